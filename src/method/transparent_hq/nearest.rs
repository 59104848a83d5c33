//! Pass 1 of Algorithm 3: the nearest layer in high quality, by the single pass.

use super::Settings;
use crate::composite::sum;
use crate::error::Result;
use crate::frame::stencil::{Operation, Outcome};
use crate::frame::{Framebuffer, NamedPlane, Plane, Rect, Samples, Stencil, Wanted};
use crate::method::algorithm::Job;
use crate::method::picture::{color, named, scalar};
use crate::method::single_pass;
use crate::method::single_pass::plain::{Composite, Geometry, store};
use crate::method::transparent::blend::Average;
use crate::number::Exact;
use crate::shade::optics;
use crate::shade::phong::Shader;
use crate::splat::{Tally, View};

/// The stencil of pixels that the nearest layer covers: 1.
const MASK: Stencil = Stencil { reference: 1, pass: Operation::Replace, ..Stencil::DISABLED };

/// The nearest layer, composited and shaded: pass 1 of Algorithm 3.
pub(super) struct First<R> {
    pub(super) target: Framebuffer<R>,
    /// Phong-shaded.
    pub(super) color: Plane<[R; 3]>,
    /// Average opacity, by tile and pixel.
    pub(super) alpha: Vec<Vec<R>>,
    pub(super) tally: Tally,
}

impl<R: Exact> First<R> {
    /// Both passes and the shading; with `stages` their planes too.
    pub(super) fn new(
        job: &Job<'_>,
        settings: &Settings,
        stages: bool,
        planes: &mut Vec<NamedPlane<R>>,
    ) -> Result<Self> {
        let Job { scene, index, camera, exec } = *job;
        let settings =
            single_pass::Settings { splats: settings.layers.splats, depth: settings.nearest };
        let groups = index.groups()?;
        let geometry = Geometry::<R>::project(&scene.surfels, groups, camera, &settings, exec)?;
        let wanted =
            Wanted { normal: true, color: scene.surfels.color().is_some(), observed: stages };
        let mut target = Framebuffer::new(camera.width, camera.height, R::INFINITY, wanted);
        let done = geometry.each_tile(&mut target, exec, |index, mut tile| {
            let images = geometry.images(index, tile.rect);
            let composites = geometry.composite(&images);
            store(&composites, &mut tile);
            if let Some(stencil) = &mut tile.stencil {
                let columns = (tile.rect.x1 - tile.rect.x0) as usize;
                for (i, composite) in composites.iter().enumerate() {
                    let outcome =
                        if composite.count > 0 { Outcome::Pass } else { Outcome::DepthFail };
                    stencil.row(i / columns)[i % columns] = MASK.update(0, outcome);
                }
            }
            (stages.then_some(images), composites.iter().map(opacity).collect())
        });
        let (images, alpha): (Vec<_>, Vec<Vec<R>>) = done.into_iter().unzip();
        let images: Vec<_> = images.into_iter().flatten().collect();
        let shader = Shader::new(View::new(camera), &scene.lights, scene.material);
        let shaded = {
            let color = target.color.take();
            shader.shade(&target.depth, target.normal.as_ref(), None, color, exec)
        };
        if stages {
            let voronoi = settings.depth != single_pass::DepthTest::Plain;
            let kinds = (wanted.color, voronoi);
            planes.extend(single_pass::image_planes("nearest.", &geometry, &images, kinds));
            planes.push(color("nearest", shaded.clone()));
            let alphas = geometry.grid().assemble(R::ZERO, |tile, i| alpha[tile][i]);
            planes.push(scalar("nearest.A", alphas));
            planes.extend(target.stencil.take().map(|p| named("nearest.mask", Samples::Count(p))));
        }
        Ok(Self { target, color: shaded, alpha, tally: geometry.tally() })
    }

    /// The depths of a tile, row by row.
    pub(super) fn mask(&self, rect: Rect) -> Vec<R> {
        let (width, depth) = (self.target.width as usize, self.target.depth.values());
        let row = |y: u32| &depth[y as usize * width..][rect.x0 as usize..rect.x1 as usize];
        (rect.y0..rect.y1).flat_map(row).copied().collect()
    }

    /// l of \[ZP06, section 5.2.3\]: the sum of all opacities over that of the nearest layer.
    pub(super) fn layers(&self, (tile, i): (usize, usize), others: &Average<R>) -> R {
        let alpha = self.alpha[tile][i];
        if alpha > R::ZERO { R::ONE + optics::layers(others.opacity, alpha) } else { R::ZERO }
    }

    /// The planes of the picture that are those of the nearest layer, and the count of layers, that
    /// of the others and one where there is one.
    pub(super) fn planes(self, others: &Plane<R>) -> Vec<NamedPlane<R>> {
        let Framebuffer { depth, id, weight, normal, .. } = self.target;
        let mut layers = others.clone();
        for (count, depth) in layers.values_mut().iter_mut().zip(depth.values()) {
            *count = if depth.is_finite() { *count + R::ONE } else { *count };
        }
        let mut planes = vec![scalar("Z", depth)];
        planes.extend(normal.map(|p| named("normal", Samples::Vector(p))));
        planes.push(scalar("weight", weight));
        planes.push(named("id", Samples::Index(id)));
        planes.push(scalar("layers", layers));
        planes
    }
}

/// The average opacity of the nearest layer.
fn opacity<R: Exact>(composite: &Composite<R>) -> R {
    let sums = &composite.sums;
    let [alpha, ..] = sum::average([sums.opacity, R::ZERO, R::ZERO], sums.weight);
    // The quotient of two sums may exceed 1 by their rounding.
    alpha.at_most(R::ONE)
}
