//! Every test from outside the crate, in one binary: it is linked once, and what the tests share is
//! compiled once. `cargo test --release NAME` runs the tests whose path has NAME in it.
//!
//! - [`oracle`]: every method, stage by stage, against independent computations; laws; bits.
//! - [`verify`]: verdicts on a client that is no part of the crate.
//! - [`regions`]: parts of pictures have the bits of whole pictures.
//! - [`settings`], [`docs`], [`models`]: the rows of settings, the pages, real scans.
//! - [`rooms`]: no folder of `src/` imports a higher one.
//! - [`examples`]: the programs in `examples/` are short, and a page names each.
//! - [`deferred`], `blue`: where two methods fail, on the scenes of the benches.
//! - `cli`, `browser`: the program, and its pages in a real browser.
//!
//! `memory.rs` measures the memory of its own process, so it is a binary of its own.

mod deferred;
mod docs;
mod examples;
mod models;
mod oracle;
mod regions;
mod rooms;
mod settings;
mod verify;

#[cfg(feature = "cli")]
mod blue;
#[cfg(feature = "cli")]
mod browser;
#[cfg(feature = "cli")]
mod cli;
