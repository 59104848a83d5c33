//! What is rendered into, what is made of the sums, and the planes.

use super::bug::Bug;
use super::number::unit;
use super::shade::Shader;
use super::view::Shared;
use splatref::Frame;
use splatref::frame::{NO_ID, Plane, Samples};

/// What the attribute pass adds up at a pixel.
#[derive(Clone, Copy, Default)]
pub(crate) struct Sums {
    pub(crate) color: [f32; 3],
    pub(crate) normal: [f32; 3],
    pub(crate) weight: f32,
    pub(crate) count: u8,
}

/// The textures, row by row from the top left.
pub(crate) struct Targets {
    size: [u32; 2],
    pub(crate) nearness: Vec<f32>,
    pub(crate) depth: Vec<f32>,
    pub(crate) id: Vec<u32>,
    pub(crate) sums: Vec<Sums>,
}

/// What normalization and shading leave at a pixel.
#[derive(Clone, Copy)]
struct Resolved {
    color: [f32; 3],
    normal: [f32; 3],
    depth: f32,
    weight: f32,
    id: u32,
    picture: [f32; 3],
    alpha: f32,
}

impl Targets {
    /// Cleared textures.
    pub(crate) fn new(shared: &Shared<'_>) -> Self {
        let [width, height] = shared.size;
        let pixels = width as usize * height as usize;
        let count = u8::from(shared.how.has(Bug::CountOffByOne));
        Self {
            size: shared.size,
            nearness: vec![shared.empty(); pixels],
            depth: vec![f32::INFINITY; pixels],
            id: vec![NO_ID; pixels],
            sums: vec![Sums { count, ..Sums::default() }; pixels],
        }
    }

    /// Where a pixel is.
    pub(crate) fn index(&self, [x, y]: [u32; 2]) -> usize {
        y as usize * self.size[0] as usize + x as usize
    }

    /// The planes of all stages.
    pub(crate) fn finish(mut self, shared: &Shared<'_>) -> Frame<f32> {
        let covered: Vec<_> =
            (0..self.sums.len()).filter(|&at| self.sums[at].weight > 0.0).collect();
        let chosen = covered.get(covered.len() / 2).copied();
        if let (true, Some(at)) = (shared.how.has(Bug::WeightOff), chosen) {
            self.sums[at].weight *= 1.001;
        }
        let shader = Shader::new(shared);
        let mut resolved: Vec<_> =
            (0..self.sums.len()).map(|at| self.resolve(shared, &shader, at)).collect();
        if let (true, Some(at)) = (shared.how.has(Bug::PixelNan), chosen) {
            resolved[at].picture[1] = f32::NAN;
        }
        self.planes(shared, &resolved)
    }

    /// Sums over weights, and the light on them.
    fn resolve(&self, shared: &Shared<'_>, shader: &Shader<'_>, at: usize) -> Resolved {
        let sums = &self.sums[at];
        if !(sums.weight > 0.0) {
            let none = [0.0; 3];
            let (depth, id) = (f32::INFINITY, NO_ID);
            let (picture, alpha) = (none, 0.0);
            return Resolved { color: none, normal: none, depth, weight: 0.0, id, picture, alpha };
        }
        let weight = shared.number(sums.weight);
        let zero = shared.number(0.0); // turns -0 into +0
        let average = |sum: [f32; 3]| shared.vector(sum).map(|sum| sum / weight + zero);
        let color = match shared.how.bug {
            Some(Bug::ColorNotDivided) => sums.color,
            _ => average(sums.color).map(|color| color.value),
        };
        let normal = match shared.how.bug {
            Some(Bug::NormalNotUnit) => average(sums.normal),
            _ => unit(average(sums.normal)),
        };
        let normal = normal.map(|component| (component + zero).value);
        let width = self.size[0] as usize;
        let [x, y] = [at % width, at / width].map(|side| side as f32);
        let mut picture = shader.shade([x, y], self.depth[at], normal, color);
        if shared.how.has(Bug::Srgb) {
            picture = picture.map(srgb);
        }
        let (depth, id) = (self.depth[at], self.id[at]);
        Resolved { color, normal, depth, weight: sums.weight, id, picture, alpha: 1.0 }
    }

    fn planes(&self, shared: &Shared<'_>, resolved: &[Resolved]) -> Frame<f32> {
        let [width, height] = self.size;
        let flipped = shared.how.has(Bug::RowsFlipped);
        let scalar = |values| Samples::Scalar(plane(self.size, flipped, values));
        let color = |values| Samples::Color(plane(self.size, flipped, values));
        let vector = |values| Samples::Vector(plane(self.size, flipped, values));
        let index = |values| Samples::Index(plane(self.size, flipped, values));
        let counts = self.sums.iter().map(|sums| sums.count).collect();
        let colored = shared.scene.surfels.color().is_some();
        let mut planes = vec![
            ("visibility.Z", scalar(self.depth.clone())),
            ("visibility.id", index(self.id.clone())),
        ];
        if colored {
            planes.push(("attributes", color(self.sums.iter().map(|sums| sums.color).collect())));
        }
        planes.extend([
            ("attributes.normal", vector(self.sums.iter().map(|sums| sums.normal).collect())),
            ("attributes.weight", scalar(self.sums.iter().map(|sums| sums.weight).collect())),
            ("attributes.count", Samples::Count(plane(self.size, flipped, counts))),
        ]);
        if colored {
            planes.push(("resolved", color(resolved.iter().map(|pixel| pixel.color).collect())));
        }
        planes.extend([
            ("", color(resolved.iter().map(|pixel| pixel.picture).collect())),
            ("A", scalar(resolved.iter().map(|pixel| pixel.alpha).collect())),
            ("Z", scalar(resolved.iter().map(|pixel| pixel.depth).collect())),
            ("normal", vector(resolved.iter().map(|pixel| pixel.normal).collect())),
            ("weight", scalar(resolved.iter().map(|pixel| pixel.weight).collect())),
            ("id", index(resolved.iter().map(|pixel| pixel.id).collect())),
        ]);
        let mut frame = Frame::new(width, height);
        for (name, samples) in planes {
            frame.push(name, samples).unwrap();
        }
        frame
    }
}

fn plane<T: Clone>([width, height]: [u32; 2], flipped: bool, values: Vec<T>) -> Plane<T> {
    if !flipped {
        return Plane::from_values(width, height, values);
    }
    let rows = values.chunks(width as usize).rev();
    Plane::from_values(width, height, rows.flatten().cloned().collect())
}

pub(crate) fn srgb(linear: f32) -> f32 {
    if linear <= 0.003_130_8 {
        linear * 12.92
    } else {
        1.055 * core_math::powf(linear, 1.0 / 2.4) - 0.055
    }
}
