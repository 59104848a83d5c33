//! Finish a picture of which regions hold the projection alone.
//!
//! A region that the method `pyramid` or `template` draws has the planes of the
//! [projection](crate::method::projection), and a text that
//! [`provenance::text_of_projection`] describes. Both together are all that the other stages need:
//! no scene is read.

use super::text::projection::{PartText, RawProjection};
use super::{DEFAULT_COUNT, SceneFile, Source};
use crate::error::{Error, Result};
use crate::frame::{Exec, Frame, NamedPlane, Plane, Samples};
use crate::io::provenance;
use crate::method::projection::{BEHIND, Has, Joined, planes};
use crate::method::stage::Holds;
use crate::method::{PlaneRow, Session};
use crate::scene::{Camera, Scene, Surfels};
use crate::source::Shape;

/// Runs the stages after the projection on the planes of all regions, joined, whose text this is. Returns
/// the planes of the picture and its text: both are those of the whole picture, bit for bit. Planes may
/// be whole or one a channel, as [`exr::assemble`](crate::io::exr::assemble) leaves them.
///
/// # Errors
/// [`Error::Invalid`] if the text is not that of such a part, if another version of this crate wrote it,
/// or if a plane is missing; else as [`Session::finish`].
pub fn finish(mut planes: Frame<f32>, text: &str, exec: &Exec) -> Result<(Frame<f32>, String)> {
    let part = PartText::parse(text)?;
    let changed = |what: &str| {
        Error::Invalid(format!("the text of the parts: {what}; render the parts again"))
    };
    let own = env!("CARGO_PKG_VERSION");
    if part.splatref != own {
        let what = format!("splatref {} drew the projection, and this is {own}", part.splatref);
        return Err(changed(&what));
    }
    let whole = provenance::without_projection(text).filter(|_| part.is_single());
    let whole = whole.ok_or_else(|| changed("it is not as `render --region` wrote it"))?;
    let scene = scene(&part);
    let camera = camera(&part, &scene)?;
    let RawProjection { stages, colors, tangents, environment } = part.projection;
    let frame = samples(&mut planes)?;
    let behind = match take(&mut planes, &BEHIND)? {
        Some(Samples::Color(behind)) => Some(behind),
        _ => None,
    };
    // The rest of the planes is of no use, and the picture needs the memory.
    drop(planes);
    if environment != behind.is_some() {
        let what = format!("`projection.environment` is {environment}, unlike the planes");
        return Err(changed(&what));
    }
    let joined = Joined { has: Has { color: colors, tangent: tangents }, behind };
    let session = Session::new(&scene, part.method.method()?, exec)?.with_joined(joined);
    Ok((session.finish(&camera, &frame, stages)?.frame, whole.to_owned()))
}

/// What the text says of the scene: its lights, its material and its offset.
fn scene(part: &PartText) -> Scene {
    Scene {
        lights: part.light.clone(),
        material: part.material,
        offset: part.offset(),
        ..Scene::unlit("", Surfels::none())
    }
}

/// The camera, bit for bit; it needs nothing of a model.
fn camera(part: &PartText, scene: &Scene) -> Result<Camera> {
    let any = Source::Shape { shape: Shape::Sphere, count: DEFAULT_COUNT, seed: 0 };
    SceneFile { camera: part.camera.clone(), ..SceneFile::of_model(any) }.camera(scene)
}

/// Takes the planes of the projection out of a frame. A plane that is missing is left out.
fn samples(frame: &mut Frame<f32>) -> Result<Frame<f32>> {
    let mut found = Frame::new(frame.width, frame.height);
    for row in planes::STAGE.leaves {
        if let Some(samples) = take(frame, row)? {
            found.planes.push(NamedPlane { name: row.name.to_owned(), samples });
        }
    }
    Ok(found)
}

/// Takes a plane out of a frame, or joins its channels.
fn take(frame: &mut Frame<f32>, row: &PlaneRow) -> Result<Option<Samples<f32>>> {
    let mut out = |name: &str| {
        let place = frame.planes.iter().position(|plane| plane.name == name)?;
        Some(frame.planes.swap_remove(place).samples)
    };
    let missing = || Error::Invalid(format!("the plane `{}` is missing", row.name));
    let mut channels = row.holds.channels(row.name).into_iter();
    Ok(match (row.holds.plain(), out(row.name)) {
        (_, Some(samples)) if row.holds(&samples) => Some(samples),
        (Holds::Count, Some(Samples::Index(values))) => Some(Samples::Count(counts(&values, row)?)),
        (holds @ (Holds::Color | Holds::Vector), None) => {
            let Some(first) = channels.next().and_then(|name| out(&name)) else { return Ok(None) };
            let mut joined = match first {
                Samples::Scalar(plane) => plane.map(|&value| [value, 0.0, 0.0]),
                _ => return Err(missing()),
            };
            for (i, name) in (1..).zip(channels) {
                let Some(Samples::Scalar(plane)) = out(&name) else { return Err(missing()) };
                let both = joined.values_mut().iter_mut().zip(plane.values());
                both.for_each(|(joined, &value)| joined[i] = value);
            }
            Some(if holds == Holds::Color {
                Samples::Color(joined)
            } else {
                Samples::Vector(joined)
            })
        }
        (_, other) => other,
    })
}

/// Counts of 8 bits, which a file holds in 32.
fn counts(values: &Plane<u32>, row: &PlaneRow) -> Result<Plane<u8>> {
    if let Some(large) = values.values().iter().find(|&&value| value > u32::from(u8::MAX)) {
        return Err(Error::Invalid(format!("the plane `{}` has {large}; at most 255", row.name)));
    }
    Ok(values.map(|&value| value as u8))
}
