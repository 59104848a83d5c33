//! The chart of a study: time against error, with the front.

use crate::study::chart::Drawing;
use crate::study::chart::scatter::{Point, Scatter};
use crate::study::run::{Loss, Record, Study};

/// The points of a study in the order of its candidates: those that were timed and measured. Each
/// comes with the index of its candidate.
#[must_use]
pub fn points(study: &Study, loss: &Loss) -> Vec<(usize, Point)> {
    let mut methods: Vec<&str> = Vec::new();
    for record in &study.candidates {
        if !methods.contains(&record.method.as_str()) {
            methods.push(&record.method);
        }
    }
    let point = |(i, record): (usize, &Record)| {
        let [first, median, last] = record.quartiles()?;
        let error = loss.value(record)?;
        let series = methods.iter().position(|method| *method == record.method)?;
        let short = record.options.trim_start_matches("--method ").to_owned();
        let name = record.options.clone();
        Some((i, Point { name, short, series, at: [median, error], spread: [first, last] }))
    };
    study.candidates.iter().enumerate().filter_map(point).collect()
}

/// Draws the chart of a study.
#[must_use]
pub fn chart(study: &Study, loss: &Loss) -> Drawing {
    let [width, height] = study.of.size;
    let all = points(study, loss);
    let notes = vec![
        format!("Truth: {}.", study.of.truth),
        format!("Time: median and quartiles of a picture, {}.", study.machine),
        "Filled: on the front; nothing else is both faster and nearer to the truth.".into(),
    ];
    Scatter {
        title: format!("{}, {width} x {height}: speed against accuracy", study.of.scene),
        notes,
        axes: ["ms a picture".into(), loss.title.clone()],
        points: all.into_iter().map(|(_, point)| point).collect(),
    }
    .draw()
}
