//! Project one Gaussian of a scene, and find its colour and the pixels that it may touch.

use super::bounds::{End, TILE};
use super::{BlendSpace, ColorBounds, Order, Settings, Support};
use crate::frame::Rect;
use crate::number::{Exact, MapInline, Real, Vector2, Vector3, elementary, srgb};
use crate::scene::gaussians::Encoding;
use crate::scene::{Camera, Gaussians, Scene, Surface};
use crate::shade::harmonics;
use crate::splat::gaussian::{GaussianProjector, GaussianShape, ProjectedGaussian, Symmetric};
use crate::splat::ray_disc::{RayDisc, axes_of_gaussian, axes_of_surfel};
use crate::splat::{Fate, View, batch};

/// A splat that is drawn: all that its fragments need.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GaussianSplat<R> {
    pub(crate) index: u32,
    /// The pixels that it may touch.
    pub(crate) bounds: Rect,
    pub(crate) center: Vector2<R>,
    pub(crate) conic: [R; 3],
    /// o, the opacity at the centre.
    pub(crate) alpha: R,
    /// The colour, in the space of blending.
    pub(crate) color: [R; 3],
    /// t of the centre.
    pub(crate) depth: R,
    /// What one order for the picture compares.
    pub(crate) key: R,
    /// No fragment beyond this q/2 has the least alpha; the fast path alone needs it.
    pub(crate) reach: f32,
}

/// What the fragments of a splat need beside it.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Beside<R> {
    /// For the order of a pixel.
    Solid(Solid<R>),
    /// If discs meet the rays of pixels.
    Disc(RayDisc<R>),
}

/// The splat in the camera frame, for the order of a pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Solid<R> {
    pub(crate) place: Vector3<R>,
    pub(crate) adjugate: Symmetric<R>,
}

/// The items of a scene, and what turns them into splats.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Source<'a, R> {
    scene: &'a Scene,
    pub(crate) settings: &'a Settings,
    pub(crate) projector: GaussianProjector<R>,
    eye: Vector3<R>,
    pub(super) size: [u32; 2],
    /// The space of blending.
    pub(crate) space: Encoding,
    /// The reach of an opaque splat: all splats of most surfels.
    pub(super) opaque_reach: f64,
}

/// An item, projected.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Projected<R> {
    pub(crate) shape: GaussianShape<R>,
    pub(crate) on_screen: ProjectedGaussian<R>,
    pub(crate) opacity: R,
    /// o, the opacity times the compensation.
    pub(crate) alpha: R,
    /// The distance from the camera's centre; t under an orthographic camera.
    pub(crate) distance: R,
    /// If discs meet the rays of pixels.
    pub(crate) disc: Option<RayDisc<R>>,
}

impl<R: Real> Projected<R> {
    /// What one order for the picture compares.
    pub(crate) fn key(&self, order: Order) -> R {
        match order {
            Order::Depth | Order::Pixel => self.on_screen.place.z,
            Order::Distance | Order::Steps => self.distance,
        }
    }

    /// Whether the splat has no ellipse, or no disc, in this arithmetic.
    #[inline(always)]
    pub(crate) fn degenerate(&self) -> R::Truth {
        self.disc.map_or_else(|| self.on_screen.degenerate(), |disc| disc.degenerate())
    }
}

impl<'a, R: Real> Source<'a, R> {
    pub(crate) fn new(scene: &'a Scene, camera: &Camera, settings: &'a Settings) -> Self {
        let stored = stored(scene);
        let space = match settings.blend {
            BlendSpace::Stored => stored,
            BlendSpace::Linear => Encoding::Linear,
            BlendSpace::Srgb => Encoding::Srgb,
        };
        let least = f64::from(settings.least_alpha);
        Self {
            scene,
            settings,
            projector: GaussianProjector::new(View::new(camera), &settings.kernel),
            eye: Vector3::from_glam(camera.eye().as_vec3()),
            size: camera.size(),
            space,
            opaque_reach: elementary::ln(1.0 / least),
        }
    }

    /// The opaque geometry that splats are mixed with.
    #[inline(always)]
    pub(crate) fn surface(&self) -> Option<&'a Surface> {
        self.scene.surface.as_ref()
    }

    /// How many items there are.
    pub(crate) fn len(&self) -> usize {
        count(self.scene)
    }

    /// The centre of an item.
    #[inline(always)]
    pub(super) fn position(&self, i: usize) -> Vector3<R> {
        let positions = match &self.scene.gaussians {
            Some(gaussians) => gaussians.position(),
            None => self.scene.surfels.position(),
        };
        Vector3::from_glam(positions[i])
    }

    /// The shape of an item.
    #[inline(always)]
    pub(crate) fn shape(&self, i: usize) -> GaussianShape<R> {
        match &self.scene.gaussians {
            Some(gaussians) => GaussianShape::of_gaussian(gaussians, i),
            None => GaussianShape::of_surfel(&self.scene.surfels, i, self.settings.cutoff),
        }
    }

    /// Projects an item.
    #[inline(always)]
    pub(crate) fn project(&self, i: usize) -> Projected<R> {
        self.project_as(i, self.shape(i))
    }

    /// Projects an item as if it had this shape.
    #[inline(always)]
    pub(crate) fn project_as(&self, i: usize, shape: GaussianShape<R>) -> Projected<R> {
        let on_screen = self.projector.project(&shape);
        let perspective = self.projector.view.perspective;
        let distance =
            if perspective { (shape.position - self.eye).length() } else { on_screen.place.z };
        let opacity = match &self.scene.gaussians {
            Some(gaussians) => gaussians.opacity()[i],
            None => self.scene.surfels.opacity_of(i),
        };
        let opacity = R::from_f32(opacity);
        let disc = self.settings.meets_rays().then(|| self.disc(i));
        let alpha = if disc.is_some() { opacity } else { opacity * on_screen.compensation };
        Projected { shape, on_screen, opacity, alpha, distance, disc }
    }

    /// An item as a disc that meets rays.
    #[inline]
    pub(crate) fn disc(&self, i: usize) -> RayDisc<R> {
        let (surfels, k) = (&self.scene.surfels, self.settings.cutoff);
        let (position, axes) = match &self.scene.gaussians {
            Some(gaussians) => (gaussians.position()[i], axes_of_gaussian(gaussians, i)),
            None => (surfels.position()[i], axes_of_surfel(surfels, i, k)),
        };
        self.projector.ray_disc(Vector3::from_glam(position), &axes, k)
    }

    /// The colour of an item at a position: in the scene's encoding before it is bounded, and as it is blended.
    #[inline(always)]
    pub(crate) fn look(&self, i: usize, position: Vector3<R>) -> ([R; 3], [R; 3]) {
        let surfels = &self.scene.surfels;
        let raw = match &self.scene.gaussians {
            Some(gaussians) => {
                let degree = self.settings.degree.min(gaussians.degree());
                let direction = if self.projector.view.perspective {
                    (position - self.eye).normalized()
                } else {
                    let [x, y, z, _] = self.projector.view.rows[2];
                    -Vector3::new(x, y, z)
                };
                harmonics::color(degree, gaussians.harmonics(i), direction)
            }
            None => {
                let color = surfels.color().map_or(self.scene.material.color, |colors| colors[i]);
                color.to_array().map_inline(R::from_f32)
            }
        };
        (raw, raw.map_inline(|part| self.shown(self.bounded(part))))
    }

    #[inline(always)]
    fn bounded(&self, part: R) -> R {
        match self.settings.bounds {
            ColorBounds::None => part,
            ColorBounds::Zero => part.at_least(R::ZERO),
            ColorBounds::Unit => part.clamped(R::ZERO, R::ONE),
        }
    }

    /// A stored component in the space of blending.
    #[inline(always)]
    fn shown(&self, part: R) -> R {
        match (stored(self.scene), self.space) {
            (Encoding::Srgb, Encoding::Linear) => srgb::decoded(part),
            (Encoding::Linear, Encoding::Srgb) => srgb::encoded(part),
            _ => part,
        }
    }

    /// A sphere that holds an item as far as it may be drawn: its centre and radius in the world.
    pub(crate) fn sphere(&self, i: usize) -> (Vector3<f64>, f64) {
        let Self { scene, settings, .. } = self;
        match &scene.gaussians {
            Some(gaussians) => {
                let scale = f64::from(gaussians.scale()[i].max_element());
                (Vector3::from_glam(gaussians.position()[i]), self.widest() * scale)
            }
            None => {
                let disc = batch::disc::<f64>(&scene.surfels, i);
                (disc.position, disc.reach() * self.widest() / f64::from(settings.cutoff))
            }
        }
    }

    /// How many pixels farther a splat may reach than what it shows: by the low-pass filter, and to
    /// the ends of tiles.
    pub(crate) fn skirt(&self) -> f64 {
        let filter = self.widest() * f64::from(self.settings.kernel.low_pass).sqrt();
        match self.settings.support {
            Support::None | Support::Ellipse => filter,
            // The original program adds the root of 0.1 px^2 to a variance.
            Support::Tiles | Support::Boxes => filter + 0.6 * self.widest() + TILE + 1.0,
        }
    }

    /// How many standard deviations from its centre a fragment may be.
    fn widest(&self) -> f64 {
        let Settings { support, cutoff, least_alpha, .. } = *self.settings;
        let dense = if least_alpha > 0.0 {
            (-2.0 * elementary::ln(f64::from(least_alpha))).sqrt()
        } else {
            f64::INFINITY
        };
        // The tiles of a disc hold a square about its box.
        let tiles = matches!(support, Support::Tiles | Support::Boxes);
        if support == Support::None || (tiles && self.settings.meets_rays()) {
            dense
        } else {
            dense.at_most(f64::from(cutoff))
        }
    }
}

/// How the colours of a scene are stored.
fn stored(scene: &Scene) -> Encoding {
    scene.gaussians.as_ref().map_or(Encoding::Linear, Gaussians::encoding)
}

/// How many items of a scene the method draws.
pub(crate) fn count(scene: &Scene) -> usize {
    scene.gaussians.as_ref().map_or(scene.surfels.len(), Gaussians::len)
}

impl<R: Exact> Source<'_, R> {
    /// A q/2 beyond which rounding leaves no fragment the least alpha.
    fn beyond(&self, reach: f64) -> f32 {
        // The errors of both factors of alpha, of their product and of q/2 itself are below 2^-20,
        // but not where numbers are so small that they lose bits.
        let margin = 1.0 / 1_048_576.0;
        let small = self.settings.least_alpha < 1e-30;
        if small { f32::INFINITY } else { (reach * (1.0 + margin) + margin) as f32 }
    }

    /// An item as a splat without its colour, and whether it is drawn.
    #[inline(always)]
    pub(super) fn splat(&self, i: usize) -> (GaussianSplat<R>, Fate) {
        let projected = self.project(i);
        let Projected { on_screen, alpha, disc, .. } = projected;
        let ProjectedGaussian { place, center, ellipse, conic, .. } = on_screen;
        let [x, y] = [center.x, center.y].map_inline(R::to_f64);
        let behind = self.projector.behind(place);
        let sound = !projected.degenerate();
        let alpha = alpha.to_f64();
        let seen = sound && !behind;
        let reach = if seen { self.reach(alpha) } else { f64::NEG_INFINITY };
        let bounds = match disc {
            _ if !seen => Rect::default(),
            Some(disc) => {
                let disc = disc.map(R::to_f64);
                self.bounds_of_disc(&disc, |number| [number; 2], reach, 0.0, End::Most)
            }
            None => self.bounds([[x, x], [y, y]], ellipse.map_inline(R::to_f64), alpha, reach),
        };
        let fate = match (behind, sound, bounds.is_empty()) {
            (true, _, _) => Fate::Behind,
            (_, false, _) => Fate::Degenerate,
            (_, _, true) => Fate::Outside,
            _ => Fate::Visible,
        };
        let splat = GaussianSplat {
            index: i as u32,
            bounds,
            center,
            conic,
            alpha: projected.alpha,
            color: [R::ZERO; 3],
            depth: place.z,
            key: projected.key(self.settings.order),
            reach: self.beyond(reach),
        };
        (splat, fate)
    }

    /// What the fragments of an item need beside it, if anything.
    pub(super) fn beside(&self, i: usize) -> Option<Beside<R>> {
        if self.settings.meets_rays() {
            return Some(Beside::Disc(self.disc(i)));
        }
        (self.settings.order == Order::Pixel).then(|| {
            let shape = self.shape(i);
            let place = self.projector.place(shape.position);
            Beside::Solid(Solid { place, adjugate: self.projector.turned(&shape.adjugate) })
        })
    }
}

/// The encoding of light in the space of blending.
pub(crate) fn in_space<R: Real>(light: [R; 3], space: Encoding) -> [R; 3] {
    if space == Encoding::Srgb { light.map_inline(srgb::encoded) } else { light }
}
