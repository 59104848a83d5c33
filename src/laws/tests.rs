//! The crate's operators keep every law, and each law catches an operator that breaks it.

use super::*;
use crate::composite::bins::{DepthBins, Range};
use crate::composite::groups::{WeightedFragment, compose};
use crate::composite::mean::Mean;
use crate::composite::over::Blend;
use crate::composite::sum;
use crate::composite::under::Under;
use crate::number::Real;

/// Asserts that the operator broke this law, and that the line has all a person needs.
fn breaks(found: Lawful, law: &str) {
    let counterexample = found.expect_err(law);
    assert!(counterexample.law.contains(law), "{counterexample}");
    let line = counterexample.to_string();
    for part in [" (", "): of ", ": expected ", ", found "] {
        assert!(line.contains(part) && !line.contains('\n'), "{line}");
    }
}

fn keeps_every_law<R: Exact>() {
    let all = [
        epsilon(&|t: R, nearest, epsilon| t <= nearest + epsilon),
        sums::<R>(&sum::add, &sum::average),
        over(&|below: Blend<R>, alpha, color| below.over(alpha, color)),
        under(&|above: Under<R>, alpha, color| above.under(alpha, color)),
        bins(&|range, t: R| DepthBins::new(range).bin(t), &|range, t, ratio| {
            DepthBins::new(range).voronoi(t, ratio)
        }),
        groups::<R>(&compose),
        means(&|takes, weights, a: [R; 4]| Mean::new(takes, weights).average(a)),
    ];
    for found in all {
        assert_eq!(found, Ok(()), "{}", found.clone().unwrap_err());
    }
}

#[test]
fn the_operators_of_the_crate_keep_every_law() {
    keeps_every_law::<f32>();
    keeps_every_law::<f64>();
}

/// Blends as b + a (c - b).
fn lerped(below: Blend<f32>, a: f32, color: [f32; 3]) -> Blend<f32> {
    let mix = |below: f32, c: f32| below + a * (c - below);
    let [r, g, b] = [0, 1, 2].map(|i| mix(below.color[i], color[i]));
    Blend { color: [r, g, b], alpha: mix(below.alpha, 1.0) }
}

/// Adds from front to back, whatever the colour of a layer of opacity 0 is.
fn plain_under(above: Under<f32>, a: f32, color: [f32; 3]) -> Under<f32> {
    let color = sum::add(above.color, above.through * a, color);
    Under { color, ..above.under(a, [0.0; 3]) }
}

#[test]
fn lawful_operators_break_laws_that_can_be_left_out_alone() {
    let found = over(&lerped).unwrap_err();
    assert_eq!((found.kind, found.law), (Kind::Exact, "an opaque layer hides what is below"));
    assert_eq!(over::of_kinds(&[Kind::Algebraic, Kind::Odd], &lerped), Ok(()));
    let found = under(&plain_under).unwrap_err();
    let law = "a clear layer of an infinite colour changes nothing";
    assert_eq!((found.kind, found.law), (Kind::Odd, law));
    assert_eq!(under::of_kinds(&[Kind::Algebraic, Kind::Exact], &plain_under), Ok(()));
    // An epsilon-z test by a difference, and sums in another order.
    let difference = |t: f32, nearest: f32, e: f32| t - nearest <= e;
    assert_eq!(epsilon(&difference).unwrap_err().kind, Kind::Exact);
    assert_eq!(epsilon::of_kinds(&[Kind::Algebraic, Kind::Odd], &difference), Ok(()));
    let reversed = |samples: &[WeightedFragment<f32>], epsilon: f32| {
        let samples: Vec<_> = samples.iter().rev().copied().collect();
        compose(&samples, epsilon)
    };
    assert_eq!(groups(&reversed).unwrap_err().kind, Kind::Exact);
    assert_eq!(groups::of_kinds(&[Kind::Algebraic], &reversed), Ok(()));
    // A quotient by a reciprocal, and a mean without bounds.
    let reciprocal =
        |s: [f32; 3], w: f32| s.map(|s| if w > 0.0 { s * (1.0 / w) + 0.0 } else { 0.0 });
    assert_eq!(sums(&sum::add, &reciprocal).unwrap_err().kind, Kind::Exact);
    assert_eq!(sums::of_kinds(&[Kind::Algebraic], &sum::add, &reciprocal), Ok(()));
}

/// Wrong operators break algebraic laws, so that they are found without the others too.
#[test]
fn wrong_operators_break_algebraic_laws() {
    let only = &[Kind::Algebraic];
    let of = |op: fn(f32, f32, f32) -> bool| epsilon::of_kinds(only, &op);
    let wrong = [
        of(|t, nearest, e| t < nearest + e),
        of(|t, nearest, e| t <= nearest + 1.001 * e),
        of(|t, nearest, e| t <= nearest * (1.0 + e)),
        of(|t, nearest, e| (t - nearest).abs() <= e),
        of(|_, _, _| true),
    ];
    assert!(wrong.iter().all(Result::is_err), "{wrong:?}");
    type Over = fn(Blend<f32>, f32, [f32; 3]) -> Blend<f32>;
    let of = |op: Over| over::of_kinds(only, &op);
    let wrong = [
        of(|below, a, color| Blend { color, ..below.over(a, color) }),
        of(|below, a, color| below.over(a * a, color)),
        of(|below, a, color| Blend { alpha: below.alpha.at_least(a), ..below.over(a, color) }),
        of(|below, a, color| below.over((a * 255.0).floor() / 255.0, color)),
    ];
    assert!(wrong.iter().all(Result::is_err), "{wrong:?}");
    type Front = fn(Under<f32>, f32, [f32; 3]) -> Under<f32>;
    let of = |op: Front| under::of_kinds(only, &op);
    let wrong = [
        of(|above, a, color| above.under(a, color.map(|c| c * a))),
        of(|above, a, color| Under { through: above.through - a, ..above.under(a, color) }),
        of(|above, a, color| if above.alpha > 0.99 { above } else { above.under(a, color) }),
    ];
    assert!(wrong.iter().all(Result::is_err), "{wrong:?}");
}

#[test]
fn a_counterexample_is_as_simple_as_can_be_found() {
    let found = over(&|below: Blend<f32>, a, color| Blend { color, ..below.over(a, color) });
    let found = found.unwrap_err();
    // One layer that is not opaque is enough.
    assert_eq!(found.inputs, "[(0.0, [2.0, 0.0, 0.0])]", "{found}");
    let again = over(&|below: Blend<f32>, a, color| Blend { color, ..below.over(a, color) });
    assert_eq!(again.unwrap_err(), found, "the search is deterministic");
    // Few digits: without shrinking each of these numbers has eight.
    let strict = epsilon(&|t: f32, nearest, epsilon| t < nearest + epsilon).unwrap_err();
    assert!(strict.inputs.len() < 50, "{strict}");
    let twice = epsilon(&|t: f32, nearest, epsilon| t <= nearest + 2.0 * epsilon).unwrap_err();
    assert!(twice.inputs.len() < 50, "{twice}");
    let reversed = |samples: &[WeightedFragment<f32>], epsilon: f32| {
        let samples: Vec<_> = samples.iter().rev().copied().collect();
        compose(&samples, epsilon)
    };
    let found = groups(&reversed).unwrap_err();
    // A sum of two is the same in both orders.
    let samples = found.inputs.matches("WeightedFragment").count();
    assert!((3..6).contains(&samples), "{found}");
}

#[test]
fn a_broken_epsilon_test_is_caught() {
    let of = |op: fn(f32, f32, f32) -> bool| epsilon(&op);
    breaks(of(|t, nearest, e| t < nearest + e), "the nearest fragment is visible");
    breaks(of(|t, nearest, e| t - nearest <= e), "the limit is nearest + epsilon, and visible");
    // Each law alone.
    type Test = fn(f32, f32, f32) -> bool;
    let at = |t, nearest, bands, op: Test| epsilon::case(&op, t, nearest, bands);
    let found = at(1.0, 1.0, [0.0; 2], |t, nearest, e| t < nearest + e);
    breaks(found, "the nearest fragment is visible");
    let bounded: Test = |t, nearest, e| t <= nearest + e.at_most(1e9);
    breaks(epsilon::infinite(&bounded, 1e30, 1.0), "an infinite epsilon keeps everything");
    let wide: Test = |t, nearest, e| t <= nearest + e + 1e-6;
    breaks(epsilon::limit(&wide, 1.000_000_5, 1.0, 0.0), "epsilon = 0 keeps the nearest");
    let strict: Test = |t, nearest, e| t < nearest + e || t == nearest;
    breaks(epsilon::limit(&strict, 2.0, 1.0, 1.0), "the limit is nearest + epsilon, and visible");
    let found = at(2.0, 1.0, [2.0, 4.0], |t, nearest, e| t <= nearest + e && e != 4.0 || t == 1.0);
    breaks(found, "a greater epsilon keeps");
    let behind: Test = |t, nearest, e| nearest <= t && t <= nearest + e || e == f32::INFINITY;
    breaks(at(1.0, 2.0, [1.0; 2], behind), "what is nearer than a visible fragment");
    let found = at(2.5, 1.0, [1.0; 2], |t, nearest, e| t <= nearest + 2.0 * e);
    breaks(found, "the limit is nearest + epsilon, up to rounding");
}

#[test]
fn broken_sums_are_caught() {
    type Average = fn([f32; 3], f32) -> [f32; 3];
    let of = |average: Average| sums(&sum::add, &average);
    let unweighted = |sum, _, value| sum::plus(sum, value);
    breaks(sums::<f32>(&unweighted, &sum::average), "the average of a constant is");
    breaks(sums::<f32>(&|_, w, v| v.map(|v| w * v), &sum::average), "the average of a constant is");
    breaks(
        of(|s, w| s.map(|s| if w > 0.0 { s * (1.0 / w) + 0.0 } else { 0.0 })),
        "the average of 1 is 1",
    );
    breaks(of(|s, w| s.map(|s| s / w + 0.0)), "without weight the average is 0");
    breaks(of(|s, w| s.map(|s| if w > 0.0 { s / w } else { 0.0 })), "the average of -0");
    let finite =
        |s: [f32; 3], w: f32| if w > 0.0 { sum::average(s, w) } else { s.map(|s| s * 0.0) };
    breaks(sums(&sum::add, &finite), "without weight an infinite sum");
    // A bias that keeps quotients finite, where not all values are 1.
    let biased = |s: [f32; 3], w: f32| match s[0] == w {
        true => sum::average(s, w),
        false => s.map(|s| s / (w + 1e-9)),
    };
    let (weights, value) = ([0.004; 2], [0.5, 2.0, 1.0]);
    assert_eq!(sums::bits(&sum::add, &sum::average, &weights, value), Ok(()));
    breaks(sums::bits(&sum::add, &biased, &weights, value), "1024 times");
}

#[test]
fn broken_blending_is_caught() {
    let of = |op: fn(Blend<f32>, f32, [f32; 3]) -> Blend<f32>| over(&op);
    breaks(
        of(|below, alpha, color| Blend { alpha: below.alpha + alpha, ..below.over(alpha, color) }),
        "blending is its closed form",
    );
    breaks(
        of(|below, a, color| {
            let through = below.color.map(|c| (1.0 - a) * c);
            Blend { color: sum::plus(color, through), ..below.over(a, color) }
        }),
        "blending is its closed form",
    );
    // A sum that is right except for its last digits.
    breaks(
        of(|below, a, color| {
            let plus = |c: f32, below: f32| below + a * (c - below);
            let [r, g, b] = [0, 1, 2].map(|i| plus(color[i], below.color[i]));
            Blend { color: [r, g, b], ..below.over(a, color) }
        }),
        "an opaque layer hides",
    );
    let layers = [(0.5, [1.0; 3])];
    let faint = |below: Blend<f32>, a: f32, color| Blend {
        alpha: if a > 0.0 { below.over(a, color).alpha } else { below.alpha + 1e-9 },
        ..below.over(a, color)
    };
    breaks(over::ends(&faint, &[], [1.0; 3]), "a clear layer changes nothing");
    let shines = |below: Blend<f32>, a: f32, color: [f32; 3]| {
        let trace = if a == 1.0 { below.alpha * 1e-3 } else { 0.0 };
        Blend { color: color.map(|c| c + trace), ..below.over(a, color) }
    };
    breaks(over::wall(&shines, &layers, [1.0; 3], &[]), "nothing shines through");
}

#[test]
fn broken_blending_from_the_front_is_caught() {
    let of = |op: fn(Under<f32>, f32, [f32; 3]) -> Under<f32>| under(&op);
    breaks(
        of(|above, alpha, color| Under { alpha: above.alpha + alpha, ..above.under(alpha, color) }),
        "opacity and rest are their closed form",
    );
    breaks(
        of(|above, a, color| {
            let color = sum::add(above.color, a, color);
            Under { color, ..above.under(a, [0.0; 3]) }
        }),
        "the colour is its closed form",
    );
    breaks(
        of(|above, a, color| {
            let color = sum::add(above.color, above.through * a, color);
            Under { color, ..above.under(a, [0.0; 3]) }
        }),
        "a clear layer of an infinite colour changes nothing",
    );
    let tinted = |above: Under<f32>, a: f32, color: [f32; 3]| {
        let next = above.under(a, color);
        let tint = if a == 0.0 { 1e-3 } else { 0.0 };
        Under { color: sum::add(next.color, tint, color), ..next }
    };
    let layers = [(0.5, [1.0; 3])];
    breaks(under::ends(&tinted, &layers, [[1.0; 3]; 2]), "a clear layer changes nothing");
    breaks(
        of(|above, a, color| {
            let next = above.under(a, color);
            Under { through: if a == 1.0 { 1e-9 } else { next.through }, ..next }
        }),
        "an opaque layer hides",
    );
}

#[test]
fn broken_bins_are_caught() {
    type Bin = fn(&Range, f32) -> f32;
    type Voronoi = fn(&Range, f32, f32) -> f32;
    let bin: Bin = |range, t| DepthBins::new(range).bin(t);
    let voronoi: Voronoi = |range, t, ratio| DepthBins::new(range).voronoi(t, ratio);
    let position = |range: &Range, t: f32| {
        (t - range.nearest) / (range.farthest - range.nearest) * range.count as f32
    };
    let of = |bin: Bin, voronoi: Voronoi| bins(&bin, &voronoi);
    let unbounded = |range: &Range, t: f32| position(range, t).floor();
    breaks(bins(&unbounded, &voronoi), "a bin is an integer in [0, n]");
    let last = |range: &Range, t: f32| bin(range, t).at_most(range.count as f32 - 1.0);
    breaks(bins(&last, &voronoi), "the ends are in the first and the last bin");
    let rounded = |range: &Range, t: f32| {
        bin(range, t + 0.5 * (range.farthest - range.nearest) / range.count as f32)
    };
    breaks(bins(&rounded, &voronoi), "a depth is in the bin of its position");
    let reciprocal = |range: &Range, t: f32| {
        let Range { nearest, farthest, count } = *range;
        let part = (1.0 / nearest - 1.0 / t) / (1.0 / nearest - 1.0 / farthest);
        let inside = nearest < t && t < farthest;
        if inside { (part * count as f32).floor() } else { bin(range, t) }
    };
    breaks(bins(&reciprocal, &voronoi), "a depth is in the bin of its position");
    breaks(of(bin, |range, t, ratio| DepthBins::new(range).bin(t) + ratio), "lies in its bin");
    breaks(
        of(bin, |range, t, r| DepthBins::new(range).bin(t) + (1.0 - r).at_most(0.5).at_least(0.0)),
        "it never falls as the ratio grows",
    );
    // Each of the other laws alone.
    let range = Range { nearest: 1.0, farthest: 2.0, count: 4 };
    let grows: Voronoi =
        |range, t, r| DepthBins::new(range).bin(t) + 0.99 * r.at_most(1.0) * (255.0 / 256.0);
    breaks(bins::clamped(&grows, &range, 1.5), "it no longer grows from 255/256");
    let fails: Voronoi = |range, t, r| DepthBins::new(range).voronoi(t, r - r * 0.0);
    assert_eq!(bins::clamped(&fails, &range, 1.5), Ok(()));
    breaks(bins::infinite(&fails, &range, 1.5), "an infinite ratio");
}

/// An operator over the depth-images of groups, from samples and epsilon to sums and count.
type Compose = fn(&[WeightedFragment<f32>], f32) -> (WeightedFragment<f32>, u32);

#[test]
fn a_broken_operator_over_groups_is_caught() {
    let of = |op: Compose| groups(&op);
    let [all, in_order] = ["of the nearest, up to rounding", "of the nearest, in order"];
    // Folds over pairs, in the order of the images.
    breaks(
        of(|samples, epsilon| {
            samples.iter().fold((WeightedFragment::EMPTY, 0), |(sums, count), s| {
                let (pair, more) = compose(&[sums, *s], epsilon);
                (pair, if more == 2 { count + 1 } else { 1 })
            })
        }),
        all,
    );
    breaks(
        of(|samples, epsilon| {
            let reversed: Vec<_> = samples.iter().rev().copied().collect();
            compose(&reversed, epsilon)
        }),
        in_order,
    );
    breaks(of(|samples, epsilon| compose(samples, epsilon / 2.0)), all);
    breaks(of(|samples, epsilon| (compose(samples, epsilon).0, samples.len() as u32)), all);
    // Each of the other laws alone.
    let two = [1.0, 2.0].map(|t| WeightedFragment::new(t, t, [0.0; 3], [0.5; 3], 1.0));
    let counts =
        |samples: &[WeightedFragment<f32>], e: f32| (compose(samples, e).0, samples.len() as u32);
    breaks(groups::empty(&counts, &two, 1, 9.0), "an empty image is neutral");
    breaks(groups::apart(&counts, &two, 0, 9.0), "an image of its own");
    let first = |samples: &[WeightedFragment<f32>], e: f32| compose(&samples[..1], e);
    breaks(groups::order(&first, &two, &[1, 0], 9.0), "in any order");
}

#[test]
fn a_broken_mean_is_caught() {
    type Operator = fn([bool; 4], [f32; 4], [f32; 4]) -> f32;
    let of = |op: Operator| means(&op);
    let sums = |takes: [bool; 4], w: [f32; 4], a: [f32; 4]| {
        let taken = (0..4).filter(|&j| takes[j]);
        taken.fold((0.0, 0.0), |(sum, total), j| (sum + w[j] * a[j], total + w[j]))
    };
    let unbounded = |takes, w, a| {
        let (sum, total) = sums(takes, w, a);
        sum / total
    };
    breaks(means(&unbounded), "the average of a constant is the constant");
    let absent: Operator = |_, w, a| Mean::new([true; 4], w).average(a);
    breaks(of(absent), "an average is the quotient");
    breaks(of(|takes, _, a| Mean::plain(takes).average(a)), "an average is the quotient");
    let sided = |takes: [bool; 4], w: [f32; 4], a: [f32; 4]| {
        let (sum, total) = sums(takes, w, a);
        let mean = Mean::new(takes, w);
        (sum / total).at_least(mean.least(a)).at_most(mean.greatest(a))
    };
    breaks(means(&sided), "exchanging sides");
}
