//! Explain every decision behind one pixel, with its operands.

use super::normalization::normalize;
use super::propagation::{self, propagate};
use super::reconstruction::{Gathered, Placement, each_query, weight};
use super::{Center, Settings};
use crate::error::Result;
use crate::frame::Plane;
use crate::frame::raster::Snap;
use crate::method::Job;
use crate::method::projection::explain::{PixelProjection, compared, outside, replay};
use crate::method::projection::{self, Has};
use crate::number::{Exact, MapInline};
use std::fmt;

/// The replay of one pixel and of the cells over it.
#[derive(Clone, Debug)]
pub(super) struct TemplateReplay<R> {
    pixel: (u32, u32),
    pub(super) projection: PixelProjection<R>,
    /// The cells over the pixel, from level 1 up.
    pub(super) merged: Vec<Merged<R>>,
    /// The centres in the templates around the pixel, in the order of the gathering.
    asked: Vec<CenterAnswer<R>>,
    /// The sums.
    pub(super) gathered: Gathered<R>,
    /// The average depth.
    pub(super) depth: R,
}

/// A cell from four finer ones.
#[derive(Clone, Copy, Debug)]
pub(super) struct Merged<R> {
    level: usize,
    cell: (u32, u32),
    finer: [Center<R>; 4],
    /// The largest radius that stays at the finer level.
    reach: R,
    moving: [bool; 4],
    /// Which centres are near the foremost centre that moves, if one moves.
    near: [bool; 4],
    first: Option<usize>,
    pub(super) found: Center<R>,
}

/// A centre, and the pixel's decisions on it.
#[derive(Clone, Copy, Debug)]
struct CenterAnswer<R> {
    level: usize,
    cell: (u32, u32),
    center: Center<R>,
    form: R,
    square: R,
    /// Whether the pixel is held: by the centre's ellipse, or because the centre was projected to
    /// this pixel.
    holds: bool,
    own: bool,
    /// The weight of the centre, what the pixel had gathered before, and the ternary test against
    /// it.
    weight: R,
    before: Gathered<R>,
    test: Placement,
}

/// Replays all stages at one pixel.
///
/// # Errors
/// The errors of the projection.
pub(super) fn explain<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    pixel: (u32, u32),
) -> Result<TemplateReplay<R>> {
    let Job { scene, camera, exec, .. } = *job;
    let snap = Snap::default();
    let projected = projection::project::<R>(job, settings.cull, snap)?;
    let levels = propagate(&projected.samples, settings, exec);
    let merged = (1..levels.len()).map(|level| {
        let (x, y) = (pixel.0 >> level, pixel.1 >> level);
        let finer = propagation::four(&levels[level - 1], x, y);
        Merged::new(level, (x, y), finer, R::from_f32(settings.reach(level - 1)))
    });
    let (mut gathered, mut asked) = (Gathered::empty(), Vec::new());
    each_query(&levels, settings, pixel, |a| {
        let (before, test) = (gathered, gathered.test(a.center));
        let given = weight(settings.falloff, a.form, a.square);
        if a.holds || a.own {
            gathered.add(a.center, given);
        }
        let (level, cell, center, form, square) = (a.level, a.cell, *a.center, a.form, a.square);
        let (holds, own) = (a.holds, a.own);
        let weight = given;
        asked.push(CenterAnswer {
            level,
            cell,
            center,
            form,
            square,
            holds,
            own,
            weight,
            before,
            test,
        });
    });
    let one = normalize(&Plane::filled(1, 1, gathered), camera, Has::in_scene(scene), false);
    Ok(TemplateReplay {
        pixel,
        projection: replay(job, settings.cull, snap, pixel),
        merged: merged.collect(),
        asked,
        gathered,
        depth: *one.depth.at(0, 0),
    })
}

impl<R: Exact> Merged<R> {
    fn new(level: usize, cell: (u32, u32), finer: [Center<R>; 4], reach: R) -> Self {
        let moving = finer.map_inline(|center| propagation::moves(&center, reach));
        let first = propagation::foremost(&finer, moving);
        let near = first.map_or([false; 4], |first| propagation::near(&finer, first));
        let takes = [0, 1, 2, 3].map_inline(|j| moving[j] && near[j]);
        let found = first.map_or(Center::empty(), |first| propagation::merge(&finer, takes, first));
        Self { level, cell, finer, reach, moving, near, first, found }
    }

    /// The fate of the centre j, in words.
    fn fate(&self, j: usize) -> String {
        let center = &self.finer[j];
        if !center.is_valid() {
            return "empty".into();
        }
        let id = center.id;
        let Some(first) = self.first.filter(|_| self.moving[j]) else {
            let extent = compared(center.extent, "<=", self.reach);
            return format!("surfel {id:>8}  stays   extent {extent}: the reach");
        };
        let extent = compared(center.extent, ">", self.reach);
        let front = &self.finer[first];
        let (distance, sum) = (center.depth - front.depth, center.radius + front.radius);
        let (word, sign) = match (j == first, self.near[j]) {
            (true, _) => ("leads ", "<="),
            (false, true) => ("merges", "<="),
            (false, false) => ("lost  ", ">"),
        };
        let near = compared(distance, sign, sum);
        format!("surfel {id:>8}  {word}  extent {extent}: the reach; distance {near}: the radii")
    }
}

impl<R: Exact> fmt::Display for Merged<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ((x, y), level) = (self.cell, self.level);
        writeln!(f, "  level {level}, cell ({x}, {y})")?;
        if !self.finer.iter().any(Center::is_valid) {
            return writeln!(f, "    all four are empty");
        }
        for j in 0..4 {
            writeln!(f, "    {j}  {}", self.fate(j))?;
        }
        let Center { id, depth, radius, extent, .. } = &self.found;
        if !self.found.is_valid() {
            return writeln!(f, "    gives nothing");
        }
        let [depth, radius, extent] = [depth, radius, extent].map_inline(|v| v.to_f64());
        writeln!(f, "    gives {id} at depth {depth}, radius {radius}, extent {extent} px")
    }
}

impl<R: Exact> fmt::Display for CenterAnswer<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ((x, y), level, id) = (self.cell, self.level, self.center.id);
        write!(f, "  level {level}, cell ({x}, {y}), surfel {id}: ")?;
        let sign = if self.holds { "<=" } else { outside(self.form, self.square) };
        let form = compared(self.form, sign, self.square);
        match (self.holds, self.own) {
            (true, _) => write!(f, "holds, form {form}")?,
            (false, true) => write!(f, "holds as the pixel's own, form {form}")?,
            (false, false) => return writeln!(f, "outside, form {form}"),
        }
        let (t, front) = (self.center.depth, self.before.depth);
        let sum = self.center.radius + self.before.radius;
        match self.test {
            Placement::Before if self.before.count == 0 => write!(f, "; the first")?,
            Placement::Before => {
                write!(f, "; before, starts anew: {}", compared(front - t, ">", sum))?;
            }
            Placement::Behind => {
                return writeln!(f, "; behind, left out: {}", compared(t - front, ">", sum));
            }
            Placement::Blended if t < front => {
                let distance = compared(front - t, "<=", sum);
                let depth = compared(t, "<", front);
                write!(f, "; blended: {distance}; the new front: depth {depth}")?;
            }
            Placement::Blended => {
                write!(f, "; blended: {}", compared(t - front, "<=", sum))?;
            }
        }
        writeln!(f, "; depth {}, weight {}", t.to_f64(), self.weight.to_f64())
    }
}

impl<R: Exact> fmt::Display for TemplateReplay<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (x, y) = self.pixel;
        writeln!(f, "pixel ({x}, {y})\n\n{}", self.projection)?;
        writeln!(
            f,
            "propagation: finer cells 0 left above, 1 right above, 2 left below, 3 right below"
        )?;
        for merged in &self.merged {
            write!(f, "{merged}")?;
        }
        let count = self.asked.len();
        writeln!(f, "\nreconstruction: {count} centres stay in the templates; distances in depth")?;
        for answer in &self.asked {
            write!(f, "{answer}")?;
        }
        let Gathered { id, depth, weight, count, .. } = &self.gathered;
        if *count == 0 {
            return writeln!(f, "\nthe pixel is empty");
        }
        let [depth, weight, average] = [depth, weight, &self.depth].map_inline(|v| v.to_f64());
        writeln!(f, "\nthe pixel blends {count} centres, the nearest {id} at depth {depth}")?;
        writeln!(f, "  sum of weights {weight}, average depth {average}")
    }
}
