//! The page in `docs/` says what is measured.

use super::page::lasting;
use super::*;
use std::collections::BTreeSet;
use std::path::Path;

#[test]
fn every_claim_is_of_a_page_that_is_there() {
    let docs = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/docs"));
    let all = claims();
    let names: BTreeSet<&str> = all.iter().map(|claim| claim.id).collect();
    assert_eq!(names.len(), all.len(), "no two have one name");
    for claim in all {
        assert!(docs.join(claim.more).is_file(), "{}", claim.id);
        assert_eq!(claim.timed, claim.measured.starts_with("ms"), "{}", claim.id);
    }
}

fn kept() -> String {
    let page = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/claims.md"));
    lasting(&std::fs::read_to_string(page).unwrap())
}

fn of_errors() -> Vec<&'static Claim> {
    claims().into_iter().filter(|claim| !claim.timed).collect()
}

/// A row without what is said of formats.
fn in_f32(line: &str) -> String {
    let cells: Vec<&str> = line.split('|').collect();
    match cells.len() {
        13 => [&cells[..8], &cells[11..]].concat().join("|"),
        _ => line.to_owned(),
    }
}

#[test]
fn the_page_is_what_is_measured() {
    let exec = Exec::new(2, 32).unwrap();
    let measured = verdicts(&of_errors(), &[], &exec, &|_, _, _| ()).unwrap();
    let (now, then) = (lasting(&page(&measured).text), kept());
    let lines = |page: &str| page.lines().map(in_f32).collect::<Vec<_>>();
    assert!(lines(&then).concat().len() < then.len(), "there are columns of formats");
    assert_eq!(lines(&now), lines(&then), "splatref study claims -o docs");
}

#[test]
#[ignore = "a minute: every picture stage by stage in two more formats; .ci/run runs it"]
fn the_page_is_what_is_measured_in_every_format() {
    let exec = Exec::new(2, 32).unwrap();
    let measured = verdicts(&of_errors(), &FORMATS, &exec, &|_, _, _| ()).unwrap();
    assert_eq!(lasting(&page(&measured).text), kept(), "splatref study claims -o docs");
}
