//! Decisions that correct implementations may take either way.

/// A decision that correct implementations may take either way, as a bit of the ambiguity mask.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Doubt {
    /// Whether a fragment is inside the cut-off. In image space: whether an ellipse holds a point,
    /// and which pixel or level holds a centre.
    CutOff = 1,
    /// Whether a fragment or a sample is nearer than the nearest so far.
    Nearer = 2,
    /// Whether a fragment belongs to the visible band. In image space: whether two centres or
    /// intervals meet.
    Epsilon = 4,
    /// Whether a surfel is drawn, or with which outline. In image space: whether a cell is
    /// occluded.
    Fate = 8,
    /// Which side of a surfel the camera sees.
    Side = 16,
    /// Not a decision: a number without a bound, because a sum may exceed the largest `f32` or a
    /// divisor may be 0. The number is not judged.
    Unbounded = 32,
}

impl Doubt {
    /// All doubts, in the order of their bits.
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

    /// The doubts that change sums: all except which of two near ties is the nearest.
    pub const OF_SUMS: u8 = !(Self::Nearer as u8);
}
