//! Shade a picture with deferred Phong shading.
//!
//! In view space, for a pixel at depth t with normal n (turned from world to view space) and
//! surface colour s (the pixel's own, or the material's where the scene has no colours):
//!
//! ```text
//!   p = (x, y, -t)      perspective: x = ((X - cx)/fx) t, y = -((Y - cy)/fy) t; else without t
//!   v = -p / |p|        orthographic: (0, 0, 1)
//!   colour = ambient s + sum over the lights, in order, of light colour times
//!              ((diffuse (n . l)) s + specular (r . v)^shininess)     r = n (2 (n . l)) - l
//! ```
//!
//! l is a vector of view space:
//!
//! - for a directional light, its `towards`, turned to view space ([`View::direction`]) and then
//!   divided by its length;
//! - for a headlight, its `towards` divided by its length;
//! - for a point light, (q - p) divided by its length, with q its position in view space
//!   ([`View::point`]).
//!
//! v is divided by its length too. n, of length 1 in world space, is turned to view space and not
//! divided again. Lights are added in the order of the scene.
//!
//! A light with n . l <= 0 adds nothing; a highlight needs r . v > 0. Without any light the colour
//! is s. An empty pixel is black.
//!
//! # How tubes are shaded
//!
//! A pixel that has a tangent shows a tube: T is that tangent, turned from world to view space and
//! then divided by its length. The pixel's own normal is not used. Each light has its own normal:
//! the direction l towards the light, projected onto the plane orthogonal to the tangent \[MKC08,
//! section 4.2\]:
//!
//! ```text
//!   m     = l - T (l . T)
//!   n     = m / |m|
//!   n . l = |m|                  = sqrt(1 - (l . T)^2)
//! ```
//!
//! Where |m| is 0, because l is parallel to T or null, the light adds nothing. The pixel shows a
//! surface where T is the null vector: the tangent is null, or its length is 0 or not finite.
//!
//! - `Decided:` the highlight takes the same n; the paper leaves it open.
//! - `Decided:` n . l is computed as the length of m, which it is equal to. Where l is nearly
//!   parallel to T, n is the direction of a rounding error, and its dot product with l is anything
//!   up to 1.
//! - As in the paper, n always turns towards the light: a light behind the tube lights it too.

mod lanes;
#[cfg(test)]
mod tests;

use crate::frame::{Exec, Plane};
use crate::number::MapInline;
use crate::number::{Exact, Real, Truth, Vector3};
use crate::scene::{Light, Phong};
use crate::splat::View;
use glam::Vec3;

/// A light in view space.
#[derive(Clone, Copy, Debug)]
enum PlacedLight<R> {
    /// The unit direction towards the light.
    Towards(Vector3<R>),
    /// The position of the light.
    At(Vector3<R>),
}

impl<R: Real> PlacedLight<R> {
    /// l: the direction towards the light from p.
    #[inline(always)]
    fn from(&self, p: Vector3<R>) -> Vector3<R> {
        match *self {
            Self::Towards(l) => l,
            Self::At(position) => (position - p).normalized(),
        }
    }
}

/// Everything that the pixels share.
#[derive(Clone, Debug)]
pub struct Shader<R> {
    view: View<R>,
    lights: Vec<(PlacedLight<R>, [R; 3])>,
    material: Phong,
    /// Column and row, in the picture, of the first pixel of the planes that are shaded.
    first: [u32; 2],
}

impl<R: Real> Shader<R> {
    /// Places the lights in the view of a camera.
    #[must_use]
    pub fn new(view: View<R>, lights: &[Light], material: Phong) -> Self {
        // Adding 0 turns -0 into 0.
        let material = Phong { color: material.color + Vec3::ZERO, ..material };
        let radiance = |color: Vec3| (color + Vec3::ZERO).to_array().map_inline(R::from_f32);
        let place = |light: &Light| match *light {
            Light::Directional { towards, color } => {
                let towards = view.direction(Vector3::from_glam(towards)).normalized();
                (PlacedLight::Towards(towards), radiance(color))
            }
            Light::Headlight { towards, color } => {
                let towards = Vector3::from_glam(towards).normalized();
                (PlacedLight::Towards(towards), radiance(color))
            }
            Light::Point { position, color } => {
                let position = view.point(Vector3::from_glam(position));
                (PlacedLight::At(position), radiance(color))
            }
        };
        Self { view, lights: lights.iter().map(place).collect(), material, first: [0, 0] }
    }

    /// The same shader for planes that hold a part of the picture, from this column and row on.
    #[must_use]
    pub fn from_pixel(self, first: [u32; 2]) -> Self {
        Self { first, ..self }
    }

    /// The colour of a point p in view space; `towards` gives n and n . l for a direction l.
    #[inline(always)]
    fn lit(
        &self,
        p: Vector3<R>,
        towards: impl Fn(Vector3<R>) -> (Vector3<R>, R),
        surface: [R; 3],
    ) -> [R; 3] {
        if self.lights.is_empty() {
            return surface;
        }
        let v = self.towards_eye(p);
        let answer = Answer::<R>::new(&self.material);
        let [r, g, b] = surface;
        let mut color = [answer.ambient * r, answer.ambient * g, answer.ambient * b];
        for (place, light) in &self.lights {
            let l = place.from(p);
            let (n, cosine) = towards(l);
            let faces = cosine.gt(R::ZERO);
            // A light that is certainly behind the surface adds nothing, and its power is
            // expensive.
            if faces.possibly() {
                let mirrored = mirrored(n, cosine, l, v);
                let highlight = answer.highlight(cosine, mirrored);
                let more = answer.add(color, *light, cosine, surface, highlight);
                // Not by `map`, because it is not inlined where numbers are balls.
                let chosen = |c: usize| R::select(faces, more[c], color[c]);
                color = [chosen(0), chosen(1), chosen(2)];
            }
        }
        color
    }

    /// [`Shader::lit`] for a surface with this normal, or a tube with this tangent. Compiled once for all
    /// forms, because in balls it takes 40 kB.
    #[inline(never)]
    fn lit_once(
        &self,
        p: Vector3<R>,
        direction: Vector3<R>,
        is_tube: bool,
        surface: [R; 3],
    ) -> [R; 3] {
        let towards =
            |l| if is_tube { around(direction, l) } else { (direction, direction.dot(l)) };
        self.lit(p, towards, surface)
    }

    /// The colour of a surface at depth t of a pixel, whose normal is in world space. The pixel
    /// must not be empty.
    pub(crate) fn surface(
        &self,
        (x, y): (usize, usize),
        t: R,
        normal: Vector3<R>,
        surface: [R; 3],
    ) -> [R; 3] {
        let normal = self.view.direction(normal);
        self.lit_once(self.position(x, y, t), normal, false, surface)
    }

    /// The same for a tube; its tangent, in world space, must not be the null vector.
    pub(crate) fn tube(
        &self,
        (x, y): (usize, usize),
        t: R,
        tangent: Vector3<R>,
        surface: [R; 3],
    ) -> [R; 3] {
        let tangent = self.view.direction(tangent).normalized();
        self.lit_once(self.position(x, y, t), tangent, true, surface)
    }

    /// The colour of a surfel, shaded once at its centre. p is its position, and n its normal,
    /// turned towards the side that is seen; both are in world space.
    #[must_use]
    pub fn surfel(&self, p: Vector3<R>, n: Vector3<R>, surface: [R; 3]) -> [R; 3] {
        let normal = self.view.direction(n);
        self.lit_once(self.view.point(p), normal, false, surface)
    }

    /// Converts the shader to another arithmetic, for the same view.
    pub(crate) fn map<S: Real>(&self, view: View<S>, number: impl Fn(R) -> S) -> Shader<S> {
        let vector = |v: Vector3<R>| Vector3::new(number(v.x), number(v.y), number(v.z));
        let light = |(place, light): &(PlacedLight<R>, [R; 3])| {
            let place = match *place {
                PlacedLight::Towards(l) => PlacedLight::Towards(vector(l)),
                PlacedLight::At(position) => PlacedLight::At(vector(position)),
            };
            (place, light.map_inline(&number))
        };
        let lights = self.lights.iter().map(light).collect();
        Shader { view, lights, material: self.material, first: self.first }
    }

    /// The colour of surfaces in a scene without colours.
    pub(crate) fn plain(&self) -> [R; 3] {
        self.material.color.to_array().map_inline(R::from_f32)
    }

    /// p: the point at depth t of a pixel.
    #[inline(always)]
    fn position(&self, x: usize, y: usize, t: R) -> Vector3<R> {
        let view = &self.view;
        let px = (R::from_f32(x as f32 + 0.5) - view.cx) / view.fx;
        let py = -((R::from_f32(y as f32 + 0.5) - view.cy) / view.fy);
        if view.perspective { Vector3::new(px * t, py * t, -t) } else { Vector3::new(px, py, -t) }
    }

    /// v: the direction from p towards the eye.
    #[inline(always)]
    fn towards_eye(&self, p: Vector3<R>) -> Vector3<R> {
        if self.view.perspective {
            (-p).normalized()
        } else {
            Vector3::new(R::ZERO, R::ZERO, R::ONE)
        }
    }
}

impl<R: Exact> Shader<R> {
    /// Shades every pixel; `color` may be reused as the result.
    ///
    /// `depth` is +inf where a pixel is empty; only an unlit scene works without normals. `tangent`
    /// is the null vector where a pixel shows no tube.
    #[must_use]
    pub fn shade(
        &self,
        depth: &Plane<R>,
        normal: Option<&Plane<[R; 3]>>,
        tangent: Option<&Plane<[R; 3]>>,
        color: Option<Plane<[R; 3]>>,
        exec: &Exec,
    ) -> Plane<[R; 3]> {
        let (width, height) = (depth.width(), depth.height());
        let colored = color.is_some();
        let mut shaded = color.unwrap_or_else(|| Plane::filled(width, height, [R::ZERO; 3]));
        self.shade_over(depth, normal, tangent, &mut shaded, colored, exec);
        shaded
    }

    /// Shades in place: `pixels` hold the colours of the surfaces if `colored`, else anything.
    pub fn shade_over(
        &self,
        depth: &Plane<R>,
        normal: Option<&Plane<[R; 3]>>,
        tangent: Option<&Plane<[R; 3]>>,
        pixels: &mut Plane<[R; 3]>,
        colored: bool,
        exec: &Exec,
    ) {
        let own = (!colored).then(|| self.plain());
        let (row, [left, top]) = (depth.width() as usize, self.first.map_inline(|n| n as usize));
        exec.ordered(
            pixels.rows_mut().enumerate().collect(),
            |(y, pixels): (usize, &mut [[R; 3]])| {
                let depth = &depth.values()[y * row..][..row];
                let normal = normal.map(|plane| &plane.values()[y * row..][..row]);
                let tangent = tangent.map(|plane| &plane.values()[y * row..][..row]);
                let at = (left, top + y);
                lanes::shade(self, &lanes::ShadedRow { at, depth, normal, tangent, own }, pixels);
            },
        );
    }

    /// The colour of one pixel at depth t, +inf if it is empty; see the module page. `normal` and
    /// `tangent` are in world space, `surface` is s.
    pub(crate) fn pixel(
        &self,
        (x, y): (usize, usize),
        t: R,
        normal: Vector3<R>,
        tangent: Vector3<R>,
        surface: [R; 3],
    ) -> [R; 3] {
        if !t.is_finite() {
            return [R::ZERO; 3];
        }
        let form = self.form(normal, tangent);
        self.lit(self.position(x, y, t), |l| form.towards(l), surface)
    }

    /// The form with this normal and tangent in world space.
    #[inline(always)]
    fn form(&self, normal: Vector3<R>, tangent: Vector3<R>) -> Form<R> {
        let tangent = self.view.direction(tangent).normalized();
        Form { normal: self.view.direction(normal), tangent }
    }
}

/// The shape that the light falls on, in view space.
#[derive(Clone, Copy)]
struct Form<R> {
    /// n, for a surface.
    normal: Vector3<R>,
    /// T, for a tube; the null vector for a surface.
    tangent: Vector3<R>,
}

impl<R: Exact> Form<R> {
    /// n and n . l for the direction l towards a light.
    #[inline(always)]
    fn towards(&self, l: Vector3<R>) -> (Vector3<R>, R) {
        let Self { normal, tangent } = *self;
        if tangent == Vector3::ZERO { (normal, normal.dot(l)) } else { around(tangent, l) }
    }
}

/// n and n . l of a tube along T for the direction l towards a light.
#[inline(always)]
fn around<R: Real>(tangent: Vector3<R>, l: Vector3<R>) -> (Vector3<R>, R) {
    let across = l - tangent * l.dot(tangent);
    (across.normalized(), across.length())
}

/// r . v: how far the mirrored light points towards the eye.
#[inline(always)]
fn mirrored<R: Real>(n: Vector3<R>, cosine: R, l: Vector3<R>, v: Vector3<R>) -> R {
    (n * (cosine + cosine) - l).dot(v)
}

/// The material in the numbers of the arithmetic.
#[derive(Clone, Copy)]
struct Answer<R> {
    ambient: R,
    diffuse: R,
    specular: R,
    shininess: R,
}

impl<R: Real> Answer<R> {
    fn new(material: &Phong) -> Self {
        Self {
            ambient: R::from_f32(material.ambient),
            diffuse: R::from_f32(material.diffuse),
            specular: R::from_f32(material.specular),
            shininess: R::from_f32(material.shininess),
        }
    }

    /// specular (r . v)^shininess, if r . v is above 0 and the light, with this n . l, may add
    /// something.
    #[inline(always)]
    fn highlight(&self, cosine: R, mirrored: R) -> R {
        let shines = mirrored.gt(R::ZERO) & self.specular.gt(R::ZERO);
        if (shines & cosine.gt(R::ZERO)).possibly() {
            let power = mirrored.at_least(R::ZERO).pow(self.shininess);
            R::select(shines, self.specular * power, R::ZERO)
        } else {
            R::ZERO
        }
    }

    /// Adds the light of one lamp to a colour.
    #[inline(always)]
    fn add(
        &self,
        color: [R; 3],
        light: [R; 3],
        cosine: R,
        surface: [R; 3],
        highlight: R,
    ) -> [R; 3] {
        let body = self.diffuse * cosine;
        // Not a closure, because a closure would not be inlined where numbers are balls.
        [
            color[0] + light[0] * (body * surface[0] + highlight),
            color[1] + light[1] * (body * surface[1] + highlight),
            color[2] + light[2] * (body * surface[2] + highlight),
        ]
    }
}
