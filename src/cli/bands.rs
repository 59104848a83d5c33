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

/// A part of this many columns or fewer is not divided.
const LEAST_COLUMNS: u32 = 32;

/// Whether a part of the picture fits into half of the memory that is left, and whether a smaller part would
/// read less of a folder. The other half is for the blocks of the file.
fn fits(
    session: &mut Session<'_>,
    ready: &Ready,
    part: Rect,
    output: OutputSettings,
) -> Result<(bool, bool)> {
    session.set_region(Some(part))?;
    // What a part reads of a folder is not in the session yet.
    let (surfels, held) = ready.most_of_part(part);
    let making = output.making();
    let read = surfels * session.needs_a_splat(making) + held;
    let needs = session.needs(&ready.camera, making) + read;
    Ok((needs <= memory::left() / 2, read > 0))
}

/// The most rows of a band with which every band fits: all, or half as many, and so on.
fn most_rows(session: &mut Session<'_>, ready: &Ready, output: OutputSettings) -> Result<u32> {
    let [width, height] = ready.camera.size();
    let mut rows = height;
    loop {
        rows = rows.next_multiple_of(exr::BLOCK_LINES);
        if rows == exr::BLOCK_LINES {
            return Ok(rows);
        }
        let mut all_fit = true;
        for y0 in (0..height).step_by(rows as usize) {
            let band = Rect { x0: 0, y0, x1: width, y1: height.min(y0 + rows) };
            all_fit = fits(session, ready, band, output)?.0;
            if !all_fit {
                break;
            }
        }
        if all_fit {
            return Ok(rows);
        }
        rows = rows.div_ceil(2);
    }
}

/// Draws a picture in bands of rows into the file `picture`.
pub(super) fn render(
    session: &mut Session<'_>,
    ready: &Ready,
    to: &Destination<'_>,
    picture: &Path,
    output: OutputSettings,
    count: Count,
    exec: &Exec,
) -> Ended {
    let start = Instant::now();
    let Ready { loaded, camera, method, .. } = ready;
    to.make_folder()?;
    let text = provenance::text(&loaded.scene, session.groups(), camera, method, output);
    let rows = match count {
        Count::About(count) => camera.height.div_ceil(count),
        Count::Auto => most_rows(session, ready, output)?,
    };
    let divides = matches!(count, Count::Auto);
    let steps = progress::Steps::new("rendering");
    let (mut bands, mut parts) = (0_u32, 0_u32);
    let mut draw = |band: Rect| {
        steps.show("bands", band.y0.into(), camera.height.into());
        bands += 1;
        band_of_parts(session, ready, band, output, divides, exec, &mut parts)
    };
    exr::pending_bands(picture, camera.size(), rows, &text, output.compression, exec, &mut draw)?
        .put()?;
    drop(steps);
    report::scene(loaded);
    report::camera(camera);
    report::picture(camera, output);
    let text = if parts > bands { format!("{bands} of {parts} parts") } else { bands.to_string() };
    report::line("bands", text);
    report::method(method, &loaded.scene, camera);
    report::line("time", report::threads(exec));
    report::time("bands", vec![start.elapsed()]);
    report::line("file", picture.display());
    Ok(Ending::Good)
}

/// Draws a band or a part of it. If it `divides` and shows more surfels of a folder than fit, each half is
/// drawn by itself.
fn band_of_parts(
    session: &mut Session<'_>,
    ready: &Ready,
    part: Rect,
    output: OutputSettings,
    divides: bool,
    exec: &Exec,
    parts: &mut u32,
) -> Result<Frame<f32>> {
    if divides && part.x1 - part.x0 > LEAST_COLUMNS {
        let (fits, reads) = fits(session, ready, part, output)?;
        if !fits && reads {
            let middle = part.x0.midpoint(part.x1);
            let halves = [Rect { x1: middle, ..part }, Rect { x0: middle, ..part }];
            let mut draw = |half| band_of_parts(session, ready, half, output, divides, exec, parts);
            let left = draw(halves[0])?;
            return left.beside(&draw(halves[1])?);
        }
    }
    *parts += 1;
    let Ready { camera, method, .. } = ready;
    match ready.part(Some(part), exec)? {
        Some(scene) => drawn(&mut Session::new(&scene, *method, exec)?, camera, part, output),
        None => drawn(session, camera, part, output),
    }
}

/// Draws a part of the picture.
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
