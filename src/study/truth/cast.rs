//! Surfaces along rays.

use super::triangles::{Met, Placed, mixed};
use super::{How, SAMPLES, Surface, Truth, frame, mean};
use crate::error::Result;
use crate::frame::{Bins, Exec, Rect};
use crate::memory;
use crate::number::Vector3;
use crate::scene::{Camera, Projection, Scene, Triangles};
use crate::shade::phong::Shader;
use crate::splat::View;
use glam::{DMat4, DVec3};

type V = Vector3<f64>;

/// The true picture of surfaces under the lights of a scene, and its colours under shifts by eighths of a
/// pixel, each 0 to 7; see the [module](super).
///
/// # Errors
/// [`crate::Error::Invalid`] as [`Camera::check`], or if the process may not hold what it takes.
pub fn of_surfaces(
    surfaces: &[Surface],
    scene: &Scene,
    cull: bool,
    (camera, shifts): (&Camera, &[[u32; 2]]),
    exec: &Exec,
    progress: &dyn Fn(&str, u64, u64),
) -> Result<Truth> {
    camera.check()?;
    let pixels = u64::from(camera.width) * u64::from(camera.height);
    memory::ask(pixels * (32 + 12 * shifts.len() as u64), || "the true picture".into())?;
    let caster = Caster::new(surfaces, scene, cull, camera, exec)?;
    let grid = exec.grid(camera.width, camera.height);
    // A few rows of tiles at a time, so that progress is seen.
    let mut tiles = Vec::new();
    let all: Vec<(usize, Rect)> = grid.rects().into_iter().enumerate().collect();
    for (done, some) in all.chunks(64).enumerate() {
        progress("the true picture", 64 * done as u64, all.len() as u64);
        tiles.extend(exec.ordered(some.to_vec(), |(tile, rect)| caster.tile(tile, &rect, shifts)));
    }
    let plane = |of: &dyn Fn(&Tile) -> &Vec<[f32; 3]>| {
        grid.assemble([0.0; 3], |tile, i| of(&tiles[tile])[i])
    };
    let seen = |of: &dyn Fn(&Seen) -> f32| grid.assemble(0.0, |tile, i| of(&tiles[tile].seen[i]));
    let alpha = seen(&|seen| f32::from(u8::from(seen.depth.is_finite())));
    let depth = seen(&|seen| seen.depth);
    let normal = grid.assemble([0.0; 3], |tile, i| tiles[tile].seen[i].normal);
    let exact = surfaces.iter().all(|surface| matches!(surface, Surface::Shape { .. }));
    Ok(Truth {
        frame: frame(plane(&|tile| &tile.colors[0]), alpha, depth, Some(normal)),
        how: if exact { How::Exact } else { How::Triangles },
        shifted: (0..shifts.len()).map(|i| plane(&|tile| &tile.colors[i + 1])).collect(),
    })
}

/// What the tiles share.
struct Caster<'a> {
    surfaces: &'a [Surface],
    /// Of each surface of triangles those that may be seen, and where.
    listed: Vec<(Vec<u32>, Option<Bins>)>,
    scene: &'a Scene,
    cull: bool,
    camera: &'a Camera,
    view: View<f64>,
    shader: Shader<f64>,
    world_from_view: DMat4,
}

/// A tile of the picture: the colours as they are and under each shift, and what the centres see.
struct Tile {
    colors: Vec<Vec<[f32; 3]>>,
    seen: Vec<Seen>,
}

/// What the ray through the centre of a pixel sees.
#[derive(Clone, Copy)]
struct Seen {
    depth: f32,
    normal: [f32; 3],
}

/// The nearest surface of a sample so far: in world space.
#[derive(Clone, Copy)]
struct Nearest {
    t: f64,
    from: Origin,
}

/// What a sample sees.
#[derive(Clone, Copy)]
enum Origin {
    Nothing,
    Triangle { surface: u32, index: u32, met: Met },
    Shape { normal: DVec3, color: DVec3 },
}

/// Rays of a rectangle: at so many places a pixel.
struct Rays {
    x: Vec<f64>,
    y: Vec<f64>,
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
            surfaces,
            listed: Vec::new(),
            scene,
            cull,
            camera,
            view,
            shader: Shader::new(view, &scene.lights, scene.material),
            world_from_view: camera.view_from_world.as_dmat4().inverse(),
        };
        for surface in surfaces {
            let listed = match surface {
                Surface::Shape { .. } => (Vec::new(), None),
                Surface::Triangles(triangles) => caster.list(triangles, exec)?,
            };
            caster.listed.push(listed);
        }
        Ok(caster)
    }

    /// The triangles that may be seen, sorted into tiles.
    fn list(&self, triangles: &Triangles, exec: &Exec) -> Result<(Vec<u32>, Option<Bins>)> {
        memory::ask(triangles.len() as u64 * 48, || "the true picture: its triangles".into())?;
        let chunks: Vec<u32> = (0..triangles.len() as u32).step_by(CHUNK as usize).collect();
        let found = exec.ordered(chunks, |first| {
            let last = (first + CHUNK).min(triangles.len() as u32);
            let rect = |i| {
                Some((i, self.rect(Placed::new(triangles, i, &self.view).bounds(&self.view)?)?))
            };
            (first..last).filter_map(rect).collect::<Vec<_>>()
        });
        let (indices, rects): (Vec<u32>, Vec<Rect>) = found.into_iter().flatten().unzip();
        let grid = exec.grid(self.camera.width, self.camera.height);
        let bins = Bins::new(&grid, rects.len(), |i| rects[i]);
        Ok((indices, Some(bins)))
    }

    /// The pixels that have a sample within bounds, under a shift or none; none if no pixel has.
    fn rect(&self, [l, t, r, b]: [f64; 4]) -> Option<Rect> {
        let place = |v: f64, room: u32| {
            let v = v.floor();
            if v > 0.0 { if v < f64::from(room) { v as u32 } else { room } } else { 0 }
        };
        let (width, height) = (self.camera.width, self.camera.height);
        // Shifts show the pixel to the left and above, too.
        let x = [place(l, width), place(r + 2.0, width)];
        let y = [place(t, height), place(b + 2.0, height)];
        let rect = Rect { x0: x[0], y0: y[0], x1: x[1], y1: y[1] };
        (!rect.is_empty()).then_some(rect)
    }

    fn tile(&self, tile: usize, rect: &Rect, shifts: &[[u32; 2]]) -> Tile {
        let side = SAMPLES as usize;
        // With a pixel to the left and above for the shifts.
        let rays = self.rays(rect, SAMPLES, SAMPLES);
        let width = rays.x.len();
        let samples = self.nearest(tile, &rays);
        let colors: Vec<[f64; 3]> = (0..samples.len())
            .map(|i| self.color(&samples[i], rays.x[i % width], rays.y[i / width]))
            .collect();
        let pixels = || (rect.y0..rect.y1).flat_map(|y| (rect.x0..rect.x1).map(move |x| (x, y)));
        let shifted = |&[kx, ky]: &[u32; 2]| -> Vec<[f32; 3]> {
            let first =
                |v: u32, from: u32, shift: u32| side * ((v - from) as usize + 1) - shift as usize;
            let at = |(x, y)| mean(&colors, width, [first(x, rect.x0, kx), first(y, rect.y0, ky)]);
            pixels().map(at).collect()
        };
        let colors = [[0, 0]].iter().chain(shifts).map(shifted).collect();
        let centres = self.rays(rect, 1, 0);
        let width = centres.x.len();
        let found = self.nearest(tile, &centres);
        let at = |i: usize| [centres.x[i % width], centres.y[i / width]];
        let seen = (0..found.len()).map(|i| self.seen(&found[i], at(i))).collect();
        Tile { colors, seen }
    }

    /// The rays of so many samples along each side of the pixels of a rectangle, and of so many before.
    fn rays(&self, rect: &Rect, samples: u32, before: u32) -> Rays {
        let Camera { fx, fy, cx, cy, .. } = *self.camera;
        let place = |from: u32, to: u32, f: f32, c: f32| -> Vec<f64> {
            let count = (to - from) * samples + before;
            let at = |i: u32| {
                let pixel =
                    f64::from(from) + (f64::from(i) - f64::from(before) + 0.5) / f64::from(samples);
                (pixel - f64::from(c)) / f64::from(f)
            };
            (0..count).map(at).collect()
        };
        let y = place(rect.y0, rect.y1, fy, cy).into_iter().map(|y| -y).collect();
        Rays { x: place(rect.x0, rect.x1, fx, cx), y }
    }

    /// What each ray of a tile sees, row by row.
    fn nearest(&self, tile: usize, rays: &Rays) -> Vec<Nearest> {
        let nothing = Nearest { t: f64::INFINITY, from: Origin::Nothing };
        let mut all = vec![nothing; rays.x.len() * rays.y.len()];
        for (i, (surface, listed)) in (0..).zip(self.surfaces.iter().zip(&self.listed)) {
            match (surface, listed) {
                (Surface::Triangles(triangles), (indices, Some(bins))) => {
                    bins.for_each(tile, |at| {
                        self.triangle(triangles, (i, indices[at as usize]), rays, &mut all);
                    });
                }
                _ => self.shape(surface, rays, &mut all),
            }
        }
        all
    }

    fn triangle(
        &self,
        triangles: &Triangles,
        (surface, index): (u32, u32),
        rays: &Rays,
        all: &mut [Nearest],
    ) {
        let placed = Placed::new(triangles, index, &self.view);
        let Some(bounds) = placed.bounds(&self.view) else { return };
        let [x, y] = self.within(bounds, rays);
        for row in y[0]..y[1] {
            for column in x[0]..x[1] {
                let Some(met) = placed.meet(rays.x[column], rays.y[row], self.view.near) else {
                    continue;
                };
                let nearest = &mut all[row * rays.x.len() + column];
                if met.t < nearest.t && (met.front || !self.cull) {
                    *nearest = Nearest { t: met.t, from: Origin::Triangle { surface, index, met } };
                }
            }
        }
    }

    /// The columns and the rows of rays within bounds in px.
    fn within(&self, [l, t, r, b]: [f64; 4], rays: &Rays) -> [[usize; 2]; 2] {
        let View { fx, fy, cx, cy, .. } = self.view;
        let column = |px: f64| rays.x.partition_point(|x| x * fx + cx < px);
        let row = |px: f64| rays.y.partition_point(|y| cy - y * fy < px);
        [[column(l), column(r)], [row(t), row(b)]]
    }

    fn shape(&self, surface: &Surface, rays: &Rays, all: &mut [Nearest]) {
        let Surface::Shape { shape, place, color: own } = surface else { return };
        let turn = place.rotation;
        for (i, nearest) in all.iter_mut().enumerate() {
            let (origin, direction) = self.ray(rays.x[i % rays.x.len()], rays.y[i / rays.x.len()]);
            // In the coordinates of the shape; a parameter there is one here.
            let back = turn.transpose();
            let origin = back * (origin - place.translation) / place.scale;
            let direction = back * direction / place.scale;
            let mut beyond = f64::from(self.camera.near);
            while let Some(hit) = shape.trace_beyond(origin, direction, beyond) {
                let normal = turn * hit.normal;
                if self.cull && normal.dot(turn * direction) >= 0.0 {
                    beyond = hit.t;
                    continue;
                }
                if hit.t < nearest.t {
                    let color = own.map_or(hit.color, glam::Vec3::as_dvec3);
                    *nearest = Nearest { t: hit.t, from: Origin::Shape { normal, color } };
                }
                break;
            }
        }
    }

    /// The ray of (x, y) in world space: its parameter is depth.
    fn ray(&self, x: f64, y: f64) -> (DVec3, DVec3) {
        let (origin, direction) = match self.camera.projection {
            Projection::Perspective => (DVec3::ZERO, DVec3::new(x, y, -1.0)),
            Projection::Orthographic => (DVec3::new(x, y, 0.0), -DVec3::Z),
        };
        let world = self.world_from_view;
        (world.transform_point3(origin), world.transform_vector3(direction))
    }

    /// The normal, turned to the side that is seen, and the colour of what a sample sees; none of
    /// nothing.
    fn surface(&self, nearest: &Nearest, direction: DVec3) -> Option<(V, [f64; 3])> {
        let (normal, color) = match nearest.from {
            Origin::Nothing => return None,
            Origin::Shape { normal, color } => {
                let normal = if normal.dot(direction) > 0.0 { -normal } else { normal };
                (Vector3::new(normal.x, normal.y, normal.z), color.to_array())
            }
            Origin::Triangle { surface, index, met } => {
                let Surface::Triangles(triangles) = &self.surfaces[surface as usize] else {
                    return None;
                };
                self.corners(triangles, index, &met)
            }
        };
        Some((normal, color))
    }

    fn corners(&self, triangles: &Triangles, index: u32, met: &Met) -> (V, [f64; 3]) {
        let corners = triangles.corners()[index as usize].map(|i| i as usize);
        let vertices = triangles.vertices();
        let normals = corners.map(|i| Vector3::from_glam(vertices.direction[i]));
        let mixed_normal = mixed(normals, met.weights);
        let length = mixed_normal.length();
        let normal = if length > 0.0 {
            Vector3::new(mixed_normal.x / length, mixed_normal.y / length, mixed_normal.z / length)
        } else {
            normals[0]
        };
        let normal = if met.front { normal } else { -normal };
        let color = vertices.color.as_ref().map_or_else(
            || self.scene.material.color.to_array().map(f64::from),
            |colors| {
                let V { x, y, z } =
                    mixed(corners.map(|i| Vector3::from_glam(colors[i])), met.weights);
                [x, y, z]
            },
        );
        (normal, color)
    }

    fn color(&self, nearest: &Nearest, x: f64, y: f64) -> [f64; 3] {
        let (_, direction) = self.ray(x, y);
        if let Some((normal, color)) = self.surface(nearest, direction) {
            let t = nearest.t;
            let [px, py] = match self.camera.projection {
                Projection::Perspective => [x * t, y * t],
                Projection::Orthographic => [x, y],
            };
            return self.shader.at(Vector3::new(px, py, -t), normal, color);
        }
        let to = Vector3::new(direction.x, direction.y, direction.z);
        self.scene.environment.as_ref().map_or([0.0; 3], |environment| environment.radiance(to))
    }

    fn seen(&self, nearest: &Nearest, [x, y]: [f64; 2]) -> Seen {
        let (_, direction) = self.ray(x, y);
        match self.surface(nearest, direction) {
            None => Seen { depth: f32::INFINITY, normal: [0.0; 3] },
            Some((V { x, y, z }, _)) => {
                Seen { depth: nearest.t as f32 + 0.0, normal: [x, y, z].map(|v| v as f32 + 0.0) }
            }
        }
    }
}

/// Triangles of one job.
const CHUNK: u32 = 1 << 14;
