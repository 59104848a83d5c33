//! Project a scene to single pixels: the one pass over the scene of image-space reconstruction.
//!
//! Source: \[MKC08, sections 3.1, 4.1, 4.2, 5\], \[MOC08, section 3.1\]. Every surfel becomes at
//! most one pixel, ribbons and tubes become lines one pixel wide, and triangles become the pixels
//! they cover. A pixel keeps one [`PixelSample`], the nearest; ties: the lower [id](self#ids).
//!
//! **Surfels.** With p the centre and n the normal in view space, t = -p.z, m = 1/t and (a, b) =
//! (p.x m, p.y m) (orthographic: m = 1 and (a, b) = (p.x, p.y)):
//!
//! ```text
//!   centre  X = cx + fx a      Y = cy - fy b      drawn into pixel (floor X, floor Y)
//!   g       = (n.x a + n.y b) - n.z               orthographic: -n.z;   < 0: the front is seen
//!   depth   t                  interval [t, t + r]
//!   extent  rho = r (f m)      f = sqrt(fx fy), at most 2^48
//! ```
//!
//! Fates, in this order:
//!
//! 1. `Behind` unless t > near;
//! 2. `Degenerate` if X, Y, t or g is not finite;
//! 3. with culling, `BackFacing` if g >= 0;
//! 4. `Outside` unless 0 <= X < width and 0 <= Y < height;
//! 5. else the surfel is a sample.
//!
//! Where the back is seen (g > 0) the normal is reversed. `Decided:` an elliptical surfel counts as
//! the disc of its radius, and opacity is ignored, because both papers know discs and opaque
//! surfaces only. A disc whose centre is outside the picture is lost even where it reaches into it:
//! that is the papers' algorithm, and one of its errors.
//!
//! **Ribbons, tubes and triangles**: see [`primitives`].
//!
//! # Ids
//!
//! Surfels have their index as id. Triangles, ribbons and tubes follow, each in its order, counted
//! on.
//!
//! # Planes
//!
//! With stages, the picture has the planes that [`planes::STAGE`] leaves.
//!
//! # Regions
//!
//! A pixel keeps the nearest of the samples that are drawn into it, wherever the rest of the picture is.
//! So a region of the projection can be drawn alone, with the bits of the whole. Of a region, the
//! methods [`pyramid`](super::pyramid) and [`template`](super::template) leave these planes and no
//! others; their later stages need the joined planes of the whole picture
//! ([`Session::finish`](super::Session::finish)). If the scene has an environment, a region also has
//! the plane `environment` (linear RGB): the light that arrives along the ray of each pixel.

pub(crate) mod explain;
pub(crate) mod fast;
mod joined;
pub mod planes;
pub mod primitives;
mod project;
pub mod surfels;
#[cfg(test)]
pub(crate) mod tests;
mod visible;

pub(crate) use joined::{BEHIND, Joined};
pub(crate) use project::{beside, project};
pub(crate) use visible::{Foremost, SHARES, VisibleTriangles};

use crate::frame::raster::Snap;
use crate::frame::{NO_ID, Plane};
use crate::number::{Real, Vector2, Vector3};
use crate::scene::{Camera, Scene};
use crate::splat::clip::Clip;
use crate::splat::{Tally, View};
use surfels::PointProjector;

/// The kind of sample that a pixel shows; the stencil of \[MKC08, section 4.1\].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[repr(u8)]
pub enum SampleKind {
    /// An empty pixel.
    #[default]
    Empty = 0,
    /// A surfel.
    Surface = 1,
    /// A ribbon.
    Ribbon = 2,
    /// A tube.
    Tube = 3,
    /// A triangle.
    Polygon = 4,
}

impl SampleKind {
    /// All kinds, each at the index that is its value in the stencil.
    pub const ALL: [Self; 5] =
        [Self::Empty, Self::Surface, Self::Ribbon, Self::Tube, Self::Polygon];

    /// The name in words.
    pub(crate) fn name(self) -> &'static str {
        ["nothing", "surfel", "ribbon", "tube", "triangle"][self as usize]
    }
}

/// The sample of one pixel; view space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelSample<R> {
    /// The kind of primitive.
    pub kind: SampleKind,
    /// The id of the primitive, see the [module](self#ids).
    pub id: u32,
    /// Depth t in world units.
    pub depth: R,
    /// Radius r in world units.
    pub radius: R,
    /// Radius rho in pixels.
    pub extent: R,
    /// Position of the centre in the picture, in pixels. `Decided:` \[MOC08\] stores the
    /// coordinates of the projection, so they are not rounded; \[MKC08\] has displacement (0, 0),
    /// so its centre is the pixel's.
    pub center: Vector2<R>,
    /// Normal, towards the viewer.
    pub normal: Vector3<R>,
    /// Tangent of a tube; else the null vector.
    pub tangent: Vector3<R>,
    /// Linear RGB; 0 if the scene has no colours.
    pub color: [R; 3],
}

impl<R> PixelSample<R> {
    /// Each number in another arithmetic.
    #[must_use]
    pub fn map<S>(self, f: impl Fn(R) -> S) -> PixelSample<S> {
        PixelSample {
            kind: self.kind,
            id: self.id,
            depth: f(self.depth),
            radius: f(self.radius),
            extent: f(self.extent),
            center: self.center.map(&f),
            normal: self.normal.map(&f),
            tangent: self.tangent.map(&f),
            color: self.color.map(&f),
        }
    }
}

impl<R: Real> PixelSample<R> {
    /// No sample.
    #[must_use]
    pub fn empty() -> Self {
        Self {
            kind: SampleKind::Empty,
            id: NO_ID,
            depth: R::INFINITY,
            radius: R::ZERO,
            extent: R::ZERO,
            center: Vector2::new(R::ZERO, R::ZERO),
            normal: Vector3::ZERO,
            tangent: Vector3::ZERO,
            color: [R::ZERO; 3],
        }
    }
}

/// A scene as one sample a pixel.
#[derive(Clone, Debug)]
pub struct Projected<R> {
    /// The nearest sample of each pixel.
    pub samples: Plane<PixelSample<R>>,
    /// What became of the surfels.
    pub tally: Tally,
}

/// What the projection of a scene's primitives shares.
pub(crate) struct SceneProjector<'a, R> {
    pub(crate) scene: &'a Scene,
    pub(crate) has: Has,
    pub(crate) points: PointProjector<R>,
    pub(crate) clip: Clip<R>,
    pub(crate) snap: Snap,
    /// Width and height of the picture.
    pub(crate) size: [u32; 2],
}

impl<'a, R: Real> SceneProjector<'a, R> {
    pub(crate) fn new(scene: &'a Scene, camera: &Camera, cull: bool, snap: Snap) -> Self {
        let view = View::new(camera);
        Self {
            scene,
            has: Has::in_scene(scene),
            points: PointProjector::new(view, cull),
            clip: Clip::new(&view),
            snap,
            size: camera.size(),
        }
    }
}

/// A vector of view space in world space, divided by its length, plus 0: each component
/// `(m0 x + m1 y) + m2 z` down a column of the view matrix; the null vector stays.
#[inline(always)]
pub(crate) fn world<R: Real>(view: &View<R>, v: Vector3<R>) -> [R; 3] {
    let m = &view.rows;
    let column = |i: usize| (m[0][i] * v.x + m[1][i] * v.y) + m[2][i] * v.z;
    let n = Vector3::new(column(0), column(1), column(2)).normalized();
    [n.x + R::ZERO, n.y + R::ZERO, n.z + R::ZERO]
}

/// Which attributes a scene has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Has {
    /// Colours, of surfels or of primitives.
    pub color: bool,
    /// Tangents: tubes.
    pub tangent: bool,
}

impl Has {
    /// What this scene has.
    #[must_use]
    pub fn in_scene(scene: &Scene) -> Self {
        Self {
            color: scene.surfels.color().is_some() || scene.primitives.colored(),
            tangent: !scene.primitives.tubes.is_empty(),
        }
    }
}
