//! One row a setting.
//!
//! A type of settings implements [`Fields`]: it lists a [`Field`] for each of its settings, with
//! name, unit, range, help and typed access. Scene files, the command line, the text in a picture,
//! reports and the reference of the scene format all follow from these rows; a default is what the
//! default of the type holds, and a method has a setting if its settings list the row.
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

/// A setting: its row, and access to its value.
#[derive(Debug)]
pub struct Field<'a> {
    /// The key in scene files; with `-` for `_` the name on the command line.
    pub name: &'static str,
    /// The name on the command line where that is another.
    pub option: Option<&'static str>,
    /// The unit of the value; empty for what has none.
    pub unit: &'static str,
    /// The values that are allowed: `0 to 16`, `above 0 to 4` or `3, 5 or 7`; empty if all that the
    /// slot can hold are.
    pub range: &'static str,
    /// What the setting says, beginning in lower case, without a full stop.
    pub help: &'static str,
    /// Why the setting means nothing as the other settings stand, such as `without a refraction`.
    pub idle: Option<&'static str>,
    /// The value.
    pub slot: Slot<'a>,
}

/// What is told of each field.
pub type Visit<'v> = dyn FnMut(Field<'_>) + 'v;

/// Why a value was not taken.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Refused {
    /// There is no setting of this name.
    Unknown,
    /// The setting means nothing as the others stand, and why.
    Idle(&'static str),
    /// The value is of another type, or a word that is none: one line that says what to give.
    Wrong(String),
}

/// Settings that list their rows.
pub trait Fields: Copy {
    /// Calls `each` for every setting, in an order in which settings can be set one after another:
    /// a preset before its parts, and what makes another setting meaningful before the other.
    fn fields(&mut self, each: &mut Visit<'_>);

    /// Names and values, in the order of the rows; what means nothing as things stand is left out,
    /// and so are presets, whose parts have rows.
    #[must_use]
    fn values(mut self) -> Vec<(&'static str, Value)> {
        let mut values = Vec::new();
        self.fields(&mut |field| {
            let value = field.slot.get().filter(|_| field.idle.is_none());
            values.extend(value.map(|value| (field.name, value)));
        });
        values
    }

    /// Sets one setting. Whether the value is in range is not checked.
    ///
    /// # Errors
    /// [`Refused`] if there is no such setting, if the setting means nothing as the others stand,
    /// or if the value is of another type.
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

    /// The value that a text stands for on the command line; none if no setting has this name.
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
    /// A row without unit and range.
    #[must_use]
    pub fn new(name: &'static str, help: &'static str, slot: Slot<'a>) -> Self {
        Self { name, option: None, unit: "", range: "", help, idle: None, slot }
    }

    /// The row with another name on the command line.
    #[must_use]
    pub fn option(self, option: &'static str) -> Self {
        Self { option: Some(option), ..self }
    }

    /// The row with a unit.
    #[must_use]
    pub fn unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }

    /// The row with a range.
    #[must_use]
    pub fn range(self, range: &'static str) -> Self {
        Self { range, ..self }
    }

    /// The row of a setting that means nothing as things stand.
    #[must_use]
    pub fn idle(self, why: &'static str) -> Self {
        Self { idle: Some(why), ..self }
    }
}
