//! The names that verdicts give to the bugs of the second implementations: every bug before every
//! cause. The page is `docs/verdicts-tried.md`.

use super::matrix::{Draws, NAMES, Picture, Section, check};
use splatref::verdict::causes::likely_cause;
use splatref::verdict::client::Client;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// The most scenes in which a bug is named.
const MOST_SCENES: usize = 3;

/// The fewest wrong pixels in which a bug is named. A change that explains fewer may do so by chance.
const LEAST_WRONG: u64 = 6;

/// The bugs that have a cause of their own, and words of its name.
const OWN: [(&str, &str); 66] = [
    ("AmplitudeMissing", "lack the amplitude"),
    ("BinCeiled", "rounded up to a bin"),
    ("BinIgnored", "in one bin"),
    ("BinRounded", "nearest bin"),
    ("CellNan", "NaN in 1 of"),
    ("ColorNotDivided", "multiplied by the weight"),
    ("CountOffByOne", "count begins at 1"),
    ("CullingIgnored", "culling is on"),
    ("CullingInverted", "fronts are culled"),
    ("CutoffNotSquared", "compared with k"),
    ("Depth16", "16 bits"),
    ("DepthClampMissing", "not clamped"),
    ("DepthOfCenter", "depth of its centre"),
    ("DiscardedWriteDepth", "should be discarded"),
    ("DiscsMovedBack", "moved back"),
    ("DiscsMovedForward", "moved towards the eye"),
    ("DisplacementNotHalved", "the pull takes cells of twice"),
    ("EpsilonAlongRay", "along the ray"),
    ("EpsilonDouble", "twice as wide"),
    ("EpsilonHalf", "half as wide"),
    ("EpsilonIgnored", "ignored"),
    ("EpsilonOfDepthBuffer", "unit"),
    ("EpsilonOfNearestRadius", "radii of the nearest"),
    ("EpsilonOfNearness", "unit"),
    ("EpsilonOtherUnit", "unit"),
    ("EpsilonReversed", "lies behind"),
    ("EpsilonSubtracted", "wrong side"),
    ("ExpWithoutHalf", "exp(-q)"),
    ("FastExp", "coarse `exp`"),
    ("HalfPixelOff", "half a pixel"),
    ("HalfSums", "sums in half floats"),
    ("LevelsByRadius", "`levels` is"),
    ("LowPassDoubled", "added twice"),
    ("LowPassMissing", "filter is missing"),
    ("LowPassOnRadius", "added to the radius"),
    ("NearestAlone", "epsilon is 0"),
    ("NearestIgnored", "epsilon is ignored"),
    ("NearestTwice", "nearest fragment is added twice"),
    ("NoHalfPixel", "half a pixel"),
    ("NormalInWorld", "stay in world space"),
    ("NormalNotTurned", "view"),
    ("NormalNotUnit", "not made unit"),
    ("NormalsNotReversed", "behind are not turned"),
    ("NormalsTransposed", "transpose of the camera"),
    ("OccludedStays", "occluded cells are kept"),
    ("OverlapIgnored", "whether or not"),
    ("PixelNan", "NaN in 1 of"),
    ("PrincipalPointOff", "half a pixel to the right"),
    ("PushUnweighted", "`weights` is"),
    ("QuadsFloored", "quads too small"),
    ("QuadsTooSmall", "quads too small"),
    ("RadiusNotDivided", "is the radius, not"),
    ("RatioMissing", "ratio of Voronoi depths is missing"),
    ("RatioNotByCutoff", "not divided by k"),
    ("RatioReversed", "ratio is reversed"),
    ("RatioSign", "ratio is subtracted"),
    ("RatioSquared", "not its root"),
    ("RatioUncapped", "goes up to 1"),
    ("RowsFlipped", "rows are flipped"),
    ("SideNotDoubled", "the side 1"),
    ("SkewSign", "sign of their tilt"),
    ("SlopeSign", "down the screen"),
    ("SplatMissing", "is missing"),
    ("SplatTwice", "is added twice"),
    ("TiesReversed", "ties"),
    ("VoronoiIgnored", "`depth` is plain"),
];

/// Bugs without a cause of their own, and a name that is right for them.
const ALLOWED: [(&str, &str); 24] = [
    ("CutoffBarelyLarger", "limit of q"),
    ("CutoffBarelySmaller", "limit of q"),
    ("CutoffLarger", "limit of q"),
    ("CutoffSmaller", "limit of q"),
    ("CutoffVisiblyLarger", "limit of q"),
    ("CutoffVisiblySmaller", "limit of q"),
    ("CutoffVisiblySmaller", "cut-off is too small"),
    ("CutoffSmaller", "cut-off is too small"),
    ("CutoffBarelySmaller", "cut-off is too small"),
    ("NormalNotTurned", "without being turned"),
    ("CutoffNotSquared", "limit of q"),
    ("SquareRootOfPicture", "gamma of 2"),
    ("Srgb", "sRGB where"),
    ("SumsSaturate", "end at 1"),
    ("SurfelMissing", "is missing"),
    ("TileDropped", "nothing is drawn"),
    ("TemplateTooSmall", "`template` is"),
    ("RimWithoutWeight", "missing guard"),
    ("WeightNan", "NaN in 1"),
    // With one group nothing is left.
    ("GroupNotSummed", "nothing is added up"),
    ("HalfImages", "half floats"),
    ("IdTiesByGroup", "ties"),
    ("BinCountOff", "`bins` is"),
    ("ColorByCount", "divided by the count"),
];

/// Bugs that have no cause in a method, where others of their name have one.
const NOT_IN: [(&str, &str); 3] = [
    ("pyramid", "NormalNotUnit"),
    ("single-pass", "DiscardedWriteDepth"),
    ("template", "NormalNotUnit"),
];

/// Whether a bug of a method has a name of its own.
fn has_own(method: &str, bug: &str) -> bool {
    OWN.iter().any(|(own, _)| *own == bug) && !NOT_IN.contains(&(method, bug))
}

/// Whether a name is right for a bug.
fn is_right(bug: &str, name: &str) -> bool {
    let mut all = OWN.iter().chain(&ALLOWED);
    all.any(|(own, words)| *own == bug && name.contains(words))
}

/// What is said of a bug, in the scenes where its verdict is wrong.
#[derive(Default)]
struct Said {
    scenes: usize,
    right: usize,
    names: BTreeSet<String>,
    wrong: BTreeSet<String>,
}

/// What is said of the bugs of a method.
fn names(method: &str, draws: Draws) -> BTreeMap<String, Said> {
    let mut all: BTreeMap<String, Said> = BTreeMap::new();
    draws(&mut |picture: Picture<'_>| {
        let Picture { session, camera, what, frame, scene, .. } = &picture;
        let tried = all.get(what).map_or(0, |said| said.scenes);
        if picture.keeps.is_some() || tried >= MOST_SCENES {
            return;
        }
        let client = Client::from(frame);
        let verdict = session.verify(camera, &client, 1.0).unwrap();
        if verdict
            .first_wrong()
            .is_none_or(|stage| stage.wrong < LEAST_WRONG && has_own(method, what))
        {
            return;
        }
        let said = all.entry(what.clone()).or_default();
        said.scenes += 1;
        let Some(name) = likely_cause(session, camera, &client, &verdict).unwrap() else { return };
        if is_right(what, &name) {
            said.right += 1;
            said.names.insert(without_numbers(&name));
        } else {
            said.wrong.insert(format!("{what} in {scene}: {name}"));
        }
    });
    all
}

/// A name whose numbers are written as `N`, because a scene has numbers of its own.
fn without_numbers(name: &str) -> String {
    // What explains as much stands after the name.
    let name = name.split(" (explains").next().unwrap_or(name);
    let is_number = |word: &str| word.parse::<f64>().is_ok();
    let words = name.split(' ').map(|word| match word.trim_end_matches([',', ';', ':']) {
        number if is_number(number) => word.replace(number, "N"),
        _ => word.to_owned(),
    });
    words.collect::<Vec<_>>().join(" ")
}

/// The rows of a method, and how many of its cells there are, and have the right name.
fn table(method: &str, said: &BTreeMap<String, Said>, page: &mut String) -> [usize; 2] {
    page.push_str("| bug | name | right, of the scenes |\n|---|---|---|\n");
    let mut cells = [0; 2];
    for (bug, Said { scenes, right, names, .. }) in
        said.iter().filter(|(bug, _)| has_own(method, bug))
    {
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        writeln!(page, "| {bug} | {} | {right} of {scenes} |", names.join("; ")).unwrap();
        cells = [cells[0] + scenes, cells[1] + right];
    }
    let others: Vec<&str> =
        said.keys().map(String::as_str).filter(|bug| !has_own(method, bug)).collect();
    writeln!(page, "\nWithout a name of their own: {}.", others.join(", ")).unwrap();
    cells
}

const INTRODUCTION: &str = "
A verdict that is wrong names the mistake if a known one explains the wrong pixels. The tables list each bug that has a name of its own,
the name that `verify` gives, and in how many scenes: the first three in which the verdict under `gpu` is wrong, from all planes, in at
least six pixels. In the other scenes `verify` names nothing. It gives no bug a wrong name; the test fails otherwise.

The test that writes this part: `cargo test --release --test all -- --ignored matrix_of_causes`.
";

#[test]
#[ignore = "slow: .ci/run runs it"]
fn every_bug_has_its_own_name_or_none() {
    let clients: [(&str, Draws); 4] = [
        ("ewa", super::verdicts::pictures),
        ("single-pass", super::groups::pictures),
        ("pyramid", super::image_space::pictures_of_pyramid),
        ("template", super::image_space::pictures_of_template),
    ];
    let (mut page, mut wrong, mut cells) = (String::new(), Vec::new(), [0; 2]);
    let all: Vec<_> = std::thread::scope(|scope| {
        let all = clients.map(|(method, draws)| scope.spawn(move || names(method, draws)));
        all.into_iter().map(|thread| thread.join().unwrap()).collect()
    });
    for ((method, _), said) in clients.iter().zip(&all) {
        writeln!(page, "\n### Names in {method}\n").unwrap();
        let [more, right] = table(method, said, &mut page);
        cells = [cells[0] + more, cells[1] + right];
        wrong.extend(said.values().flat_map(|said| &said.wrong));
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    let [all, right] = cells;
    assert!(10 * right >= 9 * all, "{right} of {all} have the right name");
    let summary = format!("\nIn {right} of {all} cells the bug has the right name.\n");
    check(Section::Names, &format!("{NAMES}\n{INTRODUCTION}{summary}{page}"));
}
