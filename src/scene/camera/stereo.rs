//! Stereo pairs: two cameras side by side that draw the same surfels.
//!
//! The eyes of a pair look along parallel axes. They stand half the distance d to the left and to
//! the right of a given camera, along its own x axis. V03 is the last element of the first row of the
//! given camera's view matrix, converted from `f32`. In f64, rounded to `f32` once:
//!
//! ```text
//!   left eye    V03 + d / 2
//!   right eye   V03 - d / 2
//! ```
//!
//! All other numbers of both cameras are the given camera's. Each camera also has the V03 of the
//! other eye, [`Camera::other_eye`], so that one picture of a pair can be drawn again alone.
//! [`crate::scene::objects::detail`] says how the two eyes share the choice of surfels.
//!
//! `Decided:` the axes are parallel. The paper renders "in stereo" for a head-mounted display
//! \[BJFM19, 1, 5\], and does not say how the cameras of the eyes stand. Displays with other frusta
//! have a [projection matrix](super::clip) for each eye.

use super::{Camera, MAX_DISTANCE};
use crate::error::{Error, Result};

/// An eye of a stereo pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Eye {
    /// The left eye.
    Left,
    /// The right eye.
    Right,
}

impl Eye {
    /// Both eyes, the left one first.
    pub const BOTH: [Self; 2] = [Self::Left, Self::Right];

    /// `left` or `right`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Left => "left",
            Self::Right => "right",
        }
    }

    /// The eye with this name.
    ///
    /// # Errors
    /// One line if there is none.
    pub fn by_name(name: &str) -> std::result::Result<Self, String> {
        let found = Self::BOTH.into_iter().find(|eye| eye.name() == name);
        found.ok_or_else(|| format!("stereo: no eye `{name}`; give left or right"))
    }
}

/// A stereo pair, or one eye of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stereo {
    /// d: the distance between the eyes in world units, greater than 0.
    pub distance: f64,
    /// The eye to draw; none for both.
    pub eye: Option<Eye>,
}

impl Stereo {
    /// Checks that eyes can be this far apart.
    ///
    /// # Errors
    /// One line if they cannot.
    pub fn check(self) -> std::result::Result<(), String> {
        let distance = self.distance;
        if distance > 0.0 && distance <= MAX_DISTANCE {
            return Ok(());
        }
        Err(format!(
            "stereo: eyes {distance} apart; give a distance above 0, in the units of the scene"
        ))
    }

    /// The eye, for callers that draw one picture.
    ///
    /// # Errors
    /// [`Error::Usage`] if none is chosen.
    pub fn one_eye(self) -> Result<Eye> {
        let distance = self.distance;
        self.eye.ok_or_else(|| {
            Error::Usage(format!(
                "a stereo pair is two pictures, and only `splatref render` draws both; choose an eye: \
                 --stereo {distance},left, or stereo_eye = \"left\" in [camera]"
            ))
        })
    }

    /// The camera of the eye beside a given camera, see the [module](self).
    ///
    /// # Errors
    /// As [`Stereo::one_eye`]. [`Error::Invalid`] as [`Stereo::check`], or if the distance that `f32`
    /// can store between the eyes differs by more than a sixteenth.
    pub fn camera(self, given: Camera) -> Result<Camera> {
        self.check().map_err(Error::Invalid)?;
        let (eye, distance) = (self.one_eye()?, self.distance);
        let middle = f64::from(given.view_from_world.w_axis.x);
        let [left, right] = [middle + distance / 2.0, middle - distance / 2.0].map(|x| x as f32);
        let stored = f64::from(left) - f64::from(right);
        // NaN and infinity fail this test too.
        if !((stored - distance).abs() <= distance / 16.0) {
            return Err(Error::Invalid(format!(
                "stereo: f32 has too few digits for eyes {distance} apart at this place; move the scene \
                 closer to the origin, or give another distance"
            )));
        }
        let (own, other) = match eye {
            Eye::Left => (left, right),
            Eye::Right => (right, left),
        };
        let mut camera = Camera { other_eye: Some(other), ..given };
        camera.view_from_world.w_axis.x = own;
        Ok(camera)
    }
}

impl Camera {
    /// The camera of the other eye, if this is an eye of a [stereo pair](self).
    #[must_use]
    pub fn seen_by_other_eye(&self) -> Option<Self> {
        let own = self.view_from_world.w_axis.x;
        let mut other = Self { other_eye: Some(own), ..*self };
        other.view_from_world.w_axis.x = self.other_eye?;
        Some(other)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Lens, Pose};
    use glam::DVec3;

    fn given(eye: DVec3) -> Camera {
        let pose = Pose { eye, target: eye - DVec3::Z, up: DVec3::Y };
        Camera::new(64, 48, pose, Lens::FieldOfView(40.0)).unwrap()
    }

    #[test]
    fn the_eyes_stand_beside_the_camera() {
        let middle = given(DVec3::new(1.0, 2.0, 3.0));
        let eye = |eye| Stereo { distance: 0.25, eye: Some(eye) }.camera(middle).unwrap();
        let [left, right] = Eye::BOTH.map(eye);
        assert_eq!(left.eye(), DVec3::new(0.875, 2.0, 3.0));
        assert_eq!(right.eye(), DVec3::new(1.125, 2.0, 3.0));
        assert_eq!(left.seen_by_other_eye(), Some(right));
        assert_eq!(right.seen_by_other_eye(), Some(left));
        assert_eq!(middle.seen_by_other_eye(), None);
        let view_from_world = middle.view_from_world;
        assert_eq!(Camera { view_from_world, other_eye: None, ..left }, middle);
    }

    #[test]
    fn distances_that_are_none_are_refused() {
        let refused = |distance, middle| {
            let stereo = Stereo { distance, eye: Some(Eye::Left) };
            stereo.camera(middle).unwrap_err().to_string()
        };
        for distance in [0.0, -0.065, f64::NAN, f64::INFINITY, 1e39] {
            let line = refused(distance, given(DVec3::ZERO));
            assert!(line.contains("give a distance above 0"), "{line}");
        }
        // At 10^7, the steps of f32 are 1.
        let line = refused(0.065, given(DVec3::X * 1e7));
        assert!(line.contains("too few digits"), "{line}");
        let both = Stereo { distance: 0.065, eye: None };
        let line = both.camera(given(DVec3::ZERO)).unwrap_err().to_string();
        assert!(line.contains("--stereo 0.065,left"), "{line}");
    }
}
