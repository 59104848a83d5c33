//! The fragments of the groups in balls: every fragment that a correct implementation may draw.

use crate::composite::bins::DepthBins;
use crate::composite::decide;
use crate::error::Result;
use crate::frame::Rect;
use crate::method::Job;
use crate::method::ewa::possible::{PossibleSplat, PossibleSplats, project, project_into};
use crate::method::fragment::each_pixel;
use crate::method::single_pass::Settings;
use crate::number::ball::{Profile, Three};
use crate::number::{Ball, MapInline, Truth};
use crate::scene::Groups;
use crate::splat::{Shared, SplatSettings, View, fragment};
use crate::verdict::client::Client;
use crate::verdict::supposed::Supposed;

/// The splats of a picture, by their groups.
pub(crate) struct GroupFragments<'a, P: Profile> {
    /// None if all surfels are in one group.
    groups: Option<&'a Groups>,
    splats: PossibleSplats<P>,
    pub(crate) view: View<Ball<P>>,
    /// The bins of the Voronoi depth test; none for the plain test.
    bins: Option<DepthBins<Ball<P>>>,
    supposed: Supposed,
}

/// A fragment that may be inside, or whose surfel the client names.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fragment<P: Profile> {
    pub(crate) surfel: u32,
    /// Whether its surfel certainly is drawn.
    pub(crate) drawn: bool,
    pub(crate) inside: Three,
    /// How certain the cut-off decision is, in bounds.
    pub(crate) margin: f64,
    /// q divided by the limit of q.
    pub(crate) rim: f64,
    pub(crate) back: Three,
    pub(crate) w: Ball<P>,
    pub(crate) t: Ball<P>,
    pub(crate) weight: Ball<P>,
    /// The keys that the depth test compares.
    pub(crate) keys: Keys<P>,
}

/// The keys of a fragment that the depth test may compare.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Keys<P: Profile> {
    /// The least and the greatest bin; none under the plain depth test.
    bins: Option<[f64; 2]>,
    /// The distance from the centre of the splat. Under the plain depth test, the depth.
    part: Ball<P>,
    supposed: Supposed,
}

/// The most bins for which each is tried as a key.
const MOST_BINS: f64 = 8.0;

impl<P: Profile> Keys<P> {
    /// The key of a bin.
    fn of_bin(&self, bin: f64) -> Ball<P> {
        self.supposed.key(Ball::exact(bin), self.part)
    }

    /// The least key.
    pub(crate) fn least(&self) -> Ball<P> {
        self.bins.map_or(self.part, |[first, _]| self.of_bin(first))
    }

    /// The greatest key.
    pub(crate) fn greatest(&self) -> Ball<P> {
        self.bins.map_or(self.part, |[_, last]| self.of_bin(last))
    }

    /// The key that fits a stored one best.
    pub(crate) fn closest(&self, found: Ball<P>) -> Ball<P> {
        let Some([first, last]) = self.bins else { return self.part };
        if !(last - first <= MOST_BINS) {
            // There are too many bins to try: take any of them, and any part of one.
            return Ball::new(0.5 * (first + last), 0.5 * (last - first) + 1.0);
        }
        let others = (1..=(last - first) as u32).map(|i| self.of_bin(first + f64::from(i)));
        others.fold(self.of_bin(first), |best, key| {
            if key.misfit(found) < best.misfit(found) { key } else { best }
        })
    }

    /// The key, if it is exact.
    fn exact(&self) -> Option<f64> {
        let (least, greatest) = (self.least(), self.greatest());
        let same = least.middle == greatest.middle && least.radius == 0.0;
        same.then_some(least.middle)
    }

    /// Whether two keys are equal in every implementation.
    pub(crate) fn are_equal(&self, other: &Self) -> bool {
        self.exact().is_some() && self.exact() == other.exact()
    }
}

/// The fragments of a row of pixels, by pixel and group.
pub(crate) struct RowFragments<P: Profile> {
    groups: usize,
    /// The fragments in the order of their places, and within a place in ascending surfel index.
    all: Vec<(usize, Fragment<P>)>,
}

/// The fragments of the groups at a pixel.
pub(crate) struct PixelFragments<'a, P: Profile> {
    first: usize,
    all: &'a [(usize, Fragment<P>)],
}

impl<P: Profile> RowFragments<P> {
    /// The fragments of a pixel, counted from the left.
    pub(crate) fn at(&self, column: usize) -> PixelFragments<'_, P> {
        let first = column * self.groups;
        PixelFragments { first, all: between(&self.all, [first, first + self.groups]) }
    }
}

impl<P: Profile> PixelFragments<'_, P> {
    /// The fragments of a group.
    pub(crate) fn in_group(&self, group: usize) -> impl Iterator<Item = &Fragment<P>> + Clone {
        let place = self.first + group;
        between(self.all, [place, place + 1]).iter().map(|(_, fragment)| fragment)
    }
}

/// The entries at the places from the first up to, but not with, the second.
fn between<T>(all: &[(usize, T)], places: [usize; 2]) -> &[(usize, T)] {
    let [first, end] = places.map_inline(|place| all.partition_point(|(at, _)| *at < place));
    &all[first..end]
}

impl<'a, P: Profile> GroupFragments<'a, P> {
    /// Projects the surfels of all groups.
    pub(crate) fn project(job: &Job<'a>, settings: &Settings, client: &Client) -> Result<Self> {
        let groups = Some(job.index.groups()?);
        let bins = settings.bins(&job.scene.surfels, job.camera)?;
        let (kernel, picture, supposed) = (&settings.splats.kernel, job.picture(), client.supposed);
        let record = |possible| supposed.splat(possible, kernel, &picture);
        let bounds = |possible: &PossibleSplat<P>| possible.splat.bounds;
        let drawn = client.projection(job);
        let mut splats = project_into(&drawn, &settings.splats, record, bounds);
        splats.shared.limit = supposed.limit(splats.shared.limit);
        Ok(Self { groups, splats, view: View::new(job.camera), bins, supposed })
    }

    /// Projects all surfels as one group, under the plain depth test.
    pub(crate) fn whole(job: &Job<'a>, settings: &SplatSettings) -> Self {
        let (splats, view) = (project(job, settings), View::new(job.camera));
        Self { groups: None, splats, view, bins: None, supposed: Supposed::Nothing }
    }

    /// Number of groups.
    pub(crate) fn groups(&self) -> usize {
        self.groups.map_or(1, Groups::len)
    }

    /// The depth of the visible band in world units.
    pub(crate) fn epsilon(&self) -> Ball<P> {
        self.splats.epsilon
    }

    /// Whether the depth test is the Voronoi one.
    pub(crate) fn voronoi(&self) -> bool {
        self.bins.is_some()
    }

    /// The constants that the fragments of all splats share.
    pub(crate) fn shared(&self) -> &Shared<Ball<P>> {
        &self.splats.shared
    }

    /// The fragments of a row of pixels in a tile. `said` gives the surfel that a group keeps at a
    /// column and row, according to the client.
    pub(crate) fn of_row(
        &self,
        tile: usize,
        row: &Rect,
        said: impl Fn(usize, (u32, u32)) -> Option<u32>,
    ) -> RowFragments<P> {
        let (groups, mut all) = (self.groups(), Vec::new());
        self.splats.for_each(tile, |possible| {
            let surfel = possible.splat.surfel;
            let group = self.groups.map_or(0, |groups| groups.own()[surfel as usize].into());
            each_pixel(&possible.splat, row, |column, at| {
                let said = said(group, at) == Some(surfel);
                if let Some(fragment) = self.fragment(possible, at, said) {
                    all.push((column * groups + group, fragment));
                }
            });
        });
        // A stable sort keeps the fragments of a place in their order.
        all.sort_by_key(|(place, _)| *place);
        RowFragments { groups, all }
    }

    /// The fragment of a splat, if it may be inside or the client names its surfel.
    fn fragment(
        &self,
        possible: &PossibleSplat<P>,
        at: (u32, u32),
        said: bool,
    ) -> Option<Fragment<P>> {
        let (shared, splat) = (self.shared(), &possible.splat);
        let (q, w) = fragment(shared, &splat.footprint, at);
        let inside = decide::inside(q, shared.limit);
        if !inside.possibly() && !said {
            return None;
        }
        let t = shared.depth(w);
        Some(Fragment {
            surfel: splat.surfel,
            drawn: possible.certain,
            inside,
            margin: q.distance(shared.limit),
            rim: q.middle / shared.limit.middle,
            back: self.supposed.turned(splat.back),
            w,
            t,
            weight: self.supposed.weight(&splat.footprint, q),
            keys: self.keys(q, t),
        })
    }

    fn keys(&self, q: Ball<P>, t: Ball<P>) -> Keys<P> {
        let supposed = self.supposed;
        let Some(bins) = &self.bins else { return Keys { bins: None, part: t, supposed } };
        let ends = supposed.bins(bins, positions(bins, t));
        Keys { bins: Some(ends), part: supposed.part(q, self.shared().limit), supposed }
    }
}

/// The least and the greatest bin of a depth.
pub(crate) fn bin_ends<P: Profile>(bins: &DepthBins<Ball<P>>, t: Ball<P>) -> [f64; 2] {
    Supposed::Nothing.bins(bins, positions(bins, t))
}

/// The least and the greatest position of a depth in bins.
fn positions<P: Profile>(bins: &DepthBins<Ball<P>>, t: Ball<P>) -> [f64; 2] {
    let position = bins.position(t);
    // A little more than the radius, because comparisons of balls use that too.
    let reach = position.radius * (1.0 + f64::from(f32::EPSILON));
    let reach = if reach.is_nan() { f64::INFINITY } else { reach };
    [position.middle - reach, position.middle + reach]
}
