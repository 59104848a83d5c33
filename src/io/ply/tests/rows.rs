//! Check that slabs and threads give the same vertices as the walk from number to number.

use super::super::*;

/// A file of vertices of every type and of faces, of one byte order or the other.
fn file(count: u32, big: bool) -> Vec<u8> {
    let order = if big { "big" } else { "little" };
    let mut bytes = format!("ply\nformat binary_{order}_endian 1.0\nelement vertex {count}\n");
    let properties = [
        ("double", "x"),
        ("int", "y"),
        ("float", "z"),
        ("char", "skipped"),
        ("float", "nx"),
        ("float", "ny"),
        ("float", "nz"),
        ("uint", "radius"),
        ("uchar", "red"),
        ("uchar", "green"),
        ("uchar", "blue"),
        ("ushort", "alpha"),
        ("float", "tux"),
        ("float", "tuy"),
        ("float", "tuz"),
        ("float", "tvx"),
        ("float", "tvy"),
        ("short", "tvz"),
        ("float", "tx"),
        ("float", "ty"),
        ("char", "tz"),
        ("float", "mip2_blue"),
        ("uchar", "mip1_red"),
        ("ushort", "mip1_green"),
        ("float", "mip1_blue"),
        ("float", "mip2_red"),
        ("uchar", "mip2_green"),
    ];
    for (kind, name) in properties {
        bytes += &format!("property {kind} {name}\n");
    }
    bytes += "element face 2\nproperty list uchar uint vertex_indices\nend_header\n";
    let mut bytes = bytes.into_bytes();
    let mut put = |little: &[u8]| match big {
        true => bytes.extend(little.iter().rev()),
        false => bytes.extend(little),
    };
    for i in 0..count {
        // The bits of any number, except that not all exponent bits are set, because a NaN equals
        // nothing.
        let mut state = i.wrapping_mul(0x9E37_79B9);
        for (kind, _) in properties {
            state = state.wrapping_mul(0x85EB_CA6B) ^ (state >> 13);
            match kind {
                "double" => put(&(f64::from(state) / 7.0).to_le_bytes()),
                "float" => put(&f32::from_bits(state & 0xBFFF_FFFF).to_le_bytes()),
                "int" | "uint" => put(&state.to_le_bytes()),
                "short" | "ushort" => put(&(state as u16).to_le_bytes()),
                _ => put(&[state as u8]),
            }
        }
    }
    for corners in [[0, 1, 2], [count - 1, 1, 0_u32]] {
        put(&[3]);
        corners.iter().for_each(|corner| put(&corner.to_le_bytes()));
    }
    bytes
}

/// Reads a file of these bytes; an error without the file's name.
fn read_back(bytes: &[u8], threads: usize) -> std::result::Result<Cloud, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ply");
    std::fs::write(&path, bytes).unwrap();
    read_with(&path, &ReadOptions::default(), &Exec::new(threads, 32).unwrap())
        .map_err(|error| error.to_string().split_once(".ply: ").unwrap().1.to_owned())
}

#[test]
fn slabs_and_threads_change_nothing() {
    // Less than a slab, a slab, and some more.
    for count in [3, 1 << 16, 150_001] {
        let little = file(count, false);
        // Big-endian files are read by the walk.
        let expected = parse(&file(count, true)).unwrap();
        assert_eq!(expected.position.len(), count as usize);
        assert!(parse(&little).unwrap() == expected, "{count} in memory");
        for threads in [1, 3] {
            assert!(read_back(&little, threads).unwrap() == expected, "{count}, {threads}");
        }
    }
}

#[test]
fn refusals_are_those_of_files_in_memory() {
    let good = file(70_000, false);
    let end = good.len();
    let mut no_vertex = good.clone();
    no_vertex[end - 4..].copy_from_slice(&70_000_u32.to_le_bytes());
    let cases = [
        (no_vertex, "vertex 70000 does not exist"),
        (good[..end - 1].to_vec(), "only 11 bytes are left"),
        (good[..end / 2].to_vec(), "element `vertex`: the header declares 70000"),
        ([&good[..], b"more"].concat(), "4 bytes are left over"),
    ];
    for (bytes, expected) in cases {
        let refused = parse(&bytes).unwrap_err();
        assert!(refused.contains(expected), "{refused}");
        assert_eq!(read_back(&bytes, 2), Err(refused));
    }
}
