//! The page of the method, operation by operation: the same bits, of every surfel at every pixel.

use super::cases::case;
use crate::kit::case::Case;
use crate::kit::planes::{index, number, unclean, value};
use splatref::frame::{Frame, NO_ID};
use splatref::method::blue::Settings;
use splatref::scene::{Primitives, Projection};
use splatref::splat::Tally;

/// What the discs of a scene without triangles leave: at each pixel depth, surfel, offset and whether the back
/// is seen; and the fates: visible, behind, degenerate, back-facing, outside.
macro_rules! discs {
    ($name:ident, $number:ty) => {
        fn $name(case: &Case<Settings>) -> (Vec<($number, u32, $number, bool)>, [u64; 5]) {
            type N = $number;
            let Case { scene, camera, settings, .. } = case;
            let n = |v: f32| N::from(v);
            let rows = [0, 1, 2].map(|i| camera.view_from_world.row(i).to_array().map(n));
            let turn = |v: glam::Vec3| {
                let [x, y, z] = v.to_array().map(n);
                rows.map(|m| (m[0] * x + m[1] * y) + m[2] * z)
            };
            let [fx, fy] = [n(camera.fx), n(camera.fy)];
            let [cx, cy, near] = [n(camera.cx), n(camera.cy), n(camera.near)];
            let perspective = camera.projection == Projection::Perspective;
            let [width, height] = [camera.width, camera.height];
            let mut pixels = vec![(N::INFINITY, NO_ID, 0.0, false); (width * height) as usize];
            let mut fates = [0; 5];
            for i in 0..scene.surfels.len() {
                let moved = turn(scene.surfels.position()[i]);
                let p = [0, 1, 2].map(|k: usize| moved[k] + rows[k][3]);
                let normal = turn(scene.surfels.normal()[i]);
                let r = n(scene.surfels.radius()[i]);
                let t = -p[2];
                let m = if perspective { 1.0 / t } else { 1.0 };
                let (a, b) = (p[0] * m, p[1] * m);
                let (x0, y0) = (cx + fx * a, cy - fy * b);
                let g = if perspective {
                    (normal[0] * a + normal[1] * b) - normal[2]
                } else {
                    -normal[2]
                };
                let h = match scene.sides.as_ref().and_then(|sides| sides.of(i as u32)) {
                    Some(side) => n(side) * 0.5,
                    None => {
                        let rho = r * ((fx * fy).sqrt() * m);
                        let most = n(2.0_f32.powi(48));
                        let rho = if rho > most { most } else { rho };
                        if rho < 0.5 { 0.5 } else { rho }
                    }
                };
                let inside = |from: N, pixel: u32| {
                    let center = N::from(pixel as f32) + 0.5;
                    from - h <= center && center < from + h
                };
                let reaches =
                    (0..width).any(|x| inside(x0, x)) && (0..height).any(|y| inside(y0, y));
                let finite = [x0, y0, t, g].iter().all(|v| v.is_finite());
                let fate = match () {
                    () if !(t > near) => 1,
                    () if !finite => 2,
                    () if settings.cull && g >= 0.0 => 3,
                    () if !reaches => 4,
                    () => 0,
                };
                fates[fate] += 1;
                if fate != 0 {
                    continue;
                }
                for (index, pixel) in pixels.iter_mut().enumerate() {
                    let (x, y) = (index as u32 % width, index as u32 / width);
                    if !(inside(x0, x) && inside(y0, y)) {
                        continue;
                    }
                    let a = ((N::from(x as f32) + 0.5) - cx) / fx;
                    let b = -(((N::from(y as f32) + 0.5) - cy) / fy);
                    let (t, d) = if perspective {
                        let through = (normal[0] * p[0] + normal[1] * p[1]) + normal[2] * p[2];
                        let t = through / ((normal[0] * a + normal[1] * b) - normal[2]);
                        (t, [t * a - p[0], t * b - p[1], t + p[2]])
                    } else {
                        let (x, y) = (a - p[0], b - p[1]);
                        let z = (normal[0] * x + normal[1] * y) / normal[2];
                        (z - p[2], [x, y, z])
                    };
                    let offset = (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2];
                    let stays = t > near && offset <= r * r && t.is_finite() && offset.is_finite();
                    if stays && t < pixel.0 {
                        *pixel = (t, i as u32, offset, g > 0.0);
                    }
                }
            }
            (pixels, fates)
        }
    };
}

discs!(single, f32);
discs!(double, f64);

/// Every plane of the discs, and their fates.
fn check<N: Into<f64> + Copy, R: splatref::number::Exact>(
    case: &Case<Settings>,
    (pixels, fates): (Vec<(N, u32, N, bool)>, [u64; 5]),
    (frame, tally): (&Frame<R>, &Tally),
) -> u64 {
    let Tally { visible, behind, degenerate, back_facing, outside } = *tally;
    assert_eq!([visible, behind, degenerate, back_facing, outside], fates, "{case:?}");
    assert_eq!(unclean(frame), None, "{case:?}");
    let mut shown = 0;
    for (i, (depth, surfel, offset, back)) in pixels.into_iter().enumerate() {
        let place = || format!("pixel {i} of {case:?}");
        assert_eq!(index(frame, "id", i), surfel, "{}", place());
        assert_eq!(number(frame, "Z", i), depth.into(), "{}", place());
        assert_eq!(number(frame, "discs.offset", i), offset.into(), "{}", place());
        let there = surfel != NO_ID;
        shown += u64::from(there);
        assert_eq!(number(frame, "weight", i), f64::from(u8::from(there)), "{}", place());
        let of = &case.scene.surfels;
        let sign = if back { -1.0 } else { 1.0 };
        let normal = if there { of.normal()[surfel as usize] * sign } else { glam::Vec3::ZERO };
        assert_eq!(value(frame, "normal", i), normal.to_array().map(f64::from), "{}", place());
        if let Some(colors) = of.color() {
            let color = if there { colors[surfel as usize] } else { glam::Vec3::ZERO };
            assert_eq!(value(frame, "resolved", i), color.to_array().map(f64::from), "{}", place());
        }
    }
    shown
}

#[test]
fn discs_have_the_bits_of_the_page() {
    let mut shown = [0; 2];
    for seed in 0..160 {
        let mut case = case(seed);
        case.scene.primitives = Primitives::default();
        let picture = case.drawing().define::<f32>();
        shown[0] += check(&case, single(&case), (&picture.frame, &picture.tally));
        let picture = case.drawing().define::<f64>();
        shown[1] += check(&case, double(&case), (&picture.frame, &picture.tally));
    }
    assert!(shown.iter().all(|count| *count > 20_000), "{shown:?}");
}
