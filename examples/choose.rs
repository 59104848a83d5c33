//! Choose a method: draw one scene by several methods, and compare time and error with the truth.
//!
//! ```sh
//! cargo run --release --example choose
//! ```
//!
//! `splatref plan` does the same with every setting of every method.

use splatref::compare::metrics::Errors;
use splatref::frame::Exec;
use splatref::scene::Similarity;
use splatref::source::Shape;
use splatref::study::truth::{Surface, of_surfaces};
use splatref::{Camera, Method, Result, Scene, Session};
use std::time::{Duration, Instant};

/// The largest error that is good enough.
const LIMIT: f64 = 0.03;
/// Draw this many times; the shortest time counts.
const ROUNDS: usize = 5;

fn main() -> Result<()> {
    let (shape, exec) = (Shape::Torus, Exec::new(0, 32)?);
    let scene = Scene::lit("torus", shape.surfels(5_000, 0)?);
    let camera = Camera::new(160, 120, shape.default_pose(), shape.default_lens())?;

    // The truth knows no surfels: 8 x 8 rays a pixel meet the exact torus, in f64.
    let place = Similarity::IDENTITY;
    let surface = Surface::Shape { shape, place, color: None };
    let none = |_step: &str, _done, _total| ();
    let truth = of_surfaces(&[surface], &scene, true, &camera, &[], &exec, &none)?;
    println!("truth: {}", truth.how);

    let mut fits = Vec::new();
    for name in ["ewa", "single-pass", "pyramid", "template", "blue"] {
        let mut session = Session::new(&scene, Method::by_name(name)?, &exec)?;
        let mut least = Duration::MAX;
        for _ in 0..ROUNDS {
            let start = Instant::now();
            session.render(&camera)?;
            least = least.min(start.elapsed());
        }
        let picture = session.render(&camera)?;
        let error = Errors::measure(&picture.frame, &truth.frame, &exec)?;
        let (milliseconds, rmse) = (1000.0 * least.as_secs_f64(), error.color.rmse);
        println!("{name:12} {milliseconds:7.2} ms   RMSE {rmse:.4}");
        assert!(rmse < 0.1, "every method draws the torus");
        if rmse <= LIMIT {
            fits.push((least, name));
        }
    }
    // Times vary from run to run; errors never do.
    let names: Vec<&str> = fits.iter().map(|(_, name)| *name).collect();
    assert_eq!(names, ["pyramid", "template", "blue"]);
    println!("the fastest within {LIMIT}: {:?}", fits.iter().min());
    Ok(())
}
