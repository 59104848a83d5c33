//! Any method, chosen by a value, with what it needs before the first view.

use super::single_pass::{BinCount, DepthTest};
use super::{Picture, ewa, peeling, pyramid, single_pass, template, transparent};
use crate::composite::bins::Range;
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::index::order::BackToFront;
use crate::io::scene_file::{MethodName, words};
use crate::number::Real;
use crate::scene::Groups;
use crate::scene::{Camera, Scene, Surfels};
use std::sync::Mutex;

/// A method and what it computes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// EWA splatting in 2+1 passes.
    Ewa(ewa::Settings),
    /// Algorithm 1 of \[ZP06\].
    SinglePass(single_pass::Settings),
    /// Algorithms 2 and 3 of \[ZP06\].
    Transparent(transparent::Settings),
    /// Depth peeling.
    Peeling(peeling::Settings),
    /// Pull-push interpolation \[MKC08\].
    Pyramid(pyramid::Settings),
    /// Reconstruction with templates \[MOC08\].
    Template(template::Settings),
}

impl Method {
    /// Footprints, epsilon and culling of a method that draws splats; none of one that reconstructs
    /// in image space.
    #[must_use]
    pub fn splats(&self) -> Option<&ewa::Settings> {
        match self {
            Self::Ewa(settings) => Some(settings),
            Self::SinglePass(settings) => Some(&settings.splats),
            Self::Transparent(settings) => Some(&settings.splats),
            Self::Peeling(settings) => Some(&settings.splats),
            Self::Pyramid(_) | Self::Template(_) => None,
        }
    }

    /// Whether what is seen from behind is dropped.
    #[must_use]
    pub fn culls(&self) -> bool {
        match self {
            Self::Pyramid(settings) => settings.cull,
            Self::Template(settings) => settings.cull,
            _ => self.splats().is_some_and(|splats| splats.cull),
        }
    }

    /// Whether the numbers are in range.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if one is not.
    pub fn check(&self) -> Result<()> {
        match self {
            Self::Ewa(settings) => settings.check(),
            Self::SinglePass(settings) => settings.check(),
            Self::Transparent(settings) => settings.check(),
            Self::Peeling(settings) => settings.check(),
            Self::Pyramid(settings) => settings.check(),
            Self::Template(settings) => settings.check(),
        }
    }

    /// The depth bins that it sorts fragments into, if it does; those of its blending, if it
    /// blends.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] as [`BinCount::resolve`].
    pub fn depth_bins(&self, surfels: &Surfels, camera: &Camera) -> Result<Option<Range>> {
        let (bins, splats): (&BinCount, _) = match self {
            Self::SinglePass(single_pass::Settings { depth: DepthTest::Voronoi(bins), splats }) => {
                (bins, splats)
            }
            Self::Transparent(settings) => (&settings.bins, &settings.splats),
            _ => return Ok(None),
        };
        bins.resolve(surfels, camera, splats.epsilon.resolve(surfels)).map(Some)
    }

    /// Whether it draws triangles, ribbons and tubes beside surfels.
    #[must_use]
    pub fn draws_primitives(&self) -> bool {
        match self {
            Self::Pyramid(_) => true,
            Self::Ewa(_)
            | Self::SinglePass(_)
            | Self::Transparent(_)
            | Self::Peeling(_)
            | Self::Template(_) => false,
        }
    }

    /// Whether it can draw all of a scene.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the scene has primitives and the method draws surfels alone.
    pub fn check_scene(&self, scene: &Scene) -> Result<()> {
        if scene.primitives.is_empty() || self.draws_primitives() {
            return Ok(());
        }
        let word = words::of_method(MethodName::of(self));
        Err(Error::Invalid(format!(
            "{} has triangles or lines, which the method {word} does not draw; \
             use --method pyramid",
            scene.name
        )))
    }

    /// Whether it draws groups.
    #[must_use]
    pub fn needs_groups(&self) -> bool {
        matches!(self, Self::SinglePass(_) | Self::Transparent(_))
    }
}

/// What a method needs of a scene before any view; made once.
#[derive(Debug)]
pub struct Preparation {
    /// For methods that draw groups.
    groups: Option<Groups>,
    /// For methods that blend from back to front.
    order: Option<BackToFront>,
    memory: Memory,
}

/// What the fast paths of the image-space methods work in, kept from picture to picture; a picture
/// that is drawn while another one is has its own.
#[derive(Debug, Default)]
struct Memory {
    pyramid: Mutex<pyramid::fast::CellLevels>,
    template: Mutex<template::fast::CenterLevels>,
}

/// Runs `draw` with what a mutex holds, or with new memory if another thread has it.
fn with<T: Default, U>(memory: &Mutex<T>, draw: impl FnOnce(&mut T) -> U) -> U {
    match memory.try_lock() {
        Ok(mut memory) => draw(&mut memory),
        Err(_) => draw(&mut T::default()),
    }
}

impl Preparation {
    /// For a method; `groups` are not used by one that does without, and missed by [`render`] if
    /// there are none for one that draws them.
    #[must_use]
    pub fn new(surfels: &Surfels, groups: Option<Groups>, method: &Method, exec: &Exec) -> Self {
        let blends = matches!(method, Method::Transparent(_));
        let groups = groups.filter(|_| method.needs_groups());
        let order = blends.then(|| BackToFront::new(surfels, exec));
        Self { groups, order, memory: Memory::default() }
    }

    /// The groups, if the method draws them.
    #[must_use]
    pub fn groups(&self) -> Option<&Groups> {
        self.groups.as_ref()
    }
}

/// Renders with the definition, in any number; see the `render` of each method.
///
/// # Errors
/// As the method and [`Method::check_scene`]; [`Error::Invalid`] if the preparation is not that of
/// the scene and the method.
pub fn render<R: Real>(
    scene: &Scene,
    preparation: &Preparation,
    camera: &Camera,
    method: &Method,
    exec: &Exec,
    stages: bool,
) -> Result<Picture<R>> {
    method.check_scene(scene)?;
    match (method, preparation) {
        (Method::Ewa(settings), _) => ewa::render(scene, camera, settings, exec, stages),
        (Method::Peeling(settings), _) => peeling::render(scene, camera, settings, exec, stages),
        (Method::Pyramid(settings), _) => pyramid::render(scene, camera, settings, exec, stages),
        (Method::Template(settings), _) => template::render(scene, camera, settings, exec, stages),
        (Method::SinglePass(settings), Preparation { groups: Some(groups), .. }) => {
            single_pass::render(scene, groups, camera, settings, exec, stages)
        }
        (
            Method::Transparent(settings),
            Preparation { groups: Some(groups), order: Some(order), .. },
        ) => transparent::render(scene, (groups, order), camera, settings, exec, stages),
        _ => Err(Error::Invalid(
            "the scene was prepared for another method, or without groups".into(),
        )),
    }
}

/// Renders in `f32` without the planes of stages, by the fast path where there is one; `earlier` is
/// a picture whose memory may be used again.
///
/// # Errors
/// As [`render`].
pub fn render_f32(
    scene: &Scene,
    preparation: &Preparation,
    camera: &Camera,
    method: &Method,
    exec: &Exec,
    earlier: Option<Picture<f32>>,
) -> Result<Picture<f32>> {
    method.check_scene(scene)?;
    match (method, &preparation.groups, earlier) {
        (Method::Ewa(settings), _, Some(earlier)) => {
            ewa::render_f32_again(scene, camera, settings, exec, earlier)
        }
        (Method::Ewa(settings), _, None) => ewa::render_f32(scene, camera, settings, exec),
        (Method::SinglePass(settings), Some(groups), Some(earlier)) => {
            single_pass::render_f32_again(scene, groups, camera, settings, exec, earlier)
        }
        (Method::SinglePass(settings), Some(groups), None) => {
            single_pass::render_f32(scene, groups, camera, settings, exec)
        }
        (Method::Pyramid(settings), _, earlier) => with(&preparation.memory.pyramid, |levels| {
            pyramid::render_f32(scene, camera, settings, exec, levels, earlier)
        }),
        (Method::Template(settings), _, earlier) => with(&preparation.memory.template, |levels| {
            template::render_f32(scene, camera, settings, exec, levels, earlier)
        }),
        _ => render(scene, preparation, camera, method, exec, false),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::index::grouping::{Extension, Grouping, Rules};
    use crate::scene::{Lens, Light, Phong, Triangles, Vertices};
    use crate::source::Shape;
    use glam::Vec3;

    fn surfel_methods() -> [Method; 5] {
        [
            Method::Ewa(ewa::Settings::default()),
            Method::SinglePass(single_pass::Settings::default()),
            Method::Transparent(transparent::Settings::default()),
            Method::Peeling(peeling::Settings::default()),
            Method::Template(template::Settings::default()),
        ]
    }

    /// A few surfels of a sphere, and a camera.
    fn sphere() -> (Scene, Camera) {
        let shape = Shape::Sphere;
        let surfels = shape.surfels(40, 0).unwrap();
        let (lights, material) = (vec![Light::DEFAULT], Phong::default());
        let name = "sphere".to_owned();
        let scene = Scene {
            name,
            surfels,
            lights,
            material,
            primitives: Default::default(),
            environment: None,
        };
        let camera = Camera::new(8, 8, shape.default_pose(), Lens::FieldOfView(40.0)).unwrap();
        (scene, camera)
    }

    #[test]
    fn primitives_are_refused_by_methods_that_draw_surfels_alone() {
        let (mut scene, camera) = sphere();
        let exec = Exec::sequential();
        let vertices = Vertices {
            position: vec![Vec3::X, Vec3::Y, Vec3::Z],
            direction: vec![Vec3::ONE; 3],
            radius: vec![0.0; 3],
            color: None,
        };
        scene.primitives.triangles = Triangles::new(vertices, vec![[0, 1, 2]]).unwrap().0;
        for method in surfel_methods() {
            assert!(!method.draws_primitives());
            let prepared = Preparation::new(&scene.surfels, None, &method, &exec);
            let plain = render::<f32>(&scene, &prepared, &camera, &method, &exec, true);
            let fast = render_f32(&scene, &prepared, &camera, &method, &exec, None);
            for error in [plain.unwrap_err(), fast.unwrap_err()] {
                let line = error.to_string();
                assert!(line.starts_with("sphere has triangles or lines, which the method "));
                assert!(line.ends_with(" does not draw; use --method pyramid"), "{line}");
            }
        }
    }

    #[test]
    fn a_scene_of_nothing_is_an_empty_picture_or_refused() {
        let (mut scene, camera) = sphere();
        scene.surfels = Surfels::none();
        let exec = Exec::sequential();
        let pyramid = Method::Pyramid(pyramid::Settings::default());
        for method in surfel_methods().into_iter().chain([pyramid]) {
            let groups = Groups::new(vec![], vec![], vec![1.0]).unwrap();
            let prepared = Preparation::new(&scene.surfels, Some(groups), &method, &exec);
            match render_f32(&scene, &prepared, &camera, &method, &exec, None) {
                Ok(picture) => assert_eq!(picture.tally.visible, 0),
                Err(error) => assert!(error.to_string().contains("an epsilon of 0"), "{error}"),
            }
        }
        for extension in [Extension::None, Extension::Add { most: 0.5 }, Extension::Enlarge] {
            for count in [None, Some(2)] {
                let grouping = Grouping { rules: Rules::default(), count, extension };
                let found = grouping.groups(&scene.surfels, &exec, &|_, _, _| ());
                assert!(found.is_ok_and(|(groups, ..)| groups.own().is_empty()));
            }
        }
    }

    #[test]
    fn a_preparation_for_another_method_is_refused() {
        let (scene, camera) = sphere();
        let exec = Exec::sequential();
        let ewa = Method::Ewa(ewa::Settings::default());
        let prepared = Preparation::new(&scene.surfels, None, &ewa, &exec);
        assert!(render_f32(&scene, &prepared, &camera, &ewa, &exec, None).is_ok());
        let single_pass = Method::SinglePass(single_pass::Settings::default());
        let transparent = Method::Transparent(transparent::Settings::default());
        for method in [single_pass, transparent] {
            for prepared in [&prepared, &Preparation::new(&scene.surfels, None, &method, &exec)] {
                let error = render_f32(&scene, prepared, &camera, &method, &exec, None);
                assert!(error.unwrap_err().to_string().contains("prepared"));
            }
        }
    }
}
