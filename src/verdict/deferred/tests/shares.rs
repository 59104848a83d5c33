use super::*;

/// The sequence with some of its objects left out.
fn with_share(share: f32) -> Sequence {
    let settings = Settings { flags: 8, share, ..Settings::default() };
    sequence(settings, Lens::FieldOfView(40.0))
}

/// The objects that a frame leaves out.
fn left_out(shown: &DrawnFrame, settings: &Settings) -> Vec<u32> {
    let whole = Whole::new(&shown.scene).after(shown.before.as_ref().unwrap(), settings);
    (0..3).filter(|&object| whole.leaves_out(object)).collect()
}

/// The picture of a client that has another idea of what the previous frame saw, or other settings.
fn other(shown: &DrawnFrame, method: Method, seen: Option<Seen>) -> Frame<f32> {
    let exec = Exec::new(1, 16).unwrap();
    let mut session = shown.session(method, &exec);
    session.resume(seen);
    session.define::<f32>(&shown.camera, true).unwrap().frame
}

#[test]
fn frames_without_some_objects_are_judged() {
    let exec = Exec::new(1, 16).unwrap();
    let mut times = 0;
    for share in [0.15, 0.2, 0.25, 0.3] {
        let sequence = with_share(share);
        let (settings, method) = (&sequence.settings, sequence.method());
        for shown in &sequence.frames::<f32>(&exec)[1..] {
            let out = left_out(shown, settings);
            let doubles = shown.in_doubles(method);
            for (frame, rounding) in [&shown.frame, &doubles]
                .into_iter()
                .flat_map(|frame| ROUNDINGS.map(|rounding| (frame, rounding)))
            {
                for frame in [frame, &plain(frame)] {
                    let found = shown.judge(method, frame, rounding);
                    assert_eq!(wrong(&found), None, "{share} {out:?}");
                }
            }
            let [object] = out[..] else { continue };
            let before = shown.before.as_ref().unwrap();
            let all = Settings { share: 0.0, ..*settings };
            let frame = other(shown, all.into(), shown.before.clone());
            // The object may be hidden by now, and then it is the same to leave it out.
            if frame == shown.frame {
                continue;
            }
            times += 1;
            // Hidden surfels show only in pass 2.
            let stages = ["visibility", "indices"];
            assert_first_wrong_of(shown, method, &frame, &stages, "nothing is left out");
            let plain = plain(&frame);
            let found = shown.judge(method, &plain, Rounding::Gpu);
            assert!(found.first_wrong().is_some(), "nothing is left out, the picture alone");
            // As few surfels of another object as of this one.
            let ids = shown.scene.objects.as_ref().unwrap().ids();
            let mut selected = before.selected().to_vec();
            let next = (object as usize + 1) % selected.len();
            selected.swap(object as usize, next);
            let words = (0..3).map(|object| before.words(object));
            let lengths: Vec<_> = words.clone().map(<[u64]>::len).collect();
            let words = words.flatten().copied().collect();
            let seen = Seen::restored(ids, settings.flags, selected, &lengths, words);
            assert!(seen.is_some());
            let frame = other(shown, method, seen);
            assert_first_wrong_of(shown, method, &frame, &stages, "another is left out");
        }
    }
    assert!(times > 0);
}
