//! The planes that a client hands in.

use super::Client;
use super::bug::Bug;
use super::levels::Level;
use super::projection::Sample;
use crate::verify::client::number::Number;
use crate::verify::client::shade::Shader;
use splatref::Frame;
use splatref::frame::{NO_ID, Plane, Samples};

/// A pixel before it is shaded.
#[derive(Clone, Copy)]
pub(super) struct Surface {
    pub(super) depth: f32,
    /// In world space.
    pub(super) normal: [f32; 3],
    pub(super) color: [f32; 3],
}

/// The planes so far.
pub(super) struct Sheet {
    size: [u32; 2],
    pub(super) colored: bool,
    pub(super) frame: Frame<f32>,
}

impl Sheet {
    pub(super) fn new(client: &Client<'_>) -> Self {
        let [width, height] = client.shared.size;
        let colored = client.shared.scene.surfels.color().is_some();
        Self { size: [width, height], colored, frame: Frame::new(width, height) }
    }

    /// A level in the upper left corner of a plane.
    fn plane<T: Copy, V: Copy>(
        &self,
        level: &Level<T>,
        empty: V,
        of: impl Fn(&T) -> V,
    ) -> Plane<V> {
        let [width, height] = self.size;
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| [x.into(), y.into()]));
        let values = pixels.map(|at| level.at(at).map_or(empty, |cell| of(&cell)));
        Plane::from_values(width, height, values.collect())
    }

    pub(super) fn scalar<T: Copy>(
        &mut self,
        name: &str,
        level: &Level<T>,
        empty: f32,
        of: impl Fn(&T) -> Number,
    ) {
        let plane = self.plane(level, empty, |cell| of(cell).value);
        self.frame.push(name, Samples::Scalar(plane)).unwrap();
    }

    pub(super) fn vector<T: Copy>(
        &mut self,
        name: &str,
        level: &Level<T>,
        of: impl Fn(&T) -> [Number; 3],
    ) {
        let plane = self.plane(level, [0.0; 3], |cell| of(cell).map(|component| component.value));
        self.frame.push(name, Samples::Vector(plane)).unwrap();
    }

    /// Colours, if the scene has some.
    pub(super) fn color<T: Copy>(
        &mut self,
        name: &str,
        level: &Level<T>,
        of: impl Fn(&T) -> [Number; 3],
    ) {
        if self.colored {
            let plane =
                self.plane(level, [0.0; 3], |cell| of(cell).map(|component| component.value));
            self.frame.push(name, Samples::Color(plane)).unwrap();
        }
    }

    pub(super) fn index<T: Copy>(&mut self, name: &str, level: &Level<T>, of: impl Fn(&T) -> u32) {
        let plane = self.plane(level, NO_ID, of);
        self.frame.push(name, Samples::Index(plane)).unwrap();
    }

    pub(super) fn count<T: Copy>(&mut self, name: &str, level: &Level<T>, of: impl Fn(&T) -> u8) {
        let plane = self.plane(level, 0, of);
        self.frame.push(name, Samples::Count(plane)).unwrap();
    }

    /// The planes of the projection.
    pub(super) fn projection(&mut self, samples: &Level<Sample>) {
        self.index("projection.id", samples, |sample| sample.id);
        self.count("projection.kind", samples, |_| 1);
        self.samples("projection", samples);
    }

    /// The planes of samples or of centres, but for the ids.
    pub(super) fn samples(&mut self, layer: &str, samples: &Level<Sample>) {
        let name = |plane: &str| format!("{layer}.{plane}");
        self.scalar(&name("Z"), samples, f32::INFINITY, |sample| sample.depth);
        self.vector(&name("normal"), samples, |sample| sample.normal);
        self.scalar(&name("extent"), samples, 0.0, |sample| sample.extent);
        self.scalar(&name("radius"), samples, 0.0, |sample| sample.radius);
        self.scalar(&name("center.X"), samples, 0.0, |sample| sample.center[0]);
        self.scalar(&name("center.Y"), samples, 0.0, |sample| sample.center[1]);
        self.color(layer, samples, |sample| sample.color);
    }

    /// The shaded picture, its opacity, depths and normals.
    pub(super) fn picture(&mut self, client: &Client<'_>, surfaces: &Level<Surface>) {
        let shader = Shader::new(&client.shared);
        let [width, height] = self.size;
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
        let mut picture: Vec<_> = pixels
            .zip(&surfaces.cells)
            .map(|(pixel, surface)| {
                surface.map_or([0.0; 3], |surface| shaded(client, &shader, pixel, surface))
            })
            .collect();
        let seen: Vec<_> = (0..picture.len()).filter(|&i| surfaces.cells[i].is_some()).collect();
        if let (true, Some(&middle)) = (client.has(Bug::PixelNan), seen.get(seen.len() / 2)) {
            picture[middle][1] = f32::NAN;
        }
        let picture = Plane::from_values(width, height, picture);
        self.frame.push("", Samples::Color(picture)).unwrap();
        let number = |value| client.number(value);
        self.scalar("A", surfaces, 0.0, |_| number(1.0));
        self.scalar("Z", surfaces, f32::INFINITY, |surface| number(surface.depth));
        self.vector("normal", surfaces, |surface| surface.normal.map(number));
    }
}

fn shaded(client: &Client<'_>, shader: &Shader<'_>, pixel: [u32; 2], at: Surface) -> [f32; 3] {
    let shaded = shader.shade(pixel.map(|side| side as f32), at.depth, at.normal, at.color);
    if client.has(Bug::SquareRootOfPicture) { shaded.map(f32::sqrt) } else { shaded }
}
