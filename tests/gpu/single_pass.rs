//! Algorithm 1 with the rasterizer: the depth test chooses a fragment for each group and pixel, and
//! a full-screen pass composites the groups.

use crate::bugs::Bug;
use crate::device::{Gpu, all_layers, layer, view};
use crate::planes::{Planes, fours, last};
use crate::raster::{Draws, Pass, Target, fresh, run};
use crate::scenes::{Job, exec};
use splatref::frame::NO_ID;
use splatref::verdict::client::Client;
use wgpu::{BindingResource, CompareFunction, TextureFormat};

const SHADERS: [&str; 6] = [
    include_str!("shaders/view.wgsl"),
    include_str!("shaders/splat.wgsl"),
    include_str!("shaders/project.wgsl"),
    include_str!("shaders/average.wgsl"),
    include_str!("shaders/quads.wgsl"),
    include_str!("shaders/single_pass.wgsl"),
];

/// The steps of the Voronoi-enhanced depth in the depth buffer.
const VORONOI_STEPS: f32 = 131_072.0;

pub(crate) fn draw(gpu: &Gpu, job: &Job, bug: Bug) -> Client {
    let (exec, size) = (exec(), job.camera.size());
    let session = job.session(&exec);
    let own = session.groups().expect("groups of Algorithm 1").own().to_vec();
    let groups = own.iter().copied().max().map_or(1, |most| u32::from(most) + 1);
    let mut order: Vec<usize> = (0..own.len()).collect();
    order.sort_by_key(|&surfel| own[surfel]); // stable: ascending within a group
    let uniform = gpu.uniform(&job.view_words(order.len()));
    let surfels = gpu.storage(&job.words_of(&order));
    let module = gpu.module(&SHADERS);

    let images = |format| gpu.layers(size, groups, format);
    let [colors, normals] = [TextureFormat::Rgba32Float; 2].map(images);
    let (ids, tested) = (images(TextureFormat::R32Uint), images(TextureFormat::Depth32Float));
    let shared = [(0, uniform.as_entire_binding()), (2, surfels.as_entire_binding())];
    let mut encoder = gpu.encoder();
    for k in 0..groups {
        let at = |group: u32| order.partition_point(|&i| u32::from(own[i]) < group) as u32;
        let [color, normal, id, depth] =
            [&colors, &normals, &ids, &tested].map(|image| layer(image, k));
        let pass = Pass {
            draws: Draws::Quads,
            vertex: "quad_of_surfel",
            fragment: "geometry",
            targets: &[
                fresh(&color, 0.0),
                Target { clear: [0.0, 0.0, 0.0, f64::INFINITY], ..fresh(&normal, 0.0) }, // depth
                fresh(&id, NO_ID.into()),
            ],
            depth: Some((&depth, CompareFunction::Less)),
            resources: &shared,
            items: at(k)..at(k + 1),
        };
        run(gpu, &mut encoder, &module, bug, &pass);
    }

    let formats = [TextureFormat::Rgba32Float; 4];
    let sums = formats.map(|format| gpu.target(size, format));
    let [depth, id] =
        [TextureFormat::R32Float, TextureFormat::R32Uint].map(|format| gpu.target(size, format));
    let [color_sums, normal_sums, color, normal] = sums.each_ref().map(view);
    let (depth_view, id_view) = (view(&depth), view(&id));
    let [all_colors, all_normals, all_ids] = [&colors, &normals, &ids].map(all_layers);
    let read = |binding, view| (binding, BindingResource::TextureView(view));
    let compositing = Pass {
        draws: Draws::Screen,
        vertex: "whole_screen",
        fragment: "compositing",
        targets: &[
            fresh(&color_sums, 0.0),
            fresh(&normal_sums, 0.0),
            fresh(&depth_view, 0.0),
            fresh(&id_view, 0.0),
        ],
        depth: None,
        resources: &[
            shared[0].clone(),
            read(6, &all_colors),
            read(7, &all_normals),
            read(8, &all_ids),
        ],
        items: 0..0,
    };
    let normalization = Pass {
        fragment: "normalization",
        targets: &[fresh(&color, 0.0), fresh(&normal, 0.0)],
        resources: &[read(4, &color_sums), read(5, &normal_sums)],
        items: 0..0,
        ..compositing
    };
    for pass in [compositing, normalization] {
        run(gpu, &mut encoder, &module, bug, &pass);
    }
    gpu.queue.submit([encoder.finish()]);

    let mut planes = Planes::new(size);
    for k in 0..groups {
        let name = format!("group{k:02}");
        let [color, normal] =
            [&colors, &normals].map(|image| fours(&gpu.read_layer(image, k), false));
        let id: Vec<u32> = bytemuck::pod_collect_to_vec(&gpu.read_layer(&ids, k));
        let tested: Vec<f32> = bytemuck::pod_collect_to_vec(&gpu.read_layer(&tested, k));
        let voronoi = tested
            .iter()
            .zip(&id)
            .map(|(&v, &id)| if id == NO_ID { f32::INFINITY } else { v * VORONOI_STEPS });
        planes.scalar(&format!("{name}.voronoi"), voronoi.collect());
        planes.scalar(&format!("{name}.Z"), last(&normal));
        planes.scalar(&format!("{name}.weight"), last(&color));
        planes.vector(&format!("{name}.normal"), &normal);
        planes.color(&name, &color);
        planes.index(&format!("{name}.id"), id);
    }
    let [color_sums, normal_sums, color, normal] =
        sums.each_ref().map(|texture| fours(&gpu.read_texture(texture), false));
    planes.color("sums", &color_sums);
    planes.vector("sums.normal", &normal_sums);
    planes.scalar("sums.weight", last(&color_sums));
    planes.count("sums.count", last(&normal_sums).into_iter().map(|count| count as u32));
    planes.color("resolved", &color);
    planes.vector("normal", &normal);
    planes.scalar("Z", bytemuck::pod_collect_to_vec(&gpu.read_texture(&depth)));
    planes.index("id", bytemuck::pod_collect_to_vec(&gpu.read_texture(&id)));
    Client::from(planes.frame())
}
