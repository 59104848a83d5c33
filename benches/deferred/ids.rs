//! What ids of 40 bits cost against those of 32 \[GBP04, 4.2\]: the same scene by both splits.
//!
//! 200 spheres of 2,250 surfels in ten ranks of twenty, 512 x 512 pixels, two threads, m = 1. The frames
//! of both splits are drawn in turn, each from what its last one saw; the first two do not count, and
//! every number is a median. *With all planes* is the definition, which leaves the planes of all stages: of
//! 40 bits four more of 8 bits.

use super::common::report::{Arguments, Table};
use glam::{DVec3, Vec3};
use splatref::frame::Exec;
use splatref::method::{Session, deferred};
use splatref::scene::objects::{Geometry, Motion, Object, Objects, Split};
use splatref::scene::{Camera, Lens, Primitives, Scene, Similarity, Sphere, Surfels};
use splatref::source::Shape;
use splatref::{Error, Result};
use std::time::Instant;

const NAME: &str = "ids of 40 bits";
const SIDE: u32 = 512;
const BEFORE: usize = 2;
const FRAMES: usize = 21;
/// The definition takes longer.
const DEFINED: usize = 5;
/// The first that fits, and one in which the 8 bits of the stencil are the object's.
const SPLITS: [Split; 2] = [Split::Even, Split::Stencil(32)];

pub(crate) fn table(arguments: &Arguments, exec: &Exec) -> Result<()> {
    if !NAME.contains(&arguments.pattern) {
        return Ok(());
    }
    let objects = spheres()?;
    let scenes = SPLITS
        .map(|split| {
            let fits = objects.split_as(split);
            let objects = fits.ok_or_else(|| Error::Invalid(format!("{split:?} does not fit")))?;
            Ok(Scene { objects: Some(objects), ..Scene::lit(NAME, Surfels::none()) })
        })
        .into_iter()
        .collect::<Result<Vec<Scene>>>()?;
    let sphere = Sphere { center: DVec3::ZERO, radius: 9.0 };
    let from = DVec3::new(0.0, 0.2, 1.0);
    let camera = Camera::framing(SIDE, SIDE, sphere, from, Lens::FieldOfView(34.0))?;
    let method = deferred::Settings::default().into();
    let sessions = scenes.iter().map(|scene| Session::new(scene, method, exec));
    let mut sessions = sessions.collect::<Result<Vec<_>>>()?;
    let none = || [Vec::new(), Vec::new()];
    let (mut frames, mut indices, mut defined) = (none(), none(), none());
    for frame in 0..BEFORE + FRAMES {
        for (i, session) in sessions.iter_mut().enumerate() {
            let start = Instant::now();
            let picture = session.render(&camera)?;
            let time = start.elapsed();
            let of_pass = picture.timings.iter().find(|(name, _)| *name == "indices");
            if frame >= BEFORE {
                frames[i].push(time);
                indices[i].extend(of_pass.map(|(_, time)| *time));
            }
        }
    }
    for _ in 0..DEFINED {
        for (i, session) in sessions.iter().enumerate() {
            let start = Instant::now();
            session.define::<f32>(&camera, true)?;
            defined[i].push(start.elapsed());
        }
    }
    let mut table = Table::new(&["", "32 bits, ms", "40 bits, ms", "ratio"]);
    for (what, times) in [("frame", frames), ("pass 2", indices), ("with all planes", defined)] {
        let [a, b] = times.map(|mut times| {
            times.sort_unstable();
            times[times.len() / 2].as_secs_f64() * 1e3
        });
        table.row(&format!("{what} | {a:.2} | {b:.2} | {:.2}", b / a));
    }
    table.publish_times(arguments, "gbp04.md", "wide-ids")
}

fn spheres() -> Result<Objects> {
    let surfels = Shape::Sphere.surfels(2_250, 1)?;
    let primitives = Primitives::default();
    let geometry = Geometry { name: "sphere".into(), surfels, primitives, detail: None };
    let object = |i: u32| {
        let [column, rank] = [i % 20, i / 20].map(f64::from);
        let place = Similarity {
            scale: 0.5,
            translation: DVec3::new(column - 9.5, 0.0, 1.25 * (4.5 - rank)),
            ..Similarity::IDENTITY
        };
        Object { name: format!("{i}"), geometry: 0, motion: Motion::still(place), color: None }
    };
    Objects::new(vec![geometry], (0..200).map(object).collect(), Vec3::splat(0.75))
}
