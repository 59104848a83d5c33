//! Speed of the image-space methods: the timing tables of \[MKC08\] and \[MOC08\], measured again.
//!
//! `cargo bench --bench image_space` prints Markdown, and with `--write` puts the table into
//! `docs/image-space.md`; an argument is a pattern that the names of rows must contain. The papers'
//! models are stood for by samplings of the dragon with as many points (`SPLATREF_MODELS` names the
//! folder of the scan; without it the sphere is sampled), each with the spacing as its radius, in a
//! picture that it fills. One headlight, back faces culled, `f32`, as many threads as cores. Each
//! number is the median over the pictures of one run in milliseconds, the minimum in brackets;
//! `frame` is the whole call, from the scene to shaded planes in the memory of the picture before.
//! `traffic` is the time that as many threads need for the memory traffic of the projection alone:
//! read 28 bytes of every surfel, write 24 for each that is seen, and read those again.

mod common;

use common::models::{models, resample};
use common::report::{Arguments, Table};
use common::sphere::cell;
use splatref::Result;
use splatref::frame::Exec;
use splatref::method::pyramid::{self, Weights};
use splatref::method::{Method, Session, template};
use splatref::scene::{Camera, Cloud, Lens, Scene, Surfels};
use splatref::source::Shape;
use std::time::{Duration, Instant};

/// A row of a paper's table: model, points, and the frame time in ms on a GPU of 2008.
struct Row {
    model: &'static str,
    count: usize,
    paper: f64,
}

const fn row(model: &'static str, count: usize, paper: f64) -> Row {
    Row { model, count, paper }
}

/// \[MKC08, Table 1\], without colours, 1024 x 1024.
const PYRAMID: [Row; 5] = [
    row("Armadillo", 173_000, 11.0),
    row("Dragon", 437_000, 13.0),
    row("Happy Buddha", 544_000, 13.0),
    row("Asian Dragon", 3_610_000, 28.0),
    row("Thai Statue", 5_000_000, 35.0),
];

/// The same with colours.
const COLORED: [Row; 5] = [
    row("Armadillo", 173_000, 22.0),
    row("Dragon", 437_000, 23.0),
    row("Happy Buddha", 544_000, 24.0),
    row("Asian Dragon", 3_610_000, 45.0),
    row("Thai Statue", 5_000_000, 55.0),
];

/// \[MOC08, Table 1\], 768 x 768, from frames a second: 3 x 3. The paper does not say whether its
/// models had colours; the authors' program interpolates them always.
const TEMPLATE_3: [Row; 5] = [
    row("Armadillo", 173_000, 1000.0 / 43.0),
    row("Happy Buddha", 544_000, 1000.0 / 40.0),
    row("Neptune", 2_004_000, 1000.0 / 28.5),
    row("Asian Dragon", 3_610_000, 1000.0 / 20.5),
    row("Statuette", 5_000_000, 1000.0 / 15.5),
];

/// The same, 5 x 5.
const TEMPLATE_5: [Row; 5] = [
    row("Armadillo", 173_000, 1000.0 / 24.0),
    row("Happy Buddha", 544_000, 1000.0 / 23.0),
    row("Neptune", 2_004_000, 1000.0 / 19.0),
    row("Asian Dragon", 3_610_000, 1000.0 / 15.0),
    row("Statuette", 5_000_000, 1000.0 / 12.5),
];

/// 7 x 7, which the paper names and does not time.
const TEMPLATE_7: [Row; 5] = [
    row("Armadillo", 173_000, f64::NAN),
    row("Happy Buddha", 544_000, f64::NAN),
    row("Neptune", 2_004_000, f64::NAN),
    row("Asian Dragon", 3_610_000, f64::NAN),
    row("Statuette", 5_000_000, f64::NAN),
];

fn main() -> Result<()> {
    let arguments = Arguments::parse()?;
    let dragon = models("dragon", &arguments)?.pop();
    let scans = dragon.map(|(_, cloud)| cloud);
    let pyramid = Method::Pyramid(pyramid::Settings::default());
    let boxed = pyramid::Settings { weights: Weights::Box, ..pyramid::Settings::default() };
    let of = |size| Method::Template(template::Settings { size, ..template::Settings::default() });
    let tables: [(&str, Method, &[Row], u32, bool); 8] = [
        ("pyramid", pyramid, &PYRAMID, 1024, false),
        ("pyramid, box", Method::Pyramid(boxed), &PYRAMID[..1], 1024, false),
        ("pyramid, colours", pyramid, &COLORED, 1024, true),
        ("template 3 x 3", of(3), &TEMPLATE_3, 768, false),
        ("template 3 x 3, colours", of(3), &TEMPLATE_3, 768, true),
        ("template 5 x 5", of(5), &TEMPLATE_5, 768, false),
        ("template 5 x 5, colours", of(5), &TEMPLATE_5, 768, true),
        ("template 7 x 7", of(7), &TEMPLATE_7, 768, false),
    ];
    let mut table = Table::new(&[
        "method",
        "paper's model",
        "points",
        "paper, ms",
        "frame, ms",
        "ratio",
        "stages, ms",
        "traffic, ms",
    ]);
    for (name, method, rows, side, colored) in tables {
        for row in rows.iter().filter(|_| name.contains(&arguments.pattern)) {
            let scene = scene(scans.as_ref(), row.count, colored)?;
            let mut sphere = scene.surfels.bounding_sphere();
            sphere.radius *= 0.8;
            let side_on = glam::DVec3::new(0.25, 0.25, 1.0);
            let lens = Lens::FieldOfView(34.0);
            let camera = Camera::framing(side, side, sphere, side_on, lens)?;
            let exec = Exec::new(0, 32)?;
            let (mut frames, stages, seen) = measure(&scene, &camera, &method, &exec)?;
            let mut points = vec![[1; 6]; row.count];
            let mut moved = || traffic(&scene.surfels, seen, &exec, &mut points);
            let mut traffic: Vec<_> = (0..9).map(|_| moved()).collect();
            let frame = median(&mut frames);
            let stages: Vec<String> =
                stages.into_iter().map(|(n, mut t)| format!("{n} {}", cell(&mut t))).collect();
            let [paper, ratio] = if row.paper.is_nan() {
                [String::new(), String::new()]
            } else {
                [format!("{:.1}", row.paper), format!("{:.2}", frame / row.paper)]
            };
            table.row(&format!(
                "{name} | {} | {} k | {paper} | {} | {ratio} | {} | {}",
                row.model,
                row.count / 1000,
                cell(&mut frames),
                stages.join(", "),
                cell(&mut traffic)
            ));
        }
    }
    table.publish_times(&arguments, "image-space.md", "image-space")
}

/// A sampling of the dragon, or of the sphere; the radius is the spacing.
fn scene(scan: Option<&Cloud>, count: usize, colored: bool) -> Result<Scene> {
    let mut cloud = match scan {
        None => Shape::Sphere.surfels(count, 0)?.into_cloud(),
        Some(mesh) => {
            let area: f64 = (mesh.triangles.iter())
                .map(|t| t.map(|i| mesh.position[i as usize].as_dvec3()))
                .map(|[a, b, c]| (b - a).cross(c - a).length() / 2.0)
                .sum();
            let radius = (area / count as f64).sqrt() as f32;
            Cloud { radius: Some(vec![radius; count]), ..resample(mesh, count, 1) }
        }
    };
    let paint =
        |cloud: &Cloud| cloud.position.iter().map(|p| p.abs().min(glam::Vec3::ONE)).collect();
    cloud.color = colored.then(|| paint(&cloud));
    let surfels = Surfels::new(cloud)?.0;
    Ok(Scene::lit("sampling", surfels))
}

/// The times of whole pictures, and of each stage, and how many surfels are seen.
type Times = (Vec<Duration>, Vec<(&'static str, Vec<Duration>)>, u64);

/// How long it takes to move what the projection moves: to read position, normal and radius of
/// every surfel, and to write 24 bytes for each of the `seen` ones and read them again.
fn traffic(surfels: &Surfels, seen: u64, exec: &Exec, points: &mut [[u32; 6]]) -> Duration {
    const CHUNK: usize = 16_384;
    let share = seen as f64 / surfels.len() as f64;
    let seen = |surfels: usize| (surfels as f64 * share) as usize;
    let bits = |of: &[glam::Vec3]| {
        let mut sum = [[0_u32; 3]; 32];
        for block in of.chunks_exact(sum.len()) {
            for (sum, v) in sum.iter_mut().zip(block) {
                (0..3).for_each(|axis| sum[axis] = sum[axis].wrapping_add(v[axis].to_bits()));
            }
        }
        sum[0]
    };
    let start = Instant::now();
    let vectors = surfels.position().chunks(CHUNK).zip(surfels.normal().chunks(CHUNK));
    let chunks = vectors.zip(surfels.radius().chunks(CHUNK)).zip(points.chunks_mut(CHUNK));
    exec.ordered(chunks.collect(), |(((position, normal), radius), points)| {
        let (position, normal, radius): (&[_], &[_], &[f32]) = (position, normal, radius);
        let points: &mut [[u32; 6]] = points;
        let radii = radius.iter().fold(0_u32, |sum, r| sum.wrapping_add(r.to_bits()));
        let (p, n) = (bits(position), bits(normal));
        points[..seen(radius.len())].fill([p[0], p[1], p[2], n[0], n[1] ^ n[2], radii]);
    });
    let sums = exec.ordered(points.chunks(CHUNK).collect(), |points: &[[u32; 6]]| {
        let mut sum = [0_u32; 6];
        for point in &points[..seen(points.len())] {
            (0..6).for_each(|i| sum[i] = sum[i].wrapping_add(point[i]));
        }
        sum
    });
    std::hint::black_box(sums);
    start.elapsed()
}

fn measure(scene: &Scene, camera: &Camera, method: &Method, exec: &Exec) -> Result<Times> {
    let mut session = Session::with_groups(scene, *method, None, exec)?;
    let (mut frames, mut stages) = (Vec::new(), Vec::<(&str, Vec<Duration>)>::new());
    let mut seen = 0;
    let begin = Instant::now();
    // At least 9 pictures, then up to 101 within two seconds; the first fills the memory.
    while frames.len() < 9 || (frames.len() < 101 && begin.elapsed().as_secs() < 2) {
        let start = Instant::now();
        let picture = session.render(camera)?;
        let time = start.elapsed();
        if !frames.is_empty() || !stages.is_empty() {
            frames.push(time);
        }
        if stages.is_empty() {
            stages = picture.timings.iter().map(|&(name, _)| (name, Vec::new())).collect();
        } else {
            let laps = stages.iter_mut().zip(&picture.timings);
            laps.for_each(|((_, all), &(_, lap))| all.push(lap));
        }
        seen = picture.tally.visible;
    }
    Ok((frames, stages, seen))
}

fn median(times: &mut [Duration]) -> f64 {
    times.sort();
    times[times.len() / 2].as_secs_f64() * 1e3
}
