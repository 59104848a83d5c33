//! Derive normals and radii of points without triangles.

use super::distinct::Distinct;
use super::neighbours::Neighbours;
use super::{PLANE_NEIGHBOURS, RADIUS_NEIGHBOURS, orient, plane};
use crate::error::{Error, Result};
use crate::frame::Exec;
use glam::Vec3;

/// The places of points, ordered for the search of neighbours.
#[derive(Debug)]
pub(super) struct Places {
    distinct: Distinct,
    neighbours: Neighbours,
}

impl Places {
    /// Needs fewer than 2^32 finite points.
    pub(super) fn new(points: &[Vec3], exec: &Exec, progress: &dyn Fn(&str, u64, u64)) -> Self {
        progress("ordering points", 0, points.len() as u64);
        let distinct = Distinct::new(points);
        let neighbours = Neighbours::new(&distinct.place, exec);
        Self { distinct, neighbours }
    }

    /// The normal of the plane at each point, see [`plane::normal`] and [`orient::agree`].
    pub(super) fn normals(
        &self,
        exec: &Exec,
        progress: &dyn Fn(&str, u64, u64),
    ) -> Result<Vec<Vec3>> {
        let places = &self.distinct.place;
        if places.len() < 3 {
            return Err(Error::Invalid(format!(
                "normals are missing and cannot be derived: a plane needs points at 3 places, but \
                 they stand at {} only; give nx, ny and nz",
                places.len()
            )));
        }
        let progress = |done, all| progress("fitting planes", done, all);
        let fitted = self.neighbours.map(exec, PLANE_NEIGHBOURS, &progress, |id, found| {
            let mut ties = [id; orient::TIES];
            for (tie, neighbour) in ties.iter_mut().zip(found) {
                *tie = neighbour.id;
            }
            (plane::normal(places, id, found), ties)
        });
        let (mut normals, ties): (Vec<_>, Vec<_>) = fitted.into_iter().unzip();
        orient::agree(places, &ties, &mut normals);
        Ok(self.distinct.spread(&normals))
    }

    /// The distance from each point to its [`RADIUS_NEIGHBOURS`]th neighbour, or to the last one,
    /// rounded to `f32` once.
    pub(super) fn radii(&self, exec: &Exec, progress: &dyn Fn(&str, u64, u64)) -> Result<Vec<f32>> {
        if self.distinct.place.len() < 2 {
            let what = "radii are missing and cannot be derived: all points stand at one place; \
                        give a radius";
            return Err(Error::Invalid(what.into()));
        }
        let progress = |done, all| progress("measuring distances", done, all);
        let radii = self.neighbours.map(exec, RADIUS_NEIGHBOURS, &progress, |_, found| {
            found.last().map_or(0.0, |last| last.distance2.sqrt() as f32)
        });
        Ok(self.distinct.spread(&radii))
    }
}
