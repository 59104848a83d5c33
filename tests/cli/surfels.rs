//! `splatref surfels`: points in order, with all that a file has of them.

use super::*;
use glam::{Vec2, Vec3};
use splatref::frame::{Frame, Plane, Samples};
use splatref::io::{exr, ply};
use splatref::scene::{Cloud, Coordinates, Groups, Mipmap, Property};
use splatref::source::sampler::{Greedy, Start};
use tempfile::TempDir;

/// Points of which each property tells which one it is of.
fn points(n: usize) -> Cloud {
    let number = |i: usize| i as f32;
    let vector = |i: usize| Vec3::new(number(i), 1.0, 2.0);
    let place = |i: usize| Vec3::new(number(i * i % 17), number(i * 5 % 23), number(i));
    let own = (0..n).map(|i| (i % 3) as u8).collect();
    Cloud {
        position: (0..n).map(place).collect(),
        normal: Some((0..n).map(vector).collect()),
        radius: Some((0..n).map(number).collect()),
        color: Some((0..n).map(|i| vector(i) / 64.0).collect()),
        opacity: Some((0..n).map(number).collect()),
        tangents: Some((0..n).map(|i| [vector(i), vector(i + 1)]).collect()),
        mipmap: Some(Mipmap::new(2, (0..2 * n).map(vector).collect()).unwrap()),
        tangent: Some((0..n).map(vector).collect()),
        groups: Some(Groups::new(own, vec![(4, 2), (5, 0), (5, 1)], vec![1.0, 2.0, 1.0]).unwrap()),
        ..Cloud::default()
    }
}

#[test]
fn points_are_written_in_the_order_with_all_properties() {
    let at = TempDir::new().unwrap();
    let given = points(60);
    ply::write(&at.path().join("in.ply"), &given).unwrap();
    let options = ["surfels", "in.ply", "-o", "out.ply", "--sampler", "greedy"];
    let start = ["--start", "3", "--count", "40"];
    let said = succeeds(at.path(), &[&options[..], &start].concat());
    for word in ["points     60\n", "greedy, 40 of them, from point 3", "apart", "out.ply"] {
        assert!(said.contains(word), "{word} in {said}");
    }
    let order = Greedy { start: Start::Index(3) }.define(&given.position, 40).unwrap().index;
    assert!(order.contains(&5) && order.contains(&4), "with further groups");
    let found = ply::read(&at.path().join("out.ply")).unwrap();
    let groups = found.groups.clone().unwrap();
    assert_eq!((found.position.len(), groups.scale()), (40, &[1.0, 2.0, 1.0][..]));
    for (new, &old) in order.iter().enumerate() {
        let i = old as usize;
        assert_eq!(found.position[new], given.position[i]);
        assert_eq!(found.radius.as_ref().unwrap()[new], old as f32);
        assert_eq!(found.opacity.as_ref().unwrap()[new], old as f32);
        assert_eq!(found.tangents.as_ref().unwrap()[new][1].x, old as f32 + 1.0);
        assert_eq!(found.color.as_ref().unwrap()[new].x, old as f32 / 64.0);
        for vectors in [&found.normal, &found.tangent] {
            assert_eq!(vectors.as_ref().unwrap()[new].x, old as f32);
        }
        assert_eq!(
            found.mipmap.as_ref().unwrap().of_surfel(new),
            given.mipmap.as_ref().unwrap().of_surfel(i)
        );
        assert!(groups.of_surfel(new as u32).eq(given.groups.as_ref().unwrap().of_surfel(old)));
    }
}

/// The octahedron |x| + |y| + |z| = 1, with a part inside that nobody sees.
fn octahedron() -> Cloud {
    let mut mesh = Cloud::default();
    for scale in [1.0, 0.25] {
        let first = mesh.position.len() as u32;
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            mesh.position.extend([axis * scale, -axis * scale]);
        }
        for i in 0..8_u32 {
            let [x, y, z] = [0, 1, 2].map(|axis| first + 2 * axis + (i >> axis & 1));
            let corners = if i.count_ones() % 2 == 0 { [x, y, z] } else { [x, z, y] };
            mesh.triangles.push(corners);
        }
    }
    mesh.color = Some(mesh.position.iter().map(|p| p.abs()).collect());
    mesh
}

#[test]
fn a_mesh_becomes_points_on_what_is_seen_of_it() {
    let at = TempDir::new().unwrap();
    ply::write(&at.path().join("mesh.ply"), &octahedron()).unwrap();
    for sampler in ["greedy", "progressive", "progressive-as-shipped", "random"] {
        let options = ["surfels", "mesh.ply", "-o", "out.ply", "--side", "100", "--count", "700"];
        let said = succeeds(at.path(), &[&options[..], &["--sampler", sampler]].concat());
        assert!(said.contains(&format!("{sampler}, 700 of them")), "{said}");
        let cloud = ply::read(&at.path().join("out.ply")).unwrap();
        assert_eq!((cloud.position.len(), cloud.triangles.len(), cloud.radius), (700, 0, None));
        let normal = cloud.normal.unwrap();
        for (i, p) in cloud.position.iter().enumerate() {
            let size = p.abs();
            assert!((size.element_sum() - 1.0).abs() < 1e-5, "{p} is on the outer one");
            assert!(normal[i].dot(*p) > 0.0, "and faces outward");
            let color = cloud.color.as_ref().unwrap()[i];
            assert!((color - size).abs().max_element() < 0.02, "{color} at {p}");
        }
    }
}

/// Opacity and what is named go with the points, through the order and the means of colours.
#[test]
fn opacities_and_properties_go_with_the_points() {
    let at = TempDir::new().unwrap();
    let mut mesh = octahedron();
    let height = |p: &Vec3| p.y / 2.0 + 0.5;
    mesh.opacity = Some(mesh.position.iter().map(height).collect());
    let property = |name: &str, of: fn(&Vec3) -> f32| Property {
        name: name.into(),
        values: mesh.position.iter().map(of).collect(),
    };
    mesh.properties = vec![
        property("roughness", |p| 7.0 * p.x),
        property("time", |p| p.z),
        property("metallic", |p| p.z),
    ];
    ply::write(&at.path().join("mesh.ply"), &mesh).unwrap();
    let surfels = ["surfels", "mesh.ply", "-o", "out.ply", "--side", "90", "--count", "600"];
    let named = ["--properties", "metallic,roughness", "--average-colors", "300"];
    succeeds(at.path(), &[&surfels[..], &named].concat());
    let path = at.path().join("out.ply");
    let cloud = ply::read(&path).unwrap();
    let names = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect::<Vec<_>>();
    let properties = ply::properties(&path, &names(&["roughness", "metallic"])).unwrap();
    let opacity = cloud.opacity.unwrap();
    assert_eq!(cloud.position.len(), 600);
    for (i, p) in cloud.position.iter().enumerate() {
        // On a face all of them are linear in the place, but for |y|, which opacity has nothing of.
        assert!((opacity[i] - height(p)).abs() < 1e-5, "{} at {p}", opacity[i]);
        assert!((properties[0].values[i] - 7.0 * p.x).abs() < 1e-5);
        assert!((properties[1].values[i] - p.z).abs() < 1e-5);
    }
    assert!(ply::properties(&path, &names(&["time"])).is_err(), "which nobody named");

    // Points alone keep what is named, each its own.
    let again =
        ["surfels", "out.ply", "-o", "again.ply", "--properties", "metallic", "--count", "50"];
    succeeds(at.path(), &again);
    let path = at.path().join("again.ply");
    let (again, metallic) =
        (ply::read(&path).unwrap(), ply::properties(&path, &names(&["metallic"])).unwrap());
    for (i, p) in again.position.iter().enumerate() {
        let old = cloud.position.iter().position(|q| q == p).unwrap();
        assert_eq!(
            (again.opacity.as_ref().unwrap()[i], metallic[0].values[i]),
            (opacity[old], properties[1].values[old])
        );
    }

    // Transparent methods draw them: what is above is seen through less than what is below.
    let render =
        ["render", "out.ply", "-o", "out.exr", "--method", "transparent", "--size", "40x40"];
    succeeds(at.path(), &render);
    let line = fails(at.path(), &[&surfels[..], &["--properties", "gloss"]].concat(), 1);
    assert!(line.contains("mesh.ply: element vertex has no property `gloss`"), "{line}");
    let line = fails(at.path(), &["surfels", "mesh.obj", "-o", "out.ply", "--properties", "a"], 2);
    assert!(line.contains("--properties needs a .ply"), "{line}");
    let line = fails(at.path(), &["surfels", "mesh.ply", "-o", "folder", "--properties", "a"], 1);
    assert!(line.contains("mesh.ply: element vertex has no property `a`"), "{line}");
    assert!(!at.path().join("folder").exists(), "nothing is begun");
    mesh.opacity = Some(vec![f32::NAN; mesh.position.len()]);
    ply::write(&at.path().join("mesh.ply"), &mesh).unwrap();
    let line = fails(at.path(), &surfels, 1);
    assert!(
        line.contains("none of its 16 triangles has corners with an opacity in [0, 1]"),
        "{line}"
    );
}

/// Every method draws a prefix as the file of so many points.
#[test]
fn a_prefix_is_the_file_of_its_points() {
    let at = TempDir::new().unwrap();
    ply::write(&at.path().join("mesh.ply"), &octahedron()).unwrap();
    let surfels = ["surfels", "mesh.ply", "--side", "100", "--count"];
    succeeds(at.path(), &[&surfels[..], &["2000", "-o", "all.ply"]].concat());
    succeeds(at.path(), &[&surfels[..], &["500", "-o", "few.ply"]].concat());
    let scene = "[[model]]\nfile = \"all.ply\"\nprefix = 500\n";
    fs::write(at.path().join("scene.toml"), scene).unwrap();
    for method in ["ewa", "single-pass", "pyramid", "template", "deferred"] {
        let exr = |arguments: &[&str]| {
            let options = ["-o", "out.exr", "--size", "48x40", "--method", method];
            succeeds(at.path(), &[&["render"], arguments, &options].concat());
            let named = at.path().join(arguments[0]).with_extension("exr");
            fs::rename(at.path().join("out.exr"), named).unwrap();
        };
        exr(&["few.ply"]);
        exr(&["all.ply", "--prefix", "500"]);
        exr(&["scene.toml"]);
        let same = |other: &str| succeeds(at.path(), &["compare", "few.exr", other]);
        same("all.exr");
        same("scene.exr");
        exr(&["all.ply"]);
        let all = splatref(at.path(), &["compare", "few.exr", "all.exr"]);
        assert_eq!(all.status.code(), Some(1), "{method}");
    }
    for (arguments, code, what) in [
        (["all.ply", "--prefix", "0"], 2, "a prefix of 0 points"),
        (["sphere", "--prefix", "9"], 2, "sphere is not one"),
        (["mesh.ply", "--prefix", "9"], 1, "mesh.ply: a prefix needs points"),
    ] {
        let line = fails(at.path(), &[&["render", "-o", "out.exr"], &arguments[..]].concat(), code);
        assert!(line.contains(what), "{what} in {line}");
    }
}

/// Every method draws as many points as a view needs, and no more than a budget has.
#[test]
fn a_view_draws_as_much_of_an_order_as_it_needs() {
    let at = TempDir::new().unwrap();
    ply::write(&at.path().join("mesh.ply"), &octahedron()).unwrap();
    let surfels = ["surfels", "mesh.ply", "--side", "100", "--count", "3000", "-o", "all.ply"];
    succeeds(at.path(), &surfels);
    let scene =
        "[[model]]\nfile = \"all.ply\"\nprogressive = true\n[refinement]\nsurfel_size = 8\n";
    fs::write(at.path().join("scene.toml"), scene).unwrap();
    let in_view = |said: &str| -> u64 {
        let line = said.lines().find_map(|line| line.strip_prefix("  in view"));
        line.and_then(|line| line.split_whitespace().next()?.parse().ok()).unwrap()
    };
    for method in
        ["ewa", "single-pass", "pyramid", "template", "deferred", "transparent", "peeling"]
    {
        let render = |arguments: &[&str], to: &str| {
            let options = ["-o", to, "--size", "48x40", "--method", method];
            in_view(&succeeds(at.path(), &[&["render"], arguments, &options].concat()))
        };
        let asked = render(&["all.ply", "--surfel-size", "8"], "asked.exr");
        assert_eq!(render(&["scene.toml"], "scene.exr"), asked);
        succeeds(at.path(), &["compare", "asked.exr", "scene.exr"]);
        // Of half the diameter, four times as many.
        let small = render(&["all.ply", "--surfel-size", "4"], "small.exr");
        assert!((4 * asked - 4..=4 * asked).contains(&small), "{method}: {asked} and {small}");
        let few = render(&["scene.toml", "--surfel-budget", "100"], "few.exr");
        assert!((96..=100).contains(&few), "{method}: {few}");
    }
    for (arguments, code, what) in [
        (["all.ply", "--surfel-size", "0"], 2, "discs of 0 pixels"),
        (["all.ply", "--surfel-budget", "0"], 2, "a budget of 0 surfels"),
        (["mesh.ply", "--surfel-budget", "9"], 1, "mesh.ply: a prefix needs points"),
        (
            ["sphere", "--surfel-budget", "9"],
            1,
            "sphere: only the ordered points of a file can be progressive",
        ),
    ] {
        let line = fails(at.path(), &[&["render", "-o", "out.exr"], &arguments[..]].concat(), code);
        assert!(line.contains(what), "{what} in {line}");
    }
}

/// A colour by chance becomes that of the neighbourhood; other points and properties stay.
#[test]
fn colours_of_the_first_points_are_means() {
    let at = TempDir::new().unwrap();
    let given = points(60);
    ply::write(&at.path().join("in.ply"), &given).unwrap();
    let options = ["surfels", "in.ply", "--start", "3", "-o"];
    succeeds(at.path(), &[&options[..], &["own.ply"]].concat());
    let said = succeeds(at.path(), &[&options[..], &["out.ply", "--average-colors", "8"]].concat());
    assert!(said.contains("means over the nearest points, for the first 8\n"), "{said}");
    let [own, new] = ["own.ply", "out.ply"].map(|name| ply::read(&at.path().join(name)).unwrap());
    let [own_color, new_color] = [&own, &new].map(|cloud| cloud.color.clone().unwrap());
    // The first pick's cell is all: the mean of 0 to 59, 1 and 2.
    assert_eq!(new_color[0], Vec3::new(29.5, 1.0, 2.0) / 64.0);
    assert!((1..8).any(|i| new_color[i] != own_color[i]));
    assert_eq!(new_color[8..], own_color[8..]);
    assert_eq!(Cloud { color: own.color.clone(), ..new }, own);
    for (arguments, code, what) in [
        (["in.ply", "--average-colors", "0"], 2, "--average-colors 0: give 1"),
        (["in.ply", "--average-colors", "61"], 1, "colours of 61 points, but the order has 60"),
        (["plain.ply", "--average-colors", "9"], 1, "plain.ply: the file has no colours"),
    ] {
        let plain = Cloud { color: None, mipmap: None, ..given.clone() };
        ply::write(&at.path().join("plain.ply"), &plain).unwrap();
        let line = fails(at.path(), &[&["surfels", "-o", "no.ply"], &arguments[..]].concat(), code);
        assert!(line.contains(what), "{what} in {line}");
    }
}

/// Two sides of a sheet: a pick on one says nothing of the other.
#[test]
fn distances_along_a_surface_do_not_go_through_it() {
    let at = TempDir::new().unwrap();
    let place = |i: usize| Vec3::new((i % 10) as f32, (i / 10 % 10) as f32, (i / 100) as f32 * 0.1);
    let normal = |i: usize| if i < 100 { -Vec3::Z } else { Vec3::Z };
    let sheet = Cloud {
        position: (0..200).map(place).collect(),
        normal: Some((0..200).map(normal).collect()),
        ..Cloud::default()
    };
    ply::write(&at.path().join("in.ply"), &sheet).unwrap();
    ply::write(&at.path().join("plain.ply"), &Cloud { normal: None, ..sheet }).unwrap();
    let along = ["--distance", "geodesic", "--reach", "1.5", "--start", "0", "--count", "4"];
    let order = |threads| {
        let options = ["surfels", "in.ply", "-o", "out.ply", "--threads", threads];
        let said = succeeds(at.path(), &[&options[..], &along].concat());
        assert!(
            said.contains("parts      2, not connected")
                && said.contains("at least 12.728 along the surface"),
            "{said}"
        );
        ply::read(&at.path().join("out.ply")).unwrap().position
    };
    let corners = [0, 100, 99, 199].map(place);
    assert_eq!(order("1"), corners, "each side in its turn");
    assert_eq!(order("3"), corners);
    // An octahedron: its edges are no borders, so that it is one part.
    ply::write(&at.path().join("mesh.ply"), &octahedron()).unwrap();
    let mesh = ["surfels", "mesh.ply", "-o", "out.ply", "--side", "60", "--distance", "geodesic"];
    let said = succeeds(at.path(), &mesh);
    assert!(said.contains("parts      1, not connected"), "{said}");
    let count = ["surfels", "in.ply", "-o", "out.ply", "--distance", "geodesic"];
    for (name, options, code, what) in [
        ("in.ply", &[] as &[&str], 1, "in.ply: points need a --reach with --distance geodesic"),
        ("plain.ply", &["--reach", "2"], 1, "plain.ply: the file has no normals"),
        ("in.ply", &["--reach", "0"], 2, "--reach 0: give a length above 0"),
        ("in.ply", &["--reach", "nan"], 2, "--reach NaN"),
        ("in.ply", &["--reach", "1", "--sampler", "random"], 2, "needs --sampler greedy"),
    ] {
        let all = [&[count[0], name], &count[2..], options].concat();
        let line = fails(at.path(), &all, code);
        assert!(line.contains(what), "{what} in {line}");
    }
    let line = fails(at.path(), &["surfels", "in.ply", "-o", "out.ply", "--reach", "1"], 2);
    assert!(line.contains("--reach needs --distance geodesic"), "{line}");
}

#[test]
fn the_start_is_chosen_by_a_seed_and_threads_change_nothing() {
    let at = TempDir::new().unwrap();
    let position = points(500).position;
    ply::write(&at.path().join("in.ply"), &Cloud { position, ..Cloud::default() }).unwrap();
    let order = |more: &[&str]| {
        succeeds(at.path(), &[&["surfels", "in.ply", "-o", "out.ply"], more].concat());
        fs::read(at.path().join("out.ply")).unwrap()
    };
    let all = order(&[]);
    assert_eq!(order(&["--seed", "0", "--threads", "1"]), all);
    assert_eq!(order(&["--count", "501", "--threads", "3"]), all, "as many as there are");
    assert_ne!(order(&["--seed", "1"]), all);
    let cloud = ply::read(&at.path().join("out.ply")).unwrap();
    assert_eq!((cloud.position.len(), cloud.normal, cloud.radius), (500, None, None));
}

#[test]
fn what_cannot_be_put_in_order_is_refused() {
    let at = TempDir::new().unwrap();
    let write = |name: &str, cloud: &Cloud| ply::write(&at.path().join(name), cloud).unwrap();
    write("in.ply", &points(9));
    let mut nowhere = points(9);
    nowhere.position[6].y = f32::NAN;
    write("nan.ply", &nowhere);
    // Flat, so that its box is too.
    let position: Vec<Vec3> = points(9).position.iter().map(|p| p.with_y(0.0)).collect();
    let mesh = Cloud { position, triangles: vec![[0, 1, 2]], ..Cloud::default() };
    write("mesh.ply", &mesh);
    write("lines.ply", &Cloud { triangles: Vec::new(), edges: vec![[0, 1]], ..mesh });
    let header = "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n";
    let empty = format!("{header}property float z\nend_header\n");
    fs::write(at.path().join("empty.ply"), empty).unwrap();
    let before = names(at.path());
    for (arguments, code, what) in [
        (&["in.ply", "-o", "out.ply", "--count", "0"] as &[&str], 2, "give at least 1"),
        (&["in.ply", "-o", "out.ply", "--start", "1", "--sampler", "random"], 2, "no --start"),
        (&["mesh.ply", "-o", "out.ply", "--side", "0"], 2, "--side 0: camera: a picture of 0 x 0"),
        (&["in.ply", "-o", "out.ply", "--side", "9"], 1, "in.ply: --side needs a mesh"),
        (&["in.ply", "-o", "out.ply", "--directions", "box"], 1, "--directions needs a mesh"),
        (&["in.ply", "-o", "out.ply", "--sampler", "best"], 2, "greedy"),
        (&["in.ply", "-o", "in.ply"], 2, "in.ply is also an input"),
        (&["in.ply", "-o", "out.exr"], 2, "out.exr: points are written as a PLY"),
        (&["sphere", "-o", "out.ply"], 2, "sphere: give points or a mesh"),
        (&["in.ply"], 2, "--output"),
        (&["in.ply", "-o", "missing/out.ply"], 1, "missing/out.ply"),
        (&["in.ply", "-o", "out.ply", "--start", "9"], 1, "start 9, but the points are 0 to 8"),
        (&["nan.ply", "-o", "out.ply"], 1, "nan.ply: point 6 is not finite"),
        (&["mesh.ply", "-o", "out.ply", "--directions", "box"], 1, "mesh.ply: no triangle covers"),
        (&["lines.ply", "-o", "out.ply"], 1, "1 edges"),
        (&["empty.ply", "-o", "out.ply"], 1, "the file holds no points"),
        (&["missing.ply", "-o", "out.ply"], 1, "missing.ply"),
        (&["in.ply", "-o", "out.ply", "--memory", "1M"], 1, "--memory"),
    ] {
        let line = fails(at.path(), &[&["surfels"], arguments].concat(), code);
        assert!(line.contains(what), "{what} in {line}");
    }
    assert_eq!(names(at.path()), before, "nothing is written");
}

/// A square of which each corner has a place in a texture: its candidates have the colours of the texture, of its own one or
/// of another that is chosen.
#[test]
fn the_candidates_of_a_textured_mesh_have_its_colours() {
    let at = TempDir::new().unwrap();
    let corner = |x: f32, y: f32| Vec3::new(x, y, 0.0);
    let places =
        [Vec2::new(0.0, 0.0), Vec2::new(1.0, 0.0), Vec2::new(1.0, 1.0), Vec2::new(0.0, 1.0)];
    let mesh = Cloud {
        position: places.iter().map(|p| corner(p.x, p.y)).collect(),
        coordinates: Some(Coordinates::Points(places.to_vec())),
        textures: vec!["red.exr".into()],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Cloud::default()
    };
    ply::write(&at.path().join("in.ply"), &mesh).unwrap();
    for (name, i) in [("red.exr", 0), ("green.exr", 1)] {
        // Bright at the right.
        let color = |x: u32| std::array::from_fn(|c| if c == i && x >= 16 { 1.0 } else { 0.0 });
        let values = (0..32 * 32).map(|at| color(at % 32)).collect();
        let frame = Frame::new(32, 32).with("", Samples::Color(Plane::from_values(32, 32, values)));
        exr::write(&at.path().join(name), &frame.unwrap(), "").unwrap();
    }
    let common = ["surfels", "in.ply", "-o", "out.ply", "--side", "64"];
    for (options, i) in [(&[][..], 0), (&["--texture", "green.exr"], 1)] {
        succeeds(at.path(), &[&common[..], options].concat());
        let found = ply::read(&at.path().join("out.ply")).unwrap();
        let colors = found.color.unwrap();
        assert!(colors.len() > 100);
        for (p, color) in
            found.position.iter().zip(&colors).filter(|(p, _)| (p.x - 0.5).abs() > 0.1)
        {
            let expected = if p.x > 0.5 { 1.0 } else { 0.0 };
            assert!((color[i] - expected).abs() < 1e-6 && color[1 - i] == 0.0, "{p}: {color}");
        }
    }
    fs::remove_file(at.path().join("red.exr")).unwrap();
    let said = fails(at.path(), &common, 1);
    assert!(said.contains("in.ply: its texture red.exr: "), "{said}");
    let picture = ["render", "in.ply", "-o", "a.exr", "--size", "32x24", "--texture", "green.exr"];
    succeeds(at.path(), &picture);
    let said = fails(at.path(), &["render", "sphere", "-o", "b.exr", "--texture", "green.exr"], 2);
    assert!(said.contains("--texture applies to a file, but sphere is not one"), "{said}");
    ply::write(&at.path().join("points.ply"), &points(9)).unwrap();
    let said =
        fails(at.path(), &["surfels", "points.ply", "-o", "c.ply", "--texture", "green.exr"], 1);
    assert!(said.contains("--texture needs a mesh, but the file has no triangles"), "{said}");
}
