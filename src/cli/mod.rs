//! The command line: arguments become library calls, results become an exit code.
//!
//! Each command has a file. Results go to stdout. An error is one line on stderr. The exit code is
//! 2 for wrong usage, and 1 for everything else, pictures that differ included. `verify` has exit
//! codes of its own.

mod assemble;
mod atlas;
mod bands;
mod camera;
mod claims;
mod compare;
mod conformance;
mod convert;
mod destination;
mod draw;
mod ending;
mod explain;
mod golden;
mod group;
mod hierarchy;
mod info;
mod interrupt;
mod memory;
mod options;
mod output;
mod plan;
mod progress;
mod project;
mod quality;
mod region;
mod render;
mod report;
mod rows;
mod sequence;
mod stdout;
mod study;
mod suite;
mod surfels;
mod tile;
mod tried;
mod verify;
mod walk;
mod words;

use clap::builder::Resettable;
use clap::error::ErrorKind;
use clap::{ArgMatches, FromArgMatches, Parser, Subcommand};
use ending::{Ended, Ending};
use splatref::Error;
use splatref::scene::Cloud;
use std::ffi::OsStr;
use std::fmt::Display;
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;
use stdout::{printed, say};

/// The ground truth for point-splatting renderers
#[derive(Parser)]
#[command(version, arg_required_else_help = false, after_help = EXAMPLES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    /// Use at most this much memory, such as 2G [default: three quarters of what
    /// the machine, the container and `ulimit` allow]
    #[arg(long, global = true, value_name = "BYTES", value_parser = memory::bytes)]
    memory: Option<u64>,
}

const EXAMPLES: &str = "\
Examples:
  splatref render                              render a procedural scene into out/
  splatref render bunny.ply --outline raycast  render a scan; the camera frames it
  splatref compare a.exr b.exr                 compare two pictures; exit code 0 if equal
  splatref verify bunny.ply gpu.exr            check what another renderer drew
  splatref explain bunny.ply 512 400           print how this pixel got its value

Exit codes: 0 success, 1 different or failed, 2 wrong usage; of verify, suite and conformance also
3 undecidable, 4 right, but unlike any right renderer.";

#[derive(Subcommand)]
enum Command {
    /// Render a scene into an EXR with every plane and a PNG
    Render(Late<render::Args>),
    /// Join the parts of a picture that `render --region` wrote
    Assemble(Late<assemble::Args>),
    /// Store the surfels of a scene in spatial order, to draw scenes larger than memory
    Tile(Late<tile::Args>),
    /// Check that the pictures under golden/ are reproduced, bit for bit
    Golden(Late<golden::Args>),
    /// Compare two pictures, plane by plane: EXR, PNG or NPY
    Compare(Late<compare::Args>),
    /// Judge the planes of another renderer, stage by stage
    Verify(Late<verify::Args>),
    /// Run a renderer on the suite of a method: a scene and a verdict for each rule
    Conformance(Late<conformance::Args>),
    /// Pool the verdicts of several scenes, to find thresholds that are slightly wrong
    Suite(Late<suite::Args>),
    /// Print every decision at one pixel
    Explain(Late<explain::Args>),
    /// Divide a scene into groups of splats that do not overlap, and write a PLY
    Group(Late<group::Args>),
    /// Order points so that every prefix covers the surface, for a model or a whole scene
    Surfels(Late<surfels::Args>),
    /// Chart the speed and the accuracy of every method and setting for a scene
    Study(Late<study::Args>),
    /// Choose the fastest method and settings within an error, or the most accurate within a time
    Plan(Late<plan::Args>),
    /// Measure how evenly the prefixes of ordered points cover the surface, with a chart
    Quality(Late<quality::Args>),
    /// Write the visible splats as records for a backend to upload
    Project(Late<project::Args>),
    /// Convert 3D Gaussians to PLY or GLB, from these, a .splat or an .spz
    Convert(Late<convert::Args>),
    /// Describe a model, a scene file, an EXR or a folder of surfels
    Info(Late<info::Args>),
}

/// Arguments that are described only if their command is run: to describe those of all commands takes
/// as long as to start the program.
struct Late<A>(A);

impl<A: clap::Args> clap::Args for Late<A> {
    fn augment_args(command: clap::Command) -> clap::Command {
        command.defer(|command| named(command, A::augment_args))
    }

    fn augment_args_for_update(command: clap::Command) -> clap::Command {
        command.defer(|command| named(command, A::augment_args_for_update))
    }
}

/// Describes arguments; what they say about themselves does not replace what the command says.
fn named(command: clap::Command, describe: fn(clap::Command) -> clap::Command) -> clap::Command {
    let [about, long] = [command.get_about(), command.get_long_about()].map(|text| text.cloned());
    describe(command).about(Resettable::from(about)).long_about(Resettable::from(long))
}

impl<A: FromArgMatches> FromArgMatches for Late<A> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        A::from_arg_matches(matches).map(Self)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        self.0.update_from_arg_matches(matches)
    }
}

/// Runs the program.
pub(crate) fn run() -> ExitCode {
    if let Some(argument) = std::env::args_os().skip(1).find(|argument| is_dash(argument)) {
        let argument = argument.to_string_lossy();
        complain(format!(
            "{argument}: `-` stands for neither standard input nor standard output here; give the \
             name of a file, or ./- for a file with the name -"
        ));
        return ExitCode::from(2);
    }
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return usage(&error),
    };
    interrupt::watch();
    memory::limit(cli.memory);
    let outcome = match cli.command {
        Command::Render(Late(args)) => render::run(&args),
        Command::Assemble(Late(args)) => assemble::run(&args),
        Command::Tile(Late(args)) => tile::run(&args),
        Command::Golden(Late(args)) => golden::run(&args),
        Command::Compare(Late(args)) => compare::run(&args),
        Command::Verify(Late(args)) => verify::run(&args),
        Command::Conformance(Late(args)) => conformance::run(&args),
        Command::Suite(Late(args)) => suite::run(&args),
        Command::Explain(Late(args)) => explain::run(&args),
        Command::Group(Late(args)) => group::run(&args),
        Command::Surfels(Late(args)) => surfels::run(&args),
        Command::Study(Late(args)) => study::run(&args),
        Command::Plan(Late(args)) => plan::run(&args),
        Command::Quality(Late(args)) => quality::run(&args),
        Command::Project(Late(args)) => project::run(&args),
        Command::Convert(Late(args)) => convert::run(&args),
        Command::Info(Late(args)) => info::run(&args),
    };
    match outcome.and_then(|ending| printed().map(|()| ending)) {
        Ok(Ending::Good) => ExitCode::SUCCESS,
        Ok(Ending::Different) => ExitCode::FAILURE,
        Ok(Ending::Undecidable) => ExitCode::from(3),
        Ok(Ending::Unlike) => ExitCode::from(4),
        Err(error) => {
            complain(&error);
            ExitCode::from(error.exit_code())
        }
    }
}

/// Whether an argument is `-`, or gives it to an option: `-o-`, `--output=-`.
fn is_dash(argument: &OsStr) -> bool {
    match argument.as_encoded_bytes() {
        b"-" => true,
        [b'-', letter, b'-'] => letter.is_ascii_alphabetic(),
        [b'-', b'-', .., b'=', b'-'] => true,
        _ => false,
    }
}

/// Prints help and version unchanged, and an error of clap as one line.
fn usage(error: &clap::Error) -> ExitCode {
    let text = error.render().to_string();
    if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) {
        say(text.trim_end());
        return match printed() {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => {
                complain(&error);
                ExitCode::from(error.exit_code())
            }
        };
    }
    let what: Vec<&str> = text
        .lines()
        .map(str::trim)
        .take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more"))
        .filter(|line| !line.is_empty())
        .collect();
    let what = what.join(" ").replace(" tip: ", "; tip: ");
    complain(format!("{}; see --help", what.strip_prefix("error: ").unwrap_or(&what)));
    ExitCode::from(2)
}

/// Prints what is to be doubted about the files, one line each, on stderr.
fn warn(warnings: &[String]) {
    for what in warnings {
        complain(format!("warning: {what}"));
    }
}

/// Takes the warnings of a file's points, and prints them.
fn warn_of(path: &Path, cloud: &mut Cloud) {
    let all = std::mem::take(&mut cloud.warnings).into_iter();
    warn(&all.map(|what| Error::format(path, what).to_string()).collect::<Vec<_>>());
}

/// Prints an error as one line on stderr.
fn complain(error: impl Display) {
    let _ = writeln!(io::stderr(), "splatref: {}", words::line(&error.to_string()));
}
