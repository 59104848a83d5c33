//! Frames a second with selection and without \[GBP04, Table 1\], and the time of each pass \[GBP04,
//! Table 2, Fig. 6\].
//!
//! 512 x 512 pixels, two threads. The camera goes around the scene by a degree a frame, and what can
//! move moves. The first two frames do not count; every number is a median over the twelve after them.
//! Time is that of the whole frame, from the scene to shaded planes, in the memory of a frame before.
//! Without selection a frame is drawn by `ewa`, of scenes of objects from surfels in their places, and
//! putting them there is not timed; `deferred` puts them there itself. Choosing levels of detail is a part
//! of a frame, and of pass 2.
//!
//! Primitives are what a pass draws: the flagged surfels, all, those of B(i) whose flag is not set,
//! B(i). Those of the last frame are counted.

use super::bars::{Bar, svg};
use super::common::report::{Arguments, Table, machine};
use super::subjects::{FOREST, Subject, drawn, landscape, subjects};
use splatref::Result;
use splatref::frame::{Exec, NO_ID};
use splatref::index::seen::Seen;
use splatref::method::{Method, Session, deferred};
use splatref::scene::Scene;
use splatref::source::flatten;
use std::time::{Duration, Instant};

/// Frames before the first that counts.
const BEFORE: u32 = 2;
const FRAMES: u32 = 12;
/// The stages of `deferred`, and beside them what `ewa` calls its first step.
const PASSES: [&str; 6] =
    ["visibility", "indices", "difference", "attributes", "normalization", "shading"];
const PREPARED: &str = "projection";
/// Milliseconds and primitives a second of each of [`PASSES`] in the paper.
const PAPER: [&str; 6] = [
    "7-11, 11.5-13.5 M/s",
    "90-110 M/s; reading 6.6, sorting 1.7-2.2",
    "0.8-1.2, 11.5-13.5 M/s",
    "9-11.5, 11-13 M/s",
    "0.7",
    "",
];

/// What was measured of a scene with one method: medians.
struct Measured {
    frame: f64,
    /// Milliseconds of [`PASSES`].
    passes: [f64; 6],
    /// Surfels that the high level leaves.
    drawn: f64,
    /// Per cent of these.
    culled: f64,
    /// What the last but one frame saw.
    before: Option<Seen>,
}

/// A frame.
struct Taken {
    time: Duration,
    passes: [Duration; 6],
    drawn: u64,
    seen: Option<Seen>,
}

pub(crate) fn tables(arguments: &Arguments, exec: &Exec) -> Result<()> {
    let mut rates = Table::new(&[
        "scene",
        "surfels",
        "in view",
        "without, frames/s",
        "culled, %",
        "with, frames/s",
        "ratio",
        "m = 64",
        "ratio",
        "paper: without",
        "culled, %",
        "with",
        "ratio",
    ]);
    let (mut rows, mut bars) = (Vec::new(), Vec::new());
    for subject in subjects(arguments, exec)? {
        let subject = subject?;
        let settings = deferred::Settings { splats: subject.splats, ..Default::default() };
        let without = measured(&subject, subject.splats.into(), exec)?;
        let with = measured(&subject, settings.into(), exec)?;
        let grouped = deferred::Settings { flags: 64, ..settings };
        let grouped = measured(&subject, grouped.into(), exec)?;
        let [a, b, c] = [&without, &with, &grouped].map(|one| 1e3 / one.frame);
        let [p, culled, q] = subject.paper;
        // Of a range the middle.
        let number = |text: &str| {
            let ends: Vec<f64> = text.split('-').filter_map(|end| end.parse().ok()).collect();
            ends.iter().sum::<f64>() / ends.len() as f64
        };
        let paper =
            if p.is_empty() { String::new() } else { format!("{:.2}", number(q) / number(p)) };
        rates.row(&format!(
            "{} | {} | {:.0} | {a:.1} | {:.1} | {b:.1} | {:.2} | {c:.1} | {:.2} | {p} | {culled} | {q} | \
             {paper}",
            subject.name,
            subject.count(),
            with.drawn,
            with.culled,
            b / a,
            c / a
        ));
        rows.extend(passes(&subject, &[&without, &with, &grouped], settings, exec)?);
        let name = subject.name;
        if name == FOREST && arguments.pictures.is_some() {
            picture(&subject, arguments, exec)?;
        }
        bars.push(Bar { name: format!("{name}, without"), parts: without.passes.to_vec() });
        bars.push(Bar { name: format!("{name}, with"), parts: with.passes.to_vec() });
    }
    rates.publish_times(arguments, "gbp04.md", "rates-of-frames")?;
    let mut columns = vec!["scene", "row", "frame, ms"];
    columns.extend(PASSES);
    let mut table = Table::new(&columns);
    table.row(&format!("the paper | ms, primitives | | {}", PAPER.join(" | ")));
    rows.iter().for_each(|row| table.row(row));
    table.publish_times(arguments, "gbp04.md", "passes")?;
    let title = format!("Time of each pass, 512 x 512; {}", machine());
    arguments.write("gbp04-passes.svg", &svg(&title, "ms", &PASSES, &bars))
}

/// The forest on its ground, as the second frame shows it.
fn picture(forest: &Subject, arguments: &Arguments, exec: &Exec) -> Result<()> {
    let (scene, camera) = landscape(forest, exec)?;
    let settings = deferred::Settings { splats: forest.splats, ..Default::default() };
    let mut session = Session::new(&scene, settings.into(), exec)?;
    session.render(&camera)?;
    let frame = &session.render(&camera)?.frame;
    arguments.picture("gbp04-forest.png", frame.color("")?)
}

/// The rows of a scene: without selection, with it, and how many primitives that is.
fn passes(
    subject: &Subject,
    found: &[&Measured; 3],
    settings: deferred::Settings,
    exec: &Exec,
) -> Result<Vec<String>> {
    let mut rows = Vec::new();
    for (one, how) in found.iter().zip(["without, ms", "with, ms", "with m = 64, ms"]) {
        let cells = one.passes.map(|time| format!("{time:.2}")).join(" | ");
        rows.push(format!("{} | {how} | {:.1} | {cells}", subject.name, one.frame));
    }
    let with = found[1];
    let counts = primitives(subject, settings, with.before.clone(), exec)?;
    let drawn: Vec<_> = counts
        .iter()
        .zip(with.passes)
        .map(|(&count, time)| {
            let (thousands, rate) = (count as f64 / 1e3, count as f64 / time / 1e3);
            // A rate of a few primitives says nothing.
            let rate = if count < 10_000 { String::new() } else { format!(", {rate:.1} M/s") };
            format!("{thousands:.1} k{rate}")
        })
        .collect();
    rows.push(format!("{} | primitives | | {} | |", subject.name, drawn.join(" | ")));
    Ok(rows)
}

/// The frames of a sequence.
fn measured(subject: &Subject, method: Method, exec: &Exec) -> Result<Measured> {
    let taken = if subject.is_still() {
        still(subject, method, exec)?
    } else {
        moving(subject, method, exec)?
    };
    let counted = &taken[BEFORE as usize..];
    let milliseconds = |time: Duration| time.as_secs_f64() * 1e3;
    let culled = |taken: &Taken| {
        let selected = taken.seen.as_ref().map(|seen| seen.selected().iter().sum::<u32>());
        selected.map_or(0.0, |n| 1e2 * (1.0 - f64::from(n) / taken.drawn as f64))
    };
    Ok(Measured {
        frame: median(counted.iter().map(|taken| milliseconds(taken.time))),
        passes: std::array::from_fn(|i| {
            median(counted.iter().map(|taken| milliseconds(taken.passes[i])))
        }),
        drawn: median(counted.iter().map(|taken| taken.drawn as f64)),
        culled: median(counted.iter().map(culled)),
        before: taken[taken.len() - 2].seen.clone(),
    })
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<_> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// One session for all frames.
fn still(subject: &Subject, method: Method, exec: &Exec) -> Result<Vec<Taken>> {
    let (scene, _) = prepared(subject, 0, &method, exec)?;
    let mut session = Session::new(&scene, method, exec)?;
    (0..BEFORE + FRAMES).map(|frame| take(&mut session, subject, frame, Duration::ZERO)).collect()
}

/// A session a frame, which draws it twice from the same state: once to take its memory.
fn moving(subject: &Subject, method: Method, exec: &Exec) -> Result<Vec<Taken>> {
    let mut seen = None;
    let mut all = Vec::new();
    for frame in 0..BEFORE + FRAMES {
        let (scene, choosing) = prepared(subject, frame, &method, exec)?;
        let mut session = Session::new(&scene, method, exec)?;
        session.resume(seen.clone());
        session.render(&subject.camera(frame)?)?;
        session.resume(seen);
        let taken = take(&mut session, subject, frame, choosing)?;
        seen = taken.seen.clone();
        all.push(taken);
    }
    Ok(all)
}

/// The scene of a frame, flattened for `ewa`, and how long levels of detail took to choose.
fn prepared(
    subject: &Subject,
    frame: u32,
    method: &Method,
    exec: &Exec,
) -> Result<(Scene, Duration)> {
    let (scene, choosing) = subject.at(frame, exec)?;
    match method {
        Method::Ewa(_) => Ok((Scene { objects: None, ..flatten(&scene, exec)? }, choosing)),
        _ => Ok((scene, choosing)),
    }
}

/// Draws a frame for which levels of detail have been chosen.
fn take(
    session: &mut Session<'_>,
    subject: &Subject,
    frame: u32,
    choosing: Duration,
) -> Result<Taken> {
    let camera = subject.camera(frame)?;
    let start = Instant::now();
    let picture = session.render(&camera)?;
    let time = start.elapsed() + choosing;
    let mut passes = [Duration::ZERO; 6];
    passes[1] = choosing;
    for (name, time) in &picture.timings {
        let name = if *name == PREPARED { PASSES[0] } else { *name };
        if let Some(pass) = PASSES.iter().position(|pass| *pass == name) {
            passes[pass] += *time;
        }
    }
    let seen = picture.seen.clone();
    Ok(Taken { time, passes, drawn: drawn(session.scene()), seen })
}

/// How many primitives the first four passes draw in the last frame.
fn primitives(
    subject: &Subject,
    settings: deferred::Settings,
    before: Option<Seen>,
    exec: &Exec,
) -> Result<[u64; 4]> {
    let frame = BEFORE + FRAMES - 1;
    let (scene, _) = subject.at(frame, exec)?;
    let ids = deferred::ids(&scene);
    let mut session = Session::new(&scene, settings.into(), exec)?;
    session.resume(before.clone());
    let picture = session.define::<f32>(&subject.camera(frame)?, true)?.frame;
    let kept = picture.index("indices.id")?.values().iter().filter(|&&id| id != NO_ID);
    let selected: Vec<_> = kept.filter_map(|&id| ids.find(u64::from(id))).collect();
    let is_drawn = |&id: &u64| match (&scene.objects, ids.find(id)) {
        (Some(objects), Some((object, surfel))) => {
            objects.drawn(object).is_none_or(|drawn| drawn.has(surfel as usize))
        }
        _ => true,
    };
    let of = |seen: &Seen| seen.surfels(&ids).into_iter().filter(is_drawn).count();
    let flagged = before.as_ref().map_or(0, of);
    let is_new = |&&(object, surfel): &&(u32, u32)| {
        before.as_ref().is_none_or(|seen| !seen.has(object, surfel))
    };
    let fresh = selected.iter().filter(is_new).count();
    Ok([flagged as u64, drawn(&scene), fresh as u64, selected.len() as u64])
}
