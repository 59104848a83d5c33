//! Read the cameras of a COLMAP reconstruction: `cameras.txt` and `images.txt`.
//!
//! A line that is empty or begins with `#` is skipped. `cameras.txt` has a line for each lens:
//! `CAMERA_ID MODEL WIDTH HEIGHT PARAMS...`. `images.txt` has two lines for each picture:
//! `IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME`, and its points, which are skipped; this second
//! line may be empty, but must be there.
//!
//! | model | parameters |
//! |---|---|
//! | `SIMPLE_PINHOLE` | f cx cy |
//! | `PINHOLE` | fx fy cx cy |
//! | `SIMPLE_RADIAL` | f cx cy k |
//! | `RADIAL` | f cx cy k1 k2 |
//! | `OPENCV` | fx fy cx cy k1 k2 p1 p2 |
//! | `FULL_OPENCV` | fx fy cx cy k1 k2 p1 p2 k3 k4 k5 k6 |
//! | `FOV` | fx fy cx cy omega |
//!
//! Every parameter after cy must be 0. Fisheye models are refused, because they distort with any
//! parameters.
//!
//! A pose goes from world to camera, in the convention `opencv`. Its rotation comes from the
//! quaternion q, in f64:
//!
//! ```text
//!   |q| = sqrt(((w w + x x) + y y) + z z)      w, x, y, z each divided by |q|
//!
//!   1 - 2 (y y + z z)    2 (x y - w z)        2 (x z + w y)
//!   2 (x y + w z)        1 - 2 (x x + z z)    2 (y z - w x)
//!   2 (x z - w y)        2 (y z + w x)        1 - 2 (x x + y y)
//! ```
//!
//! Then as [`crate::scene::camera::convention`] has it.

use super::{Reason, View, size, text, undistorted};
use crate::error::{Error, Result};
use crate::scene::{Convention, Intrinsics, PoseMatrix, Projection};
use glam::{DMat4, DVec3, DVec4};
use std::collections::BTreeMap;
use std::path::Path;

/// Each model that can be a pinhole: its name, how many focal lengths it has, and what follows cy.
const MODELS: [(&str, usize, &[&str]); 7] = [
    ("SIMPLE_PINHOLE", 1, &[]),
    ("PINHOLE", 2, &[]),
    ("SIMPLE_RADIAL", 1, &["k"]),
    ("RADIAL", 1, &["k1", "k2"]),
    ("OPENCV", 2, &["k1", "k2", "p1", "p2"]),
    ("FULL_OPENCV", 2, &["k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"]),
    ("FOV", 2, &["omega"]),
];

/// Reads the views of a folder, in the order of `images.txt`.
///
/// # Errors
/// As [`super::read`].
pub fn read(folder: &Path) -> Result<Vec<View>> {
    let [cameras, images] = ["cameras.txt", "images.txt"].map(|name| folder.join(name));
    for path in [&cameras, &images] {
        if !path.exists() && path.with_extension("bin").exists() {
            let what = "COLMAP's binary files are not read; write text with \
                        `colmap model_converter --output_type TXT`";
            return Err(Error::format(&path.with_extension("bin"), what));
        }
    }
    let lenses = lenses(&text(&cameras)?).map_err(|what| Error::format(&cameras, what))?;
    views(&text(&images)?, &lenses).map_err(|what| Error::format(&images, what))
}

/// The lenses of `cameras.txt` by their ids. One that distorts is refused only if a picture uses it.
type Lenses = BTreeMap<u64, Reason<Intrinsics>>;

fn lenses(text: &str) -> Reason<Lenses> {
    let mut lenses = Lenses::new();
    for (number, line) in (1..).zip(text.lines().map(str::trim)) {
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let words: Vec<&str> = line.split_whitespace().collect();
        let [id, model, width, height, parameters @ ..] = words.as_slice() else {
            return Err(format!(
                "line {number}: give CAMERA_ID MODEL WIDTH HEIGHT PARAMS, as COLMAP writes it"
            ));
        };
        let at = |what: String| format!("line {number}: {what}");
        let id = id.parse().map_err(|_| at(format!("`{id}` is no camera id")))?;
        let numbers =
            |words: &[&str]| words.iter().map(|word| float(word)).collect::<Reason<Vec<_>>>();
        let sides = numbers(&[width, height]).map_err(at)?;
        let size = size(sides[0], sides[1]).map_err(at)?;
        let parameters = numbers(parameters).map_err(at)?;
        let lens = intrinsics(model, size, &parameters).map_err(at);
        if lenses.insert(id, lens).is_some() {
            return Err(at(format!("camera {id} a second time; give each camera one line")));
        }
    }
    Ok(lenses)
}

/// The intrinsics of a lens.
fn intrinsics(model: &str, size: [u32; 2], parameters: &[f64]) -> Reason<Intrinsics> {
    let known = MODELS.iter().find(|(name, ..)| *name == model);
    let Some(&(_, focals, further)) = known else {
        return Err(format!(
            "the camera model {model} is not a pinhole; undistort the pictures first (colmap \
             image_undistorter)"
        ));
    };
    let count = focals + 2 + further.len();
    if parameters.len() != count {
        return Err(format!("{model} has {count} parameters, but here are {}", parameters.len()));
    }
    let (opening, rest) = parameters.split_at(focals + 2);
    let named: Vec<(&str, f64)> = further.iter().copied().zip(rest.iter().copied()).collect();
    undistorted(model, &named)?;
    let f = [opening[0], opening[focals - 1]];
    let c = [opening[focals], opening[focals + 1]];
    Ok(Intrinsics { size, projection: Projection::Perspective, f, c })
}

fn views(text: &str, lenses: &Lenses) -> Reason<Vec<View>> {
    let mut views = Vec::new();
    let mut lines = (1..).zip(text.lines().map(str::trim));
    while let Some((number, line)) = lines.next() {
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let view = view(line, lenses).map_err(|what| format!("line {number}: {what}"))?;
        views.push(view);
        // The points of the picture: numbers, or nothing.
        if let Some((number, points)) = lines.next()
            && points.split_whitespace().any(|word| float(word).is_err())
        {
            return Err(format!(
                "line {number}: the line after a picture has its points, or is empty; insert an \
                 empty line"
            ));
        }
    }
    Ok(views)
}

/// A view from its line.
fn view(line: &str, lenses: &Lenses) -> Reason<View> {
    let wrong =
        || "give IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME, as COLMAP writes it".to_owned();
    let (mut words, mut rest) = (Vec::new(), line);
    for _ in 0..9 {
        let (word, further) = rest.split_once(char::is_whitespace).ok_or_else(wrong)?;
        words.push(word);
        rest = further.trim_start();
    }
    // The name is the rest, blanks included.
    let name = rest.to_owned();
    let mut numbers = [0.0; 7];
    for (number, word) in numbers.iter_mut().zip(&words[1..8]) {
        *number = float(word)?;
    }
    let [w, x, y, z, t @ ..] = numbers;
    let id = words[8];
    let lens = id.parse().ok().and_then(|id: u64| lenses.get(&id));
    let lens = lens.ok_or_else(|| format!("cameras.txt has no camera {id}, which {name} uses"))?;
    let intrinsics = lens.clone().map_err(|what| format!("{name}: cameras.txt: {what}"))?;
    let view = PoseMatrix::WorldToCamera(pose([w, x, y, z], t)?).view(Convention::OpenCv)?;
    Ok(View::new(name, view, DVec3::ZERO, intrinsics))
}

/// World to camera from a quaternion and a translation.
fn pose(q: [f64; 4], t: [f64; 3]) -> Reason<DMat4> {
    let [w, x, y, z] = q;
    let length = (((w * w + x * x) + y * y) + z * z).sqrt();
    if !(length > 0.0 && length.is_finite()) {
        return Err(format!(
            "the quaternion {w} {x} {y} {z} is no rotation; give one that is not 0"
        ));
    }
    let [w, x, y, z] = [w / length, x / length, y / length, z / length];
    let rows = [
        DVec4::new(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y), t[0]),
        DVec4::new(2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x), t[1]),
        DVec4::new(2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y), t[2]),
    ];
    Ok(DMat4::from_cols(rows[0], rows[1], rows[2], DVec4::W).transpose())
}

fn float(word: &str) -> Reason<f64> {
    word.parse().map_err(|_| format!("`{word}` is no number"))
}
