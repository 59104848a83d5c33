//! Fragments and bounds at the near plane.

use super::{Disc, Fate, Footprint, Kernel, Projector, Shared, View, fragment, project};
use crate::composite::decide;
use crate::number::random::unit;
use crate::number::{Exact, Vector2, Vector3};
use crate::scene::{Camera, Cloud, Lens, Pose, Surfels};
use glam::{DVec3, Vec3};

/// Discs turned into ellipses of 1.5 times their radius and half of it; the half axes are not
/// perpendicular.
pub(crate) fn ellipses(discs: Surfels) -> Surfels {
    let halves = |(normal, radius): (&Vec3, &f32)| {
        let u = normal.any_orthonormal_vector();
        [u * (1.5 * radius), (normal.cross(u) * 0.5 + u * 0.25) * *radius]
    };
    let tangents = discs.normal().iter().zip(discs.radius()).map(halves).collect();
    Surfels::new(Cloud { tangents: Some(tangents), ..discs.into_cloud() }).unwrap().0
}

/// A camera at the origin that looks down -z.
fn camera(near: f32, lens: Lens) -> Camera {
    let pose = Pose { eye: DVec3::ZERO, target: -DVec3::Z, up: DVec3::Y };
    Camera { near, ..Camera::new(32, 24, pose, lens).unwrap() }
}

/// q of a ray-cast fragment, half a pixel beside the centre, whose plane has nearness `w` there.
fn q_at<R: Exact>(camera: &Camera, w: R) -> R {
    let (one, zero) = (R::ONE, R::ZERO);
    let center = Vector2::new(zero, zero);
    let (slopes, range) = ([zero; 2], [w; 2]);
    let footprint = Footprint {
        center,
        ux: one,
        uy: zero,
        vy: one,
        w0: w,
        wx: slopes[0],
        wy: slopes[1],
        w_far: range[0],
        w_near: range[1],
        amplitude: one,
    };
    let shared = Shared::new(&View::new(camera), &Kernel::ZP06);
    footprint.fragment(&shared, R::from_f32(0.5), zero).0
}

/// A fragment exactly at the near plane is kept, and the next nearer one is not: 0 < w <= 1/near,
/// or w <= -near under an orthographic camera.
#[test]
fn a_ray_meets_a_disc_at_the_near_plane_and_not_before() {
    let perspective = camera(0.25, Lens::Focal(32.0));
    let quarter = 0.25_f32; // 1/2 squared
    let below = 4.0_f32.next_down();
    assert_eq!(q_at(&perspective, 4.0_f32), quarter / 16.0, "at the near plane");
    assert_eq!(q_at(&perspective, below), quarter / (below * below));
    assert_eq!(q_at(&perspective, 4.0_f32.next_up()), f32::INFINITY, "before the near plane");
    assert_eq!(q_at(&perspective, 4.0_f64), 0.25 / 16.0);
    assert_eq!(q_at(&perspective, 4.0_f64.next_up()), f64::INFINITY);
    for behind in [0.0, -0.0, -1.0] {
        assert_eq!(q_at(&perspective, behind), f32::INFINITY, "behind the eye");
    }
    let orthographic = camera(0.25, Lens::Orthographic(1.0));
    assert_eq!(q_at(&orthographic, -0.25_f32), quarter, "at the near plane");
    assert_eq!(q_at(&orthographic, (-0.25_f32).next_up()), f32::INFINITY, "before the near plane");
    let behind = Camera { near: -0.25, ..orthographic };
    assert_eq!(q_at(&behind, 0.25_f32), quarter, "an orthographic camera sees what is behind it");
}

/// Disc `i` of a list: large, with a point of its rim in the picture, not far beyond the near
/// plane. Some lie nearly in the plane x = 0, so that their box is narrow.
fn rim_at_the_near_plane(i: u64, narrow: bool) -> (Camera, Disc<f32>) {
    let u = |k: u64| unit(if narrow { 9 } else { 5 }, 16 * i + k);
    let ten = |exponent: f32| crate::number::elementary::pow(10.0, f64::from(exponent));
    let (near, focal) =
        (ten(-3.0 + 3.0 * u(0)) as f32, ten(1.0 + if narrow { 3.0 } else { 2.0 } * u(1)));
    let radius = near * ten(if narrow { 3.0 + 5.0 * u(2) } else { 7.0 * u(2) }) as f32;
    let small = |k: u64| (u(k) - 0.5) * ten(-7.0 * u(k + 1)) as f32;
    let normal = if narrow {
        Vec3::new(1.0, small(3), small(5))
    } else {
        Vec3::new(u(3) - 0.5, u(4) - 0.5, (u(5) - 0.5) * if u(6) < 0.5 { 1.0 } else { 1e-3 })
    };
    let normal = normal.normalize();
    let t = near * (1.0 + 3.0 * u(7) * u(8));
    let [x, y] = [(u(9) - 0.5) * 32.0, (u(10) - 0.5) * 24.0].map(|side| side / focal as f32 * t);
    let along = normal.cross(Vec3::new(u(11) - 0.5, u(12) - 0.5, u(13) - 0.5)).normalize();
    let inwards = if along.z > 0.0 { -along } else { along };
    let disc = Disc {
        position: Vector3::from_glam(Vec3::new(x, y, -t) + inwards * radius),
        normal: Vector3::from_glam(normal),
        radius,
        tangents: None,
    };
    (camera(near, Lens::Focal(focal)), disc)
}

/// Counts the inside pixels of a disc that reaches the near plane, in and out of the bounds.
fn inside(camera: &Camera, disc: &Disc<f32>) -> [u32; 2] {
    let (view, kernel) = (View::<f32>::new(camera), Kernel::ZP06);
    let (shared, projector) = (Shared::new(&view, &kernel), Projector::new(view, &kernel, false));
    let (splat, reasons) = project(&projector, disc, 0);
    let mut counts = [0; 2];
    if !projector.crosses(disc) || !matches!(reasons.fate(), Fate::Visible | Fate::Outside) {
        return counts;
    }
    for (x, y) in (0..24).flat_map(|y| (0..32).map(move |x| (x, y))) {
        let (q, _) = fragment(&shared, &splat.footprint, (x, y));
        if decide::inside(q, shared.limit) {
            let held = reasons.fate() == Fate::Visible && splat.bounds.contains(x, y);
            counts[usize::from(!held)] += 1;
        }
    }
    counts
}

/// Discs that lose pixels if their box is not widened by a thousandth of its size.
const WIDE: [u64; 8] = [15, 498, 761, 1354, 1754, 1880, 4216, 4280];

/// Discs that lose pixels if their box is not widened by the magnified rounding of the radius.
const NARROW: [u64; 6] = [1567, 2839, 2973, 3998, 4704, 7062];

/// Shows why [`super::crossing`] widens its box: the points that define it carry roundings that the
/// near plane magnifies. Without the widening these discs lose pixels.
#[test]
fn bounds_at_the_near_plane_are_wide_enough_for_their_roundings() {
    for (narrow, lost_without) in [(false, &WIDE[..]), (true, &NARROW[..])] {
        for i in lost_without.iter().copied().chain(0..50) {
            let (camera, disc) = rim_at_the_near_plane(i, narrow);
            let [held, lost] = inside(&camera, &disc);
            assert_eq!(lost, 0, "disc {i} loses {lost} of its pixels and keeps {held}");
            assert!(held > 0 || !lost_without.contains(&i), "disc {i} covers nothing");
        }
    }
}

/// A disc and its camera in another unit of length.
fn in_unit((camera, disc): &(Camera, Disc<f32>), unit: f32) -> (Camera, Disc<f32>) {
    let Vector3 { x, y, z } = disc.position;
    let position = Vector3::new(x * unit, y * unit, z * unit);
    let disc = Disc { position, radius: disc.radius * unit, ..*disc };
    (Camera { near: camera.near * unit, ..*camera }, disc)
}

/// Bounds at the near plane do not depend on the unit of length. Powers of two change no bit; other
/// units may lose none of the pixels either.
#[test]
fn bounds_at_the_near_plane_hold_in_every_unit() {
    let power = |exponent: i32| f32::from_bits(((127 + exponent) as u32) << 23);
    for i in WIDE.into_iter().chain(0..200) {
        let own = rim_at_the_near_plane(i, false);
        let held = inside(&own.0, &own.1);
        for exponent in [-40, -20, 20, 33, 45] {
            let (camera, disc) = in_unit(&own, power(exponent));
            assert_eq!(inside(&camera, &disc), held, "disc {i} in units of 2^{exponent}");
        }
        for unit in [1e-12, 1e-10, 1e10, 1e12] {
            let (camera, disc) = in_unit(&own, unit);
            let [_, lost] = inside(&camera, &disc);
            assert_eq!(lost, 0, "disc {i} in units of {unit:e} loses {lost} of its pixels");
        }
    }
}
