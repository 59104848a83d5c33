use super::*;
use crate::method::deferred::Settings;
use crate::method::{Method, Session};
use crate::scene::transform::rotation;
use crate::scene::{Cloud, Lens, Mipmap, Pose, Scene};
use crate::source::Shape;
use glam::DVec3;
use proptest::prelude::*;

/// One surfel at the origin with `levels` levels: the colour of level k is k.
fn one(normal: Vec3, tangents: Option<[Vec3; 2]>, levels: usize) -> Surfels {
    let cloud = Cloud {
        position: vec![Vec3::ZERO],
        normal: Some(vec![normal]),
        radius: Some(vec![0.25]),
        color: Some(vec![Vec3::ZERO]),
        tangents: tangents.map(|tangents| vec![tangents]),
        mipmap: Some(
            Mipmap::new(levels, (1..=levels).map(|k| Vec3::splat(k as f32)).collect()).unwrap(),
        ),
        ..Cloud::default()
    };
    Surfels::new(cloud).unwrap().0
}

fn view(eye: DVec3, lens: Lens) -> View<f64> {
    let up = if eye.x == 0.0 && eye.z == 0.0 { DVec3::Z } else { DVec3::Y };
    View::new(&Camera::new(64, 64, Pose { eye, target: DVec3::ZERO, up }, lens).unwrap())
}

#[test]
fn a_level_is_twice_the_size() {
    let surfels = one(Vec3::Z, None, 4);
    // A pixel has the side of h/16 radii.
    for (height, level) in
        [(1.0, 0.0), (16.0, 0.0), (24.0, 0.5), (32.0, 1.0), (40.0, 1.25), (64.0, 2.0), (1e6, 4.0)]
    {
        let view = view(DVec3::Z * 3.0, Lens::Orthographic(height / 2.0_f64.sqrt()));
        let found = Level::of_surfel(&view, &surfels, 0);
        // The scale of the camera is an f32. x is sqrt(2) times the side.
        assert!((found.number() - level).abs() < 1e-6, "{height}: {}", found.number());
        let expected = Vec3::splat(found.number() as f32);
        assert_eq!(color(&surfels, 0, found), expected, "the colour of level k is k");
    }
    // Turned by 60 degrees, about any axis, the surfel covers half as much.
    let seen = view(DVec3::Z * 3.0, Lens::Orthographic(16.0));
    for about in [DVec3::X, DVec3::Y, DVec3::new(3.0, 4.0, 0.0)] {
        let turned = rotation(about, 60.0) * DVec3::Z;
        let found = Level::of_surfel(&seen, &one(turned.as_vec3(), None, 4), 0).number();
        assert!((found - 1.0).abs() < 1e-6, "{about}: {found}");
    }
    // An ellipse is as large as the disc of its area, whatever its half axes.
    let halves = [Vec3::new(0.5, 0.0, 0.0), Vec3::new(0.25, 0.125, 0.0)];
    let [ellipse, disc] = [Some(halves), None].map(|halves| one(Vec3::Z, halves, 4));
    let [ellipse, disc] = [ellipse, disc].map(|one| Level::of_surfel(&seen, &one, 0).number());
    assert!((ellipse - disc).abs() < 1e-9, "{ellipse} {disc}");
}

#[test]
fn what_is_edge_on_or_behind_has_a_level() {
    let surfels = one(Vec3::X, None, 3);
    let behind = Pose { eye: DVec3::Z, target: DVec3::Z * 2.0, up: DVec3::Y };
    let behind = View::new(&Camera::new(8, 8, behind, Lens::FieldOfView(40.0)).unwrap());
    let lens = Lens::FieldOfView(40.0);
    for (view, level) in
        [(view(DVec3::Z, lens), 3.0), (behind, 0.0), (view(DVec3::X / 1e3, lens), 0.0)]
    {
        let found = Level::of_surfel(&view, &surfels, 0);
        assert_eq!(found.number(), level);
        assert_eq!(color(&surfels, 0, found), Vec3::splat(level as f32));
    }
}

proptest! {
    #[test]
    fn levels_rise_with_distance(
        at in [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0],
        normal in [-1.0..1.0_f32, -1.0..1.0, -1.0..1.0],
        step in 1.0..3.0_f64,
    ) {
        let (at, normal) = (DVec3::from_array(at), Vec3::from_array(normal));
        prop_assume!(at.length() > 0.1 && normal.length() > 0.1);
        let surfels = one(normal, None, 6);
        let mut before = 0.0;
        for i in 0..12 {
            let eye = at * f64::from(1_u32 << i) * step;
            let level = Level::of_surfel(&view(eye, Lens::FieldOfView(30.0)), &surfels, 0).number();
            // The camera is rounded to f32, which matters for a surfel that is nearly edge-on.
            prop_assert!(level >= before - 1e-2, "{} {} after {}", i, level, before);
            before = level;
        }
    }

    #[test]
    fn colours_stay_between_those_of_the_levels(x in 0.0..99.0_f64, a in 0.0..9.0_f32, b in 0.0..9.0_f32) {
        let surfels = one(Vec3::Z, None, 2);
        let colors = vec![Vec3::splat(a), Vec3::splat(b)];
        let surfels = surfels.with_mipmap(Some(Mipmap::new(2, colors).unwrap())).unwrap();
        let level = Level::at(x, 2);
        let found = color(&surfels, 0, level).x;
        let mut ends = [[0.0, a], [a, b], [b, b]][level.below];
        ends.sort_by(f32::total_cmp);
        prop_assert!((ends[0]..=ends[1]).contains(&found));
        let same = surfels.with_mipmap(Some(Mipmap::new(1, vec![Vec3::ZERO]).unwrap())).unwrap();
        prop_assert_eq!(color(&same, 0, Level::at(x, 1)), Vec3::ZERO);
    }
}

fn picture(surfels: Surfels, camera: &Camera) -> Vec<[u32; 3]> {
    let scene = Scene::lit("board", surfels);
    let exec = Exec::new(2, 32).unwrap();
    let mut session = Session::new(&scene, Method::from(Settings::default()), &exec).unwrap();
    let drawn = &session.render(camera).unwrap().frame;
    drawn.color("").unwrap().values().iter().map(|color| color.map(f32::to_bits)).collect()
}

#[test]
fn levels_of_the_own_colour_change_no_bit_and_others_do() {
    let board = Shape::Checkerboard { square: 0.25 }.surfels(20_000, 1).unwrap();
    let shape = Shape::Checkerboard { square: 0.25 };
    let camera = Camera::new(96, 64, shape.default_pose(), shape.default_lens()).unwrap();
    let of = |colors: Vec<Vec3>| {
        let mipmap = Mipmap::new(3, colors).unwrap();
        picture(board.clone().with_mipmap(Some(mipmap)).unwrap(), &camera)
    };
    let plain = picture(board.clone(), &camera);
    let own = board.color().unwrap();
    assert!(plain == of(own.iter().flat_map(|color| [*color; 3]).collect()));
    assert!(plain != of(own.iter().flat_map(|_| [Vec3::ONE; 3]).collect()));
    // No other method reads the mipmap.
    let exec = Exec::sequential();
    let white = Mipmap::new(1, vec![Vec3::ONE; board.len()]).unwrap();
    let with = board.clone().with_mipmap(Some(white)).unwrap();
    for method in
        Method::all().into_iter().filter(|m| m.name() == "ewa" || m.name() == "projection")
    {
        let draw = |surfels: &Surfels| {
            let scene = Scene::lit("board", surfels.clone());
            let mut session = Session::new(&scene, method, &exec).unwrap();
            session.render(&camera).unwrap().frame.planes.clone()
        };
        assert_eq!(draw(&with), draw(&board), "{}", method.name());
    }
}
