//! Check pictures whose data window is not the display window.

use super::*;
use exr::prelude::IntegerBounds;

/// A part of 3 x 2 pixels at a place, in a display window of this size at (0, 0).
fn part(at: [i32; 2], size: [usize; 2]) -> Image {
    let floats = |first: u8| FlatSamples::F32((0..6).map(|i| f32::from(first + i)).collect());
    let ids = FlatSamples::U32((0..6).collect());
    let list = [
        AnyChannel::new("R", floats(10)),
        AnyChannel::new("Z", floats(20)),
        AnyChannel::new("group00.Z", floats(40)),
        AnyChannel::new("id", ids.clone()),
        AnyChannel::new("n.X", floats(50)),
        AnyChannel::new("n.Z", floats(60)),
        AnyChannel::new("attributes.count", ids),
    ];
    let mut attributes = LayerAttributes::named("layer");
    attributes.layer_position = Vec2(at[0], at[1]);
    let encoding = Encoding {
        compression: Codec::ZIP1,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let channels = AnyChannels::sort(list.into_iter().collect());
    let mut image = ExrImage::from_layer(Layer::new((3, 2), attributes, encoding, channels));
    image.attributes.display_window = IntegerBounds::new((0, 0), (size[0], size[1]));
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write().non_parallel().to_buffered(&mut bytes).unwrap();
    let (_folder, path) = file(&bytes.into_inner());
    let header = read_header(&path).unwrap();
    let image = read(&path).unwrap();
    assert_eq!([header.width, header.height].map(|side| side as usize), size);
    assert_eq!([image.width, image.height].map(|side| side as usize), size);
    image
}

fn floats(image: &Image, name: &str) -> Vec<f32> {
    match image.channel(name) {
        Some(Values::Float(values)) => values.clone(),
        other => panic!("{name}: {other:?}"),
    }
}

#[test]
fn what_lies_outside_the_data_is_empty() {
    // The last two columns of the second line of the data are in the first line of the picture.
    let image = part([-1, -1], [4, 2]);
    let inf = f32::INFINITY;
    assert_eq!(floats(&image, "R"), [14.0, 15.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert_eq!(floats(&image, "Z"), [24.0, 25.0, inf, inf, inf, inf, inf, inf]);
    assert_eq!(floats(&image, "group00.Z"), [44.0, 45.0, inf, inf, inf, inf, inf, inf]);
    assert_eq!(floats(&image, "n.Z"), [64.0, 65.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let ids = Values::Index([&[4, 5][..], &[NO_ID; 6]].concat());
    assert_eq!(image.channel("id"), Some(&ids));
    let counts = Values::Index([&[4, 5][..], &[0; 6]].concat());
    assert_eq!(image.channel("attributes.count"), Some(&counts));
}

#[test]
fn the_data_are_cropped_to_the_picture() {
    let image = part([1, 0], [2, 1]);
    assert_eq!(floats(&image, "R"), [0.0, 10.0]);
    for [x, y] in [[2, 0], [-3, 0], [0, 1], [0, -2], [9, 9]] {
        let image = part([x, y], [2, 1]);
        assert_eq!(floats(&image, "R"), [0.0, 0.0], "{x} {y}");
    }
    let whole = part([0, 0], [3, 2]);
    assert_eq!(floats(&whole, "Z"), [20.0, 21.0, 22.0, 23.0, 24.0, 25.0]);
}

#[test]
fn a_part_keeps_its_place_and_its_bits() {
    let folder = tempfile::tempdir().unwrap();
    let (path, exec) = (folder.path().join("part.exr"), Exec::new(2, 32).unwrap());
    let depth = Plane::from_pixels([5, 37], |x, y| (x * 100 + y) as f32);
    let frame = Frame::new(5, 37).with("Z", Samples::Scalar(depth)).unwrap();
    let window = Window { region: Rect { x0: 7, y0: 33, x1: 12, y1: 70 }, picture: [60_000, 70] };
    for compression in [Compression::Rle, Compression::Zip, Compression::Piz, Compression::None] {
        pending_part(&path, &frame, window, "text", compression, &exec).unwrap().put().unwrap();
        let read = read_region(&path, &exec).unwrap();
        assert_eq!((read.window, read.compression), (window, Some(compression)));
        assert_eq!(Image { text: None, ..read.image }, Image::from(&frame), "{compression:?}");
        assert_eq!(read_header(&path).unwrap().data, Some(window.region));
        let Some(Values::Float(whole)) = super::read(&path).unwrap().channels.pop().map(|c| c.1)
        else {
            panic!("no depth");
        };
        assert_eq!((whole[33 * 60_000 + 7], whole[69 * 60_000 + 11]), (0.0, 436.0));
        assert_eq!(whole.iter().filter(|depth| depth.is_finite()).count(), 5 * 37);
    }
    for (region, picture) in [
        (Rect { x1: 13, ..window.region }, window.picture),
        (window.region, [11, 70]),
        (Rect::default(), window.picture),
    ] {
        let other = Window { region, picture };
        let refused = pending_part(&path, &frame, other, "", Compression::Rle, &exec);
        assert_eq!(refused.unwrap_err().exit_code(), 1);
    }
}
