//! Explain a pixel: the fragments that reach it, and each decision on them with its operands.

use super::algorithm::Job;
use super::fragment::TileSplats;
use super::prepare::Prepared;
use crate::composite::decide;
use crate::error::Result;
use crate::frame::Rect;
use crate::number::{Exact, MapInline};
use crate::splat::{Shared, Splat};
use std::fmt;

/// A comparison that decided the fate of a fragment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decision<R> {
    /// The quantity that is compared: `q`, `nearness`, `depth`, `z`, `bin`.
    pub quantity: &'static str,
    /// The fragment's value.
    pub own: R,
    /// The value that it is compared with.
    pub against: R,
    /// Whether the comparison holds.
    pub holds: bool,
    /// The sign of the comparison as it came out: `<=`, `>`.
    sign: &'static str,
    /// The word for the result: `inside`.
    word: &'static str,
}

impl<R: Exact> Decision<R> {
    /// A decision. The first of `signs` and of `words` stands for a comparison that holds, the
    /// second for one that does not.
    pub(crate) fn new(
        quantity: &'static str,
        [own, against]: [R; 2],
        holds: bool,
        signs: [&'static str; 2],
        words: [&'static str; 2],
    ) -> Self {
        let [sign, word] = [signs, words].map_inline(|of| if holds { of[0] } else { of[1] });
        Self { quantity, own, against, holds, sign, word }
    }

    /// Whether a fragment is inside the cut-off.
    pub(crate) fn inside(shared: &Shared<R>, q: R) -> Self {
        let words = ["inside ", "outside"];
        Self::new("q", [q, shared.limit], decide::inside(q, shared.limit), ["<=", "> "], words)
    }

    /// Whether a fragment is nearer than the fragment that the pixel holds.
    pub(crate) fn nearer(w: R, held: R, words: [&'static str; 2]) -> Self {
        Self::new("nearness", [w, held], decide::nearer(w, held), ["> ", "<="], words)
    }

    /// Whether a fragment belongs to the visible surface.
    pub(crate) fn visible(t: R, nearest: R, epsilon: R) -> Self {
        let limit = decide::limit(nearest, epsilon);
        let holds = decide::visible(t, limit);
        Self::new("depth", [t, limit], holds, ["<=", "> "], ["visible", "hidden "])
    }

    /// Whether a fragment lies strictly beyond a depth.
    pub(crate) fn beyond(t: R, limit: R, words: [&'static str; 2]) -> Self {
        Self::new("depth", [t, limit], decide::beyond(t, limit), ["> ", "<="], words)
    }

    /// How far apart the operands are, in units of the last place.
    #[must_use]
    pub fn ulps(&self) -> f32 {
        self.own.ulps_to(self.against)
    }
}

impl<R: Exact> fmt::Display for Decision<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { quantity, sign, word, .. } = self;
        let (own, against) = (self.own.to_f64(), self.against.to_f64());
        match *quantity {
            "q" => write!(f, "{word}  q {own:<12.9} {sign} {against}")?,
            "depth" | "bin" => write!(f, "{word}  {quantity} {own} {sign} {against}")?,
            _ => write!(f, "{word}  {quantity} {own:.9} {sign} {against:.9}")?,
        }
        write!(f, "  ({} ulp)", self.ulps())
    }
}

/// A splat at the pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Touch<R> {
    /// The surfel.
    pub surfel: u32,
    /// q of the fragment.
    pub q: R,
    /// Depth of the fragment.
    pub t: R,
    /// Nearness of the fragment.
    pub w: R,
    /// The decisions, in the order in which they are made. The first decision that does not hold
    /// ends them.
    pub decisions: Vec<Decision<R>>,
    /// The result, by name: its depth, its weight.
    pub gives: Option<(&'static str, R)>,
}

impl<R: Exact> Touch<R> {
    /// Whether every decision holds.
    #[must_use]
    pub fn passes(&self) -> bool {
        self.decisions.iter().all(|decision| decision.holds)
    }

    /// Makes one more decision, if every one before it holds.
    pub(crate) fn decide(&mut self, decision: impl FnOnce() -> Decision<R>) {
        if self.passes() {
            self.decisions.push(decision());
        }
    }
}

impl<R: Exact> fmt::Display for Touch<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "surfel {:>8}", self.surfel)?;
        self.fmt_decisions(f)
    }
}

impl<R: Exact> Touch<R> {
    /// Writes what was decided, and the result.
    pub(crate) fn fmt_decisions(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, decision) in self.decisions.iter().enumerate() {
            write!(f, "{}{decision}", if i == 0 { "  " } else { "   " })?;
        }
        match self.gives {
            Some((name, value)) => write!(f, "  {name} {}", value.to_f64()),
            None => Ok(()),
        }
    }
}

/// A pixel of the picture, by its column and row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Place {
    /// The tile that holds the pixel.
    pub(crate) tile: usize,
    /// The rectangle of this one pixel.
    pub(crate) rect: Rect,
}

impl Place {
    /// The place of a pixel.
    ///
    /// # Errors
    /// [`crate::Error::Usage`] if the pixel is outside the picture.
    pub(crate) fn new(job: &Job<'_>, (x, y): (u32, u32)) -> Result<Self> {
        job.camera.check_pixel(x, y)?;
        let (tile, _) = job.grid().place(x, y);
        Ok(Self { tile, rect: Rect::pixel((x, y)) })
    }

    /// The splats that may touch the pixel.
    pub(crate) fn splats<'a, R: Exact>(
        &self,
        prepared: &'a Prepared<R, Splat<R>>,
    ) -> TileSplats<'a, R> {
        TileSplats::new(prepared, self.tile, self.rect)
    }
}

/// A splat at the pixel, and whether its fragment is inside.
pub(crate) fn touch<R: Exact>(shared: &Shared<R>, surfel: u32, q: R, w: R) -> Touch<R> {
    let decisions = vec![Decision::inside(shared, q)];
    Touch { surfel, q, t: shared.depth(w), w, decisions, gives: None }
}
