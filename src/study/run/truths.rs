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
use crate::frame::{Exec, Plane};
use crate::io::scene_file::{Draw, GroupChoice, MethodChoice, SceneFile, Source};
use crate::method::Method;
use crate::scene::{Camera, Scene, Surfels};
use crate::setting::{Fields, Value};
use crate::study::truth::{self, Surface, Truth};

/// What the true picture is of.
#[derive(Clone, Debug)]
pub struct Known {
    /// The lights, and the surfels if there are no surfaces.
    scene: Scene,
    surfaces: Vec<Surface>,
    /// Whether what is seen from behind is passed through.
    cull: bool,
    /// Why no surface is known.
    unknown: Option<String>,
}

/// The true pictures of a study.
#[derive(Clone, Debug)]
pub struct Truths {
    /// Of the picture itself, and its colours under the [shifts](cameras::shifted).
    pub still: Truth,
    /// The colours along the [path](cameras::path), the first those of the picture itself; none where
    /// no surface is known.
    pub path: Vec<Plane<[f32; 3]>>,
}

impl Known {
    /// What is known of a scene, under the lights and before the environment of a loaded one: its own,
    /// or that whose truth it is.
    ///
    /// # Errors
    /// As [`SceneFile::ready`] where not even points can be drawn.
    pub fn of(
        file: &SceneFile,
        lit: &Scene,
        exec: &Exec,
        progress: &dyn Fn(&str, u64, u64),
    ) -> Result<Self> {
        let method = file.method.method()?;
        let cull = method.values().contains(&("cull", Value::Switch(true)));
        let (surfels, surfaces, unknown) = match surfaces(file, exec, progress) {
            Ok(surfaces) => (Surfels::none(), surfaces, None),
            Err(why) => {
                let points = drawn(file, |draw| draw, exec, progress)?.surfels;
                (points, Vec::new(), Some(why))
            }
        };
        let scene = Scene {
            surfels,
            lights: lit.lights.clone(),
            material: lit.material,
            environment: lit.environment.clone(),
            ..Scene::unlit(&lit.name, Surfels::none())
        };
        Ok(Self { scene, surfaces, cull, unknown })
    }

    /// Why no surface is known, if none is.
    #[must_use]
    pub fn unknown(&self) -> Option<&str> {
        self.unknown.as_deref()
    }

    /// The true picture from a camera, and its colours under shifts.
    ///
    /// # Errors
    /// As [`truth::of_surfaces`] and [`truth::of_points`].
    fn picture(
        &self,
        looks: (&Camera, &[[u32; 2]]),
        exec: &Exec,
        progress: &dyn Fn(&str, u64, u64),
    ) -> Result<Truth> {
        if self.unknown.is_some() {
            return truth::of_points(&self.scene, looks, exec, progress);
        }
        truth::of_surfaces(&self.surfaces, &self.scene, self.cull, looks, exec, progress)
    }

    /// The true picture from a camera.
    ///
    /// # Errors
    /// As [`truth::of_surfaces`] and [`truth::of_points`].
    pub fn still(
        &self,
        camera: &Camera,
        exec: &Exec,
        progress: &dyn Fn(&str, u64, u64),
    ) -> Result<Truth> {
        self.picture((camera, &[]), exec, progress)
    }

    /// The true pictures of a study that looks from a camera. Those along the path are not made of
    /// points alone, where each takes as long as a study.
    ///
    /// # Errors
    /// As [`truth::of_surfaces`] and [`truth::of_points`].
    pub fn pictures(
        &self,
        camera: &Camera,
        exec: &Exec,
        progress: &dyn Fn(&str, u64, u64),
    ) -> Result<Truths> {
        let still = self.picture((camera, &cameras::shifts()), exec, progress)?;
        let mut path = Vec::new();
        if self.unknown.is_none() {
            path.push(still.frame.color("")?.clone());
            for (i, camera) in cameras::path(camera).iter().enumerate().skip(1) {
                progress("rendering the truth along a path", i as u64, cameras::FRAMES.into());
                let truth = self.picture((camera, &[]), exec, &|_, _, _| ())?;
                path.push(truth.frame.color("")?.clone());
            }
        }
        Ok(Truths { still, path })
    }
}

/// The surfaces of a scene, or why there are none.
fn surfaces(
    file: &SceneFile,
    exec: &Exec,
    progress: &dyn Fn(&str, u64, u64),
) -> std::result::Result<Vec<Surface>, String> {
    if file.hierarchy.is_some() {
        return Err("the triangles of a hierarchy are in its nodes".into());
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
        return Ok(all);
    }
    let scene =
        drawn(&meshes, |_| Draw::Polygons, exec, progress).map_err(|error| error.to_string())?;
    if !scene.surfels.is_empty() {
        return Err("a part of the scene has only points".into());
    }
    all.push(Surface::Triangles(scene.primitives.triangles));
    Ok(all)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::scene_file::EnvironmentChoice;
    use crate::study::truth::How;

    /// What is taken for the truth of a shape, with what is changed of its scene.
    fn known(change: impl Fn(&mut SceneFile)) -> (Known, Truth) {
        let exec = Exec::sequential();
        let mut file = SceneFile::open("sphere").unwrap();
        file.camera.size = Some([24, 16]);
        if let Source::Shape { count, .. } = &mut file.models[0].source {
            *count = 100;
        }
        change(&mut file);
        let ready = file.ready(&exec, &|_, _, _| ()).unwrap();
        let known = Known::of(&file, &ready.loaded.scene, &exec, &|_, _, _| ()).unwrap();
        let truth = known.still(&ready.camera, &exec, &|_, _, _| ()).unwrap();
        (known, truth)
    }

    #[test]
    fn the_environment_is_behind_shapes_too() {
        let corner = |truth: &Truth| *truth.frame.color("").unwrap().at(0, 0);
        let (_, black) = known(|_| ());
        assert_eq!((corner(&black), black.how), ([0.0; 3], How::Exact));
        let (_, sky) = known(|file| file.environment = Some(EnvironmentChoice::Sky));
        assert!(corner(&sky).iter().all(|v| *v > 0.0));
    }

    #[test]
    fn what_has_no_surface_says_why() {
        let (known, truth) = known(|file| file.models[0].opacity = Some(0.5));
        assert_eq!(known.unknown(), Some("surfaces have no opacity"));
        assert_eq!(truth.how, How::Layers);
    }
}
