//! Problems for the formulas of a splat and a fragment.

use super::{Ball, Profile};
use crate::number::random::{bits, unit};
use crate::number::{Real, Truth, Vector3};
use crate::scene::{Camera, Lens, Light, Phong, Pose};
use crate::shade::phong::Shader;
use crate::splat::project::project_as;
use crate::splat::{Disc, Footprint, Kernel, Outline, Projector, Shared, View, fragment};
use glam::Vec3;

/// The quantities that are evaluated: the projection and a fragment from the scene, and the
/// fragment from the client's own record.
pub(super) const QUANTITIES: [&str; 20] = [
    "shaded colour",
    "center.x",
    "center.y",
    "ux",
    "uy",
    "vy",
    "w0",
    "wx",
    "wy",
    "w_far",
    "w_near",
    "amplitude",
    "q",
    "w",
    "t",
    "weight",
    "own q",
    "own w",
    "own t",
    "own weight",
];

/// Where the surfels are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    /// Surfels of 0.5 to 50 px at depths of 0.2 to 20, facing anywhere.
    Random,
    /// Within 0.1 to 0.00001 of edge-on.
    EdgeOn,
    /// At the near plane.
    Near,
    /// With depths by ray casting.
    RayCast,
    /// Without low-pass filter, by the exact outline.
    NoFilter,
    /// A thousand units from the origin.
    Far,
    /// Ellipses.
    Ellipse,
    /// Numbers that are 0, denormal or huge, under an orthographic camera or a perspective one.
    Extreme,
}

pub(super) const KINDS: [Kind; 8] = [
    Kind::Random,
    Kind::EdgeOn,
    Kind::Near,
    Kind::RayCast,
    Kind::NoFilter,
    Kind::Far,
    Kind::Ellipse,
    Kind::Extreme,
];

/// A surfel, a camera, and pixels.
pub(super) struct Problem {
    pub(super) index: u64,
    camera: Camera,
    kernel: Kernel,
    disc: Disc<f32>,
    /// How far away the surfel is.
    depth: f32,
    /// Where the pixels are, in extents of the splat about its centre.
    offsets: [[f32; 2]; PIXELS],
}

/// Pixels of a problem.
const PIXELS: usize = 8;
/// How many of the quantities belong to the splat; the others belong to each pixel.
const OF_SPLAT: usize = 12;

/// The index in [`QUANTITIES`] for this value.
pub(super) fn quantity(value: usize) -> usize {
    let of_pixel = QUANTITIES.len() - OF_SPLAT;
    if value < OF_SPLAT { value } else { OF_SPLAT + (value - OF_SPLAT) % of_pixel }
}

/// How many values a problem has.
pub(super) const VALUES: usize = OF_SPLAT + PIXELS * (QUANTITIES.len() - OF_SPLAT);

/// What evaluating in one number gave.
pub(super) struct Quantities<R> {
    pub(super) values: Vec<R>,
    /// Whether the disc reaches the near plane.
    pub(super) crosses: bool,
}

/// Two numbers: of any exponent, or near each other.
pub(super) fn operands(index: u64) -> [f32; 2] {
    let any = |part: u64| {
        let value = f32::from_bits(bits(8 + part, index) as u32);
        if value.is_finite() { value } else { unit(20 + part, index) }
    };
    let near = |part: u64| 1.0 + unit(30 + part, index);
    if index.is_multiple_of(2) { [any(0), any(1)] } else { [near(0), near(1)] }
}

/// A number whose logarithm is uniform.
fn log(random: f32, low: f32, high: f32) -> f32 {
    (f64::from(low) * (f64::from(high) / f64::from(low)).pow(random.into())) as f32
}

fn camera(pose: [Vec3; 3], lens: Lens) -> Camera {
    let [eye, target, up] = pose.map(Vec3::as_dvec3);
    Camera::new(512, 512, Pose { eye, target, up }, lens).expect("a camera")
}

fn kernel(kind: Kind) -> Kernel {
    match kind {
        Kind::RayCast => Kernel { outline: Outline::RayCast, ..Kernel::DEFAULT },
        Kind::NoFilter => {
            Kernel { outline: Outline::Perspective, low_pass: 0.0, ..Kernel::DEFAULT }
        }
        _ => Kernel::DEFAULT,
    }
}

impl Problem {
    pub(super) fn new(kind: Kind, seed: u64, index: u64) -> Self {
        let mut next = 0;
        let mut random = || {
            next += 1;
            unit(bits(seed, kind as u64), 64 * index + next)
        };
        let mut direction = || {
            let v = Vec3::new(random() - 0.5, random() - 0.5, random() - 0.5);
            v.try_normalize().unwrap_or(Vec3::Z)
        };
        let home = if kind == Kind::Far { 577.0 } else { 1.0 };
        let eye = Vec3::splat(home) + direction();
        let (forward, normal, tangent) = (direction(), direction(), direction());
        let up = if forward.y.abs() > 0.9 { Vec3::X } else { Vec3::Y };
        let extreme = kind == Kind::Extreme;
        let lens = if extreme && random() < 0.5 {
            Lens::Orthographic(log(random(), 1e-3, 1e3).into())
        } else {
            Lens::FieldOfView(f64::from(20.0 + 80.0 * random()))
        };
        let camera = camera([eye, eye + forward, up], lens);
        let depth = match kind {
            Kind::Near => camera.near * log(random(), 0.99, 1.5),
            _ => log(random(), 0.2, 20.0),
        };
        let size = log(random(), 0.5, 50.0) / 512.0 * depth;
        let side = forward.cross(up).normalize();
        let across = (random() - 0.5) * side + (random() - 0.5) * side.cross(forward);
        let position = eye + depth * (forward + across);
        let normal = if kind == Kind::EdgeOn {
            let ray = (position - eye).normalize();
            let edge = ray.any_orthonormal_vector();
            (edge + log(random(), 1e-5, 1e-1) * normal).normalize()
        } else {
            normal
        };
        let u = normal.cross(tangent).normalize_or(normal.any_orthonormal_vector());
        let tangents = (kind == Kind::Ellipse).then(|| {
            [u * size, normal.cross(u) * (size * log(random(), 1e-3, 1.0))].map(Vector3::from_glam)
        });
        let mut odd = |value: f32| match (extreme, (random() * 12.0) as u32) {
            (true, 0) => 0.0,
            (true, 1) => f32::from_bits((random() * 1e6) as u32),
            (true, 2) => value * 1e18,
            (true, 3) => value * 1e-18,
            _ => value,
        };
        let disc = Disc {
            position: Vector3::from_glam(position.map(&mut odd)),
            normal: Vector3::from_glam(normal.map(&mut odd)),
            radius: odd(size),
            tangents,
        };
        let offsets = [(); PIXELS].map(|()| [random(), random()].map(|random| 2.0 * random - 1.0));
        Self { index, camera, kernel: kernel(kind), disc, depth, offsets }
    }

    /// Evaluates everything in a number whose comparisons are all decided, and the record it
    /// stores.
    pub(super) fn evaluate<R: Real<Truth = bool>>(&self) -> (Quantities<R>, Footprint<f32>) {
        let crosses = self.projector::<R>().crosses(&self.disc());
        let footprint = self.footprint::<R>(crosses);
        let record = footprint.map(R::to_f32);
        let values = self.values(&footprint, &record.map(R::from_f32));
        (Quantities { values, crosses }, record)
    }

    /// Evaluates everything in balls, the last part from a client's record.
    pub(super) fn judge<P: Profile>(
        &self,
        crosses: bool,
        record: &Footprint<f32>,
    ) -> Quantities<Ball<P>> {
        let values = self.values::<Ball<P>>(&self.footprint(crosses), &record.map(Ball::from_f32));
        let may_cross = self.projector::<Ball<P>>().crosses(&self.disc());
        assert!(if crosses { may_cross.possibly() } else { !may_cross.certainly() }, "crosses");
        Quantities { values, crosses }
    }

    fn projector<R: Real>(&self) -> Projector<R> {
        Projector::new(View::new(&self.camera), &self.kernel, false)
    }

    fn disc<R: Real>(&self) -> Disc<R> {
        let Disc { position, normal, radius, tangents } = self.disc;
        let own = |v: Vector3<f32>| v.map(R::from_f32);
        Disc {
            position: own(position),
            normal: own(normal),
            radius: R::from_f32(radius),
            tangents: tangents.map(|pair| pair.map(own)),
        }
    }

    fn footprint<R: Real>(&self, crosses: bool) -> Footprint<R> {
        project_as(&self.projector(), &self.disc(), 0, crosses).0.footprint
    }

    /// The quantities of a footprint from the scene, and of the client's own footprint.
    fn values<R: Real>(&self, f: &Footprint<R>, own: &Footprint<R>) -> Vec<R> {
        let shared = Shared::new(&View::new(&self.camera), &self.kernel);
        let mut values = Vec::with_capacity(VALUES);
        values.push(self.shaded());
        values.extend([f.center.x, f.center.y, f.ux, f.uy, f.vy, f.w0, f.wx, f.wy, f.w_far]);
        values.extend([f.w_near, f.amplitude]);
        for pixel in self.pixels() {
            for footprint in [f, own] {
                let (q, w) = fragment(&shared, footprint, pixel);
                values.extend([q, w, shared.depth(w), footprint.weight(q)]);
            }
        }
        values
    }

    /// A colour under all kinds of lights, from a client's depth and normal.
    fn shaded<R: Real>(&self) -> R {
        let color = Vec3::new(0.75, 0.5, 0.25);
        let towards = Vec3::new(0.25, -0.5, 1.0);
        let lights = [
            Light::Headlight { towards, color },
            Light::Directional { towards, color },
            Light::Point { position: 3.0 * towards, color },
        ];
        let material = Phong { specular: 0.5, shininess: 20.5, ..Phong::default() };
        let shader = Shader::new(View::new(&self.camera), &lights, material);
        let [x, y] = self.offsets[0].map(|offset| (200.0 + 100.0 * offset) as usize);
        let depth = R::from_f32(self.depth);
        shader.surface((x, y), depth, self.disc().normal, [R::ONE; 3])[0]
    }

    /// Pixels in the ellipse, or near it, chosen in `f64`: the same for every number.
    fn pixels(&self) -> [(u32, u32); PIXELS] {
        let f = self.footprint::<f64>(false);
        let at = |position: f64| position.clamped(0.0, 65_535.0) as u32;
        self.offsets.map(|offset| {
            let [u, v] = offset.map(|offset| 2.2 * f64::from(offset));
            let dy = v / f.vy;
            let dx = (u - f.uy * dy) / f.ux;
            (at(f.center.x + dx), at(f.center.y + dy))
        })
    }
}
