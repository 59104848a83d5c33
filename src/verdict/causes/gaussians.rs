//! The mistakes of renderers of Gaussian splats.

use super::change::Change;
use super::{Case, Mistakes};
use crate::method::gaussians::{BlendSpace, ColorBounds, Order, Settings, Support};
use crate::method::{Method, Session};
use crate::scene::gaussians::{GaussianArrays, Gaussians, coefficients};
use crate::scene::{Camera, Scene};
use crate::splat::gaussian::{Clamp, Compensation, GaussianKernel};
use crate::verdict::supposed::Supposed;
use glam::Vec3;

/// All mistakes that are tried, whatever stage is wrong first: nearly all show in both.
pub(super) fn mistakes(case: &Case<'_, '_>, settings: &Settings) -> Mistakes {
    let Case { session, camera, .. } = case;
    let mut all: Mistakes = vec![
        ("rows are flipped".into(), Change::Flipped),
        ("sRGB where linear colours are expected".into(), Change::Decoded(1)),
        ("sRGB twice: an encoded picture is encoded again".into(), Change::Decoded(2)),
    ];
    all.extend(moved_by_half(camera));
    all.extend(of_settings(settings));
    all.extend(
        OTHER_RULES.iter().map(|(rule, what)| ((*what).to_owned(), Change::Supposed(*rule))),
    );
    all.extend(scenes(session));
    all
}

/// The picture moved by half a pixel.
fn moved_by_half(camera: &Camera) -> Mistakes {
    let all = [
        ("half a pixel to the right and down", 0.5, 0.5),
        ("half a pixel to the left and up", -0.5, -0.5),
        ("half a pixel to the right", 0.5, 0.0),
        ("half a pixel down", 0.0, 0.5),
    ];
    let moved = |dx, dy| Camera { cx: camera.cx + dx, cy: camera.cy + dy, ..*camera };
    all.map(|(what, dx, dy)| (what.to_owned(), Change::Camera(moved(dx, dy)))).into()
}

/// Rules in place of the method's own.
const OTHER_RULES: [(Supposed, &str); 8] = [
    (
        Supposed::Mirrored,
        "ellipses lean to the wrong side: a quad is mirrored, as where y points up",
    ),
    (Supposed::Transposed, "ellipses are transposed: columns and rows are exchanged"),
    (Supposed::CentersWhole, "centres are rounded to the centres of pixels"),
    (Supposed::ExpWithoutHalf, "alpha falls with exp(-q), not exp(-q/2)"),
    (Supposed::BackToFront, "splats are blended from back to front by the rule for front to back"),
    (Supposed::ColorsTwice, "premultiplied twice: colours are multiplied by alpha once too often"),
    (Supposed::BackgroundTwice, "the background is added once too often"),
    (Supposed::HalfCovariance, "covariances in half floats"),
];

/// The settings, each at other values that programs have.
fn of_settings(own: &Settings) -> Mistakes {
    let mut all = Mistakes::new();
    let mut add = |what: String, changed: Settings| {
        if changed != *own && changed.check().is_ok() {
            all.push((what, Change::Method(Method::Gaussians(changed))));
        }
    };
    filters(own, &mut add);
    decisions(own, &mut add);
    colors(own, &mut add);
    all
}

/// Mistakes with the projection.
fn filters(own: &Settings, add: &mut dyn FnMut(String, Settings)) {
    for h in [0.0, 0.1, 0.3, 1.0] {
        let kernel = GaussianKernel { low_pass: h, ..own.kernel };
        let right = own.kernel.low_pass;
        let what = format!("the low-pass filter has another variance: {h} px^2, not {right}");
        add(what, Settings { kernel, ..*own });
    }
    for (compensation, what) in [
        (Compensation::None, "opacities are not compensated for the low-pass filter"),
        (Compensation::Ratio, "opacities are compensated for the low-pass filter"),
        (
            Compensation::Floor,
            "opacities are compensated for the low-pass filter, by 0.005 at least",
        ),
    ] {
        let kernel = GaussianKernel { compensation, ..own.kernel };
        add(what.into(), Settings { kernel, ..*own });
    }
    for (clamp, what) in [
        (Clamp::None, "x/t and y/t are not bounded in the Jacobian"),
        (Clamp::Fov, "x/t and y/t are bounded by 1.3 times half the field of view"),
        (Clamp::Edges, "x/t and y/t are bounded by the picture's edges"),
    ] {
        let kernel = GaussianKernel { clamp, ..own.kernel };
        add(what.into(), Settings { kernel, ..*own });
    }
    for near in [0.0, 0.01, 0.2] {
        let kernel = GaussianKernel { near, ..own.kernel };
        let what = if near == 0.0 {
            "splats are dropped at the camera's near plane".to_owned()
        } else {
            format!("splats are dropped up to the depth {near}")
        };
        add(what, Settings { kernel, ..*own });
    }
}

/// Mistakes with the decisions of blending.
fn decisions(own: &Settings, add: &mut dyn FnMut(String, Settings)) {
    for most_alpha in [0.99, 0.999, 1.0] {
        let what = format!("alpha goes up to {most_alpha}, not to {}", own.most_alpha);
        add(what, Settings { most_alpha, ..*own });
    }
    for least_alpha in [0.0, 1.0 / 1024.0, 1.0 / 255.0] {
        let what = format!(
            "fragments of less alpha than {least_alpha} are skipped, not {}",
            own.least_alpha
        );
        add(what, Settings { least_alpha, ..*own });
    }
    for (support, cutoff, what) in [
        (Support::Ellipse, 3.0, "splats end at 3 standard deviations"),
        (Support::Ellipse, 2.828_427, "splats end at sqrt(8) standard deviations"),
        (Support::Ellipse, 3.33, "splats end at 3.33 standard deviations"),
        (Support::Tiles, 3.0, "splats end with the tiles of a square of 3 standard deviations"),
        (Support::Boxes, 3.33, "splats end with the tiles of a box of 3.33 standard deviations"),
        (Support::None, own.cutoff, "splats have no end but their least alpha"),
    ] {
        add(what.into(), Settings { support, cutoff, ..*own });
    }
    for (order, what) in [
        (Order::Depth, "splats are sorted by depth"),
        (Order::Distance, "splats are sorted by their distance from the camera"),
        (Order::Steps, "splats are sorted by distances of 16 bits"),
        (Order::Pixel, "splats are sorted at each pixel"),
    ] {
        add(what.into(), Settings { order, ..*own });
    }
    for stop in [0.0, 1e-4, 1e-3] {
        let what = format!("blending ends at the transmittance {stop}, not {}", own.stop);
        add(what, Settings { stop, ..*own });
    }
    let what = "blending ends below a transmittance, or where it is reached";
    add(what.into(), Settings { stop_at: !own.stop_at, ..*own });
}

/// Mistakes with colours.
fn colors(own: &Settings, add: &mut dyn FnMut(String, Settings)) {
    for (bounds, what) in [
        (ColorBounds::None, "colours below 0 are not bounded"),
        (ColorBounds::Zero, "colours are bounded from 0"),
        (ColorBounds::Unit, "colours are bounded to 0 to 1"),
    ] {
        add(what.into(), Settings { bounds, ..*own });
    }
    for degree in 0..own.degree {
        add(format!("spherical harmonics end at degree {degree}"), Settings { degree, ..*own });
    }
    for (blend, what) in [
        (BlendSpace::Linear, "sRGB colours are blended as linear light"),
        (BlendSpace::Srgb, "linear colours are blended as sRGB"),
    ] {
        add(what.into(), Settings { blend, ..*own });
    }
}

/// A change of the arrays of Gaussians.
type OtherArrays = fn(&mut GaussianArrays);

/// Mistakes of readers and shaders, each as another scene.
const OTHER_SCENES: [(OtherArrays, &str); 8] = [
    (
        |g| g.rotation.iter_mut().for_each(|q| *q = [q[3], q[0], q[1], q[2]]),
        "the parts of quaternions are in another order: w is read where x is",
    ),
    (
        |g| g.rotation.iter_mut().for_each(|q| *q = [q[1], q[2], q[3], q[0]]),
        "the parts of quaternions are in another order: x is read where w is",
    ),
    (
        |g| g.rotation.iter_mut().for_each(|q| q[3] = -q[3]),
        "rotations are reversed: the covariance is transposed, or of another handedness",
    ),
    (
        |g| g.scale.iter_mut().for_each(|s| *s = Vec3::new(s.y, s.x, s.z)),
        "the scales of x and y are exchanged",
    ),
    (|g| of_degrees(g, |degree| degree % 2 == 1), "the direction of the harmonics is reversed"),
    (
        |g| each_splat(g, |all| all.swap(1, 3)),
        "the coefficients of degree 1 are in the order x, z, y",
    ),
    (|g| each_splat(g, mixed), "the coefficients of colours are mixed: f_rest is by channel"),
    (drawn_again, "splat 0 is drawn once more, as where a last group of threads is not full"),
];

/// Every scene with one of these mistakes.
fn scenes(session: &Session<'_>) -> Mistakes {
    let scene = session.scene();
    let Some(gaussians) = &scene.gaussians else { return Mistakes::new() };
    let changed = |(change, what): &(OtherArrays, &str)| {
        let mut arrays = gaussians.clone().into_arrays();
        change(&mut arrays);
        let gaussians = Gaussians::new(arrays).ok()?.0;
        let scene = Scene { gaussians: Some(gaussians), ..scene.clone() };
        Some(((*what).to_owned(), Change::Scene(Box::new(scene), *session.method())))
    };
    OTHER_SCENES.iter().filter_map(changed).collect()
}

fn each_splat(g: &mut GaussianArrays, change: fn(&mut [Vec3])) {
    let each = coefficients(g.degree);
    if each > 1 {
        g.harmonics.chunks_exact_mut(each).for_each(change);
    }
}

/// Reverses the coefficients of some degrees.
fn of_degrees(g: &mut GaussianArrays, which: fn(usize) -> bool) {
    let each = coefficients(g.degree);
    for all in g.harmonics.chunks_exact_mut(each) {
        for (i, coefficient) in all.iter_mut().enumerate() {
            if which(i.isqrt()) {
                *coefficient = -*coefficient;
            }
        }
    }
}

/// Reads coefficients that are stored by channel as if they were stored by coefficient.
fn mixed(all: &mut [Vec3]) {
    let rest = all.len() - 1;
    let stored: Vec<f32> = (0..3).flat_map(|c| all[1..].iter().map(move |v| v[c])).collect();
    for i in 0..rest {
        all[1 + i] = Vec3::new(stored[3 * i], stored[3 * i + 1], stored[3 * i + 2]);
    }
}

/// Adds the first splat once more.
fn drawn_again(g: &mut GaussianArrays) {
    let each = coefficients(g.degree);
    g.position.push(g.position[0]);
    g.scale.push(g.scale[0]);
    g.rotation.push(g.rotation[0]);
    g.opacity.push(g.opacity[0]);
    g.harmonics.extend_from_within(..each);
}
