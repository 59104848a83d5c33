use super::*;
use crate::number::random::unit;
use crate::scene::Cloud;
use crate::source::Shape;
use proptest::prelude::*;
use std::collections::BTreeMap;

fn none(_: &str, _: u64, _: u64) {}

fn vector(v: Vec3) -> [f64; 3] {
    v.to_array().map(f64::from)
}

fn sized(surfels: &Surfels, i: usize) -> f64 {
    let Some(tangents) = surfels.tangents() else { return surfels.radius()[i].into() };
    let [u, v] = tangents[i].map(vector);
    let c = [u[1] * v[2] - v[1] * u[2], u[2] * v[0] - v[2] * u[0], u[0] * v[1] - v[0] * u[1]];
    ((c[0] * c[0] + c[1] * c[1]) + c[2] * c[2]).sqrt().sqrt()
}

/// The sums of the samples of a grid: P A, N and C A, and A.
fn samples(surfels: &Surfels, cell: f64) -> Vec<([f64; 9], f64)> {
    let side = |i: usize| {
        let n = surfels.normal()[i].to_array();
        let longest = (0..3)
            .rev()
            .fold(2, |best, axis| if n[axis].abs() >= n[best].abs() { axis } else { best });
        2 * longest + usize::from(n[longest] < 0.0)
    };
    let mut samples = BTreeMap::<([i64; 3], usize), ([f64; 9], f64)>::new();
    for j in 0..surfels.len() {
        let at = vector(surfels.position()[j]).map(|x| (x / cell).floor() as i64);
        let (sum, area) = samples.entry((at, side(j))).or_default();
        let a = sized(surfels, j) * sized(surfels, j);
        let color = surfels.color().unwrap()[j];
        let numbers = [surfels.position()[j], surfels.normal()[j], color].map(vector);
        for (to, from) in sum.iter_mut().zip(numbers.concat()) {
            *to += from * a;
        }
        *area += a;
    }
    samples.into_values().collect()
}

/// The mean of all samples around a surfel.
fn around(surfels: &Surfels, i: usize, reach: f64) -> Option<Vec3> {
    // The greatest power of two that is not greater, found by search.
    let mut power = 1.0;
    while power > reach {
        power /= 2.0;
    }
    while power * 2.0 <= reach {
        power *= 2.0;
    }
    let (center, own) = (vector(surfels.position()[i]), vector(surfels.normal()[i]));
    let mut sums = [0.0; 4];
    for (sum, area) in samples(surfels, power / 4.0) {
        let d = [0, 1, 2].map(|c| f64::from((sum[c] / area) as f32) - center[c]);
        let dd = (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2];
        let facing = (sum[3] * own[0] + sum[4] * own[1]) + sum[5] * own[2];
        if dd < reach * reach && facing > 0.0 {
            let rest = 1.0 - dd / (reach * reach);
            let w = area * (rest * rest);
            (0..3).for_each(|c| sums[c] += sum[6 + c] / area * w);
            sums[3] += w;
        }
    }
    (sums[3] > 0.0).then(|| [0, 1, 2].map(|c| (sums[c] / sums[3]) as f32 + 0.0).into())
}

/// The module page, as it is written: every sample of the grid for every surfel.
fn naive(surfels: &Surfels, levels: usize) -> Vec<Vec3> {
    let mut made = Vec::new();
    for i in 0..surfels.len() {
        let mut color = surfels.color().unwrap()[i];
        let mut reach = sized(surfels, i);
        for _ in 1..=levels {
            reach *= 2.0;
            color = around(surfels, i, reach).unwrap_or(color);
            made.push(color);
        }
    }
    made
}

/// Discs or ellipses of any sizes, some at the same places, facing anywhere.
fn any_surfels() -> impl Strategy<Value = Surfels> {
    (1..80_u64, any::<u64>(), any::<bool>(), 1..60_u32).prop_map(|(n, seed, ellipses, spread)| {
        let unit = |i: u64, c: u64| unit(seed, 16 * i + c);
        let vector =
            |i: u64, from: u64| Vec3::new(unit(i, from), unit(i, from + 1), unit(i, from + 2));
        let each = || 0..n;
        let radius = |i: u64| {
            // Sizes that differ by up to 2^16.
            let power = 1_u32 << ((unit(i, 6) * 16.0) as u32 * spread / 60);
            (0.5 + unit(i, 7)) / power as f32
        };
        let centred = |v: Vec3| v - Vec3::splat(0.5);
        let cloud = Cloud {
            position: each().map(|i| centred(vector(i / 2 + i % 2, 0)) * 2.0).collect(),
            normal: Some(each().map(|i| centred(vector(i, 3)) + Vec3::splat(1e-3)).collect()),
            radius: Some(each().map(radius).collect()),
            color: Some(each().map(|i| vector(i, 8)).collect()),
            tangents: ellipses.then(|| {
                let axes =
                    |i: u64| [Vec3::X, Vec3::new(0.25, 1.0, unit(i, 12))].map(|v| v * radius(i));
                each().map(axes).collect()
            }),
            ..Cloud::default()
        };
        Surfels::new(cloud).unwrap().0
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn the_tree_finds_what_the_page_says(surfels in any_surfels(), levels in 1..6_usize) {
        let expected = naive(&surfels, levels);
        for exec in [Exec::sequential(), Exec::new(3, 32).unwrap()] {
            let made = build(&surfels, levels, &exec, &none).unwrap();
            prop_assert_eq!(made.colors(), expected.as_slice());
        }
    }

    #[test]
    fn one_colour_stays_that_colour(surfels in any_surfels(), gray in 0.0..9.0_f32) {
        let n = surfels.len();
        let color = Vec3::new(gray, gray / 3.0, 0.0);
        let cloud = Cloud { color: Some(vec![color; n]), ..surfels.into_cloud() };
        let surfels = Surfels::new(cloud).unwrap().0;
        let made = build(&surfels, 7, &Exec::sequential(), &none).unwrap();
        prop_assert!(made.colors().iter().all(|made| *made == color));
    }
}

/// A board of side 1 in two colours, and another board behind it that faces the other way.
fn boards() -> Surfels {
    let side = 64_u32;
    let at = |i: u32| (i as f32 + 0.5) / side as f32 - 0.5;
    let front = |i: u32| Vec3::new(at(i % side), at(i / side), 0.0);
    let count = side * side;
    let back = |i| front(i) - Vec3::Z / 256.0;
    let half = |p: Vec3| Vec3::splat(if p.x < 0.0 { 0.0 } else { 1.0 });
    let cloud = Cloud {
        position: (0..count).map(front).chain((0..count).map(back)).collect(),
        normal: Some([vec![Vec3::Z; count as usize], vec![-Vec3::Z; count as usize]].concat()),
        radius: Some(vec![1.0 / 64.0; 2 * count as usize]),
        color: Some(
            (0..count).map(|i| half(front(i))).chain((0..count).map(|_| Vec3::Y)).collect(),
        ),
        ..Cloud::default()
    };
    Surfels::new(cloud).unwrap().0
}

#[test]
fn an_edge_becomes_a_slope_of_the_width_of_the_level() {
    let surfels = boards();
    let made = build(&surfels, 4, &Exec::new(2, 32).unwrap(), &none).unwrap();
    for i in 0..64 * 64 {
        let x = surfels.position()[i].x;
        for (k, color) in (1..).zip(made.of_surfel(i)) {
            let reach = (1_u32 << k) as f32 / 64.0;
            assert!(color.x == color.y && color.y == color.z, "the other sheet: {color}");
            // A sample may lie a cell's diagonal away from its surfels.
            let far = 1.4 * reach;
            assert!(x.abs() < far || color.x == if x < 0.0 { 0.0 } else { 1.0 }, "{x} {k} {color}");
            let inside = x.abs() < 0.3 * reach;
            assert!(!inside || (color.x - 0.5).abs() < 0.4, "{x} {k} {color}");
        }
    }
    assert!(
        (64 * 64..2 * 64 * 64).all(|i| made.of_surfel(i).iter().all(|color| *color == Vec3::Y))
    );
}

#[test]
fn coarser_levels_vary_less() {
    let surfels = Shape::Checkerboard { square: 0.25 }.surfels(20_000, 1).unwrap();
    let made = build(&surfels, 5, &Exec::new(2, 32).unwrap(), &none).unwrap();
    let near = |i: &usize| surfels.position()[*i].abs().max_element() < 3.0;
    let all: Vec<usize> = (0..surfels.len()).filter(near).collect();
    let spread = |color: &dyn Fn(usize) -> f32| {
        let values: Vec<f64> = all.iter().map(|&i| color(i).into()).collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / values.len() as f64
    };
    let mut before = spread(&|i| surfels.color().unwrap()[i].x);
    for k in 1..=5 {
        let now = spread(&|i| made.of_surfel(i)[k - 1].x);
        assert!(now < before, "level {k}: {now} after {before}");
        before = now;
    }
}

#[test]
fn what_has_no_colours_is_refused() {
    let cloud = Cloud {
        position: vec![Vec3::ZERO],
        normal: Some(vec![Vec3::Z]),
        radius: Some(vec![1.0]),
        ..Cloud::default()
    };
    let surfels = Surfels::new(cloud).unwrap().0;
    let error = build(&surfels, 1, &Exec::sequential(), &none).unwrap_err().to_string();
    assert_eq!(error, "mipmaps need colours, but the points have none; remove the mipmaps");
    assert!(build(&surfels, 0, &Exec::sequential(), &none).is_err());
}
