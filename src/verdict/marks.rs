//! What is found of a client, tile by tile, until it is planes.

use crate::error::Result;
use crate::frame::{Grid, Plane, Rect};
use crate::method::Job;
use crate::method::decisions::Place;
use crate::method::tiled::pixels;
use crate::number::Real;
use crate::verdict::shift::ShiftSums;
use crate::verdict::{Cause, Causes, Check, Doubt, Fault, Finding, StageVerdict, Verdict};

/// What was found at a pixel: of wrong ones no more than is counted, as every pixel may be wrong.
#[derive(Clone, Copy, Debug, Default)]
struct AtPixel {
    error: f32,
    doubts: u8,
    /// That of the worst fault, if the error is above 1.
    cause: Cause,
}

/// What was found of one stage at the pixels of a tile.
#[derive(Debug)]
pub(crate) struct Marks {
    rect: Rect,
    found: Vec<AtPixel>,
    worst: Option<Finding>,
    /// Everything that was checked, if somebody wants to know.
    log: Option<Vec<(f64, Fault)>>,
}

/// The marks of one pixel.
pub(crate) struct PixelMarks<'a> {
    marks: &'a mut Marks,
    pixel: usize,
}

impl Marks {
    /// Nothing found yet.
    pub(crate) fn new(rect: Rect) -> Self {
        Self { rect, found: vec![AtPixel::default(); rect.pixels()], worst: None, log: None }
    }

    /// The same, and everything that is checked will be told.
    pub(crate) fn logging(rect: Rect) -> Self {
        Self { log: Some(Vec::new()), ..Self::new(rect) }
    }

    /// Whether everything that is checked will be told.
    pub(crate) fn logs(&self) -> bool {
        self.log.is_some()
    }

    /// Nothing found yet in a part of the picture, and told as much of.
    pub(crate) fn beside(&self, rect: Rect) -> Self {
        Self { log: self.log.as_ref().map(|_| Vec::new()), ..Self::new(rect) }
    }

    /// Everything that was checked.
    pub(crate) fn checks(self, stage: &'static str) -> impl Iterator<Item = Check> {
        let log = self.log.into_iter().flatten();
        log.map(move |(error, fault)| Check { stage, fault, error })
    }

    /// Nothing found yet in a whole picture.
    pub(crate) fn picture(job: &Job<'_>) -> Self {
        Self::new(job.picture())
    }

    /// The marks of a whole picture as what was found of a stage.
    pub(crate) fn whole(self, stage: &'static str, planes: Vec<&'static str>) -> StageVerdict {
        whole(self.rect, (stage, planes), [self])
    }

    /// Adds what was found in a part of the picture: at each pixel the greater error, all doubts.
    pub(crate) fn put(&mut self, part: Self) {
        for ((x, y), own) in part.pixels() {
            let found = &mut self.found[place(self.rect, (x, y))];
            let doubts = found.doubts | own.doubts;
            if own.error > found.error {
                *found = own;
            }
            found.doubts = doubts;
        }
        if let (Some(log), Some(more)) = (&mut self.log, part.log) {
            log.extend(more);
        }
        keep_worse(&mut self.worst, part.worst);
    }

    /// What was found at each pixel.
    fn pixels(&self) -> impl Iterator<Item = ((u32, u32), AtPixel)> {
        pixels(self.rect).zip(self.found.iter().copied())
    }

    /// At how many pixels there is one of these doubts.
    pub(crate) fn doubtful(&self, doubts: u8) -> u64 {
        self.found.iter().filter(|at| at.doubts & doubts != 0).count() as u64
    }

    /// The marks of a pixel, counted row by row.
    pub(crate) fn at(&mut self, pixel: usize) -> PixelMarks<'_> {
        PixelMarks { marks: self, pixel }
    }
}

impl PixelMarks<'_> {
    /// What was found, and by how many bounds it errs, NaN if there are none; `fault` says what is wrong
    /// if that is above 1.
    pub(crate) fn found(&mut self, error: f64, fault: impl Fn() -> Fault) {
        let Marks { rect, found, worst, log } = &mut *self.marks;
        if let Some(log) = log {
            let fault = fault();
            let unknown = matches!(&fault, Fault::Value { radius, .. } if radius.is_nan());
            let anything = unknown && !(error > 1.0);
            if !anything {
                log.push((error, fault));
            }
        }
        let at = &mut found[self.pixel];
        if error.is_nan() {
            at.doubts |= Doubt::Unbounded as u8;
        }
        // A comparison that NaN fails.
        if !(error > f64::from(at.error)) {
            return;
        }
        // Not rounded to 1 from above.
        let single = error as f32;
        at.error = if error > 1.0 && single <= 1.0 { 1.0_f32.next_up() } else { single };
        if error > 1.0 {
            let fault = fault();
            at.cause = Cause::of(&fault);
            if worst.as_ref().is_none_or(|worst| error > worst.error) {
                let columns = rect.columns();
                let (x, y) = (self.pixel % columns, self.pixel / columns);
                let pixel = (rect.x0 + x as u32, rect.y0 + y as u32);
                *worst = Some(Finding { pixel, fault, error });
            }
        }
    }

    /// The same of an error of at most 1: nothing is wrong.
    pub(crate) fn right(&mut self, error: f64) {
        let at = &mut self.marks.found[self.pixel];
        at.error = at.error.at_least(error as f32);
    }

    /// A decision that may be either way.
    pub(crate) fn doubt(&mut self, doubt: Doubt, there: bool) {
        if there {
            self.doubts(doubt as u8);
        }
    }

    /// Nothing depends on the decisions that may be either way.
    pub(crate) fn settle(&mut self) {
        self.marks.found[self.pixel].doubts = 0;
    }

    /// Decisions that may be either way, as bits.
    pub(crate) fn doubts(&mut self, doubts: u8) {
        self.marks.found[self.pixel].doubts |= doubts;
    }
}

/// The marks of all tiles as what was found of each of `stages`: their names, and the planes that were
/// judged.
pub(crate) fn stage_verdicts<const N: usize>(
    job: &Job<'_>,
    stages: [(&'static str, Vec<&'static str>); N],
    tiles: Vec<[Marks; N]>,
) -> Vec<StageVerdict> {
    let mut of_stages = [(); N].map(|()| Vec::new());
    for tile in tiles {
        of_stages.iter_mut().zip(tile).for_each(|(parts, marks)| parts.push(marks));
    }
    let all = stages.into_iter().zip(of_stages).collect();
    job.exec.ordered(all, |(stage, parts)| whole(job.picture(), stage, parts))
}

/// What was found in the parts of a picture, which share no pixel, as what was found of a stage.
fn whole(
    picture: Rect,
    (stage, planes): (&'static str, Vec<&'static str>),
    parts: impl IntoIterator<Item = Marks>,
) -> StageVerdict {
    let Rect { x1: width, y1: height, .. } = picture;
    let mut judged = StageVerdict {
        stage,
        planes,
        missing: Vec::new(),
        errors: Plane::filled(width, height, 0.0),
        doubts: Plane::filled(width, height, 0),
        wrong: 0,
        causes: Causes::default(),
        worst: None,
    };
    for part in parts {
        let columns = part.rect.columns();
        for (y, row) in (part.rect.y0..).zip(part.found.chunks_exact(columns)) {
            let first = place(picture, (part.rect.x0, y));
            let errors = &mut judged.errors.values_mut()[first..first + columns];
            let doubts = &mut judged.doubts.values_mut()[first..first + columns];
            for ((found, error), doubts) in row.iter().zip(errors).zip(doubts) {
                (*error, *doubts) = (found.error, found.doubts);
                if found.error > 1.0 {
                    judged.wrong += 1;
                    judged.causes.count(found.cause);
                }
            }
        }
        keep_worse(&mut judged.worst, part.worst);
    }
    judged
}

/// Where a pixel is in a rectangle, row by row.
fn place(rect: Rect, (x, y): (u32, u32)) -> usize {
    (y - rect.y0) as usize * rect.columns() + (x - rect.x0) as usize
}

/// The worse of two findings; of equals the one that comes first, row by row.
fn keep_worse(worst: &mut Option<Finding>, own: Option<Finding>) {
    let Some(own) = own else { return };
    let place = |finding: &Finding| (finding.pixel.1, finding.pixel.0);
    let worse = worst.as_ref().is_none_or(|worst| {
        own.error > worst.error || (own.error == worst.error && place(&own) < place(worst))
    });
    if worse {
        *worst = Some(own);
    }
}

/// The pixels of planes that are judged.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Watch {
    All,
    /// This one, and everything that is checked there is told.
    One((u32, u32)),
}

impl Watch {
    /// A pixel of the picture.
    ///
    /// # Errors
    /// [`crate::Error::Usage`] if the pixel is outside.
    pub(crate) fn one(job: &Job<'_>, (x, y): (u32, u32)) -> Result<Self> {
        job.camera.check_pixel(x, y)?;
        Ok(Self::One((x, y)))
    }

    /// The parts of planes that are judged, each in its tile.
    pub(crate) fn parts(self, grid: &Grid) -> Vec<(usize, Rect)> {
        match self {
            Self::All => grid.rects().into_iter().enumerate().collect(),
            Self::One((x, y)) if grid.holds(x, y) => {
                vec![(grid.place(x, y).0, Rect::pixel((x, y)))]
            }
            Self::One(_) => Vec::new(),
        }
    }

    /// The marks of a part.
    pub(crate) fn marks(self, rect: Rect) -> Marks {
        match self {
            Self::All => Marks::new(rect),
            Self::One(_) => Marks::logging(rect),
        }
    }

    /// The marks of all parts.
    pub(crate) fn picture(self, job: &Job<'_>) -> Marks {
        self.marks(if let Self::One(at) = self { Rect::pixel(at) } else { job.picture() })
    }
}

/// What was found of a stage: its name, the planes that were judged, and the marks.
pub(crate) type StageMarks = (&'static str, Vec<&'static str>, Marks);

/// What was found of a method that has levels before its picture, whose last N stages are judged tile by
/// tile.
pub(crate) struct MethodMarks<const N: usize> {
    pub(crate) levels: Vec<StageMarks>,
    pub(crate) stages: [(&'static str, Vec<&'static str>); N],
    pub(crate) tiles: Vec<[Marks; N]>,
}

impl<const N: usize> MethodMarks<N> {
    /// All stages as planes.
    pub(crate) fn stage_verdicts(self, job: &Job<'_>) -> Vec<StageVerdict> {
        let levels = self.levels.into_iter();
        let levels = levels.map(|(stage, planes, marks)| marks.whole(stage, planes));
        levels.chain(stage_verdicts(job, self.stages, self.tiles)).collect()
    }

    /// Everything that was checked.
    pub(crate) fn checks(self) -> Vec<Check> {
        let names = self.stages.map(|(stage, _)| stage);
        let tiles = self.tiles.into_iter().flat_map(|tile| names.into_iter().zip(tile));
        let levels = self.levels.into_iter().map(|(stage, _, marks)| (stage, marks));
        levels.chain(tiles).flat_map(|(stage, marks)| marks.checks(stage)).collect()
    }
}

/// What is known of a tile beside its marks.
#[derive(Debug, Default)]
pub(crate) struct Counts {
    /// How many pixels may be covered.
    pub(crate) covered: u64,
    /// In how many of them the sums are undecided.
    pub(crate) undecided: u64,
    /// The undecided decisions whose outcome is known.
    pub(crate) shifts: ShiftSums,
}

impl Counts {
    /// With those of another tile.
    pub(crate) fn add(&mut self, tile: Self) {
        self.covered += tile.covered;
        self.undecided += tile.undecided;
        self.shifts.add(tile.shifts);
    }
}

/// The verdict of a method whose stages are judged tile by tile: `judge` marks what is wrong at the
/// pixels of a rectangle in a tile.
pub(crate) fn verdict<const N: usize>(
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
    let mut all = Counts::default();
    let mut tiles = Vec::new();
    for (marks, counts) in found {
        all.add(counts);
        tiles.push(marks);
    }
    let Counts { covered, undecided, shifts } = all;
    let stages = stage_verdicts(job, stages, tiles);
    Verdict::new(stages, [covered, undecided], budget, shifts.sums())
}

/// Everything that `judge` asks at one pixel.
///
/// # Errors
/// [`crate::Error::Usage`] if the pixel is outside the picture.
pub(crate) fn checks<const N: usize>(
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
pub(crate) fn counted(rect: Rect) -> impl Iterator<Item = (usize, (u32, u32))> {
    pixels(rect).enumerate()
}
