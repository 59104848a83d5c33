use super::super::tests::{pattern, ramp};
use super::*;
use crate::number::Real;
use crate::number::random::unit;

type Picture = Plane<[f32; 3]>;

fn disc(x: u32, y: u32) -> f32 {
    let (dx, dy) = (f64::from(x) - 9.0, f64::from(y) - 7.0);
    if dx * dx + dy * dy < 40.0 { 0.75 } else { 0.0625 }
}

/// The pairs of `tests/data/flip.py`.
fn pair(name: &str, width: u32, height: u32) -> [Picture; 2] {
    let ramp = |x: u32, y: u32| ramp(x as usize, y as usize);
    let pattern = |x: u32, y: u32| pattern(x as usize, y as usize);
    let shifted = |x, y| [ramp(x, y), pattern(x, y), disc(x, y)];
    let of = |color: &dyn Fn(u32, u32) -> [f32; 3]| Plane::from_pixels([width, height], color);
    match name {
        "shifted" => [of(&shifted), of(&|x, y| shifted(x + 1, y))],
        "edge" => [of(&|x, y| [disc(x, y); 3]), of(&|x, y| [disc(x, y + 3); 3])],
        "colour" => {
            [of(&|x, y| [ramp(x, y), disc(x, y), 0.5]), of(&|x, y| [disc(x, y), 0.25, ramp(x, y)])]
        }
        "faint" => [of(&|_, _| [0.5; 3]), of(&|x, y| [0.5 + pattern(x, y) / 16.0; 3])],
        _ => [of(&|_, _| [0.0, 1.0, 0.0]), of(&|_, _| [0.0, 0.0, 1.0])],
    }
}

fn run(a: &Picture, b: &Picture) -> Flip {
    flip(a, b, PIXELS_PER_DEGREE, &Exec::sequential()).unwrap()
}

/// Printed by `tests/data/flip.py`: flip-evaluator 1.7, which is f32. Each row has the mean, then
/// FLIP of the first pixel, one in the middle, and the last.
#[test]
fn the_published_implementation_agrees() {
    let references = [
        ("shifted", 64, 48, 67.0, [0.220592, 0.532001, 0.094035, 0.106061]),
        ("edge", 64, 48, 67.0, [0.040606, 0.028013, 0.000000, 0.000000]),
        ("colour", 64, 48, 67.0, [0.819715, 0.964212, 0.763223, 0.814443]),
        ("faint", 64, 48, 67.0, [0.101794, 0.024554, 0.101007, 0.129192]),
        ("farthest", 64, 48, 67.0, [1.000000, 1.000000, 1.000000, 1.000000]),
        ("shifted", 23, 17, 67.0, [0.283615, 0.532001, 0.129216, 0.465283]),
        ("edge", 23, 17, 67.0, [0.318534, 0.028013, 0.283593, 0.000000]),
        ("colour", 23, 17, 67.0, [0.873256, 0.964212, 0.973575, 0.768770]),
        ("faint", 23, 17, 67.0, [0.102694, 0.024554, 0.099006, 0.108623]),
        ("farthest", 23, 17, 67.0, [1.000000, 1.000000, 1.000000, 1.000000]),
        ("shifted", 40, 30, 25.0, [0.682987, 0.508259, 0.394933, 0.850752]),
        ("edge", 40, 30, 25.0, [0.080701, 0.000000, 0.000000, 0.000000]),
        ("colour", 40, 30, 25.0, [0.815612, 0.959632, 0.823276, 0.772484]),
        ("faint", 40, 30, 25.0, [0.109032, 0.003406, 0.148746, 0.094990]),
        ("farthest", 40, 30, 25.0, [1.000000, 1.000000, 1.000000, 1.000000]),
        ("shifted", 5, 3, 67.0, [0.678835, 0.585311, 0.659856, 0.713210]),
        ("edge", 5, 3, 67.0, [0.453000, 0.017417, 0.181716, 0.942962]),
        ("colour", 5, 3, 67.0, [0.958366, 0.959498, 0.959008, 0.957005]),
        ("faint", 5, 3, 67.0, [0.076958, 0.023527, 0.052326, 0.128988]),
        ("farthest", 5, 3, 67.0, [1.000000, 1.000000, 1.000000, 1.000000]),
    ];
    for (name, width, height, pixels_per_degree, expected) in references {
        let [a, b] = pair(name, width, height);
        let found = flip(&a, &b, pixels_per_degree, &Exec::sequential()).unwrap();
        let at = |x, y| f64::from(*found.map.at(x, y));
        let [last_x, last_y] = [width - 1, height - 1];
        let numbers = [found.mean, at(0, 0), at(width / 3, height / 2), at(last_x, last_y)];
        for (number, expected) in numbers.into_iter().zip(expected) {
            let off: f64 = number - expected;
            assert!(off.abs() < 1e-5, "{name} {width} {pixels_per_degree}: {numbers:?}");
        }
        let swapped = flip(&b, &a, pixels_per_degree, &Exec::new(2, 8).unwrap()).unwrap();
        assert_eq!(swapped, found, "symmetric, and of any threads");
    }
}

/// Values that a display clips give the same FLIP as the clipped values.
#[test]
fn a_picture_is_clipped_as_a_display_clips_it() {
    let wide: Picture = Plane::from_pixels([90, 70], |x, y| {
        [0, 1, 2].map(|c| 3.0 * unit(c, u64::from(y * 90 + x)) - 1.0)
    });
    let clipped = wide.map(|v| v.map(|c| c.clamped(0.0, 1.0)));
    assert_eq!(run(&wide, &clipped).mean, 0.0);
    let gray = Plane::filled(90, 70, [0.5; 3]);
    assert_eq!(run(&wide, &gray), run(&clipped, &gray));
    let (low, high) = (f32::NEG_INFINITY, f32::INFINITY);
    let infinite = Plane::from_values(2, 1, vec![[low, high, 0.5], [high, low, low]]);
    let clipped = Plane::from_values(2, 1, vec![[0.0, 1.0, 0.5], [1.0, 0.0, 0.0]]);
    assert_eq!(run(&infinite, &clipped).mean, 0.0);
}

/// The rows of a band see the rows of other bands. Mirrored pictures have the mirrored map.
#[test]
fn bands_do_not_show_and_neither_side_is_preferred() {
    let [a, b] = pair("shifted", 40, 150);
    let mirrored = |p: &Picture| Plane::from_pixels([40, 150], |x, y| *p.at(39 - x, 149 - y));
    let (found, mirror) = (run(&a, &b), run(&mirrored(&a), &mirrored(&b)));
    for y in 0..150 {
        for x in 0..40 {
            let off = found.map.at(x, y) - mirror.map.at(39 - x, 149 - y);
            assert!(off.abs() < 1e-6, "({x}, {y})");
        }
    }
    // If all rows of both pictures are alike, so are the rows of the map.
    let flat = |p: &Picture| Plane::from_pixels([40, 150], |x, _| *p.at(x, 0));
    let found = run(&flat(&a), &flat(&b)).map;
    assert!((1..150).all(|y| (0..40).all(|x| found.at(x, y) == found.at(x, 0))));
}

#[test]
fn more_of_a_difference_is_seen_as_more() {
    let [a, b] = pair("edge", 40, 30);
    let mut last = 0.0;
    for part in [0.0625, 0.125, 0.25, 0.5, 1.0] {
        let mixed = Plane::from_pixels([40, 30], |x, y| {
            [0, 1, 2].map(|c| a.at(x, y)[c] + part * (b.at(x, y)[c] - a.at(x, y)[c]))
        });
        let Flip { mean, map } = run(&mixed, &a);
        assert!(mean > last, "{part}: {mean} after {last}");
        assert!(map.values().iter().all(|v| (0.0..=1.0).contains(v)));
        last = mean;
    }
}

#[test]
fn what_has_no_flip() {
    let exec = Exec::sequential();
    let [a, b] = [Plane::filled(4, 3, [0.5; 3]), Plane::filled(3, 4, [0.5; 3])];
    let said = flip(&a, &b, 67.0, &exec).unwrap_err().to_string();
    assert!(said.contains("4 x 3 pixels and a reference of 3 x 4"), "{said}");
    for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(flip(&a, &a, wrong, &exec).is_err());
    }
    let none = Plane::filled(0, 0, [0.0; 3]);
    assert!(flip(&none, &none, 67.0, &exec).unwrap().mean.is_nan());
    let mut one_nan = Plane::filled(40, 3, [0.5; 3]);
    let gray = one_nan.clone();
    one_nan.values_mut()[0] = [f32::NAN; 3];
    let found = run(&one_nan, &gray);
    assert!(found.mean.is_nan() && found.map.at(0, 0).is_nan());
    assert_eq!(*found.map.at(39, 2), 0.0, "beyond the filter");
}
