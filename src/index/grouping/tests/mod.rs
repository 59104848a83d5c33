//! Groups against their definitions, evaluated pair by pair and sample by sample.

mod clipped;
mod curve;
mod extension;
mod graph;

use super::*;
use crate::frame::Exec;
use crate::scene::{Cloud, Surfels};
use glam::{DVec3, Vec3};
use proptest::prelude::*;

fn silent(_: &str, _: u64, _: u64) {}

fn surfels(cloud: Cloud) -> Surfels {
    let (surfels, dropped) = Surfels::new(cloud).unwrap();
    assert_eq!(dropped.total(), 0);
    surfels
}

/// Discs that face +z.
fn discs(centers: &[[f32; 3]], radii: &[f32]) -> Surfels {
    surfels(Cloud {
        position: centers.iter().map(|&p| p.into()).collect(),
        normal: Some(vec![Vec3::Z; centers.len()]),
        radius: Some(radii.to_vec()),
        ..Cloud::default()
    })
}

/// A scene of `n` random surfels in a box, with normals around +z and radii in a range.
fn cluttered(seed: u64, n: usize, [width, height, depth]: [f32; 3], tilt: f32) -> Surfels {
    let unit = |i: usize, k: u64| crate::number::random::unit(seed, 16 * i as u64 + k);
    let centered = |i: usize, k: u64| 2.0 * unit(i, k) - 1.0;
    let position = |i| Vec3::new(width * unit(i, 0), height * unit(i, 1), depth * unit(i, 2));
    let normal = |i| Vec3::new(tilt * centered(i, 3), tilt * centered(i, 4), 1.0);
    surfels(Cloud {
        position: (0..n).map(position).collect(),
        normal: Some((0..n).map(normal).collect()),
        radius: Some((0..n).map(|i| 0.5 + unit(i, 5)).collect()),
        ..Cloud::default()
    })
}

/// Numbers; many are equal or nearly so, and some are extreme.
fn number() -> impl Strategy<Value = f32> {
    prop_oneof![
        6 => (-3_i8..=3).prop_map(f32::from),
        3 => (-3_i8..=3, -2_i32..=2).prop_map(|(n, ulps)| {
            f32::from_bits(f32::from(n).to_bits().wrapping_add_signed(ulps))
        }),
        6 => -4.0_f32..4.0,
        1 => prop::sample::select(vec![-0.0, 1e-45, 1e-30, 1e30, -3e38]),
    ]
    .prop_map(|x| if x.is_finite() { x } else { 0.0 })
}

fn vector() -> impl Strategy<Value = Vec3> {
    [number(), number(), number()].prop_map(Vec3::from_array)
}

fn radius() -> impl Strategy<Value = f32> {
    prop_oneof![
        8 => prop::sample::select(vec![0.25_f32, 0.5, 0.75, 1.0]),
        4 => 0.01_f32..2.0,
        1 => prop::sample::select(vec![1e-45, 1e-20, 50.0, 1e30, 3e38]),
    ]
}

/// Any surfels, enough for a tree of several levels.
fn scene() -> impl Strategy<Value = Surfels> {
    let unit_vectors = prop::sample::select(vec![
        Vec3::Z,
        Vec3::X,
        -Vec3::Z,
        Vec3::new(0.6, 0.0, 0.8),
        Vec3::new(0.1, 0.2, -0.9),
    ]);
    let color = prop::sample::select(vec![0.0_f32, 0.25, 0.5]).prop_map(Vec3::splat);
    let one = (vector(), unit_vectors, radius(), color, [1_u8..4, 1_u8..4]);
    (prop::collection::vec(one, 1..90), 0..4_u8).prop_map(|(all, kind)| {
        let tangents = |&(_, _, _, _, [u, v]): &(_, _, _, _, [u8; 2])| {
            [f32::from(u) * Vec3::X, f32::from(v) * Vec3::Y]
        };
        surfels(Cloud {
            position: all.iter().map(|s| s.0).collect(),
            normal: Some(all.iter().map(|s| s.1).collect()),
            radius: Some(all.iter().map(|s| s.2).collect()),
            color: (kind & 1 != 0).then(|| all.iter().map(|s| s.3).collect()),
            tangents: (kind == 3).then(|| all.iter().map(tangents).collect()),
            ..Cloud::default()
        })
    })
}

fn rules() -> impl Strategy<Value = Rules> {
    let overlap = prop_oneof![prop::sample::select(vec![0.0_f32, 0.5, 1.0]), 0.0_f32..=1.0];
    let coplanar = prop::sample::select(vec![
        None,
        Some(Coplanar { cosine: 0.5, offset: 0.1, color: 0.25 }),
        Some(Coplanar { cosine: 0.0, offset: 1.0, color: f32::INFINITY }),
    ]);
    (overlap, any::<bool>(), coplanar).prop_map(|(overlap, opposite, coplanar)| Rules {
        overlap,
        opposite,
        coplanar,
    })
}

/// The radius of a surfel, or its longer half axis.
fn reach(surfels: &Surfels, i: usize) -> f64 {
    match surfels.tangents() {
        None => f64::from(surfels.radius()[i]),
        Some(tangents) => {
            let length = |v: Vec3| v.as_dvec3().length();
            let [u, v] = tangents[i].map(length);
            u.max_of(v)
        }
    }
}

/// A maximum for tests.
trait MaxOf {
    fn max_of(self, other: Self) -> Self;
}

impl MaxOf for f64 {
    fn max_of(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
}

fn place(surfels: &Surfels, i: usize) -> DVec3 {
    surfels.position()[i].as_dvec3()
}

fn facing(surfels: &Surfels, i: usize) -> DVec3 {
    surfels.normal()[i].as_dvec3()
}
