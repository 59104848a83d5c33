//! All stages in one call: from a scene to named planes.

use super::fast::CellLevels;
use super::gbuffer::GBuffer;
use super::plain::{pull_all, push_all};
use super::{Cell, Settings};
use crate::error::Result;
use crate::frame::raster::Snap;
use crate::frame::{Exec, Frame, NamedPlane, Plane, Samples, pyramid};
use crate::method::picture::{Clock, Picture, before_environment, color, named, scalar};
use crate::method::projection::{self, Has, Kind, world};
use crate::number::Real;
use crate::scene::{Camera, Scene};
use crate::shade::phong::Shader;
use crate::splat::{Tally, View};

/// Renders with the definition, in any number. Beside the usual planes the picture has `kind`, and
/// `tangent` if the scene has tubes. With `stages`, every stage leaves its planes:
///
/// | stage | planes |
/// |---|---|
/// | projection | see [`mod@crate::method::projection`] |
/// | pull | for each level from 1 on, `pull01` ...: `.kind`, `.front`, `.back`, `.radius`, `.displacement.X`, `.Y`, `.normal`, and if the scene has them `.R G B`, `.tangent` |
/// | push | the same for each level but the coarsest, from `push00` on |
///
/// A level lies in the upper left corner of its planes; the rest is as in an empty cell.
///
/// # Errors
/// [`crate::Error::Invalid`] if the camera or the settings are out of range.
pub fn render<R: Real>(
    scene: &Scene,
    camera: &Camera,
    settings: &Settings,
    exec: &Exec,
    stages: bool,
) -> Result<Picture<R>> {
    camera.check()?;
    settings.check()?;
    let snap = Snap::new(settings.subpixel_bits)?;
    let has = Has::of(scene);
    let mut clock = Clock::default();
    let projected = projection::project::<R>(scene, camera, (settings.cull, snap), exec)?;
    clock.lap("projection");
    let pulled = pull_all(&projected, exec);
    clock.lap("pull");
    let pushed = push_all(&pulled, settings, exec);
    clock.lap("push");
    let mut planes = Vec::new();
    if stages {
        planes = projection::planes(&projected, has);
        for (level, cells) in pulled.iter().enumerate().skip(1) {
            planes.extend(level_planes(&format!("pull{level:02}"), cells, camera, has));
        }
        let last = pushed.len() - 1;
        for (level, cells) in pushed.iter().enumerate().take(last) {
            planes.extend(level_planes(&format!("push{level:02}"), cells, camera, has));
        }
    }
    let (cells, view) = (&pushed[0], View::new(camera));
    let normals = stages || !scene.lights.is_empty();
    let seen = |cell: &Cell<R>| if cell.kind == Kind::Empty { R::ZERO } else { R::ONE };
    let target = GBuffer {
        alpha: cells.map(seen),
        kind: cells.map(|cell| cell.kind as u8),
        depth: cells.map(|cell| cell.front),
        normal: normals.then(|| cells.map(|cell| world(&view, cell.normal))),
        tangent: has.tangent.then(|| cells.map(|cell| world(&view, cell.tangent))),
        color: cells.map(|cell| cell.color),
        colored: has.color,
    };
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
    levels: &mut CellLevels,
    earlier: Option<Picture<f32>>,
) -> Result<Picture<f32>> {
    camera.check()?;
    settings.check()?;
    let mut target = GBuffer::new(scene, camera, earlier.map(|picture| picture.frame));
    let (tally, laps) = levels.draw(scene, camera, settings, exec, &mut target)?;
    Ok(finish(target, Vec::new(), tally, Clock::of(laps), (scene, camera, exec)))
}

/// Deferred shading, and the planes of the picture.
fn finish<R: Real>(
    target: GBuffer<R>,
    mut planes: Vec<NamedPlane<R>>,
    tally: Tally,
    mut clock: Clock,
    (scene, camera, exec): (&Scene, &Camera, &Exec),
) -> Picture<R> {
    let GBuffer { kind, alpha, depth, normal, tangent, mut color, colored } = target;
    let (width, height) = (depth.width(), depth.height());
    clock.restart();
    let shader = Shader::new(View::new(camera), &scene.lights, scene.material);
    shader.shade_over(&depth, normal.as_ref(), tangent.as_ref(), (&mut color, colored), exec);
    clock.lap("shading");
    let (color, alpha) = before_environment(scene, camera, color, alpha, exec);
    planes.push(named("", Samples::Color(color)));
    planes.push(named("A", Samples::Scalar(alpha)));
    planes.push(named("Z", Samples::Scalar(depth)));
    planes.extend(normal.map(|p| named("normal", Samples::Vector(p))));
    planes.extend(tangent.map(|p| named("tangent", Samples::Vector(p))));
    planes.push(named("kind", Samples::Count(kind)));
    Picture { frame: Frame { width, height, planes }, tally, timings: clock.into_laps() }
}

/// The planes of a level, of the size of the picture.
fn level_planes<R: Real>(
    name: &str,
    cells: &Plane<Cell<R>>,
    camera: &Camera,
    has: Has,
) -> Vec<NamedPlane<R>> {
    let whole = pyramid::in_corner(cells, [camera.width, camera.height], Cell::empty());
    let name = |of: &str| format!("{name}.{of}");
    let mut planes = vec![
        named(&name("kind"), Samples::Count(whole.map(|cell| cell.kind as u8))),
        scalar(&name("front"), whole.map(|cell| cell.front)),
        scalar(&name("back"), whole.map(|cell| cell.back)),
        scalar(&name("radius"), whole.map(|cell| cell.radius)),
        scalar(&name("displacement.X"), whole.map(|cell| cell.displacement.x)),
        scalar(&name("displacement.Y"), whole.map(|cell| cell.displacement.y)),
    ];
    let normals = whole.map(|cell| [cell.normal.x, cell.normal.y, cell.normal.z]);
    planes.push(named(&name("normal"), Samples::Vector(normals)));
    if has.color {
        let name = name("").trim_end_matches('.').to_owned();
        planes.push(color(&name, whole.map(|cell| cell.color)));
    }
    if has.tangent {
        let tangents = whole.map(|cell| [cell.tangent.x, cell.tangent.y, cell.tangent.z]);
        planes.push(named(&name("tangent"), Samples::Vector(tangents)));
    }
    planes
}
