//! What the suite found: a row for each rule.

use super::Rule;
use super::common::Common;
use crate::error::Result;
use crate::setting::{Word, Words};
use crate::verdict::causes::Likely;
use crate::verdict::client::Rounding;
use crate::verdict::shift::{LIMITS, Shift, Shifts};
use crate::verdict::{Outcome, Verdict};
use std::fmt;

/// The word for a renderer that left nothing to judge.
const FAILED: &str = "failed";

/// The report on a renderer.
#[derive(Debug)]
pub struct Report {
    /// The method.
    pub method: String,
    /// The rules that were tried.
    pub rows: Vec<Row>,
}

/// What was found about one rule.
#[derive(Debug)]
pub struct Row {
    /// The rule.
    pub rule: Rule,
    /// The verdict, or why there is none.
    pub judged: std::result::Result<Judged, String>,
}

/// The verdict on a case.
#[derive(Debug)]
pub struct Judged {
    /// The verdict.
    pub verdict: Verdict,
    /// The mistake that the client most probably makes.
    pub likely: Option<Likely>,
    /// The planes with which the verdict would tell more.
    pub sharper: Option<String>,
    /// What the client promised.
    pub rounding: Rounding,
}

impl Row {
    /// A row from a verdict, or from the error that prevented it.
    #[must_use]
    pub fn new(rule: Rule, judged: Result<Judged>) -> Self {
        Self { rule, judged: judged.map_err(|error| error.to_string()) }
    }

    /// The outcome; none if the renderer failed.
    #[must_use]
    pub fn outcome(&self) -> Option<Outcome> {
        self.judged.as_ref().ok().map(|judged| judged.verdict.outcome())
    }

    /// The verdict in a word: the word of its [`Outcome`], or `failed`.
    #[must_use]
    pub fn word(&self) -> &'static str {
        self.outcome().map_or(FAILED, |outcome| outcome.word())
    }

    /// Why the rule is not right: where the picture is wrong and a likely mistake, or the failure.
    /// Empty if it is right.
    #[must_use]
    pub fn cause(&self) -> String {
        match &self.judged {
            Err(why) => why.clone(),
            Ok(judged) => judged.why(),
        }
    }
}

impl Judged {
    fn why(&self) -> String {
        let Verdict { covered, undecided, unlike, .. } = &self.verdict;
        match self.verdict.outcome() {
            Outcome::Right | Outcome::Wrong => {}
            Outcome::Undecidable if !self.verdict.judges() => return "no plane was judged".into(),
            Outcome::Undecidable if !self.verdict.unjudged().is_empty() => {
                return format!("not judged: {}", self.verdict.unjudged().join(", "));
            }
            Outcome::Undecidable => {
                return format!("{undecided} of {covered} covered pixels have undecided sums");
            }
            Outcome::Unlike => {
                let unlike: Vec<String> = unlike.iter().map(ToString::to_string).collect();
                return unlike.join("; ");
            }
        }
        let Some(stage) = self.verdict.first_wrong() else { return String::new() };
        let pixels = match stage.wrong {
            1 => "1 pixel".into(),
            wrong => format!("{wrong} pixels"),
        };
        let worst = stage
            .worst
            .as_ref()
            .map_or(String::new(), |worst| format!(", at {:?} {}", worst.pixel, worst.fault));
        let cause =
            self.likely.as_ref().map_or(String::new(), |own| format!("; looks like {}", own.words));
        format!("{} in {pixels}{worst}{cause}", stage.stage)
    }
}

impl Report {
    /// An empty report.
    #[must_use]
    pub fn new(method: &str) -> Self {
        Self { method: method.to_owned(), rows: Vec::new() }
    }

    /// Whether every rule is right, and the decisions of all rules together lean to no side.
    #[must_use]
    pub fn is_right(&self) -> bool {
        self.rows.iter().all(|row| row.outcome() == Some(Outcome::Right)) && !self.leans()
    }

    /// Every word that [`Row::word`] can be.
    #[must_use]
    pub fn words() -> Vec<&'static str> {
        Outcome::WORDS.iter().map(|(word, _)| *word).chain([FAILED]).collect()
    }

    /// How many rules have this verdict, see [`Row::word`].
    #[must_use]
    pub fn count(&self, word: &str) -> usize {
        self.rows.iter().filter(|row| row.word() == word).count()
    }

    /// To which side the undecided decisions of all rules lean together, for each promise that a
    /// client made, in the order of the first rules with it.
    #[must_use]
    pub fn shifts(&self) -> Vec<(Rounding, Shifts)> {
        let mut all: Vec<(Rounding, Shifts)> = Vec::new();
        for judged in self.rows.iter().filter_map(|row| row.judged.as_ref().ok()) {
            let found = all.iter().position(|(rounding, _)| *rounding == judged.rounding);
            let at = found.unwrap_or(all.len());
            if found.is_none() {
                all.push((judged.rounding, Shifts::default()));
            }
            let sums = all[at].1.iter_mut().zip(&judged.verdict.shifts);
            sums.for_each(|(sum, shift)| sum.add(shift));
        }
        all
    }

    /// Whether a bias of the undecided decisions shows that a threshold is wrong.
    #[must_use]
    pub fn leans(&self) -> bool {
        let shifts = self.shifts();
        shifts.iter().flat_map(|(_, shifts)| shifts).any(Shift::alarms)
    }

    /// The planes with which the verdicts would tell more, and for how many rules.
    #[must_use]
    pub fn sharper(&self) -> Option<(&str, usize)> {
        let judged = self.rows.iter().filter_map(|row| row.judged.as_ref().ok());
        let mut lacking = judged.filter_map(|judged| judged.sharper.as_deref());
        let first = lacking.next()?;
        Some((first, 1 + lacking.count()))
    }

    /// The mistake that explains the most wrong rules, if it explains more than one.
    #[must_use]
    pub fn common(&self) -> Option<Common> {
        let judged = self.rows.iter().filter_map(|row| row.judged.as_ref().ok());
        let wrong: Vec<_> =
            judged.filter(|judged| judged.verdict.outcome() == Outcome::Wrong).collect();
        let mistakes = |judged: &&Judged| match &judged.likely {
            Some(likely) => likely.mistakes.clone(),
            None => Vec::new(),
        };
        Common::new(&wrong.iter().map(mistakes).collect::<Vec<_>>())
    }

    /// The width of the column of rules.
    #[must_use]
    pub fn width(rules: &[Rule]) -> usize {
        rules.iter().map(|rule| rule.name.len()).max().unwrap_or(0)
    }

    /// What all rows say together, a line each.
    #[must_use]
    pub fn summary(&self) -> Vec<String> {
        let mut lines = Vec::new();
        for (_, shifts) in self.shifts() {
            let alarming = LIMITS.iter().zip(&shifts).filter(|(_, shift)| shift.alarms());
            lines.extend(alarming.map(|(limit, shift)| {
                let side = if shift.estimate() < 0.0 { "small" } else { "large" };
                format!(
                    "WRONG: the threshold of the {} is about {:.1e} of itself too {side}: the \
                     undecided decisions of all rules lean to one side, z = {:.1}",
                    limit.name(),
                    shift.estimate().abs(),
                    shift.z()
                )
            }));
        }
        lines.extend(self.common().map(|common| common.to_string()));
        if let Some((planes, rules)) = self.sharper() {
            lines.push(format!("{rules} of the verdicts would tell more with {planes}"));
        }
        let counts = Self::words().into_iter().map(|word| (self.count(word), word));
        let counts = counts.filter(|(count, word)| *count > 0 || *word == Outcome::Right.word());
        let counts: Vec<String> = counts.map(|(count, word)| format!("{count} {word}")).collect();
        lines.push(format!("{}: {}", self.method, counts.join(", ")));
        lines
    }
}

impl fmt::Display for Row {
    /// The verdict and the cause, to follow the name of the rule.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", format!("{:<12} {}", self.word(), self.cause()).trim_end())
    }
}

impl fmt::Display for Report {
    /// A table, and its summary.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = self.rows.iter().map(|row| row.rule.name.len()).max().unwrap_or(0);
        for row in &self.rows {
            writeln!(f, "{:<width$}  {row}", row.rule.name)?;
        }
        write!(f, "{}", self.summary().join("\n"))
    }
}
