//! Get a verdict on your own planes: hand in what your renderer left, and see which pixel is wrong.
//!
//! ```sh
//! cargo run --release --example verify
//! ```

use splatref::frame::{Exec, Frame, Plane, Samples};
use splatref::source::Shape;
use splatref::verdict::client::Client;
use splatref::verdict::{Outcome, Verdict};
use splatref::{Camera, Method, Result, Scene, Session};

const SIZE: [u32; 2] = [160, 120];

fn main() -> Result<()> {
    let (shape, exec) = (Shape::Sphere, Exec::new(0, 32)?);
    let scene = Scene::lit("sphere", shape.surfels(2_000, 0)?);
    let camera = Camera::new(SIZE[0], SIZE[1], shape.default_pose(), shape.default_lens())?;
    let session = Session::new(&scene, Method::by_name("ewa")?, &exec)?;

    // Read these buffers back from your GPU, row by row from the top left. Here splatref draws them.
    let own = session.define::<f32>(&camera, true)?.frame;
    let mut depth = own.scalar("visibility.Z")?.values().to_vec();
    let id = own.index("visibility.id")?.values().to_vec();

    let verdict = session.verify(&camera, &planes(&depth, &id)?, Verdict::BUDGET)?;
    print(&verdict);
    assert_eq!(verdict.outcome(), Outcome::Right);

    // One depth is off by a hundredth of a per cent: no rounding explains that.
    depth[60 * SIZE[0] as usize + 80] *= 1.0001;
    let verdict = session.verify(&camera, &planes(&depth, &id)?, Verdict::BUDGET)?;
    print(&verdict);
    assert_eq!(verdict.outcome(), Outcome::Wrong);
    let wrong = verdict.first_wrong().map(|stage| (stage.stage, stage.wrong));
    assert_eq!(wrong, Some(("visibility", 1)));
    Ok(())
}

/// The planes of the visibility pass, by the names that splatref gives them.
fn planes(depth: &[f32], id: &[u32]) -> Result<Client> {
    let [width, height] = SIZE;
    let frame = Frame::<f32>::new(width, height)
        .with("visibility.Z", Samples::Scalar(Plane::from_values(width, height, depth.into())))?
        .with("visibility.id", Samples::Index(Plane::from_values(width, height, id.into())))?;
    Ok(Client::from(&frame))
}

fn print(verdict: &Verdict) {
    println!("{:?}", verdict.outcome());
    for stage in verdict.stages.iter().filter(|stage| !stage.planes.is_empty()) {
        println!("  {}: {} pixels wrong", stage.stage, stage.wrong);
        if let Some(worst) = &stage.worst {
            println!("  worst at {:?}: {}", worst.pixel, worst.fault);
        }
    }
}
