//! Hand in the planes of your renderer: planes by the names of a method's rows, and how exactly
//! each is stored.

pub use super::storage::Storage;

use crate::error::{Error, Result};
use crate::frame::{Frame, NamedPlane, Plane, Rect, Samples};
use crate::method::gaussians::record::GaussianRecord;
use crate::method::part::Around;
use crate::method::stage::numbered;
use crate::method::{Holds, Job, PlaneRow};
use crate::number::MapInline;
use crate::number::ball::{Ball, Profile};
use crate::scene::{Camera, Scene};
use crate::setting::Words;
use crate::splat::record::SplatRecord;
use crate::verdict::supposed::Supposed;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The rounding that a client promises for its operations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Rounding {
    /// The rounding that shading languages publish, see [`Gpu`](crate::number::ball::Gpu).
    #[default]
    Gpu,
    /// One rounding to nearest for each sum and product, and the device's own quotients, roots and
    /// exponentials, see [`Precise`](crate::number::ball::Precise). Sums run in ascending surfel
    /// index.
    Precise,
    /// One rounding to nearest for each operation, see [`Ieee`](crate::number::ball::Ieee). Sums
    /// run in ascending surfel index.
    Ieee,
}

impl Words for Rounding {
    const WORDS: &'static [(&'static str, Self)] =
        &[("gpu", Self::Gpu), ("precise", Self::Precise), ("ieee", Self::Ieee)];
}

impl Rounding {
    /// What is promised, in words.
    #[must_use]
    pub fn promise(self) -> &'static str {
        match self {
            Self::Gpu => "operations are as inexact as shading languages allow",
            Self::Precise => "sums and products round once, to nearest, in the written order",
            Self::Ieee => "each operation rounds once, to nearest",
        }
    }
}

/// The fragment that a client keeps, by its own word, among equally near fragments.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ties {
    /// The fragment with the lowest surfel index: the rule of this crate.
    #[default]
    Lowest,
    /// The fragment with the highest surfel index.
    Last,
    /// Any of them.
    Any,
}

impl Ties {
    /// Whether a fragment of `surfel` is kept before one of `other` that is as near.
    pub(crate) fn keeps(self, surfel: u32, other: u32) -> bool {
        match self {
            Self::Lowest => surfel < other,
            Self::Last => surfel > other,
            Self::Any => false,
        }
    }
}

impl Words for Ties {
    const WORDS: &'static [(&'static str, Self)] =
        &[("lowest", Self::Lowest), ("last", Self::Last), ("any", Self::Any)];
}

/// The end of the band of visible fragments behind a nearest fragment at depth t, as assumed for a
/// client. It is used for the method `ewa`; every other client has [`Band::Depth`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Band {
    /// The rule: t + epsilon.
    #[default]
    Depth,
    /// t - epsilon, so that no fragment is in it, not even the nearest.
    Before,
    /// The depth where nearness is 1/t - u epsilon, for this u.
    OfNearness(f64),
    /// The depth where the ray of the pixel is epsilon longer.
    AlongRay,
    /// t plus this many radii of the nearest fragment's surfel.
    RadiiOfNearest(f32),
}

/// The planes of a client.
///
/// Depth is t in world units, and +inf where a pixel is empty, whatever the client stores. In an
/// empty pixel the id is [`NO_ID`](crate::frame::NO_ID). Rows run from the top.
///
/// A pixel where certainly nothing is drawn holds exact values in every plane: depth +inf, no id,
/// and 0 for every weight, colour, normal and count. Every format holds these exactly, so no format
/// and no promise excuses another value there. A NaN is wrong wherever the allowed numbers do not
/// include NaN.
///
/// `Decided:` -0 equals 0. This crate stores -0 as +0, but a client that multiplies 0 by a negative
/// number stores -0, and nothing that it computes from -0 differs.
///
/// ```
/// use splatref::frame::{Frame, Plane, Samples};
/// use splatref::verdict::client::{Client, Rounding, Storage};
///
/// let depth = Plane::filled(64, 48, f32::INFINITY); // what your GPU left, here nothing
/// let frame = Frame::<f32>::new(64, 48).with("visibility.Z", Samples::Scalar(depth))?;
/// let mut client = Client::from(&frame).stored("visibility.Z", Storage::Half);
/// client.rounding = Rounding::Ieee; // the default is `Gpu`
/// # assert_eq!(client.storage("visibility.Z"), Storage::Half);
/// # Ok::<(), splatref::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Client {
    /// Shared, because naming a mistake judges many clients that differ in their rules alone.
    pub(super) frame: Arc<Frame<f64>>,
    pub(super) storage: BTreeMap<String, Storage>,
    pub(super) radii: BTreeMap<String, Plane<[f64; 3]>>,
    /// The format of a plane of `f32`: [`Storage::Single`] or [`Storage::Rounded`].
    pub(super) single: Storage,
    /// The rounding that the client promises for its operations.
    pub rounding: Rounding,
    /// The fragment that the client keeps among equally near ones.
    pub ties: Ties,
    /// The end of the visible band that is assumed for the client.
    pub(crate) band: Band,
    /// The format of the depths that the client's depth test compares, if it is not that of the
    /// planes that store depth: a depth buffer of 24 bits, for example, beside depths in a colour
    /// target. Two fragments whose stored depths may be equal count as equally near.
    pub depth_test: Storage,
    /// The mistake that is assumed for the client.
    pub(crate) supposed: Supposed,
    /// The scene and the camera that are assumed for the client's projection, if they are others.
    pub(crate) drawn: Option<Arc<(Scene, Camera)>>,
    /// The only rectangles that are judged, each with the number of its tile in the grid; none: the
    /// whole picture.
    pub(crate) part: Option<Arc<[(usize, Rect)]>>,
    /// The surfels around these rectangles, if they were looked for. A mistake that is assumed moves no
    /// surfel, or moves it out of sight.
    pub(crate) around: Option<Arc<Around>>,
    /// The format of the attribute pass's sums between two additions.
    pub accumulator: Storage,
    /// The splats that the client has projected, in ascending surfel index. The later stages are
    /// judged from these records. Only for the method `ewa`.
    pub records: Option<Vec<SplatRecord>>,
    /// The same for the method `gaussians`, in ascending index.
    pub gaussian_records: Option<Vec<GaussianRecord>>,
    /// The channels of the file that are no planes of the method.
    pub unknown: Vec<String>,
}

/// A plane of a client.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StoredPlane<'a, T> {
    /// The name of the row.
    pub(crate) name: &'static str,
    /// The kind of values in the plane.
    pub(crate) holds: Holds,
    /// The number in place of `#` in the name.
    pub(crate) number: usize,
    pub(crate) plane: &'a Plane<T>,
    pub(crate) storage: Storage,
    /// How far each number may be off; replaces the radius that the storage gives.
    pub(crate) radii: Option<&'a Plane<[f64; 3]>>,
}

impl<T> StoredPlane<'_, T> {
    /// The name of the plane.
    pub(crate) fn channel(&self) -> String {
        numbered(self.name, self.number)
    }
}

impl StoredPlane<'_, f64> {
    /// The number at a pixel, with its radius.
    #[inline(always)]
    pub(crate) fn ball<P: Profile>(&self, (x, y): (u32, u32)) -> Ball<P> {
        let value = *self.plane.at(x, y);
        known(value, self.storage.radius(value))
    }

    /// The same, but a 0 where nothing is drawn has no radius, because every format holds it exactly.
    #[inline(always)]
    pub(crate) fn ball_where<P: Profile>(&self, at: (u32, u32), is_empty: bool) -> Ball<P> {
        if self.is_nothing(at, is_empty) { Ball::exact(0.0) } else { self.ball(at) }
    }

    /// Whether this is the 0 of a pixel where nothing is drawn.
    #[inline(always)]
    pub(super) fn is_nothing(&self, (x, y): (u32, u32), is_empty: bool) -> bool {
        is_empty && *self.plane.at(x, y) == 0.0
    }
}

impl StoredPlane<'_, [f64; 3]> {
    /// The numbers at a pixel, with their radii.
    #[inline(always)]
    pub(crate) fn balls<P: Profile>(&self, (x, y): (u32, u32)) -> [Ball<P>; 3] {
        let [a, b, c] = *self.plane.at(x, y);
        // Written out because the map of an array goes through memory.
        let [r, s, t] = match self.radii {
            Some(radii) => *radii.at(x, y),
            None => [self.storage.radius(a), self.storage.radius(b), self.storage.radius(c)],
        };
        [known(a, r), known(b, s), known(c, t)]
    }
}

/// A stored number with the radius of its storage. A NaN gives an unknown ball. A number below the
/// normal numbers may be read as 0.
#[inline(always)]
pub(crate) fn known<P: Profile>(value: f64, radius: f64) -> Ball<P> {
    let size = value.abs();
    let flushed = P::FLUSHES && size < f64::from(f32::MIN_POSITIVE) && radius < size;
    let radius = if flushed { size } else { radius };
    Ball::new(value, if value.is_nan() { f64::NAN } else { radius })
}

impl From<&Frame<f32>> for Client {
    /// Takes the planes of a frame that a client has computed.
    fn from(frame: &Frame<f32>) -> Self {
        let Frame { width, height, ref planes } = *frame;
        let planes = planes.iter().map(|NamedPlane { name, samples }| NamedPlane {
            name: name.clone(),
            samples: match samples {
                Samples::Scalar(p) => Samples::Scalar(p.map(|&v| v.into())),
                Samples::Color(p) => Samples::Color(p.map(|v| v.map_inline(f64::from))),
                Samples::Vector(p) => Samples::Vector(p.map(|v| v.map_inline(f64::from))),
                Samples::Index(p) => Samples::Index(p.clone()),
                Samples::Count(p) => Samples::Count(p.clone()),
            },
        });
        Self::new(Frame { width, height, planes: planes.collect() })
    }
}

impl Client {
    /// Whether the client hands in its projection.
    pub(crate) fn has_records(&self) -> bool {
        self.records.is_some() || self.gaussian_records.is_some()
    }

    /// Whether every plane and every sum is an `f32` as it was computed.
    pub(crate) fn stores_singles(&self) -> bool {
        let all = self.storage.values().chain([&self.single, &self.accumulator]);
        self.radii.is_empty() && all.into_iter().all(|storage| *storage == Storage::Single)
    }

    /// Takes the planes of a frame, all stored as `f32`.
    #[must_use]
    pub fn new(frame: Frame<f64>) -> Self {
        Self {
            frame: Arc::new(frame),
            storage: BTreeMap::new(),
            radii: BTreeMap::new(),
            single: Storage::Single,
            rounding: Rounding::default(),
            ties: Ties::default(),
            band: Band::default(),
            depth_test: Storage::Single,
            supposed: Supposed::default(),
            drawn: None,
            part: None,
            around: None,
            accumulator: Storage::Single,
            records: None,
            gaussian_records: None,
            unknown: Vec::new(),
        }
    }

    /// Sets the storage of a plane. For numbered planes, the name of their row sets it for all.
    #[must_use]
    pub fn stored(mut self, plane: &str, storage: Storage) -> Self {
        self.storage.insert(plane.to_owned(), storage);
        self
    }

    /// Says that the client computes with more digits than `f32`, for example in `f64`, and rounds
    /// its planes when it stores them: each plane of [`Storage::Single`] is [`Storage::Rounded`].
    ///
    /// ```
    /// use splatref::verdict::client::{Client, Storage};
    ///
    /// # let frame = splatref::frame::Frame::<f64>::new(64, 48);
    /// let client = Client::new(frame).rounded();
    /// assert_eq!(client.storage("weight"), Storage::Rounded);
    /// ```
    #[must_use]
    pub fn rounded(self) -> Self {
        Self { single: Storage::Rounded, ..self }
    }

    /// Sets how far each number of a plane of colours or vectors may be off, where the value alone
    /// does not tell. The radii replace the plane's [`Storage`].
    ///
    /// # Errors
    /// [`Error::Invalid`] if there is no such plane of this size.
    pub fn within(mut self, plane: &str, radii: Plane<[f64; 3]>) -> Result<Self> {
        let size = match self.frame.plane(plane) {
            Some(Samples::Color(p) | Samples::Vector(p)) => (p.width(), p.height()),
            _ => return Err(Error::Invalid(format!("no colours or vectors are called `{plane}`"))),
        };
        if size != (radii.width(), radii.height()) {
            let what = format!("the radii of the plane `{plane}` have another size than the plane");
            return Err(Error::Invalid(what));
        }
        self.radii.insert(plane.to_owned(), radii);
        Ok(self)
    }

    /// How far each number of a plane may be off, if [`Client::within`] has set it.
    #[must_use]
    pub fn radii(&self, plane: &str) -> Option<&Plane<[f64; 3]>> {
        self.radii.get(plane)
    }

    /// The storage of a plane.
    #[must_use]
    pub fn storage(&self, plane: &str) -> Storage {
        self.known_storage(self.storage.get(plane))
    }

    /// The storage of a plane with this entry in the table of storages.
    fn known_storage(&self, entry: Option<&Storage>) -> Storage {
        match entry.copied().unwrap_or_default() {
            Storage::Single => self.single,
            other => other,
        }
    }

    /// The planes.
    #[must_use]
    pub fn frame(&self) -> &Frame<f64> {
        &self.frame
    }

    /// The job of the projection: with the scene and the camera that are assumed for it.
    pub(crate) fn projection<'j>(&'j self, job: &Job<'j>) -> Job<'j> {
        let (scene, camera) = match self.drawn.as_deref() {
            Some((scene, camera)) => (scene, camera),
            None => (job.scene, job.camera),
        };
        // Another camera has a picture of the same size.
        let (part, window) = (job.part, job.window);
        Job { part, window, ..Job::new(scene, job.index, camera, job.exec) }
    }

    /// The planes, for changing them.
    pub(crate) fn frame_mut(&mut self) -> &mut Frame<f64> {
        Arc::make_mut(&mut self.frame)
    }

    /// The same client with other planes. `of` makes each plane from the one with its name.
    pub(crate) fn mapped(&self, of: impl Fn(&str, &Samples<f64>) -> Samples<f64>) -> Self {
        let Frame { width, height, ref planes } = *self.frame;
        let planes = planes.iter().map(|NamedPlane { name, samples }| NamedPlane {
            name: name.clone(),
            samples: of(name, samples),
        });
        let frame = Arc::new(Frame { width, height, planes: planes.collect() });
        Self { frame, ..self.clone() }
    }

    /// A plane of one number a pixel, if the client hands it in.
    pub(crate) fn scalar(&self, row: &PlaneRow) -> Option<StoredPlane<'_, f64>> {
        self.scalar_of(row, 0)
    }

    /// The same for a numbered row.
    pub(crate) fn scalar_of(&self, row: &PlaneRow, number: usize) -> Option<StoredPlane<'_, f64>> {
        match self.samples(row, number)? {
            Samples::Scalar(plane) => Some(self.of(row, number, plane)),
            _ => None,
        }
    }

    /// A plane of colours or vectors, if the client hands it in.
    pub(crate) fn triple(&self, row: &PlaneRow) -> Option<StoredPlane<'_, [f64; 3]>> {
        self.triple_of(row, 0)
    }

    /// The same for a numbered row.
    pub(crate) fn triple_of(
        &self,
        row: &PlaneRow,
        number: usize,
    ) -> Option<StoredPlane<'_, [f64; 3]>> {
        match self.samples(row, number)? {
            Samples::Color(plane) | Samples::Vector(plane) => Some(self.of(row, number, plane)),
            _ => None,
        }
    }

    /// A plane of indices, if the client hands it in.
    pub(crate) fn index(&self, row: &PlaneRow) -> Option<StoredPlane<'_, u32>> {
        self.index_of(row, 0)
    }

    /// The same for a numbered row.
    pub(crate) fn index_of(&self, row: &PlaneRow, number: usize) -> Option<StoredPlane<'_, u32>> {
        match self.samples(row, number)? {
            Samples::Index(plane) => Some(self.of(row, number, plane)),
            _ => None,
        }
    }

    /// A plane of small counts, if the client hands it in.
    pub(crate) fn count(&self, row: &PlaneRow) -> Option<StoredPlane<'_, u8>> {
        self.count_of(row, 0)
    }

    /// The same for a numbered row.
    pub(crate) fn count_of(&self, row: &PlaneRow, number: usize) -> Option<StoredPlane<'_, u8>> {
        match self.samples(row, number)? {
            Samples::Count(plane) => Some(self.of(row, number, plane)),
            _ => None,
        }
    }

    fn samples(&self, row: &PlaneRow, number: usize) -> Option<&Samples<f64>> {
        self.frame.plane(&row.numbered(number))
    }

    fn of<'a, T>(
        &'a self,
        row: &PlaneRow,
        number: usize,
        plane: &'a Plane<T>,
    ) -> StoredPlane<'a, T> {
        let channel = row.numbered(number);
        let own = self.storage.get(&channel).or_else(|| self.storage.get(row.name));
        let storage = self.known_storage(own);
        let PlaneRow { name, holds, .. } = *row;
        StoredPlane { name, holds, number, plane, storage, radii: self.radii(&channel) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::ball::{Gpu, Ieee};

    #[test]
    fn a_stored_number_below_the_normal_ones_may_be_0() {
        let tiny = f64::from(f32::from_bits(1));
        let quotient = |divisor| Ball::<Gpu>::exact(1e-30) / known(divisor, 0.0);
        assert!(!quotient(tiny).radius.is_finite());
        assert!(quotient(f64::from(f32::MIN_POSITIVE)).radius.is_finite());
        // An implementation that flushes nothing divides by the tiny number.
        let quotient = Ball::<Ieee>::exact(tiny) / known(tiny, 0.0);
        assert_eq!((quotient.middle, quotient.radius), (1.0, 0.0));
    }
}
