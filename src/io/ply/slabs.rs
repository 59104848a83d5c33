//! Read large files in slabs: decode one slab of vertices while the next is read.

use super::faces;
use super::header::{self, PlyHeader};
use super::layout::Layout;
use super::rows::Rows;
use super::values::BodyValues;
use super::{ReadOptions, ask, doubts, empty, far, gaussians, groups, other, vertex};
use crate::frame::Exec;
use crate::scene::Cloud;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};

/// A file with a longer header is read as a whole.
const MOST_HEADER: u64 = 1 << 16;
/// Rows of a slab: few enough that their bytes stay in a cache until they are decoded.
const ROWS: u64 = 1 << 16;

/// Why a file cannot be read, without its name.
pub(super) enum Error {
    Io(io::Error),
    Format(String),
}

impl From<io::Error> for Error {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

impl From<String> for Error {
    fn from(what: String) -> Self {
        Self::Format(what)
    }
}

/// A file that begins with vertices of one length, and holds all of them.
pub(super) struct Start {
    pub(super) header: PlyHeader,
    pub(super) layout: Layout,
    pub(super) rows: Rows,
    options: ReadOptions,
}

/// Examines the start of a file of `length` bytes. `None` means that the file must be read as a
/// whole, or that something is wrong with it, which the whole read will report.
///
/// # Errors
/// If the file cannot be read, or if it holds 3D Gaussians, which is worth no whole read.
pub(super) fn start(
    file: &mut File,
    length: u64,
    options: &ReadOptions,
) -> Result<Option<Start>, Error> {
    let mut bytes = Vec::new();
    file.take(MOST_HEADER).read_to_end(&mut bytes)?;
    let Ok(header) = header::parse(&bytes) else { return Ok(None) };
    if vertex(&header).is_ok() {
        gaussians::check(&header)?;
    }
    Ok(Start::new(header, length, *options))
}

impl Start {
    fn new(header: PlyHeader, length: u64, options: ReadOptions) -> Option<Self> {
        let vertex = vertex(&header).ok()?;
        if header.elements.first()?.name != vertex.name {
            return None;
        }
        let layout = Layout::new(vertex, &groups::Reader::new(vertex), options.color_range).ok()?;
        // Positions that need an offset are read twice.
        if far::wide(vertex, &layout).is_some() {
            return None;
        }
        let rows = Rows::new(vertex, &layout, header.format)?;
        let bytes = vertex.count.checked_mul(rows.stride() as u64)?;
        let there = length.checked_sub(header.body as u64)?;
        (bytes <= there).then_some(Self { header, layout, rows, options })
    }

    /// Reads the whole file.
    pub(super) fn read(self, mut file: File, length: u64, exec: &Exec) -> Result<Cloud, Error> {
        let Self { header, layout, rows, options } = self;
        let vertex = vertex(&header)?;
        let stride = rows.stride() as u64;
        let after = header.body as u64 + vertex.count * stride;
        let slab = ROWS.min(vertex.count) * stride;
        ask(&header, length, 2 * slab + (length - after))?;
        let mut cloud = empty(&header);
        layout.arrays(&mut cloud)?;
        rows.reserve(vertex.count as usize, &mut cloud);
        file.seek(SeekFrom::Start(header.body as u64))?;
        slabs(&rows, &mut file, vertex.count, &mut cloud, exec)?;

        let mut rest = Vec::new();
        file.take(length - after).read_to_end(&mut rest)?;
        let mut values = BodyValues::rest(&rest, after, header.format);
        // Vertices with groups are never read in slabs, so this reader stays empty.
        let mut groups = groups::Reader::new(vertex);
        let mut polygons = Vec::new();
        for element in &header.elements[1..] {
            let more =
                other(element, &mut values, vertex.count, &mut cloud, &mut groups, &options)?;
            polygons.extend(more);
        }
        values.finish()?;
        faces::cut(&polygons, &mut cloud);
        doubts(&header, &options, &mut cloud);
        Ok(cloud)
    }
}

/// Reads `count` rows from the current position: one slab is decoded while the next is read.
fn slabs(
    rows: &Rows,
    file: &mut File,
    count: u64,
    cloud: &mut Cloud,
    exec: &Exec,
) -> io::Result<()> {
    let (mut next, mut current) = (Vec::new(), Vec::new());
    let mut left = count;
    while left > 0 || !current.is_empty() {
        let size = left.min(ROWS);
        left -= size;
        next.resize(size as usize * rows.stride(), 0);
        let (read, ()) =
            exec.join(|| file.read_exact(&mut next), || rows.append(&current, cloud, exec));
        read?;
        std::mem::swap(&mut next, &mut current);
    }
    Ok(())
}
