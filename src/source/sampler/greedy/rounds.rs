//! Pick in rounds: each round picks all points whose m is not below a floor, whatever their turn.

use super::build;
use super::order::{Division, Order};
use super::tree::{Border, Key, Region, reach, relax};
use crate::frame::Exec;
use crate::progress::Progress;
use glam::Vec3;
use std::collections::BinaryHeap;
use std::collections::binary_heap::PeekMut;
use std::slice;

/// Rounds between two reports of progress.
const STRETCH: usize = 16;
/// With this many buckets it pays to wake threads.
const MANY: usize = 512;

/// The order of checked points; `count` is at most their number.
pub(super) fn order(
    points: &[Vec3],
    start: u32,
    count: usize,
    how: &Division,
    exec: &Exec,
    progress: Progress<'_>,
) -> Order {
    let mut order = Order::default();
    if count == 0 {
        return order;
    }
    progress("building a tree", 0, 1);
    let mut state = State {
        regions: exec.within(|| build::regions(points, how, exec)),
        points,
        keys: Vec::new(),
        count: count - 1,
        how,
        exec,
    };
    progress("picking points", 0, count as u64);
    state.take(start);
    while exec.within(|| (0..STRETCH).all(|_| state.round())) {
        progress("picking points", state.keys.len() as u64, count as u64);
    }
    let mut keys = state.keys;
    exec.sort(&mut keys);
    order.index.reserve_exact(count);
    order.distance.reserve_exact(count);
    let picks =
        [Key::new(f32::INFINITY.to_bits(), start)].into_iter().chain(keys.into_iter().rev());
    for key in picks.take(count) {
        order.index.push(key.id());
        order.distance.push(f32::from_bits(key.most()));
    }
    if order.index.len() < count {
        order.finish(points.len(), count);
    }
    order
}

/// The state between two rounds.
struct State<'a> {
    points: &'a [Vec3],
    regions: Vec<Region>,
    /// The keys of all picks after the start, down to the last floor, unsorted.
    keys: Vec<Key>,
    /// How many picks are wanted after the start.
    count: usize,
    how: &'a Division,
    exec: &'a Exec,
}

impl State<'_> {
    /// Picks the start.
    fn take(&mut self, start: u32) {
        let all = Key::new(u32::MAX, 0);
        let point = self.points[start as usize].to_array();
        self.exec.ordered(self.regions.iter_mut().collect(), |region| {
            reach(region, point, all);
            relax(region, point);
        });
    }

    /// Picks all points down to a new floor; false if there is nothing left to do.
    fn round(&mut self) -> bool {
        self.regions.iter_mut().for_each(Region::refresh);
        let most = self.regions.iter().fold(0, |most, region| most.max(region.most()));
        if most == 0 || self.keys.len() >= self.count {
            return false;
        }
        // On a surface, half the squared distance means twice as many picks.
        let there = self.keys.len() as f32 / self.count as f32;
        let part = if there > self.how.floor { there } else { self.how.floor };
        let floor = (f32::from_bits(most) * part).to_bits().max(1);
        let pass = Pass { points: self.points, floor, others: &[], exec: self.exec };
        if self.regions.len() > 1 && self.keys.len() >= self.how.warm {
            let borders: Vec<Border> = self.regions.iter().map(Region::border).collect();
            let jobs = self.regions.iter_mut().enumerate().collect();
            let found = self.exec.ordered(jobs, |(own, region)| {
                let mut others = borders.clone();
                others.swap_remove(own);
                Pass { others: &others, ..pass }.run(slice::from_mut(region))
            });
            found.into_iter().for_each(|keys| self.keys.extend(keys));
        }
        self.keys.extend(pass.run(&mut self.regions));
        true
    }
}

/// A pass that picks all points down to a floor in some regions, except the points that other
/// regions could reach.
struct Pass<'a> {
    points: &'a [Vec3],
    /// The bits of the floor.
    floor: u32,
    others: &'a [Border],
    exec: &'a Exec,
}

/// The largest key of a bucket, with its region and its slot.
type Listed = (Key, u32, u32);

impl Pass<'_> {
    fn run(&self, regions: &mut [Region]) -> Vec<Key> {
        let mut listed: Vec<Listed> = Vec::new();
        for (number, region) in (0..).zip(regions.iter_mut()) {
            region.list(self.floor);
            listed.extend(region.found.iter().map(|&slot| (region.key(slot), number, slot)));
        }
        let mut keys = Vec::with_capacity(listed.len());
        // Read all points first, because a single random read would stall.
        let points: Vec<_> = listed.iter().map(|listed| self.point(listed.0)).collect();
        // Go in the order of memory, which is better for caches than the order of keys.
        for (&(key, region, slot), &point) in listed.iter().zip(&points) {
            if regions[region as usize].key(slot) == key && self.pick(regions, key, point) {
                keys.push(key);
            }
        }
        for (key, region, slot) in &mut listed {
            *key = regions[*region as usize].key(*slot);
        }
        listed.retain(|(key, ..)| key.most() >= self.floor);
        // Treat the rest in the order of keys, so that only points within reach of another region
        // are left out. Keys only fall: an outdated key is moved back.
        let mut heap = BinaryHeap::from(listed);
        while let Some(mut top) = heap.peek_mut() {
            let (key, region, slot) = *top;
            let now = regions[region as usize].key(slot);
            if now == key {
                if self.pick(regions, key, self.point(key)) {
                    keys.push(key);
                } else {
                    PeekMut::pop(top);
                }
            } else if now.most() >= self.floor {
                top.0 = now;
            } else {
                PeekMut::pop(top);
            }
        }
        keys
    }

    fn point(&self, key: Key) -> [f32; 3] {
        self.points[key.id() as usize].to_array()
    }

    /// Picks a point, unless a larger key or another region may be within reach.
    fn pick(&self, regions: &mut [Region], key: Key, point: [f32; 3]) -> bool {
        if self.others.iter().any(|border| border.reached(point)) {
            return false;
        }
        if !regions.iter_mut().all(|region| reach(region, point, key)) {
            return false;
        }
        let found: usize = regions.iter().map(|region| region.found.len()).sum();
        if found >= MANY && regions.len() > 1 {
            self.exec.ordered(regions.iter_mut().collect(), |region| relax(region, point));
        } else {
            regions.iter_mut().for_each(|region| relax(region, point));
        }
        true
    }
}
