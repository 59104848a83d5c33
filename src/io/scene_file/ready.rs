//! Prepare a scene file for drawing: load it, and resolve camera, method and groups.

use super::camera::CameraPath;
use super::model::Purpose;
use super::{Loaded, Model, Number, OutputSettings, SceneFile};
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::index::grouping::Grouping;
use crate::index::seen::Seen;
use crate::io::state::{self, State};
use crate::method::session::{Made, Making};
use crate::method::{Method, Picture, Session, deferred};
use crate::progress::Progress;
use crate::scene::objects::detail::refine::Refinement;
use crate::scene::{Camera, Objects, Primitives, Scene, Stereo, Surfels};
use crate::source::flatten;
use std::borrow::Cow;
use std::ops::Range;
use std::path::Path;

/// A loaded scene with resolved settings: everything that the picture of a frame needs.
#[derive(Clone, Debug)]
pub struct Ready {
    /// The scene, with a report about its models.
    pub loaded: Loaded,
    /// The camera.
    pub camera: Camera,
    /// The method and its settings.
    pub method: Method,
    /// How groups are made; `None` leaves the choice to the scene or the method.
    pub grouping: Option<Grouping>,
    /// The frame to draw.
    frame: u32,
    /// The camera of every frame, if the camera moves.
    path: Option<CameraPath>,
    /// The pair of which each frame's camera is an eye.
    stereo: Option<Stereo>,
}

impl SceneFile {
    /// Loads the scene in the frame to draw, and resolves camera and method. Errors in the settings
    /// are found before large files are read. A hierarchy is read as far as the camera draws it,
    /// anew in each frame.
    ///
    /// `progress` gets the name of a step, how much of it is done, and the total.
    ///
    /// # Errors
    /// As [`SceneFile::check_frame`], [`Stereo::one_eye`], [`SceneFile::load`], [`SceneFile::camera`] and [`Ready::at`];
    /// [`crate::Error::Invalid`] if a setting is out of range or unknown to the method, or if the
    /// method cannot draw the scene.
    pub fn ready(&self, exec: &Exec, progress: Progress<'_>) -> Result<Ready> {
        self.ready_for(Purpose::View, exec, progress)
    }

    /// [`SceneFile::ready`], loaded for a purpose.
    pub(super) fn ready_for(
        &self,
        purpose: Purpose<'_>,
        exec: &Exec,
        progress: Progress<'_>,
    ) -> Result<Ready> {
        self.check_drawing()?;
        self.placed(self.load_for(purpose, exec, progress)?, exec, progress)
    }

    /// Says what was chosen, but changes no picture of the method: one line each.
    ///
    /// # Errors
    /// As [`MethodChoice::method`](super::MethodChoice::method).
    pub fn without_effect(&self) -> Result<Vec<String>> {
        let method = self.method.method()?;
        let (scene, name) = (&self.name, method.name());
        let mut all = Vec::new();
        if !self.groups.settings.is_empty() && method.grouping().is_none() {
            all.push(format!(
                "{scene}: [groups] has no effect, because the method {name} draws no groups; remove it, \
                 or choose another method"
            ));
        }
        let has_levels = |model: &Model| model.mipmaps.is_some_and(|levels| levels > 0);
        if self.all_models().any(has_levels) && !matches!(method, Method::Deferred(_)) {
            all.push(format!(
                "{scene}: mipmaps have no effect, because the method {name} draws none; remove them, or \
                 choose the method deferred"
            ));
        }
        Ok(all)
    }

    /// Finds the errors of a frame that need no loaded scene.
    fn check_drawing(&self) -> Result<(Method, Option<Grouping>)> {
        let method = self.method.method()?;
        let grouping = self.grouping(&method)?;
        self.check_frame(self.frame)?;
        self.camera.stereo.map(Stereo::one_eye).transpose()?;
        Ok((method, grouping))
    }

    /// The same for a scene that is already loaded. It may have been loaded by a scene file that
    /// differs in its levels of detail, in how the scene is drawn, or in what is stored of a
    /// picture.
    ///
    /// # Errors
    /// As [`SceneFile::ready`], except for errors of files.
    pub fn ready_of(&self, loaded: Loaded, exec: &Exec) -> Result<Ready> {
        self.placed(loaded, exec, &|_, _, _| ())
    }

    fn placed(&self, loaded: Loaded, exec: &Exec, progress: Progress<'_>) -> Result<Ready> {
        let (method, grouping) = self.check_drawing()?;
        let loaded = self.refined(loaded)?;
        let (frame, path) = (self.frame, self.camera_path(&loaded.scene)?);
        let stereo = self.camera.stereo;
        let camera = match &path {
            Some(path) => path.at(frame)?,
            None => self.still_camera(&loaded.scene)?,
        };
        let camera = stereo.map_or(Ok(camera), |stereo| stereo.camera(camera))?;
        let mut ready = Ready { loaded, camera, method, grouping, frame, path, stereo };
        ready.place(exec, progress)?;
        Ok(ready)
    }
}

impl Ready {
    /// The same scene in another frame; reuses the memory of this one.
    ///
    /// # Errors
    /// As [`Ready::camera_at`], [`Objects::at`], [`Objects::seen_from`] and [`flatten()`]; of a geometry
    /// with a file for each frame, as [`SceneFile::load`], and [`Error::Format`] if the file has other
    /// surfels than the file of frame 0.
    pub fn at(mut self, frame: u32, exec: &Exec) -> Result<Self> {
        self.camera = self.camera_at(frame)?;
        self.frame = frame;
        if !self.is_still() {
            self.place(exec, &|_, _, _| ())?;
        }
        Ok(self)
    }

    /// The same scene, whose next [frame](Ready::at) draws ordered points this size in pixels, see
    /// [`Refinement`](crate::scene::objects::detail::refine::Refinement).
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if the size is out of range.
    pub fn with_surfel_size(mut self, surfel_size: f32) -> Result<Self> {
        let scene = &mut self.loaded.scene;
        if let Some(objects) = scene.objects.take() {
            let refinement = Refinement { surfel_size, ..objects.refinement().clone() };
            scene.objects = Some(objects.with_refinement(refinement)?);
        }
        Ok(self)
    }

    /// Whether the scene has points in an order, of which a view draws as many as it needs.
    #[must_use]
    pub fn has_ordered_points(&self) -> bool {
        self.loaded.scene.objects.as_ref().is_some_and(Objects::have_prefixes)
    }

    /// The camera in a frame.
    ///
    /// # Errors
    /// As [`Camera::new`] and [`Stereo::camera`]; [`Error::Usage`] if the scene has a surface, which
    /// belongs to the view of one frame, and this is another.
    pub fn camera_at(&self, frame: u32) -> Result<Camera> {
        if self.loaded.scene.surface.is_some() && frame != self.frame {
            let what = "a surface belongs to one view; draw frame by frame, each by --frame and with its \
                        own surface";
            return Err(Error::Usage(what.into()));
        }
        let Some(path) = &self.path else { return Ok(self.camera) };
        let camera = path.at(frame)?;
        self.stereo.map_or(Ok(camera), |stereo| stereo.camera(camera))
    }

    /// Whether the scene is the same in every frame, so that one session draws all of them.
    #[must_use]
    pub fn is_still(&self) -> bool {
        let depends_on_camera = |objects: &Objects| objects.have_detail() && self.path.is_some();
        let is_still = |objects: &Objects| objects.are_still() && !depends_on_camera(objects);
        self.loaded.moving.is_empty() && self.loaded.scene.objects.as_ref().is_none_or(is_still)
    }

    /// The frame.
    #[must_use]
    pub fn frame(&self) -> u32 {
        self.frame
    }

    /// Checks, before long work, that frames can be drawn as far as that is known without reading more
    /// than names: they have cameras, and the files of geometries with a file for each frame exist.
    ///
    /// # Errors
    /// As [`Ready::camera_at`]; [`Error::Io`] for a file that is missing.
    pub fn check_frames(&self, mut frames: Range<u32>) -> Result<()> {
        self.loaded.moving.check_files(frames.clone())?;
        frames.try_for_each(|frame| self.camera_at(frame).map(drop))
    }

    /// The identity of the scene in files of states: its SHA-256, with objects as in frame 0. Geometries
    /// with a file for each frame are read again for this.
    ///
    /// # Errors
    /// As [`Ready::at`].
    pub fn identity(&self, exec: &Exec) -> Result<String> {
        let Loaded { scene, moving, .. } = &self.loaded;
        match &scene.objects {
            None => Ok(scene.sha256()),
            Some(objects) => {
                let objects = Some(moving.at(objects.clone(), 0, exec)?.0);
                let (surfels, primitives) = (Surfels::none(), Primitives::default());
                Ok(Scene { objects, surfels, primitives, ..scene.clone() }.sha256())
            }
        }
    }

    /// Reads from a file what the frame before saw.
    ///
    /// # Errors
    /// As [`state::read`]; [`Error::Usage`] if the method carries nothing from frame to frame, if the
    /// state is not that of the frame before, or if the method has another number of `flags`.
    pub fn state(&self, path: &Path, exec: &Exec) -> Result<Seen> {
        let Method::Deferred(settings) = &self.method else {
            let what = format!(
                "the method {} has no state between frames; give --method deferred, or no state",
                self.method.name()
            );
            return Err(Error::Usage(what));
        };
        let scene = &self.loaded.scene;
        let ids = deferred::ids(scene);
        let State { frame, seen } = state::read(path, &self.identity(exec)?, &ids)?;
        if frame.checked_add(1) != Some(self.frame) {
            let (next, own) = (u64::from(frame) + 1, self.frame);
            let what = format!(
                "{}: the state after frame {frame} is for frame {next}, but this is frame {own}; give \
                 --frame {next}, or the state after the frame before",
                path.display()
            );
            return Err(Error::Usage(what));
        }
        seen.check(&ids, settings.flags)
            .map_err(|error| Error::Usage(format!("{}: {error}", path.display())))?;
        Ok(seen)
    }

    /// Puts the objects in their places of the frame, as the camera sees them. The method then gets
    /// the objects, or all their surfels if it does not draw objects.
    fn place(&mut self, exec: &Exec, progress: Progress<'_>) -> Result<()> {
        let Loaded { scene, unread, moving, .. } = &mut self.loaded;
        let mut doubts = Vec::new();
        if let Some(objects) = scene.objects.take() {
            // Free the surfels of the last frame first.
            (scene.surfels, scene.primitives) = (Surfels::none(), Primitives::default());
            let (objects, of_files) = moving.at(objects, self.frame, exec)?;
            doubts = of_files;
            let view = objects.seen_from(&self.camera, exec)?;
            drop(objects);
            scene.objects = Some(match unread {
                Some(hierarchy) => hierarchy.needed_by(view, exec, progress)?,
                None => view,
            });
            if !self.method.draws_objects() {
                *scene = flatten(scene, exec)?;
            }
        }
        self.method.check_scene(scene)?;
        self.loaded.doubt(doubts);
        Ok(())
    }

    /// Prepares a session of the scene and the method; also says how groups were made, if they
    /// were.
    ///
    /// # Errors
    /// As [`Session::prepare`].
    pub fn session<'a>(
        &'a self,
        exec: &'a Exec,
        progress: Progress<'_>,
    ) -> Result<(Session<'a>, Option<Made>)> {
        Session::prepare(&self.loaded.scene, self.method, self.grouping, exec, progress)
    }
}

impl OutputSettings {
    /// Checks that passes store everything in `f32`, for callers that accept no other pictures.
    ///
    /// # Errors
    /// [`Error::Usage`] with a reason.
    pub fn check_kept(&self, why: &str) -> Result<()> {
        if self.formats.keep_all() {
            return Ok(());
        }
        Err(Error::Usage(format!("{why}; give --storage f32 and --depth-storage f32")))
    }

    /// Checks that a file can hold the region of a session: the projection of a region is in `f32`,
    /// because the stages after it go on from the file.
    ///
    /// # Errors
    /// [`Error::Usage`] if the region [is a projection](Session::projects), and other numbers are chosen.
    pub fn check_part(self, session: &Session<'_>, camera: &Camera) -> Result<()> {
        let single = self.number == Number::F32 && self.formats.keep_all();
        if single || !session.projects(camera) {
            return Ok(());
        }
        let name = session.method().name();
        Err(Error::Usage(format!(
            "a region of the method {name} holds f32, from which the other stages go on; give --number f32, \
             --storage f32 and --depth-storage f32, or draw the whole picture"
        )))
    }

    /// The call by which [`OutputSettings::draw`] draws.
    #[must_use]
    pub fn making(self) -> Making {
        match (self.number, self.stages) {
            (Number::F32, false) if self.formats.keep_all() => Making::Render,
            (Number::F32, stages) => Making::Define { number: 4, stages },
            (Number::F64, stages) => Making::Define { number: 8, stages },
        }
    }

    /// Draws a picture in the chosen number type and with the chosen planes, as files hold it.
    ///
    /// # Errors
    /// As [`OutputSettings::check_part`], [`Session::render`], [`Session::define`] and
    /// [`Session::emulate`], and [`Error::Invalid`] if other formats are chosen with f64.
    pub fn draw<'s>(
        self,
        session: &'s mut Session<'_>,
        camera: &Camera,
    ) -> Result<Cow<'s, Picture<f32>>> {
        self.check_part(session, camera)?;
        if !self.formats.keep_all() {
            if self.number == Number::F64 {
                let what = "storage formats need f32; give number = \"f32\", or f32 storage";
                return Err(Error::Invalid(what.into()));
            }
            return Ok(Cow::Owned(session.emulate(camera, self.formats, self.stages)?));
        }
        Ok(match (self.number, self.stages) {
            (Number::F32, false) => Cow::Borrowed(session.render(camera)?),
            (Number::F32, true) => Cow::Owned(session.define::<f32>(camera, true)?),
            (Number::F64, stages) => {
                let Picture { frame, tally, timings, seen } =
                    session.define::<f64>(camera, stages)?;
                Cow::Owned(Picture { frame: frame.to_f32(), tally, timings, seen })
            }
        })
    }
}
