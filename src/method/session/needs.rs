//! Estimate the memory of a picture from above. `tests/memory.rs` checks the estimates for every
//! method.

use super::Session;
use crate::error::{Error, Result};
use crate::frame::{Rect, pyramid};
use crate::memory;
use crate::method::{Holds, Job, PlaneRow, When, gaussians, peeling};
use crate::scene::{Camera, Objects};

/// The call that makes a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Making {
    /// By [`Session::render`].
    Render,
    /// By [`Session::define`], in numbers of `number` bytes, with or without the planes of the
    /// stages.
    Define {
        /// Bytes of a number: 4 or 8.
        number: u64,
        /// Whether the planes of the stages are kept.
        stages: bool,
    },
    /// By [`Session::verify`], with the planes of one more client.
    Verdict,
}

impl Session<'_> {
    /// About the most bytes that a picture needs beside the session, with the picture itself; of a
    /// region, if [`Session::set_region`] set one.
    #[must_use]
    pub fn needs(&self, camera: &Camera, making: Making) -> u64 {
        self.needs_of(self.window(camera).unwrap_or(Rect::of_size(camera.size())), camera, making)
    }

    /// As [`Session::needs`], for these pixels of the picture.
    fn needs_of(&self, window: Rect, camera: &Camera, making: Making) -> u64 {
        let pixels = window.pixels() as u64;
        if making == Making::Verdict {
            let cells = if self.has_levels() { OF_JUDGED_CELLS } else { 0 };
            let a_pixel = OF_A_JUDGED_PIXEL + cells + self.planes(camera, 8);
            let of_item = if self.method.draws_gaussians() {
                OF_A_JUDGED_GAUSSIAN
            } else {
                OF_A_JUDGED_SPLAT
            };
            let judged = pixels * a_pixel + self.items(pixels, making) * of_item;
            if !self.method.draws_objects() {
                return judged;
            }
            // All surfels are placed before it is known which of them are drawn.
            return judged + pixels * OF_JUDGED_PASSES + self.surfels() * OF_A_JUDGED_CENTRE;
        }
        let fast = self.method.fast_bytes_a_pixel().filter(|_| making == Making::Render);
        let number = if let Making::Define { number, .. } = making { number } else { 4 };
        let kept = match making {
            Making::Define { stages: true, .. } => self.planes(camera, number),
            _ => 0,
        };
        // Planes of stages are there twice: as records and as planes, or in numbers of two types.
        let a_pixel = fast.unwrap_or(number * OF_A_PIXEL + 2 * kept);
        pixels * a_pixel + self.items(pixels, making) * self.needs_a_splat(making)
    }

    /// About the most bytes that [`Session::render`] or [`Session::define`] needs for one surfel more.
    #[must_use]
    pub fn needs_a_splat(&self, making: Making) -> u64 {
        let (number, stages) = match making {
            Making::Define { number, stages } => (number, stages),
            _ if self.method.fast_bytes_a_pixel().is_some() => return OF_A_FAST_SPLAT,
            _ => (4, false),
        };
        let mut rows = self.method.stages().iter().flat_map(|stage| stage.leaves);
        // Only a plane of a whole picture, such as a margin, needs the splats in balls.
        let balls = if stages && rows.any(|row| row.when == When::Whole) { OF_A_BALL } else { 0 };
        number * OF_A_SPLAT + balls
    }

    /// The most items that are drawn. For a method that selects surfels, as many as it may select.
    /// When such a method knows what it draws of an earlier frame, it asks for that memory itself.
    fn items(&self, pixels: u64, making: Making) -> u64 {
        if self.method.draws_objects() {
            return self.surfels().min(pixels);
        }
        if let (Making::Render, Some(members)) = (making, &self.index.members) {
            return members.splats() as u64;
        }
        let items = self.index.order.as_ref().map_or(gaussians::splats::count(self.scene), |_| {
            // A surfel is drawn once in each of its groups.
            self.index.groups.as_ref().map_or(0, |groups| groups.own().len() + groups.added().len())
        });
        items as u64
    }

    /// The most surfels that a method that draws objects may draw.
    fn surfels(&self) -> u64 {
        let objects = self.scene.objects.as_ref().map(Objects::drawn_total);
        objects.unwrap_or(self.scene.surfels.len() as u64)
    }

    /// Whether the method leaves planes of levels.
    fn has_levels(&self) -> bool {
        let mut rows = self.method.stages().iter().flat_map(|stage| stage.leaves);
        rows.any(|row| copies_of(row) == Copies::Levels)
    }

    /// Bytes of the planes of all stages, a pixel.
    fn planes(&self, camera: &Camera, number: u64) -> u64 {
        let levels = pyramid::sizes(camera.width, camera.height).len() as u64;
        let groups = self.index.groups.as_ref().map_or(1, |groups| groups.len() as u64);
        let copies = |row: &PlaneRow| match copies_of(row) {
            Copies::One => 1,
            Copies::Groups => groups,
            Copies::Layers => u64::from(peeling::STAGES),
            Copies::Levels => levels,
        };
        let bytes = |row: &PlaneRow| match row.holds.plain() {
            Holds::Color | Holds::Vector => 3 * number,
            Holds::Index => 4,
            Holds::Count => 1,
            _ => number,
        };
        let rows = self.method.stages().iter().flat_map(|stage| stage.leaves);
        let kept = rows.filter(|row| row.when != When::Alone);
        kept.map(|row| copies(row) * bytes(row)).sum()
    }

    /// Checks that the process may hold one more picture.
    pub(crate) fn ask(&self, job: &Job<'_>, making: Making) -> Result<()> {
        let [width, height] = job.size();
        let what = || format!("a picture of {width} x {height} pixels by {}", self.method.name());
        let parts = making != Making::Verdict && self.method.needs_whole_picture().is_none();
        let cure = match parts {
            true if job.window.pixels() < Rect::of_size(job.camera.size()).pixels() => {
                "draw smaller parts (--region)"
            }
            true => "draw it in parts (--bands auto)",
            false => "reduce the work",
        };
        memory::try_ask_or(self.needs_of(job.window, job.camera, making), what, cure)
            .map_err(Error::Invalid)
    }
}

/// The things for which a row has one plane each.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Copies {
    One,
    Groups,
    Layers,
    Levels,
}

fn copies_of(row: &PlaneRow) -> Copies {
    match row.name {
        name if !name.contains('#') => Copies::One,
        name if name.contains("group##") => Copies::Groups,
        name if name.starts_with("layer") => Copies::Layers,
        _ => Copies::Levels,
    }
}

/// Numbers of a pixel that passes hold at once, with the planes of the picture, at most.
const OF_A_PIXEL: u64 = 80;
/// Numbers of a splat, with the bins that list it.
const OF_A_SPLAT: u64 = 64;
/// Bytes of a splat of a fast path, with the bins that list it. A million small splats of a torus took
/// 127 at most.
const OF_A_FAST_SPLAT: u64 = 160;
/// Bytes of a splat in a verdict, and of a pixel beside the planes of a client.
const OF_A_JUDGED_SPLAT: u64 = 704;
/// A Gaussian in balls, twice where batches are joined.
const OF_A_JUDGED_GAUSSIAN: u64 = 1800;
const OF_A_JUDGED_PIXEL: u64 = 128;
/// Bytes of a pixel that the passes before the sums leave in balls, and, in place of a splat, of a
/// surfel whose centre is placed in balls.
const OF_JUDGED_PASSES: u64 = 256;
const OF_A_JUDGED_CENTRE: u64 = 640;
/// Bytes of the cells of all levels in balls, a pixel.
const OF_JUDGED_CELLS: u64 = 1536;
/// Bytes of a splat in balls, with the bins that list it. A margin is computed from them.
const OF_A_BALL: u64 = 288;
