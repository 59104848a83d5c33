//! Compare pictures of a hierarchy with pictures of its scene.

use super::*;
use crate::frame::{Plane, Samples};
use crate::scene::Objects;
use glam::DVec3;

/// The depths of a picture by the method `blue`, and the objects that its view draws.
fn depth(mut file: SceneFile, eye: f64, surfel_size: f32) -> (Plane<f32>, Option<Objects>) {
    let exec = Exec::sequential();
    let quiet = |_: &str, _, _| ();
    file.method.name = Some("blue");
    file.refinement.surfel_size = surfel_size;
    file.camera.size = Some([480, 320]);
    file.camera.eye = Some(DVec3::new(4.0, 5.0, eye));
    file.camera.target = Some(DVec3::new(4.0, 5.0, 0.0));
    let ready = file.ready(&exec, &quiet).unwrap();
    let (mut session, _) = ready.session(&exec, &quiet).unwrap();
    let picture = session.render(&ready.camera).unwrap();
    let Some(Samples::Scalar(z)) = picture.frame.plane("Z") else { panic!("no depth") };
    (z.clone(), ready.loaded.scene.objects.clone())
}

/// The scene as its triangles, and its hierarchy.
fn both(at: &TempDir) -> (SceneFile, SceneFile) {
    let path = at.path().join("scene.toml");
    let text = fs::read_to_string(&path).unwrap();
    fs::write(&path, text.replace("file =", "draw = \"polygons\"\nfile =")).unwrap();
    make(at, "scene.toml", "out", &quick(Traversal::BottomUp)).unwrap();
    (SceneFile::open(&path).unwrap(), SceneFile::open(at.path().join("out")).unwrap())
}

/// If a view needs more surfels than there are, it draws the triangles of all nodes, each once.
#[test]
fn close_by_it_is_the_scene() {
    let at = given();
    let (scene, hierarchy) = both(&at);
    let (expected, _) = depth(scene, 40.0, 2.0);
    let (found, objects) = depth(hierarchy, 40.0, 1e-3);
    assert_eq!(objects.unwrap().drawn_total(), 0, "no surfels");
    assert!(expected.values().iter().any(|z| z.is_finite()));
    assert_eq!(
        found.values().iter().map(|z| z.to_bits()).collect::<Vec<_>>(),
        expected.values().iter().map(|z| z.to_bits()).collect::<Vec<_>>()
    );
}

/// A distant view draws the surfels of coarse nodes, and nothing below them.
#[test]
fn far_away_it_is_its_root() {
    let at = given();
    let (scene, hierarchy) = both(&at);
    let (expected, _) = depth(scene, 60.0, 2.0);
    let (found, objects) = depth(hierarchy, 60.0, 9.0);
    let objects = objects.unwrap();
    let drawn: Vec<&str> = (0..objects.objects().len() as u32)
        .filter(|&object| objects.disc(object).is_some() && objects.ids().count(object) > 0)
        .map(|object| objects.objects()[object as usize].name.as_str())
        .collect();
    assert_eq!(drawn, ["node-0"]);
    assert!((1..700).contains(&objects.drawn_total()), "{}", objects.drawn_total());
    let pairs = || found.values().iter().zip(expected.values());
    let inside = expected.values().iter().filter(|z| z.is_finite()).count();
    // At the outline a picture of discs recedes by a pixel here and there.
    let within = |i: &usize| [i - 480, i - 1, *i, i + 1, i + 480].map(|i| expected.values()[i]);
    let hole =
        |i: &usize| !found.values()[*i].is_finite() && within(i).iter().all(|z| z.is_finite());
    let holes = (480..480 * 319).filter(hole).count();
    assert!(inside > 100 && holes * 50 <= inside, "{holes} holes of {inside} pixels");
    // Discs are off by less than their radius of 0.7, except where they reach over an outline with
    // something behind it.
    let off = pairs().filter(|(a, b)| a.is_finite() && b.is_finite() && (*a - *b).abs() > 1.0);
    assert!(off.count() * 100 <= inside);
}

#[test]
fn finer_objects_are_those_below() {
    let at = given();
    let (_, hierarchy) = both(&at);
    let loaded = hierarchy.load(&Exec::sequential(), &|_, _, _| ()).unwrap();
    let objects = loaded.scene.objects.unwrap();
    let index = Hierarchy::open(&at.path().join("out")).unwrap();
    let triangles = |object| objects.geometry(object).primitives.counts().triangles as u64;
    let count = objects.objects().len() as u32;
    assert_eq!((0..count).map(triangles).sum::<u64>(), index.nodes()[0].below);
    for object in 0..count {
        let mut below = triangles(object);
        for other in 0..count {
            let mut above = objects.coarser(other);
            while let Some(of) = above.filter(|of| *of != object) {
                above = objects.coarser(of);
            }
            below += if above == Some(object) { triangles(other) } else { 0 };
        }
        let name = &objects.objects()[object as usize].name;
        let node: usize = name.rsplit("node-").next().unwrap().parse().unwrap();
        assert_eq!(below, index.nodes()[node].below, "{name}");
    }
}
