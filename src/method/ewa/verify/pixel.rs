//! One pixel of a client after the visibility pass: sums, averages and shading, each from what the
//! client has of the stage before.

use super::certificate::Nearest;
use super::handed::Handed;
use super::sums::Continuations;
use crate::composite::sum;
use crate::frame::named::{COLOR, VECTOR, component};
use crate::method::algorithm::Job;
use crate::method::ewa::attributes::Sums;
use crate::method::judged::Marks;
use crate::number::ball::Profile;
use crate::number::{Ball, Real, Vector3};
use crate::shade::phong::Shader;
use crate::splat::View;
use crate::verify::client::Stored;
use crate::verify::verdict::Fault;

/// The stages after visibility, by their place among the marks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Attributes = 0,
    Normalization = 1,
    Shading = 2,
}

/// Told of a check: the stage, by how many bounds it errs, and what is wrong if that is above 1.
type Report<'a> = dyn FnMut(Part, f64, &dyn Fn() -> Fault) + 'a;

/// What all pixels share.
pub(super) struct PixelJudge<'a, P: Profile> {
    handed: &'a Handed<'a>,
    shader: Shader<Ball<P>>,
    /// Whether surfels have colours; else the material has one.
    colored: bool,
    /// Whether an environment is seen where no surfel is.
    environment: bool,
    /// The greatest component of a colour, at least 1.
    brightest: f64,
}

impl<'a, P: Profile> PixelJudge<'a, P> {
    pub(super) fn new(job: &Job<'_>, handed: &'a Handed<'a>) -> Self {
        let scene = job.scene;
        let colors = scene.surfels.color().unwrap_or_default();
        let brightest = colors.iter().fold(1.0_f64, |brightest, color| {
            let [r, g, b] = color.to_array().map(f64::from);
            brightest.at_least(r).at_least(g).at_least(b)
        });
        Self {
            handed,
            shader: Shader::new(View::new(job.camera), &scene.lights, scene.material),
            colored: scene.surfels.color().is_some(),
            environment: scene.environment.is_some(),
            brightest,
        }
    }

    /// Marks what is wrong at a pixel: by the continuation that errs least.
    pub(super) fn judge(
        &self,
        (pixel, at): (usize, (u32, u32)),
        nearest: &Nearest<P>,
        sums: &Continuations<P>,
        marks: &mut [Marks; 3],
    ) {
        let all: &[Sums<Ball<P>>] = match sums {
            Continuations::One(sums) => std::slice::from_ref(sums),
            Continuations::Several(sums) => sums,
            Continuations::Many => &[],
        };
        let mut best: Option<([f64; 3], &Sums<Ball<P>>)> = None;
        for sums in all {
            // What is right is equally right; a stage counts before those that follow it.
            let mut worst = [1.0; 3];
            if all.len() > 1 {
                self.check(at, nearest, Some(sums), &mut |part, error, _| {
                    worst[part as usize] = worst[part as usize].at_least(error);
                });
            }
            if best.is_none_or(|(least, _)| worst < least) {
                best = Some((worst, sums));
            }
        }
        let sums = best.map(|(_, sums)| sums);
        self.check(at, nearest, sums, &mut |part, error, fault| {
            marks[part as usize].at(pixel).found(error, fault);
        });
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
        let averages = (sum::direction(normal, weight), sum::average(color, weight));
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
            number(Part::Attributes, plane, at, widened(sums.weight, lost(1.0)), report);
        }
        if let Some(plane) = normal_sum {
            let truth = sums.normal.map(|part| widened(part, lost(1.0)));
            triple(Part::Attributes, (plane, VECTOR), at, truth, report);
        }
        if let Some(plane) = color_sum {
            let truth = sums.color.map(|part| widened(part, lost(self.brightest)));
            triple(Part::Attributes, (plane, COLOR), at, truth, report);
        }
        if let Some(plane) = count {
            let found = u32::from(*plane.plane.at(at.0, at.1));
            whole(Part::Attributes, plane.name, found, sums.count.into(), report);
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
            triple(Part::Normalization, (plane, COLOR), at, color, report);
        }
        if let Some(plane) = &handed.normal {
            triple(Part::Normalization, (plane, VECTOR), at, normal, report);
        }
        let copies = [(handed.depth, handed.depth_copy), (handed.weight, handed.weight_copy)];
        for (first, copy) in copies {
            if let (Some(first), Some(copy)) = (first, copy) {
                number(Part::Normalization, &copy, at, first.ball::<P>(at), report);
            }
        }
        if let (Some(first), Some(copy)) = (handed.id, handed.id_copy) {
            let [truth, found] = [first, copy].map(|ids| *ids.plane.at(at.0, at.1));
            whole(Part::Normalization, copy.name, found, truth, report);
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
        let empty = depth.middle == f64::INFINITY;
        if let Some(plane) = &handed.shaded {
            let truth = if depth.radius.is_finite() && !empty {
                let normal = handed.normal.map_or(normal, |plane| plane.balls(at));
                let surface = match (self.colored, handed.color) {
                    (false, _) => self.shader.plain(),
                    (true, Some(plane)) => plane.balls(at),
                    (true, None) => color,
                };
                let [x, y, z] = normal;
                let place = (at.0 as usize, at.1 as usize);
                self.shader.surface(place, depth, Vector3::new(x, y, z), surface)
            } else if empty && !self.environment {
                [Ball::ZERO; 3]
            } else {
                [anything(); 3]
            };
            triple(Part::Shading, (plane, COLOR), at, truth, report);
        }
        if let Some(plane) = &handed.alpha {
            let seen: Ball<P> = if self.environment {
                Ball::ONE
            } else {
                Ball::select(weight.gt(Ball::ZERO), Ball::ONE, Ball::ZERO)
            };
            number(Part::Shading, plane, at, seen, report);
        }
    }
}

/// Any number, or none.
fn anything<P: Profile>() -> Ball<P> {
    Ball::new(0.0, f64::NAN)
}

/// A ball that is larger by this much.
fn widened<P: Profile>(ball: Ball<P>, by: f64) -> Ball<P> {
    if by > 0.0 { Ball::new(ball.middle, ball.radius + by) } else { ball }
}

/// One number against what it may be.
fn number<P: Profile>(
    part: Part,
    plane: &Stored<'_, f64>,
    at: (u32, u32),
    truth: Ball<P>,
    report: &mut Report<'_>,
) {
    component_of(part, || plane.name.to_owned(), plane.ball(at), truth, report);
}

/// Three numbers against what they may be.
fn triple<P: Profile>(
    part: Part,
    (plane, letters): (&Stored<'_, [f64; 3]>, [&str; 3]),
    at: (u32, u32),
    truth: [Ball<P>; 3],
    report: &mut Report<'_>,
) {
    for ((found, truth), letter) in plane.balls(at).into_iter().zip(truth).zip(letters) {
        component_of(part, || component(plane.name, letter), found, truth, report);
    }
}

fn component_of<P: Profile>(
    part: Part,
    channel: impl Fn() -> String,
    found: Ball<P>,
    truth: Ball<P>,
    report: &mut Report<'_>,
) {
    report(part, truth.misfit(found), &|| Fault::Value {
        channel: channel(),
        found: found.middle,
        truth: truth.middle,
        radius: truth.radius + found.radius,
    });
}

/// An index or a count against what it must be.
fn whole(part: Part, name: &str, found: u32, truth: u32, report: &mut Report<'_>) {
    let error = if found == truth { 0.0 } else { f64::INFINITY };
    report(part, error, &|| Fault::Whole { channel: name.to_owned(), found, truth });
}
