//! The programs in `examples/`: each is short, says how to run it, and is named on a page. `.ci/run` runs them.

use std::fs;
use std::path::Path;

/// The most lines of an example.
const MOST: usize = 60;

/// The names of all examples without their extension, and their texts.
fn examples(root: &Path) -> Vec<(String, String)> {
    let files = fs::read_dir(root.join("examples")).expect("a folder of examples");
    let paths = files.map(|entry| entry.expect("an example").path());
    // Folders hold the examples in other languages.
    let named = paths.filter(|path| path.is_file()).map(|path| {
        assert_eq!(path.extension().and_then(|end| end.to_str()), Some("rs"), "{}", path.display());
        let name = path.file_stem().and_then(|name| name.to_str()).expect("a name in Unicode");
        (name.to_owned(), fs::read_to_string(&path).expect("an example"))
    });
    named.collect()
}

/// README and all pages of the guide, one after the other.
fn pages(root: &Path) -> String {
    let guide = fs::read_dir(root.join("docs/guide")).expect("the guide");
    let paths = guide.map(|entry| entry.expect("a page").path());
    paths
        .chain([root.join("README.md")])
        .map(|path| fs::read_to_string(path).expect("a page"))
        .collect()
}

#[test]
fn every_example_is_short_says_how_to_run_it_and_is_named_on_a_page() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (examples, pages) = (examples(root), pages(root));
    assert!(!examples.is_empty(), "there are no examples");
    for (name, text) in examples {
        let lines = text.lines().count();
        assert!(lines <= MOST, "{name}: {lines} lines, at most {MOST}");
        assert!(text.starts_with("//! "), "{name} does not begin with what it shows");
        let command = format!("//! cargo run --release --example {name}\n");
        assert!(text.contains(&command), "{name} lacks its command");
        assert!(pages.contains(&format!("examples/{name}.rs)")), "no page names {name}");
    }
}
