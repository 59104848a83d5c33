use super::discs;
use super::splats::PossibleSplats;
use crate::frame::{Exec, Frame, Plane, Rect, Samples};
use crate::index::Index;
use crate::method::gaussians::splats::{Beside, Source};
use crate::method::gaussians::{Order, Settings};
use crate::method::part::Part;
use crate::method::{Job, Method, Session};
use crate::number::ball::Gpu;
use crate::number::elementary::pow_f32;
use crate::number::random::unit;
use crate::number::srgb::{decoded, encoded};
use crate::number::{Ball, Exact, Real, Truth};
use crate::scene::gaussians::{Encoding, GaussianArrays, Gaussians};
use crate::scene::{Camera, Lens, Pose, Scene, Surface};
use crate::setting::Words;
use crate::source::Shape;
use crate::splat::gaussian::{GaussianKernel, ProjectedGaussian};
use crate::splat::ray_disc::DiscRule;
use crate::verdict::causes::likely_cause;
use crate::verdict::client::{Client, Rounding};
use crate::verdict::marks::TilePart;
use crate::verdict::supposed::Supposed;
use crate::verdict::{Doubt, Outcome, Verdict};
use glam::{DVec3, Vec3};

/// Splats around the origin, some of them clear, whose sizes are 10^-decades to 10^decades times
/// this one.
pub(super) fn cloud(count: u64, size: f32, decades: f32) -> Scene {
    let random = |i: u64, k: u64| 2.0 * unit(5, 31 * i + k) - 1.0;
    let vector = |i: u64, k: u64| Vec3::new(random(i, k), random(i, k + 1), random(i, k + 2));
    let scale = |i: u64| {
        let [a, b, c] = (vector(i, 3) * decades).to_array().map(|part| pow_f32(10.0, part));
        Vec3::new(a, b, c) * size
    };
    let arrays = GaussianArrays {
        position: (0..count).map(|i| vector(i, 0) * 2.0).collect(),
        scale: (0..count).map(scale).collect(),
        rotation: (0..count)
            .map(|i| [random(i, 6), random(i, 7), random(i, 8), random(i, 9)])
            .collect(),
        opacity: (0..count).map(|i| random(i, 10).abs()).collect(),
        degree: 0,
        harmonics: (0..count).map(|i| vector(i, 11)).collect(),
        encoding: Encoding::Srgb,
    };
    Scene::of_gaussians("cloud", Gaussians::new(arrays).unwrap().0)
}

pub(super) fn camera(width: u32, height: u32) -> Camera {
    let pose = Pose { eye: DVec3::new(0.4, 0.3, 3.0), target: DVec3::ZERO, up: DVec3::Y };
    Camera::new(width, height, pose, Lens::FieldOfView(60.0)).unwrap()
}

/// The splats of a right client.
fn possible_splats(job: &Job<'_>, source: &Source<'_, Ball<Gpu>>) -> PossibleSplats<Gpu> {
    let nothing = Supposed::Nothing;
    PossibleSplats::new(job, PossibleSplats::found(job, source, nothing), nothing)
}

/// A view of the cloud, one from within it, and one without perspective.
fn cameras() -> [Camera; 3] {
    let from = |eye, lens| {
        let pose = Pose { eye, target: DVec3::new(0.1, 0.0, -1.0), up: DVec3::Y };
        Camera::new(160, 96, pose, lens).unwrap()
    };
    [
        camera(160, 96),
        from(DVec3::new(0.2, 0.1, 1.0), Lens::FieldOfView(90.0)),
        from(DVec3::new(1.0, 0.5, 4.0), Lens::Orthographic(3.0)),
    ]
}

#[test]
fn a_part_has_the_splats_of_the_whole() {
    let surfels = Shape::Torus.surfels(3_000, 0).unwrap();
    let scenes =
        [cloud(3_000, 0.02, 1.5), cloud(3_000, 0.1, 0.5), Scene::unlit("surfels", surfels)];
    for (scene, camera) in scenes.iter().zip(cameras()) {
        let [left_out, of] = left_out(scene, &camera);
        assert!(2 * left_out > of, "{}: of {of} only {left_out} are left out", scene.name);
    }
}

/// Checks that small parts have the splats that touch them; how many others are left out, of how many.
fn left_out(scene: &Scene, camera: &Camera) -> [usize; 2] {
    let exec = Exec::sequential();
    let index = Index::default();
    let (mut left_out, mut of) = (0, 0);
    for (name, settings) in Settings::WORDS {
        let source = Source::<Ball<Gpu>>::new(scene, camera, settings);
        let whole = Job::new(scene, &index, camera, &exec);
        let all = possible_splats(&whole, &source);
        for piece in whole.grid().rects().into_iter().enumerate().step_by(3) {
            let (tile, own) = piece;
            let piece = [(tile, Rect { x1: own.x0 + 7, y1: own.y0 + 5, ..own })];
            let part = Some(Part { pieces: &piece, spread: 1.0, around: None });
            let some = possible_splats(&Job { part, ..whole }, &source);
            let near = |splats: &PossibleSplats<Gpu>| -> Vec<u32> {
                let (tile, rect) = piece[0];
                let places = splats.places(TilePart { tile, rect }).into_iter();
                places.map(|place| splats.all[place].splat.index).collect()
            };
            assert_eq!(near(&some), near(&all), "{name}: tile {tile}");
            left_out += all.all.len() - some.all.len();
            of += all.all.len();
        }
    }
    [left_out, of]
}

#[test]
fn a_dense_scene_is_judged() {
    let (scene, camera, exec) = (cloud(20_000, 0.01, 1.0), camera(96, 64), Exec::sequential());
    let mut session = Session::new(&scene, Method::from(Settings::INRIA), &exec).unwrap();
    let client = Client::from(&session.render(&camera).unwrap().frame.clone());
    let verdict = session.verify(&camera, &client, Verdict::BUDGET).unwrap();
    let doubts = verdict.stages[0].doubtful(Doubt::OF_SUMS);
    assert_eq!(verdict.outcome(), Outcome::Right, "{} undecided", verdict.undecided);
    assert!(doubts > 50 && verdict.undecided < doubts / 4, "{doubts}, {}", verdict.undecided);
}

#[test]
fn two_splats_of_one_depth_have_the_sum_of_an_order_not_one_between() {
    let (camera, exec) = (camera(48, 32), Exec::sequential());
    // Across the direction of view, so that only rounding tells the depths apart.
    let aside = DVec3::new(3.0, 0.0, -0.4).normalize() * 0.05;
    let one = |i: usize| (Vec3::ZERO + aside.as_vec3() * i as f32, [Vec3::X, Vec3::Y][i]);
    let scene = |items: &[usize]| {
        let arrays = GaussianArrays {
            position: items.iter().map(|i| one(*i).0).collect(),
            scale: vec![Vec3::splat(0.3); items.len()],
            rotation: vec![[0.0, 0.0, 0.0, 1.0]; items.len()],
            opacity: vec![0.9; items.len()],
            degree: 0,
            harmonics: items.iter().map(|i| one(*i).1).collect(),
            encoding: Encoding::Srgb,
        };
        Scene::of_gaussians("two", Gaussians::new(arrays).unwrap().0)
    };
    let draw = |items: &[usize]| {
        let scene = scene(items);
        let mut session = Session::new(&scene, Settings::INRIA.into(), &exec).unwrap();
        session.render(&camera).unwrap().frame.clone()
    };
    let (both, own) = (scene(&[0, 1]), [draw(&[0]), draw(&[1])]);
    let parts = own.each_ref().map(|frame| {
        let color = frame.color("blended").unwrap().values();
        color.iter().zip(frame.scalar("T").unwrap().values()).collect::<Vec<_>>()
    });
    let sums = |order: [usize; 2], share: f32| {
        let each = parts[order[0]].iter().zip(&parts[order[1]]);
        each.map(|((front, through), (behind, _))| {
            [0, 1, 2].map(|k| share * (front[k] + *through * behind[k]))
        })
        .collect::<Vec<[f32; 3]>>()
    };
    let outcome = |sums: Vec<[f32; 3]>| {
        let plane = Plane::from_values(48, 32, sums);
        let frame = Frame::new(48, 32).with("blended", Samples::Color(plane)).unwrap();
        let session = Session::new(&both, Settings::INRIA.into(), &exec).unwrap();
        let verdict = session.verify(&camera, &Client::from(&frame), Verdict::BUDGET).unwrap();
        verdict.outcome()
    };
    let [first, second] = [[0, 1], [1, 0]].map(|order| sums(order, 1.0));
    let half = sums([0, 1], 0.5).into_iter().zip(sums([1, 0], 0.5));
    let mean = half.map(|(a, b)| [0, 1, 2].map(|k| a[k] + b[k])).collect();
    assert_eq!(outcome(first), Outcome::Right);
    assert_eq!(outcome(second), Outcome::Right);
    assert_eq!(outcome(mean), Outcome::Wrong);
}

/// q/2 at a pixel by the definition, and with the division at the end.
fn powers<R: Exact>(source: &Source<'_, R>, i: usize, at: (u32, u32)) -> [f64; 2] {
    let own = source.project(i).on_screen;
    let [xx, xy, yy] = own.ellipse;
    let (dx, dy) = (
        own.center.x - R::from_f32(at.0 as f32 + 0.5),
        own.center.y - R::from_f32(at.1 as f32 + 0.5),
    );
    let form = R::from_f32(0.5) * (yy * (dx * dx) + xx * (dy * dy)) - xy * (dx * dy);
    [ProjectedGaussian::power(own.center, own.conic, at), form / own.det].map(R::to_f64)
}

#[test]
fn every_way_to_compute_q_is_enclosed_and_needles_are_not_lost() {
    let views = [0.02, 0.005, 0.05].into_iter().zip(cameras());
    let found = views.map(|(size, camera)| enclosed(&cloud(2_000, size, 1.5), &camera));
    let found: Vec<_> = found.collect();
    for [narrowed, wide, of] in &found {
        assert!(*wide < of / 50, "{wide} of {of} are wide");
        assert!(*narrowed > 0, "none of {of} was lost");
    }
    let [narrowed, _, of] = found[0];
    assert!(narrowed > of / 50, "{narrowed} of {of} were lost");
}

/// Checks the enclosures of q/2 at some pixels of each splat; where it is below 6, how many are narrow
/// because 1/det is shared, how many are wide, and of how many.
fn enclosed(scene: &Scene, camera: &Camera) -> [u32; 3] {
    let (settings, exec) = (&Settings::INRIA, Exec::sequential());
    let (single, double) =
        (Source::<f32>::new(scene, camera, settings), Source::<f64>::new(scene, camera, settings));
    let source = Source::<Ball<Gpu>>::new(scene, camera, settings);
    let index = Index::default();
    let job = Job::new(scene, &index, camera, &exec);
    let all = possible_splats(&job, &source);
    let (mut wide, mut of, mut narrowed) = (0, 0, 0);
    for possible in &all.all {
        let i = possible.splat.index as usize;
        let bounds = possible.splat.bounds;
        for k in 0..6 {
            let column = (unit(7, 12 * i as u64 + 2 * k) * bounds.columns() as f32) as u32;
            let rows = (bounds.y1 - bounds.y0) as f32;
            let row = (unit(7, 12 * i as u64 + 2 * k + 1) * rows) as u32;
            let at = (bounds.x0 + column, bounds.y0 + row);
            let power = possible.power(at);
            let [low, high] = power.ends();
            let found = [powers(&single, i, at), powers(&double, i, at)];
            for q in found.as_flattened() {
                assert!(!(*q < low || *q > high), "{i} at {at:?}: {q} of {low} to {high}");
            }
            if found[1][0] < 6.0 {
                let plain =
                    ProjectedGaussian::power(possible.splat.center, possible.splat.conic, at);
                of += 1;
                wide += u32::from(!(power.radius < 0.1));
                narrowed += u32::from(power.radius < 0.1 && !(plain.radius < 0.1));
            }
        }
    }
    [narrowed, wide, of]
}

/// 2,000 splats whose depths differ only by roundings, so that every order of them is open. Each pixel
/// asks how much all others of a splat leave: what grows with the square of their number takes minutes.
#[test]
fn many_splats_of_one_depth_are_judged() {
    let eye = DVec3::new(3.0, 4.0, 5.0);
    let [across, along] = [DVec3::new(4.0, -3.0, 0.0), eye.cross(DVec3::new(4.0, -3.0, 0.0))];
    let [across, along] = [across.normalize(), along.normalize()];
    let random = |i: u64, k: u64| f64::from(2.0 * unit(9, 2 * i + k) - 1.0);
    let count = 2000;
    let arrays = GaussianArrays {
        position: (0..count)
            .map(|i| (across * random(i, 0) + along * random(i, 1)).as_vec3())
            .collect(),
        scale: vec![Vec3::splat(0.5); count as usize],
        rotation: vec![[0.0, 0.0, 0.0, 1.0]; count as usize],
        opacity: vec![0.01; count as usize],
        degree: 0,
        harmonics: (0..count).map(|i| Vec3::splat(unit(10, i))).collect(),
        encoding: Encoding::Srgb,
    };
    let scene = Scene::of_gaussians("one depth", Gaussians::new(arrays).unwrap().0);
    let pose = Pose { eye, target: DVec3::ZERO, up: DVec3::Z };
    let camera = Camera::new(12, 10, pose, Lens::FieldOfView(20.0)).unwrap();
    let settings = Settings { least_alpha: 0.0, ..Settings::default() };
    let exec = Exec::sequential();
    let session = Session::new(&scene, Method::Gaussians(settings), &exec).unwrap();
    let frame = session.define::<f32>(&camera, true).unwrap().frame;
    let verdict = session.verify(&camera, &Client::from(&frame), 1.0).unwrap();
    assert!(verdict.first_wrong().is_none(), "{:?}", verdict.stages[0].worst);
    assert_eq!(verdict.stages[0].doubtful(Doubt::Nearer as u8), 120);
    assert!(frame.count("count").unwrap().values().iter().all(|count| *count == 255));
}

/// Discs of all sizes, some of them nearly edge-on.
fn flakes(count: u64, size: f32) -> Scene {
    let flat = cloud(count, size, 0.7).gaussians.unwrap();
    let arrays = GaussianArrays {
        position: flat.position().to_vec(),
        scale: flat.scale().iter().map(|s| Vec3::new(s.x, s.y, 0.0)).collect(),
        rotation: flat.rotation().to_vec(),
        opacity: flat.opacity().to_vec(),
        degree: 0,
        harmonics: (0..flat.len()).map(|i| flat.harmonics(i)[0]).collect(),
        encoding: Encoding::Srgb,
    };
    Scene::of_gaussians("flakes", Gaussians::new(arrays).unwrap().0)
}

/// The rules of discs, each with two orders.
fn rules_of_discs() -> Vec<Settings> {
    let mut all = Vec::new();
    for disc in [DiscRule::Ray, DiscRule::RayBox] {
        for order in [Order::Depth, Order::Pixel] {
            let kernel = GaussianKernel { disc, ..Settings::DISCS.kernel };
            all.push(Settings { kernel, order, ..Settings::DISCS });
        }
    }
    all
}

#[test]
fn discs_of_f32_and_of_f64_are_right_under_every_promise() {
    let exec = Exec::sequential();
    let surfels = Shape::Torus.surfels(150, 0).unwrap();
    let scenes = [flakes(50, 0.15), flakes(150, 0.02), Scene::unlit("surfels", surfels)];
    for settings in rules_of_discs() {
        for (scene, camera) in scenes.iter().zip(cameras()) {
            let camera = Camera { width: 64, height: 40, ..camera };
            let session = Session::new(scene, settings.into(), &exec).unwrap();
            let narrow = Client::from(&session.define::<f32>(&camera, true).unwrap().frame);
            let wide = session.define::<f64>(&camera, true).unwrap().frame.to_f32();
            let wide = Client::from(&wide).rounded();
            for (_, rounding) in Rounding::WORDS {
                for client in [&narrow, &wide] {
                    let client = Client { rounding: *rounding, ..client.clone() };
                    let verdict = session.verify(&camera, &client, Verdict::BUDGET).unwrap();
                    let (outcome, undecided) = (verdict.outcome(), verdict.undecided);
                    let what = format!("{settings:?}, {}, {rounding:?}", scene.name);
                    assert_eq!(outcome, Outcome::Right, "{what}: {undecided} undecided");
                }
            }
        }
    }
}

/// rho at a pixel by the definition, and by the planes of the ray in homogeneous coordinates.
fn rhos<R: Exact>(source: &Source<'_, R>, i: usize, at: (u32, u32)) -> [f64; 2] {
    let disc = source.disc(i);
    let own = disc.fragment(&source.projector.rays, at);
    let (x, y) = (R::from_f32(at.0 as f32 + 0.5), R::from_f32(at.1 as f32 + 0.5));
    let ([a, b], [az, bz], w) = (disc.images, disc.bend, disc.divisor);
    let (cx, cy) = (disc.center.x, disc.center.y);
    let row = |at: R, center: R, a: R, b: R| {
        [at * az - (a + center * az), at * bz - (b + center * bz), at * w - center * w]
    };
    let (k, l) = (row(x, cx, a.x, b.x), row(y, cy, a.y, b.y));
    let p = [k[1] * l[2] - k[2] * l[1], k[2] * l[0] - k[0] * l[2], k[0] * l[1] - k[1] * l[0]];
    let (u, v) = (p[0] / p[2], p[1] / p[2]);
    let rho3d = u * u + v * v;
    let other = if own.rho == own.rho3d { rho3d } else { own.rho };
    [own.rho, other].map(R::to_f64)
}

#[test]
fn every_way_to_meet_a_disc_is_enclosed() {
    let exec = Exec::sequential();
    for (settings, camera) in rules_of_discs().iter().zip(cameras().iter().cycle()) {
        let scene = flakes(500, 0.05);
        let (single, double) = (
            Source::<f32>::new(&scene, camera, settings),
            Source::<f64>::new(&scene, camera, settings),
        );
        let source = Source::<Ball<Gpu>>::new(&scene, camera, settings);
        let index = Index::default();
        let job = Job::new(&scene, &index, camera, &exec);
        let all = possible_splats(&job, &source);
        let (mut wide, mut of) = (0, 0);
        for possible in &all.all {
            let (i, bounds) = (possible.splat.index as usize, possible.splat.bounds);
            let Some(Beside::Disc(disc)) = possible.beside.as_deref() else { panic!("no disc") };
            for k in 0..6 {
                let at = |j: u64, size: u32| (unit(7, 12 * i as u64 + j) * size as f32) as u32;
                let at = (
                    bounds.x0 + at(2 * k, bounds.x1 - bounds.x0),
                    bounds.y0 + at(2 * k + 1, bounds.y1 - bounds.y0),
                );
                let own = discs::fragment(disc, &source.projector.rays, at);
                let [low, high] = own.rho.ends();
                let found = [rhos(&single, i, at), rhos(&double, i, at)];
                if own.met.certainly() {
                    for rho in found.as_flattened() {
                        assert!(
                            !(*rho < low || *rho > high),
                            "{i}, {at:?}: {rho}: {low} to {high}"
                        );
                    }
                }
                of += u32::from(found[1][0] < 9.0);
                wide += u32::from(found[1][0] < 9.0 && !(own.rho.radius < 0.1));
            }
        }
        assert!(of > 100 && wide < of / 20, "{settings:?}: {wide} of {of} are wide");
    }
}

#[test]
fn an_edge_on_disc_is_decided_and_wrong_discs_are_found() {
    let exec = Exec::sequential();
    let camera = camera(48, 32);
    // The ray through the centre lies in the plane.
    let toward = (Vec3::new(0.4, 0.3, 3.0)).normalize();
    let across = toward.cross(Vec3::Y).normalize();
    let basis = glam::Mat3::from_cols(across, toward, across.cross(toward));
    let one = |scale: Vec3| {
        let arrays = GaussianArrays {
            position: vec![Vec3::ZERO],
            scale: vec![scale],
            rotation: vec![glam::Quat::from_mat3(&basis).to_array()],
            opacity: vec![0.9],
            degree: 0,
            harmonics: vec![Vec3::ONE],
            encoding: Encoding::Srgb,
        };
        Scene::of_gaussians("edge", Gaussians::new(arrays).unwrap().0)
    };
    let scene = one(Vec3::new(0.4, 0.3, 0.0));
    let settings = |disc, low_pass| {
        let kernel = GaussianKernel { disc, low_pass, ..Settings::DISCS.kernel };
        Settings { kernel, ..Settings::DISCS }
    };
    let draw = |scene: &Scene, settings: Settings| {
        let session = Session::new(scene, settings.into(), &exec).unwrap();
        Client::from(&session.define::<f32>(&camera, true).unwrap().frame)
    };
    let own = settings(DiscRule::Ray, 0.5);
    // An axis of length 0 makes a line, which no ray meets.
    for scene in [&scene, &one(Vec3::new(0.4, 0.0, 0.0))] {
        let session = Session::new(scene, own.into(), &exec).unwrap();
        let right = session.verify(&camera, &draw(scene, own), Verdict::BUDGET).unwrap();
        assert_eq!((right.outcome(), right.undecided), (Outcome::Right, 0));
    }
    let session = Session::new(&scene, own.into(), &exec).unwrap();
    let judge = |client: &Client| session.verify(&camera, client, Verdict::BUDGET).unwrap();
    for other in [settings(DiscRule::Ray, 0.0), settings(DiscRule::Ray, 1.0), Settings::INRIA] {
        assert_eq!(judge(&draw(&scene, other)).outcome(), Outcome::Wrong, "{other:?}");
    }
}

/// A plane that cuts through the cloud, and nothing opaque in some columns.
fn cut([width, height]: [u32; 2]) -> Surface {
    let depth = |x: u32, y: u32| {
        if x % 8 == 7 { f32::INFINITY } else { 2.0 + 0.05 * x as f32 - 0.03 * y as f32 }
    };
    let color = |x, y| [0.75, 0.01 * x as f32, 0.02 * y as f32];
    let size = [width, height];
    Surface::new(Plane::from_pixels(size, depth), Plane::from_pixels(size, color)).unwrap()
}

#[test]
fn pictures_with_a_surface_are_right_in_every_number_and_order() {
    let (camera, exec) = (camera(48, 32), Exec::sequential());
    for (name, settings) in Settings::WORDS {
        let scene = Scene { surface: Some(cut([48, 32])), ..cloud(400, 0.05, 0.7) };
        let session = Session::new(&scene, (*settings).into(), &exec).unwrap();
        let narrow = Client::from(&session.define::<f32>(&camera, true).unwrap().frame);
        let wide = session.define::<f64>(&camera, true).unwrap().frame.to_f32();
        for client in [narrow, Client::from(&wide).rounded()] {
            let verdict = session.verify(&camera, &client, Verdict::BUDGET).unwrap();
            let (outcome, undecided) = (verdict.outcome(), verdict.undecided);
            assert_eq!(outcome, Outcome::Right, "{name}: {undecided} undecided");
        }
    }
}

/// A splat whose depth and the surface's are equal but for rounding may be drawn or not.
#[test]
fn a_depth_at_the_surface_is_left_open_and_one_beside_it_is_not() {
    let (camera, exec) = (camera(48, 32), Exec::sequential());
    let aside = (Vec3::new(3.0, 0.0, -0.4).normalize() * 0.05, 0.3);
    let arrays = GaussianArrays {
        position: vec![aside.0],
        scale: vec![Vec3::splat(aside.1)],
        rotation: vec![[0.0, 0.0, 0.0, 1.0]],
        opacity: vec![0.9],
        degree: 0,
        harmonics: vec![Vec3::X],
        encoding: Encoding::Srgb,
    };
    let bare = Scene::of_gaussians("one", Gaussians::new(arrays).unwrap().0);
    let with = |depth: f32| {
        let color = Plane::filled(48, 32, [0.25, 0.5, 0.75]);
        let surface = Surface::new(Plane::filled(48, 32, depth), color).unwrap();
        Scene { surface: Some(surface), ..bare.clone() }
    };
    let draw = |scene: &Scene| {
        let session = Session::new(scene, Settings::INRIA.into(), &exec).unwrap();
        session.define::<f32>(&camera, true).unwrap().frame
    };
    let frame = draw(&with(10.0));
    let own = frame.scalar("Z").unwrap().values().iter().fold(f32::INFINITY, |a, b| a.at_most(*b));
    // Half an ulp or so apart, and a thousandth apart.
    for (near, open) in [(1.0 / 16_777_216.0, true), (1e-3, false)] {
        let [before, behind] = [own * (1.0 - near), own * (1.0 + 2.0 * near)].map(with);
        for (scene, other) in [(&before, &behind), (&behind, &before)] {
            let session = Session::new(scene, Settings::INRIA.into(), &exec).unwrap();
            let outcome = |frame: &Frame<f32>| {
                session.verify(&camera, &Client::from(frame), 1.0).unwrap().outcome()
            };
            assert_eq!(outcome(&draw(scene)), Outcome::Right);
            let swapped = if open { Outcome::Right } else { Outcome::Wrong };
            assert_eq!(outcome(&draw(other)), swapped, "{near}");
        }
    }
}

#[test]
fn mistakes_with_a_surface_have_their_names() {
    let (camera, exec) = (camera(48, 32), Exec::sequential());
    let scene = Scene { surface: Some(cut([48, 32])), ..cloud(60, 0.2, 0.3) };
    let session = Session::new(&scene, Settings::INRIA.into(), &exec).unwrap();
    let alone = Scene { surface: None, ..scene.clone() };
    let alone = Session::new(&alone, Settings::INRIA.into(), &exec).unwrap();
    let right = session.define::<f32>(&camera, true).unwrap().frame;
    let ignored = alone.define::<f32>(&camera, true).unwrap().frame;
    // Clients that keep their blended colours, and one that hands in its picture alone.
    let picture = |of: &dyn Fn(usize) -> [f32; 3]| {
        let plane = Plane::from_values(48, 32, (0..48 * 32).map(of).collect());
        Frame::new(48, 32).with("", Samples::Color(plane)).unwrap()
    };
    let surface = scene.surface.as_ref().unwrap();
    let shown = |frame: &Frame<f32>, factor: &dyn Fn(f32) -> f32| {
        let (blended, through) = (frame.color("blended").unwrap(), frame.scalar("T").unwrap());
        picture(&|i| {
            let (color, seen) = (blended.values()[i], factor(through.values()[i]));
            let light = surface.colors().values()[i];
            [0, 1, 2].map(|k| decoded(color[k] + seen * encoded(light[k])))
        })
    };
    for (frame, words) in [
        (shown(&ignored, &|through| through), "there is no depth test"),
        (ignored, "the surface has no effect"),
        (shown(&right, &|_| 1.0), "not multiplied by the transmittance"),
        (shown(&right, &|_| 0.0), "the background is added"),
    ] {
        let client = Client::from(&frame);
        let verdict = session.verify(&camera, &client, Verdict::BUDGET).unwrap();
        assert_eq!(verdict.outcome(), Outcome::Wrong, "{words}");
        let cause = likely_cause(&session, &camera, &client, &verdict).unwrap();
        assert!(cause.as_ref().is_some_and(|cause| cause.contains(words)), "{words}: {cause:?}");
    }
    let client = Client::from(&shown(&right, &|through| through));
    let verdict = session.verify(&camera, &client, Verdict::BUDGET).unwrap();
    assert_eq!(verdict.outcome(), Outcome::Right);
}
