//! Largest First colouring \[Lei79\].

use super::graph::Graph;

/// The colour of every place: those with more neighbours first, of those with equally many the lower
/// `index`; each gets the smallest colour that no neighbour has.
pub(super) fn largest_first(graph: &Graph, index: &[u32]) -> Vec<u32> {
    const NONE: u32 = u32::MAX;
    let mut order: Vec<u32> = (0..index.len() as u32).collect();
    order.sort_unstable_by_key(|&place| {
        (std::cmp::Reverse(graph.degree(place as usize)), index[place as usize])
    });
    let mut color = vec![NONE; index.len()];
    // For each colour, the last place that found it taken.
    let mut taken: Vec<u32> = Vec::new();
    for place in order {
        for &neighbour in graph.of(place as usize) {
            let theirs = color[neighbour as usize];
            if theirs != NONE {
                taken[theirs as usize] = place;
            }
        }
        let free = taken.iter().position(|&by| by != place).unwrap_or(taken.len());
        if free == taken.len() {
            taken.push(NONE);
        }
        color[place as usize] = free as u32;
    }
    color
}
