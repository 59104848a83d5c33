//! The one place that draws: every call of the crate that makes a picture.

use crate::kit::case::Case;
use splatref::Result;
use splatref::frame::{Exec, Frame};
use splatref::index::order::BackToFront;
use splatref::method::ewa::explain::{Explanation, explain};
use splatref::method::{
    Method, Picture, Preparation, ewa, peeling, pyramid, render, render_f32, single_pass, template,
    transparent,
};
use splatref::number::Real;
use splatref::scene::{Camera, Groups, Scene, Surfels};

/// The settings of a method: they say which method.
pub(crate) trait Chosen: Copy {
    fn method(self) -> Method;
}

macro_rules! chosen {
    ($($settings:ty => $method:expr),* $(,)?) => {
        $(impl Chosen for $settings {
            fn method(self) -> Method {
                $method(self)
            }
        })*
    };
}

chosen! {
    ewa::Settings => Method::Ewa,
    single_pass::Settings => Method::SinglePass,
    transparent::Settings => Method::Transparent,
    peeling::Settings => Method::Peeling,
    pyramid::Settings => Method::Pyramid,
    template::Settings => Method::Template,
}

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
    pub(crate) fn new(scene: &'a Scene, camera: &'a Camera, settings: impl Chosen) -> Self {
        Self { scene, camera, method: settings.method(), groups: None, exec: None }
    }

    pub(crate) fn grouped(self, groups: &'a Groups) -> Self {
        Self { groups: Some(groups), ..self }
    }

    pub(crate) fn on(self, exec: &'a Exec) -> Self {
        Self { exec: Some(exec), ..self }
    }

    fn executed<T>(&self, draw: impl FnOnce(&Preparation, &Exec) -> T) -> T {
        let one = Exec::sequential();
        let exec = self.exec.unwrap_or(&one);
        let groups = self.groups.cloned();
        draw(&Preparation::new(&self.scene.surfels, groups, &self.method, exec), exec)
    }

    /// By the definition in any number, or why not.
    pub(crate) fn try_define<R: Real>(&self, stages: bool) -> Result<Picture<R>> {
        let Self { scene, camera, method, .. } = self;
        self.executed(|prepared, exec| render(scene, prepared, camera, method, exec, stages))
    }

    /// By the fast path, if the method has one, or why not.
    pub(crate) fn try_fast(&self) -> Result<Picture<f32>> {
        let Self { scene, camera, method, .. } = self;
        self.executed(|prepared, exec| render_f32(scene, prepared, camera, method, exec, None))
    }

    /// By the definition in any number, with the planes of all stages.
    pub(crate) fn define<R: Real>(&self) -> Picture<R> {
        self.try_define(true).expect("renders")
    }

    /// The frame of [`Self::define`].
    pub(crate) fn frame<R: Real>(&self) -> Frame<R> {
        self.define().frame
    }

    /// By the definition, without the planes of stages.
    pub(crate) fn plain<R: Real>(&self) -> Frame<R> {
        self.try_define(false).expect("renders").frame
    }

    pub(crate) fn fast(&self) -> Picture<f32> {
        self.try_fast().expect("renders")
    }

    /// As [`Self::fast`], in the memory of a picture that another camera has taken.
    pub(crate) fn fast_after(&self, other: &Camera) -> Picture<f32> {
        let Self { scene, camera, method, .. } = self;
        self.executed(|prepared, exec| {
            let draw = |camera, earlier| render_f32(scene, prepared, camera, method, exec, earlier);
            let earlier = draw(other, None).expect("renders");
            draw(camera, Some(earlier)).expect("renders")
        })
    }
}

/// What the 2+1-pass method does at a pixel.
pub(crate) fn explained(case: &Case<ewa::Settings>, pixel: (u32, u32)) -> Explanation<f32> {
    let Case { scene, camera, settings, .. } = case;
    explain(&scene.surfels, camera, settings, &Exec::sequential(), pixel).expect("inside")
}

/// The surfels from back to front.
pub(crate) fn back_to_front(surfels: &Surfels, camera: &Camera) -> Vec<u32> {
    BackToFront::new(surfels, &Exec::sequential()).walk(camera)
}

/// A transparent picture in the order of other surfels.
pub(crate) fn in_order_of(
    case: &Case<transparent::Settings>,
    other: &Surfels,
) -> Result<Picture<f32>> {
    let exec = Exec::sequential();
    let order = BackToFront::new(other, &exec);
    let Case { scene, camera, settings, .. } = case;
    transparent::render(scene, (case.groups(), &order), camera, settings, &exec, false)
}
