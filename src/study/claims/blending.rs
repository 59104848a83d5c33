//! Claims of \[ZP06\]: groups, Voronoi depth, transparency.

use super::subject::{Subject, colors, groups};
use super::{Claim, Measured};
use crate::compare::metrics::visible;
use crate::error::Result;
use crate::index::grouping::{Extension, Grouping};
use crate::method::single_pass::{self, BinCount, DepthTest};
use crate::method::transparent::{BinEdges, Holes};
use crate::method::{Method, ewa, peeling, transparent, transparent_hq};

pub(super) const CLAIMS: [Claim; 13] = [
    Claim {
        id: "zp06-groups",
        from: "[ZP06] 6.1, Table 1",
        says: "the number of groups falls to less than a half as c goes from 1 to 0.4",
        measured: "K, at most 0.5 times: c = 0.4; c = 1",
        at_most: 0.5,
        timed: false,
        more: "zp06.md",
        of: counts,
    },
    Claim {
        id: "zp06-voronoi",
        from: "[ZP06] 5.1, Fig. 9",
        says: "artifacts caused by overlapping splats within a group are reduced by Voronoi rasterization",
        measured: "RMSE to the picture of 2 + 1 passes, c = 0.4: Voronoi depth; plain depth",
        at_most: 1.0,
        timed: false,
        more: "zp06.md",
        of: voronoi,
    },
    Claim {
        id: "zp06-c",
        from: "[ZP06] 6.1, Fig. 8",
        says: "hardly any visible artifacts are introduced even if c is set as low as 0.4",
        measured: "pixels inside that are visibly off the picture of 2 + 1 passes, %: c = 0.4, Voronoi depth; limit",
        at_most: 1.0,
        timed: false,
        more: "zp06.md",
        of: relaxed,
    },
    Claim {
        id: "zp06-single",
        from: "[ZP06] 6.1, Table 2",
        says: "1 + 1 passes are faster than 2 + 1 passes",
        measured: "ms: `single-pass`, c = 0.4; `ewa`",
        at_most: 1.0,
        timed: true,
        more: "zp06.md",
        of: single,
    },
    Claim {
        id: "zp06-cover",
        from: "[ZP06] 6.2, Fig. 11",
        says: "there is less surface coverage for K = 8 than for K = 4",
        measured: "part of the surface that a group covers, mean of groups: K = 8; K = 4",
        at_most: 1.0,
        timed: false,
        more: "zp06.md",
        of: |subject| by_groups(subject, |covered, _, count| covered / count),
    },
    Claim {
        id: "zp06-overlaps",
        from: "[ZP06] 6.2, Fig. 11",
        says: "splats have smaller overlaps for K = 8 than for K = 4",
        measured: "part of the area of the splats that others of their group cover: K = 8; K = 4",
        at_most: 1.0,
        timed: false,
        more: "zp06.md",
        of: |subject| by_groups(subject, |covered, splats, _| 1.0 - covered / splats),
    },
    Claim {
        id: "zp06-added",
        from: "[ZP06] 6.2",
        says: "covering the surface with four groups takes 45 % more points",
        measured: "points that are added, at most 0.45 times: K = 4, `--most 0.5`; all points",
        at_most: 0.45,
        timed: false,
        more: "zp06.md",
        of: added,
    },
    Claim {
        id: "zp06-enlarge",
        from: "[ZP06] 6.2",
        says: "if K is larger, enlarging radii is the better choice than adding splats",
        measured: "RMSE to depth peeling, Algorithm 3, K = 8: `--extend enlarge`; `--extend add`",
        at_most: 1.0,
        timed: false,
        more: "zp06.md",
        of: enlarged,
    },
    Claim {
        id: "zp06-all",
        from: "[ZP06] 6.2, Fig. 12",
        says: "artifacts are hardly visible by Algorithm 2",
        measured: "pixels inside that are visibly off depth peeling, %: Algorithm 2, K = 4, `--extend add`; limit",
        at_most: 1.0,
        timed: false,
        more: "zp06.md",
        of: |subject| off_peeling(subject, |[_, all]| all, HARDLY),
    },
    Claim {
        id: "zp06-far",
        from: "[ZP06] 6.2, Fig. 12",
        says: "virtually no difference is visible by Algorithm 3",
        measured: "pixels inside that are visibly off depth peeling, %: Algorithm 3, K = 4, `--extend add`; limit",
        at_most: 1.0,
        timed: false,
        more: "zp06.md",
        of: |subject| off_peeling(subject, |[nearest, _]| nearest, VIRTUALLY_NONE),
    },
    Claim {
        id: "zp06-holes",
        from: "[ZP06] 5.2.1",
        says: "the pictures of all groups are averaged, with the background where a group has a hole",
        measured: "RMSE to depth peeling, Algorithm 2, K = 4, `--extend add`: `--holes background`; `--holes skipped`",
        at_most: 1.0,
        timed: false,
        more: "zp06.md",
        of: holes,
    },
    Claim {
        id: "zp06-nearest",
        from: "[ZP06] 5.2.2",
        says: "artifacts of Algorithm 2 are further reduced if the nearest layer is drawn separately",
        measured: "RMSE to depth peeling, K = 4, `--extend add`: Algorithm 3; Algorithm 2",
        at_most: 1.0,
        timed: false,
        more: "zp06.md",
        of: layers,
    },
    Claim {
        id: "zp06-peeling",
        from: "[ZP06] 6.2",
        says: "Algorithm 3 has 5 frames per second where depth peeling of at most 8 layers has less than 2",
        measured: "ms, at most 0.4 times: Algorithm 3; peeling of 8 layers",
        at_most: 0.4,
        timed: true,
        more: "zp06.md",
        of: peeled,
    },
];

const RELAXED: f32 = 0.4;

/// The limits for *hardly any* pixels and for *virtually none*, in per cent.
const HARDLY: f64 = 5.0;
const VIRTUALLY_NONE: f64 = 1.0;

fn single_pass(depth: DepthTest) -> Method {
    single_pass::Settings { splats: ewa::Settings::default(), depth }.into()
}

fn two_passes() -> Method {
    ewa::Settings::default().into()
}

fn voronoi(subject: &Subject<'_>) -> Result<Measured> {
    let truth = subject.reference(two_passes(), None)?;
    let grouping = groups(RELAXED, None, Extension::None);
    let drawn = [DepthTest::Voronoi(BinCount::Epsilon), DepthTest::Plain]
        .map(|depth| subject.draw(single_pass(depth), Some(&grouping)));
    let [first, second] = drawn;
    let (first, second) = (first?, second?);
    let error = |frame| subject.error(frame, &truth, "rmse");
    Ok(Measured {
        numbers: [error(&first)?, error(&second)?],
        pictures: colors(&[&first, &second])?,
    })
}

fn relaxed(subject: &Subject<'_>) -> Result<Measured> {
    let truth = subject.reference(two_passes(), None)?;
    let grouping = groups(RELAXED, None, Extension::None);
    let drawn = subject.draw(single_pass(DepthTest::default()), Some(&grouping))?;
    let numbers = [visible(&drawn, &truth)?, HARDLY];
    Ok(Measured { numbers, pictures: colors(&[&drawn, &truth])? })
}

fn single(subject: &Subject<'_>) -> Result<Measured> {
    let grouping = groups(RELAXED, None, Extension::None);
    let one = subject.session(single_pass(DepthTest::default()), Some(&grouping))?;
    let numbers = subject.times([one, subject.session(two_passes(), None)?])?;
    Ok(Measured { numbers, pictures: Vec::new() })
}

fn counts(subject: &Subject<'_>) -> Result<Measured> {
    let count = |overlap| -> Result<f64> {
        let grouping = groups(overlap, None, Extension::None);
        Ok(subject.groups(&grouping)?.0.len() as f64)
    };
    Ok(Measured { numbers: [count(RELAXED)?, count(1.0)?], pictures: Vec::new() })
}

/// Four groups that cover the surface, by added splats.
const ADDED: Extension = Extension::Add { most: 0.5 };

fn added(subject: &Subject<'_>) -> Result<Measured> {
    let surfels = &subject.scene.surfels;
    let (_, extended) = subject.groups(&groups(1.0, Some(4), ADDED))?;
    let added = extended.map_or(0, |found| found.added);
    Ok(Measured { numbers: [added as f64, surfels.len() as f64], pictures: Vec::new() })
}

/// A figure of 8 groups and of 4. It is computed from the area that all groups cover and the area
/// of all splats, both as fractions of the surface, and from the number of groups.
fn by_groups(subject: &Subject<'_>, of: fn(f64, f64, f64) -> f64) -> Result<Measured> {
    let surfels = &subject.scene.surfels;
    let numbers = [8, 4].map(|count| {
        let (_, extended) = subject.groups(&groups(1.0, Some(count), Extension::Enlarge))?;
        let (area, groups) = extended.map_or((0.0, Vec::new()), |found| (found.area, found.groups));
        let covered = groups.iter().map(|group| group.before).sum();
        let square = |radius: &f32| f64::from(*radius) * f64::from(*radius);
        let splats = surfels.radius().iter().map(square).sum::<f64>() * std::f64::consts::PI;
        Ok(of(covered, splats / area, count as f64))
    });
    let [first, second] = numbers;
    Ok(Measured { numbers: [first?, second?], pictures: Vec::new() })
}

/// The bins of all groups begin where the paper's do.
const AS_PUBLISHED: transparent::Settings = transparent::Settings {
    splats: ewa::Settings::BOTH_SIDES,
    bins: BinCount::Epsilon,
    bin_edges: BinEdges::Common,
    holes: Holes::Skipped,
};

/// Algorithms 3 and 2, and peeling of this many layers, with both sides drawn.
fn transparencies(count: u32) -> [Method; 3] {
    let splats = ewa::Settings::BOTH_SIDES;
    [
        transparent_hq::Settings { layers: AS_PUBLISHED, ..transparent_hq::Settings::default() }
            .into(),
        AS_PUBLISHED.into(),
        peeling::Settings { splats, layers: count }.into(),
    ]
}

/// The errors of two transparent pictures of the subject against peeling, each by a method and its
/// groups.
fn to_peeling(subject: &Subject<'_>, drawn: [(Method, Grouping); 2]) -> Result<Measured> {
    let subject = subject.transparent()?;
    let [.., peeling] = transparencies(64);
    let truth = subject.reference(peeling, None)?;
    let [first, second] = drawn.map(|(method, groups)| subject.draw(method, Some(&groups)));
    let (first, second) = (first?, second?);
    let error = |frame| subject.error(frame, &truth, "rmse");
    Ok(Measured {
        numbers: [error(&first)?, error(&second)?],
        pictures: colors(&[&first, &second, &truth])?,
    })
}

fn layers(subject: &Subject<'_>) -> Result<Measured> {
    let [nearest, all, _] = transparencies(64);
    to_peeling(subject, [nearest, all].map(|method| (method, groups(1.0, Some(4), ADDED))))
}

fn holes(subject: &Subject<'_>) -> Result<Measured> {
    let drawn = [Holes::Background, Holes::Skipped].map(|holes| {
        let method = transparent::Settings { holes, ..AS_PUBLISHED };
        (method.into(), groups(1.0, Some(4), ADDED))
    });
    to_peeling(subject, drawn)
}

fn off_peeling(
    subject: &Subject<'_>,
    which: fn([Method; 2]) -> Method,
    limit: f64,
) -> Result<Measured> {
    let subject = subject.transparent()?;
    let [nearest, all, peeling] = transparencies(64);
    let truth = subject.reference(peeling, None)?;
    let drawn = subject.draw(which([nearest, all]), Some(&groups(1.0, Some(4), ADDED)))?;
    let numbers = [visible(&drawn, &truth)?, limit];
    Ok(Measured { numbers, pictures: colors(&[&drawn, &truth])? })
}

fn enlarged(subject: &Subject<'_>) -> Result<Measured> {
    let [nearest, ..] = transparencies(64);
    let drawn = [Extension::Enlarge, ADDED].map(|how| (nearest, groups(1.0, Some(8), how)));
    to_peeling(subject, drawn)
}

fn peeled(subject: &Subject<'_>) -> Result<Measured> {
    let subject = subject.transparent()?;
    let [nearest, _, peeling] = transparencies(8);
    let grouping = groups(1.0, Some(4), ADDED);
    let first = subject.session(nearest, Some(&grouping))?;
    let numbers = subject.times([first, subject.session(peeling, None)?])?;
    Ok(Measured { numbers, pictures: Vec::new() })
}
