//! The errors of a candidate.

use super::bench::Bench;
use super::cameras;
use super::record::Measured;
use super::truths::Truths;
use crate::error::Result;
use crate::frame::{Exec, Frame};
use crate::io::scene_file::{Number, OutputSettings};
use crate::method::Session;
use crate::scene::Camera;
use crate::study::sweep::Candidate;
use crate::verify::metrics::{Errors, Flicker};
use std::collections::BTreeMap;

/// Draws a candidate and measures its errors; the picture, too.
///
/// The picture is the second of two of one camera: `deferred` shows what it has come to where
/// nothing moves. Flicker is measured on the pictures of [`cameras`], in their order, of which each
/// goes on from the one before; not in f64, whose pictures differ from those in f32 by rounding
/// alone and take many times as long.
///
/// # Errors
/// As [`Bench::visit`] and of the drawing.
pub fn measure(
    bench: &mut Bench<'_>,
    candidate: &Candidate,
    truths: &Truths,
    exec: &Exec,
) -> Result<(Measured, Frame<f32>)> {
    let output = candidate.file.output;
    let mut visit = bench.visit(candidate, &|_, _, _| ())?;
    let camera = visit.ready.camera;
    output.draw(&mut visit.session, &camera)?;
    let frame = output.draw(&mut visit.session, &camera)?.frame.clone();
    let errors = Errors::of(&frame, &truths.still.frame, exec)?;
    let mut figures: BTreeMap<String, f64> = errors
        .figures()
        .into_iter()
        .filter_map(|(name, value)| Some((name.to_owned(), value.filter(|v| v.is_finite())?)))
        .collect();
    let mut spectra = [Vec::new(), Vec::new()];
    if output.number == Number::F32 {
        let looks = [
            ("flicker_shift", cameras::shifted(&camera), &truths.shifted),
            ("flicker_path", cameras::path(&camera), &truths.path),
        ];
        for (spectrum, (name, cameras, truths)) in spectra.iter_mut().zip(looks) {
            let flicker = flicker(&mut visit.session, output, &cameras, truths)?;
            figures.insert(name.to_owned(), flicker.rms());
            *spectrum = flicker.power;
        }
    }
    let surfels = visit.ready.loaded.surfels_drawn();
    let prepared = visit.prepared.as_secs_f64() * 1e3;
    Ok((Measured { surfels, prepared, figures, spectra }, frame))
}
