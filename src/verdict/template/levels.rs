//! Verify a client's propagation, level by level.

use crate::method::Job;
use crate::method::stage::Keep;
use crate::method::template::{Center, Settings, propagation};
use crate::number::ball::Profile;
use crate::number::{Ball, MapInline, Real};
use crate::verdict::checks::{Report, least_wrong};
use crate::verdict::marks::{LevelMarks, PixelMarks, StageMarks, Watch, counted};
use crate::verdict::outcomes::{MOST, Outcome, outcomes};
use crate::verdict::planes::{ClientRecords, RecordPlanes};
use crate::verdict::projection::SamplePlanes;

/// The centres of a level.
pub(super) type Level<'a, P> = ClientRecords<'a, Center<Ball<P>>>;

/// The levels of a client.
pub(super) struct Levels<'a, P: Profile> {
    job: &'a Job<'a>,
    settings: &'a Settings,
    sizes: &'a [[u32; 2]],
    /// The planes of level 1 and coarser levels.
    planes: &'a [RecordPlanes<'a>],
    /// All levels; none where a plane is missing.
    levels: Vec<Option<Level<'a, P>>>,
}

impl<'a, P: Profile> Levels<'a, P> {
    pub(super) fn new(
        job: &'a Job<'a>,
        settings: &'a Settings,
        sizes: &'a [[u32; 2]],
        finest: &'a SamplePlanes<'a>,
        planes: &'a [RecordPlanes<'a>],
    ) -> Self {
        let there = job.there(Keep::Stages);
        let mut levels = vec![finest.samples(job, true, Center::new)];
        let coarser = planes.iter().zip(&sizes[1..]);
        levels.extend(
            coarser
                .map(|(of, size)| of.records(job, &Center::PLANES, there, *size, Center::empty())),
        );
        Self { job, settings, sizes, planes, levels }
    }

    /// The levels, if all of them are there.
    pub(super) fn all(self) -> Option<Vec<Level<'a, P>>> {
        self.levels.into_iter().collect()
    }

    /// The levels that are not judged although the client hands in planes of them.
    pub(super) fn unjudged(&self) -> Vec<String> {
        let levels = (1..).zip(self.planes);
        let unjudged = levels.filter(|(level, planes)| {
            !planes.names().is_empty() && self.levels[level - 1].is_none()
        });
        unjudged.map(|(level, _): (usize, _)| format!("level {level}")).collect()
    }

    /// Judges each level whose finer level is there.
    pub(super) fn judge(&self, watch: Watch) -> StageMarks {
        let (mut marks, mut names) = (LevelMarks::new(self.job, watch), Vec::new());
        for (level, planes) in (1..).zip(self.planes) {
            let (Some(fine), own) = (&self.levels[level - 1], planes.names()) else { continue };
            if own.is_empty() {
                continue;
            }
            let new = own.iter().copied().filter(|name| !names.contains(name));
            names.extend(new.collect::<Vec<_>>());
            let reach = Ball::from_f32(self.settings.reach(level - 1));
            marks.level(self.job, self.sizes[level], |rect, marks| {
                for (pixel, at) in counted(rect) {
                    let finer = propagation::four(fine, at.0, at.1);
                    cell(planes, at, &finer, reach, &mut marks.at(pixel));
                }
            });
        }
        ("propagation", names, marks.together(self.job))
    }
}

/// Judges one cell from its four finer ones. Those beyond the reach move.
fn cell<P: Profile>(
    planes: &RecordPlanes<'_>,
    at: (u32, u32),
    finer: &[Center<Ball<P>>; 4],
    reach: Ball<P>,
    pixel: &mut PixelMarks<'_>,
) {
    let moving = finer.map_inline(|center| propagation::moves(&center, reach));
    let (found, doubts) = outcomes(moving, finer.map_inline(|center| center.depth), |j, first| {
        propagation::near(finer, first)[j]
    });
    pixel.doubts(doubts);
    if found.len() > MOST {
        return;
    }
    let of = |outcome: &Outcome| match *outcome {
        Some((takes, first)) => propagation::merge(finer, takes, first),
        None => Center::empty(),
    };
    let all: Vec<_> = found.iter().map(of).collect();
    let check = |truth: &_, report: &mut Report<'_>| {
        planes.check(0, &Center::PLANES, at, truth, report);
    };
    if let Some(truth) = least_wrong::<_, 1>(&all, check) {
        check(truth, &mut |_, error, fault| pixel.found(error, fault));
    }
}
