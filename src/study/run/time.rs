//! Times pictures by turns, so that a busy machine affects all candidates alike.

use super::bench::Bench;
use crate::error::Result;
use crate::frame::Exec;
use crate::number::random::below;
use crate::study::sweep::Candidate;
use std::time::{Duration, Instant};

/// The default number of rounds; in each round every candidate has a turn.
pub const ROUNDS: u64 = 5;
/// At most this many pictures are timed in a turn,
const PICTURES: usize = 3;
/// and none begins after the turn has taken this long.
const TURN: Duration = Duration::from_millis(150);
/// A picture that takes this long needs no warm-up, and has a turn only in the first
/// [`SLOW_ROUNDS`] rounds.
const SLOW: f64 = 1000.0;
const SLOW_ROUNDS: u64 = 3;

/// The name of the processor, if the system tells it, and the number of threads.
#[must_use]
pub fn machine(exec: &Exec) -> String {
    let known = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = known.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    let threads = exec.threads();
    format!("{}, {threads} threads", name.map_or(std::env::consts::ARCH, |(_, name)| name))
}

/// The order of candidates in a round: a permutation that depends only on these two numbers.
#[must_use]
pub fn order(round: u64, count: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    // From the last to the first, swap each with one of those up to it [Durstenfeld 1964].
    for i in (1..count).rev() {
        order.swap(i, below(round, i as u64, i as u64 + 1) as usize);
    }
    order
}

/// Runs the turn of a candidate in a round: draws one picture without timing it, and up to three
/// with timing, from the scene to shaded planes, in the memory of the picture before. Adds the
/// times in ms.
///
/// # Errors
/// As [`Bench::visit`] and as drawing.
pub fn turn(
    bench: &mut Bench,
    candidate: &Candidate,
    round: u64,
    times: &mut Vec<f64>,
    exec: &Exec,
) -> Result<()> {
    let is_slow = times.first().is_some_and(|first| *first >= SLOW);
    if is_slow && round >= SLOW_ROUNDS {
        return Ok(());
    }
    let mut visit = bench.visit(candidate, exec, &|_, _, _| ())?;
    let camera = visit.ready.camera;
    if !is_slow {
        candidate.file.output.draw(&mut visit.session, &camera)?;
    }
    let start = Instant::now();
    for _ in 0..PICTURES {
        let picture = Instant::now();
        candidate.file.output.draw(&mut visit.session, &camera)?;
        times.push(picture.elapsed().as_secs_f64() * 1e3);
        if start.elapsed() >= TURN {
            break;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_round_has_all_in_an_order_of_its_own() {
        for count in [0, 1, 7, 60] {
            let mut rounds: Vec<Vec<usize>> = (0..4).map(|round| order(round, count)).collect();
            assert!(count < 7 || rounds.windows(2).all(|two| two[0] != two[1]));
            for round in &mut rounds {
                round.sort_unstable();
                assert!(round.iter().copied().eq(0..count));
            }
        }
    }
}
