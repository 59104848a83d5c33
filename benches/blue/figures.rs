//! Fig. 4, 7 and 8 of \[BJFM19\] again, as pictures for `--pictures`, and a table.

use super::common::plant::pipes;
use super::common::report::{Arguments, Table};
use super::instanced::{Rings, view};
use super::scene::{against, blue, draw, percent};
use glam::DVec3;
use splatref::Result;
use splatref::frame::{Exec, Frame, Plane, Samples};
use splatref::scene::{Camera, Lens, Pose, Primitives, Scene, Similarity};
use splatref::source::candidates::{Directions, SIDE};
use splatref::study::atlas::orders::{geometry, mesh, objects, order, seen};
use splatref::verify::metrics::ssim_map;
use std::time::Instant;

/// Lengths of prefixes in Fig. 4.
const PREFIXES: [usize; 4] = [100, 1000, 10_000, 100_000];
/// The side of a large picture in Fig. 4, in pixels, and how wide discs are where a prefix is meant to be seen.
const LARGE: u32 = 400;
const MEANT: f32 = 2.0;
/// Rows and columns between pictures, in pixels.
const GAP: u32 = 4;
/// The picture of Fig. 7, the width of its discs, and those of Fig. 8.
const VIEW: [u32; 2] = [640, 360];
const SIZE: f32 = 2.0;
const SIZES: [f32; 4] = [1.0, 2.0, 4.0, 8.0];

type Color = Plane<[f32; 3]>;

/// Fig. 4: prefixes of one order of the pipes, each as large as the pipes themselves, and as small as it is meant for.
pub(crate) fn prefixes(arguments: &Arguments, exec: &Exec) -> Result<()> {
    let pipes = mesh(pipes()?);
    let all = order(&pipes, (&Directions::Cube, SIDE), PREFIXES[3], exec)?;
    let camera = |side: u32| {
        let (eye, target) = (DVec3::new(2.2, 1.8, 2.9), DVec3::splat(0.55));
        Camera::new(side, side, Pose { eye, target, up: DVec3::Y }, Lens::FieldOfView(40.0))
    };
    let of = |count: usize, size: f32, side: u32| -> Result<Scene> {
        let some: Vec<u32> = (0..count as u32).collect();
        let prefix = geometry(all.some(&some), Primitives::default())?;
        seen(&objects(prefix, &[Similarity::IDENTITY])?, size, &camera(side)?, exec)
    };
    // What discs of 64 px ask for in a small picture; the number goes with the square of pixels over size.
    let asked = of(PREFIXES[3], 64.0, 64)?.surfels.len();
    let (mut large, mut small) = (Vec::new(), Vec::new());
    for count in PREFIXES {
        let side = (f64::from(MEANT) * (count as f64 / asked as f64).sqrt()).round() as u32;
        println!("Fig. 4: {count} surfels, {side} x {side} pixels");
        large.push(color(draw(&of(count, MEANT, LARGE)?, blue(), &camera(LARGE)?, exec)?));
        small.push(color(draw(&of(count, MEANT, side)?, blue(), &camera(side)?, exec)?));
    }
    large.push(color(draw(&pipes, blue(), &camera(LARGE)?, exec)?));
    let below = small.iter().map(Plane::height).max().unwrap_or(0);
    let mut page = Plane::filled(5 * LARGE + 4 * GAP, LARGE + GAP + below, [1.0; 3]);
    for (i, (large, small)) in large.iter().zip(small.iter().map(Some).chain([None])).enumerate() {
        let left = i as u32 * (LARGE + GAP);
        place(&mut page, large, [left, 0]);
        if let Some(small) = small {
            place(&mut page, small, [left, LARGE + GAP]);
        }
    }
    arguments.picture("bjfm19-prefixes.png", &page)
}

/// Fig. 7: a view of discs, that of all triangles, and the similarity of both; Fig. 8: a view from close by.
pub(crate) fn views(rings: &Rings, arguments: &Arguments, exec: &Exec) -> Result<()> {
    let [width, height] = VIEW;
    let camera = view("overview", VIEW)?;
    let truth = rings.truth(&camera, exec)?;
    let found = draw(&seen(&rings.all, SIZE, &camera, exec)?, blue(), &camera, exec)?;
    let [found, truth] = [found, truth].map(color);
    let map = similarity(&found, &truth);
    let mut page = Plane::filled(width, 3 * height + 2 * GAP, [1.0; 3]);
    for (i, part) in (0..).zip([&found, &truth, &map]) {
        place(&mut page, part, [0, i * (height + GAP)]);
    }
    arguments.picture("bjfm19-view.png", &page)?;

    let camera = view("close", VIEW)?;
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
        if size == SIZES[1] {
            arguments.picture("bjfm19-close.png", &color(found))?;
        }
    }
    table.publish_times(arguments, "bjfm19.md", "close")
}

/// Pixels that show a triangle, and those that show anything.
fn of_triangles(frame: &Frame<f32>, surfels: usize) -> (u64, u64) {
    let Some(Samples::Index(ids)) = frame.plane("id") else { return (0, 0) };
    let seen = ids.values().iter().filter(|&&id| id != u32::MAX);
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

fn color(frame: Frame<f32>) -> Color {
    let found = frame.planes.into_iter().find(|plane| plane.name.is_empty());
    match found.map(|plane| plane.samples) {
        Some(Samples::Color(color)) => color,
        _ => Plane::filled(1, 1, [0.0; 3]),
    }
}

/// Puts a picture into a larger one.
fn place(page: &mut Color, part: &Color, [left, top]: [u32; 2]) {
    let (into, width) = (page.width() as usize, part.width() as usize);
    for (y, row) in part.values().chunks_exact(width).enumerate() {
        let first = (top as usize + y) * into + left as usize;
        page.values_mut()[first..first + width].copy_from_slice(row);
    }
}
