use super::*;
use proptest::prelude::*;

/// Boxes of all sizes, some equal, some without an extent. On a lattice all arithmetic with them is
/// exact.
fn boxes(lattice: bool) -> impl Strategy<Value = Vec<Item>> {
    let corner = || prop::array::uniform3(-1.0_f32..1.0);
    let one = (corner(), corner(), 0_u32..24, 1_u64..4);
    let scale = prop::sample::select(vec![1.0_f32, 1e-30, 1e30, 3.0]);
    (prop::collection::vec(one, 1..120), scale).prop_map(move |(all, scale)| {
        let item = |(at, extent, shift, weight): ([f32; 3], [f32; 3], u32, u64)| {
            let snap = |v: f32| if lattice { (v * 32.0).floor() / 32.0 } else { v };
            let shrink = if lattice { 1_u32 << (shift % 6) } else { 1 << shift };
            let low = Vec3::from_array(at.map(snap));
            let high = low + Vec3::from_array(extent.map(|e| snap(e.abs()))) / shrink as f32;
            let scale = if lattice { 1.0 } else { scale };
            Item { low: low * scale, high: high * scale, weight }
        };
        all.into_iter().map(item).collect()
    })
}

/// The definition on the page, item by item from the root down, with cells as cubes of real
/// numbers.
fn naive(items: &[Item], bound: u64) -> Vec<Vec<u32>> {
    let low = items.iter().fold(Vec3::INFINITY, |a, item| a.min(item.low)).as_dvec3();
    let high = items.iter().fold(Vec3::NEG_INFINITY, |a, item| a.max(item.high)).as_dvec3();
    let extent = (high - low).max_element();
    let mut side = f64::MIN_POSITIVE;
    while side < extent {
        side *= 2.0;
    }
    let side = if extent == 0.0 { 1.0 } else { side };
    let mut found = Vec::new();
    let mut level = vec![(low, side, (0..items.len() as u32).collect::<Vec<_>>())];
    while !level.is_empty() {
        let mut next = Vec::new();
        for (corner, side, all) in level {
            let (mut corner, mut side, mut all) = (corner, side, all);
            loop {
                let weight: u64 = all.iter().map(|&i| items[i as usize].weight).sum();
                let last = side * f64::from(1_u32 << 20) <= start_side(extent);
                let fits = |&i: &u32| {
                    let item = &items[i as usize];
                    let half = (item.high.as_dvec3() - item.low.as_dvec3()) / 2.0;
                    !last && half.max_element() <= side / 4.0
                };
                let leaf = weight <= bound || all.len() == 1;
                let (down, own): (Vec<u32>, Vec<u32>) = all.iter().partition(|&i| !leaf && fits(i));
                let mut parts = Vec::new();
                for octant in 0..8_u32 {
                    let half = side / 2.0;
                    let bit = |axis: u32| f64::from(octant >> axis & 1) * half;
                    let from = corner + DVec3::new(bit(0), bit(1), bit(2));
                    let inside = |&i: &u32| {
                        let item = &items[i as usize];
                        let m = (item.low.as_dvec3() + item.high.as_dvec3()) / 2.0;
                        (0..3).all(|axis| {
                            (m[axis] >= corner[axis] + half) == (bit(axis as u32) > 0.0)
                        })
                    };
                    let some: Vec<u32> = down.iter().copied().filter(inside).collect();
                    if !some.is_empty() {
                        parts.push((from, half, some));
                    }
                }
                if own.is_empty() && parts.len() == 1 {
                    (corner, side, all) = parts.remove(0);
                    continue;
                }
                found.push(own);
                next.extend(parts);
                break;
            }
        }
        level = next;
    }
    found
}

fn start_side(extent: f64) -> f64 {
    if extent == 0.0 { 1.0 } else { power_of_two(extent) }
}

proptest! {
    #[test]
    fn nodes_are_those_of_the_definition(items in boxes(true), bound in 1_u64..40) {
        let tree = octree(&items, bound);
        let own: Vec<Vec<u32>> = (0..tree.nodes.len() as u32).map(|n| tree.own(n).to_vec()).collect();
        prop_assert_eq!(own, naive(&items, bound));
    }

    #[test]
    fn every_item_is_in_one_node_and_in_its_loose_box(items in boxes(false), bound in 1_u64..40) {
        let tree = octree(&items, bound);
        let mut all = tree.order.clone();
        all.sort_unstable();
        prop_assert_eq!(all, (0..items.len() as u32).collect::<Vec<_>>());
        let root = &tree.nodes[0];
        let low = root.low.as_dvec3();
        let side = start_side((root.high.as_dvec3() - low).max_element());
        let mut seen = 1;
        for (number, node) in (0..).zip(&tree.nodes) {
            let own = tree.own(number);
            prop_assert!(own.is_sorted());
            prop_assert!(!own.is_empty() || node.children.len() > 1, "no chains");
            prop_assert_eq!(node.children.start, seen, "numbered by levels");
            seen = node.children.end;
            for child in node.children.clone() {
                prop_assert_eq!(tree.nodes[child as usize].parent, number);
                prop_assert!(tree.nodes[child as usize].depth > node.depth);
            }
            let weight: u64 = own.iter().map(|&i| items[i as usize].weight).sum();
            let below = node.children.clone().map(|c| tree.nodes[c as usize].weight).sum::<u64>();
            prop_assert_eq!(weight + below, node.weight);
            prop_assert!(node.children.is_empty() || node.weight > bound);
            let cell = side / f64::from(1_u32 << node.depth);
            for &i in own {
                let Item { low: a, high: b, .. } = items[i as usize];
                prop_assert!(node.low.cmple(a).all() && node.high.cmpge(b).all());
                let middle = (a.as_dvec3() + b.as_dvec3()) / 2.0 - low;
                let corner = (middle / cell).floor().min(DVec3::splat(side / cell - 1.0)) * cell;
                let slack = DVec3::splat(side * 1e-12);
                let loose = (corner - cell / 2.0 - slack, corner + cell * 1.5 + slack);
                let (a, b) = (a.as_dvec3() - low, b.as_dvec3() - low);
                prop_assert!(loose.0.cmple(a).all() && loose.1.cmpge(b).all());
                let half = ((b - a) / 2.0).max_element();
                let fits_a_child = half <= cell / 4.0 && node.depth < DEPTH;
                let split = !node.children.is_empty();
                prop_assert!(!(fits_a_child && split), "only what is too large stays above");
                prop_assert!(split || node.weight <= bound || own.len() == 1 || !fits_a_child);
            }
        }
        prop_assert_eq!(seen as usize, tree.nodes.len());
    }

    #[test]
    fn the_order_of_items_changes_no_box(items in boxes(false), bound in 1_u64..40) {
        let tree = octree(&items, bound);
        let reversed: Vec<Item> = items.iter().rev().copied().collect();
        let other = octree(&reversed, bound);
        let boxes = |tree: &Octree| tree.nodes.iter().map(|n| (n.low, n.high, n.weight)).collect::<Vec<_>>();
        prop_assert_eq!(boxes(&tree), boxes(&other));
    }
}

#[test]
fn nothing_and_what_falls_together() {
    assert_eq!(octree(&[], 1), Octree::default());
    let point = Item { low: Vec3::ONE, high: Vec3::ONE, weight: 5 };
    let tree = octree(&[point; 9], 7);
    assert_eq!((tree.nodes.len(), tree.nodes[0].weight, tree.nodes[0].items), (1, 45, 9));
    assert_eq!(tree.own(0), [0, 1, 2, 3, 4, 5, 6, 7, 8]);
}

#[test]
fn four_boxes_by_hand() {
    let at = |x: f32, y: f32, half: f32| Item {
        low: Vec3::new(x - half, y - half, 0.0),
        high: Vec3::new(x + half, y + half, 0.0),
        weight: 1,
    };
    // The root's side is 8. The large one stays; the two at the right share a cell of side 4.
    let items = [at(7.5, 1.0, 0.5), at(3.0, 3.0, 3.0), at(1.0, 7.0, 0.5), at(6.0, 2.0, 0.5)];
    let tree = octree(&items, 1);
    let own: Vec<&[u32]> = (0..tree.nodes.len() as u32).map(|n| tree.own(n)).collect();
    assert_eq!(own, [&[1][..], &[], &[2], &[0], &[3]]);
    let children: Vec<_> = tree.nodes.iter().map(|node| node.children.clone()).collect();
    assert_eq!(children, [1..3, 3..5, 5..5, 5..5, 5..5]);
    assert_eq!(octree(&items, 2).nodes.len(), 3);
}
