//! `splatref quality`: the table, the charts, and what is refused.

use super::*;
use glam::Vec3;
use splatref::io::ply;
use splatref::scene::Cloud;
use tempfile::TempDir;

fn write(at: &TempDir, name: &str, position: Vec<Vec3>) {
    ply::write(&at.path().join(name), &Cloud { position, ..Cloud::default() }).unwrap();
}

/// Points of a sphere in two orders, by the program itself.
fn two_orders() -> TempDir {
    let at = TempDir::new().unwrap();
    let place = |i: u64| {
        let unit = |k| 2.0 * splatref::number::random::unit(k, i) - 1.0;
        Vec3::new(unit(1), unit(2), unit(3)).normalize()
    };
    write(&at, "in.ply", (0..1200).map(place).collect());
    for sampler in ["greedy", "random"] {
        let name = format!("{sampler}.ply");
        succeeds(at.path(), &["surfels", "in.ply", "-o", &name, "--sampler", sampler]);
    }
    at
}

#[test]
fn a_table_by_hand() {
    let at = TempDir::new().unwrap();
    let line = |all: &[f32]| all.iter().map(|x| Vec3::new(*x, 0.0, 0.0)).collect();
    write(&at, "a.ply", line(&[0.0, 4.0, 1.0, 9.0]));
    write(&at, "b.ply", line(&[0.0, 2.0, 8.0, 16.0]));
    write(&at, "all.ply", line(&[-6.0]));
    let said = succeeds(at.path(), &["quality", "a.ply", "b.ply", "--prefix", "2,4"]);
    let rows: Vec<Vec<&str>> = said.lines().map(|l| l.split_whitespace().collect()).collect();
    for row in [
        "points 4 a",
        "2 a 4 4 4 4 5",
        "2 b 2 2 2 2 14",
        "4 a 1 1 3 5 0",
        "4 b 2 2 6 8 0",
        "2 b 0.500 0.500 0.500 0.500 3.500",
        "4 a 0.500 0.500 1.500 2.500 0.000",
    ] {
        assert!(rows.contains(&row.split(' ').collect()), "{row} in {said}");
    }
    let said = succeeds(at.path(), &["quality", "a.ply", "--of", "all.ply"]);
    let row: Vec<&str> = said.lines().nth(3).unwrap().split_whitespace().collect();
    assert_eq!(row, ["4", "a", "1", "1", "3", "5", "6"], "all points, and what they cover: {said}");
}

#[test]
fn charts_are_svg_and_png_and_threads_change_nothing() {
    let at = two_orders();
    let chart = |name: &str, more: &[&str]| {
        let options = ["quality", "greedy.ply", "random.ply", "--prefix", "300,600", "-o", name];
        let said = succeeds(at.path(), &[&options[..], more].concat());
        assert!(said.contains(name), "{said}");
        (fs::read(at.path().join(name)).unwrap(), said)
    };
    let (svg, said) = chart("a.svg", &["--spectrum", "--threads", "1"]);
    assert!(said.contains("spectra:") && said.contains("relative to"), "{said}");
    let text = String::from_utf8(svg.clone()).unwrap();
    for word in [">greedy<", ">random<", ">600 points<", ">Radial power spectrum<"] {
        assert!(text.contains(word), "{word}");
    }
    assert_eq!(chart("a.svg", &["--spectrum", "--threads", "3"]).0, svg);
    assert!(!String::from_utf8(chart("b.svg", &[]).0).unwrap().contains("power"));
    let png = splatref::io::png::read(&{
        chart("c.PNG", &["--spectrum"]);
        at.path().join("c.PNG")
    });
    let size = text.split('"').nth(3).unwrap().split(' ').skip(2).collect::<Vec<_>>();
    let image = png.unwrap().image;
    let doubled = [image.width, image.height].map(|side| (side / 2).to_string());
    assert_eq!(size, doubled, "two pixels a px");
}

#[test]
fn what_has_no_quality_is_refused() {
    let at = two_orders();
    write(&at, "nan.ply", vec![Vec3::ZERO, Vec3::ONE, Vec3::NAN]);
    write(&at, "equal.ply", vec![Vec3::ONE; 3]);
    write(&at, "one.ply", vec![Vec3::ONE]);
    let triangles = vec![[0, 1, 2]];
    let mesh = Cloud { position: vec![Vec3::X, Vec3::Y, Vec3::Z], triangles, ..Cloud::default() };
    ply::write(&at.path().join("mesh.ply"), &mesh).unwrap();
    let before = names(at.path());
    for (arguments, code, what) in [
        (&[] as &[&str], 2, "FILES"),
        (&["in.ply", "--prefix", "1"], 2, "--prefix 1: one point has no distance"),
        (&["in.ply", "--prefix", "9,x"], 2, "--prefix"),
        (&["in.ply", "--prefix", "1201"], 1, "in: a prefix of 1201 of 1200 points"),
        (&["in.ply", "-o", "in.ply"], 2, "in.ply: charts are written as .svg or .png"),
        (&["in.ply", "-o", "none/a.svg"], 1, "none/a.svg"),
        (&["in.ply", "--of", "sphere"], 2, "sphere: points are read"),
        (&["in.ply", "--of", "missing.ply"], 1, "missing.ply"),
        (&["nan.ply"], 1, "nan.ply: point 2 is not finite"),
        (&["in.ply", "--of", "nan.ply"], 1, "nan.ply: point 2 is not finite"),
        (&["mesh.ply"], 1, "mesh.ply: the file has triangles"),
        (&["one.ply"], 1, "one: a prefix of 1 of 1"),
        (&["equal.ply", "-o", "a.svg"], 1, "prefix 3: every order has two points at one place"),
        (&["in.ply", "--prefix", "255", "--spectrum"], 1, "in: a spectrum of 255 points"),
        (&["equal.ply"; 7], 0, ""),
    ] {
        let all = [&["quality"], arguments].concat();
        if code == 0 {
            succeeds(at.path(), &all);
            let line = fails(at.path(), &[&all[..], &["-o", "a.svg"]].concat(), 2);
            assert!(line.contains("room for 6 files and 8 prefixes"), "{line}");
            continue;
        }
        let line = fails(at.path(), &all, code);
        assert!(line.contains(what), "{what} in {line}");
    }
    // A link by the name of a chart to what is read.
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("in.ply", at.path().join("link.svg")).unwrap();
        let line = fails(at.path(), &["quality", "in.ply", "-o", "link.svg"], 2);
        assert!(line.contains("is also an input"), "{line}");
        fs::remove_file(at.path().join("link.svg")).unwrap();
    }
    assert_eq!(names(at.path()), before, "nothing is written");
}
