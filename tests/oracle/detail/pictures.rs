//! The surfels of a node: what its pictures show, which of their candidates it has, and their bytes.

use super::estimates;
use super::folder::World;
use super::mesh::Bytes;
use super::view::placed;
use crate::oracle::kit::eye::wide;
use crate::oracle::sampler::cases::alone;
use glam::Vec3;
use splatref::frame::Exec;
use splatref::number::srgb;
use splatref::scene::{Cloud, Property, Similarity, Triangles, Vertices};
use splatref::source::candidates::candidates;
use splatref::source::hierarchy::{Sampler, Traversal};
use splatref::source::sampler::{Greedy, Progressive, Start, shuffled};

/// The surfels of a node as they are in its file, and their codes.
pub(crate) struct Surfels {
    position: Vec<Vec3>,
    normal: Vec<Vec3>,
    color: Vec<Vec3>,
    codes: Vec<([i16; 2], [u8; 4])>,
    /// Of each surfel the opacity, if there are some, and the further properties.
    numbers: Vec<Vec<f32>>,
    estimate: (u32, f32),
}

fn sign(v: f64) -> f64 {
    if v < 0.0 { -1.0 } else { 1.0 }
}

fn encoded(n: Vec3) -> [i16; 2] {
    let [x, y, z] = wide(n);
    let s = (x.abs() + y.abs()) + z.abs();
    let (mut a, mut b) = (x / s, y / s);
    if z < 0.0 {
        (a, b) = ((1.0 - b.abs()) * sign(a), (1.0 - a.abs()) * sign(b));
    }
    [a, b].map(|v| (32767.0 * v + 0.5).floor() as i16)
}

fn decoded(codes: [i16; 2]) -> Vec3 {
    let [a, b] = codes.map(|code| f64::from(code) / 32767.0);
    let z = (1.0 - a.abs()) - b.abs();
    let t = if z < 0.0 { -z } else { 0.0 };
    let [x, y] = [a - t * sign(a), b - t * sign(b)];
    let length = ((x * x + y * y) + z * z).sqrt();
    Vec3::from_array([x, y, z].map(|v| (v / length) as f32 + 0.0))
}

impl Surfels {
    fn new(cloud: &Cloud) -> Self {
        let color = cloud.color.as_ref().expect("colours");
        let table = srgb::table(255);
        let code = |c: f32| {
            let c = f64::from(c).clamp(0.0, 1.0);
            (255.0 * srgb::from_linear(c) + 0.5).floor() as u8
        };
        let normals = cloud.normal.as_ref().expect("normals");
        let veil = |i: usize| {
            let code = |all: &Vec<f32>| (255.0 * f64::from(all[i]) + 0.5).floor() as u8;
            cloud.opacity.as_ref().map_or(255, code)
        };
        let codes: Vec<_> = (normals.iter().zip(color).enumerate())
            .map(|(i, (n, c))| {
                let [r, g, b] = c.to_array().map(code);
                (encoded(*n), [r, g, b, veil(i)])
            })
            .collect();
        let normal: Vec<Vec3> = codes.iter().map(|(n, _)| decoded(*n)).collect();
        let light =
            |[r, g, b, _]: &[u8; 4]| Vec3::from_array([r, g, b].map(|c| table[usize::from(*c)]));
        let numbers = |i: usize| {
            let opacity = (f64::from(codes[i].1[3]) / 255.0) as f32;
            let first = cloud.opacity.as_ref().map(|_| opacity);
            first.into_iter().chain(cloud.properties.iter().map(|one| one.values[i])).collect()
        };
        let numbers = (0..codes.len()).map(numbers).collect();
        let color = codes.iter().map(|(_, c)| light(c)).collect();
        let (count, distance) = estimates::model(&cloud.position, &normal);
        let estimate = (count, f32::from_bits(distance));
        Self { position: cloud.position.clone(), normal, color, codes, numbers, estimate }
    }

    pub(crate) fn numbers(&self) -> &[Vec<f32>] {
        &self.numbers
    }

    /// How many, `p_m` and `r_m`.
    pub(crate) fn header(&self) -> (u32, u32, f32) {
        (self.position.len() as u32, self.estimate.0, self.estimate.1)
    }

    /// The bytes of its file, with so many further properties.
    pub(crate) fn file(&self, hash: &[u8; 32], number: u32, further: usize) -> Vec<u8> {
        let mut bytes = Bytes::begin("splatref blue 2\n");
        bytes.0.extend(hash);
        let (count, p, r) = self.header();
        bytes.u32(&[number, count, p]);
        bytes.f32(&[r]);
        bytes.seal(0);
        let mut start = bytes.0.len();
        let further = |numbers: &[f32]| numbers[numbers.len() - further..].to_vec();
        let all = self.position.iter().zip(&self.codes).zip(&self.numbers);
        for (i, ((position, (normal, color)), numbers)) in all.enumerate() {
            if i > 0 && i % 1024 == 0 {
                bytes.seal(start);
                start = bytes.0.len();
            }
            bytes.f32(&position.to_array());
            normal.iter().for_each(|v| bytes.0.extend(v.to_le_bytes()));
            bytes.0.extend(color);
            bytes.f32(&further(numbers));
        }
        if count > 0 {
            bytes.seal(start);
        }
        bytes.0
    }
}

impl Surfels {
    /// Where they are, and their radius, in a node with this box.
    pub(crate) fn discs(&self, [low, high]: [Vec3; 2]) -> Vec<(Vec3, f32)> {
        let (p_m, r_m) = self.estimate;
        let d = [0, 1, 2].map(|k| f64::from(high[k]) - f64::from(low[k]));
        let half = ((d[0] * d[0] + d[1] * d[1]) + d[2] * d[2]).sqrt() / 2.0;
        let unknown = if half > 0.0 { half as f32 } else { 1.0 };
        let r_m = f64::from(if r_m == 0.0 { unknown } else { r_m });
        let share = f64::from(p_m) / self.position.len() as f64;
        self.position.iter().map(|p| (*p, (r_m * share.sqrt()) as f32)).collect()
    }
}

/// What pictures show: positions, normals and colours of corners, and their numbers.
#[derive(Default)]
struct Drawn {
    corners: Vec<[Vec3; 3]>,
    numbers: Vec<Vec<f32>>,
    triangles: Vec<[u32; 3]>,
}

fn turned(place: &Similarity, n: Vec3) -> Vec3 {
    let zero = Similarity { scale: 1.0, translation: glam::DVec3::ZERO, ..*place };
    single(placed(&zero, wide(n)))
}

fn single(v: [f64; 3]) -> Vec3 {
    Vec3::from_array(v.map(|c| c as f32))
}

/// Half axes of a disc of the radius 1, in f64.
fn axes(n: Vec3) -> [[f64; 3]; 2] {
    let n = wide(n);
    let s = n.map(f64::abs);
    let a = if s[0] <= s[1] && s[0] <= s[2] {
        [1.0, 0.0, 0.0]
    } else if s[1] <= s[2] {
        [0.0, 1.0, 0.0]
    } else {
        [0.0, 0.0, 1.0]
    };
    let across = |a: [f64; 3], n: [f64; 3]| {
        [a[1] * n[2] - a[2] * n[1], a[2] * n[0] - a[0] * n[2], a[0] * n[1] - a[1] * n[0]]
    };
    let c = across(a, n);
    let length = ((c[0] * c[0] + c[1] * c[1]) + c[2] * c[2]).sqrt();
    let u = c.map(|v| v * (1.0 / length));
    [u, across(n, u)]
}

/// Where something is shown, and in which colour.
#[derive(Clone, Copy)]
struct Shown {
    place: Similarity,
    color: Option<Vec3>,
}

impl World {
    /// The own triangles of a node of a geometry.
    fn own(&self, number: u32, shown: Shown, to: &mut Drawn) {
        let (tree, first, Some(geometry)) = self.tree_of(number) else { return };
        let mesh = &self.meshes[geometry];
        for &t in &tree[(number - first) as usize].own {
            let begin = to.corners.len() as u32;
            for v in mesh.corners[t as usize].map(|v| v as usize) {
                let own = mesh.color.as_ref().map_or(self.fill, |all| all[v]);
                let position = single(placed(&shown.place, wide(mesh.position[v])));
                let normal = turned(&shown.place, mesh.normal[v]);
                to.corners.push([position, normal, shown.color.unwrap_or(own)]);
                let veil = || mesh.opacity.as_ref().map_or(1.0, |all| all[v]);
                let further = mesh.properties.iter().map(|one| one.values[v]);
                to.numbers.push(self.veiled().then(veil).into_iter().chain(further).collect());
            }
            to.triangles.push([begin, begin + 1, begin + 2]);
        }
    }

    /// The surfels of a node as hexagons in discs.
    fn hexagons(surfels: &Surfels, shown: Shown, pixel: f64, to: &mut Drawn) {
        let n = f64::from(surfels.header().0);
        let (count, distance) = (f64::from(surfels.estimate.0), f64::from(surfels.estimate.1));
        let k = shown.place.scale;
        let r = pixel / k;
        let q = distance / r;
        let p = n.min((count * (q * q)).ceil()).max(1.0) as usize;
        let radius = (r.max(distance * (count / n).sqrt()) * k) as f32;
        for i in 0..p {
            let at = single(placed(&shown.place, wide(surfels.position[i])));
            let normal = turned(&shown.place, surfels.normal[i]);
            let [u, v] = axes(normal).map(|a| single(a.map(|c| c * f64::from(radius))));
            let color = shown.color.unwrap_or(surfels.color[i]);
            let begin = to.corners.len() as u32;
            let (half, wide) = (u * 0.5, v * (0.75_f64.sqrt() as f32));
            for side in [1.0, -1.0] {
                let sixths =
                    [at + u * side, at + half * side + wide * side, at - half * side + wide * side];
                to.corners.extend(sixths.map(|corner| [corner, normal, color]));
            }
            to.numbers.extend([(); 6].map(|()| surfels.numbers[i].clone()));
            to.triangles.extend([2, 3, 4, 5].map(|k| [begin, begin + k - 1, begin + k]));
        }
    }

    /// The triangles that stay in a node, and what is drawn of what is below.
    fn node(&self, number: u32, shown: Shown, pixel: f64, to: &mut Drawn) {
        self.own(number, shown, to);
        let (tree, first, geometry) = self.tree_of(number);
        let node = &tree[(number - first) as usize];
        let mut below = Vec::new();
        if geometry.is_none() {
            for &item in &node.own {
                let object = &self.objects[self.still[item as usize] as usize];
                let shown = Shown { place: object.motion.at(0), color: object.color };
                below.push((self.first(object.geometry), shown));
            }
        }
        below.extend(node.children.iter().map(|child| (child + first, shown)));
        for (child, shown) in below {
            let surfels = self.surfels_of(child);
            match surfels.filter(|_| self.settings.traversal == Traversal::BottomUp) {
                Some(surfels) => Self::hexagons(surfels, shown, pixel, to),
                None => self.node(child, shown, pixel, to),
            }
        }
    }
}

/// The candidates of a node with pictures of a side; without any if no triangle covers a pixel.
fn taken(world: &World, number: u32, side: u32) -> Option<Cloud> {
    let (tree, first, _) = world.tree_of(number);
    let node = &tree[(number - first) as usize];
    let [low, high] = [node.low, node.high].map(|v| v.map(f64::from));
    let d = [0, 1, 2].map(|k| high[k] - low[k]);
    let half = ((d[0] * d[0] + d[1] * d[1]) + d[2] * d[2]).sqrt() / 2.0;
    let half = if half == 0.0 { 1.0 } else { half };
    let pixel = 2.0 * half / f64::from(side);
    let mut drawn = Drawn::default();
    let shown = Shown { place: Similarity::IDENTITY, color: None };
    world.node(number, shown, pixel, &mut drawn);
    let column = |k: usize| drawn.corners.iter().map(|c| c[k]).collect::<Vec<_>>();
    let number = |k: usize| drawn.numbers.iter().map(|all| all[k]).collect::<Vec<f32>>();
    let veiled = usize::from(world.veiled());
    let property =
        |(k, name): (usize, &String)| Property { name: name.clone(), values: number(veiled + k) };
    let vertices = Vertices {
        position: column(0),
        direction: column(1),
        radius: vec![0.0; drawn.corners.len()],
        color: Some(column(2)),
        opacity: world.veiled().then(|| number(0)),
        properties: world.settings.properties.iter().enumerate().map(property).collect(),
    };
    let scene = alone(Triangles::new(vertices, drawn.triangles.clone()).expect("triangles").0);
    let exec = Exec::sequential();
    let directions = &world.settings.directions;
    Some(candidates(&scene, directions, side, &exec, &|_, _, _| ()).ok()?.cloud)
}

fn nothing() -> Cloud {
    Cloud { normal: Some(Vec::new()), color: Some(Vec::new()), ..Cloud::default() }
}

/// The surfels of a node, if it is approximated: none if no pixel sees anything.
pub(crate) fn approximate(world: &World, number: u32) -> Option<Surfels> {
    let count = world.wanted(number);
    if count == 0 {
        return None;
    }
    let settings = &world.settings;
    let most = settings.side;
    let side = (f64::from(most) * (f64::from(count) / 200_000.0).sqrt()).ceil() as u32;
    let mut side = side.max(16).min(most);
    let mut cloud = taken(world, number, side);
    let few =
        |cloud: &Option<Cloud>| cloud.as_ref().map_or(0, |c| c.position.len()) < 4 * count as usize;
    while few(&cloud) && side < most {
        side = (2 * side).min(most);
        cloud = taken(world, number, side);
    }
    let Some(cloud) = cloud else { return Some(Surfels::new(&nothing())) };
    let (points, count) = (&cloud.position, count as usize);
    let (start, seed) = (Start::Seed(settings.seed), settings.seed);
    let order = match settings.sampler {
        Sampler::Greedy => Greedy { start }.define(points, count),
        Sampler::Progressive(schedule) => {
            Progressive { start, seed, schedule }.order(points, count, &|_, _, _| ())
        }
        Sampler::Random => shuffled(points, seed, count, &|_, _, _| ()),
    };
    Some(Surfels::new(&cloud.some(&order.expect("an order").index)))
}
