//! Checks vertices of clipped primitives against rays, and against each other.

use super::*;
use crate::frame::raster::Snap;
use crate::number::random::unit;

const NEAR: f32 = 0.125;

fn view<R: Exact>(perspective: bool, focal: f32) -> View<R> {
    let [fx, fy, cx, cy] = [focal, focal * 1.25, 300.0, 170.5].map(R::from_f32);
    let [o, width, height] = [0.0, 640.0, 360.0].map(R::from_f32);
    let near = R::from_f32(NEAR);
    View { rows: [[o; 4]; 3], perspective, fx, fy, cx, cy, near, width, height }
}

/// Corners near and far, before and behind the camera.
fn corner(seed: u64, i: u64) -> Vector3<f32> {
    let u = |k: u64| unit(seed, 4 * i + k);
    let scale = [0.5, 3.0, 100.0, 1e5][(u(3) * 4.0) as usize];
    Vector3::new((u(0) - 0.5) * scale, (u(1) - 0.5) * scale, (u(2) - 0.75) * scale)
}

fn in_r<R: Exact>(p: Vector3<f32>) -> Vector3<R> {
    Vector3::new(R::from_f32(p.x), R::from_f32(p.y), R::from_f32(p.z))
}

fn wide<R: Exact>(p: Vector3<R>) -> [f64; 3] {
    [p.x.to_f64(), p.y.to_f64(), p.z.to_f64()]
}

fn screen<R: Exact>(view: &View<R>, p: Vector3<R>) -> [f64; 2] {
    let [x, y, z] = wide(p);
    let s = if view.perspective { -z } else { 1.0 };
    let [fx, fy, cx, cy] = [view.fx, view.fy, view.cx, view.cy].map(R::to_f64);
    [cx + fx * x / s, cy - fy * y / s]
}

const VIEWS: [(bool, f32); 4] =
    [(true, 300.0), (true, 30_000.0), (false, 300.0), (false, 30_000.0)];

/// Checks every vertex of many triangles; returns how far beyond the guard band they are, in
/// pixels.
fn vertices_are_sound<R: Exact>(epsilon: f64) -> f64 {
    let (mut worst, mut cuts) = (0.0, 0);
    for (seed, (perspective, focal)) in (0..).zip(VIEWS) {
        let view = view::<R>(perspective, focal);
        let clip = Clip::new(&view);
        for i in 0..10_000 {
            let corners = [0, 1, 2].map(|k| in_r::<R>(corner(seed, 3 * i + k)));
            let polygon = clip.triangle(corners);
            assert!(polygon.is_empty() || (3..=8).contains(&polygon.len()));
            for v in &polygon {
                assert!(v.position.z <= -view.near, "{v:?}");
                let reach = screen(&view, v.position);
                for beyond in reach.map(|c| c.abs() - f64::from(GUARD_BAND)) {
                    worst = if beyond > worst { beyond } else { worst };
                }
                let weights = v.weights.map(R::to_f64);
                let sum: f64 = weights.iter().sum();
                // A cut rounds about 3 times, and there are 5 cuts.
                assert!((sum - 1.0).abs() < 16.0 * epsilon && weights.iter().all(|w| *w >= 0.0));
                for axis in 0..3 {
                    let parts = [0, 1, 2].map(|k| weights[k] * wide(corners[k])[axis]);
                    let size: f64 = parts.iter().map(|p| p.abs()).sum();
                    let error = wide(v.position)[axis] - parts.iter().sum::<f64>();
                    assert!(error.abs() <= 16.0 * epsilon * size, "{v:?} {corners:?}");
                }
                cuts += usize::from(weights.iter().all(|w| *w != 1.0));
            }
        }
    }
    assert!(cuts > 10_000, "{cuts}");
    worst
}

#[test]
fn vertices_are_inside_and_are_what_their_weights_say() {
    // The border is a quotient of sums of about 2^17 px, and is projected again: half a dozen
    // roundings.
    for (epsilon, check) in [
        (f64::from(f32::EPSILON) / 2.0, vertices_are_sound::<f32> as fn(f64) -> f64),
        (f64::EPSILON / 2.0, vertices_are_sound::<f64>),
    ] {
        let worst = check(epsilon);
        assert!(0.0 < worst && worst < 8.0 * epsilon * f64::from(GUARD_BAND), "{worst} px");
    }
    let guard = i64::from(GUARD_BAND) << 8;
    assert_eq!(Snap::default().fixed(GUARD_BAND as f32 + 1.0 / 32.0), guard);
}

/// Twice the signed area.
fn cross(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// The weights of the corners where the ray of a sample meets the triangle in front of the near
/// plane, by Cramer's rule on the corners themselves.
fn ray(view: &View<f64>, corners: &[Vector3<f64>; 3], at: [f64; 2]) -> Option<[f64; 3]> {
    let third = |p: &Vector3<f64>| if view.perspective { p.z } else { -1.0 };
    let columns = corners.each_ref().map(|p| Vector3::new(p.x, p.y, third(p)));
    let ray = Vector3::new((at[0] - view.cx) / view.fx, -(at[1] - view.cy) / view.fy, -1.0);
    let det = |[a, b, c]: [Vector3<f64>; 3]| a.dot(b.cross(c));
    let parts = [0, 1, 2].map(|k| {
        let mut with = columns;
        with[k] = ray;
        det(with) / det(columns)
    });
    let sum: f64 = parts.iter().sum();
    let weights = parts.map(|p| p / sum);
    let t: f64 = (0..3).map(|k| weights[k] * -corners[k].z).sum();
    (parts.iter().all(|p| *p >= 0.0) && t >= view.near).then_some(weights)
}

/// How many triangles of the fan cover a sample, and the weights there; `None` within 2^-10 px of
/// an edge, where rounding may decide.
fn fan(view: &View<f64>, fan: &[Clipped<f64, 3>], at: [f64; 2]) -> Option<(u32, [f64; 3])> {
    let (mut covered, mut weights) = (0, [0.0; 3]);
    for k in 2..fan.len() {
        let corners = [&fan[0], &fan[k - 1], &fan[k]];
        let [a, b, c] = corners.map(|v| screen(view, v.position));
        let parts = [[b, c], [c, a], [a, b]].map(|[q, r]| {
            let length = ((r[0] - q[0]) * (r[0] - q[0]) + (r[1] - q[1]) * (r[1] - q[1])).sqrt();
            (cross(q, r, at), length)
        });
        if parts.iter().any(|(area, length)| area.abs() <= length / 1024.0) {
            return None;
        }
        if parts.iter().all(|p| p.0 > 0.0) || parts.iter().all(|p| p.0 < 0.0) {
            covered += 1;
            let share =
                |i: usize| parts[i].0 / if view.perspective { -corners[i].position.z } else { 1.0 };
            let sum = share(0) + share(1) + share(2);
            weights = [0, 1, 2]
                .map(|k| (0..3).map(|i| corners[i].weights[k] * share(i)).sum::<f64>() / sum);
        }
    }
    Some((covered, weights))
}

#[test]
fn what_is_left_is_what_rays_meet() {
    let (mut met, mut missed) = (0, 0);
    for (seed, (perspective, focal)) in (10..).zip(VIEWS) {
        let view = view::<f64>(perspective, focal);
        let clip = Clip::new(&view);
        for i in 0..2_000 {
            let corners = [0, 1, 2].map(|k| in_r::<f64>(corner(seed, 3 * i + k)));
            let polygon = clip.triangle(corners);
            for k in 0..20 {
                let u = [0, 1].map(|axis| f64::from(unit(seed + 90, 40 * i + 2 * k + axis)));
                let reach = if k % 2 == 0 { 1_000.0 } else { f64::from(GUARD_BAND) };
                let at = u.map(|u| (2.0 * u - 1.0) * reach);
                let Some((covered, weights)) = fan(&view, &polygon, at) else { continue };
                let truth = ray(&view, &corners, at);
                assert_eq!(covered, u32::from(truth.is_some()), "{corners:?} {at:?}");
                if let Some(truth) = truth {
                    // Grazing triangles lose most of the 53 bits in the determinants.
                    let close = (0..3).all(|i| (weights[i] - truth[i]).abs() < 1e-6);
                    assert!(close, "{weights:?} {truth:?} {corners:?} {at:?}");
                    met += 1;
                } else {
                    missed += 1;
                }
            }
        }
    }
    assert!(met > 10_000 && missed > 10_000, "{met} {missed}");
}

#[test]
fn triangles_that_share_an_edge_share_its_vertices_and_a_segment_has_them_too() {
    let mut cut = 0;
    for (perspective, focal) in VIEWS {
        let clip = Clip::new(&view::<f32>(perspective, focal));
        for i in 0..5_000 {
            let [a, b, c, d] = [0, 1, 2, 3].map(|k| corner(20, 4 * i + k));
            let on_edge = |corners: [Vector3<f32>; 3], first: usize, second: usize| {
                let polygon = clip.triangle(corners);
                let third = 3 - first - second;
                let on = polygon.iter().filter(|v| v.weights[third] == 0.0);
                let pair = |v: &Clipped<f32, 3>| (v.position, v.weights[first], v.weights[second]);
                let mut on: Vec<_> = on.map(pair).collect();
                on.sort_by(|p, q| q.1.total_cmp(&p.1));
                on
            };
            let one = on_edge([a, b, c], 0, 1);
            assert_eq!(one, on_edge([d, b, a], 2, 1));
            let segment = clip.segment([a, b]);
            let pair = |v: Clipped<f32, 2>| (v.position, v.weights[0], v.weights[1]);
            assert_eq!(one, segment.map_or(Vec::new(), |ends| ends.map(pair).to_vec()));
            let reversed = clip.segment([b, a]);
            let pair = |v: Clipped<f32, 2>| (v.position, v.weights[1], v.weights[0]);
            assert_eq!(one, reversed.map_or(Vec::new(), |[p, q]| vec![pair(q), pair(p)]));
            cut += usize::from(one.len() == 2 && one[0].1 != 1.0);
        }
    }
    assert!(cut > 1_000, "{cut}");
}

#[test]
fn corners_inside_stay_as_they_are_and_cuts_are_where_they_must_be() {
    let clip = Clip::new(&view::<f64>(true, 300.0));
    let inside = [[0.5, 0.25, -3.0], [-1.0, 0.1, -0.125], [0.0, 7.0, -9.0]];
    let inside = inside.map(|[x, y, z]| Vector3::new(x, y, z));
    assert_eq!(clip.triangle(inside), whole(inside));
    // From t = 1.125 to t = -0.875: the near plane at 0.125 is half way.
    let ends = [Vector3::new(1.0, 0.5, -1.125), Vector3::new(3.0, 2.5, 0.875)];
    let middle = Clipped { position: Vector3::new(2.0, 1.5, -0.125), weights: [0.5, 0.5] };
    assert_eq!(clip.segment(ends), Some([whole(ends)[0], middle]));
    // A corner behind leaves four vertices, in the order of the triangle.
    let triangle = [ends[0], ends[1], Vector3::new(-1.0, 0.5, -1.125)];
    let weights: Vec<_> = clip.triangle(triangle).iter().map(|v| v.weights).collect();
    let expected = [[1.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.0, 0.5, 0.5], [0.0, 0.0, 1.0]];
    assert_eq!(weights, expected);
    // Orthographic cameras keep points behind the eye as long as they are in front of the near
    // plane.
    let flat = View { near: -4.0, ..view::<f64>(false, 300.0) };
    let behind = [0.0, 1.0, 2.0].map(|x| Vector3::new(x, x * x, 3.0));
    assert_eq!(Clip::new(&flat).triangle(behind), whole(behind));
    assert!(Clip::new(&flat).triangle(behind.map(|p| p * 2.0)).is_empty());
}

#[test]
fn what_is_no_number_gives_nothing() {
    let clip = Clip::new(&view::<f32>(true, 300.0));
    let good = Vector3::new(0.0, 0.0, -1.0);
    assert_eq!(clip.triangle([good; 3]), whole([good; 3]), "a point is inside");
    for bad in [f32::NAN, f32::INFINITY, -f32::INFINITY, f32::MAX, -f32::MAX] {
        for axis in 0..3 {
            let mut p = good;
            *[&mut p.x, &mut p.y, &mut p.z][axis] = bad;
            let far = bad.is_finite() && axis == 2;
            let kept = far && bad < 0.0;
            assert_eq!(clip.segment([good, p]).is_some(), far, "{p:?}");
            assert_eq!(clip.triangle([p, good, good]).is_empty(), !far, "{p:?}");
            assert_eq!(clip.triangle([p; 3]).is_empty(), !kept, "{p:?}");
        }
    }
}
