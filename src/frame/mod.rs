//! What is rendered into: planes, named planes, the framebuffer, bins and tiles.

pub mod named;
pub mod plane;
pub mod stencil;

pub use named::{Channel, ChannelData, Frame, NamedPlane, Samples};
pub use plane::Plane;

/// The id of a pixel that no surfel covers.
pub const NO_ID: u32 = u32::MAX;
