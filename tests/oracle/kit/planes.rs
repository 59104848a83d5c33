//! What a picture holds: planes by name, numbers by pixel, bits.

use sha2::{Digest, Sha256};
use splatref::frame::{Frame, Samples};
use splatref::number::Exact;

/// A plane that must be there.
pub(crate) fn plane<'a, R: Exact>(frame: &'a Frame<R>, name: &str) -> &'a Samples<R> {
    frame.plane(name).unwrap_or_else(|| panic!("no plane '{name}'"))
}

/// The number at a pixel, three times if there is one.
pub(crate) fn at<R: Exact>(samples: &Samples<R>, i: usize) -> [f64; 3] {
    match samples {
        Samples::Scalar(plane) => [plane.values()[i].to_f64(); 3],
        Samples::Color(plane) | Samples::Vector(plane) => plane.values()[i].map(R::to_f64),
        Samples::Index(plane) => [f64::from(plane.values()[i]); 3],
        Samples::Count(plane) => [f64::from(plane.values()[i]); 3],
    }
}

/// [`at`] a pixel of a plane that must be there.
pub(crate) fn value<R: Exact>(frame: &Frame<R>, name: &str, i: usize) -> [f64; 3] {
    at(plane(frame, name), i)
}

/// As [`value`], one number.
pub(crate) fn number<R: Exact>(frame: &Frame<R>, name: &str, i: usize) -> f64 {
    value(frame, name, i)[0]
}

/// An index of a plane that must be one of indices.
pub(crate) fn index<R: Exact>(frame: &Frame<R>, name: &str, i: usize) -> u32 {
    match plane(frame, name) {
        Samples::Index(plane) => plane.values()[i],
        _ => panic!("'{name}' has no indices"),
    }
}

/// The numbers of a plane of one number a pixel.
pub(crate) fn scalars<'a, R: Exact>(frame: &'a Frame<R>, name: &str) -> &'a [R] {
    match plane(frame, name) {
        Samples::Scalar(plane) => plane.values(),
        _ => panic!("'{name}' is no scalar"),
    }
}

/// All numbers of a plane; none of one that is not there.
pub(crate) fn numbers<R: Exact>(frame: &Frame<R>, name: &str) -> Vec<f64> {
    match frame.plane(name) {
        Some(Samples::Scalar(p)) => p.values().iter().map(|v| v.to_f64()).collect(),
        Some(Samples::Color(p) | Samples::Vector(p)) => {
            p.values().iter().flatten().map(|v| v.to_f64()).collect()
        }
        Some(Samples::Index(p)) => p.values().iter().map(|v| f64::from(*v)).collect(),
        Some(Samples::Count(p)) => p.values().iter().map(|v| f64::from(*v)).collect(),
        None => Vec::new(),
    }
}

/// The indices of all pixels.
pub(crate) fn pixels<R>(frame: &Frame<R>) -> std::ops::Range<usize> {
    0..(frame.width * frame.height) as usize
}

/// The bits of a plane; through f64, which keeps those of f32 apart.
pub(crate) fn bits<R: Exact>(samples: &Samples<R>) -> Vec<u64> {
    let number = |v: R| v.to_f64().to_bits();
    match samples {
        Samples::Scalar(plane) => plane.values().iter().map(|v| number(*v)).collect(),
        Samples::Color(plane) | Samples::Vector(plane) => {
            plane.values().iter().flatten().map(|v| number(*v)).collect()
        }
        Samples::Index(plane) => plane.values().iter().map(|v| u64::from(*v)).collect(),
        Samples::Count(plane) => plane.values().iter().map(|v| u64::from(*v)).collect(),
    }
}

/// One hash of all planes and their names.
pub(crate) fn digest<R: Exact>(frame: &Frame<R>) -> Vec<u8> {
    let mut hash = Sha256::new();
    for plane in &frame.planes {
        hash.update(plane.name.as_bytes());
        for value in bits(&plane.samples) {
            hash.update(value.to_le_bytes());
        }
    }
    hash.finalize().to_vec()
}

/// A -0 or a NaN, which no plane may hold.
pub(crate) fn unclean<R: Exact>(frame: &Frame<R>) -> Option<&str> {
    let negative_zero = (-0.0_f64).to_bits();
    let bad = |v: &u64| *v == negative_zero || f64::from_bits(*v).is_nan();
    let floats = |s: &Samples<R>| !matches!(s, Samples::Index(_) | Samples::Count(_));
    let plane =
        frame.planes.iter().find(|p| floats(&p.samples) && bits(&p.samples).iter().any(bad));
    plane.map(|p| p.name.as_str())
}
