//! Checks every pixel against fractions of 128-bit integers, written without the code under test.

mod lines;

use super::*;
use crate::number::Real;
use lines::visited;
use proptest::prelude::*;

type Point = [i64; 2];

/// A picture small enough to check every pixel.
const PICTURE: Rect = Rect { x0: 0, y0: 0, x1: 17, y1: 14 };

fn pixels(rect: &Rect) -> impl Iterator<Item = (u32, u32)> {
    let Rect { x0, y0, x1, y1 } = *rect;
    (y0..y1).flat_map(move |y| (x0..x1).map(move |x| (x, y)))
}

/// The cross product of b - a and c - a.
fn cross(a: [i128; 2], b: [i128; 2], c: [i128; 2]) -> i128 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

fn halves(p: Point) -> [i128; 2] {
    p.map(|c| 2 * i128::from(c))
}

fn center(bits: u32, x: u32, y: u32) -> [i128; 2] {
    [x, y].map(|c| (2 * i128::from(c) + 1) << bits)
}

/// Where a centre lies: 1 inside, 0 on the outline, -1 outside.
fn side(bits: u32, corners: [Point; 3], x: u32, y: u32) -> i32 {
    let ([a, b, c], p) = (corners.map(halves), center(bits, x, y));
    let sense = cross(a, b, c).signum();
    let least = [cross(a, b, p), cross(b, c, p), cross(c, a, p)].into_iter().map(|w| w * sense);
    least.min().map_or(-1, |w| w.signum() as i32)
}

/// The rule as Direct3D words it, for corners in clockwise order: a top edge is horizontal and runs
/// to the right, a left edge runs up.
fn covers(bits: u32, corners: [Point; 3], x: u32, y: u32) -> bool {
    let ([a, mut b, mut c], p) = (corners.map(halves), center(bits, x, y));
    if cross(a, b, c) < 0 {
        (b, c) = (c, b);
    }
    [(a, b), (b, c), (c, a)].into_iter().all(|(q, r)| {
        let top = q[1] == r[1] && r[0] > q[0];
        let left = r[1] < q[1];
        let w = cross(q, r, p);
        w > 0 || (w == 0 && (top || left))
    })
}

/// The covered pixels, in order, after a check of the weights that come with them.
fn covered(bits: u32, corners: [Point; 3], rect: &Rect) -> Vec<(u32, u32)> {
    let mut list = Vec::new();
    let Some(triangle) = Triangle::new(&Snap { bits }, corners) else {
        let [a, b, c] = corners.map(halves);
        assert_eq!(cross(a, b, c), 0);
        return list;
    };
    let bounds = triangle.bounds(u32::MAX, u32::MAX);
    assert!(triangle.area() > 0);
    triangle.for_each(rect, |x, y, weights| {
        assert!(bounds.contains(x, y) && rect.contains(x, y));
        assert!(weights.iter().all(|w| *w >= 0));
        assert_eq!(weights.iter().sum::<i64>(), triangle.area());
        for axis in 0..2 {
            // Exactly one triple with this sum gives the point.
            let parts = [0, 1, 2].map(|k| i128::from(weights[k]) * halves(corners[k])[axis]);
            let point = i128::from(triangle.area()) * center(bits, x, y)[axis];
            assert_eq!(parts.iter().sum::<i128>(), point);
        }
        list.push((y, x));
    });
    assert!(list.is_sorted() && list.windows(2).all(|p| p[0] != p[1]), "row by row, once");
    list.into_iter().map(|(y, x)| (x, y)).collect()
}

fn cases() -> ProptestConfig {
    ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(2_000) }
}

/// Points in and around the picture; half of them on centres and borders of pixels.
fn point(bits: u32) -> impl Strategy<Value = Point> {
    let half = (1_i64 << bits) / 2;
    let coordinate = move || {
        let on_grid = (-10..45_i64).prop_map(move |c| if bits == 0 { c / 2 } else { c * half });
        prop_oneof![on_grid, (-5_i64 << bits)..(22_i64 << bits)]
    };
    [coordinate(), coordinate()]
}

fn points<const N: usize>() -> impl Strategy<Value = (u32, [Point; N])> {
    (0..=12_u32).prop_flat_map(|bits| (Just(bits), std::array::from_fn(|_| point(bits))))
}

/// Points of the whole guard band at 12 bits, and where a window lies between the first two.
fn wide<const N: usize>() -> impl Strategy<Value = ([Point; N], f64)> {
    let coordinate = || prop_oneof![-(1_i64 << 29)..=(1 << 29), Just(1 << 29), Just(-(1 << 29))];
    (std::array::from_fn(|_| [coordinate(), coordinate()]), 0.0..1.0)
}

/// A few pixels around a point of the segment.
fn window(a: Point, b: Point, share: f64) -> Rect {
    let [x, y] = [0, 1].map(|k| {
        let at = a[k] as f64 + (b[k] - a[k]) as f64 * share;
        (at / 4096.0).at_least(4.0) as u32
    });
    Rect { x0: x - 4, y0: y - 4, x1: x + 5, y1: y + 5 }
}

/// The picture in four pieces.
fn pieces(x: u32, y: u32) -> [Rect; 4] {
    let Rect { x1, y1, .. } = PICTURE;
    let [left, right] = [(0, x), (x, x1)];
    [(left, (0, y)), (right, (0, y)), (left, (y, y1)), (right, (y, y1))]
        .map(|((x0, x1), (y0, y1))| Rect { x0, y0, x1, y1 })
}

proptest! {
    #![proptest_config(cases())]

    #[test]
    fn a_triangle_covers_what_the_rule_says((bits, corners) in points::<3>()) {
        let own = covered(bits, corners, &PICTURE);
        let flat = Triangle::new(&Snap { bits }, corners).is_none();
        let rule = |(x, y): &(u32, u32)| !flat && covers(bits, corners, *x, *y);
        prop_assert_eq!(own, pixels(&PICTURE).filter(rule).collect::<Vec<_>>());
    }

    #[test]
    fn the_order_of_the_corners_only_turns_the_front((bits, [a, b, c]) in points::<3>()) {
        let snap = Snap { bits };
        if let Some(triangle) = Triangle::new(&snap, [a, b, c]) {
            let [p, q, r] = [a, b, c].map(halves);
            prop_assert_eq!(triangle.front(), cross(p, q, r) < 0);
            for (other, turned) in [([b, c, a], false), ([c, b, a], true), ([b, a, c], true)] {
                let front = Triangle::new(&snap, other).map(|t| t.front());
                prop_assert_eq!(front, Some(triangle.front() != turned));
                prop_assert_eq!(covered(bits, other, &PICTURE), covered(bits, [a, b, c], &PICTURE));
            }
        }
    }

    #[test]
    fn triangles_on_either_side_of_an_edge_meet_without_gap((bits, [a, b, c, d]) in points::<4>()) {
        // One of the six edges has the other points on either side, unless three points are on one
        // line.
        let apart = |[a, b, c, d]: &[Point; 4]| {
            let [p, q, r, s] = [a, b, c, d].map(|p| halves(*p));
            cross(p, r, q).signum() * cross(p, r, s).signum() < 0
        };
        let from_a = [[a, b, c, d], [a, c, b, d], [a, b, d, c]];
        let others = [[b, a, c, d], [b, a, d, c], [c, a, d, b]];
        let found = from_a.into_iter().chain(others).find(apart);
        prop_assume!(found.is_some());
        let [a, b, c, d] = found.unwrap_or_default();
        let [p, q, r, s] = [a, b, c, d].map(halves);
        let lists = [covered(bits, [a, b, c], &PICTURE), covered(bits, [c, a, d], &PICTURE)];
        for (x, y) in pixels(&PICTURE) {
            let count = lists.iter().filter(|list| list.contains(&(x, y))).count();
            let sides = [side(bits, [a, b, c], x, y), side(bits, [a, c, d], x, y)];
            // On the shared edge but not at its ends, if both triangles have the centre on it.
            let m = center(bits, x, y);
            let shared = sides == [0, 0] && m != p && m != r;
            if sides.contains(&1) || shared {
                prop_assert_eq!(count, 1);
            } else if sides == [-1, -1] {
                prop_assert_eq!(count, 0);
            } else {
                prop_assert!(count <= 1);
            }
        }
        // A convex quadrangle has the same pixels when it is split along its other diagonal.
        if cross(q, s, p).signum() * cross(q, s, r).signum() < 0 {
            let mut one = lists.concat();
            let mut other =
                [covered(bits, [d, a, b], &PICTURE), covered(bits, [b, c, d], &PICTURE)].concat();
            one.sort_unstable();
            other.sort_unstable();
            prop_assert_eq!(one, other);
        }
    }

    #[test]
    fn a_fan_covers_every_pixel_of_a_rectangle_once(
        (bits, three) in points::<3>(),
        stops in prop::collection::vec((0..4_usize, 0.0..1.0), 0..12),
        turned in any::<u64>(),
    ) {
        let [x, y] = [0, 1].map(|k| {
            let mut sorted = three.map(|p| p[k]);
            sorted.sort_unstable();
            sorted
        });
        let [low, inner, high] = [0, 1, 2].map(|k| [x[k], y[k]]);
        prop_assume!((0..2).all(|k| low[k] < inner[k] && inner[k] < high[k]));
        // The border clockwise: its corners, and points on its sides.
        let corners = [low, [high[0], low[1]], high, [low[0], high[1]]];
        let mut border = Vec::new();
        for side in 0..4 {
            let (from, to) = (corners[side], corners[(side + 1) % 4]);
            let mut shares: Vec<f64> = stops.iter().filter(|s| s.0 == side).map(|s| s.1).collect();
            shares.sort_by(f64::total_cmp);
            border.push(from);
            border.extend(shares.iter().map(|share| {
                [0, 1].map(|k| from[k] + ((to[k] - from[k]) as f64 * share) as i64)
            }));
        }
        let mut all = Vec::new();
        for (k, from) in border.iter().enumerate() {
            let to = border[(k + 1) % border.len()];
            let [p, q] = if turned >> k & 1 == 0 { [inner, to] } else { [to, inner] };
            let corners = [p, *from, q];
            all.extend(covered(bits, corners, &PICTURE));
        }
        all.sort_unstable_by_key(|(x, y)| (*y, *x));
        let inside = |(x, y): &(u32, u32)| {
            let c = center(bits, *x, *y);
            (0..2).all(|k| halves(low)[k] <= c[k] && c[k] < halves(high)[k])
        };
        prop_assert_eq!(all, pixels(&PICTURE).filter(inside).collect::<Vec<_>>());
    }

    #[test]
    fn pieces_of_the_picture_see_what_the_whole_sees(
        (bits, [a, b, c]) in points::<3>(), x in 0..=17_u32, y in 0..=14_u32,
    ) {
        for rect in pieces(x, y) {
            let whole = covered(bits, [a, b, c], &PICTURE);
            let whole: Vec<_> = whole.into_iter().filter(|p| rect.contains(p.0, p.1)).collect();
            prop_assert_eq!(covered(bits, [a, b, c], &rect), whole);
            let whole = visited(bits, a, b, &PICTURE);
            let whole: Vec<_> = whole.into_iter().filter(|p| rect.contains(p.0, p.1)).collect();
            prop_assert_eq!(visited(bits, a, b, &rect), whole);
        }
    }

    #[test]
    fn triangles_as_large_as_the_guard_band_are_exact((corners, share) in wide::<3>()) {
        let rect = window(corners[0], corners[1], share);
        let rule = |(x, y): &(u32, u32)| covers(12, corners, *x, *y);
        let rule: Vec<_> = pixels(&rect).filter(rule).collect();
        prop_assume!(Triangle::new(&Snap { bits: 12 }, corners).is_some());
        prop_assert_eq!(covered(12, corners, &rect), rule);
    }

    #[test]
    fn snapping_takes_the_nearest_and_of_two_the_greater(
        bits in 0..=12_u32, any in any::<f32>(), x in -131_072.0..131_072.0_f32, e in 0..40,
    ) {
        let sixteenths = x.floor() / 16.0;
        for x in [any, x, x / (1_i64 << e) as f32, sixteenths, f32::next_down(sixteenths)] {
            if x.abs() <= 131_072.0 {
                let fixed = Snap { bits }.fixed(x);
                prop_assert_eq!(fixed, Snap { bits }.fixed(f64::from(x)));
                // Exact: f64 holds the 24 bits of x beside those of an integer of 30.
                let rest = f64::from(x) * f64::from(1_u32 << bits) - fixed as f64;
                prop_assert!((-0.5..0.5).contains(&rest), "{} {}", x, rest);
            }
        }
    }
}

#[test]
fn centers_on_the_outline_belong_to_the_left_and_the_top() {
    // A square from centre to centre, in two triangles with corners at 1/2 px.
    let [a, b, c, d] = [[1, 1], [5, 1], [5, 5], [1, 5]];
    let room = Rect { x0: 0, y0: 0, x1: 9, y1: 9 };
    assert_eq!(covered(1, [a, b, c], &room), [(0, 0), (1, 0), (1, 1)]);
    assert_eq!(covered(1, [a, c, d], &room), [(0, 1)]);
    let triangle = Triangle::new(&Snap { bits: 1 }, [a, b, c]).unwrap();
    assert_eq!(triangle.bounds(9, 9), Rect { x0: 0, y0: 0, x1: 2, y1: 2 });
    assert_eq!(triangle.bounds(1, 9), Rect { x0: 0, y0: 0, x1: 1, y1: 2 });
    assert_eq!(triangle.area(), 32, "four times 8 units");
    assert!(!triangle.front(), "clockwise on the screen");
}

#[test]
fn what_is_out_of_range_is_held_and_nothing_panics() {
    let far = [i64::MAX, i64::MIN, -1, 0, 1 << 29];
    for bits in [0, 12] {
        for a in far {
            for b in far {
                let corners = [[a, b], [b, a], [0, 100]];
                if let Some(triangle) = Triangle::new(&Snap { bits }, corners) {
                    triangle.for_each(&PICTURE, |_, _, weights| {
                        assert_eq!(weights.iter().sum::<i64>(), triangle.area());
                    });
                }
                visited(bits, [a, b], [b, 0], &PICTURE);
            }
        }
    }
    let nothing = Rect { x0: 5, y0: 5, x1: 3, y1: 9 };
    assert!(covered(0, [[0, 0], [20, 0], [0, 20]], &nothing).is_empty());
    assert!(visited(0, [0, 0], [20, 20], &nothing).is_empty());
    let left = Triangle::new(&Snap::default(), [[-900, 0], [-300, 0], [-300, 500]]).unwrap();
    assert!(left.bounds(640, 480).is_empty());
}

#[test]
fn snapping_knows_ties_and_limits() {
    let snap = Snap::new(0).unwrap();
    let half = [-1.5_f32, -0.5, 0.5, 1.5].map(|x| snap.fixed(x));
    assert_eq!(half, [-1, 0, 1, 2]);
    assert_eq!(snap.fixed(f32::next_down(0.5)), 0, "the sum with 1/2 would round to 1");
    // 2^23 + 1 sub-pixels: the sum with 1/2 would round to even.
    assert_eq!(Snap::default().fixed(32_768.0 + 1.0 / 256.0_f32), (1 << 23) + 1);
    assert_eq!(Snap::default().fixed(f64::INFINITY), 1 << 25);
    assert_eq!(Snap::default().fixed(-1e30_f32), -(1 << 25));
    assert_eq!(Snap::default().fixed(f32::NAN), 0);
    assert_eq!(Ok(Snap::default()), Snap::new(8).map_err(|e| e.to_string()));
    let line = Snap::new(13).unwrap_err().to_string();
    assert!(line.contains("13 sub-pixel bits"), "{line}");
}
