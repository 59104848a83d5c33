use super::tests::{camera, cloud};
use crate::frame::Exec;
use crate::method::Session;
use crate::method::gaussians::Settings;
use crate::method::gaussians::record::{GaussianRecord, RecordPart, project_records};
use crate::scene::Camera;
use crate::setting::Words;
use crate::verdict::client::{Client, Rounding};
use crate::verdict::{Fault, Outcome, Verdict};

/// The records of the crate, in ascending index.
fn recorded(session: &Session<'_>, camera: &Camera, settings: &Settings) -> Vec<GaussianRecord> {
    let (mut records, _) = session.with_job(camera, |job| project_records(job, settings));
    records.sort_by_key(|record| record.index);
    records
}

/// The mean of the relative radii of T in a row of pixels.
fn sharpness(session: &Session<'_>, camera: &Camera, client: &Client) -> f64 {
    let radii = (0..camera.width).flat_map(|x| {
        let checks = session.checks(camera, client, (x, camera.height / 2)).unwrap();
        checks.into_iter().filter_map(|check| match check.fault {
            Fault::Value { channel, truth, radius, .. } if channel == "T" && truth < 1.0 => {
                Some(radius / truth)
            }
            _ => None,
        })
    });
    let radii: Vec<f64> = radii.collect();
    assert!(radii.len() > 20);
    radii.iter().sum::<f64>() / radii.len() as f64
}

#[test]
fn records_are_judged_and_what_follows_is_judged_from_them() {
    let (camera, exec) = (camera(48, 32), Exec::sequential());
    let scene = cloud(60, 0.1, 0.5);
    for (name, settings) in Settings::WORDS {
        let session = Session::new(&scene, (*settings).into(), &exec).unwrap();
        let records = recorded(&session, &camera, settings);
        let frame = session.define::<f32>(&camera, true).unwrap().frame;
        let with = |records: Option<Vec<GaussianRecord>>, rounding| {
            let client = Client::from(&frame);
            Client { rounding, gaussian_records: records, ..client }
        };
        for (_, rounding) in Rounding::WORDS {
            let clients = [None, Some(records.clone())].map(|own| with(own, *rounding));
            for client in &clients {
                let verdict = session.verify(&camera, client, Verdict::BUDGET).unwrap();
                let worst = verdict.first_wrong().map(|stage| &stage.worst);
                assert_eq!(verdict.outcome(), Outcome::Right, "{name}: {worst:?}");
            }
            // Discs need more than a record has.
            if !settings.meets_rays() {
                let [wide, sharp] = clients.map(|own| sharpness(&session, &camera, &own));
                assert!(sharp < 0.5 * wide, "{name}, {rounding:?}: {sharp} of {wide}");
            }
        }
        for (field, bug) in broken(&records) {
            let client = with(Some(bug), Rounding::Gpu);
            let verdict = session.verify(&camera, &client, 1.0).unwrap();
            let first = verdict.first_wrong().unwrap();
            let found = first.worst.as_ref().unwrap().fault.to_string();
            assert_eq!(first.stage, "projection", "{name}: {found}");
            assert!(found.starts_with(field), "{name}, {field}: {found}");
        }
    }
}

/// Records with one mistake each that discs have too, and the field that is wrong.
fn broken(records: &[GaussianRecord]) -> Vec<(&'static str, Vec<GaussianRecord>)> {
    let middle = records.len() / 2;
    let with = |field, change: &dyn Fn(&mut GaussianRecord)| {
        let mut records = records.to_vec();
        change(&mut records[middle]);
        (field, records)
    };
    let mut all = vec![
        with("place.y", &|record| record.place[1] += 0.01),
        with("distance", &|record| record.distance *= 1.001),
        with("key", &|record| record.key = f32::NAN),
        with("center.x", &|record| record.center[0] += 0.01),
        with("alpha", &|record| record.alpha *= 1.01),
        with("color.g", &|record| record.color[1] += 0.01),
        with("surfel", &|record| record.index = 1 << 30),
    ];
    all[6].1.sort_by_key(|record| record.index);
    all
}

/// A number of an ellipse that is wrong is named before those that follow from it.
#[test]
fn the_first_wrong_field_is_named() {
    let (camera, exec) = (camera(48, 32), Exec::sequential());
    let scene = cloud(60, 0.1, 0.5);
    let session = Session::new(&scene, Settings::MIP.into(), &exec).unwrap();
    let records = recorded(&session, &camera, &Settings::MIP);
    let frame = session.define::<f32>(&camera, true).unwrap().frame;
    let tables = &GaussianRecord::<f32>::TABLE;
    let mut steps: Vec<_> = tables.iter().filter(|field| field.step.is_some()).collect();
    steps.sort_by_key(|field| field.step);
    for (i, first) in steps.iter().enumerate() {
        let mut own = records.clone();
        for field in &steps[i..] {
            let RecordPart::Numbers(_, of) = field.part else { panic!("no numbers") };
            own.iter_mut().flat_map(of).for_each(|number| *number = *number * 1.5 + 0.25);
        }
        let client = Client { gaussian_records: Some(own), ..Client::from(&frame) };
        let verdict = session.verify(&camera, &client, 1.0).unwrap();
        let stage = verdict.first_wrong().unwrap();
        let found = stage.worst.as_ref().unwrap().fault.to_string();
        let name = first.component(0);
        let name = name.split('.').next().unwrap();
        assert!(stage.stage == "projection" && found.starts_with(name), "{name}: {found}");
    }
}
