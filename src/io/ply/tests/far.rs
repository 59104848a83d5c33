//! Check positions far from 0: the offset, and the places that are merged.

use super::*;
use glam::DVec3;

/// Points of this type.
fn points(kind: &str, rows: &[[f64; 3]]) -> Vec<u8> {
    let element = format!("element vertex {}", rows.len());
    let properties = ["x", "y", "z"].map(|name| format!("property {kind} {name}"));
    let header: Vec<&str> = [&element].into_iter().chain(&properties).map(String::as_str).collect();
    let rows = rows.iter().map(|[x, y, z]| format!("{x} {y} {z}\n"));
    ascii(&header, &rows.collect::<String>())
}

/// A grid of 16 places, a quarter of a metre apart, from this corner on.
fn grid([x, y, z]: [f64; 3]) -> Vec<[f64; 3]> {
    let place = |i: u32| {
        let (column, row) = (f64::from(i % 4) / 4.0, f64::from(i / 4) / 4.0);
        [x + column, y + row, z + column / 8.0]
    };
    (0..16).map(place).collect()
}

const UTM: [f64; 3] = [635_000.25, 4_853_000.0, 410.0];

#[test]
fn map_coordinates_are_shifted_exactly() {
    let rows = grid(UTM);
    let cloud = parse(&points("double", &rows)).unwrap();
    // Middle (635000.625, 4853000.375, 410.047), reach 0.375, unit 0.25.
    assert_eq!(cloud.offset, DVec3::new(635_000.5, 4_853_000.25, 410.0));
    for (position, row) in cloud.position.iter().zip(&rows) {
        assert_eq!(position.as_dvec3() + cloud.offset, DVec3::from_array(*row));
    }
    assert!(cloud.warnings.is_empty(), "{:?}", cloud.warnings);

    // The binary formats too, and a cloud that was written with its offset.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("far.ply");
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 16\nproperty double x\n\
                  property double y\nproperty double z\nend_header\n";
    let body = rows.iter().flatten().flat_map(|value| value.to_le_bytes());
    std::fs::write(&path, header.bytes().chain(body).collect::<Vec<_>>()).unwrap();
    assert_eq!(read(&path).unwrap(), cloud);
    write(&path, &cloud).unwrap();
    assert_eq!(read(&path).unwrap(), cloud);
    // Only the axes that are far, and integers as well as doubles.
    let cloud = parse(&points("int", &[[20_000_001.0, 0.0, 1.0], [20_000_003.0, 1.0, 0.0]]));
    assert_eq!(cloud.unwrap().offset, DVec3::new(20_000_002.0, 0.0, 0.0));
}

#[test]
fn everyday_files_keep_their_bits() {
    let near: Vec<_> = (0..9).map(|i| [3.0 + f64::from(i) / 10.0, 0.1, 0.7]).collect();
    let exact = grid([635_000.25, 4096.5, 410.0]);
    for (kind, rows) in [("double", &near), ("float", &grid(UTM)), ("double", &exact)] {
        let cloud = parse(&points(kind, rows)).unwrap();
        assert_eq!(cloud.offset, DVec3::ZERO, "{kind}");
        let stored = rows.iter().map(|row| DVec3::from_array(*row).as_vec3());
        assert!(cloud.position.iter().copied().eq(stored));
        assert!(cloud.warnings.is_empty(), "{:?}", cloud.warnings);
    }
    // One place, or no place at all, has no reach.
    for row in [UTM, [f64::NAN; 3]] {
        assert_eq!(parse(&points("double", &[row])).unwrap().offset, DVec3::ZERO);
    }
}

#[test]
fn places_that_are_still_merged_are_counted() {
    // A point at 0, as scanners write for a ray that met nothing.
    let mut rows = grid(UTM);
    rows.push([0.0; 3]);
    let cloud = parse(&points("double", &rows)).unwrap();
    let warning = cloud.warnings.join("\n");
    assert_eq!(cloud.offset, DVec3::ZERO);
    assert!(warning.starts_with("of 17 places, only 13 are left in f32"), "{warning}");
    assert!(warning.contains("steps of 0.5 there; remove points"), "{warning}");
    let options = ReadOptions { keep_place: true, ..ReadOptions::default() };
    let kept = parse_with(&points("double", &grid(UTM)), &options, &Exec::sequential()).unwrap();
    assert_eq!((kept.offset, kept.warnings.len()), (DVec3::ZERO, 1));
}
