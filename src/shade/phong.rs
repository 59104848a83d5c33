//! Deferred Phong shading.
//!
//! In view space, for a pixel at depth t with normal n (turned from world to view space) and surface
//! colour s (that of the pixel, or the material's where the scene has none):
//!
//! ```text
//!   p = (x, y, -t)      perspective: x = ((X - cx)/fx) t, y = -((Y - cy)/fy) t; else without t
//!   v = -p / |p|        orthographic: (0, 0, 1)
//!   colour = ambient s + sum over the lights, in order, of light colour times
//!              ((diffuse (n . l)) s + specular (r . v)^shininess)     r = n (2 (n . l)) - l
//! ```
//!
//! A light with n . l <= 0 adds nothing; a highlight needs r . v > 0. Without any light the colour is
//! s. An empty pixel is black.

use crate::frame::{Exec, Plane};
use crate::number::{Real, Vector3};
use crate::scene::{Light, Phong};
use crate::splat::View;

/// A light in view space.
#[derive(Clone, Copy, Debug)]
enum Placed<R> {
    /// The unit direction towards it.
    Towards(Vector3<R>),
    /// Its position.
    At(Vector3<R>),
}

/// Everything that the pixels share.
#[derive(Clone, Debug)]
pub struct Shader<R> {
    view: View<R>,
    lights: Vec<(Placed<R>, [R; 3])>,
    material: Phong,
}

impl<R: Real> Shader<R> {
    /// Places the lights before a camera.
    #[must_use]
    pub fn new(view: View<R>, lights: &[Light], material: Phong) -> Self {
        let place = |light: &Light| match *light {
            Light::Directional { towards, color } => {
                let towards = view.direction(Vector3::from_glam(towards)).normalized();
                (Placed::Towards(towards), color.to_array().map(R::from_f32))
            }
            Light::Headlight { towards, color } => {
                let towards = Vector3::from_glam(towards).normalized();
                (Placed::Towards(towards), color.to_array().map(R::from_f32))
            }
            Light::Point { position, color } => {
                let position = view.point(Vector3::from_glam(position));
                (Placed::At(position), color.to_array().map(R::from_f32))
            }
        };
        Self { view, lights: lights.iter().map(place).collect(), material }
    }

    /// Shades every pixel; `color` may be reused as the result.
    ///
    /// `depth` is +inf where a pixel is empty; only an unlit scene can do without normals.
    #[must_use]
    pub fn shade(
        &self,
        depth: &Plane<R>,
        normal: Option<&Plane<[R; 3]>>,
        color: Option<Plane<[R; 3]>>,
        exec: &Exec,
    ) -> Plane<[R; 3]> {
        let (width, height) = (depth.width(), depth.height());
        let own = self.material.color.to_array().map(R::from_f32);
        let mut shaded = color.unwrap_or_else(|| Plane::filled(width, height, own));
        let row = width as usize;
        let rows = shaded.values_mut().chunks_mut(row).enumerate().collect();
        exec.ordered(rows, |(y, pixels): (usize, &mut [[R; 3]])| {
            for (x, pixel) in pixels.iter_mut().enumerate() {
                let i = y * row + x;
                let [nx, ny, nz] = normal.map_or([R::ZERO; 3], |normal| normal.values()[i]);
                let normal = Vector3::new(nx, ny, nz);
                *pixel = self.pixel((x, y), depth.values()[i], normal, *pixel);
            }
        });
        shaded
    }

    /// The colour of one pixel at depth t, +inf if it is empty; see the module page. `surface` is s.
    pub(crate) fn pixel(
        &self,
        (x, y): (usize, usize),
        t: R,
        normal: Vector3<R>,
        surface: [R; 3],
    ) -> [R; 3] {
        if !t.is_finite() {
            return [R::ZERO; 3];
        }
        let view = &self.view;
        let px = (R::from_f32(x as f32 + 0.5) - view.cx) / view.fx;
        let py = -((R::from_f32(y as f32 + 0.5) - view.cy) / view.fy);
        let p = if view.perspective {
            Vector3::new(px * t, py * t, -t)
        } else {
            Vector3::new(px, py, -t)
        };
        self.lit(p, view.direction(normal), surface)
    }

    /// The colour of a surfel, shaded once at its centre: p is its position, n its normal, turned
    /// towards the side that is seen, both in world space.
    pub(crate) fn surfel(&self, p: Vector3<R>, n: Vector3<R>, surface: [R; 3]) -> [R; 3] {
        self.lit(self.view.point(p), self.view.direction(n), surface)
    }

    /// The colour of a point p with normal n, both in view space.
    fn lit(&self, p: Vector3<R>, n: Vector3<R>, surface: [R; 3]) -> [R; 3] {
        if self.lights.is_empty() {
            return surface;
        }
        let v = if self.view.perspective {
            (-p).normalized()
        } else {
            Vector3::new(R::ZERO, R::ZERO, R::ONE)
        };
        let [ambient, diffuse, specular, shininess] = [
            self.material.ambient,
            self.material.diffuse,
            self.material.specular,
            self.material.shininess,
        ]
        .map(R::from_f32);

        let mut color = surface.map(|s| ambient * s);
        for (place, light) in &self.lights {
            let l = match *place {
                Placed::Towards(l) => l,
                Placed::At(position) => (position - p).normalized(),
            };
            let cosine = n.dot(l);
            if cosine > R::ZERO {
                let r = n * (cosine + cosine) - l;
                let mirrored = r.dot(v);
                let highlight = if mirrored > R::ZERO && specular > R::ZERO {
                    specular * mirrored.pow(shininess)
                } else {
                    R::ZERO
                };
                for c in 0..3 {
                    color[c] = color[c] + light[c] * ((diffuse * cosine) * surface[c] + highlight);
                }
            }
        }
        color
    }
}
