//! The errors of a picture against the truth, together.

use super::{Coverage, Region, coverage, flip, outline, psnr, regions, rmse, ssim};
use crate::error::{Error, Result};
use crate::frame::{Exec, Frame, Plane};
use crate::number::elementary::{atan2, pow};

/// The errors of a picture; a figure is absent where it cannot be said.
///
/// Depth and normals are compared where both cover a pixel and the truth covers its neighbours, too
/// ([`Region::Interior`]): at the outline a pixel off is not an error of depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Of R, G and B together, linear.
    pub rmse: f64,
    /// The mean over the channels, see [`super::ssim()`].
    pub ssim: Option<f64>,
    /// The mean of [`mod@flip`].
    pub flip: f64,
    /// Pixels that only one covers, see [`super::coverage()`].
    pub coverage: Coverage,
    /// The length of the outline in px, see [`outline`].
    pub outline: f64,
    /// That of the truth.
    pub true_outline: f64,
    /// The root of the mean squared difference of depths, in world units.
    pub depth: Option<f64>,
    /// The root of the mean squared angle between normals, in degrees.
    pub normal: Option<f64>,
}

/// A true picture, and what comparing with it needs of it alone.
#[derive(Clone, Debug)]
pub struct Reference<'t> {
    truth: &'t Frame<f32>,
    seen: flip::Seen,
    regions: Vec<Region>,
    outline: f64,
}

impl<'t> Reference<'t> {
    /// Of a true picture with the colour (empty name), `A` and `Z`.
    ///
    /// # Errors
    /// [`Error::Invalid`] if it lacks a plane; as [`flip::Seen::of`].
    pub fn of(truth: &'t Frame<f32>, exec: &Exec) -> Result<Self> {
        let (alpha, width) = (truth.scalar("A")?.values(), truth.width as usize);
        let seen = flip::Seen::of(truth.color("")?, flip::PIXELS_PER_DEGREE, exec)?;
        let (regions, outline) = (regions(alpha, width), outline::length(alpha, width));
        Ok(Self { truth, seen, regions, outline })
    }
}

/// A figure of [`Errors`].
#[derive(Clone, Copy, Debug)]
pub struct Figure {
    /// What it is called in tables.
    pub name: &'static str,
    /// What its loss is, with its unit.
    pub title: &'static str,
    /// Its value.
    pub of: fn(&Errors) -> Option<f64>,
    /// What is the less the better, of a value.
    pub loss: fn(f64) -> f64,
}

/// Every figure, in the order of tables.
pub const FIGURES: [Figure; 9] = [
    figure("rmse", "RMSE, linear RGB", |e| Some(e.rmse)),
    Figure {
        loss: |v| pow(10.0, -v / 20.0),
        ..figure("psnr", "RMSE of the PSNR", |e| Some(psnr(e.rmse)))
    },
    Figure { loss: |v| 1.0 - v, ..figure("ssim", "1 - SSIM", |e| e.ssim) },
    figure("flip", "FLIP, mean", |e| Some(e.flip)),
    figure("holes", "holes, per mille of what is covered", |e| e.of_covered(e.coverage.holes)),
    figure("spill", "spill, per mille of what is covered", |e| e.of_covered(e.coverage.spill)),
    figure("outline", "outline, per cent off", |e| e.outline_off()),
    figure("depth", "depth, RMSE in world units", |e| e.depth),
    figure("normal", "normal, RMS in degrees", |e| e.normal),
];

const fn figure(name: &'static str, title: &'static str, of: fn(&Errors) -> Option<f64>) -> Figure {
    Figure { name, title, of, loss: |v| v }
}

impl Errors {
    /// The errors of the planes of a picture: the colour (empty name), `A`, `Z` and, where the truth has
    /// it too, `normal`.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the two are not of one size or lack a plane; as [`flip::Seen::of`].
    pub fn of(picture: &Frame<f32>, reference: &Reference<'_>, exec: &Exec) -> Result<Self> {
        let Reference { truth, seen, regions, outline } = reference;
        if (picture.width, picture.height) != (truth.width, truth.height) {
            return Err(Error::Invalid("a picture and its truth are of one size".into()));
        }
        let width = truth.width as usize;
        let color = picture.color("")?;
        let [found, expected] = [color, truth.color("")?].map(channels);
        let similar = exec.ordered(vec![0, 1, 2], |c: usize| ssim(&found[c], &expected[c], width));
        let similar = similar.into_iter().sum::<Option<f64>>();
        let seen_here = flip::Seen::of(color, flip::PIXELS_PER_DEGREE, exec)?;
        let alphas = [picture.scalar("A")?.values(), truth.scalar("A")?.values()];
        let inside: Vec<usize> = (0..regions.len())
            .filter(|&i| regions[i] == Region::Interior && alphas[0][i] > 0.0)
            .collect();
        let depths = [picture.scalar("Z")?.values(), truth.scalar("Z")?.values()];
        let depth = inside.iter().map(|&i| f64::from(depths[0][i]) - f64::from(depths[1][i]));
        let normal = match (picture.vector("normal"), truth.vector("normal")) {
            (Ok(found), Ok(expected)) => {
                root_mean(inside.iter().map(|&i| angle(found.values()[i], expected.values()[i])))
            }
            _ => None,
        };
        Ok(Self {
            rmse: rmse(&found.concat(), &expected.concat()),
            ssim: similar.map(|sum| sum / 3.0),
            flip: flip::mean(&seen_here.differences(seen, exec)?),
            coverage: coverage(alphas[0], alphas[1], width),
            outline: outline::length(alphas[0], width),
            true_outline: *outline,
            depth: root_mean(depth),
            normal,
        })
    }

    /// A count per mille of what the truth covers.
    fn of_covered(&self, count: u64) -> Option<f64> {
        let covered = self.coverage.covered;
        (covered > 0).then(|| 1000.0 * count as f64 / covered as f64)
    }

    /// By how many per cent the outline is longer or shorter than the true one.
    fn outline_off(&self) -> Option<f64> {
        let off = 100.0 * (self.outline / self.true_outline - 1.0).abs();
        (self.true_outline > 0.0).then_some(off)
    }
}

fn channels(plane: &Plane<[f32; 3]>) -> [Vec<f32>; 3] {
    [0, 1, 2].map(|c| plane.values().iter().map(|color| color[c]).collect())
}

/// The root of the mean square; none of nothing.
fn root_mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0_u64);
    for value in values {
        sum += value * value;
        count += 1;
    }
    (count > 0).then(|| (sum / count as f64).sqrt())
}

/// The angle between two vectors in degrees, of any lengths: that of the sine and the cosine.
fn angle(a: [f32; 3], b: [f32; 3]) -> f64 {
    let [a, b] = [a, b].map(|v| glam::Vec3::from_array(v).as_dvec3());
    atan2(a.cross(b).length(), a.dot(b)).to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Samples;

    /// Colour, depth and normal.
    type Pixel = ([f32; 3], f32, [f32; 3]);

    fn frame(size: [u32; 2], of: impl Fn(u32, u32) -> Pixel) -> Frame<f32> {
        let pixels = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
        let all: Vec<_> = pixels.map(|(x, y)| of(x, y)).collect();
        let plane = |of: &dyn Fn(f32) -> f32| {
            Plane::from_values(size[0], size[1], all.iter().map(|p| of(p.1)).collect())
        };
        let vectors = |of: &dyn Fn(&Pixel) -> [f32; 3]| {
            Plane::from_values(size[0], size[1], all.iter().map(of).collect())
        };
        let mut frame = Frame::new(size[0], size[1]);
        frame.push("", Samples::Color(vectors(&|p| p.0))).unwrap();
        frame.push("A", Samples::Scalar(plane(&|z| f32::from(u8::from(z.is_finite()))))).unwrap();
        frame.push("Z", Samples::Scalar(plane(&|z| z))).unwrap();
        frame.push("normal", Samples::Vector(vectors(&|p| p.2))).unwrap();
        frame
    }

    /// A square of 10 x 10 px in the middle of 20 x 20.
    fn square(shift: u32, depth: f32, normal: [f32; 3]) -> Frame<f32> {
        frame([20, 20], |x, y| {
            let inside = (5 + shift..15 + shift).contains(&x) && (5..15).contains(&y);
            if inside { ([0.5; 3], depth, normal) } else { ([0.0; 3], f32::INFINITY, [0.0; 3]) }
        })
    }

    fn errors(picture: &Frame<f32>, truth: &Frame<f32>) -> Result<Errors> {
        let exec = Exec::sequential();
        Errors::of(picture, &Reference::of(truth, &exec)?, &exec)
    }

    #[test]
    fn the_truth_has_no_error() {
        let truth = square(0, 3.0, [0.0, 0.0, 1.0]);
        let errors = errors(&truth, &truth).unwrap();
        for Figure { name, of, loss, .. } in FIGURES {
            let value = of(&errors).unwrap();
            assert!(
                if name == "psnr" { value == f64::INFINITY } else { loss(value) == 0.0 },
                "{name} {value}"
            );
        }
    }

    #[test]
    fn each_error_by_hand() {
        let truth = square(0, 3.0, [0.0, 0.0, 1.0]);
        let deep = errors(&square(0, 3.5, [0.0, 1.0, 1.0]), &truth).unwrap();
        assert!((deep.depth.unwrap() - 0.5).abs() < 1e-12);
        assert!((deep.normal.unwrap() - 45.0).abs() < 1e-12);
        assert_eq!([deep.rmse, deep.flip, deep.outline - deep.true_outline], [0.0; 3]);
        let moved = errors(&square(2, 3.0, [0.0, 0.0, 1.0]), &truth).unwrap();
        // Two columns are uncovered, of which 8 px are interior, and two covered, of which 12 are outside.
        assert!((moved.rmse - (40.0 * 0.25 / 400.0_f64).sqrt()).abs() < 1e-12);
        let Coverage { holes, spill, .. } = moved.coverage;
        assert_eq!((holes, spill), (8, 10));
        let holes = FIGURES.iter().find(|figure| figure.name == "holes").unwrap();
        assert_eq!((holes.of)(&moved), Some(80.0));
        assert_eq!(moved.depth, Some(0.0), "of pixels that both cover");
        let empty = frame([20, 20], |_, _| ([0.0; 3], f32::INFINITY, [0.0; 3]));
        let nothing = errors(&empty, &empty).unwrap();
        let absent = FIGURES.iter().filter(|figure| (figure.of)(&nothing).is_none());
        let names: Vec<_> = absent.map(|figure| figure.name).collect();
        assert_eq!(names, ["holes", "spill", "outline", "depth", "normal"]);
        assert!(errors(&frame([3, 3], |_, _| ([0.0; 3], 1.0, [0.0; 3])), &truth).is_err());
    }

    #[test]
    fn small_pictures_have_no_ssim() {
        let small = frame([10, 12], |x, y| ([(x + y) as f32 / 30.0; 3], 1.0, [0.0, 0.0, 1.0]));
        let errors = errors(&small, &small).unwrap();
        assert_eq!(errors.ssim, None);
    }
}
