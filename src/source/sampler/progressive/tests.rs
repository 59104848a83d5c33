use super::*;
use crate::frame::Exec;
use crate::source::Shape;
use crate::source::sampler::Greedy;
use proptest::prelude::*;

fn quiet(_: &str, _: u64, _: u64) {}

fn distance(a: Vec3, b: Vec3) -> f32 {
    let (dx, dy, dz) = (b.x - a.x, b.y - a.y, b.z - a.z);
    (dx * dx + dy * dy) + dz * dz
}

/// The least squared distance to some points.
fn least(points: &[Vec3], picks: &[u32], i: u32) -> f32 {
    let all = picks.iter().map(|&j| distance(points[i as usize], points[j as usize]));
    all.fold(f32::INFINITY, |a, b| if b < a { b } else { a })
}

/// The page again, with plain lists and all distances.
fn by_the_page(
    points: &[Vec3],
    start: u32,
    seed: u64,
    count: usize,
    schedule: Schedule,
) -> Vec<u32> {
    let mut picks = vec![start];
    let mut rest: Vec<u32> = (0..points.len() as u32).filter(|&i| i != start).collect();
    let mut number = 0;
    let mut round = 0;
    // The sizes of the next round.
    let (mut samples, mut accepted) = if schedule == Schedule::Paper { (200, 1) } else { (200, 0) };
    while picks.len() < count && !rest.is_empty() {
        let mut drawn = Vec::new();
        for length in (1..=rest.len()).rev().take(samples) {
            number += 1;
            let at = (u128::from(random::bits(seed, number)) * length as u128) >> 64;
            rest.swap(at as usize, length - 1);
            drawn.push(rest[length - 1]);
        }
        rest.truncate(rest.len() - drawn.len());
        let mut used = Vec::new();
        let known = picks.clone();
        let mut last = 0.0;
        for _ in 0..accepted {
            let open = drawn.iter().filter(|i| !used.contains(*i));
            let seen = if schedule == Schedule::Paper { &picks } else { &known };
            let best = open
                .map(|&i| (least(points, seen, i), i))
                .min_by(|a, b| b.0.partial_cmp(&a.0).unwrap().then(a.1.cmp(&b.1)));
            let Some((at, i)) = best.filter(|_| picks.len() < count) else { break };
            last = at;
            picks.push(i);
            used.push(i);
        }
        if schedule == Schedule::Paper {
            for &i in &drawn {
                let at = least(points, &picks, i);
                if at == 0.0 || at < last / 16.0 {
                    used.push(i);
                }
            }
            round += 1;
            accepted = 1 + round / 500;
        } else {
            let open = drawn.iter().filter(|i| !used.contains(*i));
            let next = open
                .map(|&i| (least(points, &known, i), i))
                .min_by(|a, b| b.0.partial_cmp(&a.0).unwrap().then(a.1.cmp(&b.1)));
            used.extend(next.map(|(_, i)| i));
            if round % 500 == 0 {
                samples = if samples / 2 < 20 { 20 } else { samples / 2 };
                accepted = (accepted + 1).min(samples * 3 / 10);
            }
            round += 1;
        }
        rest.extend(drawn.iter().filter(|i| !used.contains(*i)));
    }
    picks
}

fn some(points: &[[f32; 3]], lattice: bool) -> Vec<Vec3> {
    let at = |p: &[f32; 3]| if lattice { p.map(|x| (x * 4.0).floor()) } else { *p };
    points.iter().map(|p| Vec3::from_array(at(p))).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn an_order_is_that_of_the_page(
        points in prop::collection::vec(prop::array::uniform3(-1.0_f32..1.0), 1..700),
        lattice: bool,
        seed: u64,
        start in 0_u32..700,
        part in 0.0_f64..1.2,
        shipped: bool,
    ) {
        let points = some(&points, lattice);
        let start = start % points.len() as u32;
        let count = ((points.len() as f64 * part) as usize).max(1);
        let schedule = if shipped { Schedule::AsShipped } else { Schedule::Paper };
        let sampler = Progressive { start: Start::Index(start), seed, schedule };
        let order = sampler.order(&points, count, &quiet).unwrap();
        prop_assert_eq!(&order.index, &by_the_page(&points, start, seed, count, schedule));
        for (i, &index) in order.index.iter().enumerate() {
            prop_assert_eq!(order.distance[i], least(&points, &order.index[..i], index));
        }
    }

    #[test]
    fn shuffled_points_are_all_there_once(
        points in prop::collection::vec(prop::array::uniform3(-1.0_f32..1.0), 1..200),
        seed: u64,
    ) {
        let points = some(&points, false);
        let order = shuffled(&points, seed, points.len(), &|_, _, _| ()).unwrap();
        let mut all = order.index.clone();
        all.sort_unstable();
        prop_assert!(all.iter().copied().eq(0..points.len() as u32));
        let part = shuffled(&points, seed, points.len() / 2, &|_, _, _| ()).unwrap();
        prop_assert_eq!(&part.index[..], &order.index[..points.len() / 2]);
        for (i, &index) in order.index.iter().enumerate() {
            prop_assert_eq!(order.distance[i], least(&points, &order.index[..i], index));
        }
    }
}

/// The page holds after thousands of rounds too, when the schedule has changed several times.
#[test]
fn a_long_order_is_that_of_the_page() {
    let points: Vec<Vec3> = Shape::Torus.surfels(6_000, 4).unwrap().position().to_vec();
    for schedule in [Schedule::Paper, Schedule::AsShipped] {
        let sampler = Progressive { start: Start::Index(7), seed: 5, schedule };
        let order = sampler.order(&points, 3_000, &quiet).unwrap();
        let page = by_the_page(&points, 7, 5, 3_000, schedule);
        assert_eq!((order.index.len(), order.index), (3_000, page));
    }
}

/// The median distance of a prefix to its nearest neighbours: the means of Fig. 3.
fn median(points: &[Vec3], prefix: &[u32]) -> f32 {
    let mut all: Vec<f32> = prefix
        .iter()
        .map(|&i| {
            let others: Vec<u32> = prefix.iter().copied().filter(|&j| j != i).collect();
            least(points, &others, i).sqrt()
        })
        .collect();
    all.sort_by(f32::total_cmp);
    all[all.len() / 2]
}

/// Fig. 3: "still close to the minimum distance of the greedy permutation while significantly better
/// than the random approach".
#[test]
fn samplers_are_as_even_as_the_paper_says() {
    let points: Vec<Vec3> = Shape::Torus.surfels(20_000, 4).unwrap().position().to_vec();
    let start = Start::Index(0);
    let exec = Exec::sequential();
    let greedy = Greedy { start }.order(&points, 1_000, &exec, &quiet).unwrap();
    let of = |schedule| {
        let sampler = Progressive { start, seed: 1, schedule };
        median(&points, &sampler.order(&points, 1_000, &quiet).unwrap().index)
    };
    let minimum = greedy.distance[999].sqrt();
    let random = median(&points, &shuffled(&points, 1, 1_000, &|_, _, _| ()).unwrap().index);
    let (paper, shipped) = (of(Schedule::Paper), of(Schedule::AsShipped));
    assert!(paper > 0.9 * minimum && paper > 1.5 * random, "{paper} {minimum} {random}");
    assert!(shipped > 0.8 * minimum && shipped > 1.4 * random, "{shipped} {minimum} {random}");
}
