//! What transparency must keep, on pictures of scenes drawn by lot.

use crate::oracle::kit::case::Case;
use crate::oracle::kit::dice::Dice;
use crate::oracle::kit::draw::{Drawing, back_to_front};
use crate::oracle::kit::planes::{pixels, plane, value};
use crate::oracle::kit::scene::{change, groups};
use crate::oracle::transparent::Settings;
use crate::oracle::transparent::cases;
use glam::Vec3;
use splatref::composite::bins::DepthBins;
use splatref::frame::{Frame, NO_ID, Plane, Samples};
use splatref::method::single_pass::{self, BinCount};
use splatref::method::transparent::{BinEdges, Holes};
use splatref::number::Exact;
use splatref::scene::Groups;
use splatref::scene::environment::Map;
use splatref::scene::{Environment, Light, Scene};
use splatref::shade::optics::{BendingLayers, Refraction};

/// How many scenes a law is tried on.
const SCENES: usize = 48;

fn render<R: Exact>(subject: &Case<Settings>, stages: bool) -> Frame<R> {
    subject.drawing().try_define(stages).expect("renders").frame
}

fn opacities(scene: &mut Scene, alpha: f32) {
    change(scene, |cloud| cloud.opacity = Some(vec![alpha; cloud.position.len()]));
}

/// Asserts that two frames hold the same bits in these planes.
fn same<R: Exact>(a: &Frame<R>, b: &Frame<R>, planes: &[&str], name: &str) {
    for plane in planes {
        assert!(a.plane(plane).is_some(), "no plane '{plane}'");
        assert!(a.plane(plane) == b.plane(plane), "plane '{plane}': {name}");
    }
}

/// Asserts that two frames are equal up to rounding.
fn close<R: Exact>(a: &Frame<R>, b: &Frame<R>, planes: &[&str], part: f64, name: &str) {
    for plane in planes {
        for i in pixels(a) {
            for (a, b) in value(a, plane, i).into_iter().zip(value(b, plane, i)) {
                let within = a == b || (a - b).abs() <= part * a.abs().max(1.0);
                assert!(within, "plane '{plane}', pixel {i}: {a} {b}: {name}");
            }
        }
    }
}

fn white() -> Environment {
    Environment::Map(Map::new(Plane::filled(8, 4, [1.0; 3])).expect("twice as wide as high"))
}

/// Nothing shines through opaque surfels: Algorithm 3 is Algorithm 1, whatever the groups are
/// extended by.
#[test]
fn opaque_surfels_make_the_picture_of_the_single_pass() {
    fn check<R: Exact>(subject: &Case<Settings>, alone: &Groups) {
        let Case { scene, camera, name, .. } = subject;
        let depth = subject.settings.nearest.expect("Algorithm 3");
        let settings = single_pass::Settings { splats: subject.settings.splats, depth };
        let one = Drawing::new(scene, camera, settings).grouped(alone).plain::<R>();
        same(&render(subject, false), &one, &["", "A", "Z", "id", "weight"], name);
    }
    let mut tried = 0;
    for number in 0..2 * SCENES {
        let mut subject = cases::case(number);
        // A surface of a colour and no opacity is opaque, and so is one of opacity 1.
        match number % 2 {
            0 => opacities(&mut subject.scene, 1.0),
            _ => change(&mut subject.scene, |cloud| cloud.opacity = None),
        }
        // Light is bent by the part 1 - alpha alone.
        subject.settings.refraction = subject.settings.refraction.filter(|_| number % 3 == 0);
        if subject.settings.nearest.is_some() {
            let alone = groups(subject.groups().own().to_vec(), subject.groups().len());
            check::<f32>(&subject, &alone);
            check::<f64>(&subject, &alone);
            tried += 1;
        }
    }
    assert!(tried > SCENES);
}

/// Of opaque surfels Algorithm 2 shows the mean of the groups, each a surfel of its nearest bin.
#[test]
fn opaque_surfels_show_the_nearest_bin_of_each_group() {
    fn check<R: Exact>(mut subject: Case<Settings>) {
        subject.settings.nearest = None;
        subject.settings.refraction = None;
        subject.scene.environment = None;
        subject.scene.lights.clear();
        opacities(&mut subject.scene, 1.0);
        let surfels = subject.scene.surfels.len();
        subject.groups = Some(groups(vec![0; surfels], 1));
        let Case { scene, camera, settings, name, .. } = &subject;
        let frame = render::<R>(&subject, true);
        let whole = Drawing::new(scene, camera, settings.splats).frame::<R>();
        let bins = DepthBins::<R>::new(&subject.range(subject.settings.bins));
        for i in pixels(&frame) {
            let Samples::Scalar(depth) = plane(&whole, "Z") else { panic!("no scalar Z") };
            let nearest = depth.values()[i];
            let [id, ..] = value(&frame, "blended.group00.id", i);
            if !nearest.is_finite() {
                assert_eq!(id, f64::from(NO_ID), "{name}");
                continue;
            }
            let [bin, ..] = value(&frame, "blended.group00.bin", i);
            assert_eq!(bin, bins.bin(nearest).to_f64(), "pixel {i} of {name}");
            let color = match scene.surfels.color() {
                Some(all) => all[id as usize],
                None => scene.material.color,
            };
            assert_eq!(value(&frame, "", i), color.to_array().map(f64::from), "{i} of {name}");
            assert_eq!(value(&frame, "A", i), [1.0; 3], "pixel {i} of {name}");
            assert_eq!(value(&frame, "blended.opacities", i), [0.0; 3], "pixel {i} of {name}");
            assert_eq!(value(&frame, "blended.hidden", i), [1.0; 3], "pixel {i} of {name}");
        }
    }
    for number in 0..SCENES {
        check::<f32>(cases::case(number));
        check::<f64>(cases::case(number));
    }
}

/// Clear surfels leave no light, and do not change the environment by a bit.
#[test]
fn an_opacity_of_0_is_not_seen() {
    fn check<R: Exact>(mut subject: Case<Settings>) {
        opacities(&mut subject.scene, 0.0);
        subject.settings.refraction = None;
        let frame = render::<R>(&subject, false);
        let name = subject.name.clone();
        if subject.scene.environment.is_some() {
            // The same surfels, behind the camera.
            let camera = &subject.camera;
            let back = camera.view_from_world.row(2).truncate() * 1e4;
            change(&mut subject.scene, |cloud| {
                cloud.position.iter_mut().for_each(|p| *p += back);
            });
            same(&frame, &render::<R>(&subject, false), &["", "A"], &name);
            return;
        }
        let mut covered = 0;
        for i in pixels(&frame) {
            assert_eq!(value(&frame, "", i), [0.0; 3], "pixel {i} of {name}");
            assert_eq!(value(&frame, "A", i), [0.0; 3], "pixel {i} of {name}");
            covered += usize::from(value(&frame, "Z", i)[0].is_finite());
        }
        assert!(covered > 0 || subject.settings.splats.cull, "nothing there: {name}");
    }
    for number in 0..SCENES {
        check::<f32>(cases::case(number));
        check::<f64>(cases::case(number));
    }
}

/// But for the edges of their bins, if these are staggered: they go by the number of the group.
#[test]
fn the_names_of_the_groups_do_not_matter() {
    fn check<R: Exact>(number: usize, part: f64) {
        let mut subject = cases::case(number);
        subject.settings.bin_edges = BinEdges::Common;
        let before = render::<R>(&subject, true);
        let (old, count) = (subject.groups().clone(), subject.groups().len());
        let mut dice = Dice(number as u64);
        let mut names: Vec<u8> = (0..count as u8).collect();
        (1..count).rev().for_each(|i| names.swap(i, dice.below(i + 1)));
        let own = old.own().iter().map(|&g| names[usize::from(g)]).collect();
        let added = old.added().iter().map(|&(s, g)| (s, names[usize::from(g)])).collect();
        let mut scale = vec![0.0; count];
        (0..count).for_each(|g| scale[usize::from(names[g])] = old.scale()[g]);
        subject.groups = Some(Groups::new(own, added, scale).expect("the same groups"));
        let after = render::<R>(&subject, true);
        let name = subject.name.as_str();
        same(&before, &after, &["Z", "id"], name);
        for (g, other) in names.iter().enumerate() {
            for end in ["", ".A", ".opacities", ".bin", ".count", ".id"] {
                let [old, new] =
                    [g, usize::from(*other)].map(|k| format!("blended.group{k:02}{end}"));
                assert!(before.plane(&old) == after.plane(&new), "{old}: {name}");
            }
        }
        let bent = subject.settings.refraction.is_some();
        // The light of an environment can change quickly with the normal.
        let looked = if bent { 1e4 * part } else { part };
        close(&before, &after, &["blended", "A", "layers"], part, name);
        close(&before, &after, &[""], looked, name);
    }
    for number in 0..SCENES {
        check::<f32>(number, 1e-6);
        check::<f64>(number, 1e-14);
    }
}

/// In white light white surfels are not seen, whatever their opacities, groups and holes.
#[test]
fn a_white_furnace_is_white() {
    fn check<R: Exact>(number: usize, part: f64) {
        let mut subject = cases::case(number);
        let case = &mut subject;
        case.scene.environment = Some(white());
        case.scene.lights.clear();
        change(&mut case.scene, |cloud| cloud.color = Some(vec![Vec3::ONE; cloud.position.len()]));
        let name = case.name.clone();
        // With one layer whatever is not reflected or covered comes from the environment.
        let layers = BendingLayers::Single;
        let single = Refraction { ratio: [0.625, 1.0, 1.5], layers };
        let refraction = subject.settings.nearest.map(|_| single);
        for refraction in [None, refraction] {
            subject.settings.refraction = refraction;
            let frame = render::<R>(&subject, false);
            for i in pixels(&frame) {
                assert_eq!(value(&frame, "A", i), [1.0; 3], "pixel {i} of {name}");
                for light in value(&frame, "", i) {
                    assert!((light - 1.0).abs() <= part, "{light}, pixel {i} of {name}");
                }
            }
        }
    }
    for number in 0..SCENES {
        check::<f32>(number, 2e-6);
        check::<f64>(number, 4e-15);
    }
}

/// A group that leaves holes dims the picture if holes count, and only then.
#[test]
fn holes_are_skipped_or_dark() {
    for number in 0..SCENES {
        let mut subject = cases::case(number);
        let name = subject.name.clone();
        subject.settings.holes = Holes::Skipped;
        let skipped = render::<f32>(&subject, true);
        subject.settings.holes = Holes::Background;
        let counted = render::<f32>(&subject, true);
        for i in pixels(&skipped) {
            let [a, b] = [&skipped, &counted].map(|frame| value(frame, "blended.A", i)[0]);
            let groups: Vec<bool> = (0..subject.groups().len())
                .map(|k| value(&skipped, &format!("blended.group{k:02}.bin"), i)[0].is_finite())
                .collect();
            let covered = groups.iter().filter(|covers| **covers).count() as f64;
            let part = covered / groups.len() as f64;
            assert!((a * part - b).abs() <= 1e-6, "{a} {b}, pixel {i} of {name}");
        }
    }
}

/// One bin holds every depth but the farthest, if no edges are moved: each group keeps the first that it draws.
#[test]
fn in_one_bin_there_is_one_layer() {
    for number in 0..SCENES {
        let mut subject = cases::case(number);
        subject.settings.nearest = None;
        subject.settings.refraction = None;
        subject.settings.bins = BinCount::Count(1);
        subject.settings.bin_edges = BinEdges::Common;
        // Enlarged surfels leave the bins.
        subject.groups = Some(groups(subject.groups().own().to_vec(), subject.groups().len()));
        let frame = render::<f64>(&subject, true);
        let order = back_to_front(&subject.scene.surfels, &subject.camera);
        let place = |id: f64| order.iter().position(|&i| f64::from(i) == id);
        subject.settings.bins = BinCount::Count(65_535);
        let many = render::<f64>(&subject, true);
        let name = &subject.name;
        for k in 0..subject.groups().len() {
            let layer = |end: &str| format!("blended.group{k:02}.{end}");
            for i in pixels(&frame) {
                let [count, ..] = value(&frame, &layer("count"), i);
                assert!(count <= 1.0, "{count} layers, pixel {i} of {name}");
                let [first, last] = [&frame, &many].map(|f| place(value(f, &layer("id"), i)[0]));
                assert!(first <= last, "pixel {i} of {name}");
            }
        }
    }
}

/// A light changes colours alone.
#[test]
fn light_does_not_change_what_is_seen() {
    for number in 0..SCENES / 2 {
        let mut subject = cases::case(number);
        subject.settings.refraction = None;
        let lit = render::<f32>(&subject, true);
        subject.scene.lights = match subject.scene.lights.len() {
            0 => vec![Light::DEFAULT],
            _ => Vec::new(),
        };
        let other = render::<f32>(&subject, true);
        let planes = ["A", "Z", "id", "layers", "blended.A", "blended.opacities", "blended.hidden"];
        same(&lit, &other, &planes, &subject.name);
    }
}

/// What [`Scene`] says of a missing environment.
#[test]
fn without_an_environment_it_is_black() {
    let black = Map::new(Plane::filled(4, 2, [0.0; 3])).expect("twice as wide as high");
    for number in 0..SCENES {
        let mut subject = cases::case(number);
        subject.settings.refraction = None;
        subject.scene.environment = None;
        let without = render::<f32>(&subject, false);
        let environment = Some(Environment::Map(black.clone()));
        subject.scene = Scene { environment, ..subject.scene.clone() };
        let frame = render::<f32>(&subject, false);
        same(&frame, &without, &["", "Z", "id", "layers"], &subject.name);
    }
}
