//! Check that the bytes are the same in any order, and after any interruption.

use super::*;
use proptest::prelude::*;
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};

#[test]
fn threads_and_the_order_of_subtrees_change_nothing() {
    let at = given();
    for traversal in [Traversal::BottomUp, Traversal::TopDown] {
        let settings = quick(traversal);
        make(&at, "scene.toml", "all", &settings).unwrap();
        let all = bytes(&at.path().join("all"));
        let file = SceneFile::open(at.path().join("scene.toml")).unwrap();
        for (number, threads) in [1, 3].into_iter().enumerate() {
            let folder = at.path().join(format!("{traversal:?}{number}"));
            let exec = Exec::new(threads, 16).unwrap();
            let scene = file.to_approximate(&settings, &exec, &quiet).unwrap();
            let mut work = Work::begin(scene, &folder, &settings, &exec, &quiet).unwrap();
            let count = work.wanted.len() as u32;
            // Once from the top; once from the middle.
            for i in 0..count {
                let node = if number == 0 { i } else { (i * 7 + count / 2) % count };
                work.make(node).unwrap();
            }
            for node in 0..count {
                work.make(node).unwrap();
            }
            work.finish().unwrap();
            assert!(bytes(&folder) == all, "{traversal:?} {number}");
        }
        fs::remove_dir_all(at.path().join("all")).unwrap();
    }
}

#[test]
fn what_was_stopped_goes_on() {
    let at = given();
    let settings = quick(Traversal::BottomUp);
    make(&at, "scene.toml", "all", &settings).unwrap();
    let all = bytes(&at.path().join("all"));
    let file = SceneFile::open(at.path().join("scene.toml")).unwrap();
    let folder = at.path().join("stopped");
    let mut left = Vec::new();
    for stop in [1, 4, 8, 14] {
        let calls = Cell::new(0);
        let exec = Exec::sequential();
        let progress = |_: &str, _, _| {
            calls.set(calls.get() + 1);
            assert!(calls.get() < stop, "stopped");
        };
        let run = || file.approximate(&folder, &settings, &exec, &progress);
        let ended = catch_unwind(AssertUnwindSafe(run));
        assert!(ended.is_err(), "it was stopped after {stop}");
        let found = bytes(&folder);
        assert!(!found.contains_key("index"));
        assert!(found.iter().all(|(name, bytes)| all[name] == *bytes), "what is there is whole");
        let line = Hierarchy::open(&folder).unwrap_err().to_string();
        assert!(line.contains("incomplete"), "{line}");
        left.push(found.len());
    }
    assert!(left.is_sorted() && left[0] < left[3], "{left:?}");
    let built = file.approximate(&folder, &settings, &Exec::sequential(), &quiet).unwrap();
    assert!(built.found > 0 && built.found < built.nodes, "{built:?}");
    assert!(bytes(&folder) == all);
    let again = file.approximate(&folder, &settings, &Exec::sequential(), &quiet).unwrap();
    assert_eq!(again.found, again.nodes, "nothing is left to do");
    assert!(bytes(&folder) == all);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// In a complete folder, some files are removed, and some are cut.
    #[test]
    fn what_is_missing_or_cut_is_made_again(fates in prop::collection::vec(0_u8..4, 40)) {
        let at = TempDir::new().unwrap();
        ply::write(&at.path().join("mesh.ply"), &sphere(75, false)).unwrap();
        let settings = Settings { most: 60, side: 256, ..Settings::default() };
        make(&at, "mesh.ply", "out", &settings).unwrap();
        let folder = at.path().join("out");
        let all = bytes(&folder);
        for ((name, bytes), fate) in all.iter().filter(|(name, _)| *name != "plan").zip(fates) {
            match fate {
                0 => fs::remove_file(folder.join(name)).unwrap(),
                1 => fs::write(folder.join(name), &bytes[..bytes.len() / 2]).unwrap(),
                _ => {}
            }
        }
        make(&at, "mesh.ply", "out", &settings).unwrap();
        prop_assert!(bytes(&folder) == all);
    }
}

#[test]
fn another_hierarchy_is_not_mixed_in() {
    let at = given();
    let settings = quick(Traversal::BottomUp);
    make(&at, "scene.toml", "out", &settings).unwrap();
    let all = bytes(&at.path().join("out"));
    for other in [
        Settings { seed: 1, ..settings.clone() },
        Settings { most: 701, ..settings.clone() },
        Settings { side: 400, ..settings.clone() },
        quick(Traversal::TopDown),
    ] {
        let line = make(&at, "scene.toml", "out", &other).unwrap_err().to_string();
        assert!(line.contains("a hierarchy of other settings"), "{line}");
    }
    let line = make(&at, "mesh.ply", "out", &settings).unwrap_err().to_string();
    assert!(
        line.contains("a hierarchy of other settings, other objects or another version"),
        "{line}"
    );
    let mut mesh = sphere(80, true);
    mesh.position[7].x += 1e-3;
    ply::write(&at.path().join("mesh.ply"), &mesh).unwrap();
    let line = make(&at, "scene.toml", "out", &settings).unwrap_err().to_string();
    assert!(line.contains("a hierarchy of another geometry"), "{line}");
    assert!(bytes(&at.path().join("out")) == all, "and all of it stays");
    fs::create_dir(at.path().join("mine")).unwrap();
    fs::write(at.path().join("mine/letter"), "dear").unwrap();
    let line = make(&at, "mesh.ply", "mine", &settings).unwrap_err().to_string();
    assert!(line.contains("holds other files"), "{line}");
}
