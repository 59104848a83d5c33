//! Every bug and every lawful habit, in every scene: the part of `docs/verdicts-tried.md` on Gaussian
//! splats.

use super::scenes::{Case, large, some, suite};
use super::tests::{Named, Planes, accused, alarms, bug, client, draw, misnamed, named, session};
use super::{Bug, Habit, How};
use crate::verify::client_is_right::differences;
use crate::verify::matrix::{GAUSSIANS, Section, check};
use splatref::frame::Exec;
use splatref::verdict::client::Rounding;
use std::fmt::Write;

/// In how many scenes a bug changes a bit, in how many a verdict finds it from all planes, and in how
/// many from the picture alone.
type Counts = [usize; 3];

/// The counts of each bug, and the bugs that are not found in one of the larger scenes.
fn found(cases: &[Case]) -> (Vec<Counts>, Vec<String>) {
    let exec = Exec::sequential();
    let plain: Vec<_> = cases.iter().map(|case| draw(case, How::default())).collect();
    let (mut all, mut missed) = (Vec::new(), Vec::new());
    for &own in Bug::ALL {
        let mut counts = [0; 3];
        for (case, plain) in cases.iter().zip(&plain) {
            let frame = draw(case, bug(own));
            if differences(plain, &frame).is_empty() {
                continue;
            }
            counts[0] += 1;
            let session = session(case, &exec);
            for (i, planes) in [Planes::All, Planes::Picture].into_iter().enumerate() {
                let client = client(&frame, planes, Rounding::Gpu);
                let found = alarms(&session.verify(&case.camera, &client, 1.0).unwrap());
                counts[1 + i] += usize::from(found);
                if case.camera.width > 64 && planes == Planes::All && !found {
                    missed.push(format!("{} in {}", own.name(), case.name));
                }
            }
        }
        all.push(counts);
    }
    (all, missed)
}

#[test]
#[ignore = "slow: .ci/run runs it"]
fn verdicts_on_gaussians_are_those_of_the_page() {
    let (mut lawful, some) = (suite(|_| true), some());
    let small = lawful.len();
    lawful.extend(large());
    let (accused, (counts, missed), named) = std::thread::scope(|scope| {
        let accused = scope.spawn(|| accused(&lawful));
        let found = scope.spawn(|| found(&some));
        let named = named(|_| true);
        (accused.join().unwrap(), found.join().unwrap(), named)
    });
    // The table says so.
    assert!(accused.is_empty(), "{accused:#?}");
    assert!(missed.is_empty(), "{missed:#?}");
    let wrong = misnamed(&named);
    assert!(wrong.is_empty(), "{wrong:#?}");
    check(Section::Gaussians, &page([small, some.len()], &counts, &named));
}

/// The section of the page: the bugs were tried in so many scenes of the suite and larger ones, and the
/// lawful habits in all.
fn page([suite, some]: [usize; 2], counts: &[Counts], named: &[Named]) -> String {
    let (bugs, habits, large) = (Bug::ALL.len(), Habit::ALL.len(), large().len());
    let mut page = format!("{GAUSSIANS}{bugs} bugs, {habits} lawful variants\n\n");
    let tried = some - large;
    writeln!(
        page,
        "The lawful variants were tried in the {suite} small scenes of `splatref conformance gaussians`, and in {large} larger ones. A larger one
has 403 splats, drawn by the rules of the original program, of KHR_gaussian_splatting or of Mip-Splatting. Each variant was judged under
`gpu`, and under the strictest promise that it keeps. The bugs were tried in {tried} scenes of the suite and in the larger ones.

The test that writes this part: `cargo test --release --test all -- --ignored verify::gaussians`.
"
    )
    .unwrap();
    table(&mut page, habits * (suite + large), counts);
    let nameless = named.iter().filter(|(.., name)| name.is_none());
    let nameless: Vec<&str> = nameless.map(|(own, ..)| own.name()).collect();
    writeln!(
        page,
        "
Each bug is found in the scene that the next table names, from all planes and from the colour alone. From all planes, {} bugs get the
name in the table. No bug gets a wrong name. Found as wrong, but without a name: {}.

The last columns count scenes: of those where the bug changes a bit, in how many it is found.

| bug | scene | name | found, all planes | found, colour |\n|---|---|---|---|---|",
        bugs - nameless.len(),
        nameless.join(", ")
    )
    .unwrap();
    for (own, scene, name) in named {
        let [of, all, colour] = counts[Bug::ALL.iter().position(|bug| bug == own).unwrap()];
        // What explains as much stands after the name.
        let name = name.as_deref().and_then(|name| name.split(" (explains").next());
        let (bug, name) = (own.name(), name.unwrap_or("-"));
        writeln!(page, "| {bug} | {scene} | {name} | {all} of {of} | {colour} of {of} |").unwrap();
    }
    page
}

/// What each judge finds and misses, and how many lawful pictures it was asked about.
fn table(page: &mut String, lawful: usize, counts: &[Counts]) {
    let bugs = counts.len();
    let cells: usize = counts.iter().map(|counts| counts[0]).sum();
    writeln!(
        page,
        "| judge | found, of {cells} cells | bugs found, of {bugs} | false alarms |\n|---|---|---|---|"
    )
    .unwrap();
    for (i, part) in [(1, "all planes"), (2, "colour")] {
        let found: usize = counts.iter().map(|counts| counts[i]).sum();
        let of = counts.iter().filter(|counts| counts[i] > 0).count();
        writeln!(page, "| verdict, `gpu`, {part} | {found} | {of} | 0 of {lawful} |").unwrap();
    }
    let missed = Bug::ALL.iter().zip(counts).filter(|(_, [of, all, _])| all < of);
    let missed = missed.map(|(bug, [of, all, _])| format!("{} {all} of {of}", bug.name()));
    let missed = missed.collect::<Vec<_>>().join(", ");
    let missed = if missed.is_empty() { "none" } else { &missed };
    writeln!(page, "\nNot found in every scene under `gpu`, from all planes: {missed}.").unwrap();
}
