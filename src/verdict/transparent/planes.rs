//! The planes that a client has handed in, and the groups that they are of.

use super::replay::Layers;
use crate::method::Holds;
use crate::method::transparent::planes::{
    GROUP_ALPHA, GROUP_BIN, GROUP_COLOR, GROUP_COUNT, GROUP_DEPTH, GROUP_HIDDEN, GROUP_ID,
    GROUP_OPACITY,
};
use crate::number::ball::Profile;
use crate::number::{Ball, Real};
use crate::verdict::checks::{
    Report, anything, input, inputs, least_wrong, number, triple, whole, widened,
};
use crate::verdict::client::{Client, Storage, StoredPlane};
use crate::verdict::marks::PixelMarks;

/// The planes of a group, each if it is there.
#[derive(Clone, Copy, Debug)]
pub(super) struct GroupPlanes<'a> {
    color: Option<StoredPlane<'a, [f64; 3]>>,
    alpha: Option<StoredPlane<'a, f64>>,
    opacity: Option<StoredPlane<'a, f64>>,
    bin: Option<StoredPlane<'a, f64>>,
    count: Option<StoredPlane<'a, u8>>,
    id: Option<StoredPlane<'a, u32>>,
    hidden: Option<StoredPlane<'a, f64>>,
    depth: Option<StoredPlane<'a, f64>>,
    accumulator: Storage,
}

/// A group at a pixel, as the average reads it; NaN radii stand for what is not known.
#[derive(Clone, Debug)]
pub(crate) struct GroupFound<P: Profile> {
    /// What may have been blended, of what fits the planes; none if that is not known.
    pub(super) all: Option<Vec<Layers<P>>>,
    pub(super) color: [Ball<P>; 3],
    pub(super) alpha: Ball<P>,
    pub(super) opacity: Ball<P>,
    pub(super) hidden: Ball<P>,
    pub(super) count: Option<u8>,
    /// The depth that is stored.
    pub(super) depth: Option<Ball<P>>,
}

impl<P: Profile> GroupFound<P> {
    /// Whether something may be there.
    pub(crate) fn covered(&self) -> bool {
        self.count != Some(0)
    }
}

impl<'a> GroupPlanes<'a> {
    pub(super) fn new(client: &'a Client, group: usize) -> Self {
        Self {
            color: client.triple_of(&GROUP_COLOR, group),
            alpha: client.scalar_of(&GROUP_ALPHA, group),
            opacity: client.scalar_of(&GROUP_OPACITY, group),
            bin: client.scalar_of(&GROUP_BIN, group),
            count: client.count_of(&GROUP_COUNT, group),
            id: client.index_of(&GROUP_ID, group),
            hidden: client.scalar_of(&GROUP_HIDDEN, group),
            depth: client.scalar_of(&GROUP_DEPTH, group),
            accumulator: client.accumulator,
        }
    }

    fn names(&self) -> [Option<&'static str>; 8] {
        let scalar = |plane: Option<StoredPlane<'_, f64>>| plane.map(|plane| plane.name);
        [
            self.color.map(|plane| plane.name),
            scalar(self.alpha),
            scalar(self.opacity),
            scalar(self.bin),
            self.count.map(|plane| plane.name),
            self.id.map(|plane| plane.name),
            scalar(self.hidden),
            scalar(self.depth),
        ]
    }

    /// Marks what is wrong with the group at a pixel, by the continuation that errs least, and gives
    /// what the average reads.
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

    /// Every plane at a pixel, against what was blended.
    fn check<P: Profile>(&self, at: (u32, u32), truth: &Layers<P>, report: &mut Report<'_>) {
        // Each layer rounds what is stored between two.
        let lost = |largest: f64| f64::from(truth.count) * self.accumulator.radius(largest);
        if let Some(plane) = &self.id {
            whole(0, plane, at, truth.surfel, report);
        }
        if let Some(plane) = &self.count {
            whole(0, plane, at, truth.count, report);
        }
        let opacities = truth.opacity.middle.at_least(1.0);
        let scalars = [
            (&self.bin, Ball::exact(truth.bin)),
            (&self.alpha, widened(truth.blend.alpha, lost(1.0))),
            (&self.opacity, widened(truth.opacity, lost(opacities))),
            (&self.hidden, Ball::from_f32(f32::from(u8::from(truth.hidden)))),
            (&self.depth, truth.depth),
        ];
        for (plane, truth) in scalars {
            if let Some(plane) = plane {
                number(0, plane, at, truth, report);
            }
        }
        if let Some(plane) = &self.color {
            let truth = truth.blend.color.map(|part| widened(part, lost(truth.brightest)));
            triple(0, (plane, Holds::Color), at, truth, report);
        }
    }

    /// What the average reads: the client's, else all that the continuations may be.
    fn read<P: Profile>(&self, at: (u32, u32), all: Option<Vec<Layers<P>>>) -> GroupFound<P> {
        let any = |of: &dyn Fn(&Layers<P>) -> Ball<P>| {
            all.iter().flatten().map(of).reduce(Ball::either).unwrap_or(anything())
        };
        let scalar = |plane: Option<StoredPlane<'_, f64>>, of: &dyn Fn(&Layers<P>) -> Ball<P>| {
            plane.map_or_else(|| any(of), |plane| input(&plane, at))
        };
        let own = [0, 1, 2].map(|c| any(&|layers| layers.blend.color[c]));
        let hidden = |layers: &Layers<P>| Ball::exact(f64::from(u8::from(layers.hidden)));
        let count = any(&|layers| Ball::exact(layers.count.into()));
        let known = (count.radius == 0.0).then_some(count.middle as u8);
        GroupFound {
            color: self.color.map_or(own, |plane| inputs(&plane, at)),
            alpha: scalar(self.alpha, &|layers| layers.blend.alpha),
            opacity: scalar(self.opacity, &|layers| layers.opacity),
            hidden: scalar(self.hidden, &hidden),
            count: self.count.map_or(known, |plane| Some(*plane.plane.at(at.0, at.1))),
            depth: self.depth.map(|plane| input(&plane, at)),
            all,
        }
    }
}

/// The names of the planes of all groups, each once, in the order of the rows.
pub(super) fn names(groups: &[GroupPlanes<'_>]) -> Vec<&'static str> {
    let mut all = [None; 8];
    for group in groups {
        for (name, own) in all.iter_mut().zip(group.names()) {
            *name = name.or(own);
        }
    }
    all.into_iter().flatten().collect()
}
