//! Scenes with opacities and an environment, their groups, and settings, all drawn by lot.

use crate::oracle::ewa::cases::{self, Kind};
use crate::oracle::kit::case::Case;
use crate::oracle::kit::dice::Dice;
use crate::oracle::kit::scene::{OUTLINES, change};
use crate::oracle::single_pass::range::by_definition;
use crate::oracle::transparent::Settings;
use splatref::composite::bins::Range;
use splatref::frame::Plane;
use splatref::method::ewa::Settings as Splats;
use splatref::method::single_pass::{BinCount, DepthTest};
use splatref::method::transparent::{BinEdges, Holes};
use splatref::scene::environment::Map;
use splatref::scene::{Cloud, Environment, Groups};
use splatref::shade::optics::{BendingLayers, Refraction};
use splatref::splat::Epsilon;
use splatref::splat::{Kernel, Outline};

/// A picture of noise to look up.
fn noise(dice: &mut Dice, height: u32) -> Environment {
    let count = 2 * height * height;
    let values = (0..count).map(|_| [(); 3].map(|()| dice.within(0.0, 4.0))).collect();
    let plane = Plane::from_values(2 * height, height, values);
    Environment::Map(Map::new(plane).expect("twice as wide as high"))
}

/// Opacities by lot, the extremes among them.
fn opacities(cloud: &mut Cloud, dice: &mut Dice, kind: usize) {
    let few = [0.0, 0.125, 0.3, 0.5, 0.75, 0.9, 1.0];
    cloud.opacity = match kind {
        0 => None,
        1 => Some(cloud.position.iter().map(|_| few[dice.below(few.len())]).collect()),
        2 => Some(vec![0.5; cloud.position.len()]),
        _ => Some(cloud.position.iter().map(|_| dice.within(0.0, 1.0)).collect()),
    };
}

/// What fills the scenes. No layers a few ulp apart: rounding alone would order them.
const FILLED: [Kind; 8] = [
    Kind::Discs,
    Kind::Axes,
    Kind::Ellipses,
    Kind::Tilted,
    Kind::Sizes,
    Kind::Degenerate,
    Kind::Shape(0),
    Kind::Shape(1),
];

/// The case of a number.
pub(crate) fn case(number: usize) -> Case<Settings> {
    let mut dice = Dice(number as u64 * 1009 + 3);
    dice.below(1);
    let epsilon = [
        Epsilon::MedianRadii(1.0),
        Epsilon::World(0.25),
        Epsilon::MedianRadii(0.125),
        Epsilon::World(0.0),
        Epsilon::World(f32::INFINITY),
    ][dice.below(5)];
    let outline = OUTLINES[number % 3];
    let kind = FILLED[(number / 3) % FILLED.len()];
    // An enlarged disc's exact outline has another centre: without a band, rounding alone would
    // decide whether it lies behind itself.
    let epsilon = match epsilon {
        Epsilon::World(0.0) if outline == Outline::Perspective => Epsilon::World(0.0625),
        epsilon => epsilon,
    };
    let kernel = [Kernel::DEFAULT, Kernel::ZPVBG01, Kernel { low_pass: 0.0, ..Kernel::DEFAULT }];
    let kernel = Kernel { outline, ..kernel[dice.below(3)] };
    let splats = Splats { kernel, epsilon, cull: dice.below(4) == 0 };
    let mut case = cases::case(kind, number as u64, splats, number % 2 == 1);
    let extremes = dice.below(5);
    change(&mut case.scene, |cloud| opacities(cloud, &mut dice, extremes));
    case.scene.environment = match dice.below(3) {
        0 => None,
        1 => Some(Environment::Sky),
        _ => Some(noise(&mut dice, 8)),
    };
    // Bins as deep as epsilon would be too many.
    let none = epsilon == Epsilon::World(0.0) || kind == Kind::Sizes;
    let bins = [BinCount::Count(1), BinCount::Count(7), BinCount::Count(64), BinCount::Count(500)];
    let lot = |dice: &mut Dice| {
        if !none && dice.below(2) == 0 { BinCount::Epsilon } else { bins[dice.below(4)] }
    };
    let nearest = match dice.below(3) {
        0 => None,
        1 => Some(DepthTest::Plain),
        _ => Some(DepthTest::Voronoi(lot(&mut dice))),
    };
    let layers = [BendingLayers::Single, BendingLayers::Multiple][dice.below(2)];
    let ratio = [[0.625, 0.6875, 0.75], [1.25, 1.5, 0.96], [1.0, 0.5, 2.0]][dice.below(3)];
    let bent = nearest.is_some() && case.scene.environment.is_some() && dice.below(3) > 0;
    let settings = Settings {
        splats,
        bins: lot(&mut dice),
        bin_edges: [BinEdges::Staggered, BinEdges::Common][number / 2 % 2],
        holes: [Holes::Skipped, Holes::Background][dice.below(2)],
        nearest,
        refraction: bent.then_some(Refraction { ratio, layers }),
    };
    let groups = extended(case.scene.surfels.len(), &mut dice);
    let name = format!("number {number}: {} {settings:?}", case.name);
    Case { name, groups: Some(groups), ..case.with(settings) }
}

impl Case<Settings> {
    /// The bins of a setting, by the oracle's own bounds of the scene.
    pub(crate) fn range(&self, bins: BinCount) -> Range {
        let Self { scene, camera, settings, .. } = self;
        let epsilon = settings.splats.epsilon.resolve(&scene.surfels);
        let range = bins.resolve(&scene.surfels, camera, epsilon).expect("few bins");
        let [nearest, farthest] = by_definition(&scene.surfels, camera);
        let (nearest, farthest) = (nearest.max(camera.near.into()) as f32, farthest as f32);
        assert_eq!([range.nearest, range.farthest], [nearest, farthest], "{}", self.name);
        let extent = f64::from(range.farthest) - f64::from(range.nearest);
        let count = match bins {
            BinCount::Count(n) => f64::from(n),
            BinCount::Epsilon => (extent / f64::from(epsilon)).ceil().max(1.0),
        };
        assert_eq!(f64::from(range.count), count, "{}", self.name);
        range
    }
}

/// Groups by lot, with additions and scales.
fn extended(surfels: usize, dice: &mut Dice) -> Groups {
    let count = [1, 2, 3, 5][dice.below(4)];
    let own = (0..surfels).map(|_| dice.below(count) as u8).collect();
    let further = if dice.below(2) == 0 { 0 } else { surfels / 3 };
    let added =
        (0..further).map(|_| (dice.below(surfels) as u32, dice.below(count) as u8)).collect();
    let scales = [1.0, 1.0, 1.25, 1.6, 0.5];
    let scale = (0..count).map(|_| scales[dice.below(scales.len())]).collect();
    Groups::new(own, added, scale).expect("groups in range")
}
