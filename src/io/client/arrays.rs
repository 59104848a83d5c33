//! Planes that are arrays in memory.

use super::Description;
use super::format::Format;
use super::numbers::Numbers;
use super::parse::{PlaneKeys, Sidecar};
use super::records::Place;
use crate::error::{Error, Result};
use crate::setting::Words;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The numbers of a plane in memory.
#[derive(Clone, Debug)]
pub struct Array(pub(super) Numbers);

impl Array {
    /// Takes the numbers of a plane: one component, two or three, each row by row. `format` is the
    /// type that the numbers had: `f32`, `f16`, `u8`, `u16`, `u32` or `i32`.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the format is unknown or has packed numbers, or if a component is not as
    /// long as the plane.
    pub fn new(size: [u32; 2], components: Vec<Vec<f64>>, format: &str) -> Result<Self> {
        let file = Format::named(format).filter(|format| !format.is_packed());
        let file = file.ok_or_else(|| Error::Invalid(format!("no array of {format}")))?;
        let pixels = size[0] as usize * size[1] as usize;
        if pixels == 0 || components.iter().any(|component| component.len() != pixels) {
            let [width, height] = size;
            let what = format!("an array that does not fill {width} x {height} pixels");
            return Err(Error::Invalid(what));
        }
        Ok(Self(Numbers { size, components, file }))
    }
}

impl Description {
    /// Describes planes in memory. `text` is a TOML as [above](super), in which planes need no
    /// `file`: `arrays` has them by their keys in `[planes]`. Arrays need no key.
    ///
    /// # Errors
    /// [`Error::Format`] as [`Description::open`], with an empty path.
    pub fn of_arrays(text: &str, arrays: BTreeMap<String, Array>) -> Result<Self> {
        let path = Path::new("");
        let mut sidecar = Sidecar::parse_with(text, path, !arrays.is_empty())?;
        for key in arrays.keys() {
            if sidecar.planes.iter().all(|(other, _)| other != key) {
                sidecar.planes.push((key.clone(), PlaneKeys::default()));
            }
        }
        sidecar.arrays = arrays.into_iter().map(|(key, Array(numbers))| (key, numbers)).collect();
        Ok(Self { path: PathBuf::new(), sidecar })
    }

    /// Adds projected splats in memory, as the file of the key `records` holds them.
    #[must_use]
    pub fn with_records(mut self, bytes: Vec<u8>) -> Self {
        self.sidecar.records = Some(Place::Memory(bytes));
        self
    }
}
