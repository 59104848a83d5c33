//! The truth of a scene.
//!
//! - Procedural shapes use their exact surfaces. Meshes and trees use their triangles, whatever a
//!   candidate draws: even if it draws the mesh as points, or a prefix of them.
//! - If no surface is known, as for points, all points are drawn by [`truth::of_points`], and the
//!   reason is kept.
//!
//! `Decided:` if a part of the scene has no surface, the truth of the whole scene comes from its
//! points, because a picture of two kinds of truth would be neither.

use super::cameras;
use crate::error::{Error, Result};
use crate::frame::{Exec, Plane};
use crate::io::scene_file::{Draw, GroupChoice, MethodChoice, SceneFile, Source};
use crate::method::Method;
use crate::progress::Progress;
use crate::scene::{Camera, Scene, Surfels};
use crate::setting::{Fields, Value};
use crate::study::truth::{self, Surface, Truth};

/// The content of the true picture.
#[derive(Clone, Debug)]
pub struct Known {
    /// The lights, and the surfels if there are no surfaces.
    scene: Scene,
    surfaces: Vec<Surface>,
    /// Whether back faces are culled.
    cull: bool,
    /// Why no surface is known.
    unknown: Option<String>,
}

/// The true pictures of a study.
#[derive(Clone, Debug)]
pub struct Truths {
    /// The picture itself, and its colours under the [shifts](cameras::shifted).
    pub still: Truth,
    /// The colours along the [path](cameras::path); the first are those of the picture itself.
    /// Empty if no surface is known.
    pub path: Vec<Plane<[f32; 3]>>,
}

impl Known {
    /// Collects the truth of a scene, with the lights and the environment of a loaded one: the
    /// scene itself, or a scene that was sampled from it.
    ///
    /// # Errors
    /// [`Error::Usage`] for a scene of Gaussians; as [`SceneFile::ready`] if not even points can be
    /// drawn.
    pub fn about(
        file: &SceneFile,
        lit: &Scene,
        exec: &Exec,
        progress: Progress<'_>,
    ) -> Result<Self> {
        if lit.gaussians.is_some() {
            let what = "a study compares pictures with the true surface, and 3D Gaussians have none; compare \
                        two pictures with `splatref compare`";
            return Err(Error::Usage(format!("{}: {what}", lit.name)));
        }
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

    /// How a true picture was computed, and why it is no better.
    #[must_use]
    pub fn in_words(&self, truth: &Truth) -> String {
        match &self.unknown {
            None => truth.how.to_string(),
            Some(why) => format!("{} ({why})", truth.how),
        }
    }

    /// The true picture from a camera, and its colours under shifts.
    ///
    /// # Errors
    /// As [`truth::of_surfaces`] and [`truth::of_points`].
    fn picture(
        &self,
        camera: &Camera,
        shifts: &[[u32; 2]],
        exec: &Exec,
        progress: Progress<'_>,
    ) -> Result<Truth> {
        if self.unknown.is_some() {
            return truth::of_points(&self.scene, camera, shifts, exec, progress);
        }
        let (surfaces, scene) = (&self.surfaces, &self.scene);
        truth::of_surfaces(surfaces, scene, self.cull, camera, shifts, exec, progress)
    }

    /// The true picture from a camera.
    ///
    /// # Errors
    /// As [`truth::of_surfaces`] and [`truth::of_points`].
    pub fn still(&self, camera: &Camera, exec: &Exec, progress: Progress<'_>) -> Result<Truth> {
        self.picture(camera, &[], exec, progress)
    }

    /// The true pictures of a study from a camera. Scenes of points have none along the path,
    /// because each would take as long as a study.
    ///
    /// # Errors
    /// As [`truth::of_surfaces`] and [`truth::of_points`].
    pub fn pictures(&self, camera: &Camera, exec: &Exec, progress: Progress<'_>) -> Result<Truths> {
        let still = self.picture(camera, &cameras::shifts(), exec, progress)?;
        let mut path = Vec::new();
        if self.unknown.is_none() {
            path.push(still.frame.color("")?.clone());
            for (i, camera) in cameras::path(camera).iter().enumerate().skip(1) {
                progress("rendering the truth along a path", i as u64, cameras::FRAMES.into());
                let truth = self.picture(camera, &[], exec, &|_, _, _| ())?;
                path.push(truth.frame.color("")?.clone());
            }
        }
        Ok(Truths { still, path })
    }
}

/// The surfaces of a scene, or the reason why there are none.
fn surfaces(
    file: &SceneFile,
    exec: &Exec,
    progress: Progress<'_>,
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

/// The whole scene with all its content, flat; `draw` maps the draw of each model.
fn drawn(
    file: &SceneFile,
    draw: impl Fn(Draw) -> Draw,
    exec: &Exec,
    progress: Progress<'_>,
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

    /// The truth of a shape, after a change to its scene.
    fn known(change: impl Fn(&mut SceneFile)) -> (Known, Truth) {
        let exec = Exec::sequential();
        let mut file = SceneFile::open("sphere").unwrap();
        file.camera.size = Some([24, 16]);
        if let Source::Shape { count, .. } = &mut file.models[0].source {
            *count = 100;
        }
        change(&mut file);
        let ready = file.ready(&exec, &|_, _, _| ()).unwrap();
        let known = Known::about(&file, &ready.loaded.scene, &exec, &|_, _, _| ()).unwrap();
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
        assert_eq!(known.unknown.as_deref(), Some("surfaces have no opacity"));
        assert_eq!(truth.how, How::Layers);
    }
}
