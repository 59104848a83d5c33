//! Compares the page in `docs/` with new measurements.

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

/// The page without its part about scans.
fn of_shapes(page: &str) -> &str {
    page.split("\n## Scans").next().unwrap().trim_end()
}

/// The scans of the page, if the files exist.
fn scans() -> Option<Vec<SceneFile>> {
    let folder = std::env::var("SPLATREF_MODELS").unwrap_or_else(|_| "../shared/models".into());
    let scan = |name: &str| {
        let path = Path::new(&folder).join(name);
        path.is_file().then(|| SceneFile::open(&path).unwrap())
    };
    ["bunny.ply", "igea.ply", "fandisk.ply"].map(scan).into_iter().collect()
}

#[test]
#[expect(clippy::print_stdout, reason = "what is skipped is said")]
#[ignore = "minutes: every picture, and those of shapes stage by stage in three more formats; .ci/run runs it"]
fn the_page_is_what_is_measured() {
    let exec = Exec::new(2, 32).unwrap();
    let scans = scans();
    if scans.is_none() {
        println!("skipped: scans, as the models are not there");
    }
    let shown = scans.as_deref().unwrap_or_default();
    let measured = verdicts(&of_errors(), shown, &FORMATS, &exec, &|_, _, _| ()).unwrap();
    let names: Vec<&str> = shown.iter().map(|scan| scan.name.as_str()).collect();
    let (now, then) = (lasting(&page(&measured, &names).text), kept());
    let then = if scans.is_some() { then.trim_end() } else { of_shapes(&then) };
    assert_eq!(
        now.trim_end(),
        then,
        "splatref study claims bunny.ply igea.ply fandisk.ply -o docs"
    );
}
