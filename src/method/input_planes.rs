//! Read the planes that a client gives to a stage.

use super::algorithm::Job;
use super::projection::{PixelSample, SampleKind};
use super::record::{Field, Part, wide_id};
use super::stage::{Holds, Keep, PlaneRow};
use super::tiled::{Tiled, pixels};
use crate::error::{Error, Result};
use crate::frame::{Frame, NO_ID, Plane, Samples};
use crate::number::{Exact, Vector3};

/// The planes of a client. Each plane is checked for its name, type and size.
///
/// A stage computes with the values that the client stored, unchanged.
#[derive(Clone, Copy, Debug)]
pub struct InputPlanes<'a, R> {
    frame: &'a Frame<R>,
    job: &'a Job<'a>,
}

impl<'a, R: Exact> InputPlanes<'a, R> {
    /// Reads the planes of a frame.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the frame does not have the size of the job's picture.
    pub(crate) fn new(frame: &'a Frame<R>, job: &'a Job<'a>) -> Result<Self> {
        let (found, picture) = ([frame.width, frame.height], job.size());
        if found == picture {
            return Ok(Self { frame, job });
        }
        let size = |[width, height]: [u32; 2]| format!("{width} x {height}");
        Err(Error::Invalid(format!(
            "the planes have {} pixels, but the camera's picture has {}",
            size(found),
            size(picture)
        )))
    }

    /// Whether the client gave the plane of a row; `number` stands for the row's `#`.
    pub(crate) fn has(&self, row: &PlaneRow, number: usize) -> bool {
        self.frame.plane(&row.numbered(number)).is_some()
    }

    /// A plane of one number a pixel.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the plane is missing, or has another type or size.
    pub(crate) fn scalar(&self, row: &PlaneRow, number: usize) -> Result<&'a Plane<R>> {
        match self.samples(row, number)? {
            Samples::Scalar(plane) => self.sized(row, number, plane),
            _ => Err(of_another_type(row, number)),
        }
    }

    /// A plane of colours or vectors, as the row says.
    ///
    /// # Errors
    /// As [`InputPlanes::scalar`].
    pub(crate) fn triple(&self, row: &PlaneRow, number: usize) -> Result<&'a Plane<[R; 3]>> {
        match (row.holds.plain(), self.samples(row, number)?) {
            (Holds::Color, Samples::Color(plane)) | (Holds::Vector, Samples::Vector(plane)) => {
                self.sized(row, number, plane)
            }
            _ => Err(of_another_type(row, number)),
        }
    }

    /// A plane of small counts.
    ///
    /// # Errors
    /// As [`InputPlanes::scalar`].
    pub(crate) fn count(&self, row: &PlaneRow, number: usize) -> Result<&'a Plane<u8>> {
        match self.samples(row, number)? {
            Samples::Count(plane) => self.sized(row, number, plane),
            _ => Err(of_another_type(row, number)),
        }
    }

    /// A plane of ids: surfels by index, then the primitives.
    ///
    /// # Errors
    /// As [`InputPlanes::scalar`], and if nothing in the scene has an id of the plane.
    pub(crate) fn ids(&self, row: &PlaneRow, number: usize) -> Result<&'a Plane<u32>> {
        let Samples::Index(plane) = self.samples(row, number)? else {
            return Err(of_another_type(row, number));
        };
        if self.job.joined.is_some() {
            // Nobody looks an id up: it is copied to the planes of later stages.
            return self.sized(row, number, plane);
        }
        let scene = self.job.scene;
        let count = scene.surfels.len() + scene.primitives.len();
        let objects = scene.objects.as_ref().filter(|_| count == 0);
        let known = |id: u32| match objects {
            // The lowest 32 bits of a wider id do not say enough. The caller that also has the high
            // bits checks the id.
            Some(objects) => objects.ids().is_wide() || objects.ids().find(id.into()).is_some(),
            None => (id as usize) < count,
        };
        if let Some(id) = plane.values().iter().find(|&&id| id != NO_ID && !known(id)) {
            let name = row.numbered(number);
            let of = match objects {
                Some(_) => "none of the scene's".into(),
                None => format!("the scene has {count} of them"),
            };
            return Err(Error::Invalid(format!("the plane `{name}` has the id {id}; {of}")));
        }
        self.sized(row, number, plane)
    }

    /// Copies the values of planes into records, as far as the scene has such planes. If there are
    /// fewer records than pixels, the records lie in the upper left corner.
    ///
    /// # Errors
    /// [`Error::Invalid`] if a plane is missing, or has another type or size, or has an id or a
    /// kind that does not exist.
    pub(crate) fn records<T>(
        &self,
        fields: &[Field<T, R>],
        number: usize,
        mut records: Plane<T>,
    ) -> Result<Plane<T>> {
        let there = self.job.there(Keep::Alone);
        for Field { row, part } in fields.iter().filter(|field| there.hold(&field.row)) {
            let to = &mut records;
            match part {
                Part::Number(part) => put(to, self.scalar(row, number)?, |to, v| *part(to) = v),
                Part::Triple(part) => put(to, self.triple(row, number)?, |to, v| *part(to) = v),
                Part::Direction(part) => {
                    let vector = |[x, y, z]: [R; 3]| Vector3::new(x, y, z);
                    put(to, self.triple(row, number)?, |to, v| *part(to) = vector(v));
                }
                Part::Id(part) => put(to, self.ids(row, number)?, |to, v| *part(to) = v),
                Part::LowId(part) => {
                    put(to, self.ids(row, number)?, |to, v| *part(to) = wide_id(v, 0));
                }
                Part::HighId(part) => put(to, self.count(row, number)?, |to, v| {
                    let id = part(to);
                    *id = wide_id(*id as u32, v);
                }),
                Part::Count(part) => put(to, self.count(row, number)?, |to, v| *part(to) = v),
                Part::Kind(part) => put(to, &self.kinds(row, number)?, |to, v| *part(to) = v),
            }
        }
        Ok(records)
    }

    /// The samples that the stage of projection left.
    ///
    /// # Errors
    /// As [`InputPlanes::records`].
    pub(crate) fn projection(&self) -> Result<Plane<PixelSample<R>>> {
        let [width, height] = self.job.camera.size();
        self.records(&PixelSample::PLANES, 0, Plane::filled(width, height, PixelSample::empty()))
    }

    /// What each pixel shows, from a plane of counts.
    fn kinds(&self, row: &PlaneRow, number: usize) -> Result<Plane<SampleKind>> {
        let counts = self.count(row, number)?;
        let last = SampleKind::ALL.len() - 1;
        if let Some(i) = counts.values().iter().position(|&value| usize::from(value) > last) {
            let (name, value, width) = (row.numbered(number), counts.values()[i], counts.width());
            let (x, y) = (i % width as usize, i / width as usize);
            let what = format!("the plane `{name}` has {value} at ({x}, {y}); at most {last}");
            return Err(Error::Invalid(what));
        }
        Ok(counts.map(|&value| SampleKind::ALL[usize::from(value)]))
    }

    /// One record for every pixel, tile by tile as passes hold them. A record without planes is
    /// `empty`.
    ///
    /// # Errors
    /// As [`InputPlanes::records`].
    pub(crate) fn pixels<T: Copy + Send + Sync>(
        &self,
        fields: &[Field<T, R>],
        number: usize,
        empty: T,
    ) -> Result<Tiled<T>> {
        let [width, height] = self.job.size();
        let records = self.records(fields, number, Plane::filled(width, height, empty))?;
        Ok(self.tiled(|x, y| *self.at(&records, x, y)))
    }

    /// The value of a plane at a column and row of the picture.
    pub(crate) fn at<'p, T>(&self, plane: &'p Plane<T>, x: u32, y: u32) -> &'p T {
        plane.at(x - self.job.window.x0, y - self.job.window.y0)
    }

    /// Makes a record for each pixel, counted in the picture, from the values of planes at that
    /// pixel.
    pub(crate) fn tiled<T: Send>(&self, record: impl Fn(u32, u32) -> T + Sync + Send) -> Tiled<T> {
        Tiled::new(self.job, |_, rect| pixels(rect).map(|(x, y)| record(x, y)).collect())
    }

    fn samples(&self, row: &PlaneRow, number: usize) -> Result<&'a Samples<R>> {
        let name = row.numbered(number);
        let missing = || Error::Invalid(format!("the plane `{name}` is missing"));
        self.frame.plane(&name).ok_or_else(missing)
    }

    fn sized<T>(&self, row: &PlaneRow, number: usize, plane: &'a Plane<T>) -> Result<&'a Plane<T>> {
        let (found, picture) = ([plane.width(), plane.height()], self.job.size());
        if found == picture {
            return Ok(plane);
        }
        Err(Error::Invalid(format!(
            "the plane `{}` is {} x {}, but the picture is {} x {}",
            row.numbered(number),
            found[0],
            found[1],
            picture[0],
            picture[1]
        )))
    }
}

/// Copies each value into the record of its pixel, as far as there are records.
fn put<T, V: Copy>(records: &mut Plane<T>, values: &Plane<V>, set: impl Fn(&mut T, V)) {
    let rows = values.values().chunks(values.width().max(1) as usize);
    for (records, values) in records.rows_mut().zip(rows) {
        records.iter_mut().zip(values).for_each(|(record, value)| set(record, *value));
    }
}

fn of_another_type(row: &PlaneRow, number: usize) -> Error {
    let (name, holds) = (row.numbered(number), row.holds.words());
    Error::Invalid(format!("the plane `{name}` has another type; give {holds}"))
}
