//! Pull and push.

use super::Client;
use super::bug::Bug;
use super::ellipse::Ellipse;
use super::levels::{Level, Record, sizes};
use super::mean::Mean;
use super::planes::{Sheet, Surface};
use super::projection::{Sample, project};
use crate::verify::client::number::{Number, Vector};
use splatref::Frame;
use splatref::method::pyramid::{Occlusion, Settings, Weights};

/// A pixel of a level that has something.
#[derive(Clone, Copy)]
struct Cell {
    front: Number,
    back: Number,
    /// Radius in pixels of level 0.
    extent: Number,
    /// From the centre of the cell to that of the ellipse.
    displacement: [Number; 2],
    normal: Vector,
    color: Vector,
}

impl Record for Cell {
    fn map(self, f: impl Fn(Number) -> Number) -> Self {
        Self {
            front: f(self.front),
            back: f(self.back),
            extent: f(self.extent),
            displacement: self.displacement.map(&f),
            normal: self.normal.map(&f),
            color: self.color.map(&f),
        }
    }
}

/// Of four cells those that take part, and which one is foremost.
struct Foremost {
    takes: [bool; 4],
    first: usize,
}

struct Pyramid<'a> {
    client: &'a Client<'a>,
    settings: &'a Settings,
}

type Four = [Option<Cell>; 4];

/// Every plane of the method.
pub(super) fn render(client: &Client<'_>, settings: &Settings) -> Frame<f32> {
    let pyramid = Pyramid { client, settings };
    let samples = project(client);
    let pulled = pyramid.pull_all(&samples);
    let pushed = pyramid.push_all(&pulled);
    let mut sheet = Sheet::new(client);
    sheet.projection(&samples);
    for (number, level) in pulled.iter().enumerate().skip(1) {
        leave(&mut sheet, &format!("pull{number:02}"), &level.handed(client));
    }
    for (number, level) in pushed.iter().enumerate().take(pushed.len() - 1) {
        leave(&mut sheet, &format!("push{number:02}"), level);
    }
    let surfaces = pushed[0].cells.iter().map(|cell| {
        let cell = (*cell)?;
        let depth = if client.has(Bug::DepthOfBack) { cell.back } else { cell.front };
        Some(Surface {
            depth: depth.value,
            normal: client.to_world(cell.normal),
            color: cell.color.map(|color| color.value),
        })
    });
    sheet.picture(client, &Level { size: pushed[0].size, cells: surfaces.collect() });
    sheet.count("kind", &pushed[0], |_| 1);
    sheet.frame
}

/// The planes of a level.
fn leave(sheet: &mut Sheet, layer: &str, level: &Level<Cell>) {
    let name = |plane: &str| format!("{layer}.{plane}");
    sheet.count(&name("kind"), level, |_| 1);
    sheet.scalar(&name("front"), level, f32::INFINITY, |cell| cell.front);
    sheet.scalar(&name("back"), level, f32::NEG_INFINITY, |cell| cell.back);
    sheet.scalar(&name("extent"), level, 0.0, |cell| cell.extent);
    sheet.scalar(&name("displacement.X"), level, 0.0, |cell| cell.displacement[0]);
    sheet.scalar(&name("displacement.Y"), level, 0.0, |cell| cell.displacement[1]);
    sheet.vector(&name("normal"), level, |cell| cell.normal);
    sheet.color(layer, level, |cell| cell.color);
}

impl Pyramid<'_> {
    /// All levels from the finest.
    fn pull_all(&self, samples: &Level<Sample>) -> Vec<Level<Cell>> {
        let client = self.client;
        let finest = samples.cells.iter().map(|sample| Some(self.finest(sample.as_ref()?)));
        let mut levels = vec![Level { size: samples.size, cells: finest.collect() }];
        for (fine, &size) in sizes(client)[1..].iter().enumerate() {
            let side = self.side(fine);
            let coarse = Level::made(size, |cell| self.pull(levels[fine].finer(cell), side));
            levels.push(coarse.stored(client, fine + 1));
        }
        levels
    }

    /// A cell of level 0.
    fn finest(&self, sample: &Sample) -> Cell {
        let Sample { depth, radius, extent, normal, color, .. } = *sample;
        let front = if self.client.has(Bug::IntervalAround) { depth - radius } else { depth };
        let back = if self.client.has(Bug::IntervalWithoutRadius) { depth } else { depth + radius };
        let displacement = match self.client.how.bug {
            Some(Bug::PlaceWithinPixel) => {
                sample.center.map(|side| side - self.client.number(side.value.floor() + 0.5))
            }
            _ => [self.client.zero(); 2],
        };
        Cell { front, back, extent, displacement, normal, color }.map(Number::stored)
    }

    /// The side of the cells of a level in pixels.
    fn side(&self, level: usize) -> f32 {
        if self.client.has(Bug::SideNotDoubled) { 1.0 } else { (1_u32 << level) as f32 }
    }

    /// One cell from four finer ones with sides of so many pixels.
    fn pull(&self, finer: Four, side: f32) -> Option<Cell> {
        let half = match self.client.how.bug {
            Some(Bug::DisplacementNotHalved) => side,
            Some(Bug::DisplacementSign) => -side / 2.0,
            _ => side / 2.0,
        };
        let corners = [[-half, -half], [half, -half], [-half, half], [half, half]];
        let offsets = self.offsets(&finer, corners);
        let inside = self.inside(&finer, &offsets);
        let takes = match self.client.how.bug {
            Some(Bug::PullOfAll) => finer.map(|cell| cell.is_some()),
            _ => inside.map(|ratio| ratio.is_some()),
        };
        let Foremost { takes, first } = self.foremost(&finer, takes)?;
        let one = self.client.number(1.0);
        let mean = Mean::new(self.client, takes.map(|takes| takes.then_some(one)));
        let cell = self.merge(&finer, &offsets, &mean);
        let cell = match self.client.how.bug {
            Some(Bug::CornerForgotten) => Cell { displacement: finer[first]?.displacement, ..cell },
            _ => cell,
        };
        let back = |cell: Option<Cell>| cell.map_or(self.client.zero(), |cell| cell.back);
        Some(match self.client.how.bug {
            Some(Bug::BackOfTheForemost) => {
                Cell { front: finer[first]?.front, back: finer[first]?.back, ..cell }
            }
            Some(Bug::IntervalAveraged) => cell,
            _ => Cell {
                front: mean.least(finer.map(|cell| cell.map_or(self.client.zero(), |c| c.front))),
                back: mean.greatest(finer.map(back)),
                ..cell
            },
        })
    }

    /// From the centre of the new cell to the centres of the ellipses.
    fn offsets(&self, cells: &Four, centers: [[f32; 2]; 4]) -> [[Number; 2]; 4] {
        [0, 1, 2, 3].map(|j| {
            let displacement = cells[j].map_or([self.client.zero(); 2], |cell| cell.displacement);
            [0, 1].map(|axis| displacement[axis] + self.client.number(centers[j][axis]))
        })
    }

    /// The squared elliptical distances of the new centre from those whose ellipse holds it.
    fn inside(&self, cells: &Four, offsets: &[[Number; 2]; 4]) -> [Option<Number>; 4] {
        [0, 1, 2, 3].map(|j| {
            let cell = cells[j]?;
            let ellipse = Ellipse::new(cell.normal, cell.extent);
            let form = ellipse.form(self.client, offsets[j]);
            ellipse.holds(self.client, form).then(|| form / ellipse.square)
        })
    }

    /// The foremost of the candidates and those that overlap with it.
    fn foremost(&self, cells: &Four, candidates: [bool; 4]) -> Option<Foremost> {
        let candidate = |j: usize| cells[j].filter(|_| candidates[j]);
        let before = |a: &Cell, b: &Cell| match self.client.how.bug {
            Some(Bug::ForemostIsLast) => true,
            Some(Bug::ForemostTiesReversed) => a.front <= b.front,
            Some(Bug::ForemostByBack) => a.back < b.back,
            _ => a.front < b.front,
        };
        let valid = (0..4).filter(|&j| candidate(j).is_some());
        let first = valid.reduce(|first, j| match (candidate(j), candidate(first)) {
            (Some(a), Some(b)) if before(&a, &b) => j,
            _ => first,
        })?;
        let end = candidate(first)?.back;
        let takes = [0, 1, 2, 3].map(|j| {
            candidate(j).is_some_and(|cell| match self.client.how.bug {
                Some(Bug::OverlapIgnored) => true,
                Some(Bug::OverlapStrict) => cell.front < end || j == first,
                _ => cell.front <= end,
            })
        });
        Some(Foremost { takes, first })
    }

    /// The averages; the interval too.
    fn merge(&self, cells: &Four, offsets: &[[Number; 2]; 4], mean: &Mean<'_>) -> Cell {
        let zero = self.client.zero();
        let number = |of: fn(&Cell) -> Number| {
            mean.of(cells.map(|cell| cell.map_or(zero, |cell| of(&cell))))
        };
        let vector = |of: fn(&Cell) -> Vector| {
            mean.vector(cells.map(|cell| cell.map_or([zero; 3], |cell| of(&cell))))
        };
        Cell {
            front: number(|cell| cell.front),
            back: number(|cell| cell.back),
            extent: number(|cell| cell.extent),
            displacement: [0, 1].map(|axis| mean.of(offsets.map(|offset| offset[axis]))),
            normal: vector(|cell| cell.normal),
            color: vector(|cell| cell.color),
        }
    }

    /// All levels from the coarsest down, the finest first.
    fn push_all(&self, pulled: &[Level<Cell>]) -> Vec<Level<Cell>> {
        let mut pushed = pulled.to_vec();
        for fine in (0..pulled.len() - 1).rev() {
            if self.client.has(Bug::LevelNotPushed) && fine == 1 {
                continue;
            }
            let coarse = match self.client.how.bug {
                Some(Bug::PushFromPulled) => &pulled[fine + 1],
                _ => &pushed[fine + 1],
            };
            let side = self.side(fine);
            let level = Level::made(pulled[fine].size, |[x, y]| {
                let [x, y] = [x.into(), y.into()];
                self.pushed(pulled[fine].at([x, y]), coarse, [x, y], side)
            });
            pushed[fine] = level.stored(self.client, usize::MAX);
        }
        pushed
    }

    /// A cell after the push.
    fn pushed(
        &self,
        cell: Option<Cell>,
        coarse: &Level<Cell>,
        [x, y]: [i64; 2],
        side: f32,
    ) -> Option<Cell> {
        let parent = [x / 2, y / 2];
        let occluded = |cell: Cell| coarse.at(parent).is_some_and(|p| self.occluded(&cell, &p));
        if cell.is_some_and(|cell| !occluded(cell)) {
            return cell;
        }
        // The side of the parent that the cell is on.
        let [column, row] = [x, y].map(|at| {
            let odd = (at % 2 == 1) != self.client.has(Bug::NeighborOtherSide);
            if odd { 1 } else { -1 }
        });
        let [px, py] = parent;
        let places = [[px, py], [px + column, py], [px, py + row], [px + column, py + row]];
        let cells = places.map(|at| coarse.at(at));
        let near = [x, y].map(|at| if at % 2 == 1 { -side / 2.0 } else { side / 2.0 });
        let times = if self.client.has(Bug::NeighborTooNear) { -1.0 } else { -3.0 };
        let far = near.map(|near| times * near);
        let [[nx, ny], [fx, fy]] = [near, far];
        let offsets = self.offsets(&cells, [[nx, ny], [fx, ny], [nx, fy], [fx, fy]]);
        let instead = if self.client.has(Bug::OccludedEmptied) { None } else { cell };
        self.interpolated(&cells, &offsets).or(instead)
    }

    fn occluded(&self, cell: &Cell, parent: &Cell) -> bool {
        let outside = self.settings.occlusion == Occlusion::Outside && cell.front < parent.front;
        match self.client.how.bug {
            Some(Bug::OccludedStays) => false,
            Some(Bug::OccludedByFront) => cell.front > parent.front || outside,
            Some(Bug::OccludedByTouch) => cell.front >= parent.back || outside,
            _ => cell.front > parent.back || outside,
        }
    }

    /// A cell from its parent and three neighbours, if any holds its centre.
    fn interpolated(&self, cells: &Four, offsets: &[[Number; 2]; 4]) -> Option<Cell> {
        let inside = self.inside(cells, offsets);
        let candidates = inside.map(|ratio| ratio.is_some());
        let takes = match self.client.how.bug {
            Some(Bug::OccludedBlended) => candidates,
            _ => self.foremost(cells, candidates)?.takes,
        };
        let weights = [0, 1, 2, 3].map(|j| {
            let ratio = inside[j].filter(|_| takes[j])?;
            Some(match (self.settings.weights, self.client.how.bug) {
                (Weights::Box, _) | (_, Some(Bug::PushUnweighted)) => self.client.number(1.0),
                (_, Some(Bug::ExpWithoutTwo)) => (-ratio).exp(),
                (_, Some(Bug::ExpOfTheRoot)) => (ratio.sqrt() * -2.0).exp(),
                _ => (ratio * -2.0).exp(),
            })
        });
        weights
            .iter()
            .any(|weight| weight.is_some())
            .then(|| self.merge(cells, offsets, &Mean::new(self.client, weights)))
    }
}
