mod faults;
mod polygons;
mod shares;
mod wide;

use crate::composite::decide;
use crate::frame::{Exec, Frame, NO_ID, NamedPlane, Samples};
use crate::index::seen::Seen;
use crate::method::deferred::Settings;
use crate::method::deferred::indices::each_centre;
use crate::method::deferred::part::Whole;
use crate::method::deferred::visibility::NONE;
use crate::method::tests::{id, scalar};
use crate::method::{Method, Session};
use crate::number::Exact;
use crate::scene::objects::{Geometry, Motion, Object, Objects};
use crate::scene::transform::rotation;
use crate::scene::{Camera, Lens, Pose, Primitives, Scene, Similarity, Surfels};
use crate::source::Shape;
use crate::splat::{Epsilon, Kernel, Outline};
use crate::verdict::client::{Client, Rounding};
use crate::verdict::tests::{Slip, verdict};
use crate::verdict::tests::{assert_found, assert_right, assert_right_in_doubles};
use crate::verdict::{Outcome, Verdict};
use glam::{DVec3, Vec3};

const ROUNDINGS: [Rounding; 2] = [Rounding::Ieee, Rounding::Gpu];

/// Moving objects before a turning camera, and settings.
struct Sequence {
    scene: Scene,
    settings: Settings,
    lens: Lens,
}

/// A frame of a sequence: scene and camera, what the previous frame saw, and the planes of all
/// stages.
struct DrawnFrame {
    scene: Scene,
    camera: Camera,
    before: Option<Seen>,
    frame: Frame<f32>,
}

fn sequence(settings: Settings, lens: Lens) -> Sequence {
    let geometry = |name: &str, surfels| Geometry {
        name: name.into(),
        surfels,
        primitives: Primitives::default(),
        detail: None,
    };
    let geometries = vec![
        geometry("ring", Shape::Torus.surfels(700, 1).unwrap()),
        geometry("ball", Shape::Sphere.surfels(400, 2).unwrap()),
    ];
    let place = |at: [f64; 3], turn, scale| Similarity {
        rotation: rotation(DVec3::new(1.0, 0.5, 0.25), turn),
        scale,
        translation: DVec3::from_array(at),
    };
    let object = |name: &str, geometry, keys, color| Object {
        name: name.into(),
        geometry,
        motion: Motion::new(keys).unwrap(),
        color,
    };
    let left =
        vec![(0, place([-0.5, 0.0, 0.0], 0.0, 1.0)), (2, place([0.25, 0.25, 0.0], 60.0, 1.25))];
    let right =
        vec![(0, place([0.5, 0.0, -0.5], 90.0, 1.0)), (2, place([0.25, 0.0, 0.5], 20.0, 1.0))];
    let ball =
        vec![(0, place([0.1, -0.4, -1.0], 10.0, 1.0)), (2, place([-0.6, -0.2, -1.0], 30.0, 0.75))];
    let objects = vec![
        object("left", 0, left, Some(Vec3::new(0.75, 0.25, 0.125))),
        object("right", 0, right, Some(Vec3::new(0.125, 0.5, 0.75))),
        object("ball", 1, ball, None),
    ];
    let objects = Objects::new(geometries, objects, Vec3::splat(0.5)).unwrap();
    let scene = Scene { objects: Some(objects), ..Scene::lit("moving", Surfels::none()) };
    Sequence { scene, settings, lens }
}

/// Sequences with several settings and cameras.
fn sequences() -> Vec<Sequence> {
    let mut raycast = Settings { flags: 8, ..Settings::default() };
    raycast.splats.kernel = Kernel { outline: Outline::RayCast, ..Kernel::DEFAULT };
    let mut both_sides = Settings { flags: 64, ..Settings::default() };
    both_sides.splats.cull = false;
    both_sides.splats.epsilon = Epsilon::World(0.05);
    vec![
        sequence(Settings { flags: 16, ..Settings::default() }, Lens::FieldOfView(40.0)),
        sequence(raycast, Lens::FieldOfView(30.0)),
        sequence(both_sides, Lens::Orthographic(3.0)),
        sequence(
            Settings { flags: 4, second: false, ..Settings::default() },
            Lens::FieldOfView(40.0),
        ),
        with_detail(sequence(
            Settings { flags: 2, ..Settings::default() },
            Lens::FieldOfView(40.0),
        )),
    ]
    .into_iter()
    .chain(polygons::sequences())
    .collect()
}

/// The sequence with levels of detail for all objects.
fn with_detail(of: Sequence) -> Sequence {
    let objects = of.scene.objects.as_ref().unwrap();
    let geometries = objects
        .geometries()
        .iter()
        .map(|geometry| geometry.clone().with_detail(1.0, &Exec::sequential()).unwrap());
    let all = objects.objects().to_vec();
    let objects = Objects::new(geometries.collect(), all, objects.fill()).unwrap();
    Sequence { scene: Scene { objects: Some(objects), ..of.scene.clone() }, ..of }
}

impl Sequence {
    fn frames<R: Exact>(&self, exec: &Exec) -> Vec<DrawnFrame> {
        let mut before: Option<Seen> = None;
        let of_frame = |frame: u32| {
            let eye = rotation(DVec3::Y, 8.0 * f64::from(frame)) * DVec3::new(0.5, 0.75, 4.0);
            let pose = Pose { eye, target: DVec3::ZERO, up: DVec3::Y };
            let camera = Camera::new(51, 39, pose, self.lens).unwrap();
            let seen = |all: &Objects| all.at(frame).unwrap().seen_from(&camera, exec).unwrap();
            let objects = self.scene.objects.as_ref().map(seen);
            let scene = Scene { objects, ..self.scene.clone() };
            let mut session = Session::new(&scene, self.method(), exec).unwrap();
            session.resume(before.clone());
            let picture = session.define::<R>(&camera, true).unwrap();
            let given = std::mem::replace(&mut before, picture.seen);
            drop(session);
            DrawnFrame { scene, camera, before: given, frame: picture.frame.to_f32() }
        };
        (0..3).map(of_frame).collect()
    }

    fn method(&self) -> Method {
        self.settings.into()
    }
}

impl DrawnFrame {
    fn session<'a>(&'a self, method: Method, exec: &'a Exec) -> Session<'a> {
        let mut session = Session::new(&self.scene, method, exec).unwrap();
        session.resume(self.before.clone());
        session
    }

    fn judge(&self, method: Method, frame: &Frame<f32>, rounding: Rounding) -> Verdict {
        let exec = Exec::new(1, 16).unwrap();
        verdict(&self.session(method, &exec), &self.camera, frame, rounding)
    }

    /// A client that computes each stage in `f64` and keeps every plane in `f32`.
    fn in_doubles(&self, method: Method) -> Frame<f32> {
        let exec = Exec::new(1, 16).unwrap();
        let session = self.session(method, &exec);
        let mut frame = session.define::<f64>(&self.camera, true).unwrap().frame;
        for stage in method.stages() {
            let left = session.stage(&self.camera, stage.name, &frame).unwrap();
            for mut plane in left.planes {
                match &mut plane.samples {
                    Samples::Scalar(p) => {
                        p.values_mut().iter_mut().for_each(|v| *v = f64::from(*v as f32));
                    }
                    Samples::Color(p) | Samples::Vector(p) => {
                        let values = p.values_mut().iter_mut().flatten();
                        values.for_each(|v| *v = f64::from(*v as f32));
                    }
                    Samples::Index(_) | Samples::Count(_) => {}
                }
                if let Some(own) = frame.planes.iter_mut().find(|own| own.name == plane.name) {
                    *own = plane;
                }
            }
        }
        frame.to_f32()
    }

    /// The frame with some planes of a stage replaced, and the later planes recomputed from them.
    fn from(&self, method: Method, planes: &[NamedPlane<f32>], stage: &str) -> Frame<f32> {
        let exec = Exec::new(1, 16).unwrap();
        let session = self.session(method, &exec);
        let mut frame = with(&self.frame, planes);
        let stages = method.stages().iter().map(|stage| stage.name);
        for next in stages.skip_while(|name| *name != stage).skip(1) {
            let left = session.stage(&self.camera, next, &frame).unwrap();
            frame = with(&frame, &left.planes);
        }
        frame
    }
}

/// A frame with some of its planes replaced; no plane is added.
fn with(frame: &Frame<f32>, planes: &[NamedPlane<f32>]) -> Frame<f32> {
    let mut frame = frame.clone();
    for own in &mut frame.planes {
        if let Some(other) = planes.iter().find(|plane| plane.name == own.name) {
            *own = other.clone();
        }
    }
    frame
}

/// Only the planes of the picture.
fn plain(frame: &Frame<f32>) -> Frame<f32> {
    let own = |plane: &&NamedPlane<f32>| !plane.name.contains('.') && plane.name != "resolved";
    Frame { planes: frame.planes.iter().filter(own).cloned().collect(), ..*frame }
}

fn wrong(verdict: &Verdict) -> Option<String> {
    let stage = verdict.first_wrong()?;
    Some(format!("{}: {:?}", stage.stage, stage.worst))
}

#[test]
fn what_the_crate_draws_of_a_sequence_is_right() {
    let exec = Exec::new(1, 16).unwrap();
    for (i, sequence) in sequences().iter().enumerate() {
        let method = sequence.method();
        for (j, shown) in sequence.frames::<f32>(&exec).iter().enumerate() {
            let doubles = shown.in_doubles(method);
            assert_ne!(doubles.planes, shown.frame.planes);
            for (frame, rounding) in [&shown.frame, &doubles]
                .into_iter()
                .flat_map(|frame| ROUNDINGS.map(|rounding| (frame, rounding)))
            {
                let what = format!("sequence {i}, frame {j}, {rounding:?}");
                let found = shown.judge(method, frame, rounding);
                assert_eq!(wrong(&found), None, "{what}");
                assert_eq!(found.outcome(), Outcome::Right, "{what}");
                assert!(found.stages.iter().all(|stage| !stage.planes.is_empty()));
                let found = shown.judge(method, &plain(frame), rounding);
                assert_eq!(wrong(&found), None, "{what}, plain");
                let Verdict { undecided, unbounded, covered, .. } = found;
                let counts = format!("{undecided} and {unbounded} of {covered}");
                // Surfels within epsilon behind polygons are selected, but not seen.
                let most = if i < 5 { 50 } else { 6 };
                // A picture without pass 3 does not show what pass 1 left either.
                let known = i < 5 || sequence.settings.second;
                assert!(
                    !known || (undecided + unbounded) * most < covered,
                    "{what}, plain: {counts}"
                );
            }
        }
    }
}

#[test]
fn each_plane_alone_is_right() {
    let exec = Exec::new(1, 16).unwrap();
    for sequence in sequences() {
        let shown = sequence.frames::<f32>(&exec).pop().unwrap();
        for plane in &shown.frame.planes {
            let frame = Frame { planes: vec![plane.clone()], ..shown.frame };
            let found = shown.judge(sequence.method(), &frame, Rounding::Ieee);
            assert_eq!(wrong(&found), None, "{}", plane.name);
        }
    }
}

#[test]
fn a_scene_without_objects_is_judged() {
    for (shape, lens) in [
        (Shape::Sphere, None),
        (Shape::Cluster, None),
        (Shape::Torus, Some(Lens::Orthographic(3.0))),
    ] {
        let scene = Scene::lit("flat", shape.surfels(700, 5).unwrap());
        let camera = crate::verdict::tests::camera(shape, [47, 35], lens);
        let method = Settings::default().into();
        assert_right(&scene, &camera, method);
        assert_right_in_doubles(&scene, &camera, method);
        assert_found(
            &scene,
            &camera,
            method,
            &[
                ("indices.Z", Slip::Off(0.001), "indices"),
                ("indices.Z", Slip::NotANumber, "indices"),
                ("indices.id", Slip::More, "indices"),
                ("indices.id", Slip::Dropped, "indices"),
                ("difference.Z", Slip::Off(0.001), "difference"),
                ("difference.id", Slip::More, "difference"),
                ("attributes.weight", Slip::Off(0.001), "attributes"),
                ("attributes.count", Slip::More, "attributes"),
                ("Z", Slip::Next, "normalization"),
                ("id", Slip::More, "normalization"),
                ("normal", Slip::Off(0.001), "normalization"),
                ("A", Slip::Off(-1.0), "shading"),
            ],
        );
    }
}

/// A plane of ids and a plane of depths for a stage.
fn planes(stage: &str, like: &Frame<f32>, pixels: &[(u32, f32)]) -> Vec<NamedPlane<f32>> {
    let (mut ids, mut depths) = (id(like, "id").clone(), scalar(like, "Z").clone());
    for (i, &(id, depth)) in pixels.iter().enumerate() {
        (ids.values_mut()[i], depths.values_mut()[i]) = (id, depth);
    }
    vec![
        NamedPlane { name: format!("{stage}.Z"), samples: Samples::Scalar(depths) },
        NamedPlane { name: format!("{stage}.id"), samples: Samples::Index(ids) },
    ]
}

/// The ids and depths that a frame has of a stage.
fn kept(frame: &Frame<f32>, stage: &str) -> Vec<(u32, f32)> {
    let depths = scalar(frame, &format!("{stage}.Z")).values();
    id(frame, &format!("{stage}.id")).values().iter().copied().zip(depths.iter().copied()).collect()
}

/// Pass 2 of a client that keeps another passing fragment in a pixel: `limit` is computed from the
/// depth of pass 1, and a comparison chooses.
fn other_indices(
    shown: &DrawnFrame,
    settings: &Settings,
    limit: impl Fn(f32) -> f32,
    better: impl Fn(f32, f32) -> bool,
) -> Vec<NamedPlane<f32>> {
    let exec = Exec::new(1, 16).unwrap();
    let session = shown.session((*settings).into(), &exec);
    let visible = scalar(&shown.frame, "visibility.Z");
    let mut found = vec![(NO_ID, f32::INFINITY); visible.values().len()];
    session.with_job(&shown.camera, |job| {
        each_centre::<f32>(job, &settings.splats, &Whole::new(job.scene), |id, [x, y], t| {
            assert_ne!(id, NONE);
            let pixel = &mut found[(y * shown.frame.width + x) as usize];
            if t <= limit(*visible.at(x, y)) && (pixel.0 == NO_ID || better(t, pixel.1)) {
                *pixel = (id as u32, t);
            }
        });
    });
    planes("indices", &shown.frame, &found)
}

/// Asserts that a client's planes are wrong, first in this stage.
fn assert_first_wrong(
    shown: &DrawnFrame,
    method: Method,
    frame: &Frame<f32>,
    stage: &str,
    what: &str,
) {
    assert_first_wrong_of(shown, method, frame, &[stage], what);
}

/// Asserts the same for one of several stages.
fn assert_first_wrong_of(
    shown: &DrawnFrame,
    method: Method,
    frame: &Frame<f32>,
    stages: &[&str],
    what: &str,
) {
    for rounding in ROUNDINGS {
        let found = shown.judge(method, frame, rounding);
        let first = found.first_wrong().map(|wrong| wrong.stage);
        let stage = first.unwrap_or_else(|| panic!("{what} {rounding:?} is right"));
        assert!(stages.contains(&stage), "{what} {rounding:?}: {stage}");
        // When the pixel is explained, the fault is there.
        let exec = Exec::new(1, 16).unwrap();
        let mut client = Client::from(frame);
        client.rounding = rounding;
        let worst = found.first_wrong().and_then(|stage| stage.worst.clone()).unwrap();
        let checks = shown.session(method, &exec).checks(&shown.camera, &client, worst.pixel);
        let fault = format!("{:?}", worst.fault);
        let there = |check: &crate::verdict::Check| {
            check.stage == stage && check.error > 1.0 && format!("{:?}", check.fault) == fault
        };
        assert!(checks.unwrap().iter().any(there), "{what} {rounding:?}: {worst:?}");
    }
}

#[test]
fn what_has_no_plane_of_a_stage_is_judged_by_the_others() {
    let exec = Exec::new(1, 16).unwrap();
    for (i, sequence) in sequences().into_iter().enumerate() {
        let frames = sequence.frames::<f32>(&exec);
        let shown = &frames[2];
        for stage in ["visibility", "indices", "difference", "attributes"] {
            let left = |plane: &&NamedPlane<f32>| !plane.name.starts_with(stage);
            let planes: Vec<_> = shown.frame.planes.iter().filter(left).cloned().collect();
            for rounding in ROUNDINGS {
                let frame = Frame { planes: planes.clone(), ..shown.frame };
                let found = shown.judge(sequence.method(), &frame, rounding);
                assert_eq!(wrong(&found), None, "without {stage}");
                // Where a polygon is seen, a splat without weight may be in front of it.
                let most = if i < 5 { 50 } else { 8 };
                let counts = [found.undecided, found.covered];
                assert!(counts[0] * most < counts[1], "{i} without {stage}: {counts:?}");
            }
            // Ids without depths, and depths without ids.
            for other in ["Z", "id"] {
                let name = format!("{stage}.{other}");
                let left = |plane: &&NamedPlane<f32>| plane.name != name;
                let planes = shown.frame.planes.iter().filter(left).cloned().collect();
                let frame = Frame { planes, ..shown.frame };
                let found = shown.judge(sequence.method(), &frame, Rounding::Gpu);
                assert_eq!(wrong(&found), None, "without {name}");
            }
        }
    }
}
