//! The pixels of triangles against rays through the scene: nothing is clipped, snapped or
//! interpolated.
//!
//! Snapping moves what is seen by half a unit of the grid at most, so a ray through each corner of
//! a square of that size bounds depth and radius; pixels whose square is cut by an edge are left
//! out.

use crate::oracle::kit::eye::{Eye, V3, cross, dot, sub, wide};
use crate::oracle::kit::planes::value;
use crate::oracle::pyramid::cases::{Discs, Others, case};
use splatref::frame::NO_ID;
use splatref::method::pyramid::Settings;

/// What a ray through a triangle says: depth, radius, and the barycentric coordinates.
struct Hit {
    t: f64,
    radius: f64,
    weights: V3,
}

struct Triangle {
    corners: [V3; 3],
    radii: V3,
}

impl Triangle {
    /// Whether the corners lie in a line, so that there is no plane.
    fn is_flat(&self) -> bool {
        let [a, b, c] = self.corners;
        let normal = cross(sub(b, a), sub(c, a));
        dot(normal, normal) == 0.0
    }

    fn hit(&self, (origin, ray): (V3, V3)) -> Option<Hit> {
        let [a, b, c] = self.corners;
        let normal = cross(sub(b, a), sub(c, a));
        let slope = dot(normal, ray);
        if slope == 0.0 {
            return None;
        }
        let t = dot(normal, sub(a, origin)) / slope;
        let at: V3 = std::array::from_fn(|i| origin[i] + t * ray[i]);
        let share = |q: V3, r: V3| dot(normal, cross(sub(r, q), sub(at, q))) / dot(normal, normal);
        let weights = [share(b, c), share(c, a), share(a, b)];
        Some(Hit { t, radius: dot(weights, self.radii), weights })
    }

    /// The range of depth and of the radius where the whole square sees the triangle; `Ok(None)` if
    /// nothing of it does, an error if an edge or the near plane may be in between.
    fn seen(&self, eye: &Eye, squares: [[f64; 2]; 4]) -> Result<Option<[[f64; 2]; 2]>, ()> {
        let hits = squares.map(|[x, y]| self.hit(eye.ray(x, y)));
        let [Some(a), Some(b), Some(c), Some(d)] = hits else { return Err(()) };
        let all = [a, b, c, d];
        let range = |of: &dyn Fn(&Hit) -> f64| {
            let values = all.iter().map(of);
            [values.clone().fold(f64::INFINITY, f64::min), values.fold(f64::NEG_INFINITY, f64::max)]
        };
        let depth = range(&|h| h.t);
        if depth[1] < eye.near {
            return Ok(None);
        }
        if depth[0] < eye.near {
            return Err(());
        }
        let weights = [0, 1, 2].map(|i| range(&|h: &Hit| h.weights[i]));
        if weights.iter().any(|w| w[1] < 0.0) {
            return Ok(None);
        }
        if weights.iter().any(|w| w[0] <= 0.0) {
            return Err(());
        }
        Ok(Some([depth, range(&|h| h.radius)]))
    }
}

#[test]
fn pyramid_triangles_are_where_rays_meet_them() {
    let (mut checked, mut empty, mut open) = (0, 0, 0);
    for seed in 0..40 {
        let others = [Others::Triangles, Others::LargeTriangles][seed % 2];
        let bits = [8, 12, 4][seed % 3];
        let settings = Settings { cull: false, subpixel_bits: bits, ..Settings::default() };
        let optics = (seed % 4 > 1, [[31, 33], [64, 48]][seed / 4 % 2]);
        let case = case((Discs::None, others), seed as u64 + 900, settings, optics);
        let eye = Eye::new(&case.camera);
        let list = &case.scene.primitives.triangles;
        let triangle = |corners: &[u32; 3]| Triangle {
            corners: corners.map(|v| eye.point(wide(list.vertices().position[v as usize]))),
            radii: corners.map(|v| f64::from(list.vertices().radius[v as usize])),
        };
        let triangles: Vec<_> = list.corners().iter().map(triangle).collect();
        let sight =
            |t: &Triangle, square| if t.is_flat() { Ok(None) } else { t.seen(&eye, square) };
        let frame = case.drawing().frame::<f64>();
        // Half a unit of the grid, and what rounding adds.
        let half = 0.5 / f64::from(1 << bits) * (1.0 + 1e-6);
        for i in 0..(frame.width * frame.height) as usize {
            let x = f64::from(i as u32 % frame.width) + 0.5;
            let y = f64::from(i as u32 / frame.width) + 0.5;
            let square = [[-half, -half], [half, -half], [-half, half], [half, half]]
                .map(|[u, v]| [x + u, y + v]);
            let seen: Result<Vec<_>, ()> = triangles.iter().map(|t| sight(t, square)).collect();
            let Ok(seen) = seen else {
                open += 1;
                continue;
            };
            let place = format!("pixel ({x}, {y}) of {}", case.name);
            let found = value(&frame, "projection.id", i)[0] as u32;
            let nearest = seen.iter().flatten().map(|[t, _]| t[1]).fold(f64::INFINITY, f64::min);
            if nearest == f64::INFINITY {
                assert_eq!(found, NO_ID, "{place}: nothing is there");
                empty += 1;
                continue;
            }
            let own = seen.get(found as usize).copied().flatten();
            let [depth, radius] = own.unwrap_or_else(|| panic!("{place}: {found} is not there"));
            assert!(depth[0] <= nearest, "{place}: {found} is behind");
            for (name, [low, high]) in [("Z", depth), ("radius", radius)] {
                let [value, ..] = value(&frame, &format!("projection.{name}"), i);
                let slack = 1e-9 * (1.0 + high.abs());
                assert!(low - slack <= value && value <= high + slack, "{place}: {name} {value}");
            }
            checked += 1;
        }
    }
    println!("{checked} pixels of triangles, {empty} empty, {open} on edges");
    assert!(checked > 10_000 && empty > 10_000 && open < (checked + empty) / 10);
}
