//! Chooses the best method and settings within a budget, from measured candidates.
//!
//! [`choose`] takes three steps:
//!
//! 1. **Small**: draw and time every candidate in a picture with a quarter of the columns and rows.
//!    No error is taken, because holes depend on the size of a picture.
//! 2. **Whole**: from the fastest small picture to the slowest, draw candidates at full size, time
//!    them and compare them with the truth. A full picture takes at least as long as the small one.
//!    A candidate is therefore left out if its small picture takes more than [`HOPELESS`] times the
//!    time limit, or more than that multiple of the fastest whole picture within the error so far.
//! 3. **Timed**: time the candidates within the budget by turns. Candidates whose whole picture
//!    took more than [`HOPELESS`] times the fastest, or the limit, are left out.

use super::run::measure::{picture_error, second};
use super::run::{Bench, Loss, Record, time};
use super::sweep::Candidate;
use super::truth::Truth;
use crate::compare::metrics::Metric;
use crate::error::Result;
use crate::frame::Exec;
use crate::progress::Progress;
use crate::scene::Camera;
use std::time::{Duration, Instant};

/// The factor by which a first time may be too long. It is never too short by that factor.
pub const HOPELESS: f64 = 2.0;
/// The factor by which a small picture has fewer columns, and fewer rows.
const SMALLER: u32 = 4;
/// More rounds than [`time::ROUNDS`] are run while they took less than this in all, because the
/// times of fast pictures vary most from turn to turn,
const ENOUGH: Duration = Duration::from_secs(3);
/// and at most this many.
pub const MOST_ROUNDS: u64 = 25;

/// Measures candidates against the true picture, and times those that may be the best within a
/// budget.
///
/// # Errors
/// As [`Bench::visit`] and as drawing.
pub fn choose(
    bench: &mut Bench,
    candidates: &[Candidate],
    truth: &Truth,
    budget: Budget,
    loss: &Loss,
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<Vec<Known>> {
    let metric = Metric::named(loss.figure)?;
    let count = candidates.len() as u64;
    let mut known = Vec::new();
    for (i, candidate) in candidates.iter().enumerate() {
        progress("drawing small pictures", i as u64, count);
        let mut visit = bench.visit(candidate, exec, &|_, _, _| ())?;
        let camera = small(&visit.ready.camera);
        let (time, _) = second(&mut visit, candidate, &camera)?;
        known.push(Known { time, loss: f64::NAN, is_whole: false });
    }
    let mut limit = budget.first_limit();
    for (done, i) in by_time(&known).into_iter().enumerate() {
        progress("measuring", done as u64, count);
        // The first is always drawn, so that there is a nearest candidate if none is within the
        // budget.
        if done > 0 && known[i].time > HOPELESS * limit {
            break;
        }
        let (value, time) = picture_error(bench, &candidates[i], metric, truth, exec)?;
        known[i] = Known { time, loss: value.map_or(f64::NAN, loss.of), is_whole: true };
        if matches!(budget, Budget::Error(_)) && budget.allows(&known[i]) && time < limit {
            limit = time;
        }
    }
    timed(bench, candidates, &budget.hopeful(&known), &mut known, exec, progress)?;
    Ok(known)
}

/// Times some of the candidates by turns, and replaces their known times by the medians.
///
/// # Errors
/// As [`time::turn`].
pub fn timed(
    bench: &mut Bench,
    candidates: &[Candidate],
    of: &[usize],
    known: &mut [Known],
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<()> {
    let mut records: Vec<Record> = of.iter().map(|&i| Record::new(&candidates[i])).collect();
    let start = Instant::now();
    for round in 0..MOST_ROUNDS {
        if round >= time::ROUNDS && start.elapsed() >= ENOUGH {
            break;
        }
        for (done, i) in time::order(round, of.len()).into_iter().enumerate() {
            let count = of.len() as u64;
            progress("timing", round * count + done as u64, MOST_ROUNDS * count);
            time::turn(bench, &candidates[of[i]], round, &mut records[i].times, exec)?;
        }
    }
    for (&i, record) in of.iter().zip(&records) {
        if let Some([_, median, _]) = record.quartiles() {
            known[i].time = median;
        }
    }
    Ok(())
}

/// The same view with a quarter of the columns and rows, both rounded up.
fn small(camera: &Camera) -> Camera {
    let by = SMALLER as f32;
    Camera {
        width: camera.width.div_ceil(SMALLER),
        height: camera.height.div_ceil(SMALLER),
        fx: camera.fx / by,
        fy: camera.fy / by,
        cx: camera.cx / by,
        cy: camera.cy / by,
        ..*camera
    }
}

/// The candidates from the fastest to the slowest; ties go to the lower index.
fn by_time(known: &[Known]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..known.len()).collect();
    order.sort_by(|&a, &b| known[a].time.total_cmp(&known[b].time).then(a.cmp(&b)));
    order
}

/// The limit that a candidate must not exceed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Budget {
    /// An error: choose the fastest candidate whose loss is at most this.
    Error(f64),
    /// A time of a picture in ms: choose the candidate with the least loss among those whose median
    /// time is at most this.
    Time(f64),
}

/// The measurements of a candidate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Known {
    /// The median time of a picture in ms; of the small picture, if only that was drawn.
    pub time: f64,
    /// The loss against the truth; smaller is better. It is NaN if only the small picture was
    /// drawn, or if the metric is undefined.
    pub loss: f64,
    /// Whether the picture was drawn at full size.
    pub is_whole: bool,
}

impl Budget {
    /// Whether a candidate is within the budget; NaN never is.
    #[must_use]
    pub fn allows(&self, known: &Known) -> bool {
        match *self {
            Self::Error(most) => known.loss <= most,
            Self::Time(most) => known.time <= most && known.is_whole,
        }
    }

    /// How long a picture may take while no candidate is known to be within the budget.
    const fn first_limit(&self) -> f64 {
        match *self {
            Self::Error(_) => f64::INFINITY,
            Self::Time(most) => most,
        }
    }

    /// The candidates that may be the best, judged by their first times.
    #[must_use]
    pub fn hopeful(&self, all: &[Known]) -> Vec<usize> {
        let may = |known: &Known| match *self {
            Self::Error(_) => self.allows(known),
            Self::Time(most) => known.time <= HOPELESS * most && known.is_whole,
        };
        let times = all.iter().filter(|known| may(known)).map(|known| known.time);
        let fastest =
            times.fold(f64::INFINITY, |least, time| if time < least { time } else { least });
        let far = |known: &Known| matches!(self, Self::Error(_)) && known.time > HOPELESS * fastest;
        (0..all.len()).filter(|&i| may(&all[i]) && !far(&all[i])).collect()
    }

    /// The candidates within the budget, the best first. An error budget sorts by time, then loss;
    /// a time budget by loss, then time. Ties go to the lower index.
    #[must_use]
    pub fn ranked(&self, all: &[Known]) -> Vec<usize> {
        let mut allowed: Vec<usize> = (0..all.len()).filter(|&i| self.allows(&all[i])).collect();
        let key = |i: usize| match self {
            Self::Error(_) => [all[i].time, all[i].loss],
            Self::Time(_) => [all[i].loss, all[i].time],
        };
        allowed.sort_by(|&a, &b| {
            let ([first, second], [other, next]) = (key(a), key(b));
            first.total_cmp(&other).then(second.total_cmp(&next)).then(a.cmp(&b))
        });
        allowed
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::scene_file::{SceneFile, Source};
    use crate::study::run::measure::losses;
    use crate::study::run::truths;
    use crate::study::sweep::candidates;
    use std::path::Path;

    #[test]
    fn the_best_within_the_budget_is_first() {
        let known = [[4.0, 0.1], [2.0, 0.3], [2.0, 0.2], [1.0, 0.5], [9.0, 0.1], [0.5, f64::NAN]];
        let all = known.map(|[time, loss]| Known { time, loss, is_whole: true });
        assert_eq!(Budget::Error(0.3).ranked(&all), [2, 1, 0, 4]);
        assert_eq!(Budget::Error(0.05).ranked(&all), Vec::<usize>::new());
        assert_eq!(Budget::Time(2.0).ranked(&all[..5]), [2, 1, 3]);
        assert_eq!(Budget::Time(f64::INFINITY).ranked(&all[..5])[..2], [0, 4]);
        assert!(!Budget::Error(1.0).allows(&all[5]));
        assert_eq!(Budget::Error(0.3).hopeful(&all), [0, 1, 2], "9 is more than twice 2");
        assert_eq!(Budget::Time(2.0).hopeful(&all[..5]), [0, 1, 2, 3]);
    }
    /// With an unlimited budget all are drawn whole, with none only the first. A candidate that was
    /// drawn only small is never chosen.
    #[test]
    fn small_pictures_say_who_is_drawn_whole() {
        let mut file = SceneFile::open(Path::new("torus")).unwrap();
        file.camera.size = Some([34, 27]);
        let Source::Shape { count, .. } = &mut file.models[0].source else { panic!("a shape") };
        *count = 300;
        let (exec, quiet) = (Exec::sequential(), |_: &str, _, _| ());
        let mut all = candidates(&file, None).unwrap();
        all.retain(|candidate| !candidate.imitates);
        let (mut bench, all, _) = Bench::load(all, &exec, &quiet).unwrap();
        let ready = bench.visit(&all[0], &exec, &quiet).unwrap().ready;
        let camera = ready.camera;
        assert_eq!(small(&camera).size(), [9, 7]);
        let truth = truths::Known::about(&file, &ready.loaded.scene, &exec, &quiet).unwrap();
        let truth = truth.still(&camera, &exec, &quiet).unwrap();
        let rmse = losses().into_iter().find(|loss| loss.figure == "rmse").unwrap();
        let mut chosen = |budget| {
            let known = choose(&mut bench, &all, &truth, budget, &rmse, &exec, &quiet).unwrap();
            let whole = known.iter().filter(|known| known.is_whole).count();
            assert!(known.iter().all(|known| known.is_whole != known.loss.is_nan()));
            let ranked = budget.ranked(&known);
            assert!(ranked.iter().all(|&i| known[i].is_whole), "{budget:?}");
            (known, ranked, whole)
        };
        let (exact, nobody, whole) = chosen(Budget::Error(0.0));
        assert_eq!((nobody.len(), whole), (0, all.len()));
        assert_eq!(chosen(Budget::Time(f64::INFINITY)).2, all.len());
        let (_, nobody, whole) = chosen(Budget::Time(1e-9));
        assert_eq!((nobody.len(), whole), (0, 1));
        let mut sorted: Vec<f64> = exact.iter().map(|known| known.loss).collect();
        sorted.sort_by(f64::total_cmp);
        let (known, ranked, _) = chosen(Budget::Error(sorted[sorted.len() / 2]));
        for (now, before) in known.iter().zip(&exact).filter(|(now, _)| now.is_whole) {
            assert_eq!(now.loss.to_bits(), before.loss.to_bits());
        }
        assert!(!ranked.is_empty());
    }
}
