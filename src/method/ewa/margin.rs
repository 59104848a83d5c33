//! How close the decisions at each pixel came to flipping.

use super::visibility::Foremost;
use crate::composite::decide;
use crate::method::algorithm::Job;
use crate::method::fragment::TileSplats;
use crate::method::prepare::Prepared;
use crate::method::tiled::Tiled;
use crate::number::{Exact, Real};
use crate::splat::{Shared, Splat};

/// The margin of each pixel, see the page of the method: the least of all its fragments that are
/// asked; +inf where there is none.
pub(super) fn margins<R: Exact>(
    job: &Job<'_>,
    splats: &Prepared<R, Splat<R>>,
    visible: &Tiled<Foremost<R>>,
) -> Tiled<R> {
    Tiled::new(job, |tile, rect| {
        let (splats, visible) = (TileSplats::new(splats, tile, rect), visible.tile(tile));
        let (shared, epsilon) = (splats.shared(), splats.epsilon());
        let mut margins = vec![R::INFINITY; rect.pixels()];
        splats.each_in_bounds(|splat, pixel, q, w| {
            let Foremost { nearness: nearest, depth, id } = visible[pixel];
            let limit = decide::limit(depth, epsilon);
            let decisions = Decisions { q, t: shared.depth(w), w, nearest, limit };
            let margin = decisions.margin(shared, id == splat.surfel);
            margins[pixel] = margins[pixel].at_most(margin);
        });
        margins
    })
}

/// The operands of the decisions on one fragment.
#[derive(Clone, Copy, Debug)]
struct Decisions<R> {
    q: R,
    t: R,
    w: R,
    /// Nearness of the nearest fragment of the pixel.
    nearest: R,
    /// The greatest visible depth of the pixel.
    limit: R,
}

impl<R: Exact> Decisions<R> {
    /// How far the closest decision on this fragment is from flipping, in units of the last place.
    ///
    /// Inside: q against k^2, if the fragment is visible; a hidden one changes nothing. Epsilon: t
    /// against the limit, if it is inside. Depth: nearness against that of the nearest, if it is
    /// inside and another one.
    fn margin(&self, shared: &Shared<R>, is_nearest: bool) -> R {
        let inside = decide::inside(self.q, shared.limit);
        let visible = decide::visible(self.t, self.limit);
        let mut margin = f32::INFINITY;
        if visible {
            margin = margin.at_most(self.q.ulps_to(shared.limit));
        }
        if inside {
            margin = margin.at_most(self.t.ulps_to(self.limit));
            if !is_nearest {
                margin = margin.at_most(self.w.ulps_to(self.nearest));
            }
        }
        R::from_f32(margin)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Camera, Lens, Pose};
    use crate::splat::{Kernel, View};
    use glam::DVec3;

    fn shared() -> Shared<f32> {
        let pose = Pose { eye: DVec3::Z, target: DVec3::ZERO, up: DVec3::Y };
        let camera = Camera::new(8, 8, pose, Lens::Focal(8.0)).unwrap();
        Shared::new(&View::new(&camera), &Kernel::DEFAULT)
    }

    /// A number some steps up from another.
    fn up(value: f32, steps: u32) -> f32 {
        f32::from_bits(value.to_bits() + steps)
    }

    #[test]
    fn the_margin_is_that_of_the_closest_decision_that_matters() {
        let nearest = Decisions { q: 1.0, t: 2.0, w: 0.5, nearest: 0.5, limit: up(2.0, 700) };
        assert_eq!(nearest.margin(&shared(), true), 700.0, "epsilon: t against the limit");
        let rim = Decisions { q: up(4.0, 3), ..nearest };
        assert_eq!(rim.margin(&shared(), false), 3.0, "inside: q against k^2 = 4");
        let second = Decisions { w: up(0.5, 5), nearest: up(0.5, 7), ..nearest };
        assert_eq!(second.margin(&shared(), false), 2.0, "depth: against the nearest");
        let hidden = Decisions { q: up(4.0, 3), t: 3.0, ..nearest };
        assert_eq!(hidden.margin(&shared(), false), f32::INFINITY, "outside and hidden: no matter");
        let behind = Decisions { t: up(2.0, 709), w: 0.25, ..nearest };
        assert_eq!(behind.margin(&shared(), false), 9.0, "inside, but beyond the limit by 9");
    }
}
