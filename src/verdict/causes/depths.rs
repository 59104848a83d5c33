//! Mistakes with the meaning of a depth: another background, a depth of the wrong sign, scale or
//! offset, and a depth buffer that is not declared. The numbers are estimated: a line is fitted to
//! the client's values and the depths of the crate, or to their reciprocals.

use super::Case;
use super::change::Change;
use super::epsilon::DEPTHS;
use crate::frame::Samples;
use crate::method::Session;
use crate::scene::Camera;
use crate::verdict::client::{Client, Storage};

/// How a stored value v is read: t is `offset + slope v`, or the reciprocal of this.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reading {
    /// The value of an empty pixel.
    background: Option<f64>,
    is_inverse: bool,
    offset: f64,
    slope: f64,
    /// How far off a depth may be, as a fraction of it.
    relative: f64,
}

impl Reading {
    /// The value as it stands.
    const PLAIN: Self =
        Self { background: None, is_inverse: false, offset: 0.0, slope: 1.0, relative: 0.0 };

    fn depth(&self, value: f64) -> f64 {
        if self.background == Some(value) || value == f64::INFINITY {
            return f64::INFINITY;
        }
        let read = self.offset + self.slope * value;
        if self.is_inverse { 1.0 / read } else { read }
    }

    /// The client whose depths are read this way.
    pub(super) fn read(&self, client: &Client) -> Client {
        let read = client.mapped(|name, samples| match samples {
            Samples::Scalar(plane) if DEPTHS.contains(&name) => {
                Samples::Scalar(client.changed(plane, |value| self.depth(*value)))
            }
            other => client.same(other),
        });
        if self.relative == 0.0 {
            return read;
        }
        let storage = Storage::Float { relative: self.relative, least: 0.0 };
        DEPTHS.into_iter().fold(read, |client, name| client.stored(name, storage))
    }

    /// The mistake in words.
    fn in_words(&self) -> String {
        let empty = self.background.map(|value| format!("the background of the depth is {value}"));
        let Self { is_inverse, offset, slope, .. } = *self;
        if !is_inverse && offset == 0.0 && slope == 1.0 {
            return format!("{}, not +inf", empty.unwrap_or_default());
        }
        let is = |a: f64, b: f64| (a - b).abs() < 0.001;
        let [near, far] = [1.0 / offset, 1.0 / (offset + slope)].map(digits);
        let what = match is_inverse {
            true if is(offset / slope, 0.0) => format!("depth is {}/t, not t", digits(1.0 / slope)),
            true if slope < 0.0 => {
                format!("depth is a z-buffer value that is not declared (near {near}, far {far})")
            }
            true => {
                let ends = format!("near {far}, far {near}");
                format!("depth is a reversed z-buffer value that is not declared ({ends})")
            }
            false if is(slope, -1.0) && is(offset, 0.0) => {
                "depth is negative: z of view space, not t = -z".into()
            }
            false => {
                let [offset, slope] = [offset, slope].map(digits);
                format!("depth has another scale or offset: t is {offset} + {slope} times it")
            }
        };
        empty.map_or(what.clone(), |empty| format!("{what}; {empty}"))
    }
}

/// A number with four digits.
pub(super) fn digits(value: f64) -> f64 {
    let text = format!("{value:.3e}");
    text.parse().unwrap_or(value)
}

/// The readings that may explain a client's depths, in words and as changes.
pub(super) fn mistakes(case: &Case<'_, '_>) -> Vec<(String, Change)> {
    let Some(all) = case.depths() else { return Vec::new() };
    let pairs = || all.iter().copied();
    let background = background(pairs().filter(|(_, t)| *t == f64::INFINITY).map(|(v, _)| v));
    let seen: Vec<_> = pairs()
        .filter(|(v, t)| v.is_finite() && Some(*v) != background && *t > 0.0 && t.is_finite())
        .collect();
    let fits = [false, true].into_iter().filter_map(|is_inverse| fit(&seen, is_inverse));
    let mut all: Vec<_> = fits.map(|fit| Reading { background, ..fit }).collect();
    if background.is_some() {
        all.insert(0, Reading { background, ..Reading::PLAIN });
    }
    all.into_iter().map(|one| (one.in_words(), Change::Depths(one))).collect()
}

/// The depth that the client stores at each pixel, and the right one. None where there is no memory
/// for another picture.
pub(super) fn pairs(
    session: &Session<'_>,
    camera: &Camera,
    client: &Client,
) -> Option<Vec<(f64, f64)>> {
    let (name, _) = client.depth_of_visibility()?;
    let picture = session.draw_whole(camera).ok()?;
    let (own, truth) = (client.frame().scalar(name).ok()?, picture.frame.scalar("Z").ok()?);
    let truth = truth.values().iter().map(|&t| f64::from(t));
    Some(own.values().iter().copied().zip(truth).collect())
}

/// The length by which most depths are too large, if it is the same for most of them.
pub(super) fn offset(case: &Case<'_, '_>) -> Option<f64> {
    let both = case.depths()?.iter().filter(|(v, t)| v.is_finite() && t.is_finite());
    let offsets: Vec<f64> = both.map(|(v, t)| v - t).collect();
    let offset = median(offsets.clone());
    let off = median(offsets.iter().map(|own| (own - offset).abs()).collect());
    (offset.is_finite() && off < 0.01 * offset.abs()).then_some(offset)
}

/// The one value of nearly all empty pixels, if it is not +inf.
fn background(empty: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = empty.collect();
    values.sort_by(f64::total_cmp);
    let value = *values.get(values.len() / 2)?;
    let same = values.iter().filter(|other| **other == value).count();
    (value != f64::INFINITY && 10 * same >= 9 * values.len()).then_some(value)
}

/// The fewest pixels that a line is fitted to.
const FEWEST: usize = 16;
/// The largest median error of a line that may be what the client stores, as a fraction of t.
const LOOSEST: f64 = 0.001;

/// The line through values and depths, or their reciprocals. None if there is no such line, or if it
/// says that the values are depths.
fn fit(pairs: &[(f64, f64)], is_inverse: bool) -> Option<Reading> {
    let to = |t: f64| if is_inverse { 1.0 / t } else { t };
    let mut kept: Vec<(f64, f64)> = pairs.to_vec();
    let mut found = None;
    // The first line is one of medians, because wrong pixels far away would turn a mean. The second
    // and third line leave out the pixels that are far from the line before.
    for turn in 0..3 {
        if kept.len() < FEWEST {
            return None;
        }
        let points: Vec<[f64; 2]> = kept.iter().map(|pair| [pair.0, to(pair.1)]).collect();
        let [slope, offset] = if turn == 0 { of_medians(&points) } else { of_means(&points) };
        if !(slope != 0.0 && slope.is_finite() && offset.is_finite()) {
            return None;
        }
        let line = Reading { is_inverse, offset, slope, ..Reading::PLAIN };
        let error = |&(v, t): &(f64, f64)| ((line.depth(v) - t) / t).abs();
        let median = median(kept.iter().map(error).collect());
        found = Some(Reading { relative: 16.0 * median + 1e-6, ..line });
        kept.retain(|pair| error(pair) <= 4.0 * median + 1e-6);
    }
    let found = found.filter(|line| line.relative <= 16.0 * LOOSEST)?;
    // Depths with another offset alone are discs moved along the view, which is a cause of its own.
    let is_plain = !is_inverse && (found.slope - 1.0).abs() <= LOOSEST;
    (!is_plain).then_some(found)
}

/// Slope and offset by medians: of the lines through points that are half of all apart.
fn of_medians(points: &[[f64; 2]]) -> [f64; 2] {
    let (first, second) = points.split_at(points.len() / 2);
    let slopes = first.iter().zip(second).map(|([x, y], [u, v])| (v - y) / (u - x));
    let slope = median(slopes.filter(|slope| slope.is_finite()).collect());
    [slope, median(points.iter().map(|[x, y]| y - slope * x).collect())]
}

/// Slope and offset with the least squares.
fn of_means(points: &[[f64; 2]]) -> [f64; 2] {
    let count = points.len() as f64;
    let mean = |of: &dyn Fn(&[f64; 2]) -> f64| points.iter().map(of).sum::<f64>() / count;
    let (x, y) = (mean(&|point| point[0]), mean(&|point| point[1]));
    let both = mean(&|point| (point[0] - x) * (point[1] - y));
    let slope = both / mean(&|point| (point[0] - x) * (point[0] - x));
    [slope, y - slope * x]
}

/// The median; NaN of nothing.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    if values.is_empty() {
        f64::NAN
    } else {
        *values.select_nth_unstable_by(middle, f64::total_cmp).1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_found_beside_wrong_pixels() {
        let depth = |i: u32| 2.0 + 0.03 * f64::from(i);
        let (near, far) = (0.1, 50.0);
        let window = |t: f64| far / (far - near) * (1.0 - near / t);
        let pairs = |store: &dyn Fn(f64) -> f64| -> Vec<(f64, f64)> {
            let value = |i: u32| if i % 10 == 3 { 0.5 } else { f64::from(store(depth(i)) as f32) };
            (0..80).map(|i| (value(i), depth(i))).collect()
        };
        let found = fit(&pairs(&window), true).unwrap();
        assert_eq!(
            found.in_words(),
            "depth is a z-buffer value that is not declared (near 0.1, far 50)"
        );
        let found = fit(&pairs(&|t| 1.0 - window(t)), true).unwrap();
        assert!(
            found.in_words().contains("reversed z-buffer value that is not declared (near 0.1")
        );
        assert_eq!(fit(&pairs(&|t| 1.0 / t), true).unwrap().in_words(), "depth is 1/t, not t");
        let found = fit(&pairs(&|t| -t), false).unwrap();
        assert_eq!(found.in_words(), "depth is negative: z of view space, not t = -z");
        let found = fit(&pairs(&|t| 1000.0 * t), false).unwrap();
        assert!(found.in_words().contains("t is 0 + 0.001 times it") || found.offset.abs() < 1e-6);
        assert!(fit(&pairs(&|t| t), false).is_none(), "nothing is wrong");
        assert!(fit(&pairs(&|t| (t * 7919.0).fract()), true).is_none(), "no line");
    }
}
