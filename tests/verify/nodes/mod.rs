//! The golden `bjfm19_nodes`: a hierarchy whose choices lie close to their limits, and clients that
//! make these choices.
//!
//! - [`folder`]: the content of the folder, byte by byte.
//! - [`choice`]: a client's choice of nodes, of prefixes, and of sizes, and its bugs.
//!
//! Every surfel has pixels of its own, and so has the triangle. So the picture shows for each
//! whether it is drawn.

mod choice;
mod folder;

use choice::{BUGS, Way};
use folder::{SIZE, STEP, nodes};
use splatref::frame::Exec;
use splatref::io::hierarchy::Hierarchy;
use splatref::io::scene_file::{Ready, SceneFile};
use splatref::method::Session;
use splatref::verdict::client::{Client, Rounding};
use splatref::verdict::{Outcome, Verdict};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

fn golden(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("golden").join(name)
}

fn ready() -> Ready {
    let file = SceneFile::open(golden("bjfm19_nodes.toml")).unwrap();
    file.ready(&Exec::sequential(), &|_, _, _| ()).unwrap()
}

fn hierarchy() -> Hierarchy {
    Hierarchy::open(&golden("nodes")).unwrap()
}

/// The verdict on what a client draws in its way.
fn judged(ready: &Ready, way: Way, promise: Rounding) -> Verdict {
    let exec = Exec::sequential();
    let scene = &ready.loaded.scene;
    let other = way.scene(&hierarchy(), SIZE, scene);
    let drawn = Session::new(&other, ready.method, &exec).unwrap();
    let frame = drawn.define::<f32>(&ready.camera, true).unwrap().frame;
    let mut client = Client::from(&frame);
    client.rounding = promise;
    let session = Session::new(scene, ready.method, &exec).unwrap();
    session.verify(&ready.camera, &client, 0.02).unwrap()
}

/// Where they differ, what should be there is left for a person to look at.
#[test]
fn the_folder_is_what_is_written_here() {
    let expected = folder::files();
    let found: BTreeMap<String, Vec<u8>> = fs::read_dir(golden("nodes"))
        .map(|entries| entries.map(|entry| entry.unwrap().path()).collect())
        .unwrap_or_else(|_| Vec::new())
        .into_iter()
        .map(|path| {
            (path.file_name().unwrap().to_str().unwrap().to_owned(), fs::read(&path).unwrap())
        })
        .collect();
    if found != expected {
        let out = Path::new(env!("CARGO_MANIFEST_DIR")).join("out/golden/nodes");
        fs::create_dir_all(&out).unwrap();
        expected.iter().for_each(|(name, bytes)| fs::write(out.join(name), bytes).unwrap());
        panic!("golden/nodes is not what is written here: see {}", out.display());
    }
}

/// The numbers of the list are those of the choice, on both sides of each limit and about as far from it as they say.
#[test]
fn choices_are_beside_their_limits() {
    let hierarchy = hierarchy();
    let drawn = Way::Plain.choose(&hierarchy, SIZE);
    let turned =
        [0.25, -0.25, 1.0, -1.0].map(|steps| Way::Distance(steps * STEP).choose(&hierarchy, SIZE));
    for (number, node) in (2..).zip(nodes()) {
        let name = format!("{} {}", node.name, node.sign);
        assert_eq!(drawn[number].count, node.drawn, "{name}");
        // What is asked for goes with the square of r_m.
        let [a, b, ..] = &turned;
        assert_eq!([a[number].count, b[number].count], [node.drawn; 2], "{name}");
    }
    for name in ["a prefix", "finer, there or not", "finer, growing", "it shrinks", "the fade ends"]
    {
        let pair: Vec<usize> =
            (2..).zip(nodes()).filter(|(_, node)| node.name == name).map(|(i, _)| i).collect();
        let [low, high] = pair[..] else { panic!("{name} has two sides") };
        assert_ne!(drawn[low].count, drawn[high].count, "{name}");
        let [.., up, down] = &turned;
        assert_eq!(up[low].count, drawn[high].count, "{name}");
        assert_eq!(down[high].count, drawn[low].count, "{name}");
    }
}

/// The client's scene is the crate's, and so is that of a client in `f32`.
#[test]
fn right_choices_are_right() {
    let ready = ready();
    let scene = &ready.loaded.scene;
    let plain = Way::Plain.scene(&hierarchy(), SIZE, scene);
    assert_eq!(plain.surfels.position(), scene.surfels.position());
    assert_eq!(plain.surfels.radius(), scene.surfels.radius());
    assert_eq!(plain.primitives, scene.primitives);
    assert_eq!(scene.primitives.triangles.len(), 1, "of two, one is beyond its limit");
    assert!((0..plain.surfels.len() as u32).all(|i| {
        let of = |scene: &splatref::scene::Scene| scene.sides.as_ref().and_then(|all| all.side(i));
        of(&plain) == of(scene) && of(scene).is_some()
    }));
    for way in [Way::Plain, Way::Single] {
        for promise in [Rounding::Ieee, Rounding::Gpu] {
            let verdict = judged(&ready, way, promise);
            assert_eq!(verdict.outcome(), Outcome::Right, "{way:?}, {promise:?}");
        }
    }
}

#[test]
fn wrong_choices_are_wrong() {
    let ready = ready();
    for way in BUGS {
        for promise in [Rounding::Ieee, Rounding::Gpu] {
            let verdict = judged(&ready, way, promise);
            assert_eq!(verdict.outcome(), Outcome::Wrong, "{way:?}, {promise:?}");
            assert_eq!(verdict.first_wrong().map(|one| one.stage), Some("discs"), "{way:?}");
        }
    }
    for off in [1e-5, -1e-5] {
        let verdict = judged(&ready, Way::Radius(off), Rounding::Ieee);
        assert_eq!(verdict.outcome(), Outcome::Wrong, "{off}");
    }
}
