//! Entries about reconstruction in image space: pyramids, templates, tubes.

use super::case::{Case, SIZE, change, exact};
use super::{Failure, Found};
use crate::compare::metrics::{Region, regions, rmse};
use crate::error::Result;
use crate::frame::{Exec, Frame, Samples};
use crate::method::template::LevelRule;
use crate::method::{Method, ewa, pyramid, template};
use crate::number::elementary::{cos, sin};
use crate::scene::{Camera, Lens, Polylines, Pose, Primitives, Scene, Surfels, Vertices};
use crate::source::Shape;
use glam::{DVec3, Mat4, Vec3};

pub(super) const FAILURES: [Failure; 5] = [
    Failure {
        id: "pyramid-shift",
        title: "The pyramid's picture crawls when the camera moves",
        why: "Pull and push draws a sphere of 10,000 surfels [MKC08], and the camera shifts by a \
              fraction of a pixel. Centres then fall into other pixels, and pixels into other \
              cells of the levels, so the averages change. The error is the change of the picture \
              minus the change of the true picture.",
        swept: "shift, px",
        values: &[0.0, 0.03125, 0.0625, 0.125, 0.25, 0.5, 0.75],
        error: "change that is no motion, RMSE, linear RGB",
        limit: 0.005,
        cure: "none within the pyramid; use `--method ewa`",
        at: shift,
    },
    Failure {
        id: "pyramid-silhouette",
        title: "Averaged ellipses spill over the silhouette",
        why: "A sphere has fewer and fewer surfels. A cell of a higher level merges the centres of \
              several ellipses into their average, which reaches beyond each of them.",
        swept: "radius of a surfel, px",
        values: &[1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0],
        error: "spill, per mille",
        limit: 10.0,
        cure: "none within the pyramid; use `--method ewa`",
        at: silhouette,
    },
    Failure {
        id: "template-cover",
        title: "Regular holes in a plain sphere, at some sizes of the picture",
        why: "A sphere of 2,500 surfels is drawn by templates of 5 x 5. The level follows the \
              paper's words, where D is the projected radius [MOC08, eq. 1]. That level cuts \
              ellipses to half their radius: just before a disc moves to the next level, it does \
              not reach its neighbours.",
        swept: "rows of the picture",
        values: &[150.0, 175.0, 200.0, 225.0, 250.0, 275.0, 300.0],
        error: "holes, per mille",
        limit: 5.0,
        cure: "`--levels diameter`, the authors' own rule and the default of 5 x 5",
        at: cover,
    },
    Failure {
        id: "template-mirror",
        title: "A mirrored scene gives another picture",
        why: "Spheres of more and more surfels are compared with their mirror image. The ternary \
              test of a template compares each sample with the samples gathered before it [MOC08, \
              3.1], so the order decides among ellipses that overlap in depth.",
        swept: "surfels",
        values: &[100.0, 300.0, 1000.0, 3000.0, 10_000.0, 30_000.0],
        error: "normals that turn by more than a degree, per mille",
        limit: 1.0,
        cure: "none within the template; use `--method ewa`",
        at: mirror,
    },
    Failure {
        id: "tube-sign",
        title: "Tangents of alternating sign would cancel",
        why: "Three quarters of a ring is drawn as a tube. Its vertices carry tangents, and every \
              second tangent is reversed. Averaged as they are [MKC08, 4.3], tangents of opposite \
              signs cancel. splatref treats a tangent as an axis: it turns each tangent to the \
              foremost tangent's side before averaging, so the picture equals the picture with \
              agreeing tangents. This entry must not break.",
        swept: "vertices",
        values: &[5.0, 9.0, 17.0, 33.0, 65.0, 129.0, 257.0],
        error: "RMSE, linear RGB, to the picture of tangents that agree",
        limit: 0.001,
        cure: "none is needed; see `method::pyramid::pull`",
        at: tube,
    },
];

fn pull_push() -> Method {
    pyramid::Settings::default().into()
}

fn splatting() -> Method {
    ewa::Settings::default().into()
}

fn shift(by: f64, exec: &Exec) -> Result<[Found; 2]> {
    let mut case = Case::of_shape(Shape::Sphere, 10_000, pull_push())?;
    let at_rest = case.camera;
    let truth = |case: &Case| case.truth(&exact(Shape::Sphere), exec);
    let before = truth(&case)?;
    case.camera.cx += by as f32;
    let after = truth(&case)?;
    let shifted = case.camera;
    let mut found = |method| {
        case.method = method;
        case.camera = at_rest;
        let first = case.draw(exec)?.0;
        case.camera = shifted;
        let (second, time) = case.draw(exec)?;
        let error = crawl([&first, &second], [&before, &after])?;
        Ok(Found { error, picture: second.color("")?.clone(), time: Some(time) })
    };
    Ok([found(pull_push())?, found(splatting())?])
}

/// How much more two pictures change than the two true pictures.
fn crawl(drawn: [&Frame<f32>; 2], truth: [&Frame<f32>; 2]) -> Result<f64> {
    // Silhouettes jump in every picture with one sample a pixel.
    let inside = drawn.iter().chain(&truth).map(|frame| {
        let alpha = frame.scalar("A")?;
        Ok(regions(alpha.values(), frame.width as usize))
    });
    let inside = inside.collect::<Result<Vec<_>>>()?;
    let still = |i: &usize| inside.iter().all(|all| all[*i] == Region::Interior);
    let change = |[from, to]: [&Frame<f32>; 2]| -> Result<Vec<f32>> {
        let all = change(from.color("")?, to.color("")?);
        Ok((0..all.len()).filter(still).flat_map(|i| all[i]).collect())
    };
    Ok(rmse(&change(drawn)?, &change(truth)?))
}

fn silhouette(pixels: f64, exec: &Exec) -> Result<[Found; 2]> {
    // n surfels on the sphere have the radius sqrt(4 pi / n).
    let case = Case::of_shape(Shape::Sphere, 1000, pull_push())?;
    let radius = pixels * 4.0 / f64::from(case.camera.fy);
    let count = (4.0 * std::f64::consts::PI / (radius * radius)).round() as usize;
    let case = Case::of_shape(Shape::Sphere, count, pull_push())?;
    let truth = case.truth(&exact(Shape::Sphere), exec)?;
    case.and_cured(splatting(), &truth, "spill", exec)
}

fn cover(rows: f64, exec: &Exec) -> Result<[Found; 2]> {
    let method = |levels| -> Method {
        template::Settings { size: 5, levels, ..template::Settings::default() }.into()
    };
    let shape = Shape::Sphere;
    let mut case = Case::of_shape(shape, 2500, method(LevelRule::Radius))?;
    case.camera =
        Camera::new(rows as u32, rows as u32, shape.default_pose(), shape.default_lens())?;
    let truth = case.truth(&exact(shape), exec)?;
    case.and_cured(method(LevelRule::Diameter), &truth, "holes", exec)
}

fn mirror(surfels: f64, exec: &Exec) -> Result<[Found; 2]> {
    let method = template::Settings::default().into();
    Ok([mirrored(surfels, method, exec)?, mirrored(surfels, splatting(), exec)?])
}

fn mirrored(surfels: f64, method: Method, exec: &Exec) -> Result<Found> {
    let mut case = Case::of_shape(Shape::Sphere, surfels as usize, method)?;
    // The cells of all levels are mirrored too.
    case.camera =
        Camera::new(256, 256, Shape::Sphere.default_pose(), Shape::Sphere.default_lens())?;
    let (upright, time) = case.draw(exec)?;
    let mut cloud = case.scene.surfels.into_cloud();
    let turn = |v: &mut Vec3| v.x = -v.x;
    cloud.position.iter_mut().for_each(turn);
    cloud.normal.iter_mut().flatten().for_each(turn);
    case.scene = Scene::lit("mirrored", Surfels::new(cloud)?.0);
    let mirror = Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0));
    case.camera.view_from_world = mirror * case.camera.view_from_world * mirror;
    let mirrored = case.draw(exec)?.0;
    let error = turned(&upright, &mirrored)?;
    Ok(Found { error, picture: upright.color("")?.clone(), time: Some(time) })
}

/// The pixels whose mirrored normals differ by more than a degree, or that only one picture covers,
/// per mille of the pixels that either covers.
fn turned(upright: &Frame<f32>, mirrored: &Frame<f32>) -> Result<f64> {
    let normals = |frame: &Frame<f32>| -> Vec<DVec3> {
        let Some(Samples::Vector(plane)) = frame.plane("normal") else { return Vec::new() };
        plane.values().iter().map(|n| Vec3::from(*n).as_dvec3()).collect()
    };
    let (first, second) = (normals(upright), normals(mirrored));
    let (a, b) = (upright.scalar("A")?.values(), mirrored.scalar("A")?.values());
    let width = upright.width as usize;
    let limit = cos(1_f64.to_radians());
    let (mut covered, mut wrong) = (0, 0);
    for (i, n) in first.iter().enumerate() {
        let other = i - i % width + (width - 1 - i % width);
        let seen = [a[i] > 0.0, b[other] > 0.0];
        covered += u64::from(seen[0] || seen[1]);
        let back = second[other] * DVec3::new(-1.0, 1.0, 1.0);
        let differs = seen[0] != seen[1] || (seen[0] && n.dot(back) < limit);
        wrong += u64::from(differs);
    }
    Ok(1e3 * wrong as f64 / covered.max(1) as f64)
}

fn tube(vertices: f64, exec: &Exec) -> Result<[Found; 2]> {
    let agreeing = ring(vertices as u32, 1.0)?;
    let truth = agreeing.draw(exec)?.0;
    let alternating = ring(vertices as u32, -1.0)?;
    let found = |case: &Case| case.against(&truth, "rmse", exec);
    Ok([found(&alternating)?, found(&agreeing)?])
}

/// Three quarters of a ring as a tube with this many vertices; every second tangent is multiplied
/// by `sign`.
fn ring(count: u32, sign: f32) -> Result<Case> {
    let [width, height] = SIZE;
    let pose = Pose { eye: DVec3::Z * 5.0, target: DVec3::ZERO, up: DVec3::Y };
    let angle = |i: u32| 1.5 * std::f64::consts::PI * f64::from(i) / f64::from(count - 1);
    let at = |i: u32| DVec3::new(cos(angle(i)), sin(angle(i)), 0.0).as_vec3();
    let along = |i: u32| DVec3::new(-sin(angle(i)), cos(angle(i)), 0.0).as_vec3();
    let vertices = Vertices {
        position: (0..count).map(at).collect(),
        direction: (0..count).map(|i| along(i) * if i % 2 == 0 { 1.0 } else { sign }).collect(),
        radius: vec![0.125; count as usize],
        ..Vertices::default()
    };
    let (tubes, _) = Polylines::new(vertices, (1..count).map(|i| [i - 1, i]).collect())?;
    let primitives = Primitives { tubes, ..Primitives::default() };
    Ok(Case {
        scene: Scene { primitives, ..Scene::lit("tube", Surfels::none()) },
        camera: Camera::new(width, height, pose, Lens::FieldOfView(34.0))?,
        method: pull_push(),
        grouping: None,
    })
}
