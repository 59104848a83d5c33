//! The library call that `measure.py` compares `sr.render` with: each picture has a session of its own. Prints
//! milliseconds, the least and the median.

use splatref::frame::Exec;
use splatref::{Result, SceneFile};
use std::time::Instant;

fn main() -> Result<()> {
    let numbers: Vec<u32> = std::env::args().filter_map(|word| word.parse().ok()).collect(); // cargo adds a word
    let &[count, size, rounds] = numbers.as_slice() else {
        return Err(splatref::Error::Invalid("give COUNT SIZE ROUNDS".into()));
    };
    let exec = Exec::new(0, 32)?;
    let mut file = SceneFile::open_with("torus", Some(count as usize), None)?;
    file.camera.size = Some([size; 2]);
    let ready = file.ready(&exec, &|_step, _done, _total| ())?;
    let mut times = Vec::new();
    for _ in 0..rounds {
        let start = Instant::now();
        let (mut session, _groups) = ready.session(&exec, &|_step, _done, _total| ())?;
        session.render(&ready.camera)?;
        let picture = session.take_picture();
        times.push(1000.0 * start.elapsed().as_secs_f64());
        drop(picture);
    }
    times.sort_by(f64::total_cmp);
    println!("{} {}", times[0], times[times.len() / 2]);
    Ok(())
}
