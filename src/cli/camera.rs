//! Options that choose the camera.

use glam::{DMat4, DVec3, DVec4};
use splatref::io::scene_file::{CameraChoice, Matrices, SceneFile, Views};
use splatref::scene::camera::stereo::Eye;
use splatref::scene::{Camera, Convention, Intrinsics, Lens, PoseMatrix, Stereo};
use splatref::{Error, Result};
use std::path::PathBuf;

/// The camera; each option replaces the value of a scene file.
#[derive(clap::Args)]
#[command(next_help_heading = "Camera")]
pub(super) struct CameraOptions {
    /// Set the size of the picture in pixels [default: 1024x768]
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[u32; 2]>,
    /// Put the camera here
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    eye: Option<DVec3>,
    /// Point the camera at this place, the middle of the picture
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    target: Option<DVec3>,
    /// Set the direction that is up in the picture
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    up: Option<DVec3>,
    /// Set the vertical field of view in degrees
    #[arg(long, value_name = "DEG", group = "lens", allow_hyphen_values = true)]
    fov: Option<f64>,
    /// Set the focal length in pixels
    #[arg(long, value_name = "PX", group = "lens", allow_hyphen_values = true)]
    focal: Option<f64>,
    /// Use an orthographic camera; the picture is this high in world units
    #[arg(long, value_name = "HEIGHT", group = "lens", allow_hyphen_values = true)]
    ortho: Option<f64>,
    /// Set focal lengths and principal point in pixels of this --size, or give a 3 x 3 matrix K by rows
    #[arg(long, value_name = "FX,FY,CX,CY", group = "lens", value_parser = intrinsics,
        allow_hyphen_values = true)]
    intrinsics: Option<[f64; 4]>,
    /// Set the pose: the matrix from the world to the camera, 12 or 16 numbers by rows
    #[arg(long, value_name = "MATRIX", group = "pose", value_parser = pose, allow_hyphen_values = true,
        conflicts_with = "eye")]
    world_to_camera: Option<DMat4>,
    /// Set the pose: the matrix from the camera to the world, 12 or 16 numbers by rows
    #[arg(long, value_name = "MATRIX", group = "pose", value_parser = pose, allow_hyphen_values = true,
        conflicts_with = "eye")]
    camera_to_world: Option<DMat4>,
    /// Set the lens and the near plane by a projection matrix, 16 numbers by rows, beside a pose
    #[arg(long, value_name = "MATRIX", group = "lens", value_parser = matrix, allow_hyphen_values = true,
        requires = "pose")]
    projection_matrix: Option<DMat4>,
    /// Say whose matrices they are: opencv, opengl or blender; for a projection matrix opengl,
    /// vulkan or d3d
    #[arg(long, value_name = "NAME", value_parser = convention, requires = "pose")]
    convention: Option<Convention>,
    /// Set the depth of the near plane
    #[arg(long, value_name = "DEPTH", allow_hyphen_values = true)]
    near: Option<f64>,
    /// Use the cameras of a file, each as a frame: a transforms.json, a COLMAP folder with cameras.txt
    /// and images.txt, or an .exr that splatref wrote
    #[arg(long, value_name = "FILE", conflicts_with_all = ["eye", "lens", "pose"])]
    cameras: Option<PathBuf>,
    /// Use this camera of the file: its name, or its number from 0
    #[arg(long, value_name = "NAME|N", allow_hyphen_values = true)]
    view: Option<String>,
    /// Turn the camera once around the scene in N frames; the axis is --up, the centre --target or
    /// the middle of the scene
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    turntable: Option<u32>,
    /// Draw a stereo pair: NAME.left.exr and NAME.right.exr, from eyes DISTANCE world units apart that look
    /// along parallel axes and share the choice of surfels. With an eye, draw this picture alone
    #[arg(long, value_name = "DISTANCE[,left|right]", value_parser = stereo, allow_hyphen_values = true)]
    stereo: Option<Stereo>,
}

impl CameraOptions {
    /// Applies the options to a scene.
    pub(super) fn apply(&self, file: &mut SceneFile) -> Result<()> {
        let camera = &mut file.camera;
        self.clear(camera);
        replace(&mut camera.size, self.size);
        replace(&mut camera.eye, self.eye);
        replace(&mut camera.target, self.target);
        replace(&mut camera.up, self.up);
        replace(&mut camera.lens, self.fov.map(Lens::FieldOfView));
        replace(&mut camera.lens, self.focal.map(Lens::Focal));
        replace(&mut camera.lens, self.ortho.map(Lens::Orthographic));
        replace(&mut camera.near, self.near);
        replace(&mut camera.turntable, self.turntable);
        replace(&mut camera.stereo, self.stereo);
        if let Some([fx, fy, cx, cy]) = self.intrinsics {
            let size = camera.size.ok_or_else(|| {
                let what = "--intrinsics belong to a picture; give its --size";
                Error::Usage(what.into())
            })?;
            let c = [cx, cy];
            camera.intrinsics = Some(Intrinsics { c, ..Intrinsics::centered(size, [fx, fy]) });
        }
        let usage = |what: String| Error::Usage(what);
        self.matrices().apply(camera).map_err(usage)?;
        self.choose_views(camera)?;
        camera.check().map_err(usage)
    }

    fn matrices(&self) -> Matrices {
        let pose = self.world_to_camera.map(PoseMatrix::WorldToCamera);
        let pose = pose.or(self.camera_to_world.map(PoseMatrix::CameraToWorld));
        Matrices { pose, projection: self.projection_matrix, convention: self.convention }
    }

    /// Drops the parts of a scene file that the options replace.
    fn clear(&self, camera: &mut CameraChoice) {
        let posed = self.world_to_camera.or(self.camera_to_world).is_some();
        // A turntable has target and up beside any pose.
        let turned = self.turntable.or(camera.turntable).is_some();
        let aimed = self.eye.is_some() || (!turned && self.target.or(self.up).is_some());
        let lens = self.fov.or(self.focal).or(self.ortho).is_some();
        if posed || self.cameras.is_some() {
            (camera.eye, camera.target, camera.up) = (None, None, None);
        }
        if posed || aimed || self.cameras.is_some() {
            (camera.motion, camera.view, camera.offset) = (None, None, DVec3::ZERO);
            camera.other_eye = None;
        }
        if posed || aimed || lens || self.intrinsics.is_some() {
            camera.views = None;
        }
        if self.cameras.is_some() {
            // The camera of an eye's picture is that eye already.
            camera.stereo = None;
        }
        if lens || self.cameras.is_some() {
            camera.intrinsics = None;
        }
        if self.intrinsics.is_some() || self.projection_matrix.is_some() || self.cameras.is_some() {
            (camera.lens, camera.intrinsics) = (None, None);
        }
        if self.projection_matrix.is_some() || self.cameras.is_some() {
            (camera.near, camera.far) = (self.near, None);
        }
    }

    fn choose_views(&self, camera: &mut CameraChoice) -> Result<()> {
        let own = camera.views.as_ref();
        let path = self.cameras.clone().or_else(|| own.map(|views| views.path.clone()));
        match (path, &self.view) {
            (None, None) => {}
            (Some(_), None) if self.cameras.is_none() => {}
            (None, Some(_)) => {
                let what = "--view chooses from a camera file; give --cameras FILE";
                return Err(Error::Usage(what.into()));
            }
            (Some(path), view) => camera.views = Some(Views::read(&path, view.clone())?),
        }
        Ok(())
    }
}

/// Replaces a value if there is a new one.
pub(super) fn replace<T>(chosen: &mut Option<T>, by: Option<T>) {
    if by.is_some() {
        *chosen = by;
    }
}

/// Parses `640x480`.
fn size(text: &str) -> std::result::Result<[u32; 2], String> {
    let sides = text.split_once('x').and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    let size: [u32; 2] = sides.ok_or("give the width and the height in pixels, such as 640x480")?;
    Camera::check_size(size[0], size[1]).map_err(|error| error.to_string())?;
    Ok(size)
}

/// Parses `0.065` or `0.065,left`.
fn stereo(text: &str) -> std::result::Result<Stereo, String> {
    let (distance, eye) = text.split_once(',').map_or((text, None), |(a, b)| (a, Some(b.trim())));
    let distance = distance
        .trim()
        .parse()
        .map_err(|_| "give a distance, or one with an eye as in 0.065,left")?;
    let stereo = Stereo { distance, eye: eye.map(Eye::by_name).transpose()? };
    stereo.check().map(|()| stereo)
}

/// Parses `1,-2.5,3`.
fn vector(text: &str) -> std::result::Result<DVec3, String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|v| v.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y, z]) => Ok(DVec3::new(x, y, z)),
        _ => Err("give three numbers, such as 1,-2.5,3".into()),
    }
}

/// Numbers between commas, blanks, lines, semicolons or brackets, so that a matrix can be pasted.
fn numbers(text: &str) -> std::result::Result<Vec<f64>, String> {
    let between = |c: char| c.is_whitespace() || ",;[](){}".contains(c);
    let words = text.split(between).filter(|word| !word.is_empty());
    words.map(|word| word.parse().map_err(|_| format!("`{word}` is no number"))).collect()
}

/// Parses a pose of three or four rows.
fn pose(text: &str) -> std::result::Result<DMat4, String> {
    let mut numbers = numbers(text)?;
    if numbers.len() == 12 {
        numbers.extend(DVec4::W.to_array());
    }
    by_rows(&numbers)
        .ok_or_else(|| "give 12 or 16 numbers by rows, such as 1,0,0,0,0,1,0,0,...".into())
}

/// Parses a matrix of four rows.
fn matrix(text: &str) -> std::result::Result<DMat4, String> {
    by_rows(&numbers(text)?).ok_or_else(|| "give 16 numbers by rows".into())
}

fn by_rows(numbers: &[f64]) -> Option<DMat4> {
    let rows: [f64; 16] = numbers.try_into().ok()?;
    Some(DMat4::from_cols_array(&rows).transpose())
}

/// Parses `FX,FY,CX,CY`, or the nine numbers of K.
fn intrinsics(text: &str) -> std::result::Result<[f64; 4], String> {
    match *numbers(text)?.as_slice() {
        [fx, fy, cx, cy] => Ok([fx, fy, cx, cy]),
        [fx, skew, cx, zero, fy, cy, a, b, one] => {
            if skew != 0.0 {
                return Err(format!("K has skew {skew}; splatref draws without skew, so give 0"));
            }
            if [zero, a, b, one] != [0.0, 0.0, 0.0, 1.0] {
                return Err("K is no matrix [fx 0 cx; 0 fy cy; 0 0 1]; give it by rows".into());
            }
            Ok([fx, fy, cx, cy])
        }
        _ => Err("give FX,FY,CX,CY, or the nine numbers of K by rows".into()),
    }
}

/// Parses the name of a convention.
fn convention(text: &str) -> std::result::Result<Convention, String> {
    Convention::by_name(text)
}
