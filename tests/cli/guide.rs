//! The commands in README, guide and pages: each one runs, and prints the lines that its page shows.
//!
//! Each test follows one page from top to bottom, in a fresh folder with a copy of `golden/`:
//!
//! - A `toml` block whose first line is `# NAME.toml` is written to that file.
//! - A block whose language has a name behind it, as in `json NAME.json`, is written to that file.
//! - Every command of an `sh` block must exit with 0, or with N if the next line is `# exit N`.
//! - In a `console` block, `$ ` begins a command. The command must print the lines that follow, in this order. `...` at the
//!   end of a line leaves out the rest of the line; a line `...` stands for any number of lines.
//!
//! `splatref` and `cargo run --release --` both run the built program. Other cargo commands are not run here.

use super::*;
use tempfile::TempDir;

/// Makes one test a page, and the list of all pages.
macro_rules! pages {
    ($($test:ident: $page:literal;)*) => {
        const PAGES: &[&str] = &[$($page),*];

        $(#[test]
        fn $test() {
            follow($page);
        })*
    };
}

pages! {
    readme: "README.md";
    contributing: "CONTRIBUTING.md";
    backends: "docs/backends.md";
    bjfm19: "docs/bjfm19.md";
    cameras: "docs/cameras.md";
    cluster: "docs/cluster.md";
    ewa: "docs/ewa.md";
    gaussians: "docs/gaussians.md";
    gbp04: "docs/gbp04.md";
    goldens: "docs/goldens.md";
    image_space: "docs/image-space.md";
    plan: "docs/plan.md";
    regions: "docs/regions.md";
    speed: "docs/speed.md";
    zp06: "docs/zp06.md";
    index: "docs/guide/README.md";
    first_picture: "docs/guide/first-picture.md";
    golden_in_your_tests: "docs/guide/golden-in-your-tests.md";
    is_my_gpu_right: "docs/guide/is-my-gpu-right.md";
    which_method: "docs/guide/which-method.md";
    formats_and_cameras: "docs/guide/formats-and-cameras.md";
    papers: "docs/guide/papers.md";
}

#[test]
fn every_page_with_commands_is_followed() {
    let mut pages: Vec<String> =
        ["README.md", "CONTRIBUTING.md", "CHANGELOG.md"].map(String::from).into();
    for folder in ["docs", "docs/guide"] {
        let files = names(&root().join(folder)).into_iter().filter(|name| name.ends_with(".md"));
        pages.extend(files.map(|name| format!("{folder}/{name}")));
    }
    for page in pages.iter().filter(|page| !steps(&read(page)).is_empty()) {
        assert!(PAGES.contains(&page.as_str()), "{page} is not in the list of this test");
    }
}

#[test]
fn a_page_is_read_as_its_reader_would() {
    let page = "```sh\n# first\nsplatref a \\\n  b   # why\n# exit 3: c\ncargo test && splatref d\n```\n\
                ```toml\n# e/f.toml\ng = 1\n```\n```toml\nh = 2\n```\n```json k.json\n3\n```\n```console\n$ splatref i\nj ...\n...\n```\n";
    let [
        Step::Run(first),
        Step::Run(second),
        Step::Write(name, text),
        Step::Write(json, three),
        Step::Run(third),
    ] = &steps(page)[..]
    else {
        panic!("other steps");
    };
    assert_eq!((&first.arguments[..], first.code), (&["a".into(), "b".into()][..], 3));
    assert_eq!((&second.arguments[..], second.code), (&["d".into()][..], 0));
    assert_eq!((name.as_str(), text.as_str()), ("e/f.toml", "# e/f.toml\ng = 1\n"));
    assert_eq!((json.as_str(), three.as_str()), ("k.json", "3\n"));
    assert_eq!(third.shown, ["j ...", "..."]);
    assert_eq!(third.missing("i\nj k\nl\n"), None);
    assert_eq!(third.missing("k\nl\n"), Some("j ..."));
}

/// One thing that a page tells its reader to do.
enum Step {
    /// Write a file: its name and its text.
    Write(String, String),
    Run(Run),
}

/// A command of a page, its exit code, and the lines that the page shows of its output.
struct Run {
    arguments: Vec<String>,
    code: i32,
    shown: Vec<String>,
}

impl Run {
    /// The command, or none if it is another cargo command than `cargo run`.
    fn new(command: &str) -> Option<Self> {
        let program = ["splatref ", "cargo run --release -- "];
        let Some(arguments) = program.iter().find_map(|name| command.strip_prefix(name)) else {
            assert!(command.starts_with("cargo "), "no test can run this: {command}");
            return None;
        };
        assert!(!arguments.contains(['"', '$', '*', '>', '|']), "needs a shell: {command}");
        // Every second part stands in quotes.
        let parts = arguments.split('\'').enumerate();
        let arguments = parts.flat_map(|(i, part)| match i % 2 {
            0 => part.split_whitespace().map(String::from).collect(),
            _ => vec![part.to_owned()],
        });
        let arguments = arguments.collect();
        Some(Self { arguments, code: 0, shown: Vec::new() })
    }

    /// Runs the command in a folder and checks exit code and output.
    fn check(&self, at: &Path, page: &str) {
        let arguments: Vec<&str> = self.arguments.iter().map(String::as_str).collect();
        let output = splatref(at, &arguments);
        let (said, complaint) =
            (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        let all = format!("{page}: splatref {}\n{said}{complaint}", arguments.join(" "));
        assert_eq!(output.status.code(), Some(self.code), "{all}");
        assert_eq!(self.missing(&format!("{said}{complaint}")), None, "{all}");
    }

    /// The first shown line that the output lacks after the shown lines before it.
    fn missing(&self, said: &str) -> Option<&str> {
        let mut printed = said.lines();
        let shown = self.shown.iter().map(String::as_str);
        let found = |line: &str, printed: &mut std::str::Lines<'_>| match line.strip_suffix("...") {
            Some(start) => printed.any(|other| other.starts_with(start.trim_end())),
            None => printed.any(|other| other.trim_end() == line),
        };
        shown.filter(|line| *line != "...").find(|line| !found(line, &mut printed))
    }
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(page: &str) -> String {
    fs::read_to_string(root().join(page)).unwrap()
}

/// Follows a page from top to bottom.
fn follow(page: &str) {
    let at = TempDir::new().unwrap();
    copy(&root().join("golden"), &at.path().join("golden"));
    for step in steps(&read(page)) {
        match step {
            Step::Write(name, text) => {
                let path = at.path().join(name);
                fs::create_dir_all(path.parent().unwrap()).unwrap();
                fs::write(path, text).unwrap();
            }
            Step::Run(run) => run.check(at.path(), page),
        }
    }
    // Pictures in the folder of a page are drawn by its commands.
    let folder = root().join(page).with_extension("");
    for picture in names_of_pictures(&folder) {
        let stored = folder.join(&picture);
        succeeds(at.path(), &["compare", &picture, stored.to_str().unwrap()]);
    }
}

/// Runs the commands of a page in a folder; how many there are.
pub(super) fn follow_page(at: &Path, page: &str) -> usize {
    let runs = steps(page).into_iter().filter_map(|step| match step {
        Step::Run(run) => Some(run),
        Step::Write(..) => None,
    });
    runs.map(|run| run.check(at, "a page that splatref wrote")).count()
}

/// The names of the PNG files in a folder, if there is one.
fn names_of_pictures(folder: &Path) -> impl Iterator<Item = String> {
    let all = if folder.is_dir() { names(folder) } else { Vec::new() };
    all.into_iter().filter(|name| name.ends_with(".png"))
}

/// Copies a folder. A link would not do, because pages write into `golden/`.
fn copy(from: &Path, to: &Path) {
    fs::create_dir(to).unwrap();
    for name in names(from) {
        let (from, to) = (from.join(&name), to.join(&name));
        if from.is_dir() {
            copy(&from, &to);
        } else {
            fs::copy(from, to).unwrap();
        }
    }
}

/// The steps of a page, block by block.
fn steps(text: &str) -> Vec<Step> {
    let mut steps = Vec::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        let Some(language) = line.strip_prefix("```") else { continue };
        let block: Vec<&str> = lines.by_ref().take_while(|line| *line != "```").collect();
        let block = block.join("\n") + "\n";
        if let Some((_, name)) = language.split_once(' ') {
            steps.push(Step::Write(name.into(), block));
            continue;
        }
        match language {
            "toml" => steps.extend(file(&block)),
            "sh" => steps.extend(commands(&block).into_iter().map(Step::Run)),
            "console" => steps.extend(transcript(&block).into_iter().map(Step::Run)),
            _ => {}
        }
    }
    steps
}

/// The step that writes a TOML block to the file that its first line names.
fn file(block: &str) -> Option<Step> {
    let name = block.lines().next()?.strip_prefix("# ")?;
    name.ends_with(".toml").then(|| Step::Write(name.into(), block.into()))
}

/// The commands of a block `sh`.
fn commands(block: &str) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for line in block.replace("\\\n", " ").lines() {
        if let Some(code) = exit(line) {
            runs.last_mut().expect("a command before its exit code").code = code;
            continue;
        }
        let command = line.split(" #").next().unwrap_or_default();
        let parts = command.split("&&").map(str::trim);
        runs.extend(
            parts.filter(|one| !one.is_empty() && !one.starts_with('#')).filter_map(Run::new),
        );
    }
    runs
}

/// The commands of a block `console`, each with the lines that the page shows.
fn transcript(block: &str) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for line in block.lines() {
        if let Some(command) = line.strip_prefix("$ ") {
            runs.push(Run::new(command).expect("a command of the program"));
            continue;
        }
        let run = runs.last_mut().expect("a command before its output");
        match exit(line) {
            Some(code) => run.code = code,
            None => run.shown.push(line.into()),
        }
    }
    runs
}

/// The number N of a line `# exit N`; the rest of the line may say why.
fn exit(line: &str) -> Option<i32> {
    let rest = line.strip_prefix("# exit ")?;
    rest.split(|c: char| !c.is_ascii_digit()).next()?.parse().ok()
}
