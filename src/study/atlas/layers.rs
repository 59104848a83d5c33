//! Entries about layers that epsilon separates.

use super::case::{Case, exact};
use super::{Failure, Found};
use crate::error::Result;
use crate::frame::Exec;
use crate::method::single_pass::{self, BinCount, DepthTest};
use crate::method::{Method, ewa};
use crate::scene::{Cloud, Scene, Surfels};
use crate::source::Shape;
use crate::splat::Epsilon;

pub(super) const FAILURES: [Failure; 4] = [
    Failure {
        id: "eps-sheets",
        title: "The sheet behind bleeds through",
        why: "Two sheets of 20,000 surfels lie one behind the other. Fragments within epsilon of \
              the nearest depth are blended with it [GP03; ZP06, 3]. With the default epsilon of \
              two median radii both sheets are blended once they are that close.",
        swept: "gap, median radii",
        values: &[16.0, 8.0, 4.0, 3.0, 2.5, 2.0, 1.5, 1.0, 0.5, 0.25],
        error: "RMSE, linear RGB",
        limit: 0.05,
        cure: "an `--epsilon` of half the gap, as long as it exceeds the depth range of the \
               surface within a disc",
        at: sheets,
    },
    Failure {
        id: "eps-slope",
        title: "A curved surface leaves its band and is torn",
        why: "A sphere of 2,000 surfels is drawn with a smaller and smaller epsilon. Discs that \
              overlap in a pixel differ in depth by up to their radius times the slope. Discs \
              beyond epsilon are not blended, so the nearest one is seen alone.",
        swept: "epsilon, median radii",
        values: &[4.0, 2.0, 1.0, 0.5, 0.25, 0.125, 0.0625, 0.03125],
        error: "normal error, 99 %, degrees",
        limit: 3.0,
        cure: "`--epsilon 2r`, the default",
        at: slope,
    },
    Failure {
        id: "eps-default",
        title: "One epsilon does not fit a scan of uneven density",
        why: "The left half is from a sphere of 40,000 surfels, the right half from a sphere of \
              fewer. The default epsilon is two radii of the median surfel, which is less than one \
              radius of a large surfel. Where large discs overlap, they are therefore not blended, \
              and the surface is torn.",
        swept: "how many times denser the left half is",
        values: &[1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 256.0],
        error: "normal error, 99 %, degrees",
        limit: 10.0,
        cure: "an `--epsilon` of two of the large radii",
        at: density,
    },
    Failure {
        id: "voronoi-bin",
        title: "Depth bins thinner than a disc is deep cut layers apart",
        why: "The single pass draws a sphere of 5,000 surfels with Voronoi depth [ZP06, 5.1, eq. \
              10]. Within a depth bin the disc with the nearest centre wins. Two fragments of one \
              layer on either side of a border between bins are compared by depth, as in the plain \
              test. Thinner bins have more such borders.",
        swept: "bins",
        values: &[8.0, 16.0, 32.0, 64.0, 128.0, 256.0, 1024.0, 4096.0],
        error: "RMSE, linear RGB, to the picture of EWA",
        limit: 0.015,
        cure: "`--bins epsilon`, the default",
        at: bins,
    },
];

fn epsilon(epsilon: Epsilon) -> Method {
    ewa::Settings { epsilon, ..ewa::Settings::default() }.into()
}

fn sheets(radii: f64, exec: &Exec) -> Result<[Found; 2]> {
    let trial = Shape::Sheets { gap: 1.0 }.surfels(20_000, 0)?;
    let radius = f64::from(Epsilon::MedianRadii(1.0).resolve(&trial));
    let shape = Shape::Sheets { gap: (radii * radius) as f32 };
    let case = Case::of_shape(shape, 20_000, epsilon(Epsilon::DEFAULT))?;
    let truth = case.truth(&exact(shape), exec)?;
    let half = Epsilon::World((radii * radius / 2.0) as f32);
    case.and_cured(epsilon(half), &truth, "rmse", exec)
}

fn slope(radii: f64, exec: &Exec) -> Result<[Found; 2]> {
    let swept = Epsilon::MedianRadii(radii as f32);
    let case = Case::of_shape(Shape::Sphere, 2000, epsilon(swept))?;
    let truth = case.truth(&exact(Shape::Sphere), exec)?;
    case.and_cured(epsilon(Epsilon::DEFAULT), &truth, "normal-99", exec)
}

fn density(times: f64, exec: &Exec) -> Result<[Found; 2]> {
    let surfels = halves(40_000, times)?;
    let most = surfels.radius().iter().fold(0.0, |a, b| if *b > a { *b } else { a });
    let mut case = Case::of_shape(Shape::Sphere, 1, epsilon(Epsilon::DEFAULT))?;
    case.scene = Scene::lit("sphere", surfels);
    let truth = case.truth(&exact(Shape::Sphere), exec)?;
    case.and_cured(epsilon(Epsilon::World(2.0 * most)), &truth, "normal-99", exec)
}

/// The left half of a sphere of this many surfels, and the right half of a sphere with `times`
/// fewer.
fn halves(count: usize, times: f64) -> Result<Surfels> {
    let half = |count: usize, left: bool| -> Result<Cloud> {
        let surfels = Shape::Sphere.surfels(count, 0)?;
        let all = (0..).zip(surfels.position());
        let kept: Vec<u32> = all.filter(|(_, p)| (p.x <= 0.0) == left).map(|(i, _)| i).collect();
        Ok(surfels.into_cloud().some(&kept))
    };
    let (mut dense, sparse) = (half(count, true)?, half((count as f64 / times) as usize, false)?);
    dense.position.extend(sparse.position);
    let both = |own: &mut Option<Vec<_>>, other: Option<Vec<_>>| {
        own.iter_mut().zip(other).for_each(|(own, other)| own.extend(other));
    };
    both(&mut dense.normal, sparse.normal);
    both(&mut dense.color, sparse.color);
    dense.radius.iter_mut().zip(sparse.radius).for_each(|(own, other)| own.extend(other));
    Ok(Surfels::new(dense)?.0)
}

fn bins(count: f64, exec: &Exec) -> Result<[Found; 2]> {
    let splats = ewa::Settings::default();
    let mut case = Case::of_shape(Shape::Sphere, 5000, splats.into())?;
    let truth = case.draw(exec)?.0;
    let method = |bins| -> Method {
        single_pass::Settings { splats, depth: DepthTest::Voronoi(bins) }.into()
    };
    case.method = method(BinCount::Count(count as u32));
    case.and_cured(method(BinCount::Epsilon), &truth, "rmse", exec)
}
