//! Verify your planes of deferred splatting: which planes a correct implementation may leave of
//! each stage.
//!
//! Each stage is judged from the client's planes of the stage before, as the client stores them. A
//! plane that the client lacks is taken from [`Ball`]s of a [`Profile`]. The flags that the
//! previous frame left are an input and are not judged, because a client with other flags draws
//! another frame.
//!
//! **Visibility**: the certificate of [`ewa`](crate::verdict::ewa) over the flagged surfels. Where
//! the client gives neither Z nor id, the nearest depth is an interval.
//!
//! **Indices**: a certificate for each pixel, as for [`projection`](crate::verdict::projection)
//! with a depth test. A surfel *may lie* in a pixel if it is not certainly dropped, its centre may
//! fall into the pixel, and `t <= Z + epsilon` possibly holds. It *lies* there if all of this is
//! certain. Z comes from the client's pass 1, else it is the interval.
//!
//! 1. The surfel of the id may lie in the pixel, and Z is in the ball of its t.
//! 2. Nothing else lies there whose t certainly is less.
//! 3. No surfel that lies there at an equal t comes before the id's surfel by the client's tie
//!    rule. Two t are equal if they are the same and exact in balls, or if all numbers of the two
//!    surfels are the same.
//! 4. In an empty pixel Z is +inf, and nothing lies there.
//!
//! **B(i)** is the list in the client's plane of ids. Without that plane:
//!
//! - A surfel *may be selected* if it may lie in a pixel where nothing that lies there certainly is
//!   before it. If there is a client's Z, the surfel's t must fit Z.
//! - A surfel *is selected* if nothing else may be in this pixel, and either it lies there, or the
//!   client's Z says that something does.
//!
//! **Difference**: the certificate over the flagged surfels, and those of B(i) whose flag is not
//! set. A surfel that only may be selected is not certainly drawn. With `second` off, the
//! certificate covers only the flagged surfels. Z and id come from `difference`. If neither is
//! there, they come from the picture, whose empty pixels say nothing about the nearest fragment.
//!
//! **Attributes** as in `ewa`, over B(i), against the client's depth of pass 3. A surfel that only
//! may be selected is an undecided fragment wherever it is visible, and both continuations are
//! kept.
//!
//! **Normalization and shading** as in `ewa`, with a difference for Z and id of the picture. They
//! come from pass 3 where the client's weight is > 0. Where it is 0, they have the values of an
//! empty pixel. Either is right if that is not certain. With `second` off, where pass 1 certainly
//! left nothing, they come from the certificate over B(i). Where pass 1 may have left nothing, they
//! are not judged.
//!
//! **[Polygons](crate::method::deferred::polygons)**: triangles beside splats
//! [may lie](crate::verdict::projection) in a pixel, at the depth of the pixel's nearness. In the
//! certificates of passes 1 and 3 a finite Z without an id belongs to a polygon that may lie there.
//! No polygon certainly lies there whose depth certainly is less than Z. A pixel of the picture may
//! show
//!
//! 1. the splats, as above, if the nearest fragment of pass 3 may be a surfel's or none, and weight
//!    may be > 0 or no polygon certainly lies there;
//! 2. a polygon that no other polygon certainly hides, if the nearest fragment may be a polygon's
//!    or weight may be 0. It shows the polygon's depth or the depth of the client's pass 3, the
//!    polygon's normal and colour, no id, and the weight 1.
//!
//! Among these the verdict takes the one against which the client errs least. If only the picture
//! says which fragment is nearest, a pixel without an id may say nothing. This holds where polygons
//! may lie, because a fragment without weight may be before the polygon.
//!
//! # Decided
//!
//! - If it is not certain how a polygon is cut, or which way its corners run, it may be at any
//!   depth of its corners, with any normal and colour. It hides nothing.
//! - A pixel that shows a polygon and is right is not undecided, whatever its sums are, if the
//!   client has no plane of the sums.
//! - Pass 3 is judged from the surfels of both passes, not from the client's depth of pass 1,
//!   because both passes use one depth buffer. A client that stores the two in different formats
//!   declares the coarser one.
//! - For a surfel that only may be selected, the choice is free at every pixel, though it is one
//!   choice. So the verdict allows more than a correct implementation leaves, never less.
//! - Surfels are those that the high level leaves. A client that chooses another node of the
//!   [levels of detail](crate::scene::objects::detail) has a wrong surfel. The nodes that a view
//!   draws are computed in f64 and are an input, like the flags.
//! - If ids have more than 32 bits, a plane of ids is judged together with the plane of the highest
//!   8; alone it is not judged.
//! - The colours that [mipmaps](mod@crate::method::deferred::filter) give are an input of pass 4,
//!   like the colours of a scene without mipmaps: a client must draw the same `f32` numbers.
//! - The objects that pass 1 [leaves out](Settings::share) are an input, like the flags. Pass 1
//!   certainly draws no surfel of such an object, and pass 3 draws those of B(i). Its polygons are
//!   there.
//! - A client may not promise `ieee` if it continues from other numbers than it stores, e.g. from a
//!   picture in f64 that is rounded once in the end. The reason is that its stored planes are not
//!   the input of its next stage.

mod client_planes;
mod polygons;
mod selection;
#[cfg(test)]
mod tests;

use crate::composite::decide;
use crate::error::{Error, Result};
use crate::frame::raster::Snap;
use crate::frame::{Exec, NO_ID, Rect};
use crate::memory;
use crate::method::Job;
use crate::method::deferred::Settings;
use crate::method::deferred::indices::Kept;
use crate::method::deferred::part::{Part, Whole};
use crate::method::deferred::picture::whole;
use crate::method::ewa::possible;
use crate::method::record::rows;
use crate::method::tiled::{Tiled, pixels};
use crate::number::ball::Profile;
use crate::number::{Ball, Real};
use crate::scene::Surfels;
use crate::verdict::checks::anything;
use crate::verdict::client::Client;
use crate::verdict::ewa::certificate::{self, Nearest, Other};
use crate::verdict::ewa::client_planes::ClientPlanes;
use crate::verdict::ewa::pixel::PixelJudge;
use crate::verdict::ewa::sums::{self, Continuations};
use crate::verdict::ewa::swift::{self, SwiftSplats};
use crate::verdict::marks::{Counts, Marks, MethodMarks, StageMarks, TilePart, Watch, counted};
use crate::verdict::projection::{AllPossible, SamplePlanes};
use crate::verdict::shift::ShiftSums;
use crate::verdict::{Check, Doubt, Verdict};
use polygons::{Ground, PolygonTile, Polygons, front};

/// Judges the planes of a client. Its ids are ranks: the number of ids that are less.
///
/// # Errors
/// [`crate::Error::Invalid`] if the flags belong to another scene, if the process may not hold
/// the surfels, or if a part of the picture is to be judged alone and the client does not say which
/// surfels it has selected.
pub(super) fn verify<P: Profile>(
    job: &Job<'_>,
    settings: &Settings,
    client: &Client,
    budget: f64,
) -> Result<Verdict> {
    let (found, counts) = judge::<P>(job, settings, client, Watch::All)?;
    let Counts { covered, undecided, shifts } = counts;
    Ok(Verdict::new(found.stage_verdicts(job), [covered, undecided], budget, shifts.sums()))
}

/// Every check at one pixel.
pub(super) fn checks<P: Profile>(
    job: &Job<'_>,
    settings: &Settings,
    client: &Client,
    pixel: (u32, u32),
) -> Result<Vec<Check>> {
    Ok(judge::<P>(job, settings, client, Watch::one(job, pixel)?)?.0.checks())
}

/// The findings about all stages.
fn judge<P: Profile>(
    job: &Job<'_>,
    settings: &Settings,
    client: &Client,
    watch: Watch,
) -> Result<(MethodMarks<4>, Counts)> {
    if job.part.is_some() && !lists_surfels(client) {
        // What is selected elsewhere is drawn here too.
        return Err(Error::Invalid("a part needs the ids of the selected surfels".into()));
    }
    let (whole, before) = whole(job, settings)?;
    let ground = Ground::new(job, &whole)?;
    let cull = settings.splats.cull;
    let ground = ground.as_ref().map(|ground| Polygons::<P>::new(job, ground, cull));
    let flat = whole.drawn(whole.drawn_ids(), job);
    // Without objects a rank is the index of a surfel, so that what is around the part is known.
    let part = job.part.filter(|_| job.scene.objects.is_none());
    let own = flat.job(job);
    let own = Job { part: part.or(own.part), ..own };
    let near = possible::near(&own, &settings.splats);
    let (whole, flat, ground) = (&whole, &flat, ground.as_ref());
    let scene = Scenery { job, own, near, settings, whole, flat, ground };
    let flagged = before.surfels(whole.ids());
    memory::ask(flagged.len() as u64 * OF_A_FLAGGED, || {
        format!("{} flagged surfels that are judged", flagged.len())
    })?;
    let flagged = flagged.into_iter().filter(|&id| scene.draws(id));
    let flagged = flagged.filter_map(|id| Some((scene.rank(id)?, true))).collect();
    let flagged = scene.near(flagged);

    let first = client_planes::visibility(client);
    let (visible, visibility) = scene.visible(&flagged, &first, watch);
    let epsilon = scene.epsilon();
    let limits =
        visible.map(|nearest| client.depth_test.tested(decide::limit(nearest.depth, epsilon)));

    let (indices, selected) = scene.indices(client, &limits, watch);
    let selected = scene.near(selected);

    let unseen = |&(rank, _): &(u32, bool)| {
        let found = whole.ids().find(flat.id(rank));
        found
            .is_some_and(|(object, surfel)| whole.leaves_out(object) || !before.has(object, surfel))
    };
    let mut drawn = flagged;
    if settings.second {
        drawn.extend(selected.iter().filter(|one| unseen(one)));
        drawn.sort_unstable();
    }
    let client_planes = client_planes::rest(client, settings);
    let of_polygons = client_planes::of_polygons(client, &client_planes);
    let judge = LaterPasses {
        drawn: scene.splats(&drawn),
        chosen: scene.splats(&selected),
        pixels: PixelJudge::of_surfels(job, scene.surfels(), &client_planes),
        without_sums: of_polygons.no_sums(),
        polygons: PixelJudge::of_surfels(job, scene.surfels(), &of_polygons),
        ground: scene.ground,
        client_planes: &client_planes,
        picture: (!settings.second).then(|| client_planes::picture(client)),
        surfels: scene.surfels(),
        visible: &visible,
    };
    let (tiles, counts) = judge.tiles(job.exec, watch.pieces(job), watch);
    let [(_, names), ..] = first.stages();
    let levels = vec![("visibility", names, visibility), indices];
    let [nearest, sums, averages, shading] = client_planes.stages();
    let stages = [("difference", nearest.1), sums, averages, shading];
    Ok((MethodMarks { levels, stages, tiles }, counts))
}

/// Whether the client says which surfels it has selected. Then each part of its picture can be judged
/// alone.
pub(super) fn lists_surfels(client: &Client) -> bool {
    let [_, id, _] = rows(&Kept::<f32>::PLANES);
    client.index(&id).is_some()
}

/// Bytes for a surfel that pass 1 draws, placed and projected in balls, and once more for pass 3.
const OF_A_FLAGGED: u64 = 1536;

/// The surfels that passes draw from: all surfels that the high level leaves, placed, each numbered
/// by its rank.
struct Scenery<'a, P: Profile> {
    job: &'a Job<'a>,
    /// The job that draws all these surfels.
    own: Job<'a>,
    /// The ranks of the surfels that may touch the part that is judged, if it is small.
    near: Option<Vec<usize>>,
    settings: &'a Settings,
    whole: &'a Whole<'a>,
    flat: &'a Part,
    ground: Option<&'a Polygons<'a, P>>,
}

impl<'a, P: Profile> Scenery<'a, P> {
    fn surfels(&self) -> &'a Surfels {
        self.flat.surfels()
    }

    /// Whether a surfel belongs to an object that pass 1 does not leave out.
    fn draws(&self, id: u64) -> bool {
        let found = self.whole.ids().find(id);
        found.is_some_and(|(object, _)| !self.whole.leaves_out(object))
    }

    fn rank(&self, id: u64) -> Option<u32> {
        self.flat.ids().binary_search(&id).ok().map(|rank| rank as u32)
    }

    /// Those of some surfels, ascending, that may touch the part that is judged.
    fn near(&self, some: Vec<(u32, bool)>) -> Vec<(u32, bool)> {
        let Some(near) = &self.near else { return some };
        let place = |rank: &usize| some.binary_search_by_key(&(*rank as u32), |one| one.0).ok();
        near.iter().filter_map(place).map(|place| some[place]).collect()
    }

    fn epsilon(&self) -> Ball<P> {
        let epsilon = self.settings.splats.epsilon.in_units(self.whole.median_radius());
        Ball::from_f32(epsilon)
    }

    /// Projects some surfels, ascending, each with whether the pass certainly draws it.
    fn splats(&self, some: &[(u32, bool)]) -> SwiftSplats<P> {
        let ids = some.iter().map(|&(rank, _)| self.flat.id(rank)).collect();
        let part = self.whole.part(ids, self.job.exec);
        swift::project_part(&part.job(self.job), &self.settings.splats, some)
    }

    /// The nearest fragments of pass 1, and the marks on them.
    fn visible(
        &self,
        flagged: &[(u32, bool)],
        client_planes: &ClientPlanes<'_>,
        watch: Watch,
    ) -> (Tiled<Nearest<P>>, Marks) {
        let (job, splats) = (self.job, self.splats(flagged));
        let judge = |part: TilePart, mut marks: Marks| {
            let surfels = self.surfels();
            let others = beside(self.ground, part).others;
            let found = certificate::judge_among(
                &splats,
                &others,
                client_planes,
                surfels,
                part,
                &mut marks,
            );
            (found, marks)
        };
        let found = job.exec.ordered(Watch::All.pieces(job), |(tile, rect)| {
            judge(TilePart { tile, rect }, Marks::new(rect))
        });
        let (found, mut marks): (Vec<_>, Vec<_>) = found.into_iter().unzip();
        if let Watch::One(_) = watch {
            let again = |(tile, rect)| judge(TilePart { tile, rect }, watch.marks(rect)).1;
            marks = watch.pieces(job).into_iter().map(again).collect();
        }
        (in_place(job, found), watch.together(job, marks))
    }

    /// Judges pass 2, where `limits` are the greatest depths that pass at each pixel. Returns B(i)
    /// too.
    fn indices(
        &self,
        client: &Client,
        limits: &Tiled<Ball<P>>,
        watch: Watch,
    ) -> (StageMarks, Vec<(u32, bool)>) {
        let (job, cull) = (self.own, self.settings.splats.cull);
        let [depth, id, _] = rows(&Kept::<f32>::PLANES);
        let planes = SamplePlanes::of_nearest(client, job.scene, [depth, id]);
        let points = AllPossible::<P>::new(&job, cull, Snap::default(), Some(limits));
        let names = planes.names();
        let marks = match names.is_empty() {
            true => watch.picture(&job),
            false => points.judge_all(&job, &planes, watch),
        };
        let total = self.flat.ids().len() as u64;
        let selected = match client.index(&id) {
            Some(stored) => selection::listed(stored.plane, total),
            None => selection::possible(&job, &points, &planes, total),
        };
        (("indices", names, marks), selected)
    }
}

/// Puts what was found in the judged pieces of a picture into their places. Nothing is known of the
/// pixels beside them.
fn in_place<P: Profile>(job: &Job<'_>, found: Vec<Vec<Nearest<P>>>) -> Tiled<Nearest<P>> {
    let grid = job.grid();
    let Some(part) = job.part else { return Tiled::from_tiles(grid, found) };
    let (rects, mut tiles) = (grid.rects(), vec![Vec::new(); grid.len()]);
    for (tile, _) in part.pieces {
        tiles[*tile] = vec![Nearest { depth: anything(), id: None }; rects[*tile].pixels()];
    }
    let mut placed = Tiled::from_tiles(grid, tiles);
    for ((_, rect), found) in part.pieces.iter().zip(found) {
        for ((x, y), nearest) in pixels(*rect).zip(found) {
            *placed.at_mut(x, y) = nearest;
        }
    }
    placed
}

/// The polygons that may lie in a tile.
fn beside<P: Profile>(ground: Option<&Polygons<'_, P>>, part: TilePart) -> PolygonTile<P> {
    ground.map_or(PolygonTile::NOTHING, |ground| ground.beside(part))
}

/// The parts that the tiles share in the passes after the selection.
struct LaterPasses<'a, P: Profile> {
    /// The surfels of passes 1 and 3.
    drawn: SwiftSplats<P>,
    /// B(i).
    chosen: SwiftSplats<P>,
    client_planes: &'a ClientPlanes<'a>,
    /// Depth and id of the picture, if they may come from pass 4: with `second` off.
    picture: Option<ClientPlanes<'a>>,
    surfels: &'a Surfels,
    pixels: PixelJudge<'a, P>,
    /// Whether the client has no plane of the sums.
    without_sums: bool,
    /// The judge for pixels that show a polygon.
    polygons: PixelJudge<'a, P>,
    ground: Option<&'a Polygons<'a, P>>,
    /// The nearest fragments that pass 1 has left.
    visible: &'a Tiled<Nearest<P>>,
}

impl<P: Profile> LaterPasses<'_, P> {
    fn tiles(
        &self,
        exec: &Exec,
        parts: Vec<(usize, Rect)>,
        watch: Watch,
    ) -> (Vec<[Marks; 4]>, Counts) {
        let found = exec.ordered(parts, |(tile, rect)| {
            let mut marks = [(); 4].map(|()| watch.marks(rect));
            let counts = self.judge(TilePart { tile, rect }, &mut marks);
            (marks, counts)
        });
        let (mut tiles, mut all) = (Vec::new(), Counts::default());
        for (marks, counts) in found {
            tiles.push(marks);
            all.add(counts);
        }
        (tiles, all)
    }

    /// Marks the wrong pixels of a rectangle in a tile, stage by stage.
    fn judge(&self, part: TilePart, marks: &mut [Marks; 4]) -> Counts {
        let TilePart { tile, rect } = part;
        let [first, rest @ ..] = marks;
        let beside = beside(self.ground, part);
        let nearest = self.nearest(part, &beside, first);
        let (depth_test, epsilon) = (self.client_planes.depth_test, self.chosen.epsilon);
        let limits: Vec<_> =
            nearest.iter().map(|nearest| nearest.tested(depth_test, epsilon)).collect();
        let sums = sums::continuations(&self.chosen, self.surfels, &limits, part, &mut rest[0]);
        let (mut covered, mut shifts) = (0, ShiftSums::default());
        for (pixel, at) in counted(rect) {
            let sums = sums.continuations(pixel);
            let others = beside.others(pixel);
            let shown = self.shown(tile, at, nearest[pixel], others, &mut rest[1]);
            let certain = matches!(sums, Continuations::One(_));
            covered += u64::from(shown.depth.middle.is_finite() || !certain);
            if !others.is_empty() {
                self.judge_beside(pixel, at, &beside, &shown, &sums, rest);
                continue;
            }
            let taken = self.pixels.judge(pixel, at, &shown, &sums, rest);
            if let (Continuations::Several(_, open), Some(taken)) = (&sums, taken) {
                shifts.take_all(open, taken);
            }
        }
        Counts { covered, undecided: rest[0].doubtful(Doubt::OF_SUMS), shifts }
    }

    /// The nearest fragments that pass 3 has left.
    fn nearest(
        &self,
        part: TilePart,
        beside: &PolygonTile<P>,
        marks: &mut Marks,
    ) -> Vec<Nearest<P>> {
        let rect = part.rect;
        if self.picture.is_some() && self.client_planes.nothing() {
            return counted(rect).map(|(_, (x, y))| *self.visible.at(x, y)).collect();
        }
        let (client_planes, surfels) = (self.client_planes, self.surfels);
        let others = &beside.others;
        certificate::judge_among(&self.drawn, others, client_planes, surfels, part, marks)
    }

    /// The fragment that the picture shows where it has weight. Where no earlier pass has left
    /// anything, it is the nearest of B(i). Where an earlier pass has left a polygon, it is the
    /// nearer of that polygon and B(i).
    fn shown(
        &self,
        tile: usize,
        at: (u32, u32),
        nearest: Nearest<P>,
        others: &[Other<P>],
        marks: &mut Marks,
    ) -> Nearest<P> {
        let Some(picture) = &self.picture else { return nearest };
        let Nearest { depth, id } = nearest;
        let among = |others: Vec<Other<P>>, marks: &mut Marks| {
            let pixel = Rect::pixel(at);
            let mut own = marks.beside(pixel);
            let (splats, others, surfels) = (&self.chosen, [others], self.surfels);
            let part = TilePart { tile, rect: pixel };
            let found = certificate::judge_among(splats, &others, picture, surfels, part, &mut own);
            marks.put(own);
            found.into_iter().next().unwrap_or(nearest)
        };
        let [splat, polygon] = front(&nearest, others);
        if depth.middle == f64::INFINITY && depth.radius == 0.0 {
            among(others.to_vec(), marks)
        } else if !(depth.middle + depth.radius).is_finite() || (splat && polygon) {
            Nearest { depth: anything(), id: None }
        } else if polygon && id == Some(NO_ID) {
            among(vec![Other { depth, lies: true }], marks)
        } else {
            nearest
        }
    }
}
