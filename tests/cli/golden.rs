//! `splatref golden`.

use super::*;
use tempfile::TempDir;

/// A directory with two golden cases.
fn golden_cases() -> TempDir {
    let at = TempDir::new().unwrap();
    fs::create_dir(at.path().join("golden")).unwrap();
    let case = |name: &str, text: &str| {
        fs::write(at.path().join("golden").join(name), text).unwrap();
    };
    let camera = "[camera]\nsize = [16, 12]\n[output]\nstages = true\n";
    case("a.toml", &format!("[[model]]\nshape = \"sphere\"\ncount = 200\n{camera}"));
    case(
        "b.toml",
        &format!("[[model]]\nshape = \"torus\"\ncount = 200\n{camera}number = \"f64\"\n"),
    );
    at
}

/// Exit code and what was printed.
fn golden(at: &TempDir, more: &[&str]) -> (Option<i32>, String) {
    let output = splatref(at.path(), &[&["golden"], more].concat());
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    (output.status.code(), String::from_utf8(output.stdout).unwrap())
}

#[test]
fn a_blessing_is_never_silent() {
    let at = golden_cases();
    let (code, said) = golden(&at, &[]);
    assert_eq!(code, Some(1), "pictures are missing: {said}");
    assert!(said.contains("0 equal, 2 different"), "{said}");
    let (code, said) = golden(&at, &["--bless"]);
    assert_eq!(code, Some(1), "{said}");
    assert_eq!(names(&at.path().join("golden")), ["a.exr", "a.toml", "b.exr", "b.toml"]);
    let before = fs::metadata(at.path().join("golden/a.exr")).unwrap().modified().unwrap();
    let (code, said) = golden(&at, &["--bless"]);
    assert_eq!(code, Some(0), "there is nothing left to bless: {said}");
    let after = fs::metadata(at.path().join("golden/a.exr")).unwrap().modified().unwrap();
    assert_eq!(before, after, "what is equal is not rewritten");
}

#[test]
fn one_flipped_bit_in_a_golden_picture_is_found() {
    let at = golden_cases();
    golden(&at, &["--bless"]);
    let (code, said) = golden(&at, &[]);
    assert_eq!(code, Some(0), "{said}");
    let hash = said.lines().last().unwrap().to_owned();
    assert!(hash.len() == "sha256 ".len() + 64, "{hash}");
    for how in [["--threads", "1"], ["--tile", "8"]] {
        assert_eq!(golden(&at, &how), (Some(0), said.clone()), "{how:?}");
    }

    flip_a_bit(&at.path().join("golden/a.exr"));
    let (code, said) = golden(&at, &[]);
    assert_eq!(code, Some(1));
    assert!(said.contains("1 equal, 1 different") && said.contains(&hash), "{said}");
    assert!(said.contains("Z: 1 of 192 pixels differ, first (8, 6)"), "{said}");
    let kept = ["a.actual.exr", "a.actual.png", "a.expected.exr", "a.expected.png"];
    assert_eq!(names(&at.path().join("out/golden")), kept);
    // The command that it prints works.
    let scene = Path::new("golden").join("a.toml");
    let command = format!("splatref explain {} 8 6", scene.display());
    assert!(said.contains(&command), "{said}");
    succeeds(at.path(), &["explain", "golden/a.toml", "8", "6"]);

    let (code, said) = golden(&at, &["b"]);
    assert_eq!(code, Some(0), "only the other one was asked for: {said}");
    fails(at.path(), &["golden", "c"], 2);
}

#[test]
fn golden_pictures_and_scenes_come_in_pairs() {
    let at = golden_cases();
    golden(&at, &["--bless"]);
    let folder = at.path().join("golden");
    fs::remove_file(folder.join("a.toml")).unwrap();
    let (code, said) = golden(&at, &[]);
    assert_eq!(code, Some(1), "{said}");
    assert!(said.contains("1 equal, 1 different"), "{said}");
    // A damaged picture and a scene that cannot be rendered do not stop the others.
    fs::write(folder.join("a.toml"), "[[model]]\nshape = \"ball\"\n").unwrap();
    let (code, said) = golden(&at, &[]);
    assert_eq!(code, Some(1), "{said}");
    assert!(said.contains("equal      b") && said.contains("different  a"), "{said}");
    fs::write(folder.join("b.exr"), "no picture").unwrap();
    assert!(golden(&at, &[]).1.contains("0 equal, 2 different"));
    fails(at.path(), &["golden", "--dir", "missing"], 1);
    fs::create_dir(at.path().join("empty")).unwrap();
    fails(at.path(), &["golden", "--dir", "empty"], 1);
    let elsewhere = TempDir::new().unwrap();
    let dir = folder.to_str().unwrap();
    assert_eq!(splatref(elsewhere.path(), &["golden", "b", "--dir", dir]).status.code(), Some(1));
}

/// The bytes of a file, or of all files of a folder.
fn size_of(path: &Path) -> u64 {
    if !path.is_dir() {
        return fs::metadata(path).unwrap().len();
    }
    names(path).iter().map(|name| size_of(&path.join(name))).sum()
}

/// A copy of a file, or of a folder and what is in it.
fn copy_all(from: &Path, to: &Path) {
    if !from.is_dir() {
        fs::copy(from, to).unwrap();
        return;
    }
    fs::create_dir(to).unwrap();
    names(from).iter().for_each(|name| copy_all(&from.join(name), &to.join(name)));
}

/// Each committed case is tiny and can be rendered; the pictures are checked by `splatref golden`.
#[test]
fn committed_golden_cases_are_tiny() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden");
    let scenes: Vec<_> = names(&folder).into_iter().filter(|n| n.ends_with(".toml")).collect();
    assert!(scenes.len() >= 10, "{scenes:?}");
    for name in names(&folder) {
        let path = folder.join(&name);
        let length = size_of(&path);
        assert!(length <= 64 * 1024, "{name}: {length} bytes");
        if name.ends_with(".toml") {
            let file = splatref::io::scene_file::SceneFile::read(&path).unwrap();
            let loaded = file.load(&splatref::frame::Exec::sequential(), &|_, _, _| ()).unwrap();
            let camera = file.camera(&loaded.scene).unwrap();
            assert!(camera.width * camera.height <= 64 * 64, "{name}");
            assert!(loaded.scene.surfels.len() <= 1000, "{name}");
        }
    }
    // What they become when blessed must fit too.
    let at = TempDir::new().unwrap();
    let copy = at.path().join("golden");
    fs::create_dir(&copy).unwrap();
    for name in names(&folder).iter().filter(|name| !name.ends_with(".exr")) {
        copy_all(&folder.join(name), &copy.join(name));
    }
    assert_eq!(golden(&at, &["--bless"]).0, Some(1));
    for name in names(&copy) {
        let length = size_of(&copy.join(&name));
        assert!(length <= 64 * 1024, "{name}: {length} bytes");
    }
    assert_eq!(golden(&at, &[]).0, Some(0));
}
