//! `splatref render --target-ms`: chooses the size of ordered points by the time of the last frame.

use super::report;
use splatref::frame::Exec;
use splatref::io::replace::write_atomically;
use splatref::io::scene_file::Ready;
use splatref::method::blue::controller::Controller;
use splatref::study::chart::violin;
use splatref::study::chart::walk::{FrameTimes, chart};
use splatref::{Error, Result};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// A sequence whose frames take about as long as wanted \[BJFM19, 4.3\].
pub(super) struct Walk {
    controller: Controller,
    /// The size for the next frame.
    size: f32,
    drawn: Vec<FrameRow>,
    /// The table and the chart.
    files: [PathBuf; 2],
}

/// A frame as it was drawn.
struct FrameRow {
    frame: u32,
    size: f32,
    surfels: u64,
    primitives: u64,
    times: FrameTimes,
}

/// Parses milliseconds.
pub(super) fn milliseconds(text: &str) -> std::result::Result<f64, String> {
    let time = text.parse().ok().filter(|time: &f64| *time > 0.0 && time.is_finite());
    time.ok_or_else(|| "give milliseconds, greater than 0".into())
}

impl Walk {
    /// A walk whose first frame has this size, moved into the controller's range. Its table and its
    /// chart get the name of the sequence.
    pub(super) fn new(target: f64, size: f32, sequence: &Path) -> Result<Self> {
        let controller = Controller::new(target)?;
        // A frame that takes exactly as long as wanted keeps its size.
        let size = controller.next(size, target);
        let files = ["frames.csv", "frames.svg"].map(|end| sequence.with_extension(end));
        Ok(Self { controller, size, drawn: Vec::new(), files })
    }

    /// The scene in the next frame, with the size that the controller chose.
    pub(super) fn at(&self, ready: Ready, frame: u32, exec: &Exec) -> Result<Ready> {
        if !ready.has_ordered_points() {
            let what = "--target-ms chooses how many ordered points are drawn, but the scene has none; \
                        order them (`splatref surfels`) and give --surfel-size, or remove --target-ms";
            return Err(Error::Usage(what.into()));
        }
        ready.with_surfel_size(self.size)?.at(frame, exec)
    }

    /// Notes what a frame took, and chooses the next size. The table has every frame at once: after an
    /// interruption, nothing else tells the sizes of the pictures that are there.
    pub(super) fn note(&mut self, ready: &Ready, [placing, drawing]: [Duration; 2]) -> Result<()> {
        let [placing, drawing] = [placing, drawing].map(|time| time.as_secs_f64() * 1e3);
        let objects = ready.loaded.scene.objects.as_ref();
        self.drawn.push(FrameRow {
            frame: ready.frame(),
            size: self.size,
            surfels: objects.map_or(0, |objects| objects.drawn_total()),
            primitives: objects.map_or(0, |objects| objects.drawn_primitives()),
            times: FrameTimes { placing, drawing },
        });
        self.size = self.controller.next(self.size, placing + drawing);
        let table = self.table();
        write_atomically(&self.files[0], |out| out.write_all(table.as_bytes()))
    }

    /// Prints the sizes and the times of all frames, and writes the chart. Returns the files.
    pub(super) fn finish(self) -> Result<[PathBuf; 2]> {
        let sorted = |value: &dyn Fn(&FrameRow) -> f64| {
            let mut all: Vec<f64> = self.drawn.iter().map(value).collect();
            all.sort_by(f64::total_cmp);
            all
        };
        let sizes = sorted(&|one| one.size.into());
        let times = sorted(&|one| one.times.frame());
        let [least, median, most] = [0.0, 0.5, 1.0].map(|share| violin::quantile(&times, share));
        let [small, large] = [0.0, 1.0].map(|share| violin::quantile(&sizes, share));
        report::line("sizes", format!("{small:.3} to {large:.3} px"));
        let target = self.controller.target;
        report::line(
            "frames",
            format!("{least:.1} to {most:.1} ms, median {median:.1}; wanted {target} ms"),
        );

        let times: Vec<FrameTimes> = self.drawn.iter().map(|one| one.times).collect();
        let chart = chart(&times, target).svg();
        write_atomically(&self.files[1], |out| out.write_all(chart.as_bytes()))?;
        Ok(self.files)
    }

    /// A line a frame.
    fn table(&self) -> String {
        let mut text = "frame,surfel_size,surfels,primitives,placing_ms,drawing_ms\n".to_owned();
        for FrameRow { frame, size, surfels, primitives, times } in &self.drawn {
            let FrameTimes { placing, drawing } = times;
            // Writing into a string does not fail.
            let _ =
                writeln!(text, "{frame},{size},{surfels},{primitives},{placing:.3},{drawing:.3}");
        }
        text
    }
}
