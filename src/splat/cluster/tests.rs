use super::*;
use crate::frame::Exec;
use crate::index::clusters::Clusters;
use crate::number::{Ball, Truth};
use crate::scene::{Camera, Cloud, Lens, Pose, Projection, Surfels};
use crate::source::Shape;
use crate::splat::project::project_as;
use crate::splat::tests::ellipses;
use crate::splat::{Disc, Footprint, Splat, batch};
use glam::{DVec3, Vec3};

/// Surfels with neighbours one after the other: by cells of a coarse grid.
fn in_order(surfels: &Surfels) -> Surfels {
    let (low, high) = surfels.bounds();
    let cell = |i: &u32| {
        let at = (surfels.position()[*i as usize] - low) / (high - low).max_element() * 8.0;
        [at.x as u32, at.y as u32, at.z as u32]
    };
    let mut order: Vec<u32> = (0..surfels.len() as u32).collect();
    order.sort_by_key(cell);
    surfels.reordered(order.into_iter(), &Exec::sequential())
}

/// Views from outside and from inside, of parts, from afar, along the surface, and to no surfel at all.
fn cameras() -> Vec<Camera> {
    let shape = Shape::Torus;
    let whole = Camera::new(57, 43, shape.default_pose(), shape.default_lens()).unwrap();
    let pose = |eye: [f64; 3], target: [f64; 3]| Pose {
        eye: eye.into(),
        target: target.into(),
        up: DVec3::new(0.1, 1.0, 0.2),
    };
    let wide = Lens::FieldOfView(100.0);
    let seen = |pose, lens| Camera::new(64, 48, pose, lens).unwrap();
    let eye = whole.eye();
    let ortho = seen(shape.default_pose(), Lens::Orthographic(0.7));
    vec![
        Camera { near: 2.0, fx: 4.0 * whole.fx, ..whole },
        Camera { cx: 300.0, ..whole },
        seen(pose([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]), wide),
        seen(pose([0.0; 3], [1.0, 0.1, 0.3]), wide),
        seen(pose((eye * 1e4).into(), [0.0; 3]), Lens::FieldOfView(0.02)),
        seen(pose(eye.into(), (eye * 2.0).into()), wide),
        Camera { near: -1.0, ..ortho },
        ortho,
        whole,
    ]
}

const OUTLINES: [Outline; 3] = [Outline::Affine, Outline::Perspective, Outline::RayCast];

/// Surfels, kernels, and whether backs are culled.
fn each_case(mut check: impl FnMut(&Surfels, &Clusters, &Camera, &Kernel, bool)) {
    let discs = in_order(&Shape::Torus.surfels(9001, 3).unwrap());
    for surfels in [&discs, &ellipses(discs.clone())] {
        let clusters = Clusters::new(surfels, &Exec::sequential());
        for camera in cameras() {
            for (outline, low_pass) in OUTLINES.into_iter().flat_map(|o| [(o, 0.0), (o, 0.25)]) {
                let kernel = Kernel { outline, low_pass, ..Kernel::DEFAULT };
                for cull in [false, true] {
                    check(surfels, &clusters, &camera, &kernel, cull);
                }
            }
        }
    }
}

/// How many surfels of a scene are in clusters of a known fate, and what `each` finds of these.
fn known(
    projector: &Projector<f32>,
    (surfels, clusters): (&Surfels, &Clusters),
    mut each: impl FnMut(usize, Fate),
) -> [u64; 5] {
    let (view, mut counts) = (ClusterView::new(projector), [0; 5]);
    for (part, cluster) in clusters.parts(0..surfels.len()) {
        if let Some(fate) = view.fate(cluster) {
            counts[fate as usize] += part.len() as u64;
            part.for_each(|i| each(i, fate));
        }
    }
    counts
}

/// The bits of a splat.
fn bits(splat: &Splat<f32>) -> (Footprint<u32>, crate::frame::Rect, u32, bool) {
    (splat.footprint.map(f32::to_bits), splat.bounds, splat.surfel, splat.back)
}

#[test]
fn splats_and_tally_are_those_of_the_plain_projection() {
    let mut sums = [0; 5];
    each_case(|surfels, clusters, camera, kernel, cull| {
        let projector = Projector::new(View::new(camera), kernel, cull);
        let (mut plain, mut own) = (Vec::new(), Vec::new());
        // Neither end is the border of a cluster.
        let range = 13..surfels.len() - 5;
        let tally = batch::splats(&projector, surfels, range.clone(), |s| plain.push(bits(&s)));
        let at_once = batch::clustered_f32(&projector, surfels, (range, Some(clusters)), |s| {
            own.push(bits(&s));
        });
        assert!(own == plain, "{kernel:?} {camera:?}");
        assert_eq!(at_once, tally);
        let counts = known(&projector, (surfels, clusters), |_, _| ());
        sums = std::array::from_fn(|i| sums[i] + counts[i]);
    });
    let [visible, behind, degenerate, back_facing, outside] = sums;
    assert_eq!([visible, degenerate], [0; 2]);
    assert!(behind > 10_000 && back_facing > 10_000 && outside > 10_000, "{sums:?}");
}

/// Whatever a renderer's `f32` rounds: in balls no other fate is possible.
#[test]
fn no_rounding_gives_a_surfel_of_a_cluster_another_fate() {
    each_case(|surfels, clusters, camera, kernel, cull| {
        let balls = Projector::<Ball>::new(View::new(camera), kernel, cull);
        let projector = Projector::new(View::new(camera), kernel, cull);
        known(&projector, (surfels, clusters), |i, fate| {
            for crosses in [false, true] {
                let (_, reasons) = project_as(&balls, &batch::disc(surfels, i), i as u32, crosses);
                let before = reasons.behind | reasons.degenerate;
                let (certain, others) = match fate {
                    Fate::Behind => (reasons.behind, false.into()),
                    Fate::BackFacing => (reasons.back_facing, before),
                    _ => (reasons.outside, before | reasons.back_facing),
                };
                let surely = certain.certainly() && !others.possibly();
                assert!(surely, "{i} {fate:?} {reasons:?} {kernel:?} {camera:?}");
            }
        });
    });
}

/// A head-like scene is culled as far as the bounds allow: most of the back, and what is outside.
#[test]
fn most_of_a_back_is_culled() {
    let surfels = in_order(&Shape::Sphere.surfels(100_000, 1).unwrap());
    let clusters = Clusters::new(&surfels, &Exec::sequential());
    let camera =
        Camera::new(512, 512, Shape::Sphere.default_pose(), Shape::Sphere.default_lens()).unwrap();
    assert_eq!(camera.projection, Projection::Perspective);
    let projector = Projector::new(View::new(&camera), &Kernel::DEFAULT, true);
    let counts = known(&projector, (&surfels, &clusters), |_, _| ());
    assert!(counts[Fate::BackFacing as usize] > 30_000, "{counts:?}");
}

#[test]
fn a_cluster_holds_its_surfels() {
    let discs = in_order(&Shape::Torus.surfels(5003, 1).unwrap());
    for surfels in [&discs, &ellipses(discs.clone())] {
        let clusters = Clusters::new(surfels, &Exec::sequential());
        let mut next = 17;
        for (part, cluster) in clusters.parts(17..4999) {
            assert_eq!((part.start, part.is_empty()), (next, false));
            next = part.end;
            for i in part {
                let far = (surfels.position()[i].as_dvec3() - cluster.center.as_dvec3()).length();
                assert!(far <= cluster.radius.into());
                let off = (surfels.normal()[i].as_dvec3() - cluster.axis.as_dvec3()).length();
                assert!(off <= cluster.spread.into());
                let disc: Disc<f64> = batch::disc(surfels, i);
                assert!(disc.reach() <= cluster.reach.into());
                assert!(disc.reach() >= cluster.least.into());
            }
        }
        assert_eq!(next, 4999);
    }
}

#[test]
fn surfels_in_random_order_have_no_clusters() {
    let surfels = Shape::Torus.surfels(5000, 1).unwrap();
    for surfels in [surfels, Surfels::none()] {
        let clusters = Clusters::new(&surfels, &Exec::sequential());
        assert_eq!(clusters.parts(0..surfels.len()).count(), 0);
    }
}

/// A cluster of one ellipse counts on its size only if it is neither thin nor tilted.
#[test]
fn thin_and_tilted_ellipses_have_no_least_reach() {
    let least = |u: [f32; 3], v: [f32; 3]| {
        let tangents = Some(vec![[u.into(), v.into()]]);
        let surfels = Shape::Sphere.surfels(1, 0).unwrap().into_cloud();
        let normal = Some(vec![Vec3::Z]);
        let (surfels, _) = Surfels::new(Cloud { tangents, normal, ..surfels }).unwrap();
        let clusters = Clusters::new(&surfels, &Exec::sequential());
        clusters.parts(0..1).next().unwrap().1.least
    };
    assert!(least([2.0, 0.0, 0.0], [0.0, -0.25, 0.0]) > 1.99);
    assert_eq!(least([2.0, 0.0, 0.0], [0.0, 0.1, 0.0]), 0.0, "thin");
    assert_eq!(least([1.0, 0.0, 0.001], [0.0, 1.0, 0.0]), 0.0, "tilted");
}
