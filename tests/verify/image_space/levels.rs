//! The levels of a pyramid.

use super::Client;
use super::bug::Bug;
use crate::verify::client::number::Number;

/// A record of numbers.
pub(super) trait Record: Copy {
    /// Each number made another.
    fn map(self, f: impl Fn(Number) -> Number) -> Self;
}

/// Records row by row from the top left; where there is none, the cell is empty.
#[derive(Clone)]
pub(super) struct Level<T> {
    pub(super) size: [u32; 2],
    pub(super) cells: Vec<Option<T>>,
}

impl<T: Copy> Level<T> {
    /// A level of which every cell is computed from its column and row.
    pub(super) fn made(size: [u32; 2], cell: impl Fn([u32; 2]) -> Option<T>) -> Self {
        let [width, height] = size;
        let cells = (0..height).flat_map(|y| (0..width).map(move |x| [x, y])).map(cell);
        Self { size, cells: cells.collect() }
    }

    /// A cell; what lies outside is empty.
    pub(super) fn at(&self, [x, y]: [i64; 2]) -> Option<T> {
        let [width, height] = self.size.map(i64::from);
        let exists = (0..width).contains(&x) && (0..height).contains(&y);
        self.cells[usize::try_from(if exists { y * width + x } else { return None }).unwrap()]
    }

    /// The four finer cells of a cell.
    pub(super) fn finer(&self, [x, y]: [u32; 2]) -> [Option<T>; 4] {
        let [x, y] = [2 * i64::from(x), 2 * i64::from(y)];
        [[x, y], [x + 1, y], [x, y + 1], [x + 1, y + 1]].map(|at| self.at(at))
    }
}

impl<T: Record> Level<T> {
    /// The level as textures give it back; level 1 with the bugs of a single level.
    pub(super) fn stored(mut self, client: &Client<'_>, number: usize) -> Self {
        let half = client.has(Bug::HalfLevels);
        for cell in &mut self.cells {
            *cell =
                cell.map(|cell| cell.map(|v| if half { to_half(client, v) } else { v.stored() }));
        }
        let valid: Vec<_> = (0..self.cells.len()).filter(|&i| self.cells[i].is_some()).collect();
        let middle = valid.get(valid.len() / 2).filter(|_| number == 1);
        if let Some(&middle) = middle {
            if client.has(Bug::CellDropped) {
                self.cells[middle] = None;
            }
            if client.has(Bug::CellNan) {
                self.cells[middle] =
                    self.cells[middle].map(|cell| cell.map(|_| client.number(f32::NAN)));
            }
        }
        self
    }

    /// The level as it is handed in.
    pub(super) fn handed(&self, client: &Client<'_>) -> Self {
        if !client.has(Bug::LevelsFlipped) {
            return self.clone();
        }
        let [_, height] = self.size.map(i64::from);
        Self::made(self.size, |[x, y]| self.at([x.into(), height - 1 - i64::from(y)]))
    }
}

/// A number with the ten digits of a half float.
fn to_half(client: &Client<'_>, number: Number) -> Number {
    client.number(f32::from_bits((number.value.to_bits() + 0x1000) & !0x1fff))
}

/// The sizes of the levels, from the picture to the level of one pixel.
pub(super) fn sizes(client: &Client<'_>) -> Vec<[u32; 2]> {
    let mut sizes = vec![client.shared.size];
    while sizes[sizes.len() - 1] != [1, 1] {
        sizes.push(sizes[sizes.len() - 1].map(|side| {
            if client.has(Bug::OddSizeRoundedDown) && side > 1 {
                side / 2
            } else {
                side.div_ceil(2)
            }
        }));
    }
    sizes
}
