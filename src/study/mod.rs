//! What is measured of samplers, and the charts that show it.
//!
//! - [`chart`]: drawings that are written as SVG and as PNG, the same picture in both.
//! - [`spread`]: how evenly prefixes of several orders are spread \[BJFM19, Fig. 3\].

pub mod chart;
pub mod spread;
