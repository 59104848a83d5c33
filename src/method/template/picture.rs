//! All stages in one call: from a scene to named planes.

use super::fast::Levels;
use super::gather::{Gathered, gather};
use super::{Center, Settings, levels};
use crate::composite::sum;
use crate::error::Result;
use crate::frame::raster::Snap;
use crate::frame::{Framebuffer, NamedPlane, Plane, Pool, Samples, Wanted, pyramid};
use crate::method::algorithm::Job;
use crate::method::picture::{Clock, Picture, color, finish, framebuffer, named, scalar};
use crate::method::projection::{self, Has, world};
use crate::number::{Exact, Vector3};
use crate::scene::Camera;
use crate::splat::View;

/// The definition, in any number; with `stages`, every stage leaves its planes.
pub(super) fn define<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    stages: bool,
) -> Result<Picture<R>> {
    let Job { scene, camera, exec, .. } = *job;
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
    Ok(finish(target, planes, projected.tally, clock, job))
}

/// The fast path for `f32`.
pub(super) fn draw(
    job: &Job<'_>,
    settings: &Settings,
    levels: &mut Levels,
    pool: &mut Pool,
) -> Result<Picture<f32>> {
    let Job { scene, camera, exec, .. } = *job;
    let color = Has::of(scene).color;
    let wanted = Wanted { normal: !scene.lights.is_empty(), color, observed: false };
    let mut target = framebuffer(camera, wanted, pool);
    let (tally, times) = levels.draw(scene, camera, settings, exec, &mut target);
    let clock = Clock::of(vec![
        ("projection", times.project),
        ("propagation", times.propagate),
        ("reconstruction", times.search),
    ]);
    Ok(finish(target, Vec::new(), tally, clock, job))
}

/// The average depth; +inf where nothing was gathered.
fn depth<R: Exact>(pixel: &Gathered<R>) -> R {
    if pixel.weight > R::ZERO { pixel.depths / pixel.weight } else { R::INFINITY }
}

/// The direction of the average normal, world space.
fn normal<R: Exact>(view: &View<R>, pixel: &Gathered<R>) -> [R; 3] {
    let [x, y, z] = sum::average(pixel.normals, pixel.weight);
    world(view, Vector3::new(x, y, z))
}

/// The planes of a level, of the size of the picture.
fn level_planes<R: Exact>(
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
fn sums<R: Exact>(gathered: &Plane<Gathered<R>>, has: Has) -> Vec<NamedPlane<R>> {
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
