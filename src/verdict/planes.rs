//! The planes of a record that a client hands in. One table, the record's planes, says how to find,
//! judge and read them.

use super::checks::{Report, input_where, inputs, number, triple, whole};
use super::client::{Client, StoredPlane};
use crate::frame::{NO_ID, Plane};
use crate::method::Job;
use crate::method::projection::SampleKind;
use crate::method::record::{Field, Part, Records};
use crate::method::stage::{Conditions, Holds, PlaneRow};
use crate::number::ball::Profile;
use crate::number::{Ball, Real, Vector3};

/// A plane of a client, of any type.
#[derive(Clone, Copy, Debug)]
enum AnyStored<'a> {
    Index(StoredPlane<'a, u32>),
    Count(StoredPlane<'a, u8>),
    Scalar(StoredPlane<'a, f64>),
    Triple(StoredPlane<'a, [f64; 3]>),
}

/// The planes of a record that are there.
#[derive(Clone, Debug)]
pub(crate) struct RecordPlanes<'a> {
    /// Each plane with its index in the table, in the order in which they are judged: indices,
    /// counts, numbers, then vectors and colours.
    planes: Vec<(usize, AnyStored<'a>)>,
    /// The names in the order of the table.
    names: Vec<&'static str>,
}

impl<'a> RecordPlanes<'a> {
    /// Finds the planes of a table. `number` replaces the `#` in the rows.
    pub(crate) fn new<T, R>(client: &'a Client, fields: &[Field<T, R>], number: usize) -> Self {
        Self::of_rows(client, fields.iter().map(|field| field.row).enumerate(), number)
    }

    /// Finds the planes of some rows. Each row comes with the table index of the plane that it
    /// stands for. Planes of one type are judged in this order.
    pub(crate) fn of_rows(
        client: &'a Client,
        rows: impl Iterator<Item = (usize, PlaneRow)>,
        number: usize,
    ) -> Self {
        let (mut planes, mut names) = (Vec::new(), Vec::new());
        for (place, row) in rows {
            let plane = match row.holds.plain() {
                Holds::Index => client.index_of(&row, number).map(AnyStored::Index),
                Holds::Count => client.count_of(&row, number).map(AnyStored::Count),
                Holds::Color | Holds::Vector => {
                    client.triple_of(&row, number).map(AnyStored::Triple)
                }
                _ => client.scalar_of(&row, number).map(AnyStored::Scalar),
            };
            names.extend(plane.map(|_| (place, row.name)));
            planes.extend(plane.map(|plane| (place, plane)));
        }
        planes.sort_by_key(|(_, plane)| match plane {
            AnyStored::Index(_) => 0,
            AnyStored::Count(_) => 1,
            AnyStored::Scalar(_) => 2,
            AnyStored::Triple(_) => 3,
        });
        names.sort_by_key(|(place, _)| *place);
        Self { planes, names: names.into_iter().map(|(_, name)| name).collect() }
    }

    /// The names of the rows, in the order of the table.
    pub(crate) fn names(&self) -> &[&'static str] {
        &self.names
    }

    /// The plane of ids.
    pub(crate) fn ids(&self) -> Option<StoredPlane<'a, u32>> {
        self.planes.iter().find_map(|(_, plane)| match plane {
            AnyStored::Index(plane) => Some(*plane),
            _ => None,
        })
    }

    /// The plane of depths.
    pub(crate) fn depths(&self) -> Option<StoredPlane<'a, f64>> {
        self.planes.iter().find_map(|(_, plane)| match plane {
            AnyStored::Scalar(plane) if plane.holds == Holds::Depth => Some(*plane),
            _ => None,
        })
    }

    /// Whether a plane says that nothing is at a pixel. Then every format holds its zeros exactly.
    fn is_empty(&self, (x, y): (u32, u32)) -> bool {
        self.planes.iter().any(|(_, plane)| match plane {
            AnyStored::Index(plane) => *plane.plane.at(x, y) == NO_ID,
            AnyStored::Count(plane) => *plane.plane.at(x, y) == 0,
            AnyStored::Scalar(plane) => {
                plane.holds == Holds::Depth && *plane.plane.at(x, y) == f64::INFINITY
            }
            AnyStored::Triple(_) => false,
        })
    }

    /// Whether the plane at an index of the table is there.
    pub(crate) fn has(&self, place: usize) -> bool {
        self.planes.iter().any(|(own, _)| *own == place)
    }

    /// Checks every plane at a pixel, in one part of the report.
    pub(crate) fn check<T: Copy, P: Profile>(
        &self,
        part: usize,
        fields: &[Field<T, Ball<P>>],
        at: (u32, u32),
        truth: &T,
        report: &mut Report<'_>,
    ) {
        let mut truth = *truth;
        for (place, plane) in &self.planes {
            match (plane, &fields[*place].part) {
                (AnyStored::Index(plane), Part::Id(of)) => {
                    whole(part, plane, at, *of(&mut truth), report);
                }
                (AnyStored::Count(plane), Part::Count(of)) => {
                    whole(part, plane, at, *of(&mut truth), report);
                }
                (AnyStored::Count(plane), Part::Kind(of)) => {
                    whole(part, plane, at, *of(&mut truth) as u8, report);
                }
                (AnyStored::Scalar(plane), Part::Number(of)) => {
                    number(part, plane, at, *of(&mut truth), report);
                }
                (AnyStored::Triple(plane), Part::Triple(of)) => {
                    triple(part, plane, at, *of(&mut truth), report);
                }
                (AnyStored::Triple(plane), Part::Direction(of)) => {
                    let Vector3 { x, y, z } = *of(&mut truth);
                    triple(part, plane, at, [x, y, z], report);
                }
                // Ids of 40 bits are judged by their ranks, which have 32.
                _ => {}
            }
        }
    }

    /// Puts the values of the planes at a pixel into a record, as the next stage reads them. Only
    /// planes that the scene has are read.
    pub(crate) fn read<T, P: Profile>(
        &self,
        fields: &[Field<T, Ball<P>>],
        there: &Conditions,
        at: (u32, u32),
        record: &mut T,
    ) {
        let empty = self.is_empty(at);
        let numbers = |plane: &StoredPlane<'_, [f64; 3]>| match *plane.plane.at(at.0, at.1) {
            [0.0, 0.0, 0.0] if empty => [Ball::ZERO; 3],
            _ => inputs(plane, at),
        };
        for (place, plane) in &self.planes {
            let Field { row, part } = &fields[*place];
            if !there.hold(row) {
                continue;
            }
            match (plane, part) {
                (AnyStored::Index(plane), Part::Id(of)) => {
                    *of(record) = *plane.plane.at(at.0, at.1);
                }
                (AnyStored::Count(plane), Part::Count(of)) => {
                    *of(record) = *plane.plane.at(at.0, at.1);
                }
                (AnyStored::Count(plane), Part::Kind(of)) => {
                    // There is no other kind, and a wrong number was found where it comes from.
                    let kind = SampleKind::ALL.get(usize::from(*plane.plane.at(at.0, at.1)));
                    *of(record) = kind.copied().unwrap_or_default();
                }
                (AnyStored::Scalar(plane), Part::Number(of)) => {
                    *of(record) = input_where(plane, at, empty);
                }
                (AnyStored::Triple(plane), Part::Triple(of)) => *of(record) = numbers(plane),
                (AnyStored::Triple(plane), Part::Direction(of)) => {
                    let [x, y, z] = numbers(plane);
                    *of(record) = Vector3::new(x, y, z);
                }
                _ => {}
            }
        }
    }

    /// The records as the next stage reads them. None unless all planes that the scene has are
    /// there.
    pub(crate) fn records<T: Copy + Sync, P: Profile>(
        &'a self,
        job: &Job<'_>,
        fields: &'a [Field<T, Ball<P>>],
        there: Conditions,
        size: [u32; 2],
        empty: T,
    ) -> Option<ClientRecords<'a, T>> {
        let mut wanted = fields.iter().enumerate().filter(|(_, field)| there.hold(&field.row));
        let read = move |x, y| {
            let mut record = empty;
            self.read(fields, &there, (x, y), &mut record);
            record
        };
        wanted.all(|(place, _)| self.has(place)).then(|| ClientRecords::new(job, size, read))
    }
}

/// The records of a client as the next stage reads them.
pub(crate) enum ClientRecords<'a, T> {
    All(Plane<T>),
    /// Where a part of a picture is judged, few are read, each where it is asked for.
    Asked([u32; 2], Box<dyn Fn(u32, u32) -> T + Sync + 'a>),
}

impl<'a, T> ClientRecords<'a, T> {
    pub(crate) fn new(
        job: &Job<'_>,
        size: [u32; 2],
        read: impl Fn(u32, u32) -> T + Sync + 'a,
    ) -> Self {
        match job.part {
            Some(_) => Self::Asked(size, Box::new(read)),
            None => Self::All(Plane::from_pixels(size, read)),
        }
    }
}

impl<T: Copy> Records<T> for ClientRecords<'_, T> {
    fn size(&self) -> [u32; 2] {
        match self {
            Self::All(plane) => plane.size(),
            Self::Asked(size, _) => *size,
        }
    }

    #[inline(always)]
    fn with<U>(&self, x: u32, y: u32, read: impl FnOnce(&T) -> U) -> U {
        match self {
            Self::All(plane) => read(plane.at(x, y)),
            Self::Asked(_, record) => read(&record(x, y)),
        }
    }
}

/// The names of the planes of several groups, each once, in the order of a table.
pub(crate) fn names<'a, T, R>(
    fields: &[Field<T, R>],
    all: impl Iterator<Item = &'a RecordPlanes<'a>> + Clone,
) -> Vec<&'static str> {
    let names = fields.iter().map(|field| field.row.name);
    names.filter(|name| all.clone().any(|planes| planes.names.contains(name))).collect()
}
