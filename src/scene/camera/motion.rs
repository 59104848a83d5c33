//! Move a camera over the frames of a sequence.
//!
//! A [`CameraMotion`] is a list of keys, each a frame and a [`Pose`]. In a frame that has a key,
//! the pose is the key's pose, bit for bit. Before the first key it is the first pose, and after
//! the last key the last. Between two equal poses it is that pose. Between other keys a and b
//! everything is computed in f64, for a frame f:
//!
//! ```text
//!   s         (f - f_a) / (f_b - f_a), with the frames of the keys
//!   eye       a + s (b - a), each component
//!   distance  a + s (b - a), of the distances from eye to target
//!   m         between the rotations of a and b, as crate::scene::objects::motion has it
//!   target    eye - m's third column distance, each component
//!   up        m's second column
//! ```
//!
//! The rotation of a pose has the columns r, v and b, and its distance is `distance` of
//! [`super::Camera::new`]. That function then makes the camera from this eye, target and up.

use super::{Pose, axes};
use crate::error::{Error, Result};
use crate::scene::slerp::slerp;
use glam::DMat3;

/// Where a camera is over the frames of a sequence, see the [module](self).
#[derive(Clone, Debug, PartialEq)]
pub struct CameraMotion {
    keys: Vec<Key>,
}

#[derive(Clone, Debug, PartialEq)]
struct Key {
    frame: u32,
    pose: Pose,
    axes: DMat3,
    distance: f64,
}

impl CameraMotion {
    /// Makes a motion from keys in ascending frames.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there is no key, if frames do not ascend, or, for a pose, as
    /// [`super::Camera::new`].
    pub fn new(keys: Vec<(u32, Pose)>) -> Result<Self> {
        if keys.is_empty() {
            return Err(Error::Invalid("camera: there are no keys; add one".into()));
        }
        for pair in keys.windows(2) {
            let [before, after] = [pair[0].0, pair[1].0];
            if before >= after {
                return Err(Error::Invalid(format!(
                    "camera: the key of frame {after} follows the key of frame {before}; sort keys \
                     by frame"
                )));
            }
        }
        let key = |(frame, pose)| {
            let (axes, distance) = axes(pose)?;
            Ok(Key { frame, pose, axes, distance })
        };
        Ok(Self { keys: keys.into_iter().map(key).collect::<Result<_>>()? })
    }

    /// The keys, in ascending frames.
    pub fn keys(&self) -> impl Iterator<Item = (u32, Pose)> {
        self.keys.iter().map(|key| (key.frame, key.pose))
    }

    /// The pose in a frame.
    #[must_use]
    pub fn at(&self, frame: u32) -> Pose {
        let after = self.keys.partition_point(|key| key.frame < frame);
        let (Some(b), Some(before)) = (self.keys.get(after), after.checked_sub(1)) else {
            let nearest = if after == 0 { 0 } else { self.keys.len() - 1 };
            return self.keys[nearest].pose;
        };
        let a = &self.keys[before];
        // No arithmetic, so that the pose keeps its bits.
        if b.frame == frame || a.pose == b.pose {
            return b.pose;
        }
        let s = f64::from(frame - a.frame) / f64::from(b.frame - a.frame);
        let eye = a.pose.eye + s * (b.pose.eye - a.pose.eye);
        let distance = a.distance + s * (b.distance - a.distance);
        let axes = slerp(&a.axes, &b.axes, s);
        Pose { eye, target: eye - axes.z_axis * distance, up: axes.y_axis }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn pose(eye: DVec3, target: DVec3) -> Pose {
        Pose { eye, target, up: DVec3::Y }
    }

    #[test]
    fn keys_are_met_and_held() {
        let [a, b] = [pose(DVec3::Z, DVec3::ZERO), pose(DVec3::X * 3.0, DVec3::ZERO)];
        let motion = CameraMotion::new(vec![(2, a), (6, b)]).unwrap();
        assert_eq!([0, 2, 6, 9].map(|frame| motion.at(frame)), [a, a, b, b]);
        let rest = CameraMotion::new(vec![(0, a), (6, a)]).unwrap();
        assert_eq!(rest.at(3), a);
    }

    #[test]
    fn between_keys_eye_distance_and_turn_are_even() {
        // From looking along -z to looking along -x: a quarter turn about y.
        let a = pose(DVec3::new(0.0, 0.0, 1.0), DVec3::ZERO);
        let b = pose(DVec3::new(3.0, 0.0, 0.0), DVec3::ZERO);
        let middle = CameraMotion::new(vec![(0, a), (4, b)]).unwrap().at(2);
        assert_eq!(middle.eye, DVec3::new(1.5, 0.0, 0.5));
        let sight = middle.target - middle.eye;
        let half = 2.0 * 0.5_f64.sqrt();
        assert!((sight - DVec3::new(-half, 0.0, -half)).length() < 1e-14, "{sight}");
        assert!((middle.up - DVec3::Y).length() < 1e-15, "{}", middle.up);
    }

    #[test]
    fn keys_that_are_none_are_refused() {
        let one = pose(DVec3::Z, DVec3::ZERO);
        let words = |keys| CameraMotion::new(keys).unwrap_err().to_string();
        assert!(words(vec![]).contains("no keys"));
        assert!(words(vec![(3, one), (3, one)]).contains("sort keys by frame"));
        assert!(words(vec![(0, one), (1, pose(DVec3::Z, DVec3::Z))]).contains("the same point"));
        assert!(words(vec![(0, pose(DVec3::Y, DVec3::ZERO))]).contains("parallel"));
    }
}
