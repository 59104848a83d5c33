//! Read the part of a picture that a file holds.

use super::read::{Fit, decode, metadata, open};
use super::{Compression, Window, window};
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::frame::image::Image;
use crate::io::guard::guarded;
use crate::io::{Reason, input};
use exr::prelude::Compression as Codec;
use std::path::Path;

/// The part of a picture that a file holds.
#[derive(Clone, Debug)]
pub struct Region {
    /// Its pixels; the image has the size of the region.
    pub image: Image,
    /// Where the pixels are in their picture.
    pub window: Window,
    /// How the file is compressed; none if this crate cannot write such files.
    pub compression: Option<Compression>,
}

/// Reads the part of a picture that the EXR file at `path` holds, its data window, on several
/// threads. Unlike [`super::read_with`], it does not fill the rest of the picture with empty pixels.
///
/// # Errors
/// As [`super::read()`], and [`Error::Format`] if the file has data windows that differ or are not inside
/// the picture.
pub fn read_region(path: &Path, exec: &Exec) -> Result<Region> {
    let (file, length) = open(path)?;
    let bytes = input::rest(file, length).map_err(|source| Error::io(path, source))?;
    let read = || -> Reason<Region> {
        let mut rest = &bytes[..];
        let meta = metadata(&mut rest, length)?;
        let first = &meta.headers[0];
        let Some(region) = window::region(&meta.headers) else {
            return Err(
                "header: a data window that is not inside the picture; save it again".into()
            );
        };
        let size = first.shared_attributes.display_window.size;
        let compression = match first.compression {
            Codec::RLE => Some(Compression::Rle),
            Codec::ZIP16 => Some(Compression::Zip),
            Codec::PIZ => Some(Compression::Piz),
            Codec::Uncompressed => Some(Compression::None),
            _ => None,
        };
        let picture = [size.width() as u32, size.height() as u32];
        let image = decode(&bytes, exec, Fit::Data)?;
        Ok(Region { image, window: Window { region, picture }, compression })
    };
    guarded(read).flatten().map_err(|what| Error::format(path, what))
}
