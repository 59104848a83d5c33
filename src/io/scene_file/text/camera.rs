//! Parse and write the camera and its keys.

use super::exactly::Exactly;
use crate::io::scene_file::CameraChoice;
use crate::scene::{CameraMotion, Lens, Pose};
use glam::DVec3;

#[derive(serde::Deserialize, serde::Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawCamera {
    size: Option<Exactly<u32, 2>>,
    eye: Option<Exactly<f64, 3>>,
    target: Option<Exactly<f64, 3>>,
    up: Option<Exactly<f64, 3>>,
    keys: Option<Vec<RawKey>>,
    fov: Option<f64>,
    focal: Option<f64>,
    ortho: Option<f64>,
}

/// The camera's pose in a frame.
#[derive(serde::Deserialize, serde::Serialize)]
#[serde(deny_unknown_fields)]
struct RawKey {
    frame: u32,
    eye: Exactly<f64, 3>,
    target: Exactly<f64, 3>,
    up: Option<Exactly<f64, 3>>,
}

impl RawKey {
    fn pose(self) -> (u32, Pose) {
        let [eye, target] = [self.eye, self.target].map(|at| DVec3::from_array(at.0));
        (self.frame, Pose { eye, target, up: self.up.map_or(DVec3::Y, |up| up.0.into()) })
    }

    fn from_key((frame, pose): (u32, Pose)) -> Self {
        let array = |v: DVec3| Exactly(v.to_array());
        Self { frame, eye: array(pose.eye), target: array(pose.target), up: Some(array(pose.up)) }
    }
}

impl RawCamera {
    pub(super) fn choice(self) -> Result<CameraChoice, String> {
        let lenses = [
            self.fov.map(Lens::FieldOfView),
            self.focal.map(Lens::Focal),
            self.ortho.map(Lens::Orthographic),
        ];
        let mut lenses = lenses.into_iter().flatten();
        let lens = lenses.next();
        if lenses.next().is_some() {
            return Err("camera: give one of fov, focal and ortho".into());
        }
        if self.keys.is_some() && (self.eye.is_some() || self.target.is_some() || self.up.is_some())
        {
            let what = "camera: keys replace eye, target and up; remove one or the other";
            return Err(what.into());
        }
        let keys = self.keys.map(|keys| keys.into_iter().map(RawKey::pose).collect());
        let motion = keys.map(CameraMotion::new).transpose().map_err(|error| error.to_string())?;
        let vector = |v: Option<Exactly<f64, 3>>| v.map(|v| DVec3::from_array(v.0));
        Ok(CameraChoice {
            size: self.size.map(|size| size.0),
            eye: vector(self.eye),
            target: vector(self.target),
            up: vector(self.up),
            motion,
            lens,
        })
    }

    pub(super) fn from_choice(choice: &CameraChoice) -> Self {
        let CameraChoice { size, eye, target, up, motion, lens } = choice;
        let array = |v: &Option<DVec3>| v.map(|v| Exactly(v.to_array()));
        let [mut fov, mut focal, mut ortho] = [None; 3];
        match *lens {
            None => {}
            Some(Lens::FieldOfView(degrees)) => fov = Some(degrees),
            Some(Lens::Focal(pixels)) => focal = Some(pixels),
            Some(Lens::Orthographic(height)) => ortho = Some(height),
        }
        Self {
            size: size.map(Exactly),
            eye: array(eye),
            target: array(target),
            up: array(up),
            keys: motion.as_ref().map(|motion| motion.keys().map(RawKey::from_key).collect()),
            fov,
            focal,
            ortho,
        }
    }
}
