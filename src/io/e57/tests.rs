//! Check scans that the crate e57 writes, and damaged ones.

use super::*;
use crate::number::srgb;
use crate::scene::light::Phong;
use ::e57::{E57Writer, Quaternion, Record, RecordDataType, RecordName, RecordValue};
use ::e57::{Transform, Translation};
use glam::{DVec3, Vec3};
use std::io::Cursor;

type Writer<'a> = E57Writer<&'a mut Cursor<Vec<u8>>>;

fn integer(name: RecordName, max: i64) -> Record {
    Record { name, data_type: RecordDataType::Integer { min: 0, max } }
}

/// A scan of points with colours and intensities, in this place.
fn scan(file: &mut Writer<'_>, pose: Option<Transform>, points: &[[f64; 3]]) {
    let prototype = vec![
        Record::CARTESIAN_X_F64,
        Record::CARTESIAN_Y_F64,
        Record::CARTESIAN_Z_F64,
        Record::CARTESIAN_INVALID_STATE,
        Record::COLOR_RED_U8,
        Record::COLOR_GREEN_U8,
        Record::COLOR_BLUE_U8,
        integer(RecordName::IsColorInvalid, 1),
        Record::INTENSITY_U16,
    ];
    let mut writer = file.add_pointcloud("scan", prototype).unwrap();
    writer.set_transform(pose);
    for (i, point) in points.iter().enumerate() {
        let mut values: Vec<RecordValue> = point.map(RecordValue::Double).to_vec();
        let state = if point[0].is_nan() { 2 } else { 0 };
        let without_color = i64::from(i % 2 == 1);
        let numbers = [state, 255, 128, 0, without_color, 1000 + i as i64];
        values.extend(numbers.map(RecordValue::Integer));
        if state == 2 {
            values[0] = RecordValue::Double(0.0);
        }
        writer.add_point(values).unwrap();
    }
    writer.finalize().unwrap();
}

fn file(scans: impl FnOnce(&mut Writer<'_>)) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let mut file = E57Writer::new(&mut bytes, "file").unwrap();
    scans(&mut file);
    file.finalize().unwrap();
    drop(file);
    bytes.into_inner()
}

const POINTS: [[f64; 3]; 3] = [[0.5, 1.0, 2.0], [0.1, 0.2, 0.3], [-4.0, 0.0, 0.25]];

#[test]
fn scans_are_joined_in_their_places() {
    // A quarter turn around z, then a step.
    let half = 0.5_f64.sqrt();
    let pose = Transform {
        rotation: Quaternion { w: half, x: 0.0, y: 0.0, z: half },
        translation: Translation { x: 10.0, y: 0.0, z: 0.0 },
    };
    let bytes = file(|file| {
        scan(file, None, &POINTS);
        scan(file, Some(pose), &[[1.0, 2.0, 3.0], [f64::NAN, 0.0, 0.0]]);
    });
    let cloud = parse(&bytes, &ReadOptions::default()).unwrap();
    assert_eq!(cloud.position.len(), 4);
    for (found, expected) in cloud.position.iter().zip(POINTS) {
        assert_eq!(*found, DVec3::from_array(expected).as_vec3());
    }
    assert!(cloud.position[3].distance(Vec3::new(8.0, 1.0, 3.0)) < 1e-6, "{}", cloud.position[3]);
    let table = srgb::table(255);
    let color = cloud.color.unwrap();
    assert!(color[0].distance(Vec3::new(1.0, table[128], 0.0)) < 1e-6, "{}", color[0]);
    assert_eq!(color[1], Phong::default().color);
    assert_eq!(cloud.properties[0].name, "intensity");
    assert_eq!(cloud.properties[0].values, [1000.0, 1001.0, 1002.0, 1000.0]);
    assert_eq!(cloud.warnings, ["1 points have no valid coordinates, and are left out"]);
}

#[test]
fn spherical_and_map_coordinates_are_read() {
    let spherical = |name| Record { name, data_type: RecordDataType::F64 };
    let bytes = file(|file| {
        let names = [
            RecordName::SphericalRange,
            RecordName::SphericalAzimuth,
            RecordName::SphericalElevation,
        ];
        let mut writer = file.add_pointcloud("scan", names.map(spherical).to_vec()).unwrap();
        let right = std::f64::consts::FRAC_PI_2;
        writer.add_point([2.0, right, 0.0].map(RecordValue::Double).to_vec()).unwrap();
        writer.finalize().unwrap();
    });
    let cloud = parse(&bytes, &ReadOptions::default()).unwrap();
    assert!(cloud.position[0].distance(Vec3::new(0.0, 2.0, 0.0)) < 1e-6, "{}", cloud.position[0]);
    assert!(cloud.color.is_none() && cloud.properties.is_empty());

    let far = POINTS.map(|[x, y, z]| [x + 635_000.25, y, z]);
    let cloud = parse(&file(|file| scan(file, None, &far)), &ReadOptions::default()).unwrap();
    let found = cloud.position[0].as_dvec3() + cloud.offset;
    assert_eq!((found, cloud.offset.y), (DVec3::from_array(far[0]), 0.0));
}

#[test]
fn damage_is_an_error_of_one_line() {
    let good = file(|file| scan(file, None, &POINTS));
    let refused = |bytes: &[u8]| parse(bytes, &ReadOptions::default()).unwrap_err();
    // Every page has a checksum.
    for at in (0..good.len()).step_by(7) {
        let mut bytes = good.clone();
        bytes[at] ^= 0x10;
        if let Err(what) = parse(&bytes, &ReadOptions::default()) {
            assert!(!what.contains('\n'), "{what}");
        }
    }
    for length in [0, 3, 47, 48, 1024, good.len() - 1] {
        assert!(!refused(&good[..length]).contains('\n'));
    }
}

/// Counts that claim more than the file has, and points of no bits, of which there is no end.
#[test]
fn a_scan_that_claims_too_much_is_refused() {
    let claims = |change: fn(String) -> String| {
        let mut bytes = Cursor::new(Vec::new());
        let mut file = E57Writer::new(&mut bytes, "file").unwrap();
        scan(&mut file, None, &POINTS);
        file.finalize_customized_xml(|xml| Ok(change(xml))).unwrap();
        drop(file);
        parse(&bytes.into_inner(), &ReadOptions::default()).unwrap_err()
    };
    let count = |xml: String| xml.replace("recordCount=\"3\"", "recordCount=\"9000000000\"");
    let found = claims(count);
    assert!(found.contains("scan 0 claims 9000000000 points of at least"), "{found}");
    let nothing = |xml: String| {
        let start = xml.find("<cartesianX").unwrap();
        let end = xml.find("</prototype>").unwrap();
        let axis = |name| {
            format!("<{name} type=\"ScaledInteger\" minimum=\"0\" maximum=\"0\" scale=\"1\"/>")
        };
        let axes = ["cartesianX", "cartesianY", "cartesianZ"].map(axis).concat();
        format!("{}{axes}{}", &xml[..start], &xml[end..])
    };
    let found = claims(nothing);
    assert!(found.contains("of at least 0 bits"), "{found}");
}
