//! All stages in one call: from a scene to named planes.

use super::fast::Levels;
use super::plain::{pull_all, push_all};
use super::{Cell, Settings};
use crate::error::Result;
use crate::frame::raster::Snap;
use crate::frame::{Frame, NamedPlane, Plane, Pool, Samples, pyramid};
use crate::method::algorithm::Job;
use crate::method::picture::{Clock, Picture, before_environment, color, named, scalar};
use crate::method::projection::{self, Has, Kind, world};
use crate::number::Exact;
use crate::scene::{Camera, Scene};
use crate::shade::phong::Shader;
use crate::splat::{Tally, View};

/// The definition, in any number; with `stages`, every stage leaves its planes.
pub(super) fn define<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    stages: bool,
) -> Result<Picture<R>> {
    let Job { scene, camera, exec, .. } = *job;
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
    let surface = Surface {
        alpha: cells.map(seen),
        kind: cells.map(|cell| cell.kind as u8),
        depth: cells.map(|cell| cell.front),
        normal: normals.then(|| cells.map(|cell| world(&view, cell.normal))),
        tangent: has.tangent.then(|| cells.map(|cell| world(&view, cell.tangent))),
        color: cells.map(|cell| cell.color),
        colored: has.color,
    };
    Ok(finish(surface, planes, projected.tally, clock, job))
}

/// The fast path for `f32`.
pub(super) fn draw(
    job: &Job<'_>,
    settings: &Settings,
    levels: &mut Levels,
    pool: &mut Pool,
) -> Result<Picture<f32>> {
    let Job { scene, camera, exec, .. } = *job;
    let mut surface = Surface::new(scene, camera, pool);
    let (tally, times) = levels.draw(scene, camera, settings, exec, &mut surface)?;
    let laps = vec![("projection", times.project), ("pull", times.pull), ("push", times.push)];
    let clock = Clock::of(laps);
    Ok(finish(surface, Vec::new(), tally, clock, job))
}

/// What is seen, pixel by pixel; vectors in world space.
pub(super) struct Surface<R> {
    /// See [`crate::method::projection::Kind`].
    pub(super) kind: Plane<u8>,
    /// 1 where something is seen, else 0.
    pub(super) alpha: Plane<R>,
    /// Depth t; +inf where nothing is seen.
    pub(super) depth: Plane<R>,
    /// Unit normals, if there is light or they were asked for.
    pub(super) normal: Option<Plane<[R; 3]>>,
    /// Unit tangents of tubes, the null vector elsewhere; if the scene has tubes.
    pub(super) tangent: Option<Plane<[R; 3]>>,
    /// Colours, if `colored`; else anything.
    pub(super) color: Plane<[R; 3]>,
    /// Whether the scene has colours.
    pub(super) colored: bool,
}

impl Surface<f32> {
    /// What a scene needs, in memory that is used again: the values are any.
    fn new(scene: &Scene, camera: &Camera, pool: &mut Pool) -> Self {
        let (size, has) = ([camera.width, camera.height], Has::of(scene));
        Self {
            kind: pool.count(size),
            alpha: pool.scalar(size),
            depth: pool.scalar(size),
            normal: (!scene.lights.is_empty()).then(|| pool.triple(size)),
            tangent: has.tangent.then(|| pool.triple(size)),
            color: pool.triple(size),
            colored: has.color,
        }
    }
}

/// Deferred shading, and the planes of the picture.
fn finish<R: Exact>(
    surface: Surface<R>,
    mut planes: Vec<NamedPlane<R>>,
    tally: Tally,
    mut clock: Clock,
    job: &Job<'_>,
) -> Picture<R> {
    let Job { scene, camera, exec, .. } = *job;
    let Surface { kind, alpha, depth, normal, tangent, mut color, colored } = surface;
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
fn level_planes<R: Exact>(
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
