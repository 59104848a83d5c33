//! `splatref group`, and rendering what it wrote.

use super::*;
use splatref::io::ply;
use tempfile::TempDir;

#[test]
fn a_scene_is_divided_into_a_ply() {
    let at = TempDir::new().unwrap();
    let said = succeeds(at.path(), &["group", "sphere", "--count", "3000", "-o", "a.ply"]);
    let cloud = ply::read(&at.path().join("a.ply")).unwrap();
    let groups = cloud.groups.unwrap();
    assert_eq!(groups.own().len(), 3000);
    for word in [&format!("groups     {} at c = 1\n", groups.len()), "on the average", "time"] {
        assert!(said.contains(word), "{word} in {said}");
    }
    let mut sizes = vec![0; groups.len()];
    groups.own().iter().for_each(|&g| sizes[usize::from(g)] += 1);
    let sizes: Vec<String> = sizes.iter().map(|size: &i32| size.to_string()).collect();
    assert!(said.contains(&format!("surfels  {}\n", sizes.join(" "))), "{said}");
    // Every disc keeps clear of the others of its group.
    let (position, radius) = (cloud.position, cloud.radius.unwrap());
    for i in (0..3000).step_by(7) {
        for j in (0..3000).filter(|&j| j != i && groups.own()[j] == groups.own()[i]) {
            let distance = position[i].as_dvec3().distance(position[j].as_dvec3());
            assert!(distance >= f64::from(radius[i]) + f64::from(radius[j]), "{i} and {j}");
        }
    }
    let said = succeeds(at.path(), &["info", "a.ply"]);
    assert!(said.contains("has        normals, radii, colours, groups"), "{said}");
}

#[test]
fn groups_are_counted_and_extended() {
    let at = TempDir::new().unwrap();
    let group = |more: &[&str]| {
        let said = [&["group", "torus", "--count", "4000", "-o", "a.ply"], more].concat();
        let said = succeeds(at.path(), &said);
        (said, ply::read(&at.path().join("a.ply")).unwrap().groups.unwrap())
    };
    let (said, four) = group(&["--groups", "4"]);
    assert!(four.len() <= 4 && !said.contains("at c = 1\n"), "{said}");
    let (said, added) = group(&["--groups", "4", "--extend", "add", "--most", "0.3"]);
    assert_eq!(added.own(), four.own());
    assert!(!added.added().is_empty());
    let percent = added.added().len() as f64 / 40.0;
    let word = format!("added    {} surfels, {percent:.1} %", added.added().len());
    assert!(said.contains(&word), "{word} in {said}");
    let (said, enlarged) = group(&["--groups", "4", "--extend", "enlarge", "--threads", "2"]);
    assert_eq!((enlarged.own(), enlarged.added().len()), (four.own(), 0));
    assert!(enlarged.scale().iter().all(|&s| s >= 1.0) && enlarged.scale() != [1.0; 4]);
    assert!(said.contains("radii times") && said.contains("covers"), "{said}");
    let (_, all) = group(&["--coplanar", "0,1,inf", "--opposite"]);
    assert_eq!(all.len(), 1, "nothing conflicts");
}

#[test]
fn groups_of_a_file_are_drawn() {
    let at = TempDir::new().unwrap();
    let options = ["--overlap", "0.4", "--opposite", "-o", "a.ply"];
    succeeds(at.path(), &[&["group", "cluster", "--count", "500"], &options[..]].concat());
    let draw = |more: &[&str]| {
        let scene = ["render", "a.ply", "--method", "single-pass", "--size", "32x24"];
        succeeds(at.path(), &[&scene[..], more].concat())
    };
    let said = draw(&["-o", "a.exr"]);
    assert!(said.contains("from the file"), "{said}");
    let said = draw(&["-o", "b.exr", "--overlap", "0.4"]);
    assert!(said.contains("at c = 0.4"), "{said}");
    succeeds(at.path(), &["compare", "a.exr", "b.exr"]);
}

#[test]
fn groups_that_cannot_be_are_refused() {
    let at = TempDir::new().unwrap();
    let group = |more: &[&str], code| {
        let shape = ["group", "sphere", "--count", "300", "-o", "a.ply"];
        fails(at.path(), &[&shape[..], more].concat(), code)
    };
    for (more, what) in [
        (&["--overlap", "1.5"] as &[&str], "c = 1.5; give 0 to 1"),
        (&["--overlap", "-0.1"], "c = -0.1; give 0 to 1"),
        (&["--overlap", "nan"], "give 0 to 1"),
        (&["--groups", "0"], "0 groups; give 1 to 64"),
        (&["--groups", "65"], "65 groups; give 1 to 64"),
        (&["--coplanar", "2,0,0"], "cosine 2"),
        (&["--extend", "add", "--most", "2"], "most: 2; give 0 to 1"),
    ] {
        let line = group(more, 1);
        assert!(line.contains(what), "{line}");
    }
    for more in [&["--coplanar", "1,2"] as &[&str], &["--extend", "twice"], &["--most", "0.5"]] {
        group(more, 2);
    }
    fails(at.path(), &["group", "sphere"], 2);
    fails(at.path(), &["group", "sphere", "-o", "a.exr"], 2);
    fails(at.path(), &["group", "sphere", "--count", "9", "-o", "missing/a.ply"], 1);
    fails(at.path(), &["group", "missing.ply", "-o", "a.ply"], 1);
    let heap = "0 0 0 0 0 1 1\n".repeat(70);
    let vertex =
        ["x", "y", "z", "nx", "ny", "nz", "radius"].map(|p| format!("property float {p}\n"));
    let header = format!("ply\nformat ascii 1.0\nelement vertex 70\n{}", vertex.concat());
    fs::write(at.path().join("heap.ply"), format!("{header}end_header\n{heap}")).unwrap();
    let line = fails(at.path(), &["group", "heap.ply", "-o", "a.ply"], 1);
    assert!(line.contains("c = 1 needs 70 groups") && line.contains("lower c"), "{line}");
    assert_eq!(names(at.path()), ["heap.ply"]);
}
