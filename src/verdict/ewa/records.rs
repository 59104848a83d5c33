//! Verify a client's projection: each number of its records is in its ball, and no surfel is
//! missing or too many. The later stages are judged from these records, exactly as they are stored.

use super::swift::{SwiftSplat, SwiftSplats};
use crate::frame::Rect;
use crate::method::Job;
use crate::method::ewa::Settings;
use crate::method::ewa::possible::{self, PossibleSplat};
use crate::method::prepare::Prepared;
use crate::number::ball::Profile;
use crate::number::{Ball, MapInline, Real, Truth, Vector2};
use crate::scene::Surfels;
use crate::splat::project::project_as;
use crate::splat::record::SplatRecord;
use crate::splat::{Footprint, Projector, Reasons, Splat, Tally, View, batch};
use crate::verdict::marks::Marks;
use crate::verdict::supposed::Supposed;
use crate::verdict::{Fault, StageVerdict};

/// The name of the stage.
const STAGE: &str = "projection";

/// The splats of a client's records, each with the bounds that its surfel may have.
pub(super) fn project<P: Profile>(
    job: &Job<'_>,
    settings: &Settings,
    records: &[SplatRecord],
) -> SwiftSplats<P> {
    let surfels = &job.scene.surfels;
    let picture = job.picture();
    Prepared::new(
        job,
        &job.grid(),
        settings,
        records.len(),
        |projector, range, splats| {
            for record in &records[range] {
                let Some(disc) = disc(surfels, record) else { continue };
                let mut bounds = Rect::default();
                possible::each_possible(projector, &disc, record.surfel, &mut |splat, _| {
                    bounds = bounds.hull(&splat.bounds.intersection(&picture));
                });
                if !bounds.is_empty() {
                    let footprint = record.footprint().map(Ball::from_f32);
                    let back = (record.back != 0).into();
                    let splat = Splat { footprint, bounds, surfel: record.surfel, back };
                    splats.push(SwiftSplat::new(PossibleSplat { splat, certain: true }));
                }
            }
            Tally::default()
        },
        SwiftSplat::bounds,
    )
}

/// The surfel of a record, or none if the scene has no such surfel.
fn disc<P: Profile>(
    surfels: &Surfels,
    record: &SplatRecord,
) -> Option<crate::splat::Disc<Ball<P>>> {
    let i = record.surfel as usize;
    (i < surfels.len()).then(|| batch::disc(surfels, i))
}

/// Judges the records. Each fault is marked at the pixel of the record's centre.
pub(super) fn judge<P: Profile>(
    job: &Job<'_>,
    settings: &Settings,
    records: &[SplatRecord],
    supposed: Supposed,
) -> StageVerdict {
    let surfels = &job.scene.surfels;
    let projector =
        Projector::<Ball<P>>::new(View::new(job.camera), &settings.kernel, settings.cull);
    let ranges = (0..surfels.len()).step_by(4096);
    let ranges = ranges.map(|first| first..surfels.len().min(first + 4096)).collect();
    let found = job.exec.ordered(ranges, |range: std::ops::Range<usize>| {
        let of_surfel = |i: usize| {
            let at = records.binary_search_by_key(&(i as u32), |record| record.surfel);
            let other = |splat, certain| {
                let possible = PossibleSplat { splat, certain };
                supposed.splat(possible, &settings.kernel, &job.picture())
            };
            let record = at.ok().map(|at| &records[at]);
            judge_surfel(&projector, &other, surfels, i as u32, record)
        };
        range.filter_map(of_surfel).collect::<Vec<_>>()
    });
    let mut marks = Marks::picture(job);
    for Worst { error, at, surfel, what } in found.into_iter().flatten() {
        marks.near(at).found(error, || what.fault(surfel));
    }
    for record in records.iter().filter(|record| record.surfel as usize >= surfels.len()) {
        let fault = || Fault::Projected { surfel: record.surfel };
        marks.near(record.center).found(f64::INFINITY, fault);
    }
    marks.whole(STAGE, vec!["records"])
}

/// The worst error in the record of a surfel. It has no words, because most records are right.
#[derive(Clone, Copy)]
struct Worst {
    /// The error in bounds.
    error: f64,
    /// The position of the record's centre.
    at: [f32; 2],
    surfel: u32,
    what: What,
}

#[derive(Clone, Copy)]
enum What {
    /// A number: its name, the client's value, the truth, and its radius.
    Number {
        name: &'static str,
        found: f64,
        truth: f64,
        radius: f64,
    },
    /// The side that the camera sees, according to the client.
    Side {
        back: bool,
    },
    Copied,
    Projected,
    NotProjected,
}

impl What {
    /// The fault in words.
    fn fault(self, surfel: u32) -> Fault {
        match self {
            Self::Number { name, found, truth, radius } => {
                let channel = format!("{name} of surfel {surfel}");
                Fault::Value { channel, found, truth, radius }
            }
            Self::Side { back } => {
                let channel = format!("back of surfel {surfel}");
                Fault::Whole { channel, found: back.into(), truth: (!back).into() }
            }
            Self::Copied => Fault::Copied { surfel },
            Self::Projected => Fault::Projected { surfel },
            Self::NotProjected => Fault::NotProjected { surfel },
        }
    }
}

/// Changes a splat that certainly is drawn, or may be, by the rules that are supposed.
type Other<'o, P> = &'o dyn Fn(Splat<Ball<P>>, bool) -> PossibleSplat<P>;

/// The worst error in the record of a surfel; none if the surfel has no record and needs none.
fn judge_surfel<P: Profile>(
    projector: &Projector<Ball<P>>,
    other: Other<'_, P>,
    surfels: &Surfels,
    surfel: u32,
    record: Option<&SplatRecord>,
) -> Option<Worst> {
    let disc = batch::disc(surfels, surfel as usize);
    let mut best: Option<(f64, What)> = None;
    let mut missing = None;
    possible::each_possible(projector, &disc, surfel, &mut |splat, certain| {
        let PossibleSplat { splat, certain } = other(splat, certain);
        let center = splat.footprint.center.map(Real::to_f32);
        missing = certain.then_some([center.x, center.y]);
        if let Some(record) = record {
            let (error, what) = worst(&splat, record, surfels);
            if best.is_none_or(|(least, _)| error < least) {
                best = Some((error, what));
            }
        }
    });
    let certainly = |at, what| Worst { error: f64::INFINITY, at, surfel, what };
    match (record, best) {
        (Some(record), Some((error, what))) => {
            Some(Worst { error, at: record.center, surfel, what })
        }
        // A record out of sight is harmless, because the pixels that it draws are judged.
        (Some(record), None) => {
            let (_, reasons) = project_as(projector, &disc, surfel, false);
            let Reasons { behind, degenerate, back_facing, .. } = reasons;
            let dropped = (behind | degenerate | back_facing).certainly();
            dropped.then(|| certainly(record.center, What::Projected))
        }
        (None, _) => missing.map(|at| certainly(at, What::NotProjected)),
    }
}

/// The worst error of a record that has a splat.
fn worst<P: Profile>(
    splat: &Splat<Ball<P>>,
    record: &SplatRecord,
    surfels: &Surfels,
) -> (f64, What) {
    let back = record.back != 0;
    let turned = if back { splat.back.possibly() } else { !splat.back.certainly() };
    if !same_attributes(record, surfels) {
        return (f64::INFINITY, What::Copied);
    } else if !turned {
        return (f64::INFINITY, What::Side { back });
    }
    let truth = numbers(&splat.footprint);
    let found = numbers(&record.footprint().map(Ball::<P>::from_f32));
    let mut worst = (-1.0, What::Copied);
    for ((name, truth), (_, found)) in truth.into_iter().zip(found) {
        let error = truth.misfit(found);
        if error > worst.0 {
            let (found, truth, radius) = (found.middle, truth.middle, truth.radius);
            worst = (error, What::Number { name, found, truth, radius });
        }
    }
    worst
}

/// Every number of a footprint, with its name in the record.
fn numbers<R: Copy>(f: &Footprint<R>) -> [(&'static str, R); 11] {
    let Vector2 { x, y } = f.center;
    [
        ("center.x", x),
        ("center.y", y),
        ("ux", f.ux),
        ("uy", f.uy),
        ("vy", f.vy),
        ("w0", f.w0),
        ("wx", f.wx),
        ("wy", f.wy),
        ("w_far", f.w_far),
        ("w_near", f.w_near),
        ("amplitude", f.amplitude),
    ]
}

/// A field of records: its name in a record, how many records have a wrong one, and how many times
/// the right one it is, if that is the same in nearly all of them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct WrongField {
    pub(crate) name: String,
    pub(crate) wrong: usize,
    pub(crate) times: Option<f64>,
}

/// The numbers that are wrong in some record.
pub(crate) fn wrong_fields<P: Profile>(
    job: &Job<'_>,
    settings: &Settings,
    records: &[SplatRecord],
) -> Vec<WrongField> {
    let surfels = &job.scene.surfels;
    let projector =
        Projector::<Ball<P>>::new(View::new(job.camera), &settings.kernel, settings.cull);
    let mut times: Vec<(&'static str, Vec<f64>)> = Vec::new();
    for record in records {
        let Some(disc) = disc(surfels, record) else { continue };
        let mut truth = None;
        possible::each_possible(&projector, &disc, record.surfel, &mut |splat, _| {
            truth = Some(numbers(&splat.footprint));
        });
        let found = numbers(&record.footprint().map(Ball::<P>::from_f32));
        for (i, (name, truth)) in truth.into_iter().flatten().enumerate() {
            if times.len() <= i {
                times.push((name, Vec::new()));
            }
            if truth.misfit(found[i].1) > 1.0 {
                times[i].1.push(found[i].1.middle / truth.middle);
            }
        }
    }
    let wrong = times.into_iter().filter(|(_, times)| !times.is_empty());
    wrong.map(|(name, times)| WrongField::new(name.to_owned(), times)).collect()
}

impl WrongField {
    /// A field with the quotients of its wrong numbers and the right ones; there are some.
    pub(crate) fn new(name: String, times: Vec<f64>) -> Self {
        Self { name, wrong: times.len(), times: usual(times) }
    }
}

/// The number that nearly all of some numbers are.
fn usual(mut all: Vec<f64>) -> Option<f64> {
    all.sort_by(f64::total_cmp);
    let middle = all[all.len() / 2];
    let near = |value: &&f64| (**value - middle).abs() <= 0.001 * middle.abs();
    (10 * all.iter().filter(near).count() >= 9 * all.len()).then_some(middle)
}

/// Whether the record's copied attributes equal the surfel's.
fn same_attributes(record: &SplatRecord, surfels: &Surfels) -> bool {
    let i = record.surfel as usize;
    let normal = surfels.normal()[i].to_array();
    let turned = if record.back != 0 { normal.map_inline(|part| -part) } else { normal };
    turned == record.normal
        && surfels.opacity().is_none_or(|opacity| opacity[i] == record.opacity)
        && surfels.color().is_none_or(|color| color[i].to_array() == record.color)
}
