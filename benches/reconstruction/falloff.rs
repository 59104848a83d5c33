//! The weights of the template: 1 - d, and the exponential of which \[MOC08, section 3.2\] says that it
//! "leaves clear silhouette traces of the elliptical splats".
//!
//! RMSE to EWA, and *traces*: the mean angle between the normals of neighbouring pixels, those inside
//! both pictures, in parts of EWA's. A picture as smooth as EWA's has 1; a plane, where EWA's normals are
//! one, has none.

use super::{Bench, Subject, splatting};
use crate::common::report::Table;
use crate::common::shot::Shot;
use splatref::Result;
use splatref::frame::{Frame, Plane, Samples};
use splatref::method::{Method, template};
use splatref::verify::metrics::{Region, regions, rmse};

const SIZES: [u32; 3] = [3, 5, 7];
const FALLOFFS: [(&str, template::Falloff); 2] =
    [("1 - d", template::Falloff::Linear), ("exponential", template::Falloff::Gaussian)];

impl Bench {
    pub(crate) fn falloffs(&self, subjects: &[Subject]) -> Result<()> {
        let columns =
            SIZES.iter().flat_map(|size| FALLOFFS.map(|(name, _)| format!("{size}, {name}")));
        let columns: Vec<_> = ["scene".to_owned()].into_iter().chain(columns).collect();
        let mut table = Table::new(&columns.iter().map(String::as_str).collect::<Vec<_>>());
        let mut all = vec![Vec::new(); columns.len() - 1];
        for subject in subjects {
            let truth = self.draw(subject, &subject.camera, &splatting())?;
            let mut cells = Vec::new();
            let settings =
                SIZES.iter().flat_map(|size| FALLOFFS.map(|(_, falloff)| (*size, falloff)));
            for (found, (size, falloff)) in all.iter_mut().zip(settings) {
                let settings =
                    template::Settings { size, falloff, ..template::Settings::default() };
                let drawn = self.draw(subject, &subject.camera, &Method::Template(settings))?;
                found.push(against(drawn, truth.clone()));
                cells.push(cell(&found[found.len() - 1..]));
            }
            table.row(&format!("{} | {}", subject.name, cells.join(" | ")));
        }
        let means: Vec<_> = all.iter().map(|found| cell(found)).collect();
        table.row(&format!("mean | {}", means.join(" | ")));
        table.publish(&self.arguments, "image-space.md", "weights")
    }
}

/// The means of RMSE and of traces, where there are any.
fn cell(found: &[[f64; 2]]) -> String {
    let mean = |i: usize| {
        let known: Vec<_> = found.iter().map(|of| of[i]).filter(|v| v.is_finite()).collect();
        known.iter().sum::<f64>() / known.len() as f64
    };
    let traces = if mean(1).is_finite() { format!("{:.2}", mean(1)) } else { "-".into() };
    format!("{:.4}, {traces}", mean(0))
}

/// RMSE and traces.
fn against(found: Frame<f32>, truth: Frame<f32>) -> [f64; 2] {
    let [a, b] = [&found, &truth].map(normals);
    let width = found.width as usize;
    let [found, truth] = [found, truth].map(Shot::of);
    let inside = [&found, &truth].map(|shot| regions(shot.alpha.values(), width));
    let both = |i: usize| inside.iter().all(|regions| regions[i] == Region::Interior);
    let pairs: Vec<_> = (1..width * found.alpha.height() as usize)
        .filter(|i| i % width != 0 && both(*i) && both(i - 1))
        .collect();
    let jump = |normals: &[[f32; 3]]| {
        let angle = |&i: &usize| {
            let [a, b] = [normals[i], normals[i - 1]].map(glam::Vec3::from);
            f64::from(a.as_dvec3().angle_between(b.as_dvec3()) as f32)
        };
        pairs.iter().map(angle).filter(|angle| angle.is_finite()).sum::<f64>()
    };
    let [x, y] = [&found, &truth].map(|shot| shot.color.values().as_flattened());
    [rmse(x, y), jump(&a) / jump(&b)]
}

fn normals(frame: &Frame<f32>) -> Vec<[f32; 3]> {
    match frame.plane("normal") {
        Some(Samples::Vector(plane)) => Plane::values(plane).to_vec(),
        _ => Vec::new(),
    }
}
