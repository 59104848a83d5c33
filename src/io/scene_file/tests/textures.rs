//! Check which texture a model has, and which surfels take its colours.

use super::*;
use crate::scene::Surfels;
use glam::DVec3;
use tempfile::TempDir;

/// A folder with a square that names `own.exr`, which is red; `green.exr`; and a file `b.ply`
/// without coordinates.
fn folder() -> TempDir {
    let at = TempDir::new().unwrap();
    let square = "property float x\nproperty float y\nproperty float z\n";
    let face = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let file = |name: &str, text: String| fs::write(at.path().join(name), text).unwrap();
    file(
        "a.ply",
        format!(
            "ply\nformat ascii 1.0\ncomment TextureFile own.exr\nelement vertex 4\n{square}property float u\n\
             property float v\n{face}0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n4 0 1 2 3\n"
        ),
    );
    let points = "0 0 0\n1 0 0\n1 1 0\n3 0 1 2\n";
    file("b.ply", format!("ply\nformat ascii 1.0\nelement vertex 3\n{square}{face}{points}"));
    paint(&at, "own.exr", [1.0, 0.0, 0.0]);
    paint(&at, "green.exr", [0.0, 1.0, 0.0]);
    at
}

/// An EXR of this colour at the left and of black at the right.
fn paint(at: &TempDir, name: &str, color: [f32; 3]) {
    let pixels = Plane::from_pixels([64, 64], |x, _| if x < 32 { color } else { [0.0; 3] });
    let frame = Frame::new(64, 64).with("", Samples::Color(pixels)).unwrap();
    exr::write(&at.path().join(name), &frame, "").unwrap();
}

fn scene(at: &TempDir, keys: &str) -> SceneFile {
    let text = format!("[[model]]\nfile = \"a.ply\"\n{keys}\n");
    SceneFile::parse(&text, &at.path().join("scene.toml")).unwrap()
}

fn surfels(at: &TempDir, keys: &str) -> Surfels {
    load(&scene(at, keys)).scene.surfels
}

/// The sum of the colours of the surfels.
fn sum(surfels: &Surfels) -> Vec3 {
    surfels.color().unwrap().iter().copied().sum()
}

fn error(at: &TempDir, keys: &str) -> String {
    let error = scene(at, keys).load(&Exec::sequential(), &|_, _, _| ()).unwrap_err().to_string();
    assert!(!error.contains('\n'), "{error}");
    error
}

#[test]
fn the_key_beats_the_file_and_the_colour_both() {
    let at = folder();
    for draw in ["", "draw = \"points\"", "draw = \"facets\""] {
        let own = sum(&surfels(&at, draw));
        assert!(own.x > 0.5 && own.y == 0.0 && own.z == 0.0, "{own}");
        let chosen = sum(&surfels(&at, &format!("{draw}\ntexture = \"green.exr\"")));
        assert_eq!(chosen, Vec3::new(0.0, own.x, 0.0));
        let constant = surfels(&at, &format!("{draw}\ncolor = [0, 0, 0.5]"));
        assert!(constant.color().unwrap().iter().all(|&color| color == Vec3::new(0.0, 0.0, 0.5)));
    }
    let file = scene(&at, "texture = \"green.exr\"");
    let reads: Vec<_> = file.reads().collect();
    assert_eq!(reads, [at.path().join("a.ply"), at.path().join("green.exr")]);
    let polygons = load(&scene(&at, "draw = \"polygons\"")).scene.primitives.triangles;
    assert!(polygons.vertices().color.as_ref().unwrap()[0].x > 0.5);
    let hybrid = load(&scene(&at, "draw = \"hybrid\"\nsplit = [1, 0, 0, 0.5]")).scene;
    assert!(sum(&hybrid.surfels).x > 0.5);
    // A texture that is not shown need not exist.
    fs::remove_file(at.path().join("own.exr")).unwrap();
    surfels(&at, "color = [1, 1, 1]");
    let line = error(&at, "");
    assert!(line.contains("a.ply: its texture own.exr: "), "{line}");
}

#[test]
fn levels_are_made_of_the_texture_where_there_is_one() {
    let at = folder();
    let found = surfels(&at, "mipmaps = 6");
    let mipmap = found.mipmap().unwrap();
    assert_eq!((mipmap.levels(), found.len()), (6, 2));
    for i in 0..2 {
        let last = mipmap.of_surfel(i)[5];
        // 64 outlines cover the whole texture, half of which is red.
        assert!((last.x - 0.5).abs() < 1e-3, "{last}");
        assert!((found.color().unwrap()[i].x - 0.5).abs() > 0.05, "{:?}", found.color());
    }
    assert!(surfels(&at, "").mipmap().is_none() && surfels(&at, "mipmaps = 0").mipmap().is_none());
    let moved =
        load(&scene(&at, "mipmaps = 6\n[model.transform]\ntranslate = [1, 2, 3]")).scene.surfels;
    assert_eq!(moved.mipmap(), Some(mipmap));
    assert!(
        moved.position()[0]
            .as_dvec3()
            .distance(found.position()[0].as_dvec3() + DVec3::new(1.0, 2.0, 3.0))
            < 1e-6
    );
}

#[test]
fn what_a_texture_holds_is_part_of_the_scene() {
    let at = folder();
    let hash = || load(&scene(&at, "")).scene.sha256();
    let before = hash();
    assert_eq!(hash(), before);
    paint(&at, "own.exr", [0.75, 0.0, 0.0]);
    assert_ne!(hash(), before);
}

#[test]
fn textures_of_what_has_none_are_refused() {
    let at = folder();
    let texture = "texture = \"green.exr\"";
    let one = "a: a model in one colour has no texture; remove one of them";
    assert_eq!(error(&at, &format!("{texture}\ncolor = [1, 1, 1]")), one);
    let tubes = "a: a model drawn as tubes has no texture; remove one of them";
    assert_eq!(error(&at, &format!("{texture}\ndraw = \"tubes\"")), tubes);
    let line = error(&at, "texture = \"no.exr\"");
    assert!(line.starts_with(&at.path().join("no.exr").display().to_string()), "{line}");
    let bare = format!("file = \"b.ply\"\n{texture}").replace("file = ", "");
    let text = format!("[[model]]\nfile = {bare}\n");
    let file = SceneFile::parse(&text, &at.path().join("scene.toml")).unwrap();
    let line = file.load(&Exec::sequential(), &|_, _, _| ()).unwrap_err().to_string();
    assert!(line.contains("b.ply: no texture coordinates, so"), "{line}");
    let line = refused(&format!("{SHAPE}{texture}\n"));
    assert!(line.contains("`texture` does not apply to sphere: remove it"), "{line}");
}

/// The same square with coordinates at the vertices of a PLY, at the corners of an OBJ, and with a
/// material.
#[test]
fn an_obj_with_a_material_is_drawn_as_the_ply() {
    let at = folder();
    let file = |name: &str, text: &str| fs::write(at.path().join(name), text).unwrap();
    file("m.mtl", "newmtl wood\nKd 0.8 0.8 0.8\nmap_Kd own.exr\n");
    file(
        "c.obj",
        "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl wood\n\
         f 1/1 2/2 3/3 4/4\n",
    );
    for keys in ["mipmaps = 3", "draw = \"points\"\nmipmaps = 3"] {
        let text = format!("[[model]]\nfile = \"c.obj\"\n{keys}\n");
        let obj = SceneFile::parse(&text, &at.path().join("scene.toml")).unwrap();
        assert_eq!(load(&obj).scene.surfels, surfels(&at, keys));
    }
}
