//! What lies in one plane: the first that is drawn is seen.

use super::whole::{alone, check, patch, settings};
use crate::oracle::kit::dice::Dice;
use glam::{DVec3, Vec3};
use splatref::SceneFile;
use splatref::io::ply;
use splatref::scene::Cloud;
use splatref::source::candidates::Directions;
use splatref::source::hierarchy::{Settings, Traversal};
use tempfile::TempDir;

/// A flat square of 2 n n triangles around the origin, in one colour.
fn flat(n: u32, color: Vec3) -> Cloud {
    let mut cloud = patch(&mut Dice(1), n, false);
    for (i, p) in (0..).zip(&mut cloud.position) {
        *p = Vec3::new((i % (n + 1)) as f32, (i / (n + 1)) as f32, 0.0) / n as f32 - 0.5;
        p.z = 0.0;
    }
    cloud.normal = Some(vec![Vec3::Z; cloud.position.len()]);
    cloud.color = Some(vec![color; cloud.position.len()]);
    cloud
}

/// Where all lies in one plane the first in the order of what is drawn is seen: a node's own triangles
/// before its children, and its objects before its nodes.
#[test]
fn what_ties_is_drawn_in_the_order_of_the_page() {
    let at = TempDir::new().expect("a folder");
    let mut both = flat(75, Vec3::X);
    let count = both.position.len() as u32;
    let large = flat(1, Vec3::Y);
    both.position.extend(large.position);
    both.normal.as_mut().expect("normals").extend(large.normal.expect("normals"));
    both.color.as_mut().expect("colours").extend(large.color.expect("colours"));
    both.triangles.extend(large.triangles.into_iter().map(|t| t.map(|v| v + count)));
    let file = alone(&at, &both);
    ply::write(&at.path().join("flat.ply"), &flat(25, Vec3::Z)).expect("a mesh");
    let mut scene =
        "[[geometry]]\nfile = \"flat.ply\"\nname = \"flat\"\ndraw = \"polygons\"\n".to_owned();
    for i in 0..13 {
        let scale = if i < 12 { 0.75 } else { 6.0 };
        let colors = ["[1, 0, 0]", "[0, 1, 0]", "[0, 0, 1]"];
        scene += &format!("[[object]]\nof = \"flat\"\ncolor = {}\n", colors[i % 3]);
        let at = [i % 4, i / 4].map(|c| c as f32 - 1.5);
        scene +=
            &format!("transform = {{ scale = {scale}, translate = [{}, {}, 0] }}\n", at[0], at[1]);
    }
    let path = at.path().join("objects.toml");
    std::fs::write(&path, scene).expect("a scene");
    let objects = SceneFile::read(&path).expect("a scene");
    for traversal in [Traversal::BottomUp, Traversal::TopDown] {
        let directions = Directions::These(vec![DVec3::Z]);
        let settings = Settings { traversal, directions, ..settings() };
        assert!(check("triangles that tie", &file, &[0], &settings) > 0);
        assert!(check("objects that tie", &objects, &[0], &settings) > 1);
    }
}
