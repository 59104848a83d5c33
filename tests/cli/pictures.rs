//! `splatref render`.

use super::*;
use tempfile::TempDir;

#[test]
fn without_arguments_a_picture_is_made() {
    let at = TempDir::new().unwrap();
    let said = succeeds(at.path(), &["render"]);
    assert_eq!(names(at.path()), ["out"]);
    assert_eq!(names(&at.path().join("out")), ["cluster.exr", "cluster.png"]);
    for word in ["200000 surfels", "perspective", "1024 x 768", "ewa", "visibility", "total"] {
        assert!(said.contains(word), "{word} in {said}");
    }
    let image = exr::read(&at.path().join("out/cluster.exr")).unwrap();
    let covered = floats(&image, "A").iter().filter(|&&a| a == 1.0).count();
    let share = covered as f64 / (1024.0 * 768.0);
    assert!((0.1..0.9).contains(&share), "the scene fills a good part of the picture: {share}");
    let png = image::open(at.path().join("out/cluster.png")).unwrap();
    assert_eq!((png.width(), png.height()), (1024, 768));
}

#[test]
fn the_bits_do_not_depend_on_threads_tiles_or_the_path() {
    let at = TempDir::new().unwrap();
    let outline = ["--outline", "raycast"];
    succeeds(at.path(), &[&small(&["-o", "a.exr", "--threads", "1"])[..], &outline].concat());
    let other = ["-o", "b.exr", "--threads", "3", "--tile", "8", "--repeat", "2"];
    let said = succeeds(at.path(), &[&small(&other)[..], &outline].concat());
    assert!(said.contains("minimum and median of 2"), "{said}");
    assert_eq!(names(at.path()), ["a.exr", "a.png", "b.exr", "b.png"]);
    let [a, b] = ["a.exr", "b.exr"].map(|name| fs::read(at.path().join(name)).unwrap());
    assert_eq!(a, b, "the whole file, its text included");
}

#[test]
fn stages_and_f64_change_planes_and_numbers() {
    let at = TempDir::new().unwrap();
    succeeds(at.path(), &small(&["-o", "fast.exr"]));
    succeeds(at.path(), &small(&["-o", "plain.exr", "--stages"]));
    succeeds(at.path(), &small(&["-o", "truth.exr", "--number", "f64"]));
    let read = |name: &str| exr::read(&at.path().join(name)).unwrap();
    let (fast, plain, truth) = (read("fast.exr"), read("plain.exr"), read("truth.exr"));
    for name in ["R", "G", "B", "A", "Z", "normal.X", "weight"] {
        assert_eq!(floats(&fast, name), floats(&plain, name), "{name}");
    }
    assert!(fast.channel("margin").is_none() && plain.channel("margin").is_some());
    assert_eq!(fast.text, plain.text);
    assert_ne!(floats(&fast, "Z"), floats(&truth, "Z"), "rounded differently");
    assert!(truth.text.unwrap().contains("number = \"f64\""));
}

#[test]
fn negative_coordinates_are_numbers_not_options() {
    let at = TempDir::new().unwrap();
    let camera = ["--eye", "-1,-2,-3.5", "--target", "-0.5,0,0", "--up", "0,0,-1", "--fov", "20"];
    let said = succeeds(at.path(), &small(&camera));
    assert!(said.contains("at (-1, -2, -3.5)"), "{said}");
    succeeds(at.path(), &small(&["--ortho", "3", "--epsilon", "inf", "--cull=off"]));
    succeeds(at.path(), &small(&["--focal", "40", "--epsilon", "1.5r", "--kernel", "zpvbg01"]));
}

#[test]
fn the_widest_picture_is_made() {
    let at = TempDir::new().unwrap();
    succeeds(at.path(), &["render", "sphere", "--count", "300", "--size", "65536x1"]);
    let header = exr::read_header(&at.path().join("out/sphere.exr")).unwrap();
    assert_eq!((header.width, header.height), (65536, 1));
}

#[test]
fn options_replace_what_a_scene_file_says() {
    let at = TempDir::new().unwrap();
    let scene = "[[model]]\nshape = \"sphere\"\ncount = 100\n[camera]\nsize = [20, 10]\nfov = 30\n\
                 [method]\nkernel = \"zpvbg01\"\noutline = \"raycast\"\ncutoff = 3\n\
                 [output]\nnumber = \"f64\"\nstages = true\n";
    fs::write(at.path().join("s.toml"), scene).unwrap();
    let said = succeeds(at.path(), &["render", "s.toml"]);
    for word in
        ["20 x 10 pixels, f64", "outline = raycast, cutoff = 3, low_pass = 1,", "every stage"]
    {
        assert!(said.contains(word), "{word} in {said}");
    }
    let more = ["--size", "12x8", "--ortho", "4", "--kernel", "default", "--number", "f32"];
    let said = succeeds(at.path(), &[&["render", "s.toml"], &more[..]].concat());
    for word in
        ["12 x 8 pixels, f32", "outline = affine, cutoff = 2, low_pass = 0.25,", "orthographic"]
    {
        assert!(said.contains(word), "{word} in {said}");
    }
    assert_eq!(names(&at.path().join("out")), ["s.exr", "s.png"]);
}

#[test]
fn every_method_draws_and_leaves_its_planes() {
    let at = TempDir::new().unwrap();
    for (method, planes) in [
        ("ewa", &["visibility.Z", "margin"] as &[&str]),
        ("single-pass", &["group00.Z", "group00.voronoi", "sums.count"]),
        ("transparent", &["blended.group00.bin", "blended.A", "layers"]),
        ("transparent-hq", &["nearest.mask", "nearest.group00.weight", "blended.A", "l"]),
        ("peeling", &["layer1.Z", "layer2.A", "layers"]),
        ("blue", &["discs.offset", "normal.X", "id"]),
    ] {
        let more = ["--method", method, "--opacity", "0.5", "--stages", "-o", "a.exr"];
        let said = succeeds(at.path(), &small(&more));
        assert!(said.contains(&format!("method     {method},")), "{said}");
        let image = exr::read(&at.path().join("a.exr")).unwrap();
        for plane in planes {
            assert!(image.channel(plane).is_some(), "{method} has no {plane}");
        }
        let text = image.text.unwrap();
        assert!(text.contains(&format!("name = \"{method}\"")), "{text}");
        let bins = text.contains("bins_in_world_units = [");
        assert_eq!(bins, said.contains("bins = "), "{text}");
        assert_eq!(text.contains("[groups]"), said.contains("groups  "), "{text}");
    }
}

#[test]
fn another_method_forgets_what_the_file_says_of_its_own() {
    let at = TempDir::new().unwrap();
    let scene = "[[model]]\nshape = \"sphere\"\ncount = 100\nopacity = 0.5\n\
                 [camera]\nsize = [20, 10]\n[environment]\nsky = true\n\
                 [method]\nname = \"transparent-hq\"\nbins = 32\nrefraction = [0.7, 0.7, 0.7]\n\
                 [groups]\ncount = 2\n";
    fs::write(at.path().join("s.toml"), scene).unwrap();
    let said = succeeds(at.path(), &["render", "s.toml"]);
    assert!(said.contains("bins = 32") && said.contains("groups     2 "), "{said}");
    let said = succeeds(at.path(), &["render", "s.toml", "--method", "transparent"]);
    assert!(said.contains("bins = 32") && !said.contains("refraction"), "{said}");
    succeeds(at.path(), &["render", "s.toml", "--method", "ewa"]);
    let image = exr::read(&at.path().join("out/s.exr")).unwrap();
    assert!(floats(&image, "A").iter().all(|&a| a == 1.0), "the sky is behind every method");
}

#[test]
fn pictures_are_stored_in_few_digits() {
    let at = TempDir::new().unwrap();
    succeeds(at.path(), &small(&["-o", "whole.exr", "--stages"]));
    let how = ["-o", "half.exr", "--stages", "--storage", "f16", "--depth-storage", "unorm16"];
    let said = succeeds(at.path(), &small(&how));
    assert!(said.contains("f32, stored as f16, depths unorm16, with the planes"), "{said}");
    let [whole, half] =
        ["whole.exr", "half.exr"].map(|name| exr::read(&at.path().join(name)).unwrap());
    let [whole, half] = [&whole, &half].map(|image| floats(image, "attributes.weight").to_vec());
    assert_ne!(whole, half);
    assert!(half.iter().all(|w| (w * 16_777_216.0).fract() == 0.0), "half floats");
    for command in ["explain", "project"] {
        let more = if command == "explain" { &["3", "4"][..] } else { &["-o", "a.bin"] };
        let all = [&[command, "sphere"][..], more, &["--count", "100", "--storage", "f16"]];
        assert!(fails(at.path(), &all.concat(), 2).contains("give --storage f32"));
    }
    let both = ["-o", "a.exr", "--storage", "f16", "--number", "f64"];
    assert!(fails(at.path(), &small(&both), 1).contains("storage formats need f32"));
    assert_eq!(names(at.path()), ["half.exr", "half.png", "whole.exr", "whole.png"]);
}
