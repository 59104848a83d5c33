//! One tree and ten trees, as triangles and as lines: \[MKC08, section 6, Fig. 13 and 19\].
//!
//! 1024 x 1024 pixels; each number is the median over the pictures of one run in milliseconds, the
//! minimum in brackets, the whole call. The paper's are from its frames a second, on a GPU of 2008
//! that draws triangles in hardware; here both are projected and rasterized by the same code, the
//! triangles without pull and push making a difference to what is seen.

use super::tree::scene;
use crate::common::report::{Arguments, Table};
use crate::common::sphere::cell;
use glam::{DVec3, Vec3};
use splatref::Result;
use splatref::frame::Exec;
use splatref::io::scene_file;
use splatref::method::{Session, pyramid};
use splatref::scene::indexed::Indexed;
use splatref::scene::{Camera, Lens, Primitives, Sphere};
use splatref::source::plant::{LEAVES, apple_tree};
use std::time::Instant;

const FRAMES: usize = 9;

pub(crate) fn table(arguments: &Arguments, exec: &Exec) -> Result<()> {
    let plant = apple_tree(LEAVES, 0)?;
    let kinds = [("triangles", plant.polygons()?), ("lines", plant.lines()?)];
    let mut table = Table::new(&["trees", "primitives", "ms", "paper, ms"]);
    for (trees, paper) in [(1, [1000.0 / 28.0, 1000.0 / 31.0]), (10, [1000.0 / 9.0, 1000.0 / 15.0])]
    {
        for ((kind, primitives), paper) in kinds.iter().zip(paper) {
            let name = format!("{trees}, {kind}");
            if name.contains(&arguments.pattern) {
                let scene = scene(grove(primitives, trees)?);
                let width = if trees == 1 { 1.8 } else { 6.0 };
                let lens = Lens::FieldOfView(scene_file::DEFAULT_FIELD_OF_VIEW);
                let sphere = Sphere { center: DVec3::new(0.0, 1.5, 0.0), radius: width };
                let camera = Camera::framing(1024, 1024, sphere, DVec3::Z, lens)?;
                let mut session = Session::new(&scene, pyramid::Settings::default().into(), exec)?;
                session.render(&camera)?;
                let mut times = Vec::new();
                for _ in 0..FRAMES {
                    let start = Instant::now();
                    session.render(&camera)?;
                    times.push(start.elapsed());
                }
                let count = scene.primitives.len();
                table.row(&format!("{name} | {count} | {} | {paper:.0}", cell(&mut times)));
            }
        }
    }
    table.publish_times(arguments, "image-space.md", "trees")
}

/// As many trees in two rows.
fn grove(tree: &Primitives, count: u32) -> Result<Primitives> {
    let Primitives { triangles, ribbons, tubes } = tree;
    Ok(Primitives {
        triangles: repeated(triangles, count)?,
        ribbons: repeated(ribbons, count)?,
        tubes: repeated(tubes, count)?,
    })
}

fn repeated<const N: usize>(one: &Indexed<N>, count: u32) -> Result<Indexed<N>> {
    let (mut vertices, mut corners) = (Default::default(), Vec::new());
    for i in 0..count {
        let middle = (count.min(5) - 1) as f32 / 2.0;
        let away = Vec3::new(((i % 5) as f32 - middle) * 2.2, 0.0, (i / 5) as f32 * -2.2);
        let (own, own_corners) = one.clone().into_parts();
        let splatref::scene::Vertices { position, direction, radius, color, .. } = &mut vertices;
        let first = position.len() as u32;
        position.extend(own.position.iter().map(|p| *p + away));
        direction.extend(own.direction);
        radius.extend(own.radius);
        if let Some(own) = own.color {
            color.get_or_insert_with(Vec::new).extend(own);
        }
        corners.extend(own_corners.into_iter().map(|corners| corners.map(|i| first + i)));
    }
    Ok(Indexed::new(vertices, corners)?.0)
}
