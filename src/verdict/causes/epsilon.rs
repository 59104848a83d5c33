//! Mistakes with epsilon: on the wrong side or in the wrong unit. Authors of GPU backends read "the
//! fragments within epsilon of the nearest" in several ways.
//!
//! | mistake | what passes | simulated by |
//! |---|---|---|
//! | half, twice, 0, ignored | t <= `t_1` + e' | a setting |
//! | median radii for world units, or the reverse | t <= `t_1` + e' | a setting |
//! | wrong side: subtracted, or a depth bias towards the eye | t <= `t_1` - e: nothing | a [`Band`] |
//! | wrong side: the comparison reversed | t > `t_1` + e | [`behind`] |
//! | a difference of 1/t, or of what a depth buffer holds | 1/t >= 1/`t_1` - u e | a [`Band`] |
//! | a distance along the ray, as where discs are moved along it | t <= `t_1` + e / \|ray\| | a [`Band`] |
//! | radii of the nearest surfel for median ones | t <= `t_1` + n r | a [`Band`] |
//! | the depth handed in is that of the moved discs | Z = `t_1` + e, or - e | the depths moved back |
//!
//! u is 1, or the slope by which the client's depths are stored. For depths stored as t, u is 1 /
//! near, as in a depth buffer whose far plane is at infinity. Two mistakes are not simulated:
//!
//! - The radius of each fragment's own surfel, because then the band of a pixel has no single end.
//! - The strict t < `t_1` + e, because it differs only at ties.

use super::change::Change;
use super::{Case, depths};
use crate::frame::{Plane, Samples};
use crate::method::ewa::visibility::Foremost;
use crate::method::surface;
use crate::method::{Method, Session};
use crate::number::MapInline;
use crate::number::Real;
use crate::scene::{Camera, Projection};
use crate::setting::{Fields, Value};
use crate::splat::Epsilon;
use crate::verdict::client::{Band, Client, Storage};

/// Epsilon in world units, if the method is `ewa`, and epsilon is positive and finite.
fn resolved(session: &Session<'_>) -> Option<f32> {
    if !matches!(session.method(), Method::Ewa(_) | Method::SinglePass(_)) {
        return None;
    }
    let epsilon = session.method().splats()?.epsilon.resolve(&session.scene().surfels);
    (epsilon > 0.0 && epsilon.is_finite()).then_some(epsilon)
}

/// Epsilon times a factor, in the same unit.
pub(super) fn scaled(method: &Method, factor: f32) -> Option<Value> {
    let text = match method.splats()?.epsilon {
        Epsilon::World(depth) => format!("{:?}", depth * factor),
        Epsilon::MedianRadii(count) => format!("{:?}r", count * factor),
    };
    Some(Value::Text(text))
}

/// The same number in the other unit, and the mistake in words.
pub(super) fn other_unit(method: &Method) -> Option<(String, Change)> {
    let (text, what) = match method.splats()?.epsilon {
        Epsilon::World(depth) => (format!("{depth:?}r"), "epsilon is in median radii"),
        Epsilon::MedianRadii(count) => (format!("{count:?}"), "epsilon is in world units"),
    };
    let mut changed = *method;
    changed.set("epsilon", &Value::Text(text)).ok()?;
    let what = format!("the unit of epsilon: {what}");
    changed.check().is_ok().then_some((what, Change::Method(changed)))
}

/// Other ends of the band, and the mistakes in words.
pub(super) fn bands(
    session: &Session<'_>,
    camera: &Camera,
    client: &Client,
) -> Vec<(String, Change)> {
    let Some(splats) = session.method().splats().filter(|_| resolved(session).is_some()) else {
        return Vec::new();
    };
    let mut all = vec![
        ("nothing is added up, as if epsilon were on the wrong side", Band::Before),
        ("the unit of epsilon: a difference of 1/t, not of t", Band::OfNearness(1.0)),
    ];
    if camera.projection == Projection::Perspective {
        let slope = client.slope_of_depths().unwrap_or(1.0 / f64::from(camera.near));
        let what = "the unit of epsilon: a difference of depth-buffer values, not of t";
        all.push((what, Band::OfNearness(slope)));
        let what = "the direction of epsilon: along the ray of the pixel, not along the view";
        all.push((what, Band::AlongRay));
    }
    if let Epsilon::MedianRadii(count) = splats.epsilon {
        let what = "the unit of epsilon: radii of the nearest surfel, not the median radius";
        all.push((what, Band::RadiiOfNearest(count)));
    }
    let named = |(what, band): (&str, _)| (what.to_owned(), Change::Band(band));
    let mut all: Vec<_> = all.into_iter().map(named).collect();
    if matches!(session.method(), Method::Ewa(_)) {
        let what = "epsilon is on the wrong side: what is added up lies behind it";
        all.push((what.to_owned(), Change::Behind));
    }
    all
}

/// Visibility depths that are moved by epsilon, or by another length, and the mistakes in words.
pub(super) fn moved(case: &Case<'_, '_>) -> Vec<(String, Change)> {
    if case.client.depth_of_visibility().is_none() {
        return Vec::new();
    }
    let mut all = Vec::new();
    if let Some(epsilon) = resolved(case.session) {
        let epsilon = f64::from(epsilon);
        all.push((
            "the depth comes from discs moved back by epsilon".into(),
            Change::Moved(epsilon),
        ));
        let what = "epsilon is on the wrong side: the depth comes from discs moved towards the eye";
        all.push((what.into(), Change::Moved(-epsilon)));
    }
    if let Some(offset) = depths::offset(case) {
        let what = format!("a depth bias: depths are {} too large", depths::digits(offset));
        all.push((what, Change::Moved(offset)));
    }
    all
}

/// The planes that may hold the depth for judging the visibility pass. The first one that is there
/// is used.
pub(super) const DEPTHS: [&str; 2] = [Foremost::<f32>::PLANES[0].row.name, surface::DEPTH.name];

/// The client as if its band ended there.
pub(super) fn banded(client: &Client, band: Band) -> Client {
    let of_images = client.frame().planes.iter().any(|plane| plane.name.starts_with("group"));
    let client = match band {
        Band::Before if of_images => {
            client.with_planes(|name| name.starts_with("group") || is_sum(name))
        }
        Band::Before => up_to_sums(client),
        _ => client.clone(),
    };
    Client { band, ..client }
}

/// The client without the planes that follow from its sums. If nothing is added up, these planes
/// may hold anything.
fn up_to_sums(client: &Client) -> Client {
    let frame = client.frame();
    let is_first = |name: &str, stage: &str| frame.plane(&format!("{stage}.{name}")).is_none();
    let kept = |name: &str| match name {
        "Z" | "id" => is_first(name, "visibility"),
        "weight" => is_first(name, "attributes"),
        _ => name.starts_with("visibility.") || is_sum(name),
    };
    client.with_planes(kept)
}

/// The client with its depths alone.
pub(super) fn depths_alone(client: &Client) -> Client {
    let first = DEPTHS.into_iter().find(|name| client.frame().scalar(name).is_ok());
    client.with_planes(|name| Some(name) == first)
}

/// Whether a plane holds sums.
fn is_sum(name: &str) -> bool {
    name == "weight" || name.split('.').next() == Some("attributes")
}

/// The client with its discs moved back by this much.
pub(super) fn moved_back(client: &Client, by: f64) -> Client {
    let mut back = client.mapped(|name, samples| match samples {
        // An empty pixel stays at infinity.
        Samples::Scalar(plane) if DEPTHS.contains(&name) => {
            Samples::Scalar(client.changed(plane, |depth| depth - by))
        }
        other => client.same(other),
    });
    for name in DEPTHS {
        if matches!(back.storage(name), Storage::Single | Storage::Rounded) {
            // Moving the depth rounded it, and undoing the move rounds again.
            let lost = 4.0 / 16_777_216.0;
            back = back.stored(name, Storage::Float { relative: lost, least: lost * by.abs() });
        }
    }
    // The client compares with its own depth.
    banded(&back, if by < 0.0 { Band::Before } else { Band::Depth })
}

/// The method and the client for judging sums of fragments that lie behind the band. The client's
/// sums plus the sums of the band in `f64` are the sums of all fragments, which the method computes
/// without epsilon.
pub(super) fn behind(
    session: &Session<'_>,
    camera: &Camera,
    client: &Client,
) -> Option<(Method, Client)> {
    let mut all = *session.method();
    all.set("epsilon", &Value::Text("inf".into())).ok()?;
    // Where there is no memory for another picture, this mistake is not tried.
    let band = session.define_whole::<f64>(camera, true).ok()?.frame;
    let client = up_to_sums(client);
    let both = client.mapped(|name, samples| match band.plane(name) {
        Some(band) if is_sum(name) => sum(samples, band),
        _ => samples.clone(),
    });
    Some((all, both))
}

/// Adds two planes, pixel by pixel.
fn sum(a: &Samples<f64>, b: &Samples<f64>) -> Samples<f64> {
    fn each<T: Copy>(a: &Plane<T>, b: &Plane<T>, add: impl Fn(T, T) -> T) -> Plane<T> {
        let values = a.values().iter().zip(b.values()).map(|(&a, &b)| add(a, b)).collect();
        Plane::from_values(a.width(), a.height(), values)
    }
    let three = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map_inline(|i| a[i] + b[i]);
    match (a, b) {
        (Samples::Scalar(a), Samples::Scalar(b)) => Samples::Scalar(each(a, b, |a, b| a + b)),
        (Samples::Color(a), Samples::Color(b)) => Samples::Color(each(a, b, three)),
        (Samples::Vector(a), Samples::Vector(b)) => Samples::Vector(each(a, b, three)),
        (Samples::Count(a), Samples::Count(b)) => {
            Samples::Count(each(a, b, |a, b| a.saturating_add(b)))
        }
        (other, _) => other.clone(),
    }
}

impl Client {
    /// The slope of a stored depth with respect to 1/t, where the client does not store t.
    fn slope_of_depths(&self) -> Option<f64> {
        let (name, _) = self.depth_of_visibility()?;
        match self.storage(name) {
            // The stored number is z = (1/near - 1/t) / (1/near - 1/far), or 1 minus z.
            Storage::DepthBuffer { near, far, .. } => Some(1.0 / near - 1.0 / far),
            Storage::Inverse { scale, .. } => Some(1.0 / scale),
            _ => None,
        }
    }

    /// The depth for judging the visibility pass: its plane, and the greatest finite value.
    pub(super) fn depth_of_visibility(&self) -> Option<(&'static str, f64)> {
        let name = DEPTHS.into_iter().find(|name| self.frame().scalar(name).is_ok())?;
        let values = self.frame().scalar(name).ok()?.values();
        let finite = values.iter().filter(|depth| depth.is_finite());
        Some((name, finite.fold(0.0, |most: f64, &depth| most.at_least(depth))))
    }
}
