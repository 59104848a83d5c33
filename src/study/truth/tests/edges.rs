//! Rays through edges and corners, and triangles around the camera.

use super::*;
use crate::frame::Rect;
use crate::number::Vector3;
use crate::splat::View;
use crate::study::truth::rays::Rays;
use crate::study::truth::triangles::Placed;
use proptest::prelude::*;

fn triangles(surface: &Surface) -> &Triangles {
    let Surface::Triangles(triangles) = surface else { panic!("no triangles") };
    triangles
}

/// Pseudo-random numbers in [-1, 1].
fn signed(seed: u64, i: u64) -> f32 {
    2.0 * unit(seed, i) - 1.0
}

/// The surface of a cube, cut into 2 n^2 triangles a face; each point is at a random distance from
/// the centre, 1/2 to 1.
fn rock(seed: u64, n: i32) -> Triangles {
    let mut places: Vec<[i32; 3]> = Vec::new();
    let mut corner = |p: [i32; 3]| {
        let at = places.iter().position(|q| *q == p);
        at.unwrap_or_else(|| {
            places.push(p);
            places.len() - 1
        }) as u32
    };
    let mut corners = Vec::new();
    for axis in 0..3 {
        for side in [0, n] {
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                let mut at = |i: i32, j: i32| {
                    let mut p = [side; 3];
                    (p[(axis + 1) % 3], p[(axis + 2) % 3]) = (i, j);
                    corner(p)
                };
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                let front = [[a, b, c], [a, c, d]];
                corners.extend(if side == n { front } else { front.map(|[a, b, c]| [a, c, b]) });
            }
        }
    }
    let put = |(k, p): (u64, &[i32; 3])| {
        let out = Vec3::from_array(p.map(|v| 2.0 * v as f32 / n as f32 - 1.0)).normalize();
        out * (0.75 + 0.25 * signed(seed, k))
    };
    let position: Vec<Vec3> = (0..).zip(&places).map(put).collect();
    let (direction, radius) = (vec![Vec3::Z; position.len()], vec![0.0; position.len()]);
    let vertices = Vertices { position, direction, radius, color: None, ..Vertices::default() };
    Triangles::new(vertices, corners).unwrap().0
}

fn placed(of: &Triangles, camera: &Camera) -> Vec<Placed> {
    let view = View::new(camera);
    (0..of.len() as u32).map(|i| Placed::new(of, i, &view)).collect()
}

/// Any camera that looks at the origin from a distance of 3.
fn any_camera(seed: u64, lens: Lens) -> Camera {
    let eye = DVec3::from([0, 1, 2].map(|i| f64::from(signed(seed, 900 + i)))).normalize() * 3.0;
    let pose = Pose { eye, target: DVec3::ZERO, up: DVec3::new(0.1, 1.0, 0.3) };
    Camera::new(64, 48, pose, lens).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Rays at corners and at points of edges, as close as rounding allows, and at their
    /// neighbours.
    #[test]
    fn no_ray_slips_through_a_closed_mesh(seed in 0_u64..1_000_000, perspective: bool) {
        let lens = if perspective { Lens::FieldOfView(50.0) } else { Lens::Orthographic(3.0) };
        let (rock, camera) = (rock(seed, 3), any_camera(seed, lens));
        let (all, view) = (placed(&rock, &camera), View::<f64>::new(&camera));
        let at = |i: u32| view.point(Vector3::from_glam(rock.vertices().position[i as usize]));
        for (k, &[a, b, _]) in (0..).zip(rock.corners()) {
            let (a, b) = (at(a), at(b));
            let part = f64::from(unit(seed, 5000 + k));
            for p in [a, a * (1.0 - part) + b * part] {
                let w = if perspective { -p.z } else { 1.0 };
                // Corners are at least 1/2 away from the centre, and edges span at most 51 degrees,
                // so no point of a triangle is nearer than 0.3.
                let middle = view.point(Vector3::ZERO);
                let (x, y) = (p.x / w, p.y / w);
                let from = if perspective { V3::ZERO } else { V3::new(x, y, 0.0) };
                let along = if perspective { V3::new(x, y, -1.0) } else { V3::new(0.0, 0.0, -1.0) };
                let off = (middle - from).cross(along.normalized()).length();
                if off > 0.2 {
                    continue;
                }
                for (x, y) in [(x, y), (x.next_up(), y), (x, y.next_down()), (x.next_down(), y.next_up())] {
                    let fronts = all.iter().filter_map(|one| one.meet(x, y, view.near));
                    let (front, back): (Vec<_>, Vec<_>) = fronts.partition(|met| met.front);
                    prop_assert!(!front.is_empty() && !back.is_empty(), "seed {seed}: {x:e} {y:e}");
                }
            }
        }
    }

    /// Bounds and lines omit no ray that meets a triangle, wherever the triangle is.
    #[test]
    fn bounds_and_lines_hold_every_ray_that_meets(
        seed in 0_u64..1_000_000,
        perspective: bool,
        size in -12_i32..12,
        near in 0_i32..12,
    ) {
        let lens = if perspective { Lens::FieldOfView(80.0) } else { Lens::Orthographic(4.0) };
        let camera = any_camera(seed, lens);
        let camera = Camera { near: camera.near / (1_u64 << (3 * near)) as f32, ..camera };
        let eye = camera.eye().as_vec3();
        // Around the eye, around the target, thin and not, small and large.
        let scale = f32::from_bits(((127 + size) as u32) << 23);
        let around = if seed % 2 == 0 { eye } else { Vec3::ZERO };
        let soup: Vec<_> = (0..20).map(|i| {
            let corner = |k: u64| Vec3::from_array([0, 1, 2].map(|c| signed(seed, 9 * i + 3 * k + c)));
            let a = around + corner(0) * scale;
            let (b, c) = (a + corner(1) * scale, a + corner(2) * scale);
            let thin = i % 3 == 0;
            [a, b, if thin { a.lerp(b, 0.3) + (c - a) * 1e-6 } else { c }].map(|p| p.to_array())
        }).collect();
        let soup = mesh(&soup);
        let rays = Rays::new(&camera, &Rect { x0: 0, y0: 0, x1: 64, y1: 48 }, 2, 0);
        let (view, reach) = (View::<f64>::new(&camera), Rays::reach(&camera));
        for one in placed(triangles(&soup), &camera) {
            let (bounds, lines) = (one.bounds(&view), one.lines(reach));
            for (row, &y) in rays.y.iter().enumerate() {
                for (column, &x) in rays.x.iter().enumerate() {
                    let Some(met) = one.meet(x, y, view.near) else { continue };
                    let Some([l, t, r, b]) = bounds else { panic!("no bounds, but {met:?}") };
                    let (columns, rows) = (rays.columns([l, r]), rays.rows([t, b]));
                    prop_assert!((columns[0]..columns[1]).contains(&column), "{columns:?} {column}");
                    prop_assert!((rows[0]..rows[1]).contains(&row), "{rows:?} {row}");
                    let Some(lines) = &lines else { continue };
                    let span = lines.span(y).map(|range| rays.span(range, columns));
                    prop_assert!(span.is_some_and(|[a, b]| (a..b).contains(&column)), "{span:?} {column}");
                    prop_assert_eq!(lines.front, met.front);
                }
            }
        }
    }
}

type V3 = Vector3<f64>;

/// Every sample on the outline and on the diagonal occurs once, and the diagonal belongs to the
/// first.
#[test]
fn samples_on_an_edge_are_of_the_first_triangle() {
    // A pixel is a world unit. Samples are at odd sixteenths, and so are the corners.
    let camera = camera([16, 16], 4.0, Lens::Orthographic(16.0));
    let (low, high) = (-3.0 - 1.0 / 16.0, 2.0 - 1.0 / 16.0);
    let corner = |x: f32, y: f32| Vec3::new(x, y, 0.0);
    let position = vec![corner(low, low), corner(high, low), corner(high, high), corner(low, high)];
    let (direction, radius) = (vec![Vec3::Z; 4], vec![0.0; 4]);
    let side = 5 * 8 + 1;
    for (corners, first) in [
        (vec![[0, 1, 2], [0, 2, 3]], side * (side + 1) / 2),
        (vec![[0, 1, 2], [2, 3, 0], [0, 1, 2]], side * (side + 1) / 2),
        (vec![[1, 2, 3], [3, 0, 1]], side * (side + 1) / 2),
    ] {
        // The normal tells which triangle is seen; the light shines along it.
        let vertices = Vertices {
            position: position.clone(),
            direction: direction.clone(),
            radius: radius.clone(),
            color: None,
            ..Vertices::default()
        };
        let both = Triangles::new(vertices.clone(), corners.clone()).unwrap().0;
        let unlit = lights("square", vec![]);
        let seen = see(&[Surface::Triangles(both)], &unlit, true, &camera);
        let share = f64::from(unlit.material.color.x);
        assert_eq!(area(&seen) / share * 64.0, f64::from(side * side));
        // One triangle a surface, each with its own colour; the lower one has the diagonal.
        let one = |i: usize, color: Vec3| {
            let vertices = Vertices { color: Some(vec![color; 4]), ..vertices.clone() };
            Surface::Triangles(Triangles::new(vertices, vec![corners[i]]).unwrap().0)
        };
        let parted = see(&[one(0, Vec3::X), one(1, Vec3::Y)], &unlit, true, &camera);
        let sum = |c: usize| {
            colors(&parted).iter().skip(c).step_by(3).map(|v| f64::from(*v)).sum::<f64>()
        };
        let counts = [0, 1].map(|c| sum(c) * 64.0);
        assert_eq!(counts, [f64::from(first), f64::from(side * side - first)]);
    }
}

#[test]
fn a_triangle_seen_from_behind_has_its_normal_reversed() {
    let scene = lights("triangle", vec![Light::DEFAULT]);
    let camera = camera([24, 16], 3.0, Lens::FieldOfView(50.0));
    let corners = [[-1.0, -1.0, 0.0], [1.0, -0.5, 0.25], [0.0, 1.0, -0.5]];
    let front = see(&[mesh(&[corners])], &scene, true, &camera);
    let turned = mesh(&[[corners[0], corners[2], corners[1]]]);
    let behind = see(std::slice::from_ref(&turned), &scene, false, &camera);
    for (a, b) in colors(&front).into_iter().zip(colors(&behind)) {
        assert!((a - b).abs() < 1e-6);
    }
    let normal = |truth: &Truth| truth.frame.vector("normal").unwrap().at(12, 8).map(f64::from);
    let expected = Vec3::from_array(corners[1]) - Vec3::from_array(corners[0]);
    let expected = expected
        .cross(Vec3::from_array(corners[2]) - Vec3::from_array(corners[0]))
        .normalize()
        .as_dvec3();
    for found in [&front, &behind].map(normal) {
        assert!(DVec3::from_array(found).distance(expected) < 1e-6);
    }
    let culled = see(&[turned], &scene, true, &camera);
    assert!(culled.frame.scalar("Z").unwrap().values().iter().all(|t| t.is_infinite()));
}

/// The nearest depth through the centres, by another formula [Moeller, Trumbore 1997].
#[test]
fn the_nearest_of_many_is_that_of_brute_force() {
    let unlit = lights("soup", vec![]);
    for seed in 0..8 {
        let lens = if seed % 2 == 0 { Lens::FieldOfView(70.0) } else { Lens::Orthographic(4.0) };
        let camera = any_camera(seed, lens);
        let corner = |i: u64| [0, 1, 2].map(|c| 3.5 * signed(seed, 3 * i + c));
        let soup: Vec<_> = (0..30).map(|i| [0, 1, 2].map(|k| corner(3 * i + k))).collect();
        let truth = see(&[mesh(&soup)], &unlit, false, &camera);
        let depth = truth.frame.scalar("Z").unwrap();
        let world = camera.view_from_world.as_dmat4().inverse();
        let mut seen = 0;
        for (x, y) in (0..48).flat_map(|y| (0..64).map(move |x| (x, y))) {
            let px = (f64::from(x) + 0.5 - f64::from(camera.cx)) / f64::from(camera.fx);
            let py = -(f64::from(y) + 0.5 - f64::from(camera.cy)) / f64::from(camera.fy);
            let (from, along) = match lens {
                Lens::Orthographic(_) => (DVec3::new(px, py, 0.0), -DVec3::Z),
                _ => (DVec3::ZERO, DVec3::new(px, py, -1.0)),
            };
            let (from, along) = (world.transform_point3(from), world.transform_vector3(along));
            let hits = soup.iter().filter_map(|corners| {
                let [a, b, c] = corners.map(|p| Vec3::from_array(p).as_dvec3());
                let (e, f, s) = (b - a, c - a, from - a);
                let p = along.cross(f);
                let inverse = 1.0 / e.dot(p);
                let (u, q) = (s.dot(p) * inverse, s.cross(e));
                let (v, t) = (along.dot(q) * inverse, f.dot(q) * inverse);
                let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
                (inside && t > f64::from(camera.near)).then_some(t)
            });
            let expected = hits.fold(f64::INFINITY, |least, t| if t < least { t } else { least });
            let found = f64::from(*depth.at(x, y));
            assert!(found == expected || (found / expected - 1.0).abs() < 1e-5, "{seed}: {x} {y}");
            seen += u32::from(expected.is_finite());
        }
        assert!(seen > 500, "{seen}");
    }
}
