//! Laws of optics, and truths by other formulas.

mod shade;

use super::*;
use crate::number::elementary::{atan2, cos, sin, tan};
use crate::number::random;
use std::f64::consts::{FRAC_PI_2, PI};

type V = Vector3<f64>;

const UP: V = Vector3::new(0.0, 0.0, 1.0);

fn number(seed: u64, index: u64) -> f64 {
    f64::from(random::unit(seed, index))
}

/// A direction of the unit sphere.
fn unit(seed: u64, index: u64) -> V {
    let [a, b] = [0, 1].map(|c| number(seed, 2 * index + c));
    let z = 2.0 * a - 1.0;
    let r = (1.0 - z * z).sqrt();
    Vector3::new(r * cos(2.0 * PI * b), r * sin(2.0 * PI * b), z)
}

/// A view and a normal that see each other.
fn pair(seed: u64, index: u64) -> (V, V) {
    let (view, normal) = (unit(seed, 2 * index), unit(seed, 2 * index + 1));
    (view, if normal.dot(view) < 0.0 { -normal } else { normal })
}

/// The view at an angle from [`UP`].
fn view_at(angle: f64) -> V {
    Vector3::new(sin(angle), 0.0, cos(angle))
}

fn single(v: V) -> Vector3<f32> {
    Vector3::new(v.x as f32, v.y as f32, v.z as f32)
}

fn near(a: V, b: V, tolerance: f64) -> bool {
    (a - b).length() <= tolerance
}

fn angle(a: V, b: V) -> f64 {
    atan2(a.cross(b).length(), a.dot(b))
}

#[test]
fn a_mirror_halves_the_angle() {
    for i in 0..2000 {
        let (view, normal) = pair(1, i);
        let reflected = reflect(view, normal);
        assert!((reflected.length() - 1.0).abs() < 1e-14);
        assert!(near((reflected + view).normalized(), normal, 1e-7) || normal.dot(view) < 1e-3);
        assert!((angle(reflected, normal) - angle(view, normal)).abs() < 1e-7);
        assert!(near(reflect(reflected, normal), view, 1e-14), "twice is not at all");
    }
    assert_eq!(reflect(UP, UP), UP);
}

/// Light takes the path whose time does not change to first order (Fermat). The speeds are 1/ratio
/// above and 1 below, and the paths go through points of the surface around the origin.
#[test]
fn one_layer_is_the_stationary_path() {
    let mut checked = 0;
    for i in 0..2000 {
        let (view, normal) = pair(2, i);
        let ratio = 0.25 + 1.75 * number(3, i);
        let Some(t) = refract(view, normal, ratio, 1.0) else { continue };
        assert!((t.length() - 1.0).abs() < 1e-14 && t.dot(normal) <= 0.0);
        let time = |p: V| ratio * (view - p).length() + (t - p).length();
        let along = normal.cross(view).normalized();
        for direction in [along, along.cross(normal)] {
            let h = 1e-4;
            let slope = (time(direction * h) - time(direction * -h)) / (2.0 * h);
            assert!(slope.abs() < 1e-7, "{view:?} {normal:?} {ratio}: {slope}");
        }
        checked += 1;
    }
    assert!(checked > 1000);
}

#[test]
fn one_layer_is_snells_law_in_vectors_and_in_angles() {
    for i in 0..4000 {
        let (view, normal) = pair(4, i);
        let ratio = 0.25 + 1.75 * number(5, i);
        let incident = -view;
        let cosine = normal.dot(incident);
        let k = 1.0 - ratio * ratio * (1.0 - cosine * cosine);
        let found = refract(view, normal, ratio, 1.0);
        if k.abs() < 1e-9 {
            continue;
        }
        assert_eq!(found.is_some(), k > 0.0, "{view:?} {normal:?} {ratio}");
        if let Some(found) = found {
            let vector = incident * ratio - normal * (ratio * cosine + k.sqrt());
            assert!(near(found, vector, 1e-9), "{found:?} {vector:?}");
            let (inside, outside) = (angle(found, -normal), angle(view, normal));
            assert!((sin(inside) - ratio * sin(outside)).abs() < 1e-9);
            assert!(normal.cross(view).dot(found).abs() < 1e-14, "in the plane of incidence");
        }
    }
}

/// Eq. 12 for l layers is Snell's law l times, each time at the same normal.
#[test]
fn layers_add_up() {
    for i in 0..2000 {
        let (view, normal) = pair(6, i);
        let ratio = 0.5 + number(7, i);
        let mut step = Some(view);
        for l in 1..5 {
            step = step.and_then(|v| refract(v, normal, ratio, 1.0)).map(|t| -t);
            let whole = refract(view, normal, ratio, f64::from(l));
            assert_eq!(step.is_some(), whole.is_some(), "{ratio} {l}");
            if let (Some(step), Some(whole)) = (step, whole) {
                assert!(near(-step, whole, 1e-6), "{ratio} {l}: {step:?} {whole:?}");
            }
        }
        let half = refract(view, normal, ratio, 0.5).and_then(|t| refract(-t, normal, ratio, 0.5));
        let one = refract(view, normal, ratio, 1.0);
        assert!(half.is_none() && one.is_none() || near(half.unwrap(), one.unwrap(), 1e-6));
    }
}

#[test]
fn total_reflection_begins_where_the_sine_passes_one() {
    // Exact sines: ratio^layers times each is exactly 1.
    for (sine, ratio, layers) in [(0.5_f32, 2.0, 1.0), (0.25, 2.0, 2.0), (0.25, 4.0, 1.0)] {
        let view = |s: f32| Vector3::new(s, 0.0, (1.0 - s * s).sqrt());
        let up = single(UP);
        let along = refract(view(sine), up, ratio, layers).unwrap();
        assert_eq!((along.x, along.z.abs()), (-1.0, 0.0), "at 1 along the surface");
        assert!(refract(view(f32::next_down(sine)), up, ratio, layers).is_some());
        assert_eq!(refract(view(f32::next_up(sine)), up, ratio, layers), None);
    }
    for i in 0..4000 {
        let (view, normal) = pair(8, i);
        let layers = 8.0 * number(9, i);
        let ratio = if i % 3 == 0 { 1.0 } else { 1.0 - number(10, i) };
        let found = refract(single(view), single(normal), ratio as f32, layers as f32);
        let found = found.expect("a ratio of at most 1 never reflects totally");
        assert!((found.length() - 1.0).abs() < 1e-6, "{found:?}");
    }
}

#[test]
fn along_the_normal_and_without_layers_light_goes_straight() {
    let flat = single(UP);
    for ratio in [0.01_f32, 0.5, 1.0, 1.5, 4.0] {
        for layers in [0.0, 0.5, 1.0, 7.0, 1e9, f32::INFINITY] {
            assert_eq!(refract(flat, flat, ratio, layers), Some(-flat), "{ratio} {layers}");
        }
    }
    for i in 0..4000 {
        let (mut view, normal) = pair(11, i);
        if i % 4 == 0 {
            // Grazing, down to the surface itself.
            let height = if i % 8 == 0 { 0.0 } else { 1e-6 * number(12, i) };
            view = (view - normal * (normal.dot(view) - height)).normalized();
        }
        let (view32, normal32) = (single(view), single(normal));
        if normal32.dot(view32) < 0.0 || normal.dot(view) < 0.0 {
            continue;
        }
        for (ratio, layers) in [(0.5, 0.0), (4.0, 0.0), (1.0, 3.0)] {
            let found = refract(view, normal, ratio, layers).unwrap();
            assert!(near(found, -view, 1e-15 * 4.0), "{view:?} {found:?}");
            let found = refract(view32, normal32, ratio as f32, layers as f32).unwrap();
            assert!((found + view32).length() < 5e-7, "{view32:?} {found:?}");
        }
    }
}

/// Fresnel's sine law and tangent law, in angles.
fn by_angles(outside: f64, ratio: f64) -> (f64, f64) {
    let sine = ratio * sin(outside);
    let inside = atan2(sine, (1.0 - sine * sine).sqrt());
    let (less, more) = (outside - inside, outside + inside);
    let [s, p] = [sin(less) / sin(more), tan(less) / tan(more)];
    (s * s, p * p)
}

#[test]
fn fresnel_is_the_sine_law_and_the_tangent_law() {
    for ratio in [0.25, 0.5, 2.0 / 3.0, 0.75, 0.9, 1.25, 1.5, 2.0] {
        // 899 is prime: no angle is exactly critical, where rounding decides.
        for i in 1..899 {
            let outside = FRAC_PI_2 * f64::from(i) / 899.0;
            if ratio * sin(outside) > 1.0 {
                assert_eq!(fresnel(cos(outside), ratio), 1.0, "total reflection");
                continue;
            }
            let (s, p) = by_angles(outside, ratio);
            let found = fresnel(cos(outside), ratio);
            assert!((found - (s + p) / 2.0).abs() < 1e-9, "{ratio} {i}: {found}");
            assert!((0.0..=1.0).contains(&found));
            let f32s = fresnel(cos(outside) as f32, ratio as f32);
            assert!((f64::from(f32s) - found).abs() < 2e-3 && (0.0..=1.0).contains(&f32s));
        }
    }
}

/// Glass of index 1.5, as printed in tables of optics.
#[test]
fn fresnel_of_glass() {
    let glass = |degrees: f64| fresnel(cos(degrees.to_radians()), 1.0 / 1.5);
    for (degrees, percent) in [(0.0, 4.0), (30.0, 4.15), (45.0, 5.02), (60.0, 8.92), (75.0, 25.3)] {
        assert!((100.0 * glass(degrees) - percent).abs() < 0.05, "{degrees}: {}", glass(degrees));
    }
    assert!((glass(90.0) - 1.0).abs() < 1e-12);
    // At Brewster's angle, tan = 1.5, p vanishes and s is ((1 - n^2)/(1 + n^2))^2 = (1.25/3.25)^2.
    let brewster = fresnel(1.0 / (1.0_f64 + 1.5 * 1.5).sqrt(), 1.0 / 1.5);
    assert!((brewster - (1.25_f64 / 3.25) * (1.25 / 3.25) / 2.0).abs() < 1e-15);
}

#[test]
fn laws_of_fresnel() {
    for i in 0..4000 {
        let ratio = 0.01 + 3.9 * number(13, i);
        let cosine = number(14, i);
        let normal = (1.0 - ratio) / (1.0 + ratio);
        assert!((fresnel(1.0, ratio) - normal * normal).abs() < 1e-14);
        assert_eq!(fresnel(cosine, 1.0), 0.0, "a ratio of 1 is no surface");
        let grazing = if ratio == 1.0 { 0.0 } else { 1.0 };
        assert_eq!(fresnel(0.0, ratio), grazing);
        // From the other side, at the angle that the light has there, the same part is reflected.
        let k = 1.0 - ratio * ratio * (1.0 - cosine * cosine);
        if k > 1e-6 {
            let back = fresnel(k.sqrt(), 1.0 / ratio);
            assert!((fresnel(cosine, ratio) - back).abs() < 1e-6, "{ratio} {cosine}");
        }
        let f32s = fresnel(cosine as f32, ratio as f32);
        assert!((0.0..=1.0).contains(&f32s), "{ratio} {cosine}: {f32s}");
    }
    assert_eq!((fresnel(0.0_f32, 1.0), fresnel(1e-9_f32, 1.0)), (0.0, 0.0));
}

#[test]
fn absorption_is_a_power_and_layers_its_count() {
    for alpha in [0.0_f32, 0.25, 0.5, 0.875, 1.0] {
        let mut product = 1.0;
        for l in 0..6_u8 {
            assert_eq!(absorption(alpha, f32::from(l)), product, "{alpha} {l}");
            product *= 1.0 - alpha;
            let total = (0..l).fold(0.0, |sum, _| sum + alpha);
            let count = if alpha > 0.0 { f32::from(l) } else { 0.0 };
            assert_eq!(layers(total, alpha), count);
        }
    }
    for i in 0..1000 {
        let (alpha, a, b) = (number(15, i), 9.0 * number(16, i), 9.0 * number(17, i));
        let both = absorption(alpha, a) * absorption(alpha, b);
        assert!((absorption(alpha, a + b) - both).abs() < 1e-14);
        assert!((0.0..=1.0).contains(&both));
    }
    assert_eq!(absorption(1.0 + f32::EPSILON, 1.5), 0.0, "rounded past 1");
    assert_eq!(layers(0.0_f32, 0.0), 0.0);
    assert_eq!(absorption(1e-40_f32, layers(1.0, 1e-40)), 1.0, "so many layers of nothing");
}

#[test]
fn ratios_out_of_range_are_refused() {
    let check =
        |ratio| Refraction { ratio: [1.0, ratio, 4.0], layers: BendingLayers::Single }.check();
    assert!(check(0.5).is_ok() && check(4.0).is_ok());
    for bad in [0.0, -0.0, -1.0, 4.000_001, f32::INFINITY, f32::NAN] {
        let line = check(bad).unwrap_err().to_string();
        assert!(line.contains("(0, 4]") && !line.contains('\n'), "{line}");
    }
}
