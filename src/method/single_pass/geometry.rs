//! The geometry pass: the depth-image of each group \[ZP06, Algorithm 1\].

use super::Settings;
use crate::composite::bins::DepthBins;
use crate::composite::decide;
use crate::composite::groups::WeightedFragment;
use crate::error::Result;
use crate::frame::{NO_ID, Rect};
use crate::method::Job;
use crate::method::buffer_formats::DepthKey;
use crate::method::clock::{Work, spend};
use crate::method::fragment::{TileSplats, facing};
use crate::method::prepare::Prepared;
use crate::number::{Exact, MapInline, Real};
use crate::scene::{Groups, Surfels};
use crate::splat::{Shared, Splat};

/// The splats of a picture, projected and sorted into tiles, and the data of the depth test.
#[derive(Debug)]
pub(crate) struct Geometry<'a, R: Exact> {
    surfels: &'a Surfels,
    groups: &'a Groups,
    pub(crate) splats: Prepared<R, Splat<R>>,
    /// The bins of the Voronoi depth test; none for the plain one.
    bins: Option<DepthBins<R>>,
    key: DepthKey,
}

/// The fragment that a depth-image keeps at a pixel while it is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Kept<R> {
    /// Voronoi-enhanced depth in bins, +inf where there is none; 0 under the plain depth test.
    pub(super) z: R,
    /// Nearness of the fragment; where there is none, the nearness of an empty pixel.
    pub(super) nearness: R,
    /// Weight of the fragment.
    weight: R,
    /// Surfel of the fragment; [`NO_ID`] where there is none.
    surfel: u32,
    /// Whether the back of the surfel is seen.
    back: bool,
}

/// What a depth-image leaves at a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ImagePixel<R> {
    /// Depth and weighted attributes of the fragment that was kept.
    pub(crate) sample: WeightedFragment<R>,
    /// Nearness of the fragment; where there is none, the nearness of an empty pixel.
    pub(crate) nearness: R,
    /// Voronoi-enhanced depth of the fragment in bins, +inf where there is none; 0 under the plain
    /// depth test.
    pub(crate) z: R,
    /// Surfel of the fragment; [`NO_ID`] where there is none.
    pub(crate) surfel: u32,
}

impl<'a, R: Exact> Geometry<'a, R> {
    /// Projects the splats and sets up the depth test.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if there are no groups, or if the Voronoi depth test takes too
    /// many bins.
    pub(crate) fn project(job: &Job<'a>, settings: &Settings) -> Result<Self> {
        let surfels = &job.scene.surfels;
        let (groups, bins) = (job.index.groups()?, settings.bins(surfels, job.camera)?);
        Ok(Self {
            surfels,
            groups,
            splats: Prepared::splats(job, &settings.splats),
            bins,
            key: job.key,
        })
    }

    /// The constants that the fragments of all splats share.
    pub(crate) fn shared(&self) -> &Shared<R> {
        &self.splats.shared
    }

    /// The geometry pass over some pixels of a tile: the image of each group, row by row.
    pub(crate) fn images(&self, tile: usize, rect: Rect) -> Vec<Vec<ImagePixel<R>>> {
        spend(Work::Images);
        let mut images = vec![vec![self.empty(); rect.pixels()]; self.groups.len()];
        TileSplats::new(&self.splats, tile, rect).each_inside(|splat, pixel, q, nearness| {
            self.offer(splat, q, nearness, &mut images[self.group(splat)][pixel]);
        });
        let leave = |image: Vec<Kept<R>>| image.iter().map(|kept| self.leave(kept)).collect();
        images.into_iter().map(leave).collect()
    }

    /// How many groups there are.
    pub(super) fn groups(&self) -> usize {
        self.groups.len()
    }

    /// The group of a splat.
    pub(super) fn group(&self, splat: &Splat<R>) -> usize {
        usize::from(self.groups.own()[splat.surfel as usize])
    }

    /// The content of a pixel before anything is drawn.
    pub(super) fn empty(&self) -> Kept<R> {
        let z = if self.voronoi() { R::INFINITY } else { R::ZERO };
        let (nearness, weight) = (self.shared().empty(), R::ZERO);
        Kept { z, nearness, weight, surfel: NO_ID, back: false }
    }

    /// Whether the depth test is the Voronoi one.
    pub(super) fn voronoi(&self) -> bool {
        self.bins.is_some()
    }

    /// The depth test: a fragment that is inside replaces the kept fragment of a pixel, if it
    /// passes. Returns the fragment's Voronoi-enhanced depth, 0 under the plain depth test, and
    /// whether the fragment passed.
    pub(super) fn offer(
        &self,
        splat: &Splat<R>,
        q: R,
        nearness: R,
        kept: &mut Kept<R>,
    ) -> (R, bool) {
        let shared = self.shared();
        let (z, passes) = match &self.bins {
            None => {
                let compared = |w| self.key.nearness(w, || shared.depth(w));
                (R::ZERO, decide::nearer(compared(nearness), compared(kept.nearness)))
            }
            Some(bins) => {
                let z = bins.voronoi(shared.depth(nearness), ratio(q, shared.limit));
                let compared = |z| self.key.voronoi(z, bins);
                (z, decide::nearer_bin(compared(z), compared(kept.z)))
            }
        };
        if passes {
            let weight = splat.footprint.weight(q);
            *kept = Kept { z, nearness, weight, surfel: splat.surfel, back: splat.back };
        }
        (z, passes)
    }

    /// What a kept fragment leaves: its depth, and its weighted attributes.
    ///
    /// A colour that the scene does not have is 0, an opacity 1.
    fn leave(&self, kept: &Kept<R>) -> ImagePixel<R> {
        let Kept { z, nearness, weight, surfel, back } = *kept;
        if surfel == NO_ID {
            return ImagePixel { sample: WeightedFragment::EMPTY, nearness, z, surfel };
        }
        let (surfels, i) = (self.surfels, surfel as usize);
        let normal = facing(surfels.normal()[i].to_array().map_inline(R::from_f32), back);
        let color =
            surfels.color().map_or([R::ZERO; 3], |c| c[i].to_array().map_inline(R::from_f32));
        let depth = self.shared().depth(nearness);
        let sample = WeightedFragment::new(depth, weight, normal, color, opacity(surfels, surfel));
        ImagePixel { sample, nearness, z, surfel }
    }
}

/// The distance of a fragment from the centre of its splat, as a fraction of the splat's radius.
pub(crate) fn ratio<R: Real>(q: R, limit: R) -> R {
    (q / limit).root_of_squares()
}

/// The opacity of a surfel, 1 if the scene has none.
pub(crate) fn opacity<R: Real>(surfels: &Surfels, surfel: u32) -> R {
    R::from_f32(surfels.opacity_of(surfel as usize))
}
