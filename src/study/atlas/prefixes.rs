//! Entries about prefixes of orders \[BJFM19, 6\], and about meshes drawn as surfels.

use super::case::{Case, SIZE, both, quiet};
use super::orders::{geometry, mesh, objects, order, order_along, seen, torus};
use super::{Failure, Found};
use crate::error::Result;
use crate::frame::{Exec, Plane};
use crate::method::blue::{self, controller::Controller};
use crate::method::{Method, ewa};
use crate::number::elementary::{cos, sin};
use crate::scene::{Camera, Cloud, Lens, Pose, Primitives, Scene, Similarity, Triangles, Vertices};
use crate::source::candidates::Directions;
use crate::source::derive::{self, Derive};
use crate::study::truth::Surface;
use glam::{DVec3, Vec3};

pub(super) const FAILURES: [Failure; 5] = [
    Failure {
        id: "mesh-paddles",
        title: "Vertices of thin triangles are paddles",
        why: "The vertices of a cylinder with 64 columns are drawn as surfels, and its triangles \
              become longer and longer. The derived radius is the longest edge, so that discs \
              cover the surface. Discs at long edges therefore stick out over the silhouette.",
        swept: "length of a triangle, its widths",
        values: &[1.0, 2.0, 4.0, 8.0, 16.0, 32.0],
        error: "spill, per mille",
        limit: 100.0,
        cure: "`--draw facets`: an ellipse for each triangle",
        at: paddles,
    },
    Failure {
        id: "blue-thin",
        title: "Walls that are nearer to each other than surfels are have holes",
        why: "The method blue draws a plate of 2 x 2 from the front. Its two sides have 500 \
              surfels together. The order keeps surfels apart in space, even if they are on \
              different sides [BJFM19, 6].",
        swept: "thickness, distances of surfels",
        values: &[4.0, 2.0, 1.0, 0.5, 0.25, 0.0625],
        error: "holes, per mille",
        limit: 10.0,
        cure: "`--distance geodesic`: distances along the surface",
        at: thin,
    },
    Failure {
        id: "blue-prefix",
        title: "Prefixes too short for their estimate have holes",
        why: "A torus of 20,000 ordered surfels is so far away that few surfels are needed. The \
              radius of a prefix is estimated from the first 1,000 surfels, as if each had the \
              same share of the area [BJFM19, 4.1]. A few surfels on a curved surface have unequal \
              shares.",
        swept: "surfels asked for",
        values: &[10_000.0, 1000.0, 300.0, 100.0, 30.0, 10.0, 3.0],
        error: "holes, per mille",
        limit: 5.0,
        cure: "at least 100 surfels, a `p_min` that no paper has; or a smaller `--surfel-size` for \
               small objects",
        at: short,
    },
    Failure {
        id: "blue-long",
        title: "Long objects have too many surfels far away",
        why: "A bar is seen along its length, in discs of 8 px. An object has one prefix, and its \
              nearest point chooses the length of the prefix [BJFM19, 6].",
        swept: "length, widths",
        values: &[1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0],
        error: "surfels a pixel in the farthest eighth, by the nearest",
        limit: 3.0,
        cure: "split the bar into objects as long as they are wide",
        at: long,
    },
    Failure {
        id: "blue-controller",
        title: "The frame-time controller swings",
        why: "From one moment on frames take four times as long, and their times are known some \
              frames late. The controller answers each late time with another step of the size \
              [BJFM19, 4.3]. Pictures: the sizes of the last 100 frames, one column per frame, \
              light up to the size; the height of the picture is the largest possible size.",
        swept: "frames until a time is known",
        values: &[0.0, 1.0, 2.0, 3.0, 4.0, 6.0],
        error: "largest size by smallest, of the last 100 of 1,000 frames",
        limit: 1.05,
        cure: "ask the controller again only when the time of its last answer is known",
        at: swing,
    },
];

fn blue() -> Method {
    blue::Settings::default().into()
}

/// Measures the holes in a view's picture against the triangles, without the cure and with it.
fn against(drawn: [Scene; 2], whole: &Scene, camera: Camera, exec: &Exec) -> Result<[Found; 2]> {
    let [plain, cured] = drawn.map(|scene| Case { scene, camera, method: blue(), grouping: None });
    let truth = plain.truth(&[Surface::Triangles(whole.primitives.triangles.clone())], exec)?;
    Ok([plain.against(&truth, "holes", exec)?, cured.against(&truth, "holes", exec)?])
}

fn camera(eye: DVec3, side: u32, lens: Lens) -> Result<Camera> {
    Camera::new(side, side, Pose { eye, target: DVec3::ZERO, up: DVec3::Y }, lens)
}

fn thin(gap: f64, exec: &Exec) -> Result<[Found; 2]> {
    // 500 surfels on both sides, 8 area units: about 0.136 apart.
    const APART: f64 = 0.136;
    let plate = cuboid(DVec3::new(1.0, 1.0, gap * APART / 2.0))?;
    let camera = camera(DVec3::new(0.0, 0.0, 5.0), 256, Lens::FieldOfView(30.0))?;
    let drawn = |order| {
        let objects = objects(geometry(order, Primitives::default())?, &[Similarity::IDENTITY])?;
        // Small enough that all surfels are needed, and large enough that they cover the surface.
        seen(&objects, 0.125, &camera, exec)
    };
    let plain = drawn(order(&plate, &Directions::Cube, 384, 500, exec)?)?;
    let cured = drawn(order_along(&plate, &Directions::Cube, 384, 500, exec)?)?;
    against([plain, cured], &plate, camera, exec)
}

fn short(count: f64, exec: &Exec) -> Result<[Found; 2]> {
    let torus = torus()?;
    let order = order(&torus, &Directions::Cube, 256, 20_000, exec)?;
    let objects = objects(geometry(order, Primitives::default())?, &[Similarity::IDENTITY])?;
    let pose = DVec3::new(2.0, 3.0, 5.0);
    let camera = camera(pose, 256, Lens::Orthographic(3.2))?;
    let drawn = |count: f64| {
        // The radius r of the chosen prefix, as a size in this picture.
        let radius = objects.geometries()[0].prefix().map_or(0.0, |prefix| {
            let estimate = prefix.estimate();
            f64::from(estimate.distance) * (f64::from(estimate.count) / count).sqrt()
        });
        let size = (2.0 * radius * f64::from(camera.fy)) as f32;
        seen(&objects, size, &camera, exec)
    };
    let cured = drawn(if count < 100.0 { 100.0 } else { count })?;
    against([drawn(count)?, cured], &torus, camera, exec)
}

fn long(length: f64, exec: &Exec) -> Result<[Found; 2]> {
    Ok([bar(length, 1, exec)?, bar(length, length as u32, exec)?])
}

/// A bar of this many pieces.
fn bar(length: f64, pieces: u32, exec: &Exec) -> Result<Found> {
    let piece = length / f64::from(pieces);
    let bar = cuboid(DVec3::new(0.5, 0.5, piece / 2.0))?;
    let order = order(&bar, &Directions::Cube, 512, 50_000, exec)?;
    let places: Vec<Similarity> = (0..pieces)
        .map(|i| {
            let z = (f64::from(i) + 0.5) * piece - length / 2.0;
            Similarity { translation: DVec3::Z * z, ..Similarity::IDENTITY }
        })
        .collect();
    let objects = objects(geometry(order, Primitives::default())?, &places)?;
    let eye = DVec3::new(1.0, 1.0, length / 2.0 + 8.0);
    let pose = Pose { eye, target: DVec3::Z * (length / 2.0), up: DVec3::Y };
    let camera = Camera::new(256, 256, pose, Lens::FieldOfView(20.0))?;
    let scene = seen(&objects, 8.0, &camera, exec)?;
    // A piece of a side between two depths has 1 / t^2 of its area in pixels, times a common
    // factor.
    let density = |near: bool| {
        let eighth = |z: f64| if near { z > 0.375 * length } else { z < -0.375 * length };
        let all = scene.surfels.position().iter().map(|p| f64::from(p.z));
        let surfels = all.filter(|z| eighth(*z)).count() as f64;
        let from = if near { 8.0 } else { 8.0 + 0.875 * length };
        surfels / (1.0 / from - 1.0 / (from + 0.125 * length))
    };
    let error = density(false) / density(true);
    let case = Case { scene, camera, method: blue(), grouping: None };
    let (frame, time) = case.draw(exec)?;
    Ok(Found { error, picture: frame.color("")?.clone(), time: Some(time) })
}

/// Simulates surfels that take `s^-2` of the target's time at the size 1.25, and four times as long
/// from frame 0 on.
fn swing(late: f64, _: &Exec) -> Result<[Found; 2]> {
    both(|cured| swings(late as usize, cured))
}

/// With the cure, the controller is asked only when the time of its last answer is known.
fn swings(late: usize, cured: bool) -> Result<Found> {
    let controller = Controller::new(1.0)?;
    let mut sizes = vec![1.25_f32; late + 1];
    for frame in 0..1000 {
        let at = |back: usize| sizes[sizes.len() - 1 - back];
        let known = f64::from(at(late));
        let waits = cured && frame % (late + 1) != late;
        let time = 1.25 * 1.25 * 4.0 / (known * known);
        let next = if waits { at(0) } else { controller.next(at(0), time) };
        sizes.push(next);
    }
    let last = &sizes[sizes.len() - 100..];
    let ends = last.iter().fold([f32::INFINITY, 0.0], |[least, most], &size| {
        [if size < least { size } else { least }, if size > most { size } else { most }]
    });
    let error = f64::from(ends[1]) / f64::from(ends[0]);
    Ok(Found { error, picture: columns(last, controller.sizes[1]), time: None })
}

/// Draws sizes as columns of light two pixels wide; the size `most` has the height of the picture.
fn columns(sizes: &[f32], most: f32) -> Plane<[f32; 3]> {
    const HIGH: u32 = 96;
    let row = |y: u32| {
        sizes.iter().flat_map(move |size| {
            let lit = (HIGH - y) as f32 <= size / most * HIGH as f32;
            [[if lit { 1.0 } else { 0.0 }; 3]; 2]
        })
    };
    Plane::from_values(2 * sizes.len() as u32, HIGH, (0..HIGH).flat_map(row).collect())
}

fn paddles(aspect: f64, exec: &Exec) -> Result<[Found; 2]> {
    let cloud = cylinder(64, aspect);
    let (triangles, _) = derive::polygons(cloud.clone(), exec, &quiet)?;
    let (facets, _) = derive::facets(cloud.clone(), exec, &quiet)?;
    let (surfels, _) = derive::surfels(cloud, &Derive::default(), exec, &quiet)?;
    let scene = |surfels| Scene::lit("cylinder", surfels);
    let [width, height] = SIZE;
    let pose = Pose { eye: DVec3::new(0.0, 1.0, 8.0), target: DVec3::ZERO, up: DVec3::Y };
    let case = Case {
        scene: scene(surfels),
        camera: Camera::new(width, height, pose, Lens::FieldOfView(34.0))?,
        method: ewa::Settings::default().into(),
        grouping: None,
    };
    let truth = case.truth(&[Surface::Triangles(triangles)], exec)?;
    let plain = case.against(&truth, "spill", exec)?;
    Ok([plain, Case { scene: scene(facets), ..case }.against(&truth, "spill", exec)?])
}

/// A cylinder of radius 1, about 3 high, with this many columns around. The rows are chosen so that
/// triangles are this many times as long as they are wide.
fn cylinder(columns: u32, aspect: f64) -> Cloud {
    let width = std::f64::consts::TAU / f64::from(columns);
    let rows = (3.0 / (width * aspect)).round() as u32;
    let rows = if rows > 0 { rows } else { 1 };
    let high = width * aspect * f64::from(rows);
    let mut cloud = Cloud::default();
    let mut normal = Vec::new();
    for j in 0..=rows {
        for i in 0..columns {
            let angle = std::f64::consts::TAU * f64::from(i) / f64::from(columns);
            let out = DVec3::new(sin(angle), 0.0, cos(angle));
            let y = (f64::from(j) / f64::from(rows) - 0.5) * high;
            cloud.position.push((out + DVec3::Y * y).as_vec3());
            normal.push(out.as_vec3());
        }
    }
    for j in 0..rows {
        for i in 0..columns {
            let (a, b) = (j * columns + i, j * columns + (i + 1) % columns);
            cloud.triangles.extend([[a, b, b + columns], [a, b + columns, a + columns]]);
        }
    }
    cloud.normal = Some(normal);
    cloud
}

/// A box around the origin; vertices have the normals of its faces.
fn cuboid(half: DVec3) -> Result<Scene> {
    let mut vertices = Vertices::default();
    let mut corners = Vec::new();
    for face in 0..6 {
        let (axis, sign) = (face % 3, if face < 3 { 1.0 } else { -1.0 });
        let first = vertices.position.len() as u32;
        for (i, j) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
            let mut p = DVec3::ZERO;
            (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (sign, i * sign, j);
            let mut normal = Vec3::ZERO;
            normal[axis] = sign as f32;
            vertices.position.push((p * half).as_vec3());
            vertices.direction.push(normal);
            vertices.radius.push(0.0);
        }
        corners.extend([[first, first + 2, first + 3], [first, first + 3, first + 1]]);
    }
    Ok(mesh(Triangles::new(vertices, corners)?.0))
}
