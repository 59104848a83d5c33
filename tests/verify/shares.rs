//! A share of pixels is at most 100 %: a verdict has no more undecided pixels than covered ones, and no more
//! without bounds, whatever planes the client hands in.

use crate::verify::empty_pixels::each_picture;
use splatref::frame::Frame;
use splatref::setting::Words;
use splatref::verdict::client::{Client, Rounding};

/// The picture with the planes that a function takes.
fn some(frame: &Frame<f32>, takes: impl Fn(&str) -> bool) -> Frame<f32> {
    let planes = frame.planes.iter().filter(|plane| takes(&plane.name)).cloned().collect();
    Frame { planes, ..*frame }
}

#[test]
fn no_share_is_above_1() {
    each_picture(true, &["plain", "opacities"], |name, (session, camera), (frame, _)| {
        // RGB alone, every plane alone and every plane but one.
        let alone = frame.planes.iter().map(|one| some(frame, |other| other == one.name));
        let without = frame.planes.iter().map(|one| some(frame, |other| other != one.name));
        // Large scenes have as many; these are enough for each kind of plane.
        let all: Vec<_> = alone.chain(without).collect();
        let step = all.len().div_ceil(40);
        for frame in all.iter().step_by(step).chain([&some(frame, str::is_empty)]) {
            let mut client = Client::from(frame);
            for (word, rounding) in Rounding::WORDS {
                client.rounding = *rounding;
                let verdict = session.verify(camera, &client, 0.02).unwrap();
                let [undecided, unbounded] = [verdict.undecided, verdict.unbounded];
                let pixels = u64::from(camera.width) * u64::from(camera.height);
                let what = format!("{name}, {word}: {undecided} and {unbounded}");
                assert!(undecided.max(unbounded) <= verdict.covered, "{what}");
                assert!(verdict.covered <= pixels, "{what}: {}", verdict.covered);
            }
        }
    });
}
