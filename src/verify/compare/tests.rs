//! Comparators held to pairs whose answer is known.

use super::*;

fn image(width: u32, height: u32, channels: &[(&str, Values)]) -> Image {
    let channels = channels.iter().map(|(name, values)| ((*name).to_owned(), values.clone()));
    Image { width, height, channels: channels.collect(), text: None }
}

/// A 3 x 2 picture of one channel.
fn floats(values: [f32; 6]) -> Image {
    image(3, 2, &[("Z", Values::Float(values.into()))])
}

fn of(report: &Report) -> Differences {
    match &report.planes[..] {
        [PlaneReport { finding: Finding::Values(differences), .. }] => *differences,
        other => panic!("{other:?}"),
    }
}

const ULP: Tolerance = Tolerance { max_ulp: Some(1), max_abs: None };
const ABS: Tolerance = Tolerance { max_ulp: None, max_abs: Some(0.25) };
const EXACT: Tolerance = Tolerance { max_ulp: None, max_abs: None };

#[test]
fn a_picture_equals_itself() {
    let a = floats([0.0, f32::NAN, f32::INFINITY, -1.0, 2.0, 3.0]);
    let report = compare(&a, &a, EXACT);
    assert_eq!(report.verdict(), Verdict::Equal);
    assert_eq!((of(&report).nan, of(&report).first), (1, None));
    assert_eq!(report.lines(), ["Z: equal, 1 pixels with NaN", "equal: all 1 planes, bit for bit"]);
}

#[test]
fn one_ulp_is_found_measured_and_tolerated_only_on_purpose() {
    let up = f32::from_bits(1.0_f32.to_bits() + 1);
    let a = floats([0.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    let b = floats([0.0, 0.0, 0.0, 0.0, up, 0.0]);
    let report = compare(&a, &b, EXACT);
    assert_eq!(report.verdict(), Verdict::Different);
    let found = of(&report);
    let first = found.first.unwrap();
    assert_eq!((first.x, first.y, first.ulps()), (1, 1, Some(1)));
    assert_eq!((found.pixels, found.differing, found.failing, found.max_ulp), (6, 1, 1, 1));
    let epsilon = f64::from(f32::EPSILON);
    assert_eq!(found.max_abs, epsilon);
    assert!((found.rms - epsilon / 6.0_f64.sqrt()).abs() < 1e-20);
    assert_eq!(
        report.lines(),
        [
            "Z: 1 of 6 pixels differ, first (1, 1): 1.0 (0x3f800000) against 1.0000001 (0x3f800001), \
         1 ulp; at most 1 ulp, 1.192e-7; RMS 4.867e-8",
            "different: 1 of 1 planes differ"
        ]
    );
    for tolerance in [ULP, ABS] {
        let report = compare(&a, &b, tolerance);
        assert_eq!(report.verdict(), Verdict::Within);
        assert_eq!(report.lines()[1], "within tolerance: 1 of 1 planes differ");
    }
    assert_eq!(
        compare(&a, &b, Tolerance { max_ulp: Some(0), ..EXACT }).verdict(),
        Verdict::Different
    );
}

#[test]
fn zeros_of_either_sign_differ_in_bits_and_by_no_ulp() {
    let (a, b) = (floats([0.0; 6]), floats([-0.0; 6]));
    let report = compare(&a, &b, EXACT);
    assert_eq!(report.verdict(), Verdict::Different);
    assert_eq!((of(&report).differing, of(&report).max_ulp, of(&report).max_abs), (6, 0, 0.0));
    let none = Tolerance { max_ulp: Some(0), ..EXACT };
    assert_eq!(compare(&a, &b, none).verdict(), Verdict::Within);
    let tiny = f32::from_bits(1);
    let across = compare(&floats([tiny; 6]), &floats([-tiny; 6]), EXACT);
    assert_eq!(of(&across).max_ulp, 2, "one step to zero from either side");
}

#[test]
fn nan_and_infinity_pass_no_tolerance() {
    let wide = Tolerance { max_ulp: Some(u32::MAX), max_abs: Some(f32::INFINITY) };
    let other_nan = f32::from_bits(f32::NAN.to_bits() | 1);
    let pairs = [
        (f32::NAN, 1.0),
        (1.0, f32::NAN),
        (f32::NAN, other_nan),
        (f32::INFINITY, f32::MAX),
        (f32::INFINITY, f32::NEG_INFINITY),
    ];
    for (x, y) in pairs {
        let (a, b) = (floats([0.5, 0.5, x, 0.5, 0.5, 0.5]), floats([0.5, 0.5, y, 0.5, 0.5, 0.5]));
        let report = compare(&a, &b, wide);
        assert_eq!(report.verdict(), Verdict::Different, "{x} {y}");
        let found = of(&report);
        assert_eq!((found.failing, found.first.unwrap().x), (1, 2), "{x} {y}");
        if x.is_nan() || y.is_nan() {
            assert_eq!((found.nan, found.first.unwrap().ulps()), (1, None));
            assert_eq!((found.max_ulp, found.max_abs, found.rms), (0, 0.0, 0.0));
            assert!(report.lines()[0].contains("1 pixels with NaN"), "{:?}", report.lines());
        } else {
            assert_eq!(found.max_abs, f64::INFINITY);
        }
    }
    let ends = compare(&floats([f32::INFINITY; 6]), &floats([f32::NEG_INFINITY; 6]), EXACT);
    assert_eq!(of(&ends).max_ulp, 0xFF00_0000);
}

#[test]
fn either_bound_suffices_and_the_first_failure_is_shown() {
    let a = floats([1.0, 100.0, 1.0, 1.0, 1.0, 1.0]);
    let b = floats([1.25, f32::from_bits(100.0_f32.to_bits() + 1), 1.5, 1.0, 1.0, 3.0]);
    let both = Tolerance { max_ulp: Some(1), max_abs: Some(0.25) };
    let report = compare(&a, &b, both);
    let found = of(&report);
    assert_eq!((found.differing, found.failing), (4, 2));
    assert_eq!(found.first.unwrap().second, Value::Float(1.5), "the bound itself passes");
    assert_eq!(found.max_abs, 2.0);
    assert!(report.lines()[0].contains("2 beyond tolerance, first (2, 0)"));
    let loose = Tolerance { max_abs: Some(2.0), ..EXACT };
    assert_eq!(of(&compare(&a, &b, loose)).first.unwrap().second, Value::Float(1.25));
}

#[test]
fn indices_are_exact_whatever_the_tolerance() {
    let index = |values: [u32; 2]| image(2, 1, &[("id", Values::Index(values.into()))]);
    let wide = Tolerance { max_ulp: Some(u32::MAX), max_abs: Some(f32::INFINITY) };
    let report = compare(&index([5, 7]), &index([5, u32::MAX]), wide);
    assert_eq!(report.verdict(), Verdict::Different);
    assert_eq!(of(&report).max_ulp, u32::MAX - 7);
    let line = &report.lines()[0];
    assert!(line.contains("(1, 0): 7 (0x00000007) against 4294967295 (0xffffffff)"), "{line}");
}

#[test]
fn planes_types_and_sizes_must_match() {
    let float = || Values::Float(vec![0.0; 2]);
    let a = image(2, 1, &[("A", float()), ("B", float()), ("D", float())]);
    let b = image(2, 1, &[("B", float()), ("C", float()), ("D", Values::Index(vec![0; 2]))]);
    let report = compare(&a, &b, EXACT);
    assert_eq!(report.verdict(), Verdict::Different);
    assert_eq!(
        report.lines(),
        [
            "A: only in the first file",
            "B: equal",
            "C: only in the second file",
            "D: floats in one file, indices in the other",
            "different: 3 of 4 planes differ"
        ]
    );
    let turned = image(1, 2, &[("A", float()), ("B", float()), ("D", float())]);
    let report = compare(&a, &turned, EXACT);
    assert_eq!(report.verdict(), Verdict::Different);
    assert_eq!(report.lines(), ["different: 2 x 1 against 1 x 2 pixels"]);
}
