//! Scenes of several objects that move before a camera that moves.

use crate::oracle::deferred::place::{Thing, World, similarity};
use crate::oracle::ewa::cases::{self as ewa, Kind};
use crate::oracle::kit::dice::Dice;
use crate::oracle::kit::goldens::Taken;
use crate::oracle::kit::scene::{OUTLINES, change, lights, scene, straight, surfels};
use glam::{DMat3, DVec3, Mat4, Vec3};
use splatref::frame::Exec;
use splatref::io::scene_file::SceneFile;
use splatref::method::deferred::Settings;
use splatref::scene::{Camera, Object, Scene, Similarity, Surfels};
use splatref::source::Shape;
use splatref::splat::{Epsilon, Kernel, SplatSettings};
use std::path::Path;

/// A sequence of frames.
pub(crate) struct Sequence {
    pub(crate) name: String,
    pub(crate) world: World,
    /// All of the scene but its objects.
    pub(crate) around: Scene,
    pub(crate) settings: Settings,
    /// The frames in the order in which they are drawn: where the objects are, the camera, and
    /// whether the frame is given what the one before saw.
    pub(crate) frames: Vec<(u32, Camera, bool)>,
    /// Whether normals have length 1 and tangents are perpendicular to them exactly.
    pub(crate) exact: bool,
}

impl Sequence {
    /// The scene in a frame.
    pub(crate) fn scene(&self, frame: u32) -> Scene {
        let objects = self.world.objects().at(frame).expect("in range");
        Scene { objects: Some(objects), ..self.around.clone() }
    }
}

const EXACT: [Kind; 3] = [Kind::Axes, Kind::Ellipses, Kind::Layers];
const ROUNDED: [Kind; 5] = [Kind::Discs, Kind::Tilted, Kind::Sizes, Kind::Degenerate, Kind::Discs];

/// Surfels about (0, 0, -4), some with opacities, some without colours.
pub(crate) fn geometry(dice: &mut Dice, exact: bool, flat: bool) -> Surfels {
    let splats = SplatSettings::default();
    let seed = dice.bits();
    let shape = !exact && dice.below(2) == 0;
    let own = if shape {
        let shape = [Shape::Sphere, Shape::Torus][dice.below(2)];
        shape.surfels(40 + dice.below(80), seed).expect("surfels")
    } else {
        let kinds: &[Kind] = if exact { &EXACT } else { &ROUNDED };
        let allowed = kinds.iter().filter(|kind| flat || **kind != Kind::Layers);
        let kinds: Vec<_> = allowed.copied().collect();
        ewa::case(kinds[dice.below(kinds.len())], seed, splats, false).scene.surfels
    };
    let mut one = scene(own);
    change(&mut one, |cloud| {
        if shape {
            cloud.position.iter_mut().for_each(|p| p.z -= 4.0);
        }
        let n = cloud.position.len();
        if dice.below(3) == 0 {
            cloud.opacity = Some((0..n).map(|_| dice.within(0.0, 1.0)).collect());
        }
        if dice.below(3) == 0 {
            cloud.color = None;
        }
    });
    one.surfels
}

/// A turn that maps axes to axes.
fn quarter(dice: &mut Dice) -> DMat3 {
    let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z];
    [[x, y, z], [y, z, x], [z, x, y], [y, -x, z], [-x, -y, z], [x, -y, -z]]
        .map(|[a, b, c]| DMat3::from_cols(a, b, c))[dice.below(6)]
}

/// A place about the origin of the world; now and then behind the camera, or beside the picture.
fn place(dice: &mut Dice, exact: bool, rare: usize) -> Similarity {
    let far = match rare {
        0 => DVec3::new(0.0, 0.0, 16.0),
        1 => DVec3::new(-64.0, 0.0, 0.0),
        _ => DVec3::ZERO,
    };
    let by = dice.vector(Vec3::splat(-1.5), Vec3::splat(1.5)).as_dvec3() + far;
    let scale = [1.0, 1.0, 0.5, 2.0][dice.below(4)];
    // About the middle of the surfels.
    let middle = DVec3::new(0.0, 0.0, -4.0);
    if exact {
        let rotation = quarter(dice);
        let translation = middle + by - rotation * middle * scale;
        return Similarity { rotation, scale, translation };
    }
    let (axis, scale) = (dice.direction().as_dvec3(), f64::from(dice.within(0.4, 1.4)));
    let turn = similarity(axis, dice.within(-180.0, 180.0).into(), scale, by);
    Similarity { translation: middle + by - turn.rotation * middle * scale, ..turn }
}

/// Keys at rest, at every frame, or some frames apart.
fn keys(dice: &mut Dice, exact: bool) -> Vec<(u32, Similarity)> {
    let rare = dice.below(12);
    let first = place(dice, exact, rare);
    let wander = |dice: &mut Dice| {
        let step = dice.vector(Vec3::splat(-0.75), Vec3::splat(0.75)).as_dvec3();
        let translation = first.translation + step;
        if exact || dice.below(3) == 0 {
            return Similarity { translation, ..first };
        }
        let turn =
            similarity(dice.direction().as_dvec3(), dice.within(5.0, 170.0).into(), 1.0, step);
        let scale = first.scale * f64::from(dice.within(0.75, 1.25));
        Similarity { rotation: turn.rotation * first.rotation, scale, translation }
    };
    match dice.below(4) {
        0 => vec![(dice.below(3) as u32, first)],
        1 => (0..4).map(|f| (f, wander(dice))).collect(),
        2 if exact => vec![(1, first), (3, wander(dice)), (4, wander(dice))],
        2 => vec![(1, first), (3, place(dice, exact, 2)), (4, wander(dice))],
        _ => vec![(0, first), (4, wander(dice))],
    }
}

fn world(dice: &mut Dice, exact: bool, flat: bool) -> World {
    let count = 1 + dice.below(3);
    let geometries: Vec<_> = (0..count).map(|_| geometry(dice, exact, flat)).collect();
    let thing = |dice: &mut Dice| Thing {
        geometry: dice.below(count),
        keys: keys(dice, exact),
        color: (dice.below(3) == 0).then(|| dice.vector(Vec3::ZERO, Vec3::ONE)),
    };
    let mut objects: Vec<_> = (0..=dice.below(4)).map(|_| thing(dice)).collect();
    // Now and then an object is where another is: every fragment is a tie.
    if dice.below(4) == 0 {
        objects.push(Thing { color: Some(Vec3::X), ..objects[0].clone() });
    }
    World { geometries, whole: Vec::new(), objects, fill: dice.vector(Vec3::ZERO, Vec3::ONE) }
}

pub(crate) fn settings(dice: &mut Dice) -> Settings {
    let kernel = [Kernel::DEFAULT, Kernel::ZPVBG01][dice.below(2)];
    let epsilon = match dice.below(6) {
        0 => Epsilon::World(0.0),
        1 => Epsilon::World(f32::INFINITY),
        2 => Epsilon::World(dice.within(0.0, 0.5)),
        _ => Epsilon::MedianRadii(dice.within(0.0, 3.0)),
    };
    let kernel = Kernel { outline: OUTLINES[dice.below(3)], ..kernel };
    let splats = SplatSettings { kernel, epsilon, cull: dice.below(2) == 0 };
    let flags = [1, 2, 3, 5, 7, 16, 64, 4096][dice.below(8)];
    Settings { splats, flags, second: dice.below(3) > 0, share: 0.0 }
}

const SIZES: [[u32; 2]; 8] =
    [[1, 1], [7, 1], [1, 9], [8, 8], [23, 17], [32, 16], [41, 30], [60, 40]];

/// The sequence of a number.
pub(crate) fn sequence(number: u64) -> Sequence {
    let mut dice = Dice(number.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x0DEF_E44E);
    dice.bits();
    let exact = number.is_multiple_of(3);
    let settings = settings(&mut dice);
    // In one plane rounding alone decides which discs are seen, unless there is a band.
    let flat = !matches!(settings.splats.epsilon, Epsilon::World(e) if e < 1e-3)
        && !matches!(settings.splats.epsilon, Epsilon::MedianRadii(e) if e < 1e-3);
    let world = world(&mut dice, exact, flat);
    let size = SIZES[number as usize % SIZES.len()];
    let still = straight(dice.below(2) == 0, size);
    let roll = Mat4::from_rotation_z(dice.within(-3.0, 3.0));
    let frames = [[0, 1, 2, 3], [0, 3, 3, 5], [2, 1, 4, 0]][dice.below(3)];
    let frames = frames.into_iter().map(|frame| {
        let mut camera = still;
        if exact {
            camera.view_from_world.w_axis.x += dice.within(-0.5, 0.5);
        } else {
            let turn = Mat4::from_rotation_y(dice.within(-0.1, 0.1));
            camera.view_from_world = roll * turn;
        }
        (frame, camera, dice.below(8) > 0)
    });
    let frames = frames.collect();
    let around = Scene { lights: lights(&mut dice), ..scene(surfels(Default::default())) };
    let name = format!("number {number}, {settings:?}");
    Sequence { name, world, around, settings, frames, exact }
}

/// The goldens of the method, each the last frame of a sequence.
pub(crate) fn goldens() -> Vec<Sequence> {
    let exec = Exec::sequential();
    let golden = |name: &&str| {
        let path = Path::new("golden").join(name).with_extension("toml");
        let file = SceneFile::read(&path).expect("a scene file");
        let ready = file.ready(&exec, &|_, _, _| ()).expect("loads");
        let around = ready.loaded.scene.clone();
        let objects = around.objects.clone().expect("a scene of objects");
        let thing = |object: &Object| Thing {
            geometry: object.geometry,
            keys: object.motion.keys().to_vec(),
            color: object.color,
        };
        let world = World {
            geometries: objects.geometries().iter().map(|of| of.surfels.clone()).collect(),
            whole: objects.geometries().to_vec(),
            objects: objects.objects().iter().map(thing).collect(),
            fill: objects.fill(),
        };
        let camera = |frame| ready.camera_at(frame).expect("a camera");
        let frames = (0..file.frames).map(|frame| (frame, camera(frame), frame > 0)).collect();
        let settings = Settings::of(ready.method).expect("a golden of this method");
        let name = path.display().to_string();
        Sequence { name, world, around, settings, frames, exact: false }
    };
    Settings::NAMES.iter().map(golden).collect()
}
