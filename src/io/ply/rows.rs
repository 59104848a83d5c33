//! Decode vertices that all have the same length in bytes, in parallel.
//!
//! Large files consist of such vertices: binary, little-endian, without lists and groups. A row
//! cannot fail, because the reader does not judge values. The walk in [`super::values`] reads all
//! other vertices.

use super::decode::Decode;
use super::header::{Element, Format, PropertyKind, Scalar};
use super::layout::{
    COLOR, COORDINATE, Layout, MIPMAP, NORMAL, OPACITY, POSITION, PropertyUse, RADIUS, TANGENT,
    TANGENTS,
};
use crate::frame::Exec;
use crate::scene::{Cloud, Coordinates};
use glam::{Vec2, Vec3};
use std::ops::Range;

/// How to decode a row.
pub(super) struct Rows {
    /// Bytes of a row.
    stride: usize,
    /// For each place in [`super::layout::NAMES`], and then in the levels, the number that goes
    /// there.
    numbers: Vec<Option<Number>>,
}

/// A number of a row.
#[derive(Clone, Copy)]
struct Number {
    /// The offset of its first byte in the row.
    at: usize,
    scalar: Scalar,
    decode: Decode,
}

impl Rows {
    /// `None` if the vertices must be read one number after another.
    pub(super) fn new(element: &Element, layout: &Layout, format: Format) -> Option<Self> {
        if format != Format::Little {
            return None;
        }
        let mut rows = Self { stride: 0, numbers: vec![None; layout.width()] };
        for (property, slot) in element.properties.iter().zip(&layout.slots) {
            let PropertyKind::One(scalar) = property.kind else { return None };
            match *slot {
                PropertyUse::Skip => {}
                PropertyUse::Number(place, decode) => {
                    rows.numbers[place] = Some(Number { at: rows.stride, scalar, decode });
                }
                PropertyUse::Group(_) => return None,
            }
            rows.stride += scalar.size() as usize;
        }
        Some(rows)
    }

    /// How many bytes a row has.
    pub(super) fn stride(&self) -> usize {
        self.stride
    }

    /// Makes room for `count` rows, so that no array is copied while it grows.
    pub(super) fn reserve(&self, count: usize, cloud: &mut Cloud) {
        cloud.position.reserve_exact(count);
        [&mut cloud.normal, &mut cloud.color, &mut cloud.tangent]
            .into_iter()
            .flatten()
            .for_each(|vectors| vectors.reserve_exact(count));
        [&mut cloud.radius, &mut cloud.opacity]
            .into_iter()
            .flatten()
            .for_each(|numbers| numbers.reserve_exact(count));
        cloud.tangents.iter_mut().for_each(|pairs| pairs.reserve_exact(count));
        if let Some(Coordinates::Points(all)) = &mut cloud.coordinates {
            all.reserve_exact(count);
        }
        if let Some(mipmap) = &mut cloud.mipmap {
            let levels = mipmap.levels();
            mipmap.colors_mut().reserve_exact(count * levels);
        }
    }

    /// Appends the rows of `bytes` to the arrays that `cloud` has.
    pub(super) fn append(&self, bytes: &[u8], cloud: &mut Cloud, exec: &Exec) {
        let table = Table { rows: self, bytes, exec };
        table.vectors(&mut cloud.position, POSITION);
        let vectors =
            [(&mut cloud.normal, NORMAL), (&mut cloud.color, COLOR), (&mut cloud.tangent, TANGENT)];
        for (to, places) in vectors {
            to.iter_mut().for_each(|to| table.vectors(to, places.clone()));
        }
        for (to, places) in [(&mut cloud.radius, RADIUS), (&mut cloud.opacity, OPACITY)] {
            to.iter_mut().for_each(|to| table.put(to, places.clone(), |[number]| number));
        }
        let pair = |[a, b, c, d, e, f]: [f32; 6]| [Vec3::new(a, b, c), Vec3::new(d, e, f)];
        cloud.tangents.iter_mut().for_each(|to| table.put(to, TANGENTS, pair));
        if let Some(Coordinates::Points(all)) = &mut cloud.coordinates {
            table.put(all, COORDINATE, Vec2::from_array);
        }
        cloud.mipmap.iter_mut().for_each(|mipmap| table.levels(mipmap.colors_mut()));
    }
}

/// Rows to decode.
struct Table<'a> {
    rows: &'a Rows,
    bytes: &'a [u8],
    exec: &'a Exec,
}

impl Table<'_> {
    fn vectors(&self, to: &mut Vec<Vec3>, places: Range<usize>) {
        self.put(to, places, Vec3::from_array);
    }

    /// Appends the prefiltered colours of each row, level by level.
    fn levels(&self, to: &mut Vec<Vec3>) {
        let stride = self.rows.stride;
        let numbers: Vec<Number> = self.rows.numbers[MIPMAP..].iter().flatten().copied().collect();
        let levels = numbers.len() / 3;
        let count = self.bytes.len() / stride;
        self.exec.extend(to, count * levels, |i| {
            let row = &self.bytes[i / levels * stride..][..stride];
            let [red, green, blue] = [0, 1, 2].map(|c| numbers[i % levels * 3 + c].value(row));
            Vec3::new(red, green, blue)
        });
    }

    /// Appends one value for each row, made from the `N` numbers at `places`.
    fn put<T: Send, const N: usize>(
        &self,
        to: &mut Vec<T>,
        places: Range<usize>,
        of: impl Fn([f32; N]) -> T + Sync + Send,
    ) {
        let stride = self.rows.stride;
        let numbers = self.rows.numbers[places].iter().flatten().copied().collect::<Vec<_>>();
        let Some(&numbers) = numbers.first_chunk::<N>() else { return };
        let count = self.bytes.len() / stride;
        let row = |i: usize| &self.bytes[i * stride..][..stride];
        // Most files have plain `f32`; one test here saves a test for each number.
        if numbers.iter().all(Number::is_plain) {
            self.exec.extend(to, count, |i| of(each(&numbers, |number| number.plain(row(i)))));
        } else if let Some(table) = table_of_bytes(&numbers) {
            let value = |row: &[u8], number: Number| table[usize::from(row[number.at])];
            self.exec.extend(to, count, |i| of(each(&numbers, |number| value(row(i), number))));
        } else {
            self.exec.extend(to, count, |i| of(each(&numbers, |number| number.value(row(i)))));
        }
    }
}

/// The table of the codes, if all numbers are bytes of sRGB.
fn table_of_bytes(numbers: &[Number]) -> Option<&'static [f32; 256]> {
    let tables = numbers.iter().map(|number| match (number.scalar, number.decode) {
        (Scalar::U8, Decode::Srgb(table)) => table.first_chunk(),
        _ => None,
    });
    // All bytes of sRGB share one table.
    tables.reduce(Option::and)?
}

/// Applies `of` to each number; `array::map` is not inlined in builds of many units.
#[inline]
fn each<const N: usize>(numbers: &[Number; N], of: impl Fn(Number) -> f32) -> [f32; N] {
    let mut values = [0.0; N];
    values.iter_mut().zip(numbers).for_each(|(value, &number)| *value = of(number));
    values
}

impl Number {
    /// Whether the number is an `f32` that is kept.
    fn is_plain(&self) -> bool {
        matches!((self.scalar, self.decode), (Scalar::F32, Decode::Keep))
    }

    #[inline]
    fn plain(self, row: &[u8]) -> f32 {
        f32::from_le_bytes(self.of(row))
    }

    #[inline]
    fn value(self, row: &[u8]) -> f32 {
        self.decode.apply(match self.scalar {
            Scalar::I8 => f64::from(i8::from_le_bytes(self.of(row))),
            Scalar::U8 => f64::from(u8::from_le_bytes(self.of(row))),
            Scalar::I16 => f64::from(i16::from_le_bytes(self.of(row))),
            Scalar::U16 => f64::from(u16::from_le_bytes(self.of(row))),
            Scalar::I32 => f64::from(i32::from_le_bytes(self.of(row))),
            Scalar::U32 => f64::from(u32::from_le_bytes(self.of(row))),
            Scalar::F32 => f64::from(f32::from_le_bytes(self.of(row))),
            Scalar::F64 => f64::from_le_bytes(self.of(row)),
        })
    }

    /// The bytes of the number; the caller's row is long enough.
    #[inline]
    fn of<const N: usize>(self, row: &[u8]) -> [u8; N] {
        row[self.at..].first_chunk().copied().unwrap_or([0; N])
    }
}
