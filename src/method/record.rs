//! Connect the records of a pixel to their planes: one row a plane.
//!
//! A record lists its planes once, each with the place of its value. Three things follow from that
//! list: the planes that a stage leaves, the records that a stage reads, and the planes that a
//! verdict takes from a client. In the same way, scene files and the command line follow from the
//! rows of [`crate::setting`].

use super::clock::{Work, spend};
use super::projection::SampleKind;
use super::stage::{Conditions, Holds, PlaneRow, When};
use crate::frame::{NO_ID, NamedPlane, Plane, Rect};
use crate::number::{Real, Vector3};

/// The records of all pixels.
pub(crate) trait Records<T> {
    /// Width and height in pixels.
    fn size(&self) -> [u32; 2];

    /// Passes the record of a pixel, which is not copied: in the verdict's numbers it is large.
    fn with<U>(&self, x: u32, y: u32, read: impl FnOnce(&T) -> U) -> U;

    /// The record of a pixel.
    #[inline(always)]
    fn record(&self, x: u32, y: u32) -> T
    where
        T: Copy,
    {
        self.with(x, y, |record| *record)
    }
}

impl<T: Copy> Records<T> for Plane<T> {
    #[inline(always)]
    fn size(&self) -> [u32; 2] {
        [self.width(), self.height()]
    }

    #[inline(always)]
    fn with<U>(&self, x: u32, y: u32, read: impl FnOnce(&T) -> U) -> U {
        read(self.at(x, y))
    }
}

/// A plane of records `T` with numbers `R`.
#[derive(Debug)]
pub(crate) struct Field<T, R> {
    /// The row of the plane.
    pub(crate) row: PlaneRow,
    /// The place of the plane's value in the record.
    pub(crate) part: Part<T, R>,
}

/// The place of a plane's value in a record `T` with numbers `R`.
#[derive(Debug)]
pub(crate) enum Part<T, R> {
    /// A number.
    Number(fn(&mut T) -> &mut R),
    /// Three numbers.
    Triple(fn(&mut T) -> &mut [R; 3]),
    /// A vector with named components: three numbers in a plane.
    Direction(fn(&mut T) -> &mut Vector3<R>),
    /// An id.
    Id(fn(&mut T) -> &mut u32),
    /// The lowest 32 bits of an id with up to 40 bits.
    LowId(fn(&mut T) -> &mut u64),
    /// The highest 8 bits of such an id. Its lowest bits are read first.
    HighId(fn(&mut T) -> &mut u64),
    /// A count.
    Count(fn(&mut T) -> &mut u8),
    /// What a pixel shows.
    Kind(fn(&mut T) -> &mut SampleKind),
}

impl<T, R> Field<T, R> {
    /// A plane that is there with the planes of the stages.
    pub(crate) const fn new(name: &'static str, holds: Holds, part: Part<T, R>) -> Self {
        Self { row: PlaneRow::new(name, holds, ""), part }
    }

    /// The plane with another unit.
    pub(crate) const fn unit(self, unit: &'static str) -> Self {
        Self { row: self.row.unit(unit), part: self.part }
    }

    /// The plane with another condition.
    pub(crate) const fn when(self, when: When) -> Self {
        Self { row: self.row.when(when), part: self.part }
    }

    /// The plane with a meaning.
    pub(crate) const fn says(self, meaning: &'static str) -> Self {
        Self { row: self.row.says(meaning), part: self.part }
    }
}

impl PlaneRow {
    /// Adds the place of the value, which makes the row a plane of records.
    pub(crate) const fn at<T, R>(self, part: Part<T, R>) -> Field<T, R> {
        Field { row: self, part }
    }
}

/// The rows of a table, for the stage that leaves these planes.
pub(crate) const fn rows<T, R, const N: usize>(fields: &[Field<T, R>; N]) -> [PlaneRow; N] {
    let mut rows = [fields[0].row; N];
    let mut i = 1;
    while i < N {
        rows[i] = fields[i].row;
        i += 1;
    }
    rows
}

/// Joins the rows of several tables, one table after the other.
macro_rules! joined {
    ($($rows:expr),+) => {{
        const ROWS: [$crate::method::PlaneRow; 0 $(+ $rows.len())+] = {
            let mut joined = [$crate::method::PlaneRow::new("", $crate::method::Holds::Color, "");
                0 $(+ $rows.len())+];
            let mut next = 0;
            $(
                let rows = $rows;
                let mut i = 0;
                while i < rows.len() {
                    joined[next] = rows[i];
                    (i, next) = (i + 1, next + 1);
                }
            )+
            assert!(next == joined.len());
            joined
        };
        &ROWS
    }};
}
pub(crate) use joined;

/// Makes planes from the records of these pixels of a picture, for the rows that are there.
/// `number` stands for the rows' `#`.
pub(crate) fn planes<T, R: Real>(
    fields: &[Field<T, R>],
    number: usize,
    window: Rect,
    record: &dyn Fn(u32, u32) -> T,
    there: &Conditions,
) -> Vec<NamedPlane<R>> {
    let plane = |Field { row, part }: &Field<T, R>| match part {
        Part::Number(part) => row.scalar(number, values(window, &|x, y| *part(&mut record(x, y)))),
        Part::Triple(part) => row.triple(number, values(window, &|x, y| *part(&mut record(x, y)))),
        Part::Direction(part) => {
            let components = |x, y| {
                let Vector3 { x, y, z } = *part(&mut record(x, y));
                [x, y, z]
            };
            row.triple(number, values(window, &components))
        }
        Part::Id(part) => row.index(number, values(window, &|x, y| *part(&mut record(x, y)))),
        Part::LowId(part) => {
            row.index(number, values(window, &|x, y| *part(&mut record(x, y)) as u32))
        }
        Part::HighId(part) => {
            row.count(number, values(window, &|x, y| high(*part(&mut record(x, y)))))
        }
        Part::Count(part) => row.count(number, values(window, &|x, y| *part(&mut record(x, y)))),
        Part::Kind(part) => {
            row.count(number, values(window, &|x, y| *part(&mut record(x, y)) as u8))
        }
    };
    fields.iter().filter(|field| there.hold(&field.row)).map(plane).collect()
}

fn values<V>(window: Rect, value: &dyn Fn(u32, u32) -> V) -> Plane<V> {
    spend(Work::Store);
    Plane::of_window(window, value)
}

/// The bits of an id above the lowest 32; 0 for no id.
fn high(id: u64) -> u8 {
    if id as u32 == NO_ID { 0 } else { (id >> 32) as u8 }
}

/// Joins the lowest 32 bits of an id with its higher bits. All bits are set if the lowest bits say
/// that there is no id.
pub(crate) fn wide_id(low: u32, high: u8) -> u64 {
    if low == NO_ID { u64::MAX } else { u64::from(high) << 32 | u64::from(low) }
}
