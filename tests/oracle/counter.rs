//! A third number: f64 that counts its operations. Every formula of the crate runs on it.

use crate::oracle::ewa::cases::{self, Kind};
use crate::oracle::kit::case::Case;
use crate::oracle::kit::draw::Drawing;
use crate::oracle::kit::planes::{bits, digest};
use crate::oracle::kit::scene::{OUTLINES, groups};
use glam::Vec3;
use splatref::composite::{decide, sum};
use splatref::method::ewa::Settings;
use splatref::method::single_pass::{self, BinCount, DepthTest};
use splatref::number::{Exact, Real, Vector3};
use splatref::scene::Light;
use splatref::splat::Disc;
use splatref::splat::{Kernel, Outline, Projector, Shared, View, project};
use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};

/// What is counted.
#[derive(Clone, Copy)]
enum Op {
    Add,
    Mul,
    Div,
    Sqrt,
    Exp,
    Pow,
    Compare,
}

static COUNTS: [AtomicU64; 7] = [const { AtomicU64::new(0) }; 7];
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

#[derive(Clone, Copy, Debug)]
struct Counted(f64);

fn tick(op: Op, value: f64) -> Counted {
    COUNTS[op as usize].fetch_add(1, Relaxed);
    Counted(value)
}

impl PartialEq for Counted {
    fn eq(&self, other: &Self) -> bool {
        tick(Op::Compare, self.0).0 == other.0
    }
}

impl PartialOrd for Counted {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        tick(Op::Compare, self.0).0.partial_cmp(&other.0)
    }
}

impl Add for Counted {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        tick(Op::Add, self.0 + other.0)
    }
}

impl Sub for Counted {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        tick(Op::Add, self.0 - other.0)
    }
}

impl Mul for Counted {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        tick(Op::Mul, self.0 * other.0)
    }
}

impl Div for Counted {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        tick(Op::Div, self.0 / other.0)
    }
}

impl Neg for Counted {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Real for Counted {
    type Truth = bool;
    type Pixel = u32;

    const ZERO: Self = Self(0.0);
    const ONE: Self = Self(1.0);
    const INFINITY: Self = Self(f64::INFINITY);

    fn from_f32(value: f32) -> Self {
        Self(value.into())
    }
    fn from_i64(value: i64) -> Self {
        Self(Real::from_i64(value))
    }
    fn to_f32(self) -> f32 {
        self.0 as f32
    }
    fn to_f64(self) -> f64 {
        self.0
    }
    fn to_pixel(self) -> u32 {
        Real::to_pixel(self.0)
    }
    fn floor(self) -> Self {
        Self(self.0.floor())
    }
    fn sqrt(self) -> Self {
        tick(Op::Sqrt, self.0.sqrt())
    }
    fn abs(self) -> Self {
        Self(self.0.abs())
    }
    fn exp(self) -> Self {
        tick(Op::Exp, Real::exp(self.0))
    }
    fn pow(self, exponent: Self) -> Self {
        tick(Op::Pow, Real::pow(self.0, exponent.0))
    }
    fn is_finite(self) -> bool {
        self.0.is_finite()
    }
    fn lt(self, other: Self) -> bool {
        self < other
    }
    fn le(self, other: Self) -> bool {
        self <= other
    }
    fn gt(self, other: Self) -> bool {
        self > other
    }
    fn ge(self, other: Self) -> bool {
        self >= other
    }
    fn select(truth: bool, yes: Self, no: Self) -> Self {
        if truth { yes } else { no }
    }
    fn at_least(self, low: Self) -> Self {
        if self < low { low } else { self }
    }
    fn at_most(self, high: Self) -> Self {
        if self > high { high } else { self }
    }
    fn clamped(self, low: Self, high: Self) -> Self {
        self.at_least(low).at_most(high)
    }
}

impl Exact for Counted {
    fn to_i64(self) -> i64 {
        Exact::to_i64(self.0)
    }
    fn atan2(self, x: Self) -> Self {
        Self(Exact::atan2(self.0, x.0))
    }
    fn ulps_to(self, other: Self) -> f32 {
        self.0.ulps_to(other.0)
    }
}

/// Additions, multiplications, divisions, roots, exponentials, powers, comparisons of a job.
fn count<T>(job: impl FnOnce() -> T) -> (T, [u64; 7]) {
    COUNTS.iter().for_each(|c| c.store(0, Relaxed));
    let value = job();
    (value, std::array::from_fn(|i| COUNTS[i].load(Relaxed)))
}

fn scene(outline: Outline, orthographic: bool) -> Case<Settings> {
    let settings =
        Settings { kernel: Kernel { outline, ..Kernel::DEFAULT }, ..Settings::default() };
    let mut case = cases::case(Kind::Shape(0), 3, settings, orthographic);
    let color = Vec3::ONE;
    case.scene.lights = vec![
        Light::Headlight { towards: Vec3::new(0.25, 0.5, 1.0), color },
        Light::Point { position: Vec3::new(2.0, 3.0, 4.0), color },
    ];
    case
}

#[test]
fn the_fragment_takes_the_operations_that_the_specification_lists() {
    let _alone = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    for outline in OUTLINES {
        for orthographic in [false, true] {
            let case = scene(outline, orthographic);
            let kernel = &case.settings.kernel;
            let view = View::<Counted>::new(&case.camera);
            let shared = Shared::new(&view, kernel);
            let disc = Disc {
                position: Vector3::from_glam(Vec3::new(0.25, 0.5, 0.25)),
                normal: Vector3::from_glam(Vec3::Z),
                radius: Counted(0.25),
                tangents: None,
            };
            let ((splat, _), setup) =
                count(|| project(&Projector::new(view, kernel, false), &disc, 0));
            assert!(setup[Op::Mul as usize] > 30, "projection: {setup:?}");
            let (dx, dy) = (Counted(0.25), Counted(0.5));
            let ((q, _), ops) = count(|| splat.footprint.fragment(&shared, dx, dy));
            // u, v, f, w: 7 products and 4 sums. Casting: w w, dx dx, dy dy, a sum, two quotients.
            let expected = match (outline, orthographic) {
                (Outline::RayCast, false) => [5, 10, 2],
                (Outline::RayCast, true) => [5, 9, 1],
                _ => [4, 7, 0],
            };
            assert_eq!(ops[..3], expected, "{outline:?} orthographic {orthographic}");
            assert_eq!(
                ops[Op::Sqrt as usize] + ops[Op::Exp as usize],
                0,
                "no root, no exponential"
            );
            let (_, ops) = count(|| splat.footprint.weight(q));
            assert_eq!(ops[..6], [0, 2, 0, 0, 1, 0], "weight");
        }
    }
    let (three, n) = ([Counted(0.25); 3], Counted(0.5));
    assert_eq!(count(|| sum::add(three, n, three)).1[..3], [3, 3, 0], "weighted sum");
    // The sums are those with 0 that keep -0 out of the planes.
    assert_eq!(count(|| sum::average(three, n)).1[..3], [3, 0, 3], "average");
    let (_, ops) = count(|| decide::visible(n, decide::limit(n, n)));
    assert_eq!(ops, [1, 0, 0, 0, 0, 0, 1], "epsilon-z test");
}

#[test]
fn every_formula_runs_on_a_third_number_with_the_bits_of_the_second() {
    let _alone = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    for outline in OUTLINES {
        let case = scene(outline, false);
        let (counted, ops) = count(|| case.drawing().frame::<Counted>());
        assert!(ops.iter().all(|n| *n > 100), "{outline:?}: {ops:?}");
        let wide = case.drawing().frame::<f64>();
        assert_eq!(counted.planes.len(), wide.planes.len());
        for (a, b) in counted.planes.iter().zip(&wide.planes) {
            let same = a.name == b.name && bits(&a.samples) == bits(&b.samples);
            assert!(same, "{outline:?}: plane '{}'", a.name);
        }
    }
}

#[test]
fn the_single_pass_runs_on_a_third_number_with_the_bits_of_the_second() {
    let _alone = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    let case = scene(Outline::RayCast, false);
    let depth = DepthTest::Voronoi(BinCount::Count(100));
    let settings = single_pass::Settings { splats: case.settings, depth };
    let own = (0..case.scene.surfels.len()).map(|i| (i % 5) as u8).collect();
    let groups = groups(own, 5);
    let drawing = Drawing::new(&case.scene, &case.camera, settings).grouped(&groups);
    let (counted, ops) = count(|| drawing.frame::<Counted>());
    assert!(ops.iter().all(|n| *n > 100), "{ops:?}");
    assert!(digest(&counted) == digest(&drawing.frame::<f64>()));
}
