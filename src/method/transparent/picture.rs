//! All stages in one call: from a scene to named planes.

use super::Settings;
use super::blend::{Average, Blending, Layers};
use super::nearest::First;
use crate::composite::over::Blend;
use crate::error::{Error, Result};
use crate::frame::{Exec, Frame, Grid, NO_ID, NamedPlane, Rect, Samples};
use crate::index::order::BackToFront;
use crate::method::picture::{Clock, Picture, before_environment, color, named, scalar};
use crate::method::single_pass;
use crate::number::{Exact, Vector3};
use crate::scene::Groups;
use crate::scene::{Camera, Scene};
use crate::shade::optics::{self, Behind, NearestLayer};
use crate::splat::View;

/// Renders by Algorithm 2 or 3 \[ZP06\], in any number.
///
/// The planes of the picture: `R G B` and `A`; `Z` and `id` of the nearest fragment that passed its
/// depth test; `layers`, the mean count of layers, and of Algorithm 3 `normal` and `weight` of the
/// nearest layer. With `stages`:
///
/// | stage | planes |
/// |---|---|
/// | nearest layer | `nearest.groupK.*` as in [`single_pass::render`]; `nearest.R G B`: `C_F`; `nearest.A`: alpha; `nearest.mask`: the stencil |
/// | blending | for each group k `blended.groupK.R G B`, `.A`, `.opacity` (the sum of opacities), `.bin` (+inf: empty), `.count`, `.id` (of the surfel blended last) |
/// | average | `blended.R G B`, `.A`, `.opacity`, `.hidden`, `.layers`; of Algorithm 3 `l`: the layer count of eq. 11 and 12, 0 where there is no layer or where its opacity is 0 |
///
/// # Errors
/// [`crate::Error::Invalid`] if the camera or the settings are out of range, if the low-precision
/// depth takes too many bins, if refraction is wanted without an environment, or if there are not
/// as many surfels in the groups or in the order as in the scene.
pub fn render<R: Exact>(
    scene: &Scene,
    (groups, order): (&Groups, &BackToFront),
    camera: &Camera,
    settings: &Settings,
    exec: &Exec,
    stages: bool,
) -> Result<Picture<R>> {
    camera.check()?;
    settings.check()?;
    if settings.refraction.is_some() && scene.environment.is_none() {
        let what = "refraction: there is nothing to be seen through it; give an environment";
        return Err(Error::Invalid(what.into()));
    }
    groups.check(&scene.surfels)?;
    order.check(&scene.surfels)?;
    let mut clock = Clock::default();
    let mut planes = Vec::new();
    let grid = exec.grid(camera.width, camera.height);
    let first = match settings.nearest {
        None => None,
        Some(depth) => {
            let settings = single_pass::Settings { splats: settings.splats, depth };
            let first = First::new(scene, groups, camera, &settings, exec, stages, &mut planes)?;
            clock.lap("nearest layer");
            Some(first)
        }
    };
    let blending = Blending::project(scene, (groups, order), camera, settings, exec)?;
    clock.lap("order, projection");

    let tail = Tail { scene, settings, view: View::new(camera), first: first.as_ref() };
    let tiles = grid.rects().into_iter().enumerate().collect();
    let done = exec.ordered(tiles, |(tile, rect): (usize, Rect)| {
        let mask = first.as_ref().map(|first| first.mask(rect));
        let images = blending.images(tile, rect, mask.as_deref());
        let pixels: Vec<_> = (0..rect.pixels())
            .map(|i| {
                let average = blending.average(&images, i);
                (average, tail.pixel((tile, i), rect, &average))
            })
            .collect();
        (stages.then_some(images), pixels)
    });
    clock.lap("blending");

    let (images, pixels): (Vec<_>, Vec<_>) = done.into_iter().unzip();
    let images: Vec<_> = images.into_iter().flatten().collect();
    planes.extend(image_planes(&grid, &images, groups.len()));
    let tally = first.as_ref().map_or(blending.tally(), |first| first.tally);
    planes.extend(picture_planes((scene, camera, exec), &grid, &pixels, first, stages));
    let frame = Frame { width: camera.width, height: camera.height, planes };
    Ok(Picture { frame, tally, timings: clock.into_laps() })
}

/// The planes of the picture, with `stages` after those of the averages.
fn picture_planes<R: Exact>(
    (scene, camera, exec): (&Scene, &Camera, &Exec),
    grid: &Grid,
    pixels: &[Vec<(Average<R>, Blend<R>)>],
    first: Option<First<R>>,
    stages: bool,
) -> Vec<NamedPlane<R>> {
    let average = |tile: usize, i: usize| -> &Average<R> { &pixels[tile][i].0 };
    let blend = |tile: usize, i: usize| -> &Blend<R> { &pixels[tile][i].1 };
    let mut planes = Vec::new();
    if stages {
        planes.extend(average_planes(grid, average));
        planes.extend(first.as_ref().map(|first| {
            let l = grid.assemble(R::ZERO, |tile, i| first.layers((tile, i), average(tile, i)));
            scalar("l", l)
        }));
    }
    let colors = grid.assemble([R::ZERO; 3], |t, i| blend(t, i).color);
    let alphas = grid.assemble(R::ZERO, |t, i| blend(t, i).alpha);
    let (colors, alphas) = before_environment(scene, camera, colors, alphas, exec);
    planes.push(color("", colors));
    planes.push(scalar("A", alphas));
    let counts = grid.assemble(R::ZERO, |t, i| average(t, i).layers);
    match first {
        None => {
            planes.push(scalar("Z", grid.assemble(R::ZERO, |t, i| average(t, i).depth)));
            let ids = grid.assemble(NO_ID, |t, i| average(t, i).surfel);
            planes.push(named("id", Samples::Index(ids)));
            planes.push(scalar("layers", counts));
        }
        Some(first) => planes.extend(first.planes(&counts)),
    }
    planes
}

/// The last step: what the layers of a pixel make together, and what is refracted through them.
struct Tail<'a, R> {
    scene: &'a Scene,
    settings: &'a Settings,
    view: View<R>,
    first: Option<&'a First<R>>,
}

impl<R: Exact> Tail<'_, R> {
    /// The colour and the opacity of pixel `i` of a tile.
    fn pixel(&self, (tile, i): (usize, usize), rect: Rect, others: &Average<R>) -> Blend<R> {
        let columns = (rect.x1 - rect.x0) as usize;
        let (x, y) = (rect.x0 + (i % columns) as u32, rect.y0 + (i / columns) as u32);
        let Some(first) = self.first.filter(|first| first.target.depth.at(x, y).is_finite()) else {
            return others.blend;
        };
        let (alpha, near) = (first.alpha[tile][i], *first.color.at(x, y));
        let (Some(refraction), Some(environment)) =
            (&self.settings.refraction, &self.scene.environment)
        else {
            return others.blend.over(alpha, near);
        };
        let normal = first.target.normal.as_ref().map(|plane| *plane.at(x, y));
        let [nx, ny, nz] = normal.unwrap_or([R::ZERO; 3]);
        let nearest =
            NearestLayer { color: near, opacity: alpha, normal: Vector3::new(nx, ny, nz) };
        let Average { blend, opacity, hidden, .. } = *others;
        let behind = Behind { color: blend.color, opacity, hidden };
        let view = -self.view.ray(x, y).normalized();
        let color = optics::shade(environment, refraction, view, &nearest, &behind);
        Blend { color, alpha: R::ONE }
    }
}

/// The image of each group.
fn image_planes<R: Exact>(
    grid: &Grid,
    images: &[Vec<Vec<Layers<R>>>],
    groups: usize,
) -> Vec<NamedPlane<R>> {
    let groups = if images.is_empty() { 0 } else { groups };
    let of = |k: usize| {
        let at = |tile: usize, i: usize| &images[tile][k][i];
        let name = |plane: &str| format!("blended.group{k:02}{plane}");
        let counts = grid.assemble(0, |t, i| at(t, i).count);
        let ids = grid.assemble(NO_ID, |t, i| at(t, i).surfel);
        [
            color(&name(""), grid.assemble([R::ZERO; 3], |t, i| at(t, i).blend.color)),
            scalar(&name(".A"), grid.assemble(R::ZERO, |t, i| at(t, i).blend.alpha)),
            scalar(&name(".opacity"), grid.assemble(R::ZERO, |t, i| at(t, i).opacity)),
            scalar(&name(".bin"), grid.assemble(R::ZERO, |t, i| at(t, i).bin)),
            named(&name(".count"), Samples::Count(counts)),
            named(&name(".id"), Samples::Index(ids)),
        ]
    };
    (0..groups).flat_map(of).collect()
}

/// The averages of the compositing pass.
fn average_planes<'a, R: Exact>(
    grid: &Grid,
    at: impl Fn(usize, usize) -> &'a Average<R>,
) -> Vec<NamedPlane<R>> {
    let of = |value: &dyn Fn(&Average<R>) -> R| grid.assemble(R::ZERO, |t, i| value(at(t, i)));
    vec![
        color("blended", grid.assemble([R::ZERO; 3], |t, i| at(t, i).blend.color)),
        scalar("blended.A", of(&|average| average.blend.alpha)),
        scalar("blended.opacity", of(&|average| average.opacity)),
        scalar("blended.hidden", of(&|average| average.hidden)),
        scalar("blended.layers", of(&|average| average.layers)),
    ]
}
