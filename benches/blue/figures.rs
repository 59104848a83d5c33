//! Fig. 4, 7 and 8 of \[BJFM19\] again, as pictures for `--pictures`, and a table.

use super::common::plant::pipes;
use super::common::report::{Arguments, Table};
use super::instanced::{CLOSE, OVERVIEW, Rings};
use super::scene::{against, blue, draw, percent};
use glam::DVec3;
use splatref::Result;
use splatref::compare::metrics::ssim_map;
use splatref::frame::{Exec, Frame, NO_ID, Plane, Samples};
use splatref::scene::{Camera, Lens, Pose, Primitives, Similarity};
use splatref::source::candidates::{Directions, SIDE};
use splatref::study::atlas::beside;
use splatref::study::atlas::orders::{geometry, mesh, objects, order, seen};
use std::time::Instant;

/// Lengths of prefixes in Fig. 4.
const PREFIXES: [usize; 4] = [100, 1000, 10_000, 100_000];
/// The side of a large picture in Fig. 4, in pixels, and how wide discs are where a prefix is meant to be seen.
const LARGE: u32 = 400;
const MEANT: f32 = 2.0;
/// The picture of Fig. 7 and 8, the width of discs in both, and the widths that are measured.
const VIEW: [u32; 2] = [640, 360];
const SIZE: f32 = 2.0;
const SIZES: [f32; 4] = [1.0, SIZE, 4.0, 8.0];

type Color = Plane<[f32; 3]>;

/// Fig. 4: prefixes of one order of the pipes, each as large as the pipes themselves, and as small as it is meant for.
pub(crate) fn prefixes(arguments: &Arguments, exec: &Exec) -> Result<()> {
    let pipes = mesh(pipes()?);
    let all = order(&pipes, &Directions::Cube, SIDE, PREFIXES[3], exec)?;
    let prefix = |count: usize| {
        let some: Vec<u32> = (0..count as u32).collect();
        objects(geometry(all.some(&some), Primitives::default())?, &[Similarity::IDENTITY])
    };
    let camera = |side: u32| {
        let (eye, target) = (DVec3::new(2.2, 1.8, 2.9), DVec3::splat(0.55));
        Camera::new(side, side, Pose { eye, target, up: DVec3::Y }, Lens::FieldOfView(40.0))
    };
    // What discs of 64 px ask for in a small picture; the number goes with the square of pixels over size.
    let asked = seen(&prefix(PREFIXES[3])?, 64.0, &camera(64)?, exec)?.surfels.len();
    let (mut large, mut small) = (Vec::new(), Vec::new());
    for count in PREFIXES {
        let prefix = prefix(count)?;
        let side = (f64::from(MEANT) * (count as f64 / asked as f64).sqrt()).round() as u32;
        println!("Fig. 4: {count} surfels, {side} x {side} pixels");
        for (side, pictures) in [(LARGE, &mut large), (side, &mut small)] {
            let camera = camera(side)?;
            let scene = seen(&prefix, MEANT, &camera, exec)?;
            pictures.push(draw(&scene, blue(), &camera, exec)?.color("")?.clone());
        }
    }
    large.push(draw(&pipes, blue(), &camera(LARGE)?, exec)?.color("")?.clone());
    keep(arguments, "bjfm19-prefixes.png", &large)?;
    keep(arguments, "bjfm19-prefixes-meant.png", &small)
}

/// Fig. 7: a view of discs, that of all triangles, and the similarity of both.
pub(crate) fn similar(rings: &Rings, arguments: &Arguments, exec: &Exec) -> Result<()> {
    let camera = OVERVIEW.camera(VIEW)?;
    let truth = rings.truth(&camera, exec)?;
    let found = draw(&seen(&rings.all, SIZE, &camera, exec)?, blue(), &camera, exec)?;
    let [found, truth] = [found.color("")?, truth.color("")?];
    let all = [found.clone(), truth.clone(), similarity(found, truth)];
    keep(arguments, "bjfm19-view.png", &all)
}

/// Fig. 8: a view from close by.
pub(crate) fn close(rings: &Rings, arguments: &Arguments, exec: &Exec) -> Result<()> {
    let camera = CLOSE.camera(VIEW)?;
    let start = Instant::now();
    let truth = rings.truth(&camera, exec)?;
    let time = 1e3 * start.elapsed().as_secs_f64();
    let mut table = Table::new(&[
        "size, px",
        "surfels",
        "triangles",
        "pixels of triangles, %",
        "choosing, placing and drawing, ms",
        "holes, %",
    ]);
    table.row(&format!("all triangles | 0 | {} | 100 | {time:.0} | 0", rings.triangles()));
    for size in SIZES {
        let start = Instant::now();
        let scene = seen(&rings.all, size, &camera, exec)?;
        let found = draw(&scene, blue(), &camera, exec)?;
        let time = 1e3 * start.elapsed().as_secs_f64();
        let covered = against(&found, &truth);
        let (triangles, seen) = of_triangles(&found, scene.surfels.len());
        table.row(&format!(
            "{size} | {} | {} | {:.1} | {time:.0} | {:.2}",
            scene.surfels.len(),
            scene.primitives.len(),
            percent(triangles, seen),
            percent(covered.holes, covered.interior)
        ));
        if size == SIZE {
            arguments.picture("bjfm19-close.png", found.color("")?)?;
        }
    }
    table.publish_times(arguments, "bjfm19.md", "close")
}

/// Pixels that show a triangle, and those that show anything.
fn of_triangles(frame: &Frame<f32>, surfels: usize) -> (u64, u64) {
    let Some(Samples::Index(ids)) = frame.plane("id") else { return (0, 0) };
    let seen = ids.values().iter().filter(|&&id| id != NO_ID);
    seen.fold((0, 0), |(triangles, all), &id| {
        (triangles + u64::from(id as usize >= surfels), all + 1)
    })
}

/// The mean similarity of the three channels at each pixel, from 0 to 1; 1 at the border, where no window fits.
fn similarity(a: &Color, b: &Color) -> Color {
    let (width, channel) = (a.width() as usize, |plane: &Color, c: usize| -> Vec<f32> {
        plane.values().iter().map(|color| color[c]).collect()
    });
    let mut mean = Plane::filled(a.width(), a.height(), [1.0_f32; 3]);
    let maps: Vec<_> =
        (0..3).filter_map(|c| ssim_map(&channel(a, c), &channel(b, c), width)).collect();
    let [one, two, three] = &maps[..] else { return mean };
    for (i, ((one, two), three)) in one.iter().zip(two).zip(three).enumerate() {
        let (x, y) = (i % (width - 10) + 5, i / (width - 10) + 5);
        let value = (one + two + three) / 3.0;
        mean.values_mut()[y * width + x] = [if value > 0.0 { value as f32 } else { 0.0 }; 3];
    }
    mean
}

/// Pictures side by side.
fn keep(arguments: &Arguments, name: &str, pictures: &[Color]) -> Result<()> {
    beside(pictures).map_or(Ok(()), |page| arguments.picture(name, &page))
}
