//! Compares the page in `docs/` with the page that the command writes, and with new measurements.

use super::page::lasting;
use super::*;
use std::collections::BTreeSet;
use std::path::Path;

fn exec() -> Exec {
    Exec::new(2, 32).unwrap()
}

/// The folder of the crate's page.
fn docs() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/docs"))
}

#[test]
fn every_failure_has_a_name_and_a_sweep() {
    let all = failures();
    let names: BTreeSet<&str> = all.iter().map(|failure| failure.id).collect();
    assert_eq!(names.len(), all.len(), "no two have one name");
    for failure in all {
        assert!(failure.values.len() >= 5, "{}: a curve has points", failure.id);
        assert!(failure.limit > 0.0, "{}", failure.id);
    }
}

/// Checks every error on the page, and its charts; `splatref study failures -o docs` blesses the
/// page.
#[test]
#[ignore = "slow: .ci/run runs it"]
fn the_page_is_what_is_measured() {
    let curves = failures().into_iter().map(|failure| {
        (failure.curve(&exec(), &|_, _| ()).unwrap_or_else(|e| panic!("{}: {e}", failure.id)), None)
    });
    let curves: Vec<_> = curves.collect();
    for (Curve { of, plain, cured, breaks, .. }, _) in &curves {
        let Some(at) = *breaks else {
            assert!(of.cure.starts_with("none is needed"), "{}: it breaks", of.id);
            continue;
        };
        assert!(at > 0 && plain[at - 1] <= of.limit, "{}: it works at first", of.id);
        assert!(plain[at] > of.limit && cured[at] <= of.limit, "{}: the cure cures", of.id);
    }
    let files = page(&curves);
    let kept = std::fs::read_to_string(docs().join("atlas.md")).unwrap();
    for (now, then) in lasting(&files.text).lines().zip(lasting(&kept).lines()) {
        assert_eq!(now, then, "splatref study failures -o docs");
    }
    assert_eq!(lasting(&files.text), lasting(&kept));
    for (id, chart) in &files.charts {
        chart.assert_readable();
        let path = docs().join(PICTURES).join(id).with_extension("svg");
        assert_eq!(std::fs::read_to_string(path).unwrap(), chart.svg(), "{id}");
    }
    for (id, _) in &files.pictures {
        assert!(docs().join(PICTURES).join(id).with_extension("png").is_file(), "{id}");
    }
}
