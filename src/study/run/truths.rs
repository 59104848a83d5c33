//! What is taken for the truth of a scene.
//!
//! - Of procedural shapes their exact surfaces; of meshes, and of a tree, their triangles, whatever a
//!   candidate draws of them: also where a mesh is drawn as points, or a prefix of them.
//! - Where no surface is known, as of points alone, all points by the converged picture of
//!   [`truth::of_points`], and the reason.
//!
//! `Decided:` the truth of a scene of which a part has no surface is that of its points: a picture of
//! two kinds of truth would be neither.

use super::cameras;
use crate::error::Result;
use crate::frame::{Exec, Frame};
use crate::io::scene_file::{Draw, GroupChoice, MethodChoice, SceneFile, Source};
use crate::method::Method;
use crate::scene::{Camera, Scene};
use crate::study::truth::{self, Surface, Truth};

/// What the true picture is of.
#[derive(Clone, Debug)]
pub struct Known {
    /// The lights, and the surfels if there are no surfaces.
    scene: Scene,
    surfaces: Vec<Surface>,
    /// Why no surface is known.
    unknown: Option<String>,
}

/// The true pictures of a study.
#[derive(Clone, Debug)]
pub struct Truths {
    /// Of the picture itself.
    pub still: Truth,
    /// Under the [shifts](cameras::shifted).
    pub shifted: Vec<Frame<f32>>,
    /// Along the [path](cameras::path).
    pub path: Vec<Frame<f32>>,
}

impl Known {
    /// What is known of a scene.
    ///
    /// # Errors
    /// As [`SceneFile::ready`] where not even points can be drawn.
    pub fn of(file: &SceneFile, exec: &Exec, progress: &dyn Fn(&str, u64, u64)) -> Result<Self> {
        match surfaces(file, exec, progress) {
            Ok((scene, surfaces)) => Ok(Self { scene, surfaces, unknown: None }),
            Err(why) => {
                let scene = drawn(file, |draw| draw, exec, progress)?;
                Ok(Self { scene, surfaces: Vec::new(), unknown: Some(why) })
            }
        }
    }

    /// The same under the lights of another scene.
    #[must_use]
    pub fn lit_as(mut self, other: &SceneFile) -> Self {
        self.scene.lights.clone_from(&other.lights);
        self.scene.material = other.material;
        self
    }

    /// Why no surface is known, if none is.
    #[must_use]
    pub fn unknown(&self) -> Option<&str> {
        self.unknown.as_deref()
    }

    /// The true picture from a camera.
    ///
    /// # Errors
    /// As [`truth::of_surfaces`] and [`truth::of_points`].
    pub fn picture(
        &self,
        camera: &Camera,
        exec: &Exec,
        progress: &dyn Fn(&str, u64, u64),
    ) -> Result<Truth> {
        if self.unknown.is_some() {
            truth::of_points(&self.scene, camera, exec, progress)
        } else {
            truth::of_surfaces(&self.surfaces, &self.scene, camera, exec, progress)
        }
    }

    /// The true pictures of a study that looks from a camera.
    ///
    /// # Errors
    /// As [`Known::picture`].
    pub fn pictures(
        &self,
        camera: &Camera,
        exec: &Exec,
        progress: &dyn Fn(&str, u64, u64),
    ) -> Result<Truths> {
        let all: Vec<Camera> =
            [cameras::shifted(camera), cameras::path(camera)].into_iter().flatten().collect();
        let mut frames = Vec::new();
        let still = self.picture(camera, exec, progress)?;
        for (i, camera) in all.iter().enumerate() {
            progress("the truth of flicker", i as u64, all.len() as u64);
            frames.push(self.picture(camera, exec, &|_, _, _| ())?.frame);
        }
        let path = frames.split_off(cameras::FRAMES as usize);
        Ok(Truths { still, shifted: frames, path })
    }
}

/// The surfaces of a scene and its lights, or why there are none.
fn surfaces(
    file: &SceneFile,
    exec: &Exec,
    progress: &dyn Fn(&str, u64, u64),
) -> std::result::Result<(Scene, Vec<Surface>), String> {
    if file.hierarchy.is_some() {
        return Err("a hierarchy shows what its nodes hold".into());
    }
    let is_shape = |source: &Source| matches!(source, Source::Shape { .. });
    if let Some(geometry) = file.geometries.iter().find(|one| is_shape(&one.model.source)) {
        return Err(format!("the geometry {} is a shape that objects share", geometry.name));
    }
    if file.all_models().any(|model| model.opacity.is_some()) {
        return Err("surfaces have no opacity".into());
    }
    let mut all: Vec<Surface> = Vec::new();
    for model in &file.models {
        if let Source::Shape { shape, .. } = &model.source {
            all.push(Surface::Shape { shape: *shape, place: model.transform, color: model.color });
        }
    }
    let mut meshes = file.clone();
    meshes.models.retain(|model| !is_shape(&model.source));
    if meshes.models.is_empty() && meshes.geometries.is_empty() {
        let lights = Scene {
            lights: file.lights.clone(),
            material: file.material,
            ..Scene::unlit(&file.name, crate::scene::Surfels::none())
        };
        return Ok((lights, all));
    }
    let scene =
        drawn(&meshes, |_| Draw::Polygons, exec, progress).map_err(|error| error.to_string())?;
    if !scene.surfels.is_empty() {
        return Err("a part of the scene is points alone".into());
    }
    all.push(Surface::Triangles(scene.primitives.clone()));
    Ok((scene, all))
}

/// The whole scene with all that it has, each model drawn as `draw` says of its draw, flat.
fn drawn(
    file: &SceneFile,
    draw: impl Fn(Draw) -> Draw,
    exec: &Exec,
    progress: &dyn Fn(&str, u64, u64),
) -> Result<Scene> {
    let mut whole = file.clone();
    for model in whole.all_models_mut() {
        model.draw = draw(model.draw);
        model.progressive = false;
        model.mipmaps = None;
    }
    whole.groups = GroupChoice::default();
    let polygons = whole.all_models().all(|model| model.draw == Draw::Polygons);
    let able = Method::all().into_iter().find(|method| !polygons || method.draws_primitives());
    whole.method =
        MethodChoice { name: able.map(|method| method.name()), ..MethodChoice::default() };
    Ok(whole.ready(exec, progress)?.loaded.scene)
}
