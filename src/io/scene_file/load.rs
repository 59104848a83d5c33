//! Load a [`SceneFile`] into surfels and primitives.

use super::geometries::Moving;
use super::model::{Colored, ModelParts, Purpose, check_draw, prefiltered, read};
use super::{Draw, EnvironmentChoice, Model, SceneFile, Source, TREE, offset, stem};
use crate::error::Result;
use crate::frame::Exec;
use crate::io::blocks::Blocks;
use crate::io::hierarchy::Hierarchy;
use crate::io::{environment, surface};
use crate::progress::Progress;
use crate::scene::merge::{join, merge};
use crate::scene::{Cloud, Counts, Dropped, Environment, Light};
use crate::scene::{Primitives, Scene, Similarity, Surfels, Vertices};
use crate::source::derive::Derived;
use glam::{DVec3, Vec3};

/// A loaded scene, with a report about its models.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The scene.
    pub scene: Scene,
    /// Reports on its models, in order; for a scene of objects, on its geometries.
    pub models: Vec<ModelReport>,
    /// Points of all models that should have become surfels, and did not.
    pub dropped: Dropped,
    /// Triangles and edges of all models that should have become primitives, and did not.
    pub dropped_primitives: u64,
    /// How the Gaussians of the scene were read, if it has Gaussians.
    pub gaussians: Option<GaussianReport>,
    /// What is to be doubted about the files, each once: one line with the file and the remedy.
    pub warnings: Vec<String>,
    /// The hierarchy from which views read what they need.
    pub(super) unread: Option<Hierarchy>,
    /// The folder of blocks from which parts of a picture read what they need.
    pub(super) blocks: Option<Blocks>,
    /// The geometries that have a file for each frame.
    pub(super) moving: Moving,
}

/// A report on a loaded model of 3D Gaussians.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GaussianReport {
    /// How the file stores its numbers, in words.
    pub convention: String,
    /// How many Gaussians of the file cannot be drawn; see [`crate::scene::Gaussians::new`].
    pub dropped: u64,
}

/// A report on a loaded model.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelReport {
    /// The name of the file without its extension, of the shape, or of the geometry.
    pub name: String,
    /// How many surfels it has.
    pub surfels: usize,
    /// How many primitives it has.
    pub primitives: Counts,
    /// What had to be derived because its file lacks it; `None` for shapes.
    pub derived: Option<Derived>,
    /// The numbers that colour it, if numbers do.
    pub colored: Option<Colored>,
}

impl SceneFile {
    /// Reads the model files and the environment, and derives missing attributes. The models are
    /// joined in order, or become objects in frame 0.
    ///
    /// A scene of objects has no surfels yet. [`SceneFile::ready`] makes the surfels of a frame for
    /// methods that draw surfels, and [`flatten`](crate::source::flatten()) makes them for any
    /// caller.
    ///
    /// `progress` as in [`crate::source::derive::surfels`].
    ///
    /// # Errors
    /// The errors of these functions, with the file named:
    ///
    /// - [`environment::read`], [`surface::read`], [`read_model`](super::read_model), [`crate::io::texture::paint`];
    /// - [`crate::source::Shape::surfels`], [`crate::source::plant::apple_tree`];
    /// - [`crate::source::derive::surfels`], and its counterparts for polygons and lines;
    /// - [tables](super::places), [`crate::scene::Objects::new`] and [`crate::index::mipmap::build`].
    ///
    /// [`crate::Error::Invalid`] in these cases:
    ///
    /// - Neither a surfel nor a primitive is left, or there are too many.
    /// - A model cannot be drawn as chosen.
    /// - A model that is not drawn as points has an opacity or mipmaps.
    /// - A model in one colour has a texture or mipmaps, or a model drawn as lines has a texture.
    /// - A model of 3D Gaussians is not alone, or has a choice that applies to surfels.
    pub fn load(&self, exec: &Exec, progress: Progress<'_>) -> Result<Loaded> {
        self.load_for(Purpose::Scene, exec, progress)
    }

    /// [`SceneFile::load`] to find out what the scene contains. It reads the index and the bounds
    /// of a hierarchy, and no file of a node; and of a folder of [blocks](crate::io::blocks) only the
    /// index, where [`SceneFile::ready_in_parts`] would. Everything equals the result of
    /// [`SceneFile::load`], except surfels and primitives that were not read.
    ///
    /// # Errors
    /// As [`SceneFile::load`], and as [`Hierarchy::outlined`].
    pub fn load_outlined(&self, exec: &Exec, progress: Progress<'_>) -> Result<Loaded> {
        self.load_for(Purpose::Parts, exec, progress)
    }

    /// [`SceneFile::load`] to draw views: of a hierarchy it reads the index and the bounds, and no file of
    /// a node. A folder of [blocks](crate::io::blocks) is read as a whole.
    ///
    /// # Errors
    /// As [`SceneFile::load`], and as [`Hierarchy::outlined`].
    pub fn load_for_views(&self, exec: &Exec, progress: Progress<'_>) -> Result<Loaded> {
        self.load_for(Purpose::View, exec, progress)
    }

    /// [`SceneFile::load`] to choose [candidates](mod@crate::source::candidates). Every model is
    /// drawn as polygons, in its place and colour. Vertices keep their opacities and these [further
    /// properties](crate::io::ply::properties). An opacity of the model replaces the opacities of
    /// its file. If all opacities are 1, there are none.
    ///
    /// # Errors
    /// As [`SceneFile::load`] for models drawn as polygons. [`crate::Error::Usage`] if there are
    /// properties, but a model is no PLY. [`crate::Error::Format`] as
    /// [`crate::io::ply::properties`], for a PLY that lacks one.
    pub fn load_polygons(
        &self,
        properties: &[String],
        exec: &Exec,
        progress: Progress<'_>,
    ) -> Result<Loaded> {
        let mut file = self.clone();
        for model in file.all_models_mut() {
            (model.draw, model.mipmaps) = (Draw::Polygons, None);
        }
        file.load_for(Purpose::Candidates(properties), exec, progress)
    }

    /// [`SceneFile::load`] for a purpose.
    pub(super) fn load_for(
        &self,
        purpose: Purpose<'_>,
        exec: &Exec,
        progress: Progress<'_>,
    ) -> Result<Loaded> {
        let gaussians = self.gaussians(purpose)?;
        self.all_models().try_for_each(|model| check_draw(model, purpose))?;
        let hierarchy = self.hierarchy.as_deref().map(Hierarchy::open).transpose()?;
        // Check the objects before large files are read.
        let placed = self.has_objects() && hierarchy.is_none();
        let objects = if placed { Some(self.objects()?) } else { None };
        let environment = match &self.environment {
            None => None,
            Some(EnvironmentChoice::Sky) => Some(Environment::Sky),
            Some(EnvironmentChoice::File(path)) => Some(environment::read(path, exec)?),
        };
        let surface = self.surface.as_deref().map(|path| surface::read(path, exec)).transpose()?;
        let scene = Scene {
            lights: self.lights.clone(),
            material: self.material,
            environment,
            surface,
            ..Scene::unlit(&self.name, Surfels::none())
        };
        let mut loaded = Loaded::nothing_of(scene);
        if let Some((model, path)) = gaussians {
            loaded.read_gaussians(model, path)?;
            return Ok(loaded);
        }
        if purpose == Purpose::Parts
            && let Some(blocks) = self.blocks()?
        {
            loaded.read_index(blocks, self.models[0].source.name(), exec)?;
            return Ok(loaded);
        }
        match (hierarchy, objects) {
            (Some(hierarchy), _) => {
                let view = matches!(purpose, Purpose::View | Purpose::Parts);
                of_hierarchy(hierarchy, view, &mut loaded, exec, progress)?;
            }
            (None, None) => self.load_models(&mut loaded, purpose, exec, progress)?,
            (None, Some(objects)) => {
                self.load_objects(objects, &mut loaded, purpose, exec, progress)?;
            }
        }
        self.refined(loaded)
    }

    /// Sets the levels of detail that this scene file asks for.
    pub(super) fn refined(&self, mut loaded: Loaded) -> Result<Loaded> {
        if let Some(objects) = loaded.scene.objects.take() {
            loaded.scene.objects = Some(objects.with_refinement(self.refinement.clone())?);
        }
        Ok(loaded)
    }

    /// Loads the models and joins them into one.
    fn load_models(
        &self,
        loaded: &mut Loaded,
        purpose: Purpose<'_>,
        exec: &Exec,
        progress: Progress<'_>,
    ) -> Result<()> {
        // Candidates of several models are joined later, where an offset of each would be lost.
        let keep_place = matches!(purpose, Purpose::Candidates(_));
        let read = |model| read(model, purpose, keep_place, exec, progress);
        let all = self.models.iter().map(read).collect::<Result<Vec<_>>>()?;
        let offset = offset::shared(self.models.iter().zip(&all));
        loaded.move_to(offset);
        let (mut parts, mut primitives) = (Vec::new(), Vec::new());
        for (model, part) in self.models.iter().zip(all) {
            let model = offset::moved(model, part.offset, offset);
            let (surfels, more) =
                loaded.place(&model, part, model.source.name(), purpose, exec, progress)?;
            if !surfels.is_empty() {
                parts.push((model, surfels));
            }
            primitives.push(more);
        }
        let fill = self.material.color;
        let primitives = join(primitives, fill)?;
        let (surfels, lost) = join_surfels(parts, primitives.is_empty(), fill, exec)?;
        loaded.dropped += lost;
        (loaded.scene.surfels, loaded.scene.primitives) = (surfels, primitives);
        Ok(())
    }
}

/// The surfels of all models in their places. If they are `alone`, without primitives, there must be
/// at least one. `fill` is the colour of those without one.
pub(super) fn join_surfels(
    mut parts: Vec<(Model, Surfels)>,
    alone: bool,
    fill: Vec3,
    exec: &Exec,
) -> Result<(Surfels, Dropped)> {
    if parts.len() == 1 && is_as_read(&parts[0].0) {
        // One untransformed model is the usual case; its surfels are already checked.
        return Ok((parts.remove(0).1, Dropped::default()));
    }
    let clouds = parts.into_iter().map(|(model, surfels)| placed(&model, surfels));
    let all = merge(clouds.collect(), fill);
    if alone { Surfels::new_with(all, exec) } else { Surfels::new_or_none(all, exec) }
}

/// Makes objects from the nodes of a hierarchy; for a view, without reading the nodes.
fn of_hierarchy(
    hierarchy: Hierarchy,
    view: bool,
    loaded: &mut Loaded,
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<()> {
    let objects = match view {
        true => hierarchy.outlined(exec, progress)?,
        false => hierarchy.load(exec, progress)?,
    };
    let counts = hierarchy.shown_nodes();
    loaded.models.extend(objects.geometries().iter().zip(counts).map(|(geometry, node)| {
        let triangles = node.triangles as usize;
        ModelReport {
            name: geometry.name.clone(),
            surfels: node.surfels as usize,
            primitives: Counts { triangles, ..Counts::default() },
            derived: None,
            colored: None,
        }
    }));
    loaded.scene.objects = Some(objects);
    loaded.unread = view.then_some(hierarchy);
    Ok(())
}

impl Loaded {
    /// A scene of which nothing has been read.
    pub(super) fn nothing_of(scene: Scene) -> Self {
        Self {
            scene,
            models: Vec::new(),
            dropped: Dropped::default(),
            dropped_primitives: 0,
            gaussians: None,
            warnings: Vec::new(),
            unread: None,
            blocks: None,
            moving: Moving::default(),
        }
    }

    /// Takes what is to be doubted about files, each once.
    pub(super) fn doubt(&mut self, warnings: Vec<String>) {
        let is_new = |what: &String| !self.warnings.contains(what);
        let new: Vec<String> = warnings.into_iter().filter(is_new).collect();
        self.warnings.extend(new);
    }

    /// Moves what is in world coordinates by the offset of the files.
    pub(super) fn move_to(&mut self, offset: DVec3) {
        self.scene.offset = offset;
        for light in &mut self.scene.lights {
            if let Light::Point { position, .. } = light {
                *position = (position.as_dvec3() - offset).as_vec3();
            }
        }
    }

    /// Takes a model: its surfels in the coordinates of its file, its primitives in their places.
    pub(super) fn place(
        &mut self,
        model: &Model,
        part: ModelParts,
        name: String,
        purpose: Purpose<'_>,
        exec: &Exec,
        progress: Progress<'_>,
    ) -> Result<(Surfels, Primitives)> {
        let ModelParts { surfels, primitives, derived, painted, warnings, colored, .. } = part;
        self.doubt(warnings);
        let surfels = if painted { surfels } else { prefiltered(surfels, model, exec, progress)? };
        let counts = primitives.counts();
        let count = surfels.len();
        self.models.push(ModelReport {
            name,
            surfels: count,
            primitives: counts,
            derived,
            colored,
        });
        // This drops primitives that a transform moved out of the range of f32; surfels are dropped
        // later.
        let (primitives, lost) = primitives.map(|vertices| {
            if let Some(color) = model.color {
                vertices.color = Some(vec![color; vertices.position.len()]);
            }
            if let Purpose::Candidates(_) = purpose {
                veil(vertices, model.opacity);
            }
            model.transform.apply_to_vertices(vertices);
        })?;
        self.dropped_primitives += lost;
        if let Some(derived) = derived {
            self.dropped += derived.dropped;
            self.dropped_primitives += derived.dropped_primitives;
        }
        Ok((surfels, primitives))
    }
}

/// Gives vertices one common opacity if there is one, and removes opacities that are all 1.
fn veil(vertices: &mut Vertices, opacity: Option<f32>) {
    if let Some(opacity) = opacity {
        vertices.opacity = Some(vec![opacity; vertices.position.len()]);
    }
    vertices.opacity = vertices.opacity.take().filter(|all| all.iter().any(|&one| one != 1.0));
}

/// Whether the surfels of a model are unchanged from their source.
pub(super) fn is_as_read(model: &Model) -> bool {
    let Model { color, opacity, transform, .. } = model;
    color.is_none() && opacity.is_none() && *transform == Similarity::IDENTITY
}

/// The surfels of a model, in its place and colour.
fn placed(model: &Model, surfels: Surfels) -> Cloud {
    let mut cloud = surfels.into_cloud();
    if let Some(color) = model.color {
        cloud.color = Some(vec![color; cloud.position.len()]);
        cloud.mipmap = None;
    }
    if let Some(opacity) = model.opacity {
        cloud.opacity = Some(vec![opacity; cloud.position.len()]);
    }
    model.transform.apply(&mut cloud);
    cloud
}

impl Source {
    /// The name of the file without its extension, or of the shape.
    #[must_use]
    pub fn name(&self) -> String {
        match self {
            Self::File { path, .. } => stem(path),
            Self::Shape { shape, .. } => shape.name().to_owned(),
            Self::Tree { .. } => TREE.to_owned(),
        }
    }
}
