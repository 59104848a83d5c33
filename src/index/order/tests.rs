use super::*;
use crate::index::point_tree::given::points;
use crate::number::random::unit;
use crate::scene::{Cloud, Lens, Pose};
use glam::{DVec3, Vec3};
use proptest::prelude::*;

fn surfels(position: &[Vec3]) -> Surfels {
    let n = position.len();
    let (normal, radius) = (Some(vec![Vec3::Z; n]), Some(vec![1.0; n]));
    let cloud = Cloud { position: position.to_vec(), normal, radius, ..Cloud::default() };
    Surfels::new(cloud).unwrap().0
}

fn camera(eye: DVec3, looking: DVec3, lens: Lens) -> Camera {
    let up = if looking.x == 0.0 && looking.z == 0.0 { DVec3::X } else { DVec3::Y };
    Camera::new(4, 4, Pose { eye, target: eye + looking, up }, lens).unwrap()
}

fn perspective(eye: DVec3) -> Camera {
    camera(eye, -DVec3::Z, Lens::Focal(4.0))
}

fn walk(points: &[Vec3], camera: &Camera) -> Vec<u32> {
    BackToFront::new(&surfels(points), &Exec::sequential()).walk(camera)
}

/// The position of each point in an order, or none if the order is no permutation.
fn ranks(order: &[u32], count: usize) -> Option<Vec<usize>> {
    let mut ranks = vec![usize::MAX; count];
    for (rank, &id) in order.iter().enumerate() {
        if std::mem::replace(ranks.get_mut(id as usize)?, rank) != usize::MAX {
            return None;
        }
    }
    (order.len() == count).then_some(ranks)
}

/// Checks an order against the module page, node by node, without walking anything. `high_is_near`
/// gets (axis, plane).
fn check(
    points: &[Vec3],
    mut node: Vec<usize>,
    ranks: &[usize],
    high_is_near: &dyn Fn(usize, f64) -> bool,
) -> std::result::Result<(), TestCaseError> {
    if node.len() < 2 {
        return Ok(());
    }
    let at = |i: usize, axis: usize| f64::from(points[i][axis]);
    let extent = |axis: usize| {
        let mut all: Vec<f64> = node.iter().map(|&i| at(i, axis)).collect();
        all.sort_by(f64::total_cmp);
        all[all.len() - 1] - all[0]
    };
    let extents = [extent(0), extent(1), extent(2)];
    let is_widest = |&axis: &usize| extents.iter().all(|&other| other <= extents[axis]);
    let axis = (0..3).find(is_widest).unwrap();
    node.sort_by(|&a, &b| (at(a, axis), a).partial_cmp(&(at(b, axis), b)).unwrap());
    let high = node.split_off(node.len() / 2 + 1);
    let own = node.pop().unwrap();
    let plane = at(own, axis);
    let high_near = high_is_near(axis, plane);
    let (far, near) = if high_near { (&node, &high) } else { (&high, &node) };
    prop_assert!(far.iter().all(|&i| ranks[i] < ranks[own]), "the far half is first");
    prop_assert!(near.iter().all(|&i| ranks[own] < ranks[i]), "the near half is last");
    // The law, which uses centres and a plane but no halves.
    let all = || node.iter().chain(&high);
    let low_last = all().filter(|&&i| at(i, axis) < plane).map(|&i| ranks[i]).max();
    let low_first = all().filter(|&&i| at(i, axis) < plane).map(|&i| ranks[i]).min();
    let high_last = all().filter(|&&i| at(i, axis) > plane).map(|&i| ranks[i]).max();
    let high_first = all().filter(|&&i| at(i, axis) > plane).map(|&i| ranks[i]).min();
    if let (Some(low_last), Some(low_first), Some(high_last), Some(high_first)) =
        (low_last, low_first, high_last, high_first)
    {
        let ordered = if high_near { low_last < high_first } else { high_last < low_first };
        prop_assert!(ordered, "what is beyond the plane of {own} comes first");
    }
    check(points, node, ranks, high_is_near)?;
    check(points, high, ranks, high_is_near)
}

fn eye() -> impl Strategy<Value = DVec3> {
    // Eyes in the planes of many points, and anywhere.
    let coordinate = prop_oneof![(-4_i8..=4).prop_map(f64::from), -2.0..2.0, Just(-0.0)];
    [coordinate.clone(), coordinate.clone(), coordinate].prop_map(DVec3::from_array)
}

fn direction() -> impl Strategy<Value = DVec3> {
    let coordinate = (-2_i8..=2).prop_map(f64::from);
    let direction =
        [coordinate.clone(), coordinate.clone(), coordinate].prop_map(DVec3::from_array);
    direction.prop_filter("no direction", |d| d.length_squared() > 0.0)
}

proptest! {
    #[test]
    fn every_plane_has_its_far_half_first(points in points(), eye in eye(), looking in direction()) {
        let all = || (0..points.len()).collect::<Vec<_>>();
        let tree = BackToFront::new(&surfels(&points), &Exec::sequential());

        let view = camera(eye, looking, Lens::Focal(4.0));
        let order = ranks(&tree.walk(&view), points.len());
        prop_assert!(order.is_some(), "each once");
        let eye = view.eye();
        check(&points, all(), &order.unwrap(), &|axis, plane| plane < eye[axis])?;

        let view = camera(eye, looking, Lens::Orthographic(4.0));
        let order = ranks(&tree.walk(&view), points.len());
        prop_assert!(order.is_some(), "each once");
        let forward = view.view_from_world.inverse().transform_vector3(-Vec3::Z);
        let row = view.view_from_world.row(2);
        for axis in 0..3 {
            prop_assert!((forward[axis] + row[axis]).abs() < 1e-6, "the row looks back");
        }
        check(&points, all(), &order.unwrap(), &|axis, _| row[axis] > 0.0)?;
    }

    /// Uses no tree: whatever axis-aligned planes are used, a point may come before another only if
    /// along some axis the eye is not strictly beyond it, as seen from the other point.
    #[test]
    fn no_point_is_drawn_before_one_that_it_could_hide(
        seed in any::<u64>(),
        n in 2_usize..60,
        eye in eye(),
    ) {
        let at = |i: usize, axis: usize| unit(seed, (3 * i + axis) as u64) * 4.0 - 2.0;
        let points: Vec<_> = (0..n).map(|i| Vec3::new(at(i, 0), at(i, 1), at(i, 2))).collect();
        let order = walk(&points, &perspective(eye));
        for (i, &a) in order.iter().enumerate() {
            for &b in &order[i + 1..] {
                let (a, b) = (points[a as usize].as_dvec3(), points[b as usize].as_dvec3());
                let separated = |axis: usize| {
                    a[axis] < b[axis] && eye[axis] > a[axis] - 1e-6
                        || a[axis] > b[axis] && eye[axis] < a[axis] + 1e-6
                        || a[axis] == b[axis]
                };
                prop_assert!((0..3).any(separated), "{a} before {b} from {eye}");
            }
        }
    }

    #[test]
    fn points_on_a_line_through_the_eye_are_in_the_order_of_depth(
        steps in prop::collection::btree_set(1_u16..2000, 1..100),
        along in direction(),
        eye in [-8_i8..=8, -8_i8..=8, -8_i8..=8],
        order in any::<u64>(),
    ) {
        let eye = DVec3::from_array(eye.map(f64::from));
        let mut steps: Vec<_> = steps.into_iter().collect();
        steps.sort_by_key(|&step| crate::number::random::bits(order, u64::from(step)));
        let points: Vec<_> = steps.iter().map(|&t| (eye + f64::from(t) * along).as_vec3()).collect();
        let tree = BackToFront::new(&surfels(&points), &Exec::sequential());
        // From the one end and from the other; the far end is at 2000.
        let there = tree.walk(&camera(eye, along, Lens::Focal(4.0)));
        let there: Vec<_> = there.iter().map(|&i| steps[i as usize]).collect();
        prop_assert!(there.is_sorted_by(|a, b| a > b), "{there:?}");
        let back = tree.walk(&camera(eye + 2000.0 * along, -along, Lens::Focal(4.0)));
        let back: Vec<_> = back.iter().map(|&i| steps[i as usize]).collect();
        prop_assert!(back.is_sorted_by(|a, b| a < b), "{back:?}");
        let parallel = tree.walk(&camera(eye, along, Lens::Orthographic(4.0)));
        let parallel: Vec<_> = parallel.iter().map(|&i| steps[i as usize]).collect();
        prop_assert_eq!(parallel, there);
    }

    #[test]
    fn an_orthographic_camera_is_an_eye_far_away(points in points(), looking in direction()) {
        let mut points = points;
        points.retain(|p| p.abs().max_element() < 1e6);
        points.push(Vec3::ZERO);
        // A component of 0 has its own tie rule.
        let looking = looking.map(|c| if c == 0.0 { 1.0 } else { c });
        let far = -1e9 * looking;
        prop_assert_eq!(
            walk(&points, &camera(DVec3::ZERO, looking, Lens::Orthographic(4.0))),
            walk(&points, &camera(far, 1e6 * looking, Lens::Focal(4.0)))
        );
    }
}

#[test]
fn one_surfel_is_all() {
    assert_eq!(walk(&[Vec3::ONE], &perspective(DVec3::Z)), [0]);
}

#[test]
fn coincident_surfels_are_in_the_order_of_their_indices_or_its_reverse() {
    let points = vec![Vec3::new(1.0, -0.0, 3.0); 100];
    let ascending: Vec<u32> = (0..100).collect();
    let descending: Vec<u32> = (0..100).rev().collect();
    let from = |x: f64| walk(&points, &perspective(DVec3::new(x, 5.0, 5.0)));
    assert_eq!(from(2.0), ascending, "the eye on the high side of x = 1");
    assert_eq!(from(1.0), descending, "in the plane");
    assert_eq!(from(0.0), descending);
    let up = camera(DVec3::ZERO, DVec3::Y, Lens::Orthographic(4.0));
    assert_eq!(walk(&points, &up), descending, "no component along x");
}

#[test]
fn the_sign_of_a_zero_does_not_matter() {
    let point =
        |i: u32, zero: f32| Vec3::new(if i.is_multiple_of(3) { zero } else { 1.0 }, 0.0, zero);
    let plus: Vec<_> = (0..50).map(|i| point(i, 0.0)).collect();
    let mixed: Vec<_> = (0..50).map(|i| point(i, if i % 2 == 0 { 0.0 } else { -0.0 })).collect();
    for eye in [DVec3::Z, DVec3::X + DVec3::Z, -DVec3::X, DVec3::ZERO] {
        assert_eq!(walk(&plus, &perspective(eye)), walk(&mixed, &perspective(eye)), "{eye}");
    }
}

#[test]
fn threads_leave_no_trace() {
    // More than one job's worth, with many coincident points and many ties.
    let grid = |i: u64| (unit(3, i) * 24.0).floor();
    let place =
        |i: u64| if i.is_multiple_of(3) { Vec3::ONE } else { Vec3::new(grid(i), grid(i + 7), 0.5) };
    let points: Vec<_> = (0..60_000).map(place).collect();
    let surfels = surfels(&points);
    let view = perspective(DVec3::new(3.5, 9.25, 6.0));
    let order = BackToFront::new(&surfels, &Exec::sequential()).walk(&view);
    for threads in [2, 5] {
        let exec = Exec::new(threads, 8).unwrap();
        assert!(BackToFront::new(&surfels, &exec).walk(&view) == order, "{threads} threads");
    }
    let ranks = ranks(&order, points.len()).unwrap();
    let eye = view.eye();
    let high_is_near = |axis: usize, plane: f64| eye[axis] > plane;
    check(&points, (0..points.len()).collect(), &ranks, &high_is_near).unwrap();
}

proptest! {
    #[test]
    fn parts_follow_one_another_as_the_walk_does(
        points in points(),
        eye in [-2.0..2.0, -2.0..2.0, -2.0..2.0],
        most in 1..40_usize,
    ) {
        let order = BackToFront::new(&surfels(&points), &Exec::sequential());
        let view = perspective(DVec3::from_array(eye));
        let mut joined = Vec::new();
        for part in order.parts(&view, most) {
            prop_assert!((1..=most).contains(&part.len()));
            order.walk_part(&part, |place| joined.push(order.index(place)));
        }
        prop_assert_eq!(joined, order.walk(&view));
    }
}
