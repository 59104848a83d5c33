//! The template's rules of levels: one scene in pictures of several sizes.
//!
//! Holes swing with the size of a picture, since the level of a disc is a step function of its
//! radius in pixels: each scene is drawn in five sizes of the same view, of 300 to 750 rows. Per
//! template and rule, against EWA in the same size: holes, per mille of the inside, the mean over
//! the sizes and the worst, and the mean RMSE.

use super::common::report::Table;
use super::common::shot::Shot;
use super::means::measure;
use super::{Bench, Subject, methods, splatting};
use splatref::Result;
use splatref::method::Method;
use splatref::number::Real;
use splatref::scene::Camera;

/// Heights; the width is 4/3 of it.
const HEIGHTS: [u32; 5] = [300, 400, 500, 600, 750];

impl Bench {
    /// The table.
    pub(super) fn levels(&self, subjects: &[Subject]) -> Result<()> {
        println!("\nRules of levels: holes in the mean of five sizes (the worst), RMSE");
        let methods: Vec<_> = (methods().into_iter())
            .filter(|(_, method)| matches!(method, Method::Template(_)))
            .collect();
        let names = methods.iter().map(|method| method.0);
        let columns: Vec<_> = ["scene", "surfels"].into_iter().chain(names).collect();
        let mut table = Table::new(&columns);
        let mut rows = Vec::new();
        for subject in subjects {
            let mut found = vec![[0.0_f64; 3]; methods.len()];
            for height in HEIGHTS {
                let camera = resized(&subject.camera, height);
                let ewa = Shot::of(self.draw(subject, &camera, &splatting())?);
                for ((_, method), found) in methods.iter().zip(&mut found) {
                    let shot = Shot::of(self.draw(subject, &camera, method)?);
                    let measures = measure(&shot, &ewa);
                    found[0] += measures.holes / HEIGHTS.len() as f64;
                    found[1] = found[1].at_least(measures.holes);
                    found[2] += measures.rmse / HEIGHTS.len() as f64;
                }
            }
            let surfels = subject.scene.surfels.len();
            table.row(&format!("{} | {surfels} | {}", subject.name, cells(&found)));
            rows.push(found);
        }
        table.row(&format!("mean | | {}", cells(&over(&rows, mean))));
        table.row(&format!("median | | {}", cells(&over(&rows, median))));
        table.publish(&self.arguments, "image-space.md", "levels")
    }
}

fn cells(found: &[[f64; 3]]) -> String {
    let cell = |[mean, worst, rmse]: &[f64; 3]| format!("{mean:.1} ({worst:.1}), {rmse:.4}");
    found.iter().map(cell).collect::<Vec<_>>().join(" | ")
}

/// One number of each column's, over the scenes.
fn over(rows: &[Vec<[f64; 3]>], one: fn(Vec<f64>) -> f64) -> Vec<[f64; 3]> {
    let columns = 0..rows.first().map_or(0, Vec::len);
    let all = |column: usize, i: usize| rows.iter().map(|row| row[column][i]).collect();
    columns.map(|column| [0, 1, 2].map(|i| one(all(column, i)))).collect()
}

fn mean(values: Vec<f64>) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The lower one of an even number.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[(values.len() - 1) / 2]
}

/// The same view in another size.
fn resized(camera: &Camera, height: u32) -> Camera {
    let scale = height as f32 / camera.height as f32;
    Camera {
        width: height * 4 / 3,
        height,
        fx: camera.fx * scale,
        fy: camera.fy * scale,
        cx: camera.cx * scale,
        cy: camera.cy * scale,
        ..*camera
    }
}
