//! List the objects of a scene file and their places.

use super::{Model, SceneFile, places};
use crate::error::{Error, Result};
use crate::memory;
use crate::scene::{Motion, Object, Similarity};
use crate::source::Scatter;
use glam::Vec3;
use std::path::PathBuf;

/// A model that objects are copies of; it is not drawn by itself. Its transform, colour and opacity
/// apply in every object.
#[derive(Clone, Debug, PartialEq)]
pub struct Geometry {
    /// The name of the geometry.
    pub name: String,
    /// The threshold of its [levels of detail](crate::scene::objects::detail) in pixels; if absent,
    /// all surfels are drawn.
    pub detail: Option<f64>,
    /// The model.
    pub model: Model,
}

/// One object of a geometry, or many.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectChoice {
    /// The name of the object. If absent, it is the name of the geometry, a point, and the number
    /// of earlier objects of that geometry. Objects of a table or a scatter are called by this
    /// name, a point, and the number of the row or the place, from 0.
    pub name: Option<String>,
    /// The geometry, as an index into [`SceneFile::geometries`].
    pub geometry: usize,
    /// Linear RGB, in place of the geometry's colours.
    pub color: Option<Vec3>,
    /// The places.
    pub places: Places,
}

/// The places of objects.
#[derive(Clone, Debug, PartialEq)]
pub enum Places {
    /// One object, which may move.
    One(Motion),
    /// An object for each row of a [table](mod@places).
    Table {
        /// The file.
        path: PathBuf,
        /// The transform to apply after the place of each row, see [`Similarity::then`].
        transform: Similarity,
    },
    /// Random places.
    Scatter {
        /// The distribution of the places.
        scatter: Scatter,
        /// The transform to apply after each place, see [`Similarity::then`].
        transform: Similarity,
    },
}

/// Bytes of an object: itself, its name and its key, its place in two frames, its sphere, its ids.
const OF_AN_OBJECT: u64 = 768;

impl SceneFile {
    /// The objects: one for each model, then the objects of the file. Geometries are numbered in
    /// the same order.
    ///
    /// # Errors
    /// As [`places::read`]; [`Error::Invalid`] if there are 2^32 objects or more, or if the process
    /// may not hold them.
    pub(in crate::io) fn objects(&self) -> Result<Vec<Object>> {
        let tables = self.objects.iter().map(|object| match &object.places {
            Places::Table { path, .. } => places::read(path).map(Some),
            Places::One(_) | Places::Scatter { .. } => Ok(None),
        });
        let tables = tables.collect::<Result<Vec<_>>>()?;
        let counts = self.objects.iter().zip(&tables).map(|(object, table)| match &object.places {
            Places::One(_) => 1,
            Places::Table { .. } => table.as_ref().map_or(0, Vec::len) as u64,
            Places::Scatter { scatter, .. } => u64::from(scatter.count),
        });
        let total = counts.sum::<u64>() + self.models.len() as u64;
        if total > u64::from(u32::MAX) {
            return Err(Error::Invalid(format!(
                "{total} objects; at most {} are possible",
                u32::MAX
            )));
        }
        memory::ask(total * OF_AN_OBJECT, || format!("{total} objects"))?;
        let mut all = Vec::with_capacity(total as usize);
        all.extend(self.models.iter().enumerate().map(|(geometry, model)| Object {
            name: model.source.name(),
            geometry,
            motion: Motion::still(Similarity::IDENTITY),
            color: None,
        }));
        let mut before = vec![0_u32; self.geometries.len()];
        for (object, table) in self.objects.iter().zip(tables) {
            self.add(object, table, &mut before[object.geometry], &mut all)?;
        }
        Ok(all)
    }

    /// Appends an object, or all objects of a table or a scatter. `before` counts the earlier
    /// objects of the geometry.
    fn add(
        &self,
        object: &ObjectChoice,
        table: Option<Vec<places::Row>>,
        before: &mut u32,
        all: &mut Vec<Object>,
    ) -> Result<()> {
        let ObjectChoice { name, geometry, color, places } = object;
        let of = &self.geometries[*geometry].name;
        let mut add = |number: u32, motion, color| {
            let name = match (name, places) {
                (None, _) => format!("{of}.{before}"),
                (Some(name), Places::One(_)) => name.clone(),
                (Some(name), _) => format!("{name}.{number}"),
            };
            *before += 1;
            all.push(Object { name, geometry: self.models.len() + geometry, motion, color });
        };
        match places {
            Places::One(motion) => add(0, motion.clone(), *color),
            Places::Table { path, transform } => {
                for (number, row) in (0..).zip(table.unwrap_or_default()) {
                    // Refuse rather than choose one of two colours.
                    if row.color.is_some() && color.is_some() {
                        let what = "both the rows and the object have colours; remove one";
                        return Err(Error::format(path, what));
                    }
                    let motion = Motion::still(row.place.then(transform));
                    add(number, motion, row.color.or(*color));
                }
            }
            Places::Scatter { scatter, transform } => {
                for i in 0..scatter.count {
                    add(i, Motion::still(scatter.place(i).then(transform)), *color);
                }
            }
        }
        Ok(())
    }
}
