//! From a [`SceneFile`] to surfels and primitives.

use super::{Draw, EnvironmentChoice, Model, SceneFile, Source, TREE, read_model, stem};
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::index::mipmap;
use crate::io::hierarchy::Hierarchy;
use crate::io::{environment, texture};
use crate::scene::{Cloud, Counts, Dropped, Environment, Geometry, Object, Objects};
use crate::scene::{Primitives, Scene, Similarity, Surfels};
use crate::source::derive::{self, Derive, Derived};
use crate::source::merge::{join, merge};
use crate::source::plant;
use crate::source::sampler::estimate;

/// A scene and how it came about.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The scene.
    pub scene: Scene,
    /// Its models, in order; of a scene of objects its geometries.
    pub models: Vec<ModelReport>,
    /// Points of all models that became no surfel, where they should have.
    pub dropped: Dropped,
    /// Triangles and edges of all models that became no primitive, where they should have.
    pub dropped_primitives: u64,
    /// What views read of the geometries of objects, if they read what they need.
    pub(super) unread: Option<Hierarchy>,
}

/// What became of a model.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModelReport {
    /// The name of the file without its extension, of the shape, or of the geometry.
    pub name: String,
    /// How many surfels it gave.
    pub surfels: usize,
    /// How many primitives it gave.
    pub primitives: Counts,
    /// What its file did not give; none for shapes.
    pub derived: Option<Derived>,
}

impl SceneFile {
    /// Reads the model files, derives what they do not give, and joins the models in order, or makes
    /// objects of them, in frame 0; reads the environment.
    ///
    /// A scene of objects has no surfels yet: [`SceneFile::ready`] gives those of a frame to methods
    /// that draw surfels, and [`flatten`](crate::source::flatten()) to anybody.
    ///
    /// `progress` as in [`derive::surfels`].
    ///
    /// # Errors
    /// Those of [`environment::read`], [`read_model`], [`texture::paint`], [`crate::source::Shape::surfels`],
    /// [`plant::apple_tree`], and of [`derive::surfels`] and its like for polygons and lines, the
    /// file named; of [tables](super::places) and [`Objects::new`]; [`Error::Invalid`] if neither a
    /// surfel nor a primitive is left or there are too many, if a model cannot be drawn as it says, or
    /// if one that is not drawn as points was given an opacity, or mipmaps, or one in one colour or drawn as lines a texture; as [`mipmap::build`], and if
    /// mipmaps are asked for of a model in one colour.
    pub fn load(&self, exec: &Exec, progress: &dyn Fn(&str, u64, u64)) -> Result<Loaded> {
        self.load_for(false, exec, progress)
    }

    /// [`SceneFile::load`]; of a hierarchy nothing but outlines if it is for a `view`, which reads what it needs.
    pub(super) fn load_for(
        &self,
        view: bool,
        exec: &Exec,
        progress: &dyn Fn(&str, u64, u64),
    ) -> Result<Loaded> {
        self.all_models().try_for_each(check_draw)?;
        let hierarchy = self.hierarchy.as_deref().map(Hierarchy::open).transpose()?;
        // What is wrong with objects is said before large files are read.
        let placed = self.has_objects() && hierarchy.is_none();
        let objects = if placed { Some(self.objects()?) } else { None };
        let environment = match &self.environment {
            None => None,
            Some(EnvironmentChoice::Sky) => Some(Environment::Sky),
            Some(EnvironmentChoice::File(path)) => Some(environment::read(path, exec)?),
        };
        let scene = Scene {
            lights: self.lights.clone(),
            material: self.material,
            environment,
            ..Scene::unlit(&self.name, Surfels::none())
        };
        let (models, dropped) = (Vec::new(), Dropped::default());
        let mut loaded = Loaded { scene, models, dropped, dropped_primitives: 0, unread: None };
        match (hierarchy, objects) {
            (Some(hierarchy), _) => of_hierarchy(hierarchy, view, &mut loaded, exec, progress)?,
            (None, None) => self.load_models(&mut loaded, exec, progress)?,
            (None, Some(objects)) => self.load_objects(objects, &mut loaded, exec, progress)?,
        }
        self.refined(loaded)
    }

    /// The same, asked for the levels of detail that this scene file says.
    pub(super) fn refined(&self, mut loaded: Loaded) -> Result<Loaded> {
        if let Some(objects) = loaded.scene.objects.take() {
            loaded.scene.objects = Some(objects.with_refinement(self.refinement.clone())?);
        }
        Ok(loaded)
    }

    /// The models as one.
    fn load_models(
        &self,
        loaded: &mut Loaded,
        exec: &Exec,
        progress: &dyn Fn(&str, u64, u64),
    ) -> Result<()> {
        let (mut parts, mut primitives) = (Vec::new(), Vec::new());
        for model in &self.models {
            let (surfels, more) = loaded.read(model, model.source.name(), exec, progress)?;
            if !surfels.is_empty() {
                parts.push((model, surfels));
            }
            primitives.push(more);
        }
        let primitives = join(primitives, self.material.color)?;
        let (surfels, lost) = self.join_surfels(parts, primitives.is_empty(), exec)?;
        loaded.dropped += lost;
        (loaded.scene.surfels, loaded.scene.primitives) = (surfels, primitives);
        Ok(())
    }

    /// The models and the geometries as geometries of objects.
    fn load_objects(
        &self,
        objects: Vec<Object>,
        loaded: &mut Loaded,
        exec: &Exec,
        progress: &dyn Fn(&str, u64, u64),
    ) -> Result<()> {
        let own = self.models.iter().map(|model| (model.source.name(), model, None));
        let named = self.geometries.iter();
        let named = named.map(|one| (one.name.clone(), &one.model, one.detail));
        let mut geometries = Vec::new();
        for (name, model, detail) in own.chain(named) {
            let (surfels, primitives) = loaded.read(model, name.clone(), exec, progress)?;
            let parts = if surfels.is_empty() { vec![] } else { vec![(model, surfels)] };
            let (surfels, lost) = self.join_surfels(parts, primitives.is_empty(), exec)?;
            loaded.dropped += lost;
            let geometry = Geometry { name, surfels, primitives, detail: None };
            geometries.push(match detail {
                Some(threshold) => geometry.with_detail(threshold, exec)?,
                None if model.progressive => in_order(geometry)?,
                None => geometry,
            });
        }
        let objects = Objects::new(geometries, objects, self.material.color)?;
        loaded.scene.objects = Some(objects);
        Ok(())
    }

    /// The surfels of all models, in their places; there must be some if they are `alone`.
    fn join_surfels(
        &self,
        mut parts: Vec<(&Model, Surfels)>,
        alone: bool,
        exec: &Exec,
    ) -> Result<(Surfels, Dropped)> {
        if parts.len() == 1 && is_as_read(parts[0].0) {
            // The usual case, checked already.
            return Ok((parts.remove(0).1, Dropped::default()));
        }
        let clouds = parts.into_iter().map(|(model, surfels)| placed(model, surfels));
        let all = merge(clouds.collect(), self.material.color);
        if alone { Surfels::new_with(all, exec) } else { Surfels::new_or_none(all, exec) }
    }
}

/// The nodes of a hierarchy as objects; for a view not read yet.
fn of_hierarchy(
    hierarchy: Hierarchy,
    view: bool,
    loaded: &mut Loaded,
    exec: &Exec,
    progress: &dyn Fn(&str, u64, u64),
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
        }
    }));
    loaded.scene.objects = Some(objects);
    loaded.unread = view.then_some(hierarchy);
    Ok(())
}

impl Loaded {
    /// Reads a model: its surfels where its file has them, its primitives in their places.
    fn read(
        &mut self,
        model: &Model,
        name: String,
        exec: &Exec,
        progress: &dyn Fn(&str, u64, u64),
    ) -> Result<(Surfels, Primitives)> {
        let ModelParts { surfels, primitives, derived, painted } = read(model, exec, progress)?;
        let surfels = if painted { surfels } else { prefiltered(surfels, model, exec, progress)? };
        let counts = primitives.counts();
        self.models.push(ModelReport { name, surfels: surfels.len(), primitives: counts, derived });
        // What a transform took out of the range of f32 is dropped here, or of surfels later.
        let (primitives, lost) = primitives.map(|vertices| {
            if let Some(color) = model.color {
                vertices.color = Some(vec![color; vertices.position.len()]);
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

/// A geometry whose surfels are in an order.
fn in_order(geometry: Geometry) -> Result<Geometry> {
    let estimate = estimate(geometry.surfels.position(), geometry.surfels.normal());
    geometry.with_prefix(estimate)
}

/// A model where its file has it.
struct ModelParts {
    surfels: Surfels,
    primitives: Primitives,
    derived: Option<Derived>,
    /// Whether colours, of all levels that are asked for, are those of a texture.
    painted: bool,
}

impl ModelParts {
    fn new(surfels: Surfels, primitives: Primitives, derived: Derived) -> Self {
        Self { surfels, primitives, derived: Some(derived), painted: false }
    }
}

/// Whether a model has the colours of a texture, if there is one.
fn shows_texture(model: &Model) -> bool {
    model.color.is_none() && !matches!(model.draw, Draw::Ribbons | Draw::Tubes)
}

/// Whether a model can be drawn as it says, and may have its opacity and its texture.
fn check_draw(model: &Model) -> Result<()> {
    model.draw.check(&model.source).map_err(Error::Invalid)?;
    if model.progressive && !matches!(model.source, Source::File { .. }) {
        let name = model.source.name();
        let what = format!("{name}: what is progressive are points of a file, in an order");
        return Err(Error::Invalid(what));
    }
    if matches!(model.source, Source::File { texture: Some(_), .. }) && !shows_texture(model) {
        let what = match model.color {
            Some(_) => "a model in one colour".to_owned(),
            None => format!("what is drawn as {}", model.draw.word()),
        };
        let name = model.source.name();
        return Err(Error::Invalid(format!("{name}: {what} has no texture; remove one of them")));
    }
    let surfels = !matches!(model.draw, Draw::Polygons | Draw::Ribbons | Draw::Tubes | Draw::Lines);
    if model.mipmaps.is_some_and(|levels| levels > 0) && (!surfels || model.color.is_some()) {
        let name = model.source.name();
        let what = if surfels {
            "a model in one colour has the same at every level".to_owned()
        } else {
            format!("what is drawn as {} has no surfels", model.draw.word())
        };
        return Err(Error::Invalid(format!("{name}: {what}; remove the mipmaps")));
    }
    if model.opacity.is_some() && !matches!(model.draw, Draw::Surfels | Draw::Points | Draw::Facets)
    {
        let (name, word) = (model.source.name(), model.draw.word());
        let what = format!("{name}: what is drawn as {word} is opaque; remove the opacity");
        return Err(Error::Invalid(what));
    }
    Ok(())
}

fn read(model: &Model, exec: &Exec, progress: &dyn Fn(&str, u64, u64)) -> Result<ModelParts> {
    match &model.source {
        Source::File { path, radius, prefix, texture } => {
            let mut cloud = read_model(path, exec)?;
            if shows_texture(model) {
                let levels = model.mipmaps.unwrap_or(0);
                texture::paint(&mut cloud, path, texture.as_deref(), levels, exec)?;
            }
            let painted = cloud.paint.is_some();
            let options = Derive { radius: *radius };
            let parts = first(cloud, *prefix, model.progressive)
                .and_then(|cloud| of_file(cloud, &model.draw, &options, exec, progress));
            parts.map(|parts| ModelParts { painted, ..parts }).map_err(|error| match error {
                Error::Invalid(what) => Error::format(path, what),
                other => other,
            })
        }
        Source::Shape { shape, count, seed } => Ok(ModelParts {
            surfels: shape.surfels(*count, *seed)?,
            primitives: Primitives::default(),
            derived: None,
            painted: false,
        }),
        Source::Tree { leaves, seed } => {
            let tree = plant::apple_tree(*leaves, *seed)?;
            let primitives =
                if model.draw == Draw::Polygons { tree.polygons() } else { tree.lines() }?;
            let surfels = Surfels::none();
            Ok(ModelParts { surfels, primitives, derived: None, painted: false })
        }
    }
}

/// The first so many points of a file, or all, which are in an order if a prefix is drawn.
fn first(cloud: Cloud, prefix: Option<usize>, progressive: bool) -> Result<Cloud> {
    let Some(count) = prefix.or(progressive.then_some(usize::MAX)) else { return Ok(cloud) };
    if !(cloud.triangles.is_empty() && cloud.edges.is_empty()) {
        let what = "a prefix is of points, but the file has triangles or edges; \"splatref surfels\" puts what \
                    is seen of triangles in order";
        return Err(Error::Invalid(what.into()));
    }
    if count >= cloud.position.len() {
        return Ok(cloud);
    }
    Ok(cloud.some(&(0..count as u32).collect::<Vec<_>>()))
}

fn of_file(
    cloud: Cloud,
    draw: &Draw,
    options: &Derive,
    exec: &Exec,
    progress: &dyn Fn(&str, u64, u64),
) -> Result<ModelParts> {
    let none = Primitives::default();
    Ok(match draw {
        Draw::Surfels => {
            let (surfels, derived) = derive::facets_or_surfels(cloud, options, exec, progress)?;
            ModelParts::new(surfels, none, derived)
        }
        Draw::Points => {
            let (surfels, derived) = derive::surfels(cloud, options, exec, progress)?;
            ModelParts::new(surfels, none, derived)
        }
        Draw::Facets => {
            let (surfels, derived) = derive::facets(cloud, exec, progress)?;
            ModelParts::new(surfels, none, derived)
        }
        Draw::Polygons => {
            let (triangles, derived) = derive::polygons(cloud, exec, progress)?;
            ModelParts::new(Surfels::none(), Primitives { triangles, ..none }, derived)
        }
        Draw::Hybrid(half) => {
            let (surfels, triangles, derived) =
                derive::hybrid(cloud, half, options, exec, progress)?;
            ModelParts::new(surfels, Primitives { triangles, ..none }, derived)
        }
        Draw::Ribbons => {
            let (ribbons, derived) = derive::ribbons(cloud, options)?;
            ModelParts::new(Surfels::none(), Primitives { ribbons, ..none }, derived)
        }
        Draw::Tubes => {
            let (tubes, derived) = derive::tubes(cloud, options)?;
            ModelParts::new(Surfels::none(), Primitives { tubes, ..none }, derived)
        }
        // Refused before any file is read.
        Draw::Lines => return Err(Error::Invalid("only a tree is drawn as lines".into())),
    })
}

/// The surfels of a model with the mipmaps that it asks for.
fn prefiltered(
    surfels: Surfels,
    model: &Model,
    exec: &Exec,
    progress: &dyn Fn(&str, u64, u64),
) -> Result<Surfels> {
    let made = match model.mipmaps {
        None => return Ok(surfels),
        Some(0) => None,
        Some(_) if surfels.is_empty() => return Ok(surfels),
        Some(levels) => {
            let made = mipmap::build(&surfels, levels, exec, progress);
            Some(made.map_err(|error| match (error, &model.source) {
                (Error::Invalid(what), Source::File { path, .. }) => Error::format(path, what),
                (Error::Invalid(what), other) => {
                    Error::Invalid(format!("{}: {what}", other.name()))
                }
                (other, _) => other,
            })?)
        }
    };
    surfels.with_mipmap(made)
}

/// Whether the surfels of a model are what its source gives.
fn is_as_read(model: &Model) -> bool {
    let Model { color, opacity, transform, .. } = model;
    color.is_none() && opacity.is_none() && *transform == Similarity::IDENTITY
}

/// The surfels of a model in its place and colour.
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
