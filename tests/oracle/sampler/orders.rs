//! The oracle's own samplers: every distance to a pick is asked when there is the pick.

use glam::Vec3;
use splatref::source::sampler::{Schedule, Start};

/// Picks and their squared distances.
#[derive(Clone, Debug, Default)]
pub(crate) struct Picks {
    pub(crate) index: Vec<u32>,
    pub(crate) distance: Vec<f32>,
}

impl Picks {
    fn push(&mut self, index: usize, distance: f32) {
        self.index.push(index as u32);
        self.distance.push(distance);
    }

    pub(crate) fn truncate(mut self, count: usize) -> Self {
        self.index.truncate(count);
        self.distance.truncate(count);
        self
    }
}

/// Output number `index` of `SplitMix64`.
pub(crate) fn random(seed: u64, index: u64) -> u64 {
    let z = seed.wrapping_add(index.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15));
    let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

fn below(seed: u64, index: u64, count: usize) -> usize {
    ((u128::from(random(seed, index)) * count as u128) >> 64) as usize
}

pub(crate) fn squared(a: Vec3, b: Vec3) -> f32 {
    let [dx, dy, dz] = [b.x - a.x, b.y - a.y, b.z - a.z];
    (dx * dx + dy * dy) + dz * dz
}

pub(crate) fn first(start: Start, count: usize) -> usize {
    match start {
        Start::Index(index) => index as usize,
        Start::Seed(seed) => below(seed, 0, count),
    }
}

/// Of every point the squared distance to the nearest pick.
struct Nearest<'a> {
    points: &'a [Vec3],
    of: Vec<f32>,
}

impl<'a> Nearest<'a> {
    fn new(points: &'a [Vec3]) -> Self {
        Self { points, of: vec![f32::INFINITY; points.len()] }
    }

    fn add(&mut self, pick: usize) {
        for (m, p) in self.of.iter_mut().zip(self.points) {
            let d = squared(self.points[pick], *p);
            if d < *m {
                *m = d;
            }
        }
    }

    /// Of some points the farthest, of equal ones that of the lowest index.
    fn farthest(&self, among: impl Iterator<Item = usize>) -> Option<usize> {
        among.fold(None, |best: Option<usize>, i| match best {
            Some(b) if self.of[b] > self.of[i] || self.of[b] == self.of[i] && b < i => best,
            _ => Some(i),
        })
    }
}

/// The greedy permutation.
pub(crate) fn greedy(points: &[Vec3], start: Start, count: usize) -> Picks {
    let mut nearest = Nearest::new(points);
    let mut picks = Picks::default();
    let mut next = first(start, points.len());
    while picks.index.len() < points.len() {
        picks.push(next, nearest.of[next]);
        nearest.add(next);
        next = nearest.farthest(0..points.len()).expect("a point");
        if nearest.of[next] == 0.0 {
            break;
        }
        if picks.index.len() >= count {
            return picks.truncate(count);
        }
    }
    let mut left = vec![true; points.len()];
    picks.index.iter().for_each(|i| left[*i as usize] = false);
    (0..points.len()).filter(|i| left[*i]).for_each(|i| picks.push(i, 0.0));
    picks.truncate(count)
}

/// Samples and acceptances of a round, as the schedules have them.
fn portions(schedule: Schedule, round: usize) -> (usize, usize) {
    match schedule {
        Schedule::Paper => (200, 1 + round / 500),
        Schedule::AsShipped => {
            let (mut samples, mut accepted) = (200, 0);
            for _ in (0..round).filter(|before| before % 500 == 0) {
                samples = (samples / 2).max(20);
                accepted = (accepted + 1).min(samples * 3 / 10);
            }
            (samples, accepted)
        }
    }
}

/// The paper's sampler.
pub(crate) struct Random<'a> {
    nearest: Nearest<'a>,
    rest: Vec<usize>,
    seed: u64,
    drawn: u64,
    picks: Picks,
    count: usize,
}

impl<'a> Random<'a> {
    pub(crate) fn order(
        points: &'a [Vec3],
        start: Start,
        seed: u64,
        schedule: Schedule,
        count: usize,
    ) -> Picks {
        let first = first(start, points.len());
        let rest = (0..points.len()).filter(|i| *i != first).collect();
        let picks = Picks::default();
        let mut all = Self { nearest: Nearest::new(points), rest, seed, drawn: 0, picks, count };
        all.accept(first);
        for round in 0.. {
            if all.full() || all.rest.is_empty() {
                break;
            }
            let (take, accept) = portions(schedule, round);
            let samples = all.samples(take);
            match schedule {
                Schedule::Paper => all.paper(samples, accept),
                Schedule::AsShipped => all.as_shipped(samples, accept),
            }
        }
        all.picks.truncate(count)
    }

    fn full(&self) -> bool {
        self.picks.index.len() >= self.count
    }

    fn accept(&mut self, i: usize) {
        self.picks.push(i, self.nearest.of[i]);
        self.nearest.add(i);
    }

    fn samples(&mut self, take: usize) -> Vec<usize> {
        let length = self.rest.len();
        let take = take.min(length);
        for j in 0..take {
            self.drawn += 1;
            let l = length - j;
            self.rest.swap(below(self.seed, self.drawn, l), l - 1);
        }
        let mut samples = self.rest.split_off(length - take);
        samples.reverse();
        samples
    }

    fn paper(&mut self, mut samples: Vec<usize>, accept: usize) {
        let mut last = 0.0;
        for _ in 0..accept {
            let Some(best) = self.nearest.farthest(samples.iter().copied()) else { break };
            if self.full() {
                return;
            }
            last = self.nearest.of[best];
            self.accept(best);
            samples.retain(|i| *i != best);
        }
        let near = |i: &usize| self.nearest.of[*i] == 0.0 || self.nearest.of[*i] < last / 16.0;
        self.rest.extend(samples.into_iter().filter(|i| !near(i)));
    }

    fn as_shipped(&mut self, samples: Vec<usize>, accept: usize) {
        let mut sorted = samples.clone();
        let of = &self.nearest.of;
        sorted.sort_by(|a, b| of[*b].total_cmp(&of[*a]).then(a.cmp(b)));
        sorted.truncate(accept + 1);
        for i in sorted.iter().take(accept) {
            if self.full() {
                return;
            }
            self.accept(*i);
        }
        self.rest.extend(samples.into_iter().filter(|i| !sorted.contains(i)));
    }
}

/// Points by chance alone.
pub(crate) fn shuffled(points: &[Vec3], seed: u64, count: usize) -> Picks {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by_key(|i| (random(seed, *i as u64), *i));
    let mut nearest = Nearest::new(points);
    let mut picks = Picks::default();
    for i in order.into_iter().take(count) {
        picks.push(i, nearest.of[i]);
        nearest.add(i);
    }
    picks
}

/// Nearest, packing and covering of a prefix.
pub(crate) fn quality(points: &[Vec3], prefix: &[u32]) -> (Vec<f32>, f32, f32) {
    let at = |i: usize| points[prefix[i] as usize];
    let least = |all: &mut dyn Iterator<Item = f32>| {
        all.fold(f32::INFINITY, |a, b| if b < a { b } else { a })
    };
    let others = |i: usize| (0..prefix.len()).filter(move |j| *j != i);
    let nearest: Vec<f32> =
        (0..prefix.len()).map(|i| least(&mut others(i).map(|j| squared(at(i), at(j))))).collect();
    let packing = least(&mut nearest.iter().copied());
    let reach = |p: &Vec3| least(&mut (0..prefix.len()).map(|i| squared(*p, at(i))));
    let covering = points.iter().map(reach).fold(0.0, |a, b| if b > a { b } else { a });
    (nearest, packing, covering)
}
