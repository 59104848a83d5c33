//! Poses in every convention against projections computed by hand, and their bits.

use super::*;
use crate::scene::camera::intrinsics::Intrinsics;
use crate::scene::camera::{Camera, Lens, Pose};
use crate::scene::transform::rotation;
use glam::{DMat3, DVec2, DVec3};
use proptest::prelude::*;

/// A camera as `OpenCV` has it: its axes as rows, its place, and its opening.
#[derive(Debug)]
pub(in crate::scene::camera) struct Truth {
    pub(in crate::scene::camera) axes: DMat3,
    pub(in crate::scene::camera) eye: DVec3,
    pub(in crate::scene::camera) f: [f64; 2],
    pub(in crate::scene::camera) c: [f64; 2],
}

pub(in crate::scene::camera) const SIZE: [u32; 2] = [320, 240];

/// The camera of a view matrix and of intrinsics.
pub(in crate::scene::camera) fn camera(view: DMat4, intrinsics: Intrinsics) -> Camera {
    let pose = Pose { eye: DVec3::Z, target: DVec3::ZERO, up: DVec3::Y };
    let any = Camera::new(intrinsics.size[0], intrinsics.size[1], pose, Lens::Focal(1.0)).unwrap();
    intrinsics.on(Camera { view_from_world: view.as_mat4(), near: 0.125, ..any })
}

/// Where a camera of the crate sees a point, by the formulas of the module.
pub(in crate::scene::camera) fn seen(camera: &Camera, point: DVec3) -> DVec2 {
    let v = camera.view_from_world.as_dmat4();
    let [x, y, z] = [0, 1, 2]
        .map(|i| v.row(i).x * point.x + v.row(i).y * point.y + v.row(i).z * point.z + v.row(i).w);
    let [fx, fy, cx, cy] = [camera.fx, camera.fy, camera.cx, camera.cy].map(f64::from);
    match camera.projection {
        crate::scene::Projection::Perspective => DVec2::new(cx + fx * x / -z, cy - fy * y / -z),
        crate::scene::Projection::Orthographic => DVec2::new(cx + fx * x, cy - fy * y),
    }
}

impl Truth {
    /// Where `OpenCV` sees a point.
    fn seen(&self, point: DVec3) -> DVec2 {
        let q = self.axes.transpose() * (point - self.eye);
        DVec2::new(self.f[0] * q.x / q.z + self.c[0], self.f[1] * q.y / q.z + self.c[1])
    }

    /// World to camera, with the axes of the camera times these signs.
    pub(in crate::scene::camera) fn world_to_camera(&self, signs: [f64; 3]) -> DMat4 {
        let row = |i: usize| {
            let axis = self.axes.col(i) * signs[i];
            axis.extend(-axis.dot(self.eye))
        };
        DMat4::from_cols(row(0), row(1), row(2), DVec4::W).transpose()
    }

    fn camera_to_world(&self, signs: [f64; 3]) -> DMat4 {
        let column = |i: usize| (self.axes.col(i) * signs[i]).extend(0.0);
        DMat4::from_cols(column(0), column(1), column(2), self.eye.extend(1.0))
    }

    fn intrinsics(&self) -> Intrinsics {
        Intrinsics { c: self.c, ..Intrinsics::centered(SIZE, self.f) }
    }

    /// Points in front of the camera.
    pub(in crate::scene::camera) fn points(&self) -> [DVec3; 4] {
        [[0.0, 0.0, 3.0], [0.5, -0.25, 2.0], [-0.75, 0.5, 4.0], [1.0, 1.0, 2.5]]
            .map(|at| self.eye + self.axes * DVec3::from_array(at))
    }
}

/// Any camera: turned, moved, with different focal lengths and an off-centre principal point.
pub(in crate::scene::camera) fn truths() -> impl Strategy<Value = Truth> {
    let vector = || prop::array::uniform3(-1.0..1.0_f64);
    (
        vector(),
        -180.0..180.0_f64,
        vector(),
        [100.0..300.0_f64, 100.0..300.0],
        [0.0..320.0_f64, -50.0..240.0],
    )
        .prop_filter("an axis", |(axis, ..)| DVec3::from_array(*axis).length() > 0.1)
        .prop_map(|(axis, degrees, eye, f, c)| Truth {
            axes: rotation(DVec3::from_array(axis), degrees),
            eye: DVec3::from_array(eye),
            f,
            c,
        })
}

const FLIPPED: [f64; 3] = [1.0, -1.0, -1.0];
const SAME: [f64; 3] = [1.0; 3];

proptest! {
    #[test]
    fn every_convention_sees_what_opencv_sees(truth in truths()) {
        use {Convention::*, PoseMatrix::*};
        for (convention, pose) in [
            (OpenCv, WorldToCamera(truth.world_to_camera(SAME))),
            (OpenCv, CameraToWorld(truth.camera_to_world(SAME))),
            (OpenGl, WorldToCamera(truth.world_to_camera(FLIPPED))),
            (OpenGl, CameraToWorld(truth.camera_to_world(FLIPPED))),
            (Blender, WorldToCamera(truth.world_to_camera(FLIPPED))),
            (Blender, CameraToWorld(truth.camera_to_world(FLIPPED))),
        ] {
            let camera = camera(pose.view(convention).unwrap(), truth.intrinsics());
            for point in truth.points() {
                let off = (seen(&camera, point) - truth.seen(point)).length();
                prop_assert!(off < 1e-4, "{convention:?} {pose:?}: {off}");
            }
        }
    }

    #[test]
    fn a_pose_keeps_its_bits(truth in truths()) {
        let matrix = truth.world_to_camera(SAME);
        let view = PoseMatrix::WorldToCamera(matrix).view(Convention::OpenGl).unwrap();
        prop_assert_eq!(view, matrix);
        let flipped = truth.world_to_camera(FLIPPED);
        let view = PoseMatrix::WorldToCamera(flipped).view(Convention::OpenCv).unwrap();
        prop_assert_eq!(view, matrix);
        let there = PoseMatrix::CameraToWorld(matrix).view(Convention::OpenGl).unwrap();
        let back = PoseMatrix::CameraToWorld(there).view(Convention::OpenGl).unwrap();
        let off = (back - matrix).to_cols_array().into_iter().fold(0.0, |most: f64, v| if v.abs() > most { v.abs() } else { most });
        prop_assert!(off < 1e-14, "{off}");
    }

    /// The documented formulas, operation by operation.
    #[test]
    fn the_inverse_is_the_documented_one(truth in truths()) {
        let matrix = truth.camera_to_world(SAME);
        let l = |i: usize, j: usize| matrix.row(i)[j];
        let t = [l(0, 3), l(1, 3), l(2, 3)];
        let c = [
            [l(1, 1) * l(2, 2) - l(1, 2) * l(2, 1), l(1, 2) * l(2, 0) - l(1, 0) * l(2, 2), l(1, 0) * l(2, 1) - l(1, 1) * l(2, 0)],
            [l(0, 2) * l(2, 1) - l(0, 1) * l(2, 2), l(0, 0) * l(2, 2) - l(0, 2) * l(2, 0), l(0, 1) * l(2, 0) - l(0, 0) * l(2, 1)],
            [l(0, 1) * l(1, 2) - l(0, 2) * l(1, 1), l(0, 2) * l(1, 0) - l(0, 0) * l(1, 2), l(0, 0) * l(1, 1) - l(0, 1) * l(1, 0)],
        ];
        let d = (l(0, 0) * c[0][0] + l(0, 1) * c[0][1]) + l(0, 2) * c[0][2];
        let view = PoseMatrix::CameraToWorld(matrix).view(Convention::OpenCv).unwrap();
        for (i, sign) in [1.0, -1.0, -1.0].into_iter().enumerate() {
            let r = [0, 1, 2].map(|j: usize| c[j][i] / d);
            let u = -((r[0] * t[0] + r[1] * t[1]) + r[2] * t[2]);
            let row = [r[0], r[1], r[2], u].map(|v| sign * v + 0.0);
            prop_assert_eq!(view.row(i).to_array().map(f64::to_bits), row.map(f64::to_bits));
        }
    }
}

#[test]
fn what_is_no_pose_is_refused_by_name() {
    let refused = |change: &dyn Fn(&mut DMat4)| {
        let mut matrix = DMat4::from_mat3(rotation(DVec3::new(1.0, 2.0, 3.0), 40.0));
        matrix.w_axis = DVec4::new(1.0, 2.0, 3.0, 1.0);
        change(&mut matrix);
        PoseMatrix::WorldToCamera(matrix).view(Convention::OpenCv).unwrap_err()
    };
    let scale = |by: f64| move |m: &mut DMat4| (0..3).for_each(|i| *m.col_mut(i) *= by);
    for (word, error) in [
        ("scale of 2.000000", refused(&scale(2.0))),
        ("scale of 0.990000", refused(&scale(0.99))),
        ("scale of 2.000000", refused(&scale(-2.0))),
        ("mirrored", refused(&|m| m.x_axis = -m.x_axis)),
        ("orthonormal", refused(&|m| m.x_axis.x += 0.001)),
        ("orthonormal", refused(&|m| m.x_axis = m.y_axis)),
        ("orthonormal", refused(&|m| m.x_axis *= 0.5)),
        ("orthonormal", refused(&scale(0.0))),
        ("not finite", refused(&|m| m.w_axis.x = f64::NAN)),
        ("transpose", refused(&|m| *m = m.transpose())),
        ("0, 0, 0, 1", refused(&|m| m.x_axis.w = 0.5)),
        ("0, 0, 0, 1", refused(&|m| m.w_axis.w = 2.0)),
    ] {
        assert!(error.contains(word) && !error.contains('\n'), "{word}: {error}");
    }
    let other = PoseMatrix::WorldToCamera(DMat4::IDENTITY).view(Convention::Vulkan).unwrap_err();
    assert!(other.contains("opencv, opengl or blender"), "{other}");
}

#[test]
fn four_digits_are_enough() {
    for degrees in [10.0, 45.0, 77.0, 123.0] {
        let exact = DMat4::from_mat3(rotation(DVec3::new(0.3, -1.0, 0.5), degrees));
        let rounded =
            DMat4::from_cols_array(&exact.to_cols_array().map(|v| (v * 1e4).round() / 1e4));
        PoseMatrix::WorldToCamera(rounded).view(Convention::OpenGl).unwrap();
    }
}
