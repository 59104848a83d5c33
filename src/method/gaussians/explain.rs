//! Explain every decision at one pixel, with its operands.

use super::Settings;
use super::blending::{Blending, GaussianFragment, GaussianPixel, Rules};
use super::order::Splats;
use super::splats::{Projected, Source};
use crate::error::Result;
use crate::method::Job;
use crate::method::decisions::Place;
use crate::number::{Exact, MapInline, Real};
use crate::splat::ray_disc::{RayDisc, RayFragment};
use std::collections::BTreeSet;
use std::fmt;

/// The replay of one pixel.
#[derive(Clone, Debug)]
pub struct GaussianReplay<R: Real> {
    /// Column and row.
    pub pixel: (u32, u32),
    /// The splats whose bounds hold the pixel, in their order; in an order of the pixel's own, those
    /// that are skipped come last.
    pub fragments: Vec<FragmentAt<R>>,
    pixel_after: GaussianPixel<R>,
    rules: Rules<R>,
    /// Depth and colour of the surface, if one is here.
    surface: Option<(f32, [f32; 3])>,
}

/// A splat at the pixel.
#[derive(Clone, Debug)]
pub struct FragmentAt<R: Real> {
    /// The item of the scene.
    pub index: u32,
    /// Its weight T alpha, if it is drawn.
    pub weight: Option<R>,
    projected: Projected<R>,
    /// The colour before it is bounded, and as it is blended.
    look: ([R; 3], [R; 3]),
    fragment: GaussianFragment<R>,
    /// If discs meet the rays of pixels.
    met: Option<RayFragment<R>>,
}

/// Replays blending at one pixel.
///
/// # Errors
/// [`crate::Error::Usage`] if the pixel is outside the picture.
pub fn explain<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    pixel: (u32, u32),
) -> Result<GaussianReplay<R>> {
    let Place { tile, rect } = Place::new(job, pixel)?;
    let source = Source::<R>::new(job.scene, job.camera, settings);
    let splats = Splats::new(job, &job.grid(), &source);
    let rules = Rules::new(settings);
    let (buffers, key) = (job.buffers, job.key);
    let blending = Blending { source, splats: &splats, rules, buffers, key };
    let places = splats.places(tile, rect);
    let at = |place: usize, fragment: &GaussianFragment<R>, weight| {
        let index = splats.at(place).index;
        let projected = source.project(index as usize);
        let look = source.look(index as usize, projected.shape.position);
        let met = projected.disc.map(|disc| disc.fragment(&source.projector.rays, pixel));
        FragmentAt { index, weight, projected, look, fragment: *fragment, met }
    };
    let (mut drawn, mut seen) = (Vec::new(), BTreeSet::new());
    let pixel_after = blending.pixel(&places, pixel, |place, fragment, weight| {
        seen.insert(place);
        drawn.push(at(place, fragment, weight));
    });
    let skipped = places.iter().filter(|place| !seen.contains(place));
    let skipped = skipped.map(|&place| {
        let mut fragment = blending.fragment(place, pixel);
        fragment.depth = blending.depth(place, &fragment, pixel);
        at(place, &fragment, None)
    });
    let fragments = drawn.iter().cloned().chain(skipped).collect();
    let surface = source.surface().and_then(|surface| surface.at(pixel.0, pixel.1));
    Ok(GaussianReplay { pixel, fragments, pixel_after, rules, surface })
}

impl<R: Exact> fmt::Display for GaussianReplay<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ((x, y), n) = (self.pixel, |value: R| value.to_f64());
        writeln!(f, "pixel ({x}, {y}): {} splats reach it", self.fragments.len())?;
        for fragment in &self.fragments {
            fragment.fmt_projection(f)?;
            fragment.fmt_decisions(f, &self.rules, self.surface)?;
        }
        let GaussianPixel { blend, expected, median, id, heaviest, count, .. } = self.pixel_after;
        if let Some((depth, color)) = self.surface {
            writeln!(f, "\nthe surface: depth {depth}, colour {color:?}")?;
        }
        if count == 0 {
            let nothing = self.surface.map_or("the pixel is empty", |_| "no splat is before it");
            return writeln!(f, "\n{nothing}");
        }
        writeln!(
            f,
            "\nblending of {count} fragments: colour {:?} over black, {} of what is behind",
            blend.color.map_inline(n),
            n(blend.through)
        )?;
        writeln!(
            f,
            "  expected depth {}, median depth {}, first {id}, heaviest {heaviest}",
            n(expected),
            n(median)
        )
    }
}

impl<R: Exact> FragmentAt<R> {
    /// Writes how the splat was projected.
    fn fmt_projection(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let n = |value: R| value.to_f64();
        let Projected { on_screen, opacity, alpha, distance, disc, .. } = &self.projected;
        let (raw, color) = self.look;
        writeln!(f, "\nsplat {}", self.index)?;
        writeln!(
            f,
            "  depth {}, distance {}, centre ({}, {})",
            n(on_screen.place.z),
            n(*distance),
            n(on_screen.center.x),
            n(on_screen.center.y)
        )?;
        if let Some(RayDisc { filter, images: [a, b], divisor: w, .. }) = *disc {
            let axes = [a.x, a.y, b.x, b.y].map_inline(|image| n(image / w));
            writeln!(f, "  filter about ({}, {}), axes {axes:?} px", n(filter.x), n(filter.y))?;
        } else {
            writeln!(
                f,
                "  V0 {:?}, V {:?} px^2, conic {:?}",
                on_screen.unfiltered.map_inline(n),
                on_screen.ellipse.map_inline(n),
                on_screen.conic.map_inline(n)
            )?;
        }
        let factor = if disc.is_some() { R::ONE } else { on_screen.compensation };
        writeln!(
            f,
            "  opacity {} x compensation {} = {}, harmonics {:?}, colour {:?}",
            n(*opacity),
            n(factor),
            n(*alpha),
            raw.map_inline(n),
            color.map_inline(n)
        )
    }

    /// Writes the decisions on its fragment.
    fn fmt_decisions(
        &self,
        f: &mut fmt::Formatter<'_>,
        rules: &Rules<R>,
        surface: Option<(f32, [f32; 3])>,
    ) -> fmt::Result {
        let n = |value: R| value.to_f64();
        let GaussianFragment { power, alpha, depth: own, inside, dense } = self.fragment;
        if let Some(RayFragment { at: [u, v], rho3d, rho2d, depth, met, .. }) = self.met {
            let (u, v, rho3d, rho2d) = (n(u), n(v), n(rho3d), n(rho2d));
            writeln!(f, "  u {u}, v {v}, rho3d {rho3d}, rho2d {rho2d}, depth {}", n(depth))?;
            if !met {
                return writeln!(f, "  the ray meets no part of the disc: skipped");
            }
        }
        write!(f, "  q/2 {}", n(power))?;
        if !inside {
            let limit = rules.limit.map_or(f64::INFINITY, n);
            return writeln!(f, " is not in [0, {limit}]: skipped");
        }
        let sign = if dense { ">=" } else { "<" };
        write!(f, ", alpha {} {sign} {}", n(alpha), n(rules.least))?;
        match self.weight {
            _ if !dense => writeln!(f, ": skipped"),
            None if let Some((opaque, _)) = surface
                && n(own) > f64::from(opaque) =>
            {
                writeln!(f, ", depth {} > {opaque}: behind the surface, skipped", n(own))
            }
            None => writeln!(f, ": after the end, T would be below {}", n(rules.stop)),
            Some(weight) => writeln!(f, ", weight {}", n(weight)),
        }
    }
}
