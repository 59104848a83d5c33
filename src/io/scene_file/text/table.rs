//! Parse and write tables whose keys are rows of settings.

use super::super::{Choice, GroupChoice, MethodChoice, OutputSettings};
use crate::method::{Method, transparent};
use crate::setting::{Setting, Value, check_type};
use serde::de::{self, DeserializeSeed, Deserializer, MapAccess, SeqAccess, Visitor};
use serde::ser::{Serialize, SerializeMap, Serializer};
use std::fmt;

/// The key for the name of a method.
const NAME: &str = "name";

/// The keys of a table, and the types of their values.
struct Table {
    rows: Vec<Setting>,
    /// Whether the table has [`NAME`] too.
    named: bool,
    check: fn(&str, &Value) -> Result<(), String>,
}

pub(super) fn method<'de, D: Deserializer<'de>>(from: D) -> Result<MethodChoice, D::Error> {
    let check = |key: &str, value: &Value| check_type(Method::all(), key, value);
    let table = Table { rows: MethodChoice::rows(), named: true, check };
    let (name, settings) = from.deserialize_map(&table)?;
    let choice = MethodChoice { name, settings };
    choice.method().map_err(de::Error::custom)?;
    Ok(choice)
}

/// Groups of a scene file may be for any method, and ranges are the same for every method. They are
/// checked on top of the defaults of transparency, where `most` means something.
pub(super) fn groups<'de, D: Deserializer<'de>>(from: D) -> Result<GroupChoice, D::Error> {
    let check = |key: &str, value: &Value| check_type([GroupChoice::ALONE], key, value);
    let table = Table { rows: GroupChoice::rows(), named: false, check };
    let choice = GroupChoice { settings: from.deserialize_map(&table)?.1 };
    choice.grouping(transparent::GROUPING).map_err(de::Error::custom)?;
    Ok(choice)
}

pub(super) fn output<'de, D: Deserializer<'de>>(from: D) -> Result<OutputSettings, D::Error> {
    let check = |key: &str, value: &Value| check_type([OutputSettings::default()], key, value);
    let table = Table { rows: OutputSettings::rows(), named: false, check };
    let (_, settings) = from.deserialize_map(&table)?;
    settings.on(OutputSettings::default(), "the output").map_err(de::Error::custom)
}

/// A table to write.
pub(super) struct Written {
    /// The value of [`NAME`], if there is one.
    pub(super) name: Option<&'static str>,
    /// Keys and values.
    pub(super) settings: Vec<(&'static str, Value)>,
}

impl Serialize for Written {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let mut map = to.serialize_map(None)?;
        if let Some(name) = self.name {
            map.serialize_entry(NAME, name)?;
        }
        self.settings.iter().try_for_each(|(key, value)| map.serialize_entry(key, value))?;
        map.end()
    }
}

impl Serialize for Value {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Whole(number) => to.serialize_i64(*number),
            Self::Number(number) => to.serialize_f32(*number),
            Self::Switch(on) => to.serialize_bool(*on),
            Self::Text(text) => to.serialize_str(text),
            Self::Numbers(numbers) => to.collect_seq(numbers),
            Self::Parts(parts) => to.collect_map(parts.iter().map(|(name, number)| (name, number))),
        }
    }
}

impl<'de> Visitor<'de> for &Table {
    type Value = (Option<&'static str>, Choice);

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a table")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut name = None;
        let mut chosen = Vec::new();
        while let Some(key) = map.next_key_seed(SettingKey(self))? {
            match key {
                None => name = Some(map.next_value_seed(MethodName)?),
                Some(row) => chosen.push((row, map.next_value_seed(Typed(self, row))?)),
            }
        }
        // Sort into the order in which settings can be set.
        chosen.sort_by_key(|(row, _)| *row);
        let mut choice = Choice::default();
        chosen.into_iter().for_each(|(row, value)| choice.push(self.rows[row].name, value));
        Ok((name, choice))
    }
}

/// A key: a row, or `None` for [`NAME`].
struct SettingKey<'t>(&'t Table);

impl<'de> DeserializeSeed<'de> for SettingKey<'_> {
    type Value = Option<usize>;

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<Self::Value, D::Error> {
        let key = <String as de::Deserialize>::deserialize(from)?;
        if self.0.named && key == NAME {
            return Ok(None);
        }
        self.0.rows.iter().position(|row| row.name == key).map(Some).ok_or_else(|| {
            let name = self.0.named.then_some(NAME).into_iter();
            let known: Vec<_> = name.chain(self.0.rows.iter().map(|row| row.name)).collect();
            de::Error::custom(format!("unknown key `{key}`; the keys are {}", known.join(", ")))
        })
    }
}

/// The name of a method.
struct MethodName;

impl<'de> DeserializeSeed<'de> for MethodName {
    type Value = &'static str;

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<Self::Value, D::Error> {
        let name = <String as de::Deserialize>::deserialize(from)?;
        Method::by_name(&name).map(|method| method.name()).map_err(de::Error::custom)
    }
}

/// The value of a row.
struct Typed<'t>(&'t Table, usize);

impl<'de> DeserializeSeed<'de> for Typed<'_> {
    type Value = Value;

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<Value, D::Error> {
        let Self(table, row) = self;
        let value = from.deserialize_any(AnyValue)?;
        (table.check)(table.rows[row].name, &value).map_err(de::Error::custom)?;
        Ok(value)
    }
}

/// Any type that a value may have.
struct AnyValue;

impl<'de> Visitor<'de> for AnyValue {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number, a text, true or false, an array of numbers, or numbers with names")
    }

    fn visit_bool<E>(self, on: bool) -> Result<Value, E> {
        Ok(Value::Switch(on))
    }

    fn visit_i64<E>(self, number: i64) -> Result<Value, E> {
        Ok(Value::Whole(number))
    }

    fn visit_f64<E>(self, number: f64) -> Result<Value, E> {
        Ok(Value::Number(number as f32))
    }

    fn visit_str<E>(self, text: &str) -> Result<Value, E> {
        Ok(Value::Text(text.into()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut array: A) -> Result<Value, A::Error> {
        let mut numbers = Vec::new();
        while let Some(number) = array.next_element()? {
            numbers.push(number);
        }
        Ok(Value::Numbers(numbers))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut table: A) -> Result<Value, A::Error> {
        let mut parts = Vec::new();
        while let Some(part) = table.next_entry()? {
            parts.push(part);
        }
        Ok(Value::Parts(parts))
    }
}
