//! A fast path for right pixels: most pixels of a client are right, and lanes find their errors
//! side by side.
//!
//! The checks are the checks of [`PixelJudge`](super::pixel::PixelJudge), in balls of [`Common`].
//! If every number of a pixel is known and none errs by more than 1, the errors equal the plain
//! checks bit for bit. Otherwise the fast path says nothing about the pixel.

#![expect(
    clippy::needless_range_loop,
    reason = "a lane is an index into several arrays, and such a loop becomes vectors"
)]

use super::certificate::Nearest;
use super::client_planes::ClientPlanes;
use super::pixel::{ATTRIBUTES, NORMALIZATION, SHADING};
use super::sums::AllSums;
use crate::composite::sum;
use crate::method::Job;
use crate::number::ball::{BallLanes, Common, Profile, TotalsLanes};
use crate::number::lanes::{LANES, each, vectorized};
use crate::number::{Ball, MapInline, Real};
use crate::shade::phong::Shader;
use crate::splat::View;
use crate::verdict::client::{Storage, StoredPlane, known};
use crate::verdict::supposed::Supposed;
use std::slice;

/// One number in each lane.
type Numbers<P> = BallLanes<Common<P>>;

/// The parts that all pixels share.
pub(super) struct RightPixels<'a, P: Profile> {
    client_planes: &'a ClientPlanes<'a>,
    shader: Shader<Ball<Common<P>>>,
    /// Whether surfels have colours; if not, `plain` is the material's colour.
    colored: bool,
    plain: [Numbers<P>; 3],
}

/// The errors of the stages after visibility, in bounds, at most 1.
pub(super) type Errors = [f64; 3];

impl<'a, P: Profile> RightPixels<'a, P> {
    /// None where formats or a background need checks that lanes do not have.
    pub(super) fn new(job: &Job<'a>, client_planes: &'a ClientPlanes<'a>) -> Option<Self> {
        let scalars = [
            client_planes.depth,
            client_planes.weight,
            client_planes.depth_copy,
            client_planes.weight_copy,
            client_planes.alpha,
        ];
        let triples = [
            client_planes.normal_sum,
            client_planes.color_sum,
            client_planes.color,
            client_planes.normal,
            client_planes.shaded,
        ];
        let floats =
            scalars.iter().flatten().all(is_single) && triples.iter().flatten().all(is_single);
        let other = client_planes.opacity.is_some()
            || client_planes.mask.is_some()
            || client_planes.weightless
            || client_planes.supposed != Supposed::Nothing
            || client_planes.accumulator != Storage::Single
            || job.scene.environment.is_some();
        if other || !floats {
            return None;
        }
        let scene = job.scene;
        let shader = Shader::<Ball<P>>::new(View::new(job.camera), &scene.lights, scene.material);
        let plain = shader.plain().map_inline(|part| {
            let mut lanes = Numbers::<P>::ZERO;
            (0..LANES).for_each(|i| lanes.put(i, part.rounding_as()));
            lanes
        });
        let shader = shader.map(View::new(job.camera), Ball::rounding_as);
        Some(Self { client_planes, shader, colored: scene.surfels.color().is_some(), plain })
    }

    /// The errors of some pixels of a tile, where they are known and right. Give at most [`LANES`]
    /// pixels without an undecided fragment.
    pub(super) fn errors(
        &self,
        some: &[(usize, (u32, u32))],
        nearest: &[Nearest<P>],
        sums: &AllSums<P>,
    ) -> [Option<Errors>; LANES] {
        let mut lanes = Pixels::<P>::new();
        for (i, &(pixel, at)) in some.iter().enumerate() {
            lanes.put(i, pixel, at, nearest[pixel].depth, sums);
        }
        let found = judge(self, &lanes);
        std::array::from_fn(|i| {
            (found.right[i] != 0)
                .then(|| [0, 1, 2].map_inline(|stage: usize| found.worst[stage][i]))
        })
    }
}

/// Whether a plane holds plain `f32` without radii.
fn is_single<T>(plane: &StoredPlane<'_, T>) -> bool {
    plane.storage == Storage::Single && plane.radii.is_none()
}

/// [`LANES`] pixels, and the sums added up there.
struct Pixels<P: Profile> {
    at: [(u32, u32); LANES],
    depth: Numbers<P>,
    weighted: TotalsLanes<P, 4>,
    color: TotalsLanes<P, 3>,
    count: [u8; LANES],
    /// All bits set where there is a pixel that may be right, else none.
    right: [u32; LANES],
}

impl<P: Profile> Pixels<P> {
    fn new() -> Self {
        Self {
            at: [(0, 0); LANES],
            depth: Numbers::<P>::ZERO,
            weighted: TotalsLanes::NONE,
            color: TotalsLanes::NONE,
            count: [0; LANES],
            right: [0; LANES],
        }
    }

    fn put(&mut self, i: usize, pixel: usize, at: (u32, u32), depth: Ball<P>, sums: &AllSums<P>) {
        self.at[i] = at;
        self.depth.put(i, depth.rounding_as());
        self.weighted.put(i, &sums.weighted[pixel]);
        if let Some(color) = sums.color.get(pixel) {
            self.color.put(i, color);
        }
        self.count[i] = sums.count[pixel];
        self.right[i] = u32::MAX;
    }
}

/// The error of each stage in bounds, and the lanes where all numbers fit.
struct StageErrors {
    worst: [[f64; LANES]; 3],
    right: [u32; LANES],
}

impl StageErrors {
    /// Compares a number with its ball.
    #[inline(always)]
    fn number<P: Profile>(&mut self, stage: usize, found: &Numbers<P>, truth: &Numbers<P>) {
        compare(self, stage, slice::from_ref(found), slice::from_ref(truth));
    }

    #[inline(always)]
    fn triple<P: Profile>(
        &mut self,
        stage: usize,
        found: &[Numbers<P>; 3],
        truth: &[Numbers<P>; 3],
    ) {
        compare(self, stage, found, truth);
    }

    /// Requires that values are the same.
    #[inline(always)]
    fn same(&mut self, same: impl Fn(usize) -> bool) {
        for i in 0..LANES {
            self.right[i] &= u32::from(same(i)).wrapping_neg();
        }
    }
}

vectorized!(
    /// Compares numbers with their balls. It is called, because [`judge`] compares in a dozen places.
    fn compare<P: Profile>(
        errors: &mut StageErrors,
        stage: usize,
        found: &[Numbers<P>],
        truth: &[Numbers<P>],
    ) {
        let StageErrors { worst, right } = errors;
        let (mut most, mut fits) = (worst[stage], *right);
        for (found, truth) in found.iter().zip(truth) {
            for i in 0..LANES {
                let error = truth.get(i).misfit_of_bounded(found.get(i));
                // Written so that a NaN does not fit.
                fits[i] &= u32::from(error <= 1.0).wrapping_neg();
                most[i] = if error > most[i] { error } else { most[i] };
            }
        }
        (worst[stage], *right) = (most, fits);
    }
);

/// The numbers of a plane.
#[inline(always)]
fn scalars<P: Profile>(plane: &StoredPlane<'_, f64>, at: &[(u32, u32); LANES]) -> Numbers<P> {
    lanes(each(|i| *plane.plane.at(at[i].0, at[i].1)))
}

/// The triples of a plane.
#[inline(always)]
fn triples<P: Profile>(
    plane: &StoredPlane<'_, [f64; 3]>,
    at: &[(u32, u32); LANES],
) -> [Numbers<P>; 3] {
    let mut values = [[0.0; LANES]; 3];
    for i in 0..LANES {
        let [a, b, c] = *plane.plane.at(at[i].0, at[i].1);
        (values[0][i], values[1][i], values[2][i]) = (a, b, c);
    }
    [lanes(values[0]), lanes(values[1]), lanes(values[2])]
}

/// Lanes of stored numbers.
#[inline(always)]
fn lanes<P: Profile>(values: [f64; LANES]) -> Numbers<P> {
    let mut lanes = Numbers::<P>::ZERO;
    for i in 0..LANES {
        lanes.put(i, known(values[i], 0.0));
    }
    lanes
}

/// The mean in each lane, either as a direction or as a colour.
#[inline(always)]
fn means<const DIRECTION: bool, P: Profile>(
    sums: &[Numbers<P>; 3],
    weight: &Numbers<P>,
) -> [Numbers<P>; 3] {
    let mut means = [Numbers::<P>::ZERO; 3];
    for i in 0..LANES {
        let (sums, weight) = ([sums[0].get(i), sums[1].get(i), sums[2].get(i)], weight.get(i));
        let [a, b, c] =
            if DIRECTION { sum::direction(sums, weight) } else { sum::average(sums, weight) };
        means[0].put(i, a);
        means[1].put(i, b);
        means[2].put(i, c);
    }
    means
}

vectorized!(
    /// Finds the same as [`PixelJudge::check`](super::pixel::PixelJudge::check).
    fn judge<P: Profile>(of: &RightPixels<'_, P>, pixels: &Pixels<P>) -> StageErrors {
        let (client_planes, at) = (of.client_planes, &pixels.at);
        let mut found = StageErrors { worst: [[0.0; LANES]; 3], right: pixels.right };
        // -- Sums
        let (mut weight, mut normal) = (Numbers::<P>::ZERO, [Numbers::<P>::ZERO; 3]);
        for i in 0..LANES {
            let ([w, x, y, z], known) = pixels.weighted.balls(i);
            weight.put(i, w.rounding_as());
            normal[0].put(i, x.rounding_as());
            normal[1].put(i, y.rounding_as());
            normal[2].put(i, z.rounding_as());
            found.right[i] &= u32::from(known).wrapping_neg();
        }
        let mut color = [Numbers::<P>::ZERO; 3];
        for i in 0..LANES {
            let ([r, g, b], known) = pixels.color.balls(i);
            color[0].put(i, r.rounding_as());
            color[1].put(i, g.rounding_as());
            color[2].put(i, b.rounding_as());
            found.right[i] &= u32::from(known).wrapping_neg();
        }
        if let Some(plane) = &client_planes.weight {
            let own = scalars(plane, at);
            found.number(ATTRIBUTES, &own, &weight);
            weight = own;
        }
        if let Some(plane) = &client_planes.normal_sum {
            let own = triples(plane, at);
            found.triple(ATTRIBUTES, &own, &normal);
            normal = own;
        }
        if let Some(plane) = &client_planes.color_sum {
            let own = triples(plane, at);
            found.triple(ATTRIBUTES, &own, &color);
            color = own;
        }
        if let Some(plane) = &client_planes.count {
            found.same(|i| *plane.plane.at(at[i].0, at[i].1) == pixels.count[i]);
        }
        // -- Averages
        normal = means::<true, P>(&normal, &weight);
        if let Some(plane) = &client_planes.normal {
            let own = triples(plane, at);
            found.triple(NORMALIZATION, &own, &normal);
            normal = own;
        }
        if of.colored {
            color = means::<false, P>(&color, &weight);
        } else {
            color = of.plain;
        }
        if let (Some(plane), true) = (&client_planes.color, of.colored) {
            let own = triples(plane, at);
            found.triple(NORMALIZATION, &own, &color);
            color = own;
        }
        // -- Copies of what earlier passes left
        let mut depth = pixels.depth;
        if let Some(plane) = &client_planes.depth_copy {
            let own = scalars(plane, at);
            if let Some(first) = &client_planes.depth {
                found.number(NORMALIZATION, &own, &scalars(first, at));
            }
            depth = own;
        }
        if let Some(plane) = &client_planes.weight_copy {
            let own = scalars(plane, at);
            if let Some(first) = &client_planes.weight {
                found.number(NORMALIZATION, &own, &scalars(first, at));
            }
            weight = own;
        }
        if let (Some(first), Some(copy)) = (&client_planes.id, &client_planes.id_copy) {
            let id = |plane: &StoredPlane<'_, u32>, i: usize| *plane.plane.at(at[i].0, at[i].1);
            found.same(|i| id(first, i) == id(copy, i));
        }
        // -- Shading
        if let Some(plane) = &client_planes.shaded {
            let shaded = of.shader.surfaces(at, &depth, &normal, &color);
            found.triple(SHADING, &triples(plane, at), &shaded);
        }
        if let Some(plane) = &client_planes.alpha {
            let mut alpha = Numbers::<P>::ZERO;
            for i in 0..LANES {
                let seen = weight.get(i).gt(Ball::ZERO);
                alpha.put(i, Ball::select(seen, Ball::ONE, Ball::ZERO));
            }
            found.number(SHADING, &scalars(plane, at), &alpha);
        }
        found
    }
);

#[cfg(test)]
mod tests {
    use super::super::{Judge, certificate, sums};
    use super::*;
    use crate::frame::{Plane, Samples};
    use crate::method::Method;
    use crate::method::ewa::Settings;
    use crate::number::ball::{Gpu, Ieee};
    use crate::verdict::client::Client;
    use crate::verdict::ewa::tests::each_scene;
    use crate::verdict::marks::{self, Marks, TilePart};

    /// Compares the findings with lanes and without. Returns how many pixels are right in lanes,
    /// and how many are wrong.
    fn compare<P: Profile>(job: &Job<'_>, settings: &Settings, client: &Client) -> [u64; 2] {
        let client_planes = ClientPlanes::new(client);
        let mut judge = Judge::<P>::new(job, settings, client, &client_planes);
        let mut found = [0; 2];
        for (tile, rect) in job.grid().rects().into_iter().enumerate() {
            let part = TilePart { tile, rect };
            let (splats, surfels) = (&judge.splats, judge.surfels);
            let mut marks = Marks::new(rect);
            let nearest =
                certificate::judge_among(splats, &[], &client_planes, surfels, part, &mut marks);
            let added =
                sums::add(splats, surfels, Supposed::Nothing, &nearest, part, None, &mut marks);
            let right = judge.right(rect, &nearest, &added.sums, &marks);
            found[0] += right.iter().flatten().count() as u64;
        }
        let verdict = |judge: &Judge<'_, P>| {
            marks::verdict(job, client_planes.stages(), 1.0, |tile, marks| judge.judge(tile, marks))
        };
        let own = verdict(&judge);
        judge.right = None;
        let plain = verdict(&judge);
        assert_eq!((own.covered, own.undecided), (plain.covered, plain.undecided));
        for (own, plain) in own.stages.iter().zip(&plain.stages) {
            let bits = |plane: &Plane<f32>| plane.map(|error| error.to_bits());
            assert_eq!(bits(&own.errors).values(), bits(&plain.errors).values());
            assert_eq!(own.doubts.values(), plain.doubts.values());
            assert_eq!(own.wrong, plain.wrong);
            found[1] += own.wrong;
        }
        found
    }

    #[test]
    fn what_is_right_in_lanes_has_the_errors_of_the_plain_checks() {
        let mut found = [[0; 2]; 2];
        each_scene(|session, camera| {
            let Method::Ewa(settings) = *session.method() else { return };
            for stages in [false, true] {
                let frame = session.define::<f32>(camera, stages).unwrap().frame;
                let client = Client::from(&frame);
                // Wrong colours in some places.
                let wrong = client.mapped(|name, samples| match (name, samples) {
                    ("", Samples::Color(plane)) => Samples::Color(
                        plane.map(|&[r, g, b]| [if g > 0.5 { r * 1.001 } else { r }, g, b]),
                    ),
                    _ => samples.clone(),
                });
                session.with_job(camera, |job| {
                    for client in [&client, &wrong] {
                        let all = [
                            compare::<Ieee>(job, &settings, client),
                            compare::<Gpu>(job, &settings, client),
                        ];
                        for (found, more) in found.iter_mut().zip(all) {
                            *found = [found[0] + more[0], found[1] + more[1]];
                        }
                    }
                });
            }
        });
        assert!(found.iter().all(|[right, wrong]| *right > 5000 && *wrong > 100), "{found:?}");
    }
}
