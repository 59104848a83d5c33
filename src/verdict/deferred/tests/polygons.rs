use super::*;
use crate::scene::{Triangles, Vertices};

/// A square of two triangles, in x and y up to 9, or as far as `reach`.
fn square(reach: f32, color: Option<Vec3>) -> Primitives {
    let corner = |i: u32| {
        let [x, y] = [i & 1, i >> 1].map(|bit| if bit == 0 { -reach } else { reach });
        Vec3::new(x, y, 0.0)
    };
    let vertices = Vertices {
        position: (0..4).map(corner).collect(),
        direction: vec![Vec3::Z; 4],
        radius: vec![0.0; 4],
        color: color.map(|color| (1..5_u16).map(|i| color * f32::from(i)).collect()),
        ..Vertices::default()
    };
    let triangles = Triangles::new(vertices, vec![[0, 1, 3], [0, 3, 2]]).unwrap().0;
    Primitives { triangles, ..Primitives::default() }
}

/// The sequence with a square that moves between two places.
pub(super) fn with_square(of: Sequence, square: Primitives, places: [Similarity; 2]) -> Sequence {
    let objects = of.scene.objects.as_ref().unwrap();
    let (mut geometries, mut all) = (objects.geometries().to_vec(), objects.objects().to_vec());
    let [first, last] = places;
    all.push(Object {
        name: "square".into(),
        geometry: geometries.len(),
        motion: Motion::new(vec![(0, first), (2, last)]).unwrap(),
        color: None,
    });
    geometries.push(Geometry {
        name: "square".into(),
        surfels: Surfels::none(),
        primitives: square,
        detail: None,
    });
    let objects = Objects::new(geometries, all, objects.fill()).unwrap();
    Sequence { scene: Scene { objects: Some(objects), ..of.scene.clone() }, ..of }
}

fn place(axis: DVec3, turn: f64, at: [f64; 3]) -> Similarity {
    let translation = DVec3::from_array(at);
    Similarity { rotation: rotation(axis, turn), scale: 1.0, translation }
}

/// Four sequences: a wall through the surfels, a floor that the near plane cuts, a small square
/// seen from both sides, and one without pass 3.
pub(super) fn sequences() -> Vec<Sequence> {
    let grey = Some(Vec3::new(0.125, 0.25, 0.0625));
    let flags = |flags| Settings { flags, ..Settings::default() };
    let narrow = Lens::FieldOfView(40.0);
    let tilted = |at| place(DVec3::new(1.0, 0.5, 0.0), 20.0, at);
    let wall = [tilted([0.0, 0.0, -0.25]), tilted([0.5, 0.25, 0.125])];
    let floor = |y| place(DVec3::NEG_X, 90.0, [0.0, y, 0.0]);
    let mut both_sides = flags(32);
    both_sides.splats.cull = false;
    let turned = [place(DVec3::Y, 20.0, [0.0; 3]), place(DVec3::Y, 160.0, [0.25, 0.0, 0.0])];
    let without = Settings { second: false, ..flags(4) };
    vec![
        with_square(sequence(flags(16), narrow), square(9.0, grey), wall),
        with_square(sequence(flags(16), narrow), square(9.0, None), [floor(-0.4), floor(-0.25)]),
        with_square(sequence(both_sides, Lens::Orthographic(3.0)), square(0.75, grey), turned),
        with_square(sequence(without, narrow), square(0.75, None), wall),
        with_square(sequence(without, narrow), square(9.0, grey), [floor(-0.4), floor(-0.25)]),
    ]
}

/// The planes of a stage from a client that draws another scene or follows other rules.
fn of_stage(
    shown: &DrawnFrame,
    method: Method,
    scene: &Scene,
    stage: &str,
) -> Vec<NamedPlane<f32>> {
    let exec = Exec::new(1, 16).unwrap();
    let mut session = Session::new(scene, method, &exec).unwrap();
    session.resume(shown.before.clone());
    session.stage(&shown.camera, stage, &shown.frame).unwrap().planes
}

/// The scene with other polygons in place of its last object.
fn other_square(shown: &DrawnFrame, change: impl Fn(&mut Vertices)) -> Scene {
    let objects = shown.scene.objects.as_ref().unwrap();
    let mut geometries = objects.geometries().to_vec();
    let triangles = &geometries.last().unwrap().primitives.triangles;
    let (mut vertices, corners) = (triangles.vertices().clone(), triangles.corners().to_vec());
    change(&mut vertices);
    let triangles = Triangles::new(vertices, corners).unwrap().0;
    geometries.last_mut().unwrap().primitives.triangles = triangles;
    let all = objects.objects().to_vec();
    let changed = Objects::new(geometries, all, objects.fill()).unwrap();
    let changed = changed.at(2).unwrap().seen_from(&shown.camera, &Exec::sequential()).unwrap();
    Scene { objects: Some(changed), ..shown.scene.clone() }
}

#[test]
fn faults_of_polygons_are_found() {
    let exec = Exec::new(1, 16).unwrap();
    let all = sequences();
    for sequence in [&all[0], &all[2], &all[3]] {
        let method = sequence.method();
        let shown = &sequence.frames::<f32>(&exec)[2];
        let found = |scene: &Scene, stage: &str, what: &str| {
            let frame = shown.from(method, &of_stage(shown, method, scene, stage), stage);
            assert_first_wrong(shown, method, &frame, stage, what);
        };
        let far = other_square(shown, |vertices| {
            vertices.position.iter_mut().for_each(|p| p.z -= 100.0);
        });
        found(&far, "visibility", "no depth of polygons in pass 1");
        found(&far, "normalization", "no polygons in the picture");
        let shifted = other_square(shown, |vertices| {
            vertices.position.iter_mut().for_each(|p| p.x += 0.08);
        });
        // A wall larger than the picture looks the same wherever it lies in its plane.
        if !std::ptr::eq(sequence, &raw const all[0]) {
            found(&shifted, "visibility", "shifted by a pixel");
        }
        let nearer = other_square(shown, |vertices| {
            vertices.position.iter_mut().for_each(|p| p.z += 1e-3);
        });
        found(&nearer, "visibility", "a little nearer");
    }
    let of_colors = |sequence: &Sequence| {
        let method = sequence.method();
        let shown = &sequence.frames::<f32>(&exec)[2];
        let darker = other_square(shown, |vertices| {
            let colors = vertices.color.iter_mut().flatten();
            colors.for_each(|color| *color *= 0.99);
        });
        let other = of_stage(shown, method, &darker, "normalization");
        let frame = shown.from(method, &other, "normalization");
        assert_first_wrong(shown, method, &frame, "normalization", "another colour");
    };
    of_colors(&all[0]);
    of_colors(&all[2]);
}

#[test]
fn a_polygon_over_nearer_surfels_is_found() {
    let exec = Exec::new(1, 16).unwrap();
    let sequence = &sequences()[0];
    let (method, frames) = (sequence.method(), sequence.frames::<f32>(&exec));
    let shown = &frames[2];
    // Replace all pixels by a picture without surfels.
    let objects = shown.scene.objects.as_ref().unwrap();
    let bare = objects.geometries().iter().map(|geometry| Geometry {
        surfels: Surfels::none(),
        detail: None,
        ..geometry.clone()
    });
    let bare = Objects::new(bare.collect(), objects.objects().to_vec(), objects.fill()).unwrap();
    let scene = Scene { objects: Some(bare.at(2).unwrap()), ..shown.scene.clone() };
    let session = Session::new(&scene, method, &exec).unwrap();
    let below = session.define::<f32>(&shown.camera, true).unwrap().frame;
    let stage = method.stages().iter().find(|stage| stage.name == "normalization").unwrap();
    let resolved =
        |plane: &&NamedPlane<f32>| stage.leaves.iter().any(|row| row.is_called(&plane.name));
    let planes: Vec<_> = below.planes.iter().filter(resolved).cloned().collect();
    let frame = shown.from(method, &planes, "normalization");
    assert_first_wrong(shown, method, &frame, "normalization", "polygons over all");
    // Replace only one pixel that shows a surfel.
    let ids = id(&shown.frame, "id").values();
    let at = ids.iter().rposition(|&id| id != NO_ID).unwrap();
    let mut one = shown.frame.clone();
    for plane in &mut one.planes {
        let Some(other) = planes.iter().find(|other| other.name == plane.name) else { continue };
        match (&mut plane.samples, &other.samples) {
            (Samples::Scalar(own), Samples::Scalar(other)) => {
                own.values_mut()[at] = other.values()[at];
            }
            (Samples::Color(own), Samples::Color(other))
            | (Samples::Vector(own), Samples::Vector(other)) => {
                own.values_mut()[at] = other.values()[at];
            }
            (Samples::Index(own), Samples::Index(other)) => {
                own.values_mut()[at] = other.values()[at];
            }
            _ => {}
        }
    }
    let one = shown.from(method, &one.planes, "normalization");
    assert_first_wrong(shown, method, &one, "normalization", "a polygon over one surfel");
    let found = shown.judge(method, &plain(&one), Rounding::Gpu);
    assert!(found.first_wrong().is_some(), "of the picture alone");
}
