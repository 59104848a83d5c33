//! What an extension of groups did.

/// What [`extend`](super::extend()) did.
#[derive(Clone, Debug, PartialEq)]
pub struct Extended {
    /// A: the area of the surface, in square world units.
    pub area: f64,
    /// How many surfels were added to groups, each counted once for each group.
    pub added: u64,
    /// What that is in per cent of the surfels.
    pub percent: f64,
    /// Each group.
    pub groups: Vec<GroupCoverage>,
}

/// What [`extend`](super::extend()) did to a group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroupCoverage {
    /// Surfels in the group, those added included.
    pub surfels: u64,
    /// What its radii are multiplied by.
    pub scale: f32,
    /// Whether the iteration of eq. 9 converged; true where there was none.
    pub converged: bool,
    /// The area that the group covers without the extension, eq. 7, as a part of A.
    pub before: f64,
    /// The same with the extension.
    pub after: f64,
}
