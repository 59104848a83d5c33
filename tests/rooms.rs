//! Keeps the folders of `src/` in order: each room imports only from rooms below it, and no circle of imports runs through
//! folders.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Every folder and file of `src/` but `lib.rs` and `main.rs`, the lowest first.
///
/// `source` stands above `method` because the candidates of a mesh are found by the projection of the methods.
const ROOMS: [&str; 20] = [
    "error",
    "memory",
    "progress",
    "number",
    "setting",
    "frame",
    "composite",
    "scene",
    "index",
    "splat",
    "shade",
    "method",
    "source",
    "compare",
    "laws",
    "verdict",
    "io",
    "study",
    "report",
    "cli",
];

/// How high a room stands.
fn height(room: &str) -> Option<usize> {
    ROOMS.iter().position(|other| *other == room)
}

/// The Rust files of a folder, without tests: what a test draws may come from anywhere.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries =
        fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("a file").path());
    let code = entries.filter(|path| path.file_stem().is_some_and(|stem| stem != "tests"));
    code.flat_map(|path| if path.is_dir() { sources(&path) } else { vec![path] })
        .filter(|path| path.extension().is_some_and(|end| end == "rs"))
        .collect()
}

/// The code of a file, without comments and without the tests at its end.
fn code(text: &str) -> String {
    let lines = text.lines().map(|line| line.split("//").next().unwrap_or_default());
    let lines: Vec<&str> = lines.collect();
    let test = |pair: &[&str]| pair[0] == "#[cfg(test)]" && pair[1].ends_with("mod tests {");
    let end = lines.windows(2).position(test).unwrap_or(lines.len());
    lines[..end].join("\n")
}

/// The paths below the root of the crate that a file names; of a group of paths, every one.
fn imports(code: &str) -> Vec<String> {
    paths_behind("crate::", code)
}

/// The paths that stand behind a marker; of a group of paths, every one.
fn paths_behind(marker: &str, code: &str) -> Vec<String> {
    let path = |rest: &str| {
        let end = rest.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':'));
        rest[..end.unwrap_or(rest.len())].trim_matches(':').to_owned()
    };
    let mut found = Vec::new();
    for (at, marker) in code.match_indices(marker) {
        // `$crate::` is the same; `pub(in crate::` says who may see, and imports nothing.
        if code[..at].ends_with("(in ") {
            continue;
        }
        let rest = &code[at + marker.len()..];
        match rest.strip_prefix('{') {
            Some(group) => {
                let group = group.split(';').next().unwrap_or_default();
                found.extend(group.split([',', '{', '}']).map(str::trim).map(path));
            }
            None => found.push(path(rest)),
        }
    }
    found.retain(|path| !path.is_empty());
    found
}

#[test]
fn no_room_imports_a_higher_one() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut wrong = Vec::new();
    for file in sources(&src) {
        let name = file.strip_prefix(&src).expect("below src").display().to_string();
        let room = name.split('/').next().unwrap_or_default().trim_end_matches(".rs");
        if matches!(room, "lib" | "main") {
            continue;
        }
        let own = height(room).unwrap_or_else(|| panic!("{name}: its room is not in the list"));
        for path in imports(&code(&fs::read_to_string(&file).expect("a file"))) {
            match height(path.split("::").next().unwrap_or_default()) {
                Some(other) if other <= own => {}
                Some(_) => wrong.push(format!("{name} imports crate::{path}, which is higher")),
                None => wrong.push(format!("{name} imports crate::{path}, which names no room")),
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The folder that a path of modules lies in, which is the longest part of it that is a folder.
fn folder(src: &Path, modules: &[String]) -> Vec<String> {
    let is_folder = |end: &usize| src.join(modules[..*end].join("/")).is_dir();
    let end = (1..=modules.len()).rev().find(is_folder);
    modules[..end.unwrap_or(0)].to_vec()
}

/// The other folders that each folder imports from, but for those that lie in each other.
fn arrows(src: &Path) -> BTreeMap<Vec<String>, BTreeSet<Vec<String>>> {
    let mut all = BTreeMap::<_, BTreeSet<_>>::new();
    for file in sources(src) {
        let name = file.strip_prefix(src).expect("below src").with_extension("");
        let mut own: Vec<String> =
            name.iter().map(|part| part.to_string_lossy().into_owned()).collect();
        own.truncate(own.len() - usize::from(own.last().is_some_and(|last| last == "mod")));
        let text = fs::read_to_string(&file).expect("a file");
        // What only links in the documentation need ties nothing.
        let code = code(&text.replace("#[cfg(doc)]\nuse ", "// "));
        let mut paths: Vec<Vec<String>> = Vec::new();
        let parts = |path: &str| path.split("::").map(str::to_owned).collect::<Vec<_>>();
        paths.extend(imports(&code).iter().map(|path| parts(path)));
        // The longest chains first, so that each is read once.
        let mut rest = code;
        for ups in (1..=own.len()).rev() {
            let marker = "super::".repeat(ups);
            for path in paths_behind(&marker, &rest) {
                paths.push([&own[..own.len() - ups], &parts(&path)].concat());
            }
            rest = rest.replace(&marker, "");
        }
        let from = folder(src, &own);
        for to in paths.iter().map(|path| folder(src, path)) {
            if !from.starts_with(&to) && !to.starts_with(&from) {
                all.entry(from.clone()).or_default().insert(to);
            }
        }
    }
    all
}

#[test]
fn no_circle_runs_through_folders() {
    let arrows = arrows(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"));
    assert!(arrows.len() > 50, "{}", arrows.len());
    for start in arrows.keys() {
        let (mut seen, mut next) = (BTreeSet::new(), vec![start]);
        while let Some(folder) = next.pop() {
            for to in arrows.get(folder).into_iter().flatten().filter(|to| seen.insert(*to)) {
                let [start, folder] = [start, folder].map(|folder| folder.join("/"));
                assert!(to.join("/") != start, "a circle through {start} and {folder}");
                next.push(to);
            }
        }
    }
}

#[test]
fn imports_are_read_alone_in_groups_and_in_expressions() {
    let text = "use crate::a::B; // crate::comment
pub(in crate::seen) use crate::{c, d::E};
fn f() { crate::g::h(1) }
#[cfg(test)]
mod tests {
    use crate::test;
}";
    assert_eq!(imports(&code(text)), ["a::B", "c", "d::E", "g::h"]);
}
