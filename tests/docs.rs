//! Checks the pages that people read: every link leads somewhere, and each bench finds its block.

#[path = "../benches/common/block.rs"]
mod block;

use block::replaced;
use std::fs;
use std::path::{Path, PathBuf};

const PAGE: &str = "\
before
<!-- bench: a -->

old

<!-- end -->
between
<!-- bench: b -->
<!-- end -->
after
";

/// The pages at the root, and every page under `docs/` and `docs/guide/`.
fn pages() -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut paths =
        ["README.md", "CONTRIBUTING.md", "CHANGELOG.md"].map(|name| root.join(name)).to_vec();
    for folder in ["docs", "docs/guide"] {
        let files = fs::read_dir(root.join(folder)).expect("a folder of pages");
        let files = files.map(|entry| entry.expect("a page").path());
        paths.extend(files.filter(|path| path.extension().is_some_and(|end| end == "md")));
    }
    paths
        .into_iter()
        .map(|path| (path.clone(), fs::read_to_string(path).expect("a page")))
        .collect()
}

#[test]
fn a_block_is_replaced_and_nothing_else() {
    let new = replaced(PAGE, "a", "| 1 |\n").unwrap();
    assert_eq!(new, PAGE.replace("old", "| 1 |"));
    assert_eq!(replaced(&new, "a", "old").unwrap(), PAGE, "and back");
    let new = replaced(PAGE, "b", "| 2 |\n| 3 |\n").unwrap();
    assert_eq!(new, PAGE.replace("b -->\n", "b -->\n\n| 2 |\n| 3 |\n\n"));
}

#[test]
fn a_block_that_is_not_whole_or_not_one_is_refused() {
    assert!(replaced(PAGE, "c", "").is_err(), "no such block");
    assert!(replaced(&PAGE.repeat(2), "a", "").is_err(), "two of them");
    assert!(replaced(&PAGE.replacen("<!-- end -->\n", "", 1), "a", "").is_err(), "no end");
    assert!(replaced("<!-- bench: a -->\n", "a", "").is_err(), "the end of the page");
}

#[test]
fn every_link_to_a_file_leads_to_one() {
    for (path, text) in pages() {
        for target in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            let file = target.split('#').next().unwrap_or_default();
            if file.is_empty() || file.contains("://") {
                continue;
            }
            let found = path.parent().unwrap().join(file);
            assert!(found.exists(), "{}: no {}", path.display(), found.display());
        }
    }
}

#[test]
fn every_link_to_a_heading_leads_to_one() {
    for (path, text) in pages() {
        for target in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            let Some((file, heading)) = target.split_once('#') else { continue };
            if file.contains("://") {
                continue;
            }
            let file =
                if file.is_empty() { path.clone() } else { path.parent().unwrap().join(file) };
            let other = fs::read_to_string(&file).expect("a page");
            let mut headings = other.lines().filter(|line| line.starts_with('#')).map(anchor);
            assert!(headings.any(|one| one == heading), "{}: no {target}", path.display());
        }
    }
}

/// The name that GitHub gives to a heading, for links.
fn anchor(heading: &str) -> String {
    let kept = |c: &char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
    let text = heading.trim_start_matches('#').trim();
    text.chars().filter(kept).collect::<String>().to_lowercase().replace(' ', "-")
}

#[test]
fn every_block_is_written_by_a_bench_and_every_bench_finds_its_block() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches");
    let mut sources = String::new();
    let mut ahead = vec![root];
    while let Some(path) = ahead.pop() {
        if path.is_dir() {
            ahead.extend(fs::read_dir(path).unwrap().map(|entry| entry.unwrap().path()));
        } else {
            sources += &fs::read_to_string(path).unwrap();
        }
    }
    let pages = pages();
    for (path, text) in &pages {
        for name in text.split("<!-- bench: ").skip(1).filter_map(|rest| rest.split(' ').next()) {
            let block = replaced(text, name, "");
            assert!(block.is_ok(), "{}: {}", path.display(), block.unwrap_err());
            assert!(sources.contains(&format!("\"{name}\"")), "{}: {name}", path.display());
        }
    }
    let published = sources.split(".md\", \"").skip(1).filter_map(|rest| rest.split('"').next());
    for name in published {
        let line = format!("<!-- bench: {name} -->\n");
        let holders = pages.iter().filter(|(_, text)| text.contains(&line)).count();
        assert_eq!(holders, 1, "{line}");
    }
}
