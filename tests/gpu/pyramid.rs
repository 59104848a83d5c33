//! The pull-push pyramid: the rasterizer draws points, compute kernels pull and push.

use crate::bugs::Bug;
use crate::device::{Gpu, view};
use crate::planes::{Planes, fours, last};
use crate::raster::{Draws, Pass, fresh, run};
use crate::scenes::Job;
use splatref::frame::NO_ID;
use splatref::frame::pyramid::sizes;
use splatref::verdict::client::Client;
use wgpu::{BindingResource, Buffer, CompareFunction, Texture, TextureFormat};

const SHADERS: [&str; 4] = [
    include_str!("shaders/view.wgsl"),
    include_str!("shaders/splat.wgsl"),
    include_str!("shaders/project.wgsl"),
    include_str!("shaders/pyramid.wgsl"),
];

/// Words of a `Cell`.
const CELL: usize = 12;

pub(crate) fn draw(gpu: &Gpu, job: &Job, bug: Bug) -> Client {
    let size = job.camera.size();
    let module = gpu.module(&SHADERS);
    let count = job.scene.surfels.len();
    let uniform = gpu.uniform(&job.view_words(count));
    let surfels = gpu.storage(&job.surfel_words());
    let id = gpu.target(size, TextureFormat::R32Uint);
    let [normal, color, center] =
        [TextureFormat::Rgba32Float; 3].map(|format| gpu.target(size, format));
    let tested = gpu.target(size, TextureFormat::Depth32Float);
    let [id_view, normal_view, color_view, center_view, tested_view] =
        [&id, &normal, &color, &center, &tested].map(view);
    let far = [0.0, 0.0, 0.0, f64::INFINITY];
    let points = Pass {
        draws: Draws::Points,
        vertex: "point",
        fragment: "projection",
        targets: &[
            fresh(&id_view, NO_ID.into()),
            crate::raster::Target { clear: far, ..fresh(&normal_view, 0.0) },
            fresh(&color_view, 0.0),
            fresh(&center_view, 0.0),
        ],
        depth: Some((&tested_view, CompareFunction::Less)),
        resources: &[(0, uniform.as_entire_binding()), (2, surfels.as_entire_binding())],
        items: 0..count as u32,
    };
    let mut encoder = gpu.encoder();
    run(gpu, &mut encoder, &module, bug, &points);

    let levels = Levels::new(size);
    let [pulled, pushed] = [0, 1].map(|_| gpu.output(CELL * levels.cells()));
    let read = |binding, view| (binding, BindingResource::TextureView(view));
    let kernel = |entry| gpu.compute(&module, entry, &bug.constants());
    let first = levels.step(gpu, 0);
    let mut resources = vec![
        (0, uniform.as_entire_binding()),
        read(3, &id_view),
        read(4, &normal_view),
        read(5, &color_view),
        read(6, &center_view),
        (7, pulled.as_entire_binding()),
        (9, first.as_entire_binding()),
    ];
    let groups = |[width, height]: [u32; 2]| [width.div_ceil(8), height.div_ceil(8)];
    gpu.dispatch(&mut encoder, &kernel("finest"), &resources, groups(size));
    resources.retain(|(binding, _)| [0, 7].contains(binding));
    let (pull, push) = (kernel("pull"), kernel("push"));
    let last_level = levels.sizes.len() - 1;
    for level in 0..last_level {
        let step = levels.step(gpu, level);
        let resources = [resources.clone(), vec![(9, step.as_entire_binding())]].concat();
        gpu.dispatch(&mut encoder, &pull, &resources, groups(levels.sizes[level + 1]));
    }
    let (at, bytes) = (4 * CELL * levels.first[last_level], 4 * CELL);
    encoder.copy_buffer_to_buffer(&pulled, at as u64, &pushed, at as u64, bytes as u64);
    resources.push((8, pushed.as_entire_binding()));
    for level in (0..last_level).rev() {
        let step = levels.step(gpu, level);
        let resources = [resources.clone(), vec![(9, step.as_entire_binding())]].concat();
        gpu.dispatch(&mut encoder, &push, &resources, groups(levels.sizes[level]));
    }
    gpu.queue.submit([encoder.finish()]);

    let mut planes = Planes::new(size);
    samples(gpu, &mut planes, &id, [&normal, &color, &center]);
    for (name, cells, range) in
        [("pull", &pulled, 1..last_level + 1), ("push", &pushed, 0..last_level)]
    {
        let words = gpu.read_buffer(gpu.encoder(), cells);
        for level in range {
            levels.planes(&mut planes, &format!("{name}{level:02}"), level, &words);
        }
    }
    Client::from(planes.frame())
}

/// The planes of the projection.
fn samples(gpu: &Gpu, planes: &mut Planes, id: &Texture, [normal, color, center]: [&Texture; 3]) {
    let ids: Vec<u32> = bytemuck::pod_collect_to_vec(&gpu.read_texture(id));
    let [normal, color, center] =
        [normal, color, center].map(|texture| fours(&gpu.read_texture(texture), false));
    planes.count("projection.kind", ids.iter().map(|&id| u32::from(id != NO_ID)));
    planes.index("projection.id", ids);
    planes.scalar("projection.Z", last(&normal));
    planes.vector("projection.normal", &normal);
    planes.scalar("projection.extent", last(&color));
    planes.color("projection", &color);
    planes.scalar("projection.radius", center.iter().map(|sample| sample[2]).collect());
    planes.scalar("projection.center.X", center.iter().map(|sample| sample[0]).collect());
    planes.scalar("projection.center.Y", center.iter().map(|sample| sample[1]).collect());
}

/// The levels of a picture, and their places in a buffer of cells.
struct Levels {
    size: [u32; 2],
    sizes: Vec<[u32; 2]>,
    first: Vec<usize>,
}

impl Levels {
    fn new(size @ [width, height]: [u32; 2]) -> Self {
        let sizes = sizes(width, height);
        let mut first = vec![0];
        for [width, height] in &sizes {
            first.push(first[first.len() - 1] + (width * height) as usize);
        }
        Self { size, sizes, first }
    }

    fn cells(&self) -> usize {
        self.first[self.sizes.len()]
    }

    /// `Step` of `pyramid.wgsl`, from a level to the next coarser one.
    fn step(&self, gpu: &Gpu, level: usize) -> Buffer {
        let coarse = (level + 1).min(self.sizes.len() - 1);
        let ([w, h], [coarse_w, coarse_h]) = (self.sizes[level], self.sizes[coarse]);
        let at = [level, coarse].map(|level| self.first[level] as u32);
        let side = ((1_u32 << level) as f32).to_bits();
        gpu.uniform(&[w, h, coarse_w, coarse_h, at[0], at[1], side, 0])
    }

    /// The planes of a level, in the upper left corner of the picture.
    fn planes(&self, planes: &mut Planes, name: &str, level: usize, words: &[u32]) {
        let ([width, _], [level_width, level_height]) = (self.size, self.sizes[level]);
        let cells: &[[u32; CELL]] = words.as_chunks().0;
        let mut empty = [0.0; CELL];
        (empty[8], empty[9]) = (f32::INFINITY, f32::NEG_INFINITY);
        let empty = empty.map(f32::to_bits);
        let whole: Vec<[u32; CELL]> = (0..width * self.size[1])
            .map(|i| (i % width, i / width))
            .map(|(x, y)| {
                let inside = x < level_width && y < level_height;
                let at = self.first[level] + (y * level_width + x) as usize;
                if inside { cells[at] } else { empty }
            })
            .collect();
        let number = |i: usize| whole.iter().map(|cell| f32::from_bits(cell[i])).collect();
        let four = |i: usize| -> Vec<[f32; 4]> {
            whole.iter().map(|cell| [0, 1, 2, 3].map(|k| f32::from_bits(cell[i + k]))).collect()
        };
        planes.count(&format!("{name}.kind"), whole.iter().map(|cell| cell[3]));
        planes.vector(&format!("{name}.normal"), &four(0));
        planes.color(name, &four(4));
        for (part, at) in [
            ("extent", 7),
            ("front", 8),
            ("back", 9),
            ("displacement.X", 10),
            ("displacement.Y", 11),
        ] {
            planes.scalar(&format!("{name}.{part}"), number(at));
        }
    }
}
