//! Measurements: how even samplers are, and the speed and accuracy of methods.
//!
//! - [`mod@atlas`]: where each method breaks.
//! - [`chart`]: drawings, written as SVG and as PNG with the same content.
//! - [`mod@claims`]: the claims of the papers, measured.
//! - [`mod@front`]: the candidates that no other beats in both time and accuracy.
//! - [`plan`]: the best candidate within a budget.
//! - [`mod@report`]: the files of a study.
//! - [`mod@run`]: measures and times candidates.
//! - [`spread`]: how evenly the prefixes of several orders cover a surface \[BJFM19, Fig. 3\].
//! - [`sweep`]: the candidates of a study.
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
