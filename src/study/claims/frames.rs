//! \[GBP04\]: only what is visible is splatted.

use super::subject::Subject;
use super::{Claim, Measured};
use crate::error::Result;
use crate::method::{deferred, ewa};

pub(super) const CLAIMS: [Claim; 2] = [
    Claim {
        id: "gbp04-culled",
        from: "[GBP04] 5, Table 1",
        says: "70 % of the points of a head are culled by the point selection",
        measured: "surfels that are splatted; all surfels: 0.3 times as many at most",
        at_most: 0.3,
        timed: false,
        more: "gbp04.md",
        of: culled,
    },
    Claim {
        id: "gbp04-speed",
        from: "[GBP04] 5, Table 1",
        says: "a head of 285 k points is drawn 39/34 times as fast with the selection",
        measured: "ms, at most 34/39 times: `deferred`; `ewa`",
        at_most: 34.0 / 39.0,
        timed: true,
        more: "gbp04.md",
        of: speed,
    },
];

/// The points of the paper's head.
const HEAD: usize = 285_000;

fn culled(subject: &Subject<'_>) -> Result<Measured> {
    let subject = subject.of_count(HEAD)?;
    let mut session = subject.session(deferred::Settings::default().into(), None)?;
    session.render(&subject.camera)?;
    let picture = session.render(&subject.camera)?;
    let selected: u32 = picture.seen.as_ref().map_or(0, |seen| seen.selected().iter().sum());
    let numbers = [f64::from(selected), subject.scene.surfels.len() as f64];
    Ok(Measured { numbers, pictures: Vec::new() })
}

fn speed(subject: &Subject<'_>) -> Result<Measured> {
    let subject = subject.of_count(HEAD)?;
    let numbers = subject.times([
        subject.session(deferred::Settings::default().into(), None)?,
        subject.session(ewa::Settings::default().into(), None)?,
    ])?;
    Ok(Measured { numbers, pictures: Vec::new() })
}
