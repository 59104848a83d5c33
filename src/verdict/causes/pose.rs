//! Fit several numbers of the camera at once: the focal length, and where the eye is and looks.
//!
//! A camera that frames a scene moves back as its field of view gets narrower, so that two numbers
//! are wrong. The errors r of [`shown`](super::shown) tell of all seven. With d, the median depth:
//!
//! ```text
//!   n = (s, m, w)   the focal length is e^s times as long; a point p of view space is at R(w) p + d m
//!   J_i = the change of r_i with each number, as a quotient of differences
//!   c_i = least of 1 and (median of |J|) / |J_i|
//!   n is moved by the least sum of v_i (r_i + J_i . move)^2 with v_i = (c_i / (1 + (c_i r_i / e)^2))^2
//! ```
//!
//! e is twice the median of |r|. It gets smaller with each move, so that pixels that are wrong for
//! another reason count less and less. c keeps the rims of shapes from deciding alone.
//!
//! The fewest numbers that fit as well as all seven are wrong.

use super::change::Change;
use super::depths::{digits, median};
use super::shown::{AS_WELL, LEAST_LEFT, RIGHT, Shown, median_size};
use super::{Case, Explanation, MOST_LEFT};
use crate::error::Result;
use crate::number::Real;
use crate::scene::Camera;
use crate::splat::View;
use glam::{DMat3, DMat4, DQuat, DVec3};

/// The seven numbers: 0 is s, 1 to 3 are m, and 4 to 6 are w.
type Numbers = [f64; 7];

/// The numbers that may be wrong together, the likeliest first.
const TOGETHER: [&[usize]; 5] =
    [&[0, 3], &[1, 2, 3], &[4, 5, 6], &[1, 2, 3, 4, 5, 6], &[0, 1, 2, 3, 4, 5, 6]];
/// Errors that are so many times as large as the median one hardly count.
const FAR: f64 = 2.0;
/// How often the numbers are moved.
const TURNS: usize = 20;
/// The differences that slopes are computed from.
const STEP: f64 = 1e-5;

/// The camera that the client's pixels show, if it explains the wrong pixels.
///
/// # Errors
/// As [`crate::method::Session::verify`].
pub(super) fn fitted(case: &Case<'_, '_>, shown: &Shown<'_>) -> Result<Option<Explanation>> {
    let Some((camera, what)) = camera(case.camera, shown) else { return Ok(None) };
    let (change, most) = (Change::Camera(camera), MOST_LEFT);
    let left = case.judge(&change)?.filter(|left| case.explains(*left, most));
    Ok(left.map(|left| Explanation { what, change, most, left }))
}

/// The camera with which the depths fit, and what is wrong in words. None if they fit the right camera,
/// or none. In a parallel projection an eye farther back is a bias of all depths, so nothing is fitted.
fn camera(right: &Camera, shown: &Shown<'_>) -> Option<(Camera, String)> {
    let fit = Fit { view: View::new(right), unit: shown.depth(), shown };
    let wrong = median_size(&shown.errors(&fit.view));
    let [.., all] = TOGETHER;
    if !fit.view.perspective || wrong <= RIGHT {
        return None;
    }
    let (_, least) = fit.numbers(all).filter(|(_, left)| *left <= LEAST_LEFT * wrong)?;
    let fits = TOGETHER.iter().filter_map(|some| fit.numbers(some));
    let (numbers, _) = { fits }.find(|(_, left)| *left <= AS_WELL * least)?;
    Some((fit.camera(right, &numbers), fit.in_words(right, &numbers)))
}

struct Fit<'a> {
    view: View<f64>,
    /// The median depth.
    unit: f64,
    shown: &'a Shown<'a>,
}

impl Fit<'_> {
    /// Some numbers, and the median error that they leave.
    fn numbers(&self, some: &[usize]) -> Option<(Numbers, f64)> {
        let (mut numbers, mut best) = ([0.0; 7], None);
        for _ in 0..TURNS {
            let errors = self.shown.errors(&self.view(&numbers));
            let left = median_size(&errors);
            if best.is_none_or(|(_, least)| left < least) {
                best = Some((numbers, left));
            }
            let beside = |number: &usize| {
                let mut beside = numbers;
                beside[*number] += STEP;
                self.shown.errors(&self.view(&beside))
            };
            let beside: Vec<_> = some.iter().map(beside).collect();
            let step = step(&errors, &beside, FAR * left)?;
            some.iter().zip(step).for_each(|(number, by)| numbers[*number] += by);
        }
        best
    }

    /// The turn and the way of what is seen.
    fn moved(&self, numbers: &Numbers) -> (DMat3, DVec3) {
        let [_, x, y, z, turn @ ..] = *numbers;
        let turn = DMat3::from_quat(DQuat::from_scaled_axis(turn.into()));
        (turn, self.unit * DVec3::new(x, y, z))
    }

    fn view(&self, numbers: &Numbers) -> View<f64> {
        let (turn, way) = self.moved(numbers);
        let by = libm::exp(numbers[0]);
        let View { rows: [x, y, z], fx, fy, .. } = self.view;
        let old = DMat4::from_cols_array_2d(&[x, y, z, [0.0, 0.0, 0.0, 1.0]]).transpose();
        let new = DMat4::from_translation(way) * DMat4::from_mat3(turn) * old;
        let rows = [0, 1, 2].map(|row| new.row(row).to_array());
        View { rows, fx: by * fx, fy: by * fy, ..self.view }
    }

    fn camera(&self, right: &Camera, numbers: &Numbers) -> Camera {
        let View { rows: [x, y, z], fx, fy, .. } = self.view(numbers);
        let view = DMat4::from_cols_array_2d(&[x, y, z, [0.0, 0.0, 0.0, 1.0]]).transpose();
        Camera { view_from_world: view.as_mat4(), fx: fx as f32, fy: fy as f32, ..*right }
    }

    /// What is wrong in words.
    fn in_words(&self, right: &Camera, numbers: &Numbers) -> String {
        let mut all = Vec::new();
        if numbers[0] != 0.0 {
            let degrees = |focal: f64| {
                digits(2.0 * libm::atan(0.5 * f64::from(right.height) / focal).to_degrees())
            };
            let [own, right] = [self.view(numbers).fy, self.view.fy].map(degrees);
            all.push(format!("the field of view is {own} degrees, not {right}"));
        }
        let (turn, way) = self.moved(numbers);
        // In view space x is right, y is up, and z is back.
        let eye = -(turn.transpose() * way);
        let ways = [
            (eye.z, ["nearer", "farther away"]),
            (eye.x, ["farther left", "farther right"]),
            (eye.y, ["lower", "higher"]),
        ];
        let large = ways.iter().filter(|(by, _)| 1000.0 * by.abs() > eye.abs().max_element());
        all.extend(large.map(|(by, [less, more])| {
            format!("the eye is {} {}", digits(by.abs()), if *by < 0.0 { less } else { more })
        }));
        let [.., x, y, z] = *numbers;
        if [x, y, z] != [0.0; 3] {
            let angle = DVec3::new(x, y, z).length().to_degrees();
            all.push(format!("it is turned by {} degrees", digits(angle)));
        }
        format!("another camera: {}", all.join(", and "))
    }
}

/// How far to move the numbers: the errors, and those beside with each number [`STEP`] larger. Errors
/// above `far` hardly count.
fn step(errors: &[f64], beside: &[Vec<f64>], far: f64) -> Option<Vec<f64>> {
    let count = beside.len();
    let slopes = |pixel: usize| -> Vec<f64> {
        beside.iter().map(|beside| (beside[pixel] - errors[pixel]) / STEP).collect()
    };
    let slopes: Vec<_> = (0..errors.len()).map(slopes).collect();
    let lengths: Vec<_> = slopes
        .iter()
        .map(|own| own.iter().map(|slope| slope * slope).sum::<f64>().sqrt())
        .collect();
    let usual = median(lengths.clone());
    // A row a number: its equation, and the right side.
    let mut rows = vec![vec![0.0; count + 1]; count];
    for ((error, slopes), length) in errors.iter().zip(&slopes).zip(lengths) {
        let by = (usual / length).at_most(1.0);
        let share = by * error / far;
        let weight = by / (1.0 + share * share);
        let weight = weight * weight;
        if !(weight * error * length).is_finite() {
            continue;
        }
        for (row, slope) in rows.iter_mut().zip(slopes) {
            let all = slopes.iter().chain([error]);
            row.iter_mut().zip(all).for_each(|(sum, other)| *sum += weight * slope * other);
        }
    }
    let solved = solved(rows)?;
    Some(solved.into_iter().map(|by| -by).collect())
}

/// The solution of positive definite equations, each with its right side, by elimination.
fn solved(mut rows: Vec<Vec<f64>>) -> Option<Vec<f64>> {
    let count = rows.len();
    for i in 0..count {
        let own = rows[i].clone();
        for (_, row) in rows.iter_mut().enumerate().filter(|(other, _)| *other != i) {
            let by = row[i] / own[i];
            row.iter_mut().zip(&own).for_each(|(number, own)| *number -= by * own);
        }
    }
    let all: Vec<_> = (0..count).map(|i| rows[i][count] / rows[i][i]).collect();
    all.iter().all(|number| number.is_finite()).then_some(all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Exec;
    use crate::method::{Method, Session, deferred, ewa, single_pass};
    use crate::scene::{Lens, Scene, Sphere};
    use crate::source::Shape;
    use crate::verdict::causes::likely_cause;
    use crate::verdict::client::Client;
    use crate::verdict::tests;
    use glam::{Mat4, Vec3};

    /// What is named if a client draws with another camera.
    fn named(method: Method, right: &Camera, other: &Camera) -> String {
        let exec = Exec::new(2, 32).unwrap();
        let scene = Scene::unlit("", Shape::Torus.surfels(600, 3).unwrap());
        let session = Session::new(&scene, method, &exec).unwrap();
        let client = Client::from(&session.define::<f32>(other, true).unwrap().frame);
        let verdict = session.verify(right, &client, 1.0).unwrap();
        likely_cause(&session, right, &client, &verdict).unwrap().unwrap_or_default()
    }

    #[test]
    fn several_wrong_numbers_of_the_camera_are_named() {
        let framed = |degrees| {
            let sphere = Sphere { center: DVec3::ZERO, radius: 1.0 };
            let lens = Lens::FieldOfView(degrees);
            Camera::framing(176, 128, sphere, DVec3::new(0.3, 0.4, 1.0), lens).unwrap()
        };
        let right = framed(40.0);
        let moved = |by: Mat4| Camera { view_from_world: by * right.view_from_world, ..right };
        let turned = Mat4::from_axis_angle(Vec3::new(0.6, 0.8, 0.0), 0.5_f32.to_radians());
        let away = Mat4::from_translation(Vec3::new(-0.01, 0.02, 0.0));
        let both = away * turned;
        for (other, what) in [
            (framed(39.9), "the field of view is 39.9 degrees, not 40, and the eye is 0.007"),
            (framed(42.0), "the field of view is 42 degrees, not 40, and the eye is 0.1"),
            (moved(away), "the eye is 0.01 farther right, and the eye is 0.02 lower"),
            (moved(turned), "it is turned by 0.5 degrees"),
            (moved(both), "and it is turned by 0.5 degrees"),
        ] {
            for method in [
                ewa::Settings::default().into(),
                single_pass::Settings::default().into(),
                deferred::Settings::default().into(),
            ] {
                let named = named(method, &right, &other);
                assert!(named.contains(what), "{}: {named:?}, not {what}", method.name());
            }
        }
    }

    #[test]
    fn other_wrong_cameras_are_not_named() {
        let right = tests::camera(Shape::Torus, [176, 128], None);
        let scaled = right.view_from_world * Mat4::from_scale(Vec3::splat(1.01));
        let scaled = Camera { view_from_world: scaled, ..right };
        let sheared = Camera { fx: 1.01 * right.fx, cx: right.cx + 3.0, ..right };
        for other in [scaled, sheared] {
            assert_eq!(named(ewa::Settings::default().into(), &right, &other), "");
        }
    }

    #[test]
    fn equations_are_solved() {
        let rows = vec![vec![4.0, 1.0, 9.0], vec![1.0, 3.0, 5.0]];
        assert_eq!(solved(rows), Some(vec![2.0, 1.0]));
        assert_eq!(solved(vec![vec![0.0, 1.0]]), None);
    }
}
