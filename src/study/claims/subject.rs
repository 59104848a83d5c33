//! A case as a scene: its pictures by methods, its true picture, its times.

use super::{Case, Drawn};
use crate::compare::metrics::{Flicker, Metric};
use crate::error::{Error, Result};
use crate::frame::{Exec, Frame, Plane};
use crate::index::grouping::{Extended, Extension, Grouping, Rules};
use crate::io::scene_file::{CameraChoice, Ready, SceneFile};
use crate::method::buffer_formats::Formats;
use crate::method::{Method, Session};
use crate::scene::{Camera, Cloud, Groups, Scene, Similarity, Surfels};
use crate::study::run::cameras::shifted;
use crate::study::run::truths::Known;
use crate::study::truth::{Surface, of_surfaces};
use std::cell::{OnceCell, RefCell};
use std::rc::Rc;
use std::time::Instant;

/// Ignores progress.
pub(super) fn quiet(_: &str, _: u64, _: u64) {}

/// A scene with its camera.
pub(super) struct Subject<'e> {
    pub(super) case: Case,
    /// The formats in which passes store their results.
    pub(super) formats: Formats,
    pub(super) scene: Scene,
    pub(super) camera: Camera,
    pub(super) exec: &'e Exec,
    truth: OnceCell<Frame<f32>>,
    /// Pictures that a claim asked for; another claim may ask for them too.
    pictures: Kept<(Method, Option<Grouping>, Formats), Frame<f32>>,
    /// Groups of the surfels, for any opacity.
    groups: Rc<Kept<Grouping, Grouped>>,
}

/// Results by the settings that they were made with.
type Kept<K, V> = RefCell<Vec<(K, V)>>;

/// Groups, and how they were extended.
type Grouped = (Groups, Option<Extended>);

/// The cached value, or a new one that is cached now.
fn kept<K: PartialEq, V: Clone>(
    all: &Kept<K, V>,
    of: K,
    make: impl FnOnce() -> Result<V>,
) -> Result<V> {
    if let Some((_, value)) = all.borrow().iter().find(|(key, _)| *key == of) {
        return Ok(value.clone());
    }
    let made = make()?;
    all.borrow_mut().push((of, made.clone()));
    Ok(made)
}

/// Groups with the overlap c: a given number of them, or as many as c needs.
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
                    let what = format!("{}: claims need scenes of surfels", file.name);
                    return Err(Error::Invalid(what));
                }
                (loaded.scene, camera)
            }
        };
        let (truth, pictures, groups) = Default::default();
        let formats = Formats::WHOLE;
        Ok(Self { case, formats, scene, camera, exec, truth, pictures, groups })
    }

    /// Takes over the groups of the same surfels from another size of the picture.
    pub(super) fn share(&mut self, other: &Self) {
        self.groups = Rc::clone(&other.groups);
    }

    /// The same view of other surfels.
    pub(super) fn with(&self, surfels: Surfels) -> Self {
        Self {
            case: self.case.clone(),
            scene: Scene { surfels, ..self.scene.clone() },
            truth: OnceCell::new(),
            pictures: Kept::default(),
            groups: Rc::default(),
            ..*self
        }
    }

    /// The same shape with another count; a scan does not change.
    pub(super) fn of_count(&self, count: usize) -> Result<Self> {
        Ok(self.with(match self.case.of {
            Drawn::Shape(shape, _) => shape.surfels(count, 0)?,
            Drawn::Scan(_) => self.scene.surfels.clone(),
        }))
    }

    /// The same scene, transparent.
    pub(super) fn transparent(&self) -> Result<Self> {
        let cloud = self.scene.surfels.clone().into_cloud();
        let opacity = Some(vec![0.4; cloud.position.len()]);
        let groups = Rc::clone(&self.groups);
        Ok(Self { groups, ..self.with(Surfels::new(Cloud { opacity, ..cloud })?.0) })
    }

    /// The groups of the surfels.
    pub(super) fn groups(&self, grouping: &Grouping) -> Result<Grouped> {
        kept(&self.groups, *grouping, || {
            let found = grouping.groups(&self.scene.surfels, self.exec, &quiet)?;
            Ok((found.0, found.2))
        })
    }

    pub(super) fn session(&self, method: Method, groups: Option<&Grouping>) -> Result<Session<'_>> {
        match groups {
            None => Session::new(&self.scene, method, self.exec),
            Some(grouping) => {
                let (groups, _) = self.groups(grouping)?;
                Session::with_groups(&self.scene, method, Some(groups), self.exec)
            }
        }
    }

    /// The picture, in the storage formats.
    pub(super) fn draw(&self, method: Method, groups: Option<&Grouping>) -> Result<Frame<f32>> {
        if self.formats.keep_all() {
            return self.reference(method, groups);
        }
        kept(&self.pictures, (method, groups.copied(), self.formats), || {
            self.session(method, groups)?.emulate_planes(&self.camera, self.formats)
        })
    }

    /// The picture in `f32`, as a reference.
    pub(super) fn reference(
        &self,
        method: Method,
        groups: Option<&Grouping>,
    ) -> Result<Frame<f32>> {
        kept(&self.pictures, (method, groups.copied(), Formats::WHOLE), || {
            Ok(self.session(method, groups)?.render(&self.camera)?.frame.clone())
        })
    }

    /// The true picture; exact for a shape.
    pub(super) fn truth(&self) -> Result<&Frame<f32>> {
        if let Some(known) = self.truth.get() {
            return Ok(known);
        }
        let truth = match &self.case.of {
            &Drawn::Shape(shape, _) => {
                let surface = Surface::Shape { shape, place: Similarity::IDENTITY, color: None };
                of_surfaces(&[surface], &self.scene, false, &self.camera, &[], self.exec, &quiet)?
            }
            Drawn::Scan(file) => {
                let known = Known::about(file, &self.scene, self.exec, &quiet)?;
                known.still(&self.camera, self.exec, &quiet)?
            }
        };
        Ok(self.truth.get_or_init(|| truth.frame))
    }

    /// The error of a picture, by the name of a metric.
    pub(super) fn error(&self, frame: &Frame<f32>, truth: &Frame<f32>, name: &str) -> Result<f64> {
        let error = Metric::named(name)?.between(frame, truth, self.exec)?;
        error.ok_or_else(|| Error::Invalid(format!("{name}: the true picture is empty")))
    }

    /// How much a session's pictures change while the scene moves by eighths of a pixel, eight
    /// times: the [flicker](mod@crate::compare::metrics::flicker) against black.
    pub(super) fn flicker(&self, mut session: Session<'_>) -> Result<f64> {
        let cameras = shifted(&self.camera);
        let [width, height] = self.camera.size();
        let mut flicker = Flicker::new(width, height, cameras.len())?;
        let black = Plane::filled(width, height, [0.0; 3]);
        for camera in &cameras {
            flicker.push(session.render(camera)?.frame.color("")?, &black)?;
        }
        Ok(flicker.spectrum(self.exec)?.flicker)
    }

    /// The times of some stages of a picture, and of other stages: medians of nine, in ms.
    pub(super) fn laps(&self, session: &mut Session<'_>, stages: [&[&str]; 2]) -> Result<[f64; 2]> {
        let mut times = [Vec::new(), Vec::new()];
        for turn in 0..10 {
            let laps = &session.render(&self.camera)?.timings;
            for (names, times) in stages.iter().zip(&mut times) {
                let of = laps.iter().filter(|(name, _)| names.contains(name));
                // The first picture fills the caches.
                if turn > 0 {
                    times.push(of.map(|(_, time)| time.as_secs_f64() * 1e3).sum::<f64>());
                }
            }
        }
        Ok(times.map(median))
    }

    /// The median times of a picture by each of two sessions, nine by turns, in ms.
    pub(super) fn times(&self, mut sessions: [Session<'_>; 2]) -> Result<[f64; 2]> {
        let mut times = [Vec::new(), Vec::new()];
        for turn in 0..10 {
            for (session, times) in sessions.iter_mut().zip(&mut times) {
                let start = Instant::now();
                session.render(&self.camera)?;
                // The first picture fills the caches.
                if turn > 0 {
                    times.push(start.elapsed().as_secs_f64() * 1e3);
                }
            }
        }
        Ok(times.map(median))
    }
}

/// The median of an odd number of times.
pub(super) fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// The colours of pictures.
pub(super) fn colors(frames: &[&Frame<f32>]) -> Result<Vec<Plane<[f32; 3]>>> {
    frames.iter().map(|frame| Ok(frame.color("")?.clone())).collect()
}
