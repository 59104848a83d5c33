//! Command-line options made from rows of settings.

use clap::{Arg, ArgMatches, Command};
use splatref::io::scene_file::{Choice, GroupChoice, MethodChoice, OutputSettings};
use splatref::method::Method;
use splatref::setting::{Fields, Setting, Value};
use std::marker::PhantomData;

/// Rows that become options.
pub(super) trait Rows {
    /// The settings, each with its owners.
    fn rows() -> Vec<Setting>;
    /// The help heading of a setting.
    fn heading(row: &Setting) -> String;
    /// Parses a text; `None` if no setting has this name.
    fn read(name: &str, text: &str) -> Option<Result<Value, String>>;
}

/// The settings of every method.
pub(super) struct OfMethods;

/// The settings of groups, for methods that draw groups.
pub(super) struct OfGroups;

/// The settings of groups without a method.
pub(super) struct OfGroupsAlone;

/// The arithmetic and the buffer formats of a picture.
pub(super) struct OfNumber;

/// What the files of a picture hold, and their compression.
pub(super) struct OfFiles;

/// The values that the options of some rows chose.
pub(super) struct RowOptions<R> {
    pub(super) chosen: Choice,
    rows: PhantomData<R>,
}

impl Rows for OfMethods {
    fn rows() -> Vec<Setting> {
        MethodChoice::rows()
    }

    fn heading(row: &Setting) -> String {
        let owners: Vec<&str> = row.owners.iter().map(|(owner, _)| *owner).collect();
        if owners.len() == Method::all().len() {
            return "Settings of every method".into();
        }
        format!("Settings of {}", owners.join(", "))
    }

    fn read(name: &str, text: &str) -> Option<Result<Value, String>> {
        Method::all().into_iter().find_map(|method| method.read(name, text))
    }
}

impl Rows for OfGroups {
    fn rows() -> Vec<Setting> {
        GroupChoice::rows()
    }

    fn heading(row: &Setting) -> String {
        let owners: Vec<&str> = row.owners.iter().map(|(owner, _)| *owner).collect();
        format!("Groups of {}", owners.join(", "))
    }

    fn read(name: &str, text: &str) -> Option<Result<Value, String>> {
        GroupChoice::ALONE.read(name, text)
    }
}

impl Rows for OfGroupsAlone {
    fn rows() -> Vec<Setting> {
        Setting::of([("", GroupChoice::ALONE)])
    }

    fn heading(_: &Setting) -> String {
        "Groups".into()
    }

    fn read(name: &str, text: &str) -> Option<Result<Value, String>> {
        OfGroups::read(name, text)
    }
}

impl Rows for OfNumber {
    fn rows() -> Vec<Setting> {
        OutputSettings::rows().into_iter().filter(|row| is_of_picture(row.name)).collect()
    }

    fn heading(_: &Setting) -> String {
        "Output".into()
    }

    fn read(name: &str, text: &str) -> Option<Result<Value, String>> {
        OutputSettings::default().read(name, text)
    }
}

impl Rows for OfFiles {
    fn rows() -> Vec<Setting> {
        OutputSettings::rows().into_iter().filter(|row| !is_of_picture(row.name)).collect()
    }

    fn heading(row: &Setting) -> String {
        OfNumber::heading(row)
    }

    fn read(name: &str, text: &str) -> Option<Result<Value, String>> {
        OfNumber::read(name, text)
    }
}

/// Whether a setting of the output may change numbers of a picture.
fn is_of_picture(name: &str) -> bool {
    ["number", "storage", "depth_storage"].contains(&name)
}

/// The command-line option of a row.
fn option<R: Rows>(row: &Setting) -> Arg {
    let name = row.name;
    let default = match row.default_text(Value::text) {
        default if default.is_empty() => default,
        default => format!(" [default: {default}]"),
    };
    let mut help = format!("{}{default}", row.description());
    help[..1].make_ascii_uppercase();
    let option = Arg::new(row.option.clone())
        .long(row.option.clone())
        .value_name(row.form.clone())
        .help(help)
        .help_heading(R::heading(row))
        .value_parser(move |text: &str| R::read(name, text).unwrap_or_else(|| Err(name.into())));
    if row.is_switch() {
        // The option without a value turns the setting on.
        option.num_args(0..=1).require_equals(true).default_missing_value("on")
    } else {
        option.allow_hyphen_values(true)
    }
}

impl<R: Rows> clap::Args for RowOptions<R> {
    fn augment_args(command: Command) -> Command {
        command.args(R::rows().iter().map(option::<R>))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl<R: Rows> clap::FromArgMatches for RowOptions<R> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut chosen = Choice::default();
        for row in R::rows() {
            if let Some(value) = matches.get_one::<Value>(&row.option) {
                chosen.push(row.name, value.clone());
            }
        }
        Ok(Self { chosen, rows: PhantomData })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}
