//! What is found of a client, tile by tile, until it is planes.

use super::algorithm::Job;
use super::replay::Place;
use super::tiled::pixels;
use crate::error::Result;
use crate::frame::{Plane, Rect};
use crate::verify::verdict::{Causes, Check, Doubt, Fault, Finding, Judged, Verdict};
use std::collections::BTreeMap;

/// What was found of one stage at the pixels of a tile.
#[derive(Debug)]
pub(super) struct Marks {
    rect: Rect,
    found: Vec<(f32, u8)>,
    /// The worst fault of each wrong pixel.
    faults: BTreeMap<usize, Fault>,
    worst: Option<Finding>,
    /// Everything that was checked, if somebody wants to know.
    log: Option<Vec<(f64, Fault)>>,
}

/// The marks of one pixel.
pub(super) struct PixelMarks<'a> {
    marks: &'a mut Marks,
    pixel: usize,
}

impl Marks {
    /// Nothing found yet.
    pub(super) fn new(rect: Rect) -> Self {
        let found = vec![(0.0, 0); rect.pixels()];
        Self { rect, found, faults: BTreeMap::new(), worst: None, log: None }
    }

    /// The same, and everything that is checked will be told.
    pub(super) fn logging(rect: Rect) -> Self {
        Self { log: Some(Vec::new()), ..Self::new(rect) }
    }

    /// The marks of a whole picture as what was found of a stage.
    pub(super) fn whole(self, stage: &'static str, planes: Vec<&'static str>) -> Judged {
        let Rect { x1, y1, .. } = self.rect;
        let mut causes = Causes::default();
        self.faults.values().for_each(|fault| causes.count(fault));
        let plane = |values| Plane::from_values(x1, y1, values);
        let wrong = self.found.iter().filter(|(error, _)| *error > 1.0).count() as u64;
        Judged {
            stage,
            planes,
            errors: plane(self.found.iter().map(|at| at.0).collect()),
            doubts: Plane::from_values(x1, y1, self.found.iter().map(|at| at.1).collect()),
            wrong,
            causes,
            worst: self.worst,
        }
    }

    /// Nothing found yet in a part of the picture, and told as much of.
    pub(super) fn beside(&self, rect: Rect) -> Self {
        Self { log: self.log.as_ref().map(|_| Vec::new()), ..Self::new(rect) }
    }

    /// Everything that was checked.
    pub(super) fn checks(self, stage: &'static str) -> impl Iterator<Item = Check> {
        let log = self.log.into_iter().flatten();
        log.map(move |(error, fault)| Check { stage, fault, error })
    }

    /// Nothing found yet in a whole picture.
    pub(super) fn picture(job: &Job<'_>) -> Self {
        let [x1, y1] = job.camera.size();
        Self::new(Rect { x1, y1, ..Rect::default() })
    }

    /// Adds what was found in a part of the picture: at each pixel the greater error, all doubts.
    pub(super) fn put(&mut self, mut part: Self) {
        let of = self.rect.columns();
        for (pixel, (x, y)) in counted(part.rect) {
            let (column, row) = ((x - self.rect.x0) as usize, (y - self.rect.y0) as usize);
            let place = row * of + column;
            let (error, doubts) = &mut self.found[place];
            let (own, more) = part.found[pixel];
            if own > *error {
                *error = own;
                if let Some(fault) = part.faults.remove(&pixel) {
                    self.faults.insert(place, fault);
                }
            }
            *doubts |= more;
        }
        if let (Some(log), Some(more)) = (&mut self.log, part.log) {
            log.extend(more);
        }
        if let Some(own) = part.worst {
            let place = |finding: &Finding| (finding.pixel.1, finding.pixel.0);
            let worse = self.worst.as_ref().is_none_or(|worst| {
                own.error > worst.error || (own.error == worst.error && place(&own) < place(worst))
            });
            if worse {
                self.worst = Some(own);
            }
        }
    }

    /// At how many pixels there is one of these doubts.
    pub(super) fn doubtful(&self, doubts: u8) -> u64 {
        self.found.iter().filter(|(_, at)| at & doubts != 0).count() as u64
    }

    /// The marks of a pixel, counted row by row.
    pub(super) fn at(&mut self, pixel: usize) -> PixelMarks<'_> {
        PixelMarks { marks: self, pixel }
    }
}

impl PixelMarks<'_> {
    /// What was found, and by how many bounds it errs; `fault` says what is wrong if that is above 1.
    pub(super) fn found(&mut self, error: f64, fault: impl Fn() -> Fault) {
        let Marks { rect, found, faults, worst, log } = &mut *self.marks;
        if let Some(log) = log {
            let fault = fault();
            let anything = matches!(&fault, Fault::Value { radius, .. } if radius.is_nan());
            if !anything {
                log.push((error, fault));
            }
        }
        let at = &mut found[self.pixel].0;
        // A comparison that NaN fails: an error that cannot be told is none.
        if !(error > f64::from(*at)) {
            return;
        }
        // Not rounded to 1 from above.
        let single = error as f32;
        *at = if error > 1.0 && single <= 1.0 { 1.0_f32.next_up() } else { single };
        if error > 1.0 {
            let fault = fault();
            if worst.as_ref().is_none_or(|worst| error > worst.error) {
                let columns = rect.columns();
                let (x, y) = (self.pixel % columns, self.pixel / columns);
                let pixel = (rect.x0 + x as u32, rect.y0 + y as u32);
                *worst = Some(Finding { pixel, fault: fault.clone(), error });
            }
            faults.insert(self.pixel, fault);
        }
    }

    /// A decision that may be either way.
    pub(super) fn doubt(&mut self, doubt: Doubt, there: bool) {
        if there {
            self.doubts(doubt as u8);
        }
    }

    /// Decisions that may be either way, as bits.
    pub(super) fn doubts(&mut self, doubts: u8) {
        self.marks.found[self.pixel].1 |= doubts;
    }
}

/// The marks of all tiles as what was found of each of `stages`: their names, and the planes that were
/// judged.
pub(super) fn judged<const N: usize>(
    job: &Job<'_>,
    stages: [(&'static str, Vec<&'static str>); N],
    tiles: Vec<[Marks; N]>,
) -> Vec<Judged> {
    let mut all = [(); N].map(|()| Marks::picture(job));
    for tile in tiles {
        for (whole, marks) in all.iter_mut().zip(tile) {
            whole.put(marks);
        }
    }
    let all = stages.into_iter().zip(all);
    all.map(|((stage, planes), marks)| marks.whole(stage, planes)).collect()
}

/// How many pixels may be covered, and in how many the sums are undecided.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Counts {
    pub(super) covered: u64,
    pub(super) undecided: u64,
}

/// The verdict of a method whose stages are judged tile by tile: `judge` marks what is wrong at the
/// pixels of a rectangle in a tile.
pub(super) fn verdict<const N: usize>(
    job: &Job<'_>,
    stages: [(&'static str, Vec<&'static str>); N],
    budget: f64,
    judge: impl Fn((usize, Rect), &mut [Marks; N]) -> Counts + Sync + Send,
) -> Verdict {
    let tiles = job.grid().rects().into_iter().enumerate().collect();
    let found = job.exec.ordered(tiles, |(tile, rect)| {
        let mut marks = [(); N].map(|()| Marks::new(rect));
        let counts = judge((tile, rect), &mut marks);
        (marks, counts)
    });
    let sum = |of: fn(&Counts) -> u64| found.iter().map(|(_, counts)| of(counts)).sum();
    let (covered, undecided) = (sum(|counts| counts.covered), sum(|counts| counts.undecided));
    let tiles = found.into_iter().map(|(marks, _)| marks).collect();
    Verdict { stages: judged(job, stages, tiles), covered, undecided, budget }
}

/// Everything that `judge` asks at one pixel.
///
/// # Errors
/// [`crate::Error::Usage`] if the pixel is outside the picture.
pub(super) fn checks<const N: usize>(
    job: &Job<'_>,
    stages: [&'static str; N],
    pixel: (u32, u32),
    judge: impl FnOnce((usize, Rect), &mut [Marks; N]) -> Counts,
) -> Result<Vec<Check>> {
    let Place { tile, rect } = Place::new(job, pixel)?;
    let mut marks = [(); N].map(|()| Marks::logging(rect));
    judge((tile, rect), &mut marks);
    Ok(marks.into_iter().zip(stages).flat_map(|(marks, stage)| marks.checks(stage)).collect())
}

/// The pixels of a tile with their count, row by row.
pub(super) fn counted(rect: Rect) -> impl Iterator<Item = (usize, (u32, u32))> {
    pixels(rect).enumerate()
}
