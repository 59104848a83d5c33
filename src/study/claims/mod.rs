//! What the five papers claim, measured.
//!
//! A [`Claim`] says that one number is at most a part of another, or at most a limit. Each is measured on nine
//! cases: three [shapes](SHAPES) in pictures of three [sizes](ROWS). A claim *holds* if it does in all nine, *fails* if
//! in none, and else holds in so many of them. Scans are cases too, where somebody has some.
//!
//! `Decided:` a claim that has no number in its paper is read as weakly as its words allow: "better" is less
//! error. Where words say "nearly as" or "similar", the limit is of this page, and stands in the claim.
//!
//! Claims about pictures of shapes are judged in storage [formats](FORMATS) of the papers' time too: the methods draw in them, and
//! are compared with the same true picture, or with the same reference in `f32`.
//!
//! The page is `docs/claims.md`, made by `splatref study claims -o docs`. Errors are the same on every
//! machine, and a test holds the page against them; numbers that are times are not held.

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

/// What is drawn, in a picture of so many rows, 4/3 as many columns.
#[derive(Clone, Debug)]
pub struct Case {
    /// What is drawn.
    pub of: Drawn,
    /// The rows of the picture.
    pub rows: u32,
}

/// What is drawn.
#[derive(Clone, Debug)]
pub enum Drawn {
    /// A shape in so many surfels.
    Shape(Shape, usize),
    /// The surfels of a scene, as it draws them: a scan.
    Scan(Box<SceneFile>),
}

/// The shapes of the first cases, each of [`COUNT`] surfels.
pub const SHAPES: [Shape; 3] = [Shape::Sphere, Shape::Torus, Shape::Cluster];
/// The surfels of a shape.
pub const COUNT: usize = 10_000;
/// The rows of the pictures, of each shape and each scan.
pub const ROWS: [u32; 3] = [120, 180, 300];

/// The cases of every claim: the shapes, then some scans, each in pictures of all sizes.
fn cases(scans: &[SceneFile]) -> Vec<Case> {
    let shapes = SHAPES.into_iter().map(|shape| Drawn::Shape(shape, COUNT));
    let scans = scans.iter().map(|scan| Drawn::Scan(Box::new(scan.clone())));
    let all = shapes.chain(scans);
    all.flat_map(|of| ROWS.map(|rows| Case { of: of.clone(), rows })).collect()
}

/// Formats that the papers' GPUs had, and what they are called.
pub const FORMATS: [(&str, Formats); 3] = [
    ("f16, 24 bits", Formats { buffers: Buffers::F16, depth: DepthBuffer::Unorm24 }),
    ("f16, f16", Formats { buffers: Buffers::F16, depth: DepthBuffer::F16 }),
    ("unorm8, 16 bits", Formats { buffers: Buffers::Unorm8, depth: DepthBuffer::Unorm16 }),
];

/// What a paper says.
#[derive(Clone, Copy, Debug)]
pub struct Claim {
    /// How it is called: its picture's name.
    pub id: &'static str,
    /// The paper, and where in it.
    pub from: &'static str,
    /// Its words, or what they come to.
    pub says: &'static str,
    /// The two numbers, with their unit.
    pub measured: &'static str,
    /// It holds where the first number is at most this part of the second.
    pub at_most: f64,
    /// Whether the numbers are times, which differ from machine to machine.
    pub timed: bool,
    /// The page that has more of it, under `docs/`.
    pub more: &'static str,
    /// Measures a case.
    of: fn(&Subject<'_>) -> Result<Measured>,
}

/// What is found of a case.
#[derive(Clone, Debug)]
pub struct Measured {
    /// The two numbers.
    pub numbers: [f64; 2],
    /// Their pictures, linear RGB; none where they are of no pictures.
    pub pictures: Vec<Plane<[f32; 3]>>,
}

/// A claim, measured.
#[derive(Clone, Debug)]
pub struct Verdict {
    /// Of which claim.
    pub of: &'static Claim,
    /// What was found of each shape in each size, then of each scan in each size.
    pub found: Vec<Measured>,
    /// In how many cases of shapes it holds in each of [`FORMATS`]; none of a claim that is not about pictures.
    pub stored: Vec<usize>,
}

/// Every claim.
#[must_use]
pub fn claims() -> Vec<&'static Claim> {
    let rooms: [&[Claim]; 4] =
        [&frames::CLAIMS, &blending::CLAIMS, &image_space::CLAIMS, &orders::CLAIMS];
    rooms.into_iter().flatten().collect()
}

/// Measures claims in every case, in `f32` and, those about pictures of shapes, in each of some formats. `progress` is
/// told of which claim, and how many measurements are done.
///
/// # Errors
/// [`crate::Error::Invalid`] if a scan is not of surfels alone; else as drawing the scenes.
pub fn verdicts(
    claims: &[&'static Claim],
    (scans, formats): (&[SceneFile], &[(&str, Formats)]),
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<Vec<Verdict>> {
    let none = |of: &&'static Claim| Verdict { of, found: Vec::new(), stored: Vec::new() };
    let mut all: Vec<Verdict> = claims.iter().map(none).collect();
    let cases = cases(scans);
    // What is no scan is known before minutes have passed.
    for case in cases.iter().skip(SHAPES.len() * ROWS.len()).step_by(ROWS.len()) {
        Subject::new(case.clone(), exec)?;
    }
    let count = (cases.len() * claims.len()) as u64;
    let mut done = 0;
    let mut last: Option<Subject<'_>> = None;
    for (i, case) in cases.into_iter().enumerate() {
        let formats = if matches!(case.of, Drawn::Shape(..)) { formats } else { &[] };
        // What the claims share of a case is made once, and what its sizes share too.
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

    /// In how many of some cases it holds.
    fn holds(&self, found: &[Measured]) -> usize {
        found.iter().filter(|found| self.of.holds(found)).count()
    }

    /// What was found of shapes, and of scans.
    fn parts(&self) -> (&[Measured], &[Measured]) {
        self.found.split_at(SHAPES.len() * ROWS.len())
    }
}

impl Claim {
    /// Whether it holds.
    fn holds(&self, found: &Measured) -> bool {
        let [first, second] = found.numbers;
        first <= self.at_most * second
    }
}
