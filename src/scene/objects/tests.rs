use super::*;
use crate::frame::Exec;
use crate::scene::merge::merge;
use crate::scene::transform::rotation;
use crate::scene::{Cloud, Mipmap, Scene, Sphere};
use crate::source::{Shape, flatten};

fn place(degrees: f64, scale: f64, x: f64) -> Similarity {
    let translation = DVec3::new(x, 0.1, -x);
    Similarity { rotation: rotation(DVec3::new(1.0, 2.0, 0.5), degrees), scale, translation }
}

fn object(name: &str, geometry: usize, place: Similarity, color: Option<Vec3>) -> Object {
    Object { name: name.into(), geometry, motion: Motion::still(place), color }
}

fn geometry(name: &str, surfels: Surfels) -> Geometry {
    Geometry { name: name.into(), surfels, primitives: Primitives::default(), detail: None }
}

/// Ellipses with opacities.
fn ellipses() -> Surfels {
    let cloud = Shape::Torus.surfels(300, 1).unwrap().into_cloud();
    let n = cloud.position.len();
    let halves = |i: usize| [Vec3::new(0.1, 0.0, 0.01 * i as f32), Vec3::new(0.0, 0.2, 0.05)];
    let tangents = (0..n).map(halves).collect();
    let opacity = Some(vec![0.5; n]);
    let mipmap = Some(levels(n, 2));
    Surfels::new(Cloud { tangents: Some(tangents), opacity, mipmap, ..cloud }).unwrap().0
}

/// Prefiltered colours with `levels` levels for each surfel.
fn levels(surfels: usize, levels: usize) -> Mipmap {
    let colors = (0..surfels * levels).map(|i| Vec3::new(0.25, 0.0, i as f32 / 1e5));
    Mipmap::new(levels, colors.collect()).unwrap()
}

/// Two geometries and four objects. Only one geometry has opacities and half axes, and one has more
/// prefiltered colours.
fn objects() -> Objects {
    let sphere = Shape::Sphere.surfels(20_000, 3).unwrap();
    let mipmap = levels(sphere.len(), 3);
    let sphere = sphere.with_mipmap(Some(mipmap)).unwrap();
    let plain = Shape::Torus.surfels(60, 3).unwrap();
    let all = vec![
        object("still", 0, Similarity::IDENTITY, None),
        object("red", 1, place(33.0, 0.7, 2.0), Some(Vec3::X)),
        object("turned", 0, place(-71.0, 2.5, -3.0), None),
        object("plain", 2, place(-7.0, 1.5, 3.0), None),
        object("ellipses", 1, place(9.0, 1.5, 1.0), None),
    ];
    let geometries =
        vec![geometry("sphere", sphere), geometry("torus", ellipses()), geometry("plain", plain)];
    Objects::new(geometries, all, Vec3::Y).unwrap()
}

#[test]
fn objects_have_the_bits_of_models_in_their_places() {
    let objects = objects();
    let clouds = objects.objects().iter().zip(objects.places()).map(|(object, place)| {
        let mut cloud = objects.geometries()[object.geometry].surfels.clone().into_cloud();
        if let Some(color) = object.color {
            cloud.color = Some(vec![color; cloud.position.len()]);
            cloud.mipmap = None;
        }
        place.apply(&mut cloud);
        cloud
    });
    let (models, _) = Surfels::new(merge(clouds.collect(), Vec3::Y)).unwrap();
    let exec = Exec::new(3, 32).unwrap();
    let (placed, _) = objects.flattened(&exec).unwrap();
    assert_eq!(placed.position(), models.position());
    assert_eq!(placed.normal(), models.normal());
    assert_eq!(placed.radius(), models.radius());
    assert_eq!(placed.color(), models.color());
    assert_eq!(placed.opacity(), models.opacity());
    assert_eq!(placed.tangents(), models.tangents());
    assert_eq!(placed.mipmap(), models.mipmap());
    assert_eq!(placed.mipmap().unwrap().levels(), 3);

    // Some of them equal the ones among all.
    let ids = objects.ids();
    let every: Vec<_> = ids
        .order()
        .iter()
        .flat_map(|&object| (0..ids.count(object)).map(move |surfel| ids.id(object, surfel)))
        .collect();
    let chosen: Vec<_> = (0..every.len()).filter(|i| i % 7 == 3 || i % 1000 < 40).collect();
    let few = objects.some(&chosen.iter().map(|&i| every[i]).collect::<Vec<_>>(), &exec);
    let of = |all: &[Vec3]| chosen.iter().map(|&i| all[i]).collect::<Vec<_>>();
    assert_eq!(few.len(), chosen.len());
    assert_eq!(few.position(), of(placed.position()));
    assert_eq!(few.normal(), of(placed.normal()));
    assert_eq!(few.color().unwrap(), of(placed.color().unwrap()));
    assert_eq!(few.mipmap().unwrap(), &placed.mipmap().unwrap().some(&chosen));
    assert_eq!(few.median_radius(), placed.median_radius());
}

#[test]
fn the_median_radius_counts_every_surfel_once() {
    let radii = |radii: &[f32]| {
        let n = radii.len();
        let cloud = Cloud {
            position: vec![Vec3::ZERO; n],
            normal: Some(vec![Vec3::Z; n]),
            radius: Some(radii.to_vec()),
            ..Cloud::default()
        };
        geometry("g", Surfels::new(cloud).unwrap().0)
    };
    let scaled = |geometry, scale| object("o", geometry, place(0.0, scale, 0.0), None);
    let geometries = || vec![radii(&[1.0, 2.0, 3.0]), radii(&[9.0])];
    let median = |objects| Objects::new(geometries(), objects, Vec3::ONE).unwrap().median_radius();
    assert_eq!(median(vec![scaled(0, 1.0)]), 2.0);
    assert_eq!(median(vec![scaled(0, 1.0), scaled(1, 1.0), scaled(1, 1.0), scaled(1, 1.0)]), 2.0);
    assert_eq!(median(vec![scaled(0, 8.0), scaled(1, 1.0), scaled(1, 1.0), scaled(1, 1.0)]), 9.0);
    assert_eq!(median(vec![scaled(0, 0.5), scaled(0, 4.0)]), 1.0, "the lower of two");
}

#[test]
fn the_sphere_holds_every_object() {
    let objects = objects();
    let Sphere { center: middle, radius } = objects.bounding_sphere();
    let (placed, _) = objects.flattened(&Exec::sequential()).unwrap();
    let far = |p: &Vec3| (p.as_dvec3() - middle).length();
    assert!(placed.position().iter().all(|p| far(p) <= radius));
    let tight = placed.bounding_sphere().radius;
    assert!(radius < 1.5 * tight, "{radius} {tight}");
}

#[test]
fn what_is_no_scene_is_refused() {
    let sphere = || vec![geometry("sphere", Shape::Sphere.surfels(100, 0).unwrap())];
    let words = |objects| Objects::new(sphere(), objects, Vec3::ONE).unwrap_err().to_string();
    assert_eq!(words(vec![]), "the scene has no objects");
    assert_eq!(words(vec![object("oak", 1, Similarity::IDENTITY, None)]), "oak has no geometry");
    for bad in [place(0.0, 1e-35, 0.0), place(0.0, 1e35, 0.0), place(0.0, 1.0, 1e38)] {
        let what = words(vec![object("oak", 0, bad, None)]);
        assert!(what.starts_with("oak leaves the range of f32 in frame 0"), "{what}");
    }
    let keys = vec![(0, Similarity::IDENTITY), (4, place(0.0, 1.0, 1e38))];
    let motion = Motion::new(keys).unwrap();
    let moving = Object { motion, ..object("oak", 0, Similarity::IDENTITY, None) };
    let objects = Objects::new(sphere(), vec![moving], Vec3::ONE).unwrap();
    assert!(!objects.are_still() && objects.at(0).is_ok());
    assert!(objects.at(3).unwrap_err().to_string().contains("in frame 3"));
}

#[test]
fn a_scene_of_objects_becomes_one_of_surfels() {
    let exec = Exec::sequential();
    let scene = Scene { objects: Some(objects()), ..Scene::lit("three", Surfels::none()) };
    let flat = flatten(&scene, &exec).unwrap();
    assert_eq!(flat.surfels.len() as u64, objects().ids().total());
    assert_eq!(flat.sha256(), scene.sha256(), "the same scene");
    let other = Objects::new(
        vec![geometry("sphere", ellipses())],
        vec![object("a", 0, Similarity::IDENTITY, None)],
        Vec3::Y,
    );
    let mut hashes = vec![scene.sha256()];
    let mut moved = objects();
    moved.places[2].translation.x += 1e-9;
    for objects in [other.unwrap(), moved] {
        hashes.push(Scene { objects: Some(objects), ..scene.clone() }.sha256());
    }
    hashes.sort();
    hashes.dedup();
    assert_eq!(hashes.len(), 3, "all different");
    let plain = Scene::lit("plain", ellipses());
    assert_eq!(flatten(&plain, &exec).unwrap().surfels, plain.surfels);
}

#[test]
fn objects_without_primitives_have_no_empty_lists() {
    assert!(objects().primitives().unwrap().is_empty());
}
