//! The page of a suite: how to run it, what its files and verdicts mean, and all scenes with their
//! pictures.

use super::page::{FILES, SPLATS};
use crate::method::Method;
use crate::verdict::conformance::Rule;
use std::fmt::Write;

/// The text of `README.md` in the folder of a method. `options` are those of the command that
/// writes these scenes, such as `ewa --only rim`.
pub(super) fn text(method: &Method, options: &str, rules: &[Rule]) -> String {
    let mut page = begin(method, options, rules);
    page += VERDICTS;
    page += CONVENTIONS;
    page += if method.draws_gaussians() { OF_GAUSSIANS } else { OF_SURFELS };
    page += "\n## The files of a scene\n\n| file | what it holds |\n|---|---|\n";
    page += "| README.md | the rule, the settings, and the planes that a renderer may write |\n";
    let files = if method.draws_gaussians() { SPLATS } else { FILES };
    for [name, what] in files {
        // Writing into a string cannot fail.
        let _ = writeln!(page, "| {name} | {what} |");
    }
    if !method.draws_gaussians() {
        page += OTHERS;
    }
    if method.record_layout().is_some() {
        page += "| records.bin | the visible splats, projected |\n";
    }
    page += "\n## The scenes\n\nThe pictures are splatref's own.\n\n";
    page += "| picture | scene | what it tests |\n|---|---|---|\n";
    for Rule { name, tests, .. } in rules {
        let tests = tests.replace('|', "\\|");
        let _ = writeln!(
            page,
            "| ![{name}]({name}/reference.png) | [{name}]({name}/README.md) | {tests} |"
        );
    }
    page
}

/// What the folder is for, and the commands.
fn begin(method: &Method, options: &str, rules: &[Rule]) -> String {
    let (method, version, count) = (method.name(), env!("CARGO_PKG_VERSION"), rules.len());
    let scenes = if count == 1 { "scene" } else { "scenes" };
    let first = rules.first().map_or("SCENE", |rule| &rule.name);
    format!(
        "# Test a renderer of `{method}`

This folder has {count} {scenes}. Each tests one rule of the method `{method}` of splatref {version}. Your renderer draws a
scene, and splatref says whether a right renderer may draw this picture. There is no tolerance to choose.

## Run your renderer

Let your renderer draw one scene into an EXR, and get a verdict. Here its command is `./mine`, and takes the folder of the
scene and the file to write:

```sh
./mine {first} {first}/client.exr
splatref verify {first}/scene.toml {first}/client.exr
```

Or let splatref run your renderer on every scene. It writes the same scenes into `out/conformance/{method}`, puts the folder
of a scene in the place of `{{scene}}` and the file to write in the place of `{{out}}`, and prints a line for each:

```sh
splatref conformance {options} --command './mine {{scene}} {{out}}' --report report.html
```

The picture alone (`R G B`) gets a verdict. Write more planes, and the verdict gets sharper and names the stage that is wrong:
the README.md of each scene lists them. `reference.exr` has these planes as splatref draws them.

"
    )
}

const VERDICTS: &str = "\
## What the verdicts mean

| verdict | exit code | what it means |
|---|---|---|
| right | 0 | a right renderer may write each of these numbers |
| wrong | 1 | no right renderer writes one of these numbers; the line names the stage, the pixel, and the mistake, if it is a known one |
| undecidable | 3 | in too many pixels, rounding decides what is drawn: write more planes |
| unlike | 4 | each number is right, but the errors together are larger than those of any right renderer that was tried |
| failed | 1 | your command failed, or wrote no file |

A right renderer need not have the bits of `reference.exr`: it may round otherwise, fuse products with sums, and add in another
order. `--promise ieee` expects that each operation rounds once, in the written order.

";

const CONVENTIONS: &str = "\
## Conventions

- World space is right-handed. Its unit is free.
- `scene.json` has the camera twice. In `opencv`, x points to the right, y down, and z into the picture. In `opengl`, x points to the
  right, y up, and z towards the viewer.
- Matrices are stored row by row, and multiply column vectors.
- Pixel (0, 0) is the top left one, and its centre is (0.5, 0.5). x runs to the right and y down. The first row of a file is the top row.
- A perspective camera draws the point (x, y, z) of `opencv` at (cx + fx x/z, cy + fy y/z), in pixels. An orthographic one draws it
  at (cx + fx x, cy + fy y).
- Depths are z of `opencv`, in world units. `near` is the near plane. No far plane cuts anything; `far` serves the projection matrices.
- `R G B` of a picture is linear light with the primaries of sRGB. The PNG is encoded as sRGB.
- A pixel where nothing is drawn has the depth +inf and the id 4294967295. Its weights, sums and counts are 0.
- Arrays are NPY files of `float32`, or of `uint32` for indices. Row i, from 0, belongs to the number i in `id` planes.
";

const OTHERS: &str = "\
| members.npy | pairs of a surfel and a group that it is drawn into, if the scene has groups |
| polygons.ply, ribbons.ply, tubes.ply, and arrays of the same names | other primitives, if the scene has them; numbered after the surfels |
";

const OF_SURFELS: &str = "\
- A surfel is a disc, or an ellipse if the scene has half axes. Radii and half axes are in world units. Normals are unit vectors.
- Colours of surfels are linear light. `scene.json` has the lights and the material.
";

const OF_GAUSSIANS: &str = "\
- Scales are standard deviations in world units, not their logarithms. Opacities are from 0 to 1, not logits.
- A rotation is a unit quaternion (x, y, z, w), from the own axes of a splat to the world.
- Harmonics come coefficient by coefficient, red, green and blue of each. Their direction runs from the camera to the splat, in world space.
- `colors` in `scene.json` says how colours are encoded: `srgb_rec709_display` or `lin_rec709_display`. The setting `blend` says in which
  space they are blended. The plane `blended` has the numbers before they become linear light.
- Lengths in the picture are in pixels, and `low_pass` is a variance in square pixels.
";
