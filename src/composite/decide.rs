//! Every decision on fragments and cells, by its name: the one home of their comparisons.
//!
//! Each decision gives a [`Truth`](crate::number::Truth): a `bool` in `f32` and `f64`. A number
//! that stands for an interval can take every decision too, and says which ones are undecided. The
//! definitions, the fast paths and `explain` call the same functions. A comparison with NaN is
//! false.
//!
//! | decision | operator | tie | used by |
//! |---|---|---|---|
//! | [`inside`] | q <= k k | the rim is inside | every splatting pass, discs |
//! | [`nearer`] | w > than | the fragment that came first stays | visibility splatting |
//! | [`nearer_or_lower`] | w > than | the lower surfel index | compositing of groups |
//! | [`visible`] | t <= limit | the limit is visible | attribute splatting, compositing |
//! | [`beyond`] | t > limit | the limit belongs to the layers before | depth peeling, near plane of discs |
//! | [`nearer_bin`] | z < than | the fragment that came first stays | low-precision depth tests |
//! | [`before`] | t < than | what came first stays | projection to pixels, merging, discs |
//! | [`before_or_lower`] | t < than | the lower surfel index | average of groups |
//! | [`opaque`] | alpha >= 1 | 1 is opaque | blending of layers |
//! | [`dense`] | alpha >= least | the least is drawn | blending of Gaussians |
//! | [`holds`] | 0 < square, form <= square | the rim is inside | pull, push, templates |
//! | [`overlaps`] | front <= end | touching intervals overlap | pull, push |
//! | [`occluded`] | front > end | touching intervals hide nothing | push |
//! | [`moves`] | extent > reach | an extent equal to the reach stays | propagation |
//! | [`meets`] | t - `t_f` <= r + `r_f` | touching spheres meet | merging of centres |
//! | [`ternary`] | > on both sides | touching spheres blend | gathering |
//!
//! Where fragments come in ascending surfel index, the fragment that came first has the lower
//! index.

use crate::number::Real;

/// Whether a fragment is within the cut-off: `q <= limit`, the rim included; `limit` is k k.
///
/// Source: the truncated kernel of \[ZPvBG01\].
#[inline(always)]
pub fn inside<R: Real>(q: R, limit: R) -> R::Truth {
    q.le(limit)
}

/// Whether a fragment is dense enough to be blended: `alpha >= least`.
#[inline(always)]
pub fn dense<R: Real>(alpha: R, least: R) -> R::Truth {
    alpha.ge(least)
}

/// Whether a fragment of nearness `w` is in front of the nearest so far: `w > than`. The comparison
/// is strict, so the first of equally near fragments stays.
///
/// Nearness is 1/t or -t, see [`crate::splat`]; `than` may be the nearness of an empty pixel.
/// Source: visibility splatting, \[GBP04, section 3\], \[ZP06, section 3.1\].
#[inline(always)]
pub fn nearer<R: Real>(w: R, than: R) -> R::Truth {
    w.gt(than)
}

/// [`nearer`] for fragments that come in any order of their surfels: among equally near fragments,
/// the one with the lower index is the nearer.
///
/// Source: the id of the compositing pass, \[ZP06, section 3.2\]; `Decided:` the tie.
#[inline(always)]
pub fn nearer_or_lower<R: Real, I: Ord>((w, surfel): (R, I), (than, id): (R, I)) -> R::Truth {
    w.gt(than) | (w.ge(than) & R::Truth::from(surfel < id))
}

/// The greatest depth that still belongs to the surface whose nearest fragment lies at `nearest`:
/// `nearest + epsilon`.
///
/// Depths are > 0 under a perspective camera; `epsilon` is >= 0 and may be +inf.
#[inline(always)]
pub fn limit<R: Real>(nearest: R, epsilon: R) -> R {
    nearest + epsilon
}

/// The epsilon-z test: whether a fragment of depth `t` belongs to the visible surface. `t <= limit`
/// with the [`limit`] of its pixel, the limit included.
///
/// This is the conservative test of \[ZP06, section 3.2, Fig. 5, line 6\] and of the 2+1-pass
/// methods before it. Laws:
///
/// - The nearest fragment always passes.
/// - epsilon = 0 keeps only the fragments at the nearest depth.
/// - epsilon = +inf keeps everything.
/// - A greater epsilon never drops a fragment that a smaller one kept.
#[inline(always)]
pub fn visible<R: Real>(t: R, limit: R) -> R::Truth {
    t.le(limit)
}

/// Whether a fragment of depth `t` lies behind every layer so far: `t > limit`, with the [`limit`]
/// of the last layer; -inf before the first. A fragment that was [`visible`] in a layer is in no
/// other.
///
/// Source: depth peeling, see [`crate::method::peeling`].
#[inline(always)]
pub fn beyond<R: Real>(t: R, limit: R) -> R::Truth {
    t.gt(limit)
}

/// Whether a fragment passes a depth test in bins: `z < than`, strict. z is its
/// [bin](super::bins::DepthBins::bin) or its [Voronoi-enhanced
/// depth](super::bins::DepthBins::voronoi); `than` is +inf where there is no fragment yet.
///
/// Source: \[ZP06, eq. 6 and 10\].
#[inline(always)]
pub fn nearer_bin<R: Real>(z: R, than: R) -> R::Truth {
    z.lt(than)
}

/// Whether a depth is in front of another: `t < than`. The comparison is strict, so the first of
/// equal depths stays; +inf is in front of nothing.
///
/// Source: the nearest sample of a pixel \[MKC08, section 3.1\], the foremost of four \[MKC08,
/// section 3.2\], \[MOC08, section 3.1\].
#[inline(always)]
pub fn before<R: Real>(t: R, than: R) -> R::Truth {
    t.lt(than)
}

/// [`before`], and among equal depths the one with the lower surfel index is in front.
///
/// Source: the average of the groups of Algorithm 2, \[ZP06, section 3.3\]; `Decided:` the tie.
#[inline(always)]
pub fn before_or_lower<R: Real>((t, surfel): (R, u32), (than, id): (R, u32)) -> R::Truth {
    t.lt(than) | (t.le(than) & R::Truth::from(surfel < id))
}

/// Whether a fragment with this opacity hides everything behind it: `alpha >= 1`.
///
/// Source: \[ZP06, section 5.2.3\].
#[inline(always)]
pub fn opaque<R: Real>(alpha: R) -> R::Truth {
    alpha.ge(R::ONE)
}

/// Whether an ellipse contains a point: `square > 0` and `form <= square`, the rim included, see
/// [`crate::splat::ellipse`]. An edge-on disc, whose form is infinite or NaN, contains nothing.
///
/// Source: \[MKC08, section 3.2\], \[MOC08, section 3.2\].
#[inline(always)]
pub fn holds<R: Real>(form: R, square: R) -> R::Truth {
    square.gt(R::ZERO) & form.le(square)
}

/// Whether an interval of depth that begins at `front` overlaps an interval that begins no later
/// and ends at `end`: `front <= end`, touching included.
///
/// Source: \[MKC08, section 3.2\].
#[inline(always)]
pub fn overlaps<R: Real>(front: R, end: R) -> R::Truth {
    front.le(end)
}

/// Whether the interval of a parent occludes a cell whose interval begins at `front`:
/// `front > end`, behind the interval. With `outside` also `front < begin`, before the interval.
///
/// Source: \[MKC08, section 3.3\].
#[inline(always)]
pub fn occluded<R: Real>(front: R, [begin, end]: [R; 2], outside: bool) -> R::Truth {
    front.gt(end) | (R::Truth::from(outside) & front.lt(begin))
}

/// Whether a centre with a radius of `extent` pixels moves on from a level that can show radii up
/// to `reach`: `extent > reach`; NaN moves on too.
///
/// Source: \[MOC08, section 3.1, eq. 1\].
#[inline(always)]
pub fn moves<R: Real>(extent: R, reach: R) -> R::Truth {
    !extent.le(reach)
}

/// Whether a centre is merged with the foremost: `t - t_f <= r + r_f`, for depths and radii in
/// world units, `t >= t_f`.
///
/// `Departs:` \[MOC08, section 3.1\] says "its depth is less than the foremost depth minus the sum
/// of their radii", which is impossible for a depth behind the foremost.
#[inline(always)]
pub fn meets<R: Real>([t, r]: [R; 2], [t_front, r_front]: [R; 2]) -> R::Truth {
    (t - t_front).le(r + r_front)
}

/// Where a centre lies relative to the front of a pixel: before, behind, or else near enough to
/// blend.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ternary<T> {
    /// The centre hides the front: the sums of the pixel start again.
    pub before: T,
    /// The front hides the centre: nothing happens.
    pub behind: T,
}

/// The ternary test: `before` if `t_f - t > r + r_f`, `behind` if `t - t_f > r + r_f`. Every centre
/// is before an empty front, whose depth is +inf.
///
/// Source: \[MOC08, section 3.2\].
#[inline(always)]
pub fn ternary<R: Real>([t, r]: [R; 2], [t_front, r_front]: [R; 2]) -> Ternary<R::Truth> {
    let sum = r + r_front;
    Ternary { before: (t_front - t).gt(sum), behind: (t - t_front).gt(sum) }
}
