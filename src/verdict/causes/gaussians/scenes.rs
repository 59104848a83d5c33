//! Mistakes of readers and shaders of Gaussians, each as another scene.

use super::super::Mistakes;
use super::super::change::Change;
use crate::method::Session;
use crate::number::MapInline;
use crate::scene::Camera;
use crate::scene::gaussians::{GaussianArrays, coefficients};
use crate::shade::harmonics::rotation::HarmonicRotation;
use glam::{DMat3, DQuat, DVec3, Vec3};

/// A change of the arrays of Gaussians.
type OtherArrays = fn(&mut GaussianArrays);

/// Mistakes of readers and shaders, each as another scene.
const OTHER_SCENES: [(OtherArrays, &str); 12] = [
    (
        |g| g.rotation.iter_mut().for_each(|q| *q = [q[3], q[0], q[1], q[2]]),
        "the parts of quaternions are in another order: w is read where x is",
    ),
    (
        |g| g.rotation.iter_mut().for_each(|q| *q = [q[1], q[2], q[3], q[0]]),
        "the parts of quaternions are in another order: x is read where w is",
    ),
    (
        |g| g.rotation.iter_mut().for_each(|q| q[3] = -q[3]),
        "rotations are reversed: the covariance is transposed, or of another handedness",
    ),
    (
        |g| g.scale.iter_mut().for_each(|s| *s = Vec3::new(s.y, s.x, s.z)),
        "the scales of x and y are exchanged",
    ),
    (|g| of_degrees(g, |degree| degree % 2 == 1), "the direction of the harmonics is reversed"),
    (
        |g| each_splat(g, |all| all.swap(1, 3)),
        "the coefficients of degree 1 are in the order x, z, y",
    ),
    (|g| each_splat(g, mixed), "the coefficients of colours are mixed: f_rest is by channel"),
    (drawn_again, "splat 0 is drawn once more, as where a last group of threads is not full"),
    (
        |g| g.rotation.fill([0.0, 0.0, 0.0, 1.0]),
        "rotations have no effect, as where the covariance is M^T M, not M M^T",
    ),
    (|g| g.opacity.fill(1.0), "opacities are ignored"),
    (without_half, "the harmonics lack their 1/2"),
    (last_dropped, "the last splat is missing"),
];

/// Every scene with one of these mistakes.
pub(super) fn mistakes(session: &Session<'_>, camera: &Camera) -> Mistakes {
    let Some(gaussians) = &session.scene().gaussians else { return Mistakes::new() };
    let mut all = Mistakes::new();
    let mut add = |what: String, change: Box<dyn Fn(&mut GaussianArrays)>| {
        all.push((what, Change::Gaussians(change)));
    };
    OTHER_SCENES.iter().for_each(|(change, what)| add((*what).to_owned(), Box::new(*change)));
    let view = DMat3::from_mat4(camera.view_from_world.as_dmat4());
    let camera = DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0)) * view;
    for (axes, up) in [(camera, "down"), (view, "up")] {
        let turn = HarmonicRotation::new(axes.transpose());
        let what = format!("the direction of the harmonics is in camera space, y {up}");
        let turned = move |g: &mut GaussianArrays| {
            let each = coefficients(g.degree);
            g.harmonics.chunks_exact_mut(each).for_each(|all| turn.apply(all));
        };
        add(what, Box::new(turned));
    }
    // W^T S W is W S2 W^T, if S2 is S turned back twice.
    let twice = DQuat::from_mat3(&(camera.transpose() * camera.transpose()));
    let turned = move |g: &mut GaussianArrays| {
        for q in &mut g.rotation {
            let own = DQuat::from_array(q.map_inline(f64::from));
            *q = (twice * own).normalize().to_array().map_inline(|part| part as f32);
        }
    };
    let what = "covariances are turned by the transpose of the camera's rotation";
    add(what.into(), Box::new(turned));
    // The last group of threads reads splat 0 beyond the end.
    let mut before = 1;
    for group in [16, 32, 64, 128, 256] {
        let missing = gaussians.len().next_multiple_of(group) - gaussians.len();
        if missing > before {
            let what =
                format!("splat 0 is drawn {missing} times more, which fills a group of {group}");
            add(what, Box::new(move |g| (0..missing).for_each(|_| drawn_again(g))));
            before = missing;
        }
    }
    all
}

fn each_splat(g: &mut GaussianArrays, change: fn(&mut [Vec3])) {
    let each = coefficients(g.degree);
    if each > 1 {
        g.harmonics.chunks_exact_mut(each).for_each(change);
    }
}

/// Reverses the coefficients of some degrees.
fn of_degrees(g: &mut GaussianArrays, which: fn(usize) -> bool) {
    let each = coefficients(g.degree);
    for all in g.harmonics.chunks_exact_mut(each) {
        for (i, coefficient) in all.iter_mut().enumerate() {
            if which(i.isqrt()) {
                *coefficient = -*coefficient;
            }
        }
    }
}

/// Reads coefficients that are stored by channel as if they were stored by coefficient.
fn mixed(all: &mut [Vec3]) {
    let rest = all.len() - 1;
    let stored: Vec<f32> = (0..3).flat_map(|c| all[1..].iter().map(move |v| v[c])).collect();
    for i in 0..rest {
        all[1 + i] = Vec3::new(stored[3 * i], stored[3 * i + 1], stored[3 * i + 2]);
    }
}

/// Adds the first splat once more.
fn drawn_again(g: &mut GaussianArrays) {
    let each = coefficients(g.degree);
    g.position.push(g.position[0]);
    g.scale.push(g.scale[0]);
    g.rotation.push(g.rotation[0]);
    g.opacity.push(g.opacity[0]);
    g.harmonics.extend_from_within(..each);
}

/// Takes 1/2 from every colour.
fn without_half(g: &mut GaussianArrays) {
    let each = coefficients(g.degree);
    for all in g.harmonics.chunks_exact_mut(each) {
        all[0] -= 0.5 / 0.282_094_8;
    }
}

/// Drops the last splat.
fn last_dropped(g: &mut GaussianArrays) {
    let each = coefficients(g.degree);
    g.position.pop();
    g.scale.pop();
    g.rotation.pop();
    g.opacity.pop();
    g.harmonics.truncate(g.harmonics.len() - each);
}
