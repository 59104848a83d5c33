//! Tests the verifier on a client that is no part of the crate.
//!
//! - [`client`]: a second implementation of the method `ewa`, from the pages of the crate alone.
//! - [`client_is_right`]: its plain picture is the crate's, and its bugs can be seen.
//! - [`cases`]: the scenes.
//! - [`conformance`]: the suite of small scenes, as files and as tests of `cargo test`.
//! - [`empty_pixels`]: one wrong bit in an empty pixel is found, in every plane of every method.
//! - [`matrix`], [`matrix_of_causes`]: the page of what verdicts find, and how they name it.
//! - [`verdicts`]: no lawful habit is called wrong, and every bug is found.
//! - [`ladder`]: scenes whose decisions lie close to their limits.
//! - [`nodes`]: a hierarchy whose choices lie close to their limits, and clients that make these
//!   choices.
//! - [`own_pictures`]: no verdict accuses the crate, whatever the settings are.
//! - [`shares`]: no share of pixels is above 100 %.
//! - [`suite`]: a slightly wrong limit that leans decisions to one side, over several scenes.
//! - [`unjudged`]: no verdict passes a value that it did not judge.
//! - [`gaussians`]: the same tests for the method `gaussians`.
//! - [`groups`]: the same tests for the method `single-pass`.
//! - [`image_space`]: the same tests for the methods `template` and `pyramid`.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod cases;
mod client;
mod client_is_right;
#[cfg(feature = "cli")]
mod conformance;
mod empty_pixels;
mod gaussians;
mod groups;
mod image_space;
mod ladder;
mod matrix;
mod matrix_of_causes;
mod nodes;
mod own_pictures;
mod shares;
mod suite;
mod unjudged;
mod verdicts;
