//! The verifier, tried on a client that is no part of the crate.
//!
//! - [`client`]: a second implementation of the method `ewa`, from the pages of the crate alone.
//! - [`client_is_right`]: its plain picture is the crate's, and its bugs are to be seen.
//! - [`cases`]: the scenes.
//! - [`verdicts`]: no lawful habit is called wrong, and every bug is found.
//! - [`ladder`]: scenes whose decisions lie beside their limits.
//! - [`nodes`]: a hierarchy whose choices lie beside their limits, and clients that choose.
//! - [`suite`]: limits that lean, over several scenes.
//! - [`groups`]: the same of the method `single-pass`.
//! - [`image_space`]: the same of the methods `template` and `pyramid`.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod cases;
mod client;
mod client_is_right;
mod groups;
mod image_space;
mod ladder;
mod nodes;
mod suite;
mod verdicts;
