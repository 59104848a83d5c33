//! `splatref plan`: within the budget or not at all, and a command that draws it.

use super::{fails, splatref, succeeds};
use std::fs;
use std::path::Path;
use std::process::Command;

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

/// A scene file with one shape, whose candidates have fewer surfels too.
#[test]
fn a_command_may_draw_a_scene_file_with_fewer_surfels() {
    let at = tempfile::tempdir().unwrap();
    let scene = "[[model]]\nshape = \"sphere\"\ncount = 400\n[camera]\nsize = [32, 24]\n";
    fs::write(at.path().join("scene.toml"), scene).unwrap();
    let draw = |file: &str, count: &str, output: &str| {
        succeeds(at.path(), &["render", file, "--count", count, "--size", "32x24", "-o", output]);
    };
    draw("scene.toml", "100", "a.exr");
    draw("sphere", "100", "b.exr");
    let equal = succeeds(at.path(), &["compare", "a.exr", "b.exr"]);
    assert!(equal.contains("bit for bit"), "{equal}");
    let two = format!("{scene}[[model]]\nshape = \"torus\"\n");
    fs::write(at.path().join("two.toml"), two).unwrap();
    let complaint = fails(at.path(), &["render", "two.toml", "--count", "9"], 2);
    assert!(complaint.contains("whose one model is such a shape"), "{complaint}");
}

/// Scenes of many kinds, each with a budget that picks another candidate.
#[test]
fn every_planned_command_draws_what_the_planned_file_draws() {
    let at = tempfile::tempdir().unwrap();
    let ball = concat!(env!("CARGO_MANIFEST_DIR"), "/golden/ball.ply");
    let shape = "[[model]]\nshape = \"cluster\"\ncount = 150\n[camera]\nsize = [32, 24]\n";
    let grouped = "[groups]\noverlap = 0.5\n[method]\nname = \"single-pass\"\ncutoff = 1.5\n";
    let files = [
        ("shape.toml", shape.to_owned()),
        ("grouped.toml", format!("{shape}{grouped}")),
        ("opacity.toml", shape.replace("count", "opacity = 0.5\nmipmaps = 2\ncount")),
        ("-dash it's.toml", shape.to_owned()),
        ("ball.toml", format!("[[model]]\nfile = {ball:?}\n[camera]\nsize = [32, 24]\n")),
    ];
    for (name, text) in &files {
        fs::write(at.path().join(name), text).unwrap();
    }
    let scenes: [&[&str]; 6] = [
        &["shape.toml", "--error", "9"],
        &["grouped.toml", "--time", "1000s"],
        &["grouped.toml", "--error", "9", "--outline=raycast"],
        &["opacity.toml", "--error", "9", "--count", "99"],
        &["--error=9", "-oplan.toml", "--", "-dash it's.toml"],
        &["ball.toml", "--time", "1000s", "--environment", "sky"],
    ];
    for scene in scenes {
        let output: &[&str] = if scene.contains(&"--") { &[] } else { &["-o", "plan.toml"] };
        let said = succeeds(at.path(), &[&["plan"], output, scene].concat());
        let command = line(&said, "command ").strip_prefix("splatref").unwrap();
        // As a shell reads the words.
        let program = env!("CARGO_BIN_EXE_splatref");
        let shell = format!("{program} {command} -o a.exr");
        let run = Command::new("sh").args(["-c", &shell]).current_dir(at.path()).output().unwrap();
        assert!(run.status.success(), "{command}: {}", String::from_utf8_lossy(&run.stderr));
        succeeds(at.path(), &["render", "plan.toml", "-o", "b.exr"]);
        let equal = succeeds(at.path(), &["compare", "a.exr", "b.exr"]);
        assert!(equal.contains("bit for bit"), "{command}: {equal}");
    }
}

/// The commands that are printed have the name so that a shell finds the file again.
#[cfg(target_os = "linux")]
#[test]
fn names_that_are_no_text_are_planned_and_replayed() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let at = tempfile::tempdir().unwrap();
    let scene = OsStr::from_bytes(b"sc\xffne 1.toml");
    let text = "[[model]]\nshape = \"sphere\"\ncount = 90\n[camera]\nsize = [16, 12]\n";
    fs::write(at.path().join(scene), text).unwrap();
    let run = |before: &[&str], after: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_splatref"));
        let command = command.args(before).arg(scene).args(after).current_dir(at.path());
        let output = command.output().unwrap();
        assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    let said = run(&["plan"], &["--error", "9"]);
    let planned = line(&said, "command ").to_owned();
    assert!(planned.contains(r"render $'sc\377ne 1.toml' "), "{planned}");
    run(&["render"], &["-o", "a.exr"]);
    let said = run(&["verify"], &["a.exr", "--low-pass", "1"]);
    let replay = line(&said, "replay ").to_owned();
    assert!(replay.contains(r"explain $'sc\377ne 1.toml' "), "{replay}");
    // Not every `sh` reads such words, but bash does.
    for command in [planned + " -o b.exr", replay] {
        let command = command.replacen("splatref", env!("CARGO_BIN_EXE_splatref"), 1);
        let Ok(run) = Command::new("bash").args(["-c", &command]).current_dir(at.path()).output()
        else {
            return;
        };
        assert!(run.status.success(), "{command}: {}", String::from_utf8_lossy(&run.stderr));
    }
}
