//! What a verdict costs, and how much of a picture is undecided: the table of `docs/backends.md`.
//!
//! `cargo bench --bench verdicts` prints Markdown, and with `--write` puts the table into that page; an
//! argument is a pattern that the names of scenes must contain. The client is the crate in `f32`, with
//! the planes of every stage, under either promise, and once with its records too. Times are medians of
//! a run in which the three kinds of verdicts and the `f64` picture by the definition take turns.

mod common;

use common::models::path;
use common::report::{Arguments, Table};
use splatref::frame::Exec;
use splatref::io::scene_file::{Ready, SceneFile};
use splatref::method::{Method, Session};
use splatref::scene::{Camera, Scene};
use splatref::source::Shape;
use splatref::splat::record::project_records;
use splatref::verdict::client::{Client, Rounding};
use splatref::verdict::{Outcome, Verdict};
use splatref::{Error, Result};
use std::time::{Duration, Instant};

const ROUNDS: usize = 9;

/// A scene and a size of its picture.
struct Row {
    name: String,
    scene: Scene,
    camera: Camera,
}

fn main() -> Result<()> {
    let arguments = Arguments::parse()?;
    let exec = Exec::new(2, 32)?;
    let mut table = Table::new(&[
        "scene",
        "picture",
        "f64 picture, s",
        "`ieee`, s",
        "`gpu`, s",
        "`ieee` / f64",
        "`gpu` / f64",
        "undecided `ieee`",
        "`gpu`",
        "`gpu` with records",
    ]);
    for row in
        rows(&arguments, &exec)?.into_iter().filter(|row| row.name.contains(&arguments.pattern))
    {
        table.row(&measure(&row, &exec)?);
    }
    table.publish_times(&arguments, "backends.md", "verdicts")
}

/// The scenes: shapes in three sizes of picture, and scans if they are there.
fn rows(arguments: &Arguments, exec: &Exec) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    for (name, count, size) in [
        ("sphere", 200_000, [512, 512]),
        ("cluster", 200_000, [512, 512]),
        ("sheets", 200_000, [512, 512]),
        ("staircase", 20_000, [320, 240]),
        ("sphere", 1_000_000, [1920, 1080]),
    ] {
        let unknown = || Error::Invalid(format!("there is no shape {name}"));
        let shape = Shape::by_name(name).ok_or_else(unknown)?;
        let [width, height] = size;
        rows.push(Row {
            name: format!("{name}, {count}"),
            scene: Scene::lit(name, shape.surfels(count, 0)?),
            camera: Camera::new(width, height, shape.default_pose(), shape.default_lens())?,
        });
    }
    for name in ["bunny", "koala", "dragon"] {
        let path = path(name);
        if !path.exists() {
            arguments.without(&path)?;
            continue;
        }
        let mut file = SceneFile::open(&path)?;
        file.camera.size = Some([512, 512]);
        let Ready { loaded, camera, .. } = file.ready(exec, &|_, _, _| ())?;
        let scene = loaded.scene;
        rows.push(Row { name: format!("{name}, {}", scene.surfels.len()), scene, camera });
    }
    Ok(rows)
}

fn measure(row: &Row, exec: &Exec) -> Result<String> {
    let Row { name, scene, camera } = row;
    let method = Method::default();
    let session = Session::new(scene, method, exec)?;
    let frame = session.define::<f32>(camera, true)?.frame;
    let clients = [(Rounding::Ieee, false), (Rounding::Gpu, false), (Rounding::Gpu, true)];
    let mut clients = clients.map(|(rounding, own)| {
        let mut client = Client::from(&frame);
        client.rounding = rounding;
        if let (true, Some(splats)) = (own, method.splats()) {
            let records = project_records(&scene.surfels, camera, &splats.kernel, splats.cull).0;
            client.records = Some(records);
        }
        (client, Vec::new(), 0.0)
    });
    let mut pictures = Vec::new();
    for _ in 0..ROUNDS {
        pictures.push(timed(|| session.define::<f64>(camera, false))?.1);
        for (client, times, undecided) in &mut clients {
            let (verdict, time) = timed(|| session.verify(camera, client, Verdict::BUDGET))?;
            assert_ne!(verdict.outcome(), Outcome::Wrong, "{name}: the crate's own picture");
            times.push(time);
            *undecided = 100.0 * verdict.undecided as f64 / verdict.covered as f64;
        }
    }
    let picture = median(&mut pictures);
    let [ieee, gpu, own] = &mut clients;
    let times = [median(&mut ieee.1), median(&mut gpu.1)];
    let [width, height] = camera.size();
    Ok(format!(
        "{name} | {width} x {height} | {picture:.2} | {:.2} | {:.2} | {:.1} | {:.1} | {:.3} % | {:.3} % | {:.3} %",
        times[0],
        times[1],
        times[0] / picture,
        times[1] / picture,
        ieee.2,
        gpu.2,
        own.2
    ))
}

/// What work gives, and how long it takes.
fn timed<T>(work: impl FnOnce() -> Result<T>) -> Result<(T, Duration)> {
    let start = Instant::now();
    Ok((work()?, start.elapsed()))
}

/// The median in seconds.
fn median(times: &mut [Duration]) -> f64 {
    times.sort();
    times[times.len() / 2].as_secs_f64()
}
