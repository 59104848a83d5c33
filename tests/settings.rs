//! Every setting is one row of a table. These tests compare everything that follows from the row
//! with it.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use splatref::io::provenance;
use splatref::io::scene_file::{GroupChoice, MethodChoice, OutputSettings, SceneFile};
use splatref::method::{Method, gaussians};
use splatref::scene::{Camera, Scene};
use splatref::setting::{Fields, Refused, Setting, Value, Words};
use splatref::source::Shape;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::Path;

const EXAMPLE: &str = "src/io/scene_file/example.toml";
/// The column at which the comments of the example stand.
const COLUMN: usize = 32;

fn example() -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(EXAMPLE)).unwrap()
}

/// A scene of one shape, and more.
fn parse(more: &str) -> splatref::Result<SceneFile> {
    SceneFile::parse(&format!("[[model]]\nshape = \"sphere\"\n{more}"), Path::new("a.toml"))
}

/// The tables of settings of the example, each with its rows.
fn tables() -> [(&'static str, &'static str, Vec<Setting>); 3] {
    [
        (
            "method",
            "each optional; a key that the method does not have is refused, and what is given \
             here for other methods is therefore commented out",
            MethodChoice::rows(),
        ),
        (
            "groups",
            "for methods that draw groups, each optional: how groups are made; a count without \
             an overlap takes the overlap 1, an overlap without a count takes no count",
            GroupChoice::rows(),
        ),
        ("output", "each optional", OutputSettings::rows()),
    ]
}

/// A comment from column [`COLUMN`] on after what is there already, in lines of 100 characters.
fn comment(code: &str, text: &str) -> String {
    let mut lines = vec![format!("{code:<COLUMN$}#")];
    if code.len() >= COLUMN {
        lines = vec![code.to_owned(), format!("{:COLUMN$}#", "")];
    }
    for word in text.split(' ') {
        if lines.last().unwrap().len() + 1 + word.len() > 100 {
            lines.push(format!("{:COLUMN$}#", ""));
        }
        write!(lines.last_mut().unwrap(), " {word}").unwrap();
    }
    lines.join("\n") + "\n"
}

/// What the example says of a row.
fn remark(row: &Setting) -> String {
    let words: Vec<String> = row.words.iter().map(|word| format!("{word:?}")).collect();
    let words = match words.split_last() {
        None => String::new(),
        Some((last, [])) => format!("; or {last}"),
        Some((last, before)) => format!("; {} or {last}", before.join(", ")),
    };
    let default = match row.default_text(Value::to_string) {
        default if default.is_empty() => default,
        default => format!("; if absent {default}"),
    };
    format!("{}{words}{default}", row.description())
}

/// The owners of a row as a line of its own.
fn owners(row: &Setting) -> String {
    let owners: Vec<&str> = row.owners.iter().map(|(owner, _)| *owner).collect();
    match owners.as_slice() {
        [""] => String::new(),
        all if all.len() == Method::all().len() => "# every method:\n".into(),
        some => format!("# {}:\n", some.join(", ")),
    }
}

/// The values of the rows in a text of tables: by table and name, the line of code, which may be
/// commented out.
fn values(text: &str) -> BTreeMap<(String, String), String> {
    let mut table = String::new();
    let mut found = BTreeMap::new();
    for line in text.lines() {
        if let Some(name) = line.strip_prefix('[').and_then(|line| line.split(']').next()) {
            name.clone_into(&mut table);
        }
        let code = line.strip_prefix("# ").unwrap_or(line).split('#').next().unwrap_or("").trim();
        if let Some((name, _)) = code.split_once(" = ") {
            let code = if line.starts_with("# ") { format!("# {code}") } else { code.to_owned() };
            found.insert((table.clone(), name.to_owned()), code);
        }
    }
    found
}

/// The tables of settings with every comment written from the rows; the values are those of `old`,
/// and the defaults for rows that `old` does not have.
fn generated(old: &str) -> String {
    let known = values(old);
    let mut text = String::new();
    for (table, remarks, rows) in tables() {
        text += &comment(&format!("[{table}]"), remarks);
        if table == "method" {
            let default = Method::default().name();
            text += &comment(
                &known[&(table.to_owned(), "name".to_owned())],
                &format!("if absent {default:?}; one of"),
            );
            for method in Method::all() {
                text += &comment("", &format!("{:?}: {}", method.name(), method.summary()));
            }
        }
        let mut last = String::new();
        for row in &rows {
            if owners(row) != last {
                last = owners(row);
                text += &last;
            }
            let default = || row.owners.iter().find_map(|(_, value)| value.clone());
            let code = known.get(&(table.to_owned(), row.name.to_owned())).cloned();
            let code = code.unwrap_or_else(|| {
                let value = default().unwrap_or_else(|| Value::Text(row.words[0].into()));
                format!("# {} = {value}", row.name)
            });
            text += &comment(&code, &remark(row));
        }
        text += "\n";
    }
    text.trim_end().to_owned() + "\n"
}

/// `SPLATREF_BLESS=1 cargo test --release settings::` writes the comments of the example anew; the run
/// that does so fails.
#[test]
fn the_example_is_written_from_the_rows() {
    let example = example();
    let at = example.find("\n[method]").unwrap() + 1;
    let expected = example[..at].to_owned() + &generated(&example[at..]);
    if example != expected && std::env::var_os("SPLATREF_BLESS").is_some() {
        fs::write(Path::new(env!("CARGO_MANIFEST_DIR")).join(EXAMPLE), &expected).unwrap();
    }
    let differs = example.lines().zip(expected.lines()).find(|(is, should)| is != should);
    assert!(
        example == expected,
        "{EXAMPLE} is not what the rows say, first at {differs:?}; \
         SPLATREF_BLESS=1 cargo test --release settings:: writes it anew"
    );
}

#[test]
fn every_row_stands_in_the_example_with_a_value_that_is_taken() {
    let example = example();
    let file = SceneFile::parse(&example, Path::new("a.toml")).unwrap();
    let method = file.method.method().unwrap();
    let found = values(&example);
    for (table, _, rows) in tables() {
        for row in rows {
            let code = &found[&(table.to_owned(), row.name.to_owned())];
            // What is commented out is of other methods, and means something to each of these.
            let Some(code) = code.strip_prefix("# ") else { continue };
            for (owner, _) in &row.owners {
                assert_ne!(*owner, method.name(), "{code}");
                let file = parse(&format!("[{table}]\nname = \"{owner}\"\n{code}\n"));
                assert!(file.is_ok(), "{owner}, {code}: {file:?}");
            }
        }
    }
}

/// What every owner of settings is called, and whether one of its settings may have a value.
fn allows(owner: &str, name: &str, value: &Value) -> Option<bool> {
    let mut method = Method::by_name(owner).unwrap();
    let mut taken = method.set(name, value);
    let mut in_range = method.check();
    if taken == Err(Refused::Unknown) {
        let mut grouping = method.grouping().unwrap();
        taken = grouping.set(name, value);
        in_range = grouping.check();
    }
    match taken {
        Err(Refused::Idle(_)) => None,
        taken => Some(taken.is_ok() && in_range.is_ok()),
    }
}

/// The numbers at the ends of a range, and those just beyond: of a range that is written as `a to
/// b`, `above a to b`, or `a, b or c`.
fn ends(range: &str, whole: bool) -> (Vec<f32>, Vec<f32>) {
    let number = |text: &str| text.parse::<f32>().unwrap();
    let below = |v: f32| if whole { v - 1.0 } else { v.next_down() };
    let above = |v: f32| if whole { v + 1.0 } else { v.next_up() };
    let (mut inside, mut outside) = (vec![], vec![]);
    if let Some((low, high)) = range.split_once(" to ") {
        let (low, high) = (low, number(high));
        match low.strip_prefix("above ") {
            Some(low) => {
                inside.push(number(low).next_up());
                outside.push(number(low));
            }
            None => {
                inside.push(number(low));
                outside.push(below(number(low)));
            }
        }
        inside.push(high);
        outside.extend(high.is_finite().then(|| above(high)));
    } else {
        inside = range.replace(" or ", ", ").split(", ").map(number).collect();
        let beyond = inside.iter().flat_map(|&v| [below(v), above(v)]);
        outside = beyond.filter(|v| !inside.contains(v)).collect();
    }
    (inside, outside)
}

/// The values of a row at the ends of its range, and those just beyond.
fn extremes(row: &Setting) -> (Vec<Value>, Vec<Value>) {
    let with = |value: f32| match row.form.as_str() {
        "X" => Value::Number(value),
        "DEPTH" => Value::Text(format!("{value}r")),
        form if form.starts_with('R') => Value::Numbers(vec![1.0, value, 1.0]),
        _ => Value::Whole(value as i64),
    };
    if !row.form.starts_with("COSINE") {
        let whole = row.form.starts_with('N');
        let (inside, outside) = ends(row.range, whole);
        return (inside.into_iter().map(with).collect(), outside.into_iter().map(with).collect());
    }
    let (mut inside, mut outside) = (vec![], vec![]);
    for (i, range) in row.range.replace(" and ", ", ").split(", ").enumerate() {
        let part = |value: f32| {
            let mut parts = [("cosine", 1.0), ("offset", 0.0), ("color", 0.0)];
            parts[i].1 = value;
            Value::Parts(parts.map(|(name, value)| (name.to_owned(), value)).to_vec())
        };
        let (good, bad) = ends(range, false);
        inside.extend(good.into_iter().map(part));
        outside.extend(bad.into_iter().map(part));
    }
    (inside, outside)
}

#[test]
fn ranges_are_what_is_checked() {
    let mut tried = 0;
    let rows = MethodChoice::rows().into_iter().chain(GroupChoice::rows());
    for row in rows.filter(|row| !row.range.is_empty()) {
        let (inside, outside) = extremes(&row);
        for (owner, _) in &row.owners {
            for (values, allowed) in [(&inside, true), (&outside, false)] {
                for value in values {
                    let found = allows(owner, row.name, value);
                    assert!(found.is_none_or(|found| found == allowed), "{owner}: {value}");
                    tried += u32::from(found.is_some());
                }
            }
        }
    }
    assert!(tried > 60, "{tried}");
}

#[test]
fn a_row_of_several_methods_is_the_same_row() {
    let mut known: BTreeMap<&str, (Setting, &str)> = BTreeMap::new();
    for method in Method::all() {
        for mut row in Setting::of([("", method)]) {
            row.owners.clear();
            let (first, of) = known.entry(row.name).or_insert((row.clone(), method.name()));
            assert_eq!(*first, row, "of {of} and of {}", method.name());
        }
    }
}

/// What is printed is read back, as TOML and on the command line, whatever the word.
#[test]
fn values_are_read_as_they_are_printed() {
    for mut method in Method::all() {
        for row in Setting::of([("", method)]) {
            for word in row.words {
                let _ = method.set(row.name, &Value::Text(word.into()));
                let name = method.name();
                let settings: String = method
                    .values()
                    .iter()
                    .map(|(key, value)| format!("{key} = {value}\n"))
                    .collect();
                let file = parse(&format!("[method]\nname = \"{name}\"\n{settings}")).unwrap();
                assert_eq!(file.method.method().unwrap(), method, "{settings}");
                for (key, value) in method.values() {
                    assert_eq!(method.read(key, &value.text()), Some(Ok(value)), "{key}");
                }
            }
        }
        for (key, value) in method.grouping().iter().flat_map(|grouping| grouping.values()) {
            assert_eq!(GroupChoice::ALONE.read(key, &value.text()), Some(Ok(value)), "{key}");
        }
    }
}

#[test]
fn a_picture_carries_every_setting() {
    let shape = Shape::Torus;
    let scene = Scene::lit("torus", shape.surfels(100, 0).unwrap());
    let camera = Camera::new(8, 8, shape.default_pose(), shape.default_lens()).unwrap();
    for mut method in Method::all() {
        let _ = method.set("refraction", &Value::Numbers(vec![0.5; 3]));
        let text = provenance::text(&scene, None, &camera, &method, OutputSettings::default());
        let text: toml::Table = text.parse().unwrap();
        for row in Setting::of([("", method)])
            .iter()
            .filter(|row| !["kernel", "preset"].contains(&row.name))
        {
            assert!(text["method"].get(row.name).is_some(), "{}: {}", method.name(), row.name);
        }
    }
}

/// The table of presets in the page of Gaussian splats, one column a preset.
fn presets() -> String {
    let all: Vec<(&str, Method)> = gaussians::Settings::WORDS
        .iter()
        .map(|(word, settings)| (*word, Method::Gaussians(*settings)))
        .collect();
    let words: Vec<&str> = all.iter().map(|(word, _)| *word).collect();
    let mut table =
        format!("| setting | {} |\n|---|{}\n", words.join(" | "), "---|".repeat(words.len()));
    for row in Setting::of([("", Method::from(gaussians::Settings::default()))]) {
        let value = |method: &Method| {
            let found = method.values().into_iter().find(|(name, _)| *name == row.name);
            found.map_or_else(String::new, |(_, value)| value.text())
        };
        let values: Vec<String> = all.iter().map(|(_, method)| value(method)).collect();
        if row.name != "preset" {
            table += &format!("| `{}`: {} | {} |\n", row.name, row.help, values.join(" | "));
        }
    }
    table
}

/// `SPLATREF_BLESS=1` writes the table anew; the run that does so fails.
#[test]
fn the_page_of_gaussians_lists_the_presets() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/gaussians.md");
    let page = fs::read_to_string(&path).unwrap();
    let (before, rest) = page.split_once("<!-- presets -->\n").unwrap();
    let (found, after) = rest.split_once("<!-- end -->").unwrap();
    let table = presets();
    if found != table && std::env::var_os("SPLATREF_BLESS").is_some() {
        fs::write(&path, format!("{before}<!-- presets -->\n{table}<!-- end -->{after}")).unwrap();
    }
    assert_eq!(found, table, "SPLATREF_BLESS=1 cargo test --release settings:: writes it anew");
}

/// Settings are set in the order of their rows, whoever lists them first.
#[test]
fn a_preset_is_set_before_its_parts() {
    let file =
        parse("[method]\nlow_pass = 0.1\ncutoff = 2\npreset = \"khr\"\nname = \"gaussians\"\n");
    let method = file.unwrap().method.method().unwrap();
    for (name, value) in [("low_pass", 0.1), ("cutoff", 2.0), ("stop", 0.0)] {
        assert!(method.values().contains(&(name, Value::Number(value))), "{name}");
    }
}
