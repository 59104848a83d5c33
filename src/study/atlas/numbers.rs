//! Entries about formulas that lose digits and bounds that are too small. Their errors do not come
//! from a method's picture.

use super::case::both;
use super::{Failure, Found};
use crate::error::{Error, Result};
use crate::frame::{Exec, Plane, Rect};
use crate::number::elementary::{cos, sin, tan};
use crate::number::{Exact, Real, Vector3};
use crate::scene::{Camera, Lens, Pose};
use crate::splat::{Disc, Fate, Kernel, Outline, Projector, Splat, View, project};
use glam::DVec3;

pub(super) const FAILURES: [Failure; 3] = [
    Failure {
        id: "ewa-thin",
        title: "The determinant of a thin ellipse cancels",
        why: "A disc is seen nearly edge-on, turned by 45 degrees. Its covariance with the \
              low-pass filter is [[a, b], [b, c]], and the textbook computes q = (c dx^2 - 2 b dx \
              dy + a dy^2) / (a c - b^2). Where the ellipse is long and thin, a c and b^2 agree in \
              more and more digits of f32. The error is the largest error of q at 64 points of the \
              ellipse, as a fraction of the textbook's q in f64. Pictures: the ellipse stretched \
              to a circle, light where q is right to 0.001 and red where it is not; around the \
              ellipse, blue and black.",
        swept: "radius, px",
        values: &[1.0, 4.0, 16.0, 64.0, 256.0, 1024.0, 4096.0],
        error: "relative error of q",
        limit: 0.001,
        cure: "q as splatref writes it, without that difference; see `splat::Footprint`",
        at: thin,
    },
    Failure {
        id: "bounds",
        title: "A square of the projected radius does not hold the disc",
        why: "A disc is tilted by 45 degrees, 20 degrees off the axis. [BHZK05, 3] gives a point \
              sprite the square of side 2 r f / t around its centre. That square fits a disc at \
              the centre's depth that faces the camera, but the near half of a tilted disc \
              projects to a greater length. Pictures: the disc is light inside the square and red \
              outside; blue is the rest of the square.",
        swept: "distance, radii",
        values: &[64.0, 32.0, 16.0, 8.0, 4.0, 2.0, 1.5, 1.25],
        error: "pixels of the disc outside, per mille",
        limit: 10.0,
        cure: "bounds of the projected outline, which splatref guarantees; see `splat::bounds`",
        at: bounds,
    },
    Failure {
        id: "bounds-angle",
        title: "Off the axis that square falls short even of a disc that faces the eye",
        why: "A disc at a depth of four radii turns its normal towards the eye, and moves farther \
              and farther off the axis of a fixed picture plane. Off the axis a length projects to \
              more than r f / t. Pictures: as for bounds.",
        swept: "angle to the axis, degrees",
        values: &[0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0],
        error: "pixels of the disc outside, per mille",
        limit: 10.0,
        cure: "bounds of the projected outline, which splatref guarantees; see `splat::bounds`",
        at: bounds_off_axis,
    },
];

/// The tangent of the angle between the view and the thin disc's plane.
const THIN: f64 = 1.0 / 1024.0;

fn thin(radius: f64, _: &Exec) -> Result<[Found; 2]> {
    both(|cured| edge_on(radius, cured))
}

/// A thin ellipse, with the crate's q or the textbook's.
fn edge_on(radius: f64, cured: bool) -> Result<Found> {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let long = 1.0 / (1.0 + THIN * THIN).sqrt();
    // Seen along -z: half axes r (1, 1) / sqrt 2 and r THIN (1, -1) / sqrt 2.
    let normal = DVec3::new(half * long, -half * long, THIN * long);
    let side = f64::from(SIDE);
    let pose = Pose { eye: DVec3::Z * 1e4, target: DVec3::ZERO, up: DVec3::Y };
    let camera = Camera::new(SIDE, SIDE, pose, Lens::Orthographic(side))?;
    // A disc of radius r has variance r^2, as in the textbook.
    let kernel = Kernel { cutoff: 1.0, ..Kernel::DEFAULT };
    let splat = splat::<f32>(&camera, &kernel, DVec3::ZERO, normal, radius)?.footprint;
    let low_pass = f64::from(kernel.low_pass);
    let [longer, shorter] = [radius, radius * THIN * long].map(|r| (r * r + low_pass).sqrt());
    // q at a point of the ellipse's axes, in f32 and in f64, at the same point in f32.
    let both = |u: f64, v: f64| {
        let (u, v) = (longer * u * half, shorter * v * half);
        let (dx, dy) = ((u + v) as f32, (u - v) as f32);
        let axes = [radius * half, radius * half * THIN * long].map(|v| v as f32);
        let double = textbook(axes.map(f64::from), low_pass, [dx.into(), dy.into()]);
        // y points down in the raster.
        let single =
            if cured { splat.form(dx, -dy) } else { textbook(axes, kernel.low_pass, [dx, dy]) };
        [single.into(), double]
    };
    let error = |[single, double]: [f64; 2]| ((single - double) / double).abs();
    let errors = (0..64).map(|i| {
        let angle = std::f64::consts::TAU * f64::from(i) / 64.0;
        error(both(cos(angle), sin(angle)))
    });
    // NaN counts as the largest error.
    let known = errors.map(|error| if error.is_nan() { f64::INFINITY } else { error });
    let picture = Plane::from_values(
        SEEN,
        SEEN,
        (0..SEEN * SEEN)
            .map(|i| {
                let [u, v] = [i % SEEN, i / SEEN]
                    .map(|k| 3.0 * (f64::from(k) + 0.5) / f64::from(SEEN) - 1.5);
                let both = both(u, v);
                shown(both[1] <= 1.0, error(both) <= 0.001)
            })
            .collect(),
    );
    Ok(Found { error: known.fold(0.0, Real::at_least), picture, time: None })
}

/// The side of the picture of the thin ellipse, stretched to a circle.
const SEEN: u32 = 180;

/// q from the determinant of the covariance with the half axes a (1, 1) and b (1, -1) and the
/// low-pass filter.
fn textbook<R: Real>([a, b]: [R; 2], low_pass: R, [dx, dy]: [R; 2]) -> R {
    let square = a * a + b * b;
    let (diagonal, across) = (square + low_pass, a * a - b * b);
    let determinant = diagonal * diagonal - across * across;
    let two = R::ONE + R::ONE;
    (diagonal * dx * dx - two * across * dx * dy + diagonal * dy * dy) / determinant
}

const SIDE: u32 = 512;

fn splat<R: Exact>(
    camera: &Camera,
    kernel: &Kernel,
    position: DVec3,
    normal: DVec3,
    radius: f64,
) -> Result<Splat<R>> {
    let three = |v: DVec3| Vector3::from_glam(v.as_vec3());
    let disc = Disc {
        position: three(position),
        normal: three(normal),
        radius: R::from_f32(radius as f32),
        tangents: None,
    };
    let (splat, reasons) = project(&Projector::new(View::new(camera), kernel, false), &disc, 0);
    match reasons.fate() {
        Fate::Visible => Ok(splat),
        fate => Err(Error::Invalid(format!("the disc is not drawn: {fate:?}"))),
    }
}

/// The disc in front of a camera whose picture contains it.
fn bounds(distance: f64, _: &Exec) -> Result<[Found; 2]> {
    // The disc fills about half the picture, wherever it is.
    let focal = 0.25 * f64::from(SIDE) * distance;
    let camera = ahead(SIDE, focal.at_most(0.25 * f64::from(SIDE) * 4.0))?;
    Ok(beyond_the_square(&camera, distance, tilted(distance, DVec3::X)))
}

/// A disc at a depth of four radii that faces the eye, at an angle to the axis, in the middle of the picture.
fn bounds_off_axis(degrees: f64, _: &Exec) -> Result<[Found; 2]> {
    const DISTANCE: f64 = 4.0;
    let camera = ahead(SIDE, f64::from(SIDE) / 2.0)?;
    let away = degrees.to_radians();
    let cx = camera.cx - (f64::from(camera.fx) * tan(away)) as f32;
    let center = DVec3::new(DISTANCE * tan(away), 0.0, -DISTANCE);
    let normal = DVec3::new(-sin(away), 0.0, cos(away));
    let camera = Camera { cx, ..camera };
    Ok(beyond_the_square(&camera, DISTANCE, Facing { center, normal }))
}

/// The pixels of a disc of radius 1 at a depth that lie outside the square, and with the cure
/// outside the bounds, per mille.
fn beyond_the_square(camera: &Camera, distance: f64, disc: Facing) -> [Found; 2] {
    let focal = f64::from(camera.fx);
    let middle = DVec3::new(disc.center.x, disc.center.y, 0.0) * focal / distance;
    let reach = focal / distance;
    let rect = visible(camera, disc);
    let square = |x, y| {
        let [px, py] = from_the_axis(camera, [x, y]);
        (px - middle.x).abs() <= reach && (py + middle.y).abs() <= reach
    };
    [
        outside(camera, disc, square),
        outside(camera, disc, |x, y| rect.is_some_and(|rect| rect.contains(x, y))),
    ]
}

/// The distance of a pixel's middle from the axis, in pixels.
fn from_the_axis(camera: &Camera, at: [u32; 2]) -> [f64; 2] {
    let [x, y] = at.map(|v| f64::from(v) + 0.5);
    [x - f64::from(camera.cx), y - f64::from(camera.cy)]
}

/// A camera at the origin that looks along -z, with a square picture.
pub(super) fn ahead(side: u32, focal: f64) -> Result<Camera> {
    let pose = Pose { eye: DVec3::ZERO, target: -DVec3::Z, up: DVec3::Y };
    Camera::new(side, side, pose, Lens::Focal(focal))
}

/// A disc of radius 1: its centre, and the way it faces.
#[derive(Clone, Copy)]
pub(super) struct Facing {
    pub(super) center: DVec3,
    pub(super) normal: DVec3,
}

/// The centre and the normal of a disc of radius 1 in front of [`ahead`], tilted by 45 degrees and
/// 20 degrees off the axis; both point away from the axis in the same direction.
pub(super) fn tilted(distance: f64, side: DVec3) -> Facing {
    let (away, tilt) = (20_f64.to_radians(), 45_f64.to_radians());
    Facing {
        center: side * (distance * tan(away)) - DVec3::Z * distance,
        normal: side * sin(tilt) + DVec3::Z * cos(tilt),
    }
}

/// The crate's bounds of a disc of radius 1; `None` if it is not drawn.
pub(super) fn visible(camera: &Camera, Facing { center, normal }: Facing) -> Option<Rect> {
    let kernel = Kernel { outline: Outline::RayCast, low_pass: 0.0, cutoff: 1.0 };
    splat::<f32>(camera, &kernel, center, normal, 1.0).ok().map(|splat| splat.bounds)
}

/// How much of a disc of radius 1 is outside, per mille of its pixels in a picture, with a picture
/// of which.
pub(super) fn outside(
    camera: &Camera,
    Facing { center, normal }: Facing,
    held: impl Fn(u32, u32) -> bool,
) -> Found {
    let (side, focal) = (camera.width, f64::from(camera.fx));
    let (mut inside, mut outside) = (0_u32, 0_u32);
    let mut picture = Plane::filled(side, side, [0.0; 3]);
    for (i, pixel) in (0..).zip(picture.values_mut()) {
        let (x, y) = (i % side, i / side);
        let [px, py] = from_the_axis(camera, [x, y]);
        let ray = DVec3::new(px / focal, -py / focal, -1.0);
        let t = center.dot(normal) / ray.dot(normal);
        let (disc, held) = (t > 0.0 && (ray * t - center).length() <= 1.0, held(x, y));
        inside += u32::from(disc);
        outside += u32::from(disc && !held);
        *pixel = shown(disc, held);
    }
    let error = 1e3 * f64::from(outside) / f64::from(inside.max(1));
    Found { error, picture, time: None }
}

/// The colour of a pixel: light where the disc is found, red where it is missed, blue beside it.
pub(super) fn shown(disc: bool, found: bool) -> [f32; 3] {
    match (disc, found) {
        (true, true) => [0.75, 0.75, 0.75],
        (true, false) => [0.75, 0.0625, 0.0625],
        (false, true) => [0.0625, 0.125, 0.5],
        (false, false) => [0.0; 3],
    }
}
