//! The cameras for flicker: [`FRAMES`] pictures each.

use crate::scene::Camera;
use glam::{DMat4, DVec3};

/// How many pictures flicker is measured on.
pub const FRAMES: u32 = 8;
/// The camera's turn from picture to picture along its path, in degrees.
pub const DEGREES: f64 = 0.25;

/// Shifts below a pixel, in eighths. Frame i moves by i to the right and by 3 i mod 8 down, so each
/// eighth occurs once in either direction.
#[must_use]
pub fn shifts() -> Vec<[u32; 2]> {
    (0..FRAMES).map(|i| [i, 3 * i % FRAMES]).collect()
}

/// The camera, shifted.
#[must_use]
pub fn shifted(camera: &Camera) -> Vec<Camera> {
    let eighths = |k: u32| k as f32 / 8.0;
    let shift = |[right, down]: [u32; 2]| Camera {
        cx: camera.cx + eighths(right),
        cy: camera.cy + eighths(down),
        ..*camera
    };
    shifts().into_iter().map(shift).collect()
}

/// The camera on a path around its target. Frame i is turned by [`DEGREES`] i about the vertical
/// axis of the picture, through the point 1024 times as far away as the near plane. For a camera
/// from [`Camera::new`] this point is its target. Computed in f64, rounded once.
///
/// An orthographic camera uses the same axis.
#[must_use]
pub fn path(camera: &Camera) -> Vec<Camera> {
    let target = DVec3::new(0.0, 0.0, -1024.0 * f64::from(camera.near));
    let view = camera.view_from_world.as_dmat4();
    let turned = |i: u32| {
        let turn = DMat4::from_rotation_y((DEGREES * f64::from(i)).to_radians());
        let around = DMat4::from_translation(target) * turn * DMat4::from_translation(-target);
        let view_from_world =
            if i == 0 { camera.view_from_world } else { (around * view).as_mat4() };
        Camera { view_from_world, ..*camera }
    };
    (0..FRAMES).map(turned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Lens, Pose};
    use std::collections::BTreeSet;

    fn camera() -> Camera {
        let (eye, target, up) = (DVec3::new(1.0, 2.0, 6.0), DVec3::new(1.0, 0.5, 0.0), DVec3::Y);
        Camera::new(64, 48, Pose { eye, target, up }, Lens::FieldOfView(40.0)).unwrap()
    }

    #[test]
    fn shifts_are_all_eighths() {
        let all = shifted(&camera());
        assert_eq!(all[0], camera());
        for of in [|c: &Camera| c.cx - 32.0, |c: &Camera| c.cy - 24.0] {
            let shifts: BTreeSet<u32> = all.iter().map(|c| (8.0 * of(c)) as u32).collect();
            assert_eq!(shifts, (0..8).collect());
        }
    }

    #[test]
    fn the_path_keeps_the_target_in_its_place() {
        let all = path(&camera());
        assert_eq!(all[0], camera());
        let seen =
            |camera: &Camera, point| camera.view_from_world.as_dmat4().transform_point3(point);
        let (target, distance) = (DVec3::new(1.0, 0.5, 0.0), 38.25_f64.sqrt());
        for camera in &all {
            let at = seen(camera, target);
            assert!((at - DVec3::new(0.0, 0.0, -distance)).length() < 1e-5, "{at}");
            camera.check().unwrap();
        }
        // A point in front of the target moves on a circle, 7 steps of a quarter of a degree.
        let eye = all.iter().map(|camera| seen(camera, DVec3::new(1.0, 2.0, 6.0)));
        let eyes: Vec<DVec3> = eye.collect();
        let chord = 2.0 * distance * crate::number::elementary::sin((1.75_f64 / 2.0).to_radians());
        assert!(((eyes[7] - eyes[0]).length() - chord).abs() < 1e-5);
    }
}
