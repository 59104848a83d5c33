//! A region of a picture has every bit that the whole picture has there: for every golden scene, by
//! the fast path, by the definition with all stages, and where buffer formats are emulated. A verdict
//! on a region is the verdict on the whole picture there. Of methods whose later stages need the whole
//! picture, a region has the bits of the projection, and the joined projection gives the whole picture.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use splatref::frame::{Exec, Frame, NamedPlane, Plane, Rect, Samples};
use splatref::io::scene_file::{Number, Ready, SceneFile};
use splatref::method::buffer_formats::{Buffers, Formats};
use splatref::method::{Method, Session};
use splatref::number::random::below;
use splatref::verdict::client::Client;
use splatref::verdict::{Outcome, StageVerdict, Verdict};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Part of a plane.
fn crop<T: Clone>(plane: &Plane<T>, rect: &Rect) -> Plane<T> {
    let [width, height] = rect.size();
    let rows = (rect.y0..rect.y1).flat_map(|y| (rect.x0..rect.x1).map(move |x| (x, y)));
    Plane::from_values(width, height, rows.map(|(x, y)| plane.at(x, y).clone()).collect())
}

fn crop_frame<R: Clone>(frame: &Frame<R>, rect: &Rect) -> Frame<R> {
    let [width, height] = rect.size();
    let planes = frame.planes.iter().map(|plane| NamedPlane {
        name: plane.name.clone(),
        samples: match &plane.samples {
            Samples::Scalar(p) => Samples::Scalar(crop(p, rect)),
            Samples::Color(p) => Samples::Color(crop(p, rect)),
            Samples::Vector(p) => Samples::Vector(crop(p, rect)),
            Samples::Index(p) => Samples::Index(crop(p, rect)),
            Samples::Count(p) => Samples::Count(crop(p, rect)),
        },
    });
    Frame { width, height, planes: planes.collect() }
}

/// The first plane that differs. No plane holds a NaN or -0, so equal values have equal bits.
fn difference<R: PartialEq + Clone>(
    part: &Frame<R>,
    whole: &Frame<R>,
    rect: &Rect,
) -> Option<String> {
    let expected = crop_frame(whole, rect);
    if (part.width, part.height, part.planes.len())
        != (expected.width, expected.height, expected.planes.len())
    {
        return Some(format!("{} x {}, {} planes", part.width, part.height, part.planes.len()));
    }
    let both = part.planes.iter().zip(&expected.planes);
    both.into_iter().find(|(part, whole)| part != whole).map(|(part, _)| part.name.clone())
}

/// Regions of a picture: the whole, both corners, one pixel, and one anywhere.
fn regions([width, height]: [u32; 2], seed: u64) -> Vec<Rect> {
    let below = |count: u32, k: u64| below(seed, k, count.into()) as u32;
    let (x, y) = (below(width, 0), below(height, 1));
    let (x0, y0) = (below(width, 2), below(height, 3));
    let (x1, y1) = (x0 + 1 + below(width - x0, 4), y0 + 1 + below(height - y0, 5));
    vec![
        Rect { x0, y0, x1, y1 },
        Rect { x0: 0, y0: 0, x1: x + 1, y1: y + 1 },
        Rect { x0: x, y0: y, x1: width, y1: height },
        Rect { x0: x, y0: y, x1: x + 1, y1: y + 1 },
        Rect::of_size([width, height]),
    ]
}

fn prepare<'a>(ready: &'a Ready, exec: &'a Exec) -> Session<'a> {
    ready.session(exec, &|_, _, _| ()).unwrap().0
}

/// Checks the regions of one golden scene, and returns its method.
fn check(path: &Path, seed: u64) -> Method {
    let name = path.display();
    let first = Exec::sequential();
    let file = SceneFile::read(path).unwrap();
    let ready = file.ready(&first, &|_, _, _| ()).unwrap();
    let (camera, formats) =
        (&ready.camera, Formats { buffers: Buffers::F16, ..Formats::default() });
    let mut session = prepare(&ready, &first);
    if ready.method.projects_regions() {
        check_projection(&ready, seed);
        return ready.method;
    }
    if ready.method.needs_whole_picture().is_some() {
        let error = session.set_region(Some(Rect { x0: 0, y0: 0, x1: 1, y1: 1 })).unwrap_err();
        assert_eq!(error.exit_code(), 2, "{error}");
        return ready.method;
    }
    let drawn = session.render(camera).unwrap().frame.clone();
    let defined = session.define::<f32>(camera, true).unwrap().frame;
    let precise = session.define::<f64>(camera, false).unwrap().frame;
    let emulated = session.emulate(camera, formats, true).unwrap().frame;
    for (i, rect) in (0..).zip(regions(camera.size(), seed)) {
        let exec = Exec::new(1 + i % 2, [8, 64, 16][i % 3]).unwrap();
        let mut session = prepare(&ready, &exec);
        session.set_region(Some(rect)).unwrap();
        let part = &session.render(camera).unwrap().frame;
        assert_eq!(difference(part, &drawn, &rect), None, "{name} {rect:?}");
        // The definition takes long, and the fast path has its bits in each region.
        if i < 2 {
            let part = session.define::<f32>(camera, true).unwrap().frame;
            assert_eq!(difference(&part, &defined, &rect), None, "{name} {rect:?}: definition");
            let part = session.define::<f64>(camera, false).unwrap().frame;
            assert_eq!(difference(&part, &precise, &rect), None, "{name} {rect:?}: f64");
            let part = session.emulate(camera, formats, true).unwrap().frame;
            assert_eq!(difference(&part, &emulated, &rect), None, "{name} {rect:?}: f16");
        }
    }
    ready.method
}

/// Checks the regions of a method that draws their projection alone.
fn check_projection(ready: &Ready, seed: u64) {
    let (exec, camera) = (Exec::new(2, 16).unwrap(), &ready.camera);
    let mut session = prepare(ready, &exec);
    let drawn = session.render(camera).unwrap().frame.clone();
    let defined = session.define::<f32>(camera, true).unwrap().frame;
    let precise = session.define::<f64>(camera, true).unwrap().frame;
    let stage = &ready.method.stages()[0];
    assert_eq!(stage.name, "projection");
    let (single, double) = (stage.planes_of(&defined), stage.planes_of(&precise));
    for rect in regions(camera.size(), seed) {
        session.set_region(Some(rect)).unwrap();
        if rect == Rect::of_size(camera.size()) {
            assert!(!session.projects(camera));
            assert!(session.render(camera).unwrap().frame == drawn, "a region of all pixels");
            continue;
        }
        assert!(session.projects(camera));
        let part = session.render(camera).unwrap().frame.clone();
        assert_eq!(difference(&part, &single, &rect), None, "{rect:?}");
        let part = session.define::<f64>(camera, false).unwrap().frame;
        assert_eq!(difference(&part, &double, &rect), None, "{rect:?}: f64");
        // Nothing takes the projection for a picture.
        assert!(session.emulate(camera, Formats::default(), false).is_err());
        assert!(session.stage(camera, "projection", &part).is_err());
        assert!(session.verify(camera, &Client::from(&defined), Verdict::BUDGET).is_err());
    }
    assert!(session.finish(camera, &single, true).unwrap().frame == defined, "finished, stages");
    assert!(session.finish(camera, &single, false).unwrap().frame == drawn, "finished");
    let mut missing = single.clone();
    missing.planes.remove(2);
    let error = session.finish(camera, &missing, false).unwrap_err().to_string();
    assert!(error.contains("is missing"), "{error}");
}

/// Checks that the verdict on a region is that on the whole picture, pixel by pixel, whatever the
/// client's other pixels hold.
fn check_verdict(path: &Path, seed: u64) {
    let exec = Exec::new(2, 16).unwrap();
    let file = SceneFile::read(path).unwrap();
    let ready = file.ready(&exec, &|_, _, _| ()).unwrap();
    let (camera, name) = (&ready.camera, path.display());
    if ready.method.needs_whole_picture().is_some() || file.output.number == Number::F64 {
        return;
    }
    let mut session = prepare(&ready, &exec);
    let mut frame = session.define::<f32>(camera, true).unwrap().frame;
    let rect = regions(camera.size(), seed)[0];
    // A wrong depth somewhere in the region, in the second verdict.
    for wrong in [false, true] {
        if wrong && let Some(Samples::Scalar(depth)) = plane(&mut frame, "Z") {
            let at = rect.y0 as usize * camera.width as usize + rect.x0 as usize;
            depth.values_mut()[at] = 1.5;
        }
        session.set_region(None).unwrap();
        let whole = session.verify(camera, &Client::from(&frame), Verdict::BUDGET).unwrap();
        let mut garbage = frame.clone();
        for y in 0..camera.height {
            for x in (0..camera.width).filter(|x| !rect.contains(*x, y)) {
                if let Some(Samples::Scalar(depth)) = plane(&mut garbage, "Z") {
                    depth.values_mut()[(y * camera.width + x) as usize] = 3.0;
                }
            }
        }
        session.set_region(Some(rect)).unwrap();
        let part = session.verify(camera, &Client::from(&garbage), Verdict::BUDGET).unwrap();
        for (part, whole) in part.stages.iter().zip(&whole.stages) {
            for (x, y) in (0..camera.height).flat_map(|y| (0..camera.width).map(move |x| (x, y))) {
                let at = |stage: &StageVerdict| (*stage.errors.at(x, y), *stage.doubts.at(x, y));
                let expected = if rect.contains(x, y) { at(whole) } else { (0.0, 0) };
                assert_eq!(at(part), expected, "{name} {rect:?}: {} at {x} {y}", part.stage);
            }
        }
        assert_eq!(part.outcome() == Outcome::Wrong, wrong, "{name} {rect:?}");
        assert!(part.covered <= rect.pixels() as u64);
    }
}

fn plane<'a>(frame: &'a mut Frame<f32>, name: &str) -> Option<&'a mut Samples<f32>> {
    frame.planes.iter_mut().find(|plane| plane.name == name).map(|plane| &mut plane.samples)
}

#[test]
fn a_verdict_on_a_region_looks_at_nothing_else() {
    (0..).zip(&goldens()).for_each(|(seed, scene)| check_verdict(scene, seed));
}

/// The golden scenes, sorted by name.
fn goldens() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden");
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut scenes: Vec<_> =
        entries.filter(|path| path.extension().is_some_and(|end| end == "toml")).collect();
    scenes.sort();
    scenes
}

#[test]
fn a_region_has_the_bits_of_the_whole_picture() {
    let scenes = goldens();
    assert!(scenes.len() > 40);
    let checked = (0..).zip(&scenes).map(|(seed, scene)| check(scene, seed).name());
    let checked: BTreeSet<_> = checked.collect();
    let all: BTreeSet<_> = Method::all().iter().map(Method::name).collect();
    assert_eq!(checked, all, "every method has a golden scene");
}
