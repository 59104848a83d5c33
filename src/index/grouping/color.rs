//! Largest First colouring \[Lei79\]: from the graph to groups.

use super::disc_tree::DiscTree;
use super::graph::{Graph, conflicts};
use super::rules::Rules;
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::scene::groups::{MAX_GROUPS, check_count};
use crate::scene::{Groups, Surfels};

/// What [`group`] found: a row of Table 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroupingReport {
    /// Surfels of the scene.
    pub surfels: u64,
    /// c.
    pub overlap: f32,
    /// K.
    pub groups: usize,
    /// Edges of the graph.
    pub edges: u64,
    /// The most edges at one surfel.
    pub max_degree: u32,
    /// Edges at a surfel, on the average.
    pub average_degree: f64,
}

/// Divides surfels into groups by the rules, see the [module](super).
///
/// # Errors
/// [`Error::Invalid`] as [`Rules::check`]; if there would be more than [`MAX_GROUPS`]; if more than
/// 64 pairs a surfel, and a million, overlap.
pub fn group(
    surfels: &Surfels,
    rules: &Rules,
    exec: &Exec,
    progress: &dyn Fn(&str, u64, u64),
) -> Result<(Groups, GroupingReport)> {
    rules.check()?;
    progress("sorting surfels", 0, 1);
    let tree = DiscTree::new(surfels, 0..surfels.len() as u32);
    let (color, report) = color(surfels, &tree, rules, rules.overlap, exec, progress)?;
    if report.groups > MAX_GROUPS {
        return Err(Error::Invalid(format!(
            "c = {} needs {} groups, and at most {MAX_GROUPS} can be: give a lower c or smaller radii",
            rules.overlap, report.groups
        )));
    }
    Ok((groups(&tree, &color, report.groups)?, report))
}

/// As [`group`], with the largest c that gives at most `count` groups, as the [module](super)
/// defines it.
///
/// # Errors
/// [`Error::Invalid`] as [`Rules::check`], and if `count` is not in 1 to [`MAX_GROUPS`].
pub fn group_into(
    surfels: &Surfels,
    rules: &Rules,
    count: usize,
    exec: &Exec,
    progress: &dyn Fn(&str, u64, u64),
) -> Result<(Groups, GroupingReport)> {
    rules.check()?;
    check_count(count)?;
    progress("sorting surfels", 0, 1);
    let tree = DiscTree::new(surfels, 0..surfels.len() as u32);
    let colored = |c: f32| color(surfels, &tree, rules, c, exec, progress);
    // c = 0 has no edges, and so fits; what is above the c of the rules does not.
    let mut best = colored(0.0)?;
    let (mut fits, mut fails) = (0, (64.0 * rules.overlap) as u16 + 1);
    while fails - fits > 1 {
        let middle = u16::midpoint(fits, fails);
        match colored(f32::from(middle) / 64.0) {
            Ok(found) if found.1.groups <= count => (fits, best) = (middle, found),
            _ => fails = middle,
        }
    }
    let (color, report) = best;
    Ok((groups(&tree, &color, report.groups)?, report))
}

/// The colour of every place, by the rules with another c.
fn color(
    surfels: &Surfels,
    tree: &DiscTree,
    rules: &Rules,
    overlap: f32,
    exec: &Exec,
    progress: &dyn Fn(&str, u64, u64),
) -> Result<(Vec<u32>, GroupingReport)> {
    let graph = conflicts(surfels, tree, rules, overlap, exec, progress)?;
    progress("colouring", 0, 1);
    let color = largest_first(&graph, &tree.surfel);
    let n = surfels.len();
    let report = GroupingReport {
        surfels: n as u64,
        overlap,
        groups: color.iter().fold(0, |most, &color| most.max(color)) as usize + 1,
        edges: graph.edges(),
        max_degree: (0..n).map(|place| graph.degree(place)).fold(0, u32::max),
        average_degree: 2.0 * graph.edges() as f64 / n as f64,
    };
    Ok((color, report))
}

/// The groups of the colour of every place.
fn groups(tree: &DiscTree, color: &[u32], groups: usize) -> Result<Groups> {
    let mut own = vec![0; color.len()];
    for (&surfel, &color) in tree.surfel.iter().zip(color) {
        own[surfel as usize] = color as u8;
    }
    Groups::new(own, Vec::new(), vec![1.0; groups])
}

/// The colour of every place: those with more neighbours first, of those with equally many the
/// lower `index`; each gets the smallest colour that no neighbour has.
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
