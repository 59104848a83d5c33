//! The fields of the records that are wrong, where the client hands its records in.

use super::depths::digits;
use super::{Case, Likely};
use crate::error::Result;
use crate::verdict::ewa::WrongField;

/// The name of a mistake, with the fields of the records that are wrong.
pub(super) fn with(case: &Case<'_, '_>, said: Option<Likely>) -> Result<Option<Likely>> {
    if case.wrong.stage != "projection" {
        return Ok(said);
    }
    let fields = case.session.wrong_fields(case.camera, case.client)?;
    let Some(most) = fields.iter().map(|field| field.wrong).max() else { return Ok(said) };
    // A number beside a wrong one may be wrong in a few records.
    let named = fields.iter().filter(|field| 20 * field.wrong >= most);
    let fields: Vec<String> = named.map(in_words).collect();
    let fields = format!("wrong in the records: {}", fields.join(", "));
    Ok(Some(match said {
        None => fields.into(),
        Some(said) => Likely { words: format!("{}; {fields}", said.words), ..said },
    }))
}

/// A field in words.
fn in_words(field: &WrongField) -> String {
    let WrongField { name, wrong, times } = field;
    match times.map(digits) {
        Some(times) => format!("{name} of {wrong} surfels, {times} times what is right"),
        None => format!("{name} of {wrong} surfels"),
    }
}
