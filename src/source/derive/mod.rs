//! Complete the surfels, polygons, ribbons and tubes of a file: derive missing normals, radii and
//! colours.
//!
//! Call [`surfels`], or [`facets`], [`polygons`], [`hybrid`], [`ribbons`] or [`tubes`].
//!
//! # Steps that complete a cloud of surfels
//!
//! Each step derives only what is still missing:
//!
//! 1. Normals count as missing if no point has one, because all are zero or not finite. Points whose position is not finite are dropped and counted, with the triangles at them.
//! 2. **Normals** come from the tangents, if the file has them; else from the triangles, weighted
//!    by area; else from the plane through the [`PLANE_NEIGHBOURS`] nearest neighbours, all on one
//!    side.
//! 3. **Radii**: the radius that you ask for; else the longer tangent; else, in a mesh, the longest
//!    edge of the triangles around the vertex; else the distance to the [`RADIUS_NEIGHBOURS`]th
//!    nearest neighbour.
//!    All of these are lengths in the coordinates of the file. A model's `transform` and the place
//!    of an object scale the radii afterwards.
//! 4. **Colours** come from the texture, if it has been [read](Cloud::paint): see below.
//! 5. [`Surfels::new`] checks the rest.
//!
//! The other functions begin with step 1 too.
//!
//! `Decided:` neighbours are other *places*: points at one place count once, and share the derived
//! values. If there are fewer places than needed, all are used.
//!
//! `Decided:` a cloud with triangles is a mesh, and vertices in no triangle are not part of its
//! surface. Nothing is derived for them; they are dropped and counted if an attribute is missing.
//!
//! # Arithmetic
//!
//! Positions, tangents and normals are converted from `f32` to f64. Each operation is rounded in
//! the order written, and each result to `f32` once at the end. With |a| = sqrt(a . a):
//!
//! ```text
//!   a . b  = (a.x b.x + a.y b.y) + a.z b.z
//!   a x b  = (a.y b.z - b.y a.z, a.z b.x - b.z a.x, a.x b.y - b.x a.y)
//! ```
//!
//! **From tangents u and v.** The normal is c (1 / |c|) with c = u x v; it is the null vector
//! unless the quotient is finite and > 0. The radius is the greater of |u| and |v|.
//!
//! **From triangles.** For each triangle (i, j, k) in ascending order, with the corners a, b and c,
//! (b - a) x (c - a) is added to the sums of i, j and k, which begin at 0. The normal is the sum
//! divided by its length, component by component; it is the null vector unless the length is > 0.
//! The radius is the square root of the greatest d . d, for d = a - b, b - c and c - a, over the
//! triangles around the vertex; 0 if there is none.
//!
//! **Places.** A place is a position; -0 = +0. Places are numbered by their first point, and have
//! the components of that point. The neighbours of a place are the other places, in ascending order
//! of (d . d, number), where d is the difference of the two places.
//!
//! **Radius from neighbours.** The square root of d . d of neighbour 10, or of the last neighbour.
//!
//! **Plane.** Take a place p and its neighbours up to the 16th, all in ascending number, and their
//! offsets o from p, `o = q - p`. The mean m is the sum of the offsets, from 0, divided by their
//! count. The covariance M is the sum, from 0, of the products of the components of o - m, with all
//! nine elements. Eight sweeps find its eigenvectors. A sweep is one rotation for each (p, q) of
//! (0, 1), (0, 2), (1, 2), in this order; there is no rotation where M(p,q) is 0. With r the third
//! index, and V0, V1, V2 the vectors, which begin as x, y, z:
//!
//! ```text
//!   theta = (Mqq - Mpp) / (2 Mpq)        root = |theta| + sqrt(theta theta + 1)
//!   t = 1 / root, or -1 / root if theta < 0      c = 1 / sqrt(t t + 1)      s = t c
//!   Mpp -= t Mpq      Mqq += t Mpq      then Mpq = Mqp = 0
//!   Mpr, Mqr = c Mpr - s Mqr, s Mpr + c Mqr      Mrp = Mpr, Mrq = Mqr
//!   Vp, Vq   = c Vp - s Vq, s Vp + c Vq          from the values before
//! ```
//!
//! The normal is the vector of the least of M00, M11, M22, the first of equal ones.
//!
//! **One side for all.** After Hoppe et al. 1992 (*Surface Reconstruction from Unorganized
//! Points*), the normals n, rounded to `f32`, are turned to one side:
//!
//! 1. Each place is tied to its 8 nearest neighbours, or to all if there are fewer. A tie of two
//!    places counts once. Its weight is 1 - |n . n'|: 0 unless > 0, rounded to `f32`.
//! 2. The ties are taken in the order of (weight, lower number, higher number). A tie whose ends
//!    are in two parts joins the parts. If the fitted normals have n . n' >= 0, the two ends should
//!    be alike, both reversed or neither; otherwise they should be unlike. If they are not, the
//!    whole part of the higher number is reversed.
//! 3. `Decided:` each part is flipped as a whole so that the volume behind it is positive. Hoppe's
//!    choice, the normal of one extreme point, turns a whole scan inside out if that point is on a
//!    thin tip. All sums are over the places of the part in ascending number, from 0. With w the
//!    greatest d . d from the place p to its 8 nearest neighbours:
//!
//! ```text
//!   c      = (sum of p w) / (sum of w)           o = p - c
//!   volume = sum of (n . o) w      size = sum of |o| w      facing = sum of n w
//! ```
//!
//! By the divergence theorem, this volume of a closed part is three times the volume that the part
//! encloses, for any c. If 256 |volume| > size, the part is flipped if volume < 0. Else the part is
//! flat: it is flipped if the component of facing of the greatest magnitude, the first of equal
//! ones, is < 0.
//!
//! # Colours of a texture
//!
//! The colour of a surfel is the [mean](crate::scene::texture) of the texture within the surfel's
//! own outline, carried into the plane of (u, v): "prefiltered texture samples" \[GBP04, 4.4\]. It
//! replaces the colours of the file. If [prefiltered levels](crate::scene::Mipmap) are asked for,
//! level k is the mean within 2^k of that outline, the matrix times 4^k; the levels of the file are
//! left out. A texture that has not been read changes nothing. For vectors p and q of that plane, p
//! q^T is the matrix of all products. All is computed in f64.
//!
//! **A facet** with the corners `t_a`, `t_b`, `t_c` in (u, v):
//!
//! ```text
//!   center = ((t_a + t_b) + t_c) / 3     p = t_c - center     q = (t_b - t_a) / sqrt(3)
//!   matrix = p p^T + q q^T
//! ```
//!
//! **A point** of radius r, or of sqrt(|U x V|) with half axes U and V, lies in triangles. Each
//! triangle has the corners a, b, c and the normal n = (b - a) x (c - a). With e = b - a,
//! f = c - a, and x and y the differences of the coordinates of the same corners:
//!
//! ```text
//!   A = |n|     E = e . e     F = e . f     G = f . f
//!   S = (((x x^T) G - (x y^T + y x^T) F) + (y y^T) E) / A           of triangles with A > 0
//! ```
//!
//! S / A is the matrix of the outline of a disc of radius 1 in the triangle's plane. The triangles
//! at a point are grouped by their coordinates at the point. The groups are in the order of the
//! bits of u, then v, with -0 as 0; triangles in a group are in ascending number. The colour of a
//! group is the mean around its coordinates with the matrix (sum of S) (r r / sum of A). The colour
//! of the point is the mean of its groups' colours, weighted by their sums of A and rounded to
//! `f32` once; a single group's colour is not rounded again.
//!
//! - `Decided:` matrices are added and not the maps themselves, so that mirrored triangles do not
//!   cancel.
//! - `Decided:` a point at a seam mixes both sides of the seam.
//! - If a coordinate of a triangle is not finite, or a point has no triangle with an area, the
//!   colour of the facet or of the points at it is NaN, so that these surfels are dropped and
//!   counted. In a cloud without triangles the matrix of a point is 0.
//! - `Decided:` the vertices of polygons have the colours that they would have as points with radii
//!   from the third step, because colours are linear between vertices, and details finer than an
//!   edge would alias. Methods know no textures.
//!
//! # Colours of faces
//!
//! A file may have colours of faces ([`Cloud::triangle_color`]); they are used where it has neither
//! colours of vertices nor a texture. A facet has the colour of its triangle. A point has the mean of
//! the colours of its triangles, weighted by area: with w = |(b - a) x (c - a)|, the sums of w and of
//! w times the colour begin at 0 and take the triangles in ascending order; their quotient is rounded
//! to `f32` once. A point in no triangle with an area has the colour NaN, so that it is dropped and
//! counted.
//!
//! `Decided:` a vertex of polygons becomes one vertex for each colour of its triangles, because
//! colours are linear between vertices. The first colour keeps the vertex; the others follow all
//! vertices, in the order of their first use. Normals are derived before.
//!
//! # Why these radii
//!
//! `Decided:` the radii. Every point of a triangle lies within 1/sqrt(3) of its longest edge from
//! its nearest corner. Therefore discs with that edge as radius cover the triangle, with a margin
//! for tilted normals. In six scans and models of 6 k to 134 k vertices the discs overlap 6.5 to 11
//! times. The discs of a triangle's own corners leave at most 4e-5 of the area open, in triangles
//! that are almost parallel to the normal of a corner.
//!
//! With the distance to the n-th neighbour as radius, discs overlap n times whatever the density.
//! On a randomly sampled sphere n = 6 leaves about 3e-4 open, 8 about 3e-6, and 10 none of 400,000
//! probes; on the vertices of the same models 10 leaves at most 2e-4.

mod check;
mod distinct;
mod face_colors;
mod faces;
mod facets;
mod neighbours;
mod orient;
mod places;
mod plane;
mod primitives;
#[cfg(test)]
mod tests;
mod texture;

pub use facets::{facets, facets_or_surfels};
pub(in crate::source) use primitives::drop_unsound;
pub use primitives::{hybrid, polygons, ribbons, tubes};
pub(in crate::source) use texture::stretch;

use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::memory;
use crate::progress::Progress;
use crate::scene::{Cloud, Dropped, Surfels};
use glam::Vec3;
use places::Places;
use std::cell::OnceCell;

/// How many nearest neighbours, besides the point itself, determine a plane.
pub const PLANE_NEIGHBOURS: usize = 16;

/// The distance to this nearest neighbour, times 1, is the radius.
pub const RADIUS_NEIGHBOURS: usize = 10;

/// Options of the derivation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Derive {
    /// The radius of points whose file gives none, in the units of the file, > 0; derived if absent.
    pub radius: Option<f32>,
}

/// The origin of normals or radii.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The file gave them.
    File,
    /// The caller chose them, see [`Derive`].
    Given,
    /// Derived from the tangents.
    Tangents,
    /// Derived from the triangles.
    Triangles,
    /// Derived by [`facets`].
    Facets,
    /// Derived from the nearest neighbours.
    Neighbours,
    /// Derived from the edges, as tangents are.
    Edges,
    /// They are 0: radii of polygons.
    Zero,
}

/// A report of [`surfels`], [`polygons`], [`hybrid`], [`ribbons`] or [`tubes`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Derived {
    /// Where the normals come from, or the tangents of tubes.
    pub normals: Origin,
    /// Where the radii come from.
    pub radii: Origin,
    /// Points that became no surfel. Each is counted once, under the first reason that held.
    pub dropped: Dropped,
    /// Triangles that became no polygon, or edges that became no ribbon or tube, because a corner
    /// is degenerate.
    pub dropped_primitives: u64,
}

/// Makes complete surfels from a cloud, see the module.
///
/// `progress` gets the name of a step, how many points are done, and their total; only steps that
/// may take over a second report. The result is a function of the cloud and the options alone.
///
/// # Errors
/// [`Error::Invalid`] if [`Cloud::check`] fails, if the chosen radius is not finite and > 0, if no
/// point is left, if normals must be derived from fewer than 3 places, or radii from fewer than 2.
pub fn surfels(
    cloud: Cloud,
    options: &Derive,
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<(Surfels, Derived)> {
    let (cloud, mut derived) = complete(cloud, options, exec, progress)?;
    let (surfels, dropped) = Surfels::new_with(cloud, exec)?;
    derived.dropped += dropped;
    Ok((surfels, derived))
}

/// Steps 1 to 4: a cloud of finite points with normals, radii and colours.
fn complete(
    mut cloud: Cloud,
    options: &Derive,
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<(Cloud, Derived)> {
    cloud.check()?;
    let nowhere = drop_nowhere(&mut cloud)?;
    let places = OnceCell::new();
    let (normal, normals) = match cloud.take_normals() {
        Some(normal) => (normal, Origin::File),
        None => missing_normals(&cloud, &places, exec, progress)?,
    };
    let (radius, radii) = match cloud.radius.take() {
        Some(radius) => (radius, Origin::File),
        None => missing_radii(&cloud, options, &places, exec, progress)?,
    };
    let dropped = Dropped { position: nowhere, ..Dropped::default() };
    let mut cloud = texture::points(cloud, &radius, exec, progress)?;
    if cloud.color.is_none() {
        cloud.color = face_colors::means(&cloud);
    }
    let cloud = Cloud { normal: Some(normal), radius: Some(radius), ..cloud };
    Ok((cloud, Derived { normals, radii, dropped, dropped_primitives: 0 }))
}

/// Bytes for each point: the tree of the nearest neighbours, and the results found with it.
const BYTES_A_NEIGHBOUR: u64 = 160;

/// Asks for the memory to find the neighbours of these points.
fn ask_for_neighbours(points: &[Vec3]) -> Result<()> {
    let count = points.len();
    memory::ask(count as u64 * BYTES_A_NEIGHBOUR, || format!("the neighbours of {count} points"))
}

fn missing_normals(
    cloud: &Cloud,
    places: &OnceCell<Places>,
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<(Vec<Vec3>, Origin)> {
    let points = &cloud.position;
    if let Some(tangents) = &cloud.tangents {
        return Ok((tangents.iter().map(across).collect(), Origin::Tangents));
    }
    if !cloud.triangles.is_empty() {
        return Ok((faces::normals(points, &cloud.triangles), Origin::Triangles));
    }
    ask_for_neighbours(points)?;
    let places = places.get_or_init(|| Places::new(points, exec, progress));
    Ok((places.normals(exec, progress)?, Origin::Neighbours))
}

fn missing_radii(
    cloud: &Cloud,
    options: &Derive,
    places: &OnceCell<Places>,
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<(Vec<f32>, Origin)> {
    let points = &cloud.position;
    if let Some(radius) = options.radius {
        return Ok((given(radius, points.len())?, Origin::Given));
    }
    if let Some(tangents) = &cloud.tangents {
        return Ok((tangents.iter().map(longer).collect(), Origin::Tangents));
    }
    if !cloud.triangles.is_empty() {
        return Ok((faces::radii(points, &cloud.triangles), Origin::Triangles));
    }
    if places.get().is_none() {
        ask_for_neighbours(points)?;
    }
    let places = places.get_or_init(|| Places::new(points, exec, progress));
    Ok((places.radii(exec, progress)?, Origin::Neighbours))
}

/// The chosen radius, `n` times.
fn given(radius: f32, n: usize) -> Result<Vec<f32>> {
    if !(radius > 0.0 && radius.is_finite()) {
        let what = format!("radius: {radius}; give a finite number > 0");
        return Err(Error::Invalid(what));
    }
    Ok(vec![radius; n])
}

/// The direction of `u x v`, in f64 and rounded once; null if u and v span no plane.
fn across([u, v]: &[Vec3; 2]) -> Vec3 {
    u.as_dvec3().cross(v.as_dvec3()).normalize_or_zero().as_vec3()
}

/// The length of the longer half axis, in f64 and rounded once.
fn longer([u, v]: &[Vec3; 2]) -> f32 {
    let (u, v) = (u.as_dvec3().length(), v.as_dvec3().length());
    (if v > u { v } else { u }) as f32
}

/// Drops points that are not finite, with triangles and edges at them. Returns how many points it
/// dropped.
fn drop_nowhere(cloud: &mut Cloud) -> Result<u64> {
    let n = cloud.position.len();
    let keep: Vec<bool> = cloud.position.iter().map(|p| p.is_finite()).collect();
    let kept = keep.iter().filter(|&&keep| keep).count();
    if kept == 0 {
        let what = format!("the scene is empty: none of its {n} points has a finite position");
        return Err(Error::Invalid(what));
    }
    if kept < n {
        cloud.retain(&keep);
    }
    Ok((n - kept) as u64)
}
