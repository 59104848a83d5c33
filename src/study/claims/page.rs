//! The page of the claims and its pictures.

use super::{FORMATS, Measured, ROWS, SHAPES, Verdict};
use crate::frame::Plane;
use crate::study::atlas::{beside, short};
use std::fmt::Write;

/// The folder of pictures beside the page.
pub const PICTURES: &str = "claims";

const INTRODUCTION: &str = "\
# What the five papers claim, measured

Every claim is a comparison of two numbers: the first is to be at most the second, or at most so many times the second where the
row says so; the second may be a limit. Each is measured on nine cases: a sphere, a torus and a cluster of spheres, of 10,000 surfels unless the
claim is about more, in pictures of 120, 180 and 300 rows. *Holds* tells in how many of the nine; scans have a table below. The numbers are the
pair of each shape at 180 rows. A claim that has no number in its paper is read as weakly as its words allow: better is
less error. Where the words are *similar*, *slightly* or *hardly*, the limit is of this page, and stands in the row. A pixel is
*inside* if it and its neighbours are covered, and *visibly off* if R, G or B differs by more than 8/255 as sRGB.

The numbers and *holds* are of buffers in `f32`. The columns after it judge the claim once more with buffers that the papers'
GPUs had: half floats with depths of 24 bits, half floats with depths in half floats as [MOC08, 4] has them, and 8 bits with
depths of 16. Only the methods draw into them; what they are compared with
stays the same. A claim that is not about single pictures has a dash. Algorithms 2 and 3 of [ZP06] have the bins of its
equation 6 in all groups, `--bin-edges common`.

This page is made by `splatref study claims bunny.ply igea.ply fandisk.ply -o docs`. Errors are the same on every machine, and a test holds the page
against them. Rows with *ms* are times of the machine that made the page, on a CPU with two threads; the papers' were
of GPUs. The pages in the last column have more settings, and the times that the papers print.

";

/// What the page is made of.
#[derive(Clone, Debug)]
pub struct Files {
    /// The page, Markdown.
    pub text: String,
    /// Pictures side by side, linear RGB, by the names of claims: those of the two numbers and, where there is one,
    /// the true one.
    pub pictures: Vec<(&'static str, Plane<[f32; 3]>)>,
}

/// The page of some claims, measured of the shapes and of these scans.
#[must_use]
pub fn page(verdicts: &[Verdict], scans: &[&str]) -> Files {
    let mut text = INTRODUCTION.to_owned();
    let formats = FORMATS.map(|(name, _)| format!("in {name} |")).join(" ");
    let _ = writeln!(
        text,
        "| claim | from | measured | {} | holds | {formats} more |",
        SHAPES.map(|shape| shape.name()).join(" | ")
    );
    let _ = writeln!(text, "|{}", "---|".repeat(8 + FORMATS.len()));
    let mut pictures = Vec::new();
    for verdict in verdicts {
        let super::Claim { id, from, says, measured, more, .. } = verdict.of;
        let (shapes, _) = verdict.parts();
        let seen = beside(&shapes[MIDDLE].pictures);
        let name = match seen {
            Some(_) => format!("[{says}]({PICTURES}/{id}.png)"),
            None => (*says).to_owned(),
        };
        let stored = (0..FORMATS.len()).map(|i| {
            verdict.stored.get(i).map_or_else(|| "-".into(), |&holds| in_words(holds, shapes.len()))
        });
        let stored: Vec<String> = stored.collect();
        let pairs = pairs(shapes);
        let _ = writeln!(
            text,
            "| {name} | {from} | {measured} | {pairs} | {} | {} | [{more}]({more}) |",
            outcome(verdict),
            stored.join(" | "),
        );
        pictures.extend(seen.map(|seen| (*id, seen)));
    }
    if !scans.is_empty() {
        of_scans(verdicts, scans, &mut text);
    }
    Files { text, pictures }
}

const SCANS: &str = "
## Scans

The same claims of scans, as they are: a surfel a triangle, the triangles are the truth. The numbers are in the order of
the table above, those of 180 rows.

";

/// The table of the scans.
fn of_scans(verdicts: &[Verdict], scans: &[&str], text: &mut String) {
    text.push_str(SCANS);
    let _ = writeln!(text, "| claim | measured | {} | holds |", scans.join(" | "));
    let _ = writeln!(text, "|{}", "---|".repeat(3 + scans.len()));
    for verdict in verdicts {
        let (_, found) = verdict.parts();
        let super::Claim { id, measured, .. } = verdict.of;
        let holds = in_words(verdict.holds(found), found.len());
        let _ = writeln!(text, "| {id} | {measured} | {} | {holds} |", pairs(found));
    }
}

/// The pairs of numbers of the middle size, as cells.
fn pairs(found: &[Measured]) -> String {
    let of = found.chunks(ROWS.len()).map(|sizes| {
        let [first, second] = sizes[MIDDLE].numbers;
        format!("{}; {}", short(first), short(second))
    });
    of.collect::<Vec<_>>().join(" | ")
}

/// The size whose numbers are shown.
const MIDDLE: usize = 1;

/// In how many of the cases of shapes it holds, in words.
#[must_use]
pub fn outcome(verdict: &Verdict) -> String {
    let (shapes, _) = verdict.parts();
    in_words(verdict.holds(shapes), shapes.len())
}

fn in_words(holds: usize, of: usize) -> String {
    match holds {
        0 => "no".into(),
        all if all == of => "yes".into(),
        some => format!("{some} of {of}"),
    }
}

/// A page without rows of times.
#[cfg(test)]
pub(super) fn lasting(page: &str) -> String {
    page.lines().filter(|line| !line.contains("| ms")).collect::<Vec<_>>().join("\n")
}
