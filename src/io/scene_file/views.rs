//! The cameras of a file that a scene file names.

use super::text;
use crate::error::{Error, Result};
use crate::io::cameras::{self, View};
use crate::io::{exr, extension};
use std::path::{Path, PathBuf};

/// The cameras of a file: of [another program](crate::io::cameras), or of an EXR that `splatref` wrote,
/// whose text has its camera, bit for bit.
#[derive(Clone, Debug, PartialEq)]
pub struct Views {
    /// The file or folder.
    pub path: PathBuf,
    /// The view to draw; if absent, each view is a frame.
    pub view: Option<String>,
    /// All views; none until the file is read.
    pub(super) all: Vec<View>,
    /// The place of the chosen view among them.
    pub(super) chosen: Option<usize>,
}

impl Views {
    /// Names a camera file, which [`SceneFile::read`] will read.
    pub(super) fn unread(path: PathBuf, view: Option<String>) -> Self {
        Self { path, view, all: Vec::new(), chosen: None }
    }

    /// Reads a camera file, and finds the view.
    ///
    /// # Errors
    /// As [`cameras::read`]; [`Error::Format`] if a picture has no text of this crate;
    /// [`Error::Usage`] as [`cameras::find`].
    pub fn read(path: &Path, view: Option<String>) -> Result<Self> {
        let mut views = Self::unread(path.to_owned(), view);
        views.load()?;
        Ok(views)
    }

    /// The number of cameras of the file.
    #[must_use]
    pub fn count(&self) -> usize {
        self.all.len()
    }

    pub(super) fn load(&mut self) -> Result<()> {
        self.all = match extension(&self.path).as_deref() {
            Some("exr") => vec![picture(&self.path)?],
            _ => cameras::read(&self.path)?,
        };
        let find = |name: &String| cameras::find(&self.path, &self.all, name);
        self.chosen = self.view.as_ref().map(find).transpose()?;
        Ok(())
    }
}

/// The camera in the text of a picture.
fn picture(path: &Path) -> Result<View> {
    let no_text = || {
        Error::format(
            path,
            "the picture has no text from splatref with a [camera]; render it again",
        )
    };
    let text = exr::read_header(path)?.text.ok_or_else(no_text)?;
    let table: toml::Table = text.parse().map_err(|_| no_text())?;
    let camera = table.get("camera").cloned().ok_or_else(no_text)?;
    let choice = text::parse_camera(camera, path)?;
    let (Some(view), Some(intrinsics)) = (choice.view, choice.intrinsics) else {
        return Err(no_text());
    };
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned());
    let mut own = View::new(name.unwrap_or_default(), view, choice.offset, intrinsics);
    (own.near, own.other_eye) = (choice.near, choice.other_eye);
    Ok(own)
}
