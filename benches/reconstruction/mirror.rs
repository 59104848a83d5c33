//! What becomes of a picture when its scene is mirrored.
//!
//! With S = diag(-1, 1, 1) every position and normal becomes S times it, and the view matrix V
//! becomes S V S: view space is mirrored exactly, with the same roundings. Pictures have 512 x 512
//! pixels, so that the cells of all levels mirror too. What differs in the second picture, mirrored
//! back, comes from the order in which a method asks.
//!
//! - turned: painted pixels whose normals differ by more than a degree, per mille of the painted
//! - worst: the largest angle between the two normals of a pixel, degrees
//! - painted: pixels that only one of the two pictures paints, per mille of the painted

use super::common::report::Table;
use super::common::shot::Shot;
use super::{Bench, EWA, Subject, methods, splatting};
use glam::{Mat4, Vec3};
use splatref::Result;
use splatref::frame::{Frame, Samples};
use splatref::method::Method;
use splatref::number::Real;
use splatref::number::elementary::atan2;
use splatref::scene::{Camera, Scene, Surfels};

const SIDE: u32 = 512;
const SCENES: [&str; 6] = ["sphere 10 k", "torus 10 k", "cluster 10 k", "bunny", "dragon", "koala"];
const METHODS: [&str; 4] = ["pyramid", "3, radius", "5, diameter", "7, diameter"];

impl Bench {
    /// The table.
    pub(super) fn mirror(&self, subjects: &[Subject]) -> Result<()> {
        println!("\nMirrored: turned, worst, painted");
        let columns: Vec<_> = ["scene", EWA].into_iter().chain(METHODS).collect();
        let mut table = Table::new(&columns);
        let chosen = methods().into_iter().filter(|m| METHODS.contains(&m.0));
        let methods: Vec<_> = [(EWA, splatting())].into_iter().chain(chosen).collect();
        for subject in subjects.iter().filter(|s| SCENES.contains(&s.name.as_str())) {
            let camera = square(&subject.camera);
            let other = mirrored(subject, &camera)?;
            let cells = |(_, method): &(&str, Method)| {
                let upright = self.draw(subject, &camera, method)?;
                Ok(compared(upright, self.draw(&other, &other.camera, method)?))
            };
            let cells: Vec<_> = methods.iter().map(cells).collect::<Result<_>>()?;
            table.row(&format!("{} | {}", subject.name, cells.join(" | ")));
        }
        table.publish(&self.arguments, "image-space.md", "mirror")
    }
}

/// The same view, of a square.
fn square(camera: &Camera) -> Camera {
    let (scale, middle) = (SIDE as f32 / camera.height as f32, SIDE as f32 / 2.0);
    let (fx, fy) = (camera.fx * scale, camera.fy * scale);
    Camera { width: SIDE, height: SIDE, fx, fy, cx: middle, cy: middle, ..*camera }
}

/// The scene and its camera mirrored; radii, colours and order stay.
fn mirrored(subject: &Subject, camera: &Camera) -> Result<Subject> {
    let mut cloud = subject.scene.surfels.clone().into_cloud();
    let turn = |v: &mut Vec3| v.x = -v.x;
    cloud.position.iter_mut().for_each(turn);
    cloud.normal.iter_mut().flatten().for_each(turn);
    let scene = Scene::lit(&subject.name, Surfels::new(cloud)?.0);
    let mirror = Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0));
    let view_from_world = mirror * camera.view_from_world * mirror;
    let camera = Camera { view_from_world, ..*camera };
    Ok(Subject { name: subject.name.clone(), scene, camera, shape: None })
}

fn normals(frame: &Frame<f32>) -> Vec<Vec3> {
    let Some(Samples::Vector(plane)) = frame.plane("normal") else { return Vec::new() };
    plane.values().iter().map(|n| Vec3::from(*n)).collect()
}

/// A cell of the table.
fn compared(upright: Frame<f32>, mirrored: Frame<f32>) -> String {
    let (first, second) = (normals(&upright), normals(&mirrored));
    let (upright, mirrored) = (Shot::of(upright), Shot::of(mirrored));
    let width = SIDE as usize;
    let (mut turned, mut worst, mut single, mut painted) = (0, 0.0_f64, 0, 0);
    for (i, (alpha, first)) in upright.alpha.values().iter().zip(first).enumerate() {
        let other = i - i % width + (width - 1 - i % width);
        let (a, b) = (*alpha > 0.0, mirrored.alpha.values()[other] > 0.0);
        painted += u64::from(a);
        single += u64::from(a != b);
        if a && b {
            let second = second[other] * Vec3::new(-1.0, 1.0, 1.0);
            let [first, second] = [first, second].map(Vec3::as_dvec3);
            let angle = atan2(first.cross(second).length(), first.dot(second)).to_degrees();
            worst = worst.at_least(angle);
            turned += u64::from(angle > 1.0);
        }
    }
    let [turned, single] = [turned, single].map(|n| 1e3 * n as f64 / painted.max(1) as f64);
    format!("{turned:.1}, {worst:.0}, {single:.2}")
}
