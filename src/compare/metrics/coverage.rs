//! Count holes and spill: where two pictures disagree on the pixels that they cover.

/// The region of a pixel in a picture's coverage, see [`regions`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Region {
    /// The pixel and all its neighbours are covered.
    Interior,
    /// The silhouette: neither interior nor exterior. It is two pixels wide, one on either side.
    Edge,
    /// Neither the pixel nor any of its neighbours is covered.
    Exterior,
}

/// The region of each pixel of a plane of coverage with `width` values a row.
///
/// A pixel is covered if its value is > 0; a NaN is not. Its neighbours are the pixels among the
/// eight around it that lie in the plane. So the border of the picture is no silhouette.
///
/// # Panics
/// If the length of the plane is no multiple of `width`.
#[must_use]
pub fn regions(coverage: &[f32], width: usize) -> Vec<Region> {
    let height = coverage.len().checked_div(width).unwrap_or(0);
    assert_eq!(coverage.len(), width * height, "whole rows");
    let around = |at: usize, end: usize| at.saturating_sub(1)..end.min(at + 2);
    let region = |x: usize, y: usize| {
        let cells = around(y, height).flat_map(|y| around(x, width).map(move |x| y * width + x));
        let (mut full, mut empty) = (true, true);
        for covered in cells.map(|i| coverage[i] > 0.0) {
            full &= covered;
            empty &= !covered;
        }
        match (full, empty) {
            (true, _) => Region::Interior,
            (_, true) => Region::Exterior,
            _ => Region::Edge,
        }
    };
    (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| region(x, y)).collect()
}

/// Counts of pixels that compare the coverage of a picture with a reference; see [`coverage`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Coverage {
    /// Pixels that the reference covers.
    pub covered: u64,
    /// Pixels in the reference's interior.
    pub interior: u64,
    /// Interior pixels that the picture leaves empty.
    pub holes: u64,
    /// Pixels in the reference's exterior that the picture covers.
    pub spill: u64,
    /// Pixels on the reference's edge.
    pub edge: u64,
    /// Edge pixels that one picture covers and the other does not.
    pub mismatch: u64,
}

/// Counts holes and spill of a plane of coverage against a reference, both with `width` values a
/// row.
///
/// Pixels are counted by their [`regions`] in the reference. So a silhouette that is off by a pixel
/// counts only in `mismatch`.
///
/// # Panics
/// If the planes differ in length, or their length is no multiple of `width`.
#[must_use]
pub fn coverage(picture: &[f32], reference: &[f32], width: usize) -> Coverage {
    assert_eq!(picture.len(), reference.len(), "planes of one size");
    let mut counts = Coverage::default();
    let pixels = picture.iter().zip(reference).map(|(a, b)| (*a > 0.0, *b > 0.0));
    for ((found, expected), region) in pixels.zip(regions(reference, width)) {
        counts.covered += u64::from(expected);
        match region {
            Region::Interior => {
                counts.interior += 1;
                counts.holes += u64::from(!found);
            }
            Region::Edge => {
                counts.edge += 1;
                counts.mismatch += u64::from(found != expected);
            }
            Region::Exterior => counts.spill += u64::from(found),
        }
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::super::tests::plane;
    use super::*;

    #[test]
    fn regions_of_a_drawing() {
        let drawing = ["......", ".###..", ".###..", ".###.#", "....##"];
        // i interior, e edge, x exterior. The corner has no neighbours beyond the picture.
        let expected = ["eeeeex", "eeeeex", "eeieee", "eeeeee", "eeeeee"];
        let plane: Vec<f32> =
            drawing.concat().bytes().map(|c| if c == b'#' { 0.25 } else { 0.0 }).collect();
        let letter = |region| match region {
            Region::Interior => 'i',
            Region::Edge => 'e',
            Region::Exterior => 'x',
        };
        let found: String = regions(&plane, 6).into_iter().map(letter).collect();
        assert_eq!(found, expected.concat());
        assert_eq!(regions(&[1.0; 6], 3), [Region::Interior; 6], "no silhouette at the border");
        assert_eq!(regions(&[f32::NAN, -1.0], 1), [Region::Exterior; 2]);
        assert!(regions(&[], 0).is_empty());
    }

    #[test]
    fn a_hole_a_spill_and_a_shifted_silhouette() {
        let reference = plane(16, 9, |x, _| f32::from(u8::from(x < 8)));
        let whole = Coverage { covered: 72, interior: 63, edge: 18, ..Coverage::default() };
        assert_eq!(coverage(&reference, &reference, 16), whole);
        let shifted = plane(16, 9, |x, _| f32::from(u8::from(x < 9)));
        assert_eq!(coverage(&shifted, &reference, 16), Coverage { mismatch: 9, ..whole });
        let mut picture = reference.clone();
        (picture[3 * 16 + 6], picture[3 * 16 + 7], picture[3 * 16 + 9]) = (0.0, 0.0, 0.5);
        let found = coverage(&picture, &reference, 16);
        assert_eq!(found, Coverage { holes: 1, spill: 1, mismatch: 1, ..whole });
        let swapped = coverage(&plane(16, 9, |_, _| 0.0), &reference, 16);
        assert_eq!(swapped, Coverage { holes: 63, mismatch: 9, ..whole });
    }
}
