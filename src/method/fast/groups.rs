//! Sort the splats of a tile by group.

use super::tile::Record;
use crate::scene::Groups;

/// The own group of each splat. The loop does nothing else, because the groups are far away in
/// memory, and a short loop waits for many at once.
pub(crate) fn own(splats: &[Record], groups: &Groups) -> Vec<u8> {
    splats.iter().map(|splat| groups.own()[splat.surfel as usize]).collect()
}

/// The indices of a list of groups, sorted by group and then ascending, and the end of each group
/// that occurs.
pub(crate) fn sorted(groups: &[u8], count: usize) -> (Vec<u32>, Vec<usize>) {
    let mut next = vec![0; count];
    for &group in groups {
        next[usize::from(group)] += 1;
    }
    let mut ends = Vec::new();
    let mut sum = 0;
    for count in &mut next {
        let start = sum;
        sum += *count;
        if *count > 0 {
            ends.push(sum);
        }
        *count = start;
    }
    let mut order = vec![0; groups.len()];
    for (i, &group) in groups.iter().enumerate() {
        let place = &mut next[usize::from(group)];
        order[*place] = i as u32;
        *place += 1;
    }
    (order, ends)
}
