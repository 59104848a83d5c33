//! Every division of every golden scene gives one file: the bytes of the whole picture's file.

use super::*;
use splatref::frame::{Exec, Rect};
use splatref::io::provenance;
use splatref::io::scene_file::{Number, OutputSettings, Ready, SceneFile, projection};
use splatref::method::{Method, Session};
use splatref::number::random::below;
use std::collections::BTreeSet;
use std::path::PathBuf;
use tempfile::TempDir;

/// The golden scenes, sorted by name.
fn goldens() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden");
    let scenes = names(&folder).into_iter().filter(|name| name.ends_with(".toml"));
    scenes.map(|name| folder.join(name)).collect()
}

/// Cuts the larger side of the largest rectangle at a random place, until there are `count`
/// rectangles of unequal sizes.
fn cut(size: [u32; 2], count: usize, seed: u64) -> Vec<Rect> {
    let mut rects = vec![Rect::of_size(size)];
    while rects.len() < count {
        let (largest, _) = rects.iter().enumerate().max_by_key(|(_, rect)| rect.pixels()).unwrap();
        let rect = rects.swap_remove(largest);
        let [width, height] = rect.size();
        let place = |side: u32| 1 + below(seed, rects.len() as u64, (side - 1).into()) as u32;
        let halves = if width > height {
            let x = rect.x0 + place(width);
            [Rect { x1: x, ..rect }, Rect { x0: x, ..rect }]
        } else {
            let y = rect.y0 + place(height);
            [Rect { y1: y, ..rect }, Rect { y0: y, ..rect }]
        };
        rects.extend(halves);
    }
    rects
}

/// Divides each side into eight.
fn eight_by_eight([width, height]: [u32; 2]) -> Vec<Rect> {
    let ends = |side: u32| (0..8).map(move |i| (side * i / 8, side * (i + 1) / 8));
    let row = |(y0, y1)| ends(width).map(move |(x0, x1)| Rect { x0, y0, x1, y1 });
    ends(height).flat_map(row).collect()
}

/// Puts values in a random order.
fn shuffle<T>(values: &mut [T], seed: u64) {
    for i in (1..values.len()).rev() {
        values.swap(i, below(seed, i as u64, i as u64 + 1) as usize);
    }
}

/// Two, seven and 64 regions of a picture, each division in a random order.
fn divisions(size: [u32; 2], seed: u64) -> [Vec<Rect>; 3] {
    let mut all = [cut(size, 2, seed), cut(size, 7, seed + 1), eight_by_eight(size)];
    all.iter_mut().for_each(|regions| shuffle(regions, seed));
    assert_eq!(all.each_ref().map(Vec::len), [2, 7, 64]);
    for regions in &all {
        let pixels: usize = regions.iter().map(Rect::pixels).sum();
        assert_eq!(pixels, Rect::of_size(size).pixels());
        assert!(regions.iter().all(|region| !region.is_empty()), "{size:?}: {regions:?}");
    }
    all
}

fn words(Rect { x0, y0, x1, y1 }: Rect) -> String {
    format!("{x0},{y0},{x1},{y1}")
}

/// Draws a region and writes it as `render --region` does.
fn write_part(
    session: &mut Session<'_>,
    ready: &Ready,
    output: OutputSettings,
    region: Rect,
    to: &Path,
) {
    let (camera, exec) = (&ready.camera, Exec::sequential());
    session.set_region(Some(region)).unwrap();
    let window = exr::Window { region: session.window(camera).unwrap(), picture: camera.size() };
    let scene = &ready.loaded.scene;
    let mut text = provenance::text(scene, session.groups(), camera, &ready.method, output);
    if session.projects(camera) {
        text = provenance::text_of_projection(&text, scene, output);
    }
    let drawn = output.draw(session, camera).unwrap();
    let compression = output.compression;
    exr::pending_part(to, &drawn.frame, window, &text, compression, &exec).unwrap().put().unwrap();
}

/// Joins parts and writes the picture as `assemble` does.
fn write_joined(parts: &[PathBuf], to: &Path) {
    let exec = Exec::sequential();
    let mut whole = exr::assemble(parts, &exec).unwrap();
    if provenance::is_projection(&whole.text) {
        (whole.frame, whole.text) = projection::finish(whole.frame, &whole.text, &exec).unwrap();
    }
    exr::pending(to, &whole.frame, &whole.text, whole.compression, &exec).unwrap().put().unwrap();
}

/// Asserts that the program does not draw this division, says why in one line, and writes nothing.
fn refused(at: &Path, scene: &[&str], more: &[&str], words: &[&str]) {
    let line = fails(at, &[&["render"], scene, more, &["-o", "none.exr"]].concat(), 2);
    assert!(words.iter().all(|word| line.contains(word)), "{words:?}: {line}");
    assert!(!names(at).iter().any(|name| name.starts_with("none")), "{line}");
}

/// A golden scene as the program and the library draw it.
struct Golden<'a> {
    /// The scene for the program, and options.
    words: Vec<&'a str>,
    ready: Ready,
    output: OutputSettings,
}

impl<'a> Golden<'a> {
    /// Reads a scene. Asserts that the program refuses what the method cannot draw; `None` if the method
    /// draws no region at all.
    fn read(at: &Path, path: &'a Path) -> (Method, Option<Self>) {
        let mut file = SceneFile::read(path).unwrap();
        let method = file.method.method().unwrap();
        let mut words = vec![path.to_str().unwrap()];
        let (region, bands) = (["--region", "0,0,5,5"], ["--bands", "2"]);
        if method.needs_whole_picture().is_some() && !method.projects_regions() {
            let why = ["because the pixels of the whole picture select the surfels"];
            refused(at, &words, &region, &why);
            refused(at, &words, &bands, &why);
            return (method, None);
        }
        if method.projects_regions() {
            refused(at, &words, &bands, &["--bands", "needs the whole picture in memory"]);
            if file.output.number == Number::F64 {
                refused(at, &words, &region, &["holds f32", "--number f32"]);
                words.extend(["--number", "f32"]);
                file.output.number = Number::F32;
            }
        }
        let ready = file.ready(&Exec::sequential(), &|_, _, _| ()).unwrap();
        (method, Some(Self { words, ready, output: file.output }))
    }

    /// Draws with the program, and returns the bytes of the file.
    fn render(&self, at: &Path, more: &[&str], to: &str) -> Vec<u8> {
        succeeds(at, &[&["render"], &self.words[..], more, &["-o", to]].concat());
        fs::read(at.join(to)).unwrap()
    }
}

/// Calls `check` with every golden scene that is drawn in regions, a folder for its files, and a
/// random seed. Asserts that every method has a scene.
fn each_golden(check: impl Fn(&Golden<'_>, &Path, u64)) {
    let mut methods = BTreeSet::new();
    for (seed, path) in (0..).zip(goldens()) {
        let at = TempDir::new().unwrap();
        let (method, golden) = Golden::read(at.path(), &path);
        methods.insert(method.name());
        golden.iter().for_each(|golden| check(golden, at.path(), seed));
    }
    assert_eq!(methods, Method::all().iter().map(Method::name).collect(), "goldens of all methods");
}

#[test]
fn every_division_of_every_golden_scene_is_one_file() {
    each_golden(|golden, at, seed| {
        let Golden { words, ready, output } = golden;
        let whole = golden.render(at, &[], "whole.exr");
        if !ready.method.projects_regions() {
            assert!(whole == golden.render(at, &["--bands", "2"], "bands.exr"), "{words:?}: bands");
        }
        let exec = Exec::new(1, 8).unwrap();
        let mut session = ready.session(&exec, &|_, _, _| ()).unwrap().0;
        for regions in divisions(ready.camera.size(), seed) {
            let file = |region: &Rect| at.join(format!("{}.exr", self::words(*region)));
            let mut parts: Vec<_> = regions.iter().map(file).collect();
            for (region, part) in regions.iter().zip(&parts) {
                write_part(&mut session, ready, *output, *region, part);
            }
            shuffle(&mut parts, seed + 2);
            write_joined(&parts, &at.join("joined.exr"));
            let joined = fs::read(at.join("joined.exr")).unwrap();
            assert!(whole == joined, "{words:?}: {} regions", regions.len());
        }
    });
}

/// As above, with a process for each region, as on a cluster.
#[test]
#[ignore = "slow: .ci/run runs it"]
fn every_division_of_every_golden_scene_by_processes_is_one_file() {
    each_golden(|golden, at, seed| {
        golden.render(at, &[], "whole.exr");
        for regions in divisions(golden.ready.camera.size(), seed) {
            let files: Vec<_> = regions.iter().map(|region| words(*region) + ".exr").collect();
            for (region, to) in regions.iter().zip(&files) {
                golden.render(at, &["--region", &words(*region)], to);
            }
            let files: Vec<_> = files.iter().map(String::as_str).collect();
            succeeds(at, &[&["assemble"], &files[..], &["-o", "joined.exr"]].concat());
            for kind in ["exr", "png"] {
                let read = |name: &str| fs::read(at.join(name).with_extension(kind)).unwrap();
                let same = read("whole") == read("joined");
                assert!(same, "{:?}: {} regions, {kind}", golden.words, files.len());
            }
        }
    });
}
