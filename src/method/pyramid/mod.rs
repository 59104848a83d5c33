//! Pull-push interpolation of one pixel a point \[MKC08\].
//!
//! 1. **Projection** to single pixels, see [`mod@super::projection`]; each sample becomes a
//!    [`Cell`] of level 0 with the interval [t, t + r], the radius rho, displacement (0, 0),
//!    normal, tangent and colour.
//! 2. **Pull** ([`mod@pull`]): each coarser level from the finer one, four cells to one.
//! 3. **Push** ([`mod@push`]): from the coarsest level down, cells that are empty or occluded are
//!    computed again from four coarser ones; every other cell is copied.
//! 4. **Deferred shading** of level 0, see [`crate::shade`]. The depth of a pixel is its cell's
//!    `front`; its normal is the cell's, turned to world space and divided by its length, plus 0
//!    (of length 0: the null vector); that of a tube too, which is lit by its tangent, treated
//!    likewise.
//!
//! Levels are those of [`crate::frame::pyramid::sizes`]. A cell's ellipse is that of
//! [`crate::splat::ellipse`]; its centre is the centre of the cell plus the displacement.
//! `Decided:` everywhere a cell is an average of others, those of a tube and those of anything else
//! are never averaged: neither their light nor their vectors agree (\[MKC08\] 5.2 excludes it too).
//! The average has the kind of the foremost.
//!
//! [`plain`] is the definition, over any [`crate::number::Real`].

pub mod fast;
mod picture;
pub mod plain;
pub mod pull;
pub mod push;

use crate::composite::mean::Mean;
use crate::error::Result;
use crate::frame::raster::Snap;
use crate::frame::{Frame, Pool};
use crate::method::algorithm::{Algorithm, Job};
use crate::method::projection::{Kind, Sample};
use crate::method::{Picture, Stage};
use crate::number::{Exact, Vector2, Vector3};

/// How the cells that a pixel is interpolated from are weighted \[MKC08, section 3.3, Fig. 4\].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Weights {
    /// 1 inside the ellipse.
    Box,
    /// exp(-2 d^2) inside the ellipse, d the elliptical distance. `Decided:` the rim is two
    /// standard deviations from the centre, as it is by default for every splat of the crate.
    #[default]
    Gaussian,
}

/// When a cell that has something counts as occluded, by the interval [front, back] of its parent,
/// the cell of the next coarser level that it is part of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Occlusion {
    /// front > parent's back. `Departs:` by the words of the paper a cell in *front* of its
    /// parent's interval is "occluded" too, so that a triangle or a thin ribbon, which takes no
    /// part in the coarser level, is overwritten by the surface behind it, against section 5.1.
    #[default]
    Behind,
    /// front > parent's back, or front < parent's front: the words of \[MKC08, section 3.3\].
    Outside,
}

/// What is computed; everything here may change the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// See [`Weights`].
    pub weights: Weights,
    /// See [`Occlusion`].
    pub occlusion: Occlusion,
    /// Whether surfels and triangles seen from behind are dropped.
    pub cull: bool,
    /// Binary digits after the point of the corners of triangles and lines, see [`Snap`].
    pub subpixel_bits: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            weights: Weights::default(),
            occlusion: Occlusion::default(),
            cull: true,
            subpixel_bits: 8,
        }
    }
}

impl Settings {
    /// Whether the numbers are in range.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] as [`Snap::new`].
    pub fn check(&self) -> Result<()> {
        Snap::new(self.subpixel_bits).map(|_| ())
    }
}

/// A pixel of a level; view space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell<R> {
    /// What it is.
    pub kind: Kind,
    /// Where its interval of depth begins; world units.
    pub front: R,
    /// Where it ends.
    pub back: R,
    /// Radius of its ellipse in pixels of level 0.
    pub radius: R,
    /// From the centre of the cell to that of the ellipse, in pixels of level 0, x right, y down.
    pub displacement: Vector2<R>,
    /// Normal, of any length.
    pub normal: Vector3<R>,
    /// Tangent of a tube, of any length; else the null vector.
    pub tangent: Vector3<R>,
    /// Linear RGB.
    pub color: [R; 3],
}

impl<R: Exact> Cell<R> {
    /// Nothing: kind [`Kind::Empty`], front +inf, back -inf, all else 0.
    #[must_use]
    pub fn empty() -> Self {
        let none = Vector3::ZERO;
        Self {
            kind: Kind::Empty,
            front: R::INFINITY,
            back: -R::INFINITY,
            radius: R::ZERO,
            displacement: Vector2::new(R::ZERO, R::ZERO),
            normal: none,
            tangent: none,
            color: [R::ZERO; 3],
        }
    }

    /// A cell of level 0.
    #[must_use]
    pub fn new(sample: &Sample<R>) -> Self {
        if sample.kind == Kind::Empty {
            return Self::empty();
        }
        Self {
            kind: sample.kind,
            front: sample.depth,
            back: sample.depth + sample.radius,
            radius: sample.extent,
            displacement: Vector2::new(R::ZERO, R::ZERO),
            normal: sample.normal,
            tangent: sample.tangent,
            color: sample.color,
        }
    }

    /// Whether there is something.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.kind != Kind::Empty
    }

    /// Of four cells those that take part, and which one is foremost.
    ///
    /// Candidates are the valid ones within whose ellipses the new cell's centre lies; see
    /// [`crate::composite::mean::foremost`]; those that are not tubes if the foremost is one, or
    /// tubes if it is none, take no part.
    pub(super) fn foremost(cells: &[Self; 4], inside: [bool; 4]) -> ([bool; 4], usize) {
        let candidates = [0, 1, 2, 3].map(|j| inside[j] & cells[j].is_valid());
        let (fronts, backs) = (cells.map(|cell| cell.front), cells.map(|cell| cell.back));
        let (takes, first) = crate::composite::mean::foremost(candidates, fronts, backs);
        let tube = |j: usize| cells[j].kind == Kind::Tube;
        ([0, 1, 2, 3].map(|j| takes[j] & (tube(j) == tube(first))), first)
    }

    /// The average of the attributes; `displacements` are those from the new cell's centre.
    pub(super) fn average(
        cells: &[Self; 4],
        displacements: [Vector2<R>; 4],
        mean: &Mean<R>,
        kind: Kind,
    ) -> Self {
        let vector = |of: fn(&Self) -> Vector3<R>| {
            let v = [0, 1, 2, 3].map(|j| of(&cells[j]));
            Vector3::new(mean.of(v.map(|v| v.x)), mean.of(v.map(|v| v.y)), mean.of(v.map(|v| v.z)))
        };
        Self {
            kind,
            front: mean.of(cells.map(|cell| cell.front)),
            back: mean.of(cells.map(|cell| cell.back)),
            radius: mean.of(cells.map(|cell| cell.radius)),
            displacement: Vector2::new(
                mean.of(displacements.map(|d| d.x)),
                mean.of(displacements.map(|d| d.y)),
            ),
            normal: vector(|cell| cell.normal),
            tangent: vector(|cell| cell.tangent),
            color: [0, 1, 2].map(|c| mean.of(cells.map(|cell| cell.color[c]))),
        }
    }
}

impl Algorithm for Settings {
    const NAME: &'static str = "pyramid";
    const SUMMARY: &'static str =
        "one pixel a point, pull-push interpolation; ribbons, tubes, polygons and hybrids [MKC08]";
    const STAGES: &'static [Stage] = &[];
    const DRAWS_PRIMITIVES: bool = true;
    type Memory = fast::Levels;

    fn check(&self) -> Result<()> {
        Self::check(self)
    }

    fn define<R: Exact>(&self, job: &Job<'_>, stages: bool) -> Result<Picture<R>> {
        picture::define(job, self, stages)
    }

    fn draw(
        &self,
        job: &Job<'_>,
        memory: &mut fast::Levels,
        pool: &mut Pool,
    ) -> Result<Picture<f32>> {
        picture::draw(job, self, memory, pool)
    }

    fn stage<R: Exact>(&self, job: &Job<'_>, stage: &str, from: &Frame<R>) -> Result<Frame<R>> {
        let _ = (job, from);
        Err(crate::method::stage::unknown(stage))
    }

    fn explain<R: Exact>(&self, job: &Job<'_>, pixel: (u32, u32)) -> Result<String> {
        let _ = (job, pixel);
        Err(crate::Error::Usage("there is no replay of this method".into()))
    }
}
