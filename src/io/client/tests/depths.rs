//! Check the meanings of stored depths.

use super::*;
use crate::frame::Plane;

/// The depths of a plane of one row of raw numbers, and their storage.
fn depths(bytes: &[u8], count: usize, keys: &str) -> (Vec<f64>, Storage) {
    let at = Folder::new().with("z.raw", bytes);
    let toml = format!("size = [{count}, 1]\n[planes.Z]\nfile = \"z.raw\"\n{keys}");
    let client = at.read(&toml).unwrap();
    (scalars(&client, "Z"), client.storage("Z"))
}

const ENDS: &str = "near = 0.5\nfar = 2\n";
const INF: f64 = f64::INFINITY;

#[test]
fn t_is_t() {
    let bytes = floats(&[1.5, f32::INFINITY, -0.0]);
    assert_eq!(depths(&bytes, 3, ""), (vec![1.5, INF, -0.0], Storage::Single));
    let (values, _) = depths(&bytes, 3, "empty = 1.5");
    assert_eq!(values, [INF, INF, -0.0]);
    // The clear value is rounded to f32: 0.1 itself does not occur.
    let (values, _) = depths(&floats(&[0.1, 1.0]), 2, "empty = 0.1");
    assert_eq!(values, [INF, 1.0]);
    let (values, _) = depths(&floats(&[f32::NAN, 1.0]), 2, "empty = nan");
    assert_eq!(values, [INF, 1.0]);
    let (values, _) = depths(&floats(&[f32::NAN, 1.0]), 2, "");
    assert!(values[0].is_nan(), "for the verifier");
    // Codes of 16 bits as millimetres: 65.535 m.
    let bytes = le(&[1500_u16, 65_535, 0], u16::to_le_bytes);
    let keys = "format = \"unorm16\"\nrange = [0, 65.535]\nempty = 0";
    let (values, storage) = depths(&bytes, 3, keys);
    near(&values, &[1.5, 65.535, INF]);
    let Storage::Steps(step) = storage else { panic!("{storage:?}") };
    near(&[step], &[0.001]);
}

#[test]
fn one_over_t() {
    let f32_loss = 1.0 / 2_097_152.0;
    let (values, storage) = depths(&floats(&[0.5, 0.0, 4.0]), 3, "meaning = \"1/t\"");
    assert_eq!(values, [2.0, INF, 0.25]);
    assert_eq!(storage, Storage::Inverse { scale: 1.0, relative: f32_loss, least: 0.0 });
    // 0x3800 is 0.5, 0x0001 is 2^-24 of f16.
    let bytes = le(&[0x3800_u16, 0, 1], u16::to_le_bytes);
    let keys = "format = \"f16\"\nmeaning = \"near/t\"\nnear = 0.25";
    let (values, storage) = depths(&bytes, 3, keys);
    assert_eq!(values, [0.5, INF, 4_194_304.0]);
    let half = Storage::Inverse { scale: 0.25, relative: 1.0 / 1024.0, least: 1.0 / 16_777_216.0 };
    assert_eq!(storage, half);
    let keys = "format = \"unorm8\"\nmeaning = \"near/t\"\nnear = 0.25";
    let (values, storage) = depths(&[51, 255, 0], 3, keys);
    near(&values, &[1.25, 0.25, INF]);
    assert_eq!(storage, Storage::Inverse { scale: 0.25, relative: 0.0, least: 1.0 / 255.0 });
}

#[test]
fn depth_buffers() {
    // For near 1/2 and far 2, z = 2 (t - 1/2) / (1.5 t): t = 1 is 2/3, t = 4/5 is 1/2.
    let keys = format!("{ENDS}meaning = \"z-buffer\"\n");
    let (values, storage) = depths(&floats(&[0.5, 0.0, 1.0]), 3, &keys);
    near(&values, &[0.8, 0.5, INF]);
    let step = 1.0 / 8_388_608.0;
    assert_eq!(storage, Storage::DepthBuffer { step, near: 0.5, far: 2.0 });
    // 0xAAAAAA is 2/3 of 0xFFFFFF; the stencil above it does not count.
    let bytes = le(&[0x55AA_AAAA_u32, 0x00FF_FFFF, 0], u32::to_le_bytes);
    let (values, storage) = depths(&bytes, 3, &format!("{keys}format = \"unorm24\""));
    near(&values, &[1.0, INF, 0.5]);
    let step = 1.0 / 16_777_215.0;
    assert_eq!(storage, Storage::DepthBuffer { step, near: 0.5, far: 2.0 });
    let (_, storage) = depths(&[0, 0], 1, &format!("{keys}format = \"f16\""));
    assert_eq!(storage, Storage::DepthBuffer { step: 1.0 / 1024.0, near: 0.5, far: 2.0 });
    // With another empty value, 1 is the far end.
    let (values, _) = depths(&floats(&[1.0, 0.0]), 2, &format!("{keys}empty = 0"));
    near(&values, &[2.0, INF]);
}

#[test]
fn reversed_depth_buffers() {
    let keys = format!("{ENDS}meaning = \"reversed-z\"\n");
    let bytes = le(&[0x5555_u16, 0, 0xFFFF], u16::to_le_bytes);
    let (values, storage) = depths(&bytes, 3, &format!("{keys}format = \"unorm16\""));
    near(&values, &[1.0, INF, 0.5]);
    let step = 1.0 / 65_535.0;
    assert_eq!(storage, Storage::DepthBuffer { step, near: 0.5, far: 2.0 });
    let (values, storage) = depths(&floats(&[0.5, 0.0, 1.0]), 3, &keys);
    near(&values, &[0.8, INF, 0.5]);
    // 1 - z = (2/3) / t - 1/3.
    let Storage::Inverse { scale, relative, least } = storage else { panic!("{storage:?}") };
    near(&[scale, relative, least], &[2.0 / 3.0, 1.0 / 2_097_152.0, 0.0]);
    // Without a far end it is near / t.
    let keys = "near = 0.5\nfar = inf\nmeaning = \"reversed-z\"";
    let (values, _) = depths(&floats(&[0.125, 0.0, 1.0]), 3, keys);
    near(&values, &[4.0, INF, 0.5]);
    // And reversed, 1 - near / t, in steps that the radius takes into account.
    let keys = "near = 0.5\nfar = inf\nmeaning = \"z-buffer\"\nformat = \"unorm8\"";
    let (values, storage) = depths(&[51, 255], 2, keys);
    near(&values, &[0.625, INF]);
    // One code further: 52 / 255, t = 0.5 / (1 - 52 / 255).
    near(&[storage.radius(0.625)], &[0.5 / (203.0 / 255.0) - 0.625]);
}

#[test]
fn linear_depths() {
    let keys = format!("{ENDS}meaning = \"linear\"\n");
    let (values, storage) = depths(&[51, 255, 0], 3, &format!("{keys}format = \"unorm8\""));
    near(&values, &[0.8, INF, 0.5]);
    let Storage::Steps(step) = storage else { panic!("{storage:?}") };
    near(&[step], &[1.5 / 255.0]);
    let (values, storage) = depths(&floats(&[0.5]), 1, &keys);
    assert_eq!((values, storage), (vec![1.25], Storage::Steps(2.0 / 8_388_608.0)));
    let bytes = 0x3800_u16.to_le_bytes();
    let (values, storage) = depths(&bytes, 1, &format!("{keys}format = \"f16\""));
    assert_eq!(values, [1.25]);
    assert_eq!(storage.radius(1.25), 1.5 * 0.5 / 1024.0);
    // Reversed: 0 at the far end.
    let keys = "near = 2\nfar = 0.5\nmeaning = \"linear\"\nempty = 0";
    assert_eq!(depths(&floats(&[0.0, 0.5, 1.0]), 3, keys).0, [INF, 1.25, 0.5]);
}

#[test]
fn what_is_said_of_all_depths_holds_where_a_plane_says_nothing() {
    let at = Folder::new().with("z.raw", &floats(&[0.25, 0.5, 1.0, 0.0]));
    let toml = "depth = { meaning = \"near/t\", near = 0.5 }\n\
                [planes]\nZ = \"z.raw\"\n\"visibility.Z\" = { file = \"z.raw\", near = 1 }\n\
                weight = \"z.raw\"";
    let client = at.read(toml).unwrap();
    assert_eq!(scalars(&client, "Z"), [2.0, 1.0, 0.5, INF]);
    assert_eq!(scalars(&client, "visibility.Z"), [4.0, 2.0, 1.0, INF]);
    assert_eq!(scalars(&client, "weight"), [0.25, 0.5, 1.0, 0.0]);
}

/// Depths come back from every convention and file, within what its storage may lose.
#[cfg(feature = "cli")]
#[test]
fn what_is_written_is_read_again() {
    let all = [0.75, INF, 1.0, 3.5, 1.9990234375, INF];
    let plane = Plane::from_values(3, 2, all.map(|t| t as f32).to_vec());
    for (file, text) in [
        (DepthFile::Npy, "t"),
        (DepthFile::Png, "t,1000"),
        (DepthFile::Npy, "1/t"),
        (DepthFile::Npy, "near/t,0.5"),
        (DepthFile::Png, "near/t,0.5"),
        (DepthFile::Npy, "z-buffer,0.5,4"),
        (DepthFile::Png, "z-buffer,0.5,inf"),
        (DepthFile::Npy, "reversed-z,0.5,inf"),
        (DepthFile::Png, "reversed-z,0.5,100"),
        (DepthFile::Npy, "linear,0,4"),
        (DepthFile::Png, "linear,4,0.5"),
    ] {
        let at = tempfile::tempdir().unwrap();
        let place = |end: &str| at.path().join(format!("a \"b\".depth.{end}"));
        let ewa = Method::by_name("ewa").unwrap();
        let convention = DepthConvention::parse(file, text).unwrap();
        convention.write(&place(file.extension()), &place("toml"), &plane).unwrap();
        let client = read(&place("toml"), ewa.stages(), [3, 2], &Exec::sequential());
        let client = client.unwrap_or_else(|error| panic!("{text}: {error}"));
        let storage = client.storage("Z");
        for (found, t) in scalars(&client, "Z").into_iter().zip(all) {
            let near = found == t || (found - t).abs() <= storage.radius(t);
            assert!(near, "{text} in {}: {found} for {t}", file.extension());
        }
    }
}

#[test]
fn conventions_and_depths_without_numbers_are_refused() {
    for (file, text, what) in [
        (DepthFile::Png, "t", "give t,SCALE, the codes for each world unit"),
        (DepthFile::Npy, "t,1000", "give t alone"),
        (DepthFile::Npy, "z", "give one of t, 1/t, near/t"),
        (DepthFile::Npy, "z-buffer,0.1", "give z-buffer,NEAR,FAR"),
        (DepthFile::Npy, "z-buffer,2,1", "near = 2 and far = 1 are impossible"),
        (DepthFile::Npy, "linear,x,1", "`x` is not a number"),
        (DepthFile::Png, "t,0", "a scale of 0"),
    ] {
        let found = DepthConvention::parse(file, text).unwrap_err();
        assert!(found.contains(what), "{found}");
    }
    let at = tempfile::tempdir().unwrap();
    let [path, toml] = ["z.png", "z.toml"].map(|name| at.path().join(name));
    // Beyond the codes, and with the code of an empty pixel.
    for (text, t) in [("t,1000", 66.0), ("t,1000", 0.0001), ("linear,0,4", 4.0), ("1/t", 0.5)] {
        let plane = Plane::filled(1, 1, t);
        let convention = DepthConvention::parse(DepthFile::Png, text).unwrap();
        let found = convention.write(&path, &toml, &plane).unwrap_err().to_string();
        assert!(found.contains(&format!("a depth of {t} cannot be told apart")), "{found}");
        assert!(!path.exists() && !toml.exists());
    }
}
