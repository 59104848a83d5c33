//! Collect the findings tile by tile, until they become planes.

use crate::error::Result;
use crate::frame::{Grid, Plane, Rect};
use crate::method::Job;
use crate::method::decisions::Place;
use crate::method::tiled::pixels;
use crate::number::Real;
use crate::verdict::shift::ShiftSums;
use crate::verdict::{Cause, Causes, Check, Doubt, Fault, Finding, StageVerdict, Verdict};

/// The findings at a pixel. It keeps only what is counted, because every pixel may be wrong.
#[derive(Clone, Copy, Debug, Default)]
struct AtPixel {
    error: f32,
    doubts: u8,
    /// The cause of the worst fault, if the error is above 1.
    cause: Cause,
}

/// The findings about one stage at the pixels of a tile.
#[derive(Debug)]
pub(crate) struct Marks {
    rect: Rect,
    found: Vec<AtPixel>,
    worst: Option<Finding>,
    /// Every check, if the caller wants to explain a pixel.
    log: Option<Vec<(f64, Fault)>>,
}

/// The marks of one pixel.
pub(crate) struct PixelMarks<'a> {
    marks: &'a mut Marks,
    pixel: usize,
}

impl Marks {
    /// Marks without a finding.
    pub(crate) fn new(rect: Rect) -> Self {
        Self { rect, found: vec![AtPixel::default(); rect.pixels()], worst: None, log: None }
    }

    /// Marks without a finding that will record every check.
    pub(crate) fn logging(rect: Rect) -> Self {
        Self { log: Some(Vec::new()), ..Self::new(rect) }
    }

    /// Whether every check is recorded.
    pub(crate) fn logs(&self) -> bool {
        self.log.is_some()
    }

    /// Marks without a finding for another part of the picture, which record as much as these.
    pub(crate) fn beside(&self, rect: Rect) -> Self {
        Self { log: self.log.as_ref().map(|_| Vec::new()), ..Self::new(rect) }
    }

    /// The findings of some parts in a row.
    fn in_a_row(parts: Vec<Self>) -> Self {
        let mut row = Self::new(Rect { x0: 0, y0: 0, x1: 0, y1: 1 });
        for part in parts {
            row.found.extend(part.found);
            keep_worse(&mut row.worst, part.worst);
        }
        row.rect.x1 = row.found.len() as u32;
        row
    }

    /// All recorded checks.
    pub(crate) fn checks(self, stage: &'static str) -> impl Iterator<Item = Check> {
        let log = self.log.into_iter().flatten();
        log.map(move |(error, fault)| Check { stage, fault, error })
    }

    /// Marks without a finding for a whole picture.
    pub(crate) fn picture(job: &Job<'_>) -> Self {
        Self::new(job.picture())
    }

    /// Turns the marks of a whole picture into the findings about a stage.
    pub(crate) fn whole(self, stage: &'static str, planes: Vec<&'static str>) -> StageVerdict {
        whole(Some(self.rect), stage, planes, vec![self])
    }

    /// Adds the findings of a part of the picture: at each pixel the larger error, and all doubts.
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

    /// The findings at each pixel.
    fn pixels(&self) -> impl Iterator<Item = ((u32, u32), AtPixel)> {
        pixels(self.rect).zip(self.found.iter().copied())
    }

    /// Number of pixels with any of these doubts.
    pub(crate) fn doubtful(&self, doubts: u8) -> u64 {
        self.found.iter().filter(|at| at.doubts & doubts != 0).count() as u64
    }

    /// The marks of the pixel that holds a position, or of the pixel at the border next to it.
    pub(crate) fn near(&mut self, position: [f32; 2]) -> PixelMarks<'_> {
        self.at(place(self.rect, self.pixel(position)))
    }

    /// That pixel.
    pub(crate) fn pixel(&self, [x, y]: [f32; 2]) -> (u32, u32) {
        let Rect { x0, y0, x1, y1 } = self.rect;
        let inside = |at: f32, first: u32, end: u32| {
            f64::from(at).clamped(first.into(), (end - 1).into()) as u32
        };
        (inside(x, x0, x1), inside(y, y0, y1))
    }

    /// The marks of one pixel. Pixels are numbered row by row.
    pub(crate) fn at(&mut self, pixel: usize) -> PixelMarks<'_> {
        PixelMarks { marks: self, pixel }
    }
}

impl PixelMarks<'_> {
    /// Records a value and its error in bounds, or NaN if it has no bounds. `fault` describes the
    /// fault if the error is above 1.
    pub(crate) fn found(&mut self, error: f64, fault: impl Fn() -> Fault) {
        let Marks { rect, found, worst, log } = &mut *self.marks;
        if let Some(log) = log {
            let fault = fault();
            let unknown = matches!(&fault, Fault::Value { radius, .. } if radius.is_nan());
            // A right value with an unknown radius would be logged as any number, which tells
            // nothing.
            let anything = unknown && !(error > 1.0);
            if !anything {
                log.push((error, fault));
            }
        }
        let at = &mut found[self.pixel];
        if error.is_nan() {
            at.doubts |= Doubt::Unbounded as u8;
        }
        // Written so that a NaN returns here.
        if !(error > f64::from(at.error)) {
            return;
        }
        // An error above 1 must not be rounded to 1.
        let single = error as f32;
        at.error = if error > 1.0 && single <= 1.0 { 1.0_f32.next_up() } else { single };
        if error > 1.0 {
            let fault = fault();
            at.cause = Cause::from_fault(&fault);
            if worst.as_ref().is_none_or(|worst| error > worst.error) {
                let columns = rect.columns();
                let (x, y) = (self.pixel % columns, self.pixel / columns);
                let pixel = (rect.x0 + x as u32, rect.y0 + y as u32);
                *worst = Some(Finding { pixel, fault, error });
            }
        }
    }

    /// Records an error of at most 1: nothing is wrong.
    pub(crate) fn right(&mut self, error: f64) {
        let at = &mut self.marks.found[self.pixel];
        at.error = at.error.at_least(error as f32);
    }

    /// Records a decision that may be either way.
    pub(crate) fn doubt(&mut self, doubt: Doubt, there: bool) {
        if there {
            self.doubts(doubt as u8);
        }
    }

    /// Clears the doubts, because nothing depends on the open decisions.
    pub(crate) fn settle(&mut self) {
        self.marks.found[self.pixel].doubts = 0;
    }

    /// Records decisions that may be either way, as bits.
    pub(crate) fn doubts(&mut self, doubts: u8) {
        self.marks.found[self.pixel].doubts |= doubts;
    }
}

/// Turns the marks of all tiles into the findings about each stage. `stages` holds the names of the
/// stages, and the planes that were judged.
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
    let picture = job.part.is_none().then(|| job.picture());
    job.exec.ordered(all, |((stage, planes), parts)| whole(picture, stage, planes, parts))
}

/// Turns the marks of the parts of a picture, which share no pixel, into the findings about a
/// stage. Without a picture, the planes have one row: the pixels of all parts, one part after the
/// other.
fn whole(
    picture: Option<Rect>,
    stage: &'static str,
    planes: Vec<&'static str>,
    parts: Vec<Marks>,
) -> StageVerdict {
    let pixels = parts.iter().map(|part| part.found.len()).sum::<usize>() as u32;
    let [width, height] = picture.map_or([pixels, 1], |all| [all.x1, all.y1]);
    let mut next = 0;
    let mut judged = StageVerdict {
        stage,
        planes,
        missing: Vec::new(),
        unjudged: Vec::new(),
        errors: Plane::filled(width, height, 0.0),
        doubts: Plane::filled(width, height, 0),
        wrong: 0,
        causes: Causes::default(),
        worst: None,
    };
    for part in parts {
        let columns = part.rect.columns();
        for (y, row) in (part.rect.y0..).zip(part.found.chunks_exact(columns)) {
            let first = picture.map_or(next, |all| place(all, (part.rect.x0, y)));
            next += columns;
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

/// The index of a pixel in a rectangle, row by row.
fn place(rect: Rect, (x, y): (u32, u32)) -> usize {
    (y - rect.y0) as usize * rect.columns() + (x - rect.x0) as usize
}

/// Keeps the worse of two findings; on a tie, the one that comes first, row by row.
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

/// A rectangle of pixels in a tile.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TilePart {
    /// The number of the tile.
    pub(crate) tile: usize,
    pub(crate) rect: Rect,
}

/// Which pixels of the planes to judge.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Watch {
    All,
    /// Judge only this pixel, and record every check there.
    One((u32, u32)),
}

impl Watch {
    /// Watches one pixel of the picture.
    ///
    /// # Errors
    /// [`crate::Error::Usage`] if the pixel is outside the picture.
    pub(crate) fn one(job: &Job<'_>, (x, y): (u32, u32)) -> Result<Self> {
        job.camera.check_pixel(x, y)?;
        Ok(Self::One((x, y)))
    }

    /// The parts of the planes to judge, each in its tile.
    pub(crate) fn parts(self, grid: &Grid) -> Vec<(usize, Rect)> {
        match self {
            Self::All => grid.rects().into_iter().enumerate().collect(),
            Self::One((x, y)) if grid.holds(x, y) => {
                vec![(grid.place(x, y).0, Rect::pixel((x, y)))]
            }
            Self::One(_) => Vec::new(),
        }
    }

    /// The parts of the job's picture to judge, or of the one part of it that is judged.
    pub(crate) fn pieces(self, job: &Job<'_>) -> Vec<(usize, Rect)> {
        match (self, job.part) {
            (Self::All, Some(part)) => part.pieces.to_vec(),
            _ => self.parts(&job.grid()),
        }
    }

    /// The marks of all parts as one. If only a part of the picture is judged, its pixels are one
    /// row, one piece after the other.
    pub(crate) fn together(self, job: &Job<'_>, parts: Vec<Marks>) -> Marks {
        if job.part.is_some() {
            return Marks::in_a_row(parts);
        }
        let mut marks = self.picture(job);
        parts.into_iter().for_each(|part| marks.put(part));
        marks
    }

    /// Empty marks for a part.
    pub(crate) fn marks(self, rect: Rect) -> Marks {
        match self {
            Self::All => Marks::new(rect),
            Self::One(_) => Marks::logging(rect),
        }
    }

    /// Empty marks for all parts.
    pub(crate) fn picture(self, job: &Job<'_>) -> Marks {
        self.marks(if let Self::One(at) = self { Rect::pixel(at) } else { job.picture() })
    }
}

/// Marks on the cells of levels, each at its place in the plane of its own level. Where a part of the
/// picture is judged, these are the cells at the places of the part.
pub(crate) struct LevelMarks {
    watch: Watch,
    /// The marks of the pieces that are judged, or of the whole picture.
    pieces: Vec<Marks>,
}

impl LevelMarks {
    pub(crate) fn new(job: &Job<'_>, watch: Watch) -> Self {
        let pieces = match job.part {
            Some(part) => part.pieces.iter().map(|(_, rect)| watch.marks(*rect)).collect(),
            None => vec![watch.picture(job)],
        };
        Self { watch, pieces }
    }

    /// Judges a level: `judge` marks the wrong cells of a rectangle.
    pub(crate) fn level(
        &mut self,
        job: &Job<'_>,
        size: [u32; 2],
        judge: impl Fn(Rect, &mut Marks) + Sync + Send,
    ) {
        let whole = Rect::of_size(size);
        let rects: Vec<(usize, Rect)> = match job.part {
            Some(part) => {
                let all = part.pieces.iter().map(|(_, rect)| rect.intersection(&whole));
                all.enumerate().filter(|(_, rect)| !rect.is_empty()).collect()
            }
            None => {
                let all = self.watch.parts(&job.exec.grid(size[0], size[1]));
                all.into_iter().map(|(_, rect)| (0, rect)).collect()
            }
        };
        let watch = self.watch;
        let found = job.exec.ordered(rects, |(piece, rect)| {
            let mut marks = watch.marks(rect);
            judge(rect, &mut marks);
            (piece, marks)
        });
        found.into_iter().for_each(|(piece, marks)| self.pieces[piece].put(marks));
    }

    /// The marks on all levels.
    pub(crate) fn together(mut self, job: &Job<'_>) -> Marks {
        match (job.part, self.pieces.pop()) {
            (None, Some(picture)) => picture,
            (_, last) => Marks::in_a_row(self.pieces.into_iter().chain(last).collect()),
        }
    }
}

/// The findings about a stage: its name, the planes that were judged, and the marks.
pub(crate) type StageMarks = (&'static str, Vec<&'static str>, Marks);

/// The findings about a method that has levels before its picture. Its last N stages are judged
/// tile by tile.
pub(crate) struct MethodMarks<const N: usize> {
    pub(crate) levels: Vec<StageMarks>,
    pub(crate) stages: [(&'static str, Vec<&'static str>); N],
    pub(crate) tiles: Vec<[Marks; N]>,
}

impl<const N: usize> MethodMarks<N> {
    /// Turns the findings about all stages into planes.
    pub(crate) fn stage_verdicts(self, job: &Job<'_>) -> Vec<StageVerdict> {
        let levels = self.levels.into_iter();
        let levels = levels.map(|(stage, planes, marks)| marks.whole(stage, planes));
        levels.chain(stage_verdicts(job, self.stages, self.tiles)).collect()
    }

    /// All recorded checks.
    pub(crate) fn checks(self) -> Vec<Check> {
        let names = self.stages.map(|(stage, _)| stage);
        let tiles = self.tiles.into_iter().flat_map(|tile| names.into_iter().zip(tile));
        let levels = self.levels.into_iter().map(|(stage, _, marks)| (stage, marks));
        levels.chain(tiles).flat_map(|(stage, marks)| marks.checks(stage)).collect()
    }
}

/// Counts of a tile beside its marks.
#[derive(Debug, Default)]
pub(crate) struct Counts {
    /// Number of pixels that may be covered.
    pub(crate) covered: u64,
    /// Number of covered pixels with undecided sums.
    pub(crate) undecided: u64,
    /// The undecided decisions whose outcome the client's numbers tell.
    pub(crate) shifts: ShiftSums,
}

impl Counts {
    /// Adds the counts of another tile.
    pub(crate) fn add(&mut self, tile: Self) {
        self.covered += tile.covered;
        self.undecided += tile.undecided;
        self.shifts.add(tile.shifts);
    }
}

/// The verdict on a method whose stages are judged tile by tile, on the tiles of the job. `judge` marks the wrong pixels of
/// a rectangle in a tile.
pub(crate) fn verdict<const N: usize>(
    job: &Job<'_>,
    stages: [(&'static str, Vec<&'static str>); N],
    budget: f64,
    judge: impl Fn(TilePart, &mut [Marks; N]) -> Counts + Sync + Send,
) -> Verdict {
    let found = job.exec.ordered(Watch::All.pieces(job), |(tile, rect)| {
        let mut marks = [(); N].map(|()| Marks::new(rect));
        let counts = judge(TilePart { tile, rect }, &mut marks);
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

/// Every check that `judge` makes at one pixel.
///
/// # Errors
/// [`crate::Error::Usage`] if the pixel is outside the picture.
pub(crate) fn checks<const N: usize>(
    job: &Job<'_>,
    stages: [&'static str; N],
    pixel: (u32, u32),
    judge: impl FnOnce(TilePart, &mut [Marks; N]) -> Counts,
) -> Result<Vec<Check>> {
    let Place { tile, rect } = Place::new(job, pixel)?;
    let mut marks = [(); N].map(|()| Marks::logging(rect));
    judge(TilePart { tile, rect }, &mut marks);
    Ok(logged(&mut marks, &stages))
}

/// The recorded checks of each stage, one stage after the other.
fn logged(marks: &mut [Marks], stages: &[&'static str]) -> Vec<Check> {
    let mut all = Vec::new();
    for (marks, stage) in marks.iter_mut().zip(stages) {
        let log = marks.log.take().unwrap_or_default();
        all.extend(log.into_iter().map(|(error, fault)| Check { stage, fault, error }));
    }
    all
}

/// The pixels of a tile, numbered row by row.
pub(crate) fn counted(rect: Rect) -> impl Iterator<Item = (usize, (u32, u32))> {
    pixels(rect).enumerate()
}
