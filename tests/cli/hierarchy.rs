//! `splatref surfels SCENE -o folder`: hierarchies, stopped and whole.

use super::*;
use glam::Vec3;
use splatref::frame::Exec;
use splatref::io::hierarchy::Hierarchy;
use splatref::io::ply;
use splatref::io::scene_file::SceneFile;
use splatref::scene::{Cloud, Property};
use std::collections::BTreeMap;
use tempfile::TempDir;

/// A hilly square of 2 n n triangles.
fn hills(n: u32) -> Cloud {
    let mut mesh = Cloud::default();
    for row in 0..=n {
        for column in 0..=n {
            let [x, z] = [column, row].map(|i| i as f32 / n as f32);
            mesh.position.push(Vec3::new(x, x * (1.0 - x) * z * (1.0 - z), z));
        }
    }
    for row in 0..n {
        for column in 0..n {
            let a = row * (n + 1) + column;
            let (b, c, d) = (a + 1, a + n + 1, a + n + 2);
            mesh.triangles.extend([[a, d, b], [a, c, d]]);
        }
    }
    mesh
}

/// A scene of two hills in a directory, and the arguments that make its hierarchy.
fn given() -> (TempDir, Vec<&'static str>) {
    let at = TempDir::new().unwrap();
    ply::write(&at.path().join("hills.ply"), &hills(72)).unwrap();
    let scene = "\
[[geometry]]
name = \"hills\"
file = \"hills.ply\"
[[object]]
of = \"hills\"
[[object]]
of = \"hills\"
transform = { translate = [2, 0, 0] }
";
    fs::write(at.path().join("scene.toml"), scene).unwrap();
    (at, vec!["surfels", "scene.toml", "--side", "256", "--count", "500", "-o"])
}

fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    names(folder)
        .into_iter()
        .map(|name| (name.clone(), fs::read(folder.join(name)).unwrap()))
        .collect()
}

#[test]
fn a_folder_is_made_described_and_found_again() {
    let (at, options) = given();
    let with = |more: &[&'static str]| [&options[..], more].concat();
    let said = succeeds(at.path(), &with(&["out"]));
    for word in
        ["2 of 1 geometries", "20736, 10368 of them unique", "1 of them cover several objects"]
    {
        assert!(said.contains(word), "{word} in {said}");
    }
    assert!(!said.contains("flaws") && !said.contains("from an earlier run"), "{said}");
    let info = succeeds(at.path(), &["info", "out"]);
    assert!(
        info.contains("2 of 1 geometries") && info.contains("(0, 0, 0) to (3, 0.0625, 1)"),
        "{info}"
    );
    let all = files(&at.path().join("out"));
    for (to, threads) in [("one/", "1"), ("three", "3")] {
        succeeds(at.path(), &with(&[to, "--threads", threads]));
        assert!(files(&at.path().join(to)) == all, "{threads} threads");
    }
    let nodes = Hierarchy::open(&at.path().join("out")).unwrap().nodes().len();
    let made = all.keys().filter(|name| name.starts_with("surfels-")).count();
    let said = succeeds(at.path(), &with(&["out"]));
    assert!(
        said.contains(&format!("{made} approximated, {made} of them from an earlier run")),
        "{said}"
    );
    assert!(made > 3 && made <= nodes);
    succeeds(at.path(), &with(&["down", "--traversal", "top-down", "--sampler", "progressive"]));
    assert!(files(&at.path().join("down")) != all);
}

#[test]
fn a_folder_is_rendered_as_a_scene() {
    let (at, mut options) = given();
    options.push("out");
    succeeds(at.path(), &options);
    let options = ["--method", "blue", "--size", "96x64", "-o"];
    let render = |scene, picture| [&["render", scene][..], &options, &[picture]].concat();
    let said = succeeds(at.path(), &render("out", "a.exr"));
    assert!(said.contains("object-1.") || said.contains("node-0: "), "{said}");
    fs::write(at.path().join("all.toml"), "hierarchy = \"out\"\n").unwrap();
    succeeds(at.path(), &render("all.toml", "b.exr"));
    succeeds(at.path(), &["compare", "a.exr", "b.exr"]);
    fs::write(at.path().join("two.toml"), "hierarchy = \"out\"\n[[model]]\nshape = \"torus\"\n")
        .unwrap();
    let line = fails(at.path(), &render("two.toml", "c.exr"), 1);
    assert!(line.contains("a hierarchy cannot be combined with models"), "{line}");
    let line = fails(at.path(), &["render", "out", "--opacity", "0.5"], 2);
    assert!(line.contains("--opacity applies to models"), "{line}");
    let line = fails(at.path(), &["surfels", "out", "-o", "again"], 2);
    assert!(line.contains("is a hierarchy already"), "{line}");
}

/// A view from afar needs the files of the root alone, and one that is missing is a line.
#[test]
fn a_view_reads_what_it_draws() {
    let (at, mut options) = given();
    options.push("out");
    succeeds(at.path(), &options);
    let options = ["--method", "blue", "--size", "96x64", "-o"];
    let render = |size, picture| {
        [&["render", "out", "--surfel-size", size][..], &options, &[picture]].concat()
    };
    succeeds(at.path(), &render("16", "all.exr"));
    let out = at.path().join("out");
    for name in names(&out) {
        if !["index", "bounds", "surfels-0"].contains(&name.as_str()) {
            fs::remove_file(out.join(name)).unwrap();
        }
    }
    succeeds(at.path(), &render("16", "few.exr"));
    succeeds(at.path(), &["compare", "all.exr", "few.exr"]);
    let line = fails(at.path(), &render("0.01", "near.exr"), 1);
    assert!(line.contains("out/mesh-0: ") && line.lines().count() == 1, "{line}");
    fs::remove_file(out.join("surfels-0")).unwrap();
    let line = fails(at.path(), &render("16", "none.exr"), 1);
    assert!(line.contains("out/surfels-0: ") && line.lines().count() == 1, "{line}");
}

/// Killed again and again, and not always gently, it gets to the end.
#[cfg(unix)]
#[test]
fn it_goes_on_after_signals() {
    let (at, mut options) = given();
    options.push("all");
    succeeds(at.path(), &options);
    let all = files(&at.path().join("all"));
    *options.last_mut().unwrap() = "out";
    let folder = at.path().join("out");
    let made = || if folder.exists() { names(&folder).len() } else { 0 };
    for signal in ["-TERM", "-KILL", "-TERM"] {
        let before = made();
        let mut command = Command::new(env!("CARGO_BIN_EXE_splatref"));
        let mut child = command.current_dir(at.path()).args(&options).spawn().unwrap();
        while made() < before + 2 && child.try_wait().unwrap().is_none() {
            std::thread::yield_now();
        }
        let sent = Command::new("kill").args([signal, &child.id().to_string()]).output();
        sent.unwrap();
        child.wait().unwrap();
        for (name, bytes) in files(&folder) {
            let partial = name.ends_with(".partial") && signal == "-KILL";
            assert!(partial || all[&name] == bytes, "{name} after {signal}");
        }
    }
    succeeds(at.path(), &options);
    assert!(files(&folder) == all);
}

/// A limit on the size of files stands for a full disk.
#[cfg(target_os = "linux")]
#[test]
fn what_a_full_disk_stopped_goes_on() {
    let (at, mut options) = given();
    options.push("out");
    let mut shell = Command::new("sh");
    shell.args([
        "-c",
        "trap '' XFSZ; ulimit -f 16; exec \"$0\" \"$@\"",
        env!("CARGO_BIN_EXE_splatref"),
    ]);
    let output = shell.current_dir(at.path()).args(&options).output().unwrap();
    let line = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{line}");
    assert!(line.lines().count() == 1 && line.contains("mesh-0: "), "{line}");
    assert_eq!(names(&at.path().join("out")), ["plan"]);
    let line = fails(at.path(), &["info", "out"], 1);
    assert!(line.contains("incomplete"), "{line}");
    succeeds(at.path(), &options);
    let all = files(&at.path().join("out"));
    *options.last_mut().unwrap() = "all";
    succeeds(at.path(), &options);
    assert!(files(&at.path().join("all")) == all);
}

/// Both write the same files: neither harms the other.
#[test]
fn two_at_once_make_one() {
    let (at, mut options) = given();
    options.push("all");
    succeeds(at.path(), &options);
    *options.last_mut().unwrap() = "out";
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| succeeds(at.path(), &options));
        }
    });
    assert!(files(&at.path().join("out")) == files(&at.path().join("all")));
}

#[test]
fn options_that_a_folder_has_no_use_for_are_refused() {
    let (at, options) = given();
    for (more, what) in [
        (&["--start", "3"][..], "--start does not apply to a folder"),
        (&["--distance", "geodesic"], "--distance geodesic does not apply to a folder"),
        (&["--average-colors", "3"], "--average-colors does not apply to a folder"),
    ] {
        let line = fails(at.path(), &[&options[..], &["out"], more].concat(), 2);
        assert!(line.contains(what), "{what} in {line}");
    }
    let line =
        fails(at.path(), &["surfels", "hills.ply", "-o", "a.ply", "--traversal", "top-down"], 2);
    assert!(line.contains("--traversal applies to a folder"), "{line}");
    let line = fails(at.path(), &["surfels", "sphere", "-o", "out"], 1);
    assert!(line.contains("no triangles to sample"), "{line}");
    let line = fails(at.path(), &["surfels", "hills.ply", "-o", "no/where"], 1);
    assert!(line.contains("no/where"), "{line}");
    fs::write(at.path().join("file"), "kept").unwrap();
    let line = fails(at.path(), &["surfels", "hills.ply", "-o", "file"], 1);
    assert!(line.contains("file: "), "{line}");
    assert_eq!(names(at.path()), ["file", "hills.ply", "scene.toml"]);
}

/// A scene of two hills: one with opacities, the other in a place of its own without; both with a roughness. Each
/// number is linear in the place, so that it is known wherever a surfel is.
fn veiled() -> TempDir {
    let at = TempDir::new().unwrap();
    let flat = |mesh: &mut Cloud| mesh.position.iter_mut().for_each(|p| p.y = 0.0);
    let rough = |mesh: &Cloud| {
        let values = mesh.position.iter().map(|p| 3.0 * p.z - 1.0).collect();
        vec![Property { name: "roughness".into(), values }]
    };
    let mut mesh = hills(72);
    flat(&mut mesh);
    mesh.properties = rough(&mesh);
    ply::write(&at.path().join("opaque.ply"), &mesh).unwrap();
    mesh.opacity = Some(mesh.position.iter().map(|p| 0.25 + p.x / 2.0).collect());
    ply::write(&at.path().join("veiled.ply"), &mesh).unwrap();
    let scene = "\
[[geometry]]
name = \"veiled\"
file = \"veiled.ply\"
[[geometry]]
name = \"opaque\"
file = \"opaque.ply\"
[[object]]
of = \"veiled\"
[[object]]
of = \"opaque\"
transform = { translate = [2, 0, 0] }
";
    fs::write(at.path().join("scene.toml"), scene).unwrap();
    at
}

/// Whether points have the numbers of where they are.
fn check_numbers(cloud: &Cloud, roughness: &[f32], most_off: f32) {
    let opacity = cloud.opacity.as_ref().unwrap();
    assert!(cloud.position.len() > 100);
    let far = cloud.position.iter().filter(|p| p.x >= 1.5).count();
    assert!(far > 50 && far < cloud.position.len() - 50, "{far} of the other object");
    for (i, p) in cloud.position.iter().enumerate() {
        let expected = if p.x >= 1.5 { 1.0 } else { 0.25 + p.x / 2.0 };
        assert!((opacity[i] - expected).abs() < most_off, "{} at {p}", opacity[i]);
        assert!(
            (roughness[i] - (3.0 * p.z - 1.0)).abs() < 6.0 * most_off,
            "{} at {p}",
            roughness[i]
        );
    }
}

#[test]
fn scenes_give_their_opacities_and_properties_to_points() {
    let at = veiled();
    let options = ["--side", "256", "--count", "400", "--properties", "roughness", "-o"];
    let surfels =
        |scene: &'static str, to: &'static str| [&["surfels", scene][..], &options, &[to]].concat();
    let said = succeeds(at.path(), &surfels("scene.toml", "out.ply"));
    assert!(said.contains("greedy, 400 of them"), "{said}");
    let path = at.path().join("out.ply");
    let roughness = ply::properties(&path, &["roughness".into()]).unwrap();
    check_numbers(&ply::read(&path).unwrap(), &roughness[0].values, 1e-5);

    let said = succeeds(at.path(), &surfels("scene.toml", "out"));
    assert!(said.contains("opacities, roughness"), "{said}");
    let said = succeeds(at.path(), &["info", "out"]);
    assert!(said.contains("opacities, roughness"), "{said}");
    // The root stands for both objects, by the surfels of both: a square of a surfel has one number.
    let hierarchy = Hierarchy::open(&at.path().join("out")).unwrap();
    let cloud = hierarchy.surfels(0, u32::MAX).unwrap();
    check_numbers(&cloud, &cloud.properties[0].values, 0.06);
    ply::write(&at.path().join("root.ply"), &cloud).unwrap();
    let said = succeeds(at.path(), &["info", "root.ply"]);
    assert!(said.contains("opacities"), "{said}");

    // Methods that draw triangles draw all of it opaque.
    let bare = veiled();
    let mut scene = fs::read_to_string(bare.path().join("scene.toml")).unwrap();
    scene = scene.replace("veiled.ply", "opaque.ply");
    fs::write(bare.path().join("scene.toml"), scene).unwrap();
    succeeds(bare.path(), &surfels("scene.toml", "out"));
    let render = ["render", "out", "--method", "blue", "--size", "96x64", "-o", "a.exr"];
    succeeds(at.path(), &render);
    succeeds(bare.path(), &render);
    let other = bare.path().join("a.exr").display().to_string();
    succeeds(at.path(), &["compare", "a.exr", &other]);

    let mut other = hills(9);
    other.opacity = Some(vec![0.5; other.position.len()]);
    ply::write(&at.path().join("opaque.ply"), &other).unwrap();
    for to in ["new.ply", "new"] {
        let line = fails(at.path(), &surfels("scene.toml", to), 1);
        let what = "opaque.ply: element vertex has no property `roughness`";
        assert!(line.contains(what) && !at.path().join(to).exists(), "{line}");
    }
    let line = fails(at.path(), &surfels("out", "again.ply"), 2);
    assert!(line.lines().count() == 1, "{line}");
    fs::write(at.path().join("all.toml"), "hierarchy = \"out\"\n").unwrap();
    let line = fails(at.path(), &surfels("all.toml", "again.ply"), 1);
    assert!(line.contains("a hierarchy already has its surfels"), "{line}");
    fs::write(at.path().join("tree.toml"), "[[model]]\nshape = \"tree\"\n").unwrap();
    let line = fails(at.path(), &surfels("tree.toml", "tree.ply"), 2);
    assert!(line.contains("tree: no property roughness"), "{line}");
}

/// What a folder holds is told of its index alone; of a scene that shows it of the bounds, too.
#[test]
fn info_reads_the_index_alone() {
    let (at, mut options) = given();
    options.push("out");
    succeeds(at.path(), &options);
    fs::write(at.path().join("all.toml"), "hierarchy = \"out\"\n[method]\nname = \"blue\"\n")
        .unwrap();
    let [all, scene] = ["out", "all.toml"].map(|name| succeeds(at.path(), &["info", name]));
    let loaded = SceneFile::read(&at.path().join("all.toml")).unwrap();
    let loaded = loaded.load(&Exec::sequential(), &|_, _, _| ()).unwrap();
    assert!(scene.contains(&loaded.scene.sha256()), "{scene}");
    let objects = loaded.scene.objects.unwrap();
    let found = format!("{} surfels and nodes", objects.drawn_total());
    assert!(scene.contains(&found), "{found} in {scene}");
    let out = at.path().join("out");
    for name in names(&out) {
        if !["index", "bounds"].contains(&name.as_str()) {
            fs::remove_file(out.join(name)).unwrap();
        }
    }
    assert_eq!(succeeds(at.path(), &["info", "all.toml"]), scene);
    for name in names(&out) {
        if name != "index" {
            fs::remove_file(out.join(name)).unwrap();
        }
    }
    assert_eq!(succeeds(at.path(), &["info", "out"]), all);
}

/// A view in which nothing is visible is an empty picture, in every method that draws the folder.
#[test]
fn a_view_of_nothing_is_a_picture() {
    let at = tempfile::tempdir().unwrap();
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/golden/nodes");
    let camera = "[camera]\nsize = [16, 12]\neye = [0, 0, 500]\ntarget = [0, 0, 5000]\n";
    fs::write(at.path().join("away.toml"), format!("hierarchy = {folder:?}\n{camera}")).unwrap();
    for method in ["deferred", "pyramid", "blue"] {
        let render = ["render", "away.toml", "-o", "a.exr", "--method", method];
        succeeds(at.path(), &render);
        let image = exr::read(&at.path().join("a.exr")).unwrap();
        assert!(floats(&image, "A").iter().all(|alpha| *alpha == 0.0), "{method}");
    }
}
