//! The graph and its colouring.

use super::super::disc_tree::DiscTree;
use super::super::graded::Graded;
use super::super::graph::{Graph, conflicts};
use super::*;
use crate::scene::groups::MAX_GROUPS;
use crate::source::Shape;
use std::borrow::Cow;

/// The neighbours of every surfel by the definition, ascending.
fn definition(surfels: &Surfels, rules: &Rules) -> Vec<Vec<usize>> {
    let edge = |i: usize, j: usize| {
        let d = place(surfels, i) - place(surfels, j);
        let both = reach(surfels, i) + reach(surfels, j);
        let near = f64::from(rules.overlap) * both;
        let (n, m) = (facing(surfels, i), facing(surfels, j));
        let opposite = rules.opposite && n.dot(m) < 0.0;
        let coplanar = rules.coplanar.is_some_and(|rule| {
            let off = f64::from(rule.offset) * both;
            let alike = surfels.color().is_none_or(|color| {
                let difference = (color[i].as_dvec3() - color[j].as_dvec3()).abs();
                difference.max_element() <= f64::from(rule.color)
            });
            n.dot(m) >= f64::from(rule.cosine)
                && d.dot(n).abs() <= off
                && d.dot(m).abs() <= off
                && alike
        });
        i != j && d.length_squared() < near * near && !opposite && !coplanar
    };
    let n = surfels.len();
    (0..n).map(|i| (0..n).filter(|&j| edge(i, j)).collect()).collect()
}

/// Largest First by repeated search for the next surfel.
fn naive_coloring(graph: &[Vec<usize>]) -> Vec<usize> {
    let mut color = vec![usize::MAX; graph.len()];
    for _ in 0..graph.len() {
        let mut next = None;
        for i in (0..graph.len()).filter(|&i| color[i] == usize::MAX) {
            if next.is_none_or(|best: usize| graph[i].len() > graph[best].len()) {
                next = Some(i);
            }
        }
        let next = next.unwrap();
        color[next] = (0..).find(|c| graph[next].iter().all(|&j| color[j] != *c)).unwrap();
    }
    color
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn the_graph_is_that_of_the_definition(surfels in scene(), rules in rules()) {
        let tree = DiscTree::new(&surfels, 0..surfels.len() as u32, &Exec::sequential());
        let exec = Exec::sequential();
        let graph = conflicts(&surfels, &tree, &rules, rules.overlap, &exec, &silent).unwrap();
        let mut found = vec![Vec::new(); surfels.len()];
        for (place, &surfel) in tree.surfel.iter().enumerate() {
            let neighbours = graph.of(place).all.iter().map(|&j| tree.surfel[j as usize] as usize);
            found[surfel as usize] = neighbours.collect();
            found[surfel as usize].sort_unstable();
        }
        prop_assert_eq!(found, definition(&surfels, &rules));
    }

    #[test]
    fn graded_edges_make_the_graph_of_each_c(surfels in scene(), rules in rules()) {
        let exec = Exec::sequential();
        let tree = DiscTree::new(&surfels, 0..surfels.len() as u32, &exec);
        let all = Graph::new(&tree, 1.0, |_, _| true, &exec, &silent).unwrap();
        let graded = Graded::new(Cow::Owned(all), &surfels, &tree, &rules, &exec, &silent).unwrap();
        let mut graph = Graph::default();
        for step in (0..=64).chain([7, 40, 3]) {
            graph = graded.upto(step, graph, &tree, &exec, &silent).unwrap();
            let own = conflicts(&surfels, &tree, &rules, f32::from(step) / 64.0, &exec, &silent);
            let own = own.unwrap();
            for place in 0..surfels.len() {
                let [mut a, mut b] = [&graph, &own].map(|graph| graph.of(place).all.to_vec());
                a.sort_unstable();
                b.sort_unstable();
                prop_assert_eq!(a, b, "c = {}/64", step);
            }
        }
    }

    #[test]
    fn groups_are_those_of_a_naive_largest_first(surfels in scene(), rules in rules()) {
        let graph = definition(&surfels, &rules);
        let color = naive_coloring(&graph);
        let k = color.iter().max().unwrap() + 1;
        let outcome = group(&surfels, &rules, &Exec::sequential(), &silent);
        if k > MAX_GROUPS {
            let line = outcome.unwrap_err().to_string();
            prop_assert!(line.contains(&format!("needs {k} groups")), "{}", line);
            return Ok(());
        }
        let (groups, report) = outcome.unwrap();
        let own: Vec<usize> = groups.own().iter().map(|&g| g.into()).collect();
        prop_assert_eq!(&own, &color);
        for (i, neighbours) in graph.iter().enumerate() {
            prop_assert!(neighbours.iter().all(|&j| own[i] != own[j]), "surfel {}", i);
        }
        let degrees = graph.iter().map(Vec::len);
        let most = degrees.clone().max().unwrap();
        prop_assert!(k <= most + 1);
        prop_assert_eq!((groups.len(), report.groups, report.max_degree), (k, k, most as u32));
        prop_assert_eq!(2 * report.edges, degrees.sum::<usize>() as u64);
        prop_assert!(groups.added().is_empty() && groups.scale().iter().all(|&s| s == 1.0));
    }

    #[test]
    fn a_count_of_groups_is_met_by_bisection(
        surfels in scene(), rules in rules(), count in 1..6_usize,
    ) {
        let fits = |step: u32| {
            let rules = Rules { overlap: step as f32 / 64.0, ..rules };
            *naive_coloring(&definition(&surfels, &rules)).iter().max().unwrap() < count
        };
        let (mut low, mut high) = (0, (rules.overlap * 64.0) as u32 + 1);
        while high > low + 1 {
            let middle = (low + high) / 2;
            if fits(middle) { low = middle } else { high = middle }
        }
        let exec = Exec::sequential();
        let (groups, report) = group_into(&surfels, &rules, count, &exec, &silent).unwrap();
        prop_assert_eq!(report.overlap, low as f32 / 64.0);
        prop_assert!(groups.len() <= count && report.overlap <= rules.overlap);
        let same = group(&surfels, &Rules { overlap: report.overlap, ..rules }, &exec, &silent);
        prop_assert_eq!((groups, report), same.unwrap());
    }
}

fn count(surfels: &Surfels, rules: &Rules) -> usize {
    group(surfels, rules, &Exec::sequential(), &silent).unwrap().1.groups
}

#[test]
fn discs_that_touch_do_not_overlap() {
    let pair = |x: f32| discs(&[[0.0; 3], [x, 0.0, 0.0]], &[1.0, 0.5]);
    let one = Rules::default();
    assert_eq!(count(&pair(1.5), &one), 1);
    assert_eq!(count(&pair(1.5_f32.next_down()), &one), 2);
    let half = Rules { overlap: 0.5, ..one };
    assert_eq!((count(&pair(0.75), &half), count(&pair(0.749), &half)), (1, 2));
}

#[test]
fn each_modification_takes_its_edges_away() {
    let two = |n: Vec3, z: f32, red: f32| {
        surfels(Cloud {
            position: vec![Vec3::ZERO, Vec3::new(0.5, 0.0, z)],
            normal: Some(vec![Vec3::Z, n]),
            radius: Some(vec![1.0, 1.0]),
            color: Some(vec![Vec3::ZERO, Vec3::new(red, 0.0, 0.0)]),
            ..Cloud::default()
        })
    };
    let opposite = Rules { opposite: true, ..Rules::default() };
    assert_eq!(count(&two(-Vec3::Z, 0.0, 0.0), &opposite), 1);
    assert_eq!(count(&two(-Vec3::Z, 0.0, 0.0), &Rules::default()), 2);
    assert_eq!(count(&two(Vec3::X, 0.0, 0.0), &opposite), 2, "perpendicular is not opposite");
    let rule = Coplanar { cosine: 0.5, offset: 0.125, color: 0.25 };
    let coplanar = Rules { coplanar: Some(rule), ..Rules::default() };
    assert_eq!(count(&two(Vec3::Z, 0.25, 0.25), &coplanar), 1);
    assert_eq!(count(&two(Vec3::Z, 0.26, 0.25), &coplanar), 2, "too far off");
    assert_eq!(count(&two(Vec3::Z, 0.25, 0.26), &coplanar), 2, "too different");
    assert_eq!(count(&two(Vec3::X, 0.0, 0.0), &coplanar), 2, "too steep");
}

#[test]
fn the_smallest_scenes_are_grouped() {
    let exec = Exec::sequential();
    let single = discs(&[[1.0, 2.0, 3.0]], &[0.5]);
    let (groups, report) = group(&single, &Rules::default(), &exec, &silent).unwrap();
    assert_eq!((groups.own(), groups.scale()), (&[0][..], &[1.0][..]));
    assert_eq!((report.groups, report.edges, report.average_degree), (1, 0, 0.0));
    let heap = |n| discs(&vec![[1.0; 3]; n], &vec![1.0; n]);
    assert_eq!(count(&heap(10), &Rules::default()), 10);
    assert_eq!(count(&heap(64), &Rules::default()), 64);
    assert_eq!(count(&heap(1000), &Rules { overlap: 0.0, ..Rules::default() }), 1);
    let line = group(&heap(65), &Rules::default(), &exec, &silent).unwrap_err().to_string();
    assert!(line.contains("c = 1 needs 65 groups"), "{line}");
    let line = group(&heap(200), &Rules::default(), &exec, &silent).unwrap_err().to_string();
    assert!(line.contains("c = 1 needs 200 groups"), "{line}");
    let (_, report) = group_into(&heap(65), &Rules::default(), 64, &exec, &silent).unwrap();
    assert_eq!((report.overlap, report.groups), (0.0, 1));
}

#[test]
fn a_complete_graph_of_many_is_refused_in_time() {
    let heap = discs(&vec![[1.0; 3]; 20_000], &vec![1.0; 20_000]);
    for coplanar in [None, Some(Coplanar { cosine: 0.5, offset: 0.1, color: 0.0 })] {
        let rules = Rules { coplanar, ..Rules::default() };
        let outcome = group(&heap, &rules, &Exec::new(2, 32).unwrap(), &silent);
        let line = outcome.unwrap_err().to_string();
        let pairs = 64 * 20_000 + (1 << 20);
        assert!(line.starts_with(&format!("more than {pairs} pairs of 20000")), "{line}");
    }
}

#[test]
fn a_huge_surfel_among_small_ones_is_a_group_of_its_own() {
    let small = 20_000;
    let shape = Shape::Sphere.surfels(small, 0).unwrap();
    let (_, without) = group(&shape, &Rules::default(), &Exec::sequential(), &silent).unwrap();
    let mut cloud = shape.into_cloud();
    cloud.position.insert(7, Vec3::ZERO);
    cloud.normal.as_mut().unwrap().insert(7, Vec3::Z);
    cloud.radius.as_mut().unwrap().insert(7, 100.0);
    cloud.color = None;
    let exec = Exec::sequential();
    let (groups, report) = group(&surfels(cloud), &Rules::default(), &exec, &silent).unwrap();
    assert_eq!(report.max_degree as usize, small);
    assert_eq!(groups.own()[7], 0, "it has the most edges");
    assert_eq!(groups.own().iter().filter(|&&g| g == 0).count(), 1);
    assert_eq!(report.groups, without.groups + 1);
    assert_eq!(report.edges, without.edges + small as u64);
}

#[test]
fn rules_out_of_range_are_refused() {
    let single = discs(&[[0.0; 3]], &[1.0]);
    let exec = Exec::sequential();
    for overlap in [-0.1, 1.1, f32::NAN] {
        let rules = Rules { overlap, ..Rules::default() };
        assert!(group(&single, &rules, &exec, &silent).is_err(), "{overlap}");
        assert!(group_into(&single, &rules, 4, &exec, &silent).is_err(), "{overlap}");
    }
    for count in [0, 65] {
        let line = group_into(&single, &Rules::default(), count, &exec, &silent).unwrap_err();
        assert_eq!(line.to_string(), format!("{count} groups; give 1 to 64"));
    }
}

#[test]
fn threads_change_nothing() {
    let shape = Shape::Cluster.surfels(8_000, 1).unwrap();
    let rules = Rules { opposite: true, ..Rules::default() };
    let with = |threads| {
        let exec = Exec::new(threads, 32).unwrap();
        let (groups, report) = group(&shape, &rules, &exec, &silent).unwrap();
        let add = extend(&shape, &groups, &Extension::Add { most: 0.5 }, &exec, &silent).unwrap();
        let enlarge = extend(&shape, &groups, &Extension::Enlarge, &exec, &silent).unwrap();
        (groups, report, add, enlarge)
    };
    let one = with(1);
    assert_eq!(one, with(2));
    assert_eq!(one, with(5));
}

#[test]
fn a_row_where_each_waits_for_the_last_is_settled() {
    // Against the order of the tree, each disc waits for the one before, and colours alternate.
    let n = 30_000_u16;
    let centers: Vec<[f32; 3]> = (0..n).rev().map(|i| [f32::from(i), 0.0, 0.0]).collect();
    let row = discs(&centers, &vec![0.75; centers.len()]);
    for threads in [1, 3] {
        let exec = Exec::new(threads, 32).unwrap();
        let (groups, _) = group(&row, &Rules::default(), &exec, &silent).unwrap();
        // The ends have one edge and come last.
        assert!(groups.own()[1..].iter().zip([0, 1].iter().cycle()).all(|(a, b)| a == b));
        let add = Extension::Add { most: 0.5 };
        let (all, _) = extend(&row, &groups, &add, &exec, &silent).unwrap();
        let sequential = extend(&row, &groups, &add, &Exec::sequential(), &silent).unwrap().0;
        assert_eq!(all, sequential);
    }
}

#[test]
fn progress_ends_where_it_says() {
    let shape = Shape::Sphere.surfels(270_000, 1).unwrap();
    let seen = std::cell::RefCell::new(Vec::new());
    let note = |what: &str, done, of| seen.borrow_mut().push((what.to_owned(), done, of));
    group(&shape, &Rules::default(), &Exec::sequential(), &note).unwrap();
    let seen = seen.into_inner();
    let steps: Vec<_> = seen.iter().filter(|s| s.0 == "finding overlaps").collect();
    assert!(steps.len() > 2 && steps.is_sorted_by_key(|s| s.1), "{steps:?}");
    assert_eq!((steps[0].1, steps[steps.len() - 1].1), (0, 270_000));
    assert!(seen.iter().all(|&(_, done, of)| done <= of));
}
