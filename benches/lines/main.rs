//! What \[MKC08\] shows in figures and never counts: lines beside triangles (Fig. 13 and 14), ten
//! trees (Fig. 19), the silhouette of a tube, and deferred shading (Fig. 5).
//!
//! `cargo bench --bench lines` prints Markdown tables, and with `--write` puts them into
//! `docs/image-space.md`; an argument is a pattern that the names of rows must contain. The tree is
//! [`splatref::source::plant::apple_tree`] with the paper's number of leaves, in its 552,000 triangles
//! and as the ribbons and tubes that stand for them.

#[path = "../common/mod.rs"]
mod common;
mod highlights;
mod speed;
mod tree;
mod tubes;

use common::report::Arguments;
use splatref::Result;
use splatref::frame::Exec;

fn main() -> Result<()> {
    let (arguments, exec) = (Arguments::parse()?, Exec::new(0, 32)?);
    tree::table(&arguments, &exec)?;
    speed::table(&arguments, &exec)?;
    tubes::table(&arguments, &exec)?;
    highlights::table(&arguments, &exec)
}
