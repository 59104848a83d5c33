//! Peak memory of a render in 2+1 passes, measured from outside the allocator.
//!
//! The budget: 100 bytes a surfel and 64 bytes a pixel beyond the scene.

#![cfg(target_os = "linux")]

#[path = "memory/peak.rs"]
mod peak;

use peak::{SIDE, WANTED};
use splatref::frame::Framebuffer;
use splatref::method::ewa::fast;

#[test]
fn a_render_stays_within_its_budget() {
    let (surfels, camera, settings, exec) = peak::scene();
    peak::check(|| {
        let mut target = Framebuffer::new(SIDE, SIDE, 0.0, WANTED);
        fast::render(&surfels, &camera, &settings, &exec, &mut target).0.visible
    });
}
