//! Meshes and point sets.

use crate::oracle::kit::dice::Dice;
use crate::oracle::kit::scene::{discs, scene, surfels};
use glam::{DVec3, Vec3};
use splatref::scene::transform::rotation;
use splatref::scene::{
    Cloud, Geometry, Motion, Object, Objects, Primitives, Scene, Similarity, Surfels, Triangles,
    Vertices,
};
use splatref::source::Shape;

/// A mesh and how its candidates are taken.
pub(crate) struct Mesh {
    pub(crate) name: &'static str,
    pub(crate) scene: Scene,
    pub(crate) side: u32,
}

/// Triangles of these corners; `color` gives each vertex one.
pub(crate) fn mesh(
    position: Vec<Vec3>,
    direction: Vec<Vec3>,
    color: Option<Vec<Vec3>>,
    corners: Vec<[u32; 3]>,
) -> Triangles {
    let radius = vec![0.0; position.len()];
    let vertices = Vertices { position, direction, radius, color, ..Vertices::default() };
    let (triangles, dropped) = Triangles::new(vertices, corners).expect("triangles");
    assert_eq!(dropped, 0);
    triangles
}

/// A scene that is a mesh.
pub(crate) fn alone(triangles: Triangles) -> Scene {
    let primitives = Primitives { triangles, ..Primitives::default() };
    Scene { primitives, ..scene(Surfels::none()) }
}

/// Triangles anywhere, of any size, each vertex with a normal of its own.
fn soup(dice: &mut Dice, count: usize, center: Vec3, colored: bool) -> Triangles {
    let vertices = 3 * count;
    let mut position = Vec::new();
    for _ in 0..count {
        let middle = dice.vector(Vec3::splat(-1.0), Vec3::ONE);
        let reach = dice.within(0.0, 0.75);
        position.extend((0..3).map(|_| center + middle + dice.direction() * reach));
    }
    let direction = (0..vertices).map(|_| dice.direction()).collect();
    let color =
        colored.then(|| (0..vertices).map(|_| dice.vector(Vec3::ZERO, Vec3::splat(2.0))).collect());
    let corners = (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    mesh(position, direction, color, corners)
}

/// Points of a lattice that is coarse against a pixel: slivers, corners that meet, triangles that
/// are there twice, and equal depths.
fn lattice_soup(dice: &mut Dice, count: usize) -> Triangles {
    let position: Vec<Vec3> = (0..27_u32)
        .map(|i| Vec3::new((i % 3) as f32, (i / 3 % 3) as f32, (i / 9) as f32) * 0.5)
        .collect();
    let direction = position.iter().map(|_| dice.axis()).collect();
    let color = position.iter().map(|_| dice.vector(Vec3::ZERO, Vec3::ONE)).collect();
    let mut corners: Vec<[u32; 3]> =
        (0..count).map(|_| [0; 3].map(|_: u32| dice.below(27) as u32)).collect();
    let again: Vec<_> = corners.iter().map(|[a, b, c]| [*b, *a, *c]).collect();
    corners.extend(again);
    mesh(position, direction, Some(color), corners)
}

/// A sphere of an octahedron cut `levels` times, scaled along the axes.
pub(crate) fn ball(levels: u32, scale: Vec3, center: Vec3) -> Triangles {
    let axes = [Vec3::X, Vec3::Y, Vec3::NEG_X, Vec3::NEG_Y];
    let mut faces: Vec<[Vec3; 3]> = (0..4)
        .flat_map(|i| {
            let (a, b) = (axes[i], axes[(i + 1) % 4]);
            [[a, b, Vec3::Z], [b, a, Vec3::NEG_Z]]
        })
        .collect();
    for _ in 0..levels {
        let cut = |[a, b, c]: [Vec3; 3]| {
            let [d, e, f] = [(a + b).normalize(), (b + c).normalize(), (c + a).normalize()];
            [[a, d, f], [d, b, e], [f, e, c], [d, e, f]]
        };
        faces = faces.into_iter().flat_map(cut).collect();
    }
    let direction: Vec<Vec3> = faces.into_iter().flatten().collect();
    let position = direction.iter().map(|n| *n * scale + center).collect();
    let corners = (0..direction.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    mesh(position, direction, None, corners)
}

/// A rectangle of 3 by 4 whose three normals cancel along a line.
pub(crate) fn cancelling(second: Vec3) -> Triangles {
    let position = [[-1.5, 2.0], [1.5, 2.0], [-1.5, -2.0], [1.5, -2.0]];
    let position = position.map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec();
    let direction = vec![Vec3::Z, second, second, second];
    mesh(position, direction, None, vec![[0, 2, 1], [1, 2, 3]])
}

/// Turned, scaled and moved copies of two geometries, of which one may have colours and the other
/// some surfels, which have one; and the colours of the objects.
fn objects(dice: &mut Dice, colored: [bool; 2], colors: [Option<Vec3>; 4]) -> Scene {
    let point = discs([(Vec3::splat(9.0), Vec3::X, 1.0)]);
    let color = colored[1].then(|| vec![Vec3::Y]);
    let beside = [Surfels::none(), surfels(Cloud { color, ..point })];
    let meshes = [soup(dice, 30, Vec3::ZERO, colored[0]), ball(2, Vec3::ONE, Vec3::ZERO)];
    let geometry = |(surfels, triangles)| Geometry {
        name: String::new(),
        surfels,
        primitives: Primitives { triangles, ..Primitives::default() },
        detail: None,
    };
    let geometries = beside.into_iter().zip(meshes).map(geometry).collect();
    let object = |(i, color): (usize, Option<Vec3>)| {
        let axis = dice.direction().as_dvec3();
        let place = Similarity {
            rotation: rotation(axis, 73.0 * i as f64),
            scale: 0.375 + 0.25 * i as f64,
            translation: dice.direction().as_dvec3() * 2.0,
        };
        Object { name: i.to_string(), geometry: i % 2, motion: Motion::still(place), color }
    };
    let all = colors.into_iter().enumerate().map(object).collect();
    let objects = Objects::new(geometries, all, Vec3::splat(0.625)).expect("objects");
    Scene { objects: Some(objects), ..scene(Surfels::none()) }
}

/// All meshes.
pub(crate) fn meshes() -> Vec<Mesh> {
    let mut dice = Dice(7);
    let one = Vec3::ONE;
    let some = Some(Vec3::new(0.25, 0.5, 0.75));
    let far = Vec3::new(300.0, -700.0, 500.0);
    let mut unused = soup(&mut dice, 20, Vec3::ZERO, true).into_parts();
    unused.0.position[4] = Vec3::splat(1e6);
    unused.1.retain(|corners| !corners.contains(&4));
    let all = [
        ("soup", alone(soup(&mut dice, 60, Vec3::ZERO, true)), 37),
        ("soup without colours", alone(soup(&mut dice, 200, Vec3::ZERO, false)), 48),
        ("soup that is far away", alone(soup(&mut dice, 60, far, true)), 33),
        ("unused vertex", alone(Triangles::new(unused.0, unused.1).expect("triangles").0), 29),
        ("lattice", alone(lattice_soup(&mut dice, 60)), 32),
        ("lattice, odd", alone(lattice_soup(&mut dice, 60)), 31),
        ("ball", alone(ball(3, one, Vec3::ZERO)), 64),
        ("ellipsoid", alone(ball(3, Vec3::new(1.0, 0.25, 3.0), one)), 45),
        ("tiny", alone(ball(1, one * 1e-12, one * 1e-12)), 21),
        ("huge", alone(ball(1, one * 1e15, Vec3::ZERO)), 21),
        ("octahedron in one pixel", alone(ball(0, one, Vec3::ZERO)), 1),
        ("octahedron in nine pixels", alone(ball(0, one, Vec3::ZERO)), 3),
        ("cancelling", alone(cancelling(Vec3::NEG_Z)), 15),
        ("objects", objects(&mut dice, [true, false], [None, None, some, Some(Vec3::X)]), 40),
        ("objects without colours", objects(&mut dice, [false; 2], [None; 4]), 27),
        ("objects beside a colour", objects(&mut dice, [false, true], [None; 4]), 23),
        ("an object in colour", objects(&mut dice, [false; 2], [None, some, None, None]), 25),
    ];
    all.map(|(name, scene, side)| Mesh { name, scene, side }).into()
}

/// Directions of one's own: axes, one straight up, one all but, and some of any length.
pub(crate) fn directions() -> Vec<DVec3> {
    let mut dice = Dice(11);
    let mut all = vec![
        DVec3::X,
        DVec3::NEG_X,
        DVec3::Y,
        DVec3::NEG_Y,
        DVec3::Z,
        DVec3::NEG_Z,
        DVec3::new(-0.0, 3.0, 0.0),
        DVec3::new(1e-4, 1.0, 0.0),
        DVec3::new(0.0, -1.0, -1e-5),
    ];
    for length in [1e-150, 0.3, 1.0, 7.0, 1e150] {
        all.push(dice.direction().as_dvec3() * length);
    }
    all
}

/// Points and what they are.
pub(crate) type Points = (&'static str, Vec<Vec3>);

/// Of a procedural shape.
pub(crate) fn shape(name: &str, count: usize) -> Vec<Vec3> {
    let shape = Shape::by_name(name).expect("a shape");
    shape.surfels(count, 3).expect("surfels").position().to_vec()
}

/// All points of a box of integers, in some order.
pub(crate) fn lattice(dice: &mut Dice, size: [usize; 3]) -> Vec<Vec3> {
    let mut all: Vec<Vec3> = (0..size[0] * size[1] * size[2])
        .map(|i| [i % size[0], i / size[0] % size[1], i / size[0] / size[1]])
        .map(|p| Vec3::from_array(p.map(|c| c as f32)) - 2.0)
        .collect();
    for i in (1..all.len()).rev() {
        all.swap(i, dice.below(i + 1));
    }
    all
}

fn cloud(dice: &mut Dice, count: usize, reach: f32) -> Vec<Vec3> {
    (0..count).map(|_| dice.vector(Vec3::splat(-reach), Vec3::splat(reach))).collect()
}

/// Small sets of every kind.
pub(crate) fn points() -> Vec<Points> {
    let dice = &mut Dice(5);
    let repeated: Vec<Vec3> = cloud(dice, 250, 1.0).repeat(3);
    let mut close = cloud(dice, 150, 1e-23);
    close.extend(cloud(dice, 20, 1e-22));
    let mut wide = cloud(dice, 100, 1e30);
    wide.extend(cloud(dice, 100, 1.0));
    let mut zeros = lattice(dice, [9, 9, 2]);
    zeros.iter_mut().filter(|p| p.x == 0.0).for_each(|p| p.x = -0.0);
    let line = (0..700).map(|i| Vec3::new((i * 37 % 701) as f32, 0.0, 5.0)).collect();
    vec![
        ("torus", shape("torus", 1500)),
        ("cluster", shape("cluster", 1000)),
        ("checkerboard", shape("checkerboard", 1200)),
        ("cube of a lattice", lattice(dice, [11, 11, 11])),
        ("plane of a lattice", lattice(dice, [40, 25, 1])),
        ("every point thrice", repeated),
        ("one place", vec![Vec3::new(0.1, 0.2, 0.3); 300]),
        ("squares that round to 0", close),
        ("squares beyond f32", wide),
        ("zeros of both signs", zeros),
        ("line", line),
        ("one", vec![Vec3::ONE]),
        ("two", vec![Vec3::ONE, Vec3::NEG_X]),
    ]
}
