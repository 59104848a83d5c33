//! Stability under motion: the picture moved by s = 0, 1/8 ... 1 pixel to the right.
//!
//! The principal point's column becomes cx + s, exactly: nothing but the grid of pixels changes
//! against the scene. With `P(s)` a method's picture and `T(s)` the reference's at the same shift,
//! the true picture of a shape or else EWA's, over all pixels:
//!
//! ```text
//!   change    RMSE of P(s + 1/8) and P(s)                             what an eye sees change
//!   error     RMSE of P(s) and T(s)
//!   flicker   RMSE of P(s + 1/8) - P(s) and T(s + 1/8) - T(s)         change that is no motion
//!   a pixel   RMSE of P(1) moved back by a column and P(0)            0 if only the pixel grid matters
//! ```
//!
//! each as the mean over the shifts and the worst. `a pixel` leaves out the column that comes in;
//! what it finds comes from the coarser grids of the method alone.

use super::common::report::Table;
use super::common::shot::Shot;
use super::{Bench, EWA, Subject, methods, splatting};
use splatref::Result;
use splatref::frame::Plane;
use splatref::scene::Camera;
use splatref::verify::metrics::rmse;

/// Shifts of 1/8 pixel.
const STEPS: usize = 8;
const SCENES: [&str; 9] = [
    "sphere 200 k",
    "torus 10 k",
    "torus 10 k, parallel",
    "cluster 200 k",
    "checkerboard 200 k",
    "bunny",
    "bunny 1 M",
    "igea",
    "koala",
];
const METHODS: [&str; 6] =
    ["pyramid", "occluded = outside", "3, radius", "5, radius", "5, diameter", "7, diameter"];

impl Bench {
    /// The table.
    pub(super) fn stability(&self, subjects: &[Subject]) -> Result<()> {
        println!("\nMoved by 1/8 pixel eight times: RMSE, mean and worst\n");
        let mut table =
            Table::new(&["scene", "reference", "method", "change", "error", "flicker", "a pixel"]);
        for subject in subjects.iter().filter(|s| SCENES.contains(&s.name.as_str())) {
            let ewa = self.pictures(
                |camera| Ok(Shot::of(self.draw(subject, camera, &splatting())?).color),
                subject,
            )?;
            let truth = match &subject.shape {
                Some(shape) => {
                    let draw = |camera: &Camera| Ok(self.truth(subject, shape, camera)?.color);
                    Some(self.pictures(draw, subject)?)
                }
                None => None,
            };
            let (reference, name) = match &truth {
                Some(truth) => (truth, "truth"),
                None => (&ewa, EWA),
            };
            let mut row = |method: &str, shots: &[Plane<[f32; 3]>]| {
                let cells = cells(shots, reference);
                table.row(&format!("{} | {name} | {method} | {cells}", subject.name));
            };
            if let Some(truth) = &truth {
                row("truth", truth);
            }
            row(EWA, &ewa);
            for (name, method) in methods().iter().filter(|m| METHODS.contains(&m.0)) {
                let draw =
                    |camera: &Camera| Ok(Shot::of(self.draw(subject, camera, method)?).color);
                row(name, &self.pictures(draw, subject)?);
            }
        }
        table.publish(&self.arguments, "image-space.md", "stability")
    }

    /// The pictures of all shifts.
    fn pictures(
        &self,
        draw: impl Fn(&Camera) -> Result<Plane<[f32; 3]>>,
        subject: &Subject,
    ) -> Result<Vec<Plane<[f32; 3]>>> {
        let shifted = |step: usize| {
            let cx = subject.camera.cx + step as f32 / STEPS as f32;
            draw(&Camera { cx, ..subject.camera })
        };
        (0..=STEPS).map(shifted).collect()
    }
}

/// The four measures.
fn cells(shots: &[Plane<[f32; 3]>], reference: &[Plane<[f32; 3]>]) -> String {
    let values = |plane: &Plane<[f32; 3]>| plane.values().as_flattened().to_vec();
    let change = |of: &[Plane<[f32; 3]>], s: usize| -> Vec<f32> {
        values(&of[s + 1]).iter().zip(values(&of[s])).map(|(a, b)| a - b).collect()
    };
    let changes = (0..STEPS).map(|s| rmse(&values(&shots[s + 1]), &values(&shots[s])));
    let errors = (0..=STEPS).map(|s| rmse(&values(&shots[s]), &values(&reference[s])));
    let flicker = (0..STEPS).map(|s| rmse(&change(shots, s), &change(reference, s)));
    let columns = |plane: &Plane<[f32; 3]>, first: usize| -> Vec<f32> {
        let width = plane.width() as usize;
        let rows = plane.values().chunks_exact(width);
        rows.flat_map(|row| row[first..first + width - 1].as_flattened()).copied().collect()
    };
    let pixel = rmse(&columns(&shots[STEPS], 1), &columns(&shots[0], 0));
    let all = [changes.collect(), errors.collect(), flicker.collect()].map(mean_and_worst);
    format!("{} | {pixel:.4}", all.join(" | "))
}

fn mean_and_worst(values: Vec<f64>) -> String {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let worst = values.iter().copied().max_by(f64::total_cmp).unwrap_or(0.0);
    format!("{mean:.4}, {worst:.4}")
}
