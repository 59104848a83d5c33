//! The sizes of an image pyramid, and its levels as planes.

use super::Plane;

/// The width and height of every level, from the picture to the level of one pixel.
///
/// `Decided:` a level is half as wide and half as high as the next finer level, rounded up.
/// (\[MKC08\] and \[MOC08\] show powers of two.) Pixel (X, Y) stands for the finer pixels (2X, 2Y),
/// (2X + 1, 2Y), (2X, 2Y + 1), (2X + 1, 2Y + 1); the ones beyond the right or lower edge of an odd
/// level do not exist. So a pixel of level l is a square of side 2^l pixels whose centre is (2^l
/// (X + 1/2), 2^l (Y + 1/2)). Along a side that is a power of two, and not the shorter side, the
/// squares of all levels end where the picture ends. Along any other side the squares of some level
/// reach beyond the picture.
#[must_use]
pub fn sizes(width: u32, height: u32) -> Vec<[u32; 2]> {
    let mut levels = vec![[width, height]];
    let (mut w, mut h) = (width, height);
    while w > 1 || h > 1 {
        (w, h) = (w.div_ceil(2), h.div_ceil(2));
        levels.push([w, h]);
    }
    levels
}

/// Puts a level into the upper left corner of a plane with the size of the picture.
#[must_use]
pub fn in_corner<T: Copy>(level: &Plane<T>, [width, height]: [u32; 2], empty: T) -> Plane<T> {
    let mut whole = Plane::filled(width, height, empty);
    let from = level.width() as usize;
    for (row, cells) in whole.rows_mut().zip(level.values().chunks(from)) {
        row[..from].copy_from_slice(cells);
    }
    whole
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_lies_in_the_corner() {
        let level = Plane::from_values(2, 1, vec![1, 2]);
        let whole = in_corner(&level, [3, 2], 0);
        assert_eq!(whole, Plane::from_values(3, 2, vec![1, 2, 0, 0, 0, 0]));
    }

    #[test]
    fn every_level_covers_the_finer_one_and_the_last_is_a_pixel() {
        assert_eq!(sizes(1, 1), [[1, 1]]);
        assert_eq!(sizes(8, 4), [[8, 4], [4, 2], [2, 1], [1, 1]]);
        assert_eq!(sizes(1, 5), [[1, 5], [1, 3], [1, 2], [1, 1]]);
        for (w, h) in [(13, 9), (65_535, 3), (1023, 1025)] {
            let levels = sizes(w, h);
            for pair in levels.windows(2) {
                for (fine, coarse) in pair[0].into_iter().zip(pair[1]) {
                    assert!(2 * coarse >= fine && 2 * (coarse - 1) < fine, "{fine} {coarse}");
                }
            }
            assert_eq!(levels.last(), Some(&[1, 1]));
        }
    }
}
