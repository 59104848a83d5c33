//! Planes of a client with a mistake undone.

use crate::frame::{Frame, Samples};
use crate::number::{MapInline, elementary};
use crate::verdict::client::{Client, Storage};
use std::sync::Arc;

/// The planes of colours: the picture, its averages and its sums.
pub(super) const COLORS: [&str; 3] = ["", "resolved", "attributes"];

/// The planes of unit normals.
const NORMALS: [&str; 2] = ["normal", "projection.normal"];

impl Client {
    /// The planes with their rows in reverse order.
    pub(super) fn flipped(&self) -> Self {
        let radii = self.radii.iter().map(|(name, radii)| (name.clone(), radii.flipped()));
        let radii = radii.collect();
        Self { radii, ..self.mapped(|_, samples| samples.flipped()) }
    }

    /// The planes with normals read from \[0, 1\]. A null vector stays one.
    pub(super) fn signed(&self) -> Self {
        let signed = self.mapped(|name, samples| match samples {
            Samples::Vector(plane) if NORMALS.contains(&name) => {
                let of = |normal: &[f64; 3]| match normal {
                    [0.0, 0.0, 0.0] => [0.0; 3],
                    _ => normal.map_inline(|part| 2.0 * part - 1.0),
                };
                Samples::Vector(plane.map(of))
            }
            other => other.clone(),
        });
        // Halving and shifting rounded the normals.
        let lost = 2.0 / 16_777_216.0;
        let storage = Storage::Float { relative: lost, least: lost };
        NORMALS.into_iter().fold(signed, |client, name| match client.storage(name) {
            Storage::Single | Storage::Rounded => client.stored(name, storage),
            _ => client,
        })
    }

    /// The planes with changed colours in the planes of these names.
    pub(super) fn colors(&self, names: &[&str], of: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        self.mapped(|name, samples| match samples {
            Samples::Color(plane) if names.contains(&name) => {
                Samples::Color(plane.map(|color| of(*color)))
            }
            other => other.clone(),
        })
    }

    /// The client with the planes of some names alone.
    pub(super) fn with_planes(&self, some: impl Fn(&str) -> bool) -> Self {
        let Frame { width, height, ref planes } = *self.frame();
        let planes = planes.iter().filter(|plane| some(&plane.name)).cloned().collect();
        Self { frame: Arc::new(Frame { width, height, planes }), ..self.clone() }
    }

    /// Whether nearly all numbers of the client's sums are like this, and some of them are not 0.
    pub(super) fn sums_are(&self, like: impl Fn(f64) -> bool) -> bool {
        let [mut all, mut found] = [0_usize; 2];
        let mut count = |value: f64| {
            if value != 0.0 {
                all += 1;
                found += usize::from(like(value));
            }
        };
        for plane in &self.frame().planes {
            if !(plane.name == "weight" || plane.name.starts_with("attributes")) {
                continue;
            }
            match &plane.samples {
                Samples::Scalar(plane) => plane.values().iter().for_each(|value| count(*value)),
                Samples::Color(plane) | Samples::Vector(plane) => {
                    plane.values().iter().flatten().for_each(|value| count(*value));
                }
                Samples::Index(_) | Samples::Count(_) => {}
            }
        }
        all > 0 && 100 * found >= 99 * all
    }

    /// The client whose picture is decoded by a power.
    pub(super) fn to_power(&self, power: f64) -> Self {
        let raised = |part: f64| if part > 0.0 { elementary::pow(part, power) } else { part };
        // A shading language's power loses this much.
        let lost = 1.0 / 262_144.0;
        let storage = Storage::Float { relative: lost, least: lost };
        self.colors(&[""], |color| color.map_inline(raised)).stored("", storage)
    }
}
