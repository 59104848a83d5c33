//! Settings: one row for each.
//!
//! You can set, read and describe every setting of a method by its name.
//!
//! A type of settings implements [`Fields`]: it lists a [`Field`] for each of its settings, with
//! name, unit, range, help and typed access. These rows feed scene files, the command line, the
//! text in a picture, reports and the reference of the scene format. The default of a setting is
//! the value in the `Default` of the type. A method has a setting if its settings list the row.
//!
//! ```
//! use splatref::method::Method;
//! use splatref::setting::{Fields, Value};
//!
//! let mut method = Method::by_name("template")?;
//! assert_eq!(method.set("template", &Value::Whole(7)), Ok(()));
//! let values = method.values();
//! assert!(values.contains(&("template", Value::Whole(7))));
//! assert!(values.contains(&("cull", Value::Switch(true))));
//! assert!(method.set("cutoff", &Value::Number(2.0)).is_err(), "splats have a cut-off");
//! # Ok::<(), splatref::Error>(())
//! ```

mod description;
mod slot;

pub use description::Setting;
pub(crate) use description::check_type;
pub use slot::{Slot, Value, Word, Words};

/// One setting: its description, and access to its value.
#[derive(Debug)]
pub struct Field<'a> {
    /// The key in scene files. On the command line each `_` becomes `-`.
    pub name: &'static str,
    /// The name on the command line, if it is not the key.
    pub option: Option<&'static str>,
    /// The unit of the value; empty if it has none.
    pub unit: &'static str,
    /// The allowed values: `0 to 16`, `above 0 to 4` or `3, 5 or 7`; empty if every value of the
    /// slot is allowed.
    pub range: &'static str,
    /// What the setting does: begins with a verb in lower case, and has no full stop.
    pub help: &'static str,
    /// Why the setting has no effect beside the other settings, such as `without a refraction`.
    pub idle: Option<&'static str>,
    /// The value.
    pub slot: Slot<'a>,
}

/// A function that is called with each field.
pub type Visit<'v> = dyn FnMut(Field<'_>) + 'v;

/// Why a value was refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Refused {
    /// No setting has this name.
    Unknown,
    /// The setting has no effect beside the other settings, and why.
    Idle(&'static str),
    /// The value has the wrong type, or is an unknown word: one line that says what to give.
    Wrong(String),
}

/// A type of settings that lists its rows.
pub trait Fields: Copy {
    /// Calls `each` for every setting, in an order in which the settings can be set one after
    /// another: a preset before its parts, and a setting before those that only have an effect
    /// beside it.
    fn fields(&mut self, each: &mut Visit<'_>);

    /// Names and values, in the order of the rows. Settings without effect are left out. Presets
    /// are left out too, because their parts have rows.
    #[must_use]
    fn values(mut self) -> Vec<(&'static str, Value)> {
        let mut values = Vec::new();
        self.fields(&mut |field| {
            let value = field.slot.get().filter(|_| field.idle.is_none());
            values.extend(value.map(|value| (field.name, value)));
        });
        values
    }

    /// Sets one setting. The range is not checked.
    ///
    /// # Errors
    /// [`Refused`] if no setting has this name, if the setting has no effect beside the others, or
    /// if the value has the wrong type.
    fn set(&mut self, name: &str, value: &Value) -> Result<(), Refused> {
        let mut found = Err(Refused::Unknown);
        self.fields(&mut |mut field| {
            if field.name == name {
                found = field.slot.set(field.name, value).map_err(Refused::Wrong);
                if let (Ok(()), Some(why)) = (&found, field.idle) {
                    found = Err(Refused::Idle(why));
                }
            }
        });
        found
    }

    /// Parses a text of the command line; `None` if no setting has this name.
    ///
    /// # Errors
    /// One line that says what to give.
    fn read(mut self, name: &str, text: &str) -> Option<Result<Value, String>> {
        let mut found = None;
        self.fields(&mut |mut field| {
            if field.name == name {
                found = Some(field.slot.read(field.name, text));
            }
        });
        found
    }
}

impl<'a> Field<'a> {
    /// A row without unit or range.
    #[must_use]
    pub fn new(name: &'static str, help: &'static str, slot: Slot<'a>) -> Self {
        Self { name, option: None, unit: "", range: "", help, idle: None, slot }
    }

    /// Gives the row another name on the command line.
    #[must_use]
    pub fn option(self, option: &'static str) -> Self {
        Self { option: Some(option), ..self }
    }

    /// Gives the row a unit.
    #[must_use]
    pub fn unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }

    /// Gives the row a range.
    #[must_use]
    pub fn range(self, range: &'static str) -> Self {
        Self { range, ..self }
    }

    /// Marks the setting as having no effect beside the other settings, and says why.
    #[must_use]
    pub fn idle(self, why: &'static str) -> Self {
        Self { idle: Some(why), ..self }
    }
}
