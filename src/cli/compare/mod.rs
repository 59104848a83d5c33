//! `splatref compare`: compares two pictures, plane by plane.

mod page;

use super::{Ended, Ending, output, region, report, say};
use splatref::compare::metrics;
use splatref::compare::{Criteria, Tolerance, Verdict, compare};
use splatref::frame::{Exec, Image, Rect};
use splatref::io::replace::Pending;
use splatref::io::{exr, extension, npy, npz, png, provenance};
use splatref::number::srgb;
use splatref::report::page::pending;
use splatref::{Error, Result};
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
#[command(after_help = "\
Names of planes (--planes, --tolerance):
  Z               one channel
  normal          the three channels of a vector or a colour
  visibility.*    every channel whose name starts so
  R,G,B           the colour of the picture

You can mix file types; the planes that both can hold are compared:
  EXR   every plane
  PNG   the colours as stored, in sRGB
  NPY   one plane, h x w or h x w x 3, floats or integers; its name is the file's, or --as;
        RGB.npy holds R,G,B
  NPZ   one plane for each array, under the array's name

A plane `margin` that only the first picture has is left out. For colours the program also prints
RMSE, PSNR, SSIM and the mean of FLIP at 67 pixels per degree; FLIP makes sRGB linear first.

Examples:
  splatref compare out/a.exr out/b.exr
  splatref compare truth.exr gpu.exr --max-ulp 4 --max-abs 1e-6
  splatref compare truth.exr gpu.exr --planes Z,id,normal --tolerance Z:ulp=4,pixels=3
      --tolerance id:pixels=20
  splatref compare truth.exr Z.npy
  splatref compare whole.exr part.exr --region 0,0,512,256
  splatref compare truth.exr screen.png --max-abs 0.004 --report out/differences.html

Exit codes: 0 equal or within the tolerance, 1 different or failed, 2 wrong usage.")]
pub(super) struct Args {
    /// The reference picture: an .exr, .png, .npy or .npz
    first: PathBuf,
    /// The picture to check
    second: PathBuf,
    /// Compare only these planes
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    planes: Option<Vec<String>>,
    /// Compare only the columns from X0 up to X1 and the rows from Y0 up to Y1, X1 and Y1 excluded
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = region::region, allow_hyphen_values = true)]
    region: Option<Rect>,
    /// Accept floats at most N representable numbers apart
    #[arg(long, value_name = "N")]
    max_ulp: Option<u32>,
    /// Accept floats that differ by at most X
    #[arg(long, value_name = "X", value_parser = bound, allow_hyphen_values = true)]
    max_abs: Option<f32>,
    /// Set the tolerance of one plane: ulp=N, abs=X, and pixels=N, how many pixels may exceed it
    /// (or differ at all, for indices); repeatable
    #[arg(long, value_name = "NAME:BOUNDS", value_parser = tolerance)]
    tolerance: Vec<(String, Tolerance)>,
    /// Take a plane from channels of another name, such as RGB=ViewLayer.Combined, in every picture
    /// that has them; repeatable
    #[arg(long, value_name = "PLANE=CHANNEL", value_parser = channels)]
    channels: Vec<(String, String)>,
    /// Give the plane in an NPY this name
    #[arg(long = "as", value_name = "NAME")]
    name: Option<String>,
    /// Write a page that shows both pictures and their differences in a browser
    #[arg(long, value_name = "FILE.html")]
    report: Option<PathBuf>,
}

pub(super) fn run(args: &Args) -> Ended {
    if let Some(path) = &args.report {
        output::check_folder(path)?;
        [&args.first, &args.second].iter().try_for_each(|read| output::check_other(path, read))?;
    }
    let exec = Exec::new(0, 32)?;
    let read = |path| PictureFile::read(path, args, &exec);
    let mut pair = [read(&args.first)?, read(&args.second)?];
    // Two parts can be compared with each other.
    let parts = pair.each_ref().map(|file| file.text().is_some_and(provenance::is_projection));
    if parts[0] != parts[1] {
        for (path, file) in [&args.first, &args.second].into_iter().zip(&pair) {
            provenance::check_finished(path, file.text())?;
        }
    }
    args.rename(&mut pair)?;
    let stored = pair.iter().any(|file| matches!(file, PictureFile::Png(_)));
    let (mut first, mut second) = alike(pair)?;
    if let Some(region) = &args.region {
        (first, second) = (first.region(region)?, second.region(region)?);
    }
    let criteria = args.criteria();
    let found = compare(&first, &second, &criteria)?;
    let lines = found.lines();
    let (verdict, planes) = lines.split_last().map_or(("", [].as_slice()), |(v, p)| (v, p));
    let distances = distances(&first, &second, stored, &exec)?;
    let page = args.report.as_ref().map(|path| {
        let facts = [("first", &args.first), ("second", &args.second)];
        let facts = facts.map(|(label, path)| (label.to_owned(), path.display().to_string()));
        let distances = distances.iter().map(|line| ("distance".to_owned(), line.clone()));
        let facts = facts.into_iter().chain(distances).collect();
        pending(path, &page::report([first, second], &found, &criteria, facts, verdict), &exec)
    });
    page.transpose()?.map_or(Ok(()), Pending::put)?;
    planes.iter().chain(&distances).for_each(say);
    say(verdict);
    Ok(match found.verdict() {
        Verdict::Equal | Verdict::Within => Ending::Good,
        Verdict::Different => Ending::Different,
    })
}

/// The distance between the colours of two pictures, as a line; `None` unless both have colours and
/// one size.
///
/// RMSE, PSNR and SSIM are computed on the values as compared. FLIP is defined on linear light, so
/// sRGB values are made linear for it.
fn distances(first: &Image, second: &Image, stored: bool, exec: &Exec) -> Result<Option<String>> {
    let light = |image: &Image| {
        let color = image.color()?;
        let linear = |c: f32| srgb::to_linear(f64::from(c)) as f32;
        Some(if stored { color.map(|rgb| rgb.map(linear)) } else { color })
    };
    let (Some(summary), Some(picture), Some(reference)) =
        (metrics::summary(first, second), light(second), light(first))
    else {
        return Ok(None);
    };
    let metrics::Summary { rmse, psnr, ssim } = summary;
    let ssim = ssim.map_or_else(|| "too small for SSIM".into(), |s| format!("SSIM {s:.6}"));
    let rmse = report::short(rmse);
    let encoding = if stored { " as sRGB" } else { "" };
    let flip = metrics::flip(&picture, &reference, metrics::flip::PIXELS_PER_DEGREE, exec)?.mean;
    Ok(Some(format!(
        "R, G, B{encoding}: RMSE {rmse}, PSNR {psnr:.3} dB, {ssim}, FLIP {}",
        report::short(flip)
    )))
}

/// A plane, and the name of its channels.
pub(super) fn channels(text: &str) -> std::result::Result<(String, String), String> {
    match text.split_once('=') {
        Some((plane, channel)) if !plane.is_empty() && !channel.is_empty() => {
            Ok((plane.to_owned(), channel.to_owned()))
        }
        _ => Err("give a plane and its channel: RGB=ViewLayer.Combined".into()),
    }
}

/// The new name of a channel, if `old` is its name, or all of its name but the last part.
fn renamed(name: &str, plane: &str, old: &str) -> Option<String> {
    let end = name.strip_prefix(old)?;
    match (end.strip_prefix('.'), plane.strip_suffix("RGB")) {
        (None, _) => end.is_empty().then(|| plane.to_owned()),
        (Some(end), Some(layer)) if layer.is_empty() || layer.ends_with('.') => {
            Some(format!("{layer}{end}"))
        }
        (Some(end), _) => Some(format!("{plane}.{end}")),
    }
}

impl Args {
    /// Gives channels the names of planes; they replace channels that have these names already.
    fn rename(&self, pair: &mut [PictureFile; 2]) -> Result<()> {
        for (plane, old) in &self.channels {
            let mut found = false;
            for file in &mut *pair {
                let PictureFile::Exr(Image { channels, .. }) = file else { continue };
                let new = |name: &str| renamed(name, plane, old);
                let taken: Vec<String> =
                    channels.iter().filter_map(|(name, _)| new(name)).collect();
                found |= !taken.is_empty();
                channels.retain(|(name, _)| !taken.contains(name) || new(name).is_some());
                for (name, _) in &mut *channels {
                    *name = new(name).unwrap_or_else(|| name.clone());
                }
                channels.sort_by(|a, b| a.0.cmp(&b.0));
            }
            if !found {
                let what = format!("--channels {plane}={old}: neither picture has a channel {old}");
                return Err(Error::Usage(what));
            }
        }
        Ok(())
    }

    fn criteria(&self) -> Criteria {
        Criteria {
            planes: self.planes.clone(),
            tolerance: Tolerance { max_ulp: self.max_ulp, max_abs: self.max_abs, pixels: 0 },
            named: self.tolerance.clone(),
            skip_observations: true,
        }
    }
}

/// A picture, by the kind of its file.
enum PictureFile {
    Exr(Image),
    Png(png::Stored),
    /// One plane, and the file that it is from.
    Npy(Image, PathBuf),
}

impl PictureFile {
    fn read(path: &Path, args: &Args, exec: &Exec) -> Result<Self> {
        match extension(path).as_deref() {
            Some("png") => png::read(path).map(Self::Png),
            Some("npy") => {
                let stem = path.file_stem().unwrap_or_default().to_string_lossy();
                let name = args.name.as_deref().unwrap_or(&stem);
                Ok(Self::Npy(npy::read(path, name)?, path.to_owned()))
            }
            // Planes under names of their own, as in an EXR.
            Some("npz") => npz::read(path).map(Self::Exr),
            _ => exr::read_with(path, exec).map(Self::Exr),
        }
    }

    /// The text of an EXR.
    fn text(&self) -> Option<&str> {
        if let Self::Exr(image) = self { image.text.as_deref() } else { None }
    }

    fn image(self) -> Image {
        match self {
            Self::Exr(image) | Self::Npy(image, _) => image,
            Self::Png(stored) => stored.image,
        }
    }
}

/// Reduces two pictures to what both kinds of files can hold: an NPY has one plane, a PNG encoded
/// colours.
fn alike(pair: [PictureFile; 2]) -> Result<(Image, Image)> {
    Ok(match pair {
        [PictureFile::Png(first), second @ (PictureFile::Exr(_) | PictureFile::Npy(..))] => {
            let second = first.encode(&second.image());
            (first.image, second)
        }
        [first @ (PictureFile::Exr(_) | PictureFile::Npy(..)), PictureFile::Png(second)] => {
            (second.encode(&first.image()), second.image)
        }
        [PictureFile::Npy(plane, path), PictureFile::Exr(all)] => {
            let all = part_of(all, &plane, &path)?;
            (plane, all)
        }
        [PictureFile::Exr(all), PictureFile::Npy(plane, path)] => {
            (part_of(all, &plane, &path)?, plane)
        }
        [first, second] => (first.image(), second.image()),
    })
}

/// Keeps the channels that an NPY has too.
fn part_of(mut all: Image, plane: &Image, path: &Path) -> Result<Image> {
    let names = |image: &Image| -> Vec<String> {
        image.channels.iter().map(|(name, _)| name.clone()).collect()
    };
    let (there, held) = (names(&all), names(plane));
    all.channels.retain(|(name, _)| held.contains(name));
    if all.channels.is_empty() {
        let (held, there) = (held.join(", "), there.join(", "));
        return Err(Error::format(
            path,
            format!(
                "holds {held}, which the other picture does not have; give --as one of: {there}"
            ),
        ));
    }
    Ok(all)
}

/// Parses `Z:ulp=4,abs=1e-6,pixels=3`.
fn tolerance(text: &str) -> std::result::Result<(String, Tolerance), String> {
    let form = "give a name, a colon and tolerances, such as Z:ulp=4,abs=1e-6,pixels=3";
    let (name, bounds) = text.rsplit_once(':').ok_or(form)?;
    let mut tolerance = Tolerance::default();
    for part in bounds.split(',') {
        let number = |text: &str| text.parse().map_err(|_| format!("{text}: {form}"));
        match part.split_once('=') {
            Some(("ulp", most)) => tolerance.max_ulp = Some(number(most)?),
            Some(("abs", most)) => tolerance.max_abs = Some(bound(most)?),
            Some(("pixels", most)) => tolerance.pixels = number(most)? as usize,
            _ => return Err(form.into()),
        }
    }
    Ok((name.to_owned(), tolerance))
}

/// Parses a number >= 0.
fn bound(text: &str) -> std::result::Result<f32, String> {
    text.parse().ok().filter(|most| *most >= 0.0).ok_or_else(|| "give a number >= 0".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_channels_of_a_plane_are_renamed() {
        for (name, plane, new) in [
            ("ViewLayer.Combined.R", "RGB", Some("R")),
            ("ViewLayer.Combined.A", "RGB", Some("A")),
            ("ViewLayer.Combined.R", "attributes.RGB", Some("attributes.R")),
            ("ViewLayer.Combined.X", "normal", Some("normal.X")),
            ("ViewLayer.Combined", "Z", Some("Z")),
            ("ViewLayer.Combined2.R", "RGB", None),
            ("Combined.R", "RGB", None),
        ] {
            assert_eq!(renamed(name, plane, "ViewLayer.Combined").as_deref(), new, "{name}");
        }
    }
}
