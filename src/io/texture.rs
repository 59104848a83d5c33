//! Read textures from PNG, JPEG and EXR files, and find the texture of a model.
//!
//! | file | contents | colours |
//! |---|---|---|
//! | `.png` | 8 or 16 bits, grey, a palette or colours | **sRGB**, decoded in `f64` and rounded once ([`crate::number::srgb`]) |
//! | `.jpg`, `.jpeg` | 8 bits, grey or colours, baseline or progressive | as PNG |
//! | `.exr` | the channels `R`, `G`, `B`, `HALF` or `FLOAT` | linear, kept |
//!
//! Opacity is ignored, and so are the gamma that a PNG declares, and the profile and the orientation
//! of a JPEG. Reading PNG and JPEG needs the feature `cli`. A JPEG is decoded by integer arithmetic,
//! so its texels are the same on every machine; another decoder may differ by some codes, because the
//! standard allows it.
//!
//! # Which texture a model has
//!
//! You can choose a texture for a model. Otherwise the model has the texture that its file names,
//! beside that file: PLY in a line `comment TextureFile`, OBJ by its materials. If a file names
//! several textures, or a texture for only some of its polygons, you must choose one. If a file has
//! no texture coordinates, the texture that it names is not looked for.
//!
//! The texture replaces all colours of the file. [`crate::source::derive`] and
//! [`crate::source::candidates`] say what gets the texture's colour, and how it is filtered.

use super::environment::rgb;
use super::extension;
use crate::error::{Error, Result};
use crate::frame::{Exec, Plane};
use crate::scene::{Cloud, Paint, Texture};
use std::path::{Path, PathBuf};

/// Reads the texture at `path`.
///
/// # Errors
/// [`Error::Io`] if it cannot be read. [`Error::Format`] if the name ends neither in `.png`, `.jpg`,
/// `.jpeg` nor in `.exr`, as the readers of these formats, if a channel is absent, or as [`Texture::new`].
pub fn read(path: &Path, exec: &Exec) -> Result<Texture> {
    let texels = match extension(path).as_deref() {
        Some("exr") => rgb(path, exec, "a texture", Texture::check_size)?,
        Some("png") => png(path)?,
        Some("jpg" | "jpeg") => jpeg(path)?,
        _ => return Err(Error::format(path, "not a texture; give a .png, a .jpg or an .exr")),
    };
    Texture::new(texels).map_err(|error| Error::format(path, error.to_string()))
}

#[cfg(feature = "cli")]
fn png(path: &Path) -> Result<Plane<[f32; 3]>> {
    super::png::read_linear(path, Texture::check_size)
}

#[cfg(feature = "cli")]
fn jpeg(path: &Path) -> Result<Plane<[f32; 3]>> {
    super::png::read_jpeg(path, Texture::check_size)
}

#[cfg(not(feature = "cli"))]
fn jpeg(path: &Path) -> Result<Plane<[f32; 3]>> {
    Err(Error::format(path, "reading JPEG needs the feature `cli`; give an EXR"))
}

#[cfg(not(feature = "cli"))]
fn png(path: &Path) -> Result<Plane<[f32; 3]>> {
    Err(Error::format(path, "reading PNG needs the feature `cli`; give an EXR"))
}

/// Gives the cloud of the file `model` its texture: the texture at `chosen`, or else the one that
/// the file names, if any. `levels` is the number of levels of prefiltered colours to make from it.
///
/// # Errors
/// As [`read`]. [`Error::Format`] for `model` if the texture that it names is missing, if it names
/// several, or if a texture is chosen for a file without coordinates.
pub fn paint(
    cloud: &mut Cloud,
    model: &Path,
    chosen: Option<&Path>,
    levels: usize,
    exec: &Exec,
) -> Result<()> {
    let Some(coordinates) = &cloud.coordinates else {
        let Some(chosen) = chosen else { return Ok(()) };
        let what = format!(
            "no texture coordinates, so {} cannot be drawn; remove the texture",
            chosen.display()
        );
        return Err(Error::format(model, what));
    };
    let texture = match (chosen, cloud.textures.as_slice()) {
        (Some(chosen), _) => read(chosen, exec)?,
        (None, []) => return Ok(()),
        (None, [name]) => named(model, name, exec)?,
        (None, [first, second, ..]) => {
            let called = |name: &String| {
                if name.is_empty() { "none".to_owned() } else { name.escape_debug().to_string() }
            };
            let (first, second) = (called(first), called(second));
            let what = format!(
                "the polygons have several textures, such as {first} and {second}; choose one \
                 `texture` for all"
            );
            return Err(Error::format(model, what));
        }
    };
    cloud.paint = Some(Paint::new(texture, coordinates, levels));
    Ok(())
}

/// Reads the texture that a model names.
fn named(model: &Path, name: &str, exec: &Exec) -> Result<Texture> {
    let path: PathBuf = model.parent().unwrap_or(Path::new("")).join(name);
    read(&path, exec).map_err(|error| match error {
        Error::Io { source, .. } => {
            let name = name.escape_debug();
            Error::format(
                model,
                format!("its texture {name}: {source}; add the file, or choose a `texture`"),
            )
        }
        other => other,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{Frame, Samples};
    use crate::io::exr;
    use crate::scene::Coordinates;
    use glam::Vec2;
    use std::fs;
    use tempfile::TempDir;

    fn exec() -> Exec {
        Exec::sequential()
    }

    fn pixels() -> Plane<[f32; 3]> {
        Plane::from_values(2, 1, vec![[0.0, 0.5, 2.0], [1.0, 0.25, 0.125]])
    }

    fn write_exr(path: &Path) {
        let frame = Frame::new(2, 1).with("", Samples::Color(pixels())).unwrap();
        exr::write(path, &frame, "").unwrap();
    }

    fn cloud(names: &[&str]) -> Cloud {
        Cloud {
            coordinates: Some(Coordinates::Points(vec![Vec2::ZERO])),
            textures: names.iter().map(|&name| name.to_owned()).collect(),
            ..Cloud::default()
        }
    }

    fn refused(cloud: &mut Cloud, model: &Path, chosen: Option<&Path>) -> String {
        let line = paint(cloud, model, chosen, 0, &exec()).unwrap_err().to_string();
        assert!(!line.contains('\n') && cloud.paint.is_none(), "{line}");
        line
    }

    #[test]
    fn a_texture_is_chosen_or_named() {
        let at = TempDir::new().unwrap();
        let (model, texture) = (at.path().join("a.ply"), at.path().join("b.EXR"));
        write_exr(&texture);
        let expected = Texture::new(pixels()).unwrap();
        assert_eq!(read(&texture, &exec()).unwrap(), expected);
        for (names, chosen) in
            [(&["b.EXR"][..], None), (&["no.png"], Some(&*texture)), (&["", "x"], Some(&*texture))]
        {
            let mut cloud = cloud(names);
            paint(&mut cloud, &model, chosen, 3, &exec()).unwrap();
            let coordinates = cloud.coordinates.clone().unwrap();
            assert_eq!(cloud.paint, Some(Paint::new(expected.clone(), &coordinates, 3)));
        }
        let mut bare = Cloud { coordinates: None, ..cloud(&["no.png"]) };
        paint(&mut bare, &model, None, 0, &exec()).unwrap();
        let mut unnamed = cloud(&[]);
        paint(&mut unnamed, &model, None, 0, &exec()).unwrap();
        assert!(bare.paint.is_none() && unnamed.paint.is_none());
    }

    #[test]
    fn what_is_no_texture_of_a_model_is_one_line() {
        let at = TempDir::new().unwrap();
        let model = at.path().join("a.ply");
        let line = refused(&mut cloud(&["no\u{7}.exr"]), &model, None);
        assert!(line.contains("a.ply: its texture no\\u{7}.exr: "), "{line}");
        assert!(
            refused(&mut cloud(&["a.png", ""]), &model, None)
                .contains("several textures, such as a.png and none; choose")
        );
        let line = refused(&mut Cloud::default(), &model, Some(Path::new("x/b.exr")));
        assert!(line.contains("a.ply: no texture coordinates, so x/b.exr"), "{line}");
        assert!(
            refused(&mut cloud(&[]), &model, Some(Path::new("b.tga")))
                .starts_with("b.tga: not a texture; give a .png")
        );
        assert!(refused(&mut cloud(&[]), &model, Some(Path::new("b.exr"))).starts_with("b.exr: "));
        let bad = at.path().join("bad.exr");
        let frame =
            Frame::new(1, 1).with("", Samples::Color(Plane::filled(1, 1, [-1.0; 3]))).unwrap();
        exr::write(&bad, &frame, "").unwrap();
        assert!(
            refused(&mut cloud(&[]), &model, Some(&bad))
                .contains("bad.exr: texel (0, 0) is [-1, -1, -1]; clamp")
        );
        let depth = Frame::new(1, 1).with("Z", Samples::Scalar(Plane::filled(1, 1, 1.0))).unwrap();
        exr::write(&bad, &depth, "").unwrap();
        assert!(
            refused(&mut cloud(&[]), &model, Some(&bad))
                .contains("no channel R; a texture needs R, G and B")
        );
        fs::write(&bad, "ply").unwrap();
        assert!(refused(&mut cloud(&[]), &model, Some(&bad)).contains("not an EXR"));
    }

    /// Codes by the formula of the standard, of 8 bits and of 16.
    #[cfg(feature = "cli")]
    #[test]
    fn codes_of_png_are_decoded() {
        use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
        let at = TempDir::new().unwrap();
        let path = at.path().join("a.png");
        let write = |width: u32, kind, bytes: &[u8]| {
            let file = fs::File::create(&path).unwrap();
            PngEncoder::new(file).write_image(bytes, width, 1, kind).unwrap();
        };
        let texels =
            |of: Vec<[f32; 3]>| Texture::new(Plane::from_values(of.len() as u32, 1, of)).unwrap();
        let linear = |code: f64| crate::number::srgb::to_linear(code) as f32;
        write(2, ExtendedColorType::Rgba8, &[0, 128, 255, 7, 10, 11, 12, 255]);
        let of = [10.0, 11.0, 12.0].map(|code| linear(code / 255.0));
        let expected = texels(vec![[0.0, linear(128.0 / 255.0), 1.0], of]);
        assert_eq!(read(&path, &exec()).unwrap(), expected);
        let grey: Vec<u8> = (0..=u16::MAX).step_by(13).flat_map(u16::to_ne_bytes).collect();
        write(5042, ExtendedColorType::L16, &grey);
        let expected =
            (0..=u16::MAX).step_by(13).map(|code| [linear(f64::from(code) / 65_535.0); 3]);
        assert_eq!(read(&path, &exec()).unwrap(), texels(expected.collect()));
        write(70_000, ExtendedColorType::L8, &vec![0; 70_000]);
        let line = read(&path, &exec()).unwrap_err().to_string();
        assert!(
            line.ends_with("a.png: a texture of 70000 x 1 pixels; give sides of 1 to 65536"),
            "{line}"
        );
        let bytes = fs::read(&path).unwrap();
        for (side, what) in [
            (100_000_u32, "a.png: a texture of 100000 x 100000 pixels; give sides of 1 to 65536"),
            (65_536, "a.png: header: declares 65536 x 65536 pixels, more than a file of"),
            (0, "a.png: "),
        ] {
            let mut huge = bytes.clone();
            huge[16..20].copy_from_slice(&side.to_be_bytes());
            huge[20..24].copy_from_slice(&side.to_be_bytes());
            let crc = crc32(&huge[12..29]);
            huge[29..33].copy_from_slice(&crc.to_be_bytes());
            fs::write(&path, huge).unwrap();
            let line = read(&path, &exec()).unwrap_err().to_string();
            assert!(line.contains(what) && !line.contains('\n'), "{line}");
        }
        fs::write(&path, "GIF").unwrap();
        assert!(read(&path, &exec()).unwrap_err().to_string().contains("write it again"));
    }

    #[cfg(feature = "cli")]
    fn crc32(bytes: &[u8]) -> u32 {
        !bytes.iter().fold(!0, |crc: u32, byte| {
            (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
                (crc >> 1) ^ if crc & 1 == 1 { 0xEDB8_8320 } else { 0 }
            })
        })
    }
}
