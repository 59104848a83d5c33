//! What an extension of groups did.

/// The result of [`extend`](super::extend()).
#[derive(Clone, Debug, PartialEq)]
pub struct Extended {
    /// A: the area of the surface, in square world units.
    pub area: f64,
    /// How many surfels were added to groups; a surfel counts once for each group that it was added
    /// to.
    pub added: u64,
    /// The added surfels in per cent of all surfels.
    pub percent: f64,
    /// The result for each group.
    pub groups: Vec<GroupCoverage>,
}

/// The result of [`extend`](super::extend()) for one group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroupCoverage {
    /// How many surfels are in the group, including added ones.
    pub surfels: u64,
    /// The factor on the radii of the group.
    pub scale: f32,
    /// Whether the iteration of eq. 9 converged; true if there was none.
    pub converged: bool,
    /// The area that the group covers without the extension, eq. 7, as a part of A.
    pub before: f64,
    /// The same area with the extension.
    pub after: f64,
}
