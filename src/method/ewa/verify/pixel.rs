//! One pixel of a client after the visibility pass: sums, averages and shading, each from what the
//! client has of the stage before.

use super::certificate::Nearest;
use super::handed::Handed;
use super::sums::Continuations;
use crate::composite::sum;
use crate::method::Holds;
use crate::method::algorithm::Job;
use crate::method::checks::{
    Report, Shading, Surface, anything, least_wrong, number, only_fitting, triple, whole, widened,
};
use crate::method::ewa::attributes::Sums;
use crate::method::judged::Marks;
use crate::number::ball::Profile;
use crate::number::{Ball, Real, Truth};

/// The stages after visibility, by their place among the marks.
const ATTRIBUTES: usize = 0;
const NORMALIZATION: usize = 1;
const SHADING: usize = 2;

/// What all pixels share.
pub(in crate::method) struct PixelJudge<'a, P: Profile> {
    handed: &'a Handed<'a>,
    shading: Shading<P>,
    /// Whether surfels have colours; else the material has one.
    colored: bool,
    /// The greatest component of a colour, at least 1.
    brightest: f64,
    /// The direction where no weight has arrived, whatever the sums are.
    nowhere: [Ball<P>; 3],
}

impl<'a, P: Profile> PixelJudge<'a, P> {
    pub(in crate::method) fn new(job: &Job<'_>, handed: &'a Handed<'a>) -> Self {
        let scene = job.scene;
        let colors = scene.surfels.color().unwrap_or_default();
        let brightest = colors.iter().fold(1.0_f64, |brightest, color| {
            let [r, g, b] = color.to_array().map(f64::from);
            brightest.at_least(r).at_least(g).at_least(b)
        });
        Self {
            handed,
            shading: Shading::new(job, scene.surfels.color().is_some()),
            colored: scene.surfels.color().is_some(),
            brightest,
            nowhere: sum::direction([Ball::ZERO; 3], Ball::ZERO),
        }
    }

    /// Marks what is wrong at a pixel: by the continuation that errs least. Gives the number of the only
    /// one that fits, if one does and others do not.
    pub(in crate::method) fn judge(
        &self,
        (pixel, at): (usize, (u32, u32)),
        nearest: &Nearest<P>,
        sums: &Continuations<P>,
        marks: &mut [Marks; 3],
    ) -> Option<usize> {
        let all: &[Sums<Ball<P>>] = match sums {
            Continuations::One(sums) => std::slice::from_ref(sums),
            Continuations::Several(sums, _) => sums,
            Continuations::Many => &[],
        };
        let check = |sums: &_, report: &mut Report<'_>| self.check(at, nearest, Some(sums), report);
        self.check(at, nearest, least_wrong::<_, 3>(all, check), &mut |part, error, fault| {
            marks[part].at(pixel).found(error, fault);
        });
        only_fitting(all, check)
    }

    /// Every plane at a pixel, with these sums; without any, as far as the client's own are there.
    fn check(
        &self,
        at: (u32, u32),
        nearest: &Nearest<P>,
        sums: Option<&Sums<Ball<P>>>,
        report: &mut Report<'_>,
    ) {
        if let Some(sums) = sums {
            self.check_sums(at, sums, report);
        }
        let unknown = Sums {
            weight: anything(),
            normal: [anything(); 3],
            color: [anything(); 3],
            ..Sums::NONE
        };
        let own = sums.copied().unwrap_or(unknown);
        let handed = self.handed;
        let weight = handed.weight.map_or(own.weight, |plane| plane.ball(at));
        let normal = handed.normal_sum.map_or(own.normal, |plane| plane.balls(at));
        let color = handed.color_sum.map_or(own.color, |plane| plane.balls(at));
        let color = if self.colored { sum::average(color, weight) } else { [Ball::ZERO; 3] };
        let some = weight.gt(Ball::ZERO).possibly();
        let direction = if some { sum::direction(normal, weight) } else { self.nowhere };
        let averages = (direction, color);
        self.check_averages(at, averages, report);
        let nothing = handed.nothing() && sums.is_some_and(|sums| sums.count == 0);
        let depth = if nothing { Ball::INFINITY } else { nearest.depth };
        self.check_shading(at, (depth, weight), averages, report);
    }

    /// The sums of the attribute pass.
    fn check_sums(&self, at: (u32, u32), sums: &Sums<Ball<P>>, report: &mut Report<'_>) {
        let Handed { weight, normal_sum, color_sum, count, accumulator, .. } = self.handed;
        let heaviest = sums.weight.middle + sums.weight.radius;
        // Each addition rounds a sum that is at most this large.
        let lost = |largest: f64| f64::from(sums.count) * accumulator.radius(heaviest * largest);
        if let Some(plane) = weight {
            number(ATTRIBUTES, plane, at, widened(sums.weight, lost(1.0)), report);
        }
        if let Some(plane) = normal_sum {
            let lost = lost(1.0);
            let truth = sums.normal.map(|part| widened(part, lost));
            triple(ATTRIBUTES, (plane, Holds::Vector), at, truth, report);
        }
        if let Some(plane) = color_sum {
            let lost = lost(self.brightest);
            let truth = sums.color.map(|part| widened(part, lost));
            triple(ATTRIBUTES, (plane, Holds::Color), at, truth, report);
        }
        if let Some(plane) = count {
            whole(ATTRIBUTES, plane, at, sums.count, report);
        }
    }

    /// Averages, and copies of what earlier passes left.
    fn check_averages(
        &self,
        at: (u32, u32),
        (normal, color): ([Ball<P>; 3], [Ball<P>; 3]),
        report: &mut Report<'_>,
    ) {
        let handed = self.handed;
        if let (Some(plane), true) = (&handed.color, self.colored) {
            triple(NORMALIZATION, (plane, Holds::Color), at, color, report);
        }
        if let Some(plane) = &handed.normal {
            triple(NORMALIZATION, (plane, Holds::Vector), at, normal, report);
        }
        let copies = [(handed.depth, handed.depth_copy), (handed.weight, handed.weight_copy)];
        for (first, copy) in copies {
            if let (Some(first), Some(copy)) = (first, copy) {
                number(NORMALIZATION, &copy, at, first.ball::<P>(at), report);
            }
        }
        if let (Some(first), Some(copy)) = (handed.id, handed.id_copy) {
            whole(NORMALIZATION, &copy, at, *first.plane.at(at.0, at.1), report);
        }
    }

    /// The picture.
    fn check_shading(
        &self,
        at: (u32, u32),
        (depth, weight): (Ball<P>, Ball<P>),
        (normal, color): ([Ball<P>; 3], [Ball<P>; 3]),
        report: &mut Report<'_>,
    ) {
        let handed = self.handed;
        let depth = handed.depth_copy.map_or(depth, |plane| plane.ball(at));
        let weight = handed.weight_copy.map_or(weight, |plane| plane.ball(at));
        if let Some(plane) = &handed.shaded {
            let normal = handed.normal.map_or(normal, |plane| plane.balls(at));
            let color = handed.color.map_or(color, |plane| plane.balls(at));
            let surface = Surface { depth, normal, tangent: None, color };
            triple(SHADING, (plane, Holds::Color), at, self.shading.color(at, &surface), report);
        }
        if let Some(plane) = &handed.alpha {
            number(SHADING, plane, at, self.shading.alpha(weight), report);
        }
    }
}
