//! The claims of the five papers, measured.
//!
//! A [`Claim`] says that one number is at most a multiple of another, or at most a limit. Each
//! claim is measured in nine cases: three [shapes](SHAPES) in pictures of three [sizes](ROWS). A
//! claim *holds* if it does in all nine cases, and *fails* if it does in none; otherwise the page
//! says in how many it holds. Scans are more cases, if you have some.
//!
//! `Decided:` a claim without a number in its paper is read as weakly as its words allow: "better"
//! means less error. For "nearly as" or "similar" the page sets a limit, and the claim shows it.
//!
//! Claims about pictures of shapes are also judged in the storage [formats](FORMATS) of the papers'
//! time. The methods draw in these formats; the true picture, or the reference in `f32`, stays the
//! same.
//!
//! `splatref study claims -o docs` writes the page, `docs/claims.md`. Errors are the same on every
//! machine, and a test compares the page with them; times are not compared.

mod blending;
mod frames;
mod image_space;
mod orders;
mod page;
mod subject;
#[cfg(test)]
mod tests;

pub use page::{Files, PICTURES, outcome, page};

use crate::error::Result;
use crate::frame::{Exec, Plane};
use crate::io::scene_file::SceneFile;
use crate::method::buffer_formats::{Buffers, DepthBuffer, Formats};
use crate::progress::Progress;
use crate::source::Shape;
use subject::Subject;

/// The subject of a picture with this many rows and 4/3 as many columns.
#[derive(Clone, Debug)]
pub struct Case {
    /// The scene to draw.
    pub of: Drawn,
    /// The rows of the picture.
    pub rows: u32,
}

/// The scene to draw.
#[derive(Clone, Debug)]
pub enum Drawn {
    /// A shape with this many surfels.
    Shape(Shape, usize),
    /// A scan: the surfels of a scene, as it draws them.
    Scan(Box<SceneFile>),
}

/// The shapes of the first cases, with [`COUNT`] surfels each.
pub const SHAPES: [Shape; 3] = [Shape::Sphere, Shape::Torus, Shape::Cluster];
/// The number of surfels of a shape.
pub const COUNT: usize = 10_000;
/// The rows of the pictures, for each shape and each scan.
pub const ROWS: [u32; 3] = [120, 180, 300];

/// The cases of every claim: the shapes, then some scans, each in pictures of all sizes.
fn cases(scans: &[SceneFile]) -> Vec<Case> {
    let shapes = SHAPES.into_iter().map(|shape| Drawn::Shape(shape, COUNT));
    let scans = scans.iter().map(|scan| Drawn::Scan(Box::new(scan.clone())));
    let all = shapes.chain(scans);
    all.flat_map(|of| ROWS.map(|rows| Case { of: of.clone(), rows })).collect()
}

/// Formats of the papers' GPUs, with their names.
pub const FORMATS: [(&str, Formats); 3] = [
    ("f16, 24 bits", Formats { buffers: Buffers::F16, depth: DepthBuffer::Unorm24 }),
    ("f16, f16", Formats { buffers: Buffers::F16, depth: DepthBuffer::F16 }),
    ("unorm8, 16 bits", Formats { buffers: Buffers::Unorm8, depth: DepthBuffer::Unorm16 }),
];

/// A claim of a paper.
#[derive(Clone, Copy, Debug)]
pub struct Claim {
    /// Its short name, which its picture has too.
    pub id: &'static str,
    /// The paper, and the place in it.
    pub from: &'static str,
    /// The claim, in the paper's words or shortened.
    pub says: &'static str,
    /// The two numbers, with their unit.
    pub measured: &'static str,
    /// The claim holds if the first number is at most this multiple of the second.
    pub at_most: f64,
    /// Whether the numbers are times, which differ from machine to machine.
    pub timed: bool,
    /// The page under `docs/` with more about it.
    pub more: &'static str,
    /// Measures a case.
    of: fn(&Subject<'_>) -> Result<Measured>,
}

/// The measurements of a case.
#[derive(Clone, Debug)]
pub struct Measured {
    /// The two numbers.
    pub numbers: [f64; 2],
    /// Their pictures in linear RGB; empty if the numbers do not come from pictures.
    pub pictures: Vec<Plane<[f32; 3]>>,
}

/// A measured claim.
#[derive(Clone, Debug)]
pub struct Verdict {
    /// The claim.
    pub of: &'static Claim,
    /// The measurements of each shape in each size, then of each scan in each size.
    pub found: Vec<Measured>,
    /// In how many cases of shapes the claim holds in each of [`FORMATS`]; empty if the claim is
    /// not about pictures.
    pub stored: Vec<usize>,
}

/// Every claim.
#[must_use]
pub fn claims() -> Vec<&'static Claim> {
    let rooms: [&[Claim]; 4] =
        [&frames::CLAIMS, &blending::CLAIMS, &image_space::CLAIMS, &orders::CLAIMS];
    rooms.into_iter().flatten().collect()
}

/// Measures claims in every case in `f32`, and claims about pictures of shapes in each of `formats`
/// too. `progress` gets the claim, and how many measurements are done.
///
/// # Errors
/// [`crate::Error::Invalid`] if a scan does not consist of surfels; otherwise as drawing the
/// scenes.
pub fn verdicts(
    claims: &[&'static Claim],
    scans: &[SceneFile],
    formats: &[(&str, Formats)],
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<Vec<Verdict>> {
    let none = |of: &&'static Claim| Verdict { of, found: Vec::new(), stored: Vec::new() };
    let mut all: Vec<Verdict> = claims.iter().map(none).collect();
    let cases = cases(scans);
    // A wrong scan is refused now, before minutes have passed.
    for case in cases.iter().skip(SHAPES.len() * ROWS.len()).step_by(ROWS.len()) {
        Subject::new(case.clone(), exec)?;
    }
    let count = (cases.len() * claims.len()) as u64;
    let mut done = 0;
    let mut last: Option<Subject<'_>> = None;
    for (i, case) in cases.into_iter().enumerate() {
        let formats = if matches!(case.of, Drawn::Shape(..)) { formats } else { &[] };
        // Claims share what they need of a case, and the sizes of a case share it too.
        let mut subject = Subject::new(case, exec)?;
        if let Some(other_size) = last.filter(|_| i % ROWS.len() > 0) {
            subject.share(&other_size);
        }
        for verdict in &mut all {
            progress(verdict.of.id, done, count);
            verdict.measure(&mut subject, formats)?;
            done += 1;
        }
        last = Some(subject);
    }
    Ok(all)
}

impl Verdict {
    /// Measures one more case.
    fn measure(&mut self, subject: &mut Subject<'_>, formats: &[(&str, Formats)]) -> Result<()> {
        subject.formats = Formats::WHOLE;
        let found = (self.of.of)(subject)?;
        if !found.pictures.is_empty() && !formats.is_empty() {
            self.stored.resize(formats.len(), 0);
            for (holds, (_, formats)) in self.stored.iter_mut().zip(formats) {
                subject.formats = *formats;
                *holds += usize::from(self.of.holds(&(self.of.of)(subject)?));
            }
        }
        self.found.push(found);
        Ok(())
    }

    /// In how many of some cases the claim holds.
    fn holds(&self, found: &[Measured]) -> usize {
        found.iter().filter(|found| self.of.holds(found)).count()
    }

    /// The measurements of shapes, and of scans.
    fn parts(&self) -> (&[Measured], &[Measured]) {
        self.found.split_at(SHAPES.len() * ROWS.len())
    }
}

impl Claim {
    /// Whether the claim holds in this case.
    fn holds(&self, found: &Measured) -> bool {
        let [first, second] = found.numbers;
        first <= self.at_most * second
    }
}
