//! What both tests of memory share: a process of its own for each, as an allocator keeps what is freed.

use glam::DVec3;
use splatref::frame::{Exec, Wanted};
use splatref::method::ewa::Settings;
use splatref::scene::{Camera, Lens, Pose, Shape, Surfels};

pub(crate) const SURFELS: usize = 2_000_000;
pub(crate) const SIDE: u32 = 2048;
pub(crate) const WANTED: Wanted = Wanted { normal: true, color: true, observed: false };

/// Nothing is culled and everything is in sight: the worst case for the records of splats.
pub(crate) fn scene() -> (Surfels, Camera, Settings, Exec) {
    let surfels = Shape::Sphere.surfels(SURFELS, 0).expect("a sphere");
    let pose = Pose { eye: DVec3::new(0.0, 0.0, 4.0), target: DVec3::ZERO, up: DVec3::Y };
    let camera = Camera::new(SIDE, SIDE, pose, Lens::Focal(3000.0)).expect("a camera");
    let settings = Settings { cull: false, ..Settings::default() };
    (surfels, camera, settings, Exec::new(2, 32).expect("threads"))
}

/// A line of /proc/self/status, in bytes.
fn status(key: &str) -> Option<u64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find(|line| line.starts_with(key))?;
    line.split_whitespace().nth(1)?.parse::<u64>().ok().map(|kb| kb * 1024)
}

/// Draws all surfels and holds the peak of the process to the budget, beyond what it held before.
pub(crate) fn check(draw: impl FnOnce() -> u64) {
    // Writing 5 resets the peak of the process to what it holds now.
    if std::fs::write("/proc/self/clear_refs", "5").is_err() {
        println!("skipped: this kernel does not let the peak be reset");
        return;
    }
    let before = status("VmRSS").expect("a resident size");
    let visible = draw();
    let peak = status("VmHWM").expect("a peak").saturating_sub(before);
    assert_eq!(visible, SURFELS as u64);
    let pixels = u64::from(SIDE) * u64::from(SIDE);
    let budget = 100 * SURFELS as u64 + 64 * pixels;
    println!("peak {peak} bytes of {budget}");
    assert!(peak <= budget, "peak {peak} bytes, budget {budget}");
    // The least that it can be: the planes themselves. A smaller figure measures nothing.
    assert!(peak >= 36 * pixels, "peak {peak} bytes");
}
