//! The mistakes of renderers of Gaussian splats.

mod scenes;

use super::change::Change;
use super::mistakes::HALVES;
use super::{Case, Mistakes};
use crate::method::Method;
use crate::method::gaussians::{BlendSpace, ColorBounds, Order, Settings, Support};
use crate::number::MapInline;
use crate::scene::Camera;
use crate::splat::gaussian::{Clamp, Compensation, GaussianKernel};
use crate::splat::ray_disc::DiscRule;
use crate::verdict::supposed::Supposed;

/// All mistakes that are tried, whatever stage is wrong first: nearly all show in both.
pub(super) fn mistakes(case: &Case<'_, '_>, settings: &Settings) -> Mistakes {
    let Case { session, camera, .. } = case;
    let mut all: Mistakes = vec![
        ("rows are flipped".into(), Change::Flipped),
        ("sRGB where linear colours are expected".into(), Change::Decoded(1)),
        ("sRGB twice: an encoded picture is encoded again".into(), Change::Decoded(2)),
    ];
    all.extend(moved_by_half(camera));
    all.extend(of_lens(camera));
    all.extend(of_settings(settings));
    all.extend(
        OTHER_RULES.iter().map(|(rule, what)| ((*what).to_owned(), Change::Supposed(*rule))),
    );
    let of_surface = session.scene().surface.is_some().then_some(RULES_OF_SURFACE);
    let of_surface = of_surface.into_iter().flatten();
    all.extend(of_surface.map(|(rule, what)| (what.to_owned(), Change::Supposed(rule))));
    all.extend(scenes::mistakes(session, camera));
    all
}

/// Numbers of the lens that renderers ignore.
fn of_lens(camera: &Camera) -> Mistakes {
    let [cx, cy] = [camera.width, camera.height].map_inline(|side| 0.5 * side as f32);
    let all = [
        ("the principal point is the middle of the picture", Camera { cx, cy, ..*camera }),
        ("fx is taken for fy", Camera { fy: camera.fx, ..*camera }),
        ("fy is taken for fx", Camera { fx: camera.fy, ..*camera }),
    ];
    let other = all.into_iter().filter(|(_, other)| other != camera);
    other.map(|(what, other)| (what.to_owned(), Change::Camera(other))).collect()
}

/// The picture moved by half a pixel.
fn moved_by_half(camera: &Camera) -> Mistakes {
    let moved = |dx, dy| Camera { cx: camera.cx + dx, cy: camera.cy + dy, ..*camera };
    HALVES.map(|(what, dx, dy)| (what.to_owned(), Change::Camera(moved(dx, dy)))).into()
}

/// Rules in place of the method's own.
const OTHER_RULES: [(Supposed, &str); 11] = [
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
    (Supposed::HigherIndexFirst, "ties: of splats with the same key, the higher index is in front"),
    (
        Supposed::NearIgnored,
        "splats nearer than the near plane are drawn, and those behind the camera",
    ),
    (
        Supposed::StopAfter,
        "blending ends after the fragment that takes the transmittance below the stop, not before it",
    ),
];

/// The same where splats are mixed with a surface.
const RULES_OF_SURFACE: [(Supposed, &str); 4] = [
    (Supposed::SurfaceIgnored, "the surface has no effect: neither its depths nor its colours"),
    (Supposed::SurfaceNotTested, "splats behind the surface are drawn: there is no depth test"),
    (Supposed::SurfaceWhole, "the surface's colour is not multiplied by the transmittance"),
    (Supposed::SurfaceNotSeen, "the background is added where the surface's colour should be"),
];

/// The settings, each at other values that programs have.
fn of_settings(own: &Settings) -> Mistakes {
    let mut all = Mistakes::new();
    let mut add = |what: String, changed: Settings| {
        if changed != *own && changed.check().is_ok() {
            all.push((what, Change::Method(Method::Gaussians(changed))));
        }
    };
    discs(own, &mut add);
    filters(own, &mut add);
    decisions(own, &mut add);
    colors(own, &mut add);
    all
}

/// Mistakes with the rule of discs.
fn discs(own: &Settings, add: &mut dyn FnMut(String, Settings)) {
    for (disc, what) in [
        (DiscRule::Projected, "discs are projected as ellipses; rays do not meet them"),
        (
            DiscRule::Ray,
            "discs are drawn as the paper of 2D Gaussians says, not as its program does",
        ),
        (
            DiscRule::RayBox,
            "discs are drawn as the program of 2D Gaussians does, not as its paper says",
        ),
    ] {
        let kernel = GaussianKernel { disc, ..own.kernel };
        let what = match (own.meets_rays(), disc) {
            (false, DiscRule::Ray | DiscRule::RayBox) => {
                "rays meet discs; no ellipses are projected"
            }
            _ => what,
        };
        add(what.into(), Settings { kernel, ..*own });
    }
}

/// Mistakes with the projection.
fn filters(own: &Settings, add: &mut dyn FnMut(String, Settings)) {
    for h in [0.0, 0.1, 0.3, 0.5, 1.0] {
        let kernel = GaussianKernel { low_pass: h, ..own.kernel };
        let right = own.kernel.low_pass;
        let what = format!("the low-pass filter has another variance: {h} px^2, not {right}");
        add(what, Settings { kernel, ..*own });
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
    if own.meets_rays() {
        return;
    }
    for (compensation, what) in [
        (Compensation::None, "opacities are not compensated for the low-pass filter"),
        (Compensation::Ratio, "opacities are compensated for the low-pass filter"),
        (
            Compensation::Floor,
            "opacities are compensated for the low-pass filter, by 0.005 at least",
        ),
        (
            Compensation::Mip,
            "opacities are compensated for the low-pass filter as by Mip-Splatting",
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
}

/// Mistakes with the decisions of blending.
fn decisions(own: &Settings, add: &mut dyn FnMut(String, Settings)) {
    for most_alpha in [0.99, 0.999, 1.0] {
        let what = format!("alpha goes up to {most_alpha}, not to {}", own.most_alpha);
        add(what, Settings { most_alpha, ..*own });
    }
    for least_alpha in [0.0, 1.0 / 1024.0, 1.0 / 256.0, 1.0 / 255.0] {
        let right = own.least_alpha;
        let what = format!("fragments are skipped below an alpha of {least_alpha}, not {right}");
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
