//! The planes that a client hands in.

use super::Client;
use super::bug::Bug;
use super::compositing::Surface;
use super::images::{Image, Kept};
use crate::verify::client::number::Vector;
use crate::verify::client::shade::Shader;
use crate::verify::client::targets::srgb;
use splatref::Frame;
use splatref::frame::{NO_ID, Plane, Samples};

/// The planes so far.
struct Sheet {
    size: [u32; 2],
    flipped: bool,
    colored: bool,
    frame: Frame<f32>,
}

impl Sheet {
    /// A plane of what is said of each pixel that has something.
    fn plane<T, V: Copy>(&self, of: &[Option<T>], empty: V, say: impl Fn(&T) -> V) -> Plane<V> {
        let [width, height] = self.size;
        let values: Vec<V> = of.iter().map(|cell| cell.as_ref().map_or(empty, &say)).collect();
        let rows = values.chunks(width as usize);
        let values = if self.flipped {
            rows.rev().flatten().copied().collect()
        } else {
            rows.flatten().copied().collect()
        };
        Plane::from_values(width, height, values)
    }

    fn scalar<T>(&mut self, name: &str, of: &[Option<T>], empty: f32, say: impl Fn(&T) -> f32) {
        let plane = self.plane(of, empty, say);
        self.frame.push(name, Samples::Scalar(plane)).unwrap();
    }

    fn index<T>(&mut self, name: &str, of: &[Option<T>], say: impl Fn(&T) -> u32) {
        let plane = self.plane(of, NO_ID, say);
        self.frame.push(name, Samples::Index(plane)).unwrap();
    }

    fn vector<T>(&mut self, name: &str, of: &[Option<T>], say: impl Fn(&T) -> [f32; 3]) {
        let plane = self.plane(of, [0.0; 3], say);
        self.frame.push(name, Samples::Vector(plane)).unwrap();
    }

    /// Colours of surfels, if the scene has some.
    fn color<T>(&mut self, name: &str, of: &[Option<T>], say: impl Fn(&T) -> [f32; 3]) {
        if self.colored {
            self.picture(name, of, say);
        }
    }

    fn picture<T>(&mut self, name: &str, of: &[Option<T>], say: impl Fn(&T) -> [f32; 3]) {
        let plane = self.plane(of, [0.0; 3], say);
        self.frame.push(name, Samples::Color(plane)).unwrap();
    }
}

/// Every plane of the method.
pub(super) fn frame(
    client: &Client<'_>,
    images: &[Image],
    surfaces: &[Option<Surface>],
) -> Frame<f32> {
    let [width, height] = client.shared.size;
    let mut sheet = Sheet {
        size: [width, height],
        flipped: client.has(Bug::RowsFlipped),
        colored: client.shared.scene.surfels.color().is_some(),
        frame: Frame::new(width, height),
    };
    for (group, image) in images.iter().enumerate() {
        leave_image(client, &mut sheet, &format!("group{group:02}"), image);
    }
    sheet.color("sums", surfaces, |pixel| pixel.sums.color);
    sheet.vector("sums.normal", surfaces, |pixel| pixel.sums.normal);
    sheet.scalar("sums.weight", surfaces, 0.0, |pixel| pixel.sums.weight);
    let counts = sheet.plane(surfaces, 0, |pixel| pixel.sums.count);
    sheet.frame.push("sums.count", Samples::Count(counts)).unwrap();
    sheet.color("resolved", surfaces, |pixel| pixel.color);
    sheet.scalar("Z", surfaces, f32::INFINITY, |pixel| pixel.depth);
    sheet.vector("normal", surfaces, |pixel| pixel.normal);
    sheet.scalar("weight", surfaces, 0.0, |pixel| pixel.sums.weight);
    sheet.index("id", surfaces, |pixel| pixel.id);
    let shaded = shaded(client, surfaces);
    sheet.picture("", &shaded, |color| *color);
    sheet.scalar("A", surfaces, 0.0, |_| 1.0);
    sheet.frame
}

fn leave_image(client: &Client<'_>, sheet: &mut Sheet, name: &str, image: &[Option<Kept>]) {
    let three = |vector: Vector| vector.map(|number| number.value);
    sheet.scalar(&format!("{name}.Z"), image, f32::INFINITY, |kept: &Kept| kept.depth);
    sheet.index(&format!("{name}.id"), image, |kept| kept.surfel);
    sheet.scalar(&format!("{name}.weight"), image, 0.0, |kept| kept.weight.value);
    sheet.vector(&format!("{name}.normal"), image, |kept| three(kept.normal));
    sheet.color(name, image, |kept| three(kept.color));
    if client.bins.is_some() {
        sheet.scalar(&format!("{name}.voronoi"), image, f32::INFINITY, |kept| kept.voronoi);
    }
}

/// The picture.
fn shaded(client: &Client<'_>, surfaces: &[Option<Surface>]) -> Vec<Option<[f32; 3]>> {
    let width = client.shared.size[0] as usize;
    let shader = Shader::new(&client.shared);
    let pixels = surfaces.iter().enumerate().map(|(at, surface)| {
        let surface = surface.as_ref()?;
        let pixel = [at % width, at / width].map(|side| side as f32);
        let color = shader.shade(pixel, surface.depth, surface.normal, surface.color);
        Some(if client.has(Bug::Srgb) { color.map(srgb) } else { color })
    });
    let mut pixels: Vec<_> = pixels.collect();
    let mut covered: Vec<_> = pixels.iter_mut().flatten().collect();
    let middle = covered.len() / 2;
    if let (true, Some(color)) = (client.has(Bug::PixelNan), covered.get_mut(middle)) {
        color[1] = f32::NAN;
    }
    pixels
}
