//! What EWA splatting comes to without the limits of a pixel.

use super::{How, SAMPLES, Truth, frame, mean};
use crate::error::Result;
use crate::frame::{Exec, Frame, NamedPlane, Plane, Rect, Samples};
use crate::memory;
use crate::method::{Method, Session, ewa, peeling};
use crate::scene::{Camera, Scene};

/// The true picture of a scene of surfels alone, and its colours under shifts by eighths of a pixel, each 0
/// to 7; see the [module](super). Primitives are not shown.
///
/// # Errors
/// As [`Session::define`], and [`crate::Error::Invalid`] if the process may not hold what it takes.
pub fn of_points(
    scene: &Scene,
    (camera, shifts): (&Camera, &[[u32; 2]]),
    exec: &Exec,
    progress: &dyn Fn(&str, u64, u64),
) -> Result<Truth> {
    let pixels = u64::from(camera.width) * u64::from(camera.height);
    memory::ask(pixels * 32 + LARGE * 256, || "the true picture".into())?;
    let method = match scene.surfels.opacity() {
        None => Method::Ewa(ewa::Settings::default()),
        Some(_) => Method::Peeling(peeling::Settings::default()),
    };
    let surfels = Scene { primitives: Default::default(), objects: None, ..scene.clone() };
    let session = Session::new(&surfels, method, exec)?;
    let whole = session.define::<f64>(camera, false)?.frame.to_f32();
    let (width, height) = (camera.width, camera.height);
    let mut colors = vec![Plane::filled(width, height, [0.0; 3]); shifts.len() + 1];
    let blocks = blocks(camera);
    for (done, block) in blocks.iter().enumerate() {
        progress("the true picture", done as u64, blocks.len() as u64);
        let large = session.define::<f64>(&enlarged(camera, block), false)?.frame;
        let samples = large.color("")?;
        let row = samples.width() as usize;
        let all = [[0, 0]];
        for (plane, &[kx, ky]) in colors.iter_mut().zip(all.iter().chain(shifts)) {
            let first = |v: u32, from: u32, shift: u32| (SAMPLES * (v - from + 1) - shift) as usize;
            for y in block.y0..block.y1 {
                for x in block.x0..block.x1 {
                    let at = [first(x, block.x0, kx), first(y, block.y0, ky)];
                    plane.values_mut()[(y * width + x) as usize] = mean(samples.values(), row, at);
                }
            }
        }
    }
    let shifted = colors.split_off(1);
    Ok(Truth { frame: with_color(whole, colors)?, how: How::Points, shifted })
}

/// The most pixels of a block at its large size.
const LARGE: u64 = 1 << 22;
/// The most pixels of the picture along a side of a block, of which there is one more before.
const SIDE: u32 = 255;

/// A picture in parts.
fn blocks(camera: &Camera) -> Vec<Rect> {
    let part = |size: u32| {
        let starts = (0..size).step_by(SIDE as usize);
        starts.map(move |start| (start, size.min(start + SIDE)))
    };
    let rows = part(camera.height);
    rows.flat_map(|(y0, y1)| part(camera.width).map(move |(x0, x1)| Rect { x0, y0, x1, y1 }))
        .collect()
}

/// The camera that sees a block, with the pixels before it, at the large size.
fn enlarged(camera: &Camera, block: &Rect) -> Camera {
    let side = SAMPLES as f32;
    let before = |from: u32| side * (from as f32 - 1.0);
    Camera {
        width: SAMPLES * (block.x1 - block.x0 + 1),
        height: SAMPLES * (block.y1 - block.y0 + 1),
        fx: camera.fx * side,
        fy: camera.fy * side,
        cx: camera.cx * side - before(block.x0),
        cy: camera.cy * side - before(block.y0),
        ..*camera
    }
}

/// The planes of a truth, of a picture at its own size and other colours.
fn with_color(whole: Frame<f32>, colors: Vec<Plane<[f32; 3]>>) -> Result<Frame<f32>> {
    let (alpha, depth) = (whole.scalar("A")?.clone(), whole.scalar("Z")?.clone());
    let normal = whole.planes.iter().find_map(|NamedPlane { name, samples }| match samples {
        Samples::Vector(plane) if name == "normal" => Some(plane.clone()),
        _ => None,
    });
    let color = colors
        .into_iter()
        .next()
        .unwrap_or_else(|| Plane::filled(whole.width, whole.height, [0.0; 3]));
    Ok(frame(color, alpha, depth, normal))
}
