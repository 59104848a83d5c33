//! Parse `--region`, and say what a part holds.

use splatref::frame::Rect;

/// What a part holds by a method whose other stages need the whole picture.
pub(super) const PROJECTION: &str =
    "the projection alone; `splatref assemble` runs the other stages";

/// Parses `X0,Y0,X1,Y1`.
pub(super) fn region(text: &str) -> Result<Rect, String> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    let Some([x0, y0, x1, y1]) = numbers.as_deref().and_then(|all| all.as_array().copied()) else {
        return Err("give X0,Y0,X1,Y1: the first column and row, then one after the last".into());
    };
    let region = Rect { x0, y0, x1, y1 };
    if region.is_empty() {
        let what = "no pixel, because X1 and Y1 are excluded; give X1 above X0 and Y1 above Y0";
        return Err(what.into());
    }
    Ok(region)
}

/// The region as the option takes it.
pub(super) fn words(Rect { x0, y0, x1, y1 }: Rect) -> String {
    format!("{x0},{y0},{x1},{y1}")
}
