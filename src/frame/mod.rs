//! Hold a picture, its planes and its tiles.
//!
//! - [`plane`], [`rect`], [`named`]: pixels, rectangles of pixels, and the names that planes have
//!   in files.
//! - [`mod@image`]: a picture as files hold it.
//! - [`framebuffer`]: depth, stencil and floating-point accumulation.
//! - [`pool`]: planes that are reused.
//! - [`raster`]: the pixels of triangles and of lines, exactly.
//! - [`mod@pyramid`]: the sizes of an image pyramid.
//! - [`stencil`]: the 8-bit stencil of GPU APIs.
//! - [`bin`]: sort screen bounds into tiles.
//! - [`tile`]: tiles, and the one parallel loop of the crate.

mod beside;
pub mod bin;
pub mod framebuffer;
pub mod image;
pub mod named;
pub mod plane;
pub mod pool;
pub mod pyramid;
pub mod raster;
pub mod rect;
pub mod stencil;
pub mod tile;

pub use bin::Bins;
pub use framebuffer::{Framebuffer, FramebufferTile, NO_ID, Wanted};
pub use image::Image;
pub use named::{Channel, ChannelData, Frame, NamedPlane, Samples};
pub use plane::Plane;
pub use pool::Pool;
pub use rect::Rect;
pub use stencil::Stencil;
pub use tile::{Exec, Grid, TileMut};
