//! Transparent pictures whose numbers are known in closed form.

use crate::oracle::kit::dice::Dice;
use crate::oracle::kit::draw::{Drawing, back_to_front};
use crate::oracle::kit::planes::value;
use crate::oracle::kit::scene::{OUTLINES, ahead, change, discs, groups, scene, surfels};
use crate::oracle::transparent::Settings;
use glam::Vec3;
use splatref::frame::Frame;
use splatref::method::ewa;
use splatref::method::peeling;
use splatref::method::single_pass::{BinCount, DepthTest};
use splatref::method::transparent::{BinEdges, Holes};
use splatref::number::Exact;
use splatref::scene::Groups;
use splatref::scene::{Camera, Cloud, Lens, Light, Phong, Scene};
use splatref::splat::Epsilon;
use splatref::splat::Kernel;

pub(crate) const SIZE: u32 = 24;
pub(crate) const PIXELS: usize = (SIZE * SIZE) as usize;

/// A layer before the camera.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sheet {
    pub(crate) depth: f32,
    pub(crate) normal: Vec3,
    pub(crate) color: [f32; 3],
    pub(crate) alpha: f32,
}

pub(crate) fn sheet(depth: f32, color: [f32; 3], alpha: f32) -> Sheet {
    Sheet { depth, normal: Vec3::Z, color, alpha }
}

/// A scene of layers, of as many discs each as there are groups; every disc covers the picture.
pub(crate) fn sheets(layers: &[Sheet], count: usize) -> (Scene, Groups) {
    let all = || layers.iter().flat_map(|layer| (0..count).map(move |k| (layer, k)));
    let cloud = discs(all().map(|(layer, k)| {
        // Within the plane of the layer, and closer to each other than layers: centres are sorted
        // along the axis of their largest extent.
        let aside = layer.normal.cross(Vec3::Y) * (0.0625 * k as f32);
        (Vec3::new(0.0, 0.0, -layer.depth) + aside, layer.normal, 8.0)
    }));
    let cloud = Cloud {
        color: Some(all().map(|(layer, _)| layer.color.into()).collect()),
        opacity: Some(all().map(|(layer, _)| layer.alpha).collect()),
        ..cloud
    };
    (scene(surfels(cloud)), groups(all().map(|(_, k)| k as u8).collect(), count))
}

/// At the origin, looking along -z.
pub(crate) fn camera(orthographic: bool) -> Camera {
    let lens = if orthographic { Lens::Orthographic(6.0) } else { Lens::Focal(28.0) };
    ahead(lens, [SIZE; 2])
}

pub(crate) fn settings(outline: usize, nearest: Option<DepthTest>) -> Settings {
    let kernel = Kernel { outline: OUTLINES[outline], ..Kernel::DEFAULT };
    let splats = ewa::Settings { kernel, epsilon: Epsilon::World(0.25), cull: false };
    Settings { splats, nearest, ..Settings::default() }
}

pub(crate) fn render<R: Exact>(
    (scene, groups): &(Scene, Groups),
    camera: &Camera,
    settings: &Settings,
) -> Frame<R> {
    Drawing::new(scene, camera, *settings).grouped(groups).frame()
}

pub(crate) fn assert_near(found: [f64; 3], expected: [f64; 3], part: f64, name: &str) {
    for (a, b) in found.into_iter().zip(expected) {
        assert!((a - b).abs() <= part, "{found:?} for {expected:?}: {name}");
    }
}

/// Layers from the back over black: colour and opacity.
pub(crate) fn over(layers: &[Sheet]) -> ([f64; 3], f64) {
    let mut sorted = layers.to_vec();
    sorted.sort_by(|a, b| b.depth.total_cmp(&a.depth));
    sorted.iter().fold(([0.0; 3], 0.0), |(color, through), layer| {
        let a = f64::from(layer.alpha);
        let blend = |own: f64, below: f64| a * own + (1.0 - a) * below;
        ([0, 1, 2].map(|c| blend(layer.color[c].into(), color[c])), blend(1.0, through))
    })
}

/// The methods: Algorithm 2, and 3 with either depth test.
pub(crate) const TESTS: [Option<DepthTest>; 3] =
    [None, Some(DepthTest::Plain), Some(DepthTest::Voronoi(BinCount::Epsilon))];

/// One to five layers at random depths, in random order, of random colours and opacities.
fn random(dice: &mut Dice, tilted: bool) -> Vec<Sheet> {
    let alphas = [0.0, 0.25, 0.3, 0.5, 0.9, 1.0];
    let mut layers: Vec<Sheet> = (0..=dice.below(5))
        .map(|i| {
            let color = [(); 3].map(|()| dice.within(0.0, 1.0));
            let slope = if tilted { dice.within(-0.03125, 0.03125) } else { 0.0 };
            let normal = Vec3::new(slope, 0.0, 1.0).normalize();
            let normal = if dice.below(2) == 0 { normal } else { -normal };
            let depth = 4.0 + i as f32 + dice.within(0.0, 0.25);
            Sheet { depth, normal, color, alpha: alphas[dice.below(alphas.len())] }
        })
        .collect();
    let last = layers.len() - 1;
    layers.swap(0, dice.below(last + 1));
    layers
}

/// Sheets that every group covers blend as sheets of glass do: two, three, and up to five, whatever
/// their order in the scene, by Algorithms 2 and 3 and by peeling.
#[test]
fn sheets_blend_in_closed_form() {
    fn check<R: Exact>(number: usize, part: f64) {
        let mut dice = Dice(number as u64 * 31 + 7);
        let layers = random(&mut dice, number % 3 == 1);
        let count = 1 + dice.below(4);
        let mut given = sheets(&layers, count);
        if number.is_multiple_of(5) {
            // One normal, and light that does not depend on the place.
            let color = Vec3::ONE;
            given.0.lights = vec![Light::Headlight { towards: Vec3::Z, color }];
            given.0.material =
                Phong { ambient: 0.25, diffuse: 0.75, specular: 0.0, ..Phong::default() };
            change(&mut given.0, |cloud| {
                let normals = cloud.normal.iter_mut().flatten();
                normals.for_each(|n| *n = Vec3::Z * n.z.signum());
            });
        }
        let camera = camera(number % 2 == 1);
        let (color, alpha) = over(&layers);
        let nearest = layers.iter().map(|l| l.depth).fold(f32::INFINITY, f32::min);
        for test in TESTS {
            let mut settings = settings(number / 2 % 3, test);
            settings.holes = [Holes::Skipped, Holes::Background][number % 2];
            let splats = settings.splats;
            let name = format!("{layers:?} {settings:?}");
            let frame = render::<R>(&given, &camera, &settings);
            let peeling = peeling::Settings { splats, layers: 64 };
            let peeled = Drawing::new(&given.0, &camera, peeling).plain();
            for i in 0..PIXELS {
                for frame in [&frame, &peeled] {
                    assert_near(value(frame, "", i), color, part, &name);
                    assert_near(value(frame, "A", i), [alpha; 3], part, &name);
                    assert_eq!(value(frame, "layers", i), [layers.len() as f64; 3], "{name}");
                    let [depth, ..] = value(frame, "Z", i);
                    assert!((depth - f64::from(nearest)).abs() < 0.25, "{depth} {name}");
                }
            }
        }
    }
    for number in 0..60 {
        check::<f32>(number, 1e-6);
        check::<f64>(number, 2e-15);
    }
}

#[test]
fn something_opaque_hides_what_is_behind_it_and_nothing_else() {
    let (glass, wall) = (sheet(5.0, [0.0, 0.5, 1.0], 0.25), sheet(6.0, [1.0, 0.5, 0.25], 1.0));
    let behind = sheet(7.0, [0.25, 1.0, 0.75], 0.5);
    let front = Sheet { depth: 4.0, ..wall };
    for test in TESTS {
        let settings = settings(0, test);
        let render =
            |layers: &[Sheet]| render::<f64>(&sheets(layers, 2), &camera(false), &settings);
        let alone = render(&[glass, wall]);
        let more = render(&[glass, behind, wall]);
        let hidden = render(&[glass, front, behind]);
        for i in 0..PIXELS {
            // (1/4) glass + (3/4) wall.
            assert_near(value(&alone, "", i), [0.75, 0.5, 0.4375], 1e-15, "glass before a wall");
            assert_eq!(value(&alone, "A", i), [1.0; 3]);
            assert_eq!(value(&more, "", i), value(&alone, "", i), "behind the wall");
            assert_eq!(value(&hidden, "", i), [1.0, 0.5, 0.25], "a wall before glass");
            let seen = if test.is_some() { 0.0 } else { 0.25 };
            assert_eq!(value(&more, "blended.opacities", i), [seen; 3], "before the wall");
            assert_eq!(value(&more, "blended.hidden", i), [1.0; 3]);
            if test.is_some() {
                assert_eq!(value(&more, "l", i), [1.0; 3], "no glass but the nearest");
            }
        }
    }
}

/// Two discs of one layer, a little apart: in bins of epsilon they are one, in many bins two, and
/// the layer is too opaque there. A documented failure.
#[test]
fn many_bins_tear_a_layer() {
    let layers = [5.0, 5.0 + 1.0 / 64.0].map(|depth| sheet(depth, [1.0; 3], 0.5));
    let mut given = sheets(&layers, 1);
    given.1 = groups(vec![0, 0], 1);
    for (bins, expected, count) in
        [(BinCount::Count(65_535), 0.75, 2.0), (BinCount::Count(2), 0.5, 1.0)]
    {
        let settings = Settings { bins, ..settings(0, None) };
        let frame = render::<f64>(&given, &camera(true), &settings);
        for i in 0..PIXELS {
            assert_eq!(value(&frame, "A", i), [expected; 3], "{bins:?}");
            assert_eq!(value(&frame, "layers", i), [count; 3], "{bins:?}");
        }
    }
}

/// The same two discs in each of four groups before a third, by the edges of the bins: those that are staggered
/// lie between the two in some groups, by chance of the depth in none to four; common ones in all groups or in none.
#[test]
fn staggered_edges_tear_a_layer_in_some_groups() {
    const DEPTHS: [f32; 3] = [5.0, 5.0 + 1.0 / 64.0, 6.0];
    let layers = DEPTHS.map(|depth| sheet(depth, [1.0; 3], 0.5));
    let (given, camera) = (sheets(&layers, 4), camera(true));
    for edges in [BinEdges::Staggered, BinEdges::Common] {
        let mut seen = [false; 5];
        for n in 40..1200 {
            let bins = BinCount::Count(n);
            let range = bins.resolve(&given.0.surfels, &camera, 1.0).expect("few bins");
            let [low, high] = [range.nearest, range.farthest].map(f64::from);
            let shift = |k: usize| if edges == BinEdges::Common { 0.0 } else { k as f64 / 4.0 };
            let at = |t: f32, k| (f64::from(t) - low) / (high - low) * f64::from(n) + shift(k);
            let positions = (0..4).flat_map(|k| DEPTHS.map(|t| at(t, k)));
            if positions.into_iter().any(|p| (p - p.round()).abs() < 1e-9) {
                continue;
            }
            let torn = (0..4).filter(|&k| at(DEPTHS[0], k).floor() < at(DEPTHS[1], k).floor());
            let torn = torn.count();
            if std::mem::replace(&mut seen[torn], true) {
                continue;
            }
            let settings = Settings { bins, bin_edges: edges, ..settings(0, None) };
            let frame = render::<f64>(&given, &camera, &settings);
            // Three sheets of an opacity of a half where the first two are told apart, else two.
            let expected = (0.875 * torn as f64 + 0.75 * (4 - torn) as f64) / 4.0;
            for i in 0..PIXELS {
                assert_eq!(value(&frame, "A", i), [expected; 3], "{n} {edges:?}, torn in {torn}");
            }
        }
        let all = edges == BinEdges::Staggered;
        assert_eq!(seen, [true, all, all, all, true], "{edges:?}");
    }
}

/// All surfels at one place are one layer: each group keeps the first it draws.
#[test]
fn surfels_at_one_place_are_one_layer() {
    for (orthographic, test) in [(false, None), (true, None), (false, TESTS[1]), (true, TESTS[2])] {
        let layers =
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|c| sheet(5.0, c, 0.5));
        let mut given = sheets(&layers, 1);
        given.1 = groups(vec![0, 1, 0], 2);
        let camera = camera(orthographic);
        let settings = settings(0, test);
        let frame = render::<f64>(&given, &camera, &settings);
        let order = back_to_front(&given.0.surfels, &camera);
        let first = order.iter().find(|i| **i != 1).expect("two others");
        // The nearest layer takes the lower surfel, and drops the other.
        let kept = if test.is_some() { 0 } else { *first as usize };
        let mean = [0, 1, 2].map(|c| 0.25 * f64::from(layers[kept].color[c] + layers[1].color[c]));
        for i in 0..PIXELS {
            assert_near(value(&frame, "", i), mean, 1e-15, "one place");
            assert_eq!(value(&frame, "A", i), [0.5; 3]);
            assert_eq!(value(&frame, "layers", i), [1.0; 3]);
        }
    }
}

#[test]
fn one_surfel_is_itself() {
    let mut given = sheets(&[sheet(5.0, [0.5, 0.25, 0.75], 0.5)], 1);
    change(&mut given.0, |cloud| cloud.radius = Some(vec![1.0]));
    let camera = camera(false);
    for outline in 0..3 {
        let splats = settings(outline, None).splats;
        let whole = Drawing::new(&given.0, &camera, splats).plain::<f32>();
        for test in TESTS {
            let frame = render::<f32>(&given, &camera, &settings(outline, test));
            let mut covered = 0;
            for i in 0..PIXELS {
                let inside = value(&whole, "A", i)[0];
                covered += inside as usize;
                let color = [0.25, 0.125, 0.375].map(|c| c * inside);
                assert_near(value(&frame, "", i), color, 1e-7, "one surfel");
                assert_near(value(&frame, "A", i), [0.5 * inside; 3], 1e-7, "one surfel");
                for plane in ["Z", "id"] {
                    assert_eq!(value(&frame, plane, i), value(&whole, plane, i), "{plane}");
                }
            }
            assert!(covered > 50 && covered < 300, "{covered} pixels");
        }
    }
}

/// In the nearest layer a surfel has its own radius, in the others that of its group: with a band
/// of (scale - 1) r it is not drawn behind itself. (Without one it is: depths are clamped to the
/// radius, and round otherwise.)
#[test]
fn an_enlarged_disc_is_not_behind_itself() {
    for (outline, orthographic) in [(0, false), (1, false), (2, false), (0, true), (1, true)] {
        let layer = Sheet { normal: Vec3::new(0.6, 0.48, 0.64), ..sheet(5.0, [1.0; 3], 0.5) };
        let mut given = sheets(&[layer], 1);
        change(&mut given.0, |cloud| cloud.radius = Some(vec![1.5]));
        let camera = camera(orthographic);
        let mut pictures = [1.0, 1.25].into_iter().map(|scale| {
            given.1 = Groups::new(vec![0], vec![], vec![scale]).expect("a group");
            let mut settings = settings(outline, Some(DepthTest::Plain));
            settings.splats.epsilon = Epsilon::World(0.375);
            render::<f32>(&given, &camera, &settings)
        });
        let [own, enlarged] = [pictures.next(), pictures.next()].map(|p| p.expect("two pictures"));
        for name in ["", "A", "Z", "id", "layers", "weight"] {
            assert!(own.plane(name) == enlarged.plane(name), "'{name}' of outline {outline}");
        }
    }
}
