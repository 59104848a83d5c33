//! The Pareto front: candidates that no other candidate beats in both time and accuracy.

/// The candidates on the front, by ascending time; each candidate is a time and an error.
///
/// A candidate beats another if neither its time nor its error is greater and one of them is less.
/// Of two with the same time and error, the lower index stays. A candidate with a NaN is on no
/// front.
#[must_use]
pub fn front(points: &[[f64; 2]]) -> Vec<usize> {
    let mut order: Vec<usize> =
        (0..points.len()).filter(|&i| !points[i].iter().any(|v| v.is_nan())).collect();
    order.sort_by(|&a, &b| {
        let [by_time, by_error] = [0, 1].map(|axis| points[a][axis].total_cmp(&points[b][axis]));
        by_time.then(by_error).then(a.cmp(&b))
    });
    let mut least = f64::INFINITY;
    order.retain(|&i| {
        let better = points[i][1] < least;
        if better {
            least = points[i][1];
        }
        better
    });
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn beats(a: [f64; 2], b: [f64; 2]) -> bool {
        a[0] <= b[0] && a[1] <= b[1] && a != b
    }

    #[test]
    fn known_answers() {
        assert_eq!(front(&[]), Vec::<usize>::new());
        let points = [[3.0, 1.0], [1.0, 3.0], [2.0, 3.0], [2.0, 2.0], [2.0, 2.0], [f64::NAN, 0.0]];
        assert_eq!(front(&points), [1, 3, 0]);
        assert_eq!(front(&[[1.0, 0.0], [2.0, 0.0]]), [0]);
    }

    proptest! {
        #[test]
        fn it_is_what_nothing_beats(
            points in prop::collection::vec([0_u8..6, 0_u8..6], 0..20)
        ) {
            let points: Vec<[f64; 2]> = points.iter().map(|p| p.map(f64::from)).collect();
            let unbeaten = |&i: &usize| {
                let beaten = points.iter().any(|&other| beats(other, points[i]));
                !beaten && !points[..i].contains(&points[i])
            };
            let mut expected: Vec<usize> = (0..points.len()).filter(unbeaten).collect();
            let mut found = front(&points);
            let times: Vec<f64> = found.iter().map(|&i| points[i][0]).collect();
            prop_assert!(times.is_sorted());
            found.sort_unstable();
            expected.sort_unstable();
            prop_assert_eq!(found, expected);
        }
    }
}
