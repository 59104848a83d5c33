//! A session refuses what it cannot draw, and its memory shows nothing of earlier pictures.

use super::*;
use crate::frame::{NO_ID, Samples};
use crate::index::grouping::{Extension, Rules};
use crate::method::tests::{cameras, scene, surfels};
use crate::scene::Objects;
use crate::scene::{
    Geometry, Light, Motion, Object, Primitives, Similarity, Surfels, Triangles, Vertices,
};
use crate::source::{Shape, flatten};
use glam::{DVec3, Vec3};

/// A few surfels of a sphere, and a camera.
fn sphere() -> (Scene, Camera) {
    let shape = Shape::Sphere;
    let scene = Scene::lit("sphere", shape.surfels(40, 0).unwrap());
    (scene, Camera::new(8, 8, shape.default_pose(), shape.default_lens()).unwrap())
}

#[test]
fn a_picture_is_taken_out_once_and_the_next_has_its_bits() {
    let (scene, camera) = sphere();
    let exec = Exec::sequential();
    let mut session = Session::new(&scene, Method::default(), &exec).unwrap();
    let first = session.render(&camera).unwrap().frame.clone();
    assert_eq!(session.take_picture().unwrap().frame, first);
    assert!(session.take_picture().is_none());
    assert_eq!(session.render(&camera).unwrap().frame, first);
}

#[test]
fn primitives_are_refused_by_methods_that_draw_surfels_alone() {
    let (mut scene, _) = sphere();
    let vertices = Vertices {
        position: vec![Vec3::X, Vec3::Y, Vec3::Z],
        direction: vec![Vec3::ONE; 3],
        radius: vec![0.0; 3],
        color: None,
        ..Vertices::default()
    };
    scene.primitives.triangles = Triangles::new(vertices, vec![[0, 1, 2]]).unwrap().0;
    let exec = Exec::sequential();
    for method in Method::all() {
        let found = Session::new(&scene, method, &exec);
        if method.draws_polygons() {
            assert!(found.is_ok());
            continue;
        }
        let line = found.unwrap_err().to_string();
        assert!(line.starts_with("sphere has triangles or lines, but the method "), "{line}");
        let able = " does not draw them; use --method deferred or --method pyramid or --method \
                    blue";
        assert!(line.ends_with(able), "{line}");
    }
}

#[test]
fn a_scene_of_nothing_is_an_empty_picture_or_refused() {
    let (mut scene, camera) = sphere();
    scene.surfels = Surfels::none();
    let exec = Exec::sequential();
    for method in Method::all() {
        let groups = Groups::new(vec![], vec![], vec![1.0]).unwrap();
        let mut session = Session::with_groups(&scene, method, Some(groups), &exec).unwrap();
        match session.render(&camera) {
            Ok(picture) => assert_eq!(picture.tally.visible, 0),
            Err(error) => assert!(error.to_string().contains("epsilon 0 needs"), "{error}"),
        }
    }
    for extension in [Extension::None, Extension::Add { most: 0.5 }, Extension::Enlarge] {
        for count in [None, Some(2)] {
            let grouping = Grouping { rules: Rules::default(), count, extension };
            let found = grouping.groups(&scene.surfels, &exec, &|_, _, _| ());
            assert!(found.is_ok_and(|(groups, ..)| groups.own().is_empty()));
        }
    }
}

#[test]
fn groups_that_are_missing_or_of_another_scene_are_refused() {
    let (scene, _) = sphere();
    let exec = Exec::sequential();
    let others = Groups::new(vec![0; 3], vec![], vec![1.0]).unwrap();
    for method in Method::all().into_iter().filter(|method| method.grouping().is_some()) {
        let refused =
            |groups| Session::with_groups(&scene, method, groups, &exec).unwrap_err().to_string();
        assert!(refused(None).contains("prepared for another method, without groups"));
        assert_eq!(
            refused(Some(others.clone())),
            "the groups have 3 surfels, but the scene has 40"
        );
    }
}

#[test]
fn groups_come_from_the_scene_unless_a_grouping_is_chosen() {
    let (mut scene, _) = sphere();
    let exec = Exec::sequential();
    let mut cloud = scene.surfels.into_cloud();
    let own: Vec<u8> = (0..40).map(|i| i % 3).collect();
    cloud.groups = Some(Groups::new(own.clone(), vec![], vec![1.0; 3]).unwrap());
    scene.surfels = Surfels::new(cloud).unwrap().0;
    let method = Method::by_name("single-pass").unwrap();
    let prepare = |grouping| {
        let (session, made) =
            Session::prepare(&scene, method, grouping, &exec, &|_, _, _| ()).unwrap();
        (session.groups().unwrap().own().to_vec(), made.is_some())
    };
    assert_eq!(prepare(None), (own, false));
    let one = Grouping { rules: Rules::default(), count: Some(1), extension: Extension::None };
    assert_eq!(prepare(Some(one)), (vec![0; 40], true));
    let ewa = Session::new(&scene, Method::default(), &exec).unwrap();
    assert!(ewa.groups().is_none(), "a method that draws none has none");
}

#[test]
fn every_method_has_a_name_of_its_own_and_is_found_by_it() {
    for method in Method::all() {
        assert_eq!(Method::by_name(method.name()).unwrap(), method);
    }
    let line = Method::by_name("evva").unwrap_err().to_string();
    let names = "ewa, deferred, single-pass, transparent, transparent-hq, peeling, pyramid, template, \
         blue, gaussians";
    assert_eq!(line, format!("method `evva`; give one of {names}"));
}

/// The memory of an earlier picture changes nothing in the next picture, and a session draws what
/// the definition says.
#[test]
fn the_memory_of_an_earlier_picture_changes_no_bit() {
    let exec = Exec::new(2, 16).unwrap();
    let [small, large] = [6, 8].map(|i| cameras()[i]);
    // With and without light, with and without colours.
    for (i, (lit, color)) in
        [(true, true), (false, false), (true, false), (false, true)].into_iter().enumerate()
    {
        let lights = if lit { vec![Light::DEFAULT] } else { vec![] };
        let scene = Scene { lights, ..scene(surfels(500, 0.1, color, i as u64)) };
        let groups = Groups::new(vec![0; 500], vec![], vec![1.0]).unwrap();
        for method in Method::all() {
            let session =
                || Session::with_groups(&scene, method, Some(groups.clone()), &exec).unwrap();
            let mut again = session();
            for camera in [large, small, large, large] {
                // What a frame saw is not memory: the next frame must not receive it here.
                again.resume(None);
                let after = again.render(&camera).unwrap();
                assert!(after.tally.visible > 50, "{after:?}");
                let defined = session().define::<f32>(&camera, false).unwrap();
                // The shortest decimals of two floats differ if any bit differs, except between
                // NaNs.
                let same = format!("{:?}", after.frame) == format!("{:?}", defined.frame);
                assert!(same, "{method:?}, scene {i}");
            }
        }
    }
}

/// Two spheres of one geometry in their places, and the same surfels without objects.
pub(crate) fn two_spheres() -> [Scene; 2] {
    let (surfels, primitives) = (Shape::Sphere.surfels(300, 1).unwrap(), Primitives::default());
    let geometry = Geometry { name: "sphere".into(), surfels, primitives, detail: None };
    let object = |x: f64| {
        let translation = DVec3::new(x, 0.25 * x, x);
        let motion = Motion::still(Similarity { translation, ..Similarity::IDENTITY });
        Object { name: format!("at {x}"), geometry: 0, motion, color: None }
    };
    let objects = Objects::new(vec![geometry], vec![object(-0.5), object(0.5)], Vec3::ONE).unwrap();
    let scene = Scene { objects: Some(objects), ..Scene::lit("two", Surfels::none()) };
    let flat = flatten(&scene, &Exec::sequential()).unwrap();
    [Scene { objects: None, ..flat.clone() }, flat]
}

/// Planes of ids name the surfels of objects, as output and as input.
#[test]
fn surfels_of_objects_are_named_by_their_ids() {
    let exec = Exec::sequential();
    let [plain, objects] = two_spheres();
    let ids = objects.objects.as_ref().unwrap().ids().clone();
    assert_eq!((ids.id(1, 7), ids.rank(ids.id(1, 7))), (1 << 20 | 7, Some(307)));
    let camera = cameras()[6];
    for method in Method::all().into_iter().filter(|method| !method.draws_objects()) {
        let session = |scene| {
            let groups = Groups::new(vec![0; 600], vec![], vec![1.0]).unwrap();
            Session::with_groups(scene, method, Some(groups), &exec).unwrap()
        };
        let (mut own, of) = (session(&objects), session(&plain));
        let (named, indices) = (own.define::<f64>(&camera, true), of.define::<f64>(&camera, true));
        let (named, indices) = (named.unwrap().frame, indices.unwrap().frame);
        let mut large = 0;
        for (named, indices) in named.planes.iter().zip(&indices.planes) {
            let (Samples::Index(named), Samples::Index(indices)) =
                (&named.samples, &indices.samples)
            else {
                assert_eq!(named, indices, "{method:?}");
                continue;
            };
            for (&id, &index) in named.values().iter().zip(indices.values()) {
                let expected = ids.nth(index.into()).map_or(NO_ID, |id| id as u32);
                assert_eq!(id, expected, "{method:?}");
                large += u32::from(id != NO_ID && id >= 1 << 20);
            }
        }
        assert!(large > 50, "{method:?}: both spheres are seen");
        let rendered = own.render(&camera).unwrap();
        assert_eq!(rendered.frame.plane("id").is_some(), indices.plane("id").is_some());
    }
}
