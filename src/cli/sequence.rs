//! `splatref render --frames` and `--stereo`: renders each frame of a sequence, for one eye or for both.

use super::destination::{Depth, Destination, write};
use super::walk::Walk;
use super::{Ended, Ending, draw, progress, region, report, warn};
use splatref::Result;
use splatref::frame::Exec;
use splatref::index::seen::Seen;
use splatref::io::scene_file::{OutputSettings, SceneFile};
use splatref::method::Session;
use splatref::scene::Camera;
use splatref::scene::camera::stereo::Eye;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The frames of a sequence to render.
#[derive(Clone)]
pub(super) enum Frames {
    All,
    Some(Range<u32>),
}

/// Parses `0..60` or `all`.
pub(super) fn frames(text: &str) -> std::result::Result<Frames, String> {
    if text == "all" {
        return Ok(Frames::All);
    }
    let ends = text.split_once("..").and_then(|(a, b)| Some((a.parse().ok()?, b.parse().ok()?)));
    match ends {
        Some((start, end)) if start < end => Ok(Frames::Some(start..end)),
        Some((start, end)) => Err(format!(
            "{start}..{end} holds no frame, because the end is not included; give the first frame \
             and one after the last"
        )),
        None => Err("give the first frame and one after the last, such as 0..60, or all".into()),
    }
}

/// A frame, and the files of its pictures: one, or one for each eye.
pub(super) struct Shot {
    frame: u32,
    places: Vec<PathBuf>,
}

/// The frames of a sequence with their files, or a single frame; of a `pair`, with two files each.
pub(super) fn shots(
    to: &Destination<'_>,
    file: &SceneFile,
    frames: Option<Range<u32>>,
    pair: bool,
) -> Result<Vec<Shot>> {
    let numbered = frames.is_some();
    let shot = |frame| {
        let number = if numbered { format!("{frame:04}") } else { String::new() };
        let of_eye = |eye: Eye| match number.as_str() {
            "" => eye.name().to_owned(),
            number => format!("{}.{number}", eye.name()),
        };
        let parts = if pair { Eye::BOTH.map(of_eye).to_vec() } else { vec![number] };
        let places = parts.iter().map(|part| to.place(file, part)).collect::<Result<_>>()?;
        Ok(Shot { frame, places })
    };
    frames.unwrap_or(file.frame..file.frame + 1).map(shot).collect()
}

/// Renders the frames of a scene file, whose own frame is the first of them. A walk chooses the size of
/// its ordered points from frame to frame.
pub(super) fn render(
    to: &Destination<'_>,
    file: &SceneFile,
    shots: &[Shot],
    mut walk: Option<Walk>,
    exec: &Exec,
) -> Ended {
    let start = Instant::now();
    let places: Vec<PathBuf> = shots.iter().flat_map(|shot| shot.places.clone()).collect();
    let last = shots.last().map_or(file.frame, |shot| shot.frame);
    let mut ready = draw::ready(file, exec)?;
    let warned = ready.loaded.warnings.len();
    // What no later frame can have is found before the first is drawn.
    ready.check_frames(file.frame..last + 1)?;
    to.check_state(&ready, file, &places)?;
    // Each eye has its own state. Only a sequence of one eye has an old one.
    let mut seen = [draw::seen(&ready, to.options, exec)?, None];
    let mut times = Times::default();
    times.add("loading", start.elapsed());
    report::scene(&ready.loaded);
    report::camera(&ready.camera);
    report::far(file, &ready.loaded.scene, &ready.camera);
    report::picture(&ready.camera, file.output);
    let projects = to.projects(&ready.method, &ready.camera);
    if projects {
        report::line("holds", region::PROJECTION);
    }
    report::method(&ready.method, &ready.loaded.scene, &ready.camera);
    to.make_folder()?;

    let pictures = Pictures { to, output: file.output, exec };
    let steps = progress::Steps::new("preparing");
    let show = |done: usize| steps.show("rendering", done as u64, shots.len() as u64);
    if ready.is_still() && walk.is_none() {
        let mut session = times.of("preparing", || ready.session(exec, &|_, _, _| ()))?.0;
        for (done, shot) in shots.iter().enumerate() {
            show(done);
            let camera = ready.camera_at(shot.frame)?;
            pictures.both(&mut session, &camera, &mut seen, shot, &mut times)?;
        }
    } else {
        for (done, shot) in shots.iter().enumerate() {
            show(done);
            let start = Instant::now();
            ready = times.of("placing", || match &walk {
                Some(walk) => walk.at(ready, shot.frame, exec),
                None => ready.at(shot.frame, exec),
            })?;
            let mut session = times.of("preparing", || ready.session(exec, &|_, _, _| ()))?.0;
            let placing = start.elapsed();
            let drawing =
                pictures.both(&mut session, &ready.camera, &mut seen, shot, &mut times)?;
            if let Some(walk) = &mut walk {
                walk.note(&ready, [placing, drawing])?;
            }
        }
    }
    drop(steps);
    // Files of later frames may be doubtful, too.
    warn(&ready.loaded.warnings[warned..]);
    to.keep(&ready, last, seen[0].as_ref(), exec)?;

    let pairs = if places.len() > shots.len() { ", two pictures each" } else { "" };
    let frames = shots.len();
    report::line("time", format!("{}, sums over {frames} frames{pairs}", report::threads(exec)));
    times.0.into_iter().for_each(|(what, time)| report::time(what, vec![time]));
    report::time("total", vec![start.elapsed()]);
    let walked = walk.map(Walk::finish).transpose()?;
    files(&places, !projects, to.depth);
    walked.iter().flatten().for_each(|file| report::line("", file.display()));
    Ok(Ending::Good)
}

/// Where and how the pictures of a sequence are written.
struct Pictures<'a> {
    to: &'a Destination<'a>,
    output: OutputSettings,
    exec: &'a Exec,
}

impl Pictures<'_> {
    /// Draws and writes the pictures of a frame, of the camera's eye and then of the other one, each after
    /// its own state. Returns how long drawing took.
    fn both(
        &self,
        session: &mut Session<'_>,
        camera: &Camera,
        seen: &mut [Option<Seen>; 2],
        shot: &Shot,
        times: &mut Times,
    ) -> Result<Duration> {
        let cameras = [Some(*camera), camera.seen_by_other_eye()].into_iter().flatten();
        let mut drawing = Duration::ZERO;
        for ((camera, path), seen) in cameras.zip(&shot.places).zip(seen) {
            session.resume(seen.take());
            let drawn;
            (*seen, drawn) = self.one(session, &camera, path, times)?;
            drawing += drawn;
        }
        Ok(drawing)
    }

    /// Draws and writes one picture, and returns the state after it, and how long drawing took.
    fn one(
        &self,
        session: &mut Session<'_>,
        camera: &Camera,
        path: &Path,
        times: &mut Times,
    ) -> Result<(Option<Seen>, Duration)> {
        let Self { to, output, exec } = *self;
        let start = Instant::now();
        let (scene, method, groups) =
            (session.scene(), *session.method(), session.groups().cloned());
        let window = to.limit(session, camera)?;
        let drawing = output.draw(session, camera)?;
        let drawn = start.elapsed();
        drawing.timings.iter().for_each(|(stage, time)| times.add(stage, *time));
        let text = || to.text(scene, groups.as_ref(), camera, &method, output);
        let frame = &drawing.frame;
        times.of("writing", || write(path, frame, window, text, output, to.depth, exec))?;
        Ok((drawing.seen.clone(), drawn))
    }
}

/// Prints the first and the last of the files.
fn files(places: &[PathBuf], png: bool, depth: Option<Depth>) {
    let [Some(first), Some(last)] = [places.first(), places.last()] else { return };
    let depth = depth.map(|depth| format!("depth.{}", depth.file.extension()));
    let ends = [Some("exr"), png.then_some("png"), depth.as_deref()];
    for (label, end) in ["files", "", ""].into_iter().zip(ends.into_iter().flatten()) {
        let [first, last] = [first, last].map(|path| path.with_extension(end));
        let (first, last) = (first.display(), last.display());
        let all = if places.len() == 1 { first.to_string() } else { format!("{first} to {last}") };
        report::line(label, all);
    }
}

/// How long each step took in all frames, in the order in which the steps first ran.
#[derive(Default)]
struct Times(Vec<(&'static str, Duration)>);

impl Times {
    fn add(&mut self, what: &'static str, time: Duration) {
        match self.0.iter_mut().find(|(known, _)| *known == what) {
            Some((_, sum)) => *sum += time,
            None => self.0.push((what, time)),
        }
    }

    fn of<T>(&mut self, what: &'static str, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let done = work();
        self.add(what, start.elapsed());
        done
    }
}
