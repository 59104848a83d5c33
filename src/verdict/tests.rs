//! Helpers that the tests of verdicts share.

use crate::frame::{Exec, Frame, NO_ID, Plane, Samples};
use crate::method::session::tests::two_spheres;
use crate::method::tests::cameras;
use crate::method::{Method, Session};
use crate::number::Exact;
use crate::number::random::unit;
use crate::scene::environment::Map;
use crate::scene::{Camera, Cloud, Environment, Groups, Lens, Scene, Surfels};
use crate::source::Shape;
use crate::verdict::client::{Client, Rounding, Storage};
use crate::verdict::{Finding, Outcome, Verdict};

/// Surfels with opacities from 0.25 to 1, some of them opaque.
pub(crate) fn transparent(surfels: Surfels) -> Surfels {
    let opacity = |i| if i % 7 == 0 { 1.0 } else { 0.25 + 0.5 * unit(7, i) };
    let opacity = (0..surfels.len() as u64).map(opacity).collect();
    Surfels::new(Cloud { opacity: Some(opacity), ..surfels.into_cloud() }).unwrap().0
}

/// An environment map of 32 x 16 pixels in many colours, turned by this many columns, upside down
/// or not.
pub(crate) fn surroundings(turned: u32, flipped: bool) -> Environment {
    let pixel = |i: u32| {
        let (x, y) = ((i + turned) % 32, if flipped { 15 - i / 32 } else { i / 32 });
        [0, 1, 2].map(|c| 0.25 + unit(11, u64::from(3 * (32 * y + x) + c)))
    };
    let pixels = (0..512).map(pixel).collect();
    Environment::Map(Map::new(Plane::from_values(32, 16, pixels)).unwrap())
}

/// Asserts that a picture before one environment is right, and before another is wrong in a stage.
pub(crate) fn assert_environment_found(
    scene: &Scene,
    camera: &Camera,
    method: Method,
    stage: &str,
) {
    let exec = Exec::new(1, 16).unwrap();
    let before = |environment| Scene { environment: Some(environment), ..scene.clone() };
    let all = [surroundings(0, false), surroundings(1, false), surroundings(0, true)];
    let others = all[1..].iter().chain([&Environment::Sky]);
    for (own, other) in others.flat_map(|other| [(&all[0], other), (other, &all[0])]) {
        let (own, other) = (before(own.clone()), before(other.clone()));
        let [own, other] = [&own, &other].map(|scene| Session::new(scene, method, &exec).unwrap());
        let frame = own.define::<f32>(camera, true).unwrap().frame;
        for rounding in [Rounding::Ieee, Rounding::Gpu] {
            let found = verdict(&own, camera, &frame, rounding);
            assert_eq!((wrong(&found), found.outcome()), (None, Outcome::Right), "{rounding:?}");
            let found = verdict(&other, camera, &frame, rounding);
            assert_eq!(found.first_wrong().map(|wrong| wrong.stage), Some(stage), "{rounding:?}");
        }
    }
}

/// A camera before a shape; without a lens, the shape's own lens.
pub(crate) fn camera(shape: Shape, size: [u32; 2], lens: Option<Lens>) -> Camera {
    let lens = lens.unwrap_or(shape.default_lens());
    Camera::new(size[0], size[1], shape.default_pose(), lens).unwrap()
}

/// The verdict on a frame as a client's planes.
pub(crate) fn verdict(
    session: &Session<'_>,
    camera: &Camera,
    frame: &Frame<f32>,
    rounding: Rounding,
) -> Verdict {
    let mut client = Client::from(frame);
    client.rounding = rounding;
    session.verify(camera, &client, Verdict::BUDGET).unwrap()
}

/// The worst fault in the first wrong stage.
fn wrong(verdict: &Verdict) -> Option<(&'static str, Finding)> {
    verdict.first_wrong().and_then(|stage| Some((stage.stage, stage.worst.clone()?)))
}

/// Asserts that the crate's own planes are right: with all stages, with none, and each plane alone.
pub(crate) fn assert_right(scene: &Scene, camera: &Camera, method: Method) {
    let exec = Exec::new(1, 16).unwrap();
    let session = Session::new(scene, method, &exec).unwrap();
    let whole = session.define::<f32>(camera, true).unwrap().frame;
    let plain = session.define::<f32>(camera, false).unwrap().frame;
    for rounding in [Rounding::Ieee, Rounding::Gpu] {
        let found = verdict(&session, camera, &whole, rounding);
        assert_eq!(wrong(&found), None, "{rounding:?}");
        assert_eq!(found.outcome(), Outcome::Right, "{rounding:?} {}", found.undecided);
        for stage in &found.stages {
            let leaves = method.stages().iter().find(|s| s.name == stage.stage).unwrap().leaves;
            let there =
                |name: &&str| whole.planes.iter().any(|p| leaves_called(leaves, name, &p.name));
            let all = leaves.iter().map(|row| row.name).filter(there).count();
            assert_eq!(stage.planes.len(), all, "{} {:?}", stage.stage, stage.planes);
        }
        let found = verdict(&session, camera, &plain, rounding);
        assert_eq!(wrong(&found), None, "{rounding:?}");
    }
    for plane in &whole.planes {
        let frame = Frame { planes: vec![plane.clone()], ..whole };
        let found = verdict(&session, camera, &frame, Rounding::Ieee);
        assert_eq!(wrong(&found), None, "{}", plane.name);
    }
}

/// Asserts that a client is right that stores every plane in `f16` and continues from it.
pub(crate) fn assert_right_in_halves(scene: &Scene, camera: &Camera, method: Method) {
    assert_eq!(assert_none_wrong_in_halves(scene, camera, method), [Outcome::Right; 2]);
}

/// Asserts that such a client is not wrong, where much may be undecided.
pub(crate) fn assert_none_wrong_in_halves(
    scene: &Scene,
    camera: &Camera,
    method: Method,
) -> [Outcome; 2] {
    let half = |v: &mut f32| *v = f32::from_bits((v.to_bits() + 0x1000) & !0x1FFF);
    outcomes_in(scene, camera, method, Storage::Half, half)
}

/// Asserts that a client is right that computes each stage in `f64` and stores every plane in
/// `f32`.
pub(crate) fn assert_right_in_doubles(scene: &Scene, camera: &Camera, method: Method) {
    let single = |v: &mut f64| *v = f64::from(*v as f32);
    let outcomes = outcomes_in(scene, camera, method, Storage::Single, single);
    assert_eq!(outcomes, [Outcome::Right; 2]);
}

/// Asserts that nothing is wrong for a client that rounds every number of a plane this way; returns
/// both outcomes.
fn outcomes_in<R: Exact>(
    scene: &Scene,
    camera: &Camera,
    method: Method,
    storage: Storage,
    round: impl Fn(&mut R),
) -> [Outcome; 2] {
    let exec = Exec::new(1, 16).unwrap();
    let session = Session::new(scene, method, &exec).unwrap();
    let mut frame = session.define::<R>(camera, true).unwrap().frame;
    for stage in method.stages().iter().filter(|stage| !stage.leaves.is_empty()) {
        // A level is computed from the last level, so it takes as many runs as there are levels.
        loop {
            let before = format!("{frame:?}");
            let left = session.stage(camera, stage.name, &frame).unwrap();
            for mut plane in left.planes {
                match &mut plane.samples {
                    Samples::Scalar(p) => p.values_mut().iter_mut().for_each(&round),
                    Samples::Color(p) | Samples::Vector(p) => {
                        p.values_mut().iter_mut().flatten().for_each(&round);
                    }
                    Samples::Index(_) | Samples::Count(_) => {}
                }
                match frame.planes.iter_mut().find(|own| own.name == plane.name) {
                    Some(own) => *own = plane,
                    None => frame.planes.push(plane),
                }
            }
            if format!("{frame:?}") == before {
                break;
            }
        }
    }
    let mut client = Client::from(&frame.to_f32());
    for plane in &frame.planes {
        client = client.stored(&plane.name, storage);
    }
    [Rounding::Ieee, Rounding::Gpu].map(|rounding| {
        client.rounding = rounding;
        let found = session.verify(camera, &client, Verdict::BUDGET).unwrap();
        assert_eq!(wrong(&found), None, "{rounding:?}");
        found.outcome()
    })
}

/// Whether a plane belongs to the row with this name.
fn leaves_called(leaves: &[crate::method::PlaneRow], row: &str, plane: &str) -> bool {
    leaves.iter().any(|leaf| leaf.name == row && leaf.is_called(plane))
}

/// A wrong value of a client.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Slip {
    /// Too large by this fraction of itself.
    Off(f32),
    /// The next float.
    Next,
    /// Not a number.
    NotANumber,
    /// One more; for an id or a count.
    More,
    /// The value of an empty cell, in all planes of this layer.
    Dropped,
}

/// Asserts that each slip is found in its stage. The slip is in the middle of the values that say
/// something.
pub(crate) fn assert_found(
    scene: &Scene,
    camera: &Camera,
    method: Method,
    slips: &[(&str, Slip, &str)],
) {
    assert_found_where(scene, camera, method, slips, |_, _| true);
}

/// Asserts the same for the values of pixels where a condition holds.
pub(crate) fn assert_found_where(
    scene: &Scene,
    camera: &Camera,
    method: Method,
    slips: &[(&str, Slip, &str)],
    holds: impl Fn(&Frame<f32>, usize) -> bool,
) {
    let exec = Exec::new(1, 16).unwrap();
    let session = Session::new(scene, method, &exec).unwrap();
    let right = session.define::<f32>(camera, true).unwrap().frame;
    for (plane, slip, stage) in slips {
        let mut frame = right.clone();
        let of = frame.planes.iter().find(|p| p.name == *plane).unwrap();
        let mut all = places(&of.samples);
        all.retain(|place| holds(&right, *place));
        let place = *all.get(all.len() / 2).unwrap_or_else(|| panic!("nothing in {plane}"));
        for plane in frame.planes.iter_mut().filter(|p| touches(&p.name, plane, *slip)) {
            let empty = match plane.name.rsplit('.').next() {
                Some("Z" | "front" | "voronoi") => f32::INFINITY,
                Some("back") => f32::NEG_INFINITY,
                _ => 0.0,
            };
            change(&mut plane.samples, place, *slip, empty);
        }
        for rounding in [Rounding::Ieee, Rounding::Gpu] {
            let found = wrong(&verdict(&session, camera, &frame, rounding));
            let (first, worst) = found.unwrap_or_else(|| panic!("{plane}, {slip:?} is right"));
            assert_eq!(first, *stage, "{plane}, {slip:?}, {rounding:?}");
            // When the pixel is explained, the fault is there.
            let mut client = Client::from(&frame);
            client.rounding = rounding;
            let checks = session.checks(camera, &client, worst.pixel).unwrap();
            // Compared in words, because NaN equals nothing.
            let fault = format!("{:?}", worst.fault);
            let there = checks.iter().any(|check| {
                check.stage == first && check.error > 1.0 && format!("{:?}", check.fault) == fault
            });
            assert!(there, "{plane}, {slip:?}, {rounding:?}: {worst:?}");
        }
    }
}

/// Whether a slip in one plane changes another plane. A dropped cell changes all planes of its
/// layer.
fn touches(other: &str, plane: &str, slip: Slip) -> bool {
    let layer = |name: &str| name.split('.').next().unwrap_or_default().to_owned();
    other == plane || (matches!(slip, Slip::Dropped) && layer(other) == layer(plane))
}

/// The values that say something.
fn places(samples: &Samples<f32>) -> Vec<usize> {
    let says = |v: f32| v != 0.0 && v.is_finite();
    match samples {
        Samples::Scalar(p) => those(p.values(), |v| says(*v)),
        Samples::Color(p) | Samples::Vector(p) => those(p.values(), |v| says(v[0])),
        Samples::Index(p) => those(p.values(), |v| *v != NO_ID),
        Samples::Count(p) => those(p.values(), |v| *v != 0),
    }
}

fn those<T>(values: &[T], says: impl Fn(&T) -> bool) -> Vec<usize> {
    (0..values.len()).filter(|&i| says(&values[i])).collect()
}

/// Changes one value. `empty` is the value of an empty cell.
fn change(samples: &mut Samples<f32>, place: usize, slip: Slip, empty: f32) {
    let number = |v: &mut f32| {
        *v = match slip {
            Slip::Off(part) => *v * (1.0 + part),
            Slip::Next => v.next_up(),
            Slip::NotANumber => f32::NAN,
            Slip::More => *v + 1.0,
            Slip::Dropped => empty,
        }
    };
    let dropped = matches!(slip, Slip::Dropped);
    match samples {
        Samples::Scalar(p) => number(&mut p.values_mut()[place]),
        Samples::Color(p) | Samples::Vector(p) => {
            let value = &mut p.values_mut()[place];
            if dropped { *value = [0.0; 3] } else { number(&mut value[0]) }
        }
        Samples::Index(p) => {
            let id = &mut p.values_mut()[place];
            *id = if dropped { NO_ID } else { *id + 1 };
        }
        Samples::Count(p) => {
            let count = &mut p.values_mut()[place];
            *count = if dropped { 0 } else { *count + 1 };
        }
    }
}

/// The verdict on a picture of objects is the verdict on the same surfels without objects.
#[test]
fn ids_of_objects_change_no_verdict() {
    let exec = Exec::sequential();
    let [plain, objects] = two_spheres();
    let camera = cameras()[6];
    for method in Method::all().into_iter().filter(|method| !method.draws_objects()) {
        let outcome = |scene| {
            let groups = Groups::new(vec![0; 600], vec![], vec![1.0]).unwrap();
            let session = Session::with_groups(scene, method, Some(groups), &exec).unwrap();
            let client = Client::from(&session.define::<f32>(&camera, true).unwrap().frame);
            session.verify(&camera, &client, 0.02).unwrap().outcome()
        };
        assert_eq!(outcome(&objects), outcome(&plain), "{method:?}");
    }
}

/// Of two discs, 1e-4 apart, a client keeps the farther one.
#[test]
fn a_depth_test_in_few_digits_may_keep_the_farther_of_two() {
    use crate::method::{blue, deferred, ewa, peeling, single_pass, template};
    use crate::splat::{Epsilon, SplatSettings};
    use glam::{DVec3, Vec3};
    let discs = |depths: &[f32], colors: &[Vec3]| {
        let cloud = Cloud {
            position: depths.iter().map(|z| Vec3::new(0.1, 0.03, *z)).collect(),
            normal: Some(vec![Vec3::Z; depths.len()]),
            radius: Some(vec![0.5; depths.len()]),
            color: Some(colors.to_vec()),
            groups: Some(Groups::new(vec![0; depths.len()], Vec::new(), vec![1.0]).unwrap()),
            ..Cloud::default()
        };
        Scene::unlit("discs", Surfels::new(cloud).unwrap().0)
    };
    let both = discs(&[0.0, 1e-4], &[Vec3::X, Vec3::Y]);
    let farther = discs(&[0.0], &[Vec3::X]);
    let pose = crate::scene::Pose { eye: DVec3::Z * 4.0, target: DVec3::ZERO, up: DVec3::Y };
    let camera = Camera::new(24, 20, pose, Lens::FieldOfView(30.0)).unwrap();
    let splats = SplatSettings { epsilon: Epsilon::World(0.0), ..SplatSettings::default() };
    let methods: [Method; 6] = [
        ewa::Settings { ..splats }.into(),
        single_pass::Settings { splats, depth: single_pass::DepthTest::Plain }.into(),
        template::Settings::default().into(),
        peeling::Settings { splats, ..Default::default() }.into(),
        blue::Settings::default().into(),
        deferred::Settings { splats, ..Default::default() }.into(),
    ];
    let exec = Exec::sequential();
    // 2^-16 of z between 1 and 100 is 2.4e-4 at a depth of 4, and 2^-24 of it is 1e-6.
    let buffer = |step| Storage::DepthBuffer { step, near: 1.0, far: 100.0 };
    for method in methods {
        let session = Session::new(&both, method, &exec).unwrap();
        let kept = Session::new(&farther, method, &exec).unwrap();
        let frame = kept.define::<f32>(&camera, true).unwrap().frame;
        for (depth_test, right) in [
            (Storage::Single, false),
            (buffer(1.0 / 16_777_215.0), false),
            (buffer(1.0 / 65_535.0), true),
        ] {
            let mut client = Client::from(&frame);
            client.depth_test = depth_test;
            let found = session.verify(&camera, &client, 1.0).unwrap();
            let wrong = wrong(&found);
            assert_eq!(wrong.is_none(), right, "{} {depth_test:?} {wrong:?}", method.name());
            // The depth that a pixel keeps is no less exact.
            for plane in &mut client.frame_mut().planes {
                if let (true, Samples::Scalar(plane)) =
                    (plane.name.ends_with('Z'), &mut plane.samples)
                {
                    plane.values_mut().iter_mut().for_each(|depth| *depth += 5e-5);
                }
            }
            let found = session.verify(&camera, &client, 1.0).unwrap();
            assert!(found.first_wrong().is_some(), "{} {depth_test:?}", method.name());
        }
    }
}
