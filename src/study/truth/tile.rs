//! The surfaces that the rays of a tile see.

use super::caster::{Binned, Caster, Solid, Turned};
use super::rays::Rays;
use super::triangles::{Placed, mixed};
use super::{SAMPLES, mean};
use crate::frame::Rect;
use crate::number::Vector3;
use crate::number::lanes::{LANES, Lanes, components, put_vector, vectorized};
use crate::scene::Triangles;
use crate::shade::phong::Shader;
use glam::DVec3;

type V = Vector3<f64>;

/// A tile of the picture, row by row.
pub(super) struct Tile {
    /// The colours, and those under each shift.
    pub(super) colors: Vec<Vec<[f32; 3]>>,
    /// The results of the rays through the centres.
    pub(super) seen: Vec<Seen>,
}

/// The result of the ray through the centre of a pixel.
#[derive(Clone, Copy)]
pub(super) struct Seen {
    pub(super) alpha: f32,
    /// +inf if it meets nothing.
    pub(super) depth: f32,
    /// In world space, turned towards the viewer.
    pub(super) normal: [f32; 3],
}

/// The nearest surface along each ray so far.
struct Nearest {
    /// Its depth; +inf if there is none.
    t: Vec<f64>,
    /// The surface, and its triangle or its entry in `hits`.
    what: Vec<[u32; 2]>,
    /// Normals, turned towards the viewer, and colours of hits on shapes.
    hits: Vec<(V, [f64; 3])>,
}

impl Caster<'_> {
    /// The tile of this number, with these pixels.
    pub(super) fn tile(&self, tile: usize, rect: &Rect, shifts: &[[u32; 2]]) -> Tile {
        // Shifts take samples of a pixel to the left and above.
        let before = if shifts.is_empty() { 0 } else { SAMPLES };
        let rays = Rays::new(self.camera, rect, SAMPLES, before);
        let colors = self.colors(&rays, &self.nearest(tile, &rays));
        let shifted = |&[kx, ky]: &[u32; 2]| -> Vec<[f32; 3]> {
            let first = |pixel: u32, shift: u32| (SAMPLES * pixel + before - shift) as usize;
            let at = |x, y| mean(&colors, rays.x.len(), [first(x, kx), first(y, ky)]);
            let columns = rect.x1 - rect.x0;
            (0..rect.y1 - rect.y0).flat_map(|y| (0..columns).map(move |x| at(x, y))).collect()
        };
        let colors = [[0, 0]].iter().chain(shifts).map(shifted).collect();
        let centers = Rays::new(self.camera, rect, 1, 0);
        let found = self.nearest(tile, &centers);
        Tile { colors, seen: self.seen(&centers, &found) }
    }

    /// Finds the nearest surface along each ray of a tile.
    fn nearest(&self, tile: usize, rays: &Rays) -> Nearest {
        let (t, what) = (vec![f64::INFINITY; rays.len()], vec![[u32::MAX; 2]; rays.len()]);
        let mut nearest = Nearest { t, what, hits: Vec::new() };
        for (surface, solid) in (0..).zip(&self.solids) {
            match solid {
                Solid::Shape(shape) => self.trace(shape, surface, rays, &mut nearest),
                Solid::Triangles(all) => draw(self, all, tile, surface, rays, &mut nearest),
            }
        }
        nearest
    }

    /// Keeps the nearer of a triangle and the surface so far.
    #[inline(always)]
    fn meet(&self, placed: &Placed, what: [u32; 2], rays: &Rays, nearest: &mut Nearest) {
        let Some([left, top, right, bottom]) = placed.bounds(&self.view) else { return };
        let (columns, rows) = (rays.columns([left, right]), rays.rows([top, bottom]));
        if columns[0] == columns[1] || rows[0] == rows[1] {
            return;
        }
        let lines = placed.lines(self.reach);
        for row in rows[0]..rows[1] {
            let y = rays.y[row];
            let span = match &lines {
                None => columns,
                Some(lines) => match lines.span(y) {
                    None => continue,
                    Some(range) => rays.span(range, columns),
                },
            };
            for column in span[0]..span[1] {
                let Some(met) = placed.meet(rays.x[column], y, self.view.near) else { continue };
                let i = row * rays.x.len() + column;
                if met.t < nearest.t[i] && (met.front || !self.cull) {
                    nearest.t[i] = met.t;
                    nearest.what[i] = what;
                }
            }
        }
    }

    /// Keeps the nearer of a shape and the surface so far.
    fn trace(&self, shape: &Turned, surface: u32, rays: &Rays, nearest: &mut Nearest) {
        for (i, at) in rays.each() {
            let (origin, direction) = self.ray(at);
            let origin = shape.shape_from_view.transform_point3(origin);
            let direction = shape.shape_from_view.transform_vector3(direction);
            let mut beyond = self.view.near;
            while let Some(hit) = shape.tracer.trace(origin, direction, beyond) {
                if !(hit.t < nearest.t[i]) {
                    break;
                }
                let behind = hit.normal.dot(direction);
                if self.cull && behind >= 0.0 {
                    beyond = hit.t;
                    continue;
                }
                let DVec3 { x, y, z } = shape.world_from_shape * hit.normal;
                let normal = Vector3::new(x, y, z).normalized();
                let normal = if behind > 0.0 { -normal } else { normal };
                nearest.t[i] = hit.t;
                nearest.what[i] = [surface, nearest.hits.len() as u32];
                nearest.hits.push((normal, shape.color.unwrap_or(hit.color).to_array()));
                break;
            }
        }
    }

    /// The ray of (x, y) in view space; its parameter is depth.
    fn ray(&self, [x, y]: [f64; 2]) -> (DVec3, DVec3) {
        if self.view.perspective {
            (DVec3::ZERO, DVec3::new(x, y, -1.0))
        } else {
            (DVec3::new(x, y, 0.0), -DVec3::Z)
        }
    }

    /// The colour of each ray.
    fn colors(&self, rays: &Rays, nearest: &Nearest) -> Vec<[f64; 3]> {
        let mut colors = vec![[0.0; 3]; rays.len()];
        let mut batch = Batch::default();
        let mut last = None;
        for (i, at) in rays.each() {
            let t = nearest.t[i];
            let Some((normal, color)) = self.surface(nearest, i, at, &mut last) else {
                colors[i] = self.behind(at);
                continue;
            };
            let scale = if self.view.perspective { t } else { 1.0 };
            batch.push(i, Vector3::new(at[0] * scale, at[1] * scale, -t), normal, color);
            if batch.count == LANES {
                batch.shade(&self.shader, &mut colors);
            }
        }
        batch.shade(&self.shader, &mut colors);
        colors
    }

    /// The normal, turned towards the viewer, and the colour at a ray; `None` if it meets nothing.
    /// `last` is the triangle of the ray before.
    #[inline(always)]
    fn surface(
        &self,
        nearest: &Nearest,
        i: usize,
        [x, y]: [f64; 2],
        last: &mut Option<([u32; 2], Facet)>,
    ) -> Option<(V, [f64; 3])> {
        let what = nearest.what[i];
        let triangles = match self.solids.get(what[0] as usize)? {
            Solid::Shape(_) => return nearest.hits.get(what[1] as usize).copied(),
            Solid::Triangles(Binned { triangles, .. }) => triangles,
        };
        if last.as_ref().is_none_or(|(of, _)| *of != what) {
            *last = Some((what, self.facet(triangles, what[1])));
        }
        let (_, facet) = last.as_ref()?;
        facet.at(x, y, self.view.near)
    }

    fn facet(&self, triangles: &Triangles, index: u32) -> Facet {
        let corners = triangles.corners()[index as usize].map(|i| i as usize);
        let vertices = triangles.vertices();
        let of = |all: &[glam::Vec3]| corners.map(|i| Vector3::from_glam(all[i]));
        let own = || [Vector3::from_glam(self.scene.material.color); 3];
        Facet {
            placed: Placed::new(triangles, index, &self.view),
            normals: of(&vertices.direction),
            colors: vertices.color.as_deref().map_or_else(own, of),
        }
    }

    /// The background.
    fn behind(&self, at: [f64; 2]) -> [f64; 3] {
        let Some(environment) = &self.scene.environment else { return [0.0; 3] };
        let DVec3 { x, y, z } = self.world_from_view.transform_vector3(self.ray(at).1);
        environment.radiance(Vector3::new(x, y, z))
    }

    /// The results of the rays through the centres of the pixels in a rectangle.
    fn seen(&self, rays: &Rays, nearest: &Nearest) -> Vec<Seen> {
        let behind = if self.scene.environment.is_some() { 1.0 } else { 0.0 };
        let mut last = None;
        let seen = |(i, at): (usize, _)| match self.surface(nearest, i, at, &mut last) {
            None => Seen { alpha: behind, depth: f32::INFINITY, normal: [0.0; 3] },
            Some((V { x, y, z }, _)) => Seen {
                alpha: 1.0,
                depth: nearest.t[i] as f32 + 0.0,
                normal: [x, y, z].map(|v| v as f32 + 0.0),
            },
        };
        rays.each().map(seen).collect()
    }
}

vectorized!(
    /// Keeps the nearest of the triangles of a tile and the surfaces so far.
    fn draw(
        caster: &Caster<'_>,
        Binned { triangles, listed, bins }: &Binned<'_>,
        tile: usize,
        surface: u32,
        rays: &Rays,
        nearest: &mut Nearest,
    ) {
        bins.for_each(tile, |at| {
            let index = listed[at as usize];
            let placed = Placed::new(triangles, index, &caster.view);
            caster.meet(&placed, [surface, index], rays, nearest);
        });
    }
);

/// A triangle with the attributes of its corners.
struct Facet {
    placed: Placed,
    normals: [V; 3],
    colors: [V; 3],
}

impl Facet {
    /// The normal, turned towards the viewer, and the colour where the ray of (x, y) meets the
    /// triangle.
    #[inline(always)]
    fn at(&self, x: f64, y: f64, near: f64) -> Option<(V, [f64; 3])> {
        let met = self.placed.meet(x, y, near)?;
        let mixed_normal = mixed(self.normals, met.weights).normalized();
        let normal = if mixed_normal == V::ZERO { self.normals[0] } else { mixed_normal };
        let V { x, y, z } = mixed(self.colors, met.weights);
        Some((if met.front { normal } else { -normal }, [x, y, z]))
    }
}

/// Surface points that are shaded together.
struct Batch {
    count: usize,
    /// The rays that see them.
    rays: [usize; LANES],
    /// In view space.
    points: [Lanes<f64>; 3],
    /// In world space.
    normals: [Lanes<f64>; 3],
    colors: [Lanes<f64>; 3],
}

impl Default for Batch {
    fn default() -> Self {
        let zero = [[0.0; LANES]; 3];
        Self { count: 0, rays: [0; LANES], points: zero, normals: zero, colors: zero }
    }
}

impl Batch {
    #[inline(always)]
    fn push(&mut self, ray: usize, point: V, normal: V, color: [f64; 3]) {
        let i = self.count;
        self.rays[i] = ray;
        put_vector(&mut self.points, i, point);
        put_vector(&mut self.normals, i, normal);
        put_vector(&mut self.colors, i, Vector3::new(color[0], color[1], color[2]));
        self.count += 1;
    }

    /// Writes the colours to their places, and empties the batch.
    fn shade(&mut self, shader: &Shader<f64>, to: &mut [[f64; 3]]) {
        let lit = shaded(shader, self);
        for (i, &ray) in self.rays[..self.count].iter().enumerate() {
            to[ray] = components(&lit, i);
        }
        self.count = 0;
    }
}

vectorized!(
    fn shaded(shader: &Shader<f64>, batch: &Batch) -> [Lanes<f64>; 3] {
        shader.points(&batch.points, &batch.normals, &batch.colors)
    }
);
