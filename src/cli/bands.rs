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

/// The most rows of a band with which every band fits into half of the memory that is left: all, or half
/// as many, and so on. The other half is for the blocks of the file.
fn most_rows(session: &mut Session<'_>, ready: &Ready, output: OutputSettings) -> Result<u32> {
    let Ready { camera, .. } = ready;
    let making = output.making();
    let [width, height] = camera.size();
    let mut rows = height;
    loop {
        rows = rows.next_multiple_of(exr::BLOCK_LINES);
        let band = |y: u32| Rect { x0: 0, y0: y, x1: width, y1: height.min(y + rows) };
        session.set_region(Some(band(0)))?;
        // What a band reads of a folder is not in the session yet.
        let read = (0..height).step_by(rows as usize).map(|y| {
            let (surfels, held) = ready.most_of_part(band(y));
            surfels * session.needs_a_splat(making) + held
        });
        let needs = session.needs(camera, making) + read.max().unwrap_or(0);
        if rows == exr::BLOCK_LINES || needs <= memory::left() / 2 {
            return Ok(rows);
        }
        rows = rows.div_ceil(2);
    }
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
    let rows = match count {
        Count::About(count) => camera.height.div_ceil(count),
        Count::Auto => most_rows(session, ready, output)?,
    };
    let steps = progress::Steps::new("rendering");
    let mut bands = 0_u32;
    let mut draw = |band: Rect| {
        steps.show("bands", band.y0.into(), camera.height.into());
        bands += 1;
        match ready.part(Some(band), exec)? {
            Some(part) => drawn(&mut Session::new(&part, *method, exec)?, camera, band, output),
            None => drawn(session, camera, band, output),
        }
    };
    let how = (output.compression, exec);
    exr::pending_bands(picture, (camera.size(), rows), &text, how, &mut draw)?.put()?;
    drop(steps);
    report::scene(loaded);
    report::camera(camera);
    report::picture(camera, output);
    report::line("bands", bands);
    report::method(method, &loaded.scene, camera);
    report::line("time", report::threads(exec));
    report::time("bands", vec![start.elapsed()]);
    report::line("file", picture.display());
    Ok(Ending::Good)
}

/// Draws a band.
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
    drawn.map(|drawn| drawn.frame).ok_or_else(|| Error::Invalid("no band was drawn".into()))
}
