//! Speed against accuracy: every method for opaque scenes, on samplings of one shape.
//!
//! `cargo bench --bench methods` prints Markdown, and with `--write` puts the table into
//! `docs/speed.md` and draws the chart `docs/speed-accuracy.svg`; an argument is a pattern that the
//! names of methods must contain. The shape is the cluster of 32 spheres, in 800 x 600 pixels, lit
//! by the default headlight, `f32`, as many threads as cores. Time is the median over the pictures
//! of one run, whole frames from the scene to shaded planes in the memory of the picture before.
//! RMSE is of R, G and B, linear, against the true picture of the shape, which is ray-traced and
//! lit in f64 by the same shader; background counts too. The single pass draws the groups of
//! c = 0.8, which are made before.

mod common;

use common::chart::{Axis, Series, svg};
use common::report::{Arguments, Table, machine};
use common::shot::Shot;
use common::sphere::cell;
use splatref::compare::metrics::summary;
use splatref::frame::{Exec, Image};
use splatref::index::grouping::{Rules, group};
use splatref::method::{Method, Session, ewa, pyramid, single_pass, template};
use splatref::scene::{Camera, Scene};
use splatref::source::Shape;
use splatref::{Error, Result};
use std::time::{Duration, Instant};

const COUNTS: [(usize, &str); 4] =
    [(10_000, "10 k"), (50_000, "50 k"), (200_000, "200 k"), (1_000_000, "1 M")];
const OVERLAP: f32 = 0.8;

fn main() -> Result<()> {
    let arguments = Arguments::parse()?;
    let exec = Exec::new(0, 32)?;
    let shape =
        Shape::by_name("cluster").ok_or_else(|| Error::Invalid("no shape cluster".into()))?;
    let camera = Camera::new(800, 600, shape.default_pose(), shape.default_lens())?;
    let mut series: Vec<Series> = methods()
        .into_iter()
        .map(|(name, _)| Series { name: name.to_owned(), points: Vec::new() })
        .collect();
    let mut table = Table::new(&["surfels", "method", "frame, ms", "RMSE", "SSIM"]);
    for (count, label) in COUNTS {
        let scene = Scene::lit("cluster", shape.surfels(count, 0)?);
        let truth = Image::from(&Shot::truth(&scene, &shape, &camera, &exec)?.to_frame());
        let rows = methods().into_iter().zip(&mut series);
        for ((name, method), series) in rows.filter(|row| row.0.0.contains(&arguments.pattern)) {
            let (image, mut times) = draw(&scene, &camera, &method, &exec)?;
            let Some(found) = summary(&image, &truth) else { continue };
            let ssim = found.ssim.unwrap_or(0.0);
            let time = cell(&mut times);
            table.row(&format!("{label} | {name} | {time} | {:.4} | {ssim:.3}", found.rmse));
            let median = times[times.len() / 2].as_secs_f64() * 1e3;
            series.points.push([median, found.rmse]);
        }
    }
    table.publish_times(&arguments, "speed.md", "methods")?;
    arguments.write("speed-accuracy.svg", &chart(&series))
}

/// The methods and their names in the chart.
fn methods() -> [(&'static str, Method); 5] {
    let template =
        |size| Method::Template(template::Settings { size, ..template::Settings::default() });
    [
        ("ewa", Method::Ewa(ewa::Settings::default())),
        ("single-pass", Method::SinglePass(single_pass::Settings::default())),
        ("pyramid", Method::Pyramid(pyramid::Settings::default())),
        ("template 3 x 3", template(3)),
        ("template 5 x 5", template(5)),
    ]
}

/// A picture, and the times of at least 9 more.
fn draw(
    scene: &Scene,
    camera: &Camera,
    method: &Method,
    exec: &Exec,
) -> Result<(Image, Vec<Duration>)> {
    let rules = Rules { overlap: OVERLAP, ..Rules::default() };
    let groups = match method {
        Method::SinglePass(_) => Some(group(&scene.surfels, &rules, exec, &|_, _, _| ())?.0),
        _ => None,
    };
    let mut session = Session::with_groups(scene, *method, groups, exec)?;
    let image = Image::from(&session.render(camera)?.frame);
    let (mut times, begin) = (Vec::new(), Instant::now());
    // At least 9 pictures, then up to 101 within two seconds.
    while times.len() < 9 || (times.len() < 101 && begin.elapsed().as_secs() < 2) {
        let start = Instant::now();
        session.render(camera)?;
        times.push(start.elapsed());
    }
    Ok((image, times))
}

/// Time across, error up: below and to the left is better.
fn chart(series: &[Series]) -> String {
    let points = series.iter().flat_map(|series| &series.points);
    let x = Axis::around("ms a frame", points.clone().map(|point| point[0]));
    let y = Axis::around("RMSE to the true picture, linear RGB", points.map(|point| point[1]));
    let title = format!("32 spheres, 800 x 600; {}", machine());
    svg(&title, [&x, &y], series, ("surfels", &COUNTS.map(|(_, label)| label)))
}
