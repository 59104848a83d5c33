//! Check the properties of every shape.

use super::*;
use crate::frame::Samples;
use crate::number::random;
use glam::Vec3;
use sha2::{Digest, Sha256};

/// The distance from `p` to the shape, by its documentation.
fn distance(shape: Shape, p: DVec3) -> f64 {
    /// How far `v` is outside of [low, high].
    fn outside(v: f64, low: f64, high: f64) -> f64 {
        if v < low {
            low - v
        } else if v > high {
            v - high
        } else {
            0.0
        }
    }
    let norm = |a: f64, b: f64| (a * a + b * b).sqrt();
    let square = |half: f64, z: f64| {
        DVec3::new(outside(p.x, -half, half), outside(p.y, -half, half), p.z - z).length()
    };
    let least = |distances: &mut dyn Iterator<Item = f64>| {
        distances.fold(f64::INFINITY, |least, d| if d < least { d } else { least })
    };
    match shape {
        Shape::Sphere => (p.length() - 1.0).abs(),
        Shape::Torus => (norm(norm(p.x, p.z) - 1.0, p.y) - 0.375).abs(),
        Shape::Checkerboard { .. } => p.y.abs(),
        Shape::Sheets { gap } => {
            least(&mut [square(1.0, 0.0), square(1.5, -f64::from(gap))].into_iter())
        }
        Shape::Staircase { step, thickness } => least(&mut (0..16).map(|i| {
            let (k, back) = (f64::from(i / 2), f64::from(i % 2));
            let z = -k * f64::from(step) - back * f64::from(thickness);
            let y = outside(p.y, k / 4.0 - 1.125, k / 4.0 - 0.625);
            DVec3::new(outside(p.x, -1.0, 1.0), y, p.z - z).length()
        })),
        Shape::Cluster => {
            let balls = ball::cluster();
            least(&mut balls.iter().map(|b| ((p - b.center).length() - b.radius).abs()))
        }
    }
}

/// A ray that probably meets the shape.
fn random_ray(shape: Shape, i: u64) -> (DVec3, DVec3) {
    let unit = |j| f64::from(random::unit(99, 6 * i + j)) * 2.0 - 1.0;
    let [x, y, z] = [0, 1, 2].map(unit);
    if matches!(shape, Shape::Checkerboard { .. }) {
        // Slopes of all sizes, so that hits spread over all rings.
        return (DVec3::Y, DVec3::new(x, -(y * y * y * y), z));
    }
    let origin = DVec3::new(x, y, z).normalize() * 8.0;
    (origin, DVec3::new(unit(3), unit(4), unit(5)) * 1.5 - origin)
}

#[test]
fn surfels_lie_on_the_surface_and_rays_find_them() {
    // Half a unit in the last place of a coordinate below 4 is 2^-23; three of them add up to less
    // than 2^-22. On a sphere of radius 1/8 or more this turns the normal by 8 times as much.
    let on_surface = 1.0 / 4_194_304.0;
    // Small enough that no other sphere of the cluster lies in between.
    let lift = 1.0 / 65_536.0;
    for shape in Shape::ALL {
        let surfels = shape.surfels(3000, 1).unwrap();
        let colors = surfels.color().unwrap();
        for (i, color) in colors.iter().enumerate() {
            let (p, n) = (surfels.position()[i].as_dvec3(), surfels.normal()[i].as_dvec3());
            let what = format!("{} {i} at {p}", shape.name());
            assert!(distance(shape, p) < on_surface, "{what} is {} off", distance(shape, p));
            assert!((n.length() - 1.0).abs() < on_surface, "{what}");
            // A direction of half length, downwards onto the surfel.
            let hit = shape.trace(p + n * lift, n * -0.5).expect(&what);
            assert!((hit.t - 2.0 * lift).abs() < 2.0 * on_surface, "{what}: {hit:?}");
            assert!((hit.normal - n).length() < 8.0 * on_surface, "{what}: {hit:?}");
            // The colours of sphere and torus change by less than 10 a unit of length.
            assert!((hit.color - color.as_dvec3()).length() < 16.0 * on_surface, "{what}: {hit:?}");
            assert!(color.min_element() >= 0.0 && color.max_element() <= 1.0, "{what}: {color}");
        }
    }
}

#[test]
fn rays_end_on_the_surface() {
    for shape in Shape::ALL {
        let mut hits = 0;
        for i in 0..2000 {
            let (origin, direction) = random_ray(shape, i);
            let Some(hit) = shape.trace(origin, direction) else { continue };
            hits += 1;
            let p = origin + direction * hit.t;
            let tolerance = 1e-14 * (origin.length() + p.length());
            assert!(distance(shape, p) < tolerance, "{}: {origin} {direction}", shape.name());
            assert!((hit.normal.length() - 1.0).abs() < 1e-15, "{}: {hit:?}", shape.name());
        }
        assert!(hits > 300, "{}: {hits} of 2000 rays hit", shape.name());
    }
}

#[test]
fn discs_cover_the_surface() {
    for shape in Shape::ALL {
        let surfels = shape.surfels(4000, 2).unwrap();
        let mut checked = 0;
        for i in 0..4000 {
            let (origin, direction) = random_ray(shape, i);
            let Some(hit) = shape.trace(origin, direction) else { continue };
            let p = origin + direction * hit.t;
            if p.abs().max_element() > 4096.0 {
                continue;
            }
            checked += 1;
            let nearest = (0..surfels.len()).map(|j| {
                let (n, r) = (surfels.normal()[j].as_dvec3(), f64::from(surfels.radius()[j]));
                let offset = p - surfels.position()[j].as_dvec3();
                let height = offset.dot(n);
                let same_side = hit.normal.dot(n) > 0.5 && height.abs() < r;
                let flat = (offset - n * height).length();
                if same_side { flat / r } else { f64::INFINITY }
            });
            let nearest = nearest.fold(f64::INFINITY, |a, b| if b < a { b } else { a });
            assert!(nearest < 0.9, "{}: {p} is {nearest} radii away", shape.name());
        }
        assert!(checked >= 700, "{}: {checked}", shape.name());
    }
}

#[test]
fn counts_are_honoured() {
    for shape in Shape::ALL {
        for count in [10_000, 12_345, 40_000] {
            let n = shape.surfels(count, 0).unwrap().len();
            let slack = match shape {
                Shape::Sphere | Shape::Torus | Shape::Cluster => 0,
                _ => count / 20,
            };
            assert!(n.abs_diff(count) <= slack, "{}: {n} for {count}", shape.name());
        }
        let n = shape.surfels(1, 0).unwrap().len();
        assert!((1..=64).contains(&n), "{}: {n} for one", shape.name());
    }
}

#[test]
fn surfels_are_pinned() {
    let pins = [
        ("sphere", "99e0875dac4b22c3620a15264f4664053715f817df6fcf19d1ce4929b2268c47"),
        ("torus", "390f0694eb1634d9d290cf3e2a8af5cee6b4f0604f5c2b6dbf81549f85247295"),
        ("checkerboard", "51c94ad5686c473227806b8ee7fe3cfb39c06b2b70720b76f484bd90a2e51508"),
        ("sheets", "7943a783cbdbf27db381c208d51767d6ea43dafaafbfa97ba64e136c343ea90a"),
        ("staircase", "336585ccc74b3f8823d754e5d25a01e6e0d0e9e9e8a01d7e375b3b03e047e819"),
        ("cluster", "5d5fdb1648c17356290e58b8955533a8c72e3a71b9cc20cd660de4eb5ac59f66"),
    ];
    for (name, pin) in pins {
        let surfels = Shape::by_name(name).unwrap().surfels(500, 42).unwrap();
        let mut hash = Sha256::new();
        let mut vectors = |values: &[Vec3]| {
            for v in values.iter().flat_map(|v| v.to_array()) {
                hash.update(v.to_le_bytes());
            }
        };
        vectors(surfels.position());
        vectors(surfels.normal());
        vectors(surfels.color().unwrap());
        for r in surfels.radius() {
            hash.update(r.to_le_bytes());
        }
        let hex: String = hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(hex, pin, "{name}: position, normal, colour, radius as little-endian f32");
        let other = Shape::by_name(name).unwrap().surfels(500, 43).unwrap();
        assert_ne!(surfels.position(), other.position(), "{name}: another seed");
    }
}

/// Colour, depth and normal planes.
fn planes(frame: &Frame<f64>) -> (&[[f64; 3]], &[f64], &[[f64; 3]]) {
    let names: Vec<_> = frame.planes.iter().map(|plane| plane.name.as_str()).collect();
    assert_eq!(names, ["", "Z", "normal"]);
    match [0, 1, 2].map(|i| &frame.planes[i].samples) {
        [Samples::Color(c), Samples::Scalar(z), Samples::Vector(n)] => {
            (c.values(), z.values(), n.values())
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_depth_of_a_sphere_has_a_closed_form() {
    let pose = Shape::Sphere.default_pose();
    for lens in [Lens::Focal(40.0), Lens::Orthographic(2.5)] {
        let camera = Camera::new(31, 24, pose, lens).unwrap();
        let truth = Shape::Sphere.true_picture(&camera).unwrap();
        let (color, depth, normal) = planes(&truth);
        let scale = f64::from(camera.fx);
        let mut hits = 0;
        for i in 0..31 * 24 {
            let x = (f64::from(i % 31) + 0.5 - 15.5) / scale;
            let y = (12.0 - f64::from(i / 31) - 0.5) / scale;
            // |o + t d - c| = 1 with the centre 4 in front of the camera.
            let square = x * x + y * y;
            let (discriminant, t, p) = match lens {
                Lens::Orthographic(_) => {
                    let t = 4.0 - (1.0 - square).sqrt();
                    (1.0 - square, t, DVec3::new(x, y, 4.0 - t))
                }
                _ => {
                    let discriminant = 16.0 - 15.0 * (square + 1.0);
                    let t = (4.0 - discriminant.sqrt()) / (square + 1.0);
                    (discriminant, t, DVec3::new(x * t, y * t, 4.0 - t))
                }
            };
            let i = i as usize;
            if discriminant < 0.0 {
                assert_eq!((color[i], depth[i]), ([0.0; 3], f64::INFINITY));
                assert_eq!(normal[i].map(f64::to_bits), [0; 3], "+0");
            } else {
                hits += 1;
                assert!((depth[i] - t).abs() < 1e-12, "{lens:?} {i}: {} for {t}", depth[i]);
                assert!((DVec3::from(normal[i]) - p).length() < 1e-12, "{lens:?} {i}");
            }
        }
        assert!((200..400).contains(&hits), "{hits}");
    }
}

#[test]
fn the_near_plane_cuts_the_shape_open() {
    let pose = Shape::Sphere.default_pose();
    let mut camera = Camera::new(1, 1, pose, Lens::Focal(1.0)).unwrap();
    let depth = |camera: &Camera| planes(&Shape::Sphere.true_picture(camera).unwrap()).1[0];
    assert_eq!(depth(&camera), 3.0);
    camera.near = 3.0;
    assert_eq!(depth(&camera), 5.0, "a depth equal to the near plane is not seen");
    camera.near = 5.0;
    assert_eq!(depth(&camera), f64::INFINITY);
    // An orthographic camera sees objects behind its own plane, if its near plane lies there.
    let pose = Pose { eye: DVec3::ZERO, target: -DVec3::Z, up: DVec3::Y };
    let mut camera = Camera::new(1, 1, pose, Lens::Orthographic(1.0)).unwrap();
    assert_eq!(depth(&camera), 1.0);
    camera.near = -2.0;
    assert_eq!(depth(&camera), -1.0);
}

#[test]
fn the_true_picture_follows_the_camera() {
    // Up in the picture is +y, right is +x: the front sheet's corner, the back sheet beside it.
    let shape = Shape::Sheets { gap: 0.5 };
    let pose = Pose { eye: DVec3::Z * 2.0, target: DVec3::ZERO, up: DVec3::Y };
    let camera = Camera::new(8, 4, pose, Lens::Orthographic(4.0)).unwrap();
    let frame = shape.true_picture(&camera).unwrap();
    let (_, depth, _) = planes(&frame);
    // Pixel centres at x = -3.5, ... 3.5 and y = 1.5, 0.5, -0.5, -1.5; edges belong to a sheet.
    let (none, back, front) = (f64::INFINITY, 2.5, 2.0);
    let outer = [none, none, back, back, back, back, none, none];
    let inner = [none, none, back, front, front, back, none, none];
    assert_eq!(depth, [outer, inner, inner, outer].concat());

    let camera = Camera::new(9, 9, Shape::Cluster.default_pose(), Lens::Focal(20.0)).unwrap();
    let turned = Shape::Cluster.true_picture(&camera).unwrap();
    let (_, depth, _) = planes(&turned);
    let eye = camera.eye();
    let hit = Shape::Cluster.trace(eye, -eye / eye.length()).unwrap();
    assert!((depth[40] - hit.t).abs() < 1e-5, "the middle pixel looks at the target");
}

#[test]
fn the_checkerboard_reaches_the_horizon() {
    let pose = Pose { eye: DVec3::Y, target: DVec3::new(0.0, 1.0, -1.0), up: DVec3::Y };
    let camera = Camera::new(2, 64, pose, Lens::Focal(32.0)).unwrap();
    let frame = Shape::Checkerboard { square: 0.5 }.true_picture(&camera).unwrap();
    let (color, depth, _) = planes(&frame);
    for y in 0..64 {
        let below = f64::from(y) + 0.5 - 32.0;
        for x in [0, 1] {
            let i = 2 * y as usize + x;
            if below < 0.0 {
                assert_eq!(depth[i], f64::INFINITY);
                continue;
            }
            let t = 32.0 / below;
            assert!((depth[i] - t).abs() < 1e-12 * t);
            // Pixel centres are half a pixel left and right of the middle.
            let column = ((x as f64 - 0.5) * t / 32.0 / 0.5).floor() as i32;
            let row = (-t / 0.5).floor() as i32;
            let light = (row + column) % 2 == 0;
            assert_eq!(color[i][0] > 0.5, light, "row {y}, column {x}");
        }
    }
}

#[test]
fn default_views_show_the_whole_shape() {
    for shape in Shape::ALL {
        let camera = Camera::new(48, 48, shape.default_pose(), shape.default_lens()).unwrap();
        let frame = shape.true_picture(&camera).unwrap();
        let (_, depth, _) = planes(&frame);
        let seen = |i: usize| depth[i].is_finite();
        let filled = (0..48 * 48).filter(|&i| seen(i)).count();
        assert!(filled > 48 * 48 / 5, "{}: {filled} pixels", shape.name());
        let border = (0..48).flat_map(|i| [i, 47 * 48 + i, 48 * i, 48 * i + 47]);
        let cut = border.filter(|&i| seen(i)).count();
        let endless = matches!(shape, Shape::Checkerboard { .. });
        assert_eq!(cut > 0, endless, "{}: {cut} pixels of the border", shape.name());
    }
}

#[test]
fn names_lead_back_to_shapes() {
    for shape in Shape::ALL {
        assert_eq!(Shape::by_name(shape.name()), Some(shape));
    }
    assert_eq!(Shape::by_name("cube"), None);
}

#[test]
fn wrong_numbers_are_errors_and_wrong_rays_miss() {
    let message = |shape: Shape, count| shape.surfels(count, 0).unwrap_err().to_string();
    assert!(message(Shape::Sphere, 0).starts_with("sphere: 0 surfels"));
    assert!(message(Shape::Sphere, usize::MAX).contains("give 1 to"));
    assert!(message(Shape::Sheets { gap: 0.0 }, 9).starts_with("sheets: gap 0"));
    assert!(message(Shape::Checkerboard { square: f32::NAN }, 9).contains("square NaN"));
    assert!(message(Shape::Staircase { step: 1.0, thickness: 1e9 }, 9).contains("thickness"));
    let mut camera = Camera::new(1, 1, Shape::Sphere.default_pose(), Lens::Focal(1.0)).unwrap();
    assert!(Shape::Staircase { step: -1.0, thickness: 1.0 }.true_picture(&camera).is_err());
    camera.width = 0;
    assert!(Shape::Sphere.true_picture(&camera).is_err());
    for shape in Shape::ALL {
        assert_eq!(shape.trace(DVec3::ONE, DVec3::ZERO), None, "{}", shape.name());
        assert_eq!(shape.trace(DVec3::NAN, DVec3::ONE), None, "{}", shape.name());
        assert_eq!(shape.trace(DVec3::ONE * 9.0, DVec3::ONE), None, "{}", shape.name());
    }
}
