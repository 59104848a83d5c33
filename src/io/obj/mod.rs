//! Read meshes and points from OBJ, with the colours and textures of their materials.
//!
//! | line | defines | details |
//! |---|---|---|
//! | `v x y z` | a position | world units, rounded to `f32` once; a fourth number, a weight, is skipped |
//! | `v x y z r g b` | with a colour | **sRGB** in [0, 1], decoded in `f64` and rounded once ([`crate::number::srgb`]); or codes from 0 to 255 |
//! | `vn x y z` | a normal | of any length |
//! | `f a b c ...` | a polygon | cut into triangles; with fewer than 3 corners it is nothing. `fo` means the same |
//! | `l a b c ...` | a line | the segments between its vertices, for ribbons and tubes |
//!
//! | line | defines | details |
//! |---|---|---|
//! | `mtllib FILE ...` | materials | MTL files beside this one; several files make one list |
//! | `usemtl NAME` | a material | for the polygons that follow; without a name, the default material |
//! | `vt u v` | texture coordinates | a third number is skipped; without v it is 0 |
//!
//! A corner is `v`, `v/vt`, `v//vn` or `v/vt/vn`. Each part is a number from 1 on, or a negative
//! number that counts backwards from the line; -1 is the last vertex, normal or texture coordinate
//! before it. A number from 1 on may refer to a later line.
//!
//! [`crate::io::polygon`] says how a polygon is cut into triangles.
//!
//! A line ends in LF, CR or CR LF, or with the file. A backslash before the end of a line joins the
//! next line to it. Text is UTF-8, with or without a byte order mark; a line that is not UTF-8 is
//! Latin-1, each byte a character. UTF-16 is refused.
//!
//! A comment begins at `#` at the start of a line or after white space; after a number, it needs no
//! white space. All other statements are ignored. The [warnings](Cloud::warnings) name them, except
//! for `o`, `g`, `mg`, `lod`, `c_interp` and `d_interp`, which change no picture, for `p`, because every
//! vertex is a point, and for `s` in a file with normals.
//!
//! The reader takes the texture and the colour of a material:
//!
//! | line of an MTL file | defines | details |
//! |---|---|---|
//! | `newmtl NAME` | a material | the lines that follow belong to it |
//! | `Kd r g b`, `Kd r` | its colour | linear, in [0, 65536]; one number is all three |
//! | `d x`, `Tr x` | its opacity, x or 1 - x | in [0, 1]; `Tr` beside `d` is ignored, and so is `Tr 1` |
//! | `map_Kd OPTIONS FILE` | its texture, see [`crate::io::texture`] | `-s` and `-o` scale and move the texture coordinates |
//!
//! With these options, u' = u s.u + o.u and v' = v s.v + o.v, each in f64 and rounded to `f32` once.
//! `map_d`, `d -halo x` and other options of `map_Kd` are not read. A warning names them if a polygon's
//! material has them with a value that would change the picture.
//!
//! The reader does not judge values of positions and
//! normals, and neither does [`super::ply`].
//!
//! # Decided
//!
//! - Colours are sRGB, because programs that paint vertices write codes of 8 bits divided by 255. If
//!   any number of a colour is above 1, all must be whole numbers from 0 to 255; they are divided by
//!   255, with a warning.
//! - If only some vertices have a colour, the others are white, with a warning.
//! - In `v` of seven numbers, the fourth is a weight, which is skipped, and the colour follows; so it
//!   is if the fourth is 1 in all such lines. Otherwise the fourth to sixth are the colour and the
//!   seventh is the opacity. A warning says which. Programs write both.
//! - `1.#QNAN`, `1.#SNAN` and `-1.#IND` are NaN, and `1.#INF` is infinite, as Microsoft's run-time
//!   library prints them.
//! - The opacity of a point is that of its vertex times that of its material. Methods without
//!   transparency, and polygons, ignore it.
//! - A vertex becomes several points if its corners have several normals, or materials of several
//!   colours or opacities. Points are in the order of the vertices, then of the normals' numbers, then of the
//!   materials. If a corner has no normal, all normals are left out, to be derived.
//! - Texture coordinates belong to [corners](crate::scene::Coordinates::Corners); a corner without them has NaN.
//! - If vertices have no colours and no texture replaces the materials' colours, points take the
//!   colours of their materials. A material without Kd is then white.
//! - Kd is linear, because programs that write it have linear colours. A texture replaces Kd and is
//!   not multiplied by it, because the same programs write a Kd that nobody has chosen beside the
//!   texture.
//! - A name, for example of a material, reaches to the end of its line, because programs write names
//!   such as `Material #1`. So `usemtl name #x` first asks for the material `name #x`, then for `name`,
//!   then for the first one whose name is `name` without its comment. If white space follows the `#`,
//!   comments on both sides are left out last. Files of materials and textures are found in the same
//!   way: the whole name first, then the name without its comment, each also with `/` for `\`.
//! - `mtllib` has one name with blanks if such a file exists. Otherwise the longest run of at most 8
//!   words that is an existing file is a name, from the first word on.
//! - If a file of materials is missing or cannot be read, or if no file has a material, a warning
//!   says so, and the polygons have the default grey: (3/4, 3/4, 3/4) if other polygons have the
//!   colours of materials, and otherwise the scene's colour. Most files with such a fault are whole
//!   but for the materials.
//! - The default material, of polygons before the first `usemtl` and after an empty one, is white if
//!   other polygons have the colours of materials, as the format says.
//! - If there is no `f`, and as many `vn` as `v`, each normal belongs to the vertex of the same
//!   number, because point clouds are written so.
//!
//! The reader is our own. The one well-kept crate, tobj 4.0, gives no line number with an error. It
//! also drops silently what this page keeps or refuses: points without faces, and all texture
//! coordinates or normals of a file in which one corner has none.

mod cloud;
mod colors;
mod lines;
mod map;
mod materials;
mod statements;
#[cfg(test)]
mod tests;

use super::{Reason, input};
use crate::error::{Error, Result};
use crate::memory;
use crate::scene::Cloud;
use lines::{lines, statement};
use statements::Statements;
use std::path::Path;

/// The most memory for each byte of a file: a corner of a polygon takes only two bytes of it.
const BYTES_A_BYTE: u64 = 72;

/// Reads a file and its materials.
///
/// # Errors
/// [`Error::Io`] if the file cannot be read; [`Error::Format`] as [`parse`], and if a file of
/// materials is damaged.
pub fn read(path: &Path) -> Result<Cloud> {
    let bytes = input::bytes(path).map_err(|source| Error::io(path, source))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    parse_with(&bytes, Some(folder)).map_err(|what| Error::format(path, what))
}

/// Reads the bytes of a file, without materials.
///
/// # Errors
/// One line if there is no vertex, if the text is UTF-16, if a word is no number or refers to
/// something that does not exist, or if a colour is out of range. It names the line, the problem and
/// the remedy.
pub fn parse(bytes: &[u8]) -> std::result::Result<Cloud, String> {
    parse_with(bytes, None)
}

/// [`parse`] with the materials of the files that `mtllib` names, if there is a folder to look in.
fn parse_with(bytes: &[u8], folder: Option<&Path>) -> Reason<Cloud> {
    memory::try_ask(BYTES_A_BYTE.saturating_mul(bytes.len() as u64), || "a mesh".into())?;
    let mut all = Statements::new();
    for (number, line) in lines(bytes)? {
        let (word, rest) = statement(&line);
        let read = match (word, folder) {
            ("mtllib", Some(folder)) => all.library.read(folder, rest),
            ("mtllib", None) => Ok(()),
            _ => all.read(number, word, rest),
        };
        read.map_err(|what| format!("line {number}: {what}"))?;
    }
    cloud::cloud(all, folder.is_some())
}
