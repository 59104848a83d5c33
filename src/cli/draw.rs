//! A picture in the number type and with the planes that were asked for, as files hold it.

use splatref::Result;
use splatref::frame::{Exec, Frame, Plane, Samples};
use splatref::io::scene_file::{Number, Output};
use splatref::method::{self, Method, Picture, Preparation};
use splatref::scene::{Camera, Scene};
use std::path::Path;

/// Draws; `earlier` is a picture whose memory may be used again.
pub(super) fn draw(
    (scene, preparation): (&Scene, &Preparation),
    camera: &Camera,
    method: &Method,
    exec: &Exec,
    output: Output,
    earlier: Option<Picture<f32>>,
) -> Result<Picture<f32>> {
    match output {
        Output { number: Number::F32, stages: false } => {
            method::render_f32(scene, preparation, camera, method, exec, earlier)
        }
        Output { number: Number::F32, stages: true } => {
            method::render::<f32>(scene, preparation, camera, method, exec, true)
        }
        Output { number: Number::F64, stages } => {
            let exact = method::render::<f64>(scene, preparation, camera, method, exec, stages)?;
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
        Some(Samples::Color(color)) => {
            let mut color = color.clone();
            for (pixel, alpha) in
                color.values_mut().iter_mut().zip(alpha.iter().flat_map(|p| p.values()))
            {
                // A PNG wants colours that are not multiplied by alpha.
                if *alpha > 0.0 && *alpha < 1.0 {
                    *pixel = pixel.map(|value| value / alpha);
                }
            }
            splatref::io::png::write(path, &color, alpha)
        }
        _ => Ok(()),
    }
}
