//! Casts rays at surfaces, tile by tile.

use super::rays::Rays;
use super::tile::{Seen, Tile};
use super::triangles::{Placed, Reach};
use super::{How, SAMPLES, Surface, Truth, frame};
use crate::error::Result;
use crate::frame::{Bins, Exec, Plane, Rect};
use crate::memory;
use crate::scene::{Camera, Scene, Triangles};
use crate::shade::phong::Shader;
use crate::source::procedural::Tracer;
use crate::splat::View;
use glam::{DMat3, DMat4, DVec3, Vec3};

/// The true picture of surfaces under the lights of a scene, and its colours under shifts by
/// eighths of a pixel, each 0 to 7; see the [module](super).
///
/// # Errors
/// [`crate::Error::Invalid`] as [`Camera::check`] and [`crate::scene::Similarity::check`], if a
/// parameter of a shape is out of range, or if the memory limit is too low.
pub fn of_surfaces(
    surfaces: &[Surface],
    scene: &Scene,
    cull: bool,
    (camera, shifts): (&Camera, &[[u32; 2]]),
    exec: &Exec,
    progress: &dyn Fn(&str, u64, u64),
) -> Result<Truth> {
    camera.check()?;
    let grid = exec.grid(camera.width, camera.height);
    let mut all: Vec<(usize, Rect)> = grid.rects().into_iter().enumerate().collect();
    // A few tiles at a time, so that progress is seen and results are stored early.
    let some = SOME.max(4 * exec.threads());
    ask(camera, shifts.len(), grid.side, exec)?;
    let caster = Caster::new(surfaces, scene, cull, camera, exec)?;
    let mut planes = Planes::new(camera, shifts.len() + 1);
    let (count, mut done) = (all.len() as u64, 0);
    while !all.is_empty() {
        progress(STEP, done, count);
        let jobs: Vec<_> = all.drain(..some.min(all.len())).collect();
        done += jobs.len() as u64;
        let tiles = exec.ordered(jobs, |(i, rect)| (rect, caster.tile(i, &rect, shifts)));
        tiles.iter().for_each(|(rect, tile)| planes.put(rect, tile));
    }
    progress(STEP, count, count);
    let exact = surfaces.iter().all(|surface| matches!(surface, Surface::Shape { .. }));
    let how = if exact { How::Exact } else { How::Triangles };
    let Planes { mut colors, alpha, depth, normal } = planes;
    let shifted = colors.split_off(1);
    let color = colors.remove(0);
    Ok(Truth { frame: frame(color, alpha, depth, Some(normal)), how, shifted })
}

/// The name of the step in progress reports.
pub(super) const STEP: &str = "rendering the true picture";
/// The least number of tiles between two progress reports.
const SOME: usize = 64;

/// Checks that the memory limit allows the planes, and the samples of the tiles that are computed
/// at once.
fn ask(camera: &Camera, shifts: usize, [wide, high]: [u32; 2], exec: &Exec) -> Result<()> {
    let pixels = u64::from(camera.width) * u64::from(camera.height);
    let planes = pixels * (32 + 12 * shifts as u64);
    let samples = u64::from(SAMPLES * (wide + 1)) * u64::from(SAMPLES * (high + 1));
    let samples = exec.threads() as u64 * samples * OF_A_SAMPLE;
    memory::ask(planes + samples, || {
        format!("the true picture of {} x {} pixels", camera.width, camera.height)
    })
}

/// Bytes of a sample: the nearest surface, with normal and colour for shapes, and the colour.
const OF_A_SAMPLE: u64 = 192;
/// Bytes of a triangle while it is listed: its number twice, its bounds, and its tiles.
const OF_A_TRIANGLE: u64 = 112;

/// The planes of the picture, with its colours and those under each shift.
struct Planes {
    colors: Vec<Plane<[f32; 3]>>,
    alpha: Plane<f32>,
    depth: Plane<f32>,
    normal: Plane<[f32; 3]>,
}

impl Planes {
    fn new(&Camera { width, height, .. }: &Camera, colors: usize) -> Self {
        let vectors = || Plane::filled(width, height, [0.0; 3]);
        Self {
            colors: (0..colors).map(|_| vectors()).collect(),
            alpha: Plane::filled(width, height, 0.0),
            depth: Plane::filled(width, height, 0.0),
            normal: vectors(),
        }
    }

    fn put(&mut self, rect: &Rect, tile: &Tile) {
        for (plane, colors) in self.colors.iter_mut().zip(&tile.colors) {
            put(plane, rect, colors, |color| *color);
        }
        let seen = &tile.seen;
        put(&mut self.alpha, rect, seen, |seen: &Seen| seen.alpha);
        put(&mut self.depth, rect, seen, |seen: &Seen| seen.depth);
        put(&mut self.normal, rect, seen, |seen| seen.normal);
    }
}

/// Writes the values of the pixels in a rectangle, row by row.
fn put<T, U>(plane: &mut Plane<U>, rect: &Rect, values: &[T], of: impl Fn(&T) -> U) {
    let width = plane.width() as usize;
    for (y, row) in (rect.y0 as usize..).zip(values.chunks(rect.columns())) {
        let to = &mut plane.values_mut()[y * width + rect.x0 as usize..];
        to.iter_mut().zip(row).for_each(|(to, value)| *to = of(value));
    }
}

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
    Triangles {
        triangles: &'a Triangles,
        /// The numbers of those that may be seen, ascending.
        listed: Vec<u32>,
        /// The tiles in which they may be seen.
        bins: Bins,
    },
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
    fn new(
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
        Ok(Solid::Triangles { triangles, listed, bins })
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
