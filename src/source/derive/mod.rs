//! From what a file gives to complete surfels, polygons, ribbons and tubes.
//!
//! For surfels, in this order, each step for what is still missing:
//!
//! 1. Points whose position is not finite are dropped and counted, with the triangles at them.
//! 2. **Normals**: across the tangents, if the file has them; else from the triangles, weighted by
//!    area; else from the plane through the [`PLANE_NEIGHBOURS`] nearest neighbours, all on one
//!    side.
//! 3. **Radii**: the one that was asked for; else the longer tangent; else, in a mesh, the longest
//!    edge of the triangles around the vertex; else the distance to the [`RADIUS_NEIGHBOURS`]th
//!    nearest neighbour.
//! 4. [`Surfels::new`] checks the rest.
//!
//! [`polygons`], [`hybrid`], [`ribbons`] and [`tubes`] begin with step 1 too.
//!
//! `Decided:` neighbours are other *places*: points at one place count once, and share what is
//! derived. If there are fewer places than asked for, all are taken.
//!
//! `Decided:` a cloud with triangles is a mesh, and its vertices in no triangle are no surface:
//! what is missing for them is not derived, and they are dropped and counted.
//!
//! `Decided:` the radii. Every point of a triangle lies within 1/sqrt(3) of its longest edge from
//! its nearest corner, so that discs with that edge as radius cover it with a margin for tilted
//! normals. In six scans and models of 6 k to 134 k vertices the discs overlap 6.5 to 11 times, and
//! those of a triangle's own corners leave at most 4e-5 of the area open, in triangles that a
//! normal of a corner is all but parallel to. The distance to the n-th neighbour makes discs
//! overlap n times whatever the density. Of a randomly sampled sphere n = 6 leaves about 3e-4 open,
//! 8 about 3e-6, and 10 none of 400,000 probes; on the vertices of the same models 10 leaves at
//! most 2e-4.

mod check;
mod distinct;
mod faces;
mod neighbours;
mod orient;
mod places;
mod plane;
mod primitives;
#[cfg(test)]
mod tests;

pub use primitives::{hybrid, polygons, ribbons, tubes};

use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::memory;
use crate::scene::{Cloud, Dropped, Surfels};
use glam::Vec3;
use places::Places;
use std::cell::OnceCell;

/// How many nearest neighbours, besides the point, a plane is fitted to.
pub const PLANE_NEIGHBOURS: usize = 16;

/// The distance to which nearest neighbour is the radius, times 1.
pub const RADIUS_NEIGHBOURS: usize = 10;

/// What may be asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Derive {
    /// The radius of points whose file gives none, in world units, > 0; derived if absent.
    pub radius: Option<f32>,
}

/// Where normals or radii come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The file gave them.
    File,
    /// They were asked for, see [`Derive`].
    Given,
    /// Derived from the tangents.
    Tangents,
    /// Derived from the triangles.
    Triangles,
    /// Derived from the nearest neighbours.
    Neighbours,
    /// Derived from the edges, as tangents are.
    Edges,
    /// They are 0: radii of polygons.
    Zero,
}

/// What [`surfels`], [`polygons`], [`hybrid`], [`ribbons`] or [`tubes`] did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Derived {
    /// Where the normals come from, or the tangents of tubes.
    pub normals: Origin,
    /// Where the radii come from.
    pub radii: Origin,
    /// Points that became no surfel, each counted once, under the first reason that held.
    pub dropped: Dropped,
    /// Triangles that became no polygon, or edges that became no ribbon or tube, because a corner
    /// is degenerate.
    pub dropped_primitives: u64,
}

/// Makes complete surfels of a cloud, see the module.
///
/// `progress` is told the name of a step, how many points it has done, and of how many; only steps
/// that may take over a second report. The result is a function of the cloud and the options alone.
///
/// # Errors
/// [`Error::Invalid`] if [`Cloud::check`] fails, if the radius asked for is not finite and > 0, if
/// no point is left, if normals are to be derived from fewer than 3 places, or radii from fewer
/// than 2.
pub fn surfels(
    cloud: Cloud,
    options: &Derive,
    exec: &Exec,
    progress: &dyn Fn(&str, u64, u64),
) -> Result<(Surfels, Derived)> {
    let (cloud, mut derived) = complete(cloud, options, exec, progress)?;
    let (surfels, dropped) = Surfels::new_with(cloud, exec)?;
    derived.dropped += dropped;
    Ok((surfels, derived))
}

/// Steps 1 to 3: a cloud of finite points with normals and radii.
fn complete(
    mut cloud: Cloud,
    options: &Derive,
    exec: &Exec,
    progress: &dyn Fn(&str, u64, u64),
) -> Result<(Cloud, Derived)> {
    cloud.check()?;
    let nowhere = drop_nowhere(&mut cloud)?;
    let places = OnceCell::new();
    let (normal, normals) = match cloud.normal.take() {
        Some(normal) => (normal, Origin::File),
        None => missing_normals(&cloud, &places, exec, progress)?,
    };
    let (radius, radii) = match cloud.radius.take() {
        Some(radius) => (radius, Origin::File),
        None => missing_radii(&cloud, options, &places, exec, progress)?,
    };
    let dropped = Dropped { position: nowhere, ..Dropped::default() };
    let cloud = Cloud { normal: Some(normal), radius: Some(radius), ..cloud };
    Ok((cloud, Derived { normals, radii, dropped, dropped_primitives: 0 }))
}

/// What the tree of the nearest neighbours and what is found with it take for a point.
const BYTES_A_NEIGHBOUR: u64 = 160;

/// Whether the neighbours of so many points may be looked for.
fn ask_for_neighbours(points: &[Vec3]) -> Result<()> {
    let count = points.len();
    memory::ask(count as u64 * BYTES_A_NEIGHBOUR, || format!("the neighbours of {count} points"))
}

fn missing_normals(
    cloud: &Cloud,
    places: &OnceCell<Places>,
    exec: &Exec,
    progress: &dyn Fn(&str, u64, u64),
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
    progress: &dyn Fn(&str, u64, u64),
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

/// The radius that was asked for, `n` times.
fn given(radius: f32, n: usize) -> Result<Vec<f32>> {
    if !(radius > 0.0 && radius.is_finite()) {
        let what = format!("a radius of {radius} was asked for; it must be finite and > 0");
        return Err(Error::Invalid(what));
    }
    Ok(vec![radius; n])
}

/// The direction of `u x v`, in f64 and rounded once; null if they span no plane.
fn across([u, v]: &[Vec3; 2]) -> Vec3 {
    u.as_dvec3().cross(v.as_dvec3()).normalize_or_zero().as_vec3()
}

/// The length of the longer half axis, in f64 and rounded once.
fn longer([u, v]: &[Vec3; 2]) -> f32 {
    let (u, v) = (u.as_dvec3().length(), v.as_dvec3().length());
    (if v > u { v } else { u }) as f32
}

/// Drops points that are not finite, with triangles and edges at them; how many points.
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
