use super::*;
use crate::number::random::unit;
use crate::scene::Cloud;
use crate::verdict::Fault;
use crate::verdict::client::Ties;

#[test]
fn faults_of_the_selection_are_found() {
    let exec = Exec::new(1, 16).unwrap();
    let sequence = &sequences()[0];
    let (settings, method) = (&sequence.settings, sequence.method());
    let frames = sequence.frames::<f32>(&exec);
    let shown = &frames[2];
    let median = shown.scene.objects.as_ref().unwrap().median_radius();
    let epsilon = settings.splats.epsilon.in_units(median);
    let assert_wrong = |planes: &[NamedPlane<f32>], what: &str| {
        let frame = shown.from(method, planes, "indices");
        assert_first_wrong(shown, method, &frame, "indices", what);
    };
    // A check of the check: with the rule itself, nothing is wrong.
    let own = other_indices(shown, settings, |z| decide::limit(z, epsilon), |t, than| t < than);
    assert_eq!(with(&shown.frame, &own).planes, shown.frame.planes);
    let without = other_indices(shown, settings, |z| z, |t, than| t < than);
    assert_wrong(&without, "without epsilon");
    let farthest =
        other_indices(shown, settings, |z| decide::limit(z, epsilon), |t, than| t > than);
    assert_wrong(&farthest, "the farthest");
    let right = kept(&shown.frame, "indices");
    let some: Vec<usize> = (0..right.len() - 1).filter(|&i| right[i].0 != NO_ID).collect();
    for at in some.iter().step_by(some.len() / 5).copied() {
        let mut dropped = right.clone();
        dropped[at] = (NO_ID, f32::INFINITY);
        assert_wrong(&planes("indices", &shown.frame, &dropped), "dropped");
        let mut moved = right.clone();
        moved[at].0 = some.iter().map(|&i| right[i].0).find(|id| *id != right[at].0).unwrap();
        assert_wrong(&planes("indices", &shown.frame, &moved), "the id of another pixel");
    }
}

#[test]
fn faults_of_the_visibility_are_found() {
    let exec = Exec::new(1, 16).unwrap();
    let sequence = &sequences()[0];
    let (settings, method) = (&sequence.settings, sequence.method());
    let frames = sequence.frames::<f32>(&exec);
    let (last, shown) = (&frames[1], &frames[2]);
    // Positions of the previous frame.
    let stale = DrawnFrame {
        scene: last.scene.clone(),
        before: shown.before.clone(),
        frame: shown.frame.clone(),
        camera: shown.camera,
    };
    let left =
        stale.session(method, &exec).stage(&shown.camera, "visibility", &shown.frame).unwrap();
    let frame = shown.from(method, &left.planes, "visibility");
    assert_first_wrong(shown, method, &frame, "visibility", "last frame's places");
    // Flags that are off by one group.
    let ids = shown.scene.objects.as_ref().unwrap().ids();
    let seen = shown.before.as_ref().unwrap();
    let moved: Vec<u64> = seen
        .surfels(ids)
        .into_iter()
        .filter_map(|id| {
            ids.find(id + u64::from(settings.flags)).map(|_| id + u64::from(settings.flags))
        })
        .collect();
    let mut session = shown.session(method, &exec);
    session.resume(Some(Seen::from_selected(ids, settings.flags, &moved)));
    let frame = session.define::<f32>(&shown.camera, true).unwrap().frame;
    assert_first_wrong(shown, method, &frame, "visibility", "flags of the next group");
    // No flags at all. Only the planes of pass 1 need to show this.
    session.resume(None);
    let frame = session.define::<f32>(&shown.camera, true).unwrap().frame;
    assert_first_wrong(shown, method, &frame, "visibility", "no flags");
    // Without pass 3.
    let before = kept(&shown.frame, "visibility");
    let skipped = shown.from(method, &planes("difference", &shown.frame, &before), "difference");
    assert_first_wrong(shown, method, &skipped, "difference", "without pass 3");
    let all = plain(&skipped);
    let found = shown.judge(method, &all, Rounding::Ieee);
    assert!(found.first_wrong().is_some(), "without pass 3, of which the picture alone is there");
}

#[test]
fn faults_of_the_sums_are_found() {
    let exec = Exec::new(1, 16).unwrap();
    let sequence = &sequences()[0];
    let method = sequence.method();
    let frames = sequence.frames::<f32>(&exec);
    let (last, shown) = (&frames[1], &frames[2]);
    let session = shown.session(method, &exec);
    let assert_wrong = |list: &[(u32, f32)], what: &str| {
        let other = with(&shown.frame, &planes("indices", &shown.frame, list));
        let left = session.stage(&shown.camera, "attributes", &other).unwrap();
        let frame = shown.from(method, &left.planes, "attributes");
        assert_first_wrong(shown, method, &frame, "attributes", what);
    };
    assert_wrong(&kept(&last.frame, "indices"), "B(i-1)");
    let right = kept(&shown.frame, "indices");
    // A surfel that is the nearest in some pixel.
    let front = id(&shown.frame, "difference.id").values();
    let some: Vec<usize> =
        (0..right.len()).filter(|&i| right[i].0 != NO_ID && front.contains(&right[i].0)).collect();
    for &at in some.iter().step_by(some.len() / 5) {
        let mut without = right.clone();
        without[at] = (NO_ID, f32::INFINITY);
        assert_wrong(&without, "a splat without weight");
    }
}

#[test]
fn faults_are_named_by_ids() {
    let exec = Exec::new(1, 16).unwrap();
    let sequence = &sequences()[0];
    let shown = &sequence.frames::<f32>(&exec)[2];
    let mut right = kept(&shown.frame, "indices");
    let ids = shown.scene.objects.as_ref().unwrap().ids();
    // A surfel whose id is not its number, and with no other surfel near.
    let at =
        right.iter().rposition(|(id, _)| ids.rank((*id).into()).is_some_and(|i| i as u32 != *id));
    let dropped = std::mem::replace(&mut right[at.unwrap()], (NO_ID, f32::INFINITY)).0;
    let frame = with(&shown.frame, &planes("indices", &shown.frame, &right));
    let found = shown.judge(sequence.method(), &frame, Rounding::Ieee);
    let worst = found.first_wrong().unwrap();
    let named =
        |fault: &Fault| matches!(fault, Fault::LeftOut { surfel, .. } if *surfel == dropped);
    assert!(named(&worst.worst.as_ref().unwrap().fault), "{dropped} {:?}", worst.worst);
    assert!(worst.causes.left_out.contains_key(&dropped));
}

/// Discs in a plane across the view, at depths that differ only by rounding.
fn across() -> (Scene, Camera) {
    let eye = DVec3::new(1.0, 2.0, 3.0);
    let camera = Camera::new(
        16,
        16,
        Pose { eye, target: DVec3::ZERO, up: DVec3::Y },
        Lens::Orthographic(2.0),
    );
    let towards = eye.normalize();
    let (a, b) = towards.any_orthonormal_pair();
    let at = |i: u64| 2.0 * f64::from(unit(3, i)) - 1.0;
    let place = |i: u64| at(2 * i) * a + at(2 * i + 1) * b;
    let cloud = Cloud {
        position: (0..600).map(|i| place(i).as_vec3()).collect(),
        normal: Some(vec![towards.as_vec3(); 600]),
        radius: Some(vec![0.1; 600]),
        ..Cloud::default()
    };
    (Scene::lit("across", Surfels::new(cloud).unwrap().0), camera.unwrap())
}

#[test]
fn of_near_ties_either_may_be_selected() {
    let (scene, camera) = across();
    let (settings, exec) = (Settings::default(), Exec::new(1, 16).unwrap());
    let method = Method::from(settings);
    let frame =
        Session::new(&scene, method, &exec).unwrap().define::<f32>(&camera, true).unwrap().frame;
    let shown = DrawnFrame { scene, camera, before: None, frame };
    // The last fragment of each pixel.
    let last = other_indices(&shown, &settings, |_| f32::INFINITY, |t, than| t >= than);
    let differ = kept(&shown.frame, "indices");
    let other = with(&shown.frame, &last);
    let differ = kept(&other, "indices").iter().zip(&differ).filter(|(a, b)| a.0 != b.0).count();
    let some = kept(&shown.frame, "indices").iter().filter(|pixel| pixel.0 != NO_ID).count();
    assert!(differ > 50, "{differ} of {some}");
    let frame = shown.from(method, &last, "indices");
    for rounding in ROUNDINGS {
        let found = shown.judge(method, &frame, rounding);
        assert_eq!(wrong(&found), None);
        assert_eq!(found.outcome(), Outcome::Right);
    }
    // A disc a little behind the plane is no tie.
    let mut cloud = shown.scene.surfels.clone().into_cloud();
    let towards = cloud.normal.as_ref().unwrap()[0];
    cloud.position.iter_mut().step_by(2).for_each(|p| *p -= 1e-4 * towards);
    let scene = Scene { surfels: Surfels::new(cloud).unwrap().0, ..shown.scene };
    let frame =
        Session::new(&scene, method, &exec).unwrap().define::<f32>(&camera, true).unwrap().frame;
    let shown = DrawnFrame { scene, frame, ..shown };
    let farthest = other_indices(&shown, &settings, |_| f32::INFINITY, |t, than| t > than);
    let frame = shown.from(method, &farthest, "indices");
    assert_first_wrong(&shown, method, &frame, "indices", "the farthest");
}

#[test]
fn equal_surfels_are_told_apart_by_the_rule_of_ties() {
    let mut cloud = Shape::Sphere.surfels(300, 1).unwrap().into_cloud();
    let all = cloud.position.len();
    cloud.position.extend_from_within(..);
    for values in [&mut cloud.normal, &mut cloud.color].into_iter().flatten() {
        values.extend_from_within(..);
    }
    cloud.radius.iter_mut().for_each(|radius| radius.extend_from_within(..));
    let scene = Scene::lit("twice", Surfels::new(cloud).unwrap().0);
    let camera = crate::verdict::tests::camera(Shape::Sphere, [40, 30], None);
    let (settings, exec) = (Settings::default(), Exec::new(1, 16).unwrap());
    let method = Method::from(settings);
    let frame =
        Session::new(&scene, method, &exec).unwrap().define::<f32>(&camera, true).unwrap().frame;
    let shown = DrawnFrame { scene, camera, before: None, frame };
    let last = other_indices(&shown, &settings, |_| f32::INFINITY, |t, than| t <= than);
    let frame = shown.from(method, &last, "indices");
    assert!(id(&frame, "indices.id").values().iter().any(|&id| id != NO_ID && id as usize >= all));
    for rounding in ROUNDINGS {
        for (ties, right) in [(Ties::Lowest, false), (Ties::Last, true), (Ties::Any, true)] {
            let mut client = Client::from(&frame);
            (client.rounding, client.ties) = (rounding, ties);
            let session = shown.session(method, &exec);
            let found = session.verify(&camera, &client, Verdict::BUDGET).unwrap();
            assert_eq!(wrong(&found).is_none(), right, "{ties:?} {:?}", wrong(&found));
        }
    }
}
