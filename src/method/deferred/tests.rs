use super::*;
use crate::frame::{Exec, Frame, NO_ID, Samples};
use crate::index::seen::Seen;
use crate::method::tests::{id, scalar};
use crate::method::{Method, Session, ewa};
use crate::number::random::unit;
use crate::scene::objects::{Geometry, Motion, Object, Objects};
use crate::scene::transform::rotation;
use crate::scene::{Lens, Mipmap, Pose, Primitives, Similarity, Surfels};
use crate::source::{Shape, flatten};
use crate::splat::Epsilon;
use glam::{DVec3, Vec3};
use proptest::prelude::*;

mod polygons;

/// The input of a random test: objects that move, a camera that moves, settings.
#[derive(Clone, Debug)]
struct Case {
    scene: Scene,
    settings: Settings,
    turn: f64,
    size: [u32; 2],
    ortho: bool,
}

impl Case {
    fn camera(&self, frame: u32) -> Camera {
        let angle = self.turn * f64::from(frame);
        let eye = rotation(DVec3::Y, angle) * DVec3::new(0.5, 0.75, 4.0);
        let lens = if self.ortho { Lens::Orthographic(3.0) } else { Lens::FieldOfView(40.0) };
        let [w, h] = self.size;
        Camera::new(w, h, Pose { eye, target: DVec3::ZERO, up: DVec3::Y }, lens).unwrap()
    }

    fn scene(&self, frame: u32) -> Scene {
        let seen = |objects: &Objects| {
            let moved = objects.at(frame).unwrap();
            moved.seen_from(&self.camera(frame), &Exec::sequential()).unwrap()
        };
        Scene { objects: self.scene.objects.as_ref().map(seen), ..self.scene.clone() }
    }

    fn objects(&self, frame: u32) -> Objects {
        self.scene(frame).objects.unwrap()
    }

    /// The frames of a sequence, each with the planes of its stages, and with what the frame before
    /// saw.
    fn frames<R: Exact>(
        &self,
        frames: u32,
        mut seen: Option<Seen>,
        exec: &Exec,
    ) -> Vec<FrameAndSeen<R>> {
        let mut shown = Vec::new();
        for frame in 0..frames {
            let scene = self.scene(frame);
            let mut session = Session::new(&scene, Method::from(self.settings), exec).unwrap();
            session.resume(seen.clone());
            let picture = session.define::<R>(&self.camera(frame), true).unwrap();
            shown.push((picture.frame, seen.replace(picture.seen.unwrap())));
        }
        shown
    }
}

/// A frame, and what the one before saw.
type FrameAndSeen<R> = (Frame<R>, Option<Seen>);

/// A sphere, a torus and random discs, each in one object or in several, which move.
fn case() -> impl Strategy<Value = Case> {
    let settings = (1..90_u32, any::<bool>(), any::<bool>(), 0..3_usize, 0.0..3.0_f32);
    let shapes = (0..4_usize, 0..1000_u64, prop::collection::vec(-1.0..1.0_f64, 12));
    let view = (-9.0..9.0_f64, 1..70_u32, 1..50_u32, any::<bool>());
    (settings, shapes, view).prop_map(
        |((flags, second, cull, outline, eps), (n, seed, at), view)| {
            let (turn, w, h, ortho) = view;
            let mut splats = SplatSettings {
                cull,
                epsilon: Epsilon::MedianRadii(eps),
                ..SplatSettings::default()
            };
            splats.kernel.outline = [
                crate::splat::Outline::Affine,
                crate::splat::Outline::Perspective,
                crate::splat::Outline::RayCast,
            ][outline];
            let geometry = |name: &str, surfels: Surfels| Geometry {
                name: name.into(),
                surfels,
                primitives: Primitives::default(),
                detail: None,
            };
            // In half of the cases the sphere has levels of detail.
            let sphere = leveled(Shape::Sphere.surfels(400, seed).unwrap(), 3, seed);
            let sphere = geometry("sphere", sphere);
            let sphere = match seed % 4 {
                0 => sphere.with_detail(0.0, &Exec::sequential()).unwrap(),
                1 => sphere.with_detail(f64::from(eps), &Exec::sequential()).unwrap(),
                _ => sphere,
            };
            let geometries = vec![
                sphere,
                geometry("torus", leveled(Shape::Torus.surfels(300, seed).unwrap(), 1, seed)),
                geometry(
                    "discs",
                    crate::method::tests::surfels(60, 0.2, seed.is_multiple_of(2), seed),
                ),
            ];
            let place = |i: usize, step: f64| Similarity {
                rotation: rotation(DVec3::new(at[i], 1.0, at[i + 1]), 40.0 * step),
                scale: 0.5 + 0.4 * at[i + 2].abs(),
                translation: DVec3::new(at[i], at[i + 1], at[i + 2])
                    + step * DVec3::new(0.1, 0.0, at[i]),
            };
            let objects = (0..=n).map(|i| Object {
                name: format!("o{i}"),
                geometry: i % 3,
                motion: Motion::new(vec![(0, place(i, 0.0)), (3, place(i, 1.0))]).unwrap(),
                color: (i == 1).then_some(Vec3::new(0.75, 0.5, 0.25)),
            });
            let objects = Objects::new(geometries, objects.collect(), Vec3::splat(0.5)).unwrap();
            let scene = Scene { objects: Some(objects), ..Scene::lit("case", Surfels::none()) };
            Case {
                scene,
                settings: Settings { splats, flags, second, share: 0.0 },
                turn,
                size: [w, h],
                ortho,
            }
        },
    )
}

/// Surfels with prefiltered colours of any kind, or without.
fn leveled(surfels: Surfels, levels: u64, seed: u64) -> Surfels {
    if seed.is_multiple_of(3) {
        return surfels;
    }
    let of = |i: u64| Vec3::new(unit(seed, i), unit(seed + 1, i), 0.0);
    let colors = (0..surfels.len() as u64 * levels).map(of).collect();
    let mipmap = Mipmap::new(levels as usize, colors).unwrap();
    surfels.with_mipmap(Some(mipmap)).unwrap()
}

/// Plain `ewa` over surfels of some ids in the colours that pass 4 gives them, with the planes of its stages.
fn plain<R: Exact>(case: &Case, frame: u32, ids: &[u64], exec: &Exec) -> Option<Frame<R>> {
    let objects = case.objects(frame);
    let surfels = filter::filtered(objects.some(ids, exec), &case.camera(frame), exec);
    let scene = Scene { surfels, objects: None, ..case.scene.clone() };
    if scene.surfels.is_empty() {
        return None;
    }
    // Epsilon in units of the whole scene's median radius.
    let epsilon = case.settings.splats.epsilon.in_units(objects.median_radius());
    let settings = ewa::Settings { epsilon: Epsilon::World(epsilon), ..case.settings.splats };
    let session = Session::new(&scene, settings.into(), exec).unwrap();
    Some(session.define::<R>(&case.camera(frame), true).unwrap().frame)
}

/// The ids of a plane, ascending, each once.
fn listed<R: Exact>(frame: &Frame<R>, name: &str) -> Vec<u64> {
    let all = id(frame, name).values().iter().filter(|&&id| id != NO_ID);
    let mut ids: Vec<_> = all.map(|&id| u64::from(id)).collect();
    ids.sort_unstable();
    ids.dedup();
    ids
}

/// The surfels that pass 1 draws in a frame.
fn flagged(objects: &Objects, seen: Option<&Seen>) -> Vec<u64> {
    let drawn = objects.drawn_ids();
    let flagged = seen.map_or_else(Vec::new, |seen| seen.surfels(objects.ids()));
    flagged.into_iter().filter(|id| drawn.binary_search(id).is_ok()).collect()
}

/// Whether two planes of one kind have the same number at a pixel; planes of indices may differ.
fn same<R: Exact>(a: &Samples<R>, b: &Samples<R>, pixel: usize) -> bool {
    match (a, b) {
        (Samples::Scalar(a), Samples::Scalar(b)) => a.values()[pixel] == b.values()[pixel],
        (Samples::Color(a), Samples::Color(b)) | (Samples::Vector(a), Samples::Vector(b)) => {
            a.values()[pixel] == b.values()[pixel]
        }
        (Samples::Count(a), Samples::Count(b)) => a.values()[pixel] == b.values()[pixel],
        _ => true,
    }
}

fn laws<R: Exact>(case: &Case) -> std::result::Result<(), TestCaseError> {
    let exec = Exec::sequential();
    let shown = case.frames::<R>(4, None, &exec);
    for (i, (frame, before)) in (0_u32..).zip(&shown) {
        let objects = case.objects(i);
        let (ids, old) = (objects.ids(), flagged(&objects, before.as_ref()));
        let now = listed(frame, "indices.id");
        // A surfel has one centre.
        let kept = id(frame, "indices.id").values().iter().filter(|&&id| id != NO_ID).count();
        prop_assert_eq!(kept, now.len());
        // A frame saw the surfels that it selected.
        if let Some((_, seen)) = shown.get(i as usize + 1) {
            let found = Seen::from_selected(ids, case.settings.flags, &now);
            prop_assert_eq!(seen.as_ref(), Some(&found));
        }
        // The depth of pass 4 equals plain visibility splatting of B(i-1) and B(i).
        let mut drawn = old.clone();
        if case.settings.second {
            drawn.extend(&now);
        }
        drawn.sort_unstable();
        drawn.dedup();
        let depth = scalar(frame, "difference.Z");
        match plain::<R>(case, i, &drawn, &exec) {
            Some(plain) => {
                prop_assert_eq!(depth, scalar(&plain, "visibility.Z"));
                let own = id(&plain, "visibility.id").values().iter();
                let own = own.map(|&i| drawn.get(i as usize).map_or(NO_ID, |&id| id as u32));
                let found = id(frame, "difference.id").values();
                prop_assert!(own.eq(found.iter().copied()));
            }
            None => prop_assert!(depth.values().iter().all(|&t| t == R::INFINITY)),
        }
        // Where the nearest fragment belongs to B(i), the pixel equals plain `ewa` over B(i).
        // Without pass 3, fragments of B(i) may be nearer than the depth.
        if !case.settings.second {
            continue;
        }
        let Some(plain) = plain::<R>(case, i, &now, &exec) else { continue };
        for (pixel, nearest) in id(frame, "difference.id").values().iter().enumerate() {
            if !now.contains(&u64::from(*nearest)) {
                continue;
            }
            for plane in &plain.planes {
                let Some(own) = frame.plane(&plane.name) else { continue };
                prop_assert!(
                    same(&plane.samples, own, pixel) || plane.name.starts_with("visibility"),
                    "{} {pixel}",
                    plane.name
                );
            }
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn the_laws_hold_in_single_precision(case in case()) {
        laws::<f32>(&case)?;
    }

    #[test]
    fn the_laws_hold_in_double_precision(case in case()) {
        laws::<f64>(&case)?;
    }

    #[test]
    fn a_sequence_goes_on_from_the_state_of_any_frame(case in case(), at in 0..4_usize) {
        let exec = Exec::sequential();
        let whole = case.frames::<f32>(4, None, &exec);
        let (frame, seen) = &whole[at];
        let scene = case.scene(at as u32);
        let mut session = Session::new(&scene, case.settings.into(), &exec).unwrap();
        session.resume(seen.clone());
        let again = session.define::<f32>(&case.camera(at as u32), true).unwrap().frame;
        prop_assert_eq!(&again.planes, &frame.planes);
        // A session draws the same frame, with other threads and tiles too.
        for exec in [exec, Exec::new(3, 8).unwrap(), Exec::new(2, 64).unwrap()] {
            let mut session = Session::new(&scene, case.settings.into(), &exec).unwrap();
            session.resume(seen.clone());
            let drawn = session.render(&case.camera(at as u32)).unwrap();
            for plane in &drawn.frame.planes {
                prop_assert_eq!(Some(&plane.samples), frame.plane(&plane.name), "{}", &plane.name);
            }
            if let Some((_, next)) = whole.get(at + 1) {
                prop_assert_eq!(session.seen(), next.as_ref());
            }
        }
    }

    /// With a share, pass 1 draws no surfel of the objects that were hardly seen.
    #[test]
    fn what_was_hardly_seen_is_left_out(case in case(), share in 0.0..=1.0_f32) {
        let exec = Exec::sequential();
        let without = case.frames::<f32>(2, None, &exec);
        let before = without[1].1.clone().unwrap();
        let objects = case.objects(1);
        let few = |object: u32| {
            let all = objects.drawn(object).map_or(objects.ids().count(object).into(), |m| m.count());
            let selected = before.selected()[object as usize];
            selected > 0 && f64::from(selected) <= f64::from(share) * all as f64
        };
        let scene = case.scene(1);
        let settings = Settings { share, ..case.settings };
        let mut session = Session::new(&scene, settings.into(), &exec).unwrap();
        session.resume(Some(before.clone()));
        let frame = session.define::<f32>(&case.camera(1), true).unwrap().frame;
        let drawn = session.render(&case.camera(1)).unwrap();
        for plane in &drawn.frame.planes {
            prop_assert_eq!(Some(&plane.samples), frame.plane(&plane.name), "{}", &plane.name);
        }
        let left: Vec<bool> = (0..before.selected().len() as u32).map(few).collect();
        let first = listed(&frame, "visibility.id");
        for (object, _) in first.into_iter().filter_map(|id| objects.ids().find(id)) {
            prop_assert!(!left[object as usize]);
        }
        if !left.contains(&true) {
            prop_assert_eq!(&frame.planes, &without[1].0.planes);
        }
    }

    /// Where pass 1 leaves out every object, each frame of a still camera is the first frame.
    #[test]
    fn no_object_blinks_because_it_was_hardly_seen(case in case()) {
        let exec = Exec::sequential();
        let (scene, camera) = (case.scene(0), case.camera(0));
        let settings = Settings { share: 1.0, second: true, ..case.settings };
        let mut session = Session::new(&scene, settings.into(), &exec).unwrap();
        let mut before: Option<Picture<f32>> = None;
        for _ in 0..3 {
            let picture = session.render(&camera).unwrap().clone();
            if let Some(before) = before {
                prop_assert_eq!(&before.frame.planes, &picture.frame.planes);
                prop_assert_eq!(&before.seen, &picture.seen);
            }
            before = Some(picture);
        }
    }

    #[test]
    fn a_flat_scene_is_drawn_as_its_objects(case in case()) {
        let exec = Exec::sequential();
        let (scene, camera) = (case.scene(0), case.camera(0));
        let of = |scene: &Scene| {
            let session = Session::new(scene, case.settings.into(), &exec).unwrap();
            session.define::<f32>(&camera, true).unwrap().frame
        };
        let flat = flatten(&scene, &exec).unwrap();
        let (objects, flat) = (of(&scene), of(&Scene { objects: None, ..flat }));
        let every = scene.objects.as_ref().unwrap().drawn_ids();
        for (a, b) in objects.planes.iter().zip(&flat.planes) {
            match (&a.samples, &b.samples) {
                (Samples::Index(a), Samples::Index(b)) => {
                    let named = b.values().iter().map(|&i| every.get(i as usize));
                    let named = named.map(|id| id.map_or(NO_ID, |&id| id as u32));
                    prop_assert!(named.eq(a.values().iter().copied()));
                }
                (one, other) => prop_assert_eq!(one, other, "{}", &a.name),
            }
        }
    }
}
