//! Hold a level in rows of numbers.

use crate::frame::NO_ID;
use crate::method::projection::fast::{PAD, RowLayout};
use crate::number::lanes::{LANES, Lanes, load, store, vector};
use crate::splat::Ellipse;

/// The numbers of a centre, by their place in a row. First the position in the picture, two
/// numbers.
pub(super) const PLACE: usize = 0;
/// The ellipse's tilt, two numbers.
pub(super) const TILT: usize = 2;
/// The ellipse's square; NaN, which holds no form, if no centre stays here.
pub(super) const SQUARE: usize = 4;
pub(super) const DEPTH: usize = 5;
pub(super) const RADIUS: usize = 6;
pub(super) const EXTENT: usize = 7;
/// The normal, three numbers. After it the colour, three, if the scene has colours.
pub(super) const NORMAL: usize = 8;
/// The first number that not every scene has.
pub(super) const COLOR: usize = 11;

/// The layout of a level of this size.
pub(super) fn layout(size: [u32; 2], color: bool) -> RowLayout {
    RowLayout::new(size, if color { COLOR + 3 } else { COLOR })
}

/// [`LANES`] centres of level 0.
pub(super) struct SampledLanes {
    pub(super) ids: [u32; LANES],
    pub(super) place: [Lanes; 2],
    pub(super) depth: Lanes,
    pub(super) radius: Lanes,
    pub(super) extent: Lanes,
    pub(super) normal: [Lanes; 3],
    pub(super) color: Option<[Lanes; 3]>,
}

/// A row of a level, to be written.
#[derive(Debug)]
pub(super) struct CenterRowMut<'a> {
    pub(super) numbers: &'a mut [f32],
    /// The id of each cell, after [`PAD`] cells; [`NO_ID`] where there is no centre.
    pub(super) ids: &'a mut [u32],
    /// Whether a centre stays in the row, and whether one moves on.
    pub(super) has: &'a mut [bool; 2],
}

/// A row of a level.
#[derive(Clone, Copy, Debug)]
pub(super) struct CenterRow<'a> {
    pub(super) numbers: &'a [f32],
    pub(super) ids: &'a [u32],
    pub(super) has: [bool; 2],
    pub(super) layout: RowLayout,
}

/// A level.
#[derive(Debug)]
pub(super) struct CenterLevel {
    pub(super) layout: RowLayout,
    numbers: Vec<f32>,
    ids: Vec<u32>,
    has: Vec<[bool; 2]>,
}

impl CenterLevel {
    /// An empty level.
    pub(super) fn new(layout: RowLayout) -> Self {
        let RowLayout { height, stride, .. } = layout;
        Self {
            layout,
            numbers: vec![f32::NAN; height * layout.row()],
            ids: vec![NO_ID; height * stride],
            has: vec![[false; 2]; height],
        }
    }

    /// A row of cells.
    #[inline(always)]
    pub(super) fn row(&self, y: usize) -> CenterRow<'_> {
        let (row, stride) = (self.layout.row(), self.layout.stride);
        CenterRow {
            numbers: &self.numbers[y * row..(y + 1) * row],
            ids: &self.ids[y * stride..(y + 1) * stride],
            has: self.has[y],
            layout: self.layout,
        }
    }

    /// Whether a centre stays at the level.
    pub(super) fn is_searched(&self) -> bool {
        self.has.iter().any(|[stays, _]| *stays)
    }

    /// All rows, to be written.
    pub(super) fn rows_mut(&mut self) -> impl Iterator<Item = CenterRowMut<'_>> {
        let numbers = self.numbers.chunks_mut(self.layout.row());
        let rows = numbers.zip(self.ids.chunks_mut(self.layout.stride)).zip(&mut self.has);
        rows.map(|((numbers, ids), has)| CenterRowMut { numbers, ids, has })
    }
}

impl CenterRow<'_> {
    /// A number of [`LANES`] cells; `first` counts the [`PAD`].
    #[inline(always)]
    pub(super) fn load(&self, attribute: usize, first: usize) -> Lanes {
        load(self.numbers, attribute * self.layout.stride + first)
    }

    /// Three numbers of [`LANES`] cells; `first` counts the [`PAD`].
    #[inline(always)]
    pub(super) fn load_vectors(&self, attribute: usize, first: usize) -> [Lanes; 3] {
        [
            self.load(attribute, first),
            self.load(attribute + 1, first),
            self.load(attribute + 2, first),
        ]
    }
}

impl CenterRowMut<'_> {
    /// Computes the ellipses of [`LANES`] cells from x on, whose ids, extents and normals are
    /// stored already, and notes which of them stay within `reach`.
    #[inline(always)]
    pub(super) fn settle(&mut self, layout: &RowLayout, x: usize, reach: f32) {
        let number = |attribute: usize| load(self.numbers, layout.at(attribute, x));
        let normal = [number(NORMAL), number(NORMAL + 1), number(NORMAL + 2)];
        let (extent, ids) = (number(EXTENT), load(self.ids, PAD + x));
        let (mut tilt, mut square) = ([[0.0; LANES]; 2], [0.0; LANES]);
        let mut has = [0_u32; 2];
        for i in 0..LANES {
            let ellipse = Ellipse::new(vector(&normal, i), extent[i]);
            let (valid, near) = (ids[i] != NO_ID, extent[i] <= reach);
            (tilt[0][i], tilt[1][i]) = (ellipse.tilt.x, ellipse.tilt.y);
            square[i] = if valid & near { ellipse.square } else { f32::NAN };
            has[0] |= u32::from(valid & near);
            has[1] |= u32::from(valid & !near);
        }
        for (k, lanes) in [(TILT, &tilt[0]), (TILT + 1, &tilt[1]), (SQUARE, &square)] {
            store(self.numbers, layout.at(k, x), lanes);
        }
        self.has[0] |= has[0] != 0;
        self.has[1] |= has[1] != 0;
    }

    /// Stores [`LANES`] centres from x on, except for their ellipses.
    #[inline(always)]
    pub(super) fn put(&mut self, layout: &RowLayout, x: usize, centers: &SampledLanes) {
        let SampledLanes { ids, place, depth, radius, extent, normal, color } = centers;
        let mut put = |attribute: usize, lanes: &Lanes| {
            store(self.numbers, layout.at(attribute, x), lanes);
        };
        put(DEPTH, depth);
        put(RADIUS, radius);
        put(EXTENT, extent);
        (0..2).for_each(|axis| put(PLACE + axis, &place[axis]));
        (0..3).for_each(|axis| put(NORMAL + axis, &normal[axis]));
        if let Some(color) = color {
            (0..3).for_each(|channel| put(COLOR + channel, &color[channel]));
        }
        store(self.ids, PAD + x, ids);
    }

    /// Marks [`LANES`] cells from x on as empty.
    #[inline(always)]
    pub(super) fn clear(&mut self, layout: &RowLayout, x: usize) {
        store(self.numbers, layout.at(SQUARE, x), &[f32::NAN; LANES]);
        store(self.ids, PAD + x, &[NO_ID; LANES]);
    }
}
