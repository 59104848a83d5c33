//! Reconstruction with templates \[MOC08\] by brute force, stage by stage, in f64.
//!
//! Each stage takes what the crate left before it, which f64 holds exactly, so that an error is
//! found where it arises and a decision that rounding turns spreads no further. Candidates of a
//! pixel are found by asking every centre of every level, not by visiting cells.

use crate::oracle::kit::eye::V3;
use crate::oracle::kit::number::{N3, Num, exact, normalized};
use crate::oracle::kit::projection::Sight;
use splatref::frame::NO_ID;
use splatref::method::template::{Falloff, LevelRule, Settings};

/// What a cell of a level holds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Center {
    pub(crate) id: u32,
    pub(crate) depth: f64,
    pub(crate) radius: f64,
    pub(crate) extent: f64,
    pub(crate) place: [f64; 2],
    pub(crate) normal: V3,
    pub(crate) color: V3,
}

/// A level; level 0 is the projection.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) cells: Vec<Option<Center>>,
}

impl Grid {
    pub(crate) fn at(&self, x: u32, y: u32) -> Option<&Center> {
        let inside = x < self.width && y < self.height;
        self.cells.get((y * self.width + x) as usize).filter(|_| inside)?.as_ref()
    }

    /// Every cell with its column and row, row by row.
    pub(crate) fn positions(&self) -> impl Iterator<Item = [u32; 2]> {
        let width = self.width;
        (0..self.height).flat_map(move |y| (0..width).map(move |x| [x, y]))
    }
}

/// What becomes of the centres that move into one cell.
pub(crate) struct Merged<const P: u32> {
    pub(crate) id: u32,
    /// In the order of the fields of [`Center`].
    pub(crate) depth: Num<P>,
    pub(crate) radius: Num<P>,
    pub(crate) extent: Num<P>,
    pub(crate) place: [Num<P>; 2],
    pub(crate) normal: N3<P>,
    pub(crate) color: N3<P>,
    /// The ids that take part, and those that are lost.
    pub(crate) members: Vec<u32>,
    pub(crate) lost: Vec<u32>,
}

/// A centre at the level where it stays.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Staying {
    pub(crate) level: usize,
    pub(crate) cell: [u32; 2],
    pub(crate) center: Center,
}

/// What a pixel gathers.
pub(crate) struct Sums<const P: u32> {
    pub(crate) id: u32,
    pub(crate) depth: f64,
    pub(crate) radius: f64,
    pub(crate) count: u32,
    /// How many were behind, and how often the sums started anew.
    pub(crate) hidden: u32,
    pub(crate) anew: u32,
    pub(crate) weight: Num<P>,
    pub(crate) depths: Num<P>,
    pub(crate) normal: N3<P>,
    pub(crate) color: N3<P>,
}

/// The method for pictures of one size, in an arithmetic of so many digits.
pub(crate) struct Template<const P: u32> {
    pub(crate) settings: Settings,
    /// Sizes of the levels from 0 to the top.
    pub(crate) sizes: Vec<[u32; 2]>,
}

/// The least weight.
const LEAST: f64 = 1.0 / 16_777_216.0;

impl<const P: u32> Template<P> {
    pub(crate) fn new(settings: Settings, [width, height]: [u32; 2]) -> Self {
        let reached = (settings.size - 1) / 2 + 1;
        let mut sizes = vec![[width, height]];
        while let Some(&[w, h]) = sizes.last()
            && (w > reached || h > reached)
        {
            sizes.push([w.div_ceil(2), h.div_ceil(2)]);
        }
        Self { settings, sizes }
    }

    pub(crate) fn top(&self) -> usize {
        self.sizes.len() - 1
    }

    /// Whether a centre at a level goes no further.
    pub(crate) fn stays(&self, level: usize, center: &Center) -> bool {
        let k = f64::from(self.settings.size);
        let cells = match self.settings.levels {
            LevelRule::Radius => k,
            LevelRule::Diameter => k / 2.0,
            LevelRule::BySize => k / if k == 3.0 { 1.0 } else { 2.0 },
            LevelRule::Covering => (k - 1.0) / 2.0,
        };
        level == self.top() || center.extent <= cells * (level as f64).exp2()
    }

    /// The centres that stay at a level, row by row.
    pub(crate) fn staying<'a>(
        &'a self,
        level: usize,
        grid: &'a Grid,
    ) -> impl Iterator<Item = Staying> + 'a {
        grid.positions().filter_map(move |cell| {
            let center = *grid.at(cell[0], cell[1])?;
            self.stays(level, &center).then_some(Staying { level, cell, center })
        })
    }

    /// The cell (x, y) of the level above `level`, from its four; `Err` if rounding decides.
    pub(crate) fn merged(
        &self,
        level: usize,
        finer: &Grid,
        [x, y]: [u32; 2],
    ) -> Result<Option<Merged<P>>, ()> {
        let four = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| finer.at(2 * x + i, 2 * y + j));
        let mut four = four.map(|cell| cell.filter(|center| !self.stays(level, center)));
        // The first of the least: ties go to the earlier.
        let moving = four.into_iter().flatten();
        let least = moving.clone().map(|c| c.depth).fold(f64::INFINITY, f64::min);
        let Some(front) = moving.clone().find(|c| c.depth == least) else { return Ok(None) };
        let mut lost = Vec::new();
        for place in &mut four {
            let Some(center) = place.filter(|center| center.id != front.id) else { continue };
            let apart = Num::<P>::exact(center.depth) - Num::exact(front.depth);
            let near = Num::exact(center.radius) + Num::exact(front.radius);
            if near.less(apart).ok_or(())? {
                lost.push(center.id);
                *place = None;
            }
        }
        let mean = |field: &dyn Fn(&Center) -> f64| mean(four.map(|cell| cell.map(field)));
        Ok(Some(Merged {
            id: front.id,
            depth: mean(&|c| c.depth),
            radius: mean(&|c| c.radius),
            extent: mean(&|c| c.extent),
            place: [0, 1].map(|i| mean(&|c| c.place[i])),
            normal: [0, 1, 2].map(|i| mean(&|c| c.normal[i])),
            color: [0, 1, 2].map(|i| mean(&|c| c.color[i])),
            members: four.into_iter().flatten().map(|c| c.id).collect(),
            lost,
        }))
    }

    /// Whether a pixel finds a cell of a level.
    pub(crate) fn finds(&self, level: usize, cell: [u32; 2], pixel: [u32; 2]) -> bool {
        let half = (self.settings.size - 1) / 2;
        (0..2).all(|i| (pixel[i] >> level).abs_diff(cell[i]) <= half)
    }

    /// What a pixel gathers of all centres that stay, in the order of levels and rows; `Err` if
    /// rounding decides.
    pub(crate) fn gathered(&self, all: &[Staying], pixel: [u32; 2]) -> Result<Option<Sums<P>>, ()> {
        let mut sums: Option<Sums<P>> = None;
        for Staying { level, cell, center } in all {
            if !self.finds(*level, *cell, pixel) {
                continue;
            }
            let own = *level == 0 && *cell == pixel;
            let Some(weight) = self.weight(center, pixel, own)? else { continue };
            let [t, r] = [center.depth, center.radius].map(Num::<P>::exact);
            if let Some(front) = &mut sums {
                let [t_front, r_front] = [front.depth, front.radius].map(Num::exact);
                if (r + r_front).less(t - t_front).ok_or(())? {
                    front.hidden += 1;
                    continue;
                }
                if (r + r_front).less(t_front - t).ok_or(())? {
                    *front = Sums { hidden: front.hidden, anew: front.anew + 1, ..Sums::NONE };
                }
            }
            let sums = sums.get_or_insert(Sums::NONE);
            if center.depth < sums.depth {
                (sums.id, sums.depth, sums.radius) = (center.id, center.depth, center.radius);
            }
            sums.add(center, weight);
        }
        Ok(sums)
    }

    /// The weight of a centre at a pixel if that is held, its `own` pixel at any rate; `Err` if
    /// rounding decides.
    pub(crate) fn weight(
        &self,
        center: &Center,
        pixel: [u32; 2],
        own: bool,
    ) -> Result<Option<Num<P>>, ()> {
        let rim = Num::exact(LEAST);
        let outside = Ok(own.then_some(rim));
        let [nx, ny, nz] = exact(center.normal);
        let square = Num::exact(center.extent) * Num::exact(center.extent);
        if center.normal[2] == 0.0 || square.v == 0.0 {
            return outside;
        }
        let form = {
            let [x, y] =
                [0, 1].map(|i| Num::exact(f64::from(pixel[i]) + 0.5) - Num::exact(center.place[i]));
            let behind = nx / nz * x - ny / nz * y;
            x * x + y * y + behind * behind
        };
        match square.less(form) {
            None => Err(()),
            Some(true) => outside,
            Some(false) => Ok(Some(match self.settings.falloff {
                Falloff::Linear => (Num::exact(1.0) - (form / square).sqrt()).at_least(LEAST),
                Falloff::Gaussian => (Num::exact(-2.0) * (form / square)).exp(),
            })),
        }
    }
}

/// The plain mean of those that are there, within their bounds.
fn mean<const P: u32>(four: [Option<f64>; 4]) -> Num<P> {
    let there = four.into_iter().flatten();
    let [least, greatest] =
        [there.clone().fold(f64::INFINITY, f64::min), there.clone().fold(-f64::INFINITY, f64::max)];
    let [a, b, c, d] = four.map(|v| v.map_or(Num::ZERO, Num::exact));
    let sum = (a + b) + (c + d);
    let count = there.count();
    let scale = Num::exact(1.0) / Num::exact(count as f64);
    let mean = if count == 1 { sum } else { sum * scale };
    mean.at_least(least).at_most(greatest)
}

impl<const P: u32> Sums<P> {
    const NONE: Self = Self {
        id: NO_ID,
        depth: f64::INFINITY,
        radius: 0.0,
        count: 0,
        hidden: 0,
        anew: 0,
        weight: Num::ZERO,
        depths: Num::ZERO,
        normal: [Num::ZERO; 3],
        color: [Num::ZERO; 3],
    };

    fn add(&mut self, center: &Center, weight: Num<P>) {
        let more =
            |sum: N3<P>, value: V3| [0, 1, 2].map(|i| sum[i] + weight * Num::exact(value[i]));
        self.count += 1;
        self.weight = self.weight + weight;
        self.depths = self.depths + weight * Num::exact(center.depth);
        self.normal = more(self.normal, center.normal);
        self.color = more(self.color, center.color);
    }
}

/// A sum divided by its weight, which is > 0.
pub(crate) fn average<const P: u32>(sum: V3, weight: f64) -> N3<P> {
    sum.map(|v| Num::exact(v) / Num::exact(weight))
}

/// The direction of a sum of view-space normals in world space; none if they cancel.
pub(crate) fn direction<const P: u32>(sight: &Sight<P>, sum: V3, weight: f64) -> Option<N3<P>> {
    if sum == [0.0; 3] {
        return Some(exact([0.0; 3]));
    }
    let world = sight.turned(average(sum, weight));
    let size = world.map(|c| c.v.abs()).into_iter().fold(0.0, f64::max);
    let worst = world.map(|c| c.e).into_iter().fold(0.0, f64::max);
    (worst < 1e3 * Num::<P>::unit() * size).then(|| normalized(world))
}
