//! Sample a mesh into points of which every prefix covers the mesh evenly, and draw a prefix.
//!
//! ```sh
//! cargo run --release --example sample
//! ```

use glam::DVec3;
use splatref::frame::{Exec, Frame};
use splatref::io::ply;
use splatref::scene::{Camera, Cloud, Lens, Scene, Sphere};
use splatref::source::candidates::{self, Directions};
use splatref::source::derive::{self, Derive};
use splatref::source::sampler::{Greedy, Start, quality, shuffled};
use splatref::{Method, Result, Session};

const COUNT: usize = 2_000;
const PREFIX: usize = 200;

fn main() -> Result<()> {
    let exec = Exec::new(0, 32)?;
    let mesh = ply::read(concat!(env!("CARGO_MANIFEST_DIR"), "/golden/ball.ply").as_ref())?;
    println!("mesh: {} triangles", mesh.triangles.len());

    // Eight pictures of the mesh, 128 pixels wide: each covered pixel is a candidate.
    let none = |_step: &str, _done, _total| ();
    let (found, _) = candidates::of_cloud(mesh, &Directions::Cube, 128, &exec, &none)?;
    let points = &found.cloud.position;
    let order = Greedy { start: Start::Seed(0) }.order(points, COUNT, &exec, &none)?;
    println!("candidates: {}, ordered: {}", points.len(), order.index.len());

    // Distances are squared. No point of the mesh is farther than this from the prefix.
    let even = quality(points, &order.index[..PREFIX], &exec)?;
    let random = shuffled(points, 0, PREFIX, &none)?;
    let uneven = quality(points, &random.index, &exec)?;
    let [even, uneven] = [even, uneven].map(|quality| quality.covering.sqrt());
    println!("the first {PREFIX} points cover within {even}, random points within {uneven}");
    assert!(even < 0.75 * uneven);

    // With discs of this radius, a tenth of the points draws the same shape; it ends a little earlier.
    let all = draw(found.cloud.some(&order.index), order.distance[COUNT - 1].sqrt(), &exec)?;
    let some = draw(found.cloud.some(&order.index[..PREFIX]), even, &exec)?;
    let [all, some] = [all.scalar("A")?.values(), some.scalar("A")?.values()];
    let covered = all.iter().filter(|a| **a > 0.0).count();
    let lost = all.iter().zip(some).filter(|(all, some)| **all > 0.0 && **some == 0.0).count();
    println!("all points cover {covered} pixels; the prefix misses {lost} of them");
    assert!(100 * lost < covered);
    Ok(())
}

/// Draws points as discs of one radius.
fn draw(cloud: Cloud, radius: f32, exec: &Exec) -> Result<Frame<f32>> {
    let options = Derive { radius: Some(radius) };
    let (surfels, _) = derive::surfels(cloud, &options, exec, &|_step, _done, _total| ())?;
    let ball = Sphere { center: DVec3::ZERO, radius: 1.0 };
    let camera = Camera::framing(160, 120, ball, DVec3::ONE, Lens::FieldOfView(34.0))?;
    let scene = Scene::lit("ball", surfels);
    let mut session = Session::new(&scene, Method::by_name("ewa")?, exec)?;
    Ok(session.render(&camera)?.frame.clone())
}
