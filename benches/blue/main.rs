//! Prefixes of orders as a view draws them \[BJFM19, 4 and 5.3\]: holes, where the estimate fails, and an
//! instanced scene of 100 million triangles.
//!
//! `cargo bench --bench blue` prints Markdown, and with `--write` puts the tables into `docs/bjfm19.md`; an
//! argument is a part of `holes`, `failures`, `figures` or `instances`, which are measured alone then; with
//! `--pictures DIR` the figures are kept. Scans are those in the folder that `SPLATREF_MODELS` names
//! (`../shared/models` if that is not set).

#[path = "../common/mod.rs"]
mod common;
mod covering;
mod failures;
mod figures;
mod instanced;
mod scene;

use common::report::{Arguments, Table};
use instanced::Rings;
use splatref::Result;
use splatref::frame::Exec;

fn main() -> Result<()> {
    let arguments = Arguments::parse()?;
    let exec = Exec::new(2, 32)?;
    if "holes".contains(&arguments.pattern) {
        covering::tables(&arguments, &exec)?;
    }
    if "failures".contains(&arguments.pattern) {
        failures(&arguments, &exec)?;
    }
    let [figures, instances] =
        ["figures", "instances"].map(|part| part.contains(&arguments.pattern));
    if figures {
        figures::prefixes(&arguments, &exec)?;
    }
    if figures || instances {
        let rings = Rings::new(&exec)?;
        if figures {
            figures::similar(&rings, &arguments, &exec)?;
            figures::close(&rings, &arguments, &exec)?;
        }
        if instances {
            instanced::table(&rings, &arguments, &exec)?;
        }
    }
    Ok(())
}

/// What [`failures`] measures, as tables.
fn failures(arguments: &Arguments, exec: &Exec) -> Result<()> {
    let mut table = Table::new(&["fade", "surfels", "holes, %"]);
    for fade in failures::FADES {
        let (count, holes) = failures::fade(fade, exec)?;
        table.row(&format!("{fade} | {count} | {holes:.2}"));
    }
    table.publish(arguments, "bjfm19.md", "fade")?;
    let mut table = Table::new(&["load step", "0 frames late", "1", "2", "3", "4"]);
    for step in failures::STEPS {
        let cells: Vec<_> =
            (0..5).map(|late| failures::load_step(step, late).to_string()).collect();
        table.row(&format!("{step} | {}", cells.join(" | ")));
    }
    table.publish(arguments, "bjfm19.md", "controller")
}
