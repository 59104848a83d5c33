//! The scene that an entry draws, and the reference that it is measured against.

use super::Found;
use crate::compare::metrics::Metric;
use crate::error::{Error, Result};
use crate::frame::{Exec, Frame, Plane};
use crate::index::grouping::Grouping;
use crate::method::{Method, Session};
use crate::scene::{Camera, Cloud, Lens, Pose, Scene, Similarity, Surfels};
use crate::source::Shape;
use crate::study::truth::{Surface, of_surfaces};
use glam::{DVec3, Vec3};
use std::time::{Duration, Instant};

/// Width and height of pictures.
pub(super) const SIZE: [u32; 2] = [240, 180];

/// The results without and with the cure.
pub(super) fn both(found: impl Fn(bool) -> Result<Found>) -> Result<[Found; 2]> {
    Ok([found(false)?, found(true)?])
}

/// Ignores progress.
pub(super) fn quiet(_: &str, _: u64, _: u64) {}

/// A scene with its camera and method.
#[derive(Debug)]
pub(super) struct Case {
    pub(super) scene: Scene,
    pub(super) camera: Camera,
    pub(super) method: Method,
    pub(super) grouping: Option<Grouping>,
}

impl Case {
    /// Surfels of a shape under the headlight, from its default view.
    pub(super) fn of_shape(shape: Shape, count: usize, method: Method) -> Result<Self> {
        let [width, height] = SIZE;
        let camera = Camera::new(width, height, shape.default_pose(), shape.default_lens())?;
        let scene = Scene::lit(shape.name(), shape.surfels(count, 0)?);
        Ok(Self { scene, camera, method, grouping: None })
    }

    /// The same from another eye, with +y up and a vertical field of view in degrees.
    pub(super) fn seen_from(self, eye: DVec3, target: DVec3, degrees: f64) -> Result<Self> {
        let [width, height] = SIZE;
        let pose = Pose { eye, target, up: DVec3::Y };
        let camera = Camera::new(width, height, pose, Lens::FieldOfView(degrees))?;
        Ok(Self { camera, ..self })
    }

    /// The picture and its time, from the second of two runs.
    pub(super) fn draw(&self, exec: &Exec) -> Result<(Frame<f32>, Duration)> {
        let mut session = match &self.grouping {
            None => Session::new(&self.scene, self.method, exec)?,
            Some(grouping) => {
                let (groups, ..) = grouping.groups(&self.scene.surfels, exec, &quiet)?;
                Session::with_groups(&self.scene, self.method, Some(groups), exec)?
            }
        };
        session.render(&self.camera)?;
        let start = Instant::now();
        let frame = session.render(&self.camera)?.frame.clone();
        Ok((frame, start.elapsed()))
    }

    /// The error of the picture against another one, by the name of a metric.
    pub(super) fn against(&self, truth: &Frame<f32>, metric: &str, exec: &Exec) -> Result<Found> {
        let (frame, time) = self.draw(exec)?;
        let error = Metric::named(metric)?
            .between(&frame, truth, exec)?
            .ok_or_else(|| Error::Invalid(format!("{metric}: the true picture is empty")))?;
        Ok(Found { error, picture: frame.color("")?.clone(), time: Some(time) })
    }

    /// The errors of the picture and of the curing method's picture, against a third one.
    pub(super) fn and_cured(
        self,
        method: Method,
        truth: &Frame<f32>,
        metric: &str,
        exec: &Exec,
    ) -> Result<[Found; 2]> {
        let plain = self.against(truth, metric, exec)?;
        Ok([plain, Self { method, ..self }.against(truth, metric, exec)?])
    }

    /// The true picture of these surfaces, from the same camera.
    pub(super) fn truth(&self, surfaces: &[Surface], exec: &Exec) -> Result<Frame<f32>> {
        Ok(of_surfaces(surfaces, &self.scene, false, &self.camera, &[], exec, &quiet)?.frame)
    }
}

/// A shape without a transform.
pub(super) fn exact(shape: Shape) -> [Surface; 1] {
    [Surface::Shape { shape, place: Similarity::IDENTITY, color: None }]
}

/// Colours the surfels by light and dark cubes with this side.
pub(in crate::study) fn checked(surfels: Surfels, side: f64) -> Result<Surfels> {
    let cloud = surfels.into_cloud();
    let check = |p: &Vec3| {
        let cell = (p.as_dvec3() / side + 0.25).floor();
        let odd = (cell.x + cell.y + cell.z).rem_euclid(2.0) == 1.0;
        Vec3::splat(if odd { 0.0625 } else { 0.875 })
    };
    let color = Some(cloud.position.iter().map(check).collect());
    Ok(Surfels::new(Cloud { color, ..cloud })?.0)
}

/// The change from one picture to another.
pub(super) fn change(from: &Plane<[f32; 3]>, to: &Plane<[f32; 3]>) -> Vec<[f32; 3]> {
    let pixels = from.values().iter().zip(to.values());
    pixels.map(|(from, to)| [0, 1, 2].map(|k| to[k] - from[k])).collect()
}
