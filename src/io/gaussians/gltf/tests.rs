//! Check what is read from glTF, what comes back, and what is refused.

use super::super::{read, write as write_file};
use super::*;
use crate::number::elementary;
use crate::number::random::unit;
use crate::scene::Gaussians;
use crate::scene::gaussians::Encoding;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};
use std::fs;
use tempfile::TempDir;

/// Gaussians with numbers of all sizes.
fn gaussians(count: u64, degree: u32, encoding: Encoding) -> Gaussians {
    let mut next = 0..;
    let mut number = move || 2.0 * unit(7, next.next().unwrap()) - 1.0;
    let mut vector = |size: f32| Vec3::new(number(), number(), number()) * size;
    let mut arrays = GaussianArrays { degree, encoding, ..GaussianArrays::default() };
    for i in 0..count {
        arrays.position.push(vector(10.0));
        arrays.scale.push(vector(2.0).abs());
        let (axis, more) = (vector(1.0), vector(1.0));
        arrays.rotation.push([axis.x, axis.y, axis.z, more.x]);
        arrays.opacity.push([0.0, 1.0, more.y.abs()][i as usize % 3]);
        arrays.harmonics.extend((0..coefficients(degree)).map(|_| vector(1.0)));
    }
    Gaussians::new(arrays).unwrap().0
}

/// A document with a float array a base64 buffer, ready for changes. One Gaussian, degree 0.
fn simple() -> Value {
    // Position, scale, rotation, opacity, coefficient.
    let numbers = [1.0_f32, 2.0, 3.0, 0.5, 0.25, 0.125, 0.0, 0.0, 0.0, 1.0, 0.75, 0.5, -0.5, 1.0];
    let bytes: Vec<u8> = numbers.iter().flat_map(|value| value.to_le_bytes()).collect();
    let accessor = |kind: &str, offset: u64| json!({"bufferView": 0, "byteOffset": offset, "componentType": 5126, "count": 1, "type": kind});
    json!({
        "asset": {"version": "2.0"},
        "extensionsUsed": [EXTENSION],
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{
            "mode": 0,
            "attributes": {
                "POSITION": 0,
                "KHR_gaussian_splatting:SCALE": 1,
                "KHR_gaussian_splatting:ROTATION": 2,
                "KHR_gaussian_splatting:OPACITY": 3,
                "KHR_gaussian_splatting:SH_DEGREE_0_COEF_0": 4,
                "COLOR_0": 99
            },
            "extensions": {EXTENSION: {"kernel": "ellipse", "colorSpace": "lin_rec709_display"}}
        }]}],
        "accessors": [
            accessor("VEC3", 0), accessor("VEC3", 12), accessor("VEC4", 24), accessor("SCALAR", 40),
            accessor("VEC3", 44)
        ],
        "bufferViews": [{"buffer": 0, "byteLength": bytes.len()}],
        "buffers": [{"byteLength": bytes.len(), "uri": uri(&bytes)}]
    })
}

fn uri(bytes: &[u8]) -> String {
    format!("data:application/octet-stream;base64,{}", STANDARD.encode(bytes))
}

/// Adds a buffer with a view of it; the index of the view.
fn view(document: &mut Value, bytes: &[u8]) -> usize {
    let buffers = document["buffers"].as_array_mut().unwrap();
    buffers.push(json!({"byteLength": bytes.len(), "uri": uri(bytes)}));
    let buffer = buffers.len() - 1;
    let views = document["bufferViews"].as_array_mut().unwrap();
    views.push(json!({"buffer": buffer, "byteLength": bytes.len()}));
    views.len() - 1
}

fn parse(document: &Value) -> Result<GaussianFile> {
    let at = TempDir::new().unwrap();
    let path = at.path().join("a.gltf");
    fs::write(&path, document.to_string()).unwrap();
    read(&path)
}

fn refused(document: &Value) -> String {
    let error = parse(document).unwrap_err().to_string();
    assert!(!error.contains('\n') && error.contains("a.gltf: "), "{error}");
    error
}

#[test]
fn a_glb_gives_the_same_gaussians_back() {
    let at = TempDir::new().unwrap();
    for (degree, encoding) in
        [(0, Encoding::Srgb), (1, Encoding::Linear), (2, Encoding::Srgb), (3, Encoding::Srgb)]
    {
        let path = at.path().join("a.glb");
        let before = gaussians(20, degree, encoding);
        write_file(&path, &before, DVec3::ZERO).unwrap();
        let found = read(&path).unwrap();
        assert_eq!(found.warnings, [""; 0]);
        assert_eq!(
            found.convention,
            "glTF with KHR_gaussian_splatting: linear scales, opacities in [0, 1], quaternion x y z w"
        );
        let (after, dropped) = Gaussians::new(found.arrays).unwrap();
        assert_eq!(dropped, 0);
        assert!(after == before, "degree {degree}");
    }
}

#[test]
fn an_offset_comes_back_from_the_node_of_a_glb() {
    let at = TempDir::new().unwrap();
    let before = gaussians(20, 0, Encoding::Srgb);
    for name in ["a.glb", "a.ply"] {
        let path = at.path().join(name);
        let offset = DVec3::new(635_000.1, 0.0, -4_853_000.7);
        write_file(&path, &before, offset).unwrap();
        let found = read(&path).unwrap();
        for (a, b) in found.arrays.position.iter().zip(before.position()) {
            let off = a.as_dvec3() + found.offset - (b.as_dvec3() + offset);
            assert!(off.length() < 2e-6, "{name}: {off}");
        }
    }
}

/// Of a PLY only the logarithms and logits that `f32` lacks may change.
#[test]
fn a_ply_gives_everything_back_but_a_last_digit() {
    let at = TempDir::new().unwrap();
    let path = at.path().join("a.ply");
    let before = gaussians(300, 3, Encoding::Srgb);
    write_file(&path, &before, DVec3::ZERO).unwrap();
    let after = Gaussians::new(read(&path).unwrap().arrays).unwrap().0;
    assert_eq!(after.position(), before.position());
    assert_eq!(after.rotation(), before.rotation());
    assert_eq!(after.all_harmonics(), before.all_harmonics());
    let close = |a: f32, b: f32| (a - b).abs() <= 1e-6 * b.abs();
    assert!(after.opacity().iter().zip(before.opacity()).all(|(a, b)| close(*a, *b)));
    let scales = after.scale().iter().zip(before.scale());
    assert!(scales.clone().all(|(a, b)| (0..3).all(|i| close(a[i], b[i]))));
    // What was written once comes back bit for bit.
    write_file(&path, &after, DVec3::ZERO).unwrap();
    assert!(Gaussians::new(read(&path).unwrap().arrays).unwrap().0 == after);
    let linear = gaussians(2, 0, Encoding::Linear);
    let error = write_file(&path, &linear, DVec3::ZERO).unwrap_err().to_string();
    assert!(error.contains("the colours are linear"), "{error}");
}

#[test]
fn a_document_with_base64_is_read() {
    let found = parse(&simple()).unwrap();
    let arrays = found.arrays;
    assert_eq!(arrays.position, [Vec3::new(1.0, 2.0, 3.0)]);
    assert_eq!(arrays.scale, [Vec3::new(0.5, 0.25, 0.125)]);
    assert_eq!((arrays.rotation[0], arrays.opacity[0]), ([0.0, 0.0, 0.0, 1.0], 0.75));
    assert_eq!(arrays.harmonics, [Vec3::new(0.5, -0.5, 1.0)]);
    assert_eq!((arrays.degree, arrays.encoding), (0, Encoding::Linear));
    assert!(found.warnings.is_empty(), "COLOR_0 is not even looked at: {:?}", found.warnings);
}

#[test]
fn buffers_may_be_files_beside() {
    let at = TempDir::new().unwrap();
    let mut document = simple();
    let uri = document["buffers"][0]["uri"].take();
    let encoded = uri.as_str().unwrap().split_once(',').unwrap().1;
    fs::write(at.path().join("the data.bin"), STANDARD.decode(encoded).unwrap()).unwrap();
    document["buffers"][0]["uri"] = json!("the%20data.bin");
    let path = at.path().join("a.gltf");
    fs::write(&path, document.to_string()).unwrap();
    assert_eq!(read(&path).unwrap().arrays.position[0].z, 3.0);
    fs::remove_file(at.path().join("the data.bin")).unwrap();
    assert!(read(&path).unwrap_err().to_string().contains("the data.bin: "));
}

#[test]
fn integers_are_normalized_and_strides_kept() {
    let mut document = simple();
    // Two Gaussians; rotations with a stride of 6 shorts.
    let rotations = [0_i16, 0, 32767, -32768, 1, 1, 16384, 0, 0, 16384];
    let bytes: Vec<u8> = rotations.iter().flat_map(|value| value.to_le_bytes()).collect();
    let rotations = view(&mut document, &bytes);
    document["bufferViews"][rotations]["byteStride"] = json!(12);
    let scales = view(&mut document, &[255, 51, 0, 0, 255, 51]);
    let opacities = view(&mut document, &[0, 0, 0xff, 0xff]);
    let positions: Vec<u8> = [1_i16, 2, 3, -4, 5, 6].iter().flat_map(|v| v.to_le_bytes()).collect();
    let positions = view(&mut document, &positions);
    let colors = view(&mut document, &[0; 24]);
    let accessor = |view: usize, component: u32, normalized: bool, kind: &str| json!({"bufferView": view, "componentType": component, "normalized": normalized, "count": 2, "type": kind});
    document["accessors"] = json!([
        accessor(positions, 5122, false, "VEC3"),
        accessor(scales, 5121, true, "VEC3"),
        accessor(rotations, 5122, true, "VEC4"),
        accessor(opacities, 5123, true, "SCALAR"),
        accessor(colors, 5126, false, "VEC3")
    ]);
    let arrays = parse(&document).unwrap().arrays;
    assert_eq!(arrays.position[1], Vec3::new(-4.0, 5.0, 6.0));
    assert_eq!(arrays.scale, [Vec3::new(1.0, 0.2, 0.0), Vec3::new(0.0, 1.0, 0.2)]);
    assert_eq!(arrays.rotation[0], [0.0, 0.0, 1.0, -1.0], "the least code is -1");
    assert_eq!(arrays.rotation[1][0], (16384.0_f64 / 32767.0) as f32);
    assert_eq!(arrays.opacity, [0.0, 1.0]);
    document["accessors"][1]["normalized"] = json!(false);
    assert_eq!(parse(&document).unwrap().arrays.scale[0].x, 255.0, "integers as they are");
    document["accessors"][3]["normalized"] = json!(false);
    assert!(
        refused(&document).contains("OPACITY: accessor 3 has the component type unsigned short")
    );
}

#[test]
fn sparse_elements_replace_others() {
    let mut document = simple();
    let indices = view(&mut document, &[0, 0]);
    let bytes: Vec<u8> = [7.0_f32, 8.0, 9.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    let values = view(&mut document, &bytes);
    let sparse = json!({
        "count": 1,
        "indices": {"bufferView": indices, "componentType": 5123},
        "values": {"bufferView": values}
    });
    document["accessors"][0]["sparse"] = sparse;
    assert_eq!(parse(&document).unwrap().arrays.position, [Vec3::new(7.0, 8.0, 9.0)]);
    document["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    assert_eq!(parse(&document).unwrap().arrays.position, [Vec3::new(7.0, 8.0, 9.0)]);
    document["accessors"][0]["sparse"]["count"] = json!(2);
    assert!(refused(&document).contains("accessor 0, sparse: it reaches beyond its buffer view"));
}

#[test]
fn nodes_move_turn_and_scale() {
    let mut document = simple();
    // A parent that turns x to y and doubles, and a child that moves; then the mesh as it is.
    document["nodes"] = json!([
        {"children": [1], "rotation": [0, 0, 0.5_f64.sqrt(), 0.5_f64.sqrt()], "scale": [2, 2, 2]},
        {"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 10, 0, 0, 1]},
        {"mesh": 0}
    ]);
    document["scenes"] = json!([{"nodes": [0, 2]}]);
    let arrays = parse(&document).unwrap().arrays;
    assert!((arrays.position[0] - Vec3::new(-4.0, 22.0, 6.0)).length() < 1e-5);
    assert_eq!(arrays.position[1], Vec3::new(1.0, 2.0, 3.0));
    assert!((arrays.scale[0] - Vec3::new(1.0, 0.5, 0.25)).length() < 1e-6);
    let turned = arrays.rotation[0];
    assert!((turned[2] - 0.5_f32.sqrt()).abs() < 1e-6 && (turned[3] - 0.5_f32.sqrt()).abs() < 1e-6);
    // A node may stretch, which makes other ellipsoids; this one is stretched along an own axis.
    document["nodes"][0]["scale"] = json!([2, 4, 2]);
    let arrays = parse(&document).unwrap().arrays;
    assert!((arrays.position[0] - Vec3::new(-8.0, 22.0, 6.0)).length() < 1e-5);
    assert!((arrays.scale[0] - Vec3::new(1.0, 1.0, 0.25)).length() < 1e-6);
    assert_eq!(arrays.scale[1], Vec3::new(0.5, 0.25, 0.125));
    for bad in [json!([-1, 1, 1]), json!([0, 0, 0])] {
        document["nodes"][0]["scale"] = bad;
        let error = refused(&document);
        assert!(error.contains("node 1: its transform is no rotation and positive"), "{error}");
    }
    document["nodes"][1]["children"] = json!([0]);
    assert!(refused(&document).contains("node 0 has two parents"));
}

/// A sphere of colours seen from the side where the node has turned it.
#[test]
fn coefficients_turn_with_the_node() {
    let at = TempDir::new().unwrap();
    let path = at.path().join("a.glb");
    let one = gaussians(1, 3, Encoding::Srgb);
    write_file(&path, &one, DVec3::ZERO).unwrap();
    let bytes = fs::read(&path).unwrap();
    let start = 20;
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let mut document: Value = serde_json::from_slice(&bytes[start..start + length]).unwrap();
    document["nodes"][0]["rotation"] = json!([1, 0, 0, 0]);
    document["buffers"][0]["uri"] = json!(uri(&bytes[start + length + 8..]));
    let turned = parse(&document).unwrap().arrays;
    // Half a turn about x: functions that are odd in y and z together change their sign.
    let kept = |k: usize| [1.0, -1.0, -1.0, 1.0, -1.0, 1.0, 1.0, -1.0, 1.0][k];
    for k in 0..9 {
        assert_eq!(turned.harmonics[k], one.harmonics(0)[k] * kept(k), "{k}");
    }
}

#[test]
fn negative_scales_are_logarithms_of_a_draft() {
    let mut document = simple();
    let bytes: Vec<u8> = [-1.0_f32, 0.5, -3.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    let scales = view(&mut document, &bytes);
    document["accessors"][1] =
        json!({"bufferView": scales, "componentType": 5126, "count": 1, "type": "VEC3"});
    let found = parse(&document).unwrap();
    assert_eq!(found.arrays.scale[0].to_array(), [-1.0, 0.5, -3.0].map(elementary::exp_f32));
    assert!(found.convention.contains("log scales, because some are negative"));
}

#[test]
fn primitives_of_all_degrees_are_joined() {
    let at = TempDir::new().unwrap();
    let path = at.path().join("a.glb");
    write_file(&path, &gaussians(2, 1, Encoding::Linear), DVec3::ZERO).unwrap();
    let bytes = fs::read(&path).unwrap();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let mut document: Value = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
    document["buffers"][0]["uri"] = json!(uri(&bytes[28 + length..]));
    let mut lower = document["meshes"][0]["primitives"][0].clone();
    for n in 0..3 {
        let name = format!("KHR_gaussian_splatting:SH_DEGREE_1_COEF_{n}");
        lower["attributes"].as_object_mut().unwrap().remove(&name).unwrap();
    }
    let other = json!({"attributes": {"POSITION": 0}, "mode": 4});
    let all = document["meshes"][0]["primitives"].as_array_mut().unwrap();
    all.insert(0, lower);
    all.push(other);
    let found = parse(&document).unwrap();
    assert_eq!((found.arrays.position.len(), found.arrays.degree), (4, 1));
    assert_eq!(found.arrays.harmonics[0], found.arrays.harmonics[8], "degree 0 of both");
    assert_eq!(found.arrays.harmonics[1..4], [Vec3::ZERO; 3]);
    assert!(found.warnings[0].starts_with("1 primitives without KHR_gaussian_splatting"));
}

#[test]
fn what_the_reader_cannot_keep_is_said() {
    let mut document = simple();
    document["meshes"][0]["primitives"][0]["extensions"][EXTENSION]["kernel"] = json!("cube");
    let attributes = &mut document["meshes"][0]["primitives"][0]["attributes"];
    attributes["KHR_gaussian_splatting:GLOSS"] = json!(0);
    let warnings = parse(&document).unwrap().warnings;
    assert_eq!(warnings[0], "kernel \"cube\" is not known, and is taken for \"ellipse\"");
    assert_eq!(warnings[1], "attribute \"KHR_gaussian_splatting:GLOSS\" is not read");
}

/// Why the simple document is refused after a change.
fn refused_with(change: impl Fn(&mut Value)) -> String {
    let mut document = simple();
    change(&mut document);
    refused(&document)
}

#[test]
fn primitives_of_other_kinds_are_refused_by_name() {
    let changed = |key: &str, value: Value| {
        refused_with(|document| document["meshes"][0]["primitives"][0][key] = value.clone())
    };
    assert!(changed("mode", json!(4)).contains("Gaussians have mode 0 (POINTS)"));
    assert!(
        changed("extensions", json!({})).contains("no node of the scene draws a primitive with")
    );
    let space = |value: Value| changed("extensions", json!({EXTENSION: value}));
    assert!(
        space(json!({"kernel": "ellipse"})).contains("there is no colorSpace; give srgb_rec709")
    );
    assert!(space(json!({"colorSpace": "aces"})).contains("colorSpace \"aces\"; give srgb_rec709"));
    let packed = json!({"POSITION": 0});
    assert!(changed("attributes", packed).contains("no attribute KHR_gaussian_splatting:SCALE"));
    let early = json!({"POSITION": 0, "_ROTATION": 2, "_SCALE": 1, "COLOR_0": 1});
    assert!(changed("attributes", early).contains("early draft of the extension; export it again"));
    let partial = |extra: &str| {
        refused_with(|document| {
            document["meshes"][0]["primitives"][0]["attributes"][extra] = json!(4);
        })
    };
    let error = partial("KHR_gaussian_splatting:SH_DEGREE_1_COEF_1");
    assert!(
        error.contains("but no attribute KHR_gaussian_splatting:SH_DEGREE_1_COEF_0"),
        "{error}"
    );
}

#[test]
fn documents_of_other_kinds_are_refused_by_name() {
    let set = |key: &str, value: Value| refused_with(|document| document[key] = value.clone());
    let required = set("extensionsRequired", json!(["EXT_meshopt_compression"]));
    assert!(required.contains("requires the extension \"EXT_meshopt_compression\""), "{required}");
    assert!(set("asset", json!({"version": "1.0"})).contains("glTF of version \"1.0\""));
    assert!(set("scene", json!(3)).contains("there is no scene 3"));
    assert!(set("nodes", json!([{"mesh": 5}])).contains("there is no mesh 5"));
    assert!(set("nodes", json!("x")).contains("no glTF: invalid type"));
    assert!(
        set("buffers", json!([{"byteLength": 56, "uri": "http://a/b"}]))
            .contains("at another place")
    );
    assert!(set("buffers", json!([{"byteLength": 56}])).contains("buffer 0 has no uri"));
    assert!(
        set("buffers", json!([{"byteLength": 57, "uri": uri(&[0; 56])}]))
            .contains("only 56 are there")
    );
    let accessor = |key: &str, value: Value| {
        refused_with(|document| document["accessors"][0][key] = value.clone())
    };
    assert!(accessor("count", json!(1_u64 << 60)).contains("more than the file has bytes"));
    assert!(accessor("count", json!(20)).contains("accessor 0 reaches beyond buffer view 0"));
    assert!(accessor("byteOffset", json!(u64::MAX)).contains("reaches beyond"));
    assert!(accessor("type", json!("VEC2")).contains("has the type \"VEC2\", but must be VEC3"));
    assert!(
        accessor("componentType", json!(7)).contains("the component type 7, which glTF has not")
    );
}

/// No cut, flipped or doubled byte makes the reader panic.
#[test]
fn damaged_glbs_are_refused() {
    let at = TempDir::new().unwrap();
    let path = at.path().join("a.glb");
    write_file(&path, &gaussians(2, 1, Encoding::Srgb), DVec3::ZERO).unwrap();
    let whole = fs::read(&path).unwrap();
    let again = |bytes: &[u8]| {
        fs::write(&path, bytes).unwrap();
        read(&path)
    };
    for end in (0..whole.len()).step_by(23) {
        assert!(again(&whole[..end]).is_err(), "{end}");
    }
    assert!(
        again(&[&whole[..], b"1"].concat())
            .unwrap_err()
            .to_string()
            .contains("truncated or damaged")
    );
    for at in (0..1500).step_by(7) {
        let mut bytes = whole.clone();
        bytes[at] ^= 1 << (at % 8);
        let _ = again(&bytes);
    }
}
