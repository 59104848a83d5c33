//! Take all errors of a picture against its truth, and list them by name and unit.
//!
//! ```
//! use splatref::frame::{Exec, Frame, Plane, Samples};
//! use splatref::compare::metrics::{Errors, METRICS};
//!
//! let gray = |value| {
//!     Frame::new(16, 16)
//!         .with("", Samples::Color(Plane::filled(16, 16, [value; 3])))?
//!         .with("A", Samples::Scalar(Plane::filled(16, 16, 1.0)))?
//!         .with("Z", Samples::Scalar(Plane::filled(16, 16, 2.0_f32 + value)))
//! };
//! let errors = Errors::measure(&gray(0.25)?, &gray(0.5)?, &Exec::sequential())?;
//! for metric in &METRICS {
//!     if let Some(value) = (metric.of)(&errors) {
//!         println!("{}: {value} {}", metric.title, metric.unit); // RMSE: 0.25 linear RGB ...
//!     }
//! }
//! assert_eq!((errors.color.rmse, errors.depth.map(|e| e.max)), (0.25, Some(0.25)));
//! assert!(errors.normal.is_none(), "the frames have none");
//! # Ok::<(), splatref::Error>(())
//! ```

use super::rmse::mean_square;
use super::summary::channel;
use super::{
    Coverage, DepthError, NormalError, Region, Summary, coverage, depth, flip, normal, outline,
    regions, same_size,
};
use crate::error::{Error, Result};
use crate::frame::{Exec, Frame, Plane, Samples};
use crate::number::MapInline;

/// All errors of one picture.
///
/// A pixel is *covered* where a surface is seen: `A` > 0 and `Z` finite. An environment covers
/// nothing, because it has no depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// RMSE, PSNR and SSIM of the colours.
    pub color: Summary,
    /// The mean of [FLIP](flip::flip()) at [`flip::PIXELS_PER_DEGREE`].
    pub flip: f64,
    /// Holes and spill of the covered pixels.
    pub coverage: Coverage,
    /// The length of the [outline](outline::outline()) of the pixels that the picture covers, in
    /// pixels.
    pub outline: f64,
    /// The length of the truth's outline.
    pub true_outline: f64,
    /// Depth errors in the pixels that both pictures cover and that are interior in the truth. None
    /// if there are no such pixels.
    pub depth: Option<DepthError>,
    /// Normal errors in the same pixels, if both frames have normals.
    pub normal: Option<NormalError>,
}

impl Errors {
    /// Takes the errors of a picture against its truth. Give the frame of a
    /// [`Picture`](crate::method::Picture): its planes are the colour, `A`, `Z` and, where there is
    /// light, `normal`.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the frames differ in size or a plane other than `normal` is missing, or
    /// if there is not enough memory.
    pub fn measure(picture: &Frame<f32>, truth: &Frame<f32>, exec: &Exec) -> Result<Self> {
        Self::with(picture, truth, Wanted { ssim: true, flip: true }, exec)
    }

    fn with(picture: &Frame<f32>, truth: &Frame<f32>, wanted: Wanted, exec: &Exec) -> Result<Self> {
        let colors = [picture.color("")?, truth.color("")?];
        same_size(colors[0], colors[1])?;
        let [covered, expected] = [covered(picture)?, covered(truth)?];
        let width = truth.width as usize;
        let pairs = covered.iter().zip(&expected).zip(regions(&expected, width));
        // A scene without light has no normals, which is no error.
        let compared: Vec<bool> = pairs
            .map(|((covered, _), region)| *covered > 0.0 && region == Region::Interior)
            .collect();
        let depths = [picture.scalar("Z")?, truth.scalar("Z")?].map_inline(Plane::values);
        let normals = [picture, truth].map_inline(|frame| match frame.plane("normal") {
            Some(Samples::Vector(plane)) => Some(plane.values()),
            _ => None,
        });
        let normal = normals[0].zip(normals[1]).and_then(|(a, b)| normal(a, b, &compared));
        let distances = exec.ordered(vec![0, 1, 2], |c: usize| {
            let [a, b] = colors.map(|p| p.values().iter().map(|v| v[c]).collect::<Vec<f32>>());
            if wanted.ssim { channel(&a, &b, width) } else { (mean_square(&a, &b), None) }
        });
        let flip = if wanted.flip {
            flip(colors[0], colors[1], flip::PIXELS_PER_DEGREE, exec)?.mean
        } else {
            f64::NAN
        };
        Ok(Self {
            color: Summary::of_channels(&distances),
            flip,
            coverage: coverage(&covered, &expected, width),
            outline: outline(&covered, width),
            true_outline: outline(&expected, width),
            depth: depth(depths[0], depths[1], &compared),
            normal,
        })
    }

    /// Pixels in per mille of the pixels that the truth covers. None if the truth covers nothing.
    fn per_mille(&self, pixels: u64) -> Option<f64> {
        let covered = self.coverage.covered;
        (covered > 0).then(|| 1000.0 * pixels as f64 / covered as f64)
    }
}

/// Whether to take SSIM and FLIP, the two slowest numbers. A number that is not wanted is none or
/// NaN.
#[derive(Clone, Copy, Debug)]
struct Wanted {
    ssim: bool,
    flip: bool,
}

/// 1 where a frame shows a surface, else 0.
fn covered(frame: &Frame<f32>) -> Result<Vec<f32>> {
    let (alphas, depths) = (frame.scalar("A")?.values(), frame.scalar("Z")?.values());
    let pixels = alphas.iter().zip(depths);
    Ok(pixels.map(|(a, z)| if *a > 0.0 && z.is_finite() { 1.0 } else { 0.0 }).collect())
}

/// Which of two numbers is better.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Better {
    /// The smaller one; 0 is perfect.
    Less,
    /// The larger one.
    More,
    /// The one nearer to 1.
    NearOne,
}

/// A number of [`Errors`]: its names, and how to take it.
#[derive(Clone, Copy, Debug)]
pub struct Metric {
    /// The name in files and options: `rmse`.
    pub name: &'static str,
    /// The name in sentences and charts.
    pub title: &'static str,
    /// The unit; empty for a plain number.
    pub unit: &'static str,
    /// Which of two numbers is better.
    pub better: Better,
    /// Returns the number, or none where there is nothing to measure. PSNR of equal pictures is
    /// infinite.
    pub of: fn(&Errors) -> Option<f64>,
    /// Which slow numbers of [`Errors`] it needs.
    wanted: Wanted,
}

/// All numbers of [`Errors`].
pub const METRICS: [Metric; 17] = [
    metric("rmse", "RMSE", "linear RGB", Better::Less, |e| Some(e.color.rmse)),
    metric("psnr", "PSNR", "dB", Better::More, |e| Some(e.color.psnr)),
    Metric {
        wanted: Wanted { ssim: true, flip: false },
        ..metric("ssim", "SSIM", "", Better::More, |e| e.color.ssim)
    },
    Metric {
        wanted: Wanted { ssim: false, flip: true },
        ..metric("flip", "FLIP", "", Better::Less, |e| Some(e.flip))
    },
    metric("holes", "holes", "per mille", Better::Less, |e| e.per_mille(e.coverage.holes)),
    metric("holes-px", "holes", "px", Better::Less, |e| Some(e.coverage.holes as f64)),
    metric("spill", "spill", "per mille", Better::Less, |e| e.per_mille(e.coverage.spill)),
    metric("spill-px", "spill", "px", Better::Less, |e| Some(e.coverage.spill as f64)),
    metric("silhouette", "wrong at the silhouette", "per mille", Better::Less, |e| {
        e.per_mille(e.coverage.mismatch)
    }),
    metric("silhouette-px", "wrong at the silhouette", "px", Better::Less, |e| {
        Some(e.coverage.mismatch as f64)
    }),
    metric("outline", "outline", "of the true length", Better::NearOne, |e| {
        (e.true_outline > 0.0).then(|| e.outline / e.true_outline)
    }),
    metric("depth", "depth error, RMS", "world units", Better::Less, |e| Some(e.depth?.rms)),
    metric("depth-99", "depth error, 99 %", "world units", Better::Less, |e| Some(e.depth?.most)),
    metric("depth-max", "depth error, greatest", "world units", Better::Less, |e| {
        Some(e.depth?.max)
    }),
    metric("depth-relative", "depth error, RMS", "of the depth", Better::Less, |e| {
        Some(e.depth?.relative)
    }),
    metric("normal", "normal error, mean", "degrees", Better::Less, |e| Some(e.normal?.mean)),
    metric("normal-99", "normal error, 99 %", "degrees", Better::Less, |e| Some(e.normal?.most)),
];

const fn metric(
    name: &'static str,
    title: &'static str,
    unit: &'static str,
    better: Better,
    of: fn(&Errors) -> Option<f64>,
) -> Metric {
    Metric { name, title, unit, better, of, wanted: Wanted { ssim: false, flip: false } }
}

impl Metric {
    /// Takes this one number of a picture against its truth, the same as with [`Errors::measure`]. It is
    /// faster because it skips the slow numbers that it does not need.
    ///
    /// # Errors
    /// As [`Errors::measure`].
    pub fn between(
        &self,
        picture: &Frame<f32>,
        truth: &Frame<f32>,
        exec: &Exec,
    ) -> Result<Option<f64>> {
        Ok((self.of)(&Errors::with(picture, truth, self.wanted, exec)?))
    }

    /// The row of [`METRICS`] with this name.
    ///
    /// # Errors
    /// [`Error::Usage`] with all names, if no metric has this name.
    pub fn named(name: &str) -> Result<&'static Self> {
        const { &METRICS }.iter().find(|metric| metric.name == name).ok_or_else(|| {
            let names = METRICS.map_inline(|metric| metric.name).join(", ");
            Error::Usage(format!("no metric is called {name}; give one of: {names}"))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::elementary::{cos, sin};

    const SIZE: [u32; 2] = [40, 30];

    /// A gray disc of radius 8 on black, at a depth that grows to the right.
    fn disc() -> Frame<f32> {
        let inside = |x: u32, y: u32| {
            let (dx, dy) = (f64::from(x) - 19.5, f64::from(y) - 14.5);
            dx * dx + dy * dy < 64.0
        };
        frame(inside, |x| 4.0 + x as f32 / 8.0, [0.0, 0.0, 1.0])
    }

    fn frame(
        covered: impl Fn(u32, u32) -> bool,
        depth: impl Fn(u32) -> f32,
        normal: [f32; 3],
    ) -> Frame<f32> {
        let plane =
            |inside: f32, outside: f32| {
                Samples::Scalar(Plane::from_pixels(SIZE, |x, y| {
                    if covered(x, y) { inside } else { outside }
                }))
            };
        let three =
            |v: [f32; 3]| Plane::from_pixels(SIZE, |x, y| if covered(x, y) { v } else { [0.0; 3] });
        let depths =
            Plane::from_pixels(SIZE, |x, y| if covered(x, y) { depth(x) } else { f32::INFINITY });
        Frame::new(SIZE[0], SIZE[1])
            .with("", Samples::Color(three([0.5; 3])))
            .and_then(|f| f.with("A", plane(1.0, 0.0)))
            .and_then(|f| f.with("Z", Samples::Scalar(depths)))
            .and_then(|f| f.with("normal", Samples::Vector(three(normal))))
            .unwrap()
    }

    fn measured(picture: &Frame<f32>, truth: &Frame<f32>) -> Errors {
        let found = Errors::measure(picture, truth, &Exec::sequential()).unwrap();
        assert_eq!(Errors::measure(picture, truth, &Exec::new(3, 8).unwrap()).unwrap(), found);
        found
    }

    #[test]
    fn a_number_alone_is_that_of_all() {
        let tilted = [sin(0.25) as f32, 0.0, cos(0.25) as f32];
        let shrunk = frame(|x, y| (14..26).contains(&x) && (9..21).contains(&y), |_| 4.5, tilted);
        let empty = frame(|_, _| false, |_| 1.0, [0.0; 3]);
        for (picture, truth) in [(shrunk, disc()), (empty.clone(), disc()), (disc(), empty)] {
            let all = measured(&picture, &truth);
            for metric in &METRICS {
                let alone = metric.between(&picture, &truth, &Exec::sequential()).unwrap();
                let [alone, of_all] = [alone, (metric.of)(&all)].map(|v| v.map(f64::to_bits));
                assert_eq!(alone, of_all, "{}", metric.name);
            }
        }
    }

    fn number(errors: &Errors, name: &str) -> Option<f64> {
        (Metric::named(name).unwrap().of)(errors)
    }

    #[test]
    fn the_truth_itself_is_perfect() {
        let truth = disc();
        let found = measured(&truth, &truth);
        for metric in &METRICS {
            let value = (metric.of)(&found).unwrap();
            let perfect = match (metric.name, metric.better) {
                ("psnr", _) => f64::INFINITY,
                (_, Better::Less) => 0.0,
                (_, Better::More | Better::NearOne) => 1.0,
            };
            assert_eq!(value, perfect, "{}", metric.name);
        }
    }

    #[test]
    fn each_error_shows_in_its_number() {
        let truth = disc();
        let Some(Samples::Scalar(alphas)) = truth.plane("A") else { panic!("no A") };
        // A pixel in the middle is missing, and a pixel far away is there.
        let covered = |x, y| (*alphas.at(x, y) > 0.0 && (x, y) != (20, 14)) || (x, y) == (2, 3);
        let tilted = [sin(0.25) as f32, 0.0, cos(0.25) as f32];
        let picture = frame(covered, |x| 4.25 + x as f32 / 8.0, tilted);
        let found = measured(&picture, &truth);
        let total = found.coverage.covered as f64;
        let expected = [
            ("rmse", (2.0 * 0.25 / 1200.0_f64).sqrt()),
            ("holes", 1000.0 / total),
            ("holes-px", 1.0),
            ("spill", 1000.0 / total),
            ("spill-px", 1.0),
            ("silhouette", 0.0),
            ("depth", 0.25),
            ("depth-99", 0.25),
            ("depth-max", 0.25),
            ("normal", 0.25 * 180.0 / std::f64::consts::PI),
            ("normal-99", 0.25 * 180.0 / std::f64::consts::PI),
        ];
        for (name, expected) in expected {
            let value = number(&found, name).unwrap();
            assert!((value - expected).abs() < 1e-5, "{name}: {value} against {expected}");
        }
        // The disc is mirror symmetric about x = 19.5, except for the missing pixel.
        let relative = number(&found, "depth-relative").unwrap();
        assert!((relative - 0.25 / (4.0 + 19.5 / 8.0)).abs() < 1e-3, "{relative}");
        // Two more single pixels: 4 sides and 4 corners each.
        let more = 2.0 * std::f64::consts::FRAC_PI_8 * (4.0 + 8.0_f64.sqrt());
        assert!((found.outline - found.true_outline - more).abs() < 1e-9);
        assert!(number(&found, "flip").unwrap() > 0.0 && number(&found, "ssim").unwrap() < 1.0);
        let shrunk = frame(|x, y| (14..26).contains(&x) && (9..21).contains(&y), |_| 4.0, tilted);
        assert!(number(&measured(&shrunk, &truth), "silhouette-px").unwrap() > 0.0);
    }

    #[test]
    fn a_surface_is_not_compared_at_the_silhouette() {
        let (truth, mut picture) = (disc(), disc());
        let Samples::Scalar(depths) = &mut picture.planes[2].samples else { panic!("no Z") };
        // The uppermost row of the disc is y = 7.
        depths.values_mut()[7 * SIZE[0] as usize + 19] = 100.0;
        assert_eq!(measured(&picture, &truth), measured(&truth, &truth));
    }

    #[test]
    fn an_environment_covers_nothing() {
        let (truth, mut picture) = (disc(), disc());
        picture.planes[1].samples = Samples::Scalar(Plane::filled(SIZE[0], SIZE[1], 1.0));
        assert_eq!(measured(&picture, &truth), measured(&truth, &truth));
    }

    #[test]
    fn what_cannot_be_taken_is_none() {
        let (truth, empty) = (disc(), frame(|_, _| false, |_| 1.0, [0.0; 3]));
        let found = measured(&empty, &truth);
        assert_eq!((found.depth, found.normal), (None, None));
        assert_eq!((number(&found, "outline"), number(&found, "depth")), (Some(0.0), None));
        let found = measured(&truth, &empty);
        assert_eq!((number(&found, "outline"), number(&found, "holes")), (None, None));
        let mut unlit = disc();
        unlit.planes.pop();
        let found = measured(&unlit, &truth);
        assert!(found.normal.is_none() && found.depth.is_some());

        let exec = Exec::sequential();
        unlit.planes.pop();
        let said = Errors::measure(&unlit, &truth, &exec).unwrap_err().to_string();
        assert!(said.contains("no scalar plane is called `Z`"), "{said}");
        let small = Frame::new(2, 1).with("", Samples::Color(Plane::filled(2, 1, [0.0; 3])));
        let said = Errors::measure(&small.unwrap(), &truth, &exec).unwrap_err().to_string();
        assert!(said.contains("2 x 1 pixels and a reference of 40 x 30"), "{said}");
    }

    #[test]
    fn names_are_found_and_listed() {
        for metric in &METRICS {
            let same = METRICS.iter().filter(|other| other.name == metric.name).count();
            assert!(same == 1 && Metric::named(metric.name).is_ok(), "{}", metric.name);
        }
        let error = Metric::named("ssmi").unwrap_err();
        assert_eq!(error.exit_code(), 2);
        assert!(error.to_string().contains("no metric is called ssmi; give one of: rmse, psnr"));
    }
}
