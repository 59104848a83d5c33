//! The program `splatref`.
fn main() {}
