//! Peak memory of a render in a single pass: the budget of two.
//!
//! The depth-images of the groups exist for the tiles in work alone.

#![cfg(target_os = "linux")]

#[path = "memory/peak.rs"]
mod peak;

use peak::{SIDE, SURFELS, WANTED};
use splatref::frame::Framebuffer;
use splatref::method::single_pass::{BinCount, DepthTest, Settings, fast};
use splatref::scene::group::Groups;

#[test]
fn groups_take_no_more_than_the_budget() {
    let (surfels, camera, splats, exec) = peak::scene();
    let own = (0..SURFELS).map(|i| (i % 16) as u8).collect();
    let groups = Groups::new(own, Vec::new(), vec![1.0; 16]).expect("groups");
    let settings = Settings { splats, depth: DepthTest::Voronoi(BinCount::Epsilon) };
    peak::check(|| {
        let mut target = Framebuffer::new(SIDE, SIDE, 0.0, WANTED);
        let drawn = fast::render(&surfels, &groups, &camera, &settings, &exec, &mut target);
        drawn.expect("a picture").0.visible
    });
}
