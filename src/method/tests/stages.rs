//! Stages keep their contract: a plane has one row, and a stage gives the same planes from planes
//! that were read back.

use crate::frame::{Exec, Frame};
use crate::method::stage::{PlaneRow, Stage, When};
use crate::method::{Method, Session, single_pass, transparent, transparent_hq};
use crate::number::Exact;
use crate::number::random::unit;
use crate::scene::{Camera, Cloud, Environment, Light, Scene, Surfels};
use crate::shade::optics::{BendingLayers, Refraction};
use crate::source::Shape;

/// Every method, and settings that change the planes of some methods.
fn methods() -> Vec<Method> {
    let mut methods = Method::all();
    for method in &mut methods {
        if let Method::Peeling(settings) = method {
            // Every layer must leave its planes.
            settings.layers = crate::method::peeling::STAGES;
        }
    }
    let bins = single_pass::BinCount::Count(40);
    let depth = single_pass::DepthTest::Voronoi(bins);
    methods.push(single_pass::Settings { depth, ..Default::default() }.into());
    let holes = transparent::Holes::Background;
    methods.push(transparent::Settings { holes, ..Default::default() }.into());
    let refraction = Refraction { ratio: [0.75, 0.7, 0.65], layers: BendingLayers::Multiple };
    let refraction = Some(refraction);
    methods.push(transparent_hq::Settings { refraction, ..Default::default() }.into());
    methods.into_iter().filter(|method| !method.stages().is_empty()).collect()
}

/// Tori: lit and coloured, lit, coloured, neither; transparent, before the sky and not.
fn scenes() -> Vec<Scene> {
    let surfels = Shape::Torus.surfels(400, 1).unwrap();
    let scene = |i: u32| {
        let (colored, lit, clear) =
            (i.is_multiple_of(2), (i / 2).is_multiple_of(2), i == 0 || i == 3);
        let opacity = |i: u64| if i.is_multiple_of(4) { 1.0 } else { unit(7, i) };
        let cloud = Cloud {
            color: surfels.color().filter(|_| colored).map(<[_]>::to_vec),
            opacity: clear.then(|| (0..400).map(opacity).collect()),
            ..surfels.clone().into_cloud()
        };
        let mut scene = Scene::unlit("torus", Surfels::new(cloud).unwrap().0);
        scene.lights.extend(lit.then_some(Light::DEFAULT));
        scene.environment = (i < 2).then_some(Environment::Sky);
        scene
    };
    (0..4).map(scene).collect()
}

fn camera() -> Camera {
    Camera::new(43, 35, Shape::Torus.default_pose(), Shape::Torus.default_lens()).unwrap()
}

/// Runs `test` with a session of every scene and every method that can draw it, and with the
/// method's stages.
fn each_session(mut test: impl FnMut(&mut Session<'_>, &Camera, &'static [Stage])) {
    let exec = Exec::new(2, 16).unwrap();
    for scene in scenes() {
        for method in methods() {
            let refracts =
                matches!(&method, Method::TransparentHq(settings) if settings.refraction.is_some());
            if !(refracts && scene.environment.is_none()) {
                let mut session = Session::new(&scene, method, &exec).unwrap();
                test(&mut session, &camera(), method.stages());
            }
        }
    }
}

/// Whether a picture of a scene must have a plane; none if the settings decide.
fn is_there(when: When, scene: &Scene, stages: bool) -> Option<bool> {
    let tubes = !scene.primitives.is_empty();
    match when {
        When::Always => Some(true),
        When::Lit => Some(stages || !scene.lights.is_empty()),
        When::Tubes => Some(tubes),
        When::Stages | When::Whole => Some(stages),
        When::Colored => Some(stages && scene.surfels.color().is_some()),
        When::StagesOfTubes => Some(stages && tubes),
        When::Settings => (!stages).then_some(false),
        // Ids of scenes without objects have 32 bits.
        When::Wide | When::Alone => Some(false),
    }
}

/// A picture has the planes of the rows, exactly one row matches each plane, and every stage was
/// timed.
fn agrees<R: Exact>(session: &Session<'_>, frame: &Frame<R>, laps: &[&str], keeps: bool) {
    let (method, scene) = (session.method(), session.scene());
    let rows: Vec<_> = method.stages().iter().flat_map(|stage| stage.leaves).collect();
    for plane in &frame.planes {
        let of = |row: &&&PlaneRow| row.is_called(&plane.name) && row.holds(&plane.samples);
        assert_eq!(rows.iter().filter(of).count(), 1, "{method:?}: plane `{}`", plane.name);
    }
    for row in rows {
        let found = frame.planes.iter().any(|plane| row.is_called(&plane.name));
        if let Some(expected) = is_there(row.when, scene, keeps) {
            assert_eq!(found, expected, "{method:?}: row `{}`, {:?}", row.name, row.when);
        }
    }
    let stages = method.stages().iter().map(|stage| stage.name);
    let timed = laps.iter().flat_map(|lap| lap.split(" and "));
    assert!(timed.eq(stages), "{method:?}: {laps:?}");
}

#[test]
fn every_plane_has_one_row_and_every_row_its_planes() {
    each_session(|session, camera, _| {
        for keeps in [false, true] {
            let picture = session.define::<f64>(camera, keeps).unwrap();
            let laps: Vec<_> = picture.timings.iter().map(|(name, _)| *name).collect();
            agrees(session, &picture.frame, &laps, keeps);
        }
        let picture = session.render(camera).unwrap().clone();
        let laps: Vec<_> = picture.timings.iter().map(|(name, _)| *name).collect();
        agrees(session, &picture.frame, &laps, false);
    });
}

/// The planes of the stages that a stage reads, from a pool of planes.
fn read<R: Exact>(pool: &Frame<R>, stages: &'static [Stage], stage: &Stage) -> Frame<R> {
    let read = stages.iter().filter(|before| stage.reads.contains(&before.name));
    let planes = read.flat_map(|before| before.planes_of(pool).planes).collect();
    Frame { width: pool.width, height: pool.height, planes }
}

/// Each stage, run on the planes of the definition, leaves the planes of the definition.
fn comes_in_as_it_went_out<R: Exact>(
    session: &Session<'_>,
    camera: &Camera,
    stages: &'static [Stage],
) {
    let method = session.method();
    let mut pool = session.define::<R>(camera, true).unwrap().frame;
    for stage in stages.iter().filter(|stage| !stage.leaves.is_empty()) {
        let given = read(&pool, stages, stage);
        let left = session.stage(camera, stage.name, &given).unwrap();
        for plane in left.planes {
            let row = stage.row(&plane.name).expect("a row of the stage");
            match pool.plane(&plane.name) {
                // Bit for bit, because -0 is not 0.
                Some(of) => {
                    let same = format!("{of:?}") == format!("{:?}", plane.samples);
                    assert!(same, "{method:?}, {}: plane `{}`", stage.name, plane.name);
                }
                None => {
                    assert_eq!(row.when, When::Alone, "{method:?}: plane `{}`", plane.name);
                    pool.planes.push(plane);
                }
            }
        }
        let again = session.stage(camera, stage.name, &given).unwrap();
        for plane in stage.planes_of(&pool).planes {
            let row = stage.row(&plane.name).expect("a row of the stage");
            let expected = row.when != When::Whole;
            let found = again.plane(&plane.name).is_some();
            assert_eq!(found, expected, "{method:?}, {}: plane `{}`", stage.name, plane.name);
        }
    }
}

#[test]
fn every_stage_reads_its_planes_as_they_were_left() {
    each_session(|session, camera, stages| {
        comes_in_as_it_went_out::<f32>(session, camera, stages);
        comes_in_as_it_went_out::<f64>(session, camera, stages);
    });
}

#[test]
fn planes_that_a_stage_cannot_read_are_refused_in_one_line() {
    each_session(|session, camera, stages| {
        let pool = session.define::<f32>(camera, true).unwrap().frame;
        let reads = |stage: &&Stage| !read(&pool, stages, stage).planes.is_empty();
        for stage in stages.iter().filter(reads) {
            let empty = Frame { planes: Vec::new(), ..pool.clone() };
            let line = session.stage(camera, stage.name, &empty).unwrap_err().to_string();
            assert!(line.contains('`') && !line.contains('\n'), "{}: {line}", stage.name);
            let other = Camera::new(7, 5, Shape::Torus.default_pose(), Shape::Torus.default_lens())
                .unwrap();
            let small = session.define::<f32>(&other, true).unwrap().frame;
            let line = session.stage(camera, stage.name, &small).unwrap_err().to_string();
            assert!(line.contains("7 x 5") && line.contains("43 x 35"), "{line}");
        }
        let line = session.stage(camera, "no stage", &pool).unwrap_err().to_string();
        assert!(line.contains("no stage"), "{line}");
    });
}
