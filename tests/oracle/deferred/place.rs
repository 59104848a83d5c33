//! Where surfels of objects are, by the pages of motion and transform: f64, rounded once.

use glam::{DMat3, DVec3, Vec3};
use splatref::scene::objects::{Geometry, Motion, Object, Objects};
use splatref::scene::{Cloud, Similarity, Surfels};

type Rows = [[f64; 3]; 3];
type Four = [f64; 4];

/// A place in a frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    rows: Rows,
    scale: f64,
    translation: [f64; 3],
}

fn rows(m: &DMat3) -> Rows {
    [0, 1, 2].map(|i| m.row(i).to_array())
}

impl Place {
    pub(crate) fn new(of: &Similarity) -> Self {
        let translation = of.translation.to_array();
        Self { rows: rows(&of.rotation), scale: of.scale, translation }
    }

    /// By the keys of a motion.
    pub(crate) fn at(keys: &[(u32, Similarity)], frame: u32) -> Self {
        let after = keys.iter().position(|(f, _)| *f >= frame);
        let Some(after) = after else { return Self::new(&keys[keys.len() - 1].1) };
        if after == 0 || keys[after].0 == frame {
            return Self::new(&keys[after].1);
        }
        let [(first, a), (last, b)] = [keys[after - 1], keys[after]];
        let s = f64::from(frame - first) / f64::from(last - first);
        let [a, b] = [Self::new(&a), Self::new(&b)];
        let mix = |a: f64, b: f64| a + s * (b - a);
        Self {
            rows: slerp(a.rows, b.rows, s),
            scale: mix(a.scale, b.scale),
            translation: [0, 1, 2].map(|i| mix(a.translation[i], b.translation[i])),
        }
    }

    fn turned(&self, v: [f64; 3]) -> [f64; 3] {
        self.rows.map(|m| (m[0] * v[0] + m[1] * v[1]) + m[2] * v[2])
    }

    fn point(&self, p: Vec3) -> Vec3 {
        let turned = self.half_axis64(p);
        Vec3::from([0, 1, 2].map(|i| (turned[i] + self.translation[i]) as f32))
    }

    fn half_axis64(&self, v: Vec3) -> [f64; 3] {
        self.turned(v.to_array().map(|v| f64::from(v) * self.scale))
    }

    fn half_axis(&self, v: Vec3) -> Vec3 {
        Vec3::from(self.half_axis64(v).map(|v| v as f32))
    }

    fn normal(&self, n: Vec3) -> Vec3 {
        Vec3::from(self.turned(n.to_array().map(f64::from)).map(|v| v as f32))
    }

    pub(crate) fn radius(&self, r: f32) -> f32 {
        (f64::from(r) * self.scale) as f32
    }
}

fn dot4(p: Four, q: Four) -> f64 {
    ((p[0] * q[0] + p[1] * q[1]) + p[2] * q[2]) + p[3] * q[3]
}

fn slerp(a: Rows, b: Rows, s: f64) -> Rows {
    let (p, mut q) = (quaternion(a), quaternion(b));
    let mut c = dot4(p, q);
    if c < 0.0 {
        (q, c) = (q.map(|v| -v), -c);
    }
    let between: Four = if c >= 1.0 - (-40.0_f64).exp2() {
        [0, 1, 2, 3].map(|i| p[i] + s * (q[i] - p[i]))
    } else {
        let k = (1.0 - c * c).sqrt();
        let h = k.atan2(c);
        let [u, v] = [((1.0 - s) * h).sin() / k, (s * h).sin() / k];
        [0, 1, 2, 3].map(|i| p[i] * u + q[i] * v)
    };
    let length = dot4(between, between).sqrt();
    matrix(between.map(|v| v / length))
}

/// By the component of the greatest square, the first of equals.
fn quaternion(m: Rows) -> Four {
    let [x, y, z] = [m[0][0], m[1][1], m[2][2]];
    let squares =
        [((1.0 + x) + y) + z, ((1.0 + x) - y) - z, ((1.0 - x) + y) - z, ((1.0 - x) - y) + z];
    let mut greatest = 0;
    for i in 1..4 {
        if squares[i] > squares[greatest] {
            greatest = i;
        }
    }
    let g = 2.0 * squares[greatest].sqrt();
    let [dx, dy, dz] = [m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]];
    let [xy, xz, yz] = [m[1][0] + m[0][1], m[0][2] + m[2][0], m[2][1] + m[1][2]];
    let others = match greatest {
        0 => [0.0, dx, dy, dz],
        1 => [dx, 0.0, xy, xz],
        2 => [dy, xy, 0.0, yz],
        _ => [dz, xz, yz, 0.0],
    };
    let mut all = others.map(|v| v / g);
    all[greatest] = g / 4.0;
    all
}

fn matrix([w, x, y, z]: Four) -> Rows {
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
}

/// Two half axes of a disc, by the page of clouds.
fn halves(n: Vec3, r: f32) -> [Vec3; 2] {
    let [x, y, z] = n.to_array().map(f64::from);
    let c = if x.abs() <= y.abs() && x.abs() <= z.abs() {
        [0.0, -z, y]
    } else if y.abs() <= z.abs() {
        [z, 0.0, -x]
    } else {
        [-y, x, 0.0]
    };
    let part = 1.0 / ((c[0] * c[0] + c[1] * c[1]) + c[2] * c[2]).sqrt();
    let u = c.map(|v| v * part);
    let v = [y * u[2] - z * u[1], z * u[0] - x * u[2], x * u[1] - y * u[0]];
    [u, v].map(|axis| Vec3::from(axis.map(|v| (v * f64::from(r)) as f32)))
}

/// A vector of length 1, unless it is near enough.
fn unit(n: Vec3) -> Vec3 {
    let v = n.to_array().map(f64::from);
    let length = ((v[0] * v[0] + v[1] * v[1]) + v[2] * v[2]).sqrt();
    let near = (length - 1.0).abs() <= (-20.0_f64).exp2();
    if near { n } else { Vec3::from(v.map(|v| (v / length) as f32)) }
}

/// What a scene is made of, with motions that can be read.
#[derive(Clone)]
pub(crate) struct World {
    pub(crate) geometries: Vec<Surfels>,
    /// The geometries with all that they have beside surfels; none if that is nothing.
    pub(crate) whole: Vec<Geometry>,
    pub(crate) objects: Vec<Thing>,
    pub(crate) fill: Vec3,
}

#[derive(Clone)]
pub(crate) struct Thing {
    pub(crate) geometry: usize,
    pub(crate) keys: Vec<(u32, Similarity)>,
    pub(crate) color: Option<Vec3>,
}

impl World {
    /// As the crate has it.
    pub(crate) fn objects(&self) -> Objects {
        let geometry = |(i, surfels): (usize, &Surfels)| Geometry {
            name: format!("geometry {i}"),
            surfels: surfels.clone(),
            primitives: splatref::scene::Primitives::default(),
            detail: None,
        };
        let object = |(i, thing): (usize, &Thing)| Object {
            name: format!("object {i}"),
            geometry: thing.geometry,
            motion: Motion::new(thing.keys.clone()).expect("a motion"),
            color: thing.color,
        };
        let geometries = if self.whole.is_empty() {
            self.geometries.iter().enumerate().map(geometry).collect()
        } else {
            self.whole.clone()
        };
        let objects = self.objects.iter().enumerate().map(object).collect();
        Objects::new(geometries, objects, self.fill).expect("objects")
    }

    pub(crate) fn counts(&self) -> Vec<u32> {
        self.objects.iter().map(|o| self.geometries[o.geometry].len() as u32).collect()
    }

    /// Whether anything has a colour.
    pub(crate) fn colored(&self) -> bool {
        let own = |o: &Thing| self.geometries[o.geometry].color().is_some();
        let beside = |o: &Thing| self.whole.get(o.geometry).is_some_and(|g| g.primitives.colored());
        self.objects.iter().any(|o| o.color.is_some() || own(o) || beside(o))
    }

    /// The lower median of the objects' median radii, once for each surfel.
    pub(crate) fn median(&self, frame: u32) -> f32 {
        let mut all = Vec::new();
        for thing in &self.objects {
            let surfels = &self.geometries[thing.geometry];
            let mut radii = surfels.radius().to_vec();
            radii.sort_by(f32::total_cmp);
            let own = radii.get(radii.len().saturating_sub(1) / 2).copied().unwrap_or(0.0);
            let placed = Place::at(&thing.keys, frame).radius(own);
            all.extend(radii.iter().map(|_| placed));
        }
        all.sort_by(f32::total_cmp);
        all.get(all.len().saturating_sub(1) / 2).copied().unwrap_or(0.0)
    }

    /// The surfels of some ids in their places in a frame.
    pub(crate) fn placed(&self, frame: u32, which: &[(usize, u32)]) -> Cloud {
        let own = |o: &Thing| &self.geometries[o.geometry];
        let any = |has: &dyn Fn(&Thing) -> bool| self.objects.iter().any(has);
        let [opaque, round] =
            [!any(&|o| own(o).opacity().is_some()), !any(&|o| own(o).tangents().is_some())];
        let mut cloud = Cloud {
            normal: Some(Vec::new()),
            radius: Some(Vec::new()),
            color: self.colored().then(Vec::new),
            opacity: (!opaque).then(Vec::new),
            tangents: (!round).then(Vec::new),
            ..Cloud::default()
        };
        let places: Vec<_> = self.objects.iter().map(|o| Place::at(&o.keys, frame)).collect();
        for &(o, s) in which {
            let (thing, place, s) = (&self.objects[o], &places[o], s as usize);
            let surfels = own(thing);
            let (n, r) = (place.normal(surfels.normal()[s]), place.radius(surfels.radius()[s]));
            let color = thing.color.or(surfels.color().map(|c| c[s])).unwrap_or(self.fill);
            let axes = surfels.tangents().map(|t| t[s].map(|v| place.half_axis(v)));
            cloud.position.push(place.point(surfels.position()[s]));
            cloud.normal.as_mut().into_iter().for_each(|all| all.push(unit(n)));
            cloud.radius.as_mut().into_iter().for_each(|all| all.push(r));
            cloud.color.as_mut().into_iter().for_each(|all| all.push(color));
            let opacity = surfels.opacity().map_or(1.0, |all| all[s]);
            cloud.opacity.as_mut().into_iter().for_each(|all| all.push(opacity));
            let axes = axes.unwrap_or_else(|| halves(n, r));
            cloud.tangents.as_mut().into_iter().for_each(|all| all.push(axes));
        }
        cloud
    }
}

/// What the crate knows of a place, against the model's: the greatest difference.
pub(crate) fn apart(place: &Place, found: &Similarity) -> f64 {
    let rows = rows(&found.rotation);
    let pairs = (0..9).map(|i| (place.rows[i / 3][i % 3], rows[i / 3][i % 3]));
    let own = (0..3).map(|i| (place.translation[i], found.translation[i]));
    let differences = pairs.chain(own).chain([(place.scale, found.scale)]);
    differences.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// A similarity: a turn about an axis by degrees, a scale, and a displacement.
pub(crate) fn similarity(axis: DVec3, degrees: f64, scale: f64, to: DVec3) -> Similarity {
    let rotation = splatref::scene::transform::rotation(axis, degrees);
    Similarity { rotation, scale, translation: to }
}
