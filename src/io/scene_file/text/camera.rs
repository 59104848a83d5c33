//! Parse and write the camera and its keys.

use super::exactly::Exactly;
use super::folder::Folder;
use crate::io::scene_file::{CameraChoice, Matrices, Views};
use crate::scene::camera::convention::check_view;
use crate::scene::camera::stereo::Eye;
use crate::scene::{
    CameraMotion, Convention, Intrinsics, Lens, Pose, PoseMatrix, Projection, Stereo,
};
use glam::{DMat4, DVec3, DVec4};
use std::path::PathBuf;

/// A matrix by rows; three rows stand for four.
type Rows = Vec<Exactly<f64, 4>>;

#[derive(Default, serde::Deserialize, serde::Serialize)]
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
    fx: Option<f64>,
    fy: Option<f64>,
    cx: Option<f64>,
    cy: Option<f64>,
    projection: Option<String>,
    f: Option<Exactly<f64, 2>>,
    c: Option<Exactly<f64, 2>>,
    near: Option<f64>,
    far: Option<f64>,
    convention: Option<String>,
    world_to_camera: Option<Rows>,
    camera_to_world: Option<Rows>,
    projection_matrix: Option<Rows>,
    view_from_world: Option<Rows>,
    offset: Option<Exactly<f64, 3>>,
    file: Option<PathBuf>,
    view: Option<RawView>,
    turntable: Option<u32>,
    stereo: Option<f64>,
    stereo_eye: Option<String>,
    other_eye: Option<f64>,
}

/// The name or the number of a view.
#[derive(serde::Deserialize, serde::Serialize)]
#[serde(untagged)]
enum RawView {
    Number(u64),
    Name(String),
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
        let lens = self.lens()?;
        let intrinsics = self.intrinsics()?;
        let matrices = self.matrices()?;
        let view = self.view_matrix(&matrices)?;
        let stereo = self.stereo()?;
        if self.keys.is_some() && (self.eye.is_some() || self.target.is_some() || self.up.is_some())
        {
            let what = "camera: keys replace eye, target and up; remove one or the other";
            return Err(what.into());
        }
        let keys = self.keys.map(|keys| keys.into_iter().map(RawKey::pose).collect());
        let motion = keys.map(CameraMotion::new).transpose().map_err(|error| error.to_string())?;
        let name = self.view.map(|view| match view {
            RawView::Number(number) => number.to_string(),
            RawView::Name(name) => name,
        });
        if self.file.is_none() && name.is_some() {
            return Err("camera: view chooses from a camera file; add file, or remove view".into());
        }
        let vector = |v: Option<Exactly<f64, 3>>| v.map(|v| DVec3::from_array(v.0));
        let offset = vector(self.offset).unwrap_or(DVec3::ZERO);
        let mut choice = CameraChoice {
            size: self.size.map(|size| size.0),
            eye: vector(self.eye),
            target: vector(self.target),
            up: vector(self.up),
            motion,
            view,
            offset,
            lens,
            intrinsics,
            near: self.near,
            far: self.far,
            views: self.file.map(|path| Views::unread(path, name)),
            turntable: self.turntable,
            stereo,
            other_eye: self.other_eye,
        };
        matrices.apply(&mut choice)?;
        choice.check()?;
        Ok(choice)
    }

    fn lens(&self) -> Result<Option<Lens>, String> {
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
        Ok(lens)
    }

    /// The intrinsics from `fx`, `fy`, `cx` and `cy`, or from `f` and `c`.
    fn intrinsics(&self) -> Result<Option<Intrinsics>, String> {
        let single = [self.fx, self.fy, self.cx, self.cy].iter().any(Option::is_some);
        let pairs = self.f.is_some() || self.c.is_some() || self.projection.is_some();
        if !single && !pairs {
            return Ok(None);
        }
        let f = match (self.f, self.fx) {
            (Some(f), None) if !single => f.0,
            (None, Some(fx)) if !pairs => [fx, self.fy.unwrap_or(fx)],
            _ => {
                let what = "camera: intrinsics are fx, fy, cx and cy, or f and c with projection; \
                            give fx or f";
                return Err(what.into());
            }
        };
        let size = self.size.ok_or("camera: intrinsics belong to a picture; give its size")?.0;
        let mut intrinsics = Intrinsics::centered(size, f);
        let [cx, cy] = self.c.map_or([self.cx, self.cy], |c| c.0.map(Some));
        for (c, given) in intrinsics.c.iter_mut().zip([cx, cy]) {
            *c = given.unwrap_or(*c);
        }
        intrinsics.projection = match self.projection.as_deref() {
            None | Some("perspective") => Projection::Perspective,
            Some("orthographic") => Projection::Orthographic,
            Some(other) => {
                return Err(format!(
                    "camera: projection `{other}`; give \"perspective\" or \"orthographic\" \
                     (a matrix is projection_matrix)"
                ));
            }
        };
        Ok(Some(intrinsics))
    }

    fn stereo(&self) -> Result<Option<Stereo>, String> {
        if self.stereo.is_none() && self.stereo_eye.is_some() {
            return Err(
                "camera: stereo_eye chooses an eye of a pair; add stereo, or remove it".into()
            );
        }
        let eye = self.stereo_eye.as_deref().map(Eye::by_name).transpose()?;
        Ok(self.stereo.map(|distance| Stereo { distance, eye }))
    }

    fn matrices(&self) -> Result<Matrices, String> {
        let pose = match (&self.world_to_camera, &self.camera_to_world) {
            (None, None) => None,
            (Some(rows), None) => Some(PoseMatrix::WorldToCamera(matrix(rows, "world_to_camera")?)),
            (None, Some(rows)) => Some(PoseMatrix::CameraToWorld(matrix(rows, "camera_to_world")?)),
            (Some(_), Some(_)) => {
                return Err("camera: give one of world_to_camera and camera_to_world".into());
            }
        };
        let projection = self.projection_matrix.as_ref();
        let projection = projection.map(|rows| matrix(rows, "projection_matrix")).transpose()?;
        let known =
            |name: &String| Convention::by_name(name).map_err(|what| format!("camera: {what}"));
        let convention = self.convention.as_ref().map(known).transpose()?;
        Ok(Matrices { pose, projection, convention })
    }

    /// The view matrix as splatref writes it.
    fn view_matrix(&self, others: &Matrices) -> Result<Option<DMat4>, String> {
        let Some(rows) = &self.view_from_world else {
            return match self.offset {
                None => Ok(None),
                Some(_) => Err("camera: offset belongs to view_from_world; remove it".into()),
            };
        };
        if self.offset.is_some_and(|offset| !DVec3::from_array(offset.0).is_finite()) {
            return Err("camera: the offset must be finite numbers".into());
        }
        if others.pose.is_some() || others.projection.is_some() || others.convention.is_some() {
            let what = "camera: view_from_world is the whole pose, in splatref's axes; remove it, \
                        or the other matrices and the convention";
            return Err(what.into());
        }
        let view = matrix(rows, "view_from_world")?;
        check_view(&view).map_err(|what| format!("camera: {what}"))?;
        Ok(Some(view))
    }

    pub(super) fn from_choice(choice: &CameraChoice, place: &Folder) -> Self {
        let CameraChoice { size, eye, target, up, motion, lens, near, far, .. } = choice;
        let array = |v: &Option<DVec3>| v.map(|v| Exactly(v.to_array()));
        let [mut fov, mut focal, mut ortho] = [None; 3];
        match *lens {
            None => {}
            Some(Lens::FieldOfView(degrees)) => fov = Some(degrees),
            Some(Lens::Focal(pixels)) => focal = Some(pixels),
            Some(Lens::Orthographic(height)) => ortho = Some(height),
        }
        let intrinsics = choice.intrinsics.map(|all| size.map_or(all, |size| all.resized(size)));
        let projection = intrinsics.map(|intrinsics| match intrinsics.projection {
            Projection::Perspective => "perspective".to_owned(),
            Projection::Orthographic => "orthographic".to_owned(),
        });
        let rows = |m: &DMat4| (0..4).map(|i| Exactly(m.row(i).to_array())).collect();
        let views = choice.views.as_ref();
        Self {
            size: size.or(intrinsics.map(|intrinsics| intrinsics.size)).map(Exactly),
            eye: array(eye),
            target: array(target),
            up: array(up),
            keys: motion.as_ref().map(|motion| motion.keys().map(RawKey::from_key).collect()),
            fov,
            focal,
            ortho,
            projection,
            f: intrinsics.map(|intrinsics| Exactly(intrinsics.f)),
            c: intrinsics.map(|intrinsics| Exactly(intrinsics.c)),
            near: *near,
            far: far.filter(|far| far.is_finite()),
            view_from_world: choice.view.as_ref().map(rows),
            offset: (choice.offset != DVec3::ZERO).then(|| Exactly(choice.offset.to_array())),
            file: views.map(|views| place.path(&views.path)),
            view: views.and_then(|views| views.view.clone()).map(RawView::Name),
            turntable: choice.turntable,
            stereo: choice.stereo.map(|stereo| stereo.distance),
            stereo_eye: choice
                .stereo
                .and_then(|stereo| stereo.eye)
                .map(|eye| eye.name().to_owned()),
            other_eye: choice.other_eye,
            ..Self::default()
        }
    }
}

/// A matrix from three or four rows.
fn matrix(rows: &Rows, key: &str) -> Result<DMat4, String> {
    let row = |i: usize| rows.get(i).map_or(DVec4::W, |row| DVec4::from_array(row.0));
    match rows.len() {
        4 => {}
        3 if key != "projection_matrix" => {}
        other => return Err(format!("camera: {key} has {other} rows; give 4 rows of 4 numbers")),
    }
    Ok(DMat4::from_cols(row(0), row(1), row(2), row(3)).transpose())
}
