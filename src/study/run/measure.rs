//! Measures the errors of a candidate.

use super::bench::{Bench, Visit};
use super::cameras;
use super::loss::Loss;
use super::record::Measured;
use super::truths::Truths;
use crate::compare::metrics::{Better, Errors, Flicker, METRICS, Metric};
use crate::error::{Error, Result};
use crate::frame::{Exec, Frame};
use crate::io::scene_file::{Number, Ready};
use crate::method::Picture;
use crate::number::elementary::pow;
use crate::scene::{Camera, Objects};
use crate::study::sweep::Candidate;
use crate::study::truth::Truth;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::time::Instant;

/// The figures of flicker: under shifts, and along the path.
const FLICKERS: [(&str, &str); 2] =
    [("flicker-shift", "flicker under shifts"), ("flicker-path", "flicker along a path")];

/// Every figure as a loss, in the order of the tables.
#[must_use]
pub fn losses() -> Vec<Loss> {
    let of = |metric: &Metric| {
        let Metric { name, title, unit, better, .. } = *metric;
        let (before, of): (&str, fn(f64) -> f64) = match better {
            Better::Less => ("", |v| v),
            // A PSNR is shown as its RMSE; SSIM has no unit.
            Better::More if unit == "dB" => ("RMSE of the ", |v| pow(10.0, -v / 20.0)),
            Better::More => ("1 - ", |v| 1.0 - v),
            Better::NearOne => ("difference from 1 of ", |v| (v - 1.0).abs()),
        };
        let unit =
            if unit.is_empty() || unit == "dB" { String::new() } else { format!(", {unit}") };
        Loss { figure: name, title: format!("{before}{title}{unit}"), of }
    };
    let flicker = |&(name, title): &(&'static str, &str)| {
        let title = format!("{title}, RMS of luminance");
        Loss { figure: name, title, of: |v| v }
    };
    METRICS.iter().map(of).chain(FLICKERS.iter().map(flicker)).collect()
}

/// The loss of the figure with this name.
///
/// # Errors
/// [`Error::Usage`] with all names, if no figure has this name.
pub fn loss(name: &str) -> Result<Loss> {
    let all = losses();
    all.iter().find(|loss| loss.figure == name).cloned().ok_or_else(|| {
        let names: Vec<&str> = all.iter().map(|loss| loss.figure).collect();
        Error::Usage(format!("give one of {}", names.join(", ")))
    })
}

/// How many surfels a scene shows.
fn drawn(ready: &Ready) -> u64 {
    let scene = &ready.loaded.scene;
    scene.objects.as_ref().map_or(scene.surfels.len() as u64, Objects::drawn_total)
}

/// The error of the second of two pictures of a candidate, and its time in ms.
///
/// # Errors
/// As [`measure`].
pub fn picture_error(
    bench: &mut Bench,
    candidate: &Candidate,
    metric: &Metric,
    truth: &Truth,
    exec: &Exec,
) -> Result<(Option<f64>, f64)> {
    let mut visit = bench.visit(candidate, exec, &|_, _, _| ())?;
    let camera = visit.ready.camera;
    let (time, picture) = second(&mut visit, candidate, &camera)?;
    Ok((metric.between(&picture.frame, &truth.frame, exec)?, time))
}

/// The second of two pictures of a candidate, and its time in ms.
///
/// # Errors
/// As drawing.
pub fn second<'v>(
    visit: &'v mut Visit<'_>,
    candidate: &Candidate,
    camera: &Camera,
) -> Result<(f64, Cow<'v, Picture<f32>>)> {
    candidate.file.output.draw(&mut visit.session, camera)?;
    let start = Instant::now();
    let picture = candidate.file.output.draw(&mut visit.session, camera)?;
    Ok((start.elapsed().as_secs_f64() * 1e3, picture))
}

/// Draws a candidate and measures its errors; returns the picture too.
///
/// The picture is the second of two from one camera, because `deferred` needs a frame to settle.
/// Flicker is measured on the pictures of [`cameras`] in their order; each continues from the state
/// after the one before. It is not measured in f64, nor in emulated formats, because those pictures
/// differ from f32 only by rounding and take many times as long.
///
/// # Errors
/// As [`Bench::visit`] and as drawing.
pub fn measure(
    bench: &mut Bench,
    candidate: &Candidate,
    truths: &Truths,
    exec: &Exec,
) -> Result<(Measured, Frame<f32>)> {
    let output = candidate.file.output;
    let mut visit = bench.visit(candidate, exec, &|_, _, _| ())?;
    let camera = visit.ready.camera;
    if candidate.imitates {
        // Only the state after the first picture counts.
        visit.session.render(&camera)?;
    } else {
        output.draw(&mut visit.session, &camera)?;
    }
    let frame = output.draw(&mut visit.session, &camera)?.frame.clone();
    let errors = Errors::measure(&frame, &truths.still.frame, exec)?;
    let mut known = BTreeMap::new();
    let mut know = |name: &str, value: Option<f64>| {
        // Equal pictures have an infinite PSNR, which JSON cannot hold.
        known.extend(value.filter(|value| value.is_finite()).map(|value| (name.to_owned(), value)));
    };
    for metric in &METRICS {
        know(metric.name, (metric.of)(&errors));
    }
    let mut spectra = [Vec::new(), Vec::new()];
    if output.number == Number::F32 && !candidate.imitates {
        let looks = [
            (cameras::shifted(&camera), &truths.still.shifted),
            (cameras::path(&camera), &truths.path),
        ];
        for ((spectrum, (name, _)), (cameras, truths)) in
            spectra.iter_mut().zip(FLICKERS).zip(looks)
        {
            if truths.is_empty() {
                continue;
            }
            let mut errors = Flicker::new(camera.width, camera.height, cameras.len())?;
            for (camera, truth) in cameras.iter().zip(truths) {
                let picture = output.draw(&mut visit.session, camera)?;
                errors.push(picture.frame.color("")?, truth)?;
            }
            let found = errors.spectrum(exec)?;
            know(name, Some(found.flicker));
            *spectrum = found.power;
        }
    }
    let surfels = drawn(visit.ready);
    let prepared = visit.prepared.as_secs_f64() * 1e3;
    Ok((Measured { surfels, prepared, figures: known, spectra }, frame))
}
