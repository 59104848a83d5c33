//! Put the planes of a part, which fill its data window, into the display window.
//!
//! Pixels of the data window outside the display window are left out. Pixels of the display window
//! outside the data window are empty: +inf in depths and margins, `0xFFFF_FFFF` in ids, and 0 in all
//! other channels. A depth is a channel `Z` or `voronoi` without channels `X` and `Y` beside it.

use crate::frame::image::Values;
use crate::frame::{NO_ID, Rect};
use crate::io::Reason;
use exr::meta::header::Header as PartHeader;
use exr::prelude::Vec2;
use std::ops::Range;

/// All channels of a picture may take these bytes, whatever its data windows are. Files claim any
/// display window, and no byte backs what lies outside the data.
const SMALL: u64 = 256 << 20;
/// A larger picture has at most so many times the pixels of its largest data window.
const MOST_EMPTY: u64 = 4096;

/// Whether a part is the whole picture.
pub(super) fn is_whole(part: &PartHeader) -> bool {
    part.data_window() == part.shared_attributes.display_window
}

/// The data window that all parts share, as pixels of the picture, if it is inside the picture.
pub(super) fn region(parts: &[PartHeader]) -> Option<Rect> {
    let (data, display) = (parts[0].data_window(), parts[0].shared_attributes.display_window);
    if parts.iter().any(|part| part.data_window() != data) {
        return None;
    }
    let axis = |data: (i32, usize), display: (i32, usize)| {
        let start = u32::try_from(i64::from(data.0) - i64::from(display.0)).ok()?;
        let end = start.checked_add(u32::try_from(data.1).ok()?)?;
        (end as usize <= display.1).then_some([start, end])
    };
    let [x0, x1] =
        axis((data.position.x(), data.size.width()), (display.position.x(), display.size.width()))?;
    let [y0, y1] = axis(
        (data.position.y(), data.size.height()),
        (display.position.y(), display.size.height()),
    )?;
    Some(Rect { x0, y0, x1, y1 })
}

/// Checks that all parts have one display window, and that it has pixels.
pub(super) fn check(parts: &[PartHeader]) -> Reason<()> {
    let window = parts[0].shared_attributes.display_window;
    if parts.iter().any(|part| part.shared_attributes.display_window != window) {
        return Err("header: the parts have different display windows; save them alike".into());
    }
    match window.size.area() {
        0 => Err("header: a display window without pixels; save it again".into()),
        _ => Ok(()),
    }
}

/// Checks that a display window that is to be filled is no larger than a picture may be.
pub(super) fn check_emptiness(parts: &[PartHeader]) -> Reason<()> {
    let Vec2(width, height) = parts[0].shared_attributes.display_window.size;
    let channels: usize = parts.iter().map(|part| part.channels.list.len()).sum();
    let pixels = (width as u64).saturating_mul(height as u64);
    let bytes = pixels.saturating_mul(4 * channels as u64);
    let data = parts.iter().map(|part| part.layer_size.area() as u64).max().unwrap_or(0);
    if bytes > SMALL && pixels > data.saturating_mul(MOST_EMPTY) {
        let Vec2(columns, rows) = parts[0].layer_size;
        return Err(format!(
            "header: a display window of {width} x {height} pixels around data of {columns} x {rows}; \
             save the whole picture, or a smaller display window"
        ));
    }
    Ok(())
}

/// The planes in the display window.
pub(super) fn fit(planes: Vec<Values>, part: &PartHeader) -> Vec<Values> {
    let names: Vec<_> = part.channels.list.iter().map(|one| one.name.as_slice()).collect();
    let place = Place::new(part);
    let planes = planes.into_iter().zip(&names);
    let fit = |(plane, name): (Values, &&[u8])| match plane {
        Values::Float(values) => {
            let empty = if is_depth(name, &names) { f32::INFINITY } else { 0.0 };
            Values::Float(place.fit(&values, empty))
        }
        Values::Index(values) => {
            let empty = if last(name) == b"id" { NO_ID } else { 0 };
            Values::Index(place.fit(&values, empty))
        }
    };
    planes.map(fit).collect()
}

/// The part of a channel's name after the last dot.
fn last(name: &[u8]) -> &[u8] {
    name.rsplit(|byte| *byte == b'.').next().unwrap_or_default()
}

fn is_depth(name: &[u8], names: &[&[u8]]) -> bool {
    let before = &name[..name.len() - last(name).len()];
    let beside = [before, b"X"].concat();
    match last(name) {
        b"voronoi" | b"margin" => true,
        b"Z" => !names.contains(&beside.as_slice()),
        _ => false,
    }
}

/// Where the data are in the display window.
struct Place {
    columns: usize,
    /// The size of the display window.
    size: [usize; 2],
    /// The pixels of the display window that have data, by axis.
    inside: [Range<usize>; 2],
    /// The first of them in the data.
    from: [usize; 2],
}

impl Place {
    fn new(part: &PartHeader) -> Self {
        let (data, display) = (part.data_window(), part.shared_attributes.display_window);
        let axis = |data: (i32, usize), display: (i32, usize)| {
            let start = i64::from(data.0) - i64::from(display.0);
            let clip = |at: i64| usize::try_from(at).unwrap_or(0).min(display.1);
            let inside = clip(start)..clip(start + data.1 as i64);
            (inside, usize::try_from(-start).unwrap_or(0))
        };
        let (x, left) = axis(
            (data.position.x(), data.size.width()),
            (display.position.x(), display.size.width()),
        );
        let (y, top) = axis(
            (data.position.y(), data.size.height()),
            (display.position.y(), display.size.height()),
        );
        let size = [display.size.width(), display.size.height()];
        Self { columns: data.size.width(), size, inside: [x, y], from: [left, top] }
    }

    fn fit<T: Copy>(&self, values: &[T], empty: T) -> Vec<T> {
        let [width, height] = self.size;
        let [x, y] = self.inside.clone();
        let [left, top] = self.from;
        let mut all = vec![empty; width * height];
        if x.is_empty() {
            return all;
        }
        for (row, line) in y.enumerate() {
            let from = (top + row) * self.columns + left;
            all[line * width..][x.clone()].copy_from_slice(&values[from..][..x.len()]);
        }
        all
    }
}
