//! Reach: the share of a single ellipse's pixels that are painted.
//!
//! One disc, alone in a picture of 256 x 256 pixels under an orthographic camera of one pixel a
//! unit, at random places, which are as many offsets to the grids of all levels; tilted by 0, 45 or
//! 75 degrees towards random sides. Its pixels are those whose centres the ellipse around its
//! projected centre holds. The pyramid's ellipse is around the centre of the pixel that its centre
//! falls into, so a share below 1 is that too where discs are small. Painted pixels that are none
//! of the disc's: `beyond`.

use super::common::report::Table;
use super::{Bench, methods};
use glam::{DVec3, Vec3};
use splatref::Result;
use splatref::frame::Samples;
use splatref::method::{Method, Session};
use splatref::number::Vector3;
use splatref::number::elementary::{cos, sin};
use splatref::number::random::unit;
use splatref::scene::{Camera, Cloud, Lens, Pose, Scene, Surfels};
use splatref::splat::Ellipse;

const SIDE: u32 = 256;
const PLACES: u64 = 64;
const TILTS: [f64; 3] = [0.0, 45.0, 75.0];
const RADII: [f32; 10] = [0.25, 0.5, 1.0, 1.5, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0];
const METHODS: [&str; 10] = [
    "pyramid",
    "3, radius",
    "5, radius",
    "7, radius",
    "3, diameter",
    "5, diameter",
    "7, diameter",
    "3, covering",
    "5, covering",
    "7, covering",
];

/// Pixels of discs, and how many of them are painted; and painted ones beyond.
#[derive(Default)]
struct Count {
    pixels: u64,
    painted: u64,
    beyond: u64,
    /// The least share of a disc that has pixels.
    least: f64,
}

impl Bench {
    /// The table.
    pub(super) fn reach(&self) -> Result<()> {
        println!("\nReach: painted pixels of a single disc by all its pixels, per cent");
        let columns: Vec<_> = ["tilt, degrees", "radius, px"].into_iter().chain(METHODS).collect();
        let mut table = Table::new(&columns);
        let found = methods();
        let chosen: Vec<_> = found.iter().filter(|m| METHODS.contains(&m.0)).collect();
        for tilt in TILTS {
            for radius in RADII {
                let count = |(_, method): &&(&str, Method)| {
                    let counted = self.count(radius, tilt, method)?;
                    let percent = 100.0 / counted.pixels.max(1) as f64;
                    let [mean, beyond] =
                        [counted.painted, counted.beyond].map(|n| n as f64 * percent);
                    Ok(format!("{mean:.1} ({:.0}) + {beyond:.1}", 100.0 * counted.least))
                };
                let cells: Vec<_> = chosen.iter().map(count).collect::<Result<_>>()?;
                table.row(&format!("{tilt} | {radius} | {}", cells.join(" | ")));
            }
        }
        table.publish(&self.arguments, "image-space.md", "reach")
    }

    fn count(&self, radius: f32, tilt: f64, method: &Method) -> Result<Count> {
        let mut count = Count { least: 1.0, ..Count::default() };
        for place in 0..PLACES {
            let (scene, camera) = disc(radius, tilt, place)?;
            let mut session = Session::with_groups(&scene, *method, None, &self.exec)?;
            let drawn = session.render(&camera)?;
            let Some(Samples::Scalar(alpha)) = drawn.frame.plane("A") else { continue };
            let surfels = &scene.surfels;
            let (p, n) = (surfels.position()[0].as_dvec3(), surfels.normal()[0].as_dvec3());
            let ellipse = Ellipse::new(Vector3::new(n.x, n.y, n.z), f64::from(radius));
            let (mut pixels, mut painted) = (0, 0);
            for (i, alpha) in (0_u32..).zip(alpha.values()) {
                let [x, y] = [i % SIDE, i / SIDE].map(|v| f64::from(v) + 0.5);
                let half = f64::from(SIDE) / 2.0;
                let inside = ellipse.holds(ellipse.form(x - half - p.x, y - half + p.y));
                pixels += u64::from(inside);
                painted += u64::from(inside && *alpha > 0.0);
                count.beyond += u64::from(!inside && *alpha > 0.0);
            }
            count.pixels += pixels;
            count.painted += painted;
            let share = if pixels > 0 { painted as f64 / pixels as f64 } else { 1.0 };
            count.least = if share < count.least { share } else { count.least };
        }
        Ok(count)
    }
}

/// A disc at a random place in the middle quarter, before its camera.
fn disc(radius: f32, tilt: f64, place: u64) -> Result<(Scene, Camera)> {
    let [x, y, turn] = [0, 1, 2].map(|k| unit(3, 3 * place + k));
    let (angle, tilt) = (f64::from(turn) * std::f64::consts::TAU, tilt.to_radians());
    let normal = DVec3::new(sin(tilt) * cos(angle), sin(tilt) * sin(angle), cos(tilt));
    let quarter = SIDE as f32 / 4.0;
    let cloud = Cloud {
        position: vec![Vec3::new((x - 0.5) * quarter, (y - 0.5) * quarter, 0.0)],
        normal: Some(vec![normal.as_vec3()]),
        radius: Some(vec![radius]),
        ..Cloud::default()
    };
    let pose = Pose { eye: DVec3::new(0.0, 0.0, 1024.0), target: DVec3::ZERO, up: DVec3::Y };
    let camera = Camera::new(SIDE, SIDE, pose, Lens::Orthographic(f64::from(SIDE)))?;
    Ok((Scene::lit("disc", Surfels::new(cloud)?.0), camera))
}
