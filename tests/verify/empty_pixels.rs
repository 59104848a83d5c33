//! An empty pixel holds exact values in every plane of every method: one wrong bit there is found under every
//! promise, and named. So is a NaN, and so is a value that another pixel left behind.

use splatref::frame::{Exec, Frame, NO_ID, NamedPlane, Plane, Samples};
use splatref::io::scene_file::SceneFile;
use splatref::method::{Method, Session};
use splatref::scene::Camera;
use splatref::setting::Words;
use splatref::verdict::client::{Client, Rounding, Storage};
use splatref::verdict::{Outcome, Verdict};
use std::path::Path;

/// Scenes that leave part of the picture empty.
const SCENES: [(&str, &str); 3] = [
    ("plain", "[[model]]\nshape = \"cluster\"\ncount = 40\n"),
    ("opacities", "[[model]]\nshape = \"staircase\"\ncount = 60\nopacity = 0.6\n"),
    (
        "sky",
        "[[model]]\nshape = \"sphere\"\ncount = 60\nopacity = 0.999\n\
         [[light]]\nkind = \"point\"\nposition = [3, 3, 3]\n[environment]\nsky = true\n",
    ),
];

/// The names of the planes that show the environment where nothing is drawn.
const SHOWS_SKY: [&str; 2] = ["", "A"];

type Pixel = (u32, u32);

/// Whether a plane holds the value of an empty pixel here.
fn is_empty(samples: &Samples<f32>, (x, y): Pixel) -> bool {
    match samples {
        Samples::Scalar(plane) => *plane.at(x, y) == 0.0 || plane.at(x, y).is_infinite(),
        Samples::Color(plane) | Samples::Vector(plane) => plane.at(x, y).iter().all(|v| *v == 0.0),
        Samples::Index(plane) => *plane.at(x, y) == NO_ID,
        Samples::Count(plane) => *plane.at(x, y) == 0,
    }
}

/// The pass, level or group that a plane belongs to; the picture's own planes belong to none.
fn part_of(plane: &NamedPlane<f32>) -> &str {
    let name = plane.name.as_str();
    let own = |part: &str| part.ends_with(|c: char| c.is_ascii_digit());
    name.split_once('.').map_or(if own(name) { name } else { "" }, |(part, _)| part)
}

/// The columns and rows of a plane that are cells: a coarser level of a pyramid is in the upper left of its plane.
fn cells(plane: &NamedPlane<f32>) -> [u32; 2] {
    let (width, height) = plane.samples.size();
    let level = ["pull", "push", "level"].iter().find_map(|of| part_of(plane).strip_prefix(of));
    let level: u32 = level.and_then(|level| level.parse().ok()).unwrap_or(0);
    [width, height].map(|size| size.div_ceil(1 << level))
}

/// The pixels that are empty in all planes of a plane's part, and so are the pixels around them, from the
/// border inwards.
fn empty_pixels(frame: &Frame<f32>, plane: &NamedPlane<f32>, sky: bool) -> Vec<Pixel> {
    let [width, height] = cells(plane);
    let beside = |other: &&NamedPlane<f32>| {
        let same = part_of(other) == part_of(plane) || other.name == part_of(plane);
        let shows_sky = sky && SHOWS_SKY.contains(&other.name.as_str());
        same && !shows_sky
    };
    let planes: Vec<_> = frame.planes.iter().filter(beside).collect();
    let empty = |at: Pixel| planes.iter().all(|plane| is_empty(&plane.samples, at));
    let around = |(x, y): Pixel| {
        let columns = x.saturating_sub(2)..(x + 3).min(width);
        let mut rows = y.saturating_sub(2)..(y + 3).min(height);
        rows.all(|y| columns.clone().all(|x| empty((x, y))))
    };
    let all = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    all.filter(|at| around(*at)).collect()
}

/// A scalar that stands in place of another, in four ways: no number, a value of another pixel, one bit off.
fn spoiled(right: f32, other: f32, least: f32) -> [f32; 4] {
    let bit = if right.is_infinite() { f32::MAX.copysign(right) } else { least };
    [f32::NAN, 0.5, if other.is_nan() { 0.25 } else { other }, bit]
}

/// The least number above 0 that a format holds.
fn least_of(storage: Storage) -> f32 {
    match storage {
        Storage::Steps(step) => step as f32,
        Storage::Half => 1.0 / 16_777_216.0,
        Storage::Float { least, .. } => least as f32,
        _ => f32::from_bits(1),
    }
}

/// The plane with a wrong value at each of up to four empty pixels, and these pixels.
fn with_leftovers(
    samples: &Samples<f32>,
    empty: &[Pixel],
    least: f32,
) -> (Samples<f32>, Vec<Pixel>) {
    let (width, height) = samples.size();
    let mut all = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let filled = all.find(|at| !is_empty(samples, *at));
    let mut samples = samples.clone();
    let mut pixels: Vec<Pixel> = empty.iter().copied().take(4).collect();
    match &mut samples {
        Samples::Scalar(plane) => {
            let other = filled.map_or(f32::NAN, |(x, y)| *plane.at(x, y));
            for (i, &(x, y)) in pixels.iter().enumerate() {
                put(plane, (x, y), spoiled(*plane.at(x, y), other, least)[i]);
            }
        }
        Samples::Color(plane) | Samples::Vector(plane) => {
            let of = |(x, y): Pixel| plane.at(x, y).iter().copied().find(|v| v.abs() > 0.01);
            let other = filled.and_then(of).unwrap_or(f32::NAN);
            for (i, &(x, y)) in pixels.iter().enumerate() {
                let mut value = *plane.at(x, y);
                value[i % 3] = spoiled(value[i % 3], other, least)[i];
                put(plane, (x, y), value);
            }
        }
        Samples::Index(plane) => {
            let other = filled.map_or(0, |(x, y)| *plane.at(x, y));
            pixels.truncate(1);
            pixels.iter().for_each(|at| put(plane, *at, other));
        }
        Samples::Count(plane) => {
            pixels.truncate(1);
            pixels.iter().for_each(|at| put(plane, *at, 1));
        }
    }
    (samples, pixels)
}

fn put<T>(plane: &mut Plane<T>, (x, y): Pixel, value: T) {
    let at = (y * plane.width() + x) as usize;
    plane.values_mut()[at] = value;
}

/// The frame with another plane in place of one.
fn replaced(frame: &Frame<f32>, name: &str, samples: &Samples<f32>) -> Frame<f32> {
    let mut frame = frame.clone();
    let own = frame.planes.iter_mut().find(|plane| plane.name == name).unwrap();
    own.samples = samples.clone();
    frame
}

/// The verdict on the planes of a frame.
fn verdict(
    (session, camera): (&Session<'_>, &Camera),
    frame: &Frame<f32>,
    (rounding, storage): (Rounding, Storage),
    spoiled: Option<&str>,
) -> Verdict {
    let mut client = Client::from(frame);
    client.rounding = rounding;
    for plane in &frame.planes {
        // Depths in steps would have empty pixels of their own. What follows from a plane in steps may be a step off.
        let steps =
            matches!(storage, Storage::Steps(_)) && spoiled.is_none_or(|own| own != plane.name);
        if storage != Storage::Single && !plane.name.ends_with('Z') && !steps {
            client = client.stored(&plane.name, storage);
        }
    }
    session.verify(camera, &client, 1.0).unwrap()
}

/// What is not found of the wrong values in each plane, and how many planes were tried.
fn unseen(
    given: (&Session<'_>, &Camera),
    (frame, sky): (&Frame<f32>, bool),
    declared: (Rounding, Storage),
) -> (Vec<String>, usize) {
    let own = verdict(given, frame, declared, None);
    let mut found = Vec::new();
    if own.first_wrong().is_some() {
        let fault = own.first_wrong().and_then(|stage| stage.worst.as_ref());
        found.push(format!("the own picture is wrong: {fault:?}"));
    }
    let judged: Vec<&str> = own.stages.iter().flat_map(|stage| &stage.planes).copied().collect();
    let row = |name: &str| {
        let stages = given.0.method().stages();
        stages.iter().find_map(|stage| stage.row(name)).map(|row| row.name)
    };
    let mut tried = 0;
    for plane in frame
        .planes
        .iter()
        .filter(|plane| row(&plane.name).is_some_and(|row| judged.contains(&row)))
    {
        let empty = empty_pixels(frame, plane, sky);
        if empty.is_empty() {
            continue;
        }
        tried += 1;
        let (samples, pixels) = with_leftovers(&plane.samples, &empty, least_of(declared.1));
        let other =
            verdict(given, &replaced(frame, &plane.name, &samples), declared, Some(&plane.name));
        for (i, &(x, y)) in pixels.iter().enumerate() {
            let wrong = |stage: &splatref::verdict::StageVerdict| *stage.errors.at(x, y) > 1.0;
            // The bits of a sky are no exact numbers, and its opacity is that of other pixels.
            let inexact = sky && SHOWS_SKY.contains(&plane.name.as_str()) && i >= 2;
            if !inexact && !other.stages.iter().any(wrong) {
                found.push(format!("value {i} of `{}` at ({x}, {y})", plane.name));
            }
        }
        let worst = other.first_wrong().and_then(|stage| stage.worst.as_ref());
        if let Some(worst) = worst
            && !pixels.contains(&worst.pixel)
        {
            found.push(format!("`{}` is wrong at {:?}: {}", plane.name, worst.pixel, worst.fault));
        }
        if other.outcome() != Outcome::Wrong {
            found.push(format!("`{}` is {:?}", plane.name, other.outcome()));
        }
    }
    (found, tried)
}

/// The picture with -0 for every 0 of an empty pixel.
fn negative(frame: &Frame<f32>) -> Frame<f32> {
    let turned = |v: &f32| if *v == 0.0 { -0.0 } else { *v };
    let mut frame = frame.clone();
    for plane in &mut frame.planes {
        match &mut plane.samples {
            Samples::Scalar(plane) => *plane = plane.map(turned),
            Samples::Color(plane) | Samples::Vector(plane) => {
                *plane = plane.map(|value| value.each_ref().map(turned));
            }
            Samples::Index(_) | Samples::Count(_) => {}
        }
    }
    frame
}

/// Calls `visit` with the pictures of each method: a name, the session, the camera, the frame and whether a sky
/// is seen.
pub(crate) fn each_picture(
    stages: bool,
    scenes: &[&str],
    mut visit: impl FnMut(&str, (&Session<'_>, &Camera), (&Frame<f32>, bool)),
) {
    let exec = Exec::sequential();
    for (scene, text) in SCENES.into_iter().filter(|(scene, _)| scenes.contains(scene)) {
        for method in Method::all() {
            let text = format!("{text}[camera]\nsize = [24, 18]\n");
            let text = format!("{text}[method]\nname = \"{}\"\n", method.name());
            let file = SceneFile::parse(&text, Path::new("scene.toml")).unwrap();
            let ready = file.ready(&exec, &|_, _, _| ()).unwrap();
            let (session, _) = ready.session(&exec, &|_, _, _| ()).unwrap();
            let Ok(drawn) = session.define::<f32>(&ready.camera, stages) else { continue };
            let name = format!("{scene}, {}", method.name());
            visit(&name, (&session, &ready.camera), (&drawn.frame, scene == "sky"));
        }
    }
}

/// What is not found of wrong values in empty pixels of every method.
fn all_unseen(stages: bool, scenes: &[&str], storage: Storage) -> Vec<String> {
    let mut found = Vec::new();
    each_picture(stages, scenes, |name, given, frame| {
        for (word, rounding) in Rounding::WORDS {
            let (own, tried) = unseen(given, frame, (*rounding, storage));
            assert!(tried > 1, "{name}: only {tried} planes have empty pixels");
            found.extend(own.into_iter().map(|what| format!("{name}, {word}: {what}")));
        }
    });
    found
}

#[test]
fn a_wrong_bit_in_an_empty_pixel_is_found() {
    for stages in [true, false] {
        let found = all_unseen(stages, &["plain", "opacities", "sky"], Storage::Single);
        assert!(found.is_empty(), "stages {stages}: {}:\n{}", found.len(), found.join("\n"));
    }
}

#[test]
fn so_it_is_in_other_formats() {
    let float = Storage::Float { relative: 1.0 / 64.0, least: 1.0 / 1024.0 };
    for storage in [Storage::Half, Storage::Rounded, Storage::Steps(1.0 / 255.0), float] {
        let found = all_unseen(true, &["opacities"], storage);
        assert!(found.is_empty(), "{storage:?}: {}:\n{}", found.len(), found.join("\n"));
    }
}

#[test]
fn a_negative_zero_is_no_wrong_bit() {
    each_picture(true, &["plain", "opacities"], |name, given, (frame, _)| {
        for (word, rounding) in Rounding::WORDS {
            let verdict = verdict(given, &negative(frame), (*rounding, Storage::Single), None);
            let worst = verdict.first_wrong().and_then(|stage| stage.worst.as_ref());
            assert_eq!(worst, None, "{name}, {word}");
        }
    });
}
