//! The page of the method, operation by operation: the same bits, of every surfel at every pixel.

use super::cases::case;
use crate::oracle::kit::case::Case;
use crate::oracle::kit::goldens;
use crate::oracle::kit::planes::{index, number, unclean, value};
use splatref::frame::{Frame, NO_ID};
use splatref::method::blue::Settings;
use splatref::scene::{Primitives, Projection};
use splatref::splat::Tally;

/// What a pixel keeps: depth, surfel, offset and whether the back is seen.
type Kept<N> = (N, u32, N, bool);

/// What the discs of a scene without triangles leave, and the fates: visible, behind, degenerate, back-facing,
/// outside.
type Discs<N> = (Vec<Kept<N>>, [u64; 5]);

/// The page in one arithmetic: a module with a function `discs`.
macro_rules! page {
    ($name:ident, $number:ty) => {
        mod $name {
            use super::{Case, Discs, Kept, NO_ID, Projection, Settings};

            type N = $number;

            struct Eye {
                rows: [[N; 4]; 3],
                f: [N; 2],
                c: [N; 2],
                near: N,
                perspective: bool,
            }

            /// A surfel: its plane, its radius, its square, and whether its back is seen.
            struct Disc {
                p: [N; 3],
                n: [N; 3],
                r: N,
                middle: [N; 2],
                h: N,
                g: N,
            }

            fn eye(case: &Case<Settings>) -> Eye {
                let camera = &case.camera;
                Eye {
                    rows: [0, 1, 2].map(|i| camera.view_from_world.row(i).to_array().map(N::from)),
                    f: [camera.fx, camera.fy].map(N::from),
                    c: [camera.cx, camera.cy].map(N::from),
                    near: camera.near.into(),
                    perspective: camera.projection == Projection::Perspective,
                }
            }

            fn disc(case: &Case<Settings>, eye: &Eye, i: usize) -> Disc {
                let scene = &case.scene;
                let turn = |v: glam::Vec3| {
                    let [x, y, z] = v.to_array().map(N::from);
                    eye.rows.map(|m| (m[0] * x + m[1] * y) + m[2] * z)
                };
                let moved = turn(scene.surfels.position()[i]);
                let p = [0, 1, 2].map(|k: usize| moved[k] + eye.rows[k][3]);
                let n = turn(scene.surfels.normal()[i]);
                let r = N::from(scene.surfels.radius()[i]);
                let m = if eye.perspective { 1.0 / -p[2] } else { 1.0 };
                let (a, b) = (p[0] * m, p[1] * m);
                let g = if eye.perspective { (n[0] * a + n[1] * b) - n[2] } else { -n[2] };
                let h = match scene.sides.as_ref().and_then(|sides| sides.side(i as u32)) {
                    Some(side) => N::from(side) * 0.5,
                    None => {
                        let rho = r * ((eye.f[0] * eye.f[1]).sqrt() * m);
                        let most = N::from(2.0_f32.powi(48));
                        let rho = if rho > most { most } else { rho };
                        if rho < 0.5 { 0.5 } else { rho }
                    }
                };
                let middle = [eye.c[0] + eye.f[0] * a, eye.c[1] - eye.f[1] * b];
                Disc { p, n, r, middle, h, g }
            }

            impl Disc {
                /// Whether a column or a row is in the square.
                fn inside(&self, axis: usize, pixel: u32) -> bool {
                    let (center, middle) = (N::from(pixel as f32) + 0.5, self.middle[axis]);
                    middle - self.h <= center && center < middle + self.h
                }

                fn fate(&self, case: &Case<Settings>, eye: &Eye) -> usize {
                    let [width, height] = [case.camera.width, case.camera.height];
                    let reaches = (0..width).any(|x| self.inside(0, x))
                        && (0..height).any(|y| self.inside(1, y));
                    let numbers = [self.middle[0], self.middle[1], -self.p[2], self.g];
                    match () {
                        () if !(-self.p[2] > eye.near) => 1,
                        () if !numbers.iter().all(|v| v.is_finite()) => 2,
                        () if case.settings.cull && self.g >= 0.0 => 3,
                        () if !reaches => 4,
                        () => 0,
                    }
                }

                /// Depth and offset at a pixel, if the fragment stays.
                fn at(&self, eye: &Eye, x: u32, y: u32) -> Option<(N, N)> {
                    let Self { p, n, r, .. } = *self;
                    let a = ((N::from(x as f32) + 0.5) - eye.c[0]) / eye.f[0];
                    let b = -(((N::from(y as f32) + 0.5) - eye.c[1]) / eye.f[1]);
                    let (t, d) = if eye.perspective {
                        let through = (n[0] * p[0] + n[1] * p[1]) + n[2] * p[2];
                        let t = through / ((n[0] * a + n[1] * b) - n[2]);
                        (t, [t * a - p[0], t * b - p[1], t + p[2]])
                    } else {
                        let (x, y) = (a - p[0], b - p[1]);
                        let z = (n[0] * x + n[1] * y) / n[2];
                        (z - p[2], [x, y, z])
                    };
                    let offset = (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2];
                    let finite = t.is_finite() && offset.is_finite();
                    (finite && t > eye.near && offset <= r * r).then_some((t, offset))
                }
            }

            pub(super) fn discs(case: &Case<Settings>) -> Discs<N> {
                let eye = eye(case);
                let none: Kept<N> = (N::INFINITY, NO_ID, 0.0, false);
                let mut pixels = vec![none; case.pixels().count()];
                let mut fates = [0; 5];
                for surfel in 0..case.scene.surfels.len() {
                    let disc = disc(case, &eye, surfel);
                    let fate = disc.fate(case, &eye);
                    fates[fate] += 1;
                    let inside = |x, y| fate == 0 && disc.inside(0, x) && disc.inside(1, y);
                    for (i, x, y) in case.pixels().filter(|&(_, x, y)| inside(x, y)) {
                        if let Some((t, offset)) =
                            disc.at(&eye, x, y).filter(|at| at.0 < pixels[i].0)
                        {
                            pixels[i] = (t, surfel as u32, offset, disc.g > 0.0);
                        }
                    }
                }
                (pixels, fates)
            }
        }
    };
}

page!(single, f32);
page!(double, f64);

/// Every plane of the discs, and their fates.
fn check<N: Into<f64> + Copy, R: splatref::number::Exact>(
    case: &Case<Settings>,
    (pixels, fates): Discs<N>,
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
    for mut case in (0..160).map(case).chain(goldens::of()) {
        case.scene.primitives = Primitives::default();
        let picture = case.drawing().define::<f32>();
        shown[0] += check(&case, single::discs(&case), (&picture.frame, &picture.tally));
        let picture = case.drawing().define::<f64>();
        shown[1] += check(&case, double::discs(&case), (&picture.frame, &picture.tally));
    }
    assert!(shown.iter().all(|count| *count > 20_000), "{shown:?}");
}
