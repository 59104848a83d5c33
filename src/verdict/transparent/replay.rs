//! Replay the layers of a group at a pixel: every result that blending from back to front may have.

use super::drawings::DrawnFragment;
use crate::composite::decide;
use crate::composite::over::Blend;
use crate::frame::NO_ID;
use crate::frame::stencil::{Outcome, Stencil};
use crate::method::transparent::blending::GroupLayers;
use crate::number::ball::{Profile, Three};
use crate::number::{Ball, MapInline, Real, Truth};
use crate::verdict::Doubt;

/// The most continuations that are followed.
const MOST: usize = 16;

/// The layers blended so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layers<P: Profile> {
    pub(super) bin: f64,
    pub(super) blend: Blend<Ball<P>>,
    pub(super) opacity: Ball<P>,
    pub(super) hidden: bool,
    pub(super) count: u8,
    pub(super) depth: Ball<P>,
    pub(super) surfel: u32,
    /// The greatest component that the colour has had so far.
    pub(super) brightest: f64,
}

/// The possible results of blending; none if there are more than are followed.
pub(super) struct Replay<P: Profile> {
    pub(super) all: Option<Vec<Layers<P>>>,
    pub(super) doubts: u8,
}

impl<P: Profile> Layers<P> {
    /// The values that the planes of a group hold for these layers.
    pub(super) fn stored(&self) -> GroupLayers<Ball<P>> {
        let Self { bin, blend, opacity, hidden, count, depth, surfel, .. } = *self;
        let hidden = Ball::from_f32(f32::from(u8::from(hidden)));
        GroupLayers { bin: Ball::exact(bin), blend, opacity, hidden, count, depth, surfel }
    }

    /// Layers without a fragment.
    pub(super) const EMPTY: Self = Self {
        bin: f64::INFINITY,
        blend: Blend::CLEAR,
        opacity: Ball::ZERO,
        hidden: false,
        count: 0,
        depth: Ball::INFINITY,
        surfel: NO_ID,
        brightest: 0.0,
    };

    /// Adds a fragment that passed the depth test in this bin.
    fn with(&self, drawn: &DrawnFragment<P>, bin: f64) -> Self {
        let DrawnFragment { alpha, color, t, surfel, .. } = *drawn;
        // Opacities are exact.
        let opaque = decide::opaque(alpha).certainly();
        let blend = self.blend.over(alpha, color);
        let brightest = blend.color.iter().fold(self.brightest, |brightest, part| {
            brightest.at_least(part.middle.abs() + part.radius)
        });
        Self {
            bin,
            blend,
            opacity: if opaque { Ball::ZERO } else { self.opacity + alpha },
            hidden: opaque || self.hidden,
            count: Stencil::COUNT.update(self.count, Outcome::Pass),
            depth: t,
            surfel,
            brightest,
        }
    }

    /// Whether both results are the same, as far as any plane shows it.
    fn same(&self, other: &Self) -> bool {
        let numbers = |layers: &Self| {
            let [r, g, b] = layers.blend.color.map_inline(|part| part.middle.to_bits());
            [r, g, b, layers.blend.alpha.middle.to_bits(), layers.opacity.middle.to_bits()]
        };
        let rest = |layers: &Self| (layers.bin, layers.hidden, layers.count, layers.surfel);
        numbers(self) == numbers(other) && rest(self) == rest(other)
    }
}

/// Blends the fragments of a group at a pixel, from back to front. Fragments whose depth does not
/// stay are skipped.
pub(super) fn replay<'d, P: Profile>(
    fragments: impl Iterator<Item = &'d DrawnFragment<P>>,
    stays: &impl Fn(Ball<P>) -> Three,
) -> Replay<P> {
    let (mut all, mut doubts) = (vec![Layers::EMPTY], 0);
    for drawn in fragments {
        let stays = stays(drawn.t);
        if !stays.possibly() {
            continue;
        }
        let [first, last] = drawn.bins;
        // More than two possible bins are not followed; a NaN counts as more.
        if !(last - first <= 1.0) {
            return Replay { all: None, doubts };
        }
        let certain = drawn.certain && (drawn.inside & stays).certainly();
        let mut next: Vec<Layers<P>> = Vec::with_capacity(all.len());
        let mut open = false;
        for layers in &all {
            let passes = |bin: f64| bin < layers.bin;
            let bins = [first, last].into_iter().filter(|bin| passes(*bin));
            // If both bins are the same, the second outcome equals the first.
            let outcomes = bins.map(|bin| layers.with(drawn, bin));
            let same = !certain || !passes(first) || !passes(last);
            open |= passes(first) && !certain;
            for outcome in outcomes.chain(same.then_some(*layers)) {
                if !next.iter().any(|other| other.same(&outcome)) {
                    next.push(outcome);
                }
            }
        }
        if open {
            doubts |= if drawn.inside.certainly() { 0 } else { Doubt::CutOff as u8 };
            doubts |= if drawn.certain { 0 } else { Doubt::Fate as u8 };
            doubts |= if stays.certainly() { 0 } else { Doubt::Epsilon as u8 };
        }
        if next.len() > MOST {
            return Replay { all: None, doubts };
        }
        all = next;
    }
    if all.len() > 1 {
        // Any undecided decision counts, because a bin too is a matter of nearness that moves sums.
        doubts |= Doubt::Epsilon as u8;
    }
    Replay { all: Some(all), doubts }
}
