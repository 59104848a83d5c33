//! Known answers of scenes whose ids are of two schemes, or of more than 32 bits.

use crate::oracle::deferred::known::{
    BLUE, Keys, RED, assert_shows, disc, rgb, selected, settings, shot, thing, to,
};
use crate::oracle::deferred::place::World;
use crate::oracle::kit::planes::index;
use crate::oracle::template::cases::{Dot, exact_scene};
use glam::Vec3;
use splatref::frame::NO_ID;
use splatref::method::Picture;
use splatref::scene::objects::Split;
use splatref::splat::Outline;

/// So many objects of one disc, behind the camera but for some, and a last one of 2^17 + 1, of which
/// only the first is not behind the object.
fn crowd(count: usize, some: &[(usize, Keys<'_>)], last: Keys<'_>) -> World {
    let behind = Dot::new(0.0, 0.0, 1.0).at_depth(-64.0);
    let mut large = vec![behind; (1 << 17) + 1];
    large[0] = behind.at_depth(0.0);
    let geometries = vec![disc(1.0), exact_scene(&large).surfels];
    let mut objects = vec![thing(0, &[(0, to(0.5, 0.5, -8.0))], RED); count];
    for (i, keys) in some {
        objects[*i] = thing(0, keys, RED);
    }
    objects.push(thing(1, last, BLUE));
    World { geometries, whole: Vec::new(), objects, fill: Vec3::ONE }
}

#[test]
fn deferred_large_objects_win_ties_where_ids_are_of_two_schemes() {
    let (here, there, away) = (to(1.5, 1.5, 2.0), to(5.5, 1.5, 2.0), to(1.5, 1.5, -4.0));
    let settings = settings(Outline::Affine, 0.0);
    let (small, centre) = (1_u32 << 31, 8 + 1);
    // The small object is in pixel (1, 1) in both frames. The large one comes from another pixel,
    // so that pass 1 draws both; or from behind the camera, so that pass 3 draws it.
    for (from, flagged) in [(there, true), (away, false)] {
        let world = crowd(4096, &[(0, &[(0, here)])], &[(0, from), (1, here)]);
        assert_eq!(world.objects().ids().split(), Split::Two);
        let first = shot::<f64>(&world, settings, [8, 3], (0, None));
        let both = if flagged { vec![0, small] } else { vec![small] };
        assert_eq!(selected(&first.frame), both);
        let given = (1, first.seen.as_ref());
        let Picture { frame, .. } = shot::<f64>(&world, settings, [8, 3], given);
        let before = if flagged { 0 } else { small };
        assert_eq!(index(&frame, "visibility.id", centre), before, "pass 1");
        assert_eq!(selected(&frame), [0], "the last object of the scene has the lowest ids");
        assert_eq!(index(&frame, "difference.id", centre), 0, "pass 3");
        assert_shows(&frame, [1, 1], (rgb(BLUE), 1.0, 2.0, 0), "only the large one is selected");
    }
}

#[test]
fn deferred_ids_of_more_than_32_bits_are_told_apart() {
    // Objects 0 and 4095 have the numbers 0 and 2^12: the lowest 32 bits of their ids are 0.
    let (here, there, last) = (to(1.5, 1.5, 2.0), to(5.5, 1.5, 2.0), to(5.5, 1.5, 3.0));
    let still: Keys<'_> = &[(0, here)];
    let moves: Keys<'_> = &[(1, there), (2, here)];
    let mut world = crowd(16_386, &[(0, still), (4095, moves)], &[(0, last)]);
    let green = Vec3::Y;
    world.objects[4095].color = Some(green);
    let objects = world.objects();
    assert_eq!(objects.ids().split(), Split::Stencil(20));
    assert_eq!(objects.ids().id(4095, 0), 1 << 32);
    let settings = settings(Outline::Affine, 0.5);
    let mut seen = None;
    for frame in [1, 1, 2, 2] {
        let picture = shot::<f64>(&world, settings, [8, 3], (frame, seen.as_ref()));
        assert_shows(&picture.frame, [1, 1], (rgb(RED), 1.0, 2.0, 0), "the lower of two");
        // The large object is the last but one in the order of ids: its number is 16386 + 4.
        let large = ((16_390_u64 << 20) & 0xFFFF_FFFF) as u32;
        let (shows, kept) = match frame {
            1 => ((rgb(green), 1.0, 2.0, 0), [1, 1, 0]),
            _ => ((rgb(BLUE), 1.0, 3.0, large), [1, 0, 1]),
        };
        assert_shows(&picture.frame, [5, 1], shows, "the other");
        assert_ne!(large, NO_ID);
        let state = picture.seen.expect("what it saw");
        let found = [0, 4095, 16_386].map(|o| state.selected()[o]);
        assert_eq!(found, kept, "frame {frame}");
        assert!(state.has(0, 0) && state.has(4095, 0) == (frame == 1));
        seen = Some(state);
    }
}
