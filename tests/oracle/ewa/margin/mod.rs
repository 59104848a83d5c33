//! Oracle for the plane `margin`, written from the page of the method, with its own balls.
//!
//! It shares no arithmetic with the crate. The balls, the projection and the fragments are written
//! again from the documentation, so a formula of the page that the program does not follow shows.
//! The nearest surfel of a pixel comes from the picture, as the page says.

mod ball;
mod cases;
mod splat;

use crate::oracle::ewa::margin::ball::Ball;
use crate::oracle::ewa::margin::splat::{Fragment, Lens, Splat};
use crate::oracle::kit::case::Case;
use crate::oracle::kit::planes::{index, scalars};
use splatref::frame::{Frame, NO_ID};
use splatref::method::ewa::Settings;
use std::cmp::Ordering;

/// One step of an `f32`, relative. The page gives radii by formulas of real numbers: in what order
/// f64 evaluates them, and how far the ends of an interval are rounded outwards, is 2^-39 of a
/// radius or less, which the rounding of the margin to `f32` can turn into a step. (When this was
/// written, the bits of all margins were equal.)
const STEP: f32 = f32::EPSILON;

/// A scene in balls.
struct Model {
    lens: Lens,
    epsilon: Ball,
    splats: Vec<Splat>,
}

impl Model {
    fn new(case: &Case<Settings>) -> Self {
        let (lens, surfels) = (Lens::new(&case.camera, &case.settings), &case.scene.surfels);
        let splats = (0..surfels.len()).map(|i| lens.splat(surfels, i)).collect();
        let epsilon = Ball::exact(case.settings.epsilon.resolve(surfels).into());
        Self { lens, epsilon, splats }
    }

    /// The splats that have a fragment at a pixel that is asked.
    fn asked(&self, pixel: [u32; 2]) -> impl Iterator<Item = (u32, &Splat, Fragment)> {
        let limit = self.lens.limit();
        let near = self.splats.iter().enumerate().filter(move |(_, splat)| {
            let holds = |axis: usize| {
                let [first, end] = splat.bounds[axis];
                (first..end).contains(&pixel[axis])
            };
            splat.drawn != Some(false) && holds(0) && holds(1)
        });
        let fragments = near.map(move |(i, s)| (i as u32, s, self.lens.fragment(s, pixel)));
        fragments.filter(move |(.., f)| f.q.compare(limit) != Some(Ordering::Greater))
    }

    /// The margin of a pixel whose nearest surfel is `id`.
    fn margin(&self, pixel: [u32; 2], id: u32) -> f32 {
        let first = (id != NO_ID).then(|| self.lens.fragment(&self.splats[id as usize], pixel));
        let each = self.asked(pixel).map(|(i, splat, fragment)| {
            let other = first.filter(|_| i != id);
            if splat.drawn.is_none() { 0.0 } else { self.closest(&fragment, other) }
        });
        each.fold(f64::INFINITY, f64::min) as f32
    }

    /// The least distance of the decisions on a fragment, beside the nearest if it is another.
    fn closest(&self, fragment: &Fragment, nearest: Option<Fragment>) -> f64 {
        let cover = fragment.q.distance(self.lens.limit());
        let Some(nearest) = nearest else { return cover };
        let limit = nearest.t + self.epsilon;
        let hidden = fragment.t.compare(limit) == Some(Ordering::Greater);
        let cover = if hidden { f64::INFINITY } else { cover };
        cover.min(fragment.t.distance(limit)).min(fragment.w.distance(nearest.w))
    }
}

/// How many pixels had a margin of each kind.
#[derive(Debug, Default)]
struct Seen {
    zero: u32,
    below: u32,
    above: u32,
    infinite: u32,
}

impl Seen {
    fn note(&mut self, found: f32) {
        match found {
            0.0 => self.zero += 1,
            f32::INFINITY => self.infinite += 1,
            _ if found <= 1.0 => self.below += 1,
            _ => self.above += 1,
        }
    }
}

#[test]
fn the_margin_is_that_of_the_page() {
    let mut seen = Seen::default();
    for case in cases::all() {
        let frame: Frame<f32> = case.drawing().frame();
        let (model, found) = (Model::new(&case), scalars(&frame, "margin"));
        for (i, x, y) in case.pixels() {
            let (found, expected) = (found[i], model.margin([x, y], index(&frame, "id", i)));
            // Infinities are equal or not; their difference is no number.
            let close = found == expected || (found - expected).abs() <= STEP * expected.abs();
            assert!(close, "pixel ({x}, {y}) of {}: {found}, but {expected}", case.name);
            seen.note(found);
        }
    }
    let Seen { zero, below, above, infinite } = seen;
    let least = [zero, below, above, infinite].into_iter().min();
    assert!(least > Some(100), "each kind of margin is met: {seen:?}");
}
