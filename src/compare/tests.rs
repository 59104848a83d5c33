//! The comparators give the known answer on known pairs.

use super::*;

/// Compares every plane with one tolerance.
fn compare(first: &Image, second: &Image, tolerance: Tolerance) -> Comparison {
    let criteria = Criteria { tolerance, ..Criteria::default() };
    super::compare(first, second, &criteria).unwrap()
}

fn image(width: u32, height: u32, channels: &[(&str, Values)]) -> Image {
    let channels = channels.iter().map(|(name, values)| ((*name).to_owned(), values.clone()));
    Image { width, height, channels: channels.collect(), text: None }
}

/// A 3 x 2 picture with one channel.
fn floats(values: [f32; 6]) -> Image {
    image(3, 2, &[("Z", Values::Float(values.into()))])
}

fn differences(report: &Comparison) -> Differences {
    match &report.channels[..] {
        [ChannelComparison { relation: Relation::Values(differences), .. }] => *differences,
        other => panic!("{other:?}"),
    }
}

const ULP: Tolerance = Tolerance { max_ulp: Some(1), max_abs: None, pixels: 0 };
const ABS: Tolerance = Tolerance { max_ulp: None, max_abs: Some(0.25), pixels: 0 };
const WIDE: Tolerance =
    Tolerance { max_ulp: Some(u32::MAX), max_abs: Some(f32::INFINITY), pixels: 0 };
const EXACT: Tolerance = Tolerance { max_ulp: None, max_abs: None, pixels: 0 };

#[test]
fn a_picture_equals_itself() {
    let a = floats([0.0, f32::NAN, f32::INFINITY, -1.0, 2.0, 3.0]);
    let report = compare(&a, &a, EXACT);
    assert_eq!(report.verdict(), Verdict::Equal);
    assert_eq!((differences(&report).nan, differences(&report).first), (1, None));
    assert_eq!(report.lines(), ["Z: equal, 1 pixels with NaN", "equal: all 1 planes, bit for bit"]);
}

#[test]
fn one_ulp_is_found_measured_and_tolerated_only_on_purpose() {
    let up = f32::from_bits(1.0_f32.to_bits() + 1);
    let a = floats([0.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    let b = floats([0.0, 0.0, 0.0, 0.0, up, 0.0]);
    let report = compare(&a, &b, EXACT);
    assert_eq!(report.verdict(), Verdict::Different);
    let found = differences(&report);
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
    assert_eq!(
        (
            differences(&report).differing,
            differences(&report).max_ulp,
            differences(&report).max_abs
        ),
        (6, 0, 0.0)
    );
    let none = Tolerance { max_ulp: Some(0), ..EXACT };
    assert_eq!(compare(&a, &b, none).verdict(), Verdict::Within);
    let tiny = f32::from_bits(1);
    let across = compare(&floats([tiny; 6]), &floats([-tiny; 6]), EXACT);
    assert_eq!(differences(&across).max_ulp, 2, "one step to zero from either side");
}

#[test]
fn nan_and_infinity_pass_no_tolerance() {
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
        let report = compare(&a, &b, WIDE);
        assert_eq!(report.verdict(), Verdict::Different, "{x} {y}");
        let found = differences(&report);
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
    assert_eq!(differences(&ends).max_ulp, 0xFF00_0000);
}

#[test]
fn either_bound_suffices_and_the_first_failure_is_shown() {
    let a = floats([1.0, 100.0, 1.0, 1.0, 1.0, 1.0]);
    let b = floats([1.25, f32::from_bits(100.0_f32.to_bits() + 1), 1.5, 1.0, 1.0, 3.0]);
    let both = Tolerance { max_ulp: Some(1), max_abs: Some(0.25), pixels: 0 };
    let report = compare(&a, &b, both);
    let found = differences(&report);
    assert_eq!((found.differing, found.failing), (4, 2));
    assert_eq!(found.first.unwrap().second, ChannelValue::Float(1.5), "the bound itself passes");
    assert_eq!(found.max_abs, 2.0);
    assert!(report.lines()[0].contains("2 beyond tolerance, first (2, 0)"));
    let loose = Tolerance { max_abs: Some(2.0), ..EXACT };
    assert_eq!(
        differences(&compare(&a, &b, loose)).first.unwrap().second,
        ChannelValue::Float(1.25)
    );
}

#[test]
fn indices_are_exact_whatever_the_tolerance() {
    let index = |values: [u32; 2]| image(2, 1, &[("id", Values::Index(values.into()))]);
    let report = compare(&index([5, 7]), &index([5, u32::MAX]), WIDE);
    assert_eq!(report.verdict(), Verdict::Different);
    assert_eq!(differences(&report).max_ulp, u32::MAX - 7);
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

#[test]
fn the_worst_pixel_is_named_beside_the_first() {
    let a = floats([1.0, 1.0, 1.0, 1.0, 1.0, 1.0]);
    let b = floats([1.0, 1.5, 1.0, 4.0, 1.25, -2.0]);
    let report = compare(&a, &b, EXACT);
    let found = differences(&report);
    let at = |pixel: Option<Difference>| pixel.map(|p| (p.x, p.y)).unwrap();
    assert_eq!((at(found.first), at(found.worst)), ((1, 0), (0, 1)), "of two the first");
    let line = &report.lines()[0];
    assert!(line.contains("first (1, 0): 1.0 (0x3f800000) against 1.5 (0x3fc00000), 4194304 ulp"));
    assert!(line.contains("; worst (0, 1): 1.0 (0x3f800000) against 4.0 (0x40800000), 16777216"));
    // Two pixels are beyond the tolerance, and the worst pixel of all is one of them.
    let loose = Tolerance { max_abs: Some(0.5), ..EXACT };
    let found = differences(&compare(&a, &b, loose));
    assert_eq!((at(found.first), at(found.worst), found.failing), ((0, 1), (0, 1), 2));
    let c = floats([1.0, 1.5, f32::INFINITY, f32::NAN, 1.0, 1.0]);
    assert_eq!(
        at(differences(&compare(&a, &c, EXACT)).worst),
        (2, 0),
        "a NaN is no worse than infinity"
    );
    let d = floats([9.0, f32::NAN, 1.0, 1.0, 1.0, 1.0]);
    assert_eq!(at(differences(&compare(&a, &d, EXACT)).worst), (1, 0));
}

#[test]
fn so_many_pixels_may_fail() {
    let index = |values: [u32; 4]| image(2, 2, &[("id", Values::Index(values.into()))]);
    let (a, b) = (index([1, 2, 3, 4]), index([1, 7, 3, u32::MAX]));
    for (pixels, verdict) in [(1, Verdict::Different), (2, Verdict::Within)] {
        let report = compare(&a, &b, Tolerance { pixels, ..EXACT });
        assert_eq!(report.verdict(), verdict);
        let says = report.lines()[0].contains("2 beyond tolerance where 2 may be, first (1, 0)");
        assert_eq!(says, pixels == 2, "{:?}", report.lines());
    }
    // For floats, `first` and `worst` are among the pixels beyond the bounds.
    let (a, b) = (floats([1.0; 6]), floats([1.0, 1.25, f32::NAN, 1.0, 1.0, 1.0]));
    let tolerance = Tolerance { pixels: 1, ..ABS };
    assert_eq!(compare(&a, &b, tolerance).verdict(), Verdict::Within);
}

#[test]
fn a_tolerance_holds_for_the_planes_that_it_names() {
    let float = |value| Values::Float(vec![value; 2]);
    let ids = |value| Values::Index(vec![value; 2]);
    let all = |z, n, id| {
        let channels = [("Z", float(z)), ("id", ids(id))];
        let normal = ["n.X", "n.Y", "n.Z"].map(|name| (name, float(n)));
        image(2, 1, &[&channels[..], &normal].concat())
    };
    let (a, b) = (all(1.0, 0.0, 3), all(1.25, 0.25, 4));
    let named = |name: &str, tolerance| (name.to_owned(), tolerance);
    let two = Tolerance { pixels: 2, ..EXACT };
    let mut criteria = Criteria {
        tolerance: ABS,
        named: vec![
            named("id", two),
            named("n", EXACT),
            named("n.X", ABS),
            named("n.X", EXACT),
            named("n.Y", two),
        ],
        ..Criteria::default()
    };
    let verdicts = |criteria: &Criteria| -> Vec<Verdict> {
        let found = super::compare(&a, &b, criteria).unwrap();
        found.channels.iter().filter_map(ChannelComparison::verdict).collect()
    };
    let (within, different) = (Verdict::Within, Verdict::Different);
    // Z, id, n.X, n.Y, n.Z: the last name that selects a channel holds.
    assert_eq!(verdicts(&criteria), [within, within, different, within, different]);
    criteria.planes = Some(vec!["id".into(), "Z".into()]);
    assert_eq!(verdicts(&criteria), [within; 2]);
}

#[test]
fn what_is_misspelt_is_refused_and_observations_may_be_missing() {
    let float = || Values::Float(vec![0.0; 2]);
    let a = image(2, 1, &[("Z", float()), ("group00.margin", float()), ("weight", float())]);
    let b = image(2, 1, &[("Z", float())]);
    let planes = |names: &[&str]| Some(names.iter().map(|name| (*name).to_owned()).collect());
    let wrong = Criteria { planes: planes(&["Z", "z"]), ..Criteria::default() };
    let line = super::compare(&a, &b, &wrong).unwrap_err().to_string();
    assert_eq!(
        line,
        "no plane of the reference is called `z`; there are: Z, group00.margin, weight"
    );
    let wrong = Criteria { named: vec![("depth".into(), EXACT)], ..Criteria::default() };
    let line = super::compare(&a, &b, &wrong).unwrap_err().to_string();
    assert!(line.starts_with("no plane of either picture is called `depth`; there are"), "{line}");

    let lines = |criteria: &Criteria| super::compare(&a, &b, criteria).unwrap().lines();
    let skip = Criteria { skip_observations: true, ..Criteria::default() };
    assert_eq!(
        lines(&skip),
        [
            "Z: equal",
            "group00.margin: not compared, an observation of the first file",
            "weight: only in the first file",
            "different: 1 of 2 planes differ"
        ]
    );
    assert_eq!(lines(&Criteria::default()).last().unwrap(), "different: 2 of 3 planes differ");
    let backwards = super::compare(&b, &a, &skip).unwrap().lines();
    assert_eq!(backwards[1], "group00.margin: only in the second file", "of the reference alone");
    let chosen = Criteria { planes: planes(&["Z", "*.margin"]), ..skip };
    assert!(super::compare(&a, &b, &chosen).is_err(), "a star stands at the end alone");
    let chosen = Criteria { planes: planes(&["Z", "group*"]), ..chosen };
    assert_eq!(lines(&chosen).last().unwrap(), "equal: all 1 planes, bit for bit");
}
