//! What a picture covers of the mesh that an order was made of.

use splatref::Result;
use splatref::compare::metrics::{Coverage, coverage};
use splatref::frame::{Exec, Frame, Samples};
use splatref::method::{Method, Session, blue};
use splatref::scene::{Camera, Scene};

/// The picture of a scene.
pub(crate) fn draw(
    scene: &Scene,
    method: Method,
    camera: &Camera,
    exec: &Exec,
) -> Result<Frame<f32>> {
    Ok(Session::new(scene, method, exec)?.render(camera)?.frame.clone())
}

/// Both sides of everything: walls are seen from behind, too.
pub(crate) fn blue() -> Method {
    blue::Settings::default().into()
}

/// Where a picture shows something.
pub(crate) fn alpha(frame: &Frame<f32>) -> &[f32] {
    match frame.plane("A") {
        Some(Samples::Scalar(plane)) => plane.values(),
        _ => &[],
    }
}

/// Holes and spill of a picture against that of the mesh.
pub(crate) fn against(found: &Frame<f32>, truth: &Frame<f32>) -> Coverage {
    coverage(alpha(found), alpha(truth), truth.width as usize)
}

/// A part in hundredths of a whole.
pub(crate) fn percent(part: u64, whole: u64) -> f64 {
    100.0 * part as f64 / whole.max(1) as f64
}
