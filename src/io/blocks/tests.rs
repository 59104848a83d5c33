use super::*;
use crate::Result;
use crate::frame::{Exec, Frame, Rect};
use crate::io::ply;
use crate::io::scene_file::{Ready, SceneFile};
use crate::method::buffer_formats::{Buffers, Formats};
use crate::method::{Method, Session};
use crate::number::random::below;
use crate::scene::{Cloud, Scene, Surfels, hash};
use crate::source::Shape;
use glam::Vec3;
use sha2::digest::common::hazmat::SerializableState;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

fn exec() -> Exec {
    Exec::new(2, 32).unwrap()
}

fn tile(from: &Path, to: &Path) -> Result<Tiled> {
    SceneFile::open(from)?.tile(to, &exec(), &|_, _, _| ())
}

fn tiled(at: &Path, name: &str) -> Tiled {
    fs::create_dir_all(at.join("tiled")).unwrap();
    tile(&at.join(format!("{name}.ply")), &at.join("tiled").join(name)).unwrap()
}

/// A change of a file.
type Change = fn(&mut Cloud);

/// Surfels with every attribute, in no spatial order, some of which are no surfels.
fn cloud(count: usize) -> Cloud {
    let mut cloud = Shape::Torus.surfels(count, 0).unwrap().into_cloud();
    let n = cloud.position.len();
    for i in 0..n {
        let other = below(5, i as u64, n as u64) as usize;
        cloud.position.swap(i, other);
        cloud.normal.as_mut().unwrap().swap(i, other);
    }
    let random = |i: usize, k: u64| below(k, i as u64, 1000) as f32 / 1000.0;
    cloud.radius = Some((0..n).map(|i| 0.02 + 0.02 * random(i, 1)).collect());
    cloud.color = Some((0..n).map(|i| Vec3::new(random(i, 2), random(i, 3), 0.5)).collect());
    cloud.opacity = Some((0..n).map(|i| random(i, 4)).collect());
    let axes = |(n, i): (&Vec3, usize)| {
        let u = n.any_orthonormal_vector() * (0.02 + 0.02 * random(i, 6));
        [u, n.cross(u) * 0.7]
    };
    cloud.tangents = Some(cloud.normal.as_ref().unwrap().iter().zip(0..).map(axes).collect());
    cloud.position[3] = Vec3::NAN;
    cloud.normal.as_mut().unwrap()[n / 2] = Vec3::ZERO;
    cloud.radius.as_mut().unwrap()[n - 1] = -1.0;
    cloud.normal.as_mut().unwrap()[7] *= 3.0;
    cloud
}

fn ready(path: &Path, method: Method, parts: bool) -> Ready {
    let mut file = SceneFile::open(path).unwrap();
    file.camera.size = Some([70, 50]);
    file.method.replace(method.name()).unwrap();
    let ready = if parts {
        file.ready_in_parts(&exec(), &|_, _, _| ())
    } else {
        file.ready(&exec(), &|_, _, _| ())
    };
    ready.unwrap()
}

/// The pictures of a region: drawn, defined with all stages, in f64, and in another buffer format.
fn pictures(scene: &Scene, ready: &Ready, region: Rect) -> [Frame<f32>; 4] {
    let exec = exec();
    let mut session = Session::new(scene, ready.method, &exec).unwrap();
    session.set_region(Some(region)).unwrap();
    let formats = Formats { buffers: Buffers::F16, ..Formats::default() };
    [
        session.define::<f32>(&ready.camera, true).unwrap().frame,
        session.define::<f64>(&ready.camera, false).unwrap().frame.to_f32(),
        session.emulate(&ready.camera, formats, true).unwrap().frame,
        session.render(&ready.camera).unwrap().frame.clone(),
    ]
}

#[test]
fn a_part_draws_every_bit_of_the_whole() {
    let at = TempDir::new().unwrap();
    for (name, change) in [
        ("all", (|_| ()) as Change),
        ("bare", |c| (c.color, c.opacity, c.tangents) = (None, None, None)),
    ] {
        let mut cloud = cloud(9000);
        change(&mut cloud);
        let path = at.path().join(format!("{name}.ply"));
        ply::write(&path, &cloud).unwrap();
        let report = tiled(at.path(), name);
        let folder = at.path().join("tiled").join(name);
        for method in Method::all() {
            let (whole, parts) = (ready(&path, method, false), ready(&folder, method, true));
            let scene = &whole.loaded.scene;
            assert_eq!((report.surfels, report.dropped), (scene.surfels.len() as u64, 3));
            assert_eq!(parts.loaded.scene.sha256(), scene.sha256(), "{}", method.name());
            assert_eq!(parts.loaded.scene.bounds(), scene.bounds());
            assert_eq!(parts.camera, whole.camera);
            if method.skirt().is_none() {
                assert_eq!(parts.loaded.scene.surfels, scene.surfels, "all is read");
                assert!(parts.part(None, &exec()).unwrap().is_none());
                continue;
            }
            assert!(parts.loaded.scene.surfels.is_empty(), "nothing is read yet");
            for region in [
                Rect::of_size([70, 50]),
                Rect { x0: 0, y0: 0, x1: 9, y1: 7 },
                Rect { x0: 30, y0: 10, x1: 43, y1: 21 },
                Rect { x0: 69, y0: 49, x1: 70, y1: 50 },
            ] {
                let part = parts.part(Some(region), &exec()).unwrap().unwrap();
                let ids = part.excerpt.as_ref().unwrap().ids();
                let indices: Vec<u64> = ids.iter().map(|&id| id.into()).collect();
                let some = scene.surfels.some(&indices, &exec());
                assert_eq!(part.surfels.position(), some.position());
                assert_eq!(part.sha256(), scene.sha256());
                assert_eq!(
                    pictures(&part, &parts, region),
                    pictures(scene, &whole, region),
                    "{name} {} {region:?}",
                    method.name()
                );
            }
        }
        // Far from all surfels: an empty scene, with the planes of the whole.
        let corner = Rect { x0: 0, y0: 0, x1: 1, y1: 1 };
        let parts = ready(&folder, Method::default(), true);
        let part = parts.part(Some(corner), &exec()).unwrap().unwrap();
        assert!(part.surfels.len() < 2000, "{}", part.surfels.len());
    }
}

#[test]
fn a_block_bounds_its_surfels() {
    let at = TempDir::new().unwrap();
    ply::write(&at.path().join("a.ply"), &cloud(5000)).unwrap();
    let report = tiled(at.path(), "a");
    let index = Blocks::open(&at.path().join("tiled/a")).unwrap().index;
    assert_eq!(report.blocks as usize, index.blocks.len());
    let bytes = fs::read(at.path().join("tiled/a/blocks")).unwrap();
    let mut first = index.to_bytes().len();
    let mut seen = vec![];
    for block in &index.blocks {
        let surfels = &bytes[first..][..block.count as usize * index.kind.size()];
        first += surfels.len() + 4;
        for surfel in surfels.chunks(index.kind.size()) {
            let number = |i: usize| f32::from_le_bytes(*surfel[4 * i..].first_chunk().unwrap());
            let vector = |i: usize| Vec3::new(number(i), number(i + 1), number(i + 2));
            let (p, radius, [u, v]) = (vector(1), number(7), [vector(12), vector(15)]);
            assert!(p.cmpge(block.bounds[0]).all() && p.cmple(block.bounds[1]).all());
            let reach = u.as_dvec3().length_squared() + v.as_dvec3().length_squared();
            assert!(f64::from(block.reach) > reach.sqrt() && block.reach > radius);
            seen.push(u32::from_le_bytes(*surfel.first_chunk().unwrap()));
        }
    }
    assert_eq!(first, bytes.len());
    seen.sort_unstable();
    assert_eq!(seen, (0..report.surfels as u32).collect::<Vec<_>>());
}

#[test]
fn one_place_one_surfel_and_equal_radii_are_tiled() {
    let at = TempDir::new().unwrap();
    for count in [1, 1023, 1024, 1025, 2050] {
        let cloud = Cloud {
            position: vec![Vec3::new(1.0, 2.0, 3.0); count],
            normal: Some(vec![Vec3::X; count]),
            radius: Some(vec![0.5; count]),
            ..Cloud::default()
        };
        ply::write(&at.path().join("a.ply"), &cloud).unwrap();
        assert_eq!(tiled(at.path(), "a").blocks as usize, count.div_ceil(SURFELS));
        let read = Blocks::open(&at.path().join("tiled/a")).unwrap().read().unwrap();
        assert_eq!(read, cloud);
    }
}

#[test]
fn what_a_file_lacks_is_derived_once() {
    let at = TempDir::new().unwrap();
    let quad = |c: &mut Cloud| {
        let square = |i: usize| Vec3::new((i / 20) as f32, (i % 20) as f32, 0.0);
        c.position = (0..400).map(square).collect();
        c.triangles = (0..379).filter(|i| i % 20 != 19).map(|i| [i, i + 20, i + 1]).collect();
        c.normal = None;
        c.radius = None;
        c.color = None;
    };
    let changes: [Change; 4] =
        [|c| c.normal = None, |c| c.radius = None, |c| (c.normal, c.radius) = (None, None), quad];
    for change in changes {
        let mut cloud = Shape::Sphere.surfels(400, 0).unwrap().into_cloud();
        change(&mut cloud);
        let path = at.path().join("a.ply");
        ply::write(&path, &cloud).unwrap();
        tiled(at.path(), "a");
        let method = Method::default();
        let folder = at.path().join("tiled/a");
        let (whole, parts) = (ready(&path, method, false), ready(&folder, method, true));
        let scene = &whole.loaded.scene;
        let part = parts.part(None, &exec()).unwrap().unwrap();
        assert_eq!(part.sha256(), scene.sha256());
        assert_eq!(ready(&folder, method, false).loaded.scene.surfels, scene.surfels);
        let region = Rect::of_size([70, 50]);
        assert_eq!(pictures(&part, &parts, region), pictures(scene, &whole, region));
    }
}

#[test]
fn what_cannot_be_tiled_is_refused_with_the_reason() {
    let at = TempDir::new().unwrap();
    let path = at.path().join("a.ply");
    let cases: [(Change, &str); 3] = [
        (|c| c.radius = Some(vec![0.0; c.position.len()]), "none of its points"),
        (
            |c| {
                let own = vec![0; c.position.len()];
                c.groups = crate::scene::Groups::new(own, vec![], vec![1.0]).ok();
            },
            "groups cannot be tiled",
        ),
        (
            |c| {
                c.color = Some(vec![Vec3::ONE; c.position.len()]);
                c.mipmap = crate::scene::Mipmap::new(1, vec![Vec3::ONE; c.position.len()]).ok();
            },
            "prefiltered colours",
        ),
    ];
    for (change, words) in cases {
        let mut cloud = Shape::Sphere.surfels(30, 0).unwrap().into_cloud();
        change(&mut cloud);
        ply::write(&path, &cloud).unwrap();
        let error = tile(&path, &at.path().join("out")).unwrap_err();
        assert!(error.to_string().contains(words), "{error}");
    }
    let whole = Shape::Sphere.surfels(30, 0).unwrap().into_cloud();
    ply::write(&path, &whole).unwrap();
    let bytes = fs::read(&path).unwrap();
    for bytes in [&bytes[..bytes.len() - 1], &[&bytes[..], &[0]].concat()] {
        fs::write(&path, bytes).unwrap();
        tile(&path, &at.path().join("out")).unwrap_err();
    }
    tile(Path::new("tree"), &at.path().join("out")).unwrap_err();
    assert!(!at.path().join("out").exists());
}

#[test]
fn every_changed_byte_is_noticed() {
    let at = TempDir::new().unwrap();
    ply::write(&at.path().join("a.ply"), &cloud(1500)).unwrap();
    tiled(at.path(), "a");
    let folder = at.path().join("tiled/a");
    let file = folder.join("blocks");
    let bytes = fs::read(&file).unwrap();
    let opened = Blocks::open(&folder).unwrap();
    let read = || Blocks::open(&folder)?.read();
    for k in 0..300 {
        // All bytes of the first fields, then some of the rest.
        let i = if k < 140 { k } else { below(1, k as u64, bytes.len() as u64) as usize };
        let mut changed = bytes.clone();
        changed[i] ^= 1 << (k % 8);
        fs::write(&file, &changed).unwrap();
        let line = read().unwrap_err().to_string();
        assert!(line.contains("blocks: ") && !line.contains('\n'), "byte {i}: {line}");
        fs::write(&file, &bytes[..i]).unwrap();
        let line = read().unwrap_err().to_string();
        assert!(line.contains("truncated"), "{i} bytes: {line}");
        opened.read().unwrap_err();
    }
    // Another scene of as many bytes takes the place of the one that was opened.
    let mut other = cloud(1500);
    other.radius.as_mut().unwrap()[0] *= 2.0;
    ply::write(&at.path().join("a.ply"), &other).unwrap();
    tiled(at.path(), "a");
    let line = opened.read().unwrap_err().to_string();
    assert!(line.contains("was replaced"), "{line}");
    read().unwrap();
}

#[test]
fn two_writers_leave_the_blocks_of_one() {
    let at = TempDir::new().unwrap();
    for (name, count) in [("a", 3000), ("b", 4000)] {
        let cloud = Shape::Torus.surfels(count, 0).unwrap().into_cloud();
        ply::write(&at.path().join(format!("{name}.ply")), &cloud).unwrap();
    }
    let folder = at.path().join("out");
    let sizes = std::thread::scope(|scope| {
        let write = |name: &'static str| {
            let (path, folder) = (at.path().join(name), &folder);
            scope.spawn(move || tile(&path, folder).unwrap().surfels)
        };
        let all: Vec<_> = ["a.ply", "b.ply", "a.ply"].map(write).into();
        all.into_iter().map(|one| one.join().unwrap()).collect::<Vec<_>>()
    });
    let cloud = Blocks::open(&folder).unwrap().read().unwrap();
    assert!(sizes.contains(&(cloud.position.len() as u64)));
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1, "nothing else is left");
}

/// The layout is the crate's own: 32 bytes of state, then the rest of a block.
#[test]
fn the_state_of_the_hash_has_the_documented_bytes() {
    let surfels = Surfels::none();
    let mut state = hash::begin(0);
    (0..hash::ATTRIBUTES).for_each(|i| hash::part(&mut state, i, &surfels));
    let bytes = state.serialize();
    let first: [u32; 8] = [
        0x6a09_e667,
        0xbb67_ae85,
        0x3c6e_f372,
        0xa54f_f53a,
        0x510e_527f,
        0x9b05_688c,
        0x1f83_d9ab,
        0x5be0_cd19,
    ];
    let words: Vec<u8> = first.iter().flat_map(|word| word.to_le_bytes()).collect();
    assert_eq!(bytes[..32], words);
    assert_eq!(bytes[32..40], 0_u64.to_le_bytes(), "no block is full");
    assert_eq!(bytes.len(), 104);
    assert_eq!(bytes[40], 25, "bytes of the block that is not full");
    assert_eq!(&bytes[41..58], b"splatref scene 1\n");
}
