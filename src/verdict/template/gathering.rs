//! Replay a client's gathering: every outcome that its decisions allow.

use super::levels::Level;
use crate::method::template::reconstruction::{CenterQuery, Gathered, each_query, weight};
use crate::method::template::{Center, Falloff, Settings};
use crate::number::ball::Profile;
use crate::number::{Ball, MapInline, Real, Truth};
use crate::verdict::Doubt;
use crate::verdict::outcomes::MOST;

/// The outcomes that a pixel may have gathered.
pub(super) struct Outcomes<P: Profile> {
    /// All outcomes; empty if there are more than are followed.
    pub(super) all: Vec<Gathered<Ball<P>>>,
    /// The decisions that may be either way.
    pub(super) doubts: u8,
}

/// The outcomes that a pixel may have gathered from a client's levels.
pub(super) fn outcomes<P: Profile>(
    levels: &[Level<'_, P>],
    settings: &Settings,
    pixel: (u32, u32),
) -> Outcomes<P> {
    let mut found = Outcomes { all: vec![Gathered::empty()], doubts: 0 };
    each_query(levels, settings, pixel, |asked| {
        let taken = (asked.holds | asked.own.into()) & asked.stays;
        if taken.possibly() && !found.all.is_empty() {
            found.ask(settings.falloff, asked);
        }
    });
    found
}

impl<P: Profile> Outcomes<P> {
    /// Follows a centre that may be taken.
    fn ask(&mut self, falloff: Falloff, asked: &CenterQuery<'_, Ball<P>>) {
        let taken = (asked.holds | asked.own.into()) & asked.stays;
        let weight = bounded_weight(falloff, asked);
        let mut all: Vec<Gathered<Ball<P>>> = Vec::with_capacity(self.all.len());
        let mut doubts = 0;
        let mut add = |one: Gathered<Ball<P>>| {
            if !all.iter().any(|other| same(other, &one)) {
                all.push(one);
            }
        };
        for before in &self.all {
            let test = before.ternary(asked.center);
            // Behind the front it does not matter whether the ellipse holds the pixel.
            let matters = !test.behind.certainly();
            if matters && !taken.certainly() {
                doubts |= Doubt::CutOff as u8;
                add(*before);
            }
            let places = [test.before, test.behind, !test.before & !test.behind];
            if places.iter().any(|place| place.decided().is_none()) {
                doubts |= Doubt::Epsilon as u8;
            }
            if test.before.possibly() {
                each_front(&Gathered::empty(), asked.center, weight, &mut doubts, &mut add);
            }
            if test.behind.possibly() {
                add(*before);
            }
            if places[2].possibly() {
                each_front(before, asked.center, weight, &mut doubts, &mut add);
            }
        }
        self.doubts |= doubts;
        self.all = if all.len() > MOST { Vec::new() } else { all };
    }
}

/// Adds a centre to the sums, once for each front that they may have.
fn each_front<P: Profile>(
    before: &Gathered<Ball<P>>,
    center: &Center<Ball<P>>,
    weight: Ball<P>,
    doubts: &mut u8,
    add: &mut impl FnMut(Gathered<Ball<P>>),
) {
    let nearer = before.nearer(center);
    if nearer.decided().is_none() {
        *doubts |= Doubt::Nearer as u8;
    }
    if nearer.possibly() {
        add(before.with(center, weight, true));
    }
    if !nearer.certainly() {
        add(before.with(center, weight, false));
    }
}

/// The weight of a centre. At the centre itself the form may be 0 up to its radius. The root of a
/// ball that reaches below 0 is unbounded, but the root of its greatest value is bounded.
fn bounded_weight<P: Profile>(falloff: Falloff, asked: &CenterQuery<'_, Ball<P>>) -> Ball<P> {
    let CenterQuery { form, square, .. } = *asked;
    let most = form.middle + form.radius;
    let reaches_zero = form.middle - form.radius <= 0.0 && most.is_finite();
    if falloff == Falloff::Linear && reaches_zero && square.gt(Ball::ZERO).certainly() {
        let farthest = (Ball::<P>::exact(most) / square).sqrt();
        let distance = farthest.middle + farthest.radius;
        // A little more than half, because 1 - d rounds.
        Ball::new(1.0 - 0.5 * distance, 0.5 * distance + ROUNDING)
    } else {
        weight(falloff, form, square)
    }
}

/// Twice the rounding of a number in [1/2, 1], in any profile.
const ROUNDING: f64 = 1.0 / 4_194_304.0;

/// Whether two outcomes are the same.
fn same<P: Profile>(a: &Gathered<Ball<P>>, b: &Gathered<Ball<P>>) -> bool {
    let numbers = |of: &Gathered<Ball<P>>| {
        let [x, y, z] = of.normals;
        let [red, green, blue] = of.colors;
        let all = [of.depth, of.radius, of.weight, of.depths, x, y, z, red, green, blue];
        all.map_inline(|ball| (ball.middle.to_bits(), ball.radius.to_bits()))
    };
    a.id == b.id && a.count == b.count && numbers(a) == numbers(b)
}
