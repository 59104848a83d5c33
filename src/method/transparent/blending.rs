//! The geometry pass of Algorithm 2: every layer of every group, blended from back to front.

use super::Settings;
use crate::composite::bins::DepthBins;
use crate::composite::decide;
use crate::composite::over::Blend;
use crate::error::Result;
use crate::frame::stencil::{Outcome, Stencil};
use crate::frame::{NO_ID, Rect};
use crate::index::Item;
use crate::method::Job;
use crate::method::buffer_formats::Buffers;
use crate::method::clock::{Work, spend};
use crate::method::fragment::{each_in_bounds, each_inside, facing};
use crate::method::prepare::Prepared;
use crate::number::{Exact, MapInline, Real, Vector3};
use crate::scene::Scene;
use crate::shade::phong::Shader;
use crate::splat::{Fate, Shared, Splat, Tally, View, batch, project};

/// A surfel in one of its groups, projected.
#[derive(Clone, Copy, Debug)]
pub(super) struct GroupSplat<R: Exact> {
    pub(super) splat: Splat<R>,
    pub(super) group: u8,
    /// The colour, shaded at the centre.
    color: [R; 3],
    pub(super) alpha: R,
}

/// The content of a group's image at a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct GroupLayers<R> {
    /// The bin of the nearest fragment so far; +inf where there is none.
    pub(crate) bin: R,
    /// The blend of all fragments that passed.
    pub(crate) blend: Blend<R>,
    /// The sum of the opacities in front of the nearest opaque fragment.
    pub(crate) opacity: R,
    /// 1 if an opaque fragment hides what is behind, else 0.
    pub(crate) hidden: R,
    /// How many fragments passed, up to 255.
    pub(crate) count: u8,
    /// Depth of the fragment that passed last, the nearest; +inf where there is none.
    pub(crate) depth: R,
    /// Surfel of that fragment.
    pub(crate) surfel: u32,
}

impl<R: Exact> GroupLayers<R> {
    /// No fragment.
    pub(super) const EMPTY: Self = Self {
        bin: R::INFINITY,
        blend: Blend::CLEAR,
        opacity: R::ZERO,
        hidden: R::ZERO,
        count: 0,
        depth: R::INFINITY,
        surfel: NO_ID,
    };

    /// The depth test: whether a fragment is in a nearer bin than all fragments before.
    pub(super) fn is_behind(&self, bin: R) -> bool {
        decide::nearer_bin(bin, self.bin)
    }

    /// Blends a fragment that passed the depth test.
    pub(super) fn add(&mut self, drawn: &GroupSplat<R>, bin: R, depth: R) {
        let GroupSplat { alpha, color, .. } = *drawn;
        // An opaque fragment hides everything that was blended before it.
        let opaque = decide::opaque(alpha);
        *self = Self {
            bin,
            blend: self.blend.over(alpha, color),
            opacity: if opaque { R::ZERO } else { self.opacity + alpha },
            hidden: if opaque { R::ONE } else { self.hidden },
            count: Stencil::COUNT.update(self.count, Outcome::Pass),
            depth,
            surfel: drawn.splat.surfel,
        };
    }
}

/// The splats of all groups, projected and sorted into tiles.
#[derive(Debug)]
pub(crate) struct Blending<R: Exact> {
    prepared: Prepared<R, GroupSplat<R>>,
    /// The bins of each group.
    pub(super) bins: Vec<DepthBins<R>>,
    buffers: Buffers,
}

impl<R: Exact> Blending<R> {
    /// Orders, projects and shades the surfels.
    pub(crate) fn project(job: &Job<'_>, settings: &Settings) -> Result<Self> {
        let (scene, groups) = (job.scene, job.index.groups()?);
        let surfels = &scene.surfels;
        let (items, bins) =
            (job.index.back_to_front(job.camera)?, settings.bins(job, groups.len())?);
        let shader = Shader::new(View::new(job.camera), &scene.lights, scene.material);
        let prepared = Prepared::new(
            job,
            &job.grid(),
            &settings.splats,
            items.len(),
            |projector, range, drawn| {
                let mut tally = Tally::default();
                for &Item { surfel, group } in &items[range] {
                    let scale = groups.scale()[usize::from(group)];
                    let disc = batch::enlarged(surfels, surfel, scale);
                    let (splat, reasons) = project(projector, &disc, surfel);
                    let fate = reasons.fate();
                    tally.count(fate);
                    if fate == Fate::Visible {
                        let (color, alpha) = appearance(scene, &shader, &splat);
                        drawn.push(GroupSplat { splat, group, color, alpha });
                    }
                }
                tally
            },
            |drawn: &GroupSplat<R>| drawn.splat.bounds,
        );
        Ok(Self { prepared, bins, buffers: job.buffers })
    }

    /// Counts the fate of the surfels; each counts once in each of its groups.
    pub(crate) fn tally(&self) -> Tally {
        self.prepared.tally
    }

    /// The constants that the fragments of all splats share.
    pub(super) fn shared(&self) -> &Shared<R> {
        &self.prepared.shared
    }

    /// The depth of the visible band in world units.
    pub(crate) fn epsilon(&self) -> R {
        self.prepared.epsilon
    }

    /// How many groups there are.
    pub(super) fn groups(&self) -> usize {
        self.bins.len()
    }

    /// The geometry pass over some pixels of a tile: the image of each group, row by row.
    ///
    /// `stays` receives the pixel, counted row by row, and the depth of a fragment. Fragments for
    /// which it does not hold are dropped.
    pub(crate) fn images(
        &self,
        tile: usize,
        rect: Rect,
        stays: impl Fn(usize, R) -> bool,
    ) -> Vec<Vec<GroupLayers<R>>> {
        spend(Work::Blend);
        let shared = self.shared();
        let mut images = vec![vec![GroupLayers::EMPTY; rect.pixels()]; self.groups()];
        self.prepared.for_each(tile, |drawn| {
            let group = usize::from(drawn.group);
            let (image, bins) = (&mut images[group], &self.bins[group]);
            each_inside(shared, &drawn.splat, &rect, |i, _, nearness| {
                let depth = shared.depth(nearness);
                if !stays(i, depth) {
                    return;
                }
                let bin = bins.bin(depth);
                if image[i].is_behind(bin) {
                    image[i].add(drawn, bin, depth);
                    image[i].blend = self.buffers.blend(image[i].blend);
                }
            });
        });
        images
    }

    /// Runs `visit` for every pixel of `rect` in the bounds of every splat, from back to front.
    /// `visit` receives the splat, q and nearness.
    pub(super) fn each_in_bounds(
        &self,
        tile: usize,
        rect: Rect,
        mut visit: impl FnMut(&GroupSplat<R>, R, R),
    ) {
        self.prepared.for_each(tile, |drawn| {
            each_in_bounds(self.shared(), &drawn.splat, &rect, |_, q, w| visit(drawn, q, w));
        });
    }
}

/// The shaded colour and the opacity of a surfel.
pub(crate) fn appearance<R: Real>(
    scene: &Scene,
    shader: &Shader<R>,
    splat: &Splat<R>,
) -> ([R; 3], R) {
    let (surfels, i) = (&scene.surfels, splat.surfel as usize);
    let color = surfels.color().map_or(scene.material.color, |colors| colors[i]);
    let normal = surfels.normal()[i].to_array().map_inline(R::from_f32);
    let [x, y, z] = facing(normal, splat.back);
    let place = Vector3::from_glam(surfels.position()[i]);
    let color =
        shader.surfel(place, Vector3::new(x, y, z), color.to_array().map_inline(R::from_f32));
    (color, R::from_f32(surfels.opacity_of(i)))
}
