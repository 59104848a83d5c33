//! Verify your planes of the projection to single pixels: a certificate for each pixel.
//!
//! Surfels are placed in [`Ball`]s. A surfel *may lie* in a pixel if it is not certainly dropped
//! and its centre may fall into the pixel. It *lies* there if it certainly is drawn and there is no
//! other such pixel.
//!
//! The corners of triangles, ribbons and tubes are snapped to each place that their balls allow, at
//! most 16 ways for a primitive. From there on coverage is exact. A primitive may lie in a pixel
//! that one of the ways covers. It lies there if there is only one way.
//!
//! 1. The surfel or primitive of the id may lie in the pixel. An empty pixel has no id.
//! 2. Every plane is in the ball of one sample that it may have there: seen from either side,
//!    snapped in either way, visited twice. In an empty pixel every plane has the value of
//!    [`PixelSample::empty`].
//! 3. Nothing else lies in the pixel whose depth certainly is less than Z. Without Z, its depth is
//!    compared with the depth of the id's sample. In an empty pixel Z is +inf.
//! 4. No surfel that lies there at an equal depth comes before the id's surfel by the client's tie
//!    rule. Depths are equal if they are the same and exact in balls, or if all numbers of the two
//!    surfels are the same.
//!
//! Without ids, the verdict takes the sample that errs least, among those that nothing certainly
//! hides.
//!
//! Where a pass tests depths against limits, a candidate may lie in a pixel only if it possibly
//! passes there. It lies there only if it certainly passes.
//!
//! **Triangles that are cut** by the near plane or the guard band, or may be, and triangles with more
//! ways to snap, are judged like **triangles beside splats**, in
//! [`deferred`](crate::method::deferred), which have no limit on the ways to snap. The corners of a triangle are intervals on the grid of fixed point; a triangle that
//! certainly is cut has the corners of its pieces. Where each interval is one place, coverage is
//! exact. Else a piece may lie in a pixel if no edge function certainly is negative, over all
//! places of its corners. It lies there if all edge functions certainly are positive.
//!
//! **Not judged**: a ribbon or a tube that is cut, or may be, or that has more ways to snap. Pixels
//! with its id are judged only by rule 3 and by their kind, and count as pixels without bounds.
//! Without ids, every pixel that is neither empty nor a surfel counts as such a pixel.

mod candidate;
mod claim;
mod intervals;
mod planes;
mod polygons;
mod primitives;

pub(crate) use planes::SamplePlanes;
pub(crate) use polygons::{AllPolygons, PossibleFragment};

use crate::composite::decide;
use crate::frame::raster::Snap;
use crate::frame::{Bins, Rect};
use crate::method::Job;
use crate::method::projection::{PixelSample, SceneProjector};
use crate::method::tiled::Tiled;
use crate::number::ball::{Profile, Three};
use crate::number::{Ball, MapInline, Real, Truth};
use crate::verdict::Doubt;
use crate::verdict::marks::{Marks, StageMarks, TilePart, Watch, counted};
use candidate::{Candidate, Possible};
use claim::Claim;
use planes::PixelContent;
use primitives::Pieces;

/// All surfels and primitives that may be drawn, and where.
pub(crate) struct AllPossible<'a, P: Profile> {
    projector: SceneProjector<'a, Ball<P>>,
    /// The greatest depth of a surfel that is drawn into each pixel, if the pass has such a limit.
    limits: Option<&'a Tiled<Ball<P>>>,
    /// The surfels, batch by batch.
    surfels: Vec<(Vec<Possible<P>>, Bins)>,
    pieces: Pieces<P>,
    bins: Bins,
    /// The triangles that are cut.
    cut: AllPolygons<'a, P>,
}

/// Judges the planes of the projection. `snap` is for triangles and lines.
pub(crate) fn judge<P: Profile>(
    job: &Job<'_>,
    cull: bool,
    snap: Snap,
    planes: &SamplePlanes<'_>,
    watch: Watch,
) -> StageMarks {
    match planes.names() {
        names if names.is_empty() => ("projection", names, watch.picture(job)),
        names => {
            let possible = AllPossible::<P>::new(job, cull, snap, None);
            ("projection", names, possible.judge_all(job, planes, watch))
        }
    }
}

impl<'a, P: Profile> AllPossible<'a, P> {
    /// Where only a few pieces of the picture are judged, the surfels near them alone.
    pub(crate) fn new(
        job: &Job<'a>,
        cull: bool,
        snap: Snap,
        limits: Option<&'a Tiled<Ball<P>>>,
    ) -> Self {
        let (scene, grid) = (job.scene, job.grid());
        let near = job.part.and_then(|part| part.near(job, 1.0, |_| 0.0));
        let of = &scene.surfels;
        let projector = SceneProjector::new(scene, job.camera, cull, snap);
        let count = near.as_ref().map_or(of.len(), Vec::len);
        let ranges = (0..count).step_by(8192);
        let ranges = ranges.map(|first| first..count.min(first + 8192)).collect();
        let surfels = job.exec.ordered(ranges, |range: std::ops::Range<usize>| {
            let surfel = |i: usize| near.as_ref().map_or(i, |near| near[i]);
            let place = |i| Possible::new(&projector.points, of, surfel(i), &grid);
            let possible: Vec<_> = range.filter_map(place).collect();
            let bins = Bins::new(&grid, possible.len(), |i| possible[i].bounds);
            (possible, bins)
        });
        let mut pieces = Pieces::new(&projector);
        let bins = Bins::new(&grid, pieces.all.len(), |i| pieces.all[i].piece.bounds);
        let own = SceneProjector::new(scene, job.camera, cull, snap);
        let cut = AllPolygons::found(own, std::mem::take(&mut pieces.cut), &grid);
        Self { projector, limits, surfels, pieces, bins, cut }
    }

    /// Marks the wrong pixels of the planes.
    pub(crate) fn judge_all(
        &self,
        job: &Job<'_>,
        planes: &SamplePlanes<'_>,
        watch: Watch,
    ) -> Marks {
        let found = job.exec.ordered(watch.pieces(job), |(tile, rect)| {
            self.judge(planes, TilePart { tile, rect }, watch.marks(rect))
        });
        watch.together(job, found)
    }

    /// The surfels or primitives that a client without ids may have at the pixels of a tile. Each
    /// comes with whether the client certainly has it. That is certain if it is the only candidate,
    /// and if the client says that the pixel is covered, or if the candidate certainly lies there
    /// and is in front.
    pub(crate) fn kept(&self, planes: &SamplePlanes<'_>, part: TilePart) -> Vec<(u32, bool)> {
        let claims = self.claims(planes, part);
        let (mut found, mut counts) = (Vec::new(), vec![0_u32; claims.len()]);
        self.each(part, |pixel, one| {
            let claim = &claims[pixel];
            if claim.may_have(&one) {
                counts[pixel] += 1;
                let sure = matches!(claim.says, PixelContent::Some(_)) || one.lies();
                found.push((pixel, one.id(), sure));
            }
        });
        found.into_iter().map(|(pixel, id, sure)| (id, sure && counts[pixel] == 1)).collect()
    }

    /// Calls `visit` for every candidate that may lie in a pixel of a tile, with the number of the
    /// pixel in the tile.
    fn each(&self, part: TilePart, mut visit: impl FnMut(usize, Candidate<'_, P>)) {
        let TilePart { tile, rect } = part;
        let count =
            |x: u32, y: u32| (y - rect.y0) as usize * rect.columns() + (x - rect.x0) as usize;
        for (possible, bins) in &self.surfels {
            bins.for_each(tile, |i| {
                let one = &possible[i as usize];
                let Rect { x0, y0, x1, y1 } = one.bounds.intersection(&rect);
                for (x, y) in (y0..y1).flat_map(|y| (x0..x1).map(move |x| (x, y))) {
                    let passes = self.passes(one, (x, y));
                    if passes.possibly() {
                        visit(count(x, y), Candidate::Surfel(one, passes));
                    }
                }
            });
        }
        self.bins.for_each(tile, |i| {
            let one = &self.pieces.all[i as usize];
            one.piece.for_each(&rect, |at| visit(count(at.x, at.y), Candidate::Piece(one, at)));
        });
        self.cut.each(part, |(x, y), _, sample, lies| {
            visit(count(x, y), Candidate::Cut(Box::new(sample), lies));
        });
    }

    /// Whether a surfel passes the depth test at a pixel.
    fn passes(&self, one: &Possible<P>, (x, y): (u32, u32)) -> Three {
        self.limits.map_or_else(|| true.into(), |all| decide::visible(one.placed.t, *all.at(x, y)))
    }

    /// The sample of a surfel, seen from its back or from its front.
    fn surfel(&self, one: &Possible<P>, back: bool) -> PixelSample<Ball<P>> {
        let SceneProjector { scene, points, has, .. } = &self.projector;
        let (i, of) = (one.surfel as usize, &scene.surfels);
        let color = of.color().map_or(scene.material.color, |color| color[i]);
        let color = if has.color { color.to_array() } else { [0.0; 3] };
        let g = if back { Ball::ONE } else { -Ball::ONE };
        let (radius, color) = (Ball::from_f32(of.radius()[i]), color.map_inline(Ball::from_f32));
        points.sample(one.surfel, &one.placed, one.normal, g, radius, color)
    }

    /// Calls `visit` for each sample that a candidate may have.
    fn each_sample(&self, of: &Candidate<'_, P>, mut visit: impl FnMut(PixelSample<Ball<P>>)) {
        match of {
            Candidate::Surfel(one, _) => {
                if !one.back.certainly() {
                    visit(self.surfel(one, false));
                }
                if one.back.possibly() {
                    visit(self.surfel(one, true));
                }
            }
            Candidate::Piece(one, at) => visit(one.piece.sample(&self.projector, at)),
            Candidate::Cut(sample, _) => visit(**sample),
        }
    }

    /// The client's claim about each pixel, and the candidate that lies there.
    fn claims(&self, planes: &SamplePlanes<'_>, part: TilePart) -> Vec<Claim<P>> {
        let rect = part.rect;
        let claim = |(_, at)| Claim::new(planes, at, &self.pieces.unclear);
        let mut claims: Vec<Claim<P>> = counted(rect).map(claim).collect();
        self.each(part, |pixel, one| {
            if one.lies() {
                claims[pixel].meet(one.id(), one.depth());
            }
        });
        claims
    }

    fn judge(&self, planes: &SamplePlanes<'_>, part: TilePart, mut marks: Marks) -> Marks {
        let rect = part.rect;
        let mut claims = self.claims(planes, part);
        let columns = rect.columns();
        self.each(part, |pixel, one| {
            let at = (rect.x0 + (pixel % columns) as u32, rect.y0 + (pixel / columns) as u32);
            if claims[pixel].may_mean(&one) {
                self.each_sample(&one, |sample| claims[pixel].consider(planes, at, sample));
                let side = matches!(one, Candidate::Surfel(of, _) if of.back.decided().is_none());
                marks.at(pixel).doubt(Doubt::Side, side);
            }
        });
        for (pixel, at) in counted(rect) {
            let claim = &mut claims[pixel];
            if matches!(claim.says, PixelContent::Empty | PixelContent::Nothing)
                && claim.front.is_none()
            {
                claim.consider(planes, at, PixelSample::empty());
            }
            claim.judge(planes, at, &mut marks.at(pixel));
        }
        let surfels = &self.projector.scene.surfels;
        self.each(part, |pixel, one| {
            claims[pixel].doubt(&one, &mut marks.at(pixel));
            claims[pixel].judge_tie(&one, planes.ties, surfels, &mut marks.at(pixel));
        });
        marks
    }
}
