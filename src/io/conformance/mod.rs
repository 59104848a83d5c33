//! Write a case of the [suite](crate::verdict::conformance) as a folder of files that a renderer in any
//! language can read.
//!
//! | file | what it holds |
//! |---|---|
//! | `README.md` | what the case tests, the settings, and the planes to leave |
//! | `scene.toml` | the scene file, for `splatref render` and `splatref verify` |
//! | `surfels.ply` | the surfels, with their groups |
//! | `splats.glb`, `splats.ply` | 3D Gaussians in their place; the PLY, of sRGB colours only, has logarithms and logits, which are rounded |
//! | `scene.json` | camera, settings, lights and material as plain numbers |
//! | `positions.npy`, `normals.npy`, `radii.npy` | the surfels as arrays: `float32`, (n, 3) or (n,) |
//! | `colors.npy`, `opacities.npy`, `half_axes.npy` | if the scene has them: (n, 3), (n,), (n, 6) |
//! | `prefiltered.npy` | prefiltered colours, if any: (n, 3 levels) |
//! | `positions.npy`, `scales.npy`, `rotations.npy`, `opacities.npy`, `harmonics.npy` | Gaussians as arrays: (n, 3), (n, 3), quaternions (x, y, z, w) (n, 4), (n,), (n, 3 (degree + 1)^2) coefficient by coefficient |
//! | `surface.exr` | the opaque geometry that splats are mixed with, if any: depths `Z`, colours `R`, `G`, `B` |
//! | `members.npy` | `uint32` (m, 2): pairs of a surfel and a group, if the method draws groups |
//! | `polygons.ply`, `ribbons.ply`, `tubes.ply` | the primitives, if any |
//! | `polygons-positions.npy`, and so on | their vertices: positions, directions, radii, colors; and their corners as `uint32` |
//! | `reference.exr`, `reference.png` | all planes as splatref draws them, and the picture |
//! | `records.bin` | the projected splats, [`Records`](crate::method::Records), if the method draws splats |

mod index;
mod json;
mod page;

use super::gaussians;
use super::npy::{self, Values};
use super::replace::write_atomically;
use super::scene_file::{
    CameraChoice, Draw, EnvironmentChoice, MethodChoice, Model, OutputSettings, SceneFile, Source,
};
use super::{exr, ply, png, provenance};
use crate::error::{Error, Result};
use crate::frame::{Exec, Frame, Samples};
use crate::method::Method;
use crate::scene::gaussians::Encoding;
use crate::scene::indexed::Indexed;
use crate::scene::{Gaussians, Intrinsics, Vertices};
use crate::setting::Fields;
use crate::verdict::conformance::{Case, Draws, Rule};
use glam::Vec3;
use std::fs;
use std::io::Write;
use std::path::Path;

/// The file of the Gaussians, which holds every number as it is.
const SPLATS: &str = "splats.glb";
/// The file of the surface.
const SURFACE: &str = "surface.exr";

/// Writes the files of a case into a folder, which is made if it does not exist.
///
/// # Errors
/// [`Error::Io`] if a file cannot be written; [`Error::Invalid`] as [`Case::planes`], or if the path
/// is not Unicode.
pub fn write(folder: &Path, rule: &Rule, case: &Case, exec: &Exec) -> Result<()> {
    fs::create_dir_all(folder).map_err(|source| Error::io(folder, source))?;
    match &case.scene.gaussians {
        Some(splats) => {
            // A PLY has no linear colours.
            let ply = (splats.encoding() == Encoding::Srgb).then_some("splats.ply");
            for name in ply.into_iter().chain([SPLATS]) {
                gaussians::write(&folder.join(name), splats, case.scene.offset)?;
            }
        }
        None => ply::write(&folder.join("surfels.ply"), &case.scene.surfels.clone().into_cloud())?,
    }
    for (cloud, draws) in &case.meshes {
        ply::write(&folder.join(format!("{}.ply", draws.word())), cloud)?;
    }
    if let Some(surface) = &case.scene.surface {
        let [width, height] = surface.size();
        let frame =
            Frame::new(width, height).with("Z", Samples::Scalar(surface.depths().clone()))?;
        let frame = frame.with("", Samples::Color(surface.colors().clone()))?;
        exr::write(&folder.join(SURFACE), &frame, "")?;
    }
    let scene = folder.join("scene.toml");
    text(&scene, &scene_file(folder, case).text(&scene)?)?;
    arrays(folder, case)?;
    let records = case.method.records(&case.scene, &case.camera, exec);
    if let Some(records) = &records {
        write_atomically(&folder.join("records.bin"), |file| records.write(file))?;
    }
    text(&folder.join("scene.json"), &json::text(rule, case)?)?;
    let frame = case.session(exec)?.define::<f32>(&case.camera, true)?.frame;
    let (scene, method) = (&case.scene, &case.method);
    let groups = scene.surfels.groups();
    let says = provenance::text(scene, groups, &case.camera, method, OutputSettings::default());
    exr::write(&folder.join("reference.exr"), &frame, &says)?;
    png::write_frame(&folder.join("reference.png"), &frame)?;
    text(
        &folder.join("README.md"),
        &page::text(rule, case, records.as_ref(), &case.planes_of(&frame)),
    )
}

/// Writes the page of a suite into the folder that holds the folders of its cases. `options` are
/// those of the command `conformance` that writes these rules, such as `ewa --only rim`.
///
/// # Errors
/// [`Error::Io`] if it cannot be written.
pub fn write_index(folder: &Path, method: &Method, options: &str, rules: &[Rule]) -> Result<()> {
    fs::create_dir_all(folder).map_err(|source| Error::io(folder, source))?;
    text(&folder.join("README.md"), &index::text(method, options, rules))
}

fn text(path: &Path, text: &str) -> Result<()> {
    write_atomically(path, |file| file.write_all(text.as_bytes()))
}

/// The scene file of a case, whose models lie in this folder.
#[must_use]
pub fn scene_file(folder: &Path, case: &Case) -> SceneFile {
    let file = |name: &str| Source::File {
        path: folder.join(name),
        radius: None,
        prefix: None,
        texture: None,
        color_range: None,
        color_by: None,
    };
    let splats = case.scene.gaussians.is_some();
    let mut scene = SceneFile::of_model(file(if splats { SPLATS } else { "surfels.ply" }));
    if !splats {
        scene.models[0].draw = Draw::Points;
    }
    for (_, draws) in &case.meshes {
        let draw = match draws {
            Draws::Polygons => Draw::Polygons,
            Draws::Ribbons => Draw::Ribbons,
            Draws::Tubes => Draw::Tubes,
        };
        let source = file(&format!("{}.ply", draws.word()));
        scene.models.push(Model { draw, source, ..scene.models[0].clone() });
    }
    let mut method = MethodChoice { name: Some(case.method.name()), ..MethodChoice::default() };
    for (name, value) in case.method.values() {
        method.settings.push(name, value);
    }
    SceneFile {
        name: case.rule.clone(),
        camera: camera(case),
        lights: case.scene.lights.clone(),
        material: case.scene.material,
        environment: case.scene.environment.is_some().then_some(EnvironmentChoice::Sky),
        surface: case.scene.surface.is_some().then(|| folder.join(SURFACE)),
        method,
        ..scene
    }
}

/// The camera by all its numbers.
fn camera(case: &Case) -> CameraChoice {
    let camera = &case.camera;
    let [f, c] = [[camera.fx, camera.fy], [camera.cx, camera.cy]].map(|pair| pair.map(f64::from));
    CameraChoice {
        size: Some(camera.size()),
        view: Some(camera.view_from_world.as_dmat4()),
        intrinsics: Some(Intrinsics { size: camera.size(), projection: camera.projection, f, c }),
        near: Some(camera.near.into()),
        ..CameraChoice::default()
    }
}

/// The numbers of some vectors, one after the other.
fn flat(all: &[Vec3]) -> Vec<f32> {
    all.iter().flat_map(|v| v.to_array()).collect()
}

/// Writes the surfels and the primitives as arrays.
fn arrays(folder: &Path, case: &Case) -> Result<()> {
    let surfels = &case.scene.surfels;
    if let Some(splats) = &case.scene.gaussians {
        return splat_arrays(folder, splats);
    }
    let floats = |name: &str, values: &[f32], columns: usize| {
        npy::write(&folder.join(format!("{name}.npy")), Values::Floats(values), columns)
    };
    floats("positions", &flat(surfels.position()), 3)?;
    floats("normals", &flat(surfels.normal()), 3)?;
    floats("radii", surfels.radius(), 1)?;
    surfels.color().map_or(Ok(()), |color| floats("colors", &flat(color), 3))?;
    surfels.opacity().map_or(Ok(()), |opacity| floats("opacities", opacity, 1))?;
    if let Some(tangents) = surfels.tangents() {
        floats("half_axes", &flat(&tangents.concat()), 6)?;
    }
    if let Some(mipmap) = surfels.mipmap() {
        floats("prefiltered", &flat(mipmap.colors()), 3 * mipmap.levels())?;
    }
    if let Some(groups) = surfels.groups() {
        let of = |surfel: u32| groups.of_surfel(surfel).map(move |group| [surfel, group.into()]);
        let members: Vec<u32> = (0..surfels.len() as u32).flat_map(of).flatten().collect();
        npy::write(&folder.join("members.npy"), Values::Wholes(&members), 2)?;
    }
    let all = &case.scene.primitives;
    primitives(folder, Draws::Polygons, &all.triangles)?;
    primitives(folder, Draws::Ribbons, &all.ribbons)?;
    primitives(folder, Draws::Tubes, &all.tubes)
}

/// Writes Gaussians as arrays.
fn splat_arrays(folder: &Path, splats: &Gaussians) -> Result<()> {
    let floats = |name: &str, values: &[f32], columns: usize| {
        npy::write(&folder.join(format!("{name}.npy")), Values::Floats(values), columns)
    };
    floats("positions", &flat(splats.position()), 3)?;
    floats("scales", &flat(splats.scale()), 3)?;
    floats("rotations", &splats.rotation().concat(), 4)?;
    floats("opacities", splats.opacity(), 1)?;
    floats("harmonics", &flat(splats.all_harmonics()), 3 * splats.harmonics(0).len())
}

/// Writes primitives as arrays, if there are any.
fn primitives<const N: usize>(folder: &Path, draws: Draws, all: &Indexed<N>) -> Result<()> {
    if all.is_empty() {
        return Ok(());
    }
    let place = |name: &str| folder.join(format!("{}-{name}.npy", draws.word()));
    let Vertices { position, direction, radius, color, .. } = all.vertices();
    npy::write(&place("positions"), Values::Floats(&flat(position)), 3)?;
    npy::write(&place("directions"), Values::Floats(&flat(direction)), 3)?;
    npy::write(&place("radii"), Values::Floats(radius), 1)?;
    if let Some(color) = color {
        npy::write(&place("colors"), Values::Floats(&flat(color)), 3)?;
    }
    npy::write(&place("corners"), Values::Wholes(&all.corners().concat()), N)
}
