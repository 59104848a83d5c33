//! Order, project and shade the surfels.

use super::FastBlending;
use crate::error::Result;
use crate::index::members::Set;
use crate::index::order::Part;
use crate::method::Job;
use crate::method::fast::tile::{Record, Surface};
use crate::method::fragment::facing;
use crate::method::prepare::{Prepared, batch_size};
use crate::method::transparent::Settings;
use crate::number::Vector3;
use crate::number::lanes::{LANES, Lanes, components, put_vector, vectorized};
use crate::scene::Surfels;
use crate::shade::phong::Shader;
use crate::splat::batch::Enlarged;
use crate::splat::{Splat, Tally, View, batch};
use glam::Vec3;

/// The layer of a splat that belongs to some groups.
#[derive(Clone, Copy)]
pub(crate) struct Layer {
    /// The colour, shaded at the centre.
    pub(super) color: [f32; 3],
    pub(crate) alpha: f32,
    /// The groups that draw the surfel.
    pub(super) groups: Set,
    /// The surfel's own group.
    pub(crate) own: u8,
    /// Whether the back of the surfel is seen.
    back: bool,
}

/// The attributes in the record of a splat that is blended.
pub(crate) trait Blended: AsRef<Layer> + AsMut<Layer> + Copy + Send + Sync {
    /// Makes the attributes from the layer, and from the splat and its surfels.
    fn new(layer: Layer, splat: &Splat<f32>, surfels: &Surfels) -> Self;
}

impl AsRef<Self> for Layer {
    fn as_ref(&self) -> &Self {
        self
    }
}

impl AsMut<Self> for Layer {
    fn as_mut(&mut self) -> &mut Self {
        self
    }
}

impl Blended for Layer {
    #[inline(always)]
    fn new(layer: Layer, _: &Splat<f32>, _: &Surfels) -> Self {
        layer
    }
}

/// A splat that is blended, and also averaged in a nearest layer.
#[derive(Clone, Copy)]
pub(crate) struct LayerOfSurface {
    layer: Layer,
    pub(crate) surface: Surface,
}

impl LayerOfSurface {
    /// The record of the splat for the nearest layer.
    #[inline(always)]
    pub(crate) fn surface(record: &Record<Self>) -> Record {
        let Record { footprint, surfel, bounds, attributes } = *record;
        Record { footprint, surfel, bounds, attributes: attributes.surface }
    }
}

impl AsRef<Layer> for LayerOfSurface {
    fn as_ref(&self) -> &Layer {
        &self.layer
    }
}

impl AsMut<Layer> for LayerOfSurface {
    fn as_mut(&mut self) -> &mut Layer {
        &mut self.layer
    }
}

impl Blended for LayerOfSurface {
    #[inline(always)]
    fn new(layer: Layer, splat: &Splat<f32>, surfels: &Surfels) -> Self {
        Self { layer, surface: Surface::new(splat, surfels.normal(), surfels.color()) }
    }
}

impl<A: Blended> FastBlending<A> {
    /// Projects every surfel from back to front, once for all groups that draw it alike. `times`
    /// says how often a surfel counts that some groups draw.
    pub(crate) fn project(
        job: &Job<'_>,
        settings: &Settings,
        times: impl Fn(Set) -> u32 + Sync + Send,
    ) -> Result<Self> {
        let Job { scene, index, camera, .. } = *job;
        let (groups, order, members) = (index.groups()?, index.order()?, index.members()?);
        let bins = settings.bins(job, groups.len())?;
        let shader = Shader::new(View::new(camera), &scene.lights, scene.material);
        // Until their layers are shaded, surfels carry their places in the tree.
        let surfels = &members.surfels;
        let grid = job.strips();
        let size = batch_size(&grid, surfels.len());
        let prepared = Prepared::of_batches(
            job,
            &grid,
            &settings.splats,
            batches(order.parts(camera, size.div_ceil(2)), size),
            |projector, parts: Vec<Part>, records: &mut Vec<Record<A>>| {
                let count = parts.iter().map(Part::len).sum();
                let (mut list, mut sets) = (Vec::with_capacity(count), Vec::with_capacity(count));
                for part in &parts {
                    order.walk_part(part, |place| {
                        members.each_scale(place, |scale, groups| {
                            let (surfel, times) = (place as u32, times(groups));
                            list.push(Enlarged { surfel, scale, times });
                            sets.push(groups);
                        });
                    });
                }
                records.reserve_exact(list.len());
                let tally = batch::enlarged_f32(projector, surfels, &list, |place, splat| {
                    let i = splat.surfel as usize;
                    let alpha = surfels.opacity_of(i);
                    let (groups, own, back) = (sets[place], members.own[i], splat.back);
                    let layer = Layer { color: [0.0; 3], alpha, groups, own, back };
                    records.push(Record::new(&splat, A::new(layer, &splat, surfels)));
                });
                shade(records, surfels, scene.material.color, &shader);
                for record in records {
                    record.surfel = order.index(record.surfel as usize);
                }
                tally
            },
            Record::bounds,
        );
        Ok(Self { prepared, bins, holes: settings.holes })
    }

    /// Counts the fates of the surfels.
    pub(crate) fn tally(&self) -> Tally {
        self.prepared.tally
    }
}

/// Joins parts that follow one another into batches of `size` surfels or a few more.
fn batches(parts: Vec<Part>, size: usize) -> Vec<Vec<Part>> {
    let mut batches = Vec::new();
    let (mut batch, mut count) = (Vec::new(), 0);
    for part in parts {
        count += part.len();
        batch.push(part);
        if count >= size {
            batches.push(std::mem::take(&mut batch));
            count = 0;
        }
    }
    batches.extend((!batch.is_empty()).then_some(batch));
    batches
}

vectorized!(
    /// Shades the splats, each at its centre; `own` is the colour of surfels that have none.
    fn shade<A: Blended>(
        records: &mut [Record<A>],
        surfels: &Surfels,
        own: Vec3,
        shader: &Shader<f32>,
    ) {
        let (positions, normals) = (surfels.position(), surfels.normal());
        for records in records.chunks_mut(LANES) {
            // Lanes without a splat shade the null vector in black.
            let zero = [[0.0; LANES]; 3];
            let (mut position, mut normal, mut surface): ([Lanes; 3], [Lanes; 3], [Lanes; 3]) =
                (zero, zero, zero);
            for (i, record) in records.iter().enumerate() {
                let surfel = record.surfel as usize;
                let back = record.attributes.as_ref().back;
                let [x, y, z] = facing(normals[surfel].to_array(), back);
                let color = surfels.color().map_or(own, |colors| colors[surfel]);
                put_vector(&mut position, i, Vector3::from_glam(positions[surfel]));
                put_vector(&mut normal, i, Vector3::new(x, y, z));
                put_vector(&mut surface, i, Vector3::from_glam(color));
            }
            let color = shader.surfels(&position, &normal, &surface);
            for (i, record) in records.iter_mut().enumerate() {
                record.attributes.as_mut().color = components(&color, i);
            }
        }
    }
);
