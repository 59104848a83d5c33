//! What is measured: of samplers, and of methods, speed against accuracy.
//!
//! - [`mod@atlas`]: where each method breaks.
//! - [`chart`]: drawings that are written as SVG and as PNG, the same picture in both.
//! - [`mod@claims`]: what the papers claim, measured.
//! - [`mod@front`]: what nothing else is both faster and nearer to the truth than.
//! - [`plan`]: the cheapest within a budget.
//! - [`mod@report`]: a study as files.
//! - [`mod@run`]: candidates measured and timed.
//! - [`spread`]: how evenly prefixes of several orders are spread \[BJFM19, Fig. 3\].
//! - [`sweep`]: what a study of a scene tries.
//! - [`mod@truth`]: the true picture of a scene.

pub mod atlas;
pub mod chart;
pub mod claims;
pub mod front;
pub mod plan;
pub mod report;
pub mod run;
pub mod spread;
pub mod sweep;
pub mod truth;
