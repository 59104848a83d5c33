//! Cut one projected polygon into ears.

use super::{Flat, turn};
use std::cmp::Ordering;

/// A polygon of which ears are cut off.
pub(super) struct Cutter<'a> {
    at: &'a [Flat],
    /// The corner before and after each corner that is left.
    before: Vec<u32>,
    after: Vec<u32>,
    /// The turn at each corner; `Greater` at a corner that was cut off.
    turns: Vec<Ordering>,
    /// The corners that did not turn left at first, in ascending x. A corner turns further left when
    /// a neighbour is cut off, and so none is missing later.
    blockers: Vec<u32>,
    /// How often it may still be tried whether a corner is in a triangle.
    tries: &'a mut u64,
}

impl<'a> Cutter<'a> {
    pub(super) fn new(at: &'a [Flat], tries: &'a mut u64) -> Self {
        let count = at.len() as u32;
        let before: Vec<u32> = (0..count).map(|i| (i + count - 1) % count).collect();
        let after: Vec<u32> = (0..count).map(|i| (i + 1) % count).collect();
        let turns = Vec::new();
        let mut cutter = Self { at, before, after, turns, blockers: Vec::new(), tries };
        cutter.turns = (0..count).map(|i| cutter.turn_at(i)).collect();
        let blocks = |i: &u32| cutter.turns[*i as usize] != Ordering::Greater;
        let mut blockers: Vec<u32> = (0..count).filter(blocks).collect();
        blockers.sort_by(|&a, &b| at[a as usize][0].total_cmp(&at[b as usize][0]));
        Self { blockers, ..cutter }
    }

    /// The triangles; `None` if the polygon crosses itself, or if no tries are left.
    pub(super) fn cut(mut self) -> Option<Vec<[u32; 3]>> {
        let mut triangles = Vec::with_capacity(self.at.len() - 2);
        let mut left = self.at.len();
        let (mut current, mut tried) = (0, 0);
        while left > 3 {
            if *self.tries == 0 {
                return None;
            }
            let corner = if self.is_ear(current) {
                current
            } else if tried < left {
                tried += 1;
                current = self.after[current as usize];
                continue;
            } else {
                self.first_straight(current, left)?
            };
            let [a, b, c] = self.triangle(corner);
            triangles.push([a, b, c]);
            self.remove(corner);
            left -= 1;
            (current, tried) = (self.after[c as usize], 0);
        }
        triangles.push(self.triangle(current));
        Some(triangles)
    }

    fn triangle(&self, corner: u32) -> [u32; 3] {
        [self.before[corner as usize], corner, self.after[corner as usize]]
    }

    fn turn_at(&self, corner: u32) -> Ordering {
        let [a, b, c] = self.triangle(corner).map(|i| self.at[i as usize]);
        turn(a, b, c)
    }

    /// The first corner from `current` on that turns neither way.
    fn first_straight(&self, mut current: u32, left: usize) -> Option<u32> {
        for _ in 0..left {
            if self.turns[current as usize] == Ordering::Equal {
                return Some(current);
            }
            current = self.after[current as usize];
        }
        None
    }

    fn remove(&mut self, corner: u32) {
        let [a, _, c] = self.triangle(corner);
        self.after[a as usize] = c;
        self.before[c as usize] = a;
        self.turns[corner as usize] = Ordering::Greater;
        for neighbour in [a, c] {
            self.turns[neighbour as usize] = self.turn_at(neighbour);
        }
    }

    fn is_ear(&mut self, corner: u32) -> bool {
        *self.tries -= 1;
        if self.turns[corner as usize] != Ordering::Greater {
            return false;
        }
        let corners = self.triangle(corner).map(|i| self.at[i as usize]);
        let range = |axis: usize| {
            let [a, b, c] = corners.map(|corner| corner[axis]);
            let least = if a < b { a } else { b };
            let most = if a > b { a } else { b };
            [if c < least { c } else { least }, if c > most { c } else { most }]
        };
        let ([left, right], [low, high]) = (range(0), range(1));
        let start = self.blockers.partition_point(|&i| self.at[i as usize][0] < left);
        let near = self.blockers[start..].iter().map(|&i| i as usize);
        let near = near.take_while(|&i| self.at[i][0] <= right);
        let [a, b, c] = corners;
        let blocks = |i: usize| {
            let place = self.at[i];
            self.turns[i] != Ordering::Greater
                && low <= place[1]
                && place[1] <= high
                && ![a, b, c].contains(&place)
                && [(a, b), (b, c), (c, a)]
                    .into_iter()
                    .all(|(from, to)| turn(from, to, place) != Ordering::Less)
        };
        let mut tried = 0;
        let is_ear = !near.inspect(|_| tried += 1).any(blocks);
        *self.tries = self.tries.saturating_sub(tried);
        is_ear
    }
}
