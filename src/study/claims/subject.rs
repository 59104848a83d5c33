//! A case as a scene: its picture by a method, its true picture, its time.

use super::Case;
use crate::error::{Error, Result};
use crate::frame::{Exec, Frame, Plane};
use crate::index::grouping::{Extension, Grouping, Rules};
use crate::method::{Method, Session};
use crate::scene::{Camera, Cloud, Scene, Similarity, Surfels};
use crate::study::truth::{Surface, of_surfaces};
use crate::verify::metrics::{Errors, Metric};
use std::time::Instant;

/// Progress that nobody sees.
pub(super) fn quiet(_: &str, _: u64, _: u64) {}

/// A scene before a camera.
pub(super) struct Subject<'e> {
    case: Case,
    pub(super) scene: Scene,
    pub(super) camera: Camera,
    pub(super) exec: &'e Exec,
}

/// Groups of the overlap c; a given number of them, or as many as that takes.
pub(super) fn groups(overlap: f32, count: Option<usize>, extension: Extension) -> Grouping {
    Grouping { rules: Rules { overlap, opposite: true, coplanar: None }, count, extension }
}

impl<'e> Subject<'e> {
    pub(super) fn new(case: Case, exec: &'e Exec) -> Result<Self> {
        let Case { shape, count, rows } = case;
        let camera = Camera::new(rows * 4 / 3, rows, shape.default_pose(), shape.default_lens())?;
        let scene = Scene::lit(shape.name(), shape.surfels(count, 0)?);
        Ok(Self { case, scene, camera, exec })
    }

    /// The same, seen through.
    pub(super) fn transparent(self) -> Result<Self> {
        let cloud = self.scene.surfels.into_cloud();
        let opacity = Some(vec![0.4; cloud.position.len()]);
        let surfels = Surfels::new(Cloud { opacity, ..cloud })?.0;
        Ok(Self { scene: Scene::lit(self.case.shape.name(), surfels), ..self })
    }

    pub(super) fn session(&self, method: Method, groups: Option<&Grouping>) -> Result<Session<'_>> {
        match groups {
            None => Session::new(&self.scene, method, self.exec),
            Some(grouping) => {
                let (groups, ..) = grouping.groups(&self.scene.surfels, self.exec, &quiet)?;
                Session::with_groups(&self.scene, method, Some(groups), self.exec)
            }
        }
    }

    pub(super) fn draw(&self, method: Method, groups: Option<&Grouping>) -> Result<Frame<f32>> {
        Ok(self.session(method, groups)?.render(&self.camera)?.frame.clone())
    }

    /// The exact picture.
    pub(super) fn truth(&self) -> Result<Frame<f32>> {
        let shape = self.case.shape;
        let surface = Surface::Shape { shape, place: Similarity::IDENTITY, color: None };
        let view = (&self.camera, &[][..]);
        Ok(of_surfaces(&[surface], &self.scene, false, view, self.exec, &quiet)?.frame)
    }

    /// An error of a picture, by the name of a metric.
    pub(super) fn error(&self, frame: &Frame<f32>, truth: &Frame<f32>, name: &str) -> Result<f64> {
        let errors = Errors::of(frame, truth, self.exec)?;
        let error = (Metric::named(name)?.of)(&errors);
        error.ok_or_else(|| Error::Invalid(format!("{name}: the true picture is empty")))
    }

    /// The medians of times of one picture by each of two sessions, of nine by turns, in ms.
    pub(super) fn times(&self, mut sessions: [Session<'_>; 2]) -> Result<[f64; 2]> {
        let mut times = [Vec::new(), Vec::new()];
        for turn in 0..10 {
            for (session, times) in sessions.iter_mut().zip(&mut times) {
                let start = Instant::now();
                session.render(&self.camera)?;
                // The first one fills what is kept.
                if turn > 0 {
                    times.push(start.elapsed().as_secs_f64() * 1e3);
                }
            }
        }
        Ok(times.map(|mut times| {
            times.sort_by(f64::total_cmp);
            times[times.len() / 2]
        }))
    }
}

/// The colours of pictures.
pub(super) fn colors(frames: &[&Frame<f32>]) -> Result<Vec<Plane<[f32; 3]>>> {
    frames.iter().map(|frame| Ok(frame.color("")?.clone())).collect()
}
