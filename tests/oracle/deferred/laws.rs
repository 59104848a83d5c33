//! Laws: places and motion, and what a frame is given.

use crate::oracle::deferred::cases::{Sequence, sequence};
use crate::oracle::deferred::ids::Numbers;
use crate::oracle::deferred::place::{Place, Thing, World, apart, similarity};
use crate::oracle::kit::dice::Dice;
use crate::oracle::kit::draw::Drawing;
use crate::oracle::kit::planes::{bits, digest, plane};
use crate::oracle::kit::scene::surfels;
use glam::{DVec3, Vec3};
use proptest::prelude::*;
use splatref::frame::{Exec, Frame, NO_ID, Samples};
use splatref::index::seen::Seen;
use splatref::method::deferred::Settings;
use splatref::method::{Picture, Session};
use splatref::number::Exact;
use splatref::scene::objects::Motion;
use splatref::scene::{Camera, Scene, Similarity, Surfels};
use splatref::splat::{Epsilon, SplatSettings};

/// How many units of the last place two numbers are apart, of those of the larger of a vector.
fn ulps(a: &[f32], b: &[f32]) -> f64 {
    let largest = a.iter().fold(f32::MIN_POSITIVE, |m, v| m.max(v.abs()));
    let unit = f64::from(largest.next_up()) - f64::from(largest);
    a.iter().zip(b).map(|(a, b)| (f64::from(*a) - f64::from(*b)).abs() / unit).fold(0.0, f64::max)
}

/// All numbers of surfels, a list a surfel and attribute.
pub(crate) fn all(surfels: &Surfels) -> Vec<Vec<f32>> {
    let mut all: Vec<Vec<f32>> = Vec::new();
    let mut add = |of: &[Vec3]| all.extend(of.iter().map(|v| v.to_array().to_vec()));
    add(surfels.position());
    add(surfels.normal());
    surfels.color().into_iter().for_each(&mut add);
    surfels.tangents().into_iter().for_each(|pairs| add(pairs.as_flattened()));
    all.push(surfels.radius().to_vec());
    all.extend(surfels.opacity().map(<[f32]>::to_vec));
    all
}

#[test]
fn deferred_surfels_are_placed_by_the_pages() {
    let (mut same, mut other, mut worst) = (0_u64, 0_u64, 0.0_f64);
    for sequence in (0..72).map(sequence) {
        let world = &sequence.world;
        let every = Numbers::new(&world.counts()).expect("ids").every();
        for (frame, ..) in &sequence.frames {
            let objects = world.objects().at(*frame).expect("in range");
            assert_eq!(objects.median_radius(), world.median(*frame), "{}", sequence.name);
            let (found, _) = objects.flattened(&Exec::sequential()).expect("few");
            let expected = surfels(world.placed(*frame, &every));
            assert_eq!(found.len(), expected.len());
            let (found, expected) = (all(&found), all(&expected));
            assert_eq!(found.len(), expected.len(), "{}: attributes", sequence.name);
            // Of an object between keys sin and atan2 are another library's.
            let keyed = world.objects.iter().all(|o| {
                let (first, last) = (o.keys[0].0, o.keys[o.keys.len() - 1].0);
                let at_key = o.keys.iter().any(|(key, _)| key == frame);
                at_key || *frame < first || *frame > last
            });
            for (a, b) in found.iter().zip(&expected) {
                if a == b {
                    same += 1;
                    continue;
                }
                assert!(!keyed, "frame {frame} of {}: {a:?} for {b:?}", sequence.name);
                other += 1;
                worst = worst.max(ulps(a, b));
            }
        }
    }
    println!("{same} as expected, {other} not, by up to {worst} ulp");
    assert!(worst <= 1.0 && other * 1000 < same, "{other} of {same}, {worst} ulp");
}

fn any_place(dice: &mut Dice) -> Similarity {
    let by = dice.vector(Vec3::splat(-9.0), Vec3::splat(9.0)).as_dvec3();
    let degrees = [0.0, 90.0, 180.0, dice.within(-180.0, 180.0).into(), 1e-7][dice.below(5)];
    let axis = if dice.below(2) == 0 { dice.axis() } else { dice.direction() };
    similarity(axis.as_dvec3(), degrees, dice.within(0.1, 4.0).into(), by)
}

fn same_bits(a: &Similarity, b: &Similarity) -> bool {
    let bits = |s: &Similarity| {
        let rest = [s.scale, s.translation.x, s.translation.y, s.translation.z];
        s.rotation.to_cols_array().into_iter().chain(rest).map(f64::to_bits).collect::<Vec<_>>()
    };
    bits(a) == bits(b)
}

#[test]
fn deferred_motions_pass_through_their_keys() {
    let (mut dice, mut worst) = (Dice(77), 0.0_f64);
    for _ in 0..400 {
        let mut frame = dice.below(3) as u32;
        let mut keys = Vec::new();
        for _ in 0..=dice.below(4) {
            keys.push((frame, any_place(&mut dice)));
            frame += 1 + dice.below(7) as u32;
        }
        let motion = Motion::new(keys.clone()).expect("keys ascend");
        for (key, place) in &keys {
            assert!(same_bits(&motion.at(*key), place), "at the key {key} of {keys:?}");
        }
        let last = keys[keys.len() - 1];
        assert!(same_bits(&motion.at(0), &keys[0].1) || keys[0].0 == 0);
        assert!(same_bits(&motion.at(last.0 + 1), &last.1), "after the last key");
        assert!(same_bits(&motion.at(u32::MAX), &last.1), "after the last key");
        for frame in 0..frame {
            let (own, found) = (Place::at(&keys, frame), motion.at(frame));
            found.check().expect("a similarity");
            let off = apart(&own, &found);
            assert!(off <= 1e-14, "frame {frame} of {keys:?}: {found:?} for {own:?}");
            worst = worst.max(off);
        }
    }
    println!("worst {worst:e}");
}

#[test]
fn deferred_turns_about_one_axis_are_even() {
    let mut dice = Dice(78);
    for _ in 0..200 {
        let (axis, start) = (dice.direction().as_dvec3(), any_place(&mut dice));
        // Up to half a turn in 8 frames, the shorter way.
        let degrees: f64 = dice.within(-179.0, 179.0).into();
        let turned = |part: f64| {
            let turn = similarity(axis, degrees * part, 1.0, DVec3::ZERO).rotation;
            Similarity { rotation: turn * start.rotation, ..start }
        };
        let motion = Motion::new(vec![(0, start), (8, turned(1.0))]).expect("two keys");
        for frame in 1..8 {
            let (own, found) = (turned(f64::from(frame) / 8.0), motion.at(frame));
            let off = (own.rotation - found.rotation).to_cols_array().map(f64::abs);
            // Near half a turn the direction of the turn is known to fewer digits.
            let worst = off.into_iter().fold(0.0, f64::max);
            assert!(worst < 1e-12, "{frame} of a turn by {degrees} degrees: {worst:e}");
        }
    }
}

/// One frame of a sequence.
fn drawn<R: Exact>(
    (scene, settings): (&Scene, Settings),
    camera: &Camera,
    seen: Option<Seen>,
    exec: &Exec,
) -> Picture<R> {
    let mut session = Session::new(scene, settings.into(), exec).expect("a session");
    session.resume(seen);
    session.define(camera, true).expect("renders")
}

/// What the frame before the last of a sequence saw, in a chain from the first.
fn chain(sequence: &Sequence) -> Option<Seen> {
    let (exec, mut seen) = (Exec::sequential(), None);
    for (frame, camera, _) in &sequence.frames[..sequence.frames.len() - 1] {
        let scene = sequence.scene(*frame);
        seen = drawn::<f32>((&scene, sequence.settings), camera, seen, &exec).seen;
    }
    seen
}

/// The scene of the last frame, and its camera.
fn last(sequence: &Sequence) -> (Scene, &Camera) {
    let (frame, camera, _) = &sequence.frames[sequence.frames.len() - 1];
    (sequence.scene(*frame), camera)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn deferred_a_frame_depends_on_flags_alone(number in any::<u64>()) {
        let (sequence, exec) = (sequence(number), Exec::sequential());
        let (seen, (scene, camera)) = (chain(&sequence), last(&sequence));
        let of = (&scene, sequence.settings);
        let whole = drawn::<f32>(of, camera, seen.clone(), &exec);
        // Another selection with the same flags: the first surfel of each group that has one.
        let numbers = Numbers::new(&sequence.world.counts()).expect("ids");
        let m = sequence.settings.flags;
        let known = |&(o, s): &(usize, u32)| seen.as_ref().is_some_and(|seen| seen.has(o as u32, s));
        let firsts = numbers.every().into_iter().filter(|of| known(of) && of.1.is_multiple_of(m));
        let firsts: Vec<_> = firsts.map(|(o, s)| numbers.id(o, s)).collect();
        let ids = sequence.world.objects().ids().clone();
        let other = drawn::<f32>(of, camera, Some(Seen::from_selected(&ids, m, &firsts)), &exec);
        prop_assert!(digest(&whole.frame) == digest(&other.frame), "{}", sequence.name);
        prop_assert_eq!(&whole.seen, &other.seen);
        // No flags are those of the first frame.
        let nothing = drawn::<f32>(of, camera, Some(Seen::nothing(&ids, m)), &exec);
        let first = drawn::<f32>(of, camera, None, &exec);
        prop_assert!(digest(&nothing.frame) == digest(&first.frame), "{}", sequence.name);
        // Neither threads nor tiles can be seen.
        for (threads, tile) in [(3, 8), (2, 64)] {
            let exec = Exec::new(threads, tile).expect("in range");
            let again = drawn::<f32>(of, camera, seen.clone(), &exec);
            prop_assert!(digest(&whole.frame) == digest(&again.frame), "{}", sequence.name);
            prop_assert_eq!(&whole.seen, &again.seen);
        }
    }

    #[test]
    fn deferred_a_session_carries_what_its_frames_saw(number in any::<u64>()) {
        let (sequence, exec) = (sequence(number), Exec::sequential());
        let scene = sequence.scene(sequence.frames[0].0);
        let mut session = Session::new(&scene, sequence.settings.into(), &exec).expect("a session");
        prop_assert!(session.seen().is_none());
        let mut seen = None;
        for (_, camera, _) in &sequence.frames {
            let own = drawn::<f32>((&scene, sequence.settings), camera, seen, &exec);
            let held = session.define::<f64>(camera, false).expect("renders");
            prop_assert!(held.seen.is_some());
            let picture = session.render(camera).expect("renders");
            for plane in &picture.frame.planes {
                let same = own.frame.plane(&plane.name).map(bits);
                prop_assert!(same == Some(bits(&plane.samples)), "'{}'", plane.name);
            }
            prop_assert_eq!(picture.tally, own.tally);
            seen = own.seen;
            prop_assert_eq!(session.seen(), seen.as_ref());
        }
    }

    #[test]
    fn deferred_passes_have_the_bits_of_ewa(number in any::<u64>()) {
        let (sequence, exec) = (sequence(number), Exec::sequential());
        let (scene, camera) = last(&sequence);
        let objects = scene.objects.as_ref().expect("objects");
        let epsilon = sequence.settings.splats.epsilon.in_units(objects.median_radius());
        let numbers = Numbers::new(&sequence.world.counts()).expect("ids");
        let every: Vec<_> = numbers.every().iter().map(|&(o, s)| numbers.id(o, s)).collect();
        // Every flag: pass 1 is visibility splatting of all.
        let m = sequence.settings.flags;
        let seen = Seen::from_selected(objects.ids(), m, &every);
        let own = drawn::<f32>((&scene, sequence.settings), camera, Some(seen), &exec).frame;
        let (flat, _) = objects.flattened(&exec).expect("few");
        let draw = |indices: &[u64], epsilon: f32| {
            let scene = Scene { surfels: flat.some(indices, &Exec::sequential()), ..sequence.around.clone() };
            let splats =
                SplatSettings { epsilon: Epsilon::World(epsilon), ..sequence.settings.splats };
            Drawing::new(&scene, camera, splats).frame::<f32>()
        };
        let ids = |frame: &Frame<f32>, name: &str, of: &[u64]| -> Vec<u32> {
            let Samples::Index(plane) = plane(frame, name) else { panic!("no ids") };
            let id = |i: &u32| if *i == NO_ID { NO_ID } else { of[*i as usize] as u32 };
            plane.values().iter().map(id).collect()
        };
        let whole: Vec<u64> = (0..every.len() as u64).collect();
        let plain = draw(&whole, epsilon);
        let same = |a: &Frame<f32>, b: &Frame<f32>, name| bits(plane(a, name)) == bits(plane(b, name));
        prop_assert!(same(&own, &plain, "visibility.Z"), "{}", sequence.name);
        let Samples::Index(found) = plane(&own, "visibility.id") else { panic!("no ids") };
        prop_assert_eq!(found.values(), ids(&plain, "visibility.id", &every), "{}", sequence.name);
        // Pass 3 then has nothing to draw.
        prop_assert!(bits(plane(&own, "difference.Z")) == bits(plane(&own, "visibility.Z")));

        // Everything in the sums: pass 4 is attribute splatting of B(i), depth or none.
        let mut settings = sequence.settings;
        settings.splats.epsilon = Epsilon::World(f32::INFINITY);
        let own = drawn::<f32>((&scene, settings), camera, None, &exec).frame;
        let mut chosen: Vec<u64> = (0..every.len() as u64).collect();
        let Samples::Index(kept) = plane(&own, "indices.id") else { panic!("no ids") };
        chosen.retain(|i| kept.values().contains(&(every[*i as usize] as u32)));
        if !chosen.is_empty() {
            let plain = draw(&chosen, f32::INFINITY);
            for name in ["attributes.weight", "attributes.normal", "attributes.count", "weight", "Z", ""] {
                prop_assert!(same(&own, &plain, name), "'{}' of {}", name, sequence.name);
            }
        }
    }
}

#[test]
fn deferred_what_another_scene_saw_is_refused() {
    let (sequence, exec) = (sequence(5), Exec::sequential());
    let (scene, camera) = last(&sequence);
    let ids = sequence.world.objects().ids().clone();
    let m = sequence.settings.flags;
    let render = |seen: Seen| {
        let mut session = Session::new(&scene, sequence.settings.into(), &exec).expect("a session");
        session.resume(Some(seen));
        session.render(camera).map(|_| ()).map_err(|error| error.to_string())
    };
    assert!(render(Seen::nothing(&ids, m)).is_ok());
    let groups = render(Seen::nothing(&ids, m + 1));
    assert!(groups.is_err(), "groups of another size");
    let more: Vec<_> = sequence.world.counts().iter().map(|n| n + 1).collect();
    let other = splatref::scene::objects::Ids::new(more, |_| String::new()).expect("ids");
    assert!(render(Seen::nothing(&other, m)).is_err(), "other objects");
}

#[test]
fn deferred_surfels_without_objects_are_one_object() {
    let exec = Exec::sequential();
    for sequence in (0..12).map(sequence) {
        let frame = &sequence.frames[0].0;
        let (surfels, _) =
            sequence.scene(*frame).objects.expect("objects").flattened(&exec).expect("few");
        let thing = Thing { geometry: 0, keys: vec![(0, Similarity::IDENTITY)], color: None };
        let world = World {
            geometries: vec![surfels.clone()],
            whole: Vec::new(),
            objects: vec![thing],
            fill: Vec3::ONE,
        };
        let one = Scene { objects: Some(world.objects()), ..sequence.around.clone() };
        let plain = Scene { surfels, ..sequence.around.clone() };
        let [mut seen, mut plain_seen] = [None, None];
        for (_, other, _) in &sequence.frames[..2] {
            let a = drawn::<f64>((&one, sequence.settings), other, seen, &exec);
            let b = drawn::<f64>((&plain, sequence.settings), other, plain_seen, &exec);
            assert!(digest(&a.frame) == digest(&b.frame), "{}", sequence.name);
            assert_eq!((a.tally, &a.seen), (b.tally, &b.seen), "{}", sequence.name);
            (seen, plain_seen) = (a.seen, b.seen);
        }
    }
}
