//! `splatref plan`: within the budget or not at all, and a command that draws it.

use super::{fails, splatref, succeeds};
use std::fs;
use std::path::Path;

const SCENE: [&str; 7] = ["plan", "torus", "--count", "600", "--size", "64x48", "--metric"];

fn plan(at: &Path, metric: &str, budget: [&str; 2]) -> String {
    succeeds(at, &[&SCENE[..], &[metric], &budget, &["--method", "template"]].concat())
}

/// The line of a label.
fn line<'s>(said: &'s str, label: &str) -> &'s str {
    said.lines()
        .find_map(|line| line.strip_prefix(label))
        .unwrap_or_else(|| panic!("{said}"))
        .trim()
}

/// The error at the end of a line.
fn error(line: &str) -> f64 {
    line.rsplit(' ').next().unwrap().parse().unwrap()
}

#[test]
fn what_is_planned_is_within_the_budget_and_can_be_drawn() {
    let at = tempfile::tempdir().unwrap();
    let all = plan(at.path(), "rmse", ["--error", "9"]);
    assert!(all.contains("the exact surface"), "{all}");
    let best = error(line(&plan(at.path(), "rmse", ["--time", "1000s"]), "plan "));
    let tight = format!("{}", best * 1.0001);
    let written = ["--metric", "rmse", "--error", &tight, "-o", "best.toml"];
    let said =
        succeeds(at.path(), &[&SCENE[..6], &["--method", "template"], &written[..]].concat());
    assert!(error(line(&said, "plan ")) <= best * 1.0001, "{said}");
    let command = line(&said, "command ").strip_prefix("splatref ").unwrap();
    let words: Vec<&str> = command.split(' ').collect();
    assert_eq!(words[..6], ["render", "torus", "--count", "600", "--size", "64x48"]);
    assert_eq!(words[6..8], ["--method", "template"]);
    succeeds(at.path(), &[&words[..], &["-o", "a.exr"]].concat());
    // The scene file draws the same.
    assert_eq!(line(&said, "wrote "), "best.toml");
    succeeds(at.path(), &["render", "best.toml", "-o", "b.exr"]);
    let equal = succeeds(at.path(), &["compare", "a.exr", "b.exr"]);
    assert!(equal.contains("bit for bit"), "{equal}");
    // SSIM as what is missing to 1.
    let similar = plan(at.path(), "ssim", ["--error", "0.999"]);
    assert!(error(line(&similar, "plan ")) <= 0.999, "{similar}");
}

/// What the plan replaces, or what means nothing to its method, is not in the command.
#[test]
fn the_command_draws_what_the_scene_file_draws() {
    let at = tempfile::tempdir().unwrap();
    let all: [&[&str]; 3] = [
        &["--cutoff", "1.5", "--cull=off", "--error", "9"],
        &["--cutoff", "1.5", "--time", "1000s"],
        &["--method", "single-pass", "--overlap", "0.5", "--error", "9"],
    ];
    for own in all {
        let said =
            succeeds(at.path(), &[&SCENE[..], &["rmse"], own, &["-o", "best.toml"]].concat());
        let command = line(&said, "command ").strip_prefix("splatref ").unwrap();
        let words: Vec<&str> = command.split(' ').collect();
        succeeds(at.path(), &[&words[..], &["-o", "a.exr"]].concat());
        succeeds(at.path(), &["render", "best.toml", "-o", "b.exr"]);
        let equal = succeeds(at.path(), &["compare", "a.exr", "b.exr"]);
        assert!(equal.contains("bit for bit"), "{command}: {equal}");
    }
}

#[test]
fn what_nothing_meets_is_said() {
    let at = tempfile::tempdir().unwrap();
    const NOTHING: [&str; 7] = ["rmse", "--error", "0", "--method", "blue", "-o", "best.toml"];
    let out = splatref(at.path(), &[&SCENE[..], &NOTHING].concat());
    let said = String::from_utf8(out.stdout).unwrap();
    assert_eq!(out.status.code(), Some(1));
    assert!(!at.path().join("best.toml").exists());
    assert!(
        said.contains("no candidate is within an error of 0; the nearest is --method blue"),
        "{said}"
    );
    for budget in
        [&["--error", "-1"][..], &["--error", "x"], &["--time", "20"], &["--time", "0ms"], &[]]
    {
        fails(at.path(), &[&["plan", "torus"], budget].concat(), 2);
    }
    fails(at.path(), &["plan", "torus", "--error", "1", "--time", "20ms"], 2);
    let flicker = ["plan", "torus", "--error", "1", "--metric", "flicker-path"];
    assert!(fails(at.path(), &flicker, 2).contains("measured on sequences"));
    fails(at.path(), &["plan", "nowhere.ply", "--error", "1"], 1);
    let model = "[[model]]\nshape = \"sphere\"\n";
    fs::write(at.path().join("own.toml"), model).unwrap();
    let own = ["plan", "own.toml", "--error", "1", "-o", "own.toml"];
    assert!(fails(at.path(), &own, 2).contains("own.toml"));
    assert_eq!(fs::read_to_string(at.path().join("own.toml")).unwrap(), model);
    fails(at.path(), &["plan", "torus", "--error", "1", "-o", "best.exr"], 2);
    fails(at.path(), &["plan", "torus", "--error", "1", "-o", "nowhere/best.toml"], 1);
}
