//! The end of the band of visible fragments, for clients that do not measure epsilon as a depth.
//! [`crate::verdict::causes`] tries such bands.

use super::certificate::Nearest;
use crate::frame::Rect;
use crate::method::Job;
use crate::number::ball::Profile;
use crate::number::{Ball, Real, Truth};
use crate::scene::Projection;
use crate::splat::View;
use crate::verdict::client::{Band, Storage};
use crate::verdict::marks::counted;
use std::borrow::Cow;

/// The inputs of a pixel's limit, beside its nearest fragment.
pub(super) struct Bands<'a, P: Profile> {
    band: Band,
    depth_test: Storage,
    epsilon: Ball<P>,
    radii: &'a [f32],
    view: View<Ball<P>>,
}

impl<'a, P: Profile> Bands<'a, P> {
    pub(super) fn new(job: &Job<'a>, band: Band, depth_test: Storage, epsilon: Ball<P>) -> Self {
        // Under an orthographic camera nearness is -t, and all rays are parallel.
        let flat = job.camera.projection == Projection::Orthographic;
        let same = flat && matches!(band, Band::OfNearness(_) | Band::AlongRay);
        let band = if same { Band::Depth } else { band };
        let (radii, view) = (job.scene.surfels.radius(), View::new(job.camera));
        Self { band, depth_test, epsilon, radii, view }
    }

    /// Moves the nearest fragments of a rectangle, so that epsilon behind them is the end of the
    /// client's band.
    pub(super) fn moved<'n>(
        &self,
        nearest: &'n [Nearest<P>],
        rect: &Rect,
    ) -> Cow<'n, [Nearest<P>]> {
        if self.band == Band::Depth && self.depth_test == Storage::Single {
            return Cow::Borrowed(nearest);
        }
        let at = counted(*rect).map(|(_, at)| at);
        let pixels = nearest.iter().zip(at);
        let of_pixel = |(nearest, at): (&Nearest<P>, _)| {
            self.of_pixel(*nearest, at).tested(self.depth_test, self.epsilon)
        };
        Cow::Owned(pixels.map(of_pixel).collect())
    }

    fn of_pixel(&self, nearest: Nearest<P>, (x, y): (u32, u32)) -> Nearest<P> {
        let Nearest { depth, id } = nearest;
        let before = |limit: Ball<P>| Nearest { depth: limit - self.epsilon, id };
        match self.band {
            Band::Depth => nearest,
            // The nearest fragment does not pass by itself either.
            Band::Before => Nearest { depth: before(depth - self.epsilon).depth, id: None },
            Band::OfNearness(unit) => {
                let least = Ball::ONE / depth - self.epsilon * Ball::exact(unit);
                let ends = least.gt(Ball::ZERO).certainly();
                before(if ends { Ball::ONE / least } else { Ball::INFINITY })
            }
            Band::AlongRay => {
                let ray = self.view.ray(x, y);
                let squares = ray.x * ray.x + ray.y * ray.y + ray.z * ray.z;
                before(depth + self.epsilon / squares.root_of_squares())
            }
            Band::RadiiOfNearest(count) => {
                let radius = id.and_then(|id| self.radii.get(id as usize)).copied();
                let radius = Ball::from_f32(radius.unwrap_or_default());
                before(depth + Ball::from_f32(count) * radius)
            }
        }
    }
}
