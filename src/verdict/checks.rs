//! Checks for the clients of every method: numbers against balls, copies, and shading.

use crate::composite::over::Blend;
use crate::frame::named::{COLOR, VECTOR, component};
use crate::method::Job;
use crate::method::picture::before_light;
use crate::method::stage::Holds;
use crate::number::ball::Profile;
use crate::number::{Ball, MapInline, Real, Vector3};
use crate::scene::Environment;
use crate::shade::phong::Shader;
use crate::splat::View;
use crate::verdict::Fault;
use crate::verdict::client::{Storage, StoredPlane};
use crate::verdict::supposed::Supposed;

/// Receives a check: the index of its stage among the stages that are judged together, the error in
/// bounds (NaN if there are none), and the fault if the error is above 1.
pub(crate) type Report<'a> = dyn FnMut(usize, f64, &dyn Fn() -> Fault) + 'a;

/// A ball of any number, NaN included.
pub(crate) fn anything<P: Profile>() -> Ball<P> {
    Ball::new(0.0, f64::NAN)
}

/// A ball with a radius that is larger by this much.
pub(crate) fn widened<P: Profile>(ball: Ball<P>, by: f64) -> Ball<P> {
    if by > 0.0 { Ball::new(ball.middle, ball.radius + by) } else { ball }
}

/// The value that the next stage reads from a stored value of this format. Floats are read as they
/// are. None for formats that each reader converts to a number.
fn read<P: Profile>(value: f64, storage: Storage) -> Option<Ball<P>> {
    let flushed = P::FLUSHES && value.abs() < f64::from(f32::MIN_POSITIVE);
    let radius = if value.is_nan() {
        f64::NAN
    } else if flushed {
        value.abs()
    } else {
        0.0
    };
    let is_float = matches!(storage, Storage::Single | Storage::Half | Storage::Float { .. });
    is_float.then_some(Ball::new(value, radius))
}

/// The number that the next stage reads at a pixel.
pub(crate) fn input<P: Profile>(plane: &StoredPlane<'_, f64>, at: (u32, u32)) -> Ball<P> {
    let value = *plane.plane.at(at.0, at.1);
    read(value, plane.storage).unwrap_or_else(|| plane.ball(at))
}

/// The same, but a 0 where nothing is drawn has no radius, as in [`StoredPlane::ball_where`].
pub(crate) fn input_where<P: Profile>(
    plane: &StoredPlane<'_, f64>,
    at: (u32, u32),
    is_empty: bool,
) -> Ball<P> {
    if plane.is_nothing(at, is_empty) { Ball::exact(0.0) } else { input(plane, at) }
}

/// The three numbers that the next stage reads at a pixel.
#[inline]
pub(crate) fn inputs<P: Profile>(
    plane: &StoredPlane<'_, [f64; 3]>,
    at: (u32, u32),
) -> [Ball<P>; 3] {
    let balls = plane.balls(at);
    let exact = |ball: Ball<P>| read(ball.middle, plane.storage).unwrap_or(ball);
    if plane.radii.is_some() { balls } else { balls.map_inline(exact) }
}

/// Compares one number with the numbers that are allowed.
pub(crate) fn number<P: Profile>(
    part: usize,
    plane: &StoredPlane<'_, f64>,
    at: (u32, u32),
    truth: Ball<P>,
    report: &mut Report<'_>,
) {
    let found = as_exact(plane, plane.ball(at), truth);
    component_of(part, || plane.channel(), found, truth, report);
}

/// Compares three numbers with the numbers that are allowed. Their letters follow from the kind of
/// the plane.
#[inline]
pub(crate) fn triple<P: Profile>(
    part: usize,
    plane: &StoredPlane<'_, [f64; 3]>,
    at: (u32, u32),
    truth: [Ball<P>; 3],
    report: &mut Report<'_>,
) {
    let letters = if plane.holds == Holds::Color { COLOR } else { VECTOR };
    let found = plane.balls(at);
    for (i, letter) in letters.into_iter().enumerate() {
        let found = as_exact(plane, found[i], truth[i]);
        component_of(part, || component(&plane.channel(), letter), found, truth[i], report);
    }
}

/// The stored number as a copy of this truth. Every format holds 0 and 1 exactly, so a truth that
/// is exactly 0 or 1 may not be rounded: an empty pixel holds exact values in any format. Equal
/// steps may lie to both sides of the truth, because their first may stand for any number.
fn as_exact<T, P: Profile>(plane: &StoredPlane<'_, T>, found: Ball<P>, truth: Ball<P>) -> Ball<P> {
    let exact = truth.radius == 0.0 && (truth.middle == 0.0 || truth.middle == 1.0);
    // Planes of depths store other numbers than depths.
    if !exact || found.middle.is_nan() || plane.radii.is_some() || plane.holds == Holds::Depth {
        return found;
    }
    let radius = match plane.storage {
        Storage::Steps(step) => HALF_A_STEP * step,
        // The power of an sRGB code rounds, except for 0.
        Storage::Srgb { .. } if truth.middle != 0.0 => found.radius,
        _ => 0.0,
    };
    Ball::new(found.middle, radius)
}

/// Half a step between codes, and a little more because codes are converted to numbers.
const HALF_A_STEP: f64 = 0.500_001;

fn component_of<P: Profile>(
    part: usize,
    channel: impl Fn() -> String,
    found: Ball<P>,
    truth: Ball<P>,
    report: &mut Report<'_>,
) {
    // Without a bound nothing is proved, unless the value is the midpoint itself, or a NaN where
    // any number is right.
    let no_number = found.middle.is_nan() && !truth.radius.is_nan();
    let judged = truth.radius.is_finite() || truth.middle == found.middle || no_number;
    let error = if judged { truth.misfit(found) } else { f64::NAN };
    report(part, error, &|| Fault::Value {
        channel: channel(),
        found: found.middle,
        truth: truth.middle,
        // A NaN has no meaningful radius of its own.
        radius: if found.middle.is_nan() { truth.radius } else { truth.radius + found.radius },
    });
}

/// Compares an index or a count with the required value.
#[inline]
pub(crate) fn whole<T: Copy + Into<u32>>(
    part: usize,
    plane: &StoredPlane<'_, T>,
    at: (u32, u32),
    truth: T,
    report: &mut Report<'_>,
) {
    let (found, truth) = ((*plane.plane.at(at.0, at.1)).into(), truth.into());
    let error = if found == truth { 0.0 } else { f64::INFINITY };
    report(part, error, &|| Fault::Whole { channel: plane.channel(), found, truth });
}

/// Among several truths, the one against which the client errs least, by the worst error in each of
/// N stages. An earlier stage counts before later ones. Errors up to 1 count as equal.
pub(crate) fn least_wrong<T, const N: usize>(
    all: &[T],
    check: impl Fn(&T, &mut Report<'_>),
) -> Option<&T> {
    if let [one] = all {
        return Some(one);
    }
    let mut best: Option<([f64; N], &T)> = None;
    for truth in all {
        let mut worst = [1.0; N];
        check(truth, &mut |part, error, _| worst[part] = worst[part].at_least(error));
        if best.is_none_or(|(least, _)| worst < least) {
            best = Some((worst, truth));
        }
    }
    best.map(|(_, truth)| truth)
}

/// The index of the only truth among several against which nothing is wrong.
pub(crate) fn only_fitting<T>(all: &[T], check: impl Fn(&T, &mut Report<'_>)) -> Option<usize> {
    let fits = |truth: &T| {
        let mut fits = true;
        check(truth, &mut |_, error, _| fits &= !(error > 1.0));
        fits
    };
    let several = if all.len() > 1 { all } else { &[] };
    let mut fitting = (0..several.len()).filter(|i| fits(&several[*i]));
    fitting.next().filter(|_| fitting.next().is_none())
}

/// The environment behind all layers of a client.
pub(crate) struct Backdrop<'a, P: Profile> {
    environment: Option<&'a Environment>,
    view: View<Ball<P>>,
}

impl<'a, P: Profile> Backdrop<'a, P> {
    pub(crate) fn new(job: &Job<'a>) -> Self {
        Self { environment: job.scene.environment.as_ref(), view: View::new(job.camera) }
    }

    /// Puts layers before the environment, if there is one.
    pub(crate) fn behind(&self, layers: Blend<Ball<P>>, (x, y): (u32, u32)) -> Blend<Ball<P>> {
        let Some(environment) = self.environment else { return layers };
        before_light(layers, || environment.enclosure(self.view.ray(x, y)))
    }
}

/// Whether a colour is bounded, so that it can be judged.
pub(crate) fn is_bounded<P: Profile>(color: &[Ball<P>; 3]) -> bool {
    color.iter().all(|part| part.radius.is_finite())
}

/// Deferred shading for a client's surfaces.
pub(crate) struct Shading<'a, P: Profile> {
    shader: Shader<Ball<P>>,
    /// Whether surfels have colours; if not, the material has one.
    colored: bool,
    /// The environment where nothing else is seen; none if that is black.
    backdrop: Option<Backdrop<'a, P>>,
    /// Whether normals are supposed to be lit without being turned to the camera.
    unturned: bool,
    view: View<Ball<P>>,
}

/// The surface at a pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface<P: Profile> {
    /// The depth; exactly +inf in an empty pixel.
    pub(crate) depth: Ball<P>,
    /// Normal and tangent in world space. A surface has no tangent; a tube has one.
    pub(crate) normal: [Ball<P>; 3],
    pub(crate) tangent: Option<[Ball<P>; 3]>,
    /// The colour, if surfels have colours.
    pub(crate) color: [Ball<P>; 3],
}

impl<'a, P: Profile> Shading<'a, P> {
    pub(crate) fn new(job: &Job<'a>, colored: bool) -> Self {
        let scene = job.scene;
        Self {
            shader: Shader::new(View::new(job.camera), &scene.lights, scene.material),
            colored,
            backdrop: scene.environment.is_some().then(|| Backdrop::new(job)),
            unturned: false,
            view: View::new(job.camera),
        }
    }

    /// Shading by the rule that is supposed.
    pub(crate) fn supposing(self, supposed: Supposed) -> Self {
        Self { unturned: supposed == Supposed::LitUnturned, ..self }
    }

    /// Shading for a layer: an empty pixel is black.
    pub(crate) fn of_layer(job: &Job<'a>, colored: bool) -> Self {
        Self { backdrop: None, ..Self::new(job, colored) }
    }

    /// Whether an empty pixel is black.
    pub(crate) fn is_black(&self) -> bool {
        self.backdrop.is_none()
    }

    /// The colour of a pixel; any colour where the depth is unknown.
    pub(crate) fn color(&self, (x, y): (u32, u32), surface: &Surface<P>) -> [Ball<P>; 3] {
        let Surface { depth, normal, tangent, color } = *surface;
        // An unknown depth may have any midpoint, so the radius is tested too.
        let empty = depth.middle == f64::INFINITY && depth.radius == 0.0;
        if empty {
            let shown = self.backdrop.as_ref().map(|all| all.behind(Blend::CLEAR, (x, y)));
            return shown.map_or([Ball::ZERO; 3], |shown| shown.color);
        }
        if !depth.radius.is_finite() {
            return [anything(); 3];
        }
        let vector = |[x, y, z]: [Ball<P>; 3]| Vector3::new(x, y, z);
        // The shader turns the normal, so turn it back before.
        let normal = if self.unturned { self.turned_back(normal) } else { normal };
        let color = if self.colored { color } else { self.shader.plain() };
        let place = (x as usize, y as usize);
        match tangent {
            Some(tangent) => self.shader.tube(place, depth, vector(tangent), color),
            None => self.shader.surface(place, depth, vector(normal), color),
        }
    }

    /// A direction of view space in world space: the inverse of a rotation is its transpose.
    fn turned_back(&self, [x, y, z]: [Ball<P>; 3]) -> [Ball<P>; 3] {
        let rows = &self.view.rows;
        [0, 1, 2].map_inline(|i: usize| rows[0][i] * x + rows[1][i] * y + rows[2][i] * z)
    }

    /// The opacity of a pixel, where something is seen if `seen` is greater than 0.
    pub(crate) fn alpha(&self, seen: Ball<P>) -> Ball<P> {
        if self.backdrop.is_some() {
            Ball::ONE
        } else {
            Ball::select(seen.gt(Ball::ZERO), Ball::ONE, Ball::ZERO)
        }
    }
}
