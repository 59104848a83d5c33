use super::*;
use crate::method::surface::{COLOR, DEPTH, NORMAL, WEIGHT};
use crate::scene::{Triangles, Vertices};

/// A square in the plane z = `depth`, with colours or not.
fn square(depth: f32, color: Option<Vec3>) -> Primitives {
    let corner = |i: u32| {
        let [x, y] = [i & 1, i >> 1].map(|bit| if bit == 0 { -9.0 } else { 9.0 });
        Vec3::new(x, y, depth)
    };
    let vertices = Vertices {
        position: (0..4).map(corner).collect(),
        direction: vec![Vec3::Z; 4],
        radius: vec![0.0; 4],
        color: color.map(|color| vec![color; 4]),
        ..Vertices::default()
    };
    let triangles = Triangles::new(vertices, vec![[0, 1, 3], [0, 3, 2]]).unwrap().0;
    Primitives { triangles, ..Primitives::default() }
}

/// The case with a square as one more object.
fn with_square(case: &Case, depth: f32, color: Option<Vec3>) -> Case {
    let objects = case.scene.objects.as_ref().unwrap();
    let (mut geometries, mut all) = (objects.geometries().to_vec(), objects.objects().to_vec());
    all.push(Object {
        name: "ground".into(),
        geometry: geometries.len(),
        motion: Motion::still(Similarity::IDENTITY),
        color: None,
    });
    geometries.push(Geometry {
        name: "ground".into(),
        surfels: Surfels::none(),
        primitives: square(depth, color),
        detail: None,
    });
    let objects = Objects::new(geometries, all, objects.fill()).unwrap();
    Case { scene: Scene { objects: Some(objects), ..case.scene.clone() }, ..case.clone() }
}

/// Every value of a plane at a pixel.
fn at<R: Exact>(frame: &Frame<R>, name: &str, pixel: usize) -> [R; 3] {
    match frame.plane(name) {
        Some(Samples::Scalar(plane)) => [plane.values()[pixel]; 3],
        Some(Samples::Color(plane) | Samples::Vector(plane)) => plane.values()[pixel],
        _ => [R::ZERO; 3],
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Frame by frame: the fast path has the bits of the definition, and each stage runs alone.
    /// Each pixel shows the nearer of the splats and the square, whose depth is known.
    #[test]
    fn a_square_stands_among_the_surfels(
        case in case(), depth in -2.5..2.5_f32, colored in any::<bool>(),
    ) {
        let case = with_square(&case, depth, colored.then_some(Vec3::new(0.0, 0.25, 1.0)));
        let exec = Exec::sequential();
        let mut seen = None;
        for (i, (frame, before)) in (0_u32..).zip(case.frames::<f32>(3, None, &exec)) {
            prop_assert_eq!(&before, &seen);
            let (scene, camera) = (case.scene(i), case.camera(i));
            let fast = Exec::new(2, 16).unwrap();
            let mut session = Session::new(&scene, case.settings.into(), &fast).unwrap();
            session.resume(seen);
            for stage in STAGES {
                let left = session.stage(&camera, stage, &frame).unwrap();
                for plane in &left.planes {
                    // Depth becomes nearness again there: one rounding more.
                    if *stage == "visibility" || *stage == "indices" {
                        prop_assert_eq!(Some(&plane.samples), frame.plane(&plane.name));
                    }
                }
            }
            let drawn = session.render(&camera).unwrap();
            for plane in &drawn.frame.planes {
                prop_assert_eq!(Some(&plane.samples), frame.plane(&plane.name), "{}", &plane.name);
            }
            seen = session.seen().cloned();
            shows_the_nearer(&case, i, &frame)?;
        }
    }
}

const STAGES: &[&str] = &["visibility", "indices", "difference", "attributes", "normalization"];

/// Each pixel shows the nearer surface, by the depth of the square in closed form.
fn shows_the_nearer(
    case: &Case,
    i: u32,
    frame: &Frame<f32>,
) -> std::result::Result<(), TestCaseError> {
    let camera = case.camera(i);
    let view = camera.view_from_world.as_dmat4().inverse();
    let objects = case.objects(i);
    let vertices = objects.geometries()[3].primitives.triangles.vertices();
    let z = f64::from(vertices.position[0].z);
    let color = vertices.color.as_ref().map_or(case.scene.material.color, |color| color[0]);
    for y in 0..camera.height {
        for x in 0..camera.width {
            let pixel = (y * camera.width + x) as usize;
            let column = (f64::from(x) + 0.5 - f64::from(camera.cx)) / f64::from(camera.fx);
            let row = (f64::from(y) + 0.5 - f64::from(camera.cy)) / f64::from(camera.fy);
            let (from, to) = if case.ortho {
                (DVec3::new(column, -row, 0.0), DVec3::NEG_Z)
            } else {
                (DVec3::ZERO, DVec3::new(column, -row, -1.0))
            };
            let (from, to) = (view.transform_point3(from), view.transform_vector3(to));
            let t = (z - from.z) / to.z;
            let hit = from + to * t;
            let inside = hit.x.abs() < 8.5 && hit.y.abs() < 8.5;
            let outside = hit.x.abs() > 9.5 || hit.y.abs() > 9.5;
            // A square seen from behind is culled, or its normal is turned.
            let faces = to.z < 0.0 || !case.settings.splats.cull;
            let near = t > f64::from(camera.near) * 1.001;
            let there = inside && near && faces;
            if !there && !outside && faces {
                continue;
            }
            let [depth, weight] = [&DEPTH, &WEIGHT].map(|row| at(frame, row.name, pixel)[0]);
            let before = f64::from(at(frame, "visibility.Z", pixel)[0]);
            if !there {
                prop_assert!(weight == 0.0 || id(frame, "id").values()[pixel] != NO_ID);
                continue;
            }
            // Corners are snapped to 1/256 px, which tilts the square a little.
            let snapped = 4e-3 * (1.0 + t);
            prop_assert!(before <= t + snapped, "{before} {t}");
            prop_assert!(weight > 0.0);
            if id(frame, "id").values()[pixel] == NO_ID {
                prop_assert_eq!(weight, 1.0);
                prop_assert!((f64::from(depth) - t).abs() < snapped, "{depth} {t}");
                let sign = if to.z < 0.0 { 1.0 } else { -1.0 };
                let normal = at(frame, NORMAL.name, pixel);
                prop_assert!((f64::from(normal[2]) - sign).abs() < 1e-5, "{normal:?}");
                let shown = Vec3::from_array(at(frame, COLOR.name, pixel));
                prop_assert!(shown.abs_diff_eq(color, 1e-6), "{shown}");
            } else {
                prop_assert!(f64::from(depth) <= t + snapped);
            }
        }
    }
    Ok(())
}

/// A polygon in front of everything is all you see, and no surfel is selected. Far behind, it
/// changes no pixel that splats cover.
#[test]
fn a_wall_hides_and_a_backdrop_does_not() {
    let exec = Exec::sequential();
    let scene = |depth: Option<f32>| {
        let surfels = Shape::Torus.surfels(600, 3).unwrap();
        let primitives = depth.map_or_else(Primitives::default, |depth| square(depth, None));
        Scene { primitives, ..Scene::lit("torus", surfels) }
    };
    let pose = Pose { eye: DVec3::new(0.5, 0.25, 4.0), target: DVec3::ZERO, up: DVec3::Y };
    let camera = Camera::new(50, 40, pose, Lens::FieldOfView(40.0)).unwrap();
    let draw = |depth| {
        let scene = scene(depth);
        let mut session = Session::new(&scene, Settings::default().into(), &exec).unwrap();
        session.render(&camera).unwrap().clone()
    };
    let [alone, wall, backdrop] = [None, Some(2.0), Some(-3.0)].map(draw);
    let selected = |seen: Option<Seen>| seen.unwrap().selected().iter().sum::<u32>();
    assert_eq!(selected(wall.seen), 0);
    assert!(id(&wall.frame, "id").values().iter().all(|&id| id == NO_ID));
    assert!(scalar(&wall.frame, "weight").values().iter().all(|&weight| weight == 1.0));
    assert!(selected(alone.seen) > 100);
    let covered =
        id(&alone.frame, "id").values().iter().enumerate().filter(|(_, id)| **id != NO_ID);
    for (pixel, _) in covered {
        for name in ["", "Z", "normal", "weight"] {
            assert_eq!(at(&alone.frame, name, pixel), at(&backdrop.frame, name, pixel), "{name}");
        }
    }
}

/// Known answers. If a disc and a square have one depth, the disc is seen, in the colour of the
/// material if the square alone has one. A disc that is behind by less than epsilon is selected,
/// and not seen.
#[test]
fn at_one_depth_a_surfel_wins() {
    let exec = Exec::sequential();
    let pose = Pose { eye: DVec3::new(0.0, 0.0, 4.0), target: DVec3::ZERO, up: DVec3::Y };
    let camera = Camera::new(8, 8, pose, Lens::Orthographic(4.0)).unwrap();
    let blue = Vec3::new(0.0, 0.0, 1.0);
    for (behind, seen) in [(0.0, true), (0.125, false)] {
        let cloud = crate::scene::Cloud {
            position: vec![Vec3::new(0.25, 0.25, -behind)],
            normal: Some(vec![Vec3::Z]),
            radius: Some(vec![1.0]),
            ..Default::default()
        };
        let surfels = Surfels::new(cloud).unwrap().0;
        let scene = Scene { primitives: square(0.0, Some(blue)), ..Scene::unlit("disc", surfels) };
        let settings = Settings {
            splats: SplatSettings { epsilon: Epsilon::World(0.5), ..SplatSettings::default() },
            ..Settings::default()
        };
        let mut session = Session::new(&scene, settings.into(), &exec).unwrap();
        let defined = session.define::<f32>(&camera, true).unwrap().frame;
        let selected = id(&defined, "indices.id").values().iter().filter(|&&id| id == 0).count();
        assert_eq!(selected, 1);
        let drawn = session.render(&camera).unwrap().frame.clone();
        // The pixel (4, 3), whose centre is the centre of the disc, and a corner of the picture.
        for frame in [&defined, &drawn] {
            let expected = if seen { 0 } else { NO_ID };
            assert_eq!(id(frame, "id").values()[3 * 8 + 4], expected, "{behind}");
            let color = if seen { scene.material.color } else { blue };
            assert_eq!(at(frame, "", 3 * 8 + 4), color.to_array());
            assert_eq!(at(frame, "", 0), blue.to_array());
            assert_eq!(at(frame, "Z", 3 * 8 + 4), [4.0; 3]);
        }
    }
}
