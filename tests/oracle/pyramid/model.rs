//! One cell of the pull and of the push phase by other means, from the level that the crate made.
//!
//! Whether a point is inside an ellipse is decided by its axes, as the paper puts it, and by the
//! form of the documentation; they must not contradict each other. Depths are compared exactly.

use crate::oracle::kit::number::{BITS, N3, Num, exact, ways};
use crate::oracle::kit::planes::at;
use crate::oracle::kit::projection::{TUBE, and};
use splatref::frame::Frame;
use splatref::method::pyramid::{Occlusion, Settings, Weights};
use splatref::number::Exact;

/// A cell as the crate left it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cell {
    pub(crate) kind: u8,
    pub(crate) front: f64,
    pub(crate) back: f64,
    pub(crate) radius: f64,
    pub(crate) displacement: [f64; 2],
    pub(crate) normal: [f64; 3],
    pub(crate) tangent: [f64; 3],
    pub(crate) color: [f64; 3],
}

impl Cell {
    pub(crate) const EMPTY: Self = Self {
        kind: 0,
        front: f64::INFINITY,
        back: f64::NEG_INFINITY,
        radius: 0.0,
        displacement: [0.0; 2],
        normal: [0.0; 3],
        tangent: [0.0; 3],
        color: [0.0; 3],
    };
}

/// A level: what does not exist is empty.
pub(crate) struct Level {
    pub(crate) size: [u32; 2],
    pub(crate) cells: Vec<Cell>,
}

impl Level {
    pub(crate) fn at(&self, x: i64, y: i64) -> Cell {
        let [width, height] = self.size.map(i64::from);
        let there = (0..width).contains(&x) && (0..height).contains(&y);
        if there { self.cells[(y * width + x) as usize] } else { Cell::EMPTY }
    }

    /// The level in the upper left corner of the planes of `stage`; the rest must be empty.
    pub(crate) fn read<R: Exact>(frame: &Frame<R>, stage: &str, size: [u32; 2]) -> Self {
        let plane = |name: &str| frame.plane(&format!("{stage}{name}"));
        let needed = |name: &str| plane(name).unwrap_or_else(|| panic!("no plane {stage}{name}"));
        let optional = |name: &str, i| plane(name).map_or([0.0; 3], |samples| at(samples, i));
        let mut cells = Vec::new();
        for i in 0..(frame.width * frame.height) as usize {
            let [x, y] = [i as u32 % frame.width, i as u32 / frame.width];
            let one = |name: &str| at(needed(name), i)[0];
            let cell = Cell {
                kind: one(".kind") as u8,
                front: one(".front"),
                back: one(".back"),
                radius: one(".extent"),
                displacement: [one(".displacement.X"), one(".displacement.Y")],
                normal: at(needed(".normal"), i),
                tangent: optional(".tangent", i),
                color: optional("", i),
            };
            if x < size[0] && y < size[1] {
                cells.push(cell);
            } else {
                assert_eq!(cell, Cell::EMPTY, "{stage}: ({x}, {y}) is outside the level");
            }
        }
        Self { size, cells }
    }

    /// Level 0 from the projection; the interval ends where the arithmetic says t + r is.
    pub(crate) fn projected<R: Exact>(frame: &Frame<R>) -> Self {
        let plane = |name: &str, i| {
            let samples = frame.plane(&format!("projection{name}"));
            samples.map_or([0.0; 3], |samples| at(samples, i))
        };
        let cell = |i| {
            let (kind, t, r) =
                (plane(".kind", i)[0] as u8, plane(".Z", i)[0], plane(".radius", i)[0]);
            if kind == 0 {
                return Cell::EMPTY;
            }
            // A sum in f64 rounded to f32 is the sum in f32: f64 has more than twice the digits.
            let back = if size_of::<R>() == 4 { f64::from((t + r) as f32) } else { t + r };
            Cell {
                kind,
                front: t,
                back,
                radius: plane(".extent", i)[0],
                displacement: [0.0; 2],
                normal: plane(".normal", i),
                tangent: plane(".tangent", i),
                color: plane("", i),
            }
        };
        let size = [frame.width, frame.height];
        Self { size, cells: (0..(size[0] * size[1]) as usize).map(cell).collect() }
    }
}

/// What a cell may be.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Expected<const P: u32> {
    pub(crate) kind: u8,
    pub(crate) front: Num<P>,
    pub(crate) back: Num<P>,
    pub(crate) radius: Num<P>,
    pub(crate) displacement: [Num<P>; 2],
    pub(crate) normal: N3<P>,
    pub(crate) tangent: N3<P>,
    pub(crate) color: N3<P>,
}

impl<const P: u32> Expected<P> {
    /// Exactly this.
    fn copy(cell: &Cell) -> Self {
        Self {
            kind: cell.kind,
            front: Num::exact(cell.front),
            back: Num::exact(cell.back),
            radius: Num::exact(cell.radius),
            displacement: cell.displacement.map(Num::exact),
            normal: exact(cell.normal),
            tangent: exact(cell.tangent),
            color: exact(cell.color),
        }
    }
}

/// A cell seen from the centre of another: where its ellipse lies.
#[derive(Clone, Copy)]
struct Neighbour<const P: u32> {
    cell: Cell,
    v: [Num<P>; 2],
    /// d^2 as the documentation has it.
    distance: Num<P>,
    inside: Option<bool>,
}

impl<const P: u32> Neighbour<P> {
    fn new(cell: Cell, offset: [f64; 2]) -> Self {
        let v = [0, 1].map(|i| Num::exact(cell.displacement[i]) + Num::exact(offset[i]));
        let [nx, ny, nz] = exact::<P>(cell.normal);
        let square = Num::exact(cell.radius) * Num::exact(cell.radius);
        let e = nx / nz * v[0] - ny / nz * v[1];
        let form = (v[0] * v[0] + v[1] * v[1]) + e * e;
        let holds = and(Num::ZERO.less(square), form.at_most_as(square));
        if let (Some(a), Some(b)) = (holds, by_axes(&cell, v.map(|v| Num::near(v.v, v.e)))) {
            assert!(a == b || P == BITS, "axes and form disagree: {cell:?} at {v:?}");
        }
        let inside = if cell.kind == 0 { Some(false) } else { holds };
        Self { cell, v, distance: form / square, inside }
    }
}

/// Whether an offset is inside an ellipse given by its axes: the major one perpendicular to (nx,
/// ny), the minor one shortened by |nz| for a unit normal.
fn by_axes(cell: &Cell, [x, y]: [Num<53>; 2]) -> Option<bool> {
    let [nx, ny, nz] = exact::<53>(cell.normal);
    let radius = Num::exact(cell.radius);
    // Nothing here overflows or underflows, unlike in f32.
    let tame = |v: Num<53>| v.v == 0.0 || (1e-15..1e15).contains(&v.v.abs());
    if ![nx, ny, nz, radius, x, y].into_iter().all(tame) {
        return None;
    }
    if radius.v == 0.0 || nz.v == 0.0 {
        return Some(false);
    }
    let across = (nx * nx + ny * ny).sqrt();
    let length = (across * across + nz * nz).sqrt();
    let (along, aside) = if across.v == 0.0 {
        (x, y)
    } else {
        // The picture's y points down.
        ((x * nx - y * ny) / across, (x * ny + y * nx) / across)
    };
    let minor = radius * (nz.abs() / length);
    let (a, b) = (along / minor, aside / radius);
    (a * a + b * b).at_most_as(Num::exact(1.0))
}

/// The foremost of those inside, and which are averaged with it.
fn averaged<const P: u32>(
    all: &[Neighbour<P>; 4],
    inside: [bool; 4],
) -> Option<(usize, [bool; 4])> {
    let mut foremost: Option<usize> = None;
    for j in (0..4).filter(|j| inside[*j]) {
        if foremost.is_none_or(|f| all[j].cell.front < all[f].cell.front) {
            foremost = Some(j);
        }
    }
    let first = foremost?;
    let of = |j: usize| all[j].cell;
    let takes = std::array::from_fn(|j| {
        // The intervals intersect: neither begins behind the end of the other.
        let overlap = of(j).front <= of(first).back && of(first).front <= of(j).back;
        inside[j] && overlap && (of(j).kind == TUBE) == (of(first).kind == TUBE)
    });
    Some((first, takes))
}

/// A weighted mean, within the bounds of its terms.
fn mean<const P: u32>(takes: [bool; 4], weights: [Num<P>; 4], a: [Num<P>; 4]) -> Num<P> {
    let term = |j: usize| if takes[j] { weights[j] * a[j] } else { Num::ZERO };
    let weight = |j: usize| if takes[j] { weights[j] } else { Num::ZERO };
    let sum = (term(0) + term(1)) + (term(2) + term(3));
    let total = (weight(0) + weight(1)) + (weight(2) + weight(3));
    let those = (0..4).filter(|j| takes[*j]).map(|j| a[j].v);
    let (low, high) =
        (those.clone().fold(f64::INFINITY, f64::min), those.fold(f64::NEG_INFINITY, f64::max));
    let all_equal = low == high && (0..4).all(|j| !takes[j] || a[j].e == 0.0);
    if all_equal {
        Num::exact(low)
    } else {
        (sum * (Num::exact(1.0) / total)).at_least(low).at_most(high)
    }
}

/// The average of some neighbours; `hull`: the interval is that of all of them, as in the pull
/// phase.
fn average<const P: u32>(
    all: &[Neighbour<P>; 4],
    (first, takes): (usize, [bool; 4]),
    weights: [Num<P>; 4],
    hull: bool,
) -> Expected<P> {
    let number = |of: &dyn Fn(&Neighbour<P>) -> Num<P>| {
        mean(takes, weights, std::array::from_fn(|j| of(&all[j])))
    };
    let vector =
        |of: &dyn Fn(&Cell) -> [f64; 3]| [0, 1, 2].map(|i| number(&|n| Num::exact(of(&n.cell)[i])));
    let fold = |of: &dyn Fn(&Cell) -> f64, start: f64, pick: fn(f64, f64) -> f64| {
        let those = (0..4).filter(|j| takes[*j]).map(|j| of(&all[j].cell));
        Num::exact(those.fold(start, pick))
    };
    let (front, back) = if hull {
        (
            fold(&|c| c.front, f64::INFINITY, f64::min),
            fold(&|c| c.back, f64::NEG_INFINITY, f64::max),
        )
    } else {
        (number(&|n| Num::exact(n.cell.front)), number(&|n| Num::exact(n.cell.back)))
    };
    Expected {
        kind: all[first].cell.kind,
        front,
        back,
        radius: number(&|n| Num::exact(n.cell.radius)),
        displacement: [0, 1].map(|i| number(&|n| n.v[i])),
        normal: vector(&|c| c.normal),
        tangent: axes(all, (first, takes), weights),
        color: vector(&|c| c.color),
    }
}

/// The average of tangents, each on the side of the first; where rounding decides the side, either.
fn axes<const P: u32>(
    all: &[Neighbour<P>; 4],
    (first, takes): (usize, [bool; 4]),
    weights: [Num<P>; 4],
) -> N3<P> {
    let front: N3<P> = all[first].cell.tangent.map(Num::exact);
    let sides: [Option<bool>; 4] = std::array::from_fn(|j| {
        let own: N3<P> = all[j].cell.tangent.map(Num::exact);
        let dot = (own[0] * front[0] + own[1] * front[1]) + own[2] * front[2];
        if all[j].cell.tangent == [0.0; 3] { Some(false) } else { dot.less(Num::ZERO) }
    });
    [0, 1, 2].map(|axis| {
        let term = |j: usize| {
            let v: f64 = all[j].cell.tangent[axis];
            match sides[j] {
                Some(true) => Num::exact(-v),
                Some(false) => Num::exact(v),
                None => Num { v: 0.0, e: v.abs() },
            }
        };
        mean(takes, weights, std::array::from_fn(term))
    })
}

/// What the cell (x, y) of the next coarser level may be.
pub(crate) fn pulled<const P: u32>(fine: &Level, side: f64, x: i64, y: i64) -> Vec<Expected<P>> {
    let all: [Neighbour<P>; 4] = std::array::from_fn(|j| {
        let (i, k) = (j as i64 % 2, j as i64 / 2);
        // From centre to centre.
        let offset = [i, k].map(|right| (right as f64 - 0.5) * side);
        Neighbour::new(fine.at(2 * x + i, 2 * y + k), offset)
    });
    let one = |inside| match averaged(&all, inside) {
        Some(those) => average(&all, those, [Num::exact(1.0); 4], true),
        None => Expected::copy(&Cell::EMPTY),
    };
    ways(all.map(|n| n.inside)).into_iter().map(one).collect()
}

/// Whether a valid cell is occluded by its parent.
pub(crate) fn occluded(cell: &Cell, parent: &Cell, rule: Occlusion) -> bool {
    let behind = cell.front > parent.back;
    parent.kind != 0 && (behind || (rule == Occlusion::Outside && cell.front < parent.front))
}

/// What the cell (x, y) may be after the push phase.
pub(crate) fn pushed<const P: u32>(
    (pull, coarse): (&Level, &Level),
    settings: &Settings,
    side: f64,
    [x, y]: [i64; 2],
) -> Vec<Expected<P>> {
    let cell = pull.at(x, y);
    let parent = coarse.at(x / 2, y / 2);
    if cell.kind != 0 && !occluded(&cell, &parent, settings.occlusion) {
        return vec![Expected::copy(&cell)];
    }
    let all: [Neighbour<P>; 4] = std::array::from_fn(|j| {
        let coordinate = |own: i64, across: bool| {
            let next = if own % 2 == 0 { own / 2 - 1 } else { own / 2 + 1 };
            if across { next } else { own / 2 }
        };
        let (u, v) = (coordinate(x, j % 2 == 1), coordinate(y, j / 2 == 1));
        // The distance of the two centres in the picture.
        let gap = |coarse: i64, fine: i64| {
            (coarse as f64 + 0.5) * 2.0 * side - (fine as f64 + 0.5) * side
        };
        Neighbour::new(coarse.at(u, v), [gap(u, x), gap(v, y)])
    });
    let one = |inside: [bool; 4]| match averaged(&all, inside) {
        Some(those) => {
            let weights = all.map(|n| match settings.weights {
                Weights::Box => Num::exact(1.0),
                Weights::Gaussian => (Num::exact(-2.0) * n.distance).exp(),
            });
            average(&all, those, weights, false)
        }
        None => Expected::copy(&cell),
    };
    ways(all.map(|n| n.inside)).into_iter().map(one).collect()
}
