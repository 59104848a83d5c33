//! One file or folder for each published method; each reads as its paper's pass list.
//!
//! - [`ewa`]: EWA surface splatting in two geometry passes and a normalization \[ZPvBG01, GP03\].

pub mod ewa;
