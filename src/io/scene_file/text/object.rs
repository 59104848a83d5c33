//! Parse and write objects: their geometries and places.

use super::exactly::Exactly;
use super::folder::Folder;
use super::model::color;
use super::transform::{RawRotation, RawTransform};
use crate::io::scene_file::{Geometry, ObjectChoice, Places};
use crate::scene::{Motion, Similarity};
use crate::source::Scatter;
use glam::{DVec3, Vec3};
use serde::de::{self, Deserialize, Deserializer};
use std::path::PathBuf;
use toml::Spanned;

/// Objects whose `of` is still a name, which may belong to no geometry.
pub(super) struct Unresolved {
    of: Spanned<String>,
    name: Option<String>,
    color: Option<Vec3>,
    places: Places,
}

through! {
    Unresolved: RawObject, RawObject::object;
}

#[derive(serde::Deserialize, serde::Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawObject {
    of: Spanned<String>,
    name: Option<String>,
    color: Option<Exactly<f32, 3>>,
    transform: Option<RawTransform>,
    keys: Option<Vec<RawKey>>,
    table: Option<PathBuf>,
    scatter: Option<RawScatter>,
}

/// The place of an object in a frame.
#[derive(serde::Deserialize, serde::Serialize)]
#[serde(deny_unknown_fields)]
struct RawKey {
    frame: u32,
    scale: Option<f64>,
    rotate: Option<RawRotation>,
    translate: Option<Exactly<f64, 3>>,
}

#[derive(serde::Deserialize, serde::Serialize)]
#[serde(deny_unknown_fields)]
struct RawScatter {
    count: u64,
    #[serde(default)]
    seed: u64,
    low: Exactly<f64, 3>,
    high: Exactly<f64, 3>,
    #[serde(default = "unchanged")]
    scale: Exactly<f64, 2>,
    axis: Option<Exactly<f64, 3>>,
}

fn unchanged() -> Exactly<f64, 2> {
    Exactly([1.0; 2])
}

impl RawObject {
    fn object(self) -> Result<Unresolved, String> {
        let Self { of, name, color: given, transform, keys, table, scatter } = self;
        let still = transform.is_some();
        let transform = transform.map_or(Ok(Similarity::IDENTITY), RawTransform::similarity)?;
        let places = match (keys, table, scatter) {
            (None, None, None) => Places::One(Motion::still(transform)),
            (Some(_), None, None) if still => {
                let what = "an object has either a transform or keys; remove one";
                return Err(what.into());
            }
            (Some(keys), None, None) => {
                let keys = keys.into_iter().map(RawKey::place).collect::<Result<_, _>>()?;
                Places::One(Motion::new(keys).map_err(|error| error.to_string())?)
            }
            (None, Some(path), None) => Places::Table { path, transform },
            (None, None, Some(scatter)) => {
                Places::Scatter { scatter: scatter.scatter()?, transform }
            }
            _ => return Err("give one of `keys`, `table` and `scatter`".into()),
        };
        Ok(Unresolved { of, name, color: given.map(color).transpose()?, places })
    }
}

impl RawObject {
    pub(super) fn from_object(
        object: &ObjectChoice,
        geometries: &[Geometry],
        place: &Folder,
    ) -> Self {
        let ObjectChoice { name, geometry, color, places } = object;
        let of = geometries[*geometry].name.clone();
        let mut raw = Self {
            of: Spanned::new(0..of.len(), of),
            name: name.clone(),
            color: color.map(|color| Exactly(color.to_array())),
            transform: None,
            keys: None,
            table: None,
            scatter: None,
        };
        match places {
            Places::One(motion) => match motion.keys() {
                [(0, place)] => raw.transform = RawTransform::from_similarity(place),
                keys => raw.keys = Some(keys.iter().map(RawKey::from_key).collect()),
            },
            Places::Table { path, transform } => {
                raw.table = Some(place.path(path));
                raw.transform = RawTransform::from_similarity(transform);
            }
            Places::Scatter { scatter, transform } => {
                raw.scatter = Some(RawScatter::from_scatter(scatter));
                raw.transform = RawTransform::from_similarity(transform);
            }
        }
        raw
    }
}

impl RawKey {
    fn place(self) -> Result<(u32, Similarity), String> {
        let Self { frame, scale, rotate, translate } = self;
        let place = RawTransform { scale, rotate, translate }.similarity();
        place.map(|place| (frame, place)).map_err(|what| format!("frame {frame}: {what}"))
    }

    fn from_key(&(frame, ref place): &(u32, Similarity)) -> Self {
        let RawTransform { scale, rotate, translate } =
            RawTransform::from_similarity(place).unwrap_or_default();
        Self { frame, scale, rotate, translate }
    }
}

impl RawScatter {
    fn scatter(self) -> Result<Scatter, String> {
        let count = u32::try_from(self.count).map_err(|_| {
            format!("a scatter of {} objects; give at most {}", self.count, u32::MAX)
        })?;
        let scatter = Scatter {
            count,
            seed: self.seed,
            low: self.low.0.into(),
            high: self.high.0.into(),
            scale: self.scale.0,
            axis: self.axis.map(|axis| DVec3::from_array(axis.0)),
        };
        scatter.check().map(|()| scatter).map_err(|error| error.to_string())
    }

    fn from_scatter(scatter: &Scatter) -> Self {
        let Scatter { count, seed, low, high, scale, axis } = *scatter;
        Self {
            count: count.into(),
            seed,
            low: Exactly(low.to_array()),
            high: Exactly(high.to_array()),
            scale: Exactly(scale),
            axis: axis.map(|axis| Exactly(axis.to_array())),
        }
    }
}

/// Finds the geometries that the objects name; an error has the place in the text of a wrong name.
pub(super) fn resolve(
    objects: Vec<Unresolved>,
    geometries: &[Geometry],
) -> Result<Vec<ObjectChoice>, (usize, String)> {
    let found = objects.iter().map(|object| geometry_of(object, &objects, geometries));
    let found = found.collect::<Result<Vec<_>, _>>()?;
    let resolved = objects.into_iter().zip(found).map(|(object, geometry)| {
        let Unresolved { name, color, places, .. } = object;
        ObjectChoice { name, geometry, color, places }
    });
    Ok(resolved.collect())
}

/// The geometry that an object names.
fn geometry_of(
    object: &Unresolved,
    objects: &[Unresolved],
    geometries: &[Geometry],
) -> Result<usize, (usize, String)> {
    let of = object.of.get_ref();
    if let Some(geometry) = geometries.iter().position(|geometry| geometry.name == *of) {
        return Ok(geometry);
    }
    // For the error: `of` may name an object, whose `of` may name another one.
    let mut names = vec![of.as_str()];
    let next = |name: &str| objects.iter().find(|object| object.name.as_deref() == Some(name));
    let mut cycle = false;
    while let Some(next) = names.last().and_then(|name| next(name)).filter(|_| !cycle) {
        cycle = names.contains(&next.of.get_ref().as_str());
        names.push(next.of.get_ref());
    }
    let known: Vec<_> = geometries.iter().map(|geometry| geometry.name.as_str()).collect();
    let known = match known.as_slice() {
        [] => "there is none".to_owned(),
        known => format!("the geometries are {}", known.join(", ")),
    };
    let what = if cycle {
        format!("a circle of names, {}: `of` must name a geometry; {known}", names.join(" of "))
    } else if names.len() > 1 {
        format!("`{of}` is an object, but `of` must name a geometry; {known}")
    } else {
        format!("no [[geometry]] has the name `{of}`; {known}")
    };
    Err((object.of.span().start, what))
}
