//! Claims of \[BJFM19\]: prefixes of orders.

use super::subject::{Subject, colors, median, quiet};
use super::{Claim, Measured};
use crate::error::Result;
use crate::frame::{Exec, Frame};
use crate::method::blue;
use crate::scene::{Cloud, Primitives, Similarity};
use crate::source::sampler::{Greedy, Progressive, Schedule, Start, quality, shuffled};
use crate::study::atlas::orders::{geometry, objects, seen};
use glam::Vec3;
use std::time::Instant;

pub(super) const CLAIMS: [Claim; 6] = [
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
        measured: "twice the smallest distance in the greedy prefix of a fifth, divided by the smallest distance in \
                   the prefix of a twentieth, or the inverse if that is greater; 1",
        at_most: 1.25,
        timed: false,
        more: "bjfm19.md",
        of: quarter,
    },
    Claim {
        id: "bjfm19-covers",
        from: "[BJFM19] 4.1",
        says: "the prefix of a surfel size covers every pixel of the object",
        measured: "holes, per mille: `blue` with discs of 4 px; limit",
        at_most: 1.0,
        timed: false,
        more: "bjfm19.md",
        of: covers,
    },
    Claim {
        id: "bjfm19-size",
        from: "[BJFM19] 4.3",
        says: "the quality of the picture depends on the size of the surfels, smaller is better",
        measured: "RMSE to the truth: `blue` with discs of 4 px; discs of 8 px",
        at_most: 1.0,
        timed: false,
        more: "bjfm19.md",
        of: smaller,
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

/// Progressive sampling as in the paper.
fn progressive() -> Progressive {
    Progressive { start: Start::Index(0), seed: 0, schedule: Schedule::Paper }
}

const EXACT: Greedy = Greedy { start: Start::Index(0) };

/// The largest distance of any point to a prefix.
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

/// The points in the greedy order, as many as the view needs with discs of this size in pixels.
fn discs<'e>(subject: &Subject<'e>, size: f32) -> Result<Subject<'e>> {
    let surfels = subject.of_count(100 * subject.case.rows as usize)?.scene.surfels;
    let count = surfels.len();
    let order = EXACT.order(surfels.position(), count, subject.exec, &quiet)?;
    let cloud = surfels.into_cloud().some(&order.index);
    let cloud = Cloud { radius: Some(vec![1.0; count]), tangents: None, ..cloud };
    let objects = objects(geometry(cloud, Primitives::default())?, &[Similarity::IDENTITY])?;
    Ok(subject.with(seen(&objects, size, &subject.camera, subject.exec)?.surfels))
}

fn in_discs(subject: &Subject<'_>, size: f32) -> Result<Frame<f32>> {
    discs(subject, size)?.draw(blue::Settings::default().into(), None)
}

fn covers(subject: &Subject<'_>) -> Result<Measured> {
    let (drawn, truth) = (in_discs(subject, 4.0)?, subject.truth()?);
    let numbers = [subject.error(&drawn, truth, "holes")?, 1.0];
    Ok(Measured { numbers, pictures: colors(&[&drawn, truth])? })
}

fn smaller(subject: &Subject<'_>) -> Result<Measured> {
    let (first, second) = (in_discs(subject, 4.0)?, in_discs(subject, 8.0)?);
    let truth = subject.truth()?;
    let error = |frame| subject.error(frame, truth, "rmse");
    let numbers = [error(&first)?, error(&second)?];
    Ok(Measured { numbers, pictures: colors(&[&first, &second, truth])? })
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
    Ok(Measured { numbers: times.map(median), pictures: Vec::new() })
}
