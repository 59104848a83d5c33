//! How one order gives way to another, and how the controller of frame times answers a step. Where prefixes
//! fail is measured by the atlas, `docs/atlas.md`.

use super::scene::{against, blue, draw, percent};
use glam::DVec3;
use splatref::Result;
use splatref::frame::Exec;
use splatref::method::blue::controller::Controller;
use splatref::scene::{
    Camera, Geometry, Lens, Motion, Object, Objects, Pose, Primitives, Similarity,
};
use splatref::source::candidates::Directions;
use splatref::study::atlas::orders::{geometry, order, seen, torus};

/// How far an object has given way to a finer one.
pub(crate) const FADES: [f64; 6] = [0.0, 0.1, 0.25, 0.5, 0.75, 1.0];
/// By how much a frame takes longer from one moment on.
pub(crate) const STEPS: [f64; 5] = [1.5, 2.0, 4.0, 9.0, 25.0];

/// Surfels of a torus that are drawn while 5000 surfels give way to a finer object's 50,000, and the holes in
/// hundredths that they leave.
pub(crate) fn fade(fade: f64, exec: &Exec) -> Result<(usize, f64)> {
    let torus = torus()?;
    let [coarse, finer] = [(5000, "coarse"), (50_000, "finer")].map(|(count, name)| {
        let order = order(&torus, &Directions::Cube, 512, count, exec)?;
        Ok(Geometry { name: name.into(), ..geometry(order, Primitives::default())? })
    });
    let coarse: Geometry = coarse?;
    let (density, count) = match coarse.prefix() {
        Some(prefix) => (prefix.estimate(), f64::from(prefix.count())),
        None => return Ok((0, 0.0)),
    };
    let object = |geometry| Object {
        name: "torus".into(),
        geometry,
        motion: Motion::still(Similarity::IDENTITY),
        color: None,
    };
    let both = Objects::new(vec![coarse, finer?], vec![object(0), object(1)], [0.75; 3].into())?;
    let both = both.with_coarser(vec![None, Some(0)])?;
    let wanted = count * (1.0 + 0.3 * fade);
    let radius = f64::from(density.distance) * (f64::from(density.count) / wanted).sqrt();
    let camera = far_away()?;
    let scene = seen(&both, (2.0 * radius * f64::from(camera.fy)) as f32, &camera, exec)?;
    let found = draw(&scene, blue(), &camera, exec)?;
    let found = against(&found, &draw(&torus, blue(), &camera, exec)?);
    Ok((scene.surfels.len(), percent(found.holes, found.interior)))
}

/// A camera before the torus, so far away that every disc has one size.
fn far_away() -> Result<Camera> {
    let pose = Pose { eye: DVec3::new(2.0, 3.0, 5.0), target: DVec3::ZERO, up: DVec3::Y };
    Camera::new(512, 512, pose, Lens::Orthographic(3.2))
}

/// What a load step does to sizes whose frame times are known so many frames late.
pub(crate) struct Swing {
    /// The largest size over that at which sizes settle, in hundredths.
    pub(crate) overshoot: f64,
    /// The frame from which on sizes stay; none if they swing for ever.
    pub(crate) settled: Option<usize>,
}

impl std::fmt::Display for Swing {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.settled {
            Some(frame) => write!(f, "{:.0} %, {frame}", self.overshoot),
            None => write!(f, "{:.0} %, never", self.overshoot),
        }
    }
}

/// Surfels that take `s^-2` of the target's time at the size 1.25, and from frame 0 on `step` times as long.
pub(crate) fn load_step(step: f64, late: usize) -> Swing {
    let frames = 1000;
    let Ok(controller) = Controller::new(1.0) else {
        return Swing { overshoot: f64::NAN, settled: None };
    };
    let mut sizes = vec![1.25_f32; late + 1];
    for _ in 0..frames {
        let at = |back: usize| sizes[sizes.len() - 1 - back];
        let known = f64::from(at(late));
        let next = controller.next(at(0), 1.25 * 1.25 * step / (known * known));
        sizes.push(next);
    }
    let last = sizes[sizes.len() - 1];
    let first = sizes.iter().rposition(|&size| size != last).map_or(0, |i| i + 1 - late.min(i));
    let most = sizes.iter().fold(0.0_f32, |most, &size| if size > most { size } else { most });
    let wanted = 1.25 * step.sqrt();
    let settled = (first < frames / 2).then_some(first);
    Swing { overshoot: 100.0 * (f64::from(most) / wanted - 1.0), settled }
}
