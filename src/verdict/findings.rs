//! What was found of a client's planes: stage by stage, pixel by pixel, and in one word.

use super::doubt::Doubt;
use super::fault::Fault;
use super::shift::Shifts;
use crate::frame::Plane;
use std::collections::BTreeMap;

/// A wrong pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Column and row.
    pub pixel: (u32, u32),
    /// What is wrong.
    pub fault: Fault,
    /// By how many bounds: above 1; +inf if no bound can be given.
    pub error: f64,
}

/// What is wrong at a pixel, as far as [`Causes`] count it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) enum Cause {
    /// A surfel lacks; where in its splat, as in [`Fault::LeftOut`].
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
    /// That of a fault.
    pub(crate) fn of(fault: &Fault) -> Self {
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
    /// How many pixels lack a surfel, by surfel.
    pub left_out: BTreeMap<u32, u64>,
    /// The least q of what is left out, divided by the limit of q; +inf if nothing is.
    pub least_rim: f64,
    /// How many have the id of a fragment that is outside.
    pub outside: u64,
    /// How many have the id of a surfel that has no fragment there.
    pub absent: u64,
    /// How many have the id of one of two equally near that should not be there.
    pub ties: u64,
    /// How many have a number where there should be +inf: a depth without a surfel.
    pub strays: u64,
    /// How many have a number that is too small, these included.
    pub below: u64,
    /// How many are NaN.
    pub nan: u64,
    /// How many are wrong otherwise.
    pub others: u64,
}

impl Causes {
    /// One more wrong pixel.
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

    /// How many pixels lack a surfel.
    #[must_use]
    pub fn lacking(&self) -> u64 {
        self.left_out.values().sum()
    }
}

/// What was found of one stage.
#[derive(Clone, Debug)]
pub struct StageVerdict {
    /// The stage.
    pub stage: &'static str,
    /// The planes of the client that were judged; empty if there are none.
    pub planes: Vec<&'static str>,
    /// What the client has not of a stage that has levels, if it has others: whole levels, or planes. What
    /// follows from these is not judged.
    pub missing: Vec<String>,
    /// The error of each pixel in bounds: up to 1 it is right.
    pub errors: Plane<f32>,
    /// The [`Doubt`]s at each pixel.
    pub doubts: Plane<u8>,
    /// How many pixels are wrong.
    pub wrong: u64,
    /// What they have in common.
    pub causes: Causes,
    /// The worst of them; of equals the first.
    pub worst: Option<Finding>,
}

impl StageVerdict {
    /// How many pixels have one of these doubts.
    #[must_use]
    pub fn doubtful(&self, doubts: u8) -> u64 {
        self.doubts.values().iter().filter(|at| **at & doubts != 0).count() as u64
    }
}

/// The verdict in a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// A right implementation may leave these planes.
    Right,
    /// No right implementation leaves them.
    Wrong,
    /// So many sums may be either way, or have no bounds, that nothing is proved, or no plane is judged.
    Undecidable,
}

/// What was found of a client.
#[derive(Clone, Debug)]
pub struct Verdict {
    /// Stage by stage, in their order.
    pub stages: Vec<StageVerdict>,
    /// How many pixels of the picture may be covered.
    pub covered: u64,
    /// In how many of them the sums are undecided.
    pub undecided: u64,
    /// How many pixels have a number in some stage of which no bound can be given.
    pub unbounded: u64,
    /// The greatest share of undecided pixels of which a picture can be judged.
    pub budget: f64,
    /// To which side the undecided decisions lean, by limit, where the method asks.
    pub shifts: Shifts,
}

impl Verdict {
    /// The share of undecided sums of which a picture is still judged, unless somebody says
    /// otherwise. `Decided:` one pixel in fifty; the scenes of the bench `verdicts` have 0.2 to
    /// 1.3 % under `gpu`, at most 0.2 % under `ieee`.
    pub const BUDGET: f64 = 0.02;

    /// Of what was found stage by stage, and of pixels that may be covered and that are undecided.
    pub(crate) fn new(
        stages: Vec<StageVerdict>,
        [covered, undecided]: [u64; 2],
        budget: f64,
        shifts: Shifts,
    ) -> Self {
        let unbounded = unbounded(&stages);
        Self { stages, covered, undecided, unbounded, budget, shifts }
    }

    /// The same with a stage before the others.
    pub(crate) fn after(mut self, first: StageVerdict) -> Self {
        self.stages.insert(0, first);
        Self { unbounded: unbounded(&self.stages), ..self }
    }

    /// The same with other numbers of surfels.
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

    /// In a word. What is wrong is wrong, however much is undecided.
    #[must_use]
    pub fn outcome(&self) -> Outcome {
        if self.first_wrong().is_some() {
            Outcome::Wrong
        } else if self.judges() && self.within(self.undecided) && self.within(self.unbounded) {
            Outcome::Right
        } else {
            Outcome::Undecidable
        }
    }

    /// Whether so many pixels may be undecided.
    fn within(&self, pixels: u64) -> bool {
        pixels as f64 <= self.budget * self.covered as f64
    }

    /// Whether any plane of the client is judged.
    #[must_use]
    pub fn judges(&self) -> bool {
        self.stages.iter().any(|stage| !stage.planes.is_empty())
    }

    /// The first stage with a wrong pixel.
    #[must_use]
    pub fn first_wrong(&self) -> Option<&StageVerdict> {
        self.stages.iter().find(|stage| stage.wrong > 0)
    }
}

/// How many pixels have a number in some stage of which no bound can be given.
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
