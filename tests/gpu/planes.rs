//! What a client left, as planes that splatref judges.

use splatref::frame::{Frame, Plane, Samples};

/// A frame that takes pixels row by row.
pub(crate) struct Planes {
    size: [u32; 2],
    frame: Frame<f32>,
}

impl Planes {
    pub(crate) fn new(size: [u32; 2]) -> Self {
        Self { size, frame: Frame::new(size[0], size[1]) }
    }

    pub(crate) fn scalar(&mut self, name: &str, values: Vec<f32>) {
        let plane = self.plane(values);
        self.push(name, Samples::Scalar(plane));
    }

    pub(crate) fn index(&mut self, name: &str, values: Vec<u32>) {
        let plane = self.plane(values);
        self.push(name, Samples::Index(plane));
    }

    /// Counts, up to 255.
    pub(crate) fn count(&mut self, name: &str, values: impl Iterator<Item = u32>) {
        let plane = self.plane(values.map(|count| count.min(255) as u8).collect());
        self.push(name, Samples::Count(plane));
    }

    /// The first three of four numbers a pixel.
    pub(crate) fn color(&mut self, name: &str, values: &[[f32; 4]]) {
        let plane = self.plane(values.iter().map(|&[r, g, b, _]| [r, g, b]).collect());
        self.push(name, Samples::Color(plane));
    }

    pub(crate) fn vector(&mut self, name: &str, values: &[[f32; 4]]) {
        let plane = self.plane(values.iter().map(|&[x, y, z, _]| [x, y, z]).collect());
        self.push(name, Samples::Vector(plane));
    }

    pub(crate) fn frame(&self) -> &Frame<f32> {
        &self.frame
    }

    fn plane<T: Copy>(&self, values: Vec<T>) -> Plane<T> {
        Plane::from_values(self.size[0], self.size[1], values)
    }

    fn push(&mut self, name: &str, samples: Samples<f32>) {
        self.frame.push(name, samples).expect("a plane of the picture's size");
    }
}

/// The last of four numbers a pixel.
pub(crate) fn last(values: &[[f32; 4]]) -> Vec<f32> {
    values.iter().map(|&[.., last]| last).collect()
}

/// Four numbers a pixel, of 32 or 16 bits each.
pub(crate) fn fours(bytes: &[u8], half: bool) -> Vec<[f32; 4]> {
    let numbers: Vec<f32> = if half {
        bytes.as_chunks().0.iter().map(|&bytes| from_half(u16::from_le_bytes(bytes))).collect()
    } else {
        bytemuck::pod_collect_to_vec(bytes)
    };
    numbers.as_chunks().0.to_vec()
}

/// The number of a finite `f16`, exactly: its bits in the place of an `f32`'s, times the ratio of the biases.
fn from_half(bits: u16) -> f32 {
    let bits = u32::from(bits);
    f32::from_bits((bits & 0x8000) << 16 | (bits & 0x7fff) << 13) * f32::from_bits((254 - 15) << 23)
}
