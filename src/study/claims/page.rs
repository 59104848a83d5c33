//! The page of the claims and its pictures.

use super::{FORMATS, Measured, ROWS, SHAPES, Verdict};
use crate::frame::Plane;
use crate::study::atlas::{beside, short};
use std::fmt::Write;

/// The folder of pictures beside the page.
pub const PICTURES: &str = "claims";

const INTRODUCTION: &str = "\
# What the five papers claim, measured

This page measures what five papers claim. Every claim compares two numbers. It holds if the first is at most the second,
or at most the multiple of the second that the row names. The second number may be a limit.

- Each claim is measured in nine cases: a sphere, a torus and a cluster of spheres, in pictures of 120, 180 and 300 rows. The
  shapes have 10,000 surfels unless the claim is about more. Scans have a table below.
- *Holds* says in how many of the nine cases the claim holds: *yes* is all, *no* is none. The column of a shape has the two
  numbers at 180 rows.
- A claim without a number in its paper is read as weakly as its words allow: *better* means less error. For *similar*,
  *slightly* and *hardly* this page sets a limit, which the row shows.
- A pixel is *inside* if it and its neighbours are covered. It is *visibly off* if R, G or B differs by more than 8/255 in sRGB.

The numbers and *holds* are for buffers in `f32`. The columns after *holds* judge the claim again with buffer formats of the
papers' GPUs: half floats with 24-bit depths, half floats with half-float depths as in [MOC08, 4], and 8 bits with 16-bit
depths. Only the methods draw into these formats; the pictures to compare with stay the same. A dash marks a claim that is not
about single pictures. Algorithms 2 and 3 of [ZP06] use the bins of its equation 6 in all groups, `--bin-edges common`.

The command `splatref study claims bunny.ply igea.ply fandisk.ply -o docs` writes this page. Errors are the same on every
machine, and a test compares the page with them. Rows with *ms* are times on the CPU of the machine that wrote the page, with
two threads; the papers used GPUs. The pages in the last column have more settings, and the times in the papers.

";

/// The files of the page.
#[derive(Clone, Debug)]
pub struct Files {
    /// The page in Markdown.
    pub text: String,
    /// Pictures side by side in linear RGB, by the names of claims: a picture for each number and,
    /// if there is one, the true picture.
    pub pictures: Vec<(&'static str, Plane<[f32; 3]>)>,
}

/// Writes the page of some claims, measured on the shapes and on these scans.
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

These are the same claims, measured on scans: each triangle becomes a surfel, and the triangles are the truth. The claims are
in the order of the table above, and the numbers are at 180 rows.

";

/// Appends the table of the scans.
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

/// The pairs of numbers at the middle size, as cells.
fn pairs(found: &[Measured]) -> String {
    let of = found.chunks(ROWS.len()).map(|sizes| {
        let [first, second] = sizes[MIDDLE].numbers;
        format!("{}; {}", short(first), short(second))
    });
    of.collect::<Vec<_>>().join(" | ")
}

/// The index of the size whose numbers are shown.
const MIDDLE: usize = 1;

/// In how many cases of shapes the claim holds, in words.
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

/// The page without the rows of times.
#[cfg(test)]
pub(super) fn lasting(page: &str) -> String {
    page.lines().filter(|line| !line.contains("| ms")).collect::<Vec<_>>().join("\n")
}
