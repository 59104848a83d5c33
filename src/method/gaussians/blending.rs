//! Blend the fragments of a pixel from front to back.

use super::order::Splats;
use super::splats::{Beside, GaussianSplat, Solid, Source};
use super::{Order, Settings, Support};
use crate::composite::decide;
use crate::composite::under::Under;
use crate::frame::stencil::{Outcome, Stencil};
use crate::frame::{NO_ID, Rect};
use crate::method::buffer_formats::{Buffers, DepthKey};
use crate::method::clock::{Work, spend};
use crate::method::tiled::pixels;
use crate::number::real::ordered_f64;
use crate::number::{Exact, Real};
use crate::splat::gaussian::ProjectedGaussian;
use crate::splat::ray_disc::RayFragment;

/// A pixel after blending.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct GaussianPixel<R> {
    /// C, A and T.
    pub(crate) blend: Under<R>,
    /// The sum of weight times depth.
    pub(crate) moment: R,
    /// The mean depth by weight; +inf where no weight is above 0.
    pub(crate) expected: R,
    /// The depth of the last fragment before which T > 1/2; +inf where nothing is drawn.
    pub(crate) median: R,
    /// The depth of the first fragment; +inf where nothing is drawn.
    pub(crate) depth: R,
    /// The first fragment.
    pub(crate) id: u32,
    /// The fragment of the greatest weight, the first of several.
    pub(crate) heaviest: u32,
    /// That weight.
    pub(crate) weight: R,
    /// How many fragments are drawn, up to 255.
    pub(crate) count: u8,
}

impl<R: Real> GaussianPixel<R> {
    /// Nothing.
    pub(crate) const EMPTY: Self = Self {
        blend: Under::CLEAR,
        moment: R::ZERO,
        expected: R::INFINITY,
        median: R::INFINITY,
        depth: R::INFINITY,
        id: NO_ID,
        heaviest: NO_ID,
        weight: R::ZERO,
        count: 0,
    };

    /// The numbers after one more fragment; ids and counts stay.
    #[inline(always)]
    pub(crate) fn after(&self, alpha: R, color: [R; 3], depth: R) -> Self {
        let weight = self.blend.through * alpha;
        let half = self.blend.through.gt(R::from_f32(0.5));
        Self {
            blend: self.blend.under(alpha, color),
            moment: self.moment + weight * depth,
            median: R::select(half, depth, self.median),
            ..*self
        }
    }

    /// The pixel when all fragments are drawn: the expected depth is a quotient.
    pub(crate) fn finished(self) -> Self {
        let some = self.blend.alpha.gt(R::ZERO);
        let expected = R::select(some, self.moment / self.blend.alpha, R::INFINITY);
        Self { expected, ..self }
    }
}

/// The decisions on a fragment, in their order, with their operands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct GaussianFragment<R: Real> {
    /// q/2.
    pub(crate) power: R,
    /// alpha.
    pub(crate) alpha: R,
    /// The depth.
    pub(crate) depth: R,
    /// Whether it is in reach: 0 <= q/2, and within the cut-off if there is one.
    pub(crate) inside: R::Truth,
    /// Whether alpha is not too small.
    pub(crate) dense: R::Truth,
}

/// The rules of blending, as numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rules<R> {
    /// k k / 2, if an ellipse cuts.
    pub(crate) limit: Option<R>,
    pub(crate) least: R,
    /// Whether the least alpha is 0, so that every fragment is dense enough.
    all: bool,
    pub(crate) most: R,
    pub(crate) stop: R,
    stop_at: bool,
    stops: bool,
}

impl<R: Real> Rules<R> {
    pub(crate) fn new(settings: &Settings) -> Self {
        let n = R::from_f32;
        let k = n(settings.cutoff);
        Self {
            limit: (settings.support == Support::Ellipse).then(|| (k * k) / n(2.0)),
            least: n(settings.least_alpha),
            all: settings.least_alpha == 0.0,
            most: n(settings.most_alpha),
            stop: n(settings.stop),
            stop_at: settings.stop_at,
            stops: settings.stop > 0.0,
        }
    }

    /// The fragment of a splat where q/2 is this.
    #[inline(always)]
    pub(crate) fn with_power(&self, splat: &GaussianSplat<R>, power: R) -> GaussianFragment<R> {
        let alpha = (splat.alpha * (-power).exp()).at_most(self.most);
        let reaches = power.ge(R::ZERO);
        let inside = self.limit.map_or(reaches, |limit| reaches & decide::inside(power, limit));
        let dense = if self.all { true.into() } else { decide::dense(alpha, self.least) };
        GaussianFragment { power, alpha, depth: splat.depth, inside, dense }
    }

    /// The fragment of a disc that met a ray.
    #[inline(always)]
    pub(crate) fn of_disc(
        &self,
        splat: &GaussianSplat<R>,
        own: &RayFragment<R>,
    ) -> GaussianFragment<R> {
        let fragment = self.with_power(splat, R::from_f32(0.5) * own.rho);
        GaussianFragment { depth: own.depth, inside: fragment.inside & own.met, ..fragment }
    }

    /// Whether blending ends before a fragment that leaves this transmittance.
    #[inline(always)]
    pub(crate) fn ends(&self, through: R) -> R::Truth {
        if !self.stops {
            false.into()
        } else if self.stop_at {
            through.le(self.stop)
        } else {
            through.lt(self.stop)
        }
    }
}

/// Blends the pixels of a picture.
#[derive(Debug)]
pub(crate) struct Blending<'a, R> {
    pub(crate) source: Source<'a, R>,
    pub(crate) splats: &'a Splats<R>,
    pub(crate) rules: Rules<R>,
    pub(crate) buffers: Buffers,
    /// What the test against the surface compares.
    pub(crate) key: DepthKey,
}

/// A splat at a pixel: its place in the list, and its fragment.
type Listed<R> = (usize, GaussianFragment<R>);

impl<R: Exact> Blending<'_, R> {
    /// The pixels of a rectangle in a tile, row by row.
    pub(crate) fn tile(&self, tile: usize, rect: Rect) -> Vec<GaussianPixel<R>> {
        spend(Work::Blend);
        let places = self.splats.places(tile, rect);
        pixels(rect).map(|at| self.pixel(&places, at, |_, _, _| ())).collect()
    }

    /// One pixel, from the splats that may touch it. `each` gets every fragment that is inside, dense and
    /// not behind the surface, with its weight; none if blending has ended before it.
    pub(crate) fn pixel(
        &self,
        places: &[usize],
        at: (u32, u32),
        mut each: impl FnMut(usize, &GaussianFragment<R>, Option<R>),
    ) -> GaussianPixel<R> {
        let mut pixel = GaussianPixel::EMPTY;
        let mut done = false;
        let mut draw = |&(place, fragment): &Listed<R>| {
            let splat = self.splats.at(place);
            done = done || self.rules.ends(pixel.blend.through * (R::ONE - fragment.alpha));
            let weight = pixel.blend.through * fragment.alpha;
            each(place, &fragment, (!done).then_some(weight));
            if !done {
                pixel = self.add(pixel, splat, fragment.alpha, fragment.depth);
            }
            !done
        };
        if self.source.settings.order == Order::Pixel {
            let mut listed = Vec::new();
            for &place in places {
                listed.extend(self.drawn(place, at).map(|fragment| (place, fragment)));
            }
            // Stable, so that ties stay in the order of the indices.
            listed.sort_by_key(|(_, fragment)| ordered_f64(fragment.depth.to_f64()));
            listed.iter().all(&mut draw);
        } else {
            for &place in places {
                let fragment = self.drawn(place, at);
                if fragment.is_some_and(|fragment| !draw(&(place, fragment))) {
                    break;
                }
            }
        }
        pixel.finished()
    }

    /// The fragment of a splat, if it takes part.
    #[inline(always)]
    fn drawn(&self, place: usize, (x, y): (u32, u32)) -> Option<GaussianFragment<R>> {
        let Rect { x0, y0, x1, y1 } = self.splats.at(place).bounds;
        if x < x0 || x >= x1 || y < y0 || y >= y1 {
            return None;
        }
        let mut fragment = self.fragment(place, (x, y));
        if !(fragment.inside && fragment.dense) {
            return None;
        }
        fragment.depth = self.depth(place, &fragment, (x, y));
        (!self.hidden(fragment.depth, (x, y))).then_some(fragment)
    }

    /// The depth of a fragment, which an order of the pixel's own finds along the ray.
    pub(crate) fn depth(&self, place: usize, fragment: &GaussianFragment<R>, at: (u32, u32)) -> R {
        let projector = &self.source.projector;
        match self.splats.beside(place) {
            Some(Beside::Solid(solid)) => {
                let Solid { place: center, adjugate } = solid;
                projector.deepest(adjugate, *center, projector.ray(at))
            }
            _ => fragment.depth,
        }
    }

    /// Whether a fragment of this depth is behind the surface.
    #[inline(always)]
    pub(crate) fn hidden(&self, depth: R, (x, y): (u32, u32)) -> bool {
        self.source.surface().is_some_and(|surface| {
            let opaque = R::from_f32(*surface.depths().at(x, y));
            self.key.depth(depth) > self.key.depth(opaque)
        })
    }

    /// The fragment of a splat at a pixel within its bounds.
    #[inline(always)]
    pub(crate) fn fragment(&self, place: usize, at: (u32, u32)) -> GaussianFragment<R> {
        let splat = self.splats.at(place);
        match self.splats.beside(place) {
            Some(Beside::Disc(disc)) => {
                self.rules.of_disc(splat, &disc.fragment(&self.source.projector.rays, at))
            }
            _ => {
                let power = ProjectedGaussian::power(splat.center, splat.conic, at);
                self.rules.with_power(splat, power)
            }
        }
    }

    /// The pixel with one more fragment.
    #[inline(always)]
    fn add(
        &self,
        pixel: GaussianPixel<R>,
        splat: &GaussianSplat<R>,
        alpha: R,
        depth: R,
    ) -> GaussianPixel<R> {
        let weight = pixel.blend.through * alpha;
        let mut next = pixel.after(alpha, splat.color, depth);
        next.blend = self.buffers.under(next.blend);
        if pixel.id == NO_ID {
            (next.id, next.depth) = (splat.index, depth);
        }
        if pixel.heaviest == NO_ID || weight > pixel.weight {
            (next.heaviest, next.weight) = (splat.index, weight);
        }
        next.count = Stencil::COUNT.update(pixel.count, Outcome::Pass);
        next
    }
}
