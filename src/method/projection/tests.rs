//! Check the stages and planes of both image-space methods.

use crate::error::Error;
use crate::frame::{Exec, Frame, NamedPlane, Plane, Samples};
use crate::method::{Holds, Method, Session};
use crate::number::Exact;
use crate::scene::{Camera, Light, Scene};

/// The planes in the order of their names. Floats are written as their shortest decimals, which
/// tell floats apart to the last bit, and the signs of zeros too.
fn text<R: Exact>(frame: &Frame<R>) -> Vec<String> {
    let mut planes: Vec<String> = frame.planes.iter().map(|p| format!("{p:?}")).collect();
    planes.sort();
    planes
}

/// Adds a light to a scene.
pub(crate) fn lit(scene: Scene) -> Scene {
    Scene { lights: vec![Light::DEFAULT], ..scene }
}

/// Asserts that every stage, run alone, leaves the same planes as in the picture. The stage runs on
/// the planes of all stages, and on the planes of only the stages that it reads. Every plane of a
/// picture must belong to one row.
pub(crate) fn every_stage_runs_alone<R: Exact>(scene: &Scene, camera: &Camera, method: Method) {
    let exec = Exec::new(2, 16).unwrap();
    let session = Session::new(scene, method, &exec).unwrap();
    let picture = session.define::<R>(camera, true).unwrap();
    let names: Vec<_> = picture.timings.iter().map(|(name, _)| *name).collect();
    assert_eq!(names, method.stages().iter().map(|stage| stage.name).collect::<Vec<_>>());
    let whole = picture.frame;
    for plane in &whole.planes {
        let rows = method.stages().iter().filter_map(|stage| stage.row(&plane.name));
        let rows: Vec<_> = rows.collect();
        assert_eq!(rows.len(), 1, "{}", plane.name);
        assert!(rows[0].holds(&plane.samples), "{}", plane.name);
    }
    for stage in method.stages() {
        let expected = text(&stage.planes_of(&whole));
        let read = |plane: &&NamedPlane<R>| {
            let mut stages = method.stages().iter().filter(|s| stage.reads.contains(&s.name));
            stages.any(|s| s.row(&plane.name).is_some())
        };
        let planes = whole.planes.iter().filter(read).cloned().collect();
        let reads = Frame { planes, ..whole };
        for from in [&whole, &reads] {
            let found = session.stage(camera, stage.name, from).unwrap();
            assert!(text(&found) == expected, "{} of {:?}", stage.name, session.method());
        }
    }
}

/// Runs a stage on the planes of a picture after `change` has changed them.
pub(crate) fn stage_with(
    scene: &Scene,
    camera: &Camera,
    method: Method,
    stage: &str,
    change: impl Fn(&mut Frame<f32>),
) -> Result<Frame<f32>, Error> {
    let exec = Exec::sequential();
    let session = Session::new(scene, method, &exec).unwrap();
    let mut frame = session.define::<f32>(camera, true).unwrap().frame;
    change(&mut frame);
    session.stage(camera, stage, &frame)
}

/// The samples of a plane, mutable.
pub(crate) fn samples_mut<'a>(frame: &'a mut Frame<f32>, name: &str) -> &'a mut Samples<f32> {
    &mut frame.planes.iter_mut().find(|plane| plane.name == name).unwrap().samples
}

/// Asserts that planes that are missing, of another type or of another size are refused in one line
/// that names the plane.
pub(crate) fn wrong_planes_are_refused(scene: &Scene, camera: &Camera, method: Method) {
    let invalid = |stage: &str, change: &dyn Fn(&mut Frame<f32>), says: &str| {
        let error = stage_with(scene, camera, method, stage, change).unwrap_err();
        let line = error.to_string();
        assert!(matches!(error, Error::Invalid(_)), "{stage}: {line}");
        assert!(line.contains(says) && !line.contains('\n'), "{stage}: {line}");
    };
    invalid("nothing", &|_| {}, "`nothing`");
    invalid("shading", &|frame| frame.width += 1, "pixels");
    for stage in method.stages() {
        let of = |name: &str| method.stages().iter().find(|s| s.name == name).unwrap();
        let rows = stage.reads.iter().flat_map(|name| of(name).leaves);
        for row in rows.filter(|row| row.name.starts_with("projection")) {
            if row.holds.plain() == Holds::Scalar && stage.reads == ["projection"] {
                let name = row.name;
                let missing = |frame: &mut Frame<f32>| frame.planes.retain(|p| p.name != name);
                invalid(stage.name, &missing, name);
                let other = |frame: &mut Frame<f32>| {
                    let plane = Plane::filled(frame.width, frame.height, 0);
                    *samples_mut(frame, name) = Samples::Count(plane);
                };
                invalid(stage.name, &other, name);
                let small = |frame: &mut Frame<f32>| {
                    *samples_mut(frame, name) = Samples::Scalar(Plane::filled(1, 1, 0.0));
                };
                invalid(stage.name, &small, name);
            }
        }
    }
    let kind = |frame: &mut Frame<f32>| {
        *samples_mut(frame, "projection.kind") =
            Samples::Count(Plane::filled(frame.width, frame.height, 5));
    };
    invalid(method.stages()[1].name, &kind, "has 5 at (0, 0)");
}
