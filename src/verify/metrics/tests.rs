use super::ssim::C1;
use super::*;

fn plane(width: usize, height: usize, of: impl Fn(usize, usize) -> f32) -> Vec<f32> {
    (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| of(x, y)).collect()
}

fn pattern(x: usize, y: usize) -> f32 {
    ((x * x * 7 + y * 13 + x * y * 3) % 256) as f32 / 256.0
}

fn ramp(x: usize, y: usize) -> f32 {
    ((x * 4 + y * 2) % 256) as f32 / 256.0
}

fn noisy(x: usize, y: usize) -> f32 {
    0.75 * ramp(x, y) + ((x * 31 + y * 17) % 64) as f32 / 256.0
}

/// Printed by `tests/data/ssim.py`: scikit-image 0.26.0, which it first holds against the
/// definition; RMSE, PSNR, SSIM of shifted, noisy and other patterns.
#[test]
fn the_published_implementation_agrees() {
    let references = [
        (64, 48, 0, [0.12401959270615269, 18.130193985141926, 0.8939135771776123]),
        (64, 48, 1, [0.10200910919004928, 19.827220899206058, 0.3467302549767385]),
        (64, 48, 2, [0.4047306700550418, 7.856677679849904, 0.006799754254667338]),
        (11, 11, 0, [0.015625, 36.12359947967774, 0.9922426258401237]),
        (11, 11, 1, [0.11809263799334681, 18.555543517420446, 0.2673579220730217]),
        (11, 11, 2, [0.43176283778303237, 7.295094810221422, -0.0034520839930268993]),
        (37, 12, 0, [0.015625, 36.12359947967774, 0.9981501638224874]),
        (37, 12, 1, [0.09377941323150962, 20.557849778523632, 0.2643361860724498]),
        (37, 12, 2, [0.35852509711643926, 8.909608757653997, 0.010594669017081988]),
    ];
    for (width, height, pair, [expected_rmse, expected_psnr, expected_ssim]) in references {
        let (a, b) = match pair {
            0 => (plane(width, height, ramp), plane(width, height, |x, y| ramp(x + 1, y))),
            1 => (plane(width, height, ramp), plane(width, height, noisy)),
            _ => (plane(width, height, pattern), plane(width, height, ramp)),
        };
        let near = |found: f64, expected: f64| (found - expected).abs() < 1e-12;
        let found = rmse(&a, &b);
        assert!(near(found, expected_rmse), "{width} {pair}: {found}");
        assert!(near(psnr(found), expected_psnr), "{width} {pair}: {}", psnr(found));
        let found = ssim(&a, &b, width).unwrap();
        assert!(near(found, expected_ssim), "{width} {pair}: {found}");
        assert_eq!(ssim(&b, &a, width), Some(found), "symmetric");
    }
}

#[test]
fn known_answers() {
    let a = plane(20, 15, pattern);
    assert_eq!(ssim(&a, &a, 20), Some(1.0), "with itself");
    assert_eq!(rmse(&a, &a), 0.0);
    assert_eq!(psnr(0.0), f64::INFINITY);
    assert!((psnr(0.1) - 20.0).abs() < 1e-12);
    // Of two constants the second factor is C2 / C2.
    let (p, q) = (0.25_f64, 0.75_f64);
    let found = ssim(&[0.25; 169], &[0.75; 169], 13).unwrap();
    assert!((found - (2.0 * p * q + C1) / (p * p + q * q + C1)).abs() < 1e-12);
    assert_eq!(rmse(&[0.25; 169], &[0.75; 169]), 0.5);
    // Too small in one direction, or empty.
    assert_eq!(ssim(&[0.0; 110], &[0.0; 110], 10), None);
    assert_eq!(ssim(&[0.0; 110], &[0.0; 110], 11), None);
    assert_eq!(ssim(&[], &[], 0), None);
    assert!(rmse(&[1.0, f32::NAN], &[1.0, 1.0]).is_nan());
}

#[test]
fn the_summary_is_of_the_three_colours() {
    let channel = |name: &str, values: Vec<f32>| (name.to_owned(), Values::Float(values));
    let image = |blue: Vec<f32>| Image {
        width: 16,
        height: 12,
        channels: vec![
            channel("B", blue),
            channel("G", plane(16, 12, pattern)),
            channel("R", plane(16, 12, ramp)),
        ],
        text: None,
    };
    let (a, b) = (image(vec![0.25; 192]), image(vec![0.75; 192]));
    let found = summary(&a, &b).unwrap();
    assert!((found.rmse - (0.25_f64 / 3.0).sqrt()).abs() < 1e-15, "{}", found.rmse);
    let blue = ssim(&[0.25; 192], &[0.75; 192], 16).unwrap();
    assert!((found.ssim.unwrap() - (2.0 + blue) / 3.0).abs() < 1e-15);
    let same = summary(&a, &a).unwrap();
    assert_eq!(same, Summary { rmse: 0.0, psnr: f64::INFINITY, ssim: Some(1.0) });
    let mut gray = a.clone();
    gray.channels.remove(0);
    assert_eq!(summary(&a, &gray), None);
}

#[test]
fn regions_of_a_drawing() {
    let drawing = ["......", ".###..", ".###..", ".###.#", "....##"];
    // i interior, e edge, x exterior; the corner has no neighbours beyond the picture.
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
