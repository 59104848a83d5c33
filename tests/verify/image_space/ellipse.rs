//! A disc by orthogonal projection.

use super::Client;
use super::bug::Bug;
use crate::verify::client::number::{Number, Vector, sum};

/// The ellipse of a disc.
pub(super) struct Ellipse {
    tilt: [Number; 2],
    pub(super) square: Number,
}

impl Ellipse {
    pub(super) fn new(normal: Vector, extent: Number) -> Self {
        let [x, y, z] = normal;
        Self { tilt: [x / z, y / z], square: extent * extent }
    }

    /// The squared distance of an offset from the centre in the plane of the disc.
    pub(super) fn form(&self, client: &Client<'_>, [x, y]: [Number; 2]) -> Number {
        let e = match client.how.bug {
            Some(Bug::TiltIgnored) => client.zero(),
            Some(Bug::TiltSign) => self.tilt[0] * x + self.tilt[1] * y,
            _ => self.tilt[0] * x - self.tilt[1] * y,
        };
        sum(x * x, y * y, e * e)
    }

    /// Whether an offset with this form is inside.
    pub(super) fn holds(&self, client: &Client<'_>, form: Number) -> bool {
        let some = self.square.value > 0.0;
        match client.how.bug {
            Some(Bug::RimOutside) => some && form < self.square,
            Some(Bug::InsideReversed) => some && form >= self.square,
            Some(Bug::RadiusNotSquared) => some && form.value <= self.square.value.sqrt(),
            _ => some && form <= self.square,
        }
    }
}
