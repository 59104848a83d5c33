use super::*;
use crate::scene::objects::Split;
use crate::verdict::Fault;

/// The frames of a sequence whose ids have 40 bits; the highest 8 are the object.
fn frames(sequence: &Sequence, exec: &Exec) -> Vec<DrawnFrame> {
    let mut before: Option<Seen> = None;
    let of_frame = |DrawnFrame { scene, camera, .. }: DrawnFrame| {
        let objects = scene.objects.as_ref().unwrap().split_as(Split::Stencil(32)).unwrap();
        assert!(objects.ids().is_wide());
        let scene = Scene { objects: Some(objects), ..scene };
        let mut session = Session::new(&scene, sequence.method(), exec).unwrap();
        session.resume(before.clone());
        let picture = session.define::<f32>(&camera, true).unwrap();
        let given = std::mem::replace(&mut before, picture.seen);
        drop(session);
        DrawnFrame { scene, camera, before: given, frame: picture.frame }
    };
    sequence.frames::<f32>(exec).into_iter().map(of_frame).collect()
}

/// The complete ids of two planes.
fn complete(frame: &Frame<f32>, of: &str) -> Vec<u64> {
    let low = id(frame, &format!("{of}id")).values();
    let Some(Samples::Count(high)) = frame.plane(&format!("{of}stencil")) else { panic!("{of}") };
    let wide = |(&low, &high): (&u32, &u8)| match low {
        NO_ID => (high == 0).then_some(u64::MAX).unwrap(),
        low => u64::from(high) << 32 | u64::from(low),
    };
    low.iter().zip(high.values()).map(wide).collect()
}

const PLANES: [&str; 4] = ["visibility.", "indices.", "difference.", ""];

/// Both planes together name the same surfel as 32 bits do with another split. All other planes are
/// the same.
#[test]
fn ids_of_40_bits_have_a_plane_for_the_highest() {
    let exec = Exec::new(1, 16).unwrap();
    for sequence in sequences() {
        let narrow = sequence.frames::<f32>(&exec);
        for (narrow, wide) in narrow.iter().zip(frames(&sequence, &exec)) {
            let ids = [narrow, &wide].map(|shown| shown.scene.objects.as_ref().unwrap().ids());
            for of in PLANES {
                assert!(narrow.frame.plane(&format!("{of}stencil")).is_none());
                let low = id(&narrow.frame, &format!("{of}id")).values();
                for (&id, wide) in low.iter().zip(complete(&wide.frame, of)) {
                    let found = (id != NO_ID).then(|| ids[0].find(id.into()).unwrap());
                    assert_eq!(ids[1].find(wide), found, "{of}");
                }
            }
            let same = |plane: &&NamedPlane<f32>| {
                !plane.name.ends_with("id") && !plane.name.ends_with("stencil")
            };
            let planes = |frame: &Frame<f32>| -> Vec<_> {
                frame.planes.iter().filter(same).cloned().collect()
            };
            assert_eq!(planes(&narrow.frame), planes(&wide.frame));
        }
    }
}

#[test]
fn ids_of_40_bits_are_judged() {
    let exec = Exec::new(1, 16).unwrap();
    for sequence in sequences() {
        let (method, frames) = (sequence.method(), frames(&sequence, &exec));
        let shown = &frames[2];
        let doubles = shown.in_doubles(method);
        for frame in [&shown.frame, &doubles] {
            let found = shown.judge(method, frame, Rounding::Gpu);
            assert_eq!((wrong(&found), found.outcome()), (None, Outcome::Right));
            let judged =
                |stage: &crate::verdict::StageVerdict| stage.planes.contains(&"indices.id");
            assert!(found.stages.iter().any(judged));
            // Without the highest bits, ids are not judged, but all else is.
            let left = |plane: &&NamedPlane<f32>| !plane.name.ends_with("stencil");
            let planes = frame.planes.iter().filter(left).cloned().collect();
            let found = shown.judge(method, &Frame { planes, ..*frame }, Rounding::Gpu);
            assert_eq!(wrong(&found), None);
            assert!(!found.stages.iter().any(judged));
        }
    }
}

#[test]
fn a_wrong_object_in_the_highest_bits_is_found() {
    let exec = Exec::new(1, 16).unwrap();
    let sequence = &sequences()[0];
    let (method, frames) = (sequence.method(), frames(sequence, &exec));
    let shown = &frames[2];
    for of in &PLANES[..3] {
        let name = format!("{of}stencil");
        let mut frame = shown.frame.clone();
        let at = id(&frame, &format!("{of}id")).values().iter().position(|&id| id != NO_ID);
        for plane in frame.planes.iter_mut().filter(|plane| plane.name == name) {
            let Samples::Count(high) = &mut plane.samples else { panic!("{name}") };
            high.values_mut()[at.unwrap()] ^= 1;
        }
        let found = shown.judge(method, &frame, Rounding::Gpu);
        let first = found.first_wrong().unwrap();
        assert_eq!(first.stage, of.trim_end_matches('.'));
        let fault = &first.worst.as_ref().unwrap().fault;
        assert!(matches!(fault, Fault::Absent { .. } | Fault::Outside { .. }), "{fault:?}");
        // The next stage cannot run from an id without a surfel.
        if *of == "indices." {
            for plane in frame.planes.iter_mut().filter(|plane| plane.name == name) {
                let Samples::Count(high) = &mut plane.samples else { panic!("{name}") };
                high.values_mut()[at.unwrap()] = 77;
            }
            let session = shown.session(method, &exec);
            let error = session.stage(&shown.camera, "attributes", &frame).unwrap_err();
            assert!(error.to_string().contains("`indices.id` and `indices.stencil`"), "{error}");
        }
    }
}
