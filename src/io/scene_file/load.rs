//! From a [`SceneFile`] to surfels.

use super::{EnvironmentChoice, Model, SceneFile, Source, stem};
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::io::{environment, ply};
use crate::scene::derive::{self, Derive, Derived};
use crate::scene::merge::merge;
use crate::scene::{Cloud, Dropped, Environment, Primitives, Scene, Surfels};

/// A scene and how it came about.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The scene.
    pub scene: Scene,
    /// Its models, in order.
    pub models: Vec<ModelReport>,
    /// Points of all models that became no surfel.
    pub dropped: Dropped,
}

/// What became of a model.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModelReport {
    /// The name of the file without its extension, or of the shape.
    pub name: String,
    /// How many surfels it gave.
    pub surfels: usize,
    /// What its file did not give; none for shapes.
    pub derived: Option<Derived>,
}

impl SceneFile {
    /// Reads the model files, derives what they do not give, and joins the models in order; reads
    /// the environment.
    ///
    /// `progress` as in [`derive::surfels`].
    ///
    /// # Errors
    /// Those of [`environment::read`], [`ply::read`], [`derive::surfels`] and [`crate::scene::Shape::surfels`], the file
    /// named; [`Error::Invalid`] if no surfel is left or there are too many.
    pub fn load(&self, exec: &Exec, progress: &dyn Fn(&str, u64, u64)) -> Result<Loaded> {
        let environment = match &self.environment {
            None => None,
            Some(EnvironmentChoice::Sky) => Some(Environment::Sky),
            Some(EnvironmentChoice::File(path)) => Some(environment::read(path)?),
        };
        let mut models = Vec::new();
        let mut clouds = Vec::new();
        for model in &self.models {
            let (cloud, report) = load(model, exec, progress)?;
            models.push(report);
            clouds.push(cloud);
        }
        // What a transform took out of the range of f32 is dropped here.
        let (surfels, mut dropped) = Surfels::new(merge(clouds, self.material.color))?;
        for one in models.iter().filter_map(|model| Some(model.derived?.dropped)) {
            dropped.position += one.position;
            dropped.normal += one.normal;
            dropped.radius += one.radius;
            dropped.attribute += one.attribute;
        }
        let (name, lights) = (self.name.clone(), self.lights.clone());
        let primitives = Primitives::default();
        let scene =
            Scene { name, surfels, primitives, lights, material: self.material, environment };
        Ok(Loaded { scene, models, dropped })
    }
}

/// One model as a complete cloud in its place.
fn load(
    model: &Model,
    exec: &Exec,
    progress: &dyn Fn(&str, u64, u64),
) -> Result<(Cloud, ModelReport)> {
    let (surfels, name, derived) = match &model.source {
        Source::File { path, radius } => {
            let cloud = ply::read(path)?;
            let derived = derive::surfels(cloud, &Derive { radius: *radius }, exec, progress);
            let (surfels, derived) = derived.map_err(|error| match error {
                Error::Invalid(what) => Error::format(path, what),
                other => other,
            })?;
            (surfels, stem(path), Some(derived))
        }
        Source::Shape { shape, count, seed } => {
            (shape.surfels(*count, *seed)?, shape.name().to_owned(), None)
        }
    };
    let report = ModelReport { name, surfels: surfels.len(), derived };
    let mut cloud = surfels.into_cloud();
    if let Some(color) = model.color {
        cloud.color = Some(vec![color; cloud.position.len()]);
    }
    if let Some(opacity) = model.opacity {
        cloud.opacity = Some(vec![opacity; cloud.position.len()]);
    }
    model.transform.apply(&mut cloud);
    Ok((cloud, report))
}
