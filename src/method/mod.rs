//! One file or folder for each published method; each reads as its paper's pass list.
//!
//! - [`ewa`]: EWA surface splatting in two geometry passes and a normalization \[ZPvBG01, GP03\].
//! - [`peeling`]: transparency by depth peeling, the truth that the others are compared with \[ZP06\].
//! - [`single_pass`]: one geometry pass into the depth-images of groups, then compositing \[ZP06\].
//! - [`transparent`]: layers blended from back to front within groups \[ZP06\].
//! - [`mod@render`]: any of them, chosen by a value.

pub mod ewa;
pub mod peeling;
mod picture;
mod prepare;
pub mod render;
pub mod single_pass;
pub mod transparent;

pub use picture::Picture;
pub use render::{Grouping, Method, Preparation, render, render_f32};
