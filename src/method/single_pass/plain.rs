//! The definition: every pass, one fragment at a time, over any number.

use super::Settings;
use crate::composite::bins::DepthBins;
use crate::composite::groups::{Sample, compose};
use crate::composite::sum;
use crate::error::Result;
use crate::frame::{Exec, Framebuffer, FramebufferTile, Grid, NO_ID, Rect};
use crate::method::ewa::plain::{each_inside, facing};
use crate::method::prepare::Prepared;
use crate::number::Exact;
use crate::scene::Groups;
use crate::scene::{Camera, Surfels};
use crate::splat::{Shared, Splat, Tally};

/// The geometry pass of a picture: its splats, projected and sorted into tiles.
#[derive(Debug)]
pub struct Geometry<'a, R> {
    surfels: &'a Surfels,
    groups: &'a Groups,
    grid: Grid,
    prepared: Prepared<R, Splat<R>>,
    /// The bins of the Voronoi depth test; none for the plain one.
    bins: Option<DepthBins<R>>,
}

/// What a depth-image keeps at a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kept<R> {
    /// Voronoi-enhanced depth in bins, +inf where there is none; 0 under the plain depth test.
    pub z: R,
    /// Nearness of the fragment; that of an empty pixel where there is none.
    pub nearness: R,
    /// Its weight.
    pub weight: R,
    /// Its surfel; [`NO_ID`] where there is none.
    pub surfel: u32,
    /// Whether the back of the surfel is seen.
    pub back: bool,
}

/// The depth-images of all groups, in one tile.
#[derive(Clone, Debug)]
pub struct Images<R> {
    /// The pixels of the tile.
    pub rect: Rect,
    /// What each group keeps at each pixel, row by row.
    pub groups: Vec<Vec<Kept<R>>>,
}

/// What the compositing pass makes of one pixel.
#[derive(Clone, Copy, Debug)]
pub struct Composite<R> {
    /// The sums, with the nearest depth.
    pub sums: Sample<R>,
    /// How many groups passed the epsilon-z test.
    pub count: u32,
    /// The surfel of the greatest nearness.
    pub id: u32,
}

impl<'a, R: Exact> Geometry<'a, R> {
    /// Projection.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if the Voronoi depth test takes too many bins.
    pub fn project(
        surfels: &'a Surfels,
        groups: &'a Groups,
        camera: &Camera,
        settings: &Settings,
        exec: &Exec,
    ) -> Result<Self> {
        let bins = settings.bins(surfels, camera)?;
        let grid = exec.grid(camera.width, camera.height);
        let prepared = Prepared::splats(surfels, camera, &settings.splats, (exec, &grid));
        Ok(Self { surfels, groups, grid, prepared, bins })
    }

    /// The division of the picture into tiles.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// What became of the surfels.
    #[must_use]
    pub fn tally(&self) -> Tally {
        self.prepared.tally
    }

    /// What the fragments of all splats share.
    #[must_use]
    pub fn shared(&self) -> &Shared<R> {
        &self.prepared.shared
    }

    /// epsilon in world units.
    #[must_use]
    pub fn epsilon(&self) -> R {
        self.prepared.epsilon
    }

    /// The geometry pass over one tile, counted row by row.
    #[must_use]
    pub fn images(&self, tile: usize, rect: Rect) -> Images<R> {
        let (shared, empty) = (&self.prepared.shared, self.empty());
        let mut groups = vec![vec![empty; rect.pixels()]; self.groups.len()];
        self.prepared.for_each(tile, |splat| {
            let image = &mut groups[usize::from(self.groups.own()[splat.surfel as usize])];
            each_inside(shared, splat, &rect, |pixel, q, nearness| {
                self.offer(splat, q, nearness, &mut image[pixel]);
            });
        });
        Images { rect, groups }
    }

    /// What a pixel keeps before anything is drawn.
    pub(super) fn empty(&self) -> Kept<R> {
        let z = if self.voronoi() { R::INFINITY } else { R::ZERO };
        let (nearness, weight) = (self.prepared.shared.empty(), R::ZERO);
        Kept { z, nearness, weight, surfel: NO_ID, back: false }
    }

    /// Whether the depth test is the Voronoi one.
    pub(super) fn voronoi(&self) -> bool {
        self.bins.is_some()
    }

    /// Calls `visit` for each splat that may touch a tile, in ascending surfel index.
    pub(super) fn each_splat(&self, tile: usize, visit: impl FnMut(&Splat<R>)) {
        self.prepared.for_each(tile, visit);
    }

    /// The depth test: replaces what a pixel keeps by a fragment that is inside, if it passes.
    /// Gives the fragment's Voronoi-enhanced depth, 0 under the plain depth test.
    pub(super) fn offer(&self, splat: &Splat<R>, q: R, nearness: R, kept: &mut Kept<R>) -> R {
        let shared = &self.prepared.shared;
        let (z, passes) = match &self.bins {
            None => (R::ZERO, nearness > kept.nearness),
            Some(bins) => {
                let z = bins.voronoi(shared.depth(nearness), (q / shared.limit).sqrt());
                (z, z < kept.z)
            }
        };
        if passes {
            let weight = splat.footprint.weight(q);
            *kept = Kept { z, nearness, weight, surfel: splat.surfel, back: splat.back };
        }
        z
    }

    /// What a kept fragment gives to the compositing pass: its weighted attributes.
    ///
    /// A colour that the scene does not have is 0, an opacity 1.
    #[must_use]
    pub fn sample(&self, kept: &Kept<R>) -> Sample<R> {
        if kept.surfel == NO_ID {
            return Sample::EMPTY;
        }
        let i = kept.surfel as usize;
        let normal = facing(self.surfels.normal()[i].to_array().map(R::from_f32), kept.back);
        let color = self.surfels.color().map_or([R::ZERO; 3], |c| c[i].to_array().map(R::from_f32));
        let opacity = self.surfels.opacity().map_or(R::ONE, |o| R::from_f32(o[i]));
        let depth = self.prepared.shared.depth(kept.nearness);
        Sample::new(depth, kept.weight, normal, color, opacity)
    }

    /// The compositing pass over one tile, row by row.
    #[must_use]
    pub fn composite(&self, images: &Images<R>) -> Vec<Composite<R>> {
        let pixels = images.groups.first().map_or(0, Vec::len);
        let mut samples = Vec::with_capacity(images.groups.len());
        let composite = |pixel: usize| {
            samples.clear();
            let (mut nearness, mut id) = (self.prepared.shared.empty(), NO_ID);
            for image in &images.groups {
                let kept = &image[pixel];
                samples.push(self.sample(kept));
                if kept.nearness > nearness || (kept.nearness == nearness && kept.surfel < id) {
                    (nearness, id) = (kept.nearness, kept.surfel);
                }
            }
            let (sums, count) = compose(&samples, self.prepared.epsilon);
            Composite { sums, count, id }
        };
        (0..pixels).map(composite).collect()
    }

    /// Runs `job` for every tile of a framebuffer, and returns the results row by row.
    pub fn each_tile<T: Send>(
        &self,
        target: &mut Framebuffer<R>,
        exec: &Exec,
        job: impl Fn(usize, FramebufferTile<'_, R>) -> T + Sync + Send,
    ) -> Vec<T> {
        let tiles = target.tiles(&self.grid, exec).into_iter().enumerate().collect();
        exec.ordered(tiles, |(index, tile)| job(index, tile))
    }
}

/// Normalization: writes what the compositing pass made of a tile.
pub fn store<R: Exact>(composites: &[Composite<R>], tile: &mut FramebufferTile<'_, R>) {
    let columns = (tile.rect.x1 - tile.rect.x0) as usize;
    for (y, row) in composites.chunks(columns).enumerate() {
        for (x, Composite { sums, count, id }) in row.iter().enumerate() {
            tile.depth.row(y)[x] = sums.depth;
            tile.id.row(y)[x] = *id;
            tile.weight.row(y)[x] = sums.weight;
            if let Some(normal) = &mut tile.normal {
                normal.row(y)[x] = sum::direction(sums.normal, sums.weight);
            }
            if let Some(color) = &mut tile.color {
                color.row(y)[x] = sum::average(sums.color, sums.weight);
            }
            if let Some(stencil) = &mut tile.stencil {
                // At most MAX_GROUPS.
                stencil.row(y)[x] = *count as u8;
            }
        }
    }
}
