//! Laws of Algorithm 1 as a whole: what groups may and may not change in a picture.

use crate::oracle::bits::case;
use crate::oracle::composite::groups::unit;
use crate::oracle::ewa::cases::{self, Kind};
use crate::oracle::kit::case::Case;
use crate::oracle::kit::dice::Dice;
use crate::oracle::kit::draw::Drawing;
use crate::oracle::kit::planes::{at, bits, digest, index, pixels, unclean};
use crate::oracle::kit::scene::{discs, groups, straight};
use crate::oracle::single_pass::identity::lit;
use glam::Vec3;
use proptest::prelude::*;
use proptest::test_runner::TestCaseResult;
use splatref::composite::decide;
use splatref::composite::groups::{WeightedFragment, compose};
use splatref::frame::{Exec, Frame, NO_ID};
use splatref::method::ewa;
use splatref::method::single_pass::{BinCount, DepthTest, Settings};
use splatref::number::Exact;
use splatref::scene::Groups;
use splatref::scene::{Cloud, Scene};
use splatref::splat::Epsilon;
use splatref::splat::{Kernel, Outline};

/// A case by lot; which surfel is in which group is another matter.
type Splats = Case<ewa::Settings>;

const PLAIN: DepthTest = DepthTest::Plain;

fn drawing<'a>(case: &'a Splats, groups: &'a Groups, depth: DepthTest) -> Drawing<'a> {
    let settings = Settings { splats: case.settings, depth };
    Drawing::new(&case.scene, &case.camera, settings).grouped(groups)
}

fn render<R: Exact>(case: &Splats, groups: &Groups, depth: DepthTest) -> Frame<R> {
    drawing(case, groups, depth).frame()
}

/// The number at a pixel, 0 of a plane that is not there.
fn value<R: Exact>(frame: &Frame<R>, name: &str, i: usize) -> [f64; 3] {
    frame.plane(name).map_or([0.0; 3], |plane| at(plane, i))
}

/// A group for each surfel by lot.
fn lot(case: &Splats, seed: u64, count: usize) -> Vec<u8> {
    let mut dice = Dice(seed ^ 0x0123_4567_89AB_CDEF);
    (0..case.scene.surfels.len()).map(|_| dice.below(count) as u8).collect()
}

/// Any case with a depth test that it can have.
fn depth(case: &Splats, number: usize) -> DepthTest {
    let camera = &case.camera;
    let epsilon = case.settings.epsilon.resolve(&case.scene.surfels);
    match number {
        0 => PLAIN,
        1 if BinCount::Epsilon.resolve(&case.scene.surfels, camera, epsilon).is_ok() => {
            DepthTest::Voronoi(BinCount::Epsilon)
        }
        2 => DepthTest::Voronoi(BinCount::Count(1)),
        _ => DepthTest::Voronoi(BinCount::Count(1000)),
    }
}

/// Sums of the same m terms in two orders, see [`crate::oracle::composite::groups`].
fn same_but_order<R: Exact>(a: &Frame<R>, b: &Frame<R>, i: usize, place: &str) -> TestCaseResult {
    let count = value(a, "sums.count", i)[0];
    prop_assert_eq!(count, value(b, "sums.count", i)[0], "{}", place);
    let part = 2.0 * (count - 1.0).max(0.0) * unit::<R>() * 1.001;
    let weight = value(a, "sums.weight", i)[0];
    for (plane, of) in [("sums.weight", 0.0), ("sums", 0.0), ("sums.normal", weight)] {
        for (a, b) in value(a, plane, i).into_iter().zip(value(b, plane, i)) {
            let largest = a.abs().max(b.abs()).max(of);
            prop_assert!((a - b).abs() <= part * largest, "{}: {} {} {}", place, plane, a, b);
        }
    }
    Ok(())
}

/// A group for each surfel, in their order: nothing is dropped and the sums have EWA's order.
fn apart_is_ewa<R: Exact>(case: &Splats) -> TestCaseResult {
    let n = case.scene.surfels.len();
    let single = render::<R>(case, &groups((0..n as u8).collect(), n), PLAIN);
    let ewa = case.drawing().frame::<R>();
    let stages = [
        ("sums", "attributes"),
        ("sums.weight", "attributes.weight"),
        ("sums.normal", "attributes.normal"),
        ("sums.count", "attributes.count"),
    ];
    let last = ["", "A", "Z", "normal", "weight", "id", "resolved"].map(|name| (name, name));
    for (name, other) in stages.into_iter().chain(last) {
        let planes = (single.plane(name), ewa.plane(other));
        let same = match planes {
            (Some(a), Some(b)) => bits(a) == bits(b),
            (a, b) => a.is_none() && b.is_none(),
        };
        prop_assert!(same, "plane '{}' of {}", name, case.name);
    }
    Ok(())
}

/// Groups under other names: the same images under other names, and the sums in another order.
fn relabelled<R: Exact>(
    case: &Splats,
    own: &[u8],
    names: &[usize],
    test: DepthTest,
) -> TestCaseResult {
    let renamed = own.iter().map(|group| names[usize::from(*group)] as u8).collect();
    let first = render::<R>(case, &groups(own.to_vec(), names.len()), test);
    let second = render::<R>(case, &groups(renamed, names.len()), test);
    for (group, name) in names.iter().enumerate() {
        for end in [".Z", ".id", ".weight", ".normal", "", ".voronoi"] {
            let a = first.plane(&format!("group{group:02}{end}"));
            let b = second.plane(&format!("group{name:02}{end}"));
            prop_assert!(a.map(bits) == b.map(bits), "group {}{} of {}", group, end, case.name);
        }
    }
    for name in ["Z", "A", "id", "sums.count"] {
        let [a, b] = [&first, &second].map(|frame| frame.plane(name).map(bits));
        prop_assert!(a.is_some() && a == b, "plane '{}' of {}", name, case.name);
    }
    let epsilon = R::from_f32(case.settings.epsilon.resolve(&case.scene.surfels));
    for i in pixels(&first) {
        same_but_order(&first, &second, i, &case.name)?;
        // Composed in the order of the first names, the second images give the first sums.
        let number = |group: usize, end: &str| value(&second, &format!("group{group:02}{end}"), i);
        let wide = names.iter().map(|name| WeightedFragment {
            depth: number(*name, ".Z")[0],
            weight: number(*name, ".weight")[0],
            normal: number(*name, ".normal"),
            color: number(*name, ""),
            opacity: 0.0,
        });
        // Through f32 if R is f32: the numbers fit, the sums must round as R does.
        let samples: Vec<WeightedFragment<R>> = wide.map(narrowed).collect();
        let (sums, _) = compose(&samples, epsilon);
        let found = [[sums.weight; 3], sums.normal, sums.color].map(|v| v.map(R::to_f64));
        let expected = ["sums.weight", "sums.normal", "sums"].map(|name| value(&first, name, i));
        prop_assert_eq!(found, expected, "relabelled back, {}", case.name);
    }
    Ok(())
}

/// A number of R that f64 holds; in parts of f32, small ones enlarged so that no part underflows.
fn exactly<R: Exact>(value: f64) -> R {
    if !value.is_finite() {
        return R::from_f32(value as f32);
    }
    let scale = if value.abs() < 1.0 { 60 } else { 0 };
    let value = value * 2.0_f64.powi(scale);
    let high = value as f32;
    let middle = (value - f64::from(high)) as f32;
    let low = (value - f64::from(high) - f64::from(middle)) as f32;
    (R::from_f32(high) + (R::from_f32(middle) + R::from_f32(low)))
        * R::from_f32(2.0_f32.powi(-scale))
}

fn narrowed<R: Exact>(s: WeightedFragment<f64>) -> WeightedFragment<R> {
    WeightedFragment {
        depth: exactly(s.depth),
        weight: exactly(s.weight),
        normal: s.normal.map(exactly),
        color: s.color.map(exactly),
        opacity: exactly(s.opacity),
    }
}

/// The surfels that a pixel shows.
fn shown<R: Exact>(frame: &Frame<R>, i: usize, count: usize, band: R) -> Vec<u32> {
    let nearest = value(frame, "Z", i)[0];
    let groups = (0..count).filter_map(|group| {
        let t = value(frame, &format!("group{group:02}.Z"), i)[0];
        let visible = decide::visible(exactly::<R>(t), decide::limit(exactly(nearest), band));
        let id = index(frame, &format!("group{group:02}.id"), i);
        (visible && id != NO_ID).then_some(id)
    });
    groups.collect()
}

/// Splitting a group, under the plain depth test: the nearest depth of all stays; every fragment
/// that was shown is the nearest of its part too, and so is still shown; fragments may appear that
/// were behind another of their group within epsilon, and where none does, nothing changes but the
/// order of the sums.
fn splitting_shows_more<R: Exact>(case: &Splats, own: &[u8], finer: &[u8]) -> TestCaseResult {
    let whole = render::<R>(case, &groups(own.to_vec(), 4), PLAIN);
    let split = render::<R>(case, &groups(finer.to_vec(), 32), PLAIN);
    for name in ["Z", "A", "id"] {
        let [a, b] = [&whole, &split].map(|frame| frame.plane(name).map(bits));
        prop_assert!(a.is_some() && a == b, "plane '{}' of {}", name, case.name);
    }
    let ewa = case.drawing().frame::<R>();
    let band = R::from_f32(case.settings.epsilon.resolve(&case.scene.surfels));
    for i in pixels(&whole) {
        let [few, many] = [&whole, &split].map(|frame| value(frame, "sums.count", i)[0]);
        let all = value(&ewa, "attributes.count", i)[0];
        prop_assert!(few <= many && many <= all, "{} {} {} in {}", few, many, all, case.name);
        let (before, after) = (shown(&whole, i, 4, band), shown(&split, i, 32, band));
        prop_assert_eq!(before.len() as f64, few);
        prop_assert!(before.iter().all(|id| after.contains(id)), "{:?} {:?}", before, after);
        if few == many {
            same_but_order(&whole, &split, i, &case.name)?;
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn a_group_for_each_surfel_is_the_two_pass_method_to_the_bit(
        case in case().prop_filter("at most 64 surfels", |case| case.scene.surfels.len() <= 64),
    ) {
        apart_is_ewa::<f32>(&case)?;
        apart_is_ewa::<f64>(&case)?;
    }

    #[test]
    fn names_of_groups_change_the_order_of_the_sums_alone(
        case in case(), seed: u64, number in 0..4_usize,
        names in Just((0..5).collect::<Vec<usize>>()).prop_shuffle(),
    ) {
        let (own, test) = (lot(&case, seed, 5), depth(&case, number));
        relabelled::<f32>(&case, &own, &names, test)?;
        relabelled::<f64>(&case, &own, &names, test)?;
    }

    #[test]
    fn splitting_a_group_never_hides_a_fragment(case in case(), seed: u64) {
        let (own, parts) = (lot(&case, seed, 4), lot(&case, seed / 3 + 1, 8));
        let finer: Vec<u8> = own.iter().zip(&parts).map(|(group, part)| group * 8 + part).collect();
        splitting_shows_more::<f32>(&case, &own, &finer)?;
        splitting_shows_more::<f64>(&case, &own, &finer)?;
    }

    #[test]
    fn threads_tiles_and_paths_leave_no_trace(
        case in case(), seed: u64, number in 0..4_usize, count in 1..=64_usize, tile in 0..4_usize,
    ) {
        let (own, test) = (groups(lot(&case, seed, count), count), depth(&case, number));
        let exec = Exec::new(3, 8 << tile).expect("a tile size");
        let plain = render::<f32>(&case, &own, test);
        let other = drawing(&case, &own, test).on(&exec);
        prop_assert!(digest(&plain) == digest(&other.frame::<f32>()), "{}", case.name);
        prop_assert_eq!(unclean(&plain), None, "{}", case.name);
        for plane in &other.fast().frame.planes {
            let same = plain.plane(&plane.name).expect("a shared plane");
            prop_assert!(bits(same) == bits(&plane.samples), "'{}' of {}", plane.name, case.name);
        }
    }
}

/// Discs that face an orthographic camera, one pixel a unit of the picture.
fn facing(all: &[(f32, f32)], epsilon: f32) -> (Scene, ewa::Settings) {
    let colors = [Vec3::X, Vec3::Y, Vec3::Z].into_iter().cycle().take(all.len()).collect();
    let cloud = discs(all.iter().map(|(x, t)| (Vec3::new(*x, 0.0, -t), Vec3::Z, 2.0)));
    let scene = lit(Cloud { color: Some(colors), ..cloud });
    let kernel = Kernel { outline: Outline::RayCast, cutoff: 2.0, low_pass: 0.0 };
    (scene, ewa::Settings { kernel, epsilon: Epsilon::World(epsilon), cull: true })
}

/// The pixel in the middle of a picture of discs in groups: the frame and the pixel's index.
fn middle(discs: &[(f32, f32)], epsilon: f32, own: &[u8], depth: DepthTest) -> (Frame<f64>, usize) {
    let (scene, splats) = facing(discs, epsilon);
    let mut camera = straight(true, [9, 9]);
    (camera.fx, camera.fy, camera.cx, camera.cy) = (2.0, 2.0, 4.5, 4.5);
    let (settings, groups) = (Settings { splats, depth }, groups(own.to_vec(), 3));
    let frame = Drawing::new(&scene, &camera, settings).grouped(&groups).frame();
    (frame, 4 * 9 + 4)
}

/// The counterexample to "splitting a group never changes the result": the depth test of the group
/// hid a fragment that is within epsilon.
#[test]
fn splitting_a_group_can_show_what_its_depth_test_hid() {
    let discs = [(0.0, 4.0), (0.0, 4.5)];
    let (whole, i) = middle(&discs, 1.0, &[0, 0], PLAIN);
    assert_eq!(
        (value(&whole, "sums.count", i)[0], value(&whole, "resolved", i)),
        (1.0, [1.0, 0.0, 0.0])
    );
    let (split, i) = middle(&discs, 1.0, &[0, 1], PLAIN);
    assert_eq!(
        (value(&split, "sums.count", i)[0], value(&split, "resolved", i)),
        (2.0, [0.5, 0.5, 0.0])
    );
    // Farther than epsilon the split changes nothing.
    let (split, i) = middle(&[(0.0, 4.0), (0.0, 5.5)], 1.0, &[0, 1], PLAIN);
    assert_eq!(
        (value(&split, "sums.count", i)[0], value(&split, "resolved", i)),
        (1.0, [1.0, 0.0, 0.0])
    );
}

/// Under the Voronoi depth test a group need not keep its nearest fragment, so that splitting it
/// moves even the nearest depth, and can hide what was shown.
#[test]
fn splitting_a_voronoi_group_can_hide_a_fragment() {
    let voronoi = DepthTest::Voronoi(BinCount::Count(1));
    let discs = [(1.0, 4.0), (0.0, 4.75), (0.0, 5.5)];
    let (whole, i) = middle(&discs, 1.0, &[0, 0, 1], voronoi);
    let state = |frame: &Frame<f64>, i| (value(frame, "Z", i)[0], value(frame, "resolved", i));
    assert_eq!(value(&whole, "group00.id", i)[0], 1.0, "the fragment at its own centre");
    assert_eq!(state(&whole, i), (4.75, [0.0, 0.5, 0.5]));
    let (split, i) = middle(&discs, 1.0, &[0, 2, 1], voronoi);
    assert_eq!(value(&split, "Z", i)[0], 4.0);
    assert_eq!(value(&split, "resolved", i)[2], 0.0, "the farthest is beyond epsilon now");
    let (plain, i) = middle(&discs, 1.0, &[0, 0, 1], PLAIN);
    assert_eq!(value(&plain, "group00.id", i)[0], 0.0, "the plain depth test keeps the nearest");
}

#[test]
fn ties_go_to_the_lower_surfel() {
    for depth in [PLAIN, DepthTest::Voronoi(BinCount::Count(8))] {
        let (frame, i) = middle(&[(0.5, 4.0); 3], 1.0, &[1, 1, 0], depth);
        assert_eq!(value(&frame, "group01.id", i)[0], 0.0, "in a group: {depth:?}");
        assert_eq!(value(&frame, "group00.id", i)[0], 2.0);
        assert_eq!(value(&frame, "id", i)[0], 0.0, "among the groups: {depth:?}");
        assert_eq!(index(&frame, "group02.id", i), NO_ID);
    }
    // At the rim of both discs the ratio ends at 255/256, although the second is nearer to its
    // centre.
    let rim = [(-1.998, 4.0), (1.996, 4.0)];
    let (frame, i) = middle(&rim, 1.0, &[0, 0], DepthTest::Voronoi(BinCount::Count(1)));
    assert_eq!(value(&frame, "group00.voronoi", i)[0].fract(), 255.0 / 256.0);
    assert_eq!(value(&frame, "group00.id", i)[0], 0.0, "a tie that clamping makes");
}

/// What an extension adds is for transparency.
#[test]
fn extensions_of_groups_leave_the_single_pass_alone() {
    let case = cases::case(Kind::Discs, 5, ewa::Settings::default(), false);
    let own = lot(&case, 1, 3);
    let added = (0..40).map(|surfel| (surfel, (surfel % 3) as u8)).collect();
    let extended = Groups::new(own.clone(), added, vec![1.5, 2.0, 1.0]).expect("good groups");
    let [plain, more] =
        [&groups(own, 3), &extended].map(|groups| digest(&render::<f32>(&case, groups, PLAIN)));
    assert!(plain == more);
}
