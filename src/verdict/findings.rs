//! The findings about a client's planes: stage by stage, pixel by pixel, and in one word.

use super::doubt::Doubt;
use super::fault::Fault;
use super::shift::Shifts;
use super::unlike::Unlike;
use crate::frame::Plane;
use crate::setting::Words;
use std::collections::BTreeMap;

/// A wrong pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Column and row.
    pub pixel: (u32, u32),
    /// The fault.
    pub fault: Fault,
    /// The error in bounds: above 1, or +inf if there is no bound.
    pub error: f64,
}

/// The kind of a fault, as [`Causes`] counts it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) enum Cause {
    /// A surfel is missing. `rim` says where in its splat, as in [`Fault::LeftOut`].
    Lacking {
        surfel: u32,
        rim: f32,
    },
    Outside,
    Absent,
    Tie,
    Nan,
    Stray,
    Below,
    #[default]
    Other,
}

impl Cause {
    /// The kind of this fault.
    pub(crate) fn from_fault(fault: &Fault) -> Self {
        match fault {
            Fault::LeftOut { surfel, rim, .. } => {
                Self::Lacking { surfel: *surfel, rim: *rim as f32 }
            }
            Fault::Outside { .. } => Self::Outside,
            Fault::Absent { .. } => Self::Absent,
            Fault::Tie { .. } => Self::Tie,
            Fault::Value { found, .. } if found.is_nan() => Self::Nan,
            Fault::Value { truth: f64::INFINITY, found, .. } if *found < f64::INFINITY => {
                Self::Stray
            }
            Fault::Value { found, truth, .. } if found < truth => Self::Below,
            _ => Self::Other,
        }
    }
}

/// What the wrong pixels of a stage have in common.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Causes {
    /// For each missing surfel, the number of pixels that lack it.
    pub left_out: BTreeMap<u32, u64>,
    /// The smallest q of a missing fragment, divided by the limit of q; +inf if none is missing.
    pub least_rim: f64,
    /// Number of pixels with the id of a fragment that is outside.
    pub outside: u64,
    /// Number of pixels with the id of a surfel that has no fragment there.
    pub absent: u64,
    /// Number of pixels where two surfels are equally near and the wrong one is kept.
    pub ties: u64,
    /// Number of pixels with a number where +inf is right: a depth without a surfel.
    pub strays: u64,
    /// Number of pixels with a number that is too small, including `strays`.
    pub below: u64,
    /// Number of pixels with NaN.
    pub nan: u64,
    /// Number of pixels that are wrong in another way.
    pub others: u64,
}

impl Causes {
    /// Counts one more wrong pixel.
    pub(crate) fn count(&mut self, cause: Cause) {
        match cause {
            Cause::Lacking { surfel, rim } => {
                let rim = f64::from(rim);
                let least = if self.left_out.is_empty() { f64::INFINITY } else { self.least_rim };
                self.least_rim = if rim < least { rim } else { least };
                *self.left_out.entry(surfel).or_default() += 1;
            }
            Cause::Outside => self.outside += 1,
            Cause::Absent => self.absent += 1,
            Cause::Tie => self.ties += 1,
            Cause::Nan => self.nan += 1,
            Cause::Stray => {
                self.below += 1;
                self.strays += 1;
            }
            Cause::Below => self.below += 1,
            Cause::Other => self.others += 1,
        }
    }

    /// Number of pixels that lack a surfel.
    #[must_use]
    pub fn lacking(&self) -> u64 {
        self.left_out.values().sum()
    }
}

/// The findings about one stage.
#[derive(Clone, Debug)]
pub struct StageVerdict {
    /// The name of the stage.
    pub stage: &'static str,
    /// The client's planes that were judged; empty if the client has none of this stage.
    pub planes: Vec<&'static str>,
    /// The planes that the client does not hand in, where it hands in others of this stage. A
    /// level, a layer or a group without any plane is listed as a whole.
    pub missing: Vec<String>,
    /// The planes that the client hands in and that are not judged, because planes that they follow
    /// from are missing. A level or a layer is listed as a whole.
    pub unjudged: Vec<String>,
    /// The error of each pixel in bounds. A pixel with an error up to 1 is right.
    pub errors: Plane<f32>,
    /// The [`Doubt`]s at each pixel.
    pub doubts: Plane<u8>,
    /// Number of wrong pixels.
    pub wrong: u64,
    /// What the wrong pixels have in common.
    pub causes: Causes,
    /// The worst wrong pixel; on a tie, the first.
    pub worst: Option<Finding>,
}

impl StageVerdict {
    /// Number of pixels with any of these doubts.
    #[must_use]
    pub fn doubtful(&self, doubts: u8) -> u64 {
        self.doubts.values().iter().filter(|at| **at & doubts != 0).count() as u64
    }
}

/// The verdict in one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// A correct implementation may leave these planes.
    Right,
    /// As `Right`, but the errors are larger, all together, than those of any correct
    /// implementation that was tried: see [`Unlike`].
    Unlike,
    /// No correct implementation leaves these planes.
    Wrong,
    /// Nothing is wrong, but not everything is judged: too many sums may be either way or have no
    /// bounds, or a plane that the client hands in follows from planes that it does not hand in.
    Undecidable,
}

impl Words for Outcome {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("right", Self::Right),
        ("unlike", Self::Unlike),
        ("wrong", Self::Wrong),
        ("undecidable", Self::Undecidable),
    ];
}

/// The findings about a client.
#[derive(Clone, Debug)]
pub struct Verdict {
    /// The findings stage by stage, in the order of the stages.
    pub stages: Vec<StageVerdict>,
    /// Number of pixels of the picture that may be covered. Undecided pixels and pixels without bounds
    /// may be, so that there are at least as many.
    pub covered: u64,
    /// Number of covered pixels with undecided sums.
    pub undecided: u64,
    /// Number of pixels with a number in some stage that has no bound.
    pub unbounded: u64,
    /// The largest fraction of undecided pixels with which a picture can still be judged.
    pub budget: f64,
    /// To which side the undecided decisions lean, for each limit, where the method takes account
    /// of them.
    pub shifts: Shifts,
    /// The stages whose errors are larger, all together, than those of any correct implementation
    /// that was tried.
    pub unlike: Vec<Unlike>,
}

impl Verdict {
    /// The default budget: the largest fraction of undecided sums with which a picture is still
    /// judged. `Decided:` one pixel in fifty; the scenes of the bench `verdicts` have 0.2 to 1.3 %
    /// under `gpu`, at most 0.2 % under `ieee`.
    pub const BUDGET: f64 = 0.02;

    /// A verdict from the findings of each stage, and the number of covered and undecided pixels.
    pub(crate) fn new(
        stages: Vec<StageVerdict>,
        [covered, undecided]: [u64; 2],
        budget: f64,
        shifts: Shifts,
    ) -> Self {
        let unbounded = unbounded(&stages);
        let covered = covered.max(undecided).max(unbounded);
        Self { stages, covered, undecided, unbounded, budget, shifts, unlike: Vec::new() }
    }

    /// The same verdict with a stage before the others.
    pub(crate) fn after(mut self, first: StageVerdict) -> Self {
        self.stages.insert(0, first);
        let unbounded = unbounded(&self.stages);
        Self { unbounded, covered: self.covered.max(unbounded), ..self }
    }

    /// The same verdict with other numbers of surfels.
    pub(crate) fn renumbered(mut self, of: impl Fn(u32) -> u32) -> Self {
        for stage in &mut self.stages {
            let lacking = std::mem::take(&mut stage.causes.left_out);
            stage.causes.left_out = lacking.into_iter().map(|(i, count)| (of(i), count)).collect();
            if let Some(worst) = &mut stage.worst {
                worst.fault.renumber(&of);
            }
        }
        self
    }

    /// The verdict in one word. A wrong pixel is wrong, however much is undecided.
    #[must_use]
    pub fn outcome(&self) -> Outcome {
        if self.first_wrong().is_some() {
            Outcome::Wrong
        } else if !(self.judges()
            && self.unjudged().is_empty()
            && self.within(self.undecided)
            && self.within(self.unbounded))
        {
            Outcome::Undecidable
        } else if !self.unlike.is_empty() {
            Outcome::Unlike
        } else {
            Outcome::Right
        }
    }

    /// Whether this many pixels may be undecided.
    fn within(&self, pixels: u64) -> bool {
        pixels as f64 <= self.budget * self.covered as f64
    }

    /// Whether any of the client's planes is judged.
    #[must_use]
    pub fn judges(&self) -> bool {
        self.stages.iter().any(|stage| !stage.planes.is_empty())
    }

    /// The planes that the client hands in and that are not judged, over all stages.
    #[must_use]
    pub fn unjudged(&self) -> Vec<&str> {
        self.stages.iter().flat_map(|stage| &stage.unjudged).map(String::as_str).collect()
    }

    /// The first stage with a wrong pixel.
    #[must_use]
    pub fn first_wrong(&self) -> Option<&StageVerdict> {
        self.stages.iter().find(|stage| stage.wrong > 0)
    }
}

/// Number of pixels with a number in some stage that has no bound.
fn unbounded(stages: &[StageVerdict]) -> u64 {
    let pixels = stages.iter().map(|stage| stage.doubts.values().len()).max();
    let at = |pixel: &usize| {
        let mut doubts = stages.iter().filter_map(|stage| stage.doubts.values().get(*pixel));
        doubts.any(|doubts| doubts & Doubt::Unbounded as u8 != 0)
    };
    (0..pixels.unwrap_or(0)).filter(at).count() as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stage(doubts: [u8; 3]) -> StageVerdict {
        StageVerdict {
            stage: "stage",
            planes: vec!["plane"],
            missing: Vec::new(),
            unjudged: Vec::new(),
            errors: Plane::filled(3, 1, 0.0),
            doubts: Plane::from_values(3, 1, doubts.to_vec()),
            wrong: 0,
            causes: Causes::default(),
            worst: None,
        }
    }

    #[test]
    fn a_pixel_without_bounds_in_two_stages_is_one() {
        let without = Doubt::Unbounded as u8;
        let stages = vec![stage([0, without, Doubt::Side as u8]), stage([0, without | 1, 0])];
        let verdict = Verdict::new(stages, [3, 0], 0.5, Shifts::default());
        assert_eq!((verdict.unbounded, verdict.outcome()), (1, Outcome::Right));
        let verdict = verdict.after(stage([without, 0, 0]));
        assert_eq!((verdict.unbounded, verdict.outcome()), (2, Outcome::Undecidable));
    }
}
