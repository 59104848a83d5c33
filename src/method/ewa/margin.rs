//! Measure how close the decisions at each pixel come to being undecided.

use super::Settings;
use super::possible::{PossibleSplat, PossibleSplats, project};
use super::visibility::Foremost;
use crate::composite::decide;
use crate::frame::NO_ID;
use crate::method::Job;
use crate::method::fragment::{each_in_bounds, each_pixel};
use crate::method::tiled::Tiled;
use crate::number::ball::Ieee;
use crate::number::{Ball, Exact, Truth};
use crate::splat::fragment;

/// The margin of each pixel, see the page of the method.
pub(super) fn margins<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    visible: &Tiled<Foremost<R>>,
) -> Tiled<R> {
    margins_of(job, &project(job, settings), visible)
}

/// The least margin of the fragments that may be inside.
fn margins_of<R: Exact>(
    job: &Job<'_>,
    splats: &PossibleSplats<Ieee>,
    visible: &Tiled<Foremost<R>>,
) -> Tiled<R> {
    let shared = &splats.shared;
    Tiled::new(job, |tile, rect| {
        let ids = visible.tile(tile);
        // The nearness of the nearest fragment of each pixel; without one, the nearness of an empty
        // pixel.
        let mut nearest = vec![shared.empty(); rect.pixels()];
        splats.for_each(tile, |PossibleSplat { splat, .. }| {
            each_pixel(splat, &rect, |pixel, at| {
                if ids[pixel].id == splat.surfel {
                    nearest[pixel] = fragment(shared, &splat.footprint, at).1;
                }
            });
        });
        let mut margins = vec![f64::INFINITY; rect.pixels()];
        splats.for_each(tile, |PossibleSplat { splat, certain }| {
            each_in_bounds(shared, splat, &rect, |pixel, q, w| {
                if decide::inside(q, shared.limit).possibly() {
                    let (id, nearest) = (ids[pixel].id, nearest[pixel]);
                    let limit = decide::limit(shared.depth(nearest), splats.epsilon);
                    let operands = Operands { q, cutoff: shared.limit, t: shared.depth(w), limit };
                    // A surfel that may not be drawn at all makes every decision undecided.
                    let own = if *certain {
                        operands.margin([w, nearest], id, splat.surfel)
                    } else {
                        0.0
                    };
                    if own < margins[pixel] {
                        margins[pixel] = own;
                    }
                }
            });
        });
        margins.into_iter().map(|margin| R::from_f32(margin as f32)).collect()
    })
}

/// The operands of the decisions on one fragment.
#[derive(Clone, Copy, Debug)]
struct Operands {
    q: Ball,
    /// The limit that q is compared with.
    cutoff: Ball,
    t: Ball,
    /// The greatest visible depth of the pixel.
    limit: Ball,
}

impl Operands {
    /// The margin of the fragment of a surfel; `w` is its nearness, `nearest` the nearness of the
    /// nearest fragment.
    fn margin(&self, [w, nearest]: [Ball; 2], id: u32, surfel: u32) -> f64 {
        let mut margin = f64::INFINITY;
        let mut ask = |distance: f64| {
            if distance < margin {
                margin = distance;
            }
        };
        // Where the fragment is hidden either way, its rim changes nothing.
        if decide::visible(self.t, self.limit).possibly() {
            ask(self.q.distance(self.cutoff));
        }
        // The nearest fragment is not compared with itself.
        if id != surfel && id != NO_ID {
            ask(self.t.distance(self.limit));
            ask(w.distance(nearest));
        }
        margin
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{Exec, Rect};
    use crate::index::Index;
    use crate::method::ewa::attributes::attributes;
    use crate::method::ewa::visibility::visibility;
    use crate::method::prepare::Prepared;
    use crate::scene::{Camera, Scene};
    use crate::source::procedural::Shape;
    use crate::splat::{Projector, Shared, View, batch};

    fn ball(middle: f64, radius: f64) -> Ball {
        Ball::new(middle, radius)
    }

    #[test]
    fn the_margin_is_that_of_the_closest_decision_that_matters() {
        let nearest = Operands {
            q: ball(1.0, 0.25),
            cutoff: ball(4.0, 0.0),
            t: ball(2.0, 0.5),
            limit: ball(4.0, 0.5),
        };
        let w = [ball(0.5, 0.125); 2];
        assert_eq!(nearest.margin(w, 7, 7), 12.0, "inside: (4 - 1) / 0.25; no other question");
        assert_eq!(nearest.margin(w, NO_ID, 7), 12.0, "nothing is there to be nearer than");
        assert_eq!(nearest.margin(w, 3, 7), 0.0, "nearer: as near as the nearest");
        let second = [ball(0.25, 0.03125), ball(0.5, 0.03125)];
        assert_eq!(nearest.margin(second, 3, 7), 2.0, "epsilon: (4 - 2) / (0.5 + 0.5)");
        let hidden = Operands { q: ball(4.0, 0.25), t: ball(9.0, 0.5), ..nearest };
        assert_eq!(hidden.margin(second, 3, 7), 4.0, "the rim of a hidden one changes nothing");
        let exact = Operands { q: ball(4.0, 0.0), ..nearest };
        assert_eq!(exact.margin(w, 7, 7), f64::INFINITY, "at the limit, and nothing was rounded");
    }

    /// Runs a test on a shape, its picture, and its visibility in both number types.
    fn each_shape(
        mut test: impl FnMut(&Job<'_>, &Settings, &Tiled<Foremost<f32>>, &Tiled<Foremost<f64>>),
    ) {
        let exec = Exec::new(1, 16).unwrap();
        for (shape, kernel) in [
            (Shape::Sphere, crate::splat::Kernel::DEFAULT),
            (Shape::Cluster, crate::splat::Kernel::ZPVBG01),
            (Shape::Torus, crate::splat::Kernel::ZP06),
        ] {
            let scene = Scene::unlit("shape", shape.surfels(900, 5).unwrap());
            let camera = Camera::new(57, 43, shape.default_pose(), shape.default_lens()).unwrap();
            let settings = Settings { kernel, ..Settings::default() };
            let index = Index::default();
            let job = Job::new(&scene, &index, &camera, &exec);
            let single = visibility(&job, &Prepared::splats(&job, &settings));
            let double = visibility(&job, &Prepared::splats(&job, &settings));
            test(&job, &settings, &single, &double);
        }
    }

    /// The fragments that are inside, over all pixels of the picture: surfel and pixel.
    fn inside<R: Exact>(job: &Job<'_>, settings: &Settings) -> Vec<(u32, [u32; 2])> {
        let projector = Projector::<R>::new(View::new(job.camera), &settings.kernel, settings.cull);
        let shared = Shared::new(&View::new(job.camera), &settings.kernel);
        let [width, height] = job.camera.size();
        let mut found = Vec::new();
        batch::splats(&projector, &job.scene.surfels, 0..job.scene.surfels.len(), |splat| {
            for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
                let (q, _) = fragment(&shared, &splat.footprint, (x, y));
                if decide::inside(q, shared.limit) {
                    found.push((splat.surfel, [x, y]));
                }
            }
        });
        found
    }

    #[test]
    fn the_bounds_in_balls_hold_whatever_is_inside() {
        each_shape(|job, settings, _, _| {
            let mut asked = std::collections::BTreeSet::new();
            let splats = project::<Ieee>(job, settings);
            for (tile, rect) in job.grid().rects().into_iter().enumerate() {
                splats.for_each(tile, |PossibleSplat { splat, .. }| {
                    let Rect { x0, y0, x1, y1 } = splat.bounds.intersection(&rect);
                    let pixels = (y0..y1).flat_map(|y| (x0..x1).map(move |x| [x, y]));
                    asked.extend(pixels.map(|pixel| (splat.surfel, pixel)));
                });
            }
            let single = inside::<f32>(job, settings);
            assert!(!single.is_empty() && asked.len() < 900 * job.picture().pixels());
            for fragment in single.iter().chain(&inside::<f64>(job, settings)) {
                assert!(asked.contains(fragment), "{fragment:?}");
            }
        });
    }

    #[test]
    fn beyond_one_the_numbers_agree_on_the_nearest_surfel_and_on_what_is_summed() {
        each_shape(|job, settings, single, double| {
            let margins = margins(job, settings, single).plane(|margin| *margin);
            let counts = [
                attributes(job, &Prepared::splats(job, settings), single).plane(|p| p.count),
                attributes(job, &Prepared::splats(job, settings), double).plane(|p| p.count),
            ];
            let [one, other] = counts.each_ref().map(|counts| counts.values().iter());
            for ((one, other), margin) in one.zip(other).zip(margins.values()) {
                assert!(one == other || *margin <= 1.0, "{one}, {other}: a margin of {margin}");
            }
            let [single, double] = [single.plane(|p| p.id), double.plane(|p| p.id)];
            let ids = single.values().iter().zip(double.values());
            let mut certain = 0;
            for ((single, double), margin) in ids.zip(margins.values()) {
                if *margin > 1.0 {
                    assert_eq!(single, double, "a margin of {margin}");
                    certain += usize::from(*single != NO_ID);
                }
            }
            let covered = single.values().iter().filter(|id| **id != NO_ID).count();
            assert!(2 * certain > covered, "{certain} of {covered} pixels are certain");
        });
    }
}
