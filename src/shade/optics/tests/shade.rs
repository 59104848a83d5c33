//! Laws of the whole pixel.

use super::super::shade;
use super::*;
use crate::frame::Plane;
use crate::number::Real;
use crate::scene::environment::Map;

fn even(radiance: f32) -> Environment {
    Environment::Map(Map::new(Plane::filled(2, 1, [radiance; 3])).unwrap())
}

fn glass(layers: BendingLayers) -> Refraction {
    Refraction { ratio: [0.6875, 0.671_875, 0.656_25], layers }
}

const BLACK: Behind<f64> = Behind { color: [0.0; 3], opacity: 0.0, hidden: 0.0 };

/// Where everything has radiance 1, the pixel has radiance 1: no light is made and none is lost.
#[test]
fn a_white_furnace_stays_white() {
    let (white, mut least, mut total) = (even(1.0), 1.0_f64, 0);
    for i in 0..4000 {
        let (view, normal) = pair(18, i);
        let alpha = number(19, i);
        let count = f64::from((i % 5) as u8);
        let ratio = [0, 1, 2].map(|c| (0.25 + 2.0 * number(20, 3 * i + c)) as f32);
        let refraction = Refraction { ratio, layers: BendingLayers::Multiple };
        let hidden = if i % 3 == 0 { number(21, i) } else { 0.0 };
        // Where an opaque surfel hides the environment, the surfel sends what the environment would
        // have sent.
        let passed = (0..i % 5).fold(1.0, |product, _| product * (1.0 - alpha));
        let color = [1.0 - passed * (1.0 - hidden); 3];
        let behind = Behind { color, opacity: alpha * count, hidden };
        let nearest = NearestLayer { color: [1.0; 3], opacity: alpha, normal };
        for value in shade(&white, &refraction, view, &nearest, &behind) {
            assert!((value - 1.0).abs() < 1e-12, "{i}: {value}");
        }
        // Without the layers' own light, nothing is above 1.
        let nearest = NearestLayer { color: [0.0; 3], ..nearest };
        let behind = Behind { color: [0.0; 3], ..behind };
        for value in shade(&white, &refraction, view, &nearest, &behind) {
            assert!((0.0..=1.0).contains(&value), "{i}: {value}");
            least = least.at_most(value);
            total += usize::from(value > 0.5);
        }
    }
    assert!(least < 0.01 && total > 100, "{least} {total}");
}

#[test]
fn an_opaque_pixel_is_its_phong_colour() {
    for i in 0..500 {
        let (view, normal) = pair(22, i);
        let color = [0, 1, 2].map(|c| random::unit(23, 3 * i + c));
        let normal = single(normal * (0.5 + number(24, i)));
        let nearest = NearestLayer { color, opacity: 1.0_f32, normal };
        let behind = Behind { color: [0.5; 3], opacity: 3.0, hidden: 0.25 };
        for kind in [BendingLayers::Single, BendingLayers::Multiple] {
            let shaded = shade(&Environment::Sky, &glass(kind), single(view), &nearest, &behind);
            assert_eq!(shaded, color);
            // A nearly opaque pixel is nearly so too: the sun is below 26.
            let nearly = NearestLayer { opacity: 1.0 - 1.0 / 4096.0, ..nearest };
            let shaded = shade(&Environment::Sky, &glass(kind), single(view), &nearly, &behind);
            assert!((0..3).all(|c| (shaded[c] - color[c]).abs() < 2.0 * 27.0 / 4096.0));
        }
    }
}

/// A ratio of 1 neither reflects nor bends: the paper's Algorithm 3 over an absorbed environment.
#[test]
fn without_refraction_it_is_alpha_blending() {
    let plain = Refraction { ratio: [1.0; 3], layers: BendingLayers::Multiple };
    for i in 0..500 {
        let (view, normal) = pair(25, i);
        let alpha = 0.125 + 0.75 * number(26, i);
        let nearest = NearestLayer { color: [0.5, 0.25, 0.75], opacity: alpha, normal };
        let behind = Behind { color: [0.25, 0.5, 0.125], opacity: 2.0 * alpha, hidden: 0.0 };
        let shaded = shade(&Environment::Sky, &plain, view, &nearest, &behind);
        let sky = Environment::Sky.radiance(-view);
        let b = 1.0 - alpha;
        for c in 0..3 {
            let expected = alpha * nearest.color[c] + b * behind.color[c] + b * b * b * sky[c];
            assert!((shaded[c] - expected).abs() < 1e-9, "{shaded:?} {expected}");
        }
        let hidden = Behind { hidden: 1.0, ..behind };
        let shaded = shade(&Environment::Sky, &plain, view, &nearest, &hidden);
        let over = |c: usize| alpha * nearest.color[c] + b * behind.color[c];
        assert!((0..3).all(|c| (shaded[c] - over(c)).abs() < 1e-12), "an opaque surfel behind");
    }
}

#[test]
fn a_single_layer_sees_no_other() {
    let (view, normal) = (view_at(0.5), UP);
    let nearest = NearestLayer { color: [0.5; 3], opacity: 0.25, normal };
    let behind = Behind { color: [0.75; 3], opacity: 2.0, hidden: 0.5 };
    let of = |layers, behind| shade(&Environment::Sky, &glass(layers), view, &nearest, behind);
    assert_eq!(of(BendingLayers::Single, &behind), of(BendingLayers::Single, &BLACK));
    assert_eq!(
        of(BendingLayers::Single, &behind),
        of(BendingLayers::Multiple, &BLACK),
        "one layer is one layer"
    );
    assert_ne!(of(BendingLayers::Multiple, &behind), of(BendingLayers::Multiple, &BLACK));
}

#[test]
fn each_channel_has_its_own_ratio() {
    let (view, normal) = (view_at(0.75), Vector3::new(0.25, 0.5, 1.0).normalized());
    let nearest = NearestLayer { color: [0.5; 3], opacity: 0.25, normal };
    let behind = Behind { opacity: 0.25, ..BLACK };
    let dispersed = glass(BendingLayers::Multiple);
    let shaded = shade(&Environment::Sky, &dispersed, view, &nearest, &behind);
    for (c, ratio) in dispersed.ratio.into_iter().enumerate() {
        let one = Refraction { ratio: [ratio; 3], ..dispersed };
        let alone = shade(&Environment::Sky, &one, view, &nearest, &behind);
        assert_eq!(alone[c], shaded[c]);
        assert_ne!(alone[(c + 1) % 3], shaded[(c + 1) % 3]);
    }
}

#[test]
fn total_reflection_shows_the_mirror_alone() {
    let water = Refraction { ratio: [1.5; 3], layers: BendingLayers::Multiple };
    let view = view_at(1.0);
    let nearest = NearestLayer { color: [0.5; 3], opacity: 0.25, normal: UP };
    let behind = Behind { color: [9.0; 3], opacity: 1.0, hidden: 0.0 };
    let shaded = shade(&Environment::Sky, &water, view, &nearest, &behind);
    let mirror = Environment::Sky.radiance(Vector3::new(-sin(1.0), 0.0, cos(1.0)));
    assert!((0..3).all(|c| (shaded[c] - (0.125 + 0.75 * mirror[c])).abs() < 1e-12));
}

#[test]
fn a_normal_may_be_short_turned_away_or_absent() {
    let view = single(view_at(0.5));
    let of = |normal: Vector3<f32>| {
        let nearest = NearestLayer { color: [0.5; 3], opacity: 0.5, normal };
        let behind = Behind { color: [0.25; 3], opacity: 0.5, hidden: 0.0 };
        shade(&Environment::Sky, &glass(BendingLayers::Multiple), view, &nearest, &behind)
    };
    let normal = Vector3::new(0.25, 0.5, 1.0);
    assert_eq!(of(normal * 0.25), of(normal));
    assert_eq!(of(-normal), of(normal));
    let straight = Environment::Sky.radiance(-view).map(|v| 0.25 + 0.5 * v);
    assert_eq!(of(Vector3::ZERO), straight);
}

#[test]
fn single_precision_is_close_and_nothing_is_nan() {
    let smooth = Environment::Map(
        Map::new(Plane::from_values(4, 2, (0..8).map(|i| [i as f32; 3]).collect())).unwrap(),
    );
    for i in 0..4000 {
        let (view, mut normal) = pair(27, i);
        if i % 4 == 0 {
            normal = (normal - view * normal.dot(view)).normalized();
        }
        let color = [0.5, 0.25, 0.125];
        let (alpha, total) = (number(28, i), 4.0 * number(29, i));
        let refraction = Refraction {
            ratio: [0, 1, 2].map(|c| random::unit(30, 3 * i + c) * 0.875 + 0.1),
            layers: BendingLayers::Multiple,
        };
        let behind = Behind { color, opacity: total, hidden: 0.25 };
        let truth = shade(
            &smooth,
            &refraction,
            view,
            &NearestLayer { color, opacity: alpha, normal },
            &behind,
        );
        let behind = Behind { color: [0.5, 0.25, 0.125], opacity: total as f32, hidden: 0.25 };
        let nearest = NearestLayer {
            color: [0.5, 0.25, 0.125],
            opacity: alpha as f32,
            normal: single(normal),
        };
        let found = shade(&smooth, &refraction, single(view), &nearest, &behind);
        // Near the poles of the map, the rounding of a direction can be a turn by any angle.
        let tolerance = if i % 4 == 0 { 0.05 } else { 1e-3 };
        assert!(
            (0..3).all(|c| (f64::from(found[c]) - truth[c]).abs() < tolerance),
            "{i} {found:?} {truth:?}"
        );
    }
    let sky = Environment::Sky;
    for alpha in [0.0_f32, 1e-45, 1e-20, 0.5, 1.0, 1.000_001] {
        for total in [0.0, 1e-45, 1.0, 1e30] {
            for ratio in [1e-45, 0.5, 1.0, 1.000_001, 4.0] {
                for normal in [single(UP), Vector3::ZERO, Vector3::new(1.0, 0.0, 1e-30)] {
                    let nearest = NearestLayer { color: [0.5; 3], opacity: alpha, normal };
                    let behind = Behind { color: [0.5; 3], opacity: total, hidden: 0.0 };
                    let refraction =
                        Refraction { ratio: [ratio; 3], layers: BendingLayers::Multiple };
                    let light = shade(&sky, &refraction, single(UP), &nearest, &behind);
                    assert!(
                        light.iter().all(|v| v.is_finite() && *v >= 0.0),
                        "{nearest:?} {light:?}"
                    );
                }
            }
        }
    }
}
