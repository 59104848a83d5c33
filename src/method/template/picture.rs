//! All stages in one call: from a scene to named planes.

use super::fast::CenterLevels;
use super::gather::{Gathered, gather};
use super::{Center, Settings, levels};
use crate::composite::sum;
use crate::error::{Error, Result};
use crate::frame::raster::Snap;
use crate::frame::{Exec, Framebuffer, NamedPlane, Plane, Samples, Wanted, pyramid};
use crate::method::picture::{Clock, Picture, color, finish, framebuffer, named, scalar};
use crate::method::projection::{self, Has, world};
use crate::number::{Real, Vector3};
use crate::scene::{Camera, Scene};
use crate::splat::View;

/// Renders with the definition, in any number. `weight` is the sum of the weights, `id` the nearest
/// centre of those blended. With `stages`, every stage leaves its planes:
///
/// | stage | planes |
/// |---|---|
/// | projection | see [`mod@crate::method::projection`] |
/// | propagation | for each level from 1 on, `level01` ...: `.id`, `.Z`, `.radius`, `.extent`, `.place.X`, `.Y`, `.normal`, and `.R G B` if the scene has colours |
/// | reconstruction | `gathered.count` (centres blended, up to 255), `.weight`, `.depths`, `.normal`, and `.R G B` if the scene has colours: sums; `.Z`, `.radius`: of the front |
///
/// A level lies in the upper left corner of its planes; the rest is as in an empty cell.
///
/// # Errors
/// [`Error::Invalid`] if the camera or the settings are out of range, or if the scene has triangles
/// or lines.
pub fn render<R: Real>(
    scene: &Scene,
    camera: &Camera,
    settings: &Settings,
    exec: &Exec,
    stages: bool,
) -> Result<Picture<R>> {
    check(scene, camera, settings)?;
    let has = Has::of(scene);
    let mut clock = Clock::default();
    let how = (settings.cull, Snap::default());
    let projected = projection::project::<R>(scene, camera, how, exec)?;
    clock.lap("projection");
    let found = levels::propagate(&projected, settings, exec);
    clock.lap("propagation");
    let gathered = gather(&found, settings, exec);
    clock.lap("reconstruction");
    let mut planes = Vec::new();
    if stages {
        planes = projection::planes(&projected, has);
        for (level, cells) in found.iter().enumerate().skip(1) {
            planes.extend(level_planes(&format!("level{level:02}"), cells, camera, has));
        }
        planes.extend(sums(&gathered, has));
    }
    clock.restart();
    let view = View::new(camera);
    let normals = stages || !scene.lights.is_empty();
    let target = Framebuffer {
        width: camera.width,
        height: camera.height,
        depth: gathered.map(depth),
        id: gathered.map(|pixel| pixel.id),
        weight: gathered.map(|pixel| pixel.weight),
        normal: normals.then(|| gathered.map(|pixel| normal(&view, pixel))),
        color: has.color.then(|| gathered.map(|pixel| sum::average(pixel.colors, pixel.weight))),
        stencil: None,
        margin: None,
    };
    clock.lap("normalization");
    Ok(finish(target, planes, projected.tally, clock, (scene, camera, exec)))
}

/// Renders in `f32` by the fast path: the bits of [`render`], without the planes of the stages, in
/// the memory of `levels` and of an earlier picture.
///
/// # Errors
/// As [`render`].
pub fn render_f32(
    scene: &Scene,
    camera: &Camera,
    settings: &Settings,
    exec: &Exec,
    levels: &mut CenterLevels,
    earlier: Option<Picture<f32>>,
) -> Result<Picture<f32>> {
    check(scene, camera, settings)?;
    let color = Has::of(scene).color;
    let wanted = Wanted { normal: !scene.lights.is_empty(), color, observed: false };
    let mut target = framebuffer(camera, wanted, earlier.map(|picture| picture.frame));
    let (tally, laps) = levels.draw(scene, camera, settings, exec, &mut target);
    Ok(finish(target, Vec::new(), tally, Clock::of(laps), (scene, camera, exec)))
}

/// Whether the method can draw the scene.
fn check(scene: &Scene, camera: &Camera, settings: &Settings) -> Result<()> {
    camera.check()?;
    settings.check()?;
    if scene.primitives.is_empty() {
        Ok(())
    } else {
        Err(Error::Invalid("the template draws surfels only, but the scene has others".into()))
    }
}

/// The average depth; +inf where nothing was gathered.
fn depth<R: Real>(pixel: &Gathered<R>) -> R {
    if pixel.weight > R::ZERO { pixel.depths / pixel.weight } else { R::INFINITY }
}

/// The direction of the average normal, world space.
fn normal<R: Real>(view: &View<R>, pixel: &Gathered<R>) -> [R; 3] {
    let [x, y, z] = sum::average(pixel.normals, pixel.weight);
    world(view, Vector3::new(x, y, z))
}

/// The planes of a level, of the size of the picture.
fn level_planes<R: Real>(
    name: &str,
    cells: &Plane<Center<R>>,
    camera: &Camera,
    has: Has,
) -> Vec<NamedPlane<R>> {
    let whole = pyramid::in_corner(cells, [camera.width, camera.height], Center::empty());
    let of = |what: &str| format!("{name}.{what}");
    let mut planes = vec![
        named(&of("id"), Samples::Index(whole.map(|cell| cell.id))),
        scalar(&of("Z"), whole.map(|cell| cell.depth)),
        scalar(&of("radius"), whole.map(|cell| cell.radius)),
        scalar(&of("extent"), whole.map(|cell| cell.extent)),
        scalar(&of("place.X"), whole.map(|cell| cell.place.x)),
        scalar(&of("place.Y"), whole.map(|cell| cell.place.y)),
    ];
    let normals = whole.map(|cell| [cell.normal.x, cell.normal.y, cell.normal.z]);
    planes.push(named(&of("normal"), Samples::Vector(normals)));
    if has.color {
        planes.push(color(name, whole.map(|cell| cell.color)));
    }
    planes
}

/// The planes of the sums.
fn sums<R: Real>(gathered: &Plane<Gathered<R>>, has: Has) -> Vec<NamedPlane<R>> {
    let mut planes = vec![
        named("gathered.count", Samples::Count(gathered.map(|pixel| pixel.count))),
        scalar("gathered.weight", gathered.map(|pixel| pixel.weight)),
        scalar("gathered.depths", gathered.map(|pixel| pixel.depths)),
        scalar("gathered.Z", gathered.map(|pixel| pixel.depth)),
        scalar("gathered.radius", gathered.map(|pixel| pixel.radius)),
        named("gathered.normal", Samples::Vector(gathered.map(|pixel| pixel.normals))),
    ];
    if has.color {
        planes.push(color("gathered", gathered.map(|pixel| pixel.colors)));
    }
    planes
}
