//! Draw in `f32`, fast: the bits of the definition, from another layout, see [`crate::method`].
//!
//! Every surfel is projected once: B(i) are surfels that pass 1 or pass 3 draws, so pass 4 takes its
//! splats from theirs. Passes 3 to 5 are done tile by tile, like the passes of `ewa`. In the blocks of
//! a tile a surfel has the number of its rank among all surfels that passes 1 and 3 draw, in the order
//! of their ids.

mod points;
mod ranks;

use super::Settings;
use super::part::Whole;
use super::picture::{UNSHADED, flagged, whole};
use super::polygons::Polygons;
use super::queries::Limits;
use super::visibility::POLYGON;
use crate::composite::decide;
use crate::error::Result;
use crate::frame::{Exec, Framebuffer, FramebufferTile, NO_ID, Plane, Rect};
use crate::index::seen::Seen;
use crate::method::Job;
use crate::method::clock::{Clock, Stopwatch, Work, spend};
use crate::method::fast::fragments::touches;
use crate::method::fast::tile::{Record, SIDE, Tile};
use crate::method::fast::{draw, prepare, prepare_some};
use crate::method::prepare::Prepared;
use crate::number::lanes::LANES;
use crate::splat::{Shared, SplatSettings, Tally};
pub(super) use points::Centres;
use ranks::Ranks;

/// Draws a frame into a framebuffer, every pixel of it, with pass 3. Returns what the frame saw,
/// the fates of the selected surfels, and the laps.
pub(super) fn render(
    job: &Job<'_>,
    settings: &Settings,
    target: &mut Framebuffer<f32>,
    memory: &mut Vec<Centres>,
) -> Result<(Seen, Tally, Clock)> {
    let splats = &settings.splats;
    let (whole, before) = whole(job, settings)?;
    let grid = job.strips();
    let mut clock = Clock::of_stages(&UNSHADED);
    let polygons = Polygons::draw(job, settings, &whole)?;
    let flagged = flagged(&whole, &before)?;
    let flagged = Projected::new(job, splats, &whole, flagged, &mut clock, "visibility");
    // The tiles of pass 1 share the time from here on.
    clock.lap("visibility");
    first(job, &flagged.splats, target, &mut clock);
    if let Some(polygons) = &polygons {
        add(polygons, target, job.exec);
    }
    clock.lap("visibility");

    let (shared, epsilon) =
        (&flagged.splats.shared, splats.epsilon.in_units(whole.median_radius()));
    let limits = limits(shared, target, epsilon, job.exec);
    let list = points::selected(job, settings, &whole, &limits, memory);
    target.weight = Plane::from_values(target.width, target.height, limits.values);
    let now = Seen::from_selected(whole.ids(), settings.flags, &list);
    clock.lap("indices");

    let (kept, fresh) = ranks::compared(&flagged.ids, &list);
    let fresh = Projected::new(job, splats, &whole, fresh, &mut clock, "difference");
    clock.lap("difference");

    let ranks = Ranks::new(&flagged.ids, kept, &fresh.ids);
    let tally = flagged.tally(job, splats, &whole, &ranks, &mut clock).plus(&fresh.splats.tally);
    clock.lap("attributes");

    let names = ["difference", "attributes", "normalization"];
    let gather =
        |tile: &mut Tile, pixels: &mut FramebufferTile<'_, f32>, watch: &mut Stopwatch<3>| {
            gather(tile, pixels.depth.index, pixels.depth.rect, [&flagged, &fresh], &ranks);
            // Pass 4 needs the depth of pass 1 even where pass 3 draws nothing.
            if !tile.splats.is_empty() {
                load(pixels, &ranks, tile);
            }
            watch.lap(1);
        };
    draw(job, target, &mut clock, names, gather, |tile, watch| {
        let index = grid.place(tile.grid.rect.x0, tile.grid.rect.y0).0;
        more(tile, &fresh.splats, &ranks, index);
        watch.lap(0);
        tile.limits(shared, epsilon);
        tile.attributes(shared);
        watch.lap(1);
        tile.normalize(shared);
        name(tile, &ranks);
    });
    if let Some(polygons) = &polygons {
        polygons.fill(target, job.exec);
    }
    clock.lap("normalization");
    Ok((now, tally, clock))
}

/// The ids of surfels, and their splats in the colours of pass 4.
struct Projected {
    ids: Vec<u64>,
    splats: Prepared<f32, Record>,
}

impl Projected {
    /// Projects surfels. The time of making a scene of them belongs to `stage`, and that of their colours to
    /// pass 4.
    fn new(
        job: &Job<'_>,
        settings: &SplatSettings,
        whole: &Whole<'_>,
        ids: Vec<u64>,
        clock: &mut Clock,
        stage: &'static str,
    ) -> Self {
        if whole.is_plain() {
            let splats = prepare_some(job, settings, &ids);
            return Self { ids, splats };
        }
        let part = whole.part(ids, job.exec);
        clock.lap(stage);
        let part = part.filtered(job);
        clock.lap("attributes");
        let splats = prepare(&part.job(job), settings);
        Self { ids: part.into_ids(), splats }
    }

    /// The fates of the surfels of pass 1 that pass 4 draws too. A surfel has one splat at most. Those
    /// without a splat are few, and are projected again to learn why they have none.
    fn tally(
        &self,
        job: &Job<'_>,
        settings: &SplatSettings,
        whole: &Whole<'_>,
        ranks: &Ranks,
        clock: &mut Clock,
    ) -> Tally {
        let drawn = || self.splats.records().filter(|splat| ranks.keeps(splat.surfel));
        let visible = Tally { visible: drawn().count() as u64, ..Tally::default() };
        if visible.visible == ranks.kept() {
            return visible;
        }
        let mut missing: Vec<bool> = (0..).zip(&self.ids).map(|(i, _)| ranks.keeps(i)).collect();
        drawn().for_each(|splat| missing[splat.surfel as usize] = false);
        let without = self.ids.iter().zip(missing).filter(|(_, missing)| *missing);
        let without = without.map(|(&id, _)| id).collect();
        let again = Self::new(job, settings, whole, without, clock, "attributes");
        visible.plus(&again.splats.tally)
    }
}

/// Starts a tile of pass 4: the splats of B(i), numbered by their ranks.
fn gather(
    tile: &mut Tile,
    index: usize,
    rect: Rect,
    [flagged, fresh]: [&Projected; 2],
    ranks: &Ranks,
) {
    spend(Work::GatherRanked);
    let shared = &flagged.splats.shared;
    let splats = &mut tile.splats;
    flagged.splats.for_each(index, |splat| {
        if ranks.keeps(splat.surfel) && touches(splat, &rect, shared) {
            splats.push(Record { surfel: ranks.of_flagged(splat.surfel), ..*splat });
        }
    });
    let known = splats.len();
    fresh.splats.for_each(index, |splat| {
        if touches(splat, &rect, shared) {
            splats.push(Record { surfel: ranks.of_fresh(splat.surfel), ..*splat });
        }
    });
    // Two ascending runs, which a stable sort merges.
    if known > 0 && known < splats.len() {
        splats.sort_by_key(|splat| splat.surfel);
    }
    tile.empty(rect, shared.empty());
}

/// How many pixels one job takes in a pass over finished planes.
const PIXELS: usize = 1 << 14;

/// Runs pass 1: leaves nearness and, of the flagged surfels, the index of the nearest in the planes of
/// the picture, which pass 4 replaces tile by tile.
fn first(
    job: &Job<'_>,
    flagged: &Prepared<f32, Record>,
    target: &mut Framebuffer<f32>,
    clock: &mut Clock,
) {
    let shared = &flagged.shared;
    let attributes = (target.normal.take(), target.color.take());
    let gather = |tile: &mut Tile, pixels: &mut FramebufferTile<'_, f32>, _: &mut _| {
        tile.gather(flagged, pixels.depth.index, pixels.depth.rect);
    };
    draw(job, target, clock, ["visibility"], gather, |tile, _| tile.visibility(shared));
    (target.normal, target.color) = attributes;
}

/// Puts polygons where no surfel is as near.
fn add(polygons: &Polygons<f32>, target: &mut Framebuffer<f32>, exec: &Exec) {
    spend(Work::Polygons);
    let Framebuffer { depth, id, .. } = target;
    let rows = (0..).zip(depth.rows_mut().zip(id.rows_mut()));
    exec.ordered(rows.collect(), |(y, (depth, ids)): (u32, (&mut [f32], &mut [u32]))| {
        for (x, (nearest, id)) in (0..).zip(depth.iter_mut().zip(ids)) {
            let polygon = polygons.nearest(x, y);
            if polygon.id == POLYGON && (*id == NO_ID || polygon.nearness > *nearest) {
                (*nearest, *id) = (polygon.nearness, ranks::POLYGON);
            }
        }
    });
}

/// The greatest depth of pass 2 at each pixel, in the memory of the weights, which pass 4 writes anew.
fn limits(
    shared: &Shared<f32>,
    target: &mut Framebuffer<f32>,
    epsilon: f32,
    exec: &Exec,
) -> Limits {
    spend(Work::Indices);
    let mut values = std::mem::replace(&mut target.weight, Plane::filled(0, 0, 0.0)).into_values();
    let (nearness, ids) = (target.depth.values(), target.id.values());
    let pixels = nearness.chunks(PIXELS).zip(ids.chunks(PIXELS));
    let parts = values.chunks_mut(PIXELS).zip(pixels).collect();
    exec.ordered(parts, |(values, (nearness, ids)): (&mut [f32], (&[f32], &[u32]))| {
        for ((value, nearness), id) in values.iter_mut().zip(nearness).zip(ids) {
            let depth = shared.depth(*nearness);
            *value = decide::limit(if *id == NO_ID { f32::INFINITY } else { depth }, epsilon);
        }
    });
    Limits { width: target.width, values }
}

/// Puts what pass 1 left in the pixels of a tile into its blocks.
fn load(pixels: &mut FramebufferTile<'_, f32>, ranks: &Ranks, tile: &mut Tile) {
    spend(Work::Load);
    let rect = tile.grid.rect;
    for index in 0..tile.blocks.len() {
        let (x0, y0) = tile.grid.corner(index);
        let block = &mut tile.blocks[index];
        for lane in 0..LANES as u32 {
            let (x, y) = (x0 + lane % SIDE, y0 + lane / SIDE);
            if x >= rect.x1 || y >= rect.y1 {
                continue;
            }
            let id = *pixels.id.at([x, y]);
            if id != NO_ID {
                block.id[lane as usize] =
                    if id == ranks::POLYGON { id } else { ranks.of_flagged(id) };
                block.nearest[lane as usize] = *pixels.depth.at([x, y]);
            }
        }
    }
}

/// Runs pass 3 in one tile with the number `index`; afterwards the tile holds the splats of pass 4
/// again.
fn more(tile: &mut Tile, fresh: &Prepared<f32, Record>, ranks: &Ranks, index: usize) {
    spend(Work::Difference);
    let mut splats = Vec::new();
    fresh.gather_f32(index, &tile.grid.rect, &mut splats);
    for splat in &mut splats {
        splat.surfel = ranks.of_fresh(splat.surfel);
    }
    std::mem::swap(&mut tile.splats, &mut splats);
    tile.visibility_over(&fresh.shared);
    tile.splats = splats;
}

/// Puts ids in the place of ranks. Pixels without weight are empty, whatever depth passes 1 and 3
/// left. So are pixels where a polygon is nearest.
fn name(tile: &mut Tile, ranks: &Ranks) {
    spend(Work::Normalize);
    for block in &mut tile.blocks {
        for lane in 0..LANES {
            if !(block.weight[lane] > 0.0) || block.id[lane] == ranks::POLYGON {
                (block.nearest[lane], block.id[lane]) = (f32::INFINITY, NO_ID);
                block.weight[lane] = 0.0;
            } else if block.id[lane] != NO_ID {
                block.id[lane] = ranks.id(block.id[lane]) as u32;
            }
        }
    }
}
