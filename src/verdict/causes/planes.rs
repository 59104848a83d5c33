//! Planes of a client with a mistake undone.

use crate::frame::{Frame, Plane, Rect, Samples};
use crate::method::tiled::pixels;
use crate::number::{MapInline, elementary};
use crate::verdict::client::{Client, Storage};
use std::sync::Arc;

/// The planes of colours: the picture, its averages and its sums.
pub(super) const COLORS: [&str; 3] = ["", "resolved", "attributes"];

/// The planes of unit normals.
const NORMALS: [&str; 2] = ["normal", "projection.normal"];

/// The pixels of any plane that the verdict on a rectangle may read: its own; those of a finer level
/// below it; and those of every coarser level above it, with the widest template around them.
fn read_beside(rect: Rect) -> impl Iterator<Item = Rect> {
    let Rect { x0, y0, x1, y1 } = rect;
    let below = Rect { x0: 2 * x0, y0: 2 * y0, x1: 2 * x1, y1: 2 * y1 };
    let above = (0..u32::BITS / 2).map(move |level| {
        let [x0, y0] = [x0, y0].map_inline(|at| (at >> level).saturating_sub(TEMPLATE));
        let [x1, y1] = [x1, y1].map_inline(|end| (end >> level) + 1 + TEMPLATE);
        Rect { x0, y0, x1, y1 }
    });
    above.chain([below])
}

/// No template reaches so many cells from its middle.
const TEMPLATE: u32 = 4;

impl Client {
    /// A plane whose numbers are computed. Where a part of the picture is judged, only those are that
    /// its verdict may read: copies of whole planes would take longer than the verdict.
    fn computed<T>(&self, [width, height]: [u32; 2], value: impl Fn(u32, u32) -> T) -> Plane<T>
    where
        T: Copy + Default,
    {
        let Some(pieces) = &self.part else { return Plane::from_pixels([width, height], value) };
        let mut plane = Plane::filled(width, height, T::default());
        let whole = Rect::of_size([width, height]);
        let read = pieces.iter().flat_map(|(_, rect)| read_beside(*rect));
        for (x, y) in read.flat_map(|rect| pixels(rect.intersection(&whole))) {
            plane.values_mut()[y as usize * width as usize + x as usize] = value(x, y);
        }
        plane
    }

    /// A plane with changed numbers.
    pub(super) fn changed<T>(&self, plane: &Plane<T>, of: impl Fn(&T) -> T) -> Plane<T>
    where
        T: Copy + Default,
    {
        self.computed([plane.width(), plane.height()], |x, y| of(plane.at(x, y)))
    }

    /// The numbers of a plane as they are.
    pub(super) fn same(&self, samples: &Samples<f64>) -> Samples<f64> {
        match samples {
            Samples::Scalar(plane) => Samples::Scalar(self.changed(plane, |&number| number)),
            Samples::Color(plane) => Samples::Color(self.changed(plane, |&color| color)),
            Samples::Vector(plane) => Samples::Vector(self.changed(plane, |&vector| vector)),
            // `deferred` draws what ids elsewhere list.
            Samples::Index(_) | Samples::Count(_) => samples.clone(),
        }
    }

    /// The planes with their rows in reverse order.
    pub(super) fn flipped(&self) -> Self {
        let radii = self.radii.iter().map(|(name, radii)| (name.clone(), radii.flipped()));
        let radii = radii.collect();
        let flipped = self.mapped(|_, samples| match samples {
            Samples::Scalar(plane) => Samples::Scalar(self.flipped_plane(plane)),
            Samples::Color(plane) => Samples::Color(self.flipped_plane(plane)),
            Samples::Vector(plane) => Samples::Vector(self.flipped_plane(plane)),
            Samples::Index(_) | Samples::Count(_) => samples.flipped(),
        });
        Self { radii, ..flipped }
    }

    fn flipped_plane<T: Copy + Default>(&self, plane: &Plane<T>) -> Plane<T> {
        let (width, height) = (plane.width(), plane.height());
        self.computed([width, height], |x, y| *plane.at(x, height - 1 - y))
    }

    /// The planes with normals read from \[0, 1\]. A null vector stays one.
    pub(super) fn signed(&self) -> Self {
        let signed = self.mapped(|name, samples| match samples {
            Samples::Vector(plane) if NORMALS.contains(&name) => {
                let of = |normal: &[f64; 3]| match normal {
                    [0.0, 0.0, 0.0] => [0.0; 3],
                    _ => normal.map_inline(|part| 2.0 * part - 1.0),
                };
                Samples::Vector(self.changed(plane, of))
            }
            other => self.same(other),
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
                Samples::Color(self.changed(plane, |color| of(*color)))
            }
            other => self.same(other),
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
