//! Judge one pixel of a client after the visibility pass: sums, averages and shading, each from the
//! client's planes of the stage before.

use super::certificate::Nearest;
use super::client_planes::ClientPlanes;
use super::sums::Continuations;
use crate::composite::sum;
use crate::frame::NO_ID;
use crate::method::Job;
use crate::method::ewa::attributes::Sums;
use crate::number::ball::Profile;
use crate::number::{Ball, MapInline, Real, Truth};
use crate::scene::Surfels;
use crate::verdict::checks::{
    Report, Shading, Surface, anything, input_where, inputs, least_wrong, number, only_fitting,
    triple, whole, widened,
};
use crate::verdict::client::{Storage, StoredPlane};
use crate::verdict::marks::Marks;
use crate::verdict::supposed::Supposed;
use std::borrow::Cow;

/// The stages after visibility, by their index among the marks.
pub(super) const ATTRIBUTES: usize = 0;
pub(super) const NORMALIZATION: usize = 1;
pub(super) const SHADING: usize = 2;

/// The parts that all pixels share.
pub(crate) struct PixelJudge<'a, P: Profile> {
    client_planes: &'a ClientPlanes<'a>,
    shading: Shading<'a, P>,
    /// Whether surfels have colours; if not, the material has one.
    colored: bool,
    /// The greatest component of any colour, at least 1.
    brightest: f64,
    /// The direction where no weight has arrived, whatever the sums are.
    nowhere: [Ball<P>; 3],
}

/// The averages of a pixel.
struct Averages<P: Profile> {
    normal: [Ball<P>; 3],
    color: [Ball<P>; 3],
}

impl<'a, P: Profile> PixelJudge<'a, P> {
    pub(crate) fn new(job: &Job<'a>, client_planes: &'a ClientPlanes<'a>) -> Self {
        Self::of_surfels(job, &job.scene.surfels, client_planes)
    }

    /// The judge for the placed surfels of objects.
    pub(crate) fn of_surfels(
        job: &Job<'a>,
        surfels: &Surfels,
        client_planes: &'a ClientPlanes<'a>,
    ) -> Self {
        let colors = surfels.color().unwrap_or_default();
        let brightest = colors.iter().fold(1.0_f64, |brightest, color| {
            let [r, g, b] = color.to_array().map_inline(f64::from);
            brightest.at_least(r).at_least(g).at_least(b)
        });
        let colored = surfels.color().is_some();
        let shading = Shading::new(job, colored).supposing(client_planes.supposed);
        let nowhere = sum::direction([Ball::ZERO; 3], Ball::ZERO);
        Self { client_planes, shading, colored, brightest, nowhere }
    }

    /// The judge for a layer, behind which others may be seen.
    pub(crate) fn of_layer(job: &Job<'a>, client_planes: &'a ClientPlanes<'a>) -> Self {
        let colored = job.scene.surfels.color().is_some();
        Self { shading: Shading::of_layer(job, colored), ..Self::new(job, client_planes) }
    }

    /// Marks a wrong pixel, by the continuation that errs least. Returns the index of the only
    /// continuation that fits, if one fits and others do not.
    pub(crate) fn judge(
        &self,
        pixel: usize,
        at: (u32, u32),
        nearest: &Nearest<P>,
        sums: &Continuations<P>,
        marks: &mut [Marks; 3],
    ) -> Option<usize> {
        let all = all(sums);
        // An explanation needs every check, so it takes no shortcut.
        let nothing = matches!(all, [Sums { count: 0, .. }]) && !marks[ATTRIBUTES].logs();
        if nothing && self.is_right_of_nothing(at) {
            return None;
        }
        let check = |sums: &_, report: &mut Report<'_>| self.check(at, nearest, Some(sums), report);
        self.check(at, nearest, least_wrong::<_, 3>(all, check), &mut |part, error, fault| {
            marks[part].at(pixel).found(error, fault);
        });
        only_fitting(all, check)
    }

    /// Whether the client's pixel is empty, as it should be: then every check finds an error of 0.
    pub(super) fn is_right_of_nothing(&self, at: (u32, u32)) -> bool {
        self.shading.is_black() && self.client_planes.is_empty(at)
    }

    /// Opacity and shaded colour as the next pass reads them: the client's, else all values that
    /// they may have.
    pub(crate) fn read(
        &self,
        at: (u32, u32),
        nearest: &Nearest<P>,
        sums: &Continuations<P>,
    ) -> (Ball<P>, [Ball<P>; 3]) {
        let client_planes = self.client_planes;
        // Where nothing is, every format holds an opacity of exactly 0.
        let empty = matches!(all(sums), [Sums { count: 0, .. }]);
        let read = |plane: &StoredPlane<'_, f64>| input_where(plane, at, empty);
        if let (Some(opacity), Some(color)) = (&client_planes.opacity, &client_planes.shaded) {
            return (read(opacity), inputs(color, at));
        }
        let of = |sums: Option<&Sums<Ball<P>>>| {
            let stored = sums.map(|sums| self.stored(sums));
            let sums = stored.as_deref();
            let averages = self.averages(at, sums);
            (self.opacity(at, sums), self.color(at, self.depth(at, nearest, sums), &averages))
        };
        let each = all(sums).iter().map(|sums| of(Some(sums)));
        let (opacity, color) = each
            .reduce(|a, b| (a.0.either(b.0), Ball::either_of(a.1, b.1)))
            .unwrap_or_else(|| of(None));
        (
            client_planes.opacity.map_or(opacity, |plane| read(&plane)),
            client_planes.shaded.map_or(color, |plane| inputs(&plane, at)),
        )
    }

    /// Whether the picture has a depth and no id here. No splat leaves this.
    pub(crate) fn shows_no_splats(&self, (x, y): (u32, u32)) -> bool {
        let ClientPlanes { depth_copy, id_copy, .. } = self.client_planes;
        depth_copy.is_some_and(|plane| *plane.plane.at(x, y) < f64::INFINITY)
            && id_copy.is_some_and(|plane| *plane.plane.at(x, y) == NO_ID)
    }

    /// Checks every plane at a pixel that shows another surface than splats, with these sums. The
    /// picture's weight is not the weight of the sums, so `client_planes` must not hold it as such.
    pub(crate) fn check_other(
        &self,
        at: (u32, u32),
        surface: &Surface<P>,
        sums: Option<&Sums<Ball<P>>>,
        report: &mut Report<'_>,
    ) {
        if let Some(sums) = sums {
            self.check_sums(at, &self.stored(sums), report);
        }
        let (client_planes, Surface { depth, normal, color, .. }) = (self.client_planes, *surface);
        if let (Some(plane), true) = (&client_planes.color, self.colored) {
            triple(NORMALIZATION, plane, at, color, report);
        }
        if let Some(plane) = &client_planes.normal {
            triple(NORMALIZATION, plane, at, normal, report);
        }
        if let Some(plane) = &client_planes.depth_copy {
            number(NORMALIZATION, plane, at, depth, report);
        }
        if let Some(plane) = &client_planes.id_copy {
            whole(NORMALIZATION, plane, at, NO_ID, report);
        }
        if let Some(plane) = &client_planes.weight_copy {
            number(NORMALIZATION, plane, at, Ball::<P>::ONE, report);
        }
        if let Some(plane) = &client_planes.shaded {
            let depth = client_planes.depth_copy.map_or(depth, |plane| plane.ball(at));
            let color = self.color(at, depth, &Averages { normal, color });
            triple(SHADING, plane, at, color, report);
        }
        if let Some(plane) = &client_planes.alpha {
            let weight = client_planes.weight_copy.map_or(Ball::ONE, |plane| plane.ball(at));
            number(SHADING, plane, at, self.shading.alpha(weight), report);
        }
    }

    /// Checks every plane at a pixel, with these sums. Without sums, checks whatever follows from
    /// the client's own.
    pub(crate) fn check(
        &self,
        at: (u32, u32),
        nearest: &Nearest<P>,
        sums: Option<&Sums<Ball<P>>>,
        report: &mut Report<'_>,
    ) {
        let stored = sums.map(|sums| self.stored(sums));
        let sums = stored.as_deref();
        if let Some(sums) = sums {
            self.check_sums(at, sums, report);
        }
        let averages = self.averages(at, sums);
        self.check_averages(at, &averages, sums, report);
        self.check_copies(at, nearest, sums, report);
        let client_planes = self.client_planes;
        if let Some(plane) = &client_planes.shaded {
            let color = self.color(at, self.depth(at, nearest, sums), &averages);
            triple(SHADING, plane, at, color, report);
        }
        if let Some(plane) = &client_planes.alpha {
            let weight = client_planes.weight_copy.map_or_else(
                || self.weight_of(at, sums),
                |plane| Self::read_number(&plane, at, sums),
            );
            number(SHADING, plane, at, self.shading.alpha(weight), report);
        }
    }

    /// The sums as the client may have stored them between two additions. Each addition rounds a
    /// sum that is at most this large.
    fn stored<'s>(&self, sums: &'s Sums<Ball<P>>) -> Cow<'s, Sums<Ball<P>>> {
        let ClientPlanes { accumulator, supposed, .. } = self.client_planes;
        if *accumulator == Storage::Single {
            return match supposed {
                Supposed::Nothing => Cow::Borrowed(sums),
                _ => Cow::Owned(supposed.sums(*sums)),
            };
        }
        let heaviest = sums.weight.middle + sums.weight.radius;
        let lost = |largest: f64| f64::from(sums.count) * accumulator.radius(heaviest * largest);
        Cow::Owned(Sums {
            weight: widened(sums.weight, lost(1.0)),
            normal: sums.normal.map_inline(|part| widened(part, lost(1.0))),
            color: sums.color.map_inline(|part| widened(part, lost(self.brightest))),
            opacity: widened(sums.opacity, lost(1.0)),
            count: sums.count,
        })
    }

    /// Checks the sums of the attribute pass, as stored.
    fn check_sums(&self, at: (u32, u32), truth: &Sums<Ball<P>>, report: &mut Report<'_>) {
        let ClientPlanes { weight, normal_sum, color_sum, count, mask, .. } = self.client_planes;
        if let Some(plane) = weight {
            number(ATTRIBUTES, plane, at, truth.weight, report);
        }
        if let Some(plane) = normal_sum {
            triple(ATTRIBUTES, plane, at, truth.normal, report);
        }
        if let Some(plane) = color_sum {
            triple(ATTRIBUTES, plane, at, truth.color, report);
        }
        if let Some(plane) = count {
            whole(ATTRIBUTES, plane, at, truth.count, report);
        }
        if let Some(plane) = mask {
            whole(ATTRIBUTES, plane, at, u8::from(truth.count > 0), report);
        }
    }

    /// A number of the client. Where no fragment is in the sums, a 0 is exactly 0 in every format.
    fn read_number(
        plane: &StoredPlane<'_, f64>,
        at: (u32, u32),
        sums: Option<&Sums<Ball<P>>>,
    ) -> Ball<P> {
        plane.ball_where(at, sums.is_some_and(|sums| sums.count == 0))
    }

    /// The sum of the weights as the average reads it.
    pub(crate) fn weight(&self, at: (u32, u32), sums: Option<&Sums<Ball<P>>>) -> Ball<P> {
        self.weight_of(at, sums.map(|sums| self.stored(sums)).as_deref())
    }

    /// The same for stored sums. All functions below take stored sums.
    fn weight_of(&self, at: (u32, u32), sums: Option<&Sums<Ball<P>>>) -> Ball<P> {
        let own = || sums.map_or_else(anything, |sums| sums.weight);
        self.client_planes.weight.map_or_else(own, |plane| Self::read_number(&plane, at, sums))
    }

    /// The averages of the client's sums, else of these. Without either they are any numbers.
    fn averages(&self, at: (u32, u32), sums: Option<&Sums<Ball<P>>>) -> Averages<P> {
        let weight = self.weight_of(at, sums);
        let unknown = [anything(); 3];
        let normal = match &self.client_planes.normal_sum {
            Some(plane) => plane.balls(at),
            None => sums.map_or(unknown, |sums| sums.normal),
        };
        let color = match &self.client_planes.color_sum {
            Some(plane) => plane.balls(at),
            None => sums.map_or(unknown, |sums| sums.color),
        };
        let some = weight.gt(Ball::ZERO).possibly();
        Averages {
            normal: match some {
                true => self.client_planes.supposed.direction(normal, weight),
                false => self.nowhere,
            },
            color: match self.colored {
                true => {
                    let count = sums.map(|sums| sums.count);
                    self.client_planes.supposed.color(color, weight, count)
                }
                false => [Ball::ZERO; 3],
            },
        }
    }

    /// The opacity of a layer.
    fn opacity(&self, at: (u32, u32), sums: Option<&Sums<Ball<P>>>) -> Ball<P> {
        let own = sums.map_or_else(anything, |sums| sums.opacity);
        let [opacity, ..] = sum::average([own; 3], self.weight_of(at, sums));
        opacity.at_most(Ball::ONE)
    }

    /// Checks the averages.
    fn check_averages(
        &self,
        at: (u32, u32),
        averages: &Averages<P>,
        sums: Option<&Sums<Ball<P>>>,
        report: &mut Report<'_>,
    ) {
        let client_planes = self.client_planes;
        if let (Some(plane), true) = (&client_planes.color, self.colored) {
            triple(NORMALIZATION, plane, at, averages.color, report);
        }
        if let Some(plane) = &client_planes.normal {
            triple(NORMALIZATION, plane, at, averages.normal, report);
        }
        if let Some(plane) = &client_planes.opacity {
            number(NORMALIZATION, plane, at, self.opacity(at, sums), report);
        }
    }

    /// Checks the picture's copies of what earlier passes left.
    fn check_copies(
        &self,
        at: (u32, u32),
        nearest: &Nearest<P>,
        sums: Option<&Sums<Ball<P>>>,
        report: &mut Report<'_>,
    ) {
        let client_planes = self.client_planes;
        if let (Some(first), Some(copy)) = (client_planes.weight, client_planes.weight_copy) {
            number(NORMALIZATION, &copy, at, Self::read_number(&first, at, sums), report);
        }
        if client_planes.weightless {
            return self.check_shown(at, nearest, sums, report);
        }
        if let (Some(first), Some(copy)) = (client_planes.depth, client_planes.depth_copy) {
            number(NORMALIZATION, &copy, at, first.ball::<P>(at), report);
        }
        if let (Some(first), Some(copy)) = (client_planes.id, client_planes.id_copy) {
            whole(NORMALIZATION, &copy, at, *first.plane.at(at.0, at.1), report);
        }
    }

    /// Checks depth and id of a picture that shows them only where it has weight.
    fn check_shown(
        &self,
        at: (u32, u32),
        nearest: &Nearest<P>,
        sums: Option<&Sums<Ball<P>>>,
        report: &mut Report<'_>,
    ) {
        let some = self.weight_of(at, sums).gt(Ball::ZERO);
        if let Some(copy) = &self.client_planes.depth_copy {
            let empty = *copy.plane.at(at.0, at.1) == f64::INFINITY;
            let shown = some.decided().unwrap_or(!empty);
            let truth = if shown { nearest.depth } else { Ball::INFINITY };
            number(NORMALIZATION, copy, at, truth, report);
        }
        if let Some(copy) = &self.client_planes.id_copy {
            let empty = *copy.plane.at(at.0, at.1) == NO_ID;
            match (some.decided().unwrap_or(!empty), nearest.id) {
                (false, _) => whole(NORMALIZATION, copy, at, NO_ID, report),
                (true, Some(id)) => whole(NORMALIZATION, copy, at, id, report),
                (true, None) => {}
            }
        }
    }

    /// The depth that shading uses.
    fn depth(&self, at: (u32, u32), nearest: &Nearest<P>, sums: Option<&Sums<Ball<P>>>) -> Ball<P> {
        let own = if self.client_planes.weightless {
            match self.weight_of(at, sums).gt(Ball::ZERO).decided() {
                Some(true) => nearest.depth,
                Some(false) => Ball::INFINITY,
                None => anything(),
            }
        } else {
            let nothing = self.client_planes.nothing() && sums.is_some_and(|sums| sums.count == 0);
            if nothing { Ball::INFINITY } else { nearest.depth }
        };
        self.client_planes.depth_copy.map_or(own, |plane| plane.ball(at))
    }

    /// The shaded colour of the client's averages, else of these.
    fn color(&self, at: (u32, u32), depth: Ball<P>, averages: &Averages<P>) -> [Ball<P>; 3] {
        let normal = self.client_planes.normal.map_or(averages.normal, |plane| plane.balls(at));
        let color = self.client_planes.color.map_or(averages.color, |plane| plane.balls(at));
        self.shading.color(at, &Surface { depth, normal, tangent: None, color })
    }
}

/// The possible sums of a pixel; empty if there are too many.
pub(crate) fn all<P: Profile>(sums: &Continuations<P>) -> &[Sums<Ball<P>>] {
    match sums {
        Continuations::One(sums) => std::slice::from_ref(sums),
        Continuations::Several(sums, _) => sums,
        Continuations::Many => &[],
    }
}
