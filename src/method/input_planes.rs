//! Somebody's planes, as the stages of every method read them.

use super::algorithm::Job;
use super::stage::{Holds, PlaneRow};
use super::tiled::{Tiled, pixels};
use crate::error::{Error, Result};
use crate::frame::{Frame, NO_ID, Plane, Samples};
use crate::number::Exact;

/// Somebody's planes, each found by its row, its type and its size.
///
/// Their values are taken as they are: a stage computes with what a client has stored.
#[derive(Clone, Copy, Debug)]
pub struct InputPlanes<'a, R> {
    frame: &'a Frame<R>,
    job: &'a Job<'a>,
}

impl<'a, R: Exact> InputPlanes<'a, R> {
    /// The planes of a frame.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the frame is not of the size of the job's picture.
    pub(crate) fn new(frame: &'a Frame<R>, job: &'a Job<'a>) -> Result<Self> {
        let (found, picture) = ([frame.width, frame.height], job.camera.size());
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

    /// Whether there is a plane of a row; `number` stands for the row's `#`.
    pub(crate) fn has(&self, row: &PlaneRow, number: usize) -> bool {
        self.frame.plane(&row.numbered(number)).is_some()
    }

    /// One number a pixel.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the plane is missing, or of another type or size.
    pub(crate) fn scalar(&self, row: &PlaneRow, number: usize) -> Result<&'a Plane<R>> {
        match self.samples(row, number)? {
            Samples::Scalar(plane) => self.sized(row, number, plane),
            _ => Err(of_another_type(row, number)),
        }
    }

    /// Colours or vectors, as the row says.
    ///
    /// # Errors
    /// As [`InputPlanes::scalar`].
    pub(crate) fn triple(&self, row: &PlaneRow, number: usize) -> Result<&'a Plane<[R; 3]>> {
        match (row.holds, self.samples(row, number)?) {
            (Holds::Color, Samples::Color(plane)) | (Holds::Vector, Samples::Vector(plane)) => {
                self.sized(row, number, plane)
            }
            _ => Err(of_another_type(row, number)),
        }
    }

    /// Colours or vectors, if the scene has these.
    ///
    /// # Errors
    /// As [`InputPlanes::scalar`].
    pub(crate) fn triple_if(
        &self,
        has: bool,
        row: &PlaneRow,
        number: usize,
    ) -> Result<Option<&'a Plane<[R; 3]>>> {
        has.then(|| self.triple(row, number)).transpose()
    }

    /// Small counts.
    ///
    /// # Errors
    /// As [`InputPlanes::scalar`].
    pub(crate) fn count(&self, row: &PlaneRow, number: usize) -> Result<&'a Plane<u8>> {
        match self.samples(row, number)? {
            Samples::Count(plane) => self.sized(row, number, plane),
            _ => Err(of_another_type(row, number)),
        }
    }

    /// Ids: surfels by index, then the primitives.
    ///
    /// # Errors
    /// As [`InputPlanes::scalar`], and if the scene has nothing of an id.
    pub(crate) fn ids(&self, row: &PlaneRow, number: usize) -> Result<&'a Plane<u32>> {
        let Samples::Index(plane) = self.samples(row, number)? else {
            return Err(of_another_type(row, number));
        };
        let scene = self.job.scene;
        let count = scene.surfels.len() + scene.primitives.len();
        let objects = scene.objects.as_ref().filter(|_| count == 0);
        let known = |id: u32| match objects {
            // What 32 bits of a wider id say alone is for those to judge that have the others.
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

    /// A record for each pixel, made of the values of planes there.
    pub(crate) fn tiled<T: Send>(&self, record: impl Fn(u32, u32) -> T + Sync + Send) -> Tiled<T> {
        Tiled::new(self.job, |_, rect| pixels(rect).map(|(x, y)| record(x, y)).collect())
    }

    fn samples(&self, row: &PlaneRow, number: usize) -> Result<&'a Samples<R>> {
        let name = row.numbered(number);
        let missing = || Error::Invalid(format!("the plane `{name}` is missing"));
        self.frame.plane(&name).ok_or_else(missing)
    }

    fn sized<T>(&self, row: &PlaneRow, number: usize, plane: &'a Plane<T>) -> Result<&'a Plane<T>> {
        let (found, picture) = ([plane.width(), plane.height()], self.job.camera.size());
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

fn of_another_type(row: &PlaneRow, number: usize) -> Error {
    let (name, holds) = (row.numbered(number), row.holds.words());
    Error::Invalid(format!("the plane `{name}` has another type; give {holds}"))
}
