//! Pictures whose numbers are known in closed form.

use crate::oracle::kit::case::Case;
use crate::oracle::kit::planes::{index, number};
use crate::oracle::kit::scene::{ahead, discs, scene, surfels};
use glam::Vec3;
use splatref::frame::NO_ID;
use splatref::method::blue::Settings;
use splatref::scene::{Lens, Sides};

/// Discs before a camera that looks along -z from the origin; nothing is culled.
fn case(all: Vec<(Vec3, Vec3, f32)>, lens: Lens, size: [u32; 2]) -> Case<Settings> {
    let scene = scene(surfels(discs(all)));
    let (camera, settings) = (ahead(lens, size), Settings { cull: false });
    Case { name: "known".into(), scene, camera, settings, groups: None, exact: true }
}

/// The pixels that show something.
fn covered(case: &Case<Settings>) -> Vec<bool> {
    let frame = case.drawing().frame::<f32>();
    case.pixels().map(|(i, ..)| index(&frame, "id", i) != NO_ID).collect()
}

/// The offset of the centre of a pixel from the middle of the picture.
fn from_middle(case: &Case<Settings>, x: u32, y: u32) -> [f64; 2] {
    let [cx, cy] = [case.camera.cx, case.camera.cy].map(f64::from);
    [f64::from(x) + 0.5 - cx, f64::from(y) + 0.5 - cy]
}

/// At a depth of 4 with 32 pixels a unit there: all numbers have few digits, so that nothing is rounded.
#[test]
fn a_disc_that_faces_the_camera_is_a_circle() {
    for lens in [Lens::Focal(128.0), Lens::Orthographic(2.0)] {
        for (radius, shift) in
            [(0.5, 0.0), (0.25, 1.0 / 64.0), (0.015_625, 0.0), (0.75, 3.0 / 32.0)]
        {
            let all = vec![(Vec3::new(shift, -shift, -4.0), Vec3::Z, radius)];
            let case = case(all, lens, [64, 64]);
            for ((_, x, y), shown) in case.pixels().zip(covered(&case)) {
                let [dx, dy] = from_middle(&case, x, y).map(|v| v - f64::from(shift) * 32.0);
                let rho = f64::from(radius) * 32.0;
                // The rim is part of the disc, the right and the lower edge no part of its square.
                let circle = dx * dx + dy * dy <= rho * rho && dx < rho && dy < rho;
                assert_eq!(shown, circle, "({x}, {y}), {lens:?} {radius}");
            }
            let frame = case.drawing().frame::<f32>();
            let depths = case.pixels().map(|(i, ..)| number(&frame, "Z", i));
            assert!(depths.into_iter().all(|z| z == 4.0 || z == f64::INFINITY));
        }
    }
}

/// Tilted about x by an angle of tangent 3/4: in an orthographic picture an ellipse, 4/5 as high as wide; and
/// the depth is that of the plane.
#[test]
fn a_tilted_disc_is_an_ellipse() {
    let all = vec![(Vec3::new(0.0, 0.0, -4.0), Vec3::new(0.0, 0.6, 0.8), 0.625)];
    let case = case(all, Lens::Orthographic(2.0), [64, 64]);
    let frame = case.drawing().frame::<f32>();
    let mut count = 0;
    for (i, x, y) in case.pixels() {
        let [dx, dy] = from_middle(&case, x, y);
        let form = (dx * dx + dy * dy / 0.64) / 400.0;
        let shown = index(&frame, "id", i) != NO_ID;
        assert!(shown == (form <= 1.0) || (form - 1.0).abs() < 1e-5, "({x}, {y}): {form}");
        if shown {
            count += 1;
            // Rows run down, and the upper part of the plane leans back.
            let depth = 4.0 - dy / 32.0 * 0.75;
            assert!((number(&frame, "Z", i) - depth).abs() < 1e-5, "({x}, {y})");
            assert!((number(&frame, "discs.offset", i) - form * 0.390_625).abs() < 1e-6);
        }
    }
    assert!((f64::from(count) - 0.8 * 400.0 * std::f64::consts::PI).abs() < 20.0, "{count}");
}

/// The area of a disc in the picture is that of its ellipse, pi rho^2 cos, as the resolution grows; in
/// perspective, close to the axis, too.
#[test]
fn the_area_becomes_that_of_the_disc() {
    for normal in [Vec3::Z, Vec3::new(0.48, 0.6, 0.64), Vec3::new(0.0, 0.8, -0.6)] {
        for scale in [1_u32, 4, 16] {
            let size = [64 * scale; 2];
            let cosine = f64::from(normal.z.abs());
            let rho = 0.0625 * 32.0 * f64::from(scale) * 4.0;
            let truth = std::f64::consts::PI * rho * rho * cosine;
            // The perimeter is where pixels are won or lost.
            let slack = 4.0 * rho.sqrt() + 1.0;
            let flat = case(
                vec![(Vec3::new(0.01, 0.02, -4.0), normal, 0.25)],
                Lens::Orthographic(2.0),
                size,
            );
            let found = covered(&flat).iter().filter(|shown| **shown).count() as f64;
            assert!((found - truth).abs() < slack, "{found} {truth} {normal} {scale}");
            // 64 times as far and as long: what perspective changes is less than a part in 250.
            let far = case(
                vec![(Vec3::new(0.01, 0.02, -64.0), normal, 0.25)],
                Lens::Focal(2048.0 * f64::from(scale)),
                size,
            );
            let found = covered(&far).iter().filter(|shown| **shown).count() as f64;
            assert!((found - truth).abs() < slack + truth / 250.0, "{found} {truth} {normal}");
        }
    }
}

/// Squares of wide discs that touch share no pixel and leave none: those of the lower index win nothing that is
/// another's, though all are equally near.
#[test]
fn squares_that_touch_share_no_pixels() {
    // Edges between centres of pixels, and on them.
    for (side, shift) in [(4.0, 0.0), (4.0, 0.5), (3.0, 0.25), (1.0, 0.5), (2.5, 0.0)] {
        let columns = (64.0_f32 / side) as u32 + 2;
        let at = |i: u32| (i as f32 - 0.5) * side + shift - 32.0;
        let all = (0..columns * columns).map(|i| {
            let (x, y) = (at(i % columns), at(i / columns));
            (Vec3::new(x / 32.0, -y / 32.0, -4.0), Vec3::Z, 100.0)
        });
        for reversed in [false, true] {
            let mut all: Vec<_> = all.clone().collect();
            if reversed {
                all.reverse();
            }
            let count = all.len() as u32;
            let mut case = case(all, Lens::Orthographic(2.0), [64, 64]);
            case.scene.sides = Some(Sides::new(vec![(0, Some(side))]).expect("sides"));
            let frame = case.drawing().frame::<f32>();
            for (i, x, y) in case.pixels() {
                let id = index(&frame, "id", i);
                let own = if reversed { count - 1 - id } else { id };
                // x + 1/2 is in [left, left + side) of the column that begins at `shift - side`.
                let place = |pixel: u32| ((pixel as f32 + 0.5 - shift) / side + 1.0).floor() as u32;
                assert_eq!(own, place(y) * columns + place(x), "({x}, {y}) {side} {shift}");
            }
        }
    }
}

/// A side cuts the disc, and one that is larger than the disc changes nothing. The centre may be outside.
#[test]
fn a_square_cuts_its_disc() {
    let one = (Vec3::new(-1.03125, 0.0, -4.0), Vec3::Z, 0.5);
    let mut case = case(vec![one], Lens::Orthographic(2.0), [64, 64]);
    let whole = covered(&case);
    assert!(whole.iter().filter(|shown| **shown).count() > 300, "reaches in");
    for (side, same) in [(100.0, true), (32.0, true), (16.0, false)] {
        case.scene.sides = Some(Sides::new(vec![(0, Some(side))]).expect("sides"));
        let found = covered(&case);
        assert_eq!(found == whole, same, "{side}");
        for ((i, x, y), found) in case.pixels().zip(found) {
            // The centre is at column -1, row 32.
            let reach = f64::from(side) / 2.0;
            let [dx, dy] = [f64::from(x) + 1.5, f64::from(y) + 0.5 - 32.0];
            let inside = -reach <= dx && dx < reach && -reach <= dy && dy < reach;
            assert_eq!(found, whole[i] && inside, "({x}, {y}) {side}");
        }
    }
}

/// A floor that begins beside the camera and runs away from it, from before the near plane to behind: what is
/// not beyond the near plane is not seen.
#[test]
fn the_near_plane_cuts_a_disc() {
    let floor = (Vec3::new(0.0, -0.5, -1.0), Vec3::Y, 50.0);
    let mut case = case(vec![floor], Lens::Focal(32.0), [64, 64]);
    case.scene.sides = Some(Sides::new(vec![(0, Some(1e6))]).expect("sides"));
    for near in [0.001, 0.75, 0.999, 1.0, 2.0] {
        case.camera.near = near;
        let frame = case.drawing().frame::<f64>();
        for (i, x, y) in case.pixels() {
            // The ray sinks by (y + 1/2 - 32) / 32 a unit of depth, and meets the floor at -1/2.
            let sinks = (f64::from(y) + 0.5 - 32.0) / 32.0;
            let t = 0.5 / sinks;
            let a = (f64::from(x) + 0.5 - 32.0) / 32.0;
            let offset = (t * a) * (t * a) + (t - 1.0) * (t - 1.0);
            // At 1 the centre itself is not beyond the near plane, and the surfel is lost.
            let seen = near < 1.0 && t > f64::from(near) && offset <= 2500.0;
            assert_eq!(index(&frame, "id", i) != NO_ID, seen, "({x}, {y}) {near}");
            if seen {
                assert!((number(&frame, "Z", i) - t).abs() < 1e-12, "({x}, {y})");
            }
        }
    }
}

/// Edge-on planes, which no ray meets, and what no number can hold.
#[test]
fn edge_on_discs_are_not_seen() {
    for lens in [Lens::Focal(128.0), Lens::Orthographic(2.0)] {
        let all = [Vec3::X, Vec3::Y, Vec3::new(0.6, 0.8, 0.0)];
        let all = all.map(|normal| (Vec3::new(0.0, 0.0, -4.0), normal, 0.5));
        assert!(covered(&case(all.to_vec(), lens, [33, 33])).iter().all(|shown| !shown));
    }
}
