//! Places labels beside points so that they do not collide, greedily.
//!
//! Labels are placed in their order, each with the first of its texts that finds a place. The
//! places lie on rings of 9, 14, 21, 30, 42, 60 and 84 px around the point. Each ring has 16
//! directions, from the right, alternately below and above. The box of the text touches the ring on
//! the side of the point. A place is taken if the box and a px around it lie within the bounds and
//! meet no mark, no line and no earlier box, and if the leader crosses no box and no mark of
//! another point. The leader is the line from the point to the box; it is drawn if the ring is over
//! 14 px. A label that finds no place is left out.

use super::mark::REACH;
use super::text::width;
use crate::number::elementary::{cos, sin};
use std::f64::consts::TAU;

/// Left, top, right and bottom, in px.
pub type Box = [f64; 4];
/// A line between two points.
pub type Segment = [[f64; 2]; 2];

/// A label to place.
#[derive(Clone, Debug, PartialEq)]
pub struct Wanted {
    /// The index of its point.
    pub point: usize,
    /// Its possible texts, the best first.
    pub texts: Vec<String>,
}

/// The place of a label.
#[derive(Clone, Debug, PartialEq)]
pub struct Placed {
    /// The box of its text.
    pub area: Box,
    /// The chosen text.
    pub text: String,
    /// The line from the point to the box, if they are far apart.
    pub leader: Option<Segment>,
}

const RINGS: [f64; 7] = [9.0, 14.0, 21.0, 30.0, 42.0, 60.0, 84.0];
const NEAR: f64 = 14.0;
const DIRECTIONS: usize = 16;

/// Finds a place for each label, or none; see the [module](self). Texts of `size` px are placed
/// beside `points` with marks, clear of `lines`.
#[must_use]
pub fn place(
    labels: &[Wanted],
    size: f64,
    points: &[[f64; 2]],
    lines: &[Segment],
    bounds: Box,
) -> Vec<Option<Placed>> {
    let mut taken: Vec<Placed> = Vec::new();
    let marks: Vec<Box> =
        points.iter().map(|&[x, y]| [x - REACH, y - REACH, x + REACH, y + REACH]).collect();
    let place_one = |label: &Wanted| {
        let at = points[label.point];
        let free = |placed: &Placed, taken: &[Placed]| {
            let area = grown(placed.area);
            let others = marks.iter().enumerate().filter(|(i, _)| *i != label.point);
            let crossed =
                |one: &Box| placed.leader.is_some_and(|leader| meets_segment(*one, leader));
            within(area, bounds)
                && marks.iter().all(|mark| !meet(area, *mark))
                && lines.iter().all(|line| !meets_segment(area, *line))
                && taken.iter().all(|other| {
                    let leader = other.leader.is_none_or(|leader| !meets_segment(area, leader));
                    !meet(area, other.area) && leader && !crossed(&other.area)
                })
                && others.map(|(_, mark)| mark).all(|mark| !crossed(mark))
        };
        let all = label.texts.iter().flat_map(|text| places(at, text, size));
        let found = all.into_iter().find(|placed| free(placed, &taken));
        taken.extend(found.clone());
        found
    };
    labels.iter().map(place_one).collect()
}

/// The places to try for a text beside a point.
fn places(at: [f64; 2], text: &str, size: f64) -> impl Iterator<Item = Placed> {
    let extent = [width(text, size), size];
    let ring = move |ring: f64| {
        (0..DIRECTIONS).map(move |i| {
            // From the right, alternately below and above.
            let turn = if i % 2 == 1 { i.div_ceil(2) } else { DIRECTIONS - i / 2 };
            let angle = TAU * turn as f64 / DIRECTIONS as f64;
            let away = [cos(angle), sin(angle)];
            let touch = [0, 1].map(|axis| at[axis] + ring * away[axis]);
            // The nearest place of the box is a corner, or the middle of a side.
            let start =
                [0, 1].map(|axis| touch[axis] - extent[axis] * (0.5 - 0.5 * sign(away[axis])));
            let area = [start[0], start[1], start[0] + extent[0], start[1] + extent[1]];
            Placed { area, text: text.to_owned(), leader: (ring > NEAR).then_some([at, touch]) }
        })
    };
    RINGS.into_iter().flat_map(ring)
}

/// -1, 0 or 1; 0 if the direction is nearly straight across.
fn sign(away: f64) -> f64 {
    if away > 0.2 {
        1.0
    } else if away < -0.2 {
        -1.0
    } else {
        0.0
    }
}

fn grown([l, t, r, b]: Box) -> Box {
    [l - 1.0, t - 1.0, r + 1.0, b + 1.0]
}

fn within([l, t, r, b]: Box, [left, top, right, bottom]: Box) -> bool {
    l >= left && t >= top && r <= right && b <= bottom
}

/// Whether two boxes share more than an edge.
#[must_use]
pub fn meet([l, t, r, b]: Box, [left, top, right, bottom]: Box) -> bool {
    l < right && left < r && t < bottom && top < b
}

/// Whether a line shares more than an edge with a box [Liang, Barsky 1984].
#[must_use]
pub fn meets_segment([l, t, r, b]: Box, [[x, y], [to_x, to_y]]: Segment) -> bool {
    let (dx, dy) = (to_x - x, to_y - y);
    let (mut from, mut to) = (0.0, 1.0);
    for (step, room) in [(-dx, x - l), (dx, r - x), (-dy, y - t), (dy, b - y)] {
        if step == 0.0 {
            if room <= 0.0 {
                return false;
            }
        } else if step < 0.0 {
            from = if room / step > from { room / step } else { from };
        } else {
            to = if room / step < to { room / step } else { to };
        }
    }
    from < to
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_line_meets_a_box_by_hand() {
        let area = [0.0, 0.0, 2.0, 1.0];
        assert!(meets_segment(area, [[-1.0, 0.5], [3.0, 0.5]]), "across");
        assert!(meets_segment(area, [[0.5, 0.5], [0.6, 0.6]]), "inside");
        assert!(meets_segment(area, [[-1.0, -1.0], [3.0, 2.0]]), "slanted");
        assert!(!meets_segment(area, [[-1.0, 1.5], [3.0, 1.5]]), "below");
        assert!(!meets_segment(area, [[-1.0, 0.5], [-0.1, 0.5]]), "ends before");
        assert!(!meets_segment(area, [[0.0, 1.0], [2.0, 1.0]]), "along an edge");
        assert!(!meets_segment(area, [[2.0, 2.0], [3.0, 0.5]]), "past a corner");
    }

    #[test]
    fn a_lone_label_is_to_the_right() {
        let labels = [Wanted { point: 0, texts: vec!["ewa".into()] }];
        let placed = place(&labels, 10.0, &[[50.0, 50.0]], &[], [0.0, 0.0, 200.0, 100.0]);
        let Placed { area, leader, .. } = placed[0].clone().unwrap();
        assert_eq!(area[..2], [59.0, 45.0]);
        assert_eq!(leader, None);
        let nowhere = place(&labels, 10.0, &[[50.0, 50.0]], &[], [45.0, 45.0, 60.0, 60.0]);
        assert_eq!(nowhere, [None]);
    }

    proptest! {
        #[test]
        fn nothing_collides(
            points in prop::collection::vec([20.0..480.0, 20.0..280.0], 1..40),
            line in [[0.0..500.0, 0.0..300.0], [0.0..500.0, 0.0..300.0]],
        ) {
            let labels: Vec<Wanted> =
                (0..points.len()).map(|point| Wanted { point, texts: vec![format!("label {point}")] }).collect();
            let bounds = [0.0, 0.0, 500.0, 300.0];
            let placed = place(&labels, 10.0, &points, &[line], bounds);
            prop_assert!(points.len() > 8 || placed.iter().any(Option::is_some));
            let placed: Vec<&Placed> = placed.iter().flatten().collect();
            for (i, one) in placed.iter().enumerate() {
                prop_assert!(within(one.area, bounds));
                prop_assert!(!meets_segment(one.area, line));
                for [x, y] in &points {
                    prop_assert!(!meet(one.area, [x - REACH, y - REACH, x + REACH, y + REACH]));
                }
                for other in placed.iter().take(i) {
                    prop_assert!(!meet(one.area, other.area));
                    for (leader, area) in [(one.leader, other.area), (other.leader, one.area)] {
                        prop_assert!(leader.is_none_or(|leader| !meets_segment(area, leader)));
                    }
                }
            }
        }
    }
}
