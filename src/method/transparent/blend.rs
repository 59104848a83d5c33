//! The geometry pass of Algorithm 2: every layer of every group, blended from back to front.

use super::{Holes, Settings};
use crate::composite::bins::DepthBins;
use crate::composite::epsilon;
use crate::composite::over::Blend;
use crate::error::Result;
use crate::frame::{NO_ID, Rect};
use crate::method::algorithm::Job;
use crate::method::ewa::plain::{each_inside, facing};
use crate::method::prepare::Prepared;
use crate::number::{Exact, Vector3};
use crate::scene::Scene;
use crate::shade::phong::Shader;
use crate::splat::{Disc, Fate, Projector, Splat, Tally, View, batch, project};

/// A surfel in one of its groups, on the screen.
#[derive(Clone, Copy, Debug)]
struct Drawn<R> {
    splat: Splat<R>,
    group: u8,
    /// Shaded at the centre.
    color: [R; 3],
    alpha: R,
}

/// What the image of a group holds at a pixel.
#[derive(Clone, Copy, Debug)]
pub(in crate::method) struct Layers<R> {
    /// The bin of the nearest fragment so far; +inf where there is none.
    pub(in crate::method) bin: R,
    /// All fragments that passed, blended.
    pub(in crate::method) blend: Blend<R>,
    /// The sum of the opacities in front of the nearest opaque fragment.
    pub(in crate::method) opacity: R,
    /// 1 if an opaque fragment hides what is behind, else 0.
    pub(in crate::method) hidden: R,
    /// How many fragments passed, up to 255.
    pub(in crate::method) count: u8,
    /// Depth of the fragment that passed last, the nearest; +inf where there is none.
    pub(in crate::method) depth: R,
    /// Its surfel.
    pub(in crate::method) surfel: u32,
}

impl<R: Exact> Layers<R> {
    const EMPTY: Self = Self {
        bin: R::INFINITY,
        blend: Blend::CLEAR,
        opacity: R::ZERO,
        hidden: R::ZERO,
        count: 0,
        depth: R::INFINITY,
        surfel: NO_ID,
    };

    /// Blends a fragment that passed the depth test.
    fn add(&mut self, drawn: &Drawn<R>, bin: R, depth: R) {
        let Drawn { alpha, color, .. } = *drawn;
        let opaque = alpha >= R::ONE;
        *self = Self {
            bin,
            blend: self.blend.over(alpha, color),
            opacity: if opaque { R::ZERO } else { self.opacity + alpha },
            hidden: if opaque { R::ONE } else { self.hidden },
            count: self.count.saturating_add(1),
            depth,
            surfel: drawn.splat.surfel,
        };
    }
}

/// The splats of all groups, projected and sorted into tiles.
#[derive(Debug)]
pub(in crate::method) struct Blending<R> {
    prepared: Prepared<R, Drawn<R>>,
    bins: DepthBins<R>,
    groups: usize,
    holes: Holes,
}

impl<R: Exact> Blending<R> {
    /// Order, projection and shading.
    pub(in crate::method) fn project(job: &Job<'_>, settings: &Settings) -> Result<Self> {
        let Job { scene, index, camera, exec } = *job;
        let (groups, order) = (index.groups()?, index.order()?);
        let surfels = &scene.surfels;
        let epsilon = settings.splats.epsilon.resolve(surfels);
        let bins = DepthBins::new(&settings.bins.resolve(surfels, camera, epsilon)?);
        let mut items = Vec::with_capacity(surfels.len() + groups.added().len());
        for surfel in order.walk(camera) {
            items.extend(groups.of(surfel).map(|group| (surfel, group)));
        }
        let shader = Shader::new(View::new(camera), &scene.lights, scene.material);
        let grid = exec.grid(camera.width, camera.height);
        let prepared = Prepared::new(
            (surfels, items.len()),
            camera,
            &settings.splats,
            (exec, &grid),
            |projector, range, drawn| {
                let mut tally = Tally::default();
                for &(surfel, group) in &items[range] {
                    let scale = groups.scale()[usize::from(group)];
                    let (splat, fate) = place(scene, surfel, scale, projector);
                    tally.count(fate);
                    if fate == Fate::Visible {
                        let (color, alpha) = appearance(scene, &shader, &splat);
                        drawn.push(Drawn { splat, group, color, alpha });
                    }
                }
                tally
            },
            |drawn: &Drawn<R>| drawn.splat.bounds,
        );
        Ok(Self { prepared, bins, groups: groups.len(), holes: settings.holes })
    }

    /// What became of the surfels, each counted once in each of its groups.
    pub(in crate::method) fn tally(&self) -> Tally {
        self.prepared.tally
    }

    /// The geometry pass over one tile: the image of each group, row by row.
    ///
    /// With `mask`, the depth of the nearest layer at each pixel, fragments up to epsilon behind it
    /// are dropped.
    pub(in crate::method) fn images(
        &self,
        tile: usize,
        rect: Rect,
        mask: Option<&[R]>,
    ) -> Vec<Vec<Layers<R>>> {
        let (shared, band) = (&self.prepared.shared, self.prepared.epsilon);
        let mut images = vec![vec![Layers::EMPTY; rect.pixels()]; self.groups];
        self.prepared.for_each(tile, |drawn| {
            let image = &mut images[usize::from(drawn.group)];
            each_inside(shared, &drawn.splat, &rect, |i, _, nearness| {
                let depth = shared.depth(nearness);
                if mask.is_some_and(|mask| epsilon::visible(depth, mask[i], band)) {
                    return;
                }
                let bin = self.bins.bin(depth);
                if bin < image[i].bin {
                    image[i].add(drawn, bin, depth);
                }
            });
        });
        images
    }

    /// The compositing pass: the average of all groups at one pixel of their images.
    pub(in crate::method) fn average(&self, images: &[Vec<Layers<R>>], pixel: usize) -> Average<R> {
        let mut sum = Average::EMPTY;
        let mut count = 0_u8;
        for image in images {
            let layers = &image[pixel];
            count += u8::from(layers.count > 0 || self.holes == Holes::Background);
            sum.add(layers);
        }
        // An image that is left out has added zeros.
        if count == 0 { sum } else { sum.divided(R::from_f32(f32::from(count))) }
    }
}

/// The groups of a pixel together.
#[derive(Clone, Copy, Debug)]
pub(in crate::method) struct Average<R> {
    pub(in crate::method) blend: Blend<R>,
    /// See [`Layers::opacity`].
    pub(in crate::method) opacity: R,
    /// See [`Layers::hidden`].
    pub(in crate::method) hidden: R,
    /// Mean count of layers.
    pub(in crate::method) layers: R,
    /// Least depth of any group.
    pub(in crate::method) depth: R,
    /// Its surfel; ties: the lower one.
    pub(in crate::method) surfel: u32,
}

impl<R: Exact> Average<R> {
    pub(in crate::method) const EMPTY: Self = Self {
        blend: Blend::CLEAR,
        opacity: R::ZERO,
        hidden: R::ZERO,
        layers: R::ZERO,
        depth: R::INFINITY,
        surfel: NO_ID,
    };

    fn add(&mut self, layers: &Layers<R>) {
        self.blend = self.blend.plus(&layers.blend);
        self.opacity = self.opacity + layers.opacity;
        self.hidden = self.hidden + layers.hidden;
        self.layers = self.layers + R::from_f32(f32::from(layers.count));
        if (layers.depth, layers.surfel) < (self.depth, self.surfel) {
            (self.depth, self.surfel) = (layers.depth, layers.surfel);
        }
    }

    fn divided(self, count: R) -> Self {
        Self {
            blend: Blend {
                color: self.blend.color.map(|c| c / count),
                alpha: self.blend.alpha / count,
            },
            opacity: self.opacity / count,
            hidden: self.hidden / count,
            layers: self.layers / count,
            ..self
        }
    }
}

/// Projects a surfel that is enlarged.
fn place<R: Exact>(
    scene: &Scene,
    surfel: u32,
    scale: f32,
    projector: &Projector<R>,
) -> (Splat<R>, Fate) {
    let scale = R::from_f32(scale);
    let disc: Disc<R> = batch::disc(&scene.surfels, surfel as usize);
    let disc = Disc {
        radius: disc.radius * scale,
        tangents: disc.tangents.map(|[u, v]| [u * scale, v * scale]),
        ..disc
    };
    project(projector, &disc, surfel)
}

/// The shaded colour and the opacity of a surfel.
fn appearance<R: Exact>(scene: &Scene, shader: &Shader<R>, splat: &Splat<R>) -> ([R; 3], R) {
    let (surfels, i) = (&scene.surfels, splat.surfel as usize);
    let color = surfels.color().map_or(scene.material.color, |colors| colors[i]);
    let normal = surfels.normal()[i].to_array().map(R::from_f32);
    let [x, y, z] = facing(normal, splat.back);
    let place = Vector3::from_glam(surfels.position()[i]);
    let color = shader.surfel(place, Vector3::new(x, y, z), color.to_array().map(R::from_f32));
    (color, surfels.opacity().map_or(R::ONE, |opacity| R::from_f32(opacity[i])))
}
