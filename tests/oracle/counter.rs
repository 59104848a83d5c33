//! Every formula of the crate runs on a third number, which counts its operations.

use crate::oracle::ewa::cases::{self, Kind};
use crate::oracle::kit::case::Case;
use crate::oracle::kit::draw::Drawing;
use crate::oracle::kit::planes::{bits, digest};
use crate::oracle::kit::scene::{OUTLINES, groups};
use glam::Vec3;
use splatref::composite::{decide, sum};
use splatref::method::ewa::Settings;
use splatref::method::single_pass::{self, BinCount, DepthTest};
use splatref::number::Vector3;
use splatref::scene::Light;
use splatref::splat::Disc;
use splatref::splat::{Kernel, Outline, Projector, Shared, View, project};
use std::sync::{Mutex, PoisonError};

#[path = "../../benches/limits/counted.rs"]
mod counted;

use counted::{Counted, Op};

static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

/// Additions, multiplications, divisions, roots, exponentials, powers, comparisons of a job.
fn count<T>(job: impl FnOnce() -> T) -> (T, [u64; 7]) {
    let (result, all) = counted::count(job);
    (result, std::array::from_fn(|i| all[i]))
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
