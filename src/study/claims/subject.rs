//! A case as a scene: its picture by a method, its true picture, its time.

use super::{Case, Drawn};
use crate::error::{Error, Result};
use crate::frame::{Exec, Frame, Plane};
use crate::index::grouping::{Extension, Grouping, Rules};
use crate::io::scene_file::{CameraChoice, Ready, SceneFile};
use crate::method::stored::Formats;
use crate::method::{Method, Session};
use crate::scene::{Camera, Cloud, Scene, Similarity, Surfels};
use crate::study::run::truths::Known;
use crate::study::truth::{Surface, of_surfaces};
use crate::verify::metrics::{Errors, Metric};
use std::cell::OnceCell;
use std::time::Instant;

/// Progress that nobody sees.
pub(super) fn quiet(_: &str, _: u64, _: u64) {}

/// A scene before a camera.
pub(super) struct Subject<'e> {
    pub(super) case: Case,
    /// How passes store what they leave.
    pub(super) formats: Formats,
    pub(super) scene: Scene,
    pub(super) camera: Camera,
    pub(super) exec: &'e Exec,
    truth: OnceCell<Frame<f32>>,
}

/// Groups of the overlap c; a given number of them, or as many as that takes.
pub(super) fn groups(overlap: f32, count: Option<usize>, extension: Extension) -> Grouping {
    Grouping { rules: Rules { overlap, opposite: true, coplanar: None }, count, extension }
}

impl<'e> Subject<'e> {
    pub(super) fn new(case: Case, exec: &'e Exec) -> Result<Self> {
        let size = [case.rows * 4 / 3, case.rows];
        let (scene, camera) = match &case.of {
            &Drawn::Shape(shape, count) => {
                let (pose, lens) = (shape.default_pose(), shape.default_lens());
                let camera = Camera::new(size[0], size[1], pose, lens)?;
                (Scene::lit(shape.name(), shape.surfels(count, 0)?), camera)
            }
            Drawn::Scan(file) => {
                let camera = CameraChoice { size: Some(size), ..file.camera.clone() };
                let file = SceneFile { camera, ..(**file).clone() };
                let Ready { loaded, camera, .. } = file.ready(exec, &quiet)?;
                if loaded.scene.objects.is_some() || !loaded.scene.primitives.is_empty() {
                    let what = format!("{}: claims are of scenes of surfels alone", file.name);
                    return Err(Error::Invalid(what));
                }
                (loaded.scene, camera)
            }
        };
        Ok(Self { case, formats: Formats::WHOLE, scene, camera, exec, truth: OnceCell::new() })
    }

    /// The same view of other surfels.
    fn with(&self, surfels: Surfels) -> Self {
        Self {
            case: self.case.clone(),
            scene: Scene { surfels, ..self.scene.clone() },
            truth: OnceCell::new(),
            ..*self
        }
    }

    /// The same shape of another count; a scan as it is.
    pub(super) fn of_count(&self, count: usize) -> Result<Self> {
        Ok(self.with(match self.case.of {
            Drawn::Shape(shape, _) => shape.surfels(count, 0)?,
            Drawn::Scan(_) => self.scene.surfels.clone(),
        }))
    }

    /// The same, seen through.
    pub(super) fn transparent(&self) -> Result<Self> {
        let cloud = self.scene.surfels.clone().into_cloud();
        let opacity = Some(vec![0.4; cloud.position.len()]);
        Ok(self.with(Surfels::new(Cloud { opacity, ..cloud })?.0))
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

    /// The picture, in the formats.
    pub(super) fn draw(&self, method: Method, groups: Option<&Grouping>) -> Result<Frame<f32>> {
        if self.formats.keep_all() {
            return self.reference(method, groups);
        }
        Ok(self.session(method, groups)?.stored(&self.camera, self.formats, false)?.frame)
    }

    /// The picture in `f32`, which others are compared with.
    pub(super) fn reference(
        &self,
        method: Method,
        groups: Option<&Grouping>,
    ) -> Result<Frame<f32>> {
        Ok(self.session(method, groups)?.render(&self.camera)?.frame.clone())
    }

    /// The true picture: of a shape the exact one.
    pub(super) fn truth(&self) -> Result<&Frame<f32>> {
        if let Some(known) = self.truth.get() {
            return Ok(known);
        }
        let truth = match &self.case.of {
            &Drawn::Shape(shape, _) => {
                let surface = Surface::Shape { shape, place: Similarity::IDENTITY, color: None };
                let view = (&self.camera, &[][..]);
                of_surfaces(&[surface], &self.scene, false, view, self.exec, &quiet)?
            }
            Drawn::Scan(file) => {
                let known = Known::of(file, &self.scene, self.exec, &quiet)?;
                known.still(&self.camera, self.exec, &quiet)?
            }
        };
        Ok(self.truth.get_or_init(|| truth.frame))
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
