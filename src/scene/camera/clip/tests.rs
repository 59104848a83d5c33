//! Projection matrices as people have them, against clip space computed by hand.

use super::super::convention::tests::{SIZE, Truth, camera, seen, truths};
use super::*;
use glam::{DVec2, DVec3};
use proptest::prelude::*;

/// How a renderer makes a projection matrix.
#[derive(Clone, Copy, Debug)]
struct Style {
    convention: Convention,
    /// The camera looks along +z, and y of view space is down.
    forward: bool,
    /// Which clip depths near and far have.
    depths: [f64; 2],
    /// Far is infinite.
    infinite: bool,
    /// y is flipped, because the rows of the picture run the other way.
    flipped: bool,
    /// A factor of the whole matrix, which changes nothing.
    factor: f64,
}

const NEAR: f64 = 0.25;
const FAR: f64 = 50.0;

impl Style {
    fn all() -> Vec<Self> {
        let mut all = Vec::new();
        for convention in [Convention::OpenGl, Convention::Vulkan, Convention::Direct3d] {
            let low = if convention == Convention::OpenGl { -1.0 } else { 0.0 };
            for depths in [[low, 1.0], [1.0, low]] {
                for (forward, flipped) in [(false, false), (true, false), (false, true)] {
                    for (infinite, factor) in [(false, 1.0), (true, 1.0), (false, 3.0)] {
                        all.push(Self { convention, forward, depths, infinite, flipped, factor });
                    }
                }
            }
        }
        all
    }

    /// z of view space in front of the camera.
    fn sign(&self) -> f64 {
        if self.forward { 1.0 } else { -1.0 }
    }

    /// The signs of y and z of `OpenCV` in this view space.
    fn pose(&self, truth: &Truth) -> DMat4 {
        truth.world_to_camera([1.0, self.sign(), self.sign()])
    }

    /// Whether the first row of the picture has y = 1 in clip space.
    fn top(&self) -> f64 {
        let up = if self.convention == Convention::Vulkan { -1.0 } else { 1.0 };
        if self.flipped { -up } else { up }
    }

    /// The rows of x and y of the perspective: what clip space must be for the pixels of the truth.
    fn perspective(&self, truth: &Truth) -> DMat4 {
        let [w, h] = SIZE.map(f64::from);
        let ([fx, fy], [cx, cy], s) = (truth.f, truth.c, self.sign());
        // x_clip = 2 X / W - 1 and y_clip = top (1 - 2 Y / H), each times the depth s z.
        let x = DVec4::new(2.0 * fx / w, 0.0, s * (2.0 * cx / w - 1.0), 0.0);
        // y of OpenCV is s y.
        let y = DVec4::new(0.0, -2.0 * fy / h * s, s * (1.0 - 2.0 * cy / h), 0.0) * self.top();
        // depth = a + b / t.
        let [near, far] = self.depths;
        let b = if self.infinite {
            NEAR * (near - far)
        } else {
            (near - far) / (1.0 / NEAR - 1.0 / FAR)
        };
        let a = if self.infinite { far } else { near - b / NEAR };
        let rows = [x, y, DVec4::new(0.0, 0.0, s * a, b), DVec4::new(0.0, 0.0, s, 0.0)];
        let [x, y, z, w] = rows.map(|row| row * self.factor);
        DMat4::from_cols(x, y, z, w).transpose()
    }

    /// As above, of the orthographic projection with fx and fy pixels a unit.
    fn orthographic(&self, truth: &Truth) -> DMat4 {
        let [w, h] = SIZE.map(f64::from);
        let ([fx, fy], [cx, cy], s) = (truth.f, truth.c, self.sign());
        let x = DVec4::new(2.0 * fx / w, 0.0, 0.0, 2.0 * cx / w - 1.0);
        let y = DVec4::new(0.0, -2.0 * fy / h * s, 0.0, 1.0 - 2.0 * cy / h) * self.top();
        let [near, far] = self.depths;
        let a = (far - near) / (FAR - NEAR);
        let rows = [x, y, DVec4::new(0.0, 0.0, s * a, near - a * NEAR), DVec4::W];
        let [x, y, z, w] = rows.map(|row| row * self.factor);
        DMat4::from_cols(x, y, z, w).transpose()
    }

    /// The pixel of a point, through clip space.
    fn pixel(&self, matrix: &DMat4, pose: &DMat4, point: DVec3) -> DVec2 {
        let clip = *matrix * (*pose * point.extend(1.0));
        let ndc = clip.truncate() / clip.w;
        let [w, h] = SIZE.map(f64::from);
        DVec2::new((ndc.x + 1.0) / 2.0 * w, (1.0 - self.top() * ndc.y) / 2.0 * h)
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn every_style_gives_the_camera(truth in truths()) {
        for style in Style::all() {
            for orthographic in [false, true] {
                // An infinite orthographic matrix has no depth.
                if orthographic && style.infinite {
                    continue;
                }
                let matrix = match orthographic {
                    true => style.orthographic(&truth),
                    false => style.perspective(&truth),
                };
                let pose = style.pose(&truth);
                let read = from_clip(&matrix, style.convention, SIZE, PoseMatrix::WorldToCamera(pose));
                let read = read.unwrap_or_else(|error| panic!("{style:?}: {error}"));
                let camera = camera(read.view, read.intrinsics);
                for point in truth.points() {
                    let off = (seen(&camera, point) - style.pixel(&matrix, &pose, point)).length();
                    prop_assert!(off < 1e-4, "{style:?} orthographic {orthographic}: {off}");
                }
                prop_assert!((read.near - NEAR).abs() < 1e-9, "{style:?}: near {}", read.near);
                match style.infinite {
                    true => prop_assert!(read.far > 1e9, "{style:?}: far {}", read.far),
                    false => prop_assert!((read.far - FAR).abs() < 1e-6, "{style:?}: far {}", read.far),
                }
                prop_assert!(read.view.determinant() > 0.0);
            }
        }
    }
}

/// The matrices of well-known functions, typed from their manuals.
#[test]
fn the_functions_of_the_interfaces_give_one_camera() {
    let (t, n, f, aspect) = (2.0_f64, 0.5, 100.0, 320.0 / 240.0);
    let rows = |rows: [[f64; 4]; 4]| DMat4::from_cols_array_2d(&rows).transpose();
    let xy = |y: f64| ([t / aspect, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0]);
    let make = |y: f64, z: [f64; 4]| {
        let (x, y) = xy(y);
        rows([x, y, z, [0.0, 0.0, -1.0, 0.0]])
    };
    // gluPerspective; glm::perspectiveRH_ZO with [1][1] *= -1; D3DXMatrixPerspectiveFovRH;
    // reversed and infinite.
    let perspective_gl = make(t, [0.0, 0.0, (f + n) / (n - f), 2.0 * f * n / (n - f)]);
    let vulkan = make(-t, [0.0, 0.0, f / (n - f), n * f / (n - f)]);
    let d3d = make(t, [0.0, 0.0, f / (n - f), n * f / (n - f)]);
    let reversed = make(t, [0.0, 0.0, 0.0, n]);
    let pose = PoseMatrix::WorldToCamera(DMat4::from_translation(DVec3::new(0.0, 0.0, -4.0)));
    let one = from_clip(&perspective_gl, Convention::OpenGl, SIZE, pose).unwrap();
    assert_eq!(one.intrinsics, Intrinsics::centered(SIZE, [240.0, 240.0]));
    assert!((one.near - n).abs() < 1e-12 && (one.far - f).abs() < 1e-9, "{one:?}");
    for (matrix, convention) in [
        (vulkan, Convention::Vulkan),
        (d3d, Convention::Direct3d),
        (reversed, Convention::Direct3d),
    ] {
        let other = from_clip(&matrix, convention, SIZE, pose).unwrap();
        assert_eq!((other.intrinsics, other.view), (one.intrinsics, one.view));
        assert!((other.near - n).abs() < 1e-12, "{other:?}");
    }
}

#[test]
fn what_is_no_camera_is_refused() {
    let perspective = DMat4::from_cols_array_2d(&[
        [2.0, 0.0, 0.0, 0.0],
        [0.0, 2.0, 0.0, 0.0],
        [0.0, 0.0, -1.01, -1.0],
        [0.0, 0.0, -0.2, 0.0],
    ]);
    let pose = DMat4::from_translation(DVec3::new(0.0, 0.0, -4.0));
    let left = |m: &mut DMat4| (m.z_axis.z, m.z_axis.w) = (1.01, 1.0);
    let refused = |change: &dyn Fn(&mut DMat4)| {
        let mut matrix = perspective;
        change(&mut matrix);
        let pose = PoseMatrix::WorldToCamera(pose);
        from_clip(&matrix, Convention::OpenGl, SIZE, pose).unwrap_err()
    };
    for (word, error) in [
        ("transpose", refused(&|m| *m = m.transpose())),
        ("as a pose", refused(&|m| *m *= DMat4::from_rotation_y(0.3) * pose)),
        ("skew", refused(&|m| m.y_axis.x = 0.01)),
        ("shift", refused(&|m| m.w_axis.x = 0.1)),
        ("not finite", refused(&|m| m.w_axis.x = f64::INFINITY)),
        ("left-handed", refused(&left)),
        ("left-handed", refused(&|m| m.x_axis.x = -2.0)),
        ("near", refused(&|m| m.w_axis.z = 0.0)),
        ("near", refused(&|m| m.w_axis.z = 0.2)),
        ("skew", refused(&|m| m.x_axis.x = 0.0)),
        ("last row", refused(&|m| *m = DMat4::ZERO)),
        ("negate", refused(&|m| *m = DMat4::from_diagonal(DVec4::new(1.0, 1.0, 1.0, -1.0)))),
    ] {
        assert!(error.contains(word) && !error.contains('\n'), "{word}: {error}");
    }
    let other = from_clip(&perspective, Convention::OpenCv, SIZE, PoseMatrix::WorldToCamera(pose));
    assert!(other.unwrap_err().contains("opengl, vulkan or d3d"));
}

/// What is written is read again as the same camera.
#[test]
fn a_camera_gives_matrices_that_give_the_camera() {
    let pose =
        crate::scene::Pose { eye: DVec3::new(1.0, 2.0, 6.0), target: DVec3::ZERO, up: DVec3::Y };
    for lens in [crate::scene::Lens::FieldOfView(50.0), crate::scene::Lens::Orthographic(3.0)] {
        let mut camera = Camera::new(64, 48, pose, lens).unwrap();
        (camera.cx, camera.cy, camera.fy, camera.near) = (30.25, 27.5, 0.75 * camera.fx, 0.5);
        let view = PoseMatrix::WorldToCamera(camera.view_from_world.as_dmat4());
        for convention in [Convention::OpenGl, Convention::Vulkan, Convention::Direct3d] {
            let matrix = to_clip(&camera, convention, 40.0).unwrap();
            let read = from_clip(&matrix, convention, camera.size(), view).unwrap();
            let intrinsics = read.intrinsics;
            let found = [intrinsics.f, intrinsics.c, [read.near, read.far]].concat();
            let wanted = [camera.fx, camera.fy, camera.cx, camera.cy, 0.5, 40.0].map(f64::from);
            for (found, wanted) in found.iter().zip(wanted) {
                assert!((found - wanted).abs() < 1e-9, "{convention:?} {read:?}");
            }
            assert_eq!(read.view, camera.view_from_world.as_dmat4());
        }
        assert!(to_clip(&camera, Convention::OpenCv, 40.0).is_err());
        assert!(to_clip(&camera, Convention::OpenGl, 0.5).is_err());
    }
}
