//! Verify your planes of Gaussian splats: which planes a correct implementation may leave of each
//! stage.
//!
//! Without records, Gaussians are projected in [`Ball`]s of a [`Profile`], with their colours, alphas and depths.
//! Whatever is undecided is kept open. The numbers of a pixel are hulls over all ways to decide; each
//! order of splats has hulls of its own. What may be undecided:
//!
//! - Whether a splat is drawn: near plane, determinant, bounds.
//! - Whether a fragment is inside, dense enough, or behind the end of blending.
//! - Whether a fragment is behind the surface: where the ball of its depth holds the surface's, widened
//!   by the format of the client's depth test.
//! - Whether a disc that meets rays shows at a pixel, or its low-pass filter. A disc that is nearly
//!   edge-on is decided where rho3d certainly is greater than rho2d.
//! - Which of two splats is in front. Two splats are in the order of their indices only if their keys
//!   are equal whatever rounds: the same numbers, or the same products with the row of the view
//!   matrix. Of two or three splats whose order is open, every order is followed, and the pixel is
//!   judged in the order that comes closest to the client's numbers. Of more, each weight lies between
//!   those that it has in front of all the others and behind all of them.
//!
//! **Projection**, if the client hands in its records
//! ([`GaussianRecord`](crate::method::gaussians::record::GaussianRecord)):
//!
//! - Each number of a record is in its ball. The ball holds the number that the scene gives, whatever
//!   the record's other numbers are. If several fields are wrong, the fault names the first in this
//!   order: `place`, `distance`, `key`, `center`, `covariance`, `unfiltered`, `ellipse`, `conic`,
//!   `compensation`, `alpha`, `color`. The fields from `covariance` to `compensation` of discs that meet
//!   rays are not judged.
//! - Every splat that certainly has a fragment at the pixel of its centre has a record.
//! - No Gaussian that certainly is behind or degenerate has a record.
//!
//! A record is marked at the pixel of its centre. The later stages take `place`, `key`, `color`, `alpha`,
//! `conic` and `center` from the records, as they are stored: their order is the order of these keys, and
//! no error of the projection widens what follows. Discs, and the depths of an order of the pixel's own,
//! need more than a record has; the rest is from the scene. A splat without a record that is not
//! certainly missing may be drawn as the scene gives it.
//!
//! `Decided:` `bounds` is neither judged nor used, because a client may bound a splat otherwise. The
//! bounds are those of the record's `ellipse`, as open as those of the scene's. If a record is wrong,
//! a splat may also be drawn in the bounds of its conic, so that compositing is not accused of it.
//!
//! **Blending**: C, T, the depths and the count are judged against these hulls. `id` must be a
//! fragment before which no other certainly is drawn, and `Z` its depth. `heaviest` must be a
//! fragment that may weigh as much as any other certainly does.
//!
//! **Display** is judged from the client's C and T, else from the hulls of blending, so that a picture
//! alone is judged too.
//!
//! `Decided:` a pixel is undecided if open decisions leave T, or a part of C, in an interval wider than
//! 4/255, times the brightest colour if that is above 1. A narrower one, of fragments at the least
//! alpha, judges the pixel nearly as well as 8 bits do. A generated capture of 300,000 splats had such
//! decisions at every tenth pixel.

mod discs;
mod records;
mod splats;
mod supposed;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_of_records;
mod walk;
mod walked;

use crate::composite::over::Blend;
use crate::error::Result;
use crate::frame::Rect;
use crate::method::Job;
use crate::method::gaussians::Settings;
use crate::method::gaussians::blending::GaussianPixel;
use crate::method::gaussians::picture::before;
use crate::method::gaussians::splats::Source;
use crate::method::surface::{ALPHA, ID, SHADED};
use crate::number::ball::Profile;
use crate::number::{Ball, MapInline, Real, Truth, srgb};
use crate::scene::Environment;
use crate::scene::gaussians::Encoding;
use crate::verdict::checks::{Report, input, inputs, number, triple, widened};
use crate::verdict::client::{Client, Storage, StoredPlane};
use crate::verdict::marks::{self, Counts, Marks, PixelMarks, TilePart, counted};
use crate::verdict::planes::RecordPlanes;
use crate::verdict::supposed::Supposed;
use crate::verdict::{Check, StageVerdict, Verdict};
pub(super) use records::wrong_fields;
use splats::PossibleSplats;
use walk::Walker;
use walked::Walked;

/// Judges the planes of a client.
pub(super) fn verify<P: Profile>(
    job: &Job<'_>,
    settings: &Settings,
    client: &Client,
    budget: f64,
) -> Verdict {
    let mut judge = Judge::<P>::new(job, settings, client);
    let projection = judge.projection.take();
    let verdict =
        marks::verdict(job, judge.stages(), budget, |tile, marks| judge.judge(tile, marks));
    match projection {
        Some(projection) => verdict.after(projection),
        None => verdict,
    }
}

/// Every check at one pixel.
pub(super) fn checks<P: Profile>(
    job: &Job<'_>,
    settings: &Settings,
    client: &Client,
    pixel: (u32, u32),
) -> Result<Vec<Check>> {
    let judge = Judge::<P>::new(job, settings, client);
    let stages = judge.stages().map(|(stage, _)| stage);
    marks::checks(job, stages, pixel, |tile, marks| judge.judge(tile, marks))
}

/// The parts that all tiles share.
struct Judge<'a, P: Profile> {
    source: Source<'a, Ball<P>>,
    splats: PossibleSplats<P>,
    /// The findings about the client's records, if it hands them in.
    projection: Option<StageVerdict>,
    planes: RecordPlanes<'a>,
    color: Option<StoredPlane<'a, [f64; 3]>>,
    through: Option<StoredPlane<'a, f64>>,
    id: Option<StoredPlane<'a, u32>>,
    heaviest: Option<StoredPlane<'a, u32>>,
    count: Option<StoredPlane<'a, u8>>,
    shaded: Option<StoredPlane<'a, [f64; 3]>>,
    alpha: Option<StoredPlane<'a, f64>>,
    environment: Option<&'a Environment>,
    accumulator: Storage,
    supposed: Supposed,
    depth_test: Storage,
}

impl<'a, P: Profile> Judge<'a, P> {
    fn new(job: &Job<'a>, settings: &'a Settings, client: &'a Client) -> Self {
        let source = Source::new(job.scene, job.camera, settings);
        let fields = &GaussianPixel::<f32>::PLANES;
        let own = PossibleSplats::found(job, &source, client.supposed);
        let (splats, projection) = match &client.gaussian_records {
            Some(records) => {
                let (supposed, depth_test) = (client.supposed, client.depth_test);
                let (splats, projection) =
                    records::judge(job, &source, supposed, depth_test, records, own);
                (splats, Some(projection))
            }
            None => (own, None),
        };
        Self {
            splats: PossibleSplats::new(job, splats, client.supposed),
            projection,
            source,
            planes: RecordPlanes::new(client, fields, 0),
            color: client.triple(&GaussianPixel::<f32>::COLOR.row),
            through: client.scalar(&GaussianPixel::<f32>::THROUGH.row),
            id: client.index(&ID),
            heaviest: client.index(&GaussianPixel::<f32>::HEAVIEST.row),
            count: client.count(&GaussianPixel::<f32>::COUNT.row),
            shaded: client.triple(&SHADED),
            alpha: client.scalar(&ALPHA),
            environment: job.scene.environment.as_ref(),
            accumulator: client.accumulator,
            supposed: client.supposed,
            depth_test: client.depth_test,
        }
    }

    /// The stages, each with the planes that it judges.
    fn stages(&self) -> [(&'static str, Vec<&'static str>); 2] {
        let shown = [self.shaded.map(|plane| plane.name), self.alpha.map(|plane| plane.name)];
        [
            ("blending", self.planes.names().to_vec()),
            ("display", shown.into_iter().flatten().collect()),
        ]
    }

    /// Marks the wrong pixels of a rectangle in a tile.
    fn judge(&self, part: TilePart, marks: &mut [Marks; 2]) -> Counts {
        let rect = part.rect;
        let [blending, display] = marks;
        let mut counts = Counts::default();
        let Self { source, supposed, depth_test, splats, .. } = self;
        let mut walker = Walker::new(source, *supposed, *depth_test, splats, part);
        for y in rect.y0..rect.y1 {
            for (column, at) in counted(Rect { y0: y, y1: y + 1, ..rect }) {
                let pixel = (y - rect.y0) as usize * rect.columns() + column;
                let walked = walker.walk(at);
                self.blended(at, &walked, &mut blending.at(pixel));
                let judged = self.shown(at, &walked, &mut display.at(pixel));
                counts.covered += u64::from(walked.most > 0);
                counts.undecided += u64::from(walked.undecided() || !judged);
            }
        }
        counts
    }

    /// Marks wrong planes of blending at a pixel.
    fn blended(&self, at: (u32, u32), walked: &Walked<P>, pixel: &mut PixelMarks<'_>) {
        pixel.doubts(walked.doubts);
        // Each layer rounds the stored values again.
        let lost = |largest: f64| f64::from(walked.most) * self.accumulator.radius(largest);
        let truth = |numbers| {
            let mut truth = walked.truth(
                numbers,
                self.id.map(|plane| *plane.plane.at(at.0, at.1)),
                self.heaviest.map(|plane| *plane.plane.at(at.0, at.1)),
                self.count.map(|plane| *plane.plane.at(at.0, at.1)),
            );
            let blend = &mut truth.blend;
            blend.color = blend.color.map_inline(|part| widened(part, lost(walked.brightest)));
            blend.through = widened(blend.through, lost(1.0));
            truth
        };
        let check = |numbers, report: &mut Report<'_>| {
            self.planes.check(0, &GaussianPixel::PLANES, at, &truth(numbers), report);
        };
        let closest = walked.closest(|numbers| worst(|report| check(numbers, report)));
        check(closest, &mut |_, error, fault| pixel.found(error, fault));
    }

    /// Marks a wrong picture at a pixel. Returns whether its colour is judged, or is not there.
    fn shown(&self, at: (u32, u32), walked: &Walked<P>, pixel: &mut PixelMarks<'_>) -> bool {
        let check = |numbers, report: &mut Report<'_>| {
            let shown = self.shown_of(at, walked, numbers);
            if let Some(plane) = &self.shaded {
                triple(0, plane, at, shown.color, report);
            }
            if let Some(plane) = &self.alpha {
                number(0, plane, at, shown.alpha, report);
            }
            shown
        };
        let closest = walked.closest(|numbers| {
            worst(|report| {
                check(numbers, report);
            })
        });
        let shown = check(closest, &mut |_, error, fault| pixel.found(error, fault));
        self.shaded.is_none() || shown.color.iter().all(|part| part.radius.is_finite())
    }

    /// The picture at a pixel of the client's C and T, or of these numbers.
    fn shown_of(
        &self,
        at: (u32, u32),
        walked: &Walked<P>,
        numbers: GaussianPixel<Ball<P>>,
    ) -> Blend<Ball<P>> {
        let lost = |largest: f64| f64::from(walked.most) * self.accumulator.radius(largest);
        let own = numbers.blend;
        let color = self.color.as_ref().map_or_else(
            || own.color.map_inline(|part| widened(part, lost(walked.brightest))),
            |plane| inputs(plane, at),
        );
        let through = self
            .through
            .as_ref()
            .map_or_else(|| widened(own.through, lost(1.0)), |plane| input(plane, at));
        let unseen = matches!(self.supposed, Supposed::SurfaceNotSeen | Supposed::SurfaceIgnored);
        let surface = self.source.surface().filter(|_| !unseen);
        let opaque = surface.and_then(|surface| surface.at(at.0, at.1));
        let opaque = opaque.map(|(_, light)| light.map_inline(Ball::from_f32));
        let behind = opaque.or_else(|| {
            let ray = self.source.projector.view.ray(at.0, at.1);
            Some(self.environment?.enclosure(ray))
        });
        let light = behind.map_or(color, |behind| {
            let through = match self.supposed {
                Supposed::BackgroundTwice => through + through,
                Supposed::SurfaceWhole if opaque.is_some() => Ball::ONE,
                _ => through,
            };
            before(&self.source, color, through, behind)
        });
        let encoded = self.source.space == Encoding::Srgb;
        let own = if encoded { light.map_inline(srgb::decoded) } else { light };
        // A client may keep the surface's colour where it blends nothing over it, or encode and decode.
        let [zero, one] = [Ball::ZERO, Ball::ONE];
        let none = |part: &Ball<P>| part.le(zero).possibly() && part.ge(zero).possibly();
        let untouched = through.ge(one).possibly() && color.iter().all(none);
        let color = match opaque.filter(|_| untouched) {
            Some(opaque) => [0, 1, 2].map_inline(|c| own[c].either(opaque[c])),
            None => own,
        };
        let alpha = if behind.is_some() { Ball::ONE } else { Ball::ONE - through };
        Blend { color, alpha }
    }
}

/// The largest error that a check reports.
fn worst(check: impl FnOnce(&mut Report<'_>)) -> f64 {
    let mut worst = 0.0;
    check(&mut |_, error, _| worst = error.at_least(worst));
    worst
}
