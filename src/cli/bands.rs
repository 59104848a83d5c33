//! `splatref render --bands`: draws a picture band by band, and writes each band as it is made.

use super::destination::Destination;
use super::{Ended, Ending, progress, report};
use splatref::frame::{Exec, Frame, Rect};
use splatref::io::scene_file::{OutputSettings, Ready};
use splatref::io::{exr, provenance};
use splatref::memory;
use splatref::method::{Method, Session};
use splatref::scene::Camera;
use splatref::{Error, Result};
use std::borrow::Cow;
use std::path::Path;
use std::time::Instant;

/// How many bands are drawn.
#[derive(Clone, Copy, Debug)]
pub(super) enum Count {
    /// About so many.
    About(u32),
    /// As few as fit into memory.
    Auto,
}

/// Reads the number of bands.
pub(super) fn count(text: &str) -> std::result::Result<Count, String> {
    match text.parse() {
        _ if text == "auto" => Ok(Count::Auto),
        Ok(count) if count > 0 => Ok(Count::About(count)),
        _ => Err("give a number from 1, or auto".into()),
    }
}

/// Checks that a method can draw in bands.
pub(super) fn check(method: &Method) -> Result<()> {
    if !method.projects_regions() {
        return method.check_alone();
    }
    let name = method.name();
    let what = format!(
        "--bands: after the projection, the method {name} needs the whole picture in memory; remove --bands"
    );
    Err(Error::Usage(what))
}

/// The fewest columns of a part of a band.
const LEAST_COLUMNS: u32 = 32;

/// The largest parts that fit into half of the memory that is left, in columns and rows: the whole
/// picture, a band of half its rows, and so on. If the lowest band that a file may have still shows too
/// many surfels of a folder, a part of half its columns, and so on. The other half of the memory is for
/// the blocks of the file.
fn largest_part(
    session: &mut Session<'_>,
    ready: &Ready,
    output: OutputSettings,
) -> Result<[u32; 2]> {
    let Ready { camera, .. } = ready;
    let making = output.making();
    let [width, height] = camera.size();
    let [mut columns, mut rows] = [width, height.next_multiple_of(exr::BLOCK_LINES)];
    loop {
        let bands = bands_of(Rect::of_size([width, height]), rows);
        let parts: Vec<Rect> = bands.flat_map(|band| parts_of(band, columns)).collect();
        session.set_region(parts.first().copied())?;
        // What a part reads of a folder is not in the session yet.
        let read = parts.iter().map(|part| {
            let (surfels, held) = ready.most_of_part(*part);
            surfels * session.needs_a_splat(making) + held
        });
        let read = read.max().unwrap_or(0);
        if session.needs(camera, making) + read <= memory::left() / 2 {
            return Ok([columns, rows]);
        }
        match (rows > exr::BLOCK_LINES, read > 0 && columns > LEAST_COLUMNS) {
            (true, _) => rows = rows.div_ceil(2).next_multiple_of(exr::BLOCK_LINES),
            (false, true) => columns = columns.div_ceil(2),
            (false, false) => return Ok([columns, rows]),
        }
    }
}

/// The bands of so many rows, from the top.
fn bands_of(whole: Rect, rows: u32) -> impl Iterator<Item = Rect> {
    let tops = (whole.y0..whole.y1).step_by(rows as usize);
    tops.map(move |y0| Rect { y0, y1: whole.y1.min(y0 + rows), ..whole })
}

/// The parts of a band of so many columns, from the left.
fn parts_of(band: Rect, columns: u32) -> impl Iterator<Item = Rect> {
    let sides = (band.x0..band.x1).step_by(columns as usize);
    sides.map(move |x0| Rect { x0, x1: band.x1.min(x0 + columns), ..band })
}

/// Draws a picture in bands of rows into the file `picture`.
pub(super) fn render(
    session: &mut Session<'_>,
    ready: &Ready,
    (to, picture): (&Destination<'_>, &Path),
    (output, count): (OutputSettings, Count),
    exec: &Exec,
) -> Ended {
    let start = Instant::now();
    let Ready { loaded, camera, method, .. } = ready;
    to.make_folder()?;
    let text = provenance::text(&loaded.scene, session.groups(), camera, method, output);
    let [columns, rows] = match count {
        Count::About(count) => [camera.width, camera.height.div_ceil(count)],
        Count::Auto => largest_part(session, ready, output)?,
    };
    let steps = progress::Steps::new("rendering");
    let mut bands = 0_u32;
    let mut draw = |band: Rect| {
        steps.show("bands", band.y0.into(), camera.height.into());
        bands += 1;
        let mut parts = parts_of(band, columns).map(|part| match ready.part(Some(part), exec)? {
            Some(scene) => drawn(&mut Session::new(&scene, *method, exec)?, camera, part, output),
            None => drawn(session, camera, part, output),
        });
        let first = parts.next().unwrap_or_else(|| Err(Error::Invalid("an empty band".into())))?;
        parts.try_fold(first, |band, part| band.beside(&part?))
    };
    let how = (output.compression, exec);
    exr::pending_bands(picture, (camera.size(), rows), &text, how, &mut draw)?.put()?;
    drop(steps);
    report::scene(loaded);
    report::camera(camera);
    report::picture(camera, output);
    let parts = camera.width.div_ceil(columns);
    report::line(
        "bands",
        if parts > 1 { format!("{bands} of {parts} parts") } else { bands.to_string() },
    );
    report::method(method, &loaded.scene, camera);
    report::line("time", report::threads(exec));
    report::time("bands", vec![start.elapsed()]);
    report::line("file", picture.display());
    Ok(Ending::Good)
}

/// Draws a part of a band.
fn drawn(
    session: &mut Session<'_>,
    camera: &Camera,
    band: Rect,
    output: OutputSettings,
) -> Result<Frame<f32>> {
    session.set_region(Some(band))?;
    let drawn = match output.draw(session, camera)? {
        Cow::Owned(picture) => Some(picture),
        // The session holds it, and is going to draw the next band in other memory.
        Cow::Borrowed(_) => None,
    };
    let drawn = drawn.or_else(|| session.take_picture());
    drawn.map(|drawn| drawn.frame).ok_or_else(|| Error::Invalid("no part was drawn".into()))
}
