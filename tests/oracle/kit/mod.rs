//! What every oracle shares: vectors and the camera, numbers that carry their error, tolerances, goldens.

pub(crate) mod condition;
pub(crate) mod eye;
pub(crate) mod goldens;
pub(crate) mod number;
pub(crate) mod tolerance;
