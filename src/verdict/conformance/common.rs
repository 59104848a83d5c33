//! The one mistake that explains the most wrong rules. Each rule is a scene of its own, in which
//! several mistakes may look alike; all rules together tell them apart.

use std::fmt;

/// A mistake, and how many of the wrong rules it explains.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Common {
    /// The mistake in words.
    pub mistake: String,
    /// The number of wrong rules that it explains.
    pub explains: usize,
    /// The number of wrong rules.
    pub wrong: usize,
}

/// Numbers in the names of a mistake that differ by at most this fraction are one estimate.
const NEAR: f64 = 0.05;

impl Common {
    /// The mistake that explains the most rules, from the mistakes that explain each wrong rule; of
    /// those that explain as many, the first. None if no mistake explains two rules.
    pub(super) fn new(rules: &[Vec<String>]) -> Option<Self> {
        let has = |own: &[String], mistake: &str| own.iter().any(|one| are_one(one, mistake));
        let mut best: Option<Self> = None;
        for mistake in rules.iter().flatten() {
            let explains = rules.iter().filter(|own| has(own, mistake)).count();
            if explains > best.as_ref().map_or(1, |best| best.explains) {
                best = Some(Self { mistake: mistake.clone(), explains, wrong: rules.len() });
            }
        }
        best
    }
}

impl fmt::Display for Common {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { mistake, explains, wrong } = self;
        write!(f, "looks like {mistake}: explains {explains} of {wrong} wrong rules")
    }
}

/// Whether two names are those of one mistake: the same words, and nearly the same numbers.
fn are_one(a: &str, b: &str) -> bool {
    let [mut a, mut b] = [a, b].map(str::split_whitespace);
    let number = |word: &str| word.trim_end_matches([',', ':', ';']).parse::<f64>().ok();
    loop {
        match (a.next(), b.next()) {
            (None, None) => return true,
            (Some(one), Some(other)) if one == other => {}
            (Some(one), Some(other)) => {
                let (Some(one), Some(other)) = (number(one), number(other)) else { return false };
                if !((one - other).abs() <= NEAR * one.abs()) {
                    return false;
                }
            }
            _ => return false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mistake_of_most_rules_is_named() {
        let filter = |variance: f64| format!("the filter has {variance} px^2, not 0.3");
        let rules = [
            vec!["the cut-off is 2.9, not 3".to_owned()],
            vec![filter(0.1)],
            vec!["rows are flipped".to_owned(), filter(0.103)],
            vec![],
            vec![filter(0.2)],
            vec![filter(0.098)],
        ];
        let common = Common::new(&rules).unwrap();
        assert_eq!(
            common.to_string(),
            "looks like the filter has 0.1 px^2, not 0.3: explains 3 of 6 wrong rules"
        );
        assert_eq!(Common::new(&rules[..2]), None, "no mistake explains two");
        assert_eq!(Common::new(&[]), None);
        assert!(!are_one("the cut-off is 3", "the cut-off is 3 px"));
    }
}
