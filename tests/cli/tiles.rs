//! `splatref tile`, and pictures of its folders.

use super::*;
use glam::Vec3;
use splatref::io::ply;
use splatref::scene::Cloud;
use splatref::source::Shape;
use std::io::Write;
use tempfile::TempDir;

/// Writes a torus in colours as `torus.ply`, and tiles it.
fn torus(at: &Path, count: usize) {
    let mut cloud = Shape::Torus.surfels(count, 0).unwrap().into_cloud();
    let color = |n: &Vec3| 0.5 * (*n + Vec3::ONE);
    cloud.color = cloud.normal.as_ref().map(|normals| normals.iter().map(color).collect());
    ply::write(&at.join("torus.ply"), &cloud).unwrap();
    fs::create_dir(at.join("tiled")).unwrap();
    let said = succeeds(at, &["tile", "torus.ply", "-o", "tiled/torus"]);
    assert!(said.contains("blocks") && said.contains("tiled/torus"), "{said}");
}

#[test]
fn a_folder_with_the_name_of_a_shape_is_not_taken_for_it() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    torus(at, 300);
    fs::rename(at.join("tiled/torus"), at.join("torus")).unwrap();
    let size = ["--size", "20x10", "-o", "a.exr"];
    let line = fails(at, &[&["render", "torus"], &size[..]].concat(), 2);
    assert!(line.contains("./torus"), "{line}");
    let said = succeeds(at, &[&["render", "./torus"], &size[..]].concat());
    assert!(said.contains("300 surfels"), "{said}");
    let line = fails(at, &["render", "tiled"], 2);
    assert!(line.contains("without surfels"), "{line}");
}

#[test]
fn file_folder_regions_and_bands_give_one_file() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    torus(at, 6000);
    let read = |name: &str| fs::read(at.join(name)).unwrap();
    for more in [
        &["--stages"][..],
        &["--method", "peeling", "--opacity", "0.5"],
        &["--method", "peeling", "--storage", "f16", "--outline", "raycast"],
        &["--method", "blue", "--number", "f64", "--environment", "sky"],
        &["--method", "single-pass"],
        &["--eye", "0.9,0.1,0.1", "--target", "0,1,0", "--outline", "perspective"],
    ] {
        let draw = |scene: &str, to: &str, last: &[&str]| {
            let first = ["render", scene, "--size", "90x100", "-o", to];
            succeeds(at, &[&first, more, last].concat())
        };
        draw("torus.ply", "file.exr", &[]);
        draw("tiled/torus", "folder.exr", &[]);
        draw("tiled/torus", "bands.exr", &["--bands", "4"]);
        for name in ["folder", "bands"] {
            assert!(read("file.exr") == read(&format!("{name}.exr")), "{more:?} {name}");
        }
        assert!(read("file.png") == read("folder.png"), "{more:?}");
        for regions in [
            &["0,0,90,41", "0,41,90,100"][..],
            &[
                "0,0,20,30",
                "20,0,90,30",
                "0,30,90,31",
                "0,31,45,60",
                "45,31,90,77",
                "0,60,45,100",
                "45,77,90,100",
            ],
        ] {
            let mut files = Vec::new();
            for (i, region) in regions.iter().enumerate() {
                files.push(format!("{i}.exr"));
                // Parts of the file and of the folder fit together.
                let scene = if i == 1 { "torus.ply" } else { "tiled/torus" };
                draw(scene, &files[i], &["--region", region]);
            }
            let files: Vec<&str> = files.iter().map(String::as_str).collect();
            succeeds(at, &[&["assemble"], &files[..], &["-o", "joined.exr"]].concat());
            assert!(read("file.exr") == read("joined.exr"), "{more:?} {} regions", regions.len());
        }
    }
}

#[test]
fn the_folder_stands_for_the_file() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    torus(at, 6000);
    let read = |name: &str| fs::read(at.join(name)).unwrap();
    let said =
        succeeds(at, &["render", "tiled/torus", "--size", "90x100", "--region", "0,30,20,40"]);
    assert!(said.contains("6000 surfels") && said.contains("surfels, which may be seen"), "{said}");
    // Every other command takes the folder for the file.
    let [a, b] =
        ["torus.ply", "tiled/torus"].map(|scene| succeeds(at, &["explain", scene, "512", "300"]));
    assert_eq!(a, b);
    succeeds(at, &["render", "tiled/torus", "--size", "64x48", "--stages", "-o", "all.exr"]);
    succeeds(at, &["verify", "torus.ply", "--size", "64x48", "all.exr"]);
    succeeds(at, &["verify", "tiled/torus", "--size", "64x48", "all.exr"]);
    for frames in ["folder", "file"] {
        let scene = if frames == "file" { "torus.ply" } else { "tiled/torus" };
        let turn = ["render", scene, "--size", "40x30", "--turntable", "2"];
        succeeds(at, &[&turn[..], &["-o", &format!("{frames}.exr")]].concat());
    }
    assert!(read("folder.0001.exr") == read("file.0001.exr"));
    let said = succeeds(at, &["info", "tiled/torus"]);
    assert!(said.contains("6000 surfels") && said.contains("sha256"), "{said}");
}

/// Whenever the folder is replaced, the picture is of the old scene, of the new one, or not there.
#[test]
fn a_folder_that_is_replaced_meanwhile_is_never_mixed() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    torus(at, 6000);
    let other = Shape::Torus.surfels(6000, 1).unwrap().into_cloud();
    ply::write(&at.join("other.ply"), &other).unwrap();
    let draw = ["render", "tiled/torus", "--size", "90x400", "--bands", "12", "-o"];
    let read = |name: &str| fs::read(at.join(name)).unwrap();
    let drawn = ["torus", "other"].map(|scene| {
        succeeds(at, &["tile", &format!("{scene}.ply"), "-o", "tiled/torus"]);
        succeeds(at, &[&draw[..], &["whole.exr"]].concat());
        read("whole.exr")
    });
    assert!(drawn[0] != drawn[1]);
    for scene in ["torus", "other"].repeat(3) {
        let output = std::thread::scope(|scope| {
            let output = scope.spawn(|| splatref(at, &[&draw[..], &["now.exr"]].concat()));
            succeeds(at, &["tile", &format!("{scene}.ply"), "-o", "tiled/torus"]);
            output.join().unwrap()
        });
        let line = String::from_utf8(output.stderr).unwrap();
        if output.status.success() {
            assert!(line.is_empty() && drawn.contains(&read("now.exr")), "{line}");
            fs::remove_file(at.join("now.exr")).unwrap();
        } else {
            let why = "splatref: tiled/torus/blocks: the file was replaced or truncated";
            assert!(line.starts_with(why) && line.lines().count() == 1, "{line}");
            assert_eq!(output.status.code(), Some(1), "{line}");
        }
        assert!(!names(at).iter().any(|name| name.ends_with(".partial") || name == "now.exr"));
    }
}

#[test]
fn a_scene_file_takes_a_folder_as_a_model() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    torus(at, 3000);
    for transform in ["", "transform = { scale = 0.5, translate = [0, 1, 0] }\n"] {
        let draw = |name: &str, model: &str| {
            let text = format!(
                "[[model]]\nfile = \"{model}\"\n{transform}[[light]]\nkind = \"point\"\nposition = [3, 3, 3]\n\
                 color = [1, 1, 1]\n[camera]\nsize = [40, 30]\n"
            );
            fs::create_dir_all(at.join(name)).unwrap();
            fs::write(at.join(name).join("scene.toml"), text).unwrap();
            succeeds(at, &["render", &format!("{name}/scene.toml"), "-o", &format!("{name}.exr")]);
            fs::read(at.join(format!("{name}.exr"))).unwrap()
        };
        assert!(draw("a", "../torus.ply") == draw("b", "../tiled/torus"), "{transform}");
    }
}

/// A wall of surfels of 76 bytes in memory, written without holding it.
fn wall(path: &Path, side: u32) {
    let mut to = std::io::BufWriter::new(fs::File::create(path).unwrap());
    let names = "x y z nx ny nz radius red green blue opacity tux tuy tuz tvx tvy tvz";
    let names: String = names.split(' ').map(|name| format!("property float {name}\n")).collect();
    let count = side * side;
    write!(to, "ply\nformat binary_little_endian 1.0\nelement vertex {count}\n{names}end_header\n")
        .unwrap();
    let step = 2.0 / side as f32;
    for i in 0..count {
        // No spatial order: the rows are far from each other.
        let i = (u64::from(i) * 7_919 % u64::from(count)) as u32;
        let (x, y) = ((i % side) as f32 * step - 1.0, (i / side) as f32 * step - 1.0);
        let shade = (i % 997) as f32 / 997.0;
        let row = [
            x,
            y,
            0.1 * x * y,
            0.0,
            0.0,
            1.0,
            step,
            shade,
            0.5,
            1.0 - shade,
            0.9,
            step,
            0.0,
            0.0,
            0.0,
            step,
            0.0,
        ];
        row.iter().for_each(|number| to.write_all(&number.to_le_bytes()).unwrap());
    }
    to.flush().unwrap();
}

/// The limit is a fourth of what the surfels alone take in memory.
#[cfg(target_os = "linux")] // elsewhere what is in use is not known
#[test]
fn a_scene_four_times_as_large_as_memory_is_tiled_and_drawn() {
    const SIDE: u32 = 1650;
    let at = TempDir::new().unwrap();
    let at = at.path();
    wall(&at.join("wall.ply"), SIDE);
    fs::create_dir(at.join("tiled")).unwrap();
    let limit = (u64::from(SIDE * SIDE) * 72 / 4).to_string();
    let limited = ["--memory", &limit, "--threads", "2"];
    succeeds(at, &[&["tile", "wall.ply", "-o", "tiled/wall"], &limited[..]].concat());
    let draw_of = |[size, fov]: [&'static str; 2], scene: &'static str, more: &[&str]| {
        let first =
            ["render", scene, "--size", size, "--eye", "0,0,3", "--target", "0,0,0", "--fov", fov];
        first.iter().chain(more).map(|word| word.to_string()).collect::<Vec<_>>()
    };
    let draw = |scene, more: &[&str]| draw_of(["128x2048", "40"], scene, more);
    let run =
        |words: Vec<String>| splatref(at, &words.iter().map(String::as_str).collect::<Vec<_>>());
    let output = run(draw("wall.ply", &[&["-o", "no.exr"], &limited[..]].concat()));
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let output = run(draw("tiled/wall", &[&["-o", "no.exr"], &limited[..]].concat()));
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let line = String::from_utf8_lossy(&output.stderr);
    assert!(line.contains("--bands auto"), "{line}");
    let whole = run(draw("wall.ply", &["-o", "whole.exr"]));
    assert!(whole.status.success(), "{whole:?}");
    let bands =
        run(draw("tiled/wall", &[&["-o", "bands.exr", "--bands", "auto"], &limited[..]].concat()));
    assert!(bands.status.success() && bands.stderr.is_empty(), "{bands:?}");
    let read = |name: &str| fs::read(at.join(name)).unwrap();
    assert!(read("whole.exr") == read("bands.exr"));
    // A band of 32 rows, the smallest, shows more surfels than fit, and is drawn in parts side by side.
    let draw_strip = |scene: &'static str, more: &[&str]| {
        let output = run(draw_of(["1024x32", "4"], scene, more));
        assert!(output.status.success(), "{output:?}");
        String::from_utf8(output.stdout).unwrap()
    };
    draw_strip("wall.ply", &["-o", "strip.exr"]);
    let half = (u64::from(SIDE * SIDE) * 72 / 2).to_string();
    let more = ["-o", "parts.exr", "--bands", "auto", "--memory", &half, "--threads", "2"];
    let said = draw_strip("tiled/wall", &more);
    assert!(said.contains("1 of ") && said.contains(" parts"), "{said}");
    assert!(read("strip.exr") == read("parts.exr"));
    // A few regions, because every process takes its time.
    for region in ["0,0,128,32", "0,1000,128,1032", "3,2040,9,2048"] {
        let more = ["-o", "part.exr", "--region", region];
        let output = run(draw("tiled/wall", &[&more, &limited[..]].concat()));
        assert!(output.status.success(), "{output:?}");
        succeeds(at, &["compare", "whole.exr", "part.exr", "--region", region]);
    }
}

#[test]
fn what_cannot_be_tiled_is_one_line() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    torus(at, 300);
    let points = Cloud { position: vec![Vec3::X, Vec3::Y], ..Cloud::default() };
    ply::write(&at.join("points.ply"), &points).unwrap();
    let line = fails(at, &["tile", "points.ply", "-o", "out"], 1);
    assert!(line.contains("points.ply: ") && line.contains("because it has no normals"), "{line}");
    for (scene, folder, code) in [
        ("tree", "out", 1),
        ("torus.ply", "torus.ply", 2),
        ("torus.ply", "no/such/folder", 1),
        ("missing.ply", "out", 1),
    ] {
        fails(at, &["tile", scene, "-o", folder], code);
    }
    assert!(!at.join("out").exists());
    fails(at, &["tile", "torus.ply"], 2);
    // A block that is changed or cut.
    let file = at.join("tiled/torus/blocks");
    let mut bytes = fs::read(&file).unwrap();
    let last = bytes.len() - 100;
    fs::write(&file, &bytes[..last]).unwrap();
    let line = fails(at, &["render", "tiled/torus", "-o", "a.exr"], 1);
    assert!(line.contains("truncated") && line.contains("rerun `splatref tile`"), "{line}");
    bytes[last] ^= 1;
    fs::write(&file, &bytes).unwrap();
    let line = fails(at, &["render", "tiled/torus", "-o", "a.exr"], 1);
    assert!(line.contains("checksum") && line.contains("rerun `splatref tile`"), "{line}");
    assert!(!at.join("a.exr").exists());
}
