//! Order points by the paper's sampler: repeatedly take the farthest of some random points
//! \[BJFM19, 3.2\].
//!
//! Given are n finite points, a start, a seed and a count k. Squared distances are those of
//! [`super::greedy`]. The *rest* is a list that begins with all indices but the start, in ascending
//! order. Random numbers are [`random::bits`] of the seed and 1, 2, 3 ..., one after the other.
//! Rounds are counted from 0.
//!
//! # How a round draws its samples
//!
//! A round draws its number of samples, or all of the rest if there are fewer. For j = 0, 1, ...:
//! let L be the length of the rest less j, and b the next number. The item `floor(b L / 2^64)` of
//! the rest is swapped with the item L - 1. The samples are then at the end of the rest, from
//! L = the length backwards, and are removed from it. An accepted sample is used up, even at the
//! distance 0. Samples that are not used up return to the end of the rest, in the order in which
//! they were drawn.
//!
//! # [`Schedule::Paper`]
//!
//! 1. A round takes 200 samples, and accepts 1 + floor(round / 500) of them.
//! 2. Accept the sample whose squared distance to the nearest pick is largest; of equal ones, the
//!    lowest index. From then on it is a pick, for the other samples of the round too.
//! 3. Near samples are used up. A sample is near if its squared distance to the nearest pick is
//!    then 0, or less than 1/16 of the squared distance at which the last sample of the round was
//!    accepted.
//!
//! # [`Schedule::AsShipped`]
//!
//! 1. Round 0 takes 200 samples and accepts 0. After the rounds 0, 500, 1000 ... the number of
//!    samples is halved, rounded down, but not below 20. One more sample is then accepted in each
//!    round, up to 3/10 of the samples of a full round, rounded down, even where the rest has
//!    fewer.
//! 2. The samples are sorted by falling squared distance to the nearest pick of the rounds before;
//!    of equal ones, the lowest index comes first. The first ones are accepted.
//! 3. The next one is used up.
//!
//! # Rules of both schedules
//!
//! The order ends after k picks, even in the middle of a round, or when the rest is empty: there
//! may be fewer than k. The distance of a pick is its distance to all picks before it, as for every
//! [`Order`].
//!
//! `Decided:` in the paper "samples that are at close vicinity to the chosen samples can also be
//! removed": here, samples within a quarter of the distance that is then asked for. A removed
//! sample would only be picked at a quarter of that distance. `Decided:` if a round accepts
//! several, each is a pick for the next, as "all surfels chosen before" says. `AsShipped` is the
//! schedule of the authors' program as it was described to us; the program was not at hand.

use super::greedy::{Order, Start};
use super::nearest::{Known, Nearest, look};
use crate::error::Result;
use crate::memory;
use crate::number::{Real, random};
use crate::progress::Progress;
use glam::Vec3;

/// Initial number of samples of a round.
const SAMPLES: usize = 200;
/// The least number of samples of [`Schedule::AsShipped`].
const FEWEST: usize = 20;
/// The schedule changes after this many rounds.
const EVERY: u64 = 500;
/// A sample is near below this fraction of the squared distance at which the last one was accepted.
const NEAR: f32 = 1.0 / 16.0;
/// Bytes of a point that is also picked, while its arrays grow, and of its leaf.
const BYTES: u64 = 112;

/// How many samples a round takes, and how they are used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Schedule {
    /// The schedule of the paper's text.
    Paper,
    /// The schedule of the authors' program.
    AsShipped,
}

/// Picks of [`shuffled`] between two reports of progress.
const EACH: usize = 1 << 12;

/// The sampler, see the [module](self).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progressive {
    /// The first pick.
    pub start: Start,
    /// The random seed of the samples.
    pub seed: u64,
    /// How the samples are used.
    pub schedule: Schedule,
}

impl Progressive {
    /// The first `count` picks, or fewer; see the [module](self). `progress` gets the name of a
    /// step, the number of picks, and the most that there may be.
    ///
    /// # Errors
    /// As [`super::Greedy::order`].
    pub fn order(&self, points: &[Vec3], count: usize, progress: Progress<'_>) -> Result<Order> {
        let start = self.start.first_pick(points)?;
        memory::ask(points.len() as u64 * BYTES, || {
            format!("an order of {} points", points.len())
        })?;
        let count = count.min(points.len());
        let mut picks = Picks { points, near: Nearest::none(), order: Order::default() };
        if count > 0 {
            picks.add_point(start);
        }
        let mut indices: Vec<u32> = (0..points.len() as u32).collect();
        indices.remove(start as usize);
        let mut rest = Rest { indices, seed: self.seed, drawn: 0 };
        let (mut samples, mut accepted) = match self.schedule {
            Schedule::Paper => (SAMPLES, 1),
            Schedule::AsShipped => (SAMPLES, 0),
        };
        for round in 0_u64.. {
            if picks.order.index.len() >= count || rest.indices.is_empty() {
                break;
            }
            progress("picking points", picks.order.index.len() as u64, count as u64);
            let drawn = picks.look(rest.draw(samples));
            // The last round accepts only as many as are still wanted.
            let room = accepted.min(count - picks.order.index.len());
            match self.schedule {
                Schedule::Paper => {
                    rest.indices.extend(paper(&mut picks, drawn, room));
                    accepted = 1 + ((round + 1) / EVERY) as usize;
                }
                Schedule::AsShipped => {
                    rest.indices.extend(as_shipped(&mut picks, drawn, room));
                    if round % EVERY == 0 {
                        samples = (samples / 2).max(FEWEST);
                        accepted = (accepted + 1).min(samples * 3 / 10);
                    }
                }
            }
        }
        progress("picking points", count as u64, count as u64);
        Ok(picks.order)
    }
}

/// Accepts this many samples, each of which is a pick for the next; returns the samples that are
/// not used up.
fn paper(picks: &mut Picks<'_>, mut samples: Samples, accepted: usize) -> Vec<u32> {
    let mut last = 0.0;
    for _ in 0..accepted {
        let Some(new) = samples.take_farthest(&mut picks.near) else { break };
        last = new.1.most;
        picks.add(new);
        samples.known.iter_mut().for_each(|known| known.lower(new.1.place));
    }
    // Only the distance 0 is below the least positive number.
    let near = (NEAR * last).at_least(f32::from_bits(1));
    let mut known = samples.known.iter();
    samples.indices.retain(|_| known.next().is_some_and(|known| picks.near.is_beyond(known, near)));
    samples.indices
}

/// Accepts the samples farthest from the picks of earlier rounds; returns all others except the
/// next one.
fn as_shipped(picks: &mut Picks<'_>, mut samples: Samples, accepted: usize) -> Vec<u32> {
    let mut farthest = || samples.take_farthest(&mut picks.near);
    let used: Vec<Sample> = (0..accepted).map_while(|_| farthest()).collect();
    farthest();
    for i in 0..used.len() {
        let (index, mut known) = used[i];
        used[..i].iter().for_each(|(_, other)| known.lower(other.place));
        picks.add((index, known));
    }
    samples.indices
}

/// The index of a sample, and what is known of its squared distance to the nearest pick.
type Sample = (u32, Known);

/// The samples of a round, in the order of the draws.
struct Samples {
    indices: Vec<u32>,
    known: Vec<Known>,
}

impl Samples {
    /// Removes the sample that is farthest from the picks; of equal ones, the lowest index.
    fn take_farthest(&mut self, picks: &mut Nearest) -> Option<Sample> {
        let (mut best, mut at) = (0, None);
        for (i, (known, &index)) in self.known.iter_mut().zip(&self.indices).enumerate() {
            // Only what may be farther is worth a search.
            if key(known.most, index) > best {
                picks.refine(known);
                let key = key(known.most, index);
                if key > best {
                    (best, at) = (key, Some(i));
                }
            }
        }
        at.map(|at| (self.indices.remove(at), self.known.remove(at)))
    }
}

/// The sample of the largest key is accepted next. Keys are positive, because indices are below
/// 2^32 - 1.
#[inline(always)]
fn key(most: f32, index: u32) -> u64 {
    u64::from(most.to_bits()) << 32 | u64::from(!index)
}

/// The picks so far.
struct Picks<'a> {
    points: &'a [Vec3],
    near: Nearest,
    order: Order,
}

impl Picks<'_> {
    /// Looks how far samples are from the picks, at most.
    fn look(&self, drawn: Vec<u32>) -> Samples {
        // A loop of its own, so that the reads from memory overlap.
        let mut known: Vec<Known> =
            drawn.iter().map(|&i| Known::nothing(self.points[i as usize])).collect();
        look(&self.near, &mut known);
        Samples { indices: drawn, known }
    }

    /// Adds a sample whose distance is known exactly.
    fn add(&mut self, (index, known): Sample) {
        self.order.index.push(index);
        self.order.distance.push(known.most);
        self.near.add(&known);
    }

    /// Adds a point.
    fn add_point(&mut self, index: u32) {
        let mut known = Known::nothing(self.points[index as usize]);
        self.near.refine(&mut known);
        self.add((index, known));
    }
}

/// The points that are neither picked nor used up.
struct Rest {
    indices: Vec<u32>,
    seed: u64,
    /// How many random numbers have been drawn.
    drawn: u64,
}

impl Rest {
    /// Draws samples and removes them, in the order of the draws.
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

/// All points in random order: by ascending [`random::bits`] of the seed and their indices; of
/// equal ones, the lowest index first. `progress` as in [`Progressive::order`].
///
/// # Errors
/// As [`super::Greedy::order`].
pub fn shuffled(points: &[Vec3], seed: u64, count: usize, progress: Progress<'_>) -> Result<Order> {
    Start::Seed(seed).first_pick(points)?;
    memory::ask(points.len() as u64 * BYTES, || format!("an order of {} points", points.len()))?;
    let mut keys: Vec<(u64, u32)> =
        (0..points.len() as u32).map(|i| (random::bits(seed, u64::from(i)), i)).collect();
    keys.sort_unstable();
    let mut picks = Picks { points, near: Nearest::none(), order: Order::default() };
    let count = count.min(keys.len());
    for (done, &(_, index)) in keys[..count].iter().enumerate() {
        if done.is_multiple_of(EACH) {
            progress("picking points", done as u64, count as u64);
        }
        picks.add_point(index);
    }
    progress("picking points", count as u64, count as u64);
    Ok(picks.order)
}

#[cfg(test)]
mod tests;
