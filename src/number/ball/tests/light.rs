//! The light of an environment, and the light seen through a refracting surface.

use super::lawful::{Law, Lawful, begin};
use crate::frame::Plane;
use crate::number::ball::{Ball, Gpu, Ieee, Precise, Profile};
use crate::number::random::{bits, unit};
use crate::number::{Exact, Real, Vector3};
use crate::scene::Environment;
use crate::scene::environment::{Map, scaled, sky};
use crate::shade::optics::{Behind, BendingLayers, NearestLayer, Refraction, shade_before};
use std::f64::consts::TAU;

/// The light of a direction, as an implementation may compute it.
fn light(environment: &Environment, direction: Vector3<Lawful>) -> [Lawful; 3] {
    let direction = scaled(direction);
    let Environment::Map(map) = environment else { return sky::radiance(direction) };
    let [s, t] = map.place(direction, std::f32::consts::PI.into(), Lawful::atan2);
    let (i, j) = (s.floor(), t.floor());
    let width = i64::from(map.pixels().width());
    let column = |i: f32| (i as i64).rem_euclid(width) as u32;
    let row = (j.value as u32).min(map.pixels().height() - 1);
    map.between([column(i.value), column(i.value + 1.0)], row, [s - i, t - j])
}

/// A map whose pixels have any colour.
fn map(width: u32) -> Environment {
    let pixels = (0..u64::from(width * width / 2)).map(|i| [0, 1, 2].map(|c| unit(5, 3 * i + c)));
    Environment::Map(Map::new(Plane::from_values(width, width / 2, pixels.collect())).unwrap())
}

fn vector(seed: u64, i: u64) -> [f32; 3] {
    // Some of them point along an axis.
    [0, 1, 2].map(|c| if i % 7 == c { 0.0 } else { 2.0 * unit(seed, 3 * i + c) - 1.0 })
}

fn vector_of<R: Real>(value: [f32; 3]) -> Vector3<R> {
    let [x, y, z] = value.map(R::from_f32);
    Vector3::new(x, y, z)
}

/// The colour that a number computes at the surface of this index, before a light.
fn shaded<R: Real>(i: u64, light: impl Fn(Vector3<R>) -> [R; 3]) -> [R; 3] {
    let some = |seed: u64| R::from_f32(unit(seed, i));
    let color = |seed: u64| [0, 1, 2].map(|c| R::from_f32(unit(seed, 3 * i + c)));
    let ratio = [0, 1, 2].map(|c| 0.25 + 1.5 * unit(41, 3 * i + c));
    let layers = if i.is_multiple_of(2) { BendingLayers::Multiple } else { BendingLayers::Single };
    let normal = vector_of(vector(42, i));
    let nearest = NearestLayer { color: color(43), opacity: some(44), normal };
    let behind = Behind { color: color(45), opacity: some(46), hidden: some(47) };
    // Some views are straight on.
    let view = vector_of::<R>(vector(if i.is_multiple_of(5) { 42 } else { 48 }, i)).normalized();
    shade_before(light, &Refraction { ratio, layers }, view, &nearest, &behind)
}

/// Checks that no value escapes, and that most of the balls are small.
fn assert_held<P: Profile>(law: Law) {
    for environment in [Environment::Sky, map(4), map(64)] {
        let (mut small, mut all) = (0, 0);
        let mut ask = |values: [Lawful; 3], balls: [Ball<P>; 3], what: &str, i: u64| {
            for (value, ball) in values.iter().zip(balls) {
                let held = ball.contains(value.value.into());
                assert!(held, "{what} {i}: {} is not {ball:?}", value.value);
                small += usize::from(ball.radius < 5e-2);
                all += 1;
            }
        };
        for i in 0..4000 {
            begin(law, bits(7, i));
            let direction = vector(40, i);
            let own = light(&environment, vector_of(direction));
            ask(own, environment.enclosure(vector_of(direction)), "light", i);
            let own = shaded(i, |direction| light(&environment, direction));
            ask(own, shaded(i, |direction| environment.enclosure(direction)), "shaded", i);
        }
        assert!(4 * small > 3 * all, "{small} of {all} are small");
    }
}

#[test]
fn light_and_what_bends_it_do_not_escape() {
    assert_held::<Ieee>(Law::Ieee);
    assert_held::<Precise>(Law::Precise);
    assert_held::<Gpu>(Law::Gpu);
}

#[test]
fn the_middle_of_light_is_what_f64_finds() {
    for environment in [Environment::Sky, map(64)] {
        for i in 0..500 {
            let direction = vector(50, i);
            let own = environment.radiance::<f64>(vector_of(direction));
            let ball = environment.enclosure::<Ieee>(vector_of(direction));
            for (own, ball) in own.iter().zip(ball) {
                assert!((own - ball.middle).abs() < 1e-12 || ball.radius.is_nan(), "{i}");
            }
        }
    }
}

#[test]
fn light_that_is_somewhere_else_is_not_held() {
    let environment = map(64);
    let escaped = |i: &u64| {
        let [x, y, z] = vector(51, *i);
        let own = environment.radiance(Vector3::<f32>::new(x, y, -z));
        let ball = environment.enclosure::<Gpu>(vector_of([x, y, z]));
        !ball[0].contains(own[0].into())
    };
    assert!((0..500).filter(escaped).count() > 300);
}

/// A point of a ball, at its ends or between.
fn inside(ball: Ball, seed: u64, i: u64) -> f64 {
    ball.middle + ball.radius * f64::from(2.0 * unit(seed, i) - 1.0)
}

#[test]
fn angles_and_powers_of_balls_hold_those_of_their_points() {
    for i in 0..20_000 {
        let [x, y] = [0, 1].map(|c| {
            let middle = f64::from(2.0 * unit(60, 2 * i + c) - 1.0);
            Ball::<Ieee>::new(middle, f64::from(unit(61, 2 * i + c)) * 0.3)
        });
        let own = libm::atan2(inside(y, 62, i), inside(x, 63, i));
        let turns = [own - TAU, own, own + TAU];
        assert!(turns.iter().any(|own| y.angle(x).contains(*own)), "{own} is not {:?}", y.angle(x));
        let base = Ball::<Ieee>::new(x.middle.abs(), 0.2 * x.radius);
        let exponent = Ball::<Ieee>::new(1.0 + 4.0 * y.middle.abs(), y.radius);
        let point = inside(base, 64, i);
        if point >= 0.0 {
            let own = libm::pow(point, inside(exponent, 65, i));
            let ball = base.pow(exponent);
            assert!(ball.contains(own) && ball.radius < 10.0, "{own} is not {ball:?}");
        }
    }
}
