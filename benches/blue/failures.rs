//! Where prefixes fail, as \[BJFM19, 6\] says, and beyond: each a scene, what is swept, and a number.

use super::scene::seen;
use super::scene::{against, blue, draw, geometry, mesh, objects, order, order_along, percent};
use glam::{DVec3, Vec3};
use splatref::Result;
use splatref::frame::Exec;
use splatref::method::blue::controller::Controller;
use splatref::scene::{Camera, Geometry, Lens, Motion, Object, Objects, Pose};
use splatref::scene::{Primitives, Scene, Similarity, Triangles, Vertices};
use splatref::source::candidates::Directions;

/// Gaps between two walls, as parts of the distance of surfels.
pub(crate) const GAPS: [f64; 6] = [4.0, 2.0, 1.0, 0.5, 0.25, 0.0625];
/// Lengths of a bar, in its widths.
pub(crate) const LENGTHS: [f64; 5] = [1.0, 4.0, 16.0, 64.0, 256.0];
/// Surfels that a view far away asks for.
pub(crate) const COUNTS: [f64; 6] = [3.0, 10.0, 30.0, 100.0, 1000.0, 10_000.0];
/// How far an object has given way to a finer one.
pub(crate) const FADES: [f64; 6] = [0.0, 0.1, 0.25, 0.5, 0.75, 1.0];
/// By how much a frame takes longer from one moment on.
pub(crate) const STEPS: [f64; 5] = [1.5, 2.0, 4.0, 9.0, 25.0];

/// A box around the origin, of so many squares an edge, with normals of its faces.
fn cuboid(half: DVec3, squares: u32) -> Result<Scene> {
    let mut vertices = Vertices::default();
    let mut corners = Vec::new();
    for face in 0..6 {
        let (axis, sign) = (face % 3, if face < 3 { 1.0 } else { -1.0 });
        let first = vertices.position.len() as u32;
        let at = |i: u32| f64::from(i) / f64::from(squares) * 2.0 - 1.0;
        for i in 0..=squares {
            for j in 0..=squares {
                let mut p = DVec3::ZERO;
                (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (sign, at(i) * sign, at(j));
                let mut normal = Vec3::ZERO;
                normal[axis] = sign as f32;
                vertices.position.push((p * half).as_vec3());
                vertices.direction.push(normal);
                vertices.radius.push(0.0);
            }
        }
        let row = squares + 1;
        for i in 0..squares {
            for j in 0..squares {
                let [a, b] = [first + i * row + j, first + (i + 1) * row + j];
                corners.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
            }
        }
    }
    Ok(mesh(Triangles::new(vertices, corners)?.0))
}

/// Holes in hundredths of a plate of 2 x 2 whose sides are `gap` distances of surfels apart, drawn by 2000
/// surfels from the front: of an order by straight distances, or along the surface.
pub(crate) fn thin_wall(gap: f64, along: bool, exec: &Exec) -> Result<f64> {
    // 2000 surfels on both sides, 8 units: about 0.068 apart.
    const APART: f64 = 0.068;
    let plate = cuboid(DVec3::new(1.0, 1.0, gap * APART / 2.0), 1)?;
    let order =
        if along { order_along } else { order }(&plate, (&Directions::Cube, 768), 2000, exec)?;
    let objects = objects(geometry(order, Primitives::default())?, &[Similarity::IDENTITY])?;
    let camera = camera(DVec3::new(0.0, 0.0, 5.0), 256, Lens::FieldOfView(30.0))?;
    // So small that all surfels are asked for, as large as they cover with.
    let found = draw(&seen(&objects, 0.125, &camera, exec)?, blue(), &camera, exec)?;
    let found = against(&found, &draw(&plate, blue(), &camera, exec)?);
    Ok(percent(found.holes, found.interior))
}

/// How many surfels of the size 2 are drawn of a bar seen along it, and how many of them each covered pixel has
/// in the nearest and in the farthest eighth of its length, in pixels of 1 by 1.
pub(crate) fn long_object(length: f64, exec: &Exec) -> Result<[f64; 3]> {
    let half = DVec3::new(0.5, 0.5, length / 2.0);
    let bar = cuboid(half, 1)?;
    let order = order(&bar, (&Directions::Cube, 1024), 200_000, exec)?;
    let objects = objects(geometry(order, Primitives::default())?, &[Similarity::IDENTITY])?;
    let eye = DVec3::new(1.0, 1.0, length / 2.0 + 8.0);
    let target = DVec3::new(0.0, 0.0, length / 2.0);
    let pose = Pose { eye, target, up: DVec3::Y };
    let camera = Camera::new(256, 256, pose, Lens::FieldOfView(20.0))?;
    let scene = seen(&objects, 2.0, &camera, exec)?;
    // An area of a face in pixels falls with the square of its depth: of a side of the bar at a depth t, f / t each way.
    let density = |near: bool| {
        let eighth = |z: f64| if near { z > 0.375 * length } else { z < -0.375 * length };
        let all = scene.surfels.position().iter().map(|p| f64::from(p.z));
        let surfels = all.filter(|z| eighth(*z)).count() as f64;
        let depth = if near { 8.0 } else { 8.0 + length };
        let scale = f64::from(camera.fy) / depth;
        // Four sides, an eighth of the length, and one end.
        surfels / ((4.0 * length / 8.0 + 1.0) * scale * scale)
    };
    Ok([scene.surfels.len() as f64, density(true), density(false)])
}

/// Surfels that a view of a torus asks for, and the holes in hundredths that they leave; drawn with the same
/// prefix and the same discs, but 64 pixels to the one that was asked for.
pub(crate) fn short_prefix(count: f64, exec: &Exec) -> Result<(usize, f64)> {
    let torus = torus()?;
    let objects = objects(
        geometry(order(&torus, (&Directions::Cube, 512), 50_000, exec)?, Primitives::default())?,
        &[Similarity::IDENTITY],
    )?;
    let prefix = objects.geometries()[0].prefix().map(|prefix| prefix.estimate());
    let Some(estimate) = prefix else { return Ok((0, 0.0)) };
    // r of the prefix asked for, as a size in the picture below.
    let radius = f64::from(estimate.distance) * (f64::from(estimate.count) / count).sqrt();
    let camera = far_away()?;
    let size = 2.0 * radius * f64::from(camera.fy);
    let scene = seen(&objects, size as f32, &camera, exec)?;
    let found = draw(&scene, blue(), &camera, exec)?;
    let found = against(&found, &draw(&torus, blue(), &camera, exec)?);
    Ok((scene.surfels.len(), percent(found.holes, found.interior)))
}

/// Surfels of a torus that are drawn while 5000 surfels give way to a finer object's 50,000, and the holes in
/// hundredths that they leave.
pub(crate) fn fade(fade: f64, exec: &Exec) -> Result<(usize, f64)> {
    let torus = torus()?;
    let [coarse, finer] = [(5000, "coarse"), (50_000, "finer")].map(|(count, name)| {
        let order = order(&torus, (&Directions::Cube, 512), count, exec)?;
        Ok(Geometry { name: name.into(), ..geometry(order, Primitives::default())? })
    });
    let coarse: Geometry = coarse?;
    let (density, count) = match coarse.prefix() {
        Some(prefix) => (prefix.estimate(), f64::from(prefix.count())),
        None => return Ok((0, 0.0)),
    };
    let object = |geometry| Object {
        name: "torus".into(),
        geometry,
        motion: Motion::still(Similarity::IDENTITY),
        color: None,
    };
    let both = Objects::new(vec![coarse, finer?], vec![object(0), object(1)], [0.75; 3].into())?;
    let both = both.with_coarser(vec![None, Some(0)])?;
    let wanted = count * (1.0 + fade) / 2.0;
    let radius = f64::from(density.distance) * (f64::from(density.count) / wanted).sqrt();
    let camera = far_away()?;
    let scene = seen(&both, (2.0 * radius * f64::from(camera.fy)) as f32, &camera, exec)?;
    let found = draw(&scene, blue(), &camera, exec)?;
    let found = against(&found, &draw(&torus, blue(), &camera, exec)?);
    Ok((scene.surfels.len(), percent(found.holes, found.interior)))
}

/// A camera before the torus, so far away that every disc has one size.
fn far_away() -> Result<Camera> {
    let pose = Pose { eye: DVec3::new(2.0, 3.0, 5.0), target: DVec3::ZERO, up: DVec3::Y };
    Camera::new(512, 512, pose, Lens::Orthographic(3.2))
}

/// A torus of the radii 1 and 0.4.
fn torus() -> Result<Scene> {
    use splatref::number::elementary::{cos, sin};
    let (columns, rows) = (192, 96);
    let mut vertices = Vertices::default();
    let mut corners = Vec::new();
    for i in 0..columns {
        for j in 0..rows {
            let angle = |i: u32, of: u32| f64::from(i) / f64::from(of) * std::f64::consts::TAU;
            let (a, b) = (angle(i, columns), angle(j, rows));
            let normal = DVec3::new(cos(b) * cos(a), sin(b), cos(b) * sin(a));
            let p = DVec3::new(cos(a), 0.0, sin(a)) + normal * 0.4;
            vertices.position.push(p.as_vec3());
            vertices.direction.push(normal.as_vec3());
            vertices.radius.push(0.0);
            let at = |i: u32, j: u32| i % columns * rows + j % rows;
            corners.push([at(i, j), at(i, j + 1), at(i + 1, j + 1)]);
            corners.push([at(i, j), at(i + 1, j + 1), at(i + 1, j)]);
        }
    }
    Ok(mesh(Triangles::new(vertices, corners)?.0))
}

fn camera(eye: DVec3, side: u32, lens: Lens) -> Result<Camera> {
    Camera::new(side, side, Pose { eye, target: DVec3::ZERO, up: DVec3::Y }, lens)
}

/// What a load step does to sizes whose frame times are known so many frames late.
pub(crate) struct Swing {
    /// The largest size over that at which sizes settle, in hundredths.
    pub(crate) overshoot: f64,
    /// The frame from which on sizes stay; none if they swing for ever.
    pub(crate) settled: Option<usize>,
}

impl std::fmt::Display for Swing {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.settled {
            Some(frame) => write!(f, "{:.0} %, {frame}", self.overshoot),
            None => write!(f, "{:.0} %, never", self.overshoot),
        }
    }
}

/// Surfels that take `s^-2` of the target's time at the size 1.25, and from frame 0 on `step` times as long.
pub(crate) fn load_step(step: f64, late: usize) -> Swing {
    let frames = 1000;
    let Ok(controller) = Controller::new(1.0) else {
        return Swing { overshoot: f64::NAN, settled: None };
    };
    let mut sizes = vec![1.25_f32; late + 1];
    for _ in 0..frames {
        let at = |back: usize| sizes[sizes.len() - 1 - back];
        let known = f64::from(at(late));
        let next = controller.next(at(0), 1.25 * 1.25 * step / (known * known));
        sizes.push(next);
    }
    let last = sizes[sizes.len() - 1];
    let first = sizes.iter().rposition(|&size| size != last).map_or(0, |i| i + 1 - late.min(i));
    let most = sizes.iter().fold(0.0_f32, |most, &size| if size > most { size } else { most });
    let wanted = 1.25 * step.sqrt();
    let settled = (first < frames / 2).then_some(first);
    Swing { overshoot: 100.0 * (f64::from(most) / wanted - 1.0), settled }
}
