//! Order, projection and shading.

use super::FastBlending;
use crate::error::Result;
use crate::index::Item;
use crate::method::algorithm::Job;
use crate::method::fast::tile::Record;
use crate::method::fragment::facing;
use crate::method::prepare::Prepared;
use crate::method::transparent::Settings;
use crate::method::transparent::blending::Ground;
use crate::number::Vector3;
use crate::number::lanes::{LANES, Lanes, components, put_vector, vectorized};
use crate::scene::Scene;
use crate::shade::phong::Shader;
use crate::splat::batch;

/// What is blended where a splat is one of a group.
#[derive(Clone, Copy)]
pub(in crate::method) struct Layer {
    /// Shaded at the centre.
    pub(super) color: [f32; 3],
    pub(super) alpha: f32,
    pub(super) group: u8,
    /// Whether the back of the surfel is seen.
    back: bool,
}

impl FastBlending {
    /// Every surfel in each of its groups, from back to front.
    pub(in crate::method) fn project(job: &Job<'_>, settings: &Settings) -> Result<Self> {
        let (scene, groups) = (job.scene, job.index.groups()?);
        let surfels = &scene.surfels;
        let Ground { items, bins, shader } = Ground::new(job, settings)?;
        let prepared = Prepared::new(
            job,
            &settings.splats,
            items.len(),
            |projector, range, records: &mut Vec<Record<Layer>>| {
                let items = &items[range];
                let enlarged = |item: &Item| (item.surfel, groups.scale()[usize::from(item.group)]);
                let list: Vec<_> = items.iter().map(enlarged).collect();
                let tally = batch::enlarged_f32(projector, surfels, &list, |place, splat| {
                    let (group, back) = (items[place].group, splat.back);
                    let (color, alpha) = ([0.0; 3], opacity(scene, splat.surfel));
                    records.push(Record::new(&splat, Layer { color, alpha, group, back }));
                });
                shade(records, scene, &shader);
                tally
            },
            Record::bounds,
        );
        Ok(Self { prepared, bins, holes: settings.holes })
    }
}

fn opacity(scene: &Scene, surfel: u32) -> f32 {
    scene.surfels.opacity().map_or(1.0, |all| all[surfel as usize])
}

vectorized!(
    /// Shades the splats, each at its centre.
    fn shade(records: &mut [Record<Layer>], scene: &Scene, shader: &Shader<f32>) {
        let surfels = &scene.surfels;
        let (positions, normals) = (surfels.position(), surfels.normal());
        for records in records.chunks_mut(LANES) {
            // Lanes without a splat show the null vector in black.
            let zero = [[0.0; LANES]; 3];
            let (mut position, mut normal, mut surface): ([Lanes; 3], [Lanes; 3], [Lanes; 3]) =
                (zero, zero, zero);
            for (i, record) in records.iter().enumerate() {
                let surfel = record.surfel as usize;
                let [x, y, z] = facing(normals[surfel].to_array(), record.attributes.back);
                let color = surfels.color().map_or(scene.material.color, |colors| colors[surfel]);
                put_vector(&mut position, i, Vector3::from_glam(positions[surfel]));
                put_vector(&mut normal, i, Vector3::new(x, y, z));
                put_vector(&mut surface, i, Vector3::from_glam(color));
            }
            let color = shader.surfels(&position, &normal, &surface);
            for (i, record) in records.iter_mut().enumerate() {
                record.attributes.color = components(&color, i);
            }
        }
    }
);
