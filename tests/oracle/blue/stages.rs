//! Every pixel against rays in world space: no disc is seen that is not there, and none is missing.

use super::cases::case;
use super::model::{Hit, World};
use crate::oracle::kit::case::Case;
use crate::oracle::kit::goldens;
use crate::oracle::kit::planes::{index, number};
use splatref::frame::{Frame, NO_ID};
use splatref::method::blue::Settings;
use splatref::number::Exact;
use splatref::scene::Primitives;

/// How many pixels were compared, and in how many nothing but one disc may be.
fn check<R: Exact>(case: &Case<Settings>, frame: &Frame<R>) -> [u64; 2] {
    let world = World::new(case);
    let mut counts = [0; 2];
    for (i, x, y) in case.pixels() {
        let hits = world.hits(x, y);
        let place = || format!("({x}, {y}) of {case:?}: {hits:?}");
        let (id, z) = (index(frame, "id", i), number(frame, "Z", i));
        let shown = hits.iter().find(|hit| hit.surfel == id);
        assert!(id == NO_ID || shown.is_some(), "{id} is not there: {}", place());
        let before = |hit: &&Hit| hit.certain && hit.t + hit.off < z && hit.surfel != id;
        let slack = shown.map_or(0.0, |hit| hit.off);
        let missing = hits.iter().filter(before).find(|hit| hit.t + hit.off < z - slack);
        assert!(missing.is_none(), "{missing:?} at {z} {}", place());
        if let Some(hit) = shown {
            assert!(!((hit.t - z).abs() > hit.off), "{hit:?} {}", place());
            let offset = number(frame, "discs.offset", i);
            let [square, off] = hit.offset;
            assert!(!((square - offset).abs() > off + 1e-30), "{hit:?} {offset} {}", place());
        }
        counts[0] += 1;
        let open = |hit: &Hit| !hit.certain && !(hit.t - hit.off > z + slack);
        counts[1] += u64::from(!hits.iter().any(open));
    }
    counts
}

#[test]
fn every_pixel_shows_the_nearest_disc_that_its_ray_meets() {
    let mut counts = [0; 2];
    for mut case in (0..200).map(case).chain(goldens::of()) {
        case.scene.primitives = Primitives::default();
        let single = check(&case, &case.drawing().frame::<f32>());
        let double = check(&case, &case.drawing().frame::<f64>());
        counts = [0, 1].map(|k| counts[k] + single[k] + double[k]);
    }
    let [all, sure] = counts;
    // Not so where discs are edge-on, which each arithmetic sees at another place.
    assert!(all > 100_000 && sure * 100 > all * 85, "{counts:?}");
}
