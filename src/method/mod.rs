//! One file or folder for each published method; each reads as its paper's pass list.
//!
//! - [`ewa`]: EWA surface splatting in two geometry passes and a normalization \[ZPvBG01, GP03\].
//! - [`single_pass`]: one geometry pass into the depth-images of groups, then compositing \[ZP06\].
//! - [`transparent`]: layers blended from back to front within groups \[ZP06\].

pub mod ewa;
mod fast;
mod picture;
mod prepare;
pub mod single_pass;
pub mod transparent;

pub use picture::Picture;
