//! Extension (1): surfels of other groups are added to a group \[ZP06, section 4.2.2\].

use super::clipped::{DiscSamples, SAMPLES};
use super::disc_tree::DiscTree;
use super::graph::Graph;

/// The surfels that are added to group `k`, in the order in which they are.
///
/// The paper's queue needs no queue. A surfel is taken out at the priority p; if it has grown
/// since, it goes back with a larger one. All others were at p or below and have not been looked at
/// since: it is the first again, nothing has changed, and step 2b adds it. So each surfel is
/// decided when its turn comes, in the order of the priorities that step 1 gave.
pub(super) fn added(tree: &DiscTree, graph: &Graph, own: &[u8], k: u8, most: f32) -> Vec<u32> {
    let group = |place: usize| own[tree.surfel[place] as usize];
    let too_big = |covered: u64| covered.count_ones() as f32 / SAMPLES as f32 > most;
    let mut covered = vec![0; own.len()];
    let join = |covered: &mut [u64], place: usize| {
        let by = tree.disc(place);
        for &other in graph.of(place) {
            let mask = &mut covered[other as usize];
            if *mask != u64::MAX {
                *mask |= DiscSamples::of(tree.disc(other as usize)).covered_by(&by);
            }
        }
    };
    for place in (0..own.len()).filter(|&place| group(place) == k) {
        join(&mut covered, place);
    }
    let mut queue: Vec<(u32, u32, u32)> = (0..own.len())
        .filter(|&place| group(place) != k && !too_big(covered[place]))
        .map(|place| (covered[place].count_zeros(), tree.surfel[place], place as u32))
        .collect();
    // By priority, the largest first, and by index.
    queue.sort_unstable();
    let mut added = Vec::new();
    for (_, surfel, place) in queue {
        if !too_big(covered[place as usize]) {
            added.push(surfel);
            join(&mut covered, place as usize);
        }
    }
    added
}
