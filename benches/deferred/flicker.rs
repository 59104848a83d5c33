//! What flickers over a slow dolly \[GBP04, 4.4, Fig. 4\].
//!
//! Surfaces with checks of the side of one pixel, unlit, in 256 x 256 pixels, in more and more surfels.
//! The camera goes towards the middle by 1/400 of its distance a frame, by which what is seen at the edge
//! of the picture moves by a third of a pixel. With D(i) a frame of `deferred` and E(i) the same frame of
//! `ewa` of all surfels, over the pixels that lie inside of what E(i) and E(i + 1) cover, the mean over
//! the frames:
//!
//! ```text
//!   change     RMSE of D(i + 1) and D(i), and of E(i + 1) and E(i)
//!   flicker    RMSE of D(i + 1) - D(i) and E(i + 1) - E(i)       change that is no motion
//!   error      RMSE of D(i) and E(i)
//! ```
//!
//! Flicker is the measure of the bench `reconstruction`. The difference of the two changes is not taken
//! for it: a picture that changes as much as the reference and elsewhere would have none.
//!
//! Flicker and error are also measured of `deferred` with surfel mipmaps of [`LEVELS`] levels; the
//! reference is the same.

use super::order::along_a_curve;
use super::stage::{board, check};
use glam::{DVec3, Vec3};
use splatref::Result;
use splatref::compare::metrics::{Region, regions, rmse};
use splatref::frame::Exec;
use splatref::index::mipmap;
use splatref::method::{Method, Session, deferred, ewa};
use splatref::scene::transform::rotation;
use splatref::scene::{Camera, Cloud, Lens, Pose, Scene, Similarity, Surfels};
use splatref::source::Shape;

pub(crate) const SIDE: u32 = 256;
/// At 16 surfels a pixel its side is about four radii.
const LEVELS: usize = 5;
/// Frames before the first that counts.
const BEFORE: u32 = 2;
const DISTANCE: f64 = 4.0;
const FIELD_OF_VIEW: f64 = 34.0;
/// The world size of a pixel in the middle of the first frame.
const PIXEL: f64 = 2.0 * DISTANCE * 0.305_730_681_458_660_4 / SIDE as f64;
/// How many surfels are drawn to find out how many a pixel has.
const TRIAL: usize = 20_000;

/// A surface in about so many surfels.
pub(crate) type Surface = fn(usize) -> Result<Surfels>;

pub(crate) const SURFACES: [(&str, Surface); 3] = [
    ("plane", |count| {
        let side = (count as f64).sqrt().round() as u32;
        let mut cloud = board(side.max(1), 1.0, PIXEL)?.into_cloud();
        // Far end up, by 60 degrees from facing the camera.
        let tilt = Similarity { rotation: rotation(DVec3::X, -60.0), ..Similarity::IDENTITY };
        tilt.apply(&mut cloud);
        Ok(Surfels::new(cloud)?.0)
    }),
    ("sphere", |count| checked(&Shape::Sphere, count, 0.0)),
    ("torus", |count| checked(&Shape::Torus, count, 60.0)),
];

/// A shape with checks, in the order of a curve.
fn checked(shape: &Shape, count: usize, lean: f64) -> Result<Surfels> {
    let mut cloud = along_a_curve(shape.surfels(count, 0)?)?.into_cloud();
    let lean = Similarity { rotation: rotation(DVec3::X, lean), ..Similarity::IDENTITY };
    lean.apply(&mut cloud);
    let colors: Vec<Vec3> = cloud.position.iter().map(|p| check(p.as_dvec3(), PIXEL)).collect();
    Ok(Surfels::new(Cloud { color: Some(colors), ..cloud })?.0)
}

/// A surface with about so many surfels for each pixel that it covers.
pub(crate) fn dense(surface: Surface, wanted: f64, exec: &Exec) -> Result<Surfels> {
    let trial = density(&surface(TRIAL)?, exec)?;
    surface((TRIAL as f64 * wanted / trial).round() as usize)
}

fn camera(frame: u32) -> Result<Camera> {
    let distance = DISTANCE * (1.0 - f64::from(frame) / 400.0);
    let pose = Pose { eye: DVec3::Z * distance, target: DVec3::ZERO, up: DVec3::Y };
    Camera::new(SIDE, SIDE, pose, Lens::FieldOfView(FIELD_OF_VIEW))
}

/// Surfels that face the camera, by covered pixels.
fn density(surfels: &Surfels, exec: &Exec) -> Result<f64> {
    let camera = camera(0)?;
    let eye = camera.eye();
    let faces = |(p, n): (&Vec3, &Vec3)| (eye - p.as_dvec3()).dot(n.as_dvec3()) > 0.0;
    let facing = surfels.position().iter().zip(surfels.normal()).filter(|&s| faces(s)).count();
    let scene = Scene::unlit("trial", surfels.clone());
    let mut session = Session::new(&scene, ewa::Settings::default().into(), exec)?;
    let alpha = session.render(&camera)?.frame.scalar("A")?;
    let covered = alpha.values().iter().filter(|a| **a > 0.0).count();
    Ok(facing as f64 / covered.max(1) as f64)
}

pub(crate) struct Found {
    /// Surfels that are not selected, per cent.
    pub(crate) culled: f64,
    pub(crate) deferred: f64,
    pub(crate) ewa: f64,
    /// Without mipmaps and with them.
    pub(crate) flicker: [f64; 2],
    pub(crate) error: [f64; 2],
}

/// A frame of both methods: colours, and what `ewa` covers.
struct Shot {
    deferred: Vec<[f32; 3]>,
    filtered: Vec<[f32; 3]>,
    ewa: Vec<[f32; 3]>,
    inside: Vec<bool>,
    selected: u32,
}

pub(crate) fn measured(surfels: Surfels, frames: u32, exec: &Exec) -> Result<Found> {
    let count = surfels.len() as f64;
    let scene = Scene::unlit("dense", surfels);
    let mipmap = mipmap::build(&scene.surfels, LEVELS, exec, &|_, _, _| ())?;
    let prefiltered = scene.surfels.clone().with_mipmap(Some(mipmap))?;
    let prefiltered = Scene::unlit("dense", prefiltered);
    let methods: [Method; 2] =
        [deferred::Settings::default().into(), ewa::Settings::default().into()];
    let [mut deferred, mut filtered, mut ewa] = [
        Session::new(&scene, methods[0], exec)?,
        Session::new(&prefiltered, methods[0], exec)?,
        Session::new(&scene, methods[1], exec)?,
    ];
    let mut shots = Vec::new();
    for frame in 0..BEFORE + frames + 1 {
        let camera = camera(frame)?;
        let other = filtered.render(&camera)?;
        let drawn = deferred.render(&camera)?;
        if frame < BEFORE {
            continue;
        }
        let selected = drawn.seen.as_ref().map_or(0, |seen| seen.selected().iter().sum());
        let colors = drawn.frame.color("")?.values().to_vec();
        let full = &ewa.render(&camera)?.frame;
        let inside = regions(full.scalar("A")?.values(), SIDE as usize);
        shots.push(Shot {
            deferred: colors,
            filtered: other.frame.color("")?.values().to_vec(),
            ewa: full.color("")?.values().to_vec(),
            inside: inside.iter().map(|region| *region == Region::Interior).collect(),
            selected,
        });
    }
    Ok(found(&shots, count))
}

fn found(shots: &[Shot], count: f64) -> Found {
    let mut sums = [0.0; 7];
    for pair in shots.windows(2) {
        let [a, b] = [&pair[0], &pair[1]];
        let pixels: Vec<usize> =
            (0..a.inside.len()).filter(|&i| a.inside[i] && b.inside[i]).collect();
        let of =
            |colors: &[[f32; 3]]| -> Vec<f32> { pixels.iter().flat_map(|&i| colors[i]).collect() };
        let [d0, d1, e0, e1] = [&a.deferred, &b.deferred, &a.ewa, &b.ewa].map(|c| of(c));
        let [m0, m1] = [&a.filtered, &b.filtered].map(|c| of(c));
        let change = |from: &[f32], to: &[f32]| -> Vec<f32> {
            from.iter().zip(to).map(|(from, to)| to - from).collect()
        };
        let [flicker, less] =
            [(&d0, &d1), (&m0, &m1)].map(|(from, to)| rmse(&change(from, to), &change(&e0, &e1)));
        let culled = 1e2 * (1.0 - f64::from(a.selected) / count);
        let [error, other] = [rmse(&d0, &e0), rmse(&m0, &e0)];
        let all = [culled, rmse(&d0, &d1), rmse(&e0, &e1), flicker, less, error, other];
        (0..7).for_each(|i| sums[i] += all[i] / (shots.len() - 1) as f64);
    }
    let [culled, deferred, ewa, flicker, less, error, other] = sums;
    Found { culled, deferred, ewa, flicker: [flicker, less], error: [error, other] }
}
