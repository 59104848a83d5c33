//! Check the laws of every hierarchy.

use super::*;
use crate::scene::Similarity;
use crate::source::hierarchy::approximate::pixel;
use crate::source::sampler::estimate;

/// All own triangles of the nodes of a geometry, as places.
fn triangles(hierarchy: &Hierarchy, geometry: usize) -> Vec<[[u32; 3]; 3]> {
    let mut all = Vec::new();
    for node in hierarchy.geometries()[geometry].nodes.clone() {
        let own = hierarchy.triangles(node).unwrap();
        let Node { low, high, triangles, .. } = hierarchy.nodes()[node as usize];
        assert_eq!(own.len(), triangles as usize);
        let position = &own.vertices().position;
        assert!(position.iter().all(|p| p.cmpge(low).all() && p.cmple(high).all()));
        all.extend(own.corners().iter().map(|c| c.map(|i| bits(position[i as usize]))));
    }
    all.sort_unstable();
    all
}

fn bits(p: Vec3) -> [u32; 3] {
    p.to_array().map(f32::to_bits)
}

#[test]
fn a_mesh_is_approximated_at_every_level() {
    let at = given();
    for traversal in [Traversal::BottomUp, Traversal::TopDown] {
        let settings = quick(traversal);
        let name = format!("{traversal:?}");
        let built = make(&at, "mesh.ply", &name, &settings).unwrap();
        let hierarchy = Hierarchy::open(&at.path().join(name)).unwrap();
        let mesh = sphere(80, true);
        let mut expected: Vec<_> =
            mesh.triangles.iter().map(|c| c.map(|i| bits(mesh.position[i as usize]))).collect();
        expected.sort_unstable();
        assert_eq!(triangles(&hierarchy, 0), expected, "each triangle is in one node");
        assert_eq!((hierarchy.upper(), hierarchy.objects().len()), (1, 1));
        assert_eq!(hierarchy.nodes()[0].surfels, 0, "one object alone is approximated once");
        let approximated = hierarchy.nodes().iter().filter(|node| node.surfels > 0).count();
        assert_eq!((built.nodes, built.found, built.unseen), (approximated as u32, 0, 0));
        assert!(approximated > 4, "{approximated}");
        for (number, node) in (0..).zip(hierarchy.nodes()).skip(1) {
            assert_eq!(node.surfels, settings.count(node.below), "{number}");
            let cloud = hierarchy.surfels(number, u32::MAX).unwrap();
            assert_eq!(cloud.position.len(), node.surfels as usize);
            let normal = cloud.normal.clone().unwrap_or_default();
            // Squares of the nodes below are as large as a pixel, and flat.
            let pixel = pixel(settings.side_of(node.surfels), node.low, node.high) as f32;
            for (i, p) in cloud.position.iter().enumerate() {
                assert!(
                    (p.length() - 1.0).abs() < pixel * pixel + 0.003,
                    "{traversal:?} {p} of {}",
                    node.surfels
                );
                assert!(normal[i].dot(*p).abs() > 0.9, "{} at {p}", normal[i]);
                let color = cloud.color.as_ref().unwrap()[i];
                assert!((color - p.abs()).length() < 1.5 * pixel + 0.01, "{color} at {p}");
            }
            assert_eq!(estimate(&cloud.position, &normal), node.estimate);
            let some = hierarchy.surfels(number, 9).unwrap();
            let first = node.surfels.min(9) as usize;
            assert_eq!(some.position, cloud.position[..first], "a prefix");
        }
    }
}

#[test]
fn objects_share_geometries_and_are_approximated_in_groups() {
    let at = given();
    let settings = quick(Traversal::BottomUp);
    make(&at, "scene.toml", "out", &settings).unwrap();
    let hierarchy = Hierarchy::open(&at.path().join("out")).unwrap();
    let [ball, pea] = hierarchy.geometries() else { panic!("two geometries") };
    assert_eq!((ball.kind.colored, pea.kind.colored, pea.nodes.len()), (true, false, 1));
    assert_eq!(hierarchy.nodes()[pea.nodes.start as usize].surfels, 0, "450 triangles");
    let root = &hierarchy.nodes()[0];
    assert_eq!((root.below, root.surfels), (2 * 12_800 + 3 * 450, 700));
    let mut numbers: Vec<u32> = hierarchy.objects().iter().map(|object| object.number).collect();
    numbers.sort_unstable();
    assert_eq!(numbers, [0, 1, 2, 3, 4]);
    for object in hierarchy.objects() {
        let node = &hierarchy.nodes()[object.node as usize];
        for place in sphere(15, false).position {
            let place = object.place.rotation * (place.as_dvec3() * object.place.scale)
                + object.place.translation;
            let (low, high) = (node.low.as_dvec3(), node.high.as_dvec3());
            let slack = 0.2 * object.place.scale; // This is no vertex of the other one.
            assert!((place + slack).cmpge(low).all() && (place - slack).cmple(high).all());
        }
    }
    // Every surfel of the root is on an object, in its colour.
    let cloud = hierarchy.surfels(0, u32::MAX).unwrap();
    let color = cloud.color.unwrap();
    let mut seen = [0; 5];
    for (p, color) in cloud.position.iter().zip(color) {
        let object = hierarchy.objects().iter().find(|object| {
            let Similarity { scale, translation, .. } = object.place;
            ((p.as_dvec3() - translation).length() / scale - 1.0).abs() < 0.15
        });
        let object = object.unwrap_or_else(|| panic!("{p} is on no object"));
        seen[object.number as usize] += 1;
        match object.number {
            0 => assert!((color - p.abs()).length() < 0.3, "{color} at {p}"),
            1 => assert_eq!(color, Vec3::Y),
            _ => assert!((color - hierarchy.fill()).length() < 0.01, "{color}"),
        }
    }
    assert!(seen.iter().all(|count| *count > 20), "{seen:?}");
}

#[test]
fn what_moves_is_in_no_node() {
    let at = given();
    let scene = "\
[sequence]
frames = 10
[[geometry]]
name = \"pea\"
file = \"small.ply\"
[[object]]
of = \"pea\"
[[object]]
of = \"pea\"
keys = [{ frame = 0 }, { frame = 9, translate = [5, 0, 0] }]
[[object]]
of = \"pea\"
transform = { translate = [0, 3, 0] }
";
    fs::write(at.path().join("moving.toml"), scene).unwrap();
    make(&at, "moving.toml", "out", &quick(Traversal::BottomUp)).unwrap();
    let hierarchy = Hierarchy::open(&at.path().join("out")).unwrap();
    let found: Vec<_> = hierarchy.objects().iter().map(|o| (o.number, o.node, o.moves)).collect();
    assert_eq!(found, [(0, 0, false), (2, 0, false), (1, NONE, true)]);
    let root = &hierarchy.nodes()[0];
    assert!(root.below == 900 && root.high.x < 2.0 && root.high.y > 3.0, "{root:?}");
}

#[test]
fn bad_meshes_are_told_and_sampled_where_they_can_be() {
    let at = given();
    let mut mesh = sphere(40, false);
    mesh.position.push(Vec3::NAN);
    let nan = mesh.position.len() as u32 - 1;
    mesh.position.push(Vec3::new(3.0, 0.0, 0.0));
    let [a, b, c] = mesh.triangles[0];
    mesh.triangles.extend([[a, b, nan], [a, a, b], [b, c, a], [a, b, nan + 1]]);
    ply::write(&at.path().join("bad.ply"), &mesh).unwrap();
    let built = make(&at, "bad.ply", "out", &quick(Traversal::BottomUp)).unwrap();
    let (name, triangles, flaws) = &built.geometries[0];
    assert_eq!((name.as_str(), *triangles), ("bad", 3203));
    assert_eq!((flaws.dropped, flaws.degenerate, flaws.duplicate), (1, 1, 1));
    assert!(flaws.edges_of_many >= 1, "{flaws:?}");
    let hierarchy = Hierarchy::open(&at.path().join("out")).unwrap();
    assert_eq!((hierarchy.nodes()[1].surfels, hierarchy.geometries()[0].flaws), (700, *flaws));
}

/// A mesh with enough triangles to be approximated, and none that a pixel sees.
#[test]
fn what_nobody_sees_is_no_failure() {
    let at = given();
    let position = vec![Vec3::ZERO, Vec3::X, Vec3::new(2.0, 0.0, 0.0)];
    let mesh = Cloud { position, triangles: vec![[0, 1, 2]; 1200], ..Cloud::default() };
    let mesh = Cloud { normal: Some(vec![Vec3::Z; 3]), ..mesh };
    ply::write(&at.path().join("line.ply"), &mesh).unwrap();
    let built = make(&at, "line.ply", "out", &quick(Traversal::BottomUp)).unwrap();
    assert_eq!((built.nodes, built.unseen), (1, 1));
    let hierarchy = Hierarchy::open(&at.path().join("out")).unwrap();
    assert_eq!(
        (hierarchy.nodes()[1].surfels, hierarchy.surfels(1, 9).unwrap()),
        (0, Cloud::default())
    );
    let (_, _, flaws) = built.geometries[0];
    assert_eq!((flaws.degenerate, flaws.duplicate), (1200, 1199));
}

#[test]
fn what_cannot_be_approximated_is_refused() {
    let at = given();
    let points = Cloud { triangles: Vec::new(), ..sphere(15, false) };
    ply::write(&at.path().join("points.ply"), &points).unwrap();
    let settings = quick(Traversal::BottomUp);
    let line = make(&at, "points.ply", "out", &settings).unwrap_err().to_string();
    assert!(line.contains("there are no triangles"), "{line}");
    for (text, what) in [
        ("[[model]]\nshape = \"torus\"\n", "no triangles to sample"),
        ("[[model]]\nfile = \"points.ply\"\nprefix = 5\n", "a prefix needs points"),
    ] {
        fs::write(at.path().join("bad.toml"), text).unwrap();
        let line = make(&at, "bad.toml", "none", &settings).unwrap_err().to_string();
        assert!(line.contains(what), "{what} in {line}");
        assert!(!at.path().join("none").exists(), "nothing is begun");
    }
    let none = Settings { most: 0, ..settings };
    assert!(make(&at, "mesh.ply", "none", &none).is_err());
}
