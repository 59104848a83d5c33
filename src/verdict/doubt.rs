//! Decisions that right implementations may take either way.

/// A decision that right implementations may take either way, as a bit of the ambiguity mask.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Doubt {
    /// Whether a fragment is inside the cut-off; in image space whether an ellipse holds a point, which
    /// pixel or level a centre is in.
    CutOff = 1,
    /// Whether a fragment or a sample is nearer than the nearest.
    Nearer = 2,
    /// Whether a fragment belongs to the visible band; in image space whether two centres or intervals
    /// meet.
    Epsilon = 4,
    /// Whether a surfel is drawn, or by which outline; in image space whether a cell is occluded.
    Fate = 8,
    /// Which side of a surfel is seen.
    Side = 16,
    /// No decision: a number that no bound can be given for, as where a sum may exceed the largest
    /// `f32` or a divisor may be 0. It is not judged.
    Unbounded = 32,
}

impl Doubt {
    /// All, in the order of their bits.
    pub const ALL: [Self; 6] =
        [Self::CutOff, Self::Nearer, Self::Epsilon, Self::Fate, Self::Side, Self::Unbounded];

    /// The name in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::CutOff => "cut-off",
            Self::Nearer => "nearer",
            Self::Epsilon => "epsilon",
            Self::Fate => "fate",
            Self::Side => "side",
            Self::Unbounded => "without bounds",
        }
    }

    /// The doubts that move sums: all but which of near ties is the nearest.
    pub const OF_SUMS: u8 = !(Self::Nearer as u8);
}
