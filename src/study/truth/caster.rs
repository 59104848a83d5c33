//! Surfaces made ready to be seen: what all tiles share.

use super::Surface;
use super::rays::Rays;
use super::triangles::{Placed, Reach};
use crate::error::Result;
use crate::frame::{Bins, Exec, Rect};
use crate::memory;
use crate::scene::{Camera, Scene, Triangles};
use crate::shade::phong::Shader;
use crate::source::procedural::Tracer;
use crate::splat::View;
use glam::{DMat3, DMat4, DVec3, Vec3};

/// Bytes of a triangle while it is listed: its number twice, its bounds, and its tiles.
const OF_A_TRIANGLE: u64 = 112;

/// What the tiles share.
pub(super) struct Caster<'a> {
    pub(super) solids: Vec<Solid<'a>>,
    pub(super) scene: &'a Scene,
    pub(super) cull: bool,
    pub(super) camera: &'a Camera,
    pub(super) view: View<f64>,
    pub(super) reach: Reach,
    pub(super) shader: Shader<f64>,
    pub(super) world_from_view: DMat4,
}

/// A surface, prepared for rays.
pub(super) enum Solid<'a> {
    Shape(Turned),
    Triangles(Binned<'a>),
}

/// Triangles, by the tiles in which they may be seen.
pub(super) struct Binned<'a> {
    pub(super) triangles: &'a Triangles,
    /// The numbers of those that may be seen, ascending.
    pub(super) listed: Vec<u32>,
    /// The tiles in which they may be seen.
    pub(super) bins: Bins,
}

/// A shape at its place.
pub(super) struct Turned {
    pub(super) tracer: Tracer,
    pub(super) shape_from_view: DMat4,
    /// Transforms directions.
    pub(super) world_from_shape: DMat3,
    /// Its one colour, if it has one.
    pub(super) color: Option<DVec3>,
}

impl<'a> Caster<'a> {
    pub(super) fn new(
        surfaces: &'a [Surface],
        scene: &'a Scene,
        cull: bool,
        camera: &'a Camera,
        exec: &Exec,
    ) -> Result<Self> {
        let view = View::new(camera);
        let mut caster = Self {
            solids: Vec::new(),
            scene,
            cull,
            camera,
            view,
            reach: Rays::reach(camera),
            shader: Shader::new(view, &scene.lights, scene.material),
            world_from_view: camera.view_from_world.as_dmat4().inverse(),
        };
        for surface in surfaces {
            let solid = match surface {
                Surface::Shape { shape, place, color } => {
                    place.check()?;
                    let world_from_shape = DMat4::from_translation(place.translation)
                        * DMat4::from_mat3(place.rotation * place.scale);
                    Solid::Shape(Turned {
                        tracer: shape.tracer()?,
                        shape_from_view: world_from_shape.inverse() * caster.world_from_view,
                        world_from_shape: place.rotation,
                        color: color.map(Vec3::as_dvec3),
                    })
                }
                Surface::Triangles(triangles) => caster.list(triangles, exec)?,
            };
            caster.solids.push(solid);
        }
        Ok(caster)
    }

    /// The triangles that may be seen, sorted into tiles.
    fn list(&self, triangles: &'a Triangles, exec: &Exec) -> Result<Solid<'a>> {
        let count = triangles.len() as u32;
        memory::ask(u64::from(count) * OF_A_TRIANGLE, || {
            format!("the true picture of {count} triangles")
        })?;
        let chunks: Vec<u32> = (0..count).step_by(CHUNK).collect();
        let found = exec.ordered(chunks, |first| {
            let last = count.min(first.saturating_add(CHUNK as u32));
            let rect = |i| Some((i, self.rect(&Placed::new(triangles, i, &self.view))?));
            (first..last).filter_map(rect).collect::<Vec<_>>()
        });
        let (listed, rects): (Vec<u32>, Vec<Rect>) = found.into_iter().flatten().unzip();
        let grid = exec.grid(self.camera.width, self.camera.height);
        let bins = Bins::new(&grid, rects.len(), |i| rects[i]);
        Ok(Solid::Triangles(Binned { triangles, listed, bins }))
    }

    /// The pixels that may see a triangle, with or without a shift; `None` if no pixel may.
    fn rect(&self, placed: &Placed) -> Option<Rect> {
        let [left, top, right, bottom] = placed.bounds(&self.view)?;
        let from_behind = || placed.lines(self.reach).is_some_and(|lines| !lines.front);
        let place = |v: f64, room: u32| {
            let v = v.floor();
            if v > 0.0 { if v < f64::from(room) { v as u32 } else { room } } else { 0 }
        };
        let (width, height) = (self.camera.width, self.camera.height);
        // Under a shift, a pixel takes samples of the pixels to the left and above.
        let x = [place(left, width), place(right + 2.0, width)];
        let y = [place(top, height), place(bottom + 2.0, height)];
        let rect = Rect { x0: x[0], y0: y[0], x1: x[1], y1: y[1] };
        let hidden = rect.is_empty() || (self.cull && from_behind());
        (!hidden).then_some(rect)
    }
}

/// Triangles in one job.
const CHUNK: usize = 1 << 14;
