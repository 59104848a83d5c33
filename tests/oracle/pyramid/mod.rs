//! The pull-push pyramid of \[MKC08\].

pub(crate) mod cases;
pub(crate) mod known;
pub(crate) mod laws;
pub(crate) mod model;
pub(crate) mod pieces;
pub(crate) mod projection;
pub(crate) mod rays;
pub(crate) mod shade;
pub(crate) mod stages;
pub(crate) mod tolerance;
