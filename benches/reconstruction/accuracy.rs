//! Accuracy of one picture: against EWA, and of shapes against the true picture.
//!
//! - RMSE and SSIM as in [`splatref::verify::metrics`], of the whole picture.
//! - Holes: empty pixels of the reference's interior, per mille of it. Spill: painted pixels of its
//!   exterior, per mille of what it covers. Edge: pixels of its silhouette that one of the two
//!   paints and the other does not, per cent. See [`splatref::verify::metrics::coverage`].
//! - Inside: the RMSE over the reference's interior, holes included. Behind: painted pixels there
//!   whose depth is more than 4 median radii greater than the reference's, before: less; per mille.
//! - Outline: how many pairs of pixels, side by side or one above the other, have one that is
//!   painted and one that is not, by that number of the reference; above 1 a silhouette is rougher,
//!   or there are holes.

use super::common::report::Table;
use super::common::shot::Shot;
use super::{Bench, EWA, Subject, methods, splatting};
use splatref::Result;
use splatref::frame::image::Image;
use splatref::frame::{Frame, NO_ID, Samples};
use splatref::method::Method;
use splatref::scene::Projection;
use splatref::verify::metrics::{Region, coverage, regions, summary};

/// What is measured of a picture.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Measures {
    pub(super) rmse: f64,
    ssim: f64,
    inside: f64,
    pub(super) holes: f64,
    spill: f64,
    edge: f64,
    behind: f64,
    before: f64,
    outline: f64,
}

/// A title, and what a cell under it shows.
type Shown = (&'static str, fn(&Measures) -> String);

const TABLES: [Shown; 3] = [
    ("RMSE, SSIM", |m| format!("{:.4}, {:.3}", m.rmse, m.ssim)),
    ("Holes (per mille), spill (per mille), edge (per cent), outline", |m| {
        format!("{:.2}, {:.2}, {:.0}, {:.2}", m.holes, m.spill, m.edge, m.outline)
    }),
    ("RMSE inside, behind (per mille), before (per mille)", |m| {
        format!("{:.4}, {:.2}, {:.2}", m.inside, m.behind, m.before)
    }),
];

/// Rows of the means: against EWA, over all scenes, and against the truth, over the shapes.
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

/// A scene's row: its name, surfels, median radius in pixels, and the measures of each method.
struct Row {
    title: String,
    cells: Vec<Measures>,
}

impl Bench {
    /// The tables against EWA, then those against true pictures.
    pub(super) fn accuracy(&self, subjects: &[Subject]) -> Result<()> {
        let (mut by_ewa, mut by_truth) = (Vec::new(), Vec::new());
        for subject in subjects {
            let frame = self.draw(subject, &subject.camera, &splatting())?;
            let radius = radius_in_pixels(subject, &frame);
            let title = format!("{} | {} | {radius:.1}", subject.name, subject.scene.surfels.len());
            let ewa = Shot::of(frame);
            self.keep(subject, EWA, &ewa)?;
            let truth = subject.shape.as_ref();
            let truth = truth.map(|s| self.truth(subject, s, &subject.camera)).transpose()?;
            let (mut first, mut second) = (Vec::new(), Vec::new());
            if let Some(truth) = &truth {
                self.keep(subject, "truth", truth)?;
                second.push(measure(subject, &ewa, truth));
            }
            for (name, method) in methods() {
                let shot = self.shoot(subject, name, &method)?;
                first.push(measure(subject, &shot, &ewa));
                second.extend(truth.as_ref().map(|truth| measure(subject, &shot, truth)));
            }
            by_ewa.push(Row { title: title.clone(), cells: first });
            by_truth.extend(truth.is_some().then_some(Row { title, cells: second }));
        }
        let methods = methods();
        let names: Vec<_> = methods.iter().map(|method| method.0).collect();
        let with_ewa: Vec<_> = [EWA].into_iter().chain(names.iter().copied()).collect();
        self.scenes("by-ewa", "EWA", &names, &by_ewa)?;
        self.scenes("by-truth", "the true picture", &with_ewa, &by_truth)?;
        self.means(&names, &by_ewa, &by_truth)
    }

    fn shoot(&self, subject: &Subject, name: &str, method: &Method) -> Result<Shot> {
        let shot = Shot::of(self.draw(subject, &subject.camera, method)?);
        self.keep(subject, name, &shot)?;
        Ok(shot)
    }
}

/// The median radius of the surfels that are seen, by EWA, in pixels.
fn radius_in_pixels(subject: &Subject, frame: &Frame<f32>) -> f32 {
    let (Some(Samples::Index(id)), Some(Samples::Scalar(depth))) =
        (frame.plane("id"), frame.plane("Z"))
    else {
        return 0.0;
    };
    let radius = subject.scene.surfels.radius();
    let perspective = subject.camera.projection == Projection::Perspective;
    let seen = id.values().iter().zip(depth.values()).filter(|(id, _)| **id != NO_ID);
    let mut pixels: Vec<f32> = seen
        .map(|(id, depth)| {
            let scale = if perspective { subject.camera.fy / depth } else { subject.camera.fy };
            radius[*id as usize] * scale
        })
        .collect();
    pixels.sort_by(f32::total_cmp);
    pixels.get(pixels.len() / 2).copied().unwrap_or(0.0)
}

/// The measures of a picture against a reference.
pub(super) fn measure(subject: &Subject, shot: &Shot, reference: &Shot) -> Measures {
    let width = shot.alpha.width() as usize;
    let [a, b] = [shot, reference].map(|shot| Image::from(&shot.to_frame()));
    let (rmse, ssim) =
        summary(&a, &b).map_or((0.0, 0.0), |found| (found.rmse, found.ssim.unwrap_or(0.0)));
    let (alpha, expected) = (shot.alpha.values(), reference.alpha.values());
    let counts = coverage(alpha, expected, width);
    let share = |part: u64, whole: u64, of: f64| of * part as f64 / whole.max(1) as f64;
    let band = 4.0 * subject.scene.surfels.median_radius();
    let (mut squares, mut behind, mut before) = (0.0, 0, 0);
    for (i, region) in regions(expected, width).into_iter().enumerate() {
        if region != Region::Interior {
            continue;
        }
        for (a, b) in shot.color.values()[i].into_iter().zip(reference.color.values()[i]) {
            squares += f64::from(a - b) * f64::from(a - b);
        }
        let (found, depth) = (shot.depth.values()[i], reference.depth.values()[i]);
        behind += u64::from(found.is_finite() && found > depth + band);
        before += u64::from(found < depth - band);
    }
    Measures {
        rmse,
        ssim,
        inside: (squares / (3 * counts.interior.max(1)) as f64).sqrt(),
        holes: share(counts.holes, counts.interior, 1e3),
        spill: share(counts.spill, counts.covered, 1e3),
        edge: share(counts.mismatch, counts.edge, 1e2),
        behind: share(behind, counts.interior, 1e3),
        before: share(before, counts.interior, 1e3),
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

impl Bench {
    /// The tables of all scenes; the first of them is published in `block`.
    fn scenes(&self, block: &str, reference: &str, names: &[&str], rows: &[Row]) -> Result<()> {
        for (index, (title, show)) in TABLES.iter().enumerate().filter(|_| !rows.is_empty()) {
            println!("\n{title}, against {reference}");
            let columns = ["scene", "surfels", "radius, px"];
            let columns: Vec<_> = columns.iter().chain(names).copied().collect();
            let mut table = Table::new(&columns);
            for row in rows {
                let cells: Vec<_> = row.cells.iter().map(show).collect();
                table.row(&format!("{} | {}", row.title, cells.join(" | ")));
            }
            let means: Vec<_> = (0..names.len()).map(|i| show(&mean(rows, i))).collect();
            table.row(&format!("mean | | | {}", means.join(" | ")));
            if index == 0 {
                table.publish(&self.arguments, "image-space.md", block)?;
            }
        }
        Ok(())
    }

    /// The means over the scenes, a row a measure; EWA is not measured against itself.
    fn means(&self, names: &[&str], by_ewa: &[Row], by_truth: &[Row]) -> Result<()> {
        let columns: Vec<_> = ["", EWA].iter().chain(names).copied().collect();
        println!("\nMeans");
        let mut table = Table::new(&columns);
        for (title, show) in BY_EWA.iter().filter(|_| !by_ewa.is_empty()) {
            let cells: Vec<_> = (0..names.len()).map(|i| show(&mean(by_ewa, i))).collect();
            table.row(&format!("{title} | | {}", cells.join(" | ")));
        }
        for (title, show) in BY_TRUTH.iter().filter(|_| !by_truth.is_empty()) {
            let cells: Vec<_> = (0..=names.len()).map(|i| show(&mean(by_truth, i))).collect();
            table.row(&format!("{title} | {}", cells.join(" | ")));
        }
        table.publish(&self.arguments, "image-space.md", "means")
    }
}

/// The mean over the scenes of a method's measures.
fn mean(rows: &[Row], method: usize) -> Measures {
    let of = |value: fn(&Measures) -> f64| {
        rows.iter().map(|row| value(&row.cells[method])).sum::<f64>() / rows.len() as f64
    };
    Measures {
        rmse: of(|m| m.rmse),
        ssim: of(|m| m.ssim),
        inside: of(|m| m.inside),
        holes: of(|m| m.holes),
        spill: of(|m| m.spill),
        edge: of(|m| m.edge),
        behind: of(|m| m.behind),
        before: of(|m| m.before),
        outline: of(|m| m.outline),
    }
}
