//! Check that every error is one line.

use super::*;

/// A folder of a raw file of 2 x 2 numbers.
fn folder() -> Folder {
    Folder::new().with("a.raw", &floats(&[1.0, 2.0, 3.5, 4.0])).with("one.raw", &[1])
}

#[test]
fn what_is_no_file_of_planes() {
    let at = folder();
    for (toml, why) in [
        ("", "mine.toml: no plane; give a `file`, or a table such as [planes.Z]"),
        ("[planes]", "no plane; give a `file`"),
        ("size = [2, 2", "line 1: "),
        ("profile = \"gpu\"\nprofile = \"gpu\"", "line 2: "),
        ("\n\nsize = ", "line 3: "),
        (
            "planes.Z = \"a.raw\"\ngamma = 2",
            "mine.toml: unknown key `gamma`; the keys are depth, depth-test, planes, file, profile, accumulator, \
             ties, origin, size",
        ),
        (
            "planes.Z = \"a.raw\"\ndepth.kind = \"t\"",
            "depth: unknown key `kind`; the keys are meaning, near, far",
        ),
        (
            "[planes.Z]\nfile = \"a.raw\"\nstride = 4",
            "planes.Z: unknown key `stride`; the keys are file, channel, format, offset, row_stride, \
             pixel_stride, empty, id_base, premultiplied, encoding, range, meaning, near, far",
        ),
        (
            "[planes.visibility.Z]\nfile = \"a.raw\"",
            "quote a name that has a dot: [planes.\"visibility.Z\"]",
        ),
        (
            "planes.depth = \"a.raw\"",
            "planes: no plane is called `depth`; there are visibility.Z, ",
        ),
        (
            "[planes]\nRGB = \"a.raw\"\n\"\" = \"a.raw\"",
            "planes: `` and `RGB` are the same plane; remove one",
        ),
        (
            "file = \"a.raw\"",
            "file: only an EXR holds several planes; name other files in [planes]",
        ),
        ("planes.Z.format = \"f32\"", "planes.Z: no `file`, neither here nor for all planes"),
        ("planes.Z = \"a.tif\"", "a.tif\"; give an .exr, .npy, .npz, .png, .raw or .bin"),
        ("planes.Z = \"none.raw\"", "none.raw: "),
    ] {
        let line = at.refusal(toml);
        assert!(line.contains(why), "{toml}: {line}");
    }
}

#[test]
fn raw_files_of_another_length() {
    let at = folder();
    for (toml, why) in [
        ("planes.Z = \"one.raw\"\nsize = [60000, 60000]", "14400000000 bytes, but the file has 1;"),
        (
            "planes.Z = \"one.raw\"",
            "planes.Z: 2 x 2 pixels of f32 need 16 bytes, but the file has 1",
        ),
        (
            "[planes.Z]\nfile = \"a.raw\"\noffset = 9223372036854775807",
            "planes.Z: 2 x 2 pixels of f32 need at least 9223372036854775823 bytes",
        ),
        (
            "[planes.Z]\nfile = \"a.raw\"\nrow_stride = 9223372036854775807\n\
             pixel_stride = 9223372036854775800",
            "planes.Z: 2 x 2 pixels of f32 need at least 18446744073709551611 bytes",
        ),
        (
            "[planes.Z]\nfile = \"a.raw\"\nrow_stride = 16\npixel_stride = 9223372036854775800",
            "planes.Z: row_stride is 16, but a row has 9223372036854775804 bytes",
        ),
        (
            "planes.normal = { file = \"a.raw\", pixel_stride = 4 }",
            "planes.normal: pixel_stride is 4, but a pixel has 12 bytes",
        ),
        (
            "planes.normal = \"a.raw\"",
            "planes.normal: 2 x 2 pixels of 3 f32 need 48 bytes, but the file has 16",
        ),
    ] {
        let line = at.refusal(toml);
        assert!(line.contains(why), "{toml}: {line}");
    }
}

#[test]
fn values_of_the_wrong_type() {
    let at = folder();
    for (key, why) in [
        ("file = 7", "file is 7; give the path of a file"),
        ("file = \"\"", "file is \"\"; give the path of a file"),
        ("planes = 1", "planes is 1; give a table"),
        ("planes.Z = 1.5", "planes.Z is 1.5; give a table, or the path of a file"),
        ("depth = \"t\"", "depth is \"t\"; give a table"),
        ("profile = \"GPU\"", "profile is \"GPU\"; give one of \"gpu\", \"precise\", \"ieee\""),
        ("ties = true", "ties is true; give one of \"lowest\", \"last\", \"any\""),
        ("accumulator = \"f64\"", "accumulator is \"f64\"; give one of \"f32\", \"f16\""),
        ("origin = []", "origin is an array of 0; give one of \"top-left\", \"bottom-left\""),
        ("size = [0, 4]", "size is an array of 2; give width and height, at least 1: [640, 480]"),
        ("size = [4294967296, 4]", "size is an array of 2; give width and height"),
        ("size = 1979-05-27", "size is a datetime; give width and height"),
        (
            "depth.meaning = \"z\"",
            "depth.meaning is \"z\"; give one of \"t\", \"1/t\", \"near/t\", ",
        ),
        ("depth.near = \"1\"", "depth.near is \"1\"; give a number"),
        ("depth.near = -1", "depth.near must be a depth, from 0"),
        ("depth.far = nan", "depth.far must be a depth, from 0"),
        ("planes.Z.format = \"f64\"", "planes.Z.format is \"f64\"; give one of \"f32\", \"f16\", "),
        ("planes.Z.offset = -1", "planes.Z.offset is -1; give a whole number of bytes from 0"),
        ("planes.Z.empty = true", "planes.Z.empty is true; give a number"),
        ("planes.id.id_base = -1", "planes.id.id_base is -1; give a whole number from 0"),
        ("planes.RGB.premultiplied = 1", "planes.RGB.premultiplied is 1; give true or false"),
        (
            "planes.RGB.encoding = \"sRGB\"",
            "planes.RGB.encoding is \"sRGB\"; give one of \"linear\", ",
        ),
        ("planes.RGB.channel = [\"r\"]", "planes.RGB.channel is an array of 1; give the name of"),
        ("planes.Z.range = [1, 1]", "planes.Z.range is an array of 2; give two different finite"),
        ("planes.\"visibility.Z\".near = -2", "planes.\"visibility.Z\".near must be a depth"),
    ] {
        let line = at.refusal(key);
        assert!(line.contains(&format!("mine.toml: {why}")), "{key}: {line}");
    }
}

#[test]
fn what_no_rule_covers() {
    let at = folder();
    for (plane, keys, why) in [
        ("Z", "meaning = \"linear\"\nnear = 1", "meaning is linear, which needs `far`: give it in"),
        ("Z", "meaning = \"near/t\"", "meaning is near/t, which needs `near`"),
        (
            "Z",
            "meaning = \"z-buffer\"\nnear = 0\nfar = 1",
            "meaning is z-buffer, but near = 0 and far = 1 are impossible",
        ),
        (
            "Z",
            "meaning = \"z-buffer\"\nnear = 2\nfar = 1",
            "meaning is z-buffer, but near = 2 and far = 1 are impossible",
        ),
        (
            "Z",
            "meaning = \"linear\"\nnear = 2\nfar = inf",
            "meaning is linear, but near = 2 and far = inf are impossible",
        ),
        ("Z", "range = [0, 2]", "`range` does not apply to f32, only to unorm: remove it"),
        ("Z", "channel = \"depth\"", "`channel` does not apply to a raw file: remove it"),
        ("Z", "id_base = 1", "`id_base` does not apply to depths: remove it"),
        ("Z", "encoding = \"srgb\"", "`encoding` does not apply to depths: remove it"),
        (
            "Z",
            "format = \"u32\"",
            "whole numbers (u32), but the plane holds others; give the `format`",
        ),
        (
            "weight",
            "meaning = \"1/t\"",
            "`meaning` does not apply to one number a pixel: remove it",
        ),
        ("weight", "empty = 0", "`empty` does not apply to one number a pixel: remove it"),
        ("id", "premultiplied = true", "`premultiplied` does not apply to indices of 32 bits"),
        (
            "id",
            "format = \"f32\"",
            "3.5 at pixel (0, 1) is not a whole number from 0 to 4294967295",
        ),
        ("id", "format = \"f32\"\nid_base = 3", "1 at pixel (0, 0) is not a whole number"),
        (
            "id",
            "format = \"unorm24\"",
            "format is unorm24, but indices and counts are whole: give u8",
        ),
        ("id", "range = [0, 1]", "`range` does not apply to indices of 32 bits"),
    ] {
        let line = at.refusal(&format!("[planes.{plane}]\nfile = \"a.raw\"\n{keys}"));
        let place = format!(": planes.{plane}: {why}");
        assert!(line.contains(&place), "{line}");
    }
}

#[test]
fn depth_tests_that_no_rule_covers() {
    let at = folder();
    for (keys, why) in [
        (
            "meaning = \"z-buffer\"\nnear = 1",
            "meaning is z-buffer, which needs `far`: give it in [depth-test]",
        ),
        ("format = \"unorm16\"", "format is unorm16, which holds 0 to 1; give a `meaning`"),
        ("format = \"u32\"", "format is u32; give f32, f16 or unorm"),
        ("width = 3", "unknown key `width`"),
    ] {
        let line = at.refusal(&format!("[depth-test]\n{keys}\n[planes.Z]\nfile = \"a.raw\""));
        assert!(line.contains(&format!(": depth-test: {why}")), "{line}");
    }
}

#[test]
fn what_no_value_of_a_file_fits() {
    let at = folder().with("c.raw", &[0; 12]);
    let color = "[planes.RGB]\nfile = \"c.raw\"\nformat = \"unorm8\"\n";
    let line = at.refusal(&format!("{color}premultiplied = true"));
    assert!(line.ends_with("planes.RGB: `premultiplied` needs the plane `A`"), "{line}");
    let line = at.refusal(&format!("{color}encoding = \"srgb\"\nrange = [0, 2]"));
    assert!(line.contains("planes.RGB: `range` does not apply to sRGB: remove it, or"), "{line}");
    let at = at.with("f.raw", &floats(&[16_777_216.0, 0.0, 0.0, 0.0]));
    let line = at.refusal("[planes.id]\nfile = \"f.raw\"\nformat = \"f32\"");
    assert!(line.contains("the format is exact only below 16777216; store them"), "{line}");
    let at = at.with("c.raw", &le(&[256_u32, 0, 0, 0], u32::to_le_bytes));
    let line = at.refusal("[planes.\"attributes.count\"]\nfile = \"c.raw\"\nformat = \"u32\"");
    assert!(line.contains("256 at pixel (0, 0) is not a whole number from 0 to 255"), "{line}");
}

#[test]
fn files_that_lie() {
    let npy = |shape: &str, data: &[u8]| {
        let text = format!("{{'descr': '<u4', 'fortran_order': False, 'shape': {shape}, }}");
        let length = (text.len() as u16).to_le_bytes();
        [b"\x93NUMPY\x01\0", length.as_slice(), text.as_bytes(), data].concat()
    };
    let codes = le(&[70_000_u32, 0, 0, 0], u32::to_le_bytes);
    let at = folder().with("one.exr", &[1]).with("one.npy", &[1]).with("text.toml", &[0xFF]);
    let at = at.with("a.npy", &npy("(2, 2)", &codes)).with("big.npy", &npy("(60000, 60000)", &[]));
    for (toml, why) in [
        ("file = \"one.exr\"", "one.exr: byte 0: not an EXR file"),
        ("planes.Z = \"one.npy\"", "one.npy: byte 0: not an NPY file"),
        ("planes.id = \"big.npy\"", "declares 60000 x 60000 pixels"),
        ("planes.RGB = \"a.npy\"", "planes.RGB: 1 numbers a pixel, but the plane holds colours"),
        ("planes.Z = \"a.npy\"", "planes.Z: whole numbers (u32), but the plane holds others"),
        (
            "planes.Z = { file = \"a.npy\", format = \"unorm16\" }",
            "planes.Z: 70000 at pixel (0, 0) is not a code of unorm16",
        ),
        (
            "planes.Z = { file = \"a.npy\", format = \"f32\" }",
            "planes.Z: format is f32, but a file of u32 can hold other numbers",
        ),
        (
            "planes.Z = { file = \"a.npy\", offset = 4 }",
            "planes.Z: `offset` does not apply to an NPY: remove it",
        ),
    ] {
        let line = at.refusal(toml);
        assert!(line.contains(why), "{toml}: {line}");
    }
    assert!(matches!(at.open("text.toml").unwrap_err(), Error::Format { .. }));
    assert!(matches!(at.open("none.toml").unwrap_err(), Error::Io { .. }));
    assert!(matches!(at.open("a.npy").unwrap_err(), Error::Usage(_)));
}
