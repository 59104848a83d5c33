//! The bounds of a splat are a guarantee: no pixel of the picture outside them is inside the splat.
//!
//! This is a property of the crate's own numbers, in each arithmetic; only the test of tightness
//! takes extents from the oracle.

use crate::oracle::ewa::splat::{Body, Figure, Optics};
use crate::oracle::kit::eye::{Eye, wide};
use crate::oracle::kit::scene::{OUTLINES, discs, near, surfels};
use glam::Vec3;
use proptest::prelude::*;
use splatref::method::ewa::Settings;
use splatref::number::{Exact, Vector3};
use splatref::scene::Camera;
use splatref::splat::Disc;
use splatref::splat::{Fate, Kernel, Outline, Projector, View, project};

/// A surfel in view space before any number type.
#[derive(Clone, Debug)]
struct Given {
    position: Vec3,
    normal: Vec3,
    radius: f32,
    tangents: Option<[Vec3; 2]>,
}

impl Given {
    fn disc<R: Exact>(&self) -> Disc<R> {
        Disc {
            position: Vector3::from_glam(self.position),
            normal: Vector3::from_glam(self.normal),
            radius: R::from_f32(self.radius),
            tangents: self.tangents.map(|pair| pair.map(Vector3::from_glam)),
        }
    }
}

/// A float a few ulp from a given one.
fn near_to(value: f32) -> impl Strategy<Value = f32> {
    (-3_i32..=3).prop_map(move |ulps| f32::from_bits((value.to_bits() as i32 + ulps) as u32))
}

fn normal() -> impl Strategy<Value = Vec3> {
    let part = || prop_oneof![4 => -1.0_f32..1.0, 1 => -1e-4_f32..1e-4, 1 => Just(0.0_f32)];
    (part(), part(), part()).prop_filter_map("a direction", |(x, y, z)| {
        let v = Vec3::new(x, y, z);
        (v.length() > 1e-6).then(|| v.normalize())
    })
}

fn given() -> impl Strategy<Value = Given> {
    let across = || prop_oneof![4 => -3.0_f32..3.0, 1 => near_to(1.0), 1 => Just(0.0_f32), 1 => -300.0_f32..300.0];
    let depth =
        prop_oneof![4 => 0.07_f32..8.0, 1 => near_to(0.0625), 1 => near_to(2.0), 1 => 1.0_f32..1e5];
    // Powers of ten, and the radii that just reach the near plane.
    let radius = prop_oneof![
        4 => (-1.5_f32..0.5).prop_map(|e| 10.0_f32.powf(e)),
        1 => (-14.0_f32..7.0).prop_map(|e| 10.0_f32.powf(e)),
        1 => near_to(1.9375),
    ];
    let ellipse = prop_oneof![3 => Just(None), 1 => (0.0_f32..7.0, 0.0_f32..4.0).prop_map(Some)];
    let place = (across(), across(), depth);
    (place, normal(), radius, ellipse).prop_map(|((x, y, t), normal, radius, ellipse)| {
        let tangents = ellipse.map(|(angle, thin)| {
            let helper = if normal.x.abs() < 0.6 { Vec3::X } else { Vec3::Y };
            let first = normal.cross(helper).normalize();
            let second = normal.cross(first);
            let (s, c) = angle.sin_cos();
            let ratio = 10.0_f32.powf(-thin);
            [(first * c + second * s) * radius, (second * c - first * s) * (radius * ratio)]
        });
        // A grazing view: the normal turned until the ray lies nearly in the plane.
        Given { position: Vec3::new(x, y, -t), normal, radius, tangents }
    })
}

fn kernel() -> impl Strategy<Value = Kernel> {
    let cutoff = prop_oneof![Just(2.0_f32), Just(1.0), Just(4.0), Just(0.25), 0.25_f32..4.0];
    let low_pass = prop_oneof![2 => Just(0.25_f32), 1 => Just(1.0), 2 => Just(0.0), 1 => Just(1e-6), 1 => 0.0_f32..16.0];
    (0..3_usize, cutoff, low_pass).prop_map(|(o, cutoff, low_pass)| Kernel {
        outline: OUTLINES[o],
        cutoff,
        low_pass,
    })
}

/// Turns a surfel so that its plane passes near the eye.
fn grazing(mut given: Given, lean: f32) -> Given {
    let ray = given.position.normalize();
    let side = ray.cross(given.normal);
    if given.tangents.is_none() && side.length() > 1e-3 {
        given.normal = (side.normalize() + ray * lean).normalize();
    }
    given
}

/// The first pixel outside the bounds that is inside the splat, and its q.
fn leak<R: Exact>(given: &Given, kernel: &Kernel, camera: &Camera) -> Option<(u32, u32, R)> {
    let view = View::<R>::new(camera);
    let shared = splatref::splat::Shared::new(&view, kernel);
    let (splat, reasons) = project(&Projector::new(view, kernel, false), &given.disc(), 0);
    let fate = reasons.fate();
    if matches!(fate, Fate::Behind | Fate::Degenerate | Fate::BackFacing) {
        return None;
    }
    let reach = f64::from(kernel.cutoff) * f64::from(kernel.low_pass).sqrt();
    let [excess, terms] = Eye::new(camera).beyond(wide(given.position), given.radius.into(), reach);
    // Only the linearized ellipse of a disc reaches farther than the disc itself.
    let linear = kernel.outline != Outline::RayCast || given.tangents.is_some();
    if fate == Fate::Outside && linear && excess > -1e-5 * terms {
        return None;
    }
    let half = R::from_f32(0.5);
    for y in 0..camera.height {
        for x in 0..camera.width {
            if fate == Fate::Visible && splat.bounds.contains(x, y) {
                continue;
            }
            let center = splat.footprint.center;
            let dx = (R::from_f32(x as f32) + half) - center.x;
            let dy = (R::from_f32(y as f32) + half) - center.y;
            let (q, _) = splat.footprint.fragment(&shared, dx, dy);
            if q <= shared.limit {
                return Some((x, y, q));
            }
        }
    }
    None
}

#[test]
fn a_giant_disc_through_the_near_plane_keeps_its_bounds() {
    let camera = near(false, [29, 23]);
    let kernel = Kernel { outline: Outline::RayCast, cutoff: 3.0, low_pass: 0.0 };
    let normal = Vec3::new(0.5652968, 0.6663123, 0.4862792);
    let position = Vec3::new(0.011187125, 2.1883247, -4.322463);
    for radius in [1000.0, 2987.9792, 36_238.184, 1_161_613.3] {
        let given = Given { position, normal, radius, tangents: None };
        assert_eq!(leak::<f32>(&given, &kernel, &camera), None, "radius {radius}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]

    #[test]
    fn nothing_inside_lies_outside_the_bounds(
        given in given(),
        kernel in kernel(),
        orthographic: bool,
        lean in prop_oneof![3 => Just(None), 1 => (-6.0_f32..0.0).prop_map(|e| Some(10.0_f32.powf(e)))],
        wide in 0..20_u32,
    ) {
        let size = if wide == 0 { [1500, 2] } else { [29, 23] };
        let camera = near(orthographic, size);
        let given = if let Some(lean) = lean { grazing(given, lean) } else { given };
        let found = leak::<f32>(&given, &kernel, &camera);
        prop_assert!(found.is_none(), "f32 {:?}", found);
        let found = leak::<f64>(&given, &kernel, &camera);
        prop_assert!(found.is_none(), "f64 {:?}", found);
    }

    #[test]
    fn bounds_of_moderate_splats_are_tight(
        (x, y, t) in (-2.0_f32..2.0, -2.0_f32..2.0, 2.0_f32..6.0),
        normal in normal(),
        radius in 0.05_f32..0.75,
        (outline, orthographic) in (0..3_usize, any::<bool>()),
    ) {
        let camera = near(orthographic, [57, 49]);
        let kernel = Kernel { outline: OUTLINES[outline], ..Kernel::DEFAULT };
        let given = Given { position: Vec3::new(x, y, -t), normal, radius, tangents: None };
        let view = View::<f32>::new(&camera);
        let (splat, reasons) = project(&Projector::new(view, &kernel, false), &given.disc(), 0);
        if reasons.fate() != Fate::Visible {
            return Ok(());
        }
        let ([low, high], facing) = extent(&given, kernel, &camera);
        if facing < 0.01 {
            return Ok(());
        }
        let b = splat.bounds;
        let corners = [(b.x0, b.x1, low[0], high[0], camera.width), (b.y0, b.y1, low[1], high[1], camera.height)];
        for (first, end, low, high, count) in corners {
            let (first_center, last_center) = (f64::from(first) + 0.5, f64::from(end) - 0.5);
            prop_assert!(first == 0 || first_center >= low - 1.5, "first {first}, extent {low}");
            prop_assert!(end == count || last_center <= high + 1.5, "end {end}, extent {high}");
        }
    }
}

/// The true extent of a splat on the screen, by the oracle, and how far it is from edge-on.
fn extent(given: &Given, kernel: Kernel, camera: &Camera) -> ([[f64; 2]; 2], f64) {
    let surfels = surfels(discs([(given.position, given.normal, given.radius)]));
    let cast = kernel.outline == Outline::RayCast;
    let shape = if cast {
        Kernel { outline: Outline::Perspective, low_pass: 0.0, ..kernel }
    } else {
        kernel
    };
    let optics = Optics::new(camera, &Settings { kernel: shape, ..Settings::default() });
    let body = Body::new(&optics.eye, &surfels, (0, 1.0));
    let figure = Figure::new(&optics, body);
    let (c, [xx, _, yy]) = (figure.center, figure.covariance);
    let reach = [optics.k * xx.sqrt(), optics.k * yy.sqrt()];
    let mut low = [c[0] - reach[0], c[1] - reach[1]];
    let mut high = [c[0] + reach[0], c[1] + reach[1]];
    if cast {
        let circle = f64::from(kernel.cutoff) * f64::from(kernel.low_pass).sqrt();
        let center = optics.eye.pixel(body.p);
        for i in 0..2 {
            low[i] = low[i].min(center[i] - circle);
            high[i] = high[i].max(center[i] + circle);
        }
    }
    ([low, high], figure.facing.abs())
}
