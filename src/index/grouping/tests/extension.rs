//! The two extensions.

use super::clipped::naive_cover;
use super::*;
use std::f64::consts::PI;

fn basic(surfels: &Surfels, overlap: f32) -> Groups {
    let rules = Rules { overlap, ..Rules::default() };
    group(surfels, &rules, &Exec::sequential(), &silent).unwrap().0
}

fn extended(surfels: &Surfels, groups: &Groups, extension: Extension) -> (Groups, Extended) {
    extend(surfels, groups, &extension, &Exec::sequential(), &silent).unwrap()
}

/// The samples of a surfel that the surfels `by` cover.
fn clipped(surfels: &Surfels, i: usize, by: &[usize], scale: f64) -> u64 {
    by.iter().filter(|&&j| j != i).fold(0, |m, &j| m | naive_cover(surfels, i, j, scale))
}

/// The covered area of some surfels, ascending, divided by pi.
fn covered_area(surfels: &Surfels, members: &[usize], scale: f64) -> f64 {
    let one = |(at, &i): (usize, &usize)| {
        let r = scale * reach(surfels, i);
        r * r * f64::from(clipped(surfels, i, &members[..at], scale).count_zeros()) / 64.0
    };
    members.iter().enumerate().map(one).sum()
}

fn members(groups: &Groups, k: usize) -> Vec<usize> {
    (0..groups.own().len())
        .filter(|&i| groups.of_surfel(i as u32).any(|g| usize::from(g) == k))
        .collect()
}

/// The paper's steps 1, 2, 2a and 2b with a queue.
fn queue(surfels: &Surfels, groups: &Groups, k: usize, most: f32) -> Vec<usize> {
    let mut group = members(groups, k);
    let clip = |group: &[usize], i: usize| clipped(surfels, i, group, 1.0).count_ones();
    let others = (0..surfels.len()).filter(|i| !group.contains(i));
    let mut queue: Vec<(u32, usize)> = others.map(|i| (clip(&group, i), i)).collect();
    while !queue.is_empty() {
        let mut first = 0;
        for at in 1..queue.len() {
            let ((p, i), (best, lowest)) = (queue[at], queue[first]);
            if p > best || (p == best && i < lowest) {
                first = at;
            }
        }
        let (p, i) = queue[first];
        let new = clip(&group, i);
        assert!(new >= p);
        if new as f32 / 64.0 > most {
            queue.remove(first);
        } else if new == p {
            group.push(i);
            queue.remove(first);
        } else {
            queue[first].0 = new;
        }
    }
    group.sort_unstable();
    group
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn adding_is_what_the_queue_of_the_paper_does(
        seed in 0..10_000_u64, most in prop::sample::select(vec![0.0_f32, 0.25, 0.5, 0.75, 1.0]),
    ) {
        let scene = cluttered(seed, 70, [8.0, 8.0, 0.5], 0.5);
        let groups = basic(&scene, 0.8);
        let (result, report) = extended(&scene, &groups, Extension::Add { most });
        prop_assert_eq!(result.own(), groups.own());
        prop_assert!(result.scale().iter().all(|&s| s == 1.0));
        prop_assert!(result.added().is_sorted());
        for k in 0..groups.len() {
            let found = members(&result, k);
            prop_assert_eq!(&found, &queue(&scene, &groups, k, most), "group {}", k);
            prop_assert_eq!(report.groups[k].surfels, found.len() as u64);
            for i in (0..70).filter(|i| !found.contains(i)) {
                let part = clipped(&scene, i, &found, 1.0).count_ones() as f32 / 64.0;
                prop_assert!(part > most, "surfel {} could be added", i);
            }
        }
        if most == 1.0 {
            prop_assert_eq!(result.added().len(), 70 * (groups.len() - 1));
        }
    }

    #[test]
    fn adding_is_so_among_more_neighbours_than_one_mask_holds(
        seed in 0..10_000_u64, most in prop::sample::select(vec![0.25_f32, 0.5, 0.75]),
    ) {
        let scene = cluttered(seed, 140, [2.0, 2.0, 0.3], 0.5);
        let groups = basic(&scene, 0.125);
        let (result, _) = extended(&scene, &groups, Extension::Add { most });
        let last = groups.len() - 1;
        for k in [0, last] {
            prop_assert_eq!(members(&result, k), queue(&scene, &groups, k, most), "group {}", k);
        }
    }

    #[test]
    fn the_report_is_that_of_a_naive_count(seed in 0..10_000_u64) {
        let scene = cluttered(seed, 60, [8.0, 8.0, 0.5], 0.5);
        let groups = basic(&scene, 1.0);
        let all: Vec<usize> = (0..60).collect();
        let target = covered_area(&scene, &all, 1.0);
        for extension in [Extension::None, Extension::Add { most: 0.5 }, Extension::Enlarge] {
            let (result, report) = extended(&scene, &groups, extension);
            let near = |a: f64, b: f64| (a - b).abs() <= 1e-12 * b;
            prop_assert!(near(report.area, PI * target));
            prop_assert_eq!(report.added, result.added().len() as u64);
            prop_assert!(near(report.percent, result.added().len() as f64 / 0.6));
            for (k, coverage) in report.groups.iter().enumerate() {
                let before = covered_area(&scene, &members(&groups, k), 1.0) / target;
                let scale = f64::from(result.scale()[k]);
                let after = covered_area(&scene, &members(&result, k), scale) / target;
                prop_assert_eq!(coverage.scale, result.scale()[k]);
                prop_assert!(near(coverage.before, before) && near(coverage.after, after));
                // Never less, except for sampling: one more disc may hide samples of another disc.
                prop_assert!(after > before - 0.02, "group {}: {} to {}", k, before, after);
            }
            if extension == Extension::None {
                prop_assert_eq!(&result, &groups);
            }
        }
    }

    #[test]
    fn enlarging_solves_eq_9_step_by_step(seed in 0..10_000_u64) {
        let scene = cluttered(seed, 60, [8.0, 8.0, 0.5], 0.5);
        let groups = basic(&scene, 1.0);
        let all: Vec<usize> = (0..60).collect();
        let target = covered_area(&scene, &all, 1.0);
        let (result, report) = extended(&scene, &groups, Extension::Enlarge);
        for k in 0..groups.len() {
            let group = members(&groups, k);
            let sum: f64 = group.iter().map(|&i| reach(&scene, i) * reach(&scene, i)).sum();
            let (mut scale, mut converged) = (1.0_f64, false);
            for _ in 0..MAX_STEPS {
                let clipped = scale * scale * sum - covered_area(&scene, &group, scale);
                let next = ((target + clipped) / sum).sqrt().max_of(1.0);
                if next >= 8.0 {
                    scale = 8.0;
                    break;
                }
                converged = (next - scale).abs() <= next / 512.0;
                scale = next;
                if converged {
                    break;
                }
            }
            prop_assert!((f64::from(result.scale()[k]) - scale).abs() < 1e-6 * scale);
            prop_assert_eq!(report.groups[k].converged, converged, "group {}", k);
        }
    }
}

#[test]
fn discs_apart_are_enlarged_in_one_step() {
    // A row of five discs with room between; the other group is one disc far away.
    let groups = |own: &[u8]| Groups::new(own.to_vec(), vec![], vec![1.0; 2]).unwrap();
    let row: Vec<[f32; 3]> = (0..5_u8).map(|i| [100.0 * f32::from(i), 0.0, 0.0]).collect();
    let scene = discs(&row, &[1.0, 1.0, 1.0, 1.0, 2.0]);
    let (result, report) = extended(&scene, &groups(&[0, 0, 0, 0, 1]), Extension::Enlarge);
    // A = 8 pi; 4 pi s^2 = 8 pi for the one group, and 4 pi s^2 = 8 pi for the other.
    let root = 2.0_f64.sqrt() as f32;
    assert_eq!(result.scale(), [root, root]);
    assert!(report.groups.iter().all(|g| g.converged));
    assert!((report.area - 8.0 * PI).abs() < 1e-14);
    let (result, report) = extended(&scene, &groups(&[0, 0, 1, 0, 0]), Extension::Enlarge);
    // 7 pi s^2 and pi s^2.
    let [most, eight] = [8.0 / 7.0, 8.0].map(|s: f64| s.sqrt() as f32);
    assert_eq!(result.scale(), [most, eight]);
    assert!(report.groups.iter().all(|g| (g.after - 1.0).abs() < 1e-6));
}

#[test]
fn a_group_that_cannot_cover_is_capped_and_says_so() {
    let centers: Vec<[f32; 3]> = (0..70_u8).map(|i| [10.0 * f32::from(i), 0.0, 0.0]).collect();
    let scene = discs(&centers, &[1.0; 70]);
    let mut own = vec![0; 70];
    own[3] = 1;
    let groups = Groups::new(own, vec![], vec![1.0; 3]).unwrap();
    let (result, report) = extended(&scene, &groups, Extension::Enlarge);
    assert_eq!(result.scale()[1..], [MAX_SCALE, 1.0], "one of 70, and none");
    let converged: Vec<bool> = report.groups.iter().map(|g| g.converged).collect();
    assert_eq!(converged, [true, false, false]);
    assert_eq!((report.groups[2].before, report.groups[2].after), (0.0, 0.0));
}

#[test]
fn an_extension_starts_from_the_groups_themselves() {
    let scene = cluttered(1, 60, [8.0, 8.0, 0.5], 0.5);
    let groups = basic(&scene, 1.0);
    let (added, _) = extended(&scene, &groups, Extension::Add { most: 0.5 });
    assert!(!added.added().is_empty());
    assert_eq!(extended(&scene, &added, Extension::None).0, groups);
    let enlarged = extended(&scene, &groups, Extension::Enlarge);
    assert_eq!(extended(&scene, &added, Extension::Enlarge), enlarged);
    assert_eq!(extended(&scene, &enlarged.0, Extension::Add { most: 0.5 }).0, added);
}

#[test]
fn one_group_of_all_stays_as_it_is() {
    let scene = cluttered(2, 60, [8.0, 8.0, 0.5], 0.5);
    let groups = basic(&scene, 0.0);
    let (result, report) = extended(&scene, &groups, Extension::Enlarge);
    assert_eq!(result, groups);
    assert!(report.groups[0].converged && report.groups[0].after == 1.0);
    assert_eq!(extended(&scene, &groups, Extension::Add { most: 1.0 }).0, groups);
}

#[test]
fn what_does_not_fit_is_refused() {
    let scene = cluttered(2, 5, [8.0, 8.0, 0.5], 0.5);
    let groups = basic(&scene, 1.0);
    let refused = |surfels, extension| {
        extend(surfels, &groups, &extension, &Exec::sequential(), &silent).unwrap_err().to_string()
    };
    for most in [-0.1, 1.5, f32::NAN] {
        let line = refused(&scene, Extension::Add { most });
        assert_eq!(line, format!("most: {most}; give 0 to 1"));
    }
    let line = refused(&cluttered(2, 6, [8.0, 8.0, 0.5], 0.5), Extension::None);
    assert_eq!(line, "the groups have 5 surfels, but the scene has 6");
}
