//! EWA in compute kernels.

use crate::bugs::Bug;
use crate::device::Gpu;
use crate::planes::{Planes, last};
use crate::scenes::{Job, record_words};
use splatref::splat::record::SplatRecord;
use splatref::verdict::client::Client;

const SHADERS: [&str; 5] = [
    include_str!("shaders/view.wgsl"),
    include_str!("shaders/splat.wgsl"),
    include_str!("shaders/project.wgsl"),
    include_str!("shaders/average.wgsl"),
    include_str!("shaders/ewa_compute.wgsl"),
];

/// Words of a record and of a `Pixel`.
const RECORD: usize = SplatRecord::SIZE / 4;
const PIXEL: usize = 16;

/// Draws from splatref's records, or from its own, which it hands in too.
pub(crate) fn draw(gpu: &Gpu, job: &Job, uploads: bool, bug: Bug) -> Client {
    let (module, constants) = (gpu.module(&SHADERS), bug.constants());
    let records = if uploads { job.records() } else { project(gpu, job, &module, bug) };
    let size @ [width, height] = job.camera.size();
    let uniform = gpu.uniform(&job.view_words(records.len()));
    let splats = gpu.storage(&record_words(&records));
    let pixels = gpu.output(PIXEL * (width * height) as usize);
    let mut encoder = gpu.encoder();
    let resources = [
        (0, uniform.as_entire_binding()),
        (1, splats.as_entire_binding()),
        (4, pixels.as_entire_binding()),
    ];
    let gather = gpu.compute(&module, "gather", &constants);
    gpu.dispatch(&mut encoder, &gather, &resources, [width.div_ceil(8), height.div_ceil(8)]);
    let words = gpu.read_buffer(encoder, &pixels);

    let pixels: &[[u32; PIXEL]] = words.as_chunks().0;
    let four = |at: usize| -> Vec<[f32; 4]> {
        pixels.iter().map(|pixel| [0, 1, 2, 3].map(|i| f32::from_bits(pixel[at + i]))).collect()
    };
    let [color_sums, normal_sums, color, normal] = [0, 4, 8, 12].map(four);
    let mut planes = Planes::new(size);
    planes.scalar("visibility.Z", last(&color));
    planes.index("visibility.id", pixels.iter().map(|pixel| pixel[15]).collect());
    planes.color("attributes", &color_sums);
    planes.vector("attributes.normal", &normal_sums);
    planes.scalar("attributes.weight", last(&color_sums));
    planes.count("attributes.count", pixels.iter().map(|pixel| pixel[7]));
    planes.color("resolved", &color);
    planes.vector("normal", &normal);
    let mut client = Client::from(planes.frame());
    client.records = Some(records);
    client
}

/// The visible splats, projected on the device.
fn project(gpu: &Gpu, job: &Job, module: &wgpu::ShaderModule, bug: Bug) -> Vec<SplatRecord> {
    let count = job.scene.surfels.len();
    let uniform = gpu.uniform(&job.view_words(count));
    let surfels = gpu.storage(&job.surfel_words());
    let projected = gpu.output(RECORD * count);
    let mut encoder = gpu.encoder();
    let resources = [
        (0, uniform.as_entire_binding()),
        (2, surfels.as_entire_binding()),
        (3, projected.as_entire_binding()),
    ];
    let kernel = gpu.compute(module, "project_all", &bug.constants());
    gpu.dispatch(&mut encoder, &kernel, &resources, [(count as u32).div_ceil(64), 1]);
    let bytes: Vec<u8> = bytemuck::pod_collect_to_vec(&gpu.read_buffer(encoder, &projected));
    let records = bytes.as_chunks().0.iter().map(SplatRecord::from_bytes);
    records
        .filter(|record| record.bounds[2] > record.bounds[0] && record.bounds[3] > record.bounds[1])
        .collect()
}
