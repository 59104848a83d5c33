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

/// All that the page says of errors; the page is blessed by `splatref study claims -o docs`.
#[test]
fn the_page_is_what_is_measured() {
    let exec = Exec::new(2, 32).unwrap();
    let errors = claims().into_iter().filter(|claim| !claim.timed);
    let verdicts: Vec<_> = errors.map(|claim| claim.verdict(&exec, &|_, _| ()).unwrap()).collect();
    let kept = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/claims.md"));
    let kept = std::fs::read_to_string(kept).unwrap();
    for (now, then) in lasting(&page(&verdicts).text).lines().zip(lasting(&kept).lines()) {
        assert_eq!(now, then, "splatref study claims -o docs");
    }
    assert_eq!(lasting(&page(&verdicts).text), lasting(&kept));
}
