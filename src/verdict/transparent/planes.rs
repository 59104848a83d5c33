//! The planes that a client hands in, and the groups that they belong to.

use super::replay::Layers;
use crate::composite::over::Blend;
use crate::frame::NO_ID;
use crate::method::Job;
use crate::method::record::{Field, rows};
use crate::method::stage::{Conditions, Keep};
use crate::method::transparent::blending::GroupLayers;
use crate::number::ball::Profile;
use crate::number::{Ball, MapInline, Real};
use crate::verdict::checks::{Report, anything, least_wrong, widened};
use crate::verdict::client::{Client, Storage};
use crate::verdict::marks::PixelMarks;
use crate::verdict::planes::RecordPlanes;

/// The planes of a group.
#[derive(Clone, Debug)]
pub(super) struct GroupPlanes<'a> {
    pub(super) planes: RecordPlanes<'a>,
    accumulator: Storage,
    there: Conditions,
}

/// A group at a pixel, as the average reads it. A NaN radius marks an unknown number.
#[derive(Clone, Debug)]
pub(crate) struct GroupFound<P: Profile> {
    /// The possible results of blending that fit the planes; none if they are not known.
    pub(super) all: Option<Vec<Layers<P>>>,
    pub(super) color: [Ball<P>; 3],
    pub(super) alpha: Ball<P>,
    pub(super) opacity: Ball<P>,
    pub(super) hidden: Ball<P>,
    pub(super) count: Option<u8>,
    /// The stored depth.
    pub(super) depth: Option<Ball<P>>,
}

impl<P: Profile> GroupFound<P> {
    /// Whether the pixel may be covered.
    pub(crate) fn covered(&self) -> bool {
        self.count != Some(0)
    }
}

impl<'a> GroupPlanes<'a> {
    pub(super) fn new(job: &Job<'_>, client: &'a Client, group: usize) -> Self {
        let rows = rows(&GroupLayers::<f32>::PLANES).into_iter().enumerate();
        // Among the numbers, the bin is judged first.
        let (bin, others): (Vec<_>, Vec<_>) =
            rows.partition(|(_, row)| *row == GroupLayers::<f32>::BIN.row);
        Self {
            planes: RecordPlanes::of_rows(client, bin.into_iter().chain(others), group),
            accumulator: client.accumulator,
            there: job.there(Keep::Alone),
        }
    }

    /// Marks a wrong group at a pixel, by the continuation that errs least. Returns the group as
    /// the average reads it.
    pub(super) fn judge<P: Profile>(
        &self,
        at: (u32, u32),
        all: Option<Vec<Layers<P>>>,
        pixel: &mut PixelMarks<'_>,
    ) -> GroupFound<P> {
        let check = |layers: &Layers<P>, report: &mut Report<'_>| {
            self.check(at, layers, report);
        };
        let fitting = all.map(|all| {
            if let Some(best) = least_wrong::<_, 1>(&all, check) {
                check(best, &mut |_, error, fault| pixel.found(error, fault));
            }
            self.fitting(all, check)
        });
        self.read(at, fitting)
    }

    /// The continuations that err least.
    fn fitting<P: Profile>(
        &self,
        all: Vec<Layers<P>>,
        check: impl Fn(&Layers<P>, &mut Report<'_>),
    ) -> Vec<Layers<P>> {
        // Nearly every pixel has one continuation, and checks take most of a verdict's time.
        if all.len() == 1 {
            return all;
        }
        let error = |layers: &Layers<P>| {
            let mut worst = 1.0_f64;
            check(layers, &mut |_, error, _| worst = worst.at_least(error));
            worst
        };
        let errors: Vec<f64> = all.iter().map(error).collect();
        let least = errors.iter().fold(f64::INFINITY, |least, error| least.at_most(*error));
        let fits = all.into_iter().zip(errors).filter(|(_, error)| *error <= least);
        fits.map(|(layers, _)| layers).collect()
    }

    /// Checks every plane at a pixel against a result of blending.
    fn check<P: Profile>(&self, at: (u32, u32), truth: &Layers<P>, report: &mut Report<'_>) {
        // Each layer rounds the stored values again.
        let lost = |largest: f64| f64::from(truth.count) * self.accumulator.radius(largest);
        let blend = Blend {
            color: truth.blend.color.map_inline(|part| widened(part, lost(truth.brightest))),
            alpha: widened(truth.blend.alpha, lost(1.0)),
        };
        let opacity = widened(truth.opacity, lost(truth.opacity.middle.at_least(1.0)));
        let truth = GroupLayers { blend, opacity, ..truth.stored() };
        self.planes.check(0, &GroupLayers::PLANES, at, &truth, report);
    }

    /// The group as the average reads it: the client's values, else all values of the
    /// continuations.
    fn read<P: Profile>(&self, at: (u32, u32), all: Option<Vec<Layers<P>>>) -> GroupFound<P> {
        let stored: Vec<_> = all.iter().flatten().map(Layers::stored).collect();
        let any = |of: &dyn Fn(&GroupLayers<Ball<P>>) -> Ball<P>| {
            stored.iter().map(of).reduce(Ball::either).unwrap_or(anything())
        };
        let count = any(&|layers| Ball::exact(layers.count.into()));
        let mut own = GroupLayers {
            blend: Blend {
                color: [0, 1, 2].map_inline(|c| any(&|layers| layers.blend.color[c])),
                alpha: any(&|layers| layers.blend.alpha),
            },
            opacity: any(&|layers| layers.opacity),
            hidden: any(&|layers| layers.hidden),
            count: count.middle as u8,
            bin: anything(),
            depth: anything(),
            surfel: NO_ID,
        };
        self.planes.read(&GroupLayers::PLANES, &self.there, at, &mut own);
        let there =
            |field: Field<GroupLayers<f32>, f32>| self.planes.names().contains(&field.row.name);
        let counted = there(GroupLayers::COUNT) || count.radius == 0.0;
        GroupFound {
            color: own.blend.color,
            alpha: own.blend.alpha,
            opacity: own.opacity,
            hidden: own.hidden,
            count: counted.then_some(own.count),
            depth: there(GroupLayers::DEPTH).then_some(own.depth),
            all,
        }
    }
}
