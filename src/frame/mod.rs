//! What is rendered into: planes, named planes, the framebuffer, bins and tiles.
//!
//! - [`plane`], [`rect`], [`named`]: pixels, rectangles of them, and the names they have in files.
//! - [`mod@image`]: a picture as files hold it.
//! - [`framebuffer`]: depth, stencil and floating accumulation.
//! - [`pool`]: planes that are used again.
//! - [`raster`]: the pixels of triangles and of lines, exactly.
//! - [`mod@pyramid`]: the sizes of an image pyramid.
//! - [`stencil`]: the 8-bit stencil of GPU APIs.
//! - [`bin`]: from screen bounds to tiles.
//! - [`tile`]: tiles and the one parallel loop of the crate.

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
