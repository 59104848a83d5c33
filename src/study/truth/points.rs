//! The limit of EWA splatting without pixels.

use super::cast::STEP;
use super::{How, SAMPLES, Truth, frame, mean};
use crate::error::Result;
use crate::frame::{Exec, NamedPlane, Plane, Rect, Samples};
use crate::memory;
use crate::method::{Method, Session, ewa, peeling};
use crate::progress::Progress;
use crate::scene::{Camera, Primitives, Scene};
use std::borrow::Cow;

/// The true picture of a scene of surfels, and its colours under shifts by eighths of a pixel, each
/// 0 to 7; see the [module](super). Primitives are not shown.
///
/// The samples are drawn in blocks of 127 x 127 pixels, counted from the top left, each by a camera
/// of its own. Its scale is 8 times the camera's, and its centre is at 8 cx - 8 (x0 - 1) and
/// likewise in y, rounded to `f32`, with x0 the first column of the block. Samples may therefore be
/// off by up to width / 2^24 px; they are exact if cx and cy are multiples of 1/16.
///
/// # Errors
/// As [`Session::define`], and [`crate::Error::Invalid`] if the memory limit is too low.
pub fn of_points(
    scene: &Scene,
    camera: &Camera,
    shifts: &[[u32; 2]],
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<Truth> {
    camera.check()?;
    let (width, height) = (camera.width, camera.height);
    let pixels = u64::from(width) * u64::from(height);
    let colors = 1 + shifts.len();
    memory::ask(pixels * (20 + 12 * colors as u64), || {
        format!("the true picture of {width} x {height} pixels")
    })?;
    let (method, how) = match scene.surfels.opacity() {
        None => (Method::Ewa(ewa::Settings::default()), How::Points),
        Some(_) => (Method::Peeling(peeling::Settings::default()), How::Layers),
    };
    let surfels = of_surfels(scene);
    let session = Session::new(&surfels, method, exec)?;
    let whole = session.define::<f64>(camera, false)?.frame.to_f32();
    let mut colors = vec![Plane::filled(width, height, [0.0; 3]); colors];
    let blocks = blocks(camera);
    for (done, block) in (0..).zip(&blocks) {
        progress(STEP, done, blocks.len() as u64);
        let large = session.define::<f64>(&enlarged(camera, block), false)?.frame;
        let samples = large.color("")?;
        let row = samples.width() as usize;
        let all = [[0, 0]];
        for (plane, &[kx, ky]) in colors.iter_mut().zip(all.iter().chain(shifts)) {
            let first = |v: u32, from: u32, shift: u32| (SAMPLES * (v - from + 1) - shift) as usize;
            for y in block.y0..block.y1 {
                for x in block.x0..block.x1 {
                    let at = [first(x, block.x0, kx), first(y, block.y0, ky)];
                    let to = y as usize * width as usize + x as usize;
                    plane.values_mut()[to] = mean(samples.values(), row, at);
                }
            }
        }
    }
    progress(STEP, blocks.len() as u64, blocks.len() as u64);
    let shifted = colors.split_off(1);
    let (alpha, depth) = (whole.scalar("A")?.clone(), whole.scalar("Z")?.clone());
    let normal = whole.planes.into_iter().find_map(|NamedPlane { name, samples }| match samples {
        Samples::Vector(plane) if name == "normal" => Some(plane),
        _ => None,
    });
    Ok(Truth { frame: frame(colors.remove(0), alpha, depth, normal), how, shifted })
}

/// The scene with nothing but its surfels.
fn of_surfels(scene: &Scene) -> Cow<'_, Scene> {
    if scene.primitives.is_empty() && scene.objects.is_none() {
        return Cow::Borrowed(scene);
    }
    let surfels = Scene { primitives: Primitives::default(), objects: None, ..scene.clone() };
    Cow::Owned(surfels)
}

/// The largest number of pixels along a side of a block; one more comes before them.
const SIDE: u32 = 127;

/// A picture in blocks.
fn blocks(camera: &Camera) -> Vec<Rect> {
    let part = |size: u32| {
        let starts = (0..size).step_by(SIDE as usize);
        starts.map(move |start| (start, size.min(start + SIDE)))
    };
    let rows = part(camera.height);
    rows.flat_map(|(y0, y1)| part(camera.width).map(move |(x0, x1)| Rect { x0, y0, x1, y1 }))
        .collect()
}

/// The camera that sees a block and the pixels before it, at the large size.
fn enlarged(camera: &Camera, block: &Rect) -> Camera {
    let side = SAMPLES as f32;
    let center = |center: f32, from: u32| {
        let before = f64::from(SAMPLES) * (f64::from(from) - 1.0);
        (f64::from(SAMPLES) * f64::from(center) - before) as f32
    };
    Camera {
        width: SAMPLES * (block.x1 - block.x0 + 1),
        height: SAMPLES * (block.y1 - block.y0 + 1),
        fx: camera.fx * side,
        fy: camera.fy * side,
        cx: center(camera.cx, block.x0),
        cy: center(camera.cy, block.y0),
        ..*camera
    }
}
