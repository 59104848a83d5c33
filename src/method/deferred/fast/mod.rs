//! The fast path for `f32`: the bits of the definition, from another layout, see [`crate::method`].
//!
//! Passes 3 to 5 are done tile by tile, like the passes of `ewa`. In the blocks of a tile a surfel is
//! named by its rank among all that passes 1 and 3 draw, which are in the order of their ids.

mod points;

use super::part::{Part, Whole};
use super::picture::{flagged, seen, unseen};
use super::queries::Limits;
use super::{Settings, visibility};
use crate::composite::decide;
use crate::error::Result;
use crate::frame::{Framebuffer, NO_ID, Plane, Wanted};
use crate::index::seen::Seen;
use crate::method::algorithm::Job;
use crate::method::fast::tile::{Record, SIDE, Tile};
use crate::method::fast::{draw, prepare};
use crate::method::picture::{Clock, Laps};
use crate::method::prepare::Prepared;
use crate::number::lanes::LANES;
use crate::splat::{Shared, SplatSettings, Tally};

/// Draws a frame into a framebuffer, every pixel of it, with pass 3; and tells what it saw, what became
/// of the selected surfels, and the wall times. The fused passes have shares of their common time.
pub(super) fn render(
    job: &Job<'_>,
    settings: &Settings,
    target: &mut Framebuffer<f32>,
) -> Result<(Seen, Tally, Laps)> {
    let (whole, splats) = (Whole::of(job), &settings.splats);
    let before = seen(job, settings, &whole)?;
    let mut clock = Clock::default();
    let flagged = flagged(job, &whole, &before)?;
    let first = First::draw(job, splats, &flagged);
    clock.lap("visibility");

    let epsilon = splats.epsilon.in_units(whole.median_radius());
    let limits = first.limits(epsilon);
    let list = points::selected(job, settings, &whole, &limits);
    let now = Seen::of(whole.ids(), settings.flags, &list);
    clock.lap("indices");

    let fresh = whole.part(unseen(&whole, &before, &list), job.exec);
    let selected = whole.drawn(list, job);
    let [fresh_job, selected_job] = [&fresh, &selected].map(|part| part.job(job));
    let fresh_splats = prepare(&fresh_job, splats);
    let ranks = Ranks::new(flagged.ids(), fresh.ids());
    clock.lap("difference");

    let prepared = prepare(&selected_job, splats);
    let shared = &prepared.shared;
    let grid = job.grid();
    let passes = draw::<3>(&selected_job, &prepared, target, |tile, watch| {
        first.load(&ranks, tile);
        let index = grid.place(tile.grid.rect.x0, tile.grid.rect.y0).0;
        more(tile, &fresh_splats, &ranks, index);
        watch.lap(0);
        tile.limits(shared, prepared.epsilon);
        tile.attributes(shared);
        watch.lap(1);
        tile.normalize(shared);
        empty(tile);
    });
    ranks.name(&mut target.id);
    let mut laps = clock.into_laps();
    let names = ["difference", "attributes", "normalization"];
    for (name, time) in names.into_iter().zip(passes) {
        match laps.iter_mut().find(|(of, _)| *of == name) {
            Some((_, sum)) => *sum += time,
            None => laps.push((name, time)),
        }
    }
    Ok((now, prepared.tally, laps))
}

/// What pass 1 leaves: nearness and, of the flagged surfels, the index of the nearest.
struct First {
    shared: Shared<f32>,
    target: Framebuffer<f32>,
}

impl First {
    fn draw(job: &Job<'_>, settings: &SplatSettings, flagged: &Part) -> Self {
        let job = flagged.job(job);
        let prepared = prepare(&job, settings);
        let shared = prepared.shared;
        let wanted = Wanted { normal: false, color: false, observed: false };
        let [width, height] = job.camera.size();
        let mut target = Framebuffer::new(width, height, shared.empty(), wanted);
        draw::<1>(&job, &prepared, &mut target, |tile, _| tile.visibility(&shared));
        Self { shared, target }
    }

    /// The greatest depth of pass 2 at each pixel.
    fn limits(&self, epsilon: f32) -> Limits {
        let pixels = self.target.depth.values().iter().zip(self.target.id.values());
        let depth = |(&nearness, &id): (&f32, &u32)| match id {
            NO_ID => f32::INFINITY,
            _ => self.shared.depth(nearness),
        };
        let limits = pixels.map(|pixel| decide::limit(depth(pixel), epsilon));
        Limits { width: self.target.width, values: limits.collect() }
    }

    /// Puts the pixels of a tile into its blocks.
    fn load(&self, ranks: &Ranks, tile: &mut Tile) {
        let rect = tile.grid.rect;
        for index in 0..tile.blocks.len() {
            let (x0, y0) = tile.grid.corner(index);
            let block = &mut tile.blocks[index];
            for lane in 0..LANES as u32 {
                let (x, y) = (x0 + lane % SIDE, y0 + lane / SIDE);
                if x >= rect.x1 || y >= rect.y1 {
                    continue;
                }
                let id = *self.target.id.at(x, y);
                if id != NO_ID {
                    block.id[lane as usize] = ranks.flagged[id as usize];
                    block.nearest[lane as usize] = *self.target.depth.at(x, y);
                }
            }
        }
    }
}

/// Pass 3 in one tile, which has the number `index`; its splats are those of pass 4 again afterwards.
fn more(tile: &mut Tile, fresh: &Prepared<f32, Record>, ranks: &Ranks, index: usize) {
    let mut splats = Vec::new();
    fresh.gather_f32(index, &tile.grid.rect, &mut splats);
    for splat in &mut splats {
        splat.surfel = ranks.fresh[splat.surfel as usize];
    }
    std::mem::swap(&mut tile.splats, &mut splats);
    tile.visibility_over(&fresh.shared);
    tile.splats = splats;
}

/// Pixels without weight are empty, whatever depth passes 1 and 3 left.
fn empty(tile: &mut Tile) {
    for block in &mut tile.blocks {
        for lane in 0..LANES {
            if !(block.weight[lane] > 0.0) {
                (block.nearest[lane], block.id[lane]) = (f32::INFINITY, NO_ID);
            }
        }
    }
}

/// The ranks of surfels among all that passes 1 and 3 draw.
struct Ranks {
    flagged: Vec<u32>,
    fresh: Vec<u32>,
    /// The ids, ascending.
    ids: Vec<u64>,
}

impl Ranks {
    /// Of two ascending lists that have no id in common.
    fn new(flagged: &[u64], fresh: &[u64]) -> Self {
        let mut all = Self {
            flagged: Vec::with_capacity(flagged.len()),
            fresh: Vec::with_capacity(fresh.len()),
            ids: Vec::with_capacity(flagged.len() + fresh.len()),
        };
        let (mut flagged, mut fresh) = (flagged.iter().peekable(), fresh.iter().peekable());
        loop {
            let rank = all.ids.len() as u32;
            match (flagged.peek(), fresh.peek()) {
                (Some(&&id), other) if other.is_none_or(|&&other| id < other) => {
                    all.flagged.push(rank);
                    all.ids.push(id);
                    flagged.next();
                }
                (_, Some(&&id)) => {
                    all.fresh.push(rank);
                    all.ids.push(id);
                    fresh.next();
                }
                _ => return all,
            }
        }
    }

    /// Puts ids in the place of ranks.
    fn name(&self, ranks: &mut Plane<u32>) {
        for rank in ranks.values_mut().iter_mut().filter(|rank| **rank != NO_ID) {
            *rank = self.ids.get(*rank as usize).map_or(visibility::NONE, |&id| id) as u32;
        }
    }
}
