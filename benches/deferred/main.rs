//! What \[GBP04\] claims and what it warns of: turns (Fig. 3), dense surfels (Fig. 4), frames a second
//! with and without selection (Table 1), and the time of each pass (Table 2, Fig. 6), and what ids of 40 bits cost (4.2).
//!
//! `cargo bench --bench deferred` prints Markdown tables, and with `--write` puts them into
//! `docs/gbp04.md` and draws its charts; an argument is a pattern that the names of scenes must contain.
//! The sections say what they measure: [`turn`], [`wrong`], [`dense`], [`rates`], [`ids`].

mod bars;
#[path = "../common/mod.rs"]
mod common;
mod dense;
mod flicker;
mod ids;
mod rates;
mod stage;
mod subjects;
mod turn;
mod wrong;

use common::order;
use common::report::Arguments;
use splatref::Result;
use splatref::frame::Exec;

fn main() -> Result<()> {
    let (arguments, exec) = (Arguments::parse()?, Exec::new(2, 32)?);
    turn::tables(&arguments, &exec)?;
    dense::table(&arguments, &exec)?;
    rates::tables(&arguments, &exec)?;
    ids::table(&arguments, &exec)
}
