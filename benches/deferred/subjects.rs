//! The scenes of Table 1 and of its passes, as near to the paper's as what there is allows.

use super::common::models;
use super::common::report::Arguments;
use super::order::along_a_curve;
use glam::{DVec3, Vec3};
use splatref::Result;
use splatref::frame::Exec;
use splatref::io::ply;
use splatref::number::random::unit;
use splatref::scene::objects::{Geometry, Motion, Object, Objects};
use splatref::scene::transform::rotation;
use splatref::scene::{
    Camera, Cloud, Environment, Lens, Pose, Primitives, Scene, Similarity, Sphere,
};
use splatref::scene::{Surfels, Triangles, Vertices};
use splatref::source::derive::{self, Derive};
use splatref::source::plant::{LEAVES, apple_tree};
use splatref::splat::SplatSettings;
use std::path::PathBuf;
use std::time::{Duration, Instant};

const SIDE: u32 = 512;
/// Turn of the camera about +y between two frames, in degrees.
const STEP: f64 = 1.0;

/// A scene, its camera by the frame, and what the paper says of it: frames a second without selection,
/// percentage culled, frames a second with it.
pub(crate) struct Subject {
    pub(crate) name: &'static str,
    pub(crate) scene: Scene,
    pub(crate) splats: SplatSettings,
    pub(crate) paper: [&'static str; 3],
    view: View,
}

/// How a scene is looked at.
enum View {
    /// From all around a sphere: what is seen of it first, from this direction.
    Around(Sphere, DVec3),
    /// From one place, in all directions; this one first.
    From(DVec3, DVec3),
}

impl Subject {
    pub(crate) fn camera(&self, frame: u32) -> Result<Camera> {
        let (turn, lens) = (rotation(DVec3::Y, STEP * f64::from(frame)), Lens::FieldOfView(34.0));
        match self.view {
            View::Around(sphere, from) => Camera::framing(SIDE, SIDE, sphere, turn * from, lens),
            View::From(eye, towards) => {
                let pose = Pose { eye, target: eye + turn * towards, up: DVec3::Y };
                Camera::new(SIDE, SIDE, pose, lens)
            }
        }
    }

    /// The scene in a frame, as its camera sees it; and how long levels of detail took to choose.
    pub(crate) fn at(&self, frame: u32, exec: &Exec) -> Result<(Scene, Duration)> {
        let Some(objects) = &self.scene.objects else {
            return Ok((self.scene.clone(), Duration::ZERO));
        };
        let (objects, camera) = (objects.at(frame)?, self.camera(frame)?);
        let start = Instant::now();
        let objects = Some(objects.seen_from(&camera, exec)?);
        Ok((Scene { objects, ..self.scene.clone() }, start.elapsed()))
    }

    /// Whether the scene is the same in every frame.
    pub(crate) fn is_still(&self) -> bool {
        let is_still = |objects: &Objects| objects.are_still() && !objects.have_detail();
        self.scene.objects.as_ref().is_none_or(is_still)
    }

    /// All surfels: of geometries with levels of detail those that these were made of.
    pub(crate) fn count(&self) -> u64 {
        drawn(&self.scene)
    }
}

/// How many surfels of a scene are drawn.
pub(crate) fn drawn(scene: &Scene) -> u64 {
    scene.objects.as_ref().map_or(scene.surfels.len() as u64, Objects::drawn_total)
}

/// Something that makes a scene.
type Maker<'a> = Box<dyn Fn() -> Result<Subject> + 'a>;

/// The scenes whose names contain the pattern, each made when it is asked for.
pub(crate) fn subjects<'a>(
    arguments: &Arguments,
    exec: &'a Exec,
) -> Result<impl Iterator<Item = Result<Subject>> + use<'a>> {
    let mut made: Vec<Maker<'a>> = Vec::new();
    let wanted = |name: &str| name.contains(&arguments.pattern);
    let scan = |name: &str| -> Result<Option<PathBuf>> {
        let path = models::path(name);
        if path.exists() {
            return Ok(Some(path));
        }
        arguments.without(&path).map(|()| None)
    };
    for (name, sorted) in [(HEAD, true), (SHUFFLED, false)].into_iter().filter(|n| wanted(n.0)) {
        if let Some(path) = scan("igea")? {
            made.push(Box::new(move || head(name, &ply::read(&path)?, sorted, exec)));
        }
    }
    if wanted(TREE) {
        made.push(Box::new(tree));
    }
    if wanted(FOREST) {
        made.push(Box::new(move || forest(exec)));
    }
    if wanted(CROWD)
        && let Some(path) = scan("armadillo")?
    {
        made.push(Box::new(move || crowd(&ply::read(&path)?, exec)));
    }
    Ok(made.into_iter().map(|make| make()))
}

const HEAD: &str = "head, 285 k";
const SHUFFLED: &str = "head, random order";
const TREE: &str = "tree, 750 k";
pub(crate) const FOREST: &str = "forest, 6,800 trees of 750 k";
const CROWD: &str = "200 objects, 450 k in all";

/// Igea, a head, sampled evenly at random, with derived radii.
fn head(name: &'static str, mesh: &Cloud, sorted: bool, exec: &Exec) -> Result<Subject> {
    let derived = sampled(mesh, 285_000, exec)?;
    let surfels = if sorted { along_a_curve(derived)? } else { derived };
    let view = View::Around(surfels.bounding_sphere(), DVec3::Z);
    let paper = if sorted { ["34", "70", "39"] } else { [""; 3] };
    let (scene, splats) = (Scene::lit(name, surfels), SplatSettings::default());
    Ok(Subject { name, scene, splats, paper, view })
}

fn sampled(mesh: &Cloud, count: usize, exec: &Exec) -> Result<Surfels> {
    let points = models::resample(mesh, count, 1);
    Ok(derive::surfels(points, &Derive::default(), exec, &|_, _, _| ())?.0)
}

/// The points of a tree, seen from both sides.
fn tree() -> Result<Subject> {
    let surfels = along_a_curve(points_of_tree()?)?;
    Ok(Subject {
        name: TREE,
        view: View::Around(surfels.bounding_sphere(), DVec3::new(0.0, 0.25, 1.0)),
        scene: Scene::lit(TREE, surfels),
        splats: SplatSettings::BOTH_SIDES,
        paper: ["8.6", "88", "32"],
    })
}

/// The tree 6,800 times, once in memory, with levels of detail at two pixels: at random on a square of 250
/// times the radius of the largest, turned and scaled. The camera stands at the edge and looks about.
pub(crate) fn forest(exec: &Exec) -> Result<Subject> {
    let surfels = points_of_tree()?;
    let Sphere { center, radius } = surfels.bounding_sphere();
    let (primitives, side) = (Primitives::default(), 250.0);
    let geometry = Geometry { name: "tree".into(), surfels, primitives, detail: None };
    let geometry = geometry.with_detail(2.0, exec)?;
    let object = |i: u32| {
        let [x, z, size, turn] = [0, 1, 2, 3].map(|c| f64::from(unit(3, u64::from(4 * i + c))));
        let (scale, turn) = ((0.5 + 0.5 * size) / radius, rotation(DVec3::Y, 360.0 * turn));
        let stand = DVec3::new((x - 0.5) * side, 0.0, -z * side);
        let place =
            Similarity { rotation: turn, scale, translation: stand - turn * (center * scale) };
        Object { name: format!("tree {i}"), geometry: 0, motion: Motion::still(place), color: None }
    };
    let objects = Objects::new(vec![geometry], (0..6800).map(object).collect(), Vec3::splat(0.75))?;
    Ok(Subject {
        name: FOREST,
        view: View::From(DVec3::new(0.0, 6.0, 4.0), DVec3::new(0.0, -0.1, -1.0)),
        scene: Scene { objects: Some(objects), ..Scene::lit(FOREST, Surfels::none()) },
        splats: SplatSettings::BOTH_SIDES,
        paper: ["0.8-1.5", "90-98", "10-16"],
    })
}

/// The forest on a ground of two triangles, and its camera in the first frame \[GBP04, Fig. 7\].
pub(crate) fn landscape(forest: &Subject, exec: &Exec) -> Result<(Scene, Camera)> {
    let camera = forest.camera(0)?;
    let far = 400.0;
    let corner = |x: f32, z: f32| Vec3::new(x * far, -0.9, z * far);
    let vertices = Vertices {
        position: vec![corner(-1.0, 0.1), corner(1.0, 0.1), corner(1.0, -1.0), corner(-1.0, -1.0)],
        direction: vec![Vec3::Y; 4],
        radius: vec![0.0; 4],
        color: Some(vec![Vec3::new(0.1, 0.16, 0.05); 4]),
        ..Vertices::default()
    };
    let triangles = Triangles::new(vertices, vec![[0, 1, 2], [0, 2, 3]])?.0;
    let primitives = Primitives { triangles, ..Primitives::default() };
    let (name, surfels) = ("ground", Surfels::none());
    let ground = Geometry { name: name.into(), surfels, primitives, detail: None };
    let forest = &forest.scene;
    let (mut geometries, mut all) = match &forest.objects {
        Some(objects) => (objects.geometries().to_vec(), objects.objects().to_vec()),
        None => (Vec::new(), Vec::new()),
    };
    let motion = Motion::still(Similarity::IDENTITY);
    all.push(Object { name: name.into(), geometry: geometries.len(), motion, color: None });
    geometries.push(ground);
    let objects = Objects::new(geometries, all, Vec3::splat(0.75))?.seen_from(&camera, exec)?;
    let environment = Some(Environment::Sky);
    Ok((Scene { objects: Some(objects), environment, ..forest.clone() }, camera))
}

/// Points on the triangles of all leaves and branches of a tree, evenly at random, with the spacing as
/// radius.
fn points_of_tree() -> Result<Surfels> {
    let count = 750_000;
    let triangles = apple_tree(LEAVES, 0)?.polygons()?.triangles;
    let (vertices, triangles) = triangles.into_parts();
    let mesh = Cloud {
        position: vertices.position,
        normal: Some(vertices.direction),
        color: vertices.color,
        triangles,
        ..Cloud::default()
    };
    let corner = |i: u32| mesh.position[i as usize].as_dvec3();
    let double =
        |&[a, b, c]: &[u32; 3]| (corner(b) - corner(a)).cross(corner(c) - corner(a)).length();
    let area = mesh.triangles.iter().map(double).sum::<f64>() / 2.0;
    let mut cloud = models::resample(&mesh, count, 1);
    cloud.radius = Some(vec![(area / count as f64).sqrt() as f32; count]);
    Ok(Surfels::new(cloud)?.0)
}

/// Armadillos of 2,250 surfels in ten ranks of twenty, which walk and turn.
fn crowd(mesh: &Cloud, exec: &Exec) -> Result<Subject> {
    let surfels = along_a_curve(sampled(mesh, 2_250, exec)?)?;
    let Sphere { center, radius } = surfels.bounding_sphere();
    let primitives = Primitives::default();
    let geometry = Geometry { name: "armadillo".into(), surfels, primitives, detail: None };
    let place = |i: u32, degrees: f64, way: f64| {
        let turn = rotation(DVec3::Y, degrees + 60.0 * f64::from(unit(1, u64::from(i))) - 30.0);
        let (column, rank) = (f64::from(i % 20) - 9.5, f64::from(i / 20) - 4.5);
        let stand = DVec3::new(column, 0.0, -1.25 * rank + way);
        let scale = 1.0 / radius;
        Similarity { rotation: turn, scale, translation: stand - turn * (center * scale) }
    };
    // In 32 frames half a turn and two steps.
    let object = |i: u32| -> Result<Object> {
        let away = if i.is_multiple_of(2) { 90.0 } else { -90.0 };
        let keys = vec![(0, place(i, 180.0, 0.0)), (32, place(i, 180.0 + away, 1.0))];
        let color = [0, 1, 2].map(|c| 0.25 + 0.625 * unit(2, u64::from(3 * i + c)));
        let (name, motion) = (format!("armadillo {i}"), Motion::new(keys)?);
        Ok(Object { name, geometry: 0, motion, color: Some(Vec3::from(color)) })
    };
    let objects = (0..200).map(object).collect::<Result<Vec<_>>>()?;
    let objects = Objects::new(vec![geometry], objects, Vec3::splat(0.75))?;
    Ok(Subject {
        name: CROWD,
        view: View::Around(Sphere { center: DVec3::ZERO, radius: 9.0 }, DVec3::new(0.0, 0.2, 1.0)),
        scene: Scene { objects: Some(objects), ..Scene::lit(CROWD, Surfels::none()) },
        splats: SplatSettings::default(),
        paper: ["11.5", "90", "33.5"],
    })
}
