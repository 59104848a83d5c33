//! A picture in the number type and with the planes that were asked for, as files hold it.

use splatref::Result;
use splatref::frame::{Exec, Frame, Plane, Samples};
use splatref::io::scene_file::{Number, Output};
use splatref::method::Picture;
use splatref::method::ewa::{self, Settings};
use splatref::scene::{Camera, Scene};
use std::path::Path;

/// Draws; `earlier` is a picture whose memory may be used again.
pub(super) fn draw(
    scene: &Scene,
    camera: &Camera,
    settings: &Settings,
    exec: &Exec,
    output: Output,
    earlier: Option<Picture<f32>>,
) -> Result<Picture<f32>> {
    match (output, earlier) {
        (Output { number: Number::F32, stages: false }, Some(earlier)) => {
            ewa::render_f32_again(scene, camera, settings, exec, earlier)
        }
        (Output { number: Number::F32, stages: false }, None) => {
            ewa::render_f32(scene, camera, settings, exec)
        }
        (Output { number: Number::F32, stages: true }, _) => {
            ewa::render::<f32>(scene, camera, settings, exec, true)
        }
        (Output { number: Number::F64, stages }, _) => {
            let exact = ewa::render::<f64>(scene, camera, settings, exec, stages)?;
            let Picture { frame, tally, timings } = exact;
            Ok(Picture { frame: frame.to_f32(), tally, timings })
        }
    }
}

/// Writes the preview of a picture: its colour over its coverage.
pub(super) fn write_png(path: &Path, frame: &Frame<f32>) -> Result<()> {
    let alpha: Option<&Plane<f32>> = match frame.plane("A") {
        Some(Samples::Scalar(alpha)) => Some(alpha),
        _ => None,
    };
    match frame.plane("") {
        Some(Samples::Color(color)) => splatref::io::png::write(path, color, alpha),
        _ => Ok(()),
    }
}
