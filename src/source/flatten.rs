//! Turn a scene of objects into a scene of surfels.

use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::memory;
use crate::scene::Scene;
use crate::scene::merge::join;

/// The scene with all drawn surfels and primitives of its objects in their places, for methods that
/// draw surfels. Surfels are in the order of their ids, primitives in the order of the objects. A
/// scene without objects stays as it is. In a view from which no object is seen, nothing is left, and
/// the picture is empty.
///
/// # Errors
/// [`Error::Invalid`] if there are more than 2^32 - 2 surfels or primitives, or if the process may not
/// hold them.
pub fn flatten(scene: &Scene, exec: &Exec) -> Result<Scene> {
    let Some(objects) = &scene.objects else { return Ok(scene.clone()) };
    let total = objects.drawn_total();
    if total >= u64::from(u32::MAX) {
        let what = "surfels of all objects, too many to be drawn one by one; use --method deferred";
        return Err(Error::Invalid(format!("{total} {what}")));
    }
    memory::ask(total * OF_A_SURFEL, || format!("{total} surfels of all objects"))?;
    let (surfels, primitives) = objects.flattened(exec)?;
    let primitives = join(primitives, objects.fill())?;
    let sides = objects.sides()?;
    Ok(Scene { surfels, primitives, sides, ..scene.clone() })
}

/// Bytes of a surfel with every attribute, twice because the arrays are put together.
const OF_A_SURFEL: u64 = 2 * 68;
