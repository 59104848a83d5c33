//! The loose octree, a node at a time.

use crate::oracle::kit::dice::Dice;
use glam::Vec3;
use splatref::source::hierarchy::octree::{Item, NO_NODE, Octree, octree};
use std::collections::{BTreeMap, VecDeque};

/// A node: parent, children, own items, depth, box, weight and number of all items.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Node {
    pub(crate) parent: u32,
    pub(crate) children: Vec<u32>,
    pub(crate) own: Vec<u32>,
    pub(crate) depth: u32,
    pub(crate) low: [f32; 3],
    pub(crate) high: [f32; 3],
    pub(crate) weight: u64,
    pub(crate) items: u32,
}

/// Where an item may go: its depth, and its place in the finest grid.
struct Place {
    depth: u32,
    grid: [u64; 3],
}

fn axis<T>(of: impl Fn(usize) -> T) -> [T; 3] {
    [of(0), of(1), of(2)]
}

/// The box around items, without -0.
fn around(items: &[Item], some: &[u32]) -> [[f32; 3]; 2] {
    let of = |i: &u32| [items[*i as usize].low, items[*i as usize].high].map(|v| v.to_array());
    let all = |k: usize, side: usize| {
        let mut all: Vec<f32> = some.iter().map(|i| of(i)[side][k]).collect();
        all.sort_by(f32::total_cmp);
        all
    };
    let low = axis(|k| all(k, 0)[0] + 0.0);
    let high = axis(|k| all(k, 1)[some.len() - 1] + 0.0);
    [low, high]
}

fn places(items: &[Item]) -> Vec<Place> {
    let all: Vec<u32> = (0..items.len() as u32).collect();
    let [low, high] = around(items, &all).map(|v| v.map(f64::from));
    let extent = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
    let mut side = 1.0_f64;
    if extent > 0.0 {
        while side < extent {
            side *= 2.0;
        }
        while side / 2.0 >= extent {
            side /= 2.0;
        }
    }
    let cells = 2.0_f64.powi(20);
    let place = |item: &Item| {
        let [a, b] = [item.low, item.high].map(|v| v.to_array().map(f64::from));
        let reach = (0..3).map(|k| (b[k] - a[k]) / 2.0).fold(0.0, f64::max);
        let fits = |d: &u32| reach <= side / 2.0_f64.powi(*d as i32 + 1);
        let depth = (0..=20).rev().find(fits).expect("the root has room");
        let grid = axis(|k| {
            let cell = (((a[k] + b[k]) / 2.0 - low[k]) / (side / cells)).floor();
            cell.min(cells - 1.0) as u64
        });
        Place { depth, grid }
    };
    items.iter().map(place).collect()
}

/// What stays in a node, and the items of its children, in their order.
fn divide(places: &[Place], some: &[u32], depth: u32) -> (Vec<u32>, Vec<Vec<u32>>) {
    let mut own = Vec::new();
    let mut children: BTreeMap<u64, Vec<u32>> = BTreeMap::new();
    for &i in some {
        let place = &places[i as usize];
        if place.depth > depth {
            let low = place.grid.map(|g| (g >> (20 - (depth + 1))) & 1);
            children.entry(low[0] + 2 * low[1] + 4 * low[2]).or_default().push(i);
        } else {
            own.push(i);
        }
    }
    (own, children.into_values().collect())
}

pub(crate) fn model(items: &[Item], bound: u64) -> Vec<Node> {
    if items.is_empty() {
        return Vec::new();
    }
    let places = places(items);
    let mut nodes: Vec<Node> = Vec::new();
    let mut waiting = VecDeque::from([(NO_NODE, 0, (0..items.len() as u32).collect::<Vec<_>>())]);
    while let Some((parent, mut depth, some)) = waiting.pop_front() {
        let weight = some.iter().map(|&i| items[i as usize].weight).sum();
        let (own, children) = loop {
            if some.len() <= 1 || weight <= bound {
                break (some.clone(), Vec::new());
            }
            let (own, children) = divide(&places, &some, depth);
            if !own.is_empty() || children.len() != 1 {
                break (own, children);
            }
            depth += 1;
        };
        let number = nodes.len() as u32;
        if let Some(above) = nodes.get_mut(parent as usize) {
            above.children.push(number);
        }
        waiting.extend(children.into_iter().map(|items| (number, depth + 1, items)));
        let [low, high] = around(items, &some);
        let items = some.len() as u32;
        nodes.push(Node { parent, children: Vec::new(), own, depth, low, high, weight, items });
    }
    nodes
}

fn same(name: &str, found: &Octree, truth: &[Node]) {
    let found: Vec<Node> = (0..found.nodes.len() as u32)
        .map(|i| {
            let node = &found.nodes[i as usize];
            assert_eq!(found.own(i), &found.order[node.own.start as usize..node.own.end as usize]);
            Node {
                parent: node.parent,
                children: node.children.clone().collect(),
                own: found.own(i).to_vec(),
                depth: node.depth,
                low: node.low.to_array(),
                high: node.high.to_array(),
                weight: node.weight,
                items: node.items,
            }
        })
        .collect();
    let bits = |node: &Node| [node.low, node.high].map(|corner| corner.map(f32::to_bits));
    let first = found.iter().zip(truth).find(|(a, b)| a != b || bits(a) != bits(b));
    assert_eq!(first, None, "{name}");
    assert_eq!(found.len(), truth.len(), "{name}");
}

/// Items of a shape: where they are, how large, and how heavy.
fn items(dice: &mut Dice, kind: usize, count: usize) -> Vec<Item> {
    let one = |dice: &mut Dice, i: usize| {
        let s = Vec3::ONE;
        let (middle, reach) = match kind {
            0 => (dice.vector(-s, s), Vec3::ZERO),
            1 => (dice.vector(-s, s), dice.vector(Vec3::ZERO, s * 0.01)),
            // Of all sizes, so that every depth has some; in a corner of the box there are many.
            2 => (dice.vector(-s, s), s * 2.0_f32.powi(-(dice.below(24) as i32))),
            3 => (dice.vector(-s, s) * 2.0_f32.powi(-(dice.below(30) as i32)), Vec3::ZERO),
            // At cells' borders, and of exactly their sides.
            4 => {
                let side = 2.0_f32.powi(-(dice.below(6) as i32));
                let cell = |dice: &mut Dice| dice.below(16) as f32 / 8.0;
                (Vec3::new(cell(dice), cell(dice), cell(dice)), s * side / 2.0)
            }
            5 => (Vec3::splat(1e30) * dice.vector(-s, s), Vec3::splat(1e28)),
            6 => (Vec3::splat(1e-40) * (dice.below(4) as f32), Vec3::ZERO),
            7 => (Vec3::splat(0.3), Vec3::ZERO),
            8 => (Vec3::new(i as f32, 1e6, -1e6), Vec3::ZERO),
            _ => (dice.vector(-s, s) * [1.0, -0.0][dice.below(2)], Vec3::ZERO),
        };
        let weight = if kind.is_multiple_of(2) { 1 } else { dice.below(20) as u64 };
        Item { low: middle - reach, high: middle + reach, weight }
    };
    (0..count).map(|i| one(dice, i)).collect()
}

#[test]
fn octrees_are_those_of_the_page() {
    let mut dice = Dice(4);
    let mut inner = 0;
    for kind in 0..10 {
        for count in [0, 1, 2, 3, 17, 300, 2000] {
            let items = items(&mut dice, kind, count);
            for bound in [0, 1, 10, 100, 5000] {
                let truth = model(&items, bound);
                same(&format!("{count} of {kind}, {bound}"), &octree(&items, bound), &truth);
                let all: usize = truth.iter().map(|node| node.own.len()).sum();
                assert_eq!(all, count);
                inner +=
                    truth.iter().filter(|n| !n.children.is_empty() && !n.own.is_empty()).count();
            }
        }
    }
    assert!(inner > 1000, "{inner} nodes keep items and have children");
}

/// What lies in the loose box of a cell lies there but for the rounding of its middle.
#[test]
fn items_lie_in_the_loose_boxes_of_their_cells() {
    let items = items(&mut Dice(9), 2, 2000);
    let all: Vec<u32> = (0..2000).collect();
    let [low, high] = around(&items, &all).map(|v| v.map(f64::from));
    let extent = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
    let root = (0..).map(|e| 2.0_f64.powi(e)).find(|s| *s >= extent).expect("a power");
    let tree = octree(&items, 1);
    for number in 0..tree.nodes.len() as u32 {
        let node = &tree.nodes[number as usize];
        let side = root / 2.0_f64.powi(node.depth as i32);
        for &own in tree.own(number).iter().take(if node.children.is_empty() { 0 } else { 9 }) {
            let item = &items[own as usize];
            for (k, low) in low.iter().enumerate() {
                let [a, b] = [item.low[k], item.high[k]].map(f64::from);
                let cell = (((a + b) / 2.0 - low) / side).floor() * side + low;
                assert!(a > cell - side / 2.0 - 1e-6 && b < cell + side * 1.5 + 1e-6, "{number}");
            }
        }
    }
}
