//! The greedy order along the surface, and colours averaged over cells \[BJFM19, 6\].

use crate::common::report::Table;
use splatref::Result;
use splatref::frame::Exec;
use splatref::source::candidates::Candidates;
use splatref::source::sampler::{Graph, Greedy, Start, averaged};
use std::time::Instant;

/// Picks of an order along the surface.
const COUNTS: [usize; 2] = [10_000, 100_000];

pub(crate) fn table() -> Table {
    Table::new(&["mesh", "candidates", "parts", "graph, s", "10 k, s", "100 k, s", "colours, s"])
}

pub(crate) fn row(table: &mut Table, name: &str, found: &Candidates, exec: &Exec) -> Result<()> {
    let quiet = |_: &str, _, _| ();
    let Some(normals) = &found.cloud.normal else { return Ok(()) };
    let points = &found.cloud.position;
    let (start, mut times) = (Instant::now(), Vec::new());
    let graph = Graph::new(points, normals, (2.0 * found.pixel) as f32, exec, &quiet)?;
    times.push(start.elapsed());
    let greedy = Greedy { start: Start::Seed(0) };
    for count in COUNTS {
        let start = Instant::now();
        greedy.along(&graph, count, &quiet)?;
        times.push(start.elapsed());
    }
    let order = greedy.order(points, COUNTS[1], exec, &quiet)?;
    // What the colours are changes nothing of the time.
    let start = Instant::now();
    averaged(points, normals, &order, order.index.len(), exec, &quiet)?;
    times.push(start.elapsed());
    let times: Vec<String> = times.iter().map(|t| format!("{:.2}", t.as_secs_f64())).collect();
    let (n, parts) = (points.len(), graph.parts());
    table.row(&format!("{name} | {n} | {parts} | {}", times.join(" | ")));
    Ok(())
}
