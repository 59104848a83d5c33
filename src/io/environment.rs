//! Read environment maps from EXR files.

use super::exr;
use crate::error::{Error, Result};
use crate::frame::image::Values;
use crate::frame::{Exec, Plane};
use crate::memory;
use crate::scene::environment::{Environment, Map};
use std::path::Path;

/// Reads the latitude-longitude map at `path` on the threads of `exec`. The map is the channels
/// `R`, `G` and `B` of a flat EXR, `HALF` or `FLOAT`, as [`exr::read`] accepts it. Other channels
/// are ignored. For the orientation, see [`crate::scene::environment::map`].
///
/// # Errors
/// The errors of [`exr::read`]; [`Error::Format`] if a channel is absent or holds integers, or as
/// [`Map::new`].
pub fn read(path: &Path, exec: &Exec) -> Result<Environment> {
    let pixels = rgb(path, exec, "an environment map", Map::check_size)?;
    Map::new(pixels).map(Environment::Map).map_err(|error| Error::format(path, error.to_string()))
}

/// Reads the channels `R`, `G` and `B` of the EXR file at `path`, if `check_size` accepts its size;
/// `what` names the picture in errors.
pub(super) fn rgb(
    path: &Path,
    exec: &Exec,
    what: &str,
    check_size: fn(u32, u32) -> Result<()>,
) -> Result<Plane<[f32; 3]>> {
    // Check the size before anything large is read.
    let header = exr::read_header(path)?;
    check_size(header.width, header.height)
        .map_err(|error| Error::format(path, error.to_string()))?;
    let mut image = exr::read_with(path, exec)?;
    let mut channel = |name: &str| {
        let found = image.channels.iter_mut().find(|(of, _)| of == name);
        match found.map(|(_, values)| values) {
            Some(Values::Float(values)) => Ok(std::mem::take(values)),
            Some(Values::Index(_)) => {
                let what = format!("channel {name} holds integers, but {what} needs floats");
                Err(Error::format(path, what))
            }
            None => {
                let what = format!("no channel {name}; {what} needs R, G and B");
                Err(Error::format(path, what))
            }
        }
    };
    let count = u64::from(image.width) * u64::from(image.height);
    memory::try_ask(12 * count, || format!("the colours of {count} pixels"))
        .map_err(|what| Error::format(path, what))?;
    let (red, green, blue) = (channel("R")?, channel("G")?, channel("B")?);
    let pixels = red.iter().zip(&green).zip(&blue).map(|((&r, &g), &b)| [r, g, b]).collect();
    Ok(Plane::from_values(image.width, image.height, pixels))
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::exr::prelude::{
        AnyChannel, AnyChannels, Compression, Encoding, FlatSamples, Image, Layer, LayerAttributes,
        WritableImage, f16,
    };

    /// Value `i` of channel `c`, exact in a half.
    fn value(c: usize, i: usize) -> f32 {
        (c * 100 + i) as f32 * 0.25
    }

    /// An EXR of these channels at `width` x `height`, written by the exr crate.
    fn file(width: usize, height: usize, channels: &[(&str, FlatSamples)]) -> tempfile::TempPath {
        let list = channels.iter().map(|(name, samples)| AnyChannel::new(*name, samples.clone()));
        let encoding = Encoding { compression: Compression::PIZ, ..Encoding::SMALL_LOSSLESS };
        let channels = AnyChannels::sort(list.collect());
        let layer = Layer::new((width, height), LayerAttributes::named("sky"), encoding, channels);
        let path = tempfile::Builder::new().suffix(".exr").tempfile().unwrap().into_temp_path();
        Image::from_layer(layer).write().non_parallel().to_file(&path).unwrap();
        path
    }

    fn floats(c: usize, count: usize) -> FlatSamples {
        FlatSamples::F32((0..count).map(|i| value(c, i)).collect())
    }

    fn refused(path: &Path) -> String {
        let line = read(path, &Exec::sequential()).unwrap_err().to_string();
        assert!(!line.contains('\n') && line.starts_with(&path.display().to_string()), "{line}");
        line
    }

    #[test]
    fn halves_and_floats_are_read_in_their_order() {
        let half = |c| FlatSamples::F16((0..32).map(|i| f16::from_f32(value(c, i))).collect());
        let expected: Vec<[f32; 3]> = (0..32).map(|i| [0, 1, 2].map(|c| value(c, i))).collect();
        let expected = Map::new(Plane::from_values(8, 4, expected)).unwrap();
        for samples in [|c| floats(c, 32), half as fn(usize) -> FlatSamples] {
            let ids = FlatSamples::U32(vec![7; 32]);
            let channels = [("R", samples(0)), ("G", samples(1)), ("B", samples(2)), ("id", ids)];
            let path = file(8, 4, &channels);
            assert_eq!(
                read(&path, &Exec::sequential()).unwrap(),
                Environment::Map(expected.clone())
            );
        }
    }

    #[test]
    fn what_is_no_map_is_refused_by_file() {
        let rgb =
            |count| [("R", floats(0, count)), ("G", floats(1, count)), ("B", floats(2, count))];
        let line = refused(&file(5, 3, &rgb(15)));
        assert!(line.contains("5 x 3 pixels") && line.contains("twice as wide"), "{line}");
        let mut bad = rgb(32);
        bad[1].1 = FlatSamples::F16(vec![f16::INFINITY; 32]);
        assert!(refused(&file(8, 4, &bad)).contains("pixel (0, 0) is [0, inf, 50]"));
        bad[1].1 = FlatSamples::U32(vec![1; 32]);
        assert!(refused(&file(8, 4, &bad)).contains("channel G holds integers"));
        assert!(refused(&file(8, 4, &rgb(32)[..2])).contains("no channel B"));
        assert!(refused(Path::new("no/such.exr")).starts_with("no/such.exr: "));
        let path = tempfile::NamedTempFile::new().unwrap().into_temp_path();
        std::fs::write(&path, "ply\n").unwrap();
        assert!(refused(&path).contains("not an EXR"));
    }
}
