//! \[BJFM19\]: prefixes of orders.

use super::subject::{Subject, quiet};
use super::{Claim, Measured};
use crate::error::Result;
use crate::frame::Exec;
use crate::source::sampler::{Greedy, Progressive, Schedule, Start, quality, shuffled};
use glam::Vec3;
use std::time::Instant;

pub(super) const CLAIMS: [Claim; 4] = [
    Claim {
        id: "bjfm19-random",
        from: "[BJFM19] 3.3, Fig. 3",
        says: "a prefix is a significant improvement over points chosen uniformly at random",
        measured: "greatest distance of a point to the first twentieth, at most 0.8 times: `progressive`; `random`",
        at_most: 0.8,
        timed: false,
        more: "bjfm19.md",
        of: against_random,
    },
    Claim {
        id: "bjfm19-greedy",
        from: "[BJFM19] 3.3, Fig. 3",
        says: "a short prefix is only slightly different from the exact one",
        measured: "greatest distance of a point to the first twentieth, at most 1.25 times: `progressive`; `greedy`",
        at_most: 1.25,
        timed: false,
        more: "bjfm19.md",
        of: against_greedy,
    },
    Claim {
        id: "bjfm19-law",
        from: "[BJFM19] 4.1",
        says: "four times as many surfels are half as far apart",
        measured: "smallest distance in the greedy prefix of a fifth, times 2, by that of a twentieth, or the inverse if \
                   that is more; 1",
        at_most: 1.25,
        timed: false,
        more: "bjfm19.md",
        of: quarter,
    },
    Claim {
        id: "bjfm19-speed",
        from: "[BJFM19] 3.3",
        says: "the sampler is much faster than the exact greedy order: 180 ms against 15 s for 10 k points",
        measured: "ms for a tenth of the points: `progressive`; `greedy` of this crate",
        at_most: 1.0,
        timed: true,
        more: "bjfm19.md",
        of: speed,
    },
];

/// Points on the shape, a hundred for each row of the picture.
fn points(subject: &Subject<'_>) -> Result<Vec<Vec3>> {
    let count = 100 * subject.case.rows as usize;
    Ok(subject.of_count(count)?.scene.surfels.position().to_vec())
}

/// Progressive sampling as the paper says.
fn progressive() -> Progressive {
    Progressive { start: Start::Index(0), seed: 0, schedule: Schedule::Paper }
}

const EXACT: Greedy = Greedy { start: Start::Index(0) };

/// The greatest distance of a point to a prefix.
fn covering(points: &[Vec3], prefix: &[u32], exec: &Exec) -> Result<f64> {
    Ok(f64::from(quality(points, prefix, exec)?.covering).sqrt())
}

fn against_random(subject: &Subject<'_>) -> Result<Measured> {
    let (points, exec) = (points(subject)?, subject.exec);
    let count = points.len() / 20;
    let (first, second) =
        (progressive().order(&points, count, &quiet)?, shuffled(&points, 0, count, &quiet)?);
    let numbers = [covering(&points, &first.index, exec)?, covering(&points, &second.index, exec)?];
    Ok(Measured { numbers, pictures: Vec::new() })
}

fn against_greedy(subject: &Subject<'_>) -> Result<Measured> {
    let (points, exec) = (points(subject)?, subject.exec);
    let count = points.len() / 20;
    let (first, second) =
        (progressive().order(&points, count, &quiet)?, EXACT.order(&points, count, exec, &quiet)?);
    let numbers = [covering(&points, &first.index, exec)?, covering(&points, &second.index, exec)?];
    Ok(Measured { numbers, pictures: Vec::new() })
}

fn quarter(subject: &Subject<'_>) -> Result<Measured> {
    let (points, exec) = (points(subject)?, subject.exec);
    let order = EXACT.order(&points, points.len() / 5, exec, &quiet)?.index;
    let apart = |part: usize| -> Result<f64> {
        Ok(f64::from(quality(&points, &order[..points.len() / part], exec)?.packing).sqrt())
    };
    let ratio = 2.0 * apart(5)? / apart(20)?;
    let ratio = if ratio < 1.0 { 1.0 / ratio } else { ratio };
    Ok(Measured { numbers: [ratio, 1.0], pictures: Vec::new() })
}

fn speed(subject: &Subject<'_>) -> Result<Measured> {
    let (points, exec) = (points(subject)?, subject.exec);
    let count = points.len() / 10;
    let mut times = [Vec::new(), Vec::new()];
    for _ in 0..5 {
        let start = Instant::now();
        progressive().order(&points, count, &quiet)?;
        times[0].push(start.elapsed().as_secs_f64() * 1e3);
        let start = Instant::now();
        EXACT.order(&points, count, exec, &quiet)?;
        times[1].push(start.elapsed().as_secs_f64() * 1e3);
    }
    let numbers = times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    });
    Ok(Measured { numbers, pictures: Vec::new() })
}
