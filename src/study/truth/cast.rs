//! Casts rays at surfaces, tile by tile.

use super::caster::Caster;
use super::tile::{Seen, Tile};
use super::{How, SAMPLES, Surface, Truth, frame};
use crate::error::Result;
use crate::frame::{Exec, Plane, Rect};
use crate::memory;
use crate::progress::Progress;
use crate::scene::{Camera, Scene};

/// The true picture of surfaces under the lights of a scene, and its colours under shifts by
/// eighths of a pixel, each 0 to 7; see the [module](super).
///
/// # Errors
/// [`crate::Error::Invalid`] as [`Camera::check`] and [`crate::scene::Similarity::check`], if a
/// parameter of a shape is out of range, or if the memory limit is too low.
pub fn of_surfaces(
    surfaces: &[Surface],
    scene: &Scene,
    cull: bool,
    camera: &Camera,
    shifts: &[[u32; 2]],
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<Truth> {
    camera.check()?;
    let grid = exec.grid(camera.width, camera.height);
    let mut all: Vec<(usize, Rect)> = grid.rects().into_iter().enumerate().collect();
    // A few tiles at a time, so that progress is seen and results are stored early.
    let some = SOME.max(4 * exec.threads());
    ask(camera, shifts.len(), grid.side, exec)?;
    let caster = Caster::new(surfaces, scene, cull, camera, exec)?;
    let mut planes = Planes::new(camera, shifts.len() + 1);
    let (count, mut done) = (all.len() as u64, 0);
    while !all.is_empty() {
        progress(STEP, done, count);
        let jobs: Vec<_> = all.drain(..some.min(all.len())).collect();
        done += jobs.len() as u64;
        let tiles = exec.ordered(jobs, |(i, rect)| (rect, caster.tile(i, &rect, shifts)));
        tiles.iter().for_each(|(rect, tile)| planes.put(rect, tile));
    }
    progress(STEP, count, count);
    let exact = surfaces.iter().all(|surface| matches!(surface, Surface::Shape { .. }));
    let how = if exact { How::Exact } else { How::Triangles };
    let Planes { mut colors, alpha, depth, normal } = planes;
    let shifted = colors.split_off(1);
    let color = colors.remove(0);
    Ok(Truth { frame: frame(color, alpha, depth, Some(normal)), how, shifted })
}

/// The name of the step in progress reports.
pub(super) const STEP: &str = "rendering the true picture";
/// The least number of tiles between two progress reports.
const SOME: usize = 64;

/// Checks that the memory limit allows the planes, and the samples of the tiles that are computed
/// at once.
fn ask(camera: &Camera, shifts: usize, [wide, high]: [u32; 2], exec: &Exec) -> Result<()> {
    let pixels = u64::from(camera.width) * u64::from(camera.height);
    let planes = pixels * (32 + 12 * shifts as u64);
    let samples = u64::from(SAMPLES * (wide + 1)) * u64::from(SAMPLES * (high + 1));
    let samples = exec.threads() as u64 * samples * OF_A_SAMPLE;
    memory::ask(planes + samples, || {
        format!("the true picture of {} x {} pixels", camera.width, camera.height)
    })
}

/// Bytes of a sample: the nearest surface, with normal and colour for shapes, and the colour.
const OF_A_SAMPLE: u64 = 192;
/// The planes of the picture, with its colours and those under each shift.
struct Planes {
    colors: Vec<Plane<[f32; 3]>>,
    alpha: Plane<f32>,
    depth: Plane<f32>,
    normal: Plane<[f32; 3]>,
}

impl Planes {
    fn new(&Camera { width, height, .. }: &Camera, colors: usize) -> Self {
        let vectors = || Plane::filled(width, height, [0.0; 3]);
        Self {
            colors: (0..colors).map(|_| vectors()).collect(),
            alpha: Plane::filled(width, height, 0.0),
            depth: Plane::filled(width, height, 0.0),
            normal: vectors(),
        }
    }

    fn put(&mut self, rect: &Rect, tile: &Tile) {
        for (plane, colors) in self.colors.iter_mut().zip(&tile.colors) {
            put(plane, rect, colors, |color| *color);
        }
        let seen = &tile.seen;
        put(&mut self.alpha, rect, seen, |seen: &Seen| seen.alpha);
        put(&mut self.depth, rect, seen, |seen: &Seen| seen.depth);
        put(&mut self.normal, rect, seen, |seen| seen.normal);
    }
}

/// Writes the values of the pixels in a rectangle, row by row.
fn put<T, U>(plane: &mut Plane<U>, rect: &Rect, values: &[T], of: impl Fn(&T) -> U) {
    let width = plane.width() as usize;
    for (y, row) in (rect.y0 as usize..).zip(values.chunks(rect.columns())) {
        let to = &mut plane.values_mut()[y * width + rect.x0 as usize..];
        to.iter_mut().zip(row).for_each(|(to, value)| *to = of(value));
    }
}
