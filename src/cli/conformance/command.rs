//! A command as a renderer: it runs in a process of its own, and leaves files.

use crate::cli::words;
use splatref::frame::Exec;
use splatref::io::client::Description;
use splatref::verdict::client::{Client, Rounding};
use splatref::verdict::conformance::{Case, Renderer};
use splatref::{Error, Result};
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread;
use std::time::{Duration, Instant};

/// The files that a command may write, and the file with what it printed.
const PICTURE: &str = "client.exr";
const DESCRIPTION: &str = "client.toml";
const LOG: &str = "client.log";

/// How often a command with a time limit is looked at.
const GLANCE: Duration = Duration::from_millis(10);
/// How many bytes of the log are searched for its last line.
const END: u64 = 1 << 16;
/// The most of a line that the report quotes, in characters.
const LONGEST: usize = 160;

/// The scene in a folder and what a command left there, as words of a command line.
pub(super) fn files(folder: &Path) -> [String; 2] {
    let left = [DESCRIPTION, PICTURE].into_iter().find(|name| folder.join(name).exists());
    ["scene.toml", left.unwrap_or(PICTURE)].map(|name| words::quoted(folder.join(name).as_os_str()))
}

/// A command that draws the scene in a folder.
pub(super) struct Program<'a> {
    /// The words of the command, with placeholders.
    pub(super) words: Vec<String>,
    /// The folder with the folders of the scenes; an absolute path.
    pub(super) folder: PathBuf,
    pub(super) timeout: Option<Duration>,
    /// The promise, in place of the one in the description.
    pub(super) promise: Option<Rounding>,
    pub(super) exec: &'a Exec,
}

impl Renderer for Program<'_> {
    fn draw(&mut self, case: &Case) -> Result<Client> {
        let scene = self.folder.join(&case.rule);
        let (picture, description) = (scene.join(PICTURE), scene.join(DESCRIPTION));
        // What an earlier run left must not be judged.
        [&picture, &description].into_iter().try_for_each(|path| remove(path))?;
        let log = scene.join(LOG);
        let ended = self.start(&scene, &picture, &log).and_then(|child| self.wait(child))?;
        if !ended.success() {
            return Err(Error::Invalid(format!("{}{}", code(ended), last_line(&log))));
        }
        let client = [description, picture].into_iter().find(|path| path.exists());
        let Some(client) = client else {
            let what = format!("wrote no {PICTURE} and no {DESCRIPTION}{}", last_line(&log));
            return Err(Error::Invalid(what));
        };
        let (stages, size) = (case.method.stages(), case.camera.size());
        let mut client = Description::open(&client)?.client(stages, size, self.exec)?;
        client.rounding = self.promise.unwrap_or(client.rounding);
        Ok(client)
    }
}

impl Program<'_> {
    fn start(&self, scene: &Path, picture: &Path, log: &Path) -> Result<Child> {
        let places = [("{scene}", scene), ("{out}", picture)];
        let words: Vec<OsString> = self.words.iter().map(|word| filled(word, places)).collect();
        let file = File::create(log).map_err(|source| Error::io(log, source))?;
        let copy = file.try_clone().map_err(|source| Error::io(log, source))?;
        let started = Command::new(&words[0])
            .args(&words[1..])
            .stdin(Stdio::null())
            .stdout(file)
            .stderr(copy)
            .spawn();
        started.map_err(|source| Error::io(Path::new(&words[0]), source))
    }

    fn wait(&self, mut child: Child) -> Result<ExitStatus> {
        let lost = |source: io::Error| Error::Invalid(format!("the command was lost: {source}"));
        let Some(timeout) = self.timeout else { return child.wait().map_err(lost) };
        let start = Instant::now();
        loop {
            if let Some(ended) = child.try_wait().map_err(lost)? {
                return Ok(ended);
            }
            if start.elapsed() > timeout {
                // It may have ended meanwhile; then there is nothing to kill.
                let _ = child.kill();
                let _ = child.wait();
                let seconds = timeout.as_secs();
                return Err(Error::Invalid(format!("ran longer than {seconds} s, and was ended")));
            }
            thread::sleep(GLANCE);
        }
    }
}

/// A word of the command with paths in place of placeholders. A path may have bytes that are no text.
fn filled(word: &str, places: [(&str, &Path); 2]) -> OsString {
    let (mut filled, mut rest) = (OsString::new(), word);
    let first = |rest: &str| {
        let found = places.map(|(name, path)| Some((rest.find(name)?, name.len(), path)));
        found.into_iter().flatten().min_by_key(|(at, ..)| *at)
    };
    while let Some((at, length, path)) = first(rest) {
        filled.push(&rest[..at]);
        filled.push(path);
        rest = &rest[at + length..];
    }
    filled.push(rest);
    filled
}

/// Removes a file, if it exists.
fn remove(path: &Path) -> Result<()> {
    match fs::remove_file(path) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => Err(Error::io(path, source)),
        _ => Ok(()),
    }
}

/// How a command ended, in words.
fn code(ended: ExitStatus) -> String {
    // Without a code, a signal ended it; the system's words name the signal.
    ended.code().map_or_else(|| ended.to_string(), |code| format!("exit code {code}"))
}

/// The last line of the log, to follow what went wrong.
fn last_line(log: &Path) -> String {
    let text = end(log).unwrap_or_default();
    let text = String::from_utf8_lossy(&text);
    let last = text.lines().rev().map(str::trim).find(|line| !line.is_empty());
    last.map_or_else(String::new, |line| {
        let short: String = words::line(line).chars().take(LONGEST).collect();
        format!("; it said: {short}")
    })
}

/// The last bytes of a file, which may be long.
fn end(path: &Path) -> io::Result<Vec<u8>> {
    let mut file = File::open(path)?;
    let length = file.metadata()?.len();
    file.seek(SeekFrom::Start(length.saturating_sub(END)))?;
    let mut bytes = Vec::new();
    file.take(END).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Splits a command into words at blanks. Single and double quotes keep blanks; nothing else is
/// special.
pub(super) fn split(command: &str) -> std::result::Result<Vec<String>, String> {
    let (mut words, mut word, mut quote) = (Vec::new(), None::<String>, None);
    for c in command.chars() {
        match quote {
            Some(open) if c == open => quote = None,
            None if c == '\'' || c == '"' => {
                quote = Some(c);
                word.get_or_insert_default();
            }
            None if c.is_whitespace() => words.extend(word.take()),
            _ => word.get_or_insert_default().push(c),
        }
    }
    if let Some(open) = quote {
        return Err(format!("--command: a quote {open} is not closed"));
    }
    words.extend(word);
    if !words.iter().any(|word| word.contains("{scene}")) {
        return Err(
            "--command: no {scene} is in the command; write {scene} where your program takes \
                    the folder of the scene"
                .into(),
        );
    }
    Ok(words)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_is_split_at_blanks_outside_of_quotes() {
        let words = split("  ./mine '{scene}/a b' \"it's\" '' {out}x ").unwrap();
        assert_eq!(words, ["./mine", "{scene}/a b", "it's", "", "{out}x"]);
        assert!(split("mine 'a {scene}").unwrap_err().contains("not closed"));
        assert!(split("mine {out}").unwrap_err().contains("{scene}"));
    }

    #[cfg(unix)]
    #[test]
    fn paths_keep_their_bytes() {
        use std::os::unix::ffi::OsStringExt;
        let scene = PathBuf::from(OsString::from_vec(b"a\xff {out}".to_vec()));
        let places = [("{scene}", &*scene), ("{out}", Path::new("o.exr"))];
        let word = filled("-i={scene}/s,{out}!", places).into_vec();
        assert_eq!(word, b"-i=a\xff {out}/s,o.exr!");
        assert_eq!(filled("plain", places), "plain");
    }
}
