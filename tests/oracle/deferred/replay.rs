//! Each stage alone on the planes of those before, and the explanation of pixels, against the
//! picture.

use crate::oracle::deferred::cases::{Sequence, sequence};
use crate::oracle::kit::planes::{bits, index, number, plane};
use splatref::frame::{Exec, Frame, NO_ID};
use splatref::index::Index;
use splatref::index::seen::Seen;
use splatref::method::deferred::explain::{DeferredReplay, explain};
use splatref::method::{Job, Method, Session};
use splatref::scene::{Camera, Projection, Scene};

/// The frames of a sequence, each given what the one before saw.
fn each(sequence: &Sequence, mut run: impl FnMut(&Scene, &Camera, Option<Seen>, Frame<f32>)) {
    let (exec, mut seen) = (Exec::sequential(), None);
    for (frame, camera, _) in &sequence.frames {
        let scene = sequence.scene(*frame);
        let mut session = Session::new(&scene, sequence.settings.into(), &exec).expect("a session");
        session.resume(seen.clone());
        let picture = session.define::<f32>(camera, true).expect("renders");
        run(&scene, camera, seen, picture.frame);
        seen = picture.seen;
    }
}

#[test]
fn deferred_stages_alone_leave_the_planes_of_the_picture() {
    let (mut same, mut rounded) = (0_u64, 0_u64);
    for sequence in (0..24).map(sequence) {
        let exec = Exec::sequential();
        each(&sequence, |scene, camera, seen, whole| {
            let mut session = Session::new(scene, sequence.settings.into(), &exec).expect("fits");
            session.resume(seen);
            for stage in Method::from(sequence.settings).stages() {
                let alone = session.stage::<f32>(camera, stage.name, &whole);
                let alone = alone.unwrap_or_else(|e| panic!("{}: {e}", stage.name));
                for row in stage.leaves {
                    let both = [&whole, &alone].map(|frame| frame.plane(row.name).is_some());
                    assert!(!both[0] || both[1], "{} leaves no '{}'", stage.name, row.name);
                }
                for found in &alone.planes {
                    let Some(own) = whole.plane(&found.name) else { continue };
                    same += 1;
                    if bits(own) == bits(&found.samples) {
                        continue;
                    }
                    // A depth that comes back as a nearness is rounded once more.
                    let (name, place) = (&found.name, &sequence.name);
                    assert_eq!(stage.name, "difference", "'{name}' of {place}");
                    assert_eq!(camera.projection, Projection::Perspective, "'{name}' of {place}");
                    let pixels = (whole.width * whole.height) as usize;
                    for i in 0..pixels {
                        let [a, b] = [&whole, &alone].map(|f| number(f, "difference.Z", i));
                        let off = if a == b { 0.0 } else { ((a - b) / a).abs() };
                        assert!(off <= (-22.0_f64).exp2(), "{a} and {b} at {i} of {place}");
                    }
                    rounded += 1;
                }
            }
        });
    }
    println!("{same} planes, {rounded} of them rounded");
    assert!(rounded * 10 < same && same > 1000, "{rounded} of {same}");
}

#[test]
fn deferred_shading_alone_shades_the_colours() {
    let exec = Exec::sequential();
    for sequence in (0..24).map(sequence) {
        each(&sequence, |scene, camera, _, whole| {
            let session = Session::new(scene, sequence.settings.into(), &exec).expect("fits");
            let alone = session.stage::<f32>(camera, "shading", &whole).expect("shades");
            let [a, b] = [&whole, &alone].map(|frame| bits(plane(frame, "")));
            assert!(a == b, "the colours of {}", sequence.name);
        });
    }
}

/// What is said of a pixel against what its planes hold.
fn compare(said: &DeferredReplay<f32>, frame: &Frame<f32>, i: usize, place: &str) {
    let depth = |name| number(frame, name, i) as f32;
    assert_eq!(said.visible, depth("visibility.Z"), "{place}: pass 1");
    assert_eq!(said.nearest, depth("difference.Z"), "{place}: pass 3");
    let kept: Vec<_> = said.centres.iter().filter(|centre| centre.kept).collect();
    match index(frame, "indices.id", i) {
        NO_ID => assert!(kept.is_empty(), "{place}: {kept:?}"),
        _ => {
            assert_eq!(kept.len(), 1, "{place}: {kept:?}");
            assert_eq!(kept[0].visible.own, depth("indices.Z"), "{place}: pass 2");
        }
    }
    for centre in &said.centres {
        let test = &centre.visible;
        assert_eq!(test.holds, test.own <= said.visible + said.epsilon, "{place}: {test:?}");
    }
    let weights = said.sums.iter().filter_map(|(_, touch)| touch.gives.map(|(_, weight)| weight));
    let (mut sum, mut count) = (0.0_f32, 0);
    for weight in weights {
        (sum, count) = (sum + weight, count + 1);
    }
    assert_eq!(sum, depth("attributes.weight"), "{place}: pass 4");
    assert_eq!(f64::from(count.min(255)), number(frame, "attributes.count", i), "{place}");
}

#[test]
fn deferred_explanations_say_what_the_planes_hold() {
    let exec = Exec::sequential();
    let (mut centres, mut sums) = (0, 0);
    for sequence in (0..24).map(sequence) {
        each(&sequence, |scene, camera, seen, frame| {
            let objects = scene.objects.as_ref().expect("objects");
            let flagged = seen.as_ref().map_or(0, |seen| seen.surfels(objects.ids()).len() as u64);
            let index = Index { seen, ..Index::default() };
            let job = Job::new(scene, &index, camera, &exec);
            let pixels = (frame.width * frame.height) as usize;
            let ids =
                (0..pixels).map(|i| crate::oracle::kit::planes::index(&frame, "indices.id", i));
            let selected = ids.filter(|id| *id != NO_ID).count() as u64;
            for i in (0..pixels).step_by(pixels / 12 + 1) {
                let pixel = (i as u32 % frame.width, i as u32 / frame.width);
                let said = explain::<f32>(&job, &sequence.settings, pixel).expect("a pixel");
                let place = format!("{pixel:?} of {}", sequence.name);
                assert_eq!(said.pixel, pixel);
                assert_eq!(said.counts, [objects.ids().total(), flagged, selected], "{place}");
                compare(&said, &frame, i, &place);
                centres += said.centres.len();
                sums += said.sums.len();
            }
            assert!(plane(&frame, "indices.id").size() == (frame.width, frame.height));
        });
    }
    assert!(centres > 20 && sums > 100, "{centres} centres, {sums} in sums");
}
