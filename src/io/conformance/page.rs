//! The page of a case: what it tests, and what the renderer must leave.

use crate::method::Records;
use crate::method::{PlaneRow, Stage};
use crate::setting::Fields;
use crate::verdict::conformance::{Case, Rule};
use std::fmt::Write;

/// The files of a scene of Gaussians.
pub(super) const SPLATS: &[[&str; 2]] = &[
    ["scene.toml", "the scene file, for `splatref render` and `splatref verify`"],
    ["scene.json", "camera and settings as plain numbers"],
    ["splats.glb", "the Gaussians (`KHR_gaussian_splatting`), every number as it is"],
    [
        "splats.ply",
        "the same as the original program stores them: its logarithms and logits are rounded; not of \
         linear colours",
    ],
    [
        "positions.npy, scales.npy, rotations.npy, opacities.npy",
        "the Gaussians as arrays; a rotation is a quaternion (x, y, z, w)",
    ],
    ["harmonics.npy", "the coefficients of each Gaussian, one colour after the other"],
    REFERENCE,
];

/// The files of a scene of surfels.
pub(super) const FILES: &[[&str; 2]] = &[
    ["scene.toml", "the scene file, for `splatref render` and `splatref verify`"],
    ["scene.json", "camera, settings, lights and material as plain numbers"],
    ["surfels.ply", "the surfels"],
    [
        "positions.npy, normals.npy, radii.npy",
        "the surfels as arrays; colors.npy, opacities.npy, half_axes.npy (two vectors a surfel), prefiltered.npy \
         if the scene has them",
    ],
    REFERENCE,
];

const REFERENCE: [&str; 2] =
    ["reference.exr, reference.png", "all planes, as splatref draws them, and the picture"];

/// The text of `README.md`. `records` are those of the case, if it has any.
pub(super) fn text(
    rule: &Rule,
    case: &Case,
    records: Option<&Records>,
    planes: &[(&'static Stage, Vec<&'static PlaneRow>)],
) -> String {
    let mut page = format!("# {}: {}\n\n{}\n\n", case.method.name(), rule.name, rule.tests);
    // Writing into a string cannot fail.
    let _ = specification(&mut page, case)
        .and_then(|()| draw(&mut page, case, records))
        .and_then(|()| leave(&mut page, planes));
    page.push_str(
        "\n## Look closer\n\nRun these in this folder; `client.exr` is your file.\n\n```sh\n\
         splatref verify scene.toml client.exr\n\
         splatref explain scene.toml X Y --client client.exr\n```\n",
    );
    page
}

/// Where the formulas are.
fn specification(page: &mut String, case: &Case) -> std::fmt::Result {
    let Case { scene, method, .. } = case;
    let module = method.name().replace('-', "_");
    let mut pages = vec![format!("`splatref::method::{module}`")];
    if method.splats().is_some() {
        pages.push("`splatref::splat::project` and `splatref::splat::Footprint`".into());
    }
    if method.draws_gaussians() {
        pages.push("`splatref::splat::gaussian` and `splatref::shade::harmonics`".into());
    } else if !scene.lights.is_empty() {
        pages.push("`splatref::shade`".into());
    }
    if scene.environment.is_some() {
        pages.push("`splatref::scene::environment`".into());
    }
    if scene.surface.is_some() {
        pages.push("`splatref::scene::surface`".into());
    }
    let pages = pages.join(", ");
    writeln!(page, "The specification, in splatref's rustdoc: {pages}.\n")
}

fn draw(page: &mut String, case: &Case, records: Option<&Records>) -> std::fmt::Result {
    let Case { scene, camera, method, .. } = case;
    writeln!(page, "## Draw\n\n| file | what it holds |\n|---|---|")?;
    let files = if scene.gaussians.is_some() { SPLATS } else { FILES };
    for [name, what] in files {
        writeln!(page, "| {name} | {what} |")?;
    }
    for (_, draws) in &case.meshes {
        let word = draws.word();
        writeln!(page, "| {word}.ply, {word}-*.npy | {word}; numbered after the surfels |")?;
    }
    if scene.surface.is_some() {
        let what = "the opaque geometry that the splats are mixed with: depths Z, colours R, G, B";
        writeln!(page, "| surface.exr | {what} |")?;
    }
    if scene.surfels.groups().is_some() {
        let what = "pairs of a surfel and a group that it is drawn into";
        writeln!(page, "| members.npy | {what}; scene.json has the scale of each group's radii |")?;
    }
    if records.is_some() {
        let what = "the visible splats, projected; use them to leave out your own projection";
        writeln!(page, "| records.bin | {what} |")?;
    }
    writeln!(
        page,
        "\nMatrices are by rows and multiply column vectors. Depth is the distance along the view direction."
    )?;
    writeln!(page, "\n| setting | value |\n|---|---|")?;
    for (name, value) in method.values() {
        writeln!(page, "| {name} | {} |", value.text())?;
    }
    for (name, value) in method.settings_in_scene(scene, camera) {
        writeln!(page, "| {name} | {value} |")?;
    }
    let Some(records) = records else { return Ok(()) };
    let (size, shared) = (records.layout.size, &records.shared);
    writeln!(
        page,
        "\nA record has {size} bytes, little-endian:\n\n| offset | field | type |\n|---|---|---|"
    )?;
    for (name, offset, kind) in records.layout.fields {
        writeln!(page, "| {offset} | {name} | {kind} |")?;
    }
    if shared.is_empty() {
        return Ok(());
    }
    let shared: Vec<String> = shared.iter().map(|(name, v)| format!("{name} = {v:?}")).collect();
    writeln!(page, "\nAll records share {}.", shared.join(", "))
}

fn leave(
    page: &mut String,
    planes: &[(&'static Stage, Vec<&'static PlaneRow>)],
) -> std::fmt::Result {
    writeln!(
        page,
        "\n## Leave\n\nWrite these channels into the EXR, as 32-bit floats or 32-bit unsigned integers. \
         The picture `R G B` alone gets a verdict; each further plane makes it sharper. In a name, \
         `#` stands for a digit of the number of a group, a layer or a level.\n\n\
         Instead of an EXR you can leave NPY files, with a `client.toml` that names them. There a plane \
         has one name for all of its channels:\n\n```toml\n[planes]\nRGB = \"color.npy\"\n\
         Z = \"depth.npy\"\n```\n\n\
         | stage | channels | what they hold |\n|---|---|---|"
    )?;
    for (stage, rows) in planes {
        for row in rows {
            let channels = row.holds.channels(row.name).join(" ");
            writeln!(page, "| {} | `{channels}` | {} |", stage.name, row.meaning)?;
        }
    }
    Ok(())
}
