//! Read the opaque surface of a view from an EXR file.

use super::exr;
use crate::error::{Error, Result};
use crate::frame::image::Values;
use crate::frame::{Exec, Plane};
use crate::memory;
use crate::scene::Surface;
use std::path::Path;

/// Reads the surface at `path` on the threads of `exec`: the channels `Z`, `R`, `G` and `B` of a flat
/// EXR, `HALF` or `FLOAT`, as [`exr::read`] accepts it. Other channels are ignored. Methods that draw
/// surfels or polygons leave these channels.
///
/// # Errors
/// The errors of [`exr::read`]; [`Error::Format`] if a channel is absent or holds integers, or as
/// [`Surface::new`].
pub fn read(path: &Path, exec: &Exec) -> Result<Surface> {
    let refused = |what: &str| {
        Error::format(
            path,
            format!(
                "{what}; a surface needs the depths Z and the colours R, G and B, such as `splatref \
                     render --method ewa` writes"
            ),
        )
    };
    let image = exr::read_with(path, exec)?;
    let Some(Values::Float(depth)) = image.channel("Z") else {
        return Err(refused("no channel Z of floats"));
    };
    // Depths and colours are copied out of the channels.
    memory::try_ask(16 * depth.len() as u64, || format!("a surface of {} pixels", depth.len()))
        .map_err(|what| Error::format(path, what))?;
    let color = image.color().ok_or_else(|| refused("no channels R, G and B of floats"))?;
    let depth = Plane::from_values(image.width, image.height, depth.clone());
    Surface::new(depth, color).map_err(|error| Error::format(path, error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{Frame, Samples};

    #[test]
    fn channels_are_read_and_missing_ones_are_refused() {
        let depth = Plane::from_values(2, 1, vec![1.5, f32::INFINITY]);
        let color = Plane::from_values(2, 1, vec![[0.25, 0.5, 0.75], [9.0; 3]]);
        let [z, rgb] = [Samples::Scalar(depth.clone()), Samples::Color(color.clone())];
        let folder = tempfile::TempDir::new().unwrap();
        let path = folder.path().join("opaque.exr");
        let read = |frame: &Frame<f32>| {
            exr::write(&path, frame, "").unwrap();
            read(&path, &Exec::sequential())
        };
        let with =
            |name, samples: &Samples<f32>| Frame::new(2, 1).with(name, samples.clone()).unwrap();
        let whole = with("Z", &z).with("", rgb.clone()).unwrap();
        assert_eq!(read(&whole).unwrap(), Surface::new(depth, color).unwrap());
        for (frame, what) in [(with("Z", &z), "no channels R, G"), (with("", &rgb), "no channel Z")]
        {
            let line = read(&frame).unwrap_err().to_string();
            assert!(line.contains("opaque.exr: ") && line.contains(what), "{line}");
            assert!(line.contains("render --method ewa") && !line.contains('\n'), "{line}");
        }
    }
}
