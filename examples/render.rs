//! Render a scene, read its planes, and keep them in a file that any EXR viewer opens.
//!
//! ```sh
//! cargo run --release --example render
//! ```

use splatref::frame::{Exec, Image};
use splatref::io::exr;
use splatref::{Result, SceneFile};

fn main() -> Result<()> {
    // 0 threads: one for each core. Threads and tile size change no bit of the picture.
    let exec = Exec::new(0, 32)?;
    let mut file = SceneFile::open("torus")?; // a shape, "scan.ply" or "scene.toml"
    file.camera.size = Some([160, 120]);
    let ready = file.ready(&exec, &|_step, _done, _total| ())?;
    let (session, _groups) = ready.session(&exec, &|_step, _done, _total| ())?;

    // `render` is faster, and leaves only the planes of the picture. `define` keeps every pass too.
    let picture = session.define::<f32>(&ready.camera, true)?;
    let planes: Vec<_> = picture.frame.planes.iter().map(|plane| plane.name.as_str()).collect();
    println!("planes: {planes:?}; the picture's colour has the empty name");

    let (depth, id) = (picture.frame.scalar("Z")?, picture.frame.index("id")?);
    let covered: Vec<f32> = depth.values().iter().copied().filter(|t| t.is_finite()).collect();
    let nearest = covered.iter().copied().min_by(f32::total_cmp).unwrap_or(f32::INFINITY);
    println!("{} pixels see the torus; the nearest is {nearest} away", covered.len());
    println!("surfel {} is seen at column 80, row 90", id.at(80, 90));
    for (stage, time) in &picture.timings {
        println!("{stage}: {:.2} ms", 1000.0 * time.as_secs_f64());
    }

    // An empty pixel has an infinite depth and no id.
    assert!(depth.at(0, 0).is_infinite() && *id.at(0, 0) == splatref::frame::NO_ID);
    // The eye is 5 from the middle of the torus, whose outer radius is 1 + 3/8.
    assert!(nearest > 5.0 - 1.375 && nearest < 5.0);

    let path = std::env::temp_dir().join(format!("splatref-render-{}.exr", std::process::id()));
    exr::write(&path, &picture.frame, "")?;
    let read = exr::read(&path);
    std::fs::remove_file(&path).map_err(|error| splatref::Error::io(&path, error))?;
    assert_eq!(read?.channels, Image::from(&picture.frame).channels, "no bit is lost");
    Ok(())
}
