//! A picture in the number type and with the planes that were asked for, as files hold it.

use splatref::Result;
use splatref::frame::Exec;
use splatref::io::scene_file::{Number, Output};
use splatref::method::{self, Method, Picture, Preparation};
use splatref::scene::{Camera, Scene};

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
