//! Verify a client's projection: each number of its records is in its ball, and no item is missing or
//! too many. What follows is judged from these records, exactly as they are stored.

use super::splats::{PossibleSplat, PossibleSplats, projected, recorded};
use super::walk::Walker;
use crate::frame::Rect;
use crate::method::Job;
use crate::method::gaussians::record::{GaussianRecord, RecordPart, Step};
use crate::method::gaussians::splats::{Projected, Source};
use crate::method::gaussians::{Order, Settings};
use crate::number::ball::Profile;
use crate::number::{Ball, Real, Truth};
use crate::verdict::client::{Storage, known};
use crate::verdict::ewa::WrongField;
use crate::verdict::marks::{Marks, TilePart};
use crate::verdict::supposed::Supposed;
use crate::verdict::{Fault, StageVerdict};

/// The name of the stage.
const STAGE: &str = "projection";

/// Items that one job judges.
const SIZE: usize = 1024;

/// Judges the records, and puts their numbers in the place of the splats'. Each fault is marked at the
/// pixel of the record's centre.
///
/// An item without a record stays a splat that may be drawn, unless it certainly is drawn at the pixel
/// of its centre: then the projection is at fault, and not what follows.
pub(super) fn judge<P: Profile>(
    job: &Job<'_>,
    source: &Source<'_, Ball<P>>,
    supposed: Supposed,
    depth_test: Storage,
    records: &[GaussianRecord],
    own: Vec<PossibleSplat<P>>,
) -> (Vec<PossibleSplat<P>>, StageVerdict) {
    let keys = Keys::new(source, &own);
    let chunks = records.chunks(SIZE).collect();
    let found = job.exec.ordered(chunks, |chunk: &[GaussianRecord]| {
        chunk.iter().map(|record| one(job, source, supposed, record, &keys)).collect::<Vec<_>>()
    });
    let mut marks = Marks::picture(job);
    let mut all = Vec::with_capacity(records.len());
    for (record, (splat, worst)) in records.iter().zip(found.into_iter().flatten()) {
        marks.near(record.center).found(worst.error, || worst.fault(record.index));
        all.extend(splat);
    }
    let none = PossibleSplats::new(job, Vec::new(), supposed);
    let part = TilePart { tile: 0, rect: Rect::default() };
    let walker = Walker::new(source, supposed, depth_test, &none, part);
    let has_record = |splat: &PossibleSplat<P>| {
        records.binary_search_by_key(&splat.splat.index, |record| record.index).is_ok()
    };
    for splat in own.into_iter().filter(|splat| !has_record(splat)) {
        let center = splat.splat.center.map(Real::to_f32);
        if walker.certainly_draws(&splat, marks.pixel([center.x, center.y])) {
            let fault = || Fault::NotProjected { surfel: splat.splat.index };
            marks.near([center.x, center.y]).found(f64::INFINITY, fault);
        } else {
            all.push(splat);
        }
    }
    (all, marks.whole(STAGE, vec!["records"]))
}

/// The keys of an order that compares steps, in ascending index.
struct Keys<P: Profile>(Option<Vec<(u32, Ball<P>)>>);

impl<P: Profile> Keys<P> {
    fn new(source: &Source<'_, Ball<P>>, own: &[PossibleSplat<P>]) -> Self {
        let steps = source.settings.order == Order::Steps;
        Self(steps.then(|| own.iter().map(|one| (one.splat.index, one.splat.key)).collect()))
    }

    /// The key of an item; any number if it has none.
    fn key(&self, index: u32, projected: &Projected<Ball<P>>, order: Order) -> Ball<P> {
        let Some(keys) = &self.0 else { return projected.key(order) };
        let found = keys.binary_search_by_key(&index, |(index, _)| *index);
        found.map_or(known(f64::NAN, f64::NAN), |at| keys[at].1)
    }
}

/// The splat of a record, if it may touch a pixel, and the worst error in the record.
fn one<P: Profile>(
    job: &Job<'_>,
    source: &Source<'_, Ball<P>>,
    supposed: Supposed,
    record: &GaussianRecord,
    keys: &Keys<P>,
) -> (Option<PossibleSplat<P>>, Worst) {
    let not_drawn = Worst { error: f64::INFINITY, what: None };
    if record.index as usize >= source.len() {
        return (None, not_drawn);
    }
    let (own, drawn) = projected(source, supposed, record.index as usize);
    let worst = if drawn.possibly() {
        let truth = truth(source, record.index, &own, keys);
        first_wrong(&truth, record, own.disc.is_some())
    } else {
        not_drawn
    };
    (recorded(job, source, record, worst.error > 1.0, &own), worst)
}

/// The record of an item in balls.
fn truth<P: Profile>(
    source: &Source<'_, Ball<P>>,
    index: u32,
    own: &Projected<Ball<P>>,
    keys: &Keys<P>,
) -> GaussianRecord<Ball<P>> {
    let key = keys.key(index, own, source.settings.order);
    let color = source.look(index as usize, own.shape.position).1;
    GaussianRecord::new(index, own, key, color, [0; 4])
}

/// The worst error in a record. It has no words, because most records are right.
struct Worst {
    /// The error in bounds.
    error: f64,
    /// The number; none if the item certainly is not drawn, or does not exist.
    what: Option<Number>,
}

/// A number of a record, and the truth.
#[derive(Clone, Copy)]
struct Number {
    /// The place of its field in the table, and its own in the field.
    at: (usize, usize),
    found: f64,
    truth: f64,
    radius: f64,
}

impl Worst {
    /// The fault in words.
    fn fault(&self, surfel: u32) -> Fault {
        let Some(Number { at, found, truth, radius }) = self.what else {
            return Fault::Projected { surfel };
        };
        Fault::Value {
            channel: format!("{} of surfel {surfel}", name(at.0, at.1)),
            found,
            truth,
            radius,
        }
    }
}

/// The name of a number of a record.
fn name(field: usize, i: usize) -> String {
    GaussianRecord::<f32>::TABLE[field].component(i)
}

/// The number with the largest error in the first field that is wrong, in the order of the projection.
/// If none is wrong, the number with the largest error of all.
fn first_wrong<P: Profile>(
    truth: &GaussianRecord<Ball<P>>,
    record: &GaussianRecord,
    is_disc: bool,
) -> Worst {
    let mut first: Option<(Step, Worst)> = None;
    each_number(truth, record, is_disc, |step, number, error| {
        let comes_first = first.as_ref().is_none_or(|(other, worst)| match worst.error > 1.0 {
            true if error > 1.0 && step != *other => step < *other,
            true => step == *other && error > worst.error,
            false => error > worst.error,
        });
        if comes_first {
            first = Some((step, Worst { error, what: Some(number) }));
        }
    });
    first.map_or(Worst { error: 0.0, what: None }, |(_, worst)| worst)
}

/// Compares each number of a record that is judged with the truth: its error in bounds.
fn each_number<P: Profile>(
    truth: &GaussianRecord<Ball<P>>,
    record: &GaussianRecord,
    is_disc: bool,
    mut each: impl FnMut(Step, Number, f64),
) {
    let tables = GaussianRecord::<Ball<P>>::TABLE.iter().zip(&GaussianRecord::<f32>::TABLE);
    for (field, (of_truth, of_record)) in tables.enumerate() {
        let Some(step) = of_truth.step.filter(|step| !(is_disc && step.is_of_ellipse())) else {
            continue;
        };
        let (RecordPart::Numbers(truths, _), RecordPart::Numbers(numbers, _)) =
            (&of_truth.part, &of_record.part)
        else {
            continue;
        };
        for (i, (truth, found)) in truths(truth).iter().zip(numbers(record)).enumerate() {
            let error = truth.misfit(Ball::from_f32(*found));
            let (found, truth, radius) = (f64::from(*found), truth.middle, truth.radius);
            each(step, Number { at: (field, i), found, truth, radius }, error);
        }
    }
}

/// A wrong number: its step and place, and how many times the right one it is.
type WrongNumber = ((Step, (usize, usize)), f64);

/// The numbers that are wrong in some record.
pub(crate) fn wrong_fields<P: Profile>(
    job: &Job<'_>,
    settings: &Settings,
    records: &[GaussianRecord],
) -> Vec<WrongField> {
    let source = Source::<Ball<P>>::new(job.scene, job.camera, settings);
    let keys = Keys::new(&source, &PossibleSplats::found(job, &source, Supposed::Nothing));
    let mut times: Vec<WrongNumber> = Vec::new();
    for record in records.iter().filter(|record| (record.index as usize) < source.len()) {
        let (own, drawn) = projected(&source, Supposed::Nothing, record.index as usize);
        if !drawn.possibly() {
            continue;
        }
        let truth = truth(&source, record.index, &own, &keys);
        each_number(&truth, record, own.disc.is_some(), |step, number, error| {
            if error > 1.0 {
                times.push(((step, number.at), number.found / number.truth));
            }
        });
    }
    times.sort_by_key(|(number, _)| *number);
    let of_a_number = times.chunk_by(|a, b| a.0 == b.0);
    let field = |all: &[WrongNumber]| {
        let ((_, at), _) = all[0];
        WrongField::new(name(at.0, at.1), all.iter().map(|(_, times)| *times).collect())
    };
    of_a_number.map(field).collect()
}
