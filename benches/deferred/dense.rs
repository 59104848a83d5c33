//! Flicker with more than one surfel a pixel \[GBP04, 4.4, Fig. 4\], measured as [`super::flicker`] says.

use super::common::chart::{Axis, Series, svg};
use super::common::report::{Arguments, Table};
use super::flicker::{Found, SIDE, SURFACES, dense, measured};
use splatref::Result;
use splatref::frame::Exec;

const DENSITIES: [f64; 7] = [0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0];
const FRAMES: u32 = 8;

pub(crate) fn table(arguments: &Arguments, exec: &Exec) -> Result<()> {
    let mut table = Table::new(&[
        "scene",
        "surfels a pixel",
        "surfels",
        "culled, %",
        "change, deferred",
        "change, ewa",
        "flicker",
        "flicker with mipmaps",
        "error",
        "error with mipmaps",
    ]);
    let (mut series, mut filtered) = (Vec::new(), Vec::new());
    for (name, surface) in SURFACES.into_iter().filter(|s| s.0.contains(&arguments.pattern)) {
        let [mut points, mut below] = [Vec::new(), Vec::new()];
        for wanted in DENSITIES {
            let surfels = dense(surface, wanted, exec)?;
            let (count, found) = (surfels.len(), measured(surfels, FRAMES, exec)?);
            let Found { culled, deferred, ewa, flicker, error } = found;
            let ([flicker, less], [error, other]) = (flicker, error);
            table.row(&format!(
                "{name} | {wanted} | {count} | {culled:.1} | {deferred:.4} | {ewa:.4} | \
                 {flicker:.4} | {less:.4} | {error:.4} | {other:.4}"
            ));
            points.push([wanted, flicker]);
            below.push([wanted, less]);
        }
        series.push(Series { name: name.to_owned(), points });
        filtered.push(Series { name: format!("{name}, mipmaps"), points: below });
    }
    series.append(&mut filtered);
    table.publish(arguments, "gbp04.md", "dense")?;
    let x = Axis { title: "surfels a pixel", ticks: DENSITIES.to_vec() };
    let flickers = series.iter().flat_map(|series| &series.points).map(|point| point[1]);
    let y = Axis::around("flicker, RMSE of linear RGB", flickers);
    let title = format!("Checks of one pixel over a slow dolly, {SIDE} x {SIDE}");
    arguments.write("gbp04-dense.svg", &svg(&title, [&x, &y], &series, ("", &[])))
}
