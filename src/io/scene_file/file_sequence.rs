//! Name one file a frame: `cloud.%04d.ply` is `cloud.0007.ply` in frame 7.
//!
//! `%d` stands for the number of the frame in decimal digits. `%04d` does too, with zeros in front up to
//! 4 digits; 1 to 9 digits are possible. The name of the file may hold one of them. Any other `%` is an
//! ordinary character, and so is every `%` in the name of a folder.

use std::fs;
use std::path::{Path, PathBuf};

/// Files whose names have the number of a frame between two texts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct FileSequence {
    folder: PathBuf,
    before: String,
    digits: usize,
    after: String,
}

impl FileSequence {
    /// The files that a path names; `None` if it names one file.
    ///
    /// # Errors
    /// One line if the name has two numbers.
    pub(super) fn of(path: &Path) -> Result<Option<Self>, String> {
        let Some(name) = path.file_name().and_then(|name| name.to_str()) else { return Ok(None) };
        let Some((before, digits, after)) = split(name) else { return Ok(None) };
        if split(after).is_some() {
            let what = format!("{name} has two numbers of a frame; keep one");
            return Err(what);
        }
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        Ok(Some(Self { folder, before: before.into(), digits, after: after.into() }))
    }

    /// The file of a frame.
    pub(super) fn at(&self, frame: u32) -> PathBuf {
        let Self { folder, before, digits, after } = self;
        folder.join(format!("{before}{frame:0digits$}{after}"))
    }

    /// Whether a canonical path is the file of some frame.
    pub(super) fn has(&self, path: &Path) -> bool {
        let Some(name) = path.file_name().and_then(|name| name.to_str()) else { return false };
        let number =
            name.strip_prefix(&self.before).and_then(|rest| rest.strip_suffix(&self.after));
        let file = number.and_then(|number| number.parse().ok()).map(|frame| self.at(frame));
        file.is_some_and(|file| {
            file.ends_with(name) && fs::canonicalize(file).is_ok_and(|file| file == path)
        })
    }
}

/// The texts before and after the first `%d` or `%0Nd`, and N, which is 1 for `%d`.
fn split(name: &str) -> Option<(&str, usize, &str)> {
    name.match_indices('%').find_map(|(at, _)| {
        let rest = &name[at + 1..];
        let (format, after) = rest.split_once('d')?;
        let digits = match format.as_bytes() {
            [] => 1,
            [b'0', digit @ b'1'..=b'9'] => usize::from(digit - b'0'),
            _ => return None,
        };
        Some((&name[..at], digits, after))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(path: &str, frame: u32) -> String {
        let files = FileSequence::of(Path::new(path)).unwrap();
        files.map_or("one".into(), |files| files.at(frame).to_str().unwrap().replace('\\', "/"))
    }

    #[test]
    fn the_number_of_the_frame_stands_in_the_name() {
        assert_eq!(at("a/cloud.%04d.ply", 7), "a/cloud.0007.ply");
        assert_eq!(at("%d", 0), "0");
        assert_eq!(at("a.%02d.ply", 1234), "a.1234.ply");
        assert_eq!(at("100%.%d.ply", 5), "100%.5.ply");
        // Folders keep their names.
        assert_eq!(at("%d/cloud.%d.ply", 3), "%d/cloud.3.ply");
        for one in
            ["cloud.ply", "%d/cloud.ply", "50%.ply", "a%4d.ply", "a%00d.ply", "a%010d.ply", ".."]
        {
            assert_eq!(at(one, 7), "one", "{one}");
        }
        let two = FileSequence::of(Path::new("a.%d.%02d.ply")).unwrap_err();
        assert_eq!(two, "a.%d.%02d.ply has two numbers of a frame; keep one");
    }
}
