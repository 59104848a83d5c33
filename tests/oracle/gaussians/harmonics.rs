//! Real spherical harmonics from associated Legendre functions of angles.

use crate::oracle::kit::dice::Dice;
use crate::oracle::kit::eye::{V3, dot, unit, wide};
use splatref::number::Vector3;
use splatref::shade::harmonics::basis;
use std::collections::BTreeSet;
use std::f64::consts::PI;

/// The associated Legendre function `P_l^m`(cos theta) with the Condon-Shortley sign, by its
/// recurrence.
fn legendre(l: u32, m: u32, cosine: f64, sine: f64) -> f64 {
    let mut last = (0..m).fold(1.0, |p, k| p * -f64::from(2 * k + 1) * sine);
    let mut before = 0.0;
    for degree in m + 1..=l {
        let (n, order) = (f64::from(degree), f64::from(m));
        let next = ((2.0 * n - 1.0) * cosine * last - (n + order - 1.0) * before) / (n - order);
        (before, last) = (last, next);
    }
    last
}

fn factorial(n: u32) -> f64 {
    (1..=n).map(f64::from).product()
}

/// The constant in front of each polynomial of the rustdoc, in closed form: its square times 4 pi.
fn constant(l: u32, m: u32) -> f64 {
    let square = match (l, m) {
        (0, _) => 1.0,
        (1, _) => 3.0,
        (2, 1) => 15.0,
        (2, 0) => 5.0 / 4.0,
        (2, _) => 15.0 / 4.0,
        (_, 0) => 7.0 / 4.0,
        (_, 1) => 21.0 / 8.0,
        (_, 2) => 105.0 / 4.0,
        (_, _) => 35.0 / 8.0,
    };
    (square / (4.0 * PI)).sqrt()
}

/// The constant of an order: degree 3 has two constants for its order 2, one twice the other.
fn rounding(l: u32, m: i32) -> f64 {
    let double = if (l, m) == (3, -2) || (l, m) == (2, -2) { 2.0 } else { 1.0 };
    let exact = constant(l, m.unsigned_abs()) * double;
    f64::from(exact as f32) / exact
}

/// The function of degree l and order m in a direction, times the rounding of its constant to
/// `f32`. The polynomials are homogeneous, so a length is a power of it.
pub(crate) fn harmonic(l: u32, m: i32, direction: V3) -> f64 {
    let length = dot(direction, direction).sqrt();
    let [x, y, z] = unit(direction);
    let order = m.unsigned_abs();
    let norm = f64::from(2 * l + 1) / (4.0 * PI) * factorial(l - order) / factorial(l + order);
    let angle = f64::from(order) * y.atan2(x);
    let around = match m {
        0 => 1.0,
        1.. => std::f64::consts::SQRT_2 * angle.cos(),
        _ => std::f64::consts::SQRT_2 * angle.sin(),
    };
    norm.sqrt()
        * legendre(l, order, z, x.hypot(y))
        * around
        * rounding(l, m)
        * length.powi(l as i32)
}

/// The functions of degrees 0 to this one, in the order of coefficients.
pub(crate) fn harmonics(degree: u32, direction: V3) -> Vec<f64> {
    let orders = (0..=degree as i32).flat_map(|l| (-l..=l).map(move |m| (l as u32, m)));
    orders.map(|(l, m)| harmonic(l, m, direction)).collect()
}

#[test]
fn the_functions_are_those_of_the_table_in_the_rustdoc() {
    // Each function in a direction where it is large, from the table by hand.
    let [x, y, z] = [2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0];
    let found = harmonics(3, [x, y, z]);
    let c = |digits: f64| f64::from(digits as f32);
    let table = [
        c(0.282_094_791_8),
        -c(0.488_602_51) * y,
        c(0.488_602_51) * z,
        -c(0.488_602_51) * x,
        c(1.092_548_430_6) * x * y,
        -c(1.092_548_430_6) * y * z,
        c(0.315_391_57) * (2.0 * z * z - x * x - y * y),
        -c(1.092_548_430_6) * x * z,
        c(0.546_274_22) * (x * x - y * y),
        -c(0.590_043_59) * y * (3.0 * x * x - y * y),
        c(2.890_611_4) * x * y * z,
        -c(0.457_045_80) * y * (4.0 * z * z - x * x - y * y),
        c(0.373_176_33) * z * (2.0 * z * z - 3.0 * x * x - 3.0 * y * y),
        -c(0.457_045_80) * x * (4.0 * z * z - x * x - y * y),
        c(1.445_305_7) * z * (x * x - y * y),
        -c(0.590_043_59) * x * (x * x - 3.0 * y * y),
    ];
    for (i, (found, table)) in found.iter().zip(table).enumerate() {
        assert!((found - table).abs() < 1e-14, "b{i}: {found} for {table}");
    }
}

/// Each constant of the crate is the float nearest to the constant itself, not to eight digits of
/// it, which may be nearer to another float.
#[test]
fn the_functions_of_the_crate_have_the_nearest_floats_as_constants() {
    let mut dice = Dice(3);
    let mut wrong = BTreeSet::new();
    for _ in 0..20 {
        let direction = dice.direction();
        let [x, y, z] = wide(direction);
        let found = basis::<f64>(3, Vector3::new(x, y, z));
        for (i, truth) in harmonics(3, [x, y, z]).into_iter().enumerate() {
            if (found[i] - truth).abs() > 1e-14 {
                wrong.insert(format!("b{i}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}
