//! The planes that the picture is shaded from; the definition and the fast path both leave them.

use super::Cell;
use crate::frame::{Plane, Pool};
use crate::method::Job;
use crate::method::clock::{Work, spend};
use crate::method::picture::before_environment;
use crate::method::projection::{Has, world};
use crate::number::Exact;
use crate::scene::{Camera, Scene};
use crate::shade::phong::Shader;
use crate::splat::View;

/// The visible surface, pixel by pixel; vectors in world space.
pub(super) struct GBuffer<R> {
    /// The kind of primitive, see [`crate::method::projection::SampleKind`].
    pub(super) kind: Plane<u8>,
    /// 1 where something is seen, else 0.
    pub(super) alpha: Plane<R>,
    /// Depth t; +inf where nothing is seen.
    pub(super) depth: Plane<R>,
    /// Unit normals, if there is light or the caller asked for them.
    pub(super) normal: Option<Plane<[R; 3]>>,
    /// Unit tangents of tubes, the null vector elsewhere; if the scene has tubes.
    pub(super) tangent: Option<Plane<[R; 3]>>,
    /// Colours, if `colored`; else any values.
    pub(super) color: Plane<[R; 3]>,
    /// Whether the scene has colours.
    pub(super) colored: bool,
}

impl GBuffer<f32> {
    /// The planes that a scene needs, in memory that is used again; their values are arbitrary.
    pub(super) fn new(scene: &Scene, camera: &Camera, pool: &mut Pool) -> Self {
        let (size, has) = (camera.size(), Has::in_scene(scene));
        Self {
            kind: pool.count(size),
            alpha: pool.scalar(size),
            depth: pool.scalar(size),
            normal: (!scene.lights.is_empty()).then(|| pool.triple(size)),
            tangent: has.tangent.then(|| pool.triple(size)),
            color: pool.triple(size),
            colored: has.color,
        }
    }
}

impl<R: Exact> GBuffer<R> {
    /// Level 0 as the push phase left it.
    pub(super) fn from_cells(
        cells: &Plane<Cell<R>>,
        camera: &Camera,
        has: Has,
        normals: bool,
    ) -> Self {
        spend(Work::Store);
        let view = View::new(camera);
        Self {
            kind: cells.map(|cell| cell.kind as u8),
            alpha: cells.map(|cell| if cell.is_valid() { R::ONE } else { R::ZERO }),
            depth: cells.map(|cell| cell.front),
            normal: normals.then(|| cells.map(|cell| world(&view, cell.normal))),
            tangent: has.tangent.then(|| cells.map(|cell| world(&view, cell.tangent))),
            color: cells.map(|cell| cell.color),
            colored: has.color,
        }
    }

    /// The planes with shaded colours, before the environment of the scene, if it has one.
    pub(super) fn shaded(mut self, job: &Job<'_>) -> Self {
        spend(Work::Shade);
        let Job { scene, camera, exec, .. } = *job;
        let shader = Shader::new(View::new(camera), &scene.lights, scene.material);
        let (normal, tangent) = (self.normal.as_ref(), self.tangent.as_ref());
        shader.shade_over(&self.depth, normal, tangent, &mut self.color, self.colored, exec);
        let (color, alpha) = before_environment(job, self.color, self.alpha);
        Self { color, alpha, ..self }
    }
}
