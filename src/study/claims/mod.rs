//! What the five papers claim, measured.
//!
//! A [`Claim`] says that one number is at most a part of another, or at most a limit. Each is measured on nine
//! [cases](CASES): three shapes in pictures of three sizes. A claim *holds* if it does in all nine, *fails* if in
//! none, and else holds in so many of them.
//!
//! `Decided:` a claim that has no number in its paper is read as weakly as its words allow: "better" is less
//! error. Where words say "nearly as" or "similar", the limit is of this page, and stands in the claim.
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
use crate::source::Shape;

/// A shape in so many surfels and a picture of so many rows, 4/3 as many columns.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Which shape.
    pub shape: Shape,
    /// Its surfels.
    pub count: usize,
    /// The rows of the picture.
    pub rows: u32,
}

/// The cases of every claim.
pub const CASES: [Case; 9] = {
    const fn case(shape: Shape, rows: u32) -> Case {
        Case { shape, count: 10_000, rows }
    }
    const SHAPES: [Shape; 3] = [Shape::Sphere, Shape::Torus, Shape::Cluster];
    const ROWS: [u32; 3] = [120, 180, 300];
    [
        case(SHAPES[0], ROWS[0]),
        case(SHAPES[0], ROWS[1]),
        case(SHAPES[0], ROWS[2]),
        case(SHAPES[1], ROWS[0]),
        case(SHAPES[1], ROWS[1]),
        case(SHAPES[1], ROWS[2]),
        case(SHAPES[2], ROWS[0]),
        case(SHAPES[2], ROWS[1]),
        case(SHAPES[2], ROWS[2]),
    ]
};

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
    pub of: fn(Case, &Exec) -> Result<Measured>,
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
    /// What was found, in the order of [`CASES`].
    pub found: Vec<Measured>,
}

/// Every claim.
#[must_use]
pub fn claims() -> Vec<&'static Claim> {
    let rooms: [&[Claim]; 4] =
        [&frames::CLAIMS, &blending::CLAIMS, &image_space::CLAIMS, &orders::CLAIMS];
    rooms.into_iter().flatten().collect()
}

impl Claim {
    /// Measures every case. `progress` is told how many of how many are done.
    ///
    /// # Errors
    /// As drawing the scenes.
    pub fn verdict(&'static self, exec: &Exec, progress: &dyn Fn(u64, u64)) -> Result<Verdict> {
        let count = CASES.len() as u64;
        let found = (0..).zip(CASES).map(|(done, case)| {
            progress(done, count);
            (self.of)(case, exec)
        });
        Ok(Verdict { of: self, found: found.collect::<Result<_>>()? })
    }
}

impl Verdict {
    /// In how many cases it holds.
    #[must_use]
    pub fn holds(&self) -> usize {
        let holds = |found: &&Measured| {
            let [first, second] = found.numbers;
            first <= self.of.at_most * second
        };
        self.found.iter().filter(holds).count()
    }
}
