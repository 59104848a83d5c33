use super::*;
use crate::number::elementary;
use glam::{DVec2, Vec2};

const AXES: [fn(Vec2) -> Vec3; 6] = [
    |p| Vec3::new(p.x, p.y, 0.0),
    |p| Vec3::new(0.0, p.x, p.y),
    |p| Vec3::new(p.y, 0.0, p.x),
    |p| Vec3::new(p.y, p.x, 0.0),
    |p| Vec3::new(p.x, p.y, 0.5 * p.x - 0.25 * p.y),
    |p| Vec3::new(1.5e3 + p.x, 1e3 + p.y, -2.0 * p.x),
];

fn points(text: &str) -> Vec<Vec2> {
    let number = |word: &str| word.parse::<f32>().unwrap();
    let words: Vec<f32> = text.split_whitespace().map(number).collect();
    words.chunks(2).map(|pair| Vec2::new(pair[0], pair[1])).collect()
}

fn turned(points: &[Vec2], by: usize) -> Vec<Vec2> {
    points.iter().cycle().skip(by).take(points.len()).copied().collect()
}

/// How often triangles cover a place, each with the sign of its turn; none may have its edge there.
fn covers(corners: &[Vec2], triangles: &[[u32; 3]], at: DVec2) -> i32 {
    let covers = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|i| corners[i as usize].as_dvec2());
        let sides = [(a, b), (b, c), (c, a)].map(|(a, b)| (b - a).perp_dot(at - a));
        let inside = sides.iter().all(|side| *side > 0.0) || sides.iter().all(|side| *side < 0.0);
        i32::from(inside) * if sides[0] > 0.0 { 1 } else { -1 }
    };
    triangles.iter().map(covers).sum()
}

fn fan(count: u32) -> Vec<[u32; 3]> {
    (2..count).map(|i| [0, i - 1, i]).collect()
}

/// Triangles cover exactly the polygon, wherever it begins, in whichever plane it lies and whichever
/// way it runs. The fan covers each place as often as the polygon winds around it.
#[test]
fn triangles_cover_the_polygon_once() {
    let shapes = [
        ("L", "2 0 2 1 1 1 1 2 0 2 0 0"),
        ("arrow", "0 0 2 1 0 2 1 1"),
        ("comb", "0 0 7 0 7 3 6 3 6 1 5 1 5 3 4 3 4 1 3 1 3 3 2 3 2 1 1 1 1 3 0 3"),
        ("spiral", "0 0 6 0 6 6 1 6 1 2 4 2 4 4 3 4 3 3 2 3 2 5 5 5 5 1 0 1"),
        // A square hole, with a bridge that is walked twice.
        ("ring", "0 0 4 0 4 4 0 4 0 0 1 1 1 3 3 3 3 1 1 1"),
        // Corners on straight edges, and the same corner twice.
        ("straight", "0 0 1 0 2 0 2 1 1 1 1 1 1 2 0 2 0 1"),
        ("star", "3 0 4 2 6 2 4.5 3.5 5 6 3 4.5 1 6 1.5 3.5 0 2 2 2"),
    ];
    for (name, shape) in shapes {
        let all = points(shape);
        for (by, reversed) in (0..all.len()).flat_map(|by| [(by, false), (by, true)]) {
            let mut corners = turned(&all, by);
            if reversed {
                corners.reverse();
            }
            let whole = fan(corners.len() as u32);
            let placed = |axes: fn(Vec2) -> Vec3| -> Vec<Vec3> {
                corners.iter().copied().map(axes).collect()
            };
            let all_ears = AXES.map(|axes| ears(&placed(axes), &mut Budget::new()));
            assert!(all_ears.iter().all(|one| *one == all_ears[0]), "{name} from {by}");
            let cut = all_ears[0].clone().unwrap_or_else(|| whole.clone());
            assert_eq!(cut.len(), corners.len() - 2, "{name}");
            for i in 0..36 * 36 {
                let steps = DVec2::new(f64::from(i % 36), f64::from(i / 36)) + 0.217;
                // No place is on a line between corners.
                let at = steps * DVec2::new(0.14 * 2.0_f64.sqrt(), 0.114 * 3.0_f64.sqrt());
                let (found, needed) = (covers(&corners, &cut, at), covers(&corners, &whole, at));
                assert_eq!(found, needed, "{name} from {by} at {at}: {cut:?}");
                let most = cut.iter().filter(|one| covers(&corners, &[**one], at) != 0).count();
                assert!(most <= 1, "{name} from {by}: {most} triangles at {at}");
            }
        }
    }
}

#[test]
fn polygons_whose_fan_is_right_keep_it() {
    for shape in [
        "0 0 1 0 1 1 0 1",
        "0 0 2 0 3 2 1 4 -1 2",
        // Corners on an edge.
        "0 0 1 0 2 0 2 2 0 2 0 1",
        // Concave, but its first corner sees all of it.
        "1 1 0 2 0 0 2 1",
        "1 1 0 0 2 1 0 2",
    ] {
        for axes in AXES {
            let corners: Vec<Vec3> = points(shape).into_iter().map(axes).collect();
            assert_eq!(ears(&corners, &mut Budget::new()), None, "{shape}");
        }
    }
}

/// No right cut exists: the fan stays, and nothing panics.
#[test]
fn polygons_without_ears_keep_the_fan() {
    for shape in
        ["0 0 1 0 2 0 1 0", "0 0 0 0 0 0 0 0", "0 0 1e38 3e38 nan 1 0 2", "0 0 1 0 inf 1 0 1"]
    {
        let corners: Vec<Vec3> = points(shape).iter().map(|p| p.extend(0.0)).collect();
        assert_eq!(ears(&corners, &mut Budget::new()), None, "{shape}");
    }
    for shape in ["0 0 2 2 2 0 0 2", "0 0 4 0 1 3 2 -1 3 3", "0 0 3e38 0 3e38 3e38 1 1 0 3e38"] {
        let corners: Vec<Vec3> = points(shape).iter().map(|p| p.extend(0.0)).collect();
        let cut = ears(&corners, &mut Budget::new()).unwrap_or_else(|| fan(corners.len() as u32));
        assert_eq!(cut.len(), corners.len() - 2);
    }
}

/// A gear: every second corner turns right.
fn gear(corners: u32) -> Vec<Vec3> {
    let place = |i: u32| {
        let angle = f64::from(i) / f64::from(corners) * std::f64::consts::TAU;
        let radius = if i.is_multiple_of(2) { 1000.0 } else { 1001.0 };
        let (x, y) = (elementary::cos(angle), elementary::sin(angle));
        (DVec2::new(x, y) * radius).as_vec2().extend(0.0)
    };
    (0..corners).map(place).collect()
}

#[test]
fn long_polygons_are_cut_as_long_as_the_budget_lasts() {
    let mut budget = Budget::new();
    let corners = gear(70_000);
    let cut = ears(&corners, &mut budget).unwrap();
    assert_eq!((cut.len(), budget.warning()), (69_998, None));
    assert!(budget.tries > 1 << 29, "{} are left", budget.tries);

    let flat = project(&gear(20)).unwrap();
    let mut tries = 1000;
    assert!(ears::Cutter::new(&flat, &mut tries).cut().is_some());
    let mut tries = (1000 - tries) / 2;
    assert!(ears::Cutter::new(&flat, &mut tries).cut().is_none() && tries == 0);
    let said = Budget { tries: 0, uncut: 2 }.warning().unwrap();
    assert!(said.starts_with("2 polygons have so many corners"), "{said}");
}

/// The rules, step by step: after the ear at corner 0, corner 2 is tried next.
#[test]
fn ears_are_cut_in_the_order_of_the_rules() {
    let corners: Vec<Vec3> =
        points("2 0 2 1 1 1 1 2 0 2 0 0").iter().map(|p| p.extend(0.0)).collect();
    assert_eq!(
        ears(&corners, &mut Budget::new()).unwrap(),
        [[5, 0, 1], [2, 3, 4], [5, 1, 2], [2, 4, 5]]
    );
}

#[test]
fn the_sign_of_a_turn_is_exact() {
    let next = |value: f64| f64::from((value as f32).next_up());
    // On the line y = x, far from the origin: f64 alone rounds the sum of the products to 0.
    let (a, b) = ([1e-30_f32.into(), 1e-30_f32.into()], [16_777_216.0, 16_777_216.0]);
    for at in [0.5_f64, 3.0, 1e7] {
        let at = f64::from(at as f32);
        assert_eq!(turn(a, b, [at, at]), Ordering::Equal);
        assert_eq!(turn(a, b, [at, next(at)]), Ordering::Greater);
        assert_eq!(turn(a, b, [next(at), at]), Ordering::Less);
    }
    let tiny = f64::from(f32::from_bits(1));
    assert_eq!(turn([0.0, 0.0], [3e38, 0.0], [0.0, tiny]), Ordering::Greater);
}
