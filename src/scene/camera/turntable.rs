//! Turn a camera around a scene, in even steps.
//!
//! Frame k of n shows the scene from the first camera, turned by 360 k / n degrees about an axis.
//! The camera goes counter-clockwise, seen from the tip of the axis, and keeps its distance from the
//! axis and its height. Frame 0 is the first camera, bit for bit. Every frame
//! has its size, focal lengths, principal point and near plane, and is no eye of a stereo pair. With R =
//! [`rotation`] of (axis, 360 k / n), c the centre, and Lij and t of
//! the first view matrix converted from `f32`, in f64:
//!
//! ```text
//!   degrees  (360 k) / n
//!   Mij      (Li0 Rj0 + Li1 Rj1) + Li2 Rj2                                  L R^T
//!   ui       ti + (((Li0 - Mi0) c0 + (Li1 - Mi1) c1) + (Li2 - Mi2) c2)      t + (L - M) c
//! ```
//!
//! The view matrix has the elements Mij and the last column u, rounded to `f32` once.

use super::Camera;
use crate::error::{Error, Result};
use crate::scene::transform::{is_axis, rotation};
use glam::{DMat4, DVec3, DVec4};

/// A camera that goes round, see the [module](self).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turntable {
    first: Camera,
    center: DVec3,
    axis: DVec3,
    frames: u32,
}

impl Turntable {
    /// Turns `first` around an axis through `center` in this many frames.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there is no frame, or if the axis is 0 or not finite.
    pub fn new(first: Camera, center: DVec3, axis: DVec3, frames: u32) -> Result<Self> {
        if frames == 0 {
            return Err(Error::Invalid("camera: a turntable of 0 frames; give 1 or more".into()));
        }
        if !(is_axis(axis) && center.is_finite()) {
            let what = "camera: a turntable needs an axis (up) that is not 0, and a finite centre";
            return Err(Error::Invalid(what.into()));
        }
        // The other eye would stand still while this one turns.
        let first = Camera { other_eye: None, ..first };
        Ok(Self { first, center, axis, frames })
    }

    /// The camera in a frame.
    #[must_use]
    pub fn at(&self, frame: u32) -> Camera {
        let frame = frame % self.frames;
        if frame == 0 {
            return self.first;
        }
        let degrees = 360.0 * f64::from(frame) / f64::from(self.frames);
        let turn = rotation(self.axis, degrees);
        let view = self.first.view_from_world.as_dmat4();
        let row = |i: usize| {
            let (l, t) = (view.row(i).truncate(), view.row(i).w);
            let dot = |a: DVec3, b: DVec3| (a.x * b.x + a.y * b.y) + a.z * b.z;
            let m = DVec3::from_array([0, 1, 2].map(|j| dot(l, turn.row(j))));
            (m + DVec3::ZERO).extend(t + dot(l - m, self.center))
        };
        let rows = DMat4::from_cols(row(0), row(1), row(2), DVec4::W);
        Camera { view_from_world: rows.transpose().as_mat4(), ..self.first }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Lens, Pose};

    #[test]
    fn the_camera_goes_round_at_its_height_and_distance() {
        let pose = Pose {
            eye: DVec3::new(2.0, 1.5, 4.0),
            target: DVec3::new(0.5, 0.0, 0.0),
            up: DVec3::Y,
        };
        let first = Camera::new(64, 48, pose, Lens::FieldOfView(40.0)).unwrap();
        let first = Camera { cx: 20.0, fx: 50.0, ..first };
        let center = DVec3::new(0.25, -1.0, 0.5);
        let turntable = Turntable::new(first, center, DVec3::Y * 3.0, 4).unwrap();
        assert_eq!(turntable.at(0), first);
        assert_eq!(turntable.at(4), first);
        // A quarter turn about +y takes +z to +x.
        let arm = pose.eye - center;
        let places = [arm, DVec3::new(arm.z, arm.y, -arm.x), DVec3::new(-arm.x, arm.y, -arm.z)];
        for (frame, place) in (0..).zip(places) {
            let camera = turntable.at(frame);
            assert!((camera.eye() - center - place).length() < 1e-6, "{frame}: {}", camera.eye());
            assert_eq!(Camera { view_from_world: first.view_from_world, ..camera }, first);
        }
        // The centre stays where it is in the picture.
        for frame in 0..4 {
            let seen = turntable.at(frame).view_from_world.as_dmat4().transform_point3(center);
            let still = first.view_from_world.as_dmat4().transform_point3(center);
            assert!((seen - still).length() < 1e-6, "{frame}");
        }
    }

    #[test]
    fn what_cannot_turn_is_refused() {
        let pose = Pose { eye: DVec3::Z, target: DVec3::ZERO, up: DVec3::Y };
        let first = Camera::new(4, 3, pose, Lens::Focal(4.0)).unwrap();
        let refused = |axis, frames| Turntable::new(first, DVec3::ZERO, axis, frames).unwrap_err();
        assert!(refused(DVec3::Y, 0).to_string().contains("0 frames"));
        assert!(refused(DVec3::ZERO, 4).to_string().contains("axis"));
    }
}
