//! A picture in the number type and with the planes that were asked for, as files hold it.

use splatref::Result;
use splatref::frame::{Exec, Frame, Plane, Samples};
use splatref::io::scene_file::{Number, Output};
use splatref::method::ewa::{self, Settings};
use splatref::scene::{Camera, Scene};
use splatref::splat::Tally;
use std::path::Path;
use std::time::Duration;

/// A picture in `f32`, and how it came about.
pub(super) struct Drawing {
    pub(super) frame: Frame<f32>,
    pub(super) tally: Tally,
    pub(super) timings: Vec<(&'static str, Duration)>,
}

pub(super) fn draw(
    scene: &Scene,
    camera: &Camera,
    settings: &Settings,
    exec: &Exec,
    output: Output,
) -> Result<Drawing> {
    let picture = match output {
        Output { number: Number::F32, stages: false } => {
            ewa::render_f32(scene, camera, settings, exec)?
        }
        Output { number: Number::F32, stages: true } => {
            ewa::render::<f32>(scene, camera, settings, exec, true)?
        }
        Output { number: Number::F64, stages } => {
            let exact = ewa::render::<f64>(scene, camera, settings, exec, stages)?;
            let ewa::Picture { frame, tally, timings } = exact;
            ewa::Picture { frame: frame.to_f32(), tally, timings }
        }
    };
    Ok(Drawing { frame: picture.frame, tally: picture.tally, timings: picture.timings })
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
