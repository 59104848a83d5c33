//! Verify a client's pull and push, level by level.

use crate::composite::decide;
use crate::method::Job;
use crate::method::projection::SampleKind;
use crate::method::pyramid::{Cell, Settings, pull, push};
use crate::method::record::Records;
use crate::method::stage::Keep;
use crate::number::ball::Profile;
use crate::number::{Ball, MapInline, Truth, Vector2};
use crate::verdict::Doubt;
use crate::verdict::checks::{Report, least_wrong};
use crate::verdict::marks::{LevelMarks, PixelMarks, StageMarks, Watch, counted};
use crate::verdict::outcomes::{MOST, Outcome, outcomes};
use crate::verdict::planes::{ClientRecords, RecordPlanes};
use crate::verdict::projection::SamplePlanes;
use crate::verdict::supposed::Supposed;

/// The cells of a level.
pub(super) type Level<'a, P> = ClientRecords<'a, Cell<Ball<P>>>;

/// Four cells.
type Four<P> = [Cell<Ball<P>>; 4];

/// The levels of a client.
pub(super) struct Levels<'a, P: Profile> {
    job: &'a Job<'a>,
    sizes: &'a [[u32; 2]],
    supposed: Supposed,
    /// The planes of the levels 1 to the last after the pull, and of the levels 0 to the last but
    /// one after the push.
    planes: [&'a [RecordPlanes<'a>]; 2],
    /// All levels after the pull; none where a plane is missing.
    pulled: Vec<Option<Level<'a, P>>>,
    /// All levels after the push but the last, which is the pull's.
    pushed: Vec<Option<Level<'a, P>>>,
}

impl<'a, P: Profile> Levels<'a, P> {
    pub(super) fn new(
        job: &'a Job<'a>,
        sizes: &'a [[u32; 2]],
        supposed: Supposed,
        finest: &'a SamplePlanes<'a>,
        planes: [&'a [RecordPlanes<'a>]; 2],
    ) -> Self {
        // The planes of both phases have the same places in a cell.
        let there = job.there(Keep::Stages);
        let level = |(of, size): (&'a RecordPlanes<'a>, &[u32; 2])| {
            of.records(job, &Cell::PULL, there, *size, Cell::empty())
        };
        let mut pulled = vec![finest.samples(job, false, Cell::new)];
        pulled.extend(planes[0].iter().zip(&sizes[1..]).map(level));
        let pushed = planes[1].iter().zip(sizes).map(level).collect();
        Self { job, sizes, supposed, planes, pulled, pushed }
    }

    /// Level 0 after the push, if all its planes are there.
    pub(super) fn finest(&self) -> Option<&Level<'a, P>> {
        self.pushed(0)
    }

    /// A level after the push, if all its planes are there.
    fn pushed(&self, level: usize) -> Option<&Level<'a, P>> {
        self.pushed.get(level).or(self.pulled.last())?.as_ref()
    }

    /// The levels of the pull and of the push that are not judged although the client hands in
    /// planes of them.
    pub(super) fn unjudged(&self) -> [Vec<String>; 2] {
        let there = |phase: usize, at: usize| !self.planes[phase][at].names().is_empty();
        let [pulls, pushes] = self.planes.map_inline(<[_]>::len);
        let pull =
            (1..=pulls).filter(|level| there(0, level - 1) && self.pulled[level - 1].is_none());
        let push = (0..pushes).filter(|&level| {
            there(1, level) && (self.pulled[level].is_none() || self.pushed(level + 1).is_none())
        });
        let name = |level| format!("level {level}");
        [pull.map(name).collect(), push.map(name).collect()]
    }

    /// Judges each level of the pull whose finer level is there.
    pub(super) fn pull(&self, watch: Watch) -> StageMarks {
        let mut found = Phase::new(self.job, watch);
        for (level, planes) in (1..).zip(self.planes[0]) {
            let Some(fine) = &self.pulled[level - 1] else { continue };
            let (side, supposed) = (self.supposed.pull_side(level - 1), self.supposed);
            found.level(self.job, planes, self.sizes[level], |at, pixel| {
                let finer = pull::four(fine, at.0, at.1);
                let offsets = pull::offsets(&finer, side);
                let (outcomes, doubts) = of_four(&finer, &offsets, supposed);
                pixel.doubts(doubts);
                let of = |outcome: &Outcome| match *outcome {
                    Some((takes, first)) => pull::merge(&finer, &offsets, takes, first),
                    None => Cell::empty(),
                };
                outcomes.iter().map(of).collect()
            });
        }
        ("pull", found.names, found.marks.together(self.job))
    }

    /// Judges each level of the push whose coarser level is there, together with its own level
    /// after the pull.
    pub(super) fn push(&self, settings: &Settings, watch: Watch) -> StageMarks {
        let mut found = Phase::new(self.job, watch);
        for (level, planes) in self.planes[1].iter().enumerate() {
            let (Some(fine), Some(coarse)) = (&self.pulled[level], self.pushed(level + 1)) else {
                continue;
            };
            found.level(self.job, planes, self.sizes[level], |at, pixel| {
                pushed(fine, coarse, at, level, settings, self.supposed, pixel)
            });
        }
        ("push", found.names, found.marks.together(self.job))
    }
}

/// The findings about a phase.
struct Phase {
    marks: LevelMarks,
    names: Vec<&'static str>,
}

impl Phase {
    fn new(job: &Job<'_>, watch: Watch) -> Self {
        Self { marks: LevelMarks::new(job, watch), names: Vec::new() }
    }

    /// Judges the planes of a level against all outcomes that each cell may have.
    fn level<P: Profile>(
        &mut self,
        job: &Job<'_>,
        planes: &RecordPlanes<'_>,
        size: [u32; 2],
        all: impl Fn((u32, u32), &mut PixelMarks<'_>) -> Vec<Cell<Ball<P>>> + Sync + Send,
    ) {
        let names = planes.names();
        if names.is_empty() {
            return;
        }
        for name in names {
            if !self.names.contains(name) {
                self.names.push(*name);
            }
        }
        self.marks.level(job, size, |rect, marks| {
            for (pixel, at) in counted(rect) {
                let mut pixel = marks.at(pixel);
                let all = all(at, &mut pixel);
                if all.len() > MOST {
                    continue;
                }
                let check = |truth: &_, report: &mut Report<'_>| {
                    planes.check(0, &Cell::PULL, at, truth, report);
                };
                if let Some(truth) = least_wrong::<_, 1>(&all, check) {
                    check(truth, &mut |_, error, fault| pixel.found(error, fault));
                }
            }
        });
    }
}

/// The outcomes of four cells at these offsets.
fn of_four<P: Profile>(
    cells: &Four<P>,
    offsets: &[Vector2<Ball<P>>; 4],
    supposed: Supposed,
) -> (Vec<Outcome>, u8) {
    let tube = |j: usize| cells[j].kind == SampleKind::Tube;
    outcomes(Cell::inside(cells, offsets), cells.map_inline(|cell| cell.front), |j, first| {
        let overlaps = decide::overlaps(cells[j].front, cells[first].back);
        let all = supposed == Supposed::AllOverlap;
        (overlaps | all.into()) & (tube(j) == tube(first)).into()
    })
}

/// Every outcome that a cell may have after the push.
fn pushed<P: Profile>(
    fine: &Level<'_, P>,
    coarse: &Level<'_, P>,
    (x, y): (u32, u32),
    level: usize,
    settings: &Settings,
    supposed: Supposed,
    pixel: &mut PixelMarks<'_>,
) -> Vec<Cell<Ball<P>>> {
    let (cell, parent) = (fine.record(x, y), coarse.record(x / 2, y / 2));
    let none = supposed == Supposed::NothingOccluded;
    let occluded = push::occluded(&cell, &parent, settings.occlusion) & (!none).into();
    let covered = occluded | (!cell.is_valid()).into();
    pixel.doubt(Doubt::Fate, covered.decided().is_none());
    if !covered.possibly() {
        return vec![cell];
    }
    let coarser = push::four(coarse, x, y);
    let (even_x, even_y) = (x.is_multiple_of(2), y.is_multiple_of(2));
    let offsets = push::offsets(&coarser, even_x, even_y, supposed.push_side(level));
    let (outcomes, doubts) = of_four(&coarser, &offsets, supposed);
    pixel.doubts(doubts);
    let mut all = Vec::with_capacity(outcomes.len() + 1);
    if !covered.certainly() {
        all.push(cell);
    }
    all.extend(outcomes.iter().map(|outcome| match *outcome {
        Some((takes, first)) => push::merge(&coarser, &offsets, settings.weights, takes, first),
        None => cell,
    }));
    all
}
