//! Entries about groups of surfels that overlap little.

use super::case::Case;
use super::{Failure, Found};
use crate::error::Result;
use crate::frame::{Exec, Frame};
use crate::index::grouping::{Extension, Grouping, Rules};
use crate::method::single_pass::{self, BinCount, DepthTest};
use crate::method::transparent::BinEdges;
use crate::method::{Method, ewa, peeling, transparent, transparent_hq};
use crate::scene::{Cloud, Scene, Surfels};
use crate::source::Shape;

pub(super) const FAILURES: [Failure; 3] = [
    Failure {
        id: "group-c",
        title: "Surfels of one group that overlap show flaps",
        why: "The single pass draws the spheres of the cluster, 20,000 surfels. A smaller c, down \
              to 0, lets surfels of one group overlap more, so that fewer groups are needed [ZP06, \
              5.1]. Where two surfels of one group overlap, the plain depth test keeps the \
              nearest.",
        swept: "c",
        values: &[1.0, 0.8, 0.6, 0.4, 0.2],
        error: "RMSE, linear RGB, to the picture of EWA",
        limit: 0.01,
        cure: "`--overlap 1`, the default: more groups; Voronoi depth alone removes a fifth of the \
               error",
        at: overlap,
    },
    Failure {
        id: "transparent-holes",
        title: "Groups that do not cover the surface",
        why: "Algorithm 2 draws a torus of 4,000 surfels with opacity 0.4 [ZP06, 4.2]. Each of K \
              groups shows a part of the surface. Where a group has a hole, its picture lacks a \
              layer. The average of K groups is then too transparent, or shows the background.",
        swept: "K",
        values: &[2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0],
        error: "RMSE, linear RGB, to the picture of peeling",
        limit: 0.05,
        cure: "`--extend enlarge`: the discs of each group grow until they cover",
        at: holes,
    },
    Failure {
        id: "bin-arcs",
        title: "Arcs at the borders of depth bins",
        why: "Algorithm 3 draws a torus of 20,000 surfels with opacity 0.4 [ZP06, 4.2.1]. \
              Fragments belong to one layer if they share a depth bin. A surface that passes from \
              one bin to the next becomes two layers where discs of both bins overlap. These \
              places are arcs, and they are too opaque.",
        swept: "bins",
        values: &[8.0, 16.0, 32.0, 64.0, 128.0, 256.0, 512.0, 1024.0, 4096.0],
        error: "RMSE, linear RGB, to the picture of peeling",
        limit: 0.012,
        cure: "`--bins epsilon --bin-edges staggered`, the defaults; the broken sweep has \
               `--bin-edges common`",
        at: arcs,
    },
];

fn rules(overlap: f32) -> Rules {
    Rules { overlap, opposite: true, coplanar: None }
}

fn overlap(c: f64, exec: &Exec) -> Result<[Found; 2]> {
    let splats = ewa::Settings::default();
    let mut case = Case::of_shape(Shape::Cluster, 20_000, splats.into())?;
    let truth = case.draw(exec)?.0;
    case.method = single_pass::Settings { splats, depth: DepthTest::Plain }.into();
    let mut found = |c: f64| {
        let rules = rules(c as f32);
        case.grouping = Some(Grouping { rules, count: None, extension: Extension::None });
        case.against(&truth, "rmse", exec)
    };
    Ok([found(c)?, found(1.0)?])
}

/// A transparent torus, and its picture by peeling.
fn torus(count: usize, splats: ewa::Settings, exec: &Exec) -> Result<(Case, Frame<f32>)> {
    let method = peeling::Settings { splats, layers: 64 };
    let mut case = Case::of_shape(Shape::Torus, count, method.into())?;
    let cloud = case.scene.surfels.into_cloud();
    let opacity = Some(vec![0.4; cloud.position.len()]);
    case.scene = Scene::lit("torus", Surfels::new(Cloud { opacity, ..cloud })?.0);
    let truth = case.draw(exec)?.0;
    Ok((case, truth))
}

fn holes(groups: f64, exec: &Exec) -> Result<[Found; 2]> {
    let splats = ewa::Settings::BOTH_SIDES;
    let (mut case, truth) = torus(4000, splats, exec)?;
    let holes = transparent::Holes::Background;
    // Algorithm 2 to the letter.
    let bin_edges = BinEdges::Common;
    let settings =
        transparent::Settings { splats, holes, bin_edges, ..transparent::Settings::default() };
    case.method = settings.into();
    let count = Some(groups as usize);
    let mut found = |extension| {
        case.grouping = Some(Grouping { rules: rules(1.0), count, extension });
        case.against(&truth, "rmse", exec)
    };
    Ok([found(Extension::None)?, found(Extension::Enlarge)?])
}

fn arcs(bins: f64, exec: &Exec) -> Result<[Found; 2]> {
    let splats = ewa::Settings::BOTH_SIDES;
    let (mut case, truth) = torus(20_000, splats, exec)?;
    let extension = Extension::Add { most: 0.5 };
    case.grouping = Some(Grouping { rules: rules(1.0), count: Some(4), extension });
    let method = |layers| -> Method {
        transparent_hq::Settings { layers, ..transparent_hq::Settings::default() }.into()
    };
    let layers = transparent::Settings { splats, ..transparent::Settings::default() };
    let bins = BinCount::Count(bins as u32);
    case.method = method(transparent::Settings { bins, bin_edges: BinEdges::Common, ..layers });
    case.and_cured(method(layers), &truth, "rmse", exec)
}
