//! Read cameras from the files of other programs.
//!
//! | file | what it is |
//! |---|---|
//! | `*.json` | [`transforms`]: nerfstudio, instant-ngp and Blender exports |
//! | `cameras.txt`, `images.txt`, or their folder | [`colmap`]: a reconstruction as text |
//!
//! A file has one or more views, in its order, counted from 0. Lenses that distort are refused by
//! name.

pub mod colmap;
#[cfg(feature = "cli")]
pub mod transforms;

use super::{Reason, extension, input};
use crate::error::{Error, Result};
use crate::scene::Intrinsics;
use glam::{DMat4, DVec3};
use std::path::Path;

/// The most cameras of a file, and frames of a sequence.
pub const MOST_FRAMES: u32 = 1_000_000;

/// A camera of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Its name: the picture's file. It may be empty.
    pub name: String,
    /// The view matrix, [`crate::scene::Camera::view_from_world`] before it is rounded.
    pub view: DMat4,
    /// What the view matrix takes off the coordinates first, in world units.
    pub offset: DVec3,
    /// The near plane, if the file has one.
    pub near: Option<f64>,
    /// [`crate::scene::Camera::other_eye`] before it is rounded.
    pub other_eye: Option<f64>,
    opening: Opening,
}

/// The opening of a view.
#[derive(Clone, Debug, PartialEq)]
enum Opening {
    Pixels(Intrinsics),
    /// The angles that width and height span, in radians, for a picture of any size. Pixels are
    /// square without the second.
    #[cfg_attr(not(feature = "cli"), expect(dead_code, reason = "only JSON has angles"))]
    Angles(f64, Option<f64>),
}

impl View {
    /// A camera with these intrinsics, without a near plane.
    pub(super) fn new(name: String, view: DMat4, offset: DVec3, intrinsics: Intrinsics) -> Self {
        let opening = Opening::Pixels(intrinsics);
        Self { name, view, offset, near: None, other_eye: None, opening }
    }

    /// The intrinsics, for a picture of the chosen size if the file has none.
    pub(super) fn intrinsics(&self, size: Option<[u32; 2]>) -> Reason<Intrinsics> {
        match self.opening {
            Opening::Pixels(intrinsics) => Ok(intrinsics),
            Opening::Angles(x, y) => {
                let size = size.ok_or("the file has no w and h; give the size of the picture")?;
                by_angles(size, x, y)
            }
        }
    }
}

/// Intrinsics from angles, see [`Opening::Angles`].
fn by_angles(size: [u32; 2], x: f64, y: Option<f64>) -> Reason<Intrinsics> {
    let focal = |side, angle| Intrinsics::focal(side, angle).map_err(|error| error.to_string());
    let fx = focal(size[0], x)?;
    let fy = y.map_or(Ok(fx), |y| focal(size[1], y))?;
    Ok(Intrinsics::centered(size, [fx, fy]))
}

/// Reads all cameras of a file.
///
/// # Errors
/// [`Error::Io`] if it cannot be read. [`Error::Format`], with the line or the frame, if it is none
/// of these files, if a lens distorts, or if a pose is no rotation and translation.
pub fn read(path: &Path) -> Result<Vec<View>> {
    let ends = extension(path);
    let views = match ends.as_deref() {
        _ if path.is_dir() => colmap::read(path)?,
        Some("json") => json(path)?,
        Some("txt" | "bin")
            if path.file_stem().is_some_and(|stem| stem == "cameras" || stem == "images") =>
        {
            colmap::read(path.parent().unwrap_or(Path::new("")))?
        }
        _ => {
            // A file that is not there is said to be so.
            input::open(path).map_err(|source| Error::io(path, source))?;
            let what = "not a camera file; give a transforms.json, a COLMAP folder with cameras.txt \
                        and images.txt, or an .exr that splatref wrote";
            return Err(Error::format(path, what));
        }
    };
    if views.is_empty() || views.len() > MOST_FRAMES as usize {
        let what = format!("{} cameras; give a file with 1 to {MOST_FRAMES}", views.len());
        return Err(Error::format(path, what));
    }
    Ok(views)
}

#[cfg(feature = "cli")]
fn json(path: &Path) -> Result<Vec<View>> {
    transforms::read(path)
}

#[cfg(not(feature = "cli"))]
fn json(path: &Path) -> Result<Vec<View>> {
    Err(Error::format(path, "this build reads no JSON; build splatref with the feature cli"))
}

/// Finds a view: by its name, else by its file's name, with or without its extension, else by its
/// number, counted from 0.
///
/// # Errors
/// [`Error::Usage`] if no view, or more than one, is called so.
pub fn find(path: &Path, views: &[View], name: &str) -> Result<usize> {
    let file = |view: &View| Path::new(&view.name).file_name().map(|name| name.to_owned());
    let stem = |view: &View| Path::new(&view.name).file_stem().map(|name| name.to_owned());
    let called: [&dyn Fn(&View) -> bool; 3] = [
        &|view| view.name == name,
        &|view| file(view).is_some_and(|file| file == *name),
        &|view| stem(view).is_some_and(|stem| stem == *name),
    ];
    for is_called in called {
        let mut found = views.iter().enumerate().filter(|(_, view)| is_called(view));
        if let Some((first, _)) = found.next() {
            let Some((second, _)) = found.next() else { return Ok(first) };
            let what = format!(
                "{}: views {first} and {second} are both called `{name}`; give the number",
                path.display()
            );
            return Err(Error::Usage(what));
        }
    }
    let number = name.parse::<usize>().ok().filter(|&number| number < views.len());
    number.ok_or_else(|| {
        let (last, first) = (views.len() - 1, &views[0].name);
        let what = format!(
            "{}: no view `{name}`; give a number from 0 to {last}, or a name such as `{first}`",
            path.display()
        );
        Error::Usage(what)
    })
}

/// The text of a file, without a byte order mark.
fn text(path: &Path) -> Result<String> {
    let bytes = input::bytes(path).map_err(|source| Error::io(path, source))?;
    let text = String::from_utf8(bytes)
        .map_err(|_| Error::format(path, "not text in UTF-8; export the cameras as text"))?;
    Ok(match text.strip_prefix('\u{feff}') {
        Some(rest) => rest.to_owned(),
        None => text,
    })
}

/// The size that two numbers of a file give.
fn size(width: f64, height: f64) -> Reason<[u32; 2]> {
    let side =
        |v: f64| (v >= 1.0 && v <= f64::from(u32::MAX) && v.fract() == 0.0).then_some(v as u32);
    let sides = side(width).zip(side(height));
    // `{:?}` writes 1e300 where `{}` would write its 301 digits.
    let (width, height) = sides.ok_or_else(|| {
        format!(
            "the picture is {width:?} x {height:?} pixels; both must be whole numbers from 1 on"
        )
    })?;
    crate::scene::Camera::check_size(width, height).map_err(|error| error.to_string())?;
    Ok([width, height])
}

/// Refuses what distorts: a nonzero coefficient.
fn undistorted(model: &str, coefficients: &[(&str, f64)]) -> Reason<()> {
    match coefficients.iter().find(|(_, value)| *value != 0.0) {
        None => Ok(()),
        Some((name, value)) => Err(format!(
            "{model} distorts: {name} = {value}; splatref draws pinhole cameras, so undistort the \
             pictures first (colmap image_undistorter)"
        )),
    }
}

#[cfg(test)]
mod tests;
