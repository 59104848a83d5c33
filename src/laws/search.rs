//! Search for a counterexample, and shrink it to the simplest inputs that are found.

use super::inputs::{Draw, Inputs};
use super::{Counterexample, Kind, Lawful};

/// Number of cases for each operator and kind of ordinary inputs.
const CASES: u32 = 1024;
/// Number of cases of odd inputs.
const ODD_CASES: u32 = 256;

/// The number of times that a case is run to shrink it.
const TRIES: u32 = 4096;

/// The laws that are tested in a case.
#[derive(Clone, Copy)]
pub(super) struct Asked<'k> {
    kinds: &'k [Kind],
    /// Whether the inputs may be odd.
    odd: bool,
}

impl<'k> Asked<'k> {
    /// The laws of these kinds at ordinary inputs.
    pub(super) fn ordinary(kinds: &'k [Kind]) -> Self {
        Self { kinds, odd: false }
    }

    /// Tests laws of a kind if this kind is asked. Laws of odd inputs are tested among those.
    pub(super) fn check(&self, kind: Kind, test: impl FnOnce() -> Lawful) -> Lawful {
        if !self.kinds.contains(&kind) || (kind == Kind::Odd && !self.odd) {
            return Ok(());
        }
        // The ordinary inputs were tried before.
        let kind = if self.odd { Kind::Odd } else { kind };
        test().map_err(|found| Counterexample { kind, ..found })
    }
}

/// A case: makes inputs, and tests laws at them.
type Case<'c> = dyn Fn(&mut Inputs, &Asked<'_>) -> Lawful + 'c;

/// Runs a case at ordinary inputs, first for algebraic laws and then for exact ones, then at odd
/// inputs for all that are asked. Returns the first counterexample, shrunk.
pub(super) fn search(seed: u64, kinds: &[Kind], case: &Case<'_>) -> Lawful {
    for kind in Kind::ALL.iter().filter(|kind| kinds.contains(kind)) {
        let (asked, cases) = match kind {
            Kind::Algebraic | Kind::Exact => {
                (Asked { kinds: std::slice::from_ref(kind), odd: false }, CASES)
            }
            Kind::Odd => (Asked { kinds, odd: true }, ODD_CASES),
        };
        let mut inputs = Inputs::new(seed, asked.odd);
        for _ in 0..cases {
            inputs.begin();
            if let Err(found) = case(&mut inputs, &asked) {
                return Err(Shrinking { case, asked, tries: TRIES }.shrunk(inputs.drawn(), found));
            }
        }
    }
    Ok(())
}

/// The search for simpler inputs that break the same law.
struct Shrinking<'s> {
    case: &'s Case<'s>,
    asked: Asked<'s>,
    tries: u32,
}

/// The choices and numbers that the inputs of a case were made of, and what they break.
type Broken = (Vec<Draw>, Counterexample);

impl Shrinking<'_> {
    /// Replaces draws by simpler ones, as long as that is possible.
    fn shrunk(mut self, drawn: &[Draw], found: Counterexample) -> Counterexample {
        let mut best = (drawn.to_vec(), found);
        loop {
            let shorter = self.without_some(&mut best);
            let simpler = self.with_simpler(&mut best);
            if self.tries == 0 || !(shorter || simpler) {
                return best.1;
            }
        }
    }

    /// Runs the case with these draws, and keeps them if they are simpler and break the same law.
    fn is_better(&mut self, draws: &[Draw], best: &mut Broken) -> bool {
        if self.tries == 0 {
            return false;
        }
        self.tries -= 1;
        let mut inputs = Inputs::replay(draws, self.asked.odd);
        let Err(found) = (self.case)(&mut inputs, &self.asked) else { return false };
        let drawn = inputs.drawn();
        let same = (found.law, found.kind) == (best.1.law, best.1.kind);
        let better = same && is_simpler(drawn, &best.0);
        if better {
            *best = (drawn.to_vec(), found);
        }
        better
    }

    /// Leaves out runs of draws. Whatever is missing at the end is drawn as 0.
    fn without_some(&mut self, best: &mut Broken) -> bool {
        let (mut found, mut size) = (false, best.0.len().next_power_of_two());
        while size > 0 {
            let mut start = 0;
            while start < best.0.len() {
                let end = best.0.len().min(start + size);
                let rest = [&best.0[..start], &best.0[end..]].concat();
                // What comes after is at the same place now.
                if self.is_better(&rest, best) {
                    found = true;
                } else {
                    start += size;
                }
            }
            size /= 2;
        }
        found
    }

    /// Replaces each draw by the simplest that still breaks the law.
    fn with_simpler(&mut self, best: &mut Broken) -> bool {
        let (mut found, mut i) = (false, 0);
        while i < best.0.len() {
            for simpler in best.0[i].simpler() {
                let mut draws = best.0.clone();
                draws[i] = simpler;
                if self.is_better(&draws, best) {
                    found = true;
                    break;
                }
            }
            i += 1;
        }
        found
    }
}

/// Whether draws are simpler than others: simpler altogether, or as simple and the first that
/// differs is simpler.
fn is_simpler(draws: &[Draw], others: &[Draw]) -> bool {
    let order = |draws: &[Draw]| {
        let each: Vec<u64> = draws.iter().map(Draw::complexity).collect();
        (each.iter().sum::<u64>(), each.len(), each)
    };
    order(draws) < order(others)
}
