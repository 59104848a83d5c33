//! Lines.

use super::*;

/// The visits of a line: pixel, numerator, denominator.
pub(super) fn visited(bits: u32, a: Point, b: Point, rect: &Rect) -> Vec<(u32, u32, i64, i64)> {
    let line = Line::new(&Snap { bits }, a, b);
    let bounds = line.bounds(u32::MAX, u32::MAX);
    let mut list = Vec::new();
    line.for_each(rect, |x, y, numerator, denominator| {
        assert!(bounds.contains(x, y) && rect.contains(x, y));
        assert!(denominator > 0 && (0..=denominator).contains(&numerator));
        list.push((x, y, numerator, denominator));
    });
    assert!(list.is_sorted_by_key(|v| v.2), "from a to b");
    list
}

/// The parameters of the visits of one pixel, as fractions, found by visiting only that pixel.
fn parameters(bits: u32, a: Point, b: Point, x: u32, y: u32) -> Vec<(i128, i128)> {
    let pixel = [i128::from(x), i128::from(y)];
    let contains = |p: Point| (0..2).all(|k| i128::from(p[k]) >> bits == pixel[k]);
    if a == b {
        return if contains(a) { vec![(0, 1)] } else { Vec::new() };
    }
    let (a2, b2) = (halves(a), halves(b));
    let d = [b2[0] - a2[0], b2[1] - a2[1]];
    let (m, n) = if d[0].abs() >= d[1].abs() { (0, 1) } else { (1, 0) };
    let mut list = Vec::new();
    if contains(a) {
        list.push((0, 1));
    }
    let along = (center(bits, x, y)[m] - a2[m]) * d[m].signum();
    let length = d[m].abs();
    if 0 < along && along < length {
        // a + d along / length in [border, border + 1 pixel), times the length.
        let at = a2[n] * length + d[n] * along;
        let border = (pixel[n] << (bits + 1)) * length;
        if border <= at && at < border + (length << (bits + 1)) {
            list.push((along, length));
        }
    }
    if contains(b) {
        list.push((1, 1));
    }
    list
}

fn assert_line(bits: u32, a: Point, b: Point, rect: &Rect) {
    let visits = visited(bits, a, b, rect);
    let mut total = 0;
    for (x, y) in pixels(rect) {
        let expected = parameters(bits, a, b, x, y);
        let own: Vec<_> = visits.iter().filter(|v| (v.0, v.1) == (x, y)).collect();
        assert_eq!(own.len(), expected.len(), "{:?} {:?} {:?}", (x, y), a, b);
        for (own, (numerator, denominator)) in own.iter().zip(&expected) {
            let [n, d] = [own.2, own.3].map(i128::from);
            assert_eq!(n * denominator, numerator * d);
        }
        total += own.len();
    }
    assert_eq!(total, visits.len());
}

proptest! {
    #![proptest_config(cases())]

    #[test]
    fn a_line_visits_what_the_rule_says((bits, [a, b]) in points::<2>()) {
        assert_line(bits, a, b, &PICTURE);
    }

    #[test]
    fn lines_as_long_as_the_guard_band_are_exact(([a, b], share) in wide::<2>()) {
        assert_line(12, a, b, &window(a, b, share));
    }

    #[test]
    fn a_line_has_the_same_pixels_from_the_other_end((bits, [a, b]) in points::<2>()) {
        let there = visited(bits, a, b, &PICTURE);
        let mut back = visited(bits, b, a, &PICTURE);
        back.reverse();
        if a != b {
            back.iter_mut().for_each(|v| v.2 = v.3 - v.2);
        }
        prop_assert_eq!(there, back);
    }

    #[test]
    fn polylines_are_connected((bits, vertices) in points::<5>()) {
        let shift = |p: Point| p.map(|c| c + (16 << bits));
        let room = Rect { x0: 0, y0: 0, x1: 64, y1: 64 };
        let visits: Vec<_> = vertices
            .windows(2)
            .flat_map(|ends| visited(bits, shift(ends[0]), shift(ends[1]), &room))
            .collect();
        for pair in visits.windows(2) {
            let apart = (pair[0].0.abs_diff(pair[1].0), pair[0].1.abs_diff(pair[1].1));
            prop_assert!(apart.0 <= 1 && apart.1 <= 1, "{:?}", pair);
        }
        for vertex in vertices.map(shift) {
            let pixel = vertex.map(|c| (c >> bits) as u32);
            prop_assert!(visits.iter().any(|v| [v.0, v.1] == pixel));
        }
    }
}

#[test]
fn a_line_by_hand() {
    // From (1/2, 1/2) to (7/2, 3/2) px: samples at 3/2 and 5/2 px, rows 5/6 and 7/6.
    let room = Rect { x0: 0, y0: 0, x1: 9, y1: 9 };
    let expected = [(0, 0, 0, 12), (1, 0, 4, 12), (2, 1, 8, 12), (3, 1, 12, 12)];
    assert_eq!(visited(1, [1, 1], [7, 3], &room), expected);
    // Along the border of rows 0 and 1, and along the diagonal through corners of pixels.
    let rows: Vec<_> = visited(1, [0, 2], [4, 2], &room).iter().map(|v| (v.0, v.1)).collect();
    assert_eq!(rows, [(0, 1), (0, 1), (1, 1), (2, 1)]);
    let corners: Vec<_> = visited(1, [2, 0], [0, 2], &room).iter().map(|v| (v.0, v.1)).collect();
    assert_eq!(corners, [(1, 0), (0, 0), (0, 1)]);
    assert_eq!(visited(8, [700, 300], [700, 300], &room), [(2, 1, 0, 1)]);
}
