//! Which surfel a pixel shows where two are equally near.

use super::{id, scalar};
use crate::frame::{Exec, NO_ID};
use crate::method::{Method, Session, transparent};
use crate::number::Exact;
use crate::scene::{Camera, Cloud, Groups, Lens, Pose, Scene, Surfels};
use glam::{DVec3, Vec3};

/// Two discs at one place, facing +z.
fn twins() -> Scene {
    let cloud = Cloud {
        position: vec![Vec3::ZERO; 2],
        normal: Some(vec![Vec3::Z; 2]),
        radius: Some(vec![0.5; 2]),
        opacity: Some(vec![0.5; 2]),
        ..Cloud::default()
    };
    Scene::unlit("twins", Surfels::new(cloud).unwrap().0)
}

/// The planes `Z` and `id` of Algorithm 2 for surfels in these groups: the surfel at each covered
/// pixel.
fn nearest<R: Exact>(groups: [u8; 2]) -> Vec<u32> {
    let (scene, exec) = (twins(), Exec::sequential());
    let groups = Groups::new(groups.to_vec(), Vec::new(), vec![1.0; 2]).unwrap();
    let method = Method::from(transparent::Settings::default());
    let session = Session::with_groups(&scene, method, Some(groups), &exec).unwrap();
    let pose = Pose { eye: DVec3::new(0.25, 0.125, 4.0), target: DVec3::ZERO, up: DVec3::Y };
    let camera = Camera::new(16, 16, pose, Lens::FieldOfView(30.0)).unwrap();
    let frame = session.define::<R>(&camera, true).unwrap().frame;
    let mut found = Vec::new();
    for y in 0..16 {
        for x in 0..16 {
            let depths = ["blended.group00.Z", "blended.group01.Z"];
            assert!(depths.iter().all(|name| frame.plane(name).is_none()), "no picture keeps them");
            let surfel = *id(&frame, "id").at(x, y);
            assert_eq!(surfel != NO_ID, *scalar(&frame, "Z").at(x, y) < R::INFINITY);
            if surfel != NO_ID {
                let both = [0, 1].map(|k| *id(&frame, &format!("blended.group0{k}.id")).at(x, y));
                assert!(both.iter().all(|&surfel| surfel != NO_ID), "both groups cover the pixel");
                found.push(surfel);
            }
        }
    }
    found
}

/// \[ZP06, Algorithm 2\]: if two groups have equal depth, the lower surfel is the nearest,
/// whichever group is averaged first.
#[test]
fn of_groups_of_equal_depth_the_lower_surfel_is_the_nearest() {
    for groups in [[0, 1], [1, 0]] {
        let found = nearest::<f32>(groups);
        assert!(found.len() > 20, "{}", found.len());
        assert!(found.iter().all(|&surfel| surfel == 0), "{groups:?}: {found:?}");
        assert!(nearest::<f64>(groups).iter().all(|&surfel| surfel == 0), "{groups:?}");
    }
}
