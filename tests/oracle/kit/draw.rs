//! The one place that draws: every call of the crate that makes a picture.

use crate::oracle::kit::case::Case;
use splatref::Result;
use splatref::frame::{Exec, Frame};
use splatref::index::Index;
use splatref::index::order::BackToFront;
use splatref::method::ewa::explain::{EwaReplay, explain};
use splatref::method::{Job, Method, Picture, Session, ewa};
use splatref::number::Exact;
use splatref::scene::{Camera, Groups, Scene, Surfels};

/// What is drawn, of what, and how.
#[derive(Clone, Copy)]
pub(crate) struct Drawing<'a> {
    scene: &'a Scene,
    camera: &'a Camera,
    method: Method,
    groups: Option<&'a Groups>,
    /// One thread if there is none.
    exec: Option<&'a Exec>,
}

impl<'a> Drawing<'a> {
    pub(crate) fn new(scene: &'a Scene, camera: &'a Camera, settings: impl Into<Method>) -> Self {
        Self { scene, camera, method: settings.into(), groups: None, exec: None }
    }

    pub(crate) fn grouped(self, groups: &'a Groups) -> Self {
        Self { groups: Some(groups), ..self }
    }

    pub(crate) fn on(self, exec: &'a Exec) -> Self {
        Self { exec: Some(exec), ..self }
    }

    fn session<T>(&self, draw: impl FnOnce(&mut Session<'_>) -> Result<T>) -> Result<T> {
        let one = Exec::sequential();
        let exec = self.exec.unwrap_or(&one);
        draw(&mut Session::with_groups(self.scene, self.method, self.groups.cloned(), exec)?)
    }

    /// By the definition in any number, or why not.
    pub(crate) fn try_define<R: Exact>(&self, stages: bool) -> Result<Picture<R>> {
        self.session(|session| session.define(self.camera, stages))
    }

    /// By the fast path, if the method has one, or why not.
    pub(crate) fn try_fast(&self) -> Result<Picture<f32>> {
        self.session(|session| session.render(self.camera).cloned())
    }

    /// By the definition in any number, with the planes of all stages.
    pub(crate) fn define<R: Exact>(&self) -> Picture<R> {
        self.try_define(true).expect("renders")
    }

    /// The frame of [`Self::define`].
    pub(crate) fn frame<R: Exact>(&self) -> Frame<R> {
        self.define().frame
    }

    /// By the definition, without the planes of stages.
    pub(crate) fn plain<R: Exact>(&self) -> Frame<R> {
        self.try_define(false).expect("renders").frame
    }

    pub(crate) fn fast(&self) -> Picture<f32> {
        self.try_fast().expect("renders")
    }

    /// As [`Self::fast`], in the memory of a picture that another camera has taken.
    pub(crate) fn fast_after(&self, other: &Camera) -> Picture<f32> {
        let drawn = self.session(|session| {
            session.render(other)?;
            session.render(self.camera).cloned()
        });
        drawn.expect("renders")
    }
}

/// What the 2+1-pass method does at a pixel.
pub(crate) fn explained(case: &Case<ewa::Settings>, pixel: (u32, u32)) -> EwaReplay<f32> {
    let Case { scene, camera, settings, .. } = case;
    let (index, exec) = (Index::default(), Exec::sequential());
    let job = Job::new(scene, &index, camera, &exec);
    explain(&job, settings, pixel).expect("inside")
}

/// The surfels from back to front.
pub(crate) fn back_to_front(surfels: &Surfels, camera: &Camera) -> Vec<u32> {
    BackToFront::new(surfels, &Exec::sequential()).walk(camera)
}
