//! From surfels to the tree, and from the tree to the list.

use super::node::{Child, Disc, Leaves};
use super::{larger, longer};
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::index::point_tree::{Entry, divide};
use crate::memory;
use crate::scene::cloud::half_axes;
use crate::scene::objects::detail::sequential::{NONE, Sequential};
use crate::scene::{Cloud, Surfels};
use glam::Vec3;
use std::ops::Range;

/// Subtrees of up to this many surfels are built by one job.
const JOB: usize = 1 << 13;

/// The bits of `far` that a band ignores: all of the mantissa except two.
const BAND: u32 = 21;

/// An upper estimate of the memory that a surfel takes while the list is built.
const BYTES_A_SURFEL: u64 = 420;

/// A node in the order of the tree: before its children.
#[derive(Clone, Copy, Debug)]
struct Node {
    parent: u32,
    near: f32,
    far: f32,
    gap: f32,
    /// The place of a leaf in the tree; [`NONE`] for an inner node.
    leaf: u32,
    disc: Disc,
}

/// A subtree that a job has built, and its root as a child.
type Part = (Vec<Node>, Child);

pub(super) fn build(surfels: &Surfels, most: f32, exec: &Exec) -> Result<(Surfels, Sequential)> {
    let count = surfels.len();
    if count > 1 << 31 {
        return Err(Error::Invalid(format!(
            "a point tree of {count} surfels is too large, because nodes have 32-bit numbers; \
             split the model"
        )));
    }
    memory::ask(count as u64 * BYTES_A_SURFEL, || format!("a point tree of {count} surfels"))?;
    let ids = sorted(surfels.position(), exec);
    let mut discs = Vec::with_capacity(count);
    exec.extend(&mut discs, count, |place| Disc::from_surfel(surfels, ids[place]));
    let tangents = surfels.tangents().map(|all| ids.iter().map(|&id| all[id as usize]).collect());
    let nodes = grown(&Leaves { discs, tangents, most }, exec);
    listed(surfels, &ids, nodes, exec)
}

/// The surfels in the order of the tree's leaves.
fn sorted(points: &[Vec3], exec: &Exec) -> Vec<u32> {
    let mut entries: Vec<_> =
        points.iter().zip(0..).map(|(&point, id)| Entry { point, id }).collect();
    let mut parts = vec![&mut entries[..]];
    // The last part is the longest, because a high half is never shorter than its low half.
    while parts.last().is_some_and(|part| part.len() > JOB) {
        parts = exec.ordered(parts, halves).into_iter().flatten().collect();
    }
    exec.ordered(parts, sort);
    entries.into_iter().map(|entry| entry.id).collect()
}

/// Halves a range of two or more surfels.
fn halves(entries: &mut [Entry]) -> [&mut [Entry]; 2] {
    let (middle, _) = divide(entries);
    let (low, high) = entries.split_at_mut(middle);
    [low, high]
}

/// Halves a range down to single surfels.
fn sort(entries: &mut [Entry]) {
    if entries.len() > 1 {
        halves(entries).into_iter().for_each(sort);
    }
}

/// The ranges of a node's children.
fn quarters(range: &Range<usize>) -> impl Iterator<Item = Range<usize>> {
    let halves = |range: &Range<usize>| {
        let middle = range.start + range.len() / 2;
        [range.start..middle, middle..range.end]
    };
    halves(range).into_iter().flat_map(move |half| halves(&half)).filter(|part| !part.is_empty())
}

/// All nodes in the order of the tree.
fn grown(leaves: &Leaves, exec: &Exec) -> Vec<Node> {
    let all = 0..leaves.discs.len();
    if all.is_empty() {
        return Vec::new();
    }
    let mut nodes = Vec::new();
    let mut ranges = Vec::new();
    jobs(all.clone(), &mut ranges);
    let parts = exec.ordered(ranges, |range| {
        let mut nodes = Vec::with_capacity(2 * range.len());
        let root = grow(leaves, range, &mut nodes, None);
        (nodes, root)
    });
    // There are fewer nodes above the parts than parts.
    nodes.reserve_exact(parts.iter().map(|(nodes, _)| nodes.len() + 1).sum());
    let mut rest = Rest { parts: parts.into_iter(), exec };
    grow(leaves, all, &mut nodes, Some(&mut rest));
    nodes
}

/// Collects the subtrees, each for one job.
fn jobs(range: Range<usize>, to: &mut Vec<Range<usize>>) {
    if range.len() <= JOB {
        to.push(range);
    } else {
        quarters(&range).for_each(|part| jobs(part, to));
    }
}

/// The subtrees that the upper nodes join, and the threads that measure these nodes.
struct Rest<'a> {
    parts: std::vec::IntoIter<Part>,
    exec: &'a Exec,
}

/// Appends the nodes of a range.
fn grow(
    leaves: &Leaves,
    range: Range<usize>,
    nodes: &mut Vec<Node>,
    mut rest: Option<&mut Rest<'_>>,
) -> Child {
    let at = nodes.len();
    if range.len() <= JOB
        && let Some((part, root)) = rest.as_mut().and_then(|rest| rest.parts.next())
    {
        // A job has built this subtree; its parents are counted from where it is appended.
        let parent = |node: Node| if node.parent == NONE { NONE } else { node.parent + at as u32 };
        nodes.extend(part.into_iter().map(|node| Node { parent: parent(node), ..node }));
        return root;
    }
    let leaf = range.start;
    nodes.push(Node {
        parent: NONE,
        near: 0.0,
        far: f32::INFINITY,
        gap: 0.0,
        leaf: leaf as u32,
        disc: leaves.discs[leaf],
    });
    if range.len() == 1 {
        return leaves.child(leaf);
    }
    let (mut places, mut children) = (Vec::with_capacity(4), Vec::with_capacity(4));
    for part in quarters(&range) {
        places.push(nodes.len());
        children.push(grow(leaves, part, nodes, rest.as_deref_mut()));
    }
    let (own, disc) = leaves.parent(&children, range, rest.map(|rest| rest.exec));
    nodes[at] = Node { near: own.error, leaf: NONE, disc, ..nodes[at] };
    for (place, child) in places.into_iter().zip(children) {
        let gap = longer((child.center.as_dvec3() - own.center.as_dvec3()).length());
        nodes[place] = Node { parent: at as u32, far: own.error, gap, ..nodes[place] };
    }
    own
}

/// Puts the nodes into the order of the list.
fn listed(
    surfels: &Surfels,
    ids: &[u32],
    nodes: Vec<Node>,
    exec: &Exec,
) -> Result<(Surfels, Sequential)> {
    // The bits of floats that are not negative ascend as the floats do.
    let key = |(node, i): (&Node, u64)| u64::from(!node.far.to_bits() >> BAND) << 32 | i;
    let mut keys: Vec<u64> = nodes.iter().zip(0..).map(key).collect();
    exec.sort(&mut keys);
    let order: Vec<u32> = keys.into_iter().map(|key| key as u32).collect();
    let mut places = vec![0; nodes.len()];
    for (place, &node) in (0_u32..).zip(&order) {
        places[node as usize] = place;
    }
    let each = || order.iter().map(|&node| &nodes[node as usize]);
    let place_of = |node: u32| if node == NONE { NONE } else { places[node as usize] };
    let surfel_of = |leaf: u32| if leaf == NONE { NONE } else { ids[leaf as usize] };
    let surfel: Vec<u32> = each().map(|node| surfel_of(node.leaf)).collect();
    let tangents = |own: &[[Vec3; 2]]| -> Vec<_> {
        let of = |(node, &surfel): (&Node, &u32)| match own.get(surfel as usize) {
            Some(&own) => own,
            None => half_axes(node.disc.normal, node.disc.radius),
        };
        each().zip(&surfel).map(of).collect()
    };
    let cloud = Cloud {
        position: each().map(|node| node.disc.position).collect(),
        normal: Some(each().map(|node| node.disc.normal).collect()),
        radius: Some(each().map(|node| node.disc.radius).collect()),
        color: surfels.color().map(|_| each().map(|node| node.disc.color).collect()),
        opacity: surfels.opacity().map(|_| each().map(|node| node.disc.opacity).collect()),
        tangents: surfels.tangents().map(tangents),
        ..Cloud::default()
    };
    let near = each().map(|node| node.near).collect();
    let far: Vec<f32> = each().map(|node| node.far).collect();
    let gap: Vec<f32> = each().map(|node| node.gap).collect();
    let (far_from, gap_from) = (largest_from(&far), largest_from(&gap));
    let parent = each().map(|node| place_of(node.parent)).collect();
    let (nodes, dropped) = Surfels::new_or_none(cloud, exec)?;
    if dropped.total() > 0 {
        return Err(Error::Invalid(
            "the surfels are too far apart for a point tree, because a disc leaves the range of \
             f32; scale the model down"
                .into(),
        ));
    }
    Ok((nodes, Sequential { near, far, gap, far_from, gap_from, parent, surfel }))
}

/// The largest value from each place to the end.
fn largest_from(values: &[f32]) -> Vec<f32> {
    let mut largest = values.to_vec();
    for i in (1..values.len()).rev() {
        largest[i - 1] = larger(largest[i - 1], largest[i]);
    }
    largest
}
