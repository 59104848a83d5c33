//! The errors of a candidate.

use super::bench::Bench;
use super::cameras;
use super::record::Measured;
use super::truths::Truths;
use crate::error::Result;
use crate::frame::{Exec, Frame};
use crate::io::scene_file::{Number, Ready};
use crate::scene::Objects;
use crate::study::report::chart::Loss;
use crate::study::sweep::Candidate;
use crate::verify::metrics::errors::{Errors, FIGURES, Figure, Reference};
use crate::verify::metrics::flicker;
use std::collections::BTreeMap;

/// The figures of flicker.
const FLICKERS: [Loss; 2] = [
    Loss { figure: "flicker_shift", title: "flicker under shifts, RMS", of: |v| v },
    Loss { figure: "flicker_path", title: "flicker along a path, RMS", of: |v| v },
];

/// Every figure as a loss, in the order of tables; the name is that of the figure.
#[must_use]
pub fn losses() -> Vec<Loss> {
    let of = |figure: &Figure| Loss { figure: figure.name, title: figure.title, of: figure.loss };
    FIGURES.iter().map(of).chain(FLICKERS).collect()
}

/// How many surfels a scene shows.
fn drawn(ready: &Ready) -> u64 {
    let scene = &ready.loaded.scene;
    scene.objects.as_ref().map_or(scene.surfels.len() as u64, Objects::drawn_total)
}

/// Draws a candidate and measures its errors, with what is needed of the [still](Truths::still) truth; the picture, too.
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
    (truths, reference): (&Truths, &Reference<'_>),
    exec: &Exec,
) -> Result<(Measured, Frame<f32>)> {
    let output = candidate.file.output;
    let mut visit = bench.visit(candidate, &|_, _, _| ())?;
    let camera = visit.ready.camera;
    output.draw(&mut visit.session, &camera)?;
    let frame = output.draw(&mut visit.session, &camera)?.frame.clone();
    let errors = Errors::of(&frame, reference, exec)?;
    let mut known = BTreeMap::new();
    let mut know = |name: &str, value: Option<f64>| {
        // Of equal pictures the PSNR is infinite, which no file holds.
        known.extend(value.filter(|value| value.is_finite()).map(|value| (name.to_owned(), value)));
    };
    for figure in FIGURES {
        know(figure.name, (figure.of)(&errors));
    }
    let mut spectra = [Vec::new(), Vec::new()];
    if output.number == Number::F32 {
        let looks = [
            (cameras::shifted(&camera), &truths.still.shifted),
            (cameras::path(&camera), &truths.path),
        ];
        for ((spectrum, flickers), (cameras, truths)) in spectra.iter_mut().zip(FLICKERS).zip(looks)
        {
            if truths.is_empty() {
                continue;
            }
            let mut errors = flicker::Errors::default();
            for (camera, truth) in cameras.iter().zip(truths) {
                let picture = output.draw(&mut visit.session, camera)?;
                errors.push(picture.frame.color("")?, truth)?;
            }
            let flicker = errors.flicker();
            know(flickers.figure, Some(flicker.rms()));
            *spectrum = flicker.power;
        }
    }
    let surfels = drawn(visit.ready);
    let prepared = visit.prepared.as_secs_f64() * 1e3;
    Ok((Measured { surfels, prepared, figures: known, spectra }, frame))
}
