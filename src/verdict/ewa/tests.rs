use crate::frame::{Exec, Frame};
use crate::method::ewa::possible;
use crate::method::{Method, Session};
use crate::number::ball::{Gpu, Ieee, Profile};
use crate::number::{Ball, Truth};
use crate::scene::{Camera, Lens, Scene};
use crate::source::Shape;
use crate::splat::project::project_as;
use crate::splat::record::{SplatRecord, project_records};
use crate::splat::tests::ellipses;
use crate::splat::{Disc, Epsilon, Kernel, Outline, Projector, SplatSettings, View, batch};
use crate::verdict::client::{Client, Rounding, Storage};
use crate::verdict::{Fault, Outcome, Verdict};

const SHEETS: Shape = Shape::Sheets { gap: 0.02 };

/// Runs a test on several scenes, each with a camera and settings.
pub(super) fn each_scene(mut test: impl FnMut(&Session<'_>, &Camera)) {
    let exec = Exec::new(1, 16).unwrap();
    let of = |outline| Kernel { outline, ..Kernel::DEFAULT };
    for (shape, elliptic, kernel, lens, epsilon) in [
        (Shape::Sphere, false, Kernel::DEFAULT, None, None),
        (Shape::Torus, true, Kernel::DEFAULT, None, None),
        (Shape::Cluster, false, Kernel::ZPVBG01, None, None),
        (Shape::Torus, false, Kernel::ZP06, None, None),
        (Shape::Sphere, false, of(Outline::Perspective), None, None),
        (Shape::Torus, false, of(Outline::RayCast), None, None),
        (SHEETS, false, Kernel::DEFAULT, Some(Lens::Orthographic(3.0)), Some(0.0)),
    ] {
        let discs = shape.surfels(900, 5).unwrap();
        let scene = Scene::lit("shape", if elliptic { ellipses(discs) } else { discs });
        let lens = lens.unwrap_or(shape.default_lens());
        let camera = Camera::new(57, 43, shape.default_pose(), lens).unwrap();
        let mut settings = SplatSettings { kernel, ..SplatSettings::default() };
        if let Some(epsilon) = epsilon {
            settings.epsilon = Epsilon::World(epsilon);
        }
        let session = Session::new(&scene, Method::Ewa(settings), &exec).unwrap();
        test(&session, &camera);
    }
}

/// The result of [`possible::each_possible`], without its shortcut.
fn plain<P: Profile>(
    projector: &Projector<Ball<P>>,
    disc: &Disc<Ball<P>>,
    surfel: u32,
) -> Vec<String> {
    let crosses = projector.crosses(disc);
    let ways = [!crosses.certainly(), crosses.possibly()];
    let ways = [false, true].into_iter().zip(ways).filter(|(_, possible)| *possible);
    ways.map(|(way, _)| project_as(projector, disc, surfel, way))
        .filter(|(_, reasons)| !reasons.any().certainly())
        .map(|(splat, reasons)| {
            let certain = !reasons.any().possibly() && crosses.decided().is_some();
            format!("{splat:?} {certain}")
        })
        .collect()
}

/// Counts the surfels that may be drawn, and the others.
fn compare_projections<P: Profile>(session: &Session<'_>, camera: &Camera, all: &mut [usize; 2]) {
    let Method::Ewa(settings) = *session.method() else { return };
    let surfels = &session.scene().surfels;
    for cull in [false, true] {
        let projector = Projector::<Ball<P>>::new(View::new(camera), &settings.kernel, cull);
        let common = Projector::new(View::new(camera), &settings.kernel, cull);
        let mut in_lanes = Vec::new();
        possible::each_of_range(
            &projector,
            &common,
            surfels,
            0..surfels.len(),
            None,
            &mut |splat, certain| {
                in_lanes.push((splat.surfel, format!("{splat:?} {certain}")));
            },
        );
        let mut in_lanes = in_lanes.into_iter().peekable();
        let mut counts = [0; 2];
        for i in 0..surfels.len() {
            let (disc, mut found, mut lanes) = (batch::disc(surfels, i), Vec::new(), Vec::new());
            possible::each_possible(&projector, &disc, i as u32, &mut |splat, certain| {
                found.push(format!("{splat:?} {certain}"));
            });
            assert_eq!(found, plain(&projector, &disc, i as u32));
            while let Some((_, lane)) = in_lanes.next_if(|(surfel, _)| *surfel == i as u32) {
                lanes.push(lane);
            }
            assert_eq!(lanes, found);
            counts[usize::from(found.is_empty())] += 1;
        }
        for (all, some) in all.iter_mut().zip(counts) {
            *all += some;
        }
    }
}

#[test]
fn a_surfel_that_is_turned_away_before_its_shape_would_be_after() {
    let mut all = [0; 2];
    each_scene(|session, camera| {
        // A near camera, with surfels behind it, beside it and at the near plane.
        let near = Camera { near: 2.0, fx: 4.0 * camera.fx, ..*camera };
        for camera in [camera, &near] {
            compare_projections::<Ieee>(session, camera, &mut all);
            compare_projections::<Gpu>(session, camera, &mut all);
        }
    });
    assert!(all.iter().all(|count| *count > 5000), "{all:?}");
}

fn verdict(
    session: &Session<'_>,
    camera: &Camera,
    frame: &Frame<f32>,
    rounding: Rounding,
) -> Verdict {
    let mut client = Client::from(frame);
    client.rounding = rounding;
    session.verify(camera, &client, 1.0).unwrap()
}

#[test]
fn what_the_crate_renders_is_right() {
    each_scene(|session, camera| {
        let whole = session.define::<f32>(camera, true).unwrap().frame;
        let plain = session.define::<f32>(camera, false).unwrap().frame;
        for rounding in [Rounding::Ieee, Rounding::Gpu] {
            for frame in [&whole, &plain] {
                let verdict = verdict(session, camera, frame, rounding);
                let wrong = verdict.stages.iter().find_map(|stage| stage.worst.clone());
                assert_eq!(wrong, None);
                assert_eq!(verdict.outcome(), Outcome::Right);
            }
        }
    });
}

#[test]
fn what_has_no_bounds_is_not_right() {
    each_scene(|session, camera| {
        let frame = session.define::<f32>(camera, false).unwrap().frame;
        // Averages with a weight that may be 0.
        let client = Client::from(&frame).stored("weight", Storage::Steps(16.0));
        let verdict = session.verify(camera, &client, 0.5).unwrap();
        assert_eq!(verdict.first_wrong().map(|stage| stage.stage), None);
        assert!(verdict.unbounded > verdict.covered / 2);
        assert_eq!(verdict.outcome(), Outcome::Undecidable);
    });
}

#[test]
fn of_each_plane_alone_what_the_crate_renders_is_right() {
    each_scene(|session, camera| {
        let whole = session.define::<f32>(camera, true).unwrap().frame;
        for plane in &whole.planes {
            if plane.name == "margin" {
                continue;
            }
            let Frame { width, height, .. } = whole;
            let frame = Frame { width, height, planes: vec![plane.clone()] };
            let verdict = verdict(session, camera, &frame, Rounding::Ieee);
            let wrong = verdict.stages.iter().find_map(|stage| stage.worst.clone());
            assert_eq!(wrong, None, "{}", plane.name);
        }
    });
}

#[test]
fn records_are_judged_and_what_follows_is_judged_from_them() {
    each_scene(|session, camera| {
        let Method::Ewa(settings) = *session.method() else { return };
        let surfels = &session.scene().surfels;
        let (records, _) = project_records(surfels, camera, &settings.kernel, settings.cull);
        let frame = session.define::<f32>(camera, true).unwrap().frame;
        let mut widths = [0.0; 2];
        for rounding in [Rounding::Ieee, Rounding::Gpu] {
            for (records, width) in [None, Some(&records)].into_iter().zip(&mut widths) {
                let mut client = Client::from(&frame);
                (client.rounding, client.records) = (rounding, records.cloned());
                let verdict = session.verify(camera, &client, 1.0).unwrap();
                assert_eq!(verdict.first_wrong().map(|stage| &stage.worst), None);
                *width = sharpness(session, camera, &client);
            }
            assert!(widths[1] < 0.2 * widths[0], "{widths:?}: records make weights sharper");
        }
        for (bug, stage) in broken(&records) {
            let mut client = Client::from(&frame);
            (client.rounding, client.records) = (Rounding::Gpu, Some(bug));
            let verdict = session.verify(camera, &client, 1.0).unwrap();
            assert_eq!(verdict.first_wrong().map(|stage| stage.stage), Some(stage));
        }
    });
}

/// The mean of the relative radii of the weights in a row of pixels.
fn sharpness(session: &Session<'_>, camera: &Camera, client: &Client) -> f64 {
    let mut all = Vec::new();
    for x in 0..camera.width {
        for check in session.checks(camera, client, (x, camera.height / 2)).unwrap() {
            if let Fault::Value { channel, truth, radius, .. } = check.fault
                && channel == "attributes.weight"
                && truth > 0.0
            {
                all.push(radius / truth);
            }
        }
    }
    assert!(all.len() > 5);
    all.iter().sum::<f64>() / all.len() as f64
}

/// Records with one mistake each.
fn broken(records: &[SplatRecord]) -> Vec<(Vec<SplatRecord>, &'static str)> {
    let middle = records.len() / 2;
    let with = |change: &dyn Fn(&mut Vec<SplatRecord>)| {
        let mut records = records.to_vec();
        change(&mut records);
        (records, "projection")
    };
    vec![
        with(&|records| records.truncate(middle)),
        with(&|records| records[middle].center[0] += 0.01),
        with(&|records| records[middle].amplitude = f32::NAN),
        with(&|records| records[middle].normal[1] += 0.25),
        with(&|records| records[middle].plane[2] *= 1.01 + 0.5),
        with(&|records| records.push(SplatRecord { surfel: 1 << 30, ..records[middle] })),
    ]
}
