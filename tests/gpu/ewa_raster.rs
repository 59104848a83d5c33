//! EWA with the rasterizer: a visibility pass into a depth buffer, an attribute pass that blends,
//! and a full-screen pass that normalizes.

use crate::bugs::Bug;
use crate::device::{Gpu, view};
use crate::planes::{Planes, fours, last};
use crate::raster::{Draws, Pass, Target, fresh, run};
use crate::scenes::{Job, record_words};
use splatref::verdict::client::{Client, Storage};
use wgpu::{BindingResource, CompareFunction, TextureFormat};

const SHADERS: [&str; 6] = [
    include_str!("shaders/view.wgsl"),
    include_str!("shaders/splat.wgsl"),
    include_str!("shaders/project.wgsl"),
    include_str!("shaders/average.wgsl"),
    include_str!("shaders/quads.wgsl"),
    include_str!("shaders/ewa_raster.wgsl"),
];

/// Which of the clients.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Variant {
    /// Whether splatref projects, and the client uploads its records.
    pub(crate) records: bool,
    /// Whether the sums are blended in 16-bit floats.
    pub(crate) half: bool,
    pub(crate) bug: Bug,
}

pub(crate) fn draw(gpu: &Gpu, job: &Job, variant: Variant) -> Client {
    let size = job.camera.size();
    let records = variant.records.then(|| job.records());
    let (splats, count) = match &records {
        Some(records) => (gpu.storage(&record_words(records)), records.len()),
        None => (gpu.storage(&job.surfel_words()), job.scene.surfels.len()),
    };
    let items = count as u32 - u32::from(variant.bug == Bug::OneMissing);
    let (binding, vertex) =
        if variant.records { (1, "quad_of_record") } else { (2, "quad_of_surfel") };
    let uniform = gpu.uniform(&job.view_words(count));
    let module = gpu.module(&SHADERS);

    let half = variant.half || variant.bug == Bug::HalfSums;
    let sums = if half { TextureFormat::Rgba16Float } else { TextureFormat::Rgba32Float };
    let depths = if variant.bug == Bug::ShallowDepth {
        TextureFormat::Depth16Unorm
    } else {
        TextureFormat::Depth32Float
    };
    let depth_buffer = gpu.target(size, depths);
    let [depth, id] =
        [TextureFormat::R32Float, TextureFormat::R32Uint].map(|format| gpu.target(size, format));
    let [color_sums, normal_sums] = [sums; 2].map(|format| gpu.target(size, format));
    let [color, normal] = [TextureFormat::Rgba32Float; 2].map(|format| gpu.target(size, format));

    let nearer = match (job.perspective(), variant.bug == Bug::LastOfTies) {
        (true, false) => CompareFunction::Greater,
        (true, true) => CompareFunction::GreaterEqual,
        (false, false) => CompareFunction::Less,
        (false, true) => CompareFunction::LessEqual,
    };
    let [depth_view, id_view, colors_view, normals_view, color_view, normal_view, tested] =
        [&depth, &id, &color_sums, &normal_sums, &color, &normal, &depth_buffer].map(view);
    let shared = [(0, uniform.as_entire_binding()), (binding, splats.as_entire_binding())];
    let read = |binding, view| (binding, BindingResource::TextureView(view));
    let passes = [
        Pass {
            draws: Draws::Quads,
            vertex,
            fragment: "visibility",
            targets: &[fresh(&depth_view, f64::INFINITY), fresh(&id_view, u32::MAX.into())],
            depth: Some((&tested, nearer)),
            resources: &shared,
            items: 0..items,
        },
        Pass {
            draws: Draws::Quads,
            vertex,
            fragment: "attributes",
            targets: &[&colors_view, &normals_view].map(|v| Target { adds: true, ..fresh(v, 0.0) }),
            depth: None,
            resources: &[shared[0].clone(), shared[1].clone(), read(3, &depth_view)],
            items: 0..items,
        },
        Pass {
            draws: Draws::Screen,
            vertex: "whole_screen",
            fragment: "normalization",
            targets: &[fresh(&color_view, 0.0), fresh(&normal_view, 0.0)],
            depth: None,
            resources: &[read(4, &colors_view), read(5, &normals_view)],
            items: 0..0,
        },
    ];
    let mut encoder = gpu.encoder();
    for pass in &passes {
        run(gpu, &mut encoder, &module, variant.bug, pass);
    }
    gpu.queue.submit([encoder.finish()]);

    let mut planes = Planes::new(size);
    let z: Vec<f32> = bytemuck::pod_collect_to_vec(&gpu.read_texture(&depth));
    let ids: Vec<u32> = bytemuck::pod_collect_to_vec(&gpu.read_texture(&id));
    let [color_sums, normal_sums] =
        [&color_sums, &normal_sums].map(|texture| fours(&gpu.read_texture(texture), half));
    let [color, normal] = [&color, &normal].map(|texture| fours(&gpu.read_texture(texture), false));
    planes.scalar("visibility.Z", z.clone());
    planes.index("visibility.id", ids.clone());
    planes.color("attributes", &color_sums);
    planes.vector("attributes.normal", &normal_sums);
    planes.scalar("attributes.weight", last(&color_sums));
    planes.count("attributes.count", last(&normal_sums).into_iter().map(|count| count as u32));
    planes.color("resolved", &color);
    planes.vector("normal", &normal);
    planes.scalar("Z", z);
    planes.index("id", ids);
    let mut client = Client::from(planes.frame());
    client.records = records;
    if variant.half {
        client.accumulator = Storage::Half;
        for plane in ["attributes", "attributes.normal", "attributes.weight"] {
            client = client.stored(plane, Storage::Half);
        }
    }
    client
}
