//! Check EXR, NPY and PNG files.

use super::*;
use crate::frame::NO_ID;
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image as ExrImage, Layer, LayerAttributes,
    WritableImage, f16,
};

/// The bytes of an EXR of 2 x 2 pixels, its channels by name.
fn exr(channels: Vec<(&str, FlatSamples)>) -> Vec<u8> {
    let channels = channels.into_iter().map(|(name, samples)| AnyChannel::new(name, samples));
    let channels = AnyChannels::sort(channels.collect());
    let attributes = LayerAttributes::named("layer");
    let layer = Layer::new((2, 2), attributes, Encoding::UNCOMPRESSED, channels);
    let mut bytes = std::io::Cursor::new(Vec::new());
    ExrImage::from_layer(layer).write().non_parallel().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

fn singles(values: [f32; 4]) -> FlatSamples {
    FlatSamples::F32(values.to_vec())
}

fn halves(values: [f32; 4]) -> FlatSamples {
    FlatSamples::F16(values.map(f16::from_f32).to_vec())
}

fn frame() -> Vec<u8> {
    exr(vec![
        ("Z", singles([1.5, f32::INFINITY, 2.5, 3.5])),
        ("R", halves([0.25, 0.0, 0.5, 1.0])),
        ("G", halves([0.5, 0.0, 0.5, 1.0])),
        ("B", halves([0.75, 0.0, 0.5, 1.0])),
        ("id", FlatSamples::U32(vec![7, NO_ID, 0, 1])),
        ("attributes.count", halves([1.0, 0.0, 2.0, 3.0])),
        ("normal.X", singles([0.0; 4])),
        ("debug", singles([0.0; 4])),
    ])
}

/// An NPY of version 1.0.
fn npy(descr: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let text = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}\n");
    let length = (text.len() as u16).to_le_bytes();
    [b"\x93NUMPY\x01\0", length.as_slice(), text.as_bytes(), data].concat()
}

#[test]
fn an_exr_by_itself() {
    let at = Folder::new().with("frame.exr", &frame());
    let client = at.open("frame.exr").unwrap();
    assert_eq!(scalars(&client, "Z"), [1.5, f64::INFINITY, 2.5, 3.5]);
    assert_eq!(triples(&client, "")[0], [0.25, 0.5, 0.75]);
    assert_eq!((client.storage("Z"), client.storage("")), (Storage::Single, Storage::Half));
    assert_eq!(ids(&client, "id"), [7, NO_ID, 0, 1]);
    assert_eq!(client.frame().count("attributes.count").unwrap().values(), [1, 0, 2, 3]);
    assert_eq!(client.unknown, ["debug", "normal.X"], "a third of a vector is none");
    assert_eq!(client.frame().planes.len(), 4);
}

#[test]
fn an_exr_with_words() {
    let at = Folder::new().with("frame.exr", &frame());
    let toml = "file = \"frame.exr\"\norigin = \"bottom-left\"\n\
                [planes]\nweight = { channel = \"debug\" }\n\
                A = { channel = \"Z\", format = \"f16\" }\n\
                attributes = { channel = [\"B\", \"G\", \"R\"] }\n\
                id = { empty = 0, id_base = 0 }";
    let client = at.read(toml).unwrap();
    assert_eq!(scalars(&client, "weight"), [0.0; 4]);
    assert_eq!(scalars(&client, "A")[..2], [2.5, 3.5]);
    assert_eq!(client.storage("A"), Storage::Half);
    assert_eq!(triples(&client, "attributes")[2], [0.75, 0.5, 0.25]);
    assert_eq!(triples(&client, "")[2], [0.25, 0.5, 0.75]);
    // The key of the id makes 0 empty, so all bits set are a surfel that does not exist.
    assert_eq!(ids(&client, "id"), [NO_ID, 1, 7, NO_ID]);
    assert_eq!(client.unknown, ["normal.X"]);
}

#[test]
fn planes_of_numpy() {
    let depth = npy("<f4", "(2, 2)", &floats(&[0.5, 0.25, 1.0, 0.0]));
    let id = npy("<i4", "(2, 2)", &le(&[7, -1, 0, 1], i32::to_le_bytes));
    let normal = npy("|u1", "(2, 2, 3)", &[255, 0, 51, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
    let at = Folder::new().with("z.npy", &depth).with("id.npy", &id).with("n.npy", &normal);
    let toml = "[planes]\nZ = { file = \"z.npy\", meaning = \"1/t\", format = \"unorm16\" }\n\
                id = \"id.npy\"\n\
                normal = { file = \"n.npy\", format = \"unorm8\", range = [-1, 1] }";
    let client = at.read(toml).unwrap();
    assert_eq!(scalars(&client, "Z"), [2.0, 4.0, 1.0, f64::INFINITY]);
    let steps = Storage::Inverse { scale: 1.0, relative: 0.0, least: 1.0 / 65_535.0 };
    assert_eq!(client.storage("Z"), steps);
    assert_eq!(ids(&client, "id"), [7, NO_ID, 0, 1]);
    near(&triples(&client, "normal")[0], &[1.0, -1.0, -0.6]);
    assert_eq!(client.storage("normal"), Storage::Steps(2.0 / 255.0));
}

#[test]
fn all_planes_have_one_size() {
    let depth = npy("<f4", "(1, 3)", &floats(&[0.5, 0.25, 1.0]));
    let at = Folder::new().with("z.npy", &depth).with("frame.exr", &frame());
    let at = at.with("w.raw", &floats(&[1.0, 2.0, 3.0]));
    // A raw file has the size of the other files, which are read first.
    let client = at.read("[planes]\nA = \"w.raw\"\nZ = \"z.npy\"").unwrap();
    assert_eq!((client.frame().width, client.frame().height), (3, 1));
    let line = at.refusal("file = \"frame.exr\"\n[planes]\nZ = \"z.npy\"");
    assert!(
        line.ends_with("planes.\"attributes.count\": 2 x 2 pixels, but planes.Z is 3 x 1"),
        "{line}"
    );
    let line = at.refusal("size = [1, 3]\n[planes]\nZ = \"z.npy\"");
    assert!(line.ends_with("planes.Z: 3 x 1 pixels, but `size` is 1 x 3"), "{line}");
}

#[cfg(feature = "cli")]
#[test]
fn pictures_of_png() {
    use image::codecs::png::PngEncoder;
    use image::{ExtendedColorType, ImageEncoder};
    let png = |pixels: &[u8], kind| {
        let mut bytes = Vec::new();
        PngEncoder::new(&mut bytes).write_image(pixels, 2, 1, kind).unwrap();
        bytes
    };
    let color = png(&[188, 10, 255, 51, 0, 0, 0, 102], ExtendedColorType::Rgba8);
    let grey = png(&le(&[13_107_u16, 65_535], u16::to_ne_bytes), ExtendedColorType::L16);
    let at = Folder::new().with("c.png", &color).with("g.png", &grey);
    let toml = "[planes]\nRGB = \"c.png\"\nA = \"c.png\"\nid = { file = \"g.png\", empty = 65535 }\n\
                weight = \"g.png\"\nZ = { file = \"g.png\", range = [0, 10] }\n\
                attributes = { file = \"c.png\", encoding = \"linear\" }";
    let client = at.read(toml).unwrap();
    let [first, _] = triples(&client, "").try_into().unwrap();
    assert!((first[0] - 0.502_886_5).abs() < 1e-7 && first[2] == 1.0, "{first:?}");
    assert_eq!(client.storage(""), Storage::Srgb { relative: 0.0, least: 1.0 / 255.0 });
    assert_eq!(triples(&client, "attributes")[0], [188.0 / 255.0, 10.0 / 255.0, 1.0]);
    assert_eq!(scalars(&client, "A"), [0.2, 0.4], "codes, not what f32 makes of them");
    assert_eq!(scalars(&client, "weight"), [0.2, 1.0]);
    assert_eq!(client.storage("weight"), Storage::Steps(1.0 / 65_535.0));
    assert_eq!(scalars(&client, "Z"), [2.0, 10.0]);
    assert_eq!(ids(&client, "id"), [13_107, NO_ID]);
    let line = at.refusal("[planes]\nweight = \"c.png\"");
    assert!(line.contains("planes.weight: the PNG is not grey; give the `channel`"), "{line}");
    let green = at.read("[planes]\nweight = { file = \"c.png\", channel = \"G\" }").unwrap();
    near(&scalars(&green, "weight"), &[10.0 / 255.0, 0.0]);
}

/// Channels as Blender names them.
#[test]
fn one_name_stands_for_all_channels_of_a_colour() {
    let picture = exr(vec![
        ("ViewLayer.Combined.R", singles([0.25, 0.0, 0.5, 1.0])),
        ("ViewLayer.Combined.G", singles([0.5, 0.0, 0.5, 1.0])),
        ("ViewLayer.Combined.B", singles([0.75, 0.0, 0.5, 1.0])),
        ("ViewLayer.Depth.Z", singles([1.5, f32::INFINITY, 2.5, 3.5])),
    ]);
    let at = Folder::new().with("frame.exr", &picture);
    let text = "file = \"frame.exr\"\n[planes]\nRGB = { channel = \"ViewLayer.Combined\" }\n\
                Z = { channel = \"ViewLayer.Depth.Z\" }\n";
    let client = at.read(text).unwrap();
    assert_eq!(triples(&client, "")[0], [0.25, 0.5, 0.75]);
    assert_eq!(scalars(&client, "Z")[0], 1.5);
    assert!(client.unknown.is_empty(), "{:?}", client.unknown);
}

#[test]
fn half_floats_of_numpy_are_half_floats() {
    let data: Vec<u8> = [1.5_f32, 2.0, 2.5, 3.5]
        .iter()
        .flat_map(|&value| f16::from_f32(value).to_le_bytes())
        .collect();
    let at = Folder::new().with("Z.npy", &npy("<f2", "(2, 2)", &data));
    let client = at.read("[planes]\nZ = \"Z.npy\"\n").unwrap();
    assert_eq!(scalars(&client, "Z"), [1.5, 2.0, 2.5, 3.5]);
    assert_eq!(client.storage("Z"), Storage::Half);
}
