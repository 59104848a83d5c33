use super::*;
use crate::source::Shape;
use crate::source::sampler::{Greedy, Start, shuffled};

fn orders(n: usize) -> Vec<Ordered> {
    let points = Shape::Torus.surfels(n, 1).unwrap().position().to_vec();
    let exec = Exec::new(2, 32).unwrap();
    let greedy = Greedy { start: Start::Index(0) };
    let greedy = greedy.order(&points, n, &exec, &|_, _, _| ()).unwrap();
    [("greedy", greedy), ("random", shuffled(&points, 1, n, &|_, _, _| ()).unwrap())]
        .map(|(name, order)| {
            let points = order.index.iter().map(|i| points[*i as usize]).collect();
            Ordered { name: name.into(), points }
        })
        .into()
}

fn measured(orders: &[Ordered], prefixes: &[usize], spectra: bool) -> Result<Vec<AtPrefix>> {
    measure(orders, None, prefixes, spectra, &Exec::sequential(), &|_, _, _| ())
}

#[test]
fn the_unit_is_the_best_least_distance() {
    let found = measured(&orders(2000), &[100, 400], false).unwrap();
    for AtPrefix { unit, spreads, .. } in &found {
        let [greedy, random] = [&spreads[0], &spreads[1]];
        assert_eq!(*unit, greedy.least(), "of the exact order");
        assert!(greedy.covering <= greedy.least(), "a net of its own radius");
        assert!(random.least() < 0.5 * unit && random.covering > unit * 1.2);
        let [least, low, median, high, covering] = random.five();
        assert!(least < low && low < median && median < high && high < covering);
    }
}

#[test]
fn four_on_a_line_by_hand() {
    let at = |x: f32| Vec3::new(x, 0.0, 0.0);
    let order = Ordered { name: "line".into(), points: [0.0, 4.0, 1.0, 9.0].map(at).into() };
    let measure = |of: Option<&[Vec3]>| {
        let orders = std::slice::from_ref(&order);
        measure(orders, of, &[2, 3], false, &Exec::sequential(), &|_, _, _| ()).unwrap()
    };
    let found = measure(None);
    assert_eq!((found[0].unit, found[1].unit), (4.0, 1.0));
    assert_eq!(found[1].spreads[0].nearest, [1.0, 1.0, 3.0]);
    assert_eq!((found[0].spreads[0].covering, found[1].spreads[0].covering), (5.0, 5.0));
    let found = measure(Some(&[at(-7.0), at(5.0)]));
    assert_eq!(found[0].spreads[0].covering, 7.0, "of others");
    assert_eq!(found[1].spreads[0].nearest, [1.0, 1.0, 3.0], "which are no neighbours");
}

#[test]
fn what_cannot_be_measured_or_drawn_is_refused() {
    let mut orders = orders(300);
    for (prefix, what) in [(1, "random: a prefix of 1 of 300"), (301, "give 2 to 300")] {
        let error = measured(&orders[1..], &[prefix], false).unwrap_err().to_string();
        assert!(error.contains(what), "{error}");
    }
    let error = measured(&orders, &[255], true).unwrap_err().to_string();
    assert!(error.contains("greedy: a spectrum of 255 points"), "{error}");
    let found = measured(&orders, &[9], false).unwrap();
    assert!(chart(&[]).is_err() && chart(&vec![found[0].clone(); MOST_PREFIXES + 1]).is_err());
    orders.truncate(1);
    orders[0].points[1] = orders[0].points[0];
    let found = measured(&orders, &[9], false).unwrap();
    assert_eq!(found[0].unit, 0.0);
    assert!(chart(&found).unwrap_err().to_string().contains("prefix 9"));
    orders[0].points = [0.0, 1.0, 1e5].map(|x| Vec3::new(x, 0.0, 0.0)).into();
    let error = chart(&measured(&orders, &[3], false).unwrap()).unwrap_err().to_string();
    assert!(error.contains("over 10000 times"), "{error}");
    orders[0].points[2].x = f32::MAX;
    assert!(chart(&measured(&orders, &[3], false).unwrap()).is_err(), "infinitely far in f32");
}

/// From one order at one prefix to as many as fit, with names of any length.
#[test]
fn no_label_covers_another() {
    let two = orders(600);
    for (count, prefixes) in [(1, 1), (2, 1), (3, 3), (MOST_ORDERS, MOST_PREFIXES)] {
        for name in ["a", "an-order-of-a-very-long-name-that-nobody-reads"] {
            let some = two.iter().cycle().take(count).cloned();
            let some: Vec<_> = some.map(|order| Ordered { name: name.into(), ..order }).collect();
            let prefixes: Vec<usize> = (0..prefixes).map(|i| 600 - 10 * i).collect();
            let found = measured(&some, &prefixes[..1], true).unwrap();
            let found: Vec<_> = prefixes
                .iter()
                .map(|&prefix| AtPrefix { prefix: 1000 * prefix, ..found[0].clone() })
                .collect();
            chart(&found).unwrap().assert_readable();
            let plain = |at: &AtPrefix| {
                let spreads = at.spreads.iter();
                let spreads = spreads.map(|s| Spread { spectrum: None, ..s.clone() }).collect();
                AtPrefix { spreads, ..at.clone() }
            };
            chart(&found.iter().map(plain).collect::<Vec<_>>()).unwrap().assert_readable();
        }
    }
}

#[test]
fn a_chart_shows_every_order_at_every_prefix() {
    let found = measured(&orders(700), &[300, 600], true).unwrap();
    let drawing = chart(&found).unwrap();
    let svg = drawing.svg();
    for (text, count) in [("greedy", 3), ("random", 3), ("300 points", 1), ("600 points", 1)] {
        assert_eq!(svg.matches(&format!(">{text}</text>")).count(), count, "{text}");
    }
    let again = chart(&measured(&orders(700), &[300, 600], true).unwrap()).unwrap();
    assert_eq!((svg, drawing.picture()), (again.svg(), again.picture()));
}
