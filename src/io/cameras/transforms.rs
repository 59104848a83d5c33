//! Read `transforms.json`, which nerfstudio, instant-ngp and exports from Blender write.
//!
//! Keys of a frame replace the keys of the file.
//!
//! | key | meaning |
//! |---|---|
//! | `frames` | the list of views |
//! | `transform_matrix` | camera to world, by rows, in the convention `opengl` |
//! | `file_path` | the name of the view |
//! | `w h` | the size of the picture in pixels |
//! | `fl_x fl_y` | focal lengths in pixels |
//! | `camera_angle_x camera_angle_y` | else the angles that width and height span, in radians |
//! | `x_fov y_fov` | else the same in degrees |
//! | `cx cy` | the principal point; the middle of the picture if absent |
//! | `camera_model` | `PINHOLE`, `SIMPLE_PINHOLE`, or a model below whose coefficients are 0 |
//! | `k1 ... k6 p1 p2` | must be 0 or absent |
//! | `is_fisheye` | must be false or absent |
//!
//! Without `fl_y` and its angle, fy is fx. Without `w` and `h`, the size is the size of the PNG
//! that `file_path` names (`.png` may be missing), if that is there; else the caller must choose
//! one. Every other key is skipped, `applied_transform`, `scale`, `offset` and `aabb_scale` too:
//! the camera is in the world of the matrices.
//!
//! Degrees are multiplied by PI / 180 in f64. [`Intrinsics::focal`] has the formula for angles.

use super::{Opening, Reason, View, by_angles, size, text, undistorted};
use crate::error::{Error, Result};
use crate::io::input;
use crate::scene::{Convention, Intrinsics, PoseMatrix};
use glam::{DMat4, DVec3, DVec4};
use serde_json::{Map, Value};
use std::io::Read;
use std::path::{Path, PathBuf};

/// Reads the views of a file, in its order.
///
/// # Errors
/// As [`super::read`].
pub fn read(path: &Path) -> Result<Vec<View>> {
    let text = text(path)?;
    let value: Value = serde_json::from_str(&text)
        .map_err(|error| Error::format(path, format!("no JSON: {error}")))?;
    let wrong = || Error::format(path, "no list `frames`; give a transforms.json with frames");
    let file = value.as_object().ok_or_else(wrong)?;
    let frames = file.get("frames").and_then(Value::as_array).ok_or_else(wrong)?;
    let mut views = Vec::new();
    for (number, frame) in frames.iter().enumerate() {
        let empty = Map::new();
        let own = frame.as_object().unwrap_or(&empty);
        let keys = Keys { own, file };
        let view = view(&keys, path).map_err(|what| {
            let name = own.get("file_path").and_then(Value::as_str).unwrap_or_default();
            let name = if name.is_empty() { String::new() } else { format!(" ({name})") };
            Error::format(path, format!("frame {number}{name}: {what}"))
        })?;
        views.push(view);
    }
    Ok(views)
}

/// The keys of a frame, and of the file behind them.
struct Keys<'a> {
    own: &'a Map<String, Value>,
    file: &'a Map<String, Value>,
}

impl Keys<'_> {
    fn get(&self, key: &str) -> Option<&Value> {
        let given =
            |map: &'_ Map<String, Value>| map.get(key).is_some_and(|value| !value.is_null());
        if given(self.own) {
            self.own.get(key)
        } else {
            self.file.get(key).filter(|v| !v.is_null())
        }
    }

    fn number(&self, key: &str) -> Reason<Option<f64>> {
        let Some(value) = self.get(key) else { return Ok(None) };
        value.as_f64().map(Some).ok_or_else(|| format!("{key}: {value} is no number"))
    }
}

fn view(keys: &Keys<'_>, path: &Path) -> Reason<View> {
    check_lens(keys)?;
    let name = match keys.own.get("file_path") {
        None => String::new(),
        Some(name) => name.as_str().ok_or("file_path: give a text")?.to_owned(),
    };
    let matrix = keys.own.get("transform_matrix").ok_or("no transform_matrix")?;
    let view = PoseMatrix::CameraToWorld(rows(matrix)?).view(Convention::OpenGl)?;
    let size = match (keys.number("w")?, keys.number("h")?) {
        (Some(w), Some(h)) => Some(size(w, h)?),
        (None, None) => png_size(path, &name),
        _ => return Err("one of w and h alone; give both".into()),
    };
    let (offset, opening) = (DVec3::ZERO, opening(keys, size)?);
    Ok(View { name, view, offset, near: None, other_eye: None, opening })
}

fn opening(keys: &Keys<'_>, size: Option<[u32; 2]>) -> Reason<Opening> {
    let angle = |radians: &str, degrees: &str| -> Reason<Option<f64>> {
        let of_degrees = keys.number(degrees)?.map(f64::to_radians);
        Ok(keys.number(radians)?.or(of_degrees))
    };
    let angles = [angle("camera_angle_x", "x_fov")?, angle("camera_angle_y", "y_fov")?];
    let focals = [keys.number("fl_x")?, keys.number("fl_y")?];
    let Some(size) = size else {
        return match (focals, angles) {
            ([None, _], [Some(x), y]) => Ok(Opening::Angles(x, y)),
            _ => Err("no w and h; add the size of the pictures to the file".into()),
        };
    };
    let mut intrinsics = match (focals, angles) {
        ([Some(fx), fy], [_, y]) => {
            let of_angle = y.map(|y| Intrinsics::focal(size[1], y)).transpose();
            let of_angle = of_angle.map_err(|error| error.to_string())?;
            Intrinsics::centered(size, [fx, fy.or(of_angle).unwrap_or(fx)])
        }
        ([None, fy], [Some(x), y]) => {
            let by_angles = by_angles(size, x, y)?;
            Intrinsics { f: [by_angles.f[0], fy.unwrap_or(by_angles.f[1])], ..by_angles }
        }
        _ => return Err("no fl_x and no camera_angle_x; add one of them".into()),
    };
    for (i, key) in ["cx", "cy"].into_iter().enumerate() {
        intrinsics.c[i] = keys.number(key)?.unwrap_or(intrinsics.c[i]);
    }
    Ok(Opening::Pixels(intrinsics))
}

/// Refuses lenses that distort.
fn check_lens(keys: &Keys<'_>) -> Reason<()> {
    let model = match keys.get("camera_model") {
        None => "PINHOLE",
        Some(model) => model.as_str().ok_or("camera_model: give a text")?,
    };
    let known = ["PINHOLE", "SIMPLE_PINHOLE", "SIMPLE_RADIAL", "RADIAL", "OPENCV", "FULL_OPENCV"];
    let fisheye = keys.get("is_fisheye").is_some_and(|is| *is != Value::Bool(false));
    if fisheye || !known.contains(&model) {
        let model = if fisheye { "a fisheye" } else { model };
        return Err(format!(
            "the camera model {model} is not a pinhole; undistort the pictures first (colmap \
             image_undistorter)"
        ));
    }
    let mut coefficients = Vec::new();
    for key in ["k1", "k2", "k3", "k4", "k5", "k6", "p1", "p2"] {
        coefficients.push((key, keys.number(key)?.unwrap_or(0.0)));
    }
    undistorted(&format!("the camera model {model}"), &coefficients)
}

/// A matrix of three or four rows.
fn rows(value: &Value) -> Reason<DMat4> {
    let wrong = || "transform_matrix: give 4 rows of 4 numbers".to_owned();
    let rows = value.as_array().filter(|rows| (3..=4).contains(&rows.len())).ok_or_else(wrong)?;
    let row = |value: &Value| -> Option<DVec4> {
        let numbers: Option<Vec<f64>> = value.as_array()?.iter().map(Value::as_f64).collect();
        Some(DVec4::from_array(numbers?.try_into().ok()?))
    };
    let rows: Option<Vec<DVec4>> = rows.iter().map(row).collect();
    let rows = rows.ok_or_else(wrong)?;
    let last = rows.get(3).copied().unwrap_or(DVec4::W);
    Ok(DMat4::from_cols(rows[0], rows[1], rows[2], last).transpose())
}

/// The size of the PNG that a view names, if there is one: the header begins with it.
fn png_size(path: &Path, name: &str) -> Option<[u32; 2]> {
    let beside = path.parent().unwrap_or(Path::new("")).join(name);
    let mut with_end = beside.clone().into_os_string();
    with_end.push(".png");
    let (file, _) =
        [beside, PathBuf::from(with_end)].iter().find_map(|path| input::open(path).ok())?;
    let mut header = Vec::new();
    file.take(24).read_to_end(&mut header).ok()?;
    let rest = header.strip_prefix(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR")?;
    let side = |at: usize| Some(u32::from_be_bytes(rest.get(at..at + 4)?.try_into().ok()?));
    let size = [side(0)?, side(4)?];
    crate::scene::Camera::check_size(size[0], size[1]).ok().map(|()| size)
}
