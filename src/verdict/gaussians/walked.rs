//! What may be at a pixel after blending.

use crate::composite::under::Under;
use crate::frame::NO_ID;
use crate::method::gaussians::blending::GaussianPixel;
use crate::number::ball::Profile;
use crate::number::{Ball, Real};

/// What may be at a pixel.
pub(super) struct Walked<P: Profile> {
    /// The numbers, one set for each order that was followed; ids and count mean nothing.
    pub(super) numbers: Vec<GaussianPixel<Ball<P>>>,
    /// The fragments that may be the first, in their order; with none, nothing is drawn for certain.
    pub(super) firsts: Vec<(u32, Ball<P>)>,
    /// Whether a fragment certainly is drawn.
    pub(super) covered: bool,
    /// The items that may be the heaviest.
    pub(super) heaviest: Vec<u32>,
    /// The least and the greatest count.
    pub(super) least: u32,
    pub(super) most: u32,
    /// The largest component of a colour.
    pub(super) brightest: f64,
    pub(super) doubts: u8,
}

impl<P: Profile> Walked<P> {
    /// Whether open decisions leave the sums in intervals that are too wide to judge them.
    pub(super) fn undecided(&self) -> bool {
        let most = 2.0 / 255.0;
        let narrow = |numbers: &GaussianPixel<Ball<P>>| {
            let Under { color, through, .. } = &numbers.blend;
            let widest = most * self.brightest.at_least(1.0);
            through.radius <= most && color.iter().all(|part| part.radius <= widest)
        };
        self.doubts != 0 && !self.numbers.iter().all(narrow)
    }

    /// The numbers in the order that comes closest to a client's, where `error` is its distance from
    /// some numbers.
    pub(super) fn closest(
        &self,
        error: impl Fn(GaussianPixel<Ball<P>>) -> f64,
    ) -> GaussianPixel<Ball<P>> {
        let numbers = self.numbers.iter();
        let closest = numbers.min_by(|a, b| error(**a).total_cmp(&error(**b)));
        closest.copied().unwrap_or(GaussianPixel::EMPTY)
    }

    /// These numbers with the ids and the count that the client has, if it may have them. Its depth is
    /// that of its first fragment.
    pub(super) fn truth(
        &self,
        numbers: GaussianPixel<Ball<P>>,
        id: Option<u32>,
        heaviest: Option<u32>,
        count: Option<u8>,
    ) -> GaussianPixel<Ball<P>> {
        let empty = (NO_ID, Ball::INFINITY);
        let may_be_empty = (!self.covered).then_some(empty);
        let mut firsts = self.firsts.iter().copied().chain(may_be_empty);
        let found = id.and_then(|id| firsts.clone().find(|(first, _)| *first == id));
        let (id, depth) = match (id, found) {
            (_, Some(found)) => found,
            // Without an id, the depth may be that of any first fragment.
            (None, None) => firsts.clone().reduce(|a, b| (a.0, a.1.either(b.1))).unwrap_or(empty),
            (Some(_), None) => firsts.next().unwrap_or(empty),
        };
        let may_weigh = |own: u32| self.heaviest.contains(&own) || (own == NO_ID && !self.covered);
        let heaviest = heaviest
            .filter(|own| may_weigh(*own))
            .or_else(|| self.heaviest.first().copied())
            .unwrap_or(NO_ID);
        let (least, most) = (self.least.min(255) as u8, self.most.min(255) as u8);
        let count = count.map_or(least, |count| count.clamp(least, most));
        GaussianPixel { id, depth, heaviest, count, ..numbers }
    }
}
