//! Entries about deferred splatting over several frames.

use super::case::{SIZE, both, change, checked, quiet};
use super::{Failure, Found};
use crate::compare::metrics::{Metric, rmse};
use crate::error::Result;
use crate::frame::{Exec, Plane};
use crate::index::mipmap;
use crate::method::{Method, Session, deferred, ewa};
use crate::scene::objects::{Geometry, Motion, Object, Objects};
use crate::scene::transform::rotation;
use crate::scene::{Camera, Lens, Pose, Primitives, Scene, Similarity, Surfels};
use crate::source::{Shape, flatten};
use glam::{DVec3, Vec3};
use std::time::{Duration, Instant};

pub(super) const FAILURES: [Failure; 2] = [
    Failure {
        id: "deferred-motion",
        title: "Holes after a fast turn",
        why: "A sphere of 20,000 surfels in front of a sheet is at rest for three frames, and then \
              turned. Deferred splatting draws it without the third pass, and flags each surfel by \
              itself. Pass 1 draws the surfels that the last frame saw. Where the sphere's surfels \
              were not seen, pass 1 leaves no depth, and the sheet shines through between the new \
              surfels [GBP04, 4.1, Fig. 3].",
        swept: "degrees in a frame",
        values: &[0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0],
        error: "RMSE, linear RGB, to the picture of EWA",
        limit: 0.016,
        cure: "`--second on`, the default",
        at: turn,
    },
    Failure {
        id: "deferred-dense",
        title: "More than one surfel for a pixel flickers",
        why: "The camera moves towards a sphere with checks one pixel wide, sampled by more and \
              more surfels. Deferred splatting draws the surfel nearest to each pixel's centre, \
              and that surfel changes from frame to frame [GBP04, 4.4].",
        swept: "surfels a pixel",
        values: &[0.0625, 0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0],
        error: "change that EWA does not show, RMSE, linear RGB",
        limit: 0.08,
        cure: "surfel mipmaps: `mipmap` in the scene file",
        at: dense,
    },
];

/// The last frame in which the sphere is at rest; it is turned in the next.
const REST: u32 = 2;

fn turn(degrees: f64, exec: &Exec) -> Result<[Found; 2]> {
    let splats = ewa::Settings::default();
    let [width, height] = SIZE;
    let pose = Pose { eye: DVec3::new(0.5, 0.5, 5.0), target: DVec3::ZERO, up: DVec3::Y };
    let camera = Camera::new(width, height, pose, Lens::FieldOfView(34.0))?;
    let objects = sphere_and_sheet(degrees)?;
    let scene = |frame| -> Result<Scene> {
        let objects = Some(objects.at(frame)?);
        Ok(Scene { objects, ..Scene::lit("turn", Surfels::none()) })
    };
    let (rest, turned) = (scene(0)?, scene(REST + 1)?);
    let flat = flatten(&turned, exec)?;
    let truth = Session::new(&flat, splats.into(), exec)?.render(&camera)?.frame.clone();
    both(|second| {
        let settings =
            deferred::Settings { splats, flags: 1, second, ..deferred::Settings::default() };
        let mut before = Session::new(&rest, settings.into(), exec)?;
        for _ in 0..=REST {
            before.render(&camera)?;
        }
        let mut session = Session::new(&turned, settings.into(), exec)?;
        session.resume(before.seen().cloned());
        let start = Instant::now();
        let frame = session.render(&camera)?.frame.clone();
        let time = Some(start.elapsed());
        let error = Metric::named("rmse")?.between(&frame, &truth, exec)?.unwrap_or(0.0);
        Ok(Found { error, picture: frame.color("")?.clone(), time })
    })
}

/// A sphere in front of a sheet; it turns by some degrees about +y after [`REST`].
fn sphere_and_sheet(degrees: f64) -> Result<Objects> {
    let geometry = |name: &str, shape: Shape, count| {
        Ok(Geometry {
            name: name.into(),
            surfels: shape.surfels(count, 0)?,
            primitives: Primitives::default(),
            detail: None,
        })
    };
    let object =
        |name: &str, geometry, motion| Object { name: name.into(), geometry, motion, color: None };
    let turned = Similarity { rotation: rotation(DVec3::Y, degrees), ..Similarity::IDENTITY };
    let behind = Similarity { translation: DVec3::Z * -1.5, scale: 2.0, ..Similarity::IDENTITY };
    let moves = Motion::new(vec![(REST, Similarity::IDENTITY), (REST + 1, turned)])?;
    Objects::new(
        vec![
            geometry("sphere", Shape::Sphere, 20_000)?,
            geometry("sheet", Shape::Sheets { gap: 0.5 }, 40_000)?,
        ],
        vec![object("sphere", 0, moves), object("sheet", 1, Motion::still(behind))],
        Vec3::splat(0.75),
    )
}

/// How many frames are measured, and how many frames come before them.
const FRAMES: [u32; 2] = [4, 2];
const SIDE: u32 = 128;

fn towards(frame: u32) -> Result<Camera> {
    let eye = DVec3::Z * 4.0 * (1.0 - f64::from(frame) / 400.0);
    let pose = Pose { eye, ..Shape::Sphere.default_pose() };
    Camera::new(SIDE, SIDE, pose, Shape::Sphere.default_lens())
}

fn dense(wanted: f64, exec: &Exec) -> Result<[Found; 2]> {
    let first = towards(0)?;
    // The near half of the sphere covers pi (f / 4)^2 pixels.
    let covered = std::f64::consts::PI * f64::from(first.fy) * f64::from(first.fy) / 16.0;
    let pixel = 4.0 / f64::from(first.fy);
    let surfels = checked(Shape::Sphere.surfels((2.0 * wanted * covered) as usize, 0)?, pixel)?;
    let plain = Scene::unlit("dense", surfels);
    let mipmap = mipmap::build(&plain.surfels, 5, exec, &quiet)?;
    let cured = Scene::unlit("dense", plain.surfels.clone().with_mipmap(Some(mipmap))?);
    let (full, _) = approach(&plain, ewa::Settings::default().into(), exec)?;
    let found = |scene: &Scene| {
        let (mut pictures, time) = approach(scene, deferred::Settings::default().into(), exec)?;
        let changes = pictures.windows(2).zip(full.windows(2)).map(|(found, full)| {
            let [found, full] = [found, full].map(|pair| change(&pair[0], &pair[1]));
            rmse(found.as_flattened(), full.as_flattened())
        });
        let error = changes.sum::<f64>() / f64::from(FRAMES[0]);
        let picture = pictures.pop().unwrap_or_else(|| Plane::filled(SIDE, SIDE, [0.0; 3]));
        Ok(Found { error, picture, time: Some(time) })
    };
    Ok([found(&plain)?, found(&cured)?])
}

/// The pictures of all measured frames, and the time of the last.
fn approach(
    scene: &Scene,
    method: Method,
    exec: &Exec,
) -> Result<(Vec<Plane<[f32; 3]>>, Duration)> {
    let mut session = Session::new(scene, method, exec)?;
    let (mut pictures, mut time) = (Vec::new(), Duration::ZERO);
    let [frames, ahead] = FRAMES;
    for frame in 0..=frames + ahead {
        let start = Instant::now();
        let picture = session.render(&towards(frame)?)?.frame.color("")?.clone();
        time = start.elapsed();
        if frame >= ahead {
            pictures.push(picture);
        }
    }
    Ok((pictures, time))
}
