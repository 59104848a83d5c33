//! The result of a comparison as text.

use super::{ChannelComparison, Comparison, Difference, Differences, Relation, Verdict};
use std::fmt;

impl Comparison {
    /// The findings as text: one line for each channel, and a last line with the verdict.
    #[must_use]
    pub fn lines(&self) -> Vec<String> {
        let mut lines: Vec<String> =
            self.channels.iter().map(ChannelComparison::to_string).collect();
        let [(width, height), (other_width, other_height)] = self.sizes;
        let verdicts = || self.channels.iter().filter_map(ChannelComparison::verdict);
        let count = verdicts().count();
        let unequal = verdicts().filter(|verdict| *verdict != Verdict::Equal).count();
        lines.push(match self.verdict() {
            _ if self.sizes[0] != self.sizes[1] => format!(
                "different: {width} x {height} against {other_width} x {other_height} pixels"
            ),
            Verdict::Equal => format!("equal: all {count} planes, bit for bit"),
            Verdict::Within => format!("within tolerance: {unequal} of {count} planes differ"),
            Verdict::Different => format!("different: {unequal} of {count} planes differ"),
        });
        lines
    }
}

impl fmt::Display for ChannelComparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.name)?;
        match &self.relation {
            Relation::Observation => f.write_str("not compared, an observation of the first file"),
            Relation::OnlyFirst => f.write_str("only in the first file"),
            Relation::OnlySecond => f.write_str("only in the second file"),
            Relation::Types => f.write_str("floats in one file, indices in the other"),
            Relation::Values(differences) => differences.fmt(f),
        }
    }
}

/// Writes the pixel, both values, and their distance.
impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "({}, {}): {} against {}", self.x, self.y, self.first, self.second)?;
        self.ulps().map_or(Ok(()), |ulps| write!(f, ", {ulps} ulp"))
    }
}

/// Names the worst pixel only where it is not the first.
impl fmt::Display for Differences {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Some(first), Some(worst)) = (&self.first, &self.worst) else {
            f.write_str("equal")?;
            return if self.nan > 0 { write!(f, ", {} pixels with NaN", self.nan) } else { Ok(()) };
        };
        write!(f, "{} of {} pixels differ, ", self.differing, self.pixels)?;
        match self.failing {
            0 => f.write_str("all within tolerance, ")?,
            failing if failing <= self.allowed => {
                write!(f, "{failing} beyond tolerance where {} may be, ", self.allowed)?;
            }
            failing if failing < self.differing => write!(f, "{failing} beyond tolerance, ")?,
            _ => {}
        }
        write!(f, "first {first}")?;
        if (worst.x, worst.y) != (first.x, first.y) {
            write!(f, "; worst {worst}")?;
        }
        write!(f, "; at most {} ulp, {:.3e}; RMS {:.3e}", self.max_ulp, self.max_abs, self.rms)?;
        if self.nan > 0 {
            write!(f, "; {} pixels with NaN", self.nan)?;
        }
        Ok(())
    }
}
