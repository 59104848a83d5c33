//! Find the nearest disc of each pixel, see the page of [`super`].

use super::squares::{Disc, Squares};
use crate::composite::decide;
use crate::frame::NO_ID;
use crate::method::Job;
use crate::method::clock::{Work, spend};
use crate::method::fragment::facing;
use crate::method::surface::SurfacePixel;
use crate::method::tiled::Tiled;
use crate::number::{Exact, MapInline, Real};
use crate::splat::View;

/// The point where the ray of a pixel meets the plane of a disc.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DiscFragment<R> {
    /// Depth.
    pub(crate) t: R,
    /// The squared distance from the centre, in square world units.
    pub(crate) offset: R,
}

/// The ray of a pixel: a and b.
#[inline(always)]
pub(crate) fn ray<R: Real>(view: &View<R>, (x, y): (u32, u32)) -> [R; 2] {
    [column(view, x), row(view, y)]
}

/// a of a column.
#[inline(always)]
pub(crate) fn column<R: Real>(view: &View<R>, x: u32) -> R {
    (R::from_f32(x as f32 + 0.5) - view.cx) / view.fx
}

/// b of a row.
#[inline(always)]
pub(crate) fn row<R: Real>(view: &View<R>, y: u32) -> R {
    -((R::from_f32(y as f32 + 0.5) - view.cy) / view.fy)
}

impl<R: Real> Disc<R> {
    /// The fragment on the ray of a pixel.
    #[inline(always)]
    pub(crate) fn at(&self, [a, b]: [R; 2], perspective: bool) -> DiscFragment<R> {
        let Self { p, n, .. } = *self;
        let (t, x, y, z) = if perspective {
            let t = self.through / ((n.x * a + n.y * b) - n.z);
            (t, t * a - p.x, t * b - p.y, t + p.z)
        } else {
            let (x, y) = (a - p.x, b - p.y);
            let z = (n.x * x + n.y * y) / n.z;
            (z - p.z, x, y, z)
        };
        DiscFragment { t, offset: (x * x + y * y) + z * z }
    }

    /// Whether a fragment stays.
    #[inline(always)]
    pub(crate) fn holds(&self, fragment: &DiscFragment<R>, near: R) -> R::Truth {
        let DiscFragment { t, offset } = *fragment;
        let sound = t.is_finite() & offset.is_finite();
        sound & decide::beyond(t, near) & decide::inside(offset, self.limit)
    }
}

/// The fragment that a pixel keeps.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Kept<R> {
    /// Depth of the fragment; +inf where there is none.
    pub(crate) depth: R,
    /// Surfel of the fragment; [`NO_ID`] where there is none.
    pub(crate) surfel: u32,
    /// Squared distance from the disc's centre; 0 where there is none.
    pub(crate) offset: R,
    back: bool,
}

/// The nearest fragment of each pixel.
pub(crate) fn nearest<R: Exact>(job: &Job<'_>, squares: &Squares<R>) -> Tiled<Kept<R>> {
    let view = View::<R>::new(job.camera);
    let none = Kept { depth: R::INFINITY, surfel: NO_ID, offset: R::ZERO, back: false };
    Tiled::new(job, |tile, rect| {
        spend(Work::Discs);
        let mut pixels = vec![none; rect.pixels()];
        squares.for_each(tile, |square| {
            let inner = square.bounds.intersection(&rect);
            for (x, y) in crate::method::tiled::pixels(inner) {
                let fragment = square.disc.at(ray(&view, (x, y)), view.perspective);
                let pixel = (y - rect.y0) as usize * rect.columns() + (x - rect.x0) as usize;
                let kept = &mut pixels[pixel];
                let holds = square.disc.holds(&fragment, view.near);
                let compared = |t| job.key.depth(t);
                if holds && decide::before(compared(fragment.t), compared(kept.depth)) {
                    let DiscFragment { t, offset } = fragment;
                    let (surfel, back) = (square.surfel, square.back);
                    // Adding 0 turns -0 into +0.
                    *kept = Kept { depth: t + R::ZERO, surfel, offset, back };
                }
            }
        });
        pixels
    })
}

/// The surface that a pixel shows for its kept fragment, in a scene with colours or without.
pub(crate) fn shown<R: Exact>(job: &Job<'_>, kept: &Kept<R>, colored: bool) -> SurfacePixel<R> {
    if kept.surfel == NO_ID {
        return SurfacePixel::EMPTY;
    }
    let (scene, i) = (job.scene, kept.surfel as usize);
    let normal = scene.surfels.normal()[i].to_array().map_inline(R::from_f32);
    let color = scene.surfels.color().map_or(scene.material.color, |color| color[i]);
    SurfacePixel {
        depth: kept.depth,
        id: kept.surfel,
        weight: R::ONE,
        normal: facing(normal, kept.back).map_inline(|part| part + R::ZERO),
        color: if colored {
            color.to_array().map_inline(|part| R::from_f32(part) + R::ZERO)
        } else {
            [R::ZERO; 3]
        },
    }
}
