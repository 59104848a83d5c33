//! Descriptions of settings, for help texts and the reference of the scene format.

use super::{Fields, Refused, Value};

/// A setting as its row describes it, with its owners.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// See [`super::Field::name`].
    pub name: &'static str,
    /// The name on the command line, without the leading dashes.
    pub option: String,
    /// See [`super::Field::unit`].
    pub unit: &'static str,
    /// See [`super::Field::range`].
    pub range: &'static str,
    /// See [`super::Field::help`].
    pub help: &'static str,
    /// See [`super::Slot::form`].
    pub form: String,
    /// See [`super::Slot::words`].
    pub words: Vec<&'static str>,
    /// Each owner of the setting, and the default there; presets have no default.
    pub owners: Vec<(&'static str, Option<Value>)>,
}

impl Setting {
    /// Collects the settings of several owners from their names and defaults. Each setting is
    /// listed once, in the order in which the owners list it.
    #[must_use]
    pub fn of<F: Fields>(owners: impl IntoIterator<Item = (&'static str, F)>) -> Vec<Self> {
        let mut all: Vec<Self> = Vec::new();
        for (owner, mut default) in owners {
            default.fields(&mut |field| {
                let owned = (owner, field.slot.get());
                if let Some(known) = all.iter_mut().find(|setting| setting.name == field.name) {
                    known.owners.push(owned);
                    return;
                }
                all.push(Self {
                    name: field.name,
                    option: field.option.unwrap_or(field.name).replace('_', "-"),
                    unit: field.unit,
                    range: field.range,
                    help: field.help,
                    form: field.slot.form(),
                    words: field.slot.words(),
                    owners: vec![owned],
                });
            });
        }
        // A preset of one owner sets rows that another owner lists before it.
        all.sort_by_key(|setting| !setting.is_preset());
        all
    }

    /// Whether the setting sets others.
    fn is_preset(&self) -> bool {
        self.owners.iter().all(|(_, default)| default.is_none())
    }

    /// Whether the setting is a switch, on or off.
    #[must_use]
    pub fn is_switch(&self) -> bool {
        self.owners.iter().all(|(_, default)| matches!(default, Some(Value::Switch(_))))
    }

    /// The help text, the unit and the range.
    #[must_use]
    pub fn description(&self) -> String {
        let unit = if self.unit.is_empty() { String::new() } else { format!(", in {}", self.unit) };
        let range =
            if self.range.is_empty() { String::new() } else { format!(" ({})", self.range) };
        format!("{}{unit}{range}", self.help)
    }

    /// The default, written by `show`, followed by each different default and its owners; empty for
    /// a preset.
    #[must_use]
    pub fn default_text(&self, show: impl Fn(&Value) -> String) -> String {
        let mut defaults: Vec<(&Value, Vec<&str>)> = Vec::new();
        for (owner, value) in &self.owners {
            let Some(value) = value else { continue };
            match defaults.iter_mut().find(|(known, _)| *known == value) {
                Some((_, owners)) => owners.push(owner),
                None => defaults.push((value, vec![owner])),
            }
        }
        let of = |(i, (value, owners)): (usize, &(&Value, Vec<&str>))| match i {
            0 => show(value),
            _ => format!("{} for {}", show(value), owners.join(", ")),
        };
        defaults.iter().enumerate().map(of).collect::<Vec<_>>().join("; ")
    }
}

/// Checks that a value has the type that the setting has in one of the owners. The range is not
/// checked.
///
/// # Errors
/// One line that says what to give.
pub(crate) fn check_type<F: Fields>(
    owners: impl IntoIterator<Item = F>,
    name: &str,
    value: &Value,
) -> Result<(), String> {
    for mut owner in owners {
        match owner.set(name, value) {
            Err(Refused::Unknown) => {}
            Err(Refused::Wrong(what)) => return Err(what),
            Ok(()) | Err(Refused::Idle(_)) => return Ok(()),
        }
    }
    Ok(())
}
