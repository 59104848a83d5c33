//! The program `splatref`: `splatref --help` tells what it does.

mod cli;

fn main() -> std::process::ExitCode {
    cli::run()
}
