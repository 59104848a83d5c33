//! The pixels of triangles and of lines, exactly: integer arithmetic, one answer.
//!
//! ```text
//!   pixel position (X, Y) ──Snap::fixed──▶ fixed point ──Triangle──▶ pixel, weights of 3 corners
//!                                                      ──Line──────▶ pixel, parameter from a to b
//! ```
//!
//! Rounding happens once, when a corner is snapped. From there on coverage, weights and parameters
//! are exact: primitives that share corners neither leave gaps nor overlap, a picture does not
//! depend on its tiles, and `f32` and `f64` disagree only where they snap a corner differently.
//!
//! - [`triangle`]: pixels whose centres are inside, by the top-left rule.
//! - [`mod@line`]: connected lines, one pixel wide.
//!
//! \[MKC08, sections 4 and 5\] has the graphics hardware rasterize polygons and lines. `Decided:`
//! which pixels those are: for triangles the rule that the graphics interfaces share, for lines,
//! where they do not agree, the rule of [`mod@line`].
//!
//! **Fixed point.** An integer F stands for the coordinate F / 2^bits, with 8 sub-pixel bits as in
//! Direct3D unless said otherwise. Coordinates reach to the **guard band**, |X| <= 2^17 and |Y| <=
//! 2^17 px, twice the largest picture; what reaches farther is clipped before
//! ([`crate::splat::clip`]). That and at most 12 bits keep every product here below 2^63.

pub mod line;
mod snap;
pub mod triangle;

#[cfg(test)]
mod tests;

pub use line::Line;
pub use snap::{GUARD_BAND, Snap};
pub use triangle::Triangle;
