//! Draw a scene by one of ten published methods, or read a method as its paper's pass list.
//!
//! [`Session`] draws a scene by one method. [`Method`] is the table of methods, one row a method.
//! Each row is a folder whose page is the specification:
//!
//! - [`ewa`]: EWA surface splatting in two geometry passes and a normalization \[ZPvBG01, GP03\].
//! - [`deferred`]: the passes of `ewa` on visible surfels only, which the last frame helps to find
//!   \[GBP04\].
//! - [`single_pass`]: one geometry pass into the depth-images of groups, then compositing \[ZP06\].
//! - [`transparent`]: layers blended from back to front within groups \[ZP06\].
//! - [`transparent_hq`]: `transparent` behind a nearest layer in high quality \[ZP06\].
//! - [`peeling`]: transparency by depth peeling, the truth that the other transparent methods are
//!   compared with \[ZP06\].
//! - [`pyramid`]: pull-push interpolation, with ribbons, tubes and polygons \[MKC08\].
//! - [`template`]: reconstruction with templates of k x k pixels \[MOC08\].
//! - [`blue`]: oriented discs in squares, as progressive blue surfels are drawn \[BJFM19\].
//! - [`gaussians`]: 3D Gaussian splats, or surfels as 2D ones, blended from front to back.
//!
//! [`mod@planes`] lists the planes that each method leaves.
//!
//! [`mod@projection`] turns a scene into one sample a pixel; [`pyramid`] and [`template`] begin
//! with it.
//!
//! # The files of a method
//!
//! | file | what is in it |
//! |---|---|
//! | `mod.rs` | the specification, and the row of the table: [`Algorithm`] for the settings |
//! | `settings.rs` | the settings, a row a setting ([`crate::setting`]) |
//! | one a published pass | the definition, over any exact number |
//! | `planes.rs` | the planes of every [`Stage`], one row a plane, beside the records that hold their values |
//! | `picture.rs` | all stages in one call |
//! | `explain.rs` | the decisions at one pixel |
//! | `fast/` | the bits of the definition for `f32`, from another layout |
//!
//! [`crate::verdict`], a folder a method, says what a right implementation may leave of each stage.
//!
//! To add a method, write its folder, a row in `table.rs`, its verdict and a row in
//! `src/verdict/table.rs`, its scenes under `golden/` and its oracle under `tests/oracle/`.
//!
//! # Fast paths with the same bits
//!
//! The fast paths of the methods that draw splats give the bits of the definitions for `f32`. A
//! tile is finished while it is in the cache. Its splats, which projection has left side by side,
//! are gathered into one list. Its pixels are kept in blocks of 4 x 4, one vector of 16 lanes a
//! quantity. A lane is a pixel and never a partial sum, so every pixel sees the operations of the
//! definition in their order.
//!
//! [`ewa`] and [`single_pass`] run over the splats, and for each splat over its blocks. The methods
//! of layers run over the blocks, and for each block over the list of its splats. They do so
//! because they meet the fragments of a block again, or because they keep more of the block's
//! pixels than fits the nearest cache for a whole tile.
//!
//! Four things differ from the definition, and none of them changes a bit:
//!
//! - A block is visited whole. The lanes outside a splat's bounds have q > k^2.
//! - The epsilon-z test `1/w <= limit` becomes `w >= least`, with `least` the smallest `f32` that
//!   passes: 1/w, correctly rounded, never grows with w.
//! - A fragment that fails adds weight 0 instead of nothing, and an image without fragments is not
//!   added to a sum at all.
//! - If a processor multiplies and adds in one instruction, the polynomial of e^x is computed so.
//!   The result is correctly rounded either way, see
//!   [`exp_f32_in_range`](crate::number::elementary::exp_f32_in_range).

mod algorithm;
pub mod blue;
pub mod buffer_formats;
pub(crate) mod clock;
pub(crate) mod decisions;
pub mod deferred;
pub mod ewa;
mod fast;
pub(crate) mod fragment;
pub mod gaussians;
mod input_planes;
pub(crate) mod part;
pub mod peeling;
pub(crate) mod picture;
pub mod planes;
pub(crate) mod prepare;
pub mod projection;
pub mod pyramid;
pub(crate) mod record;
mod records;
pub mod session;
pub mod single_pass;
pub mod stage;
pub(crate) mod surface;
mod table;
pub mod template;
#[cfg(test)]
pub(crate) mod tests;
pub(crate) mod tiled;
pub mod transparent;
pub mod transparent_hq;

pub use algorithm::{Algorithm, Job};
pub use clock::Laps;
pub use input_planes::InputPlanes;
pub use picture::Picture;
pub use records::{RecordLayout, Records};
pub use session::Session;
pub use stage::{Holds, PlaneRow, Stage, When};
pub use table::Method;
