//! Texture coordinates and the names of textures.

use super::*;
use crate::scene::Coordinates;
use glam::Vec2;

const NAMES: [[&str; 2]; 3] = [["u", "v"], ["s", "t"], ["texture_u", "texture_v"]];

fn at(x: f32, y: f32) -> Vec2 {
    Vec2::new(x, y)
}

#[test]
fn vertices_have_coordinates_by_any_of_their_names() {
    for [u, v] in NAMES {
        let more = [format!("property float {v}"), format!("property double {u}")];
        let bytes =
            vertices("2", &more.each_ref().map(String::as_str), "0 0 0 0.5 2\n1 0 0 nan -1");
        let Some(Coordinates::Points(found)) = parse(&bytes).unwrap().coordinates else { panic!() };
        assert_eq!(found[0], at(2.0, 0.5));
        assert!(found[1].x == -1.0 && found[1].y.is_nan(), "not judged");
    }
}

#[test]
fn corners_have_coordinates_of_their_own() {
    // A quad, then a triangle; before the indices.
    let header = [
        "element vertex 4",
        XYZ[0],
        XYZ[1],
        XYZ[2],
        "property float u",
        "property float v",
        "element face 3",
        "property list uchar float texcoord",
        INDICES,
    ];
    let body = "0 0 0 9 9\n1 0 0 9 9\n1 1 0 9 9\n0 1 0 9 9\n\
        8 0 0 1 0 1 1 0 1 4 0 1 2 3\n4 0 0 1 1 2 0 1\n6 .5 .5 .25 .25 0 0 3 1 2 3\n";
    let cloud = parse(&ascii(&header, body)).unwrap();
    assert_eq!(cloud.triangles, [[0, 1, 2], [0, 2, 3], [1, 2, 3]]);
    let corners = vec![
        [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0)],
        [at(0.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)],
        [at(0.5, 0.5), at(0.25, 0.25), at(0.0, 0.0)],
    ];
    assert_eq!(
        cloud.coordinates,
        Some(Coordinates::Corners(corners)),
        "in the place of the vertices'"
    );
    cloud.check().unwrap();
    // Faces may come before vertices.
    let (vertex, face) = (&header[..6], &header[6..]);
    let lines: Vec<&str> = body.lines().collect();
    let turned = ascii(&[face, vertex].concat(), &[&lines[4..], &lines[..4]].concat().join("\n"));
    assert_eq!(parse(&turned).unwrap(), cloud);
}

/// Ears where the fan leaves the polygon; coordinates stay with their corners, and faces may come
/// before their vertices.
#[test]
fn concave_polygons_are_cut_into_ears() {
    let vertex = ["element vertex 6", "property float x", "property float y", "property float z"];
    let face = [
        "element face 3",
        "property list uchar int vertex_indices",
        "property list uchar float texcoord",
    ];
    let vertices = "2 0 0\n2 1 0\n1 1 0\n1 2 0\n0 2 0\n0 0 0\n";
    let faces =
        "3 0 1 2 6 0 0 1 0 2 0\n6 0 1 2 3 4 5 12 0 0 1 0 2 0 3 0 4 0 5 0\n3 3 4 5 6 3 0 4 0 5 0\n";
    let expected = [[0, 1, 2], [5, 0, 1], [2, 3, 4], [5, 1, 2], [2, 4, 5], [3, 4, 5]];
    for bytes in [
        ascii(&[vertex.as_slice(), &face].concat(), &format!("{vertices}{faces}")),
        ascii(&[face.as_slice(), &vertex].concat(), &format!("{faces}{vertices}")),
    ] {
        let found = parse(&bytes).unwrap();
        assert_eq!(found.triangles, expected);
        let Some(Coordinates::Corners(at)) = found.coordinates else { panic!() };
        let at: Vec<[u32; 3]> = at.iter().map(|one| one.map(|at| at.x as u32)).collect();
        assert_eq!(at, expected);
    }
}

#[test]
fn what_is_written_comes_back() {
    let points = Cloud {
        position: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        coordinates: Some(Coordinates::Points(vec![
            at(0.1, 0.2),
            at(-3.0, f32::INFINITY),
            at(0.0, 1e-40),
        ])),
        textures: vec!["my wood.png".into(), "b.exr".into()],
        color: Some(vec![Vec3::ONE; 3]),
        mipmap: Some(Mipmap::new(1, vec![Vec3::X; 3]).unwrap()),
        triangles: vec![[0, 1, 2], [2, 1, 0]],
        ..Cloud::default()
    };
    let corners = vec![[at(0.1, 0.2), at(0.3, 0.4), at(0.5, 0.6)], [at(1.0, 2.0); 3]];
    let cornered = Cloud { coordinates: Some(Coordinates::Corners(corners)), ..points.clone() };
    let file = tempfile::NamedTempFile::new().unwrap().into_temp_path();
    for cloud in [points, cornered] {
        let mut bytes = Vec::new();
        write::encode(&cloud, &mut bytes).unwrap();
        assert_eq!(parse(&bytes).unwrap(), cloud);
        std::fs::write(&file, &bytes).unwrap();
        assert_eq!(read(&file).unwrap(), cloud, "by slabs");
    }
    let odd = Cloud { textures: vec![String::new(), "a\nb".into()], ..Cloud::default() };
    let mut bytes = Vec::new();
    write::encode(&odd, &mut bytes).unwrap();
    assert!(!String::from_utf8(bytes).unwrap().contains("TextureFile"));
}

#[test]
fn comments_name_textures() {
    let named = [
        "comment TextureFile a b.png ",
        "comment TextureFile c.png",
        "comment TextureFile c.png",
        "comment TextureFile",
        "comment about TextureFile d.png",
        "element vertex 1",
        XYZ[0],
        XYZ[1],
        XYZ[2],
    ];
    assert_eq!(parse(&ascii(&named, "0 0 0")).unwrap().textures, ["a b.png", "c.png"]);
}

#[test]
fn incomplete_coordinates_are_refused() {
    let line = |bytes: Vec<u8>| parse(&bytes).unwrap_err();
    for name in ["u", "v", "texture_u", "texture_v"] {
        let bytes = vertices("1", &[&format!("property float {name}")], "0 0 0 1");
        let expected = "element vertex has one texture coordinate alone; declare u and v, or \
            texture_u and texture_v";
        assert_eq!(line(bytes), expected);
    }
    for name in ["s", "t"] {
        let time = vertices("1", &[&format!("property double {name}")], "0 0 0 1");
        assert_eq!(parse(&time).unwrap().coordinates, None, "a time");
    }
    let twice = ["property float u", "property float v", "property float texture_u"];
    assert!(
        line(vertices("1", &twice, "0 0 0 1 1 1")).contains("several texture coordinates; keep")
    );
    let list = ["property list uchar float u", "property float v"];
    assert!(line(vertices("1", &list, "0 0 0 1 1 1")).contains("`u` is a list"));
    let texcoord = "property list uchar float texcoord";
    for (face, found) in
        [("3 0 1 2 4 0 0 1 1", 4), ("3 0 1 2 0", 0), ("3 0 1 2 8 0 0 0 0 0 0 0 0", 8)]
    {
        let expected =
            format!("face 0 (line 14): texcoord has {found} numbers, but 3 corners need 6");
        assert_eq!(line(faces(&[INDICES, texcoord], face)), expected);
    }
    let one = line(faces(&[INDICES, "property float texcoord"], "3 0 1 2 4"));
    assert!(one.contains("element face: property `texcoord` must be a list"), "{one}");
}
