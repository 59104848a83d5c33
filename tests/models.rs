//! Tests on real scans, if they are there: `SPLATREF_MODELS`, or `../shared/models`.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use splatref::frame::Exec;
use splatref::io::ply;
use splatref::scene::{Cloud, Dropped};
use splatref::source::derive::{Derive, Origin, surfels};
use splatref::source::sampler::{Greedy, Start};
use std::path::PathBuf;

/// The clouds of the models, with the counts of vertices and triangles that their source states.
fn models() -> Vec<(&'static str, usize, usize, Cloud)> {
    let known = [
        ("bunny", 34_834, 69_451),
        ("dragon", 50_002, 100_000),
        ("armadillo", 15_002, 30_000),
        ("igea", 134_345, 268_686),
        ("koala", 10_002, 20_000),
        ("fandisk", 6_475, 12_946),
    ];
    let directory = std::env::var_os("SPLATREF_MODELS")
        .map_or_else(|| PathBuf::from("../shared/models"), PathBuf::from);
    let mut found = Vec::new();
    for (name, vertices, triangles) in known {
        let path = directory.join(name).with_extension("ply");
        if path.exists() {
            found.push((name, vertices, triangles, ply::read(&path).unwrap()));
        } else {
            println!("skipped: there is no {}; set SPLATREF_MODELS", path.display());
        }
    }
    found
}

#[test]
fn models_have_the_counts_that_their_source_states() {
    for (name, vertices, triangles, cloud) in models() {
        assert_eq!((cloud.position.len(), cloud.triangles.len()), (vertices, triangles), "{name}");
        assert_eq!(cloud.color.is_some(), name == "koala", "{name}");
        let (surfels, derived) =
            surfels(cloud, &Derive::default(), &Exec::sequential(), &|_, _, _| ()).unwrap();
        assert_eq!((derived.normals, derived.radii), (Origin::File, Origin::Triangles), "{name}");
        // One normal of the dragon is the rounding error of a sum that cancelled, 1.5e-31 long.
        let dropped = Dropped { normal: u64::from(name == "dragon"), ..Dropped::default() };
        assert_eq!(derived.dropped, dropped, "{name}");
        assert_eq!((surfels.len() as u64) + dropped.total(), vertices as u64, "{name}");
    }
}

#[test]
fn derived_normals_agree_with_those_of_the_scans() {
    for (name, _, _, cloud) in models() {
        let truth = cloud.normal.clone().unwrap();
        let bare = Cloud { normal: None, color: None, ..cloud };
        let points = Cloud { triangles: Vec::new(), ..bare.clone() };
        // Cosine and share of the vertices. The files weight triangles by angle and not by area,
        // and planes through 17 points round the features off.
        for (cloud, cosine, share) in [(bare, 0.9, 0.99), (points, 0.5, 0.9)] {
            let position = cloud.position.clone();
            let (surfels, derived) =
                surfels(cloud, &Derive::default(), &Exec::sequential(), &|_, _, _| ()).unwrap();
            assert!(derived.dropped.total() <= 1, "one vertex of the dragon has no area around it");
            // Surfels are in the order of the vertices; a dropped vertex is passed over.
            let (mut next, mut close) = (0, 0);
            for (position, truth) in position.iter().zip(&truth) {
                if surfels.position().get(next) == Some(position) {
                    close += usize::from(surfels.normal()[next].dot(*truth) > cosine);
                    next += 1;
                }
            }
            assert_eq!(next, surfels.len(), "{name}");
            let part = close as f64 / truth.len() as f64;
            println!("{name}: {:?} {part}", derived.normals);
            assert!(part > share, "{name}: {:?} {part}", derived.normals);
        }
    }
}

#[test]
fn the_greedy_order_of_a_scan_is_that_of_the_definition() {
    for (name, vertices, _, cloud) in models() {
        // Every pick of the definition looks at all points.
        let count = if vertices < 7000 { vertices } else { 300 };
        let greedy = Greedy { start: Start::Seed(1) };
        let exec = Exec::new(2, 32).unwrap();
        let order = greedy.order(&cloud.position, count, &exec, &|_, _, _| ()).unwrap();
        assert_eq!(order, greedy.define(&cloud.position, count).unwrap(), "{name}");
    }
}
