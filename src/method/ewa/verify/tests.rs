use crate::frame::{Exec, Frame};
use crate::method::{Method, Session};
use crate::scene::{Camera, Lens, Scene};
use crate::source::Shape;
use crate::splat::{Epsilon, Kernel, SplatSettings};
use crate::verify::client::{Client, Rounding};
use crate::verify::verdict::{Outcome, Verdict};

/// Runs a test of a scene, its camera and its settings.
fn each_scene(mut test: impl FnMut(&Session<'_>, &Camera)) {
    let exec = Exec::new(1, 16).unwrap();
    for (shape, kernel, lens, epsilon) in [
        (Shape::Sphere, Kernel::DEFAULT, None, None),
        (Shape::Cluster, Kernel::ZPVBG01, None, None),
        (Shape::Torus, Kernel::ZP06, None, None),
        (Shape::Sheets { gap: 0.02 }, Kernel::DEFAULT, Some(Lens::Orthographic(3.0)), Some(0.0)),
    ] {
        let scene = Scene::lit("shape", shape.surfels(900, 5).unwrap());
        let lens = lens.unwrap_or(shape.default_lens());
        let camera = Camera::new(57, 43, shape.default_pose(), lens).unwrap();
        let mut settings = SplatSettings { kernel, ..SplatSettings::default() };
        if let Some(epsilon) = epsilon {
            settings.epsilon = Epsilon::World(epsilon);
        }
        let session = Session::new(&scene, Method::Ewa(settings), &exec).unwrap();
        test(&session, &camera);
    }
}

fn verdict(
    session: &Session<'_>,
    camera: &Camera,
    frame: &Frame<f32>,
    rounding: Rounding,
) -> Verdict {
    let mut client = Client::from(frame);
    client.rounding = rounding;
    session.verify(camera, &client, 1.0).unwrap()
}

#[test]
fn what_the_crate_renders_is_right() {
    each_scene(|session, camera| {
        let whole = session.define::<f32>(camera, true).unwrap().frame;
        let plain = session.define::<f32>(camera, false).unwrap().frame;
        for rounding in [Rounding::Ieee, Rounding::Gpu] {
            for frame in [&whole, &plain] {
                let verdict = verdict(session, camera, frame, rounding);
                let wrong = verdict.stages.iter().find_map(|stage| stage.worst.clone());
                assert_eq!(wrong, None);
                assert_eq!(verdict.outcome(), Outcome::Right);
            }
        }
    });
}

#[test]
fn of_each_plane_alone_what_the_crate_renders_is_right() {
    each_scene(|session, camera| {
        let whole = session.define::<f32>(camera, true).unwrap().frame;
        for plane in &whole.planes {
            if plane.name == "margin" {
                continue;
            }
            let Frame { width, height, .. } = whole;
            let frame = Frame { width, height, planes: vec![plane.clone()] };
            let verdict = verdict(session, camera, &frame, Rounding::Ieee);
            let wrong = verdict.stages.iter().find_map(|stage| stage.worst.clone());
            assert_eq!(wrong, None, "{}", plane.name);
        }
    });
}
