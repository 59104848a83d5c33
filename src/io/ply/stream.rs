//! Read the surfels of a file part by part, as often as needed.

use super::slabs::{self, Start};
use super::{ReadOptions, vertex};
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::io::input;
use crate::memory;
use crate::scene::{Cloud, Surfels};
use glam::DVec3;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// Rows of a part: few enough for a small memory.
const ROWS: u64 = 1 << 14;
/// The most bytes that a row takes in memory: decoded, checked, and while both are there.
const BYTES_A_ROW: u64 = 400;

/// A file of complete surfels, whose vertices are read in parts.
pub(in crate::io) struct Stream {
    path: PathBuf,
    file: File,
    start: Start,
    count: u64,
}

impl Stream {
    /// Opens a file. Says why not, if it must be read as a whole, or if a surfel depends on other
    /// surfels or on other files.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be read. [`Error::Format`] if it holds 3D Gaussians, or more than a
    /// complete file.
    pub(in crate::io) fn open(path: &Path) -> Result<std::result::Result<Self, &'static str>> {
        let io = |source| Error::io(path, source);
        let format = |what: String| Error::format(path, what);
        let (mut file, length) = input::open(path).map_err(io)?;
        let start = slabs::start(&mut file, length, &ReadOptions::default());
        let start = start.map_err(|error| match error {
            slabs::Error::Io(source) => io(source),
            slabs::Error::Format(what) => format(what),
        })?;
        let Some(start) = start else { return Ok(Err(WHOLE)) };
        if let Some(why) = whole(&start).map_err(format)? {
            return Ok(Err(why));
        }
        let count = vertex(&start.header).map_err(format)?.count;
        let left = length - start.header.body as u64 - count * start.rows.stride() as u64;
        if left > 0 {
            return Err(format(format!("{left} bytes are left over after the vertices")));
        }
        let bytes = count.min(ROWS) * (BYTES_A_ROW + start.rows.stride() as u64);
        memory::ask(bytes, || "reading a part of the file".to_owned())?;
        Ok(Ok(Self { path: path.to_owned(), file, start, count }))
    }

    /// How many vertices there are.
    pub(in crate::io) fn count(&self) -> u64 {
        self.count
    }

    /// Whether surfels have colours, opacities and half axes.
    pub(in crate::io) fn has(&self) -> [bool; 3] {
        let mut cloud = Cloud::default();
        // The file has been checked, so its arrays are known.
        let _ = self.start.layout.arrays(&mut cloud);
        [cloud.color.is_some(), cloud.opacity.is_some(), cloud.tangents.is_some()]
    }

    /// What the file says was subtracted from its positions.
    pub(in crate::io) fn offset(&self) -> DVec3 {
        self.start.header.offset.unwrap_or_default()
    }

    /// Reads all vertices, and calls `visit` with the surfels of each part, in the order of the file.
    /// A part may have no surfel, because points that are no surfels are dropped.
    ///
    /// # Errors
    /// [`Error::Io`] if the file cannot be read, and what `visit` returns.
    pub(in crate::io) fn each(
        &mut self,
        exec: &Exec,
        visit: &mut dyn FnMut(Surfels) -> Result<()>,
    ) -> Result<()> {
        let io = |source| Error::io(&self.path, source);
        let Start { header, layout, rows, .. } = &self.start;
        self.file.seek(SeekFrom::Start(header.body as u64)).map_err(io)?;
        let mut bytes = Vec::new();
        let mut left = self.count;
        while left > 0 {
            let size = left.min(ROWS);
            left -= size;
            bytes.resize(size as usize * rows.stride(), 0);
            self.file.read_exact(&mut bytes).map_err(io)?;
            let mut cloud = Cloud::default();
            layout.arrays(&mut cloud).map_err(|what| Error::format(&self.path, what))?;
            rows.append(&bytes, &mut cloud, exec);
            visit(Surfels::new_or_none(cloud, exec)?.0)?;
        }
        Ok(())
    }
}

/// Why a file cannot be read in parts.
const WHOLE: &str = "it is no complete binary little-endian PLY that begins with its vertices, with \
                     float coordinates, without lists and groups";

/// Why surfels depend on each other or on another file, if they do.
fn whole(start: &Start) -> std::result::Result<Option<&'static str>, String> {
    let Start { header, layout, .. } = start;
    let mut cloud = Cloud::default();
    layout.arrays(&mut cloud)?;
    let reasons = [
        (header.elements[1..].iter().any(|other| other.count > 0), "it has more than vertices"),
        (cloud.normal.is_none(), "it has no normals nx ny nz"),
        (cloud.radius.is_none(), "it has no property radius"),
        (cloud.mipmap.is_some(), "it has prefiltered colours"),
        (!header.textures.is_empty(), "it has a texture"),
    ];
    Ok(reasons.into_iter().find(|(is, _)| *is).map(|(_, why)| why))
}
