//! All stages in one call: from a scene to named planes.

use super::plain::{Composite, Geometry, Images, store};
use super::{Settings, fast};
use crate::composite::groups::Sample;
use crate::error::Result;
use crate::frame::{Framebuffer, Grid, NO_ID, NamedPlane, Pool, Samples, Wanted};
use crate::method::algorithm::Job;
use crate::method::picture::{Clock, Picture, finish, framebuffer, named};
use crate::number::Exact;
use crate::scene::Scene;

/// The definition, in any number; with `stages`, every stage leaves its planes.
pub(super) fn define<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    stages: bool,
) -> Result<Picture<R>> {
    let Job { scene, camera, exec, .. } = *job;
    let (groups, wanted) = (job.index.groups()?, wanted(scene, stages));
    let mut clock = Clock::default();
    let geometry = Geometry::<R>::project(&scene.surfels, groups, camera, settings, exec)?;
    let mut target = Framebuffer::new(camera.width, camera.height, R::ZERO, wanted);
    clock.lap("projection");

    let kept = geometry.each_tile(&mut target, exec, |index, mut tile| {
        let images = geometry.images(index, tile.rect);
        let composites = geometry.composite(&images);
        store(&composites, &mut tile);
        stages.then_some((images, composites))
    });
    clock.lap("groups");

    let mut planes = Vec::new();
    if stages {
        let (images, composites): (Vec<_>, Vec<_>) = kept.into_iter().flatten().unzip();
        let voronoi = settings.depth != super::DepthTest::Plain;
        planes.extend(image_planes("", &geometry, &images, (wanted.color, voronoi)));
        planes.extend(sum_planes(geometry.grid(), &composites, wanted.color));
        planes.extend(target.stencil.take().map(|p| named("sums.count", Samples::Count(p))));
        planes.extend(target.color.clone().map(|p| named("resolved", Samples::Color(p))));
    }
    Ok(finish(target, planes, geometry.tally(), clock, job))
}

/// The fast path for `f32`.
pub(super) fn draw(job: &Job<'_>, settings: &Settings, pool: &mut Pool) -> Result<Picture<f32>> {
    let Job { scene, camera, exec, .. } = *job;
    let groups = job.index.groups()?;
    let mut target = framebuffer(camera, wanted(scene, false), pool);
    let (tally, times) = fast::render(&scene.surfels, groups, camera, settings, exec, &mut target)?;
    let clock = Clock::of(vec![
        ("projection", times.project),
        ("geometry", times.geometry),
        ("compositing", times.compositing),
    ]);
    Ok(finish(target, Vec::new(), tally, clock, job))
}

/// The planes that a scene needs.
fn wanted(scene: &Scene, stages: bool) -> Wanted {
    Wanted {
        normal: stages || !scene.lights.is_empty(),
        color: scene.surfels.color().is_some(),
        observed: stages,
    }
}

/// The depth-image of each group.
pub(in crate::method) fn image_planes<R: Exact>(
    prefix: &str,
    geometry: &Geometry<'_, R>,
    images: &[Images<R>],
    (color, voronoi): (bool, bool),
) -> Vec<NamedPlane<R>> {
    let grid = geometry.grid();
    let groups = images.first().map_or(0, |image| image.groups.len());
    let mut planes = Vec::new();
    for k in 0..groups {
        let kept = |tile: usize, pixel: usize| images[tile].groups[k][pixel];
        let sample = |tile: usize, pixel: usize| geometry.sample(&kept(tile, pixel));
        let name = |plane: &str| format!("{prefix}group{k:02}{plane}");
        let scalar =
            |value: &dyn Fn(usize, usize) -> R| Samples::Scalar(grid.assemble(R::ZERO, value));
        let triple = |value: &dyn Fn(usize, usize) -> [R; 3]| grid.assemble([R::ZERO; 3], value);
        planes.push(named(&name(".Z"), scalar(&|t, i| sample(t, i).depth)));
        let ids = grid.assemble(NO_ID, |t, i| kept(t, i).surfel);
        planes.push(named(&name(".id"), Samples::Index(ids)));
        planes.push(named(&name(".weight"), scalar(&|t, i| sample(t, i).weight)));
        let normals = triple(&|t, i| sample(t, i).normal.map(|n| n + R::ZERO));
        planes.push(named(&name(".normal"), Samples::Vector(normals)));
        if color {
            let colors = Samples::Color(triple(&|t, i| sample(t, i).color));
            planes.push(named(&name(""), colors));
        }
        if voronoi {
            planes.push(named(&name(".voronoi"), scalar(&|t, i| kept(t, i).z)));
        }
    }
    planes
}

/// The sums of the compositing pass.
fn sum_planes<R: Exact>(
    grid: &Grid,
    composites: &[Vec<Composite<R>>],
    color: bool,
) -> Vec<NamedPlane<R>> {
    let sums = |tile: usize, pixel: usize| -> Sample<R> { composites[tile][pixel].sums };
    let zero = [R::ZERO; 3];
    let mut planes = Vec::new();
    if color {
        let colors = grid.assemble(zero, |t, i| sums(t, i).color);
        planes.push(named("sums", Samples::Color(colors)));
    }
    let normals = grid.assemble(zero, |t, i| sums(t, i).normal.map(|n| n + R::ZERO));
    planes.push(named("sums.normal", Samples::Vector(normals)));
    let weights = grid.assemble(R::ZERO, |t, i| sums(t, i).weight);
    planes.push(named("sums.weight", Samples::Scalar(weights)));
    planes
}
