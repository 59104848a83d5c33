//! Reconstruction with templates of \[MOC08\].

pub(crate) mod cases;
pub(crate) mod cover;
pub(crate) mod known;
pub(crate) mod laws;
pub(crate) mod mirror;
pub(crate) mod model;
pub(crate) mod projection;
pub(crate) mod rounded;
pub(crate) mod stages;
pub(crate) mod tolerance;
