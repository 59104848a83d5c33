//! The means over the scenes of what is wrong with a picture: against EWA, and of shapes against the true picture. They
//! are why occluded is what lies behind, and why the template's level is that of the diameter.
//!
//! - RMSE and SSIM as in [`splatref::compare::metrics`], of the whole picture.
//! - Holes: empty pixels of the reference's interior, per mille of it. Spill: painted pixels of its
//!   exterior, per mille of what it covers. See [`splatref::compare::metrics::coverage`].
//! - Outline: how many pairs of pixels, side by side or one above the other, have one that is
//!   painted and one that is not, by that number of the reference; above 1 a silhouette is rougher,
//!   or there are holes.

use super::common::report::Table;
use super::common::shot::Shot;
use super::{Bench, EWA, Subject, methods, splatting};
use splatref::Result;
use splatref::compare::metrics::{coverage, summary};
use splatref::frame::image::Image;

/// What is measured of a picture.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Measures {
    pub(super) rmse: f64,
    ssim: f64,
    pub(super) holes: f64,
    spill: f64,
    outline: f64,
}

/// A row's title, and what a cell of it shows.
type Shown = (&'static str, fn(&Measures) -> String);

/// Rows against EWA, over all scenes, and against the truth, over the shapes.
const BY_EWA: [Shown; 3] = [
    ("RMSE to EWA", |m| format!("{:.4}", m.rmse)),
    ("SSIM to EWA", |m| format!("{:.3}", m.ssim)),
    ("holes, spill", |m| format!("{:.1}, {:.1}", m.holes, m.spill)),
];
const BY_TRUTH: [Shown; 3] = [
    ("RMSE to the truth", |m| format!("{:.4}", m.rmse)),
    ("SSIM to the truth", |m| format!("{:.3}", m.ssim)),
    ("outline to the truth", |m| format!("{:.2}", m.outline)),
];

impl Bench {
    /// The table. EWA is not measured against itself.
    pub(super) fn means(&self, subjects: &[Subject]) -> Result<()> {
        let methods = methods();
        let (mut by_ewa, mut by_truth) = (Vec::new(), Vec::new());
        for subject in subjects {
            let ewa = Shot::of(self.draw(subject, &subject.camera, &splatting())?);
            let truth = subject.shape.as_ref();
            let truth = truth.map(|s| self.truth(subject, s, &subject.camera)).transpose()?;
            let (mut first, mut second) = (vec![Measures::default()], Vec::new());
            second.extend(truth.as_ref().map(|truth| measure(&ewa, truth)));
            for (_, method) in &methods {
                let shot = Shot::of(self.draw(subject, &subject.camera, method)?);
                first.push(measure(&shot, &ewa));
                second.extend(truth.as_ref().map(|truth| measure(&shot, truth)));
            }
            by_ewa.push(first);
            by_truth.extend(truth.is_some().then_some(second));
        }
        println!("\nMeans");
        let names = methods.iter().map(|method| method.0);
        let mut table = Table::new(&["", EWA].into_iter().chain(names).collect::<Vec<_>>());
        let all = 0..=methods.len();
        for (title, show) in BY_EWA.iter().filter(|_| !by_ewa.is_empty()) {
            let cells: Vec<_> = all.clone().skip(1).map(|i| show(&mean(&by_ewa, i))).collect();
            table.row(&format!("{title} | | {}", cells.join(" | ")));
        }
        for (title, show) in BY_TRUTH.iter().filter(|_| !by_truth.is_empty()) {
            let cells: Vec<_> = all.clone().map(|i| show(&mean(&by_truth, i))).collect();
            table.row(&format!("{title} | {}", cells.join(" | ")));
        }
        table.publish(&self.arguments, "image-space.md", "means")
    }
}

/// The measures of a picture against a reference.
pub(super) fn measure(shot: &Shot, reference: &Shot) -> Measures {
    let width = shot.alpha.width() as usize;
    let [a, b] = [shot, reference].map(|shot| Image::from(&shot.to_frame()));
    let (rmse, ssim) =
        summary(&a, &b).map_or((0.0, 0.0), |found| (found.rmse, found.ssim.unwrap_or(0.0)));
    let (alpha, expected) = (shot.alpha.values(), reference.alpha.values());
    let counts = coverage(alpha, expected, width);
    let share = |part: u64, whole: u64, of: f64| of * part as f64 / whole.max(1) as f64;
    Measures {
        rmse,
        ssim,
        holes: share(counts.holes, counts.interior, 1e3),
        spill: share(counts.spill, counts.covered, 1e3),
        outline: share(outline(alpha, width), outline(expected, width), 1.0),
    }
}

/// Pairs of neighbours of which one is covered.
fn outline(alpha: &[f32], width: usize) -> u64 {
    let differ = |a: &f32, b: &f32| u64::from((*a > 0.0) != (*b > 0.0));
    let beside = alpha.chunks_exact(width).flat_map(|row| row.windows(2));
    let below = alpha.iter().zip(alpha.iter().skip(width));
    beside.map(|pair| differ(&pair[0], &pair[1])).sum::<u64>()
        + below.map(|(a, b)| differ(a, b)).sum::<u64>()
}

/// The mean over the scenes of a method's measures.
fn mean(rows: &[Vec<Measures>], method: usize) -> Measures {
    let of = |value: fn(&Measures) -> f64| {
        rows.iter().map(|row| value(&row[method])).sum::<f64>() / rows.len() as f64
    };
    Measures {
        rmse: of(|m| m.rmse),
        ssim: of(|m| m.ssim),
        holes: of(|m| m.holes),
        spill: of(|m| m.spill),
        outline: of(|m| m.outline),
    }
}
