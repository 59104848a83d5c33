//! Typed access to the value of a setting, and values without a setting.

use std::fmt;
use std::mem::discriminant;

/// A value of a setting.
///
/// [`fmt::Display`] writes it as TOML, [`Value::text`] as on the command line.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A whole number.
    Whole(i64),
    /// A number.
    Number(f32),
    /// True or false; on or off.
    Switch(bool),
    /// A word, or a number with a unit.
    Text(String),
    /// Several numbers.
    Numbers(Vec<f32>),
    /// Several named numbers.
    Parts(Vec<(String, f32)>),
}

/// A type whose values have names: the choices of an enum, or the presets of a type.
pub trait Words: Copy + 'static {
    /// Every word with its value.
    const WORDS: &'static [(&'static str, Self)];

    /// The value that a word names.
    fn named(word: &str) -> Option<Self> {
        Self::WORDS.iter().find(|(known, _)| *known == word).map(|(_, value)| *value)
    }

    /// Whether two values have the same word. By default only the variants of an enum count, not
    /// their fields.
    fn is(&self, other: &Self) -> bool {
        discriminant(self) == discriminant(other)
    }
}

/// Object-safe access to a value that is one of several words; every type with [`Words`] has it.
pub trait Word {
    /// All the words.
    fn words(&self) -> Vec<&'static str>;
    /// The word of the value; empty if it has none.
    fn word(&self) -> &'static str;
    /// Sets the value that the word names, and returns whether there is such a word. A value that
    /// already has the word is not changed.
    fn choose(&mut self, word: &str) -> bool;
}

impl<T: Words> Word for T {
    fn words(&self) -> Vec<&'static str> {
        T::WORDS.iter().map(|(word, _)| *word).collect()
    }

    fn word(&self) -> &'static str {
        T::WORDS.iter().find(|(_, value)| self.is(value)).map_or("", |(word, _)| word)
    }

    fn choose(&mut self, word: &str) -> bool {
        let found = T::named(word);
        if let Some(value) = found.filter(|value| !self.is(value)) {
            *self = value;
        }
        found.is_some()
    }
}

/// Typed access to the value of a setting.
pub enum Slot<'a> {
    /// A number.
    Number(&'a mut f32),
    /// A whole number >= 0.
    Count(&'a mut u32),
    /// A whole number >= 0, or a word instead.
    CountOr(&'a mut Option<u32>, &'static str),
    /// On or off.
    Switch(&'a mut bool),
    /// One of several words.
    Word(&'a mut dyn Word),
    /// A word that sets several other settings. Those are printed, not the word.
    Preset(&'a mut dyn Word),
    /// A depth: the number, and whether its unit is the median radius instead of the world unit.
    Depth(&'a mut f32, &'a mut bool),
    /// Three numbers, one number for all three, or `none`.
    Ratios(&'a mut Option<[f32; 3]>),
    /// Three named numbers, or `none`.
    Parts(&'a mut Option<[f32; 3]>, [&'static str; 3]),
}

/// The word for an optional value that is absent.
const NONE: &str = "none";

impl Slot<'_> {
    /// The value; `None` for a preset.
    #[must_use]
    pub fn get(&self) -> Option<Value> {
        let none = || Value::Text(NONE.into());
        Some(match self {
            Self::Preset(_) => return None,
            Self::Number(value) => Value::Number(**value),
            Self::Count(value) => Value::Whole((**value).into()),
            Self::CountOr(value, word) => value
                .map_or_else(|| Value::Text((*word).into()), |count| Value::Whole(count.into())),
            Self::Switch(value) => Value::Switch(**value),
            Self::Word(word) => Value::Text(word.word().into()),
            Self::Depth(value, true) => Value::Text(format!("{value}r")),
            Self::Depth(value, false) => Value::Text(value.to_string()),
            Self::Ratios(values) => values.map_or_else(none, |v| Value::Numbers(v.to_vec())),
            Self::Parts(values, names) => values.map_or_else(none, |values| {
                Value::Parts(names.iter().map(|name| (*name).into()).zip(values).collect())
            }),
        })
    }

    /// Sets the value; `name` is the setting's name, for the error.
    ///
    /// # Errors
    /// One line that says what to give.
    pub fn set(&mut self, name: &str, value: &Value) -> Result<(), String> {
        let taken = match (&mut *self, value) {
            (Self::Number(to), Value::Number(number)) => put(*to, Some(*number)),
            (Self::Number(to), Value::Whole(number)) => put(*to, Some(*number as f32)),
            (Self::Count(to), Value::Whole(number)) => put(*to, u32::try_from(*number).ok()),
            (Self::CountOr(to, _), Value::Whole(number)) => {
                put(*to, u32::try_from(*number).ok().map(Some))
            }
            (Self::CountOr(to, word), Value::Text(text)) => {
                put(*to, (text == word).then_some(None))
            }
            (Self::Switch(to), Value::Switch(on)) => put(*to, Some(*on)),
            (Self::Word(to) | Self::Preset(to), Value::Text(word)) => to.choose(word),
            (Self::Depth(to, in_radii), value) => {
                let found = depth(value);
                put(*in_radii, found.map(|(_, radii)| radii)) && put(*to, found.map(|(t, _)| t))
            }
            (Self::Ratios(to), Value::Numbers(numbers)) => {
                put(*to, <[f32; 3]>::try_from(numbers.as_slice()).ok().map(Some))
            }
            (Self::Parts(to, names), Value::Parts(parts)) => {
                put(*to, three(names, parts).map(Some))
            }
            (Self::Ratios(to) | Self::Parts(to, _), Value::Text(text)) => {
                put(*to, (text == NONE).then_some(None))
            }
            _ => false,
        };
        if taken { Ok(()) } else { Err(self.wanted(name, &value.text())) }
    }

    /// Parses a text of the command line; see [`Value::text`].
    ///
    /// # Errors
    /// One line that says what to give.
    pub fn read(&mut self, name: &str, text: &str) -> Result<Value, String> {
        let numbers: Option<Vec<f32>> = text.split(',').map(|v| v.trim().parse().ok()).collect();
        let value = match (&*self, numbers.as_deref()) {
            (Self::Number(_), Some(&[number])) => Value::Number(number),
            (Self::Ratios(_), Some(&[all])) => Value::Numbers(vec![all; 3]),
            (Self::Ratios(_), Some(numbers)) => Value::Numbers(numbers.to_vec()),
            (Self::Parts(_, names), Some(numbers)) if numbers.len() == names.len() => {
                let names = names.iter().map(|name| (*name).to_owned());
                Value::Parts(names.zip(numbers.iter().copied()).collect())
            }
            (Self::Switch(_), _) if text == "on" || text == "off" => Value::Switch(text == "on"),
            (Self::Count(_) | Self::CountOr(..), _) => {
                text.parse().map_or_else(|_| Value::Text(text.into()), Value::Whole)
            }
            _ => Value::Text(text.into()),
        };
        self.set(name, &value).map(|()| value)
    }

    /// How help writes the value on the command line: its words, or a letter for a number.
    #[must_use]
    pub fn form(&self) -> String {
        match self {
            Self::Number(_) => "X".into(),
            Self::Count(_) => "N".into(),
            Self::CountOr(_, word) => format!("N|{word}"),
            Self::Switch(_) => "on|off".into(),
            Self::Word(word) | Self::Preset(word) => word.words().join("|"),
            Self::Depth(..) => "DEPTH".into(),
            Self::Ratios(_) => format!("R,G,B|{NONE}"),
            Self::Parts(_, names) => format!("{}|{NONE}", names.join(",").to_uppercase()),
        }
    }

    /// The words that the value can be.
    #[must_use]
    pub fn words(&self) -> Vec<&'static str> {
        match self {
            Self::CountOr(_, word) => vec![word],
            Self::Word(word) | Self::Preset(word) => word.words(),
            Self::Ratios(_) | Self::Parts(..) => vec![NONE],
            Self::Number(_) | Self::Count(_) | Self::Switch(_) | Self::Depth(..) => vec![],
        }
    }

    /// The error for a text that is not a value.
    fn wanted(&self, name: &str, text: &str) -> String {
        let wanted = match self {
            Self::Number(_) => "a number".into(),
            Self::Count(_) => "a whole number from 0".into(),
            Self::CountOr(_, word) => format!("a whole number from 0, or {word}"),
            Self::Switch(_) => "true or false (on the command line: on or off)".into(),
            Self::Word(word) | Self::Preset(word) => format!("one of {}", word.words().join(", ")),
            Self::Depth(..) => "world units such as 0.25, median radii such as 1.5r, or inf".into(),
            Self::Ratios(_) => {
                format!(
                    "three numbers (on the command line: 0.66,0.67,0.68, or one for all), or {NONE}"
                )
            }
            Self::Parts(_, [a, b, c]) => {
                format!(
                    "{a}, {b} and {c} (on the command line: three numbers in this order), or {NONE}"
                )
            }
        };
        format!("{name} `{text}`; give {wanted}")
    }
}

impl fmt::Debug for Slot<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Slot({})", self.form())
    }
}

/// Stores `found`, and returns whether there was something.
fn put<T>(to: &mut T, found: Option<T>) -> bool {
    found.map(|value| *to = value).is_some()
}

/// Parses a depth, and whether it is in median radii: `0.25` is in world units, `1.5r` in median
/// radii. `inf` and `infr` are numbers too.
fn depth(value: &Value) -> Option<(f32, bool)> {
    match value {
        Value::Whole(number) => Some((*number as f32, false)),
        Value::Number(number) => Some((*number, false)),
        Value::Text(text) => {
            let (number, in_radii) = match text.strip_suffix('r') {
                Some(number) => (number, true),
                None => (text.as_str(), false),
            };
            number.trim().parse().ok().map(|number| (number, in_radii))
        }
        Value::Switch(_) | Value::Numbers(_) | Value::Parts(_) => None,
    }
}

/// The numbers of three names, if each name is given once.
fn three(names: &[&'static str; 3], parts: &[(String, f32)]) -> Option<[f32; 3]> {
    let of = |name: &str| parts.iter().find(|(given, _)| given == name).map(|(_, value)| *value);
    let [a, b, c] = names.map(of);
    if parts.len() == names.len() { Some([a?, b?, c?]) } else { None }
}

impl Value {
    /// The value as you write it on the command line.
    #[must_use]
    pub fn text(&self) -> String {
        let joined = |numbers: &mut dyn Iterator<Item = f32>| {
            numbers.map(|number| number.to_string()).collect::<Vec<_>>().join(",")
        };
        match self {
            Self::Whole(number) => number.to_string(),
            Self::Number(number) => number.to_string(),
            Self::Switch(on) => if *on { "on" } else { "off" }.into(),
            Self::Text(text) => text.clone(),
            Self::Numbers(numbers) => joined(&mut numbers.iter().copied()),
            Self::Parts(parts) => joined(&mut parts.iter().map(|(_, number)| *number)),
        }
    }
}

impl fmt::Display for Value {
    /// Writes TOML; floats are the shortest decimals that give the same `f32`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Whole(number) => write!(f, "{number}"),
            Self::Number(number) => write!(f, "{number:?}"),
            Self::Switch(on) => write!(f, "{on}"),
            Self::Text(text) => write!(f, "{text:?}"),
            Self::Numbers(numbers) => write!(f, "{numbers:?}"),
            Self::Parts(parts) => {
                let parts: Vec<_> =
                    parts.iter().map(|(name, number)| format!("{name} = {number:?}")).collect();
                write!(f, "{{ {} }}", parts.join(", "))
            }
        }
    }
}
