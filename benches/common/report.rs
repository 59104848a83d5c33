//! What every bench takes and leaves: its arguments, and Markdown tables on stdout and in `docs/`.

use super::block;
use splatref::io::replace::write_atomically;
use splatref::{Error, Result};
#[cfg(feature = "cli")]
use splatref::{frame::Plane, io::png};
use std::io::Write;
use std::path::{Path, PathBuf};

/// `[PATTERN] [--write] [--pictures DIR]`.
pub(crate) struct Arguments {
    /// What the names of rows, workloads, models or scenes must contain.
    pub(crate) pattern: String,
    /// Where every picture is kept, by benches that measure pictures.
    pub(crate) pictures: Option<PathBuf>,
    write: bool,
}

impl Arguments {
    /// The arguments of the process; others that begin with `-` are cargo's.
    ///
    /// # Errors
    /// `--write` with a pattern, which would take rows from a page.
    pub(crate) fn parse() -> Result<Self> {
        let mut found = Self { pattern: String::new(), pictures: None, write: false };
        let mut arguments = std::env::args().skip(1);
        while let Some(argument) = arguments.next() {
            match argument.as_str() {
                "--write" => found.write = true,
                "--pictures" => found.pictures = arguments.next().map(PathBuf::from),
                option if option.starts_with('-') => {}
                pattern => pattern.clone_into(&mut found.pattern),
            }
        }
        if found.write && !found.pattern.is_empty() {
            return Err(Error::Invalid("--write takes all rows: give no pattern".into()));
        }
        Ok(found)
    }

    /// Tells that rows are left out because a file is not there.
    ///
    /// # Errors
    /// With `--write`: a page has the rows of all files.
    pub(crate) fn without(&self, missing: &Path) -> Result<()> {
        let said = format!("there is no {}; set SPLATREF_MODELS", missing.display());
        if self.write {
            return Err(Error::Invalid(format!("--write needs every scan: {said}")));
        }
        println!("skipped: {said}");
        Ok(())
    }

    /// With `--write`, puts a text into a block of a page under `docs/`.
    pub(crate) fn publish(&self, page: &str, block: &str, text: &str) -> Result<()> {
        if !self.write {
            return Ok(());
        }
        let path = docs(page);
        let old = std::fs::read_to_string(&path).map_err(|error| Error::io(&path, error))?;
        let wrong = |what| Error::Invalid(format!("{}: {what}", path.display()));
        let new = block::replaced(&old, block, text).map_err(wrong)?;
        write_atomically(&path, |file| file.write_all(new.as_bytes()))
    }

    /// With `--write`, makes a file under `docs/`.
    pub(crate) fn write(&self, name: &str, text: &str) -> Result<()> {
        if !self.write {
            return Ok(());
        }
        write_atomically(&docs(name), |file| file.write_all(text.as_bytes()))
    }

    /// With `--pictures`, makes a picture of linear colours there. PNG is a part of the program.
    #[cfg(feature = "cli")]
    pub(crate) fn picture(&self, name: &str, color: &Plane<[f32; 3]>) -> Result<()> {
        let Some(folder) = &self.pictures else { return Ok(()) };
        std::fs::create_dir_all(folder).map_err(|source| Error::io(folder, source))?;
        png::write(&folder.join(name), color, None)
    }
}

fn docs(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("docs").join(name)
}

/// A Markdown table, printed row by row as it is measured.
pub(crate) struct Table(String);

impl Table {
    /// A table with the names of its columns.
    pub(crate) fn new(columns: &[&str]) -> Self {
        let mut table = Self(String::new());
        println!();
        table.line(format!("| {} |", columns.join(" | ")));
        table.line(format!("|{}", "---|".repeat(columns.len())));
        table
    }

    /// One row, its cells joined by ` | `.
    pub(crate) fn row(&mut self, cells: &str) {
        self.line(format!("| {cells} |"));
    }

    fn line(&mut self, line: String) {
        println!("{line}");
        self.0.push_str(&line);
        self.0.push('\n');
    }

    /// With `--write`, puts the table into a block of a page.
    pub(crate) fn publish(&self, arguments: &Arguments, page: &str, block: &str) -> Result<()> {
        arguments.publish(page, block, &self.0)
    }

    /// The same, with the machine under it: for times.
    pub(crate) fn publish_times(&self, to: &Arguments, page: &str, block: &str) -> Result<()> {
        to.publish(page, block, &format!("{}\nMeasured on {}.", self.0, machine()))
    }
}

/// The processor, as far as the system tells, and its threads.
pub(crate) fn machine() -> String {
    let known = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = known.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    format!("{}, {threads} threads", name.map_or(std::env::consts::ARCH, |(_, name)| name))
}
