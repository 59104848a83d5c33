//! List every outcome of merging four neighbours, where the decisions may be undecided.
//!
//! The formulas of pull, push and propagation have the same shape:
//!
//! - The foremost candidate is the one with the least depth, which must be less than +inf. On a
//!   tie, the earlier candidate is foremost.
//! - All candidates that join the foremost are merged with it.
//! - If there is no candidate, or if the foremost does not join itself, the result is empty.
//! - Where it is undecided whether the foremost joins itself, it does so by law.

use crate::composite::decide;
use crate::number::{MapInline, Real, Truth};
use crate::verdict::Doubt;

/// Which of the four candidates take part, and which of them is foremost; none if the result is
/// empty.
pub(crate) type Outcome = Option<([bool; 4], usize)>;

/// The largest number of outcomes that are followed.
pub(crate) const MOST: usize = 16;

/// Every outcome, each once, in a fixed order, and the doubts behind them.
///
/// `joins(one, foremost)` says whether a candidate joins the foremost.
pub(crate) fn outcomes<R: Real>(
    candidates: [R::Truth; 4],
    depths: [R; 4],
    joins: impl Fn(usize, usize) -> R::Truth,
) -> (Vec<Outcome>, u8) {
    let (mut found, mut doubts) = (Vec::new(), 0);
    if candidates.iter().any(|truth| open(*truth)) {
        doubts |= Doubt::CutOff as u8;
    }
    for present in subsets(candidates) {
        let firsts: Vec<usize> = (0..4).filter(|&j| may_be_first(present, depths, j)).collect();
        let shown = |j: usize| decide::before(depths[j], R::INFINITY);
        if (0..4).all(|j| !present[j] || !shown(j).certainly()) {
            add(&mut found, None);
        }
        if !firsts.iter().skip(1).all(|&j| is_tie(depths[j], depths[firsts[0]])) {
            doubts |= Doubt::Nearer as u8;
        }
        for first in firsts {
            if !joins(first, first).possibly() {
                add(&mut found, None);
                continue;
            }
            let with = [0, 1, 2, 3].map_inline(|j| match present[j] {
                true if j == first => true.into(),
                true => joins(j, first),
                false => false.into(),
            });
            if with.iter().any(|truth| open(*truth)) {
                doubts |= Doubt::Epsilon as u8;
            }
            for takes in subsets(with) {
                add(&mut found, Some((takes, first)));
            }
        }
    }
    (found, doubts)
}

fn add(found: &mut Vec<Outcome>, outcome: Outcome) {
    if !found.contains(&outcome) {
        found.push(outcome);
    }
}

/// Whether two depths are one number that was rounded when it was stored. The numbers before they
/// were rounded may differ, so that both orders are followed, but the tie is nearly always what it
/// seems: one number that was copied. Coarser formats hide real differences, so that their equal
/// codes are doubts.
fn is_tie<R: Real>(depth: R, other: R) -> bool {
    let nearer = other * R::from_f32(1.0 - 4.0 / 1_048_576.0);
    depth.to_f64() == other.to_f64() && !decide::before(depth, nearer).possibly()
}

/// Whether a truth is undecided.
fn open<T: Truth>(truth: T) -> bool {
    truth.possibly() && !truth.certainly()
}

/// The sets that four truths allow.
fn subsets<T: Truth>(truths: [T; 4]) -> impl Iterator<Item = [bool; 4]> {
    let all = (0..16).map(|bits: u32| [0, 1, 2, 3].map_inline(|j| bits >> j & 1 == 1));
    all.filter(move |set| {
        let allows = |j: usize| if set[j] { truths[j].possibly() } else { !truths[j].certainly() };
        (0..4).all(allows)
    })
}

/// Whether candidate j, among those present, may be the foremost.
fn may_be_first<R: Real>(present: [bool; 4], depths: [R; 4], j: usize) -> bool {
    let passes = |k: usize| match k {
        _ if k == j || !present[k] => true,
        // The earlier candidate stays foremost unless the later is before it.
        _ if k < j => decide::before(depths[j], depths[k]).possibly(),
        _ => !decide::before(depths[k], depths[j]).certainly(),
    };
    present[j] && decide::before(depths[j], R::INFINITY).possibly() && (0..4).all(passes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::composite::mean::foremost;
    use crate::number::Ball;
    use crate::number::random::unit;

    #[test]
    fn of_exact_numbers_there_is_one_outcome_and_it_is_that_of_the_definition() {
        for i in 0..4000_u64 {
            // Few different values, so that there are ties.
            let of = |k: usize| (unit(i, k as u64) * 4.0).floor() * 0.25;
            let fronts = [0, 1, 2, 3].map(|j| if of(j) == 0.75 { f32::INFINITY } else { of(j) });
            let backs = [0, 1, 2, 3].map(|j| fronts[j] + of(4 + j) - 0.25);
            let candidates = [0, 1, 2, 3].map(|j| of(8 + j) > 0.25);
            let join = |j: usize, first: usize| decide::overlaps(fronts[j], backs[first]);
            let (found, doubts) = outcomes(candidates, fronts, join);
            let (takes, first) = foremost(candidates, fronts, backs);
            let one = takes[first].then_some((takes, first));
            assert_eq!((found, doubts), (vec![one], 0), "{fronts:?} {backs:?} {candidates:?}");
        }
    }

    #[test]
    fn what_is_undecided_has_every_outcome() {
        let ball = |middle: f64| Ball::<crate::number::ball::Ieee>::new(middle, 0.125);
        let certain = [true.into(), true.into(), false.into(), false.into()];
        let yes = |_, _| true.into();
        let (found, doubts) = outcomes(certain, [1.0, 1.0, 0.0, 0.0].map(ball), yes);
        let both = [true, true, false, false];
        assert_eq!(found, [Some((both, 0)), Some((both, 1))]);
        assert_eq!(doubts, Doubt::Nearer as u8);
        let rounded = |middle: f64| Ball::<crate::number::ball::Ieee>::new(middle, 6e-8);
        let (found, doubts) = outcomes(certain, [1.0, 1.0, 0.0, 0.0].map(rounded), yes);
        assert_eq!(found, [Some((both, 0)), Some((both, 1))]);
        assert_eq!(doubts, 0, "one rounded number twice is a tie");
        let undecided = ball(0.0).lt(ball(0.0));
        let one = [undecided, false.into(), false.into(), false.into()];
        let (found, doubts) = outcomes(one, [1.0; 4].map(ball), yes);
        assert_eq!(found, [None, Some(([true, false, false, false], 0))]);
        assert_eq!(doubts, Doubt::CutOff as u8);
        let join = |j: usize, first: usize| if j == first { true.into() } else { undecided };
        let (found, doubts) = outcomes(certain, [1.0, 2.0, 0.0, 0.0].map(ball), join);
        assert_eq!(found, [Some(([true, false, false, false], 0)), Some((both, 0))]);
        assert_eq!(doubts, Doubt::Epsilon as u8);
    }
}
