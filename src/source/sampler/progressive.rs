//! The paper's sampler: of some points by chance the farthest \[BJFM19, 3.2\].
//!
//! Given are n finite points, a start, a seed and a count k. Squared distances are those of
//! [`super::greedy`]. The *rest* is a list, at first all indices but the start, ascending. Numbers by chance are
//! [`random::bits`] of the seed and 1, 2, 3 ..., one after the other. Rounds are counted from 0.
//!
//! # Samples of a round
//!
//! As many as the round takes, or all of the rest if it has no more. For j = 0, 1, ...: with L the length of
//! the rest less j, and b the next number, the item `floor(b L / 2^64)` of the rest changes places with the item
//! L - 1. The samples are what then stands at the end of the rest, from L = the length backwards; they are taken
//! out of it. Samples that are accepted are used up, at the distance 0 too. Samples that are not used up return
//! to the end of the rest, in the order in which they were drawn.
//!
//! # [`Schedule::Paper`]
//!
//! 1. A round takes 200 samples, and accepts 1 + floor(round / 500) of them.
//! 2. To accept: of the samples the one whose squared distance to the nearest pick is largest, of equal ones
//!    that of the lowest index. It is a pick from then on, for the other samples of the round too.
//! 3. Near samples are used up: those whose squared distance to the nearest pick then is 0, or less than
//!    1/16 of that at which the last one of the round was accepted.
//!
//! # [`Schedule::AsShipped`]
//!
//! 1. Round 0 takes 200 samples and accepts 0. After the rounds 0, 500, 1000 ... the samples are halved, rounded
//!    down, but not below 20, and one more is accepted, at most 3/10 of the samples, rounded down; the samples of a
//!    full round, also where the rest has fewer.
//! 2. The samples are put in falling order of their squared distances to the nearest pick of the rounds before, of
//!    equal ones the lowest index first. The first ones are accepted.
//! 3. The next one is used up.
//!
//! # Both
//!
//! The order ends after k picks, in the middle of a round if need be, or when the rest is empty: there may be
//! fewer than k.
//! The distance of a pick is that to all picks before it, as for every [`Order`].
//!
//! `Decided:` in the paper "samples that are at close vicinity to the chosen samples can also be removed": here
//! within a quarter of the distance that is then asked for. What is removed would be picked when four times as
//! near. `Decided:` of several accepted in a round each is a pick for the next, as "all surfels chosen before" says.
//! `AsShipped` is the schedule of the authors' program as it was described to us; the program was not at hand.

use super::greedy::{Order, Start, squared_distance};
use super::nearest::Nearest;
use crate::error::Result;
use crate::memory;
use crate::number::random;
use crate::progress::Progress;
use glam::Vec3;

/// Samples of a round, at first.
const SAMPLES: usize = 200;
/// The fewest samples of [`Schedule::AsShipped`].
const FEWEST: usize = 20;
/// Rounds after which the schedule changes.
const EVERY: u64 = 500;
/// A near sample: this part of the squared distance of the last one accepted.
const NEAR: f32 = 1.0 / 16.0;
/// What a point takes that is picked too, its arrays growing, and the cells for it.
const BYTES: u64 = 144;

/// How many samples a round takes, and what becomes of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Schedule {
    /// The paper's text.
    Paper,
    /// The authors' program.
    AsShipped,
}

/// Picks of [`shuffled`] that are told at once.
const EACH: usize = 1 << 12;

/// The sampler, see the [module](self).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progressive {
    /// The first pick.
    pub start: Start,
    /// What the samples are drawn by.
    pub seed: u64,
    /// How they are used.
    pub schedule: Schedule,
}

/// A sample: its squared distance to the nearest pick, and its index.
type Sample = (f32, u32);

impl Progressive {
    /// The first `count` picks, or fewer; see the [module](self). `progress` is told the name of a step, how many
    /// picks there are, and how many there may be.
    ///
    /// # Errors
    /// As [`super::Greedy::order`].
    pub fn order(&self, points: &[Vec3], count: usize, progress: Progress<'_>) -> Result<Order> {
        let start = self.start.first_pick(points)?;
        memory::ask(points.len() as u64 * BYTES, || {
            format!("an order of {} points", points.len())
        })?;
        let count = count.min(points.len());
        let mut picks = Picks { points, near: Nearest::within(points), order: Order::default() };
        if count > 0 {
            picks.add(start);
        }
        let mut rest = Rest {
            indices: (0..points.len() as u32).filter(|&i| i != start).collect(),
            seed: self.seed,
            drawn: 0,
        };
        let (mut samples, mut accepted) = match self.schedule {
            Schedule::Paper => (SAMPLES, 1),
            Schedule::AsShipped => (SAMPLES, 0),
        };
        for round in 0_u64.. {
            if picks.order.index.len() >= count || rest.indices.is_empty() {
                break;
            }
            progress("picks", picks.order.index.len() as u64, count as u64);
            let drawn = rest.draw(samples);
            let room = accepted.min(count - picks.order.index.len());
            match self.schedule {
                Schedule::Paper => {
                    rest.indices.extend(paper(&mut picks, drawn, room));
                    accepted = 1 + ((round + 1) / EVERY) as usize;
                }
                Schedule::AsShipped => {
                    rest.indices.extend(as_shipped(&mut picks, &drawn, room));
                    if round % EVERY == 0 {
                        samples = (samples / 2).max(FEWEST);
                        accepted = (accepted + 1).min(samples * 3 / 10);
                    }
                }
            }
        }
        progress("picks", count as u64, count as u64);
        Ok(picks.order)
    }
}

/// Accepts so many of the samples, each a pick for the next; gives back those that are not used up.
fn paper(picks: &mut Picks<'_>, drawn: Vec<u32>, accepted: usize) -> Vec<u32> {
    let mut samples: Vec<Sample> = drawn.iter().map(|&i| (picks.distance(i), i)).collect();
    let mut last = 0.0;
    for _ in 0..accepted {
        let Some(best) =
            (0..samples.len()).reduce(|a, b| if before(samples[b], samples[a]) { b } else { a })
        else {
            break;
        };
        let (distance, index) = samples.remove(best);
        last = distance;
        picks.add(index);
        for (distance, other) in &mut samples {
            let new = squared_distance(picks.points[*other as usize], picks.points[index as usize]);
            if new < *distance {
                *distance = new;
            }
        }
    }
    let far = |&(distance, _): &Sample| distance > 0.0 && !(distance < NEAR * last);
    samples.into_iter().filter(far).map(|(_, index)| index).collect()
}

/// Accepts the farthest from the picks of the rounds before; gives back all others but the next.
fn as_shipped(picks: &mut Picks<'_>, drawn: &[u32], accepted: usize) -> Vec<u32> {
    let mut samples: Vec<Sample> = drawn.iter().map(|&i| (picks.distance(i), i)).collect();
    samples.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let used = &samples[..samples.len().min(accepted + 1)];
    used.iter().take(accepted).for_each(|&(_, index)| picks.add(index));
    drawn.iter().copied().filter(|i| used.iter().all(|(_, other)| other != i)).collect()
}

/// Whether a sample is accepted before another.
fn before(a: Sample, b: Sample) -> bool {
    a.0 > b.0 || (a.0 == b.0 && a.1 < b.1)
}

/// What has been picked.
struct Picks<'a> {
    points: &'a [Vec3],
    near: Nearest,
    order: Order,
}

impl Picks<'_> {
    fn distance(&self, index: u32) -> f32 {
        self.near.distance(self.points[index as usize])
    }

    fn add(&mut self, index: u32) {
        self.order.index.push(index);
        self.order.distance.push(self.distance(index));
        self.near.add(self.points[index as usize]);
    }
}

/// What has not been picked or used up.
struct Rest {
    indices: Vec<u32>,
    seed: u64,
    /// How many numbers have been drawn.
    drawn: u64,
}

impl Rest {
    /// Takes samples out, in the order in which they are drawn.
    fn draw(&mut self, samples: usize) -> Vec<u32> {
        let mut drawn = Vec::with_capacity(samples);
        for _ in 0..samples.min(self.indices.len()) {
            self.drawn += 1;
            let at = random::below(self.seed, self.drawn, self.indices.len() as u64);
            drawn.push(self.indices.swap_remove(at as usize));
        }
        drawn
    }
}

/// All points in an order by chance: by ascending [`random::bits`] of the seed and their indices, of equal ones
/// the lowest index first. `progress` is told as by [`Progressive::order`].
///
/// # Errors
/// As [`super::Greedy::order`].
pub fn shuffled(points: &[Vec3], seed: u64, count: usize, progress: Progress<'_>) -> Result<Order> {
    Start::Seed(seed).first_pick(points)?;
    memory::ask(points.len() as u64 * BYTES, || format!("an order of {} points", points.len()))?;
    let mut keys: Vec<(u64, u32)> =
        (0..points.len() as u32).map(|i| (random::bits(seed, u64::from(i)), i)).collect();
    keys.sort_unstable();
    let mut picks = Picks { points, near: Nearest::within(points), order: Order::default() };
    let count = count.min(keys.len());
    for (done, &(_, index)) in keys[..count].iter().enumerate() {
        if done.is_multiple_of(EACH) {
            progress("picks", done as u64, count as u64);
        }
        picks.add(index);
    }
    progress("picks", count as u64, count as u64);
    Ok(picks.order)
}

#[cfg(test)]
mod tests;
