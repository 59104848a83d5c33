//! The identity of \[ZP06\]: Algorithm 1 is the 2+1-pass method wherever no group has two fragments
//! within epsilon of the nearest of all; and what it is elsewhere.
//!
//! The groups are coloured here, from the definition. Which fragments a pixel has is the oracle's
//! word; the two pictures are the crate's.

use crate::oracle::ewa::model::{Oracle, Seen};
use crate::oracle::kit::dice::Dice;
use crate::oracle::kit::draw::Drawing;
use crate::oracle::kit::eye::{dot, wide};
use crate::oracle::kit::planes::value;
use crate::oracle::kit::scene::{discs, framed, groups, scene, straight, surfels};
use crate::oracle::kit::tolerance::Arithmetic;
use glam::Vec3;
use proptest::prelude::*;
use splatref::frame::Frame;
use splatref::method::ewa;
use splatref::method::single_pass::{self, DepthTest};
use splatref::scene::{Camera, Cloud, Light, Scene, Surfels};
use splatref::source::Shape;
use splatref::splat::Epsilon;
use splatref::splat::{Kernel, Outline};

/// The spacing of `f64` at 1: two roundings, one for either method.
const ULP: f64 = f64::EPSILON;

/// The paper's kernel: distance in the splat's plane, nothing else.
const PAPER: Kernel = Kernel { outline: Outline::RayCast, cutoff: 2.0, low_pass: 0.0 };

/// Greedy colouring with `|p_i - p_j| >= r_i + r_j` in a group.
fn colored(surfels: &Surfels) -> Vec<u8> {
    let mut own: Vec<u8> = Vec::new();
    for (i, p) in surfels.position().iter().enumerate() {
        let conflicts = |j: &usize| {
            let distance = (p.as_dvec3() - surfels.position()[*j].as_dvec3()).length();
            distance < f64::from(surfels.radius()[i]) + f64::from(surfels.radius()[*j])
        };
        let taken: Vec<u8> = (0..i).filter(conflicts).map(|j| own[j]).collect();
        own.push((0..64).find(|group| !taken.contains(group)).expect("at most 64 groups"));
    }
    own
}

/// Surfels before a headlight.
pub(crate) fn lit(cloud: Cloud) -> Scene {
    let light = Light::Headlight { towards: Vec3::new(0.25, 0.5, 1.0), color: Vec3::ONE };
    Scene { lights: vec![light], ..scene(surfels(cloud)) }
}

/// Discs in the view of [`straight`]: anywhere, or on two bent sheets that face the camera.
fn cloud(seed: u64, sheets: bool) -> Cloud {
    let mut dice = Dice(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 77);
    let (mut position, mut normal, mut radius, mut color) = (vec![], vec![], vec![], vec![]);
    for _ in 0..150 {
        let p = dice.vector(Vec3::new(-3.0, -2.5, -6.0), Vec3::new(3.0, 2.5, -2.0));
        let behind = dice.below(2) as f32 * 0.75;
        let bend = 0.05 * (p.x * p.x + p.y * p.y);
        let on = Vec3::new(p.x, p.y, -3.0 - bend - behind);
        let slope = Vec3::new(0.1 * p.x, 0.1 * p.y, 1.0).normalize();
        position.push(if sheets { on } else { p });
        normal.push(if sheets { slope } else { dice.direction() });
        radius.push(dice.within(0.1, 0.45));
        color.push(dice.vector(Vec3::ZERO, Vec3::ONE));
    }
    let (normal, radius, color) = (Some(normal), Some(radius), Some(color));
    Cloud { position, normal, radius, color, ..Cloud::default() }
}

/// How many pixels, and why the identity does not hold at some.
#[derive(Clone, Copy, Debug, Default)]
struct Census {
    covered: usize,
    /// The condition holds, and so does the identity.
    same: usize,
    /// Two fragments of one group in the band: one of them beside its disc.
    footprint: usize,
    /// As before, both on their discs: one of them is seen at more than 60 degrees.
    steep: usize,
    /// As before, both seen from the front.
    sheets: usize,
    /// Rounding decides what is in the band.
    doubtful: usize,
    /// The most fragments in a band.
    most: usize,
    /// The largest difference as a part of its bound.
    worst: f64,
    /// And in ulp of the larger value, of weights and of colours.
    ulps: f64,
}

impl Census {
    /// Which causes there are.
    fn causes(&self) -> String {
        let causes =
            [(self.footprint, "footprint"), (self.steep, "steep"), (self.sheets, "sheets")];
        let there: Vec<_> = causes.into_iter().filter(|c| c.0 > 0).map(|c| c.1).collect();
        there.join(" ")
    }
}

/// Both pictures of a scene, and the oracle.
struct Pair<'a> {
    scene: &'a Scene,
    oracle: Oracle<'a>,
    /// The oracle of the discs themselves: the paper's kernel.
    discs: Oracle<'a>,
    own: Vec<u8>,
    ewa: Frame<f64>,
    single: Frame<f64>,
}

impl<'a> Pair<'a> {
    fn new(scene: &'a Scene, camera: &Camera, splats: ewa::Settings) -> Self {
        let own = colored(&scene.surfels);
        let count = usize::from(own.iter().copied().fold(0, u8::max)) + 1;
        let settings = single_pass::Settings { splats, depth: DepthTest::Plain };
        let groups = groups(own.clone(), count);
        let single = Drawing::new(scene, camera, settings).grouped(&groups).frame();
        let ewa = Drawing::new(scene, camera, splats).frame();
        let (step, part) = Arithmetic::F64Rounded.step();
        let oracle = Oracle::new(scene, camera, &splats, [step, 4.0 * part]);
        let kernel = Kernel { cutoff: splats.kernel.cutoff, ..PAPER };
        let bare = ewa::Settings { kernel, ..splats };
        let discs = Oracle::new(scene, camera, &bare, [step, 4.0 * part]);
        Self { scene, oracle, discs, own, ewa, single }
    }

    /// The sums of m fragments in two orders, and what follows from them, with derived bounds.
    ///
    /// A sum of m terms in any order is within (m - 1) u of the exact one, times the sum of the
    /// terms' magnitudes, with u = ulp/2; so two differ by (m - 1) ulp. A quotient of two such sums
    /// is within (2 (m - 1) + 1) u, two differ by (2 m - 1) ulp. A direction adds four roundings in
    /// either method, and a short average magnifies.
    fn check_same(&self, i: usize, m: usize, census: &mut Census, place: &str) {
        let both = |ewa, single| (value(&self.ewa, ewa, i), value(&self.single, single, i));
        let (weight, count) = (both("attributes.weight", "sums.weight").0[0], m as f64);
        let average = both("attributes.normal", "sums.normal").0.map(|v| v / weight);
        let length = dot(average, average).sqrt();
        let rows = [
            ("attributes.weight", "sums.weight", count - 1.0, 0.0),
            ("weight", "weight", count - 1.0, 0.0),
            ("attributes", "sums", count - 1.0, 0.0),
            ("resolved", "resolved", 2.0 * count - 1.0, 0.0),
            ("attributes.normal", "sums.normal", 0.0, (count - 1.0) * weight),
            ("normal", "normal", 0.0, (2.0 * count - 1.0) / length + 4.0),
        ];
        for (ewa, single, relative, absolute) in rows {
            let (a, b) = both(ewa, single);
            for (a, b) in a.into_iter().zip(b) {
                let bound = ULP * (relative * a.abs().max(b.abs()) + absolute) * (1.0 + 1e-5);
                assert!((a - b).abs() <= bound, "{place}: {ewa} {a} and {b}, {m} fragments");
                if a != b {
                    census.worst = census.worst.max((a - b).abs() / bound);
                }
                if a != b && relative > 0.0 {
                    census.ulps = census.ulps.max((a - b).abs() / (ULP * a.abs()));
                }
            }
        }
    }

    /// Whether one of two fragments is seen at more than 60 degrees.
    fn steep(&self, [x, y]: [f64; 2], pair: [&Seen<'_>; 2]) -> bool {
        let eye = &self.oracle.optics.eye;
        let ray = eye.ray(x, y).1;
        pair.iter().any(|(splat, _)| {
            let n = eye.direction(wide(self.scene.surfels.normal()[splat.index]));
            dot(n, ray).abs() < 0.5 * dot(ray, ray).sqrt()
        })
    }

    /// Whether one of two fragments is beside its disc.
    fn beside(&self, at: [f64; 2], pair: [&Seen<'_>; 2]) -> bool {
        let on = self.discs.fragments(at);
        let hit =
            |i: usize| on.iter().any(|(s, f)| s.index == i && f.value.q <= self.discs.limit());
        pair.iter().any(|(splat, _)| !hit(splat.index))
    }

    /// Two fragments of one group in the band.
    fn conflict<'b>(&self, seen: &'b [Seen<'a>]) -> Option<[&'b Seen<'a>; 2]> {
        let group = |s: &Seen<'_>| self.own[s.0.index];
        seen.iter()
            .enumerate()
            .find_map(|(k, a)| seen[..k].iter().find(|b| group(b) == group(a)).map(|b| [a, b]))
    }

    /// In the band every group has its nearest fragment alone.
    fn check_nearer_alone(&self, i: usize, inside: &[Seen<'_>], place: &str) -> usize {
        let first = inside.iter().map(|s| s.1.value.t).fold(f64::INFINITY, f64::min);
        let mut visible = 0;
        for group in 0..64 {
            let members = || inside.iter().filter(|s| self.own[s.0.index] == group);
            let nearest = members().map(|s| s.1.value.t).fold(f64::INFINITY, f64::min);
            if nearest == f64::INFINITY {
                continue;
            }
            let id = value(&self.single, &format!("group{group:02}.id"), i)[0] as usize;
            let kept = members().find(|s| s.0.index == id);
            let t = kept.map(|s| s.1.value.t - self.oracle.slack(&s.1));
            assert!(t.is_some_and(|t| t <= nearest), "{place}: group {group} keeps {id}");
            visible += usize::from(nearest <= first + self.oracle.epsilon);
        }
        visible
    }

    fn census(&self, name: &str) -> Census {
        let mut census = Census::default();
        let limit = self.oracle.limit();
        for i in 0..(self.ewa.width * self.ewa.height) as usize {
            let (x, y) = (i as u32 % self.ewa.width, i as u32 / self.ewa.width);
            let place = format!("pixel ({x}, {y}) of {name}");
            let center = [f64::from(x) + 0.5, f64::from(y) + 0.5];
            let [fragments, kept] = [
                value(&self.ewa, "attributes.count", i)[0] as usize,
                value(&self.single, "sums.count", i)[0] as usize,
            ];
            // Nothing else than the order of the sums is different where no fragment was dropped.
            if fragments == kept && fragments > 0 {
                self.check_same(i, fragments, &mut census, &place);
            }
            // The nearest of all is never dropped.
            for plane in ["id", "Z"] {
                let [a, b] = [&self.ewa, &self.single].map(|f| value(f, plane, i));
                assert_eq!(a, b, "{place}: {plane}");
            }
            let all = self.oracle.fragments(center);
            if all.iter().any(|s| self.oracle.unsure(s)) || self.oracle.grazes(&all) {
                census.doubtful += 1;
                continue;
            }
            let inside: Vec<_> = all.into_iter().filter(|s| s.1.value.q <= limit).collect();
            let seen = self.oracle.seen(&inside);
            assert_eq!(seen.len(), fragments, "{place}: fragments");
            census.covered += usize::from(!seen.is_empty());
            census.most = census.most.max(seen.len());
            assert_eq!(self.check_nearer_alone(i, &inside, &place), kept, "{place}: groups");
            match self.conflict(&seen) {
                None if seen.is_empty() => {}
                None => {
                    assert_eq!(fragments, kept, "{place}: the identity");
                    census.same += 1;
                }
                Some(pair) if self.beside(center, pair) => census.footprint += 1,
                Some(pair) if self.steep(center, pair) => census.steep += 1,
                Some(_) => census.sheets += 1,
            }
        }
        census
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn the_single_pass_is_the_two_pass_method_where_groups_have_one_fragment(
        seed in any::<u32>(),
        [sheets, orthographic, cull] in any::<[bool; 3]>(),
        epsilon in prop_oneof![Just(0.0_f32), 0.0_f32..0.5, 0.5_f32..2.0, Just(f32::INFINITY)],
    ) {
        let scene = lit(cloud(seed.into(), sheets));
        let camera = straight(orthographic, [40, 31]);
        let epsilon = Epsilon::World(epsilon);
        let splats = ewa::Settings { kernel: PAPER, epsilon, cull };
        let census = Pair::new(&scene, &camera, splats).census(&format!("seed {seed}"));
        prop_assert!(census.covered > 100 && census.same > 0, "{:?}", census);
        prop_assert!(census.doubtful < 40, "{:?}", census);
    }
}

/// A surface that is drawn whole, and what is to be found.
struct Whole {
    shape: Shape,
    epsilon: Epsilon,
    kernel: Kernel,
    orthographic: bool,
    cull: bool,
    /// The part of the covered pixels where the condition, and so the identity, holds.
    exact: std::ops::RangeInclusive<f64>,
    /// The causes at the others, all of them.
    causes: &'static str,
}

#[test]
fn whole_surfaces_are_exact_but_for_the_causes_that_are_listed() {
    let skirt = Kernel { low_pass: 0.25, ..PAPER };
    let (near, deep) = (Epsilon::MedianRadii(1.0), Epsilon::World(0.75));
    let stairs = Shape::Staircase { step: 0.25, thickness: 0.031_25 };
    let sheets = Shape::Sheets { gap: 0.5 };
    let rows = [
        (Shape::Sphere, near, PAPER, false, true, 1.0..=1.0, ""),
        (Shape::Sphere, near, PAPER, false, false, 0.99..=0.999, "steep"),
        (Shape::Sphere, near, skirt, false, true, 0.98..=0.999, "footprint"),
        (Shape::Sphere, near, Kernel::DEFAULT, false, true, 0.9..=0.95, "footprint"),
        (Shape::Torus, near, PAPER, false, true, 0.99..=0.9999, "steep"),
        (Shape::Torus, near, PAPER, true, false, 0.97..=0.999, "steep"),
        (Shape::Torus, near, Kernel::DEFAULT, false, true, 0.9..=0.97, "footprint steep"),
        (Shape::Cluster, near, PAPER, false, true, 0.99..=0.999, "steep sheets"),
        (Shape::Cluster, near, PAPER, true, true, 0.99..=0.999, "sheets"),
        (stairs, near, PAPER, false, true, 1.0..=1.0, ""),
        (stairs, near, PAPER, false, false, 0.99..=0.999, "sheets"),
        (sheets, near, PAPER, false, true, 1.0..=1.0, ""),
        (sheets, near, Kernel::DEFAULT, false, true, 0.9..=0.95, "footprint"),
        (sheets, deep, PAPER, false, true, 0.5..=0.6, "sheets"),
    ];
    for (shape, epsilon, kernel, orthographic, cull, exact, causes) in rows {
        let whole = Whole { shape, epsilon, kernel, orthographic, cull, exact, causes };
        whole.check();
    }
}

impl Whole {
    fn check(&self) {
        let Self { shape, epsilon, kernel, orthographic, cull, .. } = *self;
        let scene = lit(shape.surfels(600, 1).expect("few surfels").into_cloud());
        let camera = framed(&shape, orthographic, [64, 48]);
        let splats = ewa::Settings { kernel, epsilon, cull };
        let name = format!("{shape:?} {epsilon:?} {kernel:?} ortho {orthographic} cull {cull}");
        let census = Pair::new(&scene, &camera, splats).census(&name);
        let part = census.same as f64 / census.covered as f64;
        println!("{part:.4} {name}: {census:?}");
        assert!(self.exact.contains(&part), "{part} is not in {:?}: {name}", self.exact);
        assert_eq!(census.causes(), self.causes, "{census:?}: {name}");
        assert!(census.covered > 600 && census.doubtful <= 4, "{census:?}: {name}");
        assert!(census.worst > 0.25, "the bound is too loose by far: {census:?}");
    }
}

/// Two discs on the ground that touch, one behind the other: no ray meets both, but an outline that
/// is linearized at the centre of the nearer reaches over the other, and so does a filter's skirt.
#[test]
fn footprints_beside_their_discs_are_a_cause_where_discs_touch() {
    let pair = [-2.0, -4.0].map(|z| (Vec3::new(0.0, -1.0, z), Vec3::Y, 1.0));
    let scene = lit(Cloud { color: Some(vec![Vec3::X, Vec3::Z]), ..discs(pair) });
    let kernel = |outline, low_pass| Kernel { outline, cutoff: 2.0, low_pass };
    let rows = [
        (kernel(Outline::RayCast, 0.0), ""),
        (kernel(Outline::Perspective, 0.0), ""),
        (kernel(Outline::Affine, 0.0), "footprint"),
        (kernel(Outline::RayCast, 16.0), "footprint"),
        (kernel(Outline::Perspective, 1.0), "footprint"),
    ];
    for (kernel, causes) in rows {
        let splats = ewa::Settings { kernel, epsilon: Epsilon::World(1.0), cull: false };
        let pair = Pair::new(&scene, &straight(false, [40, 60]), splats);
        assert_eq!(pair.own, [0, 0], "they touch, so they share a group");
        let census = pair.census(&format!("{kernel:?}"));
        assert_eq!(census.causes(), causes, "{census:?} {kernel:?}");
        assert!(census.covered > 40 && census.same > 40, "{census:?} {kernel:?}");
    }
}
