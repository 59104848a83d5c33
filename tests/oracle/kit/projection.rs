//! The projection to single pixels by other means: for every pixel, all that may be seen there.
//!
//! Nothing is discarded on the way: a pixel has the list of all candidates, and the picture is held
//! to it. Where rounding may decide where something is, there is a candidate for each outcome.

use crate::oracle::kit::eye::wide;
use crate::oracle::kit::number::{N3, Num, dot, exact, negated, normalized};
use crate::oracle::kit::pieces::{Piece, pieces};
use splatref::scene::{Camera, Projection, Scene};
use splatref::splat::Tally;
use std::collections::BTreeSet;

/// The number of this kind of primitive among the planes.
pub(crate) const TUBE: u8 = 3;

/// What one pixel may keep.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate<const P: u32> {
    pub(crate) id: u32,
    pub(crate) kind: u8,
    /// Whether it is sure that this is drawn into the pixel.
    pub(crate) certain: bool,
    /// What has several outcomes has several candidates of one number.
    pub(crate) group: usize,
    pub(crate) t: Num<P>,
    pub(crate) normal: N3<P>,
    pub(crate) tangent: N3<P>,
    pub(crate) extent: Num<P>,
    pub(crate) radius: Num<P>,
    pub(crate) center: [Num<P>; 2],
    pub(crate) color: N3<P>,
    /// The position of a surfel: two at one place have one depth.
    place: Option<glam::Vec3>,
}

impl<const P: u32> Candidate<P> {
    /// Whether it is certainly drawn, and in front of another: nearer, or of equal depth and a
    /// lower id.
    pub(crate) fn is_before(&self, other: &Self) -> bool {
        let known =
            self.t.e + other.t.e == 0.0 || (self.place.is_some() && self.place == other.place);
        let tie = known && self.t.v == other.t.v && (self.id, self.group) < (other.id, other.group);
        self.certain && (tie || self.t.less(other.t) == Some(true))
    }

    /// Whether all outcomes of another are in front.
    pub(crate) fn is_hidden(&self, all: &[Self]) -> bool {
        let others = all.iter().filter(|k| k.group != self.group && k.is_before(self));
        others
            .into_iter()
            .any(|k| all.iter().filter(|j| j.group == k.group).all(|j| j.is_before(self)))
    }
}

/// What became of surfels: visible, behind, degenerate, back-facing, outside; and of how many that
/// is in doubt.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Fates {
    counts: [u64; 5],
    open: u64,
}

impl Fates {
    /// Asserts that every surfel has the fate it should have, if no rounding decides one.
    pub(crate) fn check(&self, tally: &Tally, surfels: usize, name: &str) {
        let Tally { visible, behind, degenerate, back_facing, outside } = *tally;
        let found = [visible, behind, degenerate, back_facing, outside];
        for (found, sure) in found.into_iter().zip(self.counts) {
            assert!((sure..=sure + self.open).contains(&found), "{tally:?} for {self:?} in {name}");
        }
        assert_eq!(found.iter().sum::<u64>(), surfels as u64, "{tally:?} in {name}");
    }
}

/// The camera in the arithmetic.
pub(crate) struct Sight<const P: u32> {
    rows: [[Num<P>; 4]; 3],
    pub(crate) perspective: bool,
    pub(crate) fx: Num<P>,
    pub(crate) fy: Num<P>,
    pub(crate) cx: Num<P>,
    pub(crate) cy: Num<P>,
    pub(crate) near: Num<P>,
    size: [u32; 2],
}

/// A point before the camera: m, (a, b), and where it is in the picture.
pub(crate) struct Placed<const P: u32> {
    pub(crate) m: Num<P>,
    a: Num<P>,
    b: Num<P>,
    pub(crate) at: [Num<P>; 2],
}

impl<const P: u32> Sight<P> {
    pub(crate) fn new(camera: &Camera) -> Self {
        let number = |v: f32| Num::exact(v.into());
        let row = |i| camera.view_from_world.row(i).to_array().map(number);
        Self {
            rows: [row(0), row(1), row(2)],
            perspective: camera.projection == Projection::Perspective,
            fx: number(camera.fx),
            fy: number(camera.fy),
            cx: number(camera.cx),
            cy: number(camera.cy),
            near: number(camera.near),
            size: [camera.width, camera.height],
        }
    }

    pub(crate) fn point(&self, p: glam::Vec3) -> N3<P> {
        let p = exact(wide(p));
        self.rows.map(|m| dot([m[0], m[1], m[2]], p) + m[3])
    }

    pub(crate) fn direction(&self, n: N3<P>) -> N3<P> {
        self.rows.map(|m| dot([m[0], m[1], m[2]], n))
    }

    /// From view space to world space, divided by its length.
    pub(crate) fn outwards(&self, n: N3<P>) -> N3<P> {
        normalized(self.turned(n))
    }

    /// From view space to world space.
    pub(crate) fn turned(&self, n: N3<P>) -> N3<P> {
        [0, 1, 2].map(|i| dot(self.rows.map(|m| m[i]), n))
    }

    pub(crate) fn place(&self, p: N3<P>) -> Placed<P> {
        let m = if self.perspective { Num::exact(1.0) / -p[2] } else { Num::exact(1.0) };
        let (a, b) = (p[0] * m, p[1] * m);
        Placed { m, a, b, at: [self.cx + self.fx * a, self.cy - self.fy * b] }
    }

    /// g: negative where the front is seen.
    pub(crate) fn facing(&self, placed: &Placed<P>, n: N3<P>) -> Num<P> {
        if self.perspective { (n[0] * placed.a + n[1] * placed.b) - n[2] } else { -n[2] }
    }

    /// Pixels of a length in world units.
    pub(crate) fn extent(&self, radius: Num<P>, m: Num<P>) -> Num<P> {
        (radius * ((self.fx * self.fy).sqrt() * m)).at_most(48.0_f64.exp2())
    }
}

/// The cells that a number may lie in: its floor, and its neighbour's if rounding may decide.
fn floors<const P: u32>(x: Num<P>) -> Vec<i64> {
    let mut all: Vec<i64> = [x.v - x.e, x.v, x.v + x.e].map(|v| v.floor() as i64).to_vec();
    if x.e == 0.0 {
        all.truncate(1);
    }
    all.dedup();
    all
}

/// All candidates of every pixel.
pub(crate) struct Projected<const P: u32> {
    sight: Sight<P>,
    pub(crate) pixels: Vec<Vec<Candidate<P>>>,
    pub(crate) fates: Fates,
    /// Primitives of which rounding decides too much.
    pub(crate) loose: Vec<u32>,
    groups: usize,
}

impl<const P: u32> Projected<P> {
    /// `bits`: of the grid that primitives are snapped to.
    pub(crate) fn new(scene: &Scene, camera: &Camera, cull: bool, bits: u32) -> Self {
        let pixels = vec![Vec::new(); (camera.width * camera.height) as usize];
        let (sight, fates) = (Sight::new(camera), Fates::default());
        let mut all = Self { sight, pixels, fates, loose: Vec::new(), groups: 0 };
        for i in 0..scene.surfels.len() {
            all.surfel(scene, i, cull);
        }
        all.groups = scene.surfels.len();
        let mut id = scene.surfels.len() as u32;
        for i in 0..scene.primitives.triangles.len() {
            let primitive =
                Primitive::new(&all.sight, scene, &scene.primitives.triangles, (i, id, 4));
            all.primitive(&primitive, bits, cull);
            id += 1;
        }
        for (list, kind) in [(&scene.primitives.ribbons, 2), (&scene.primitives.tubes, 3)] {
            for i in 0..list.len() {
                let primitive = Primitive::new(&all.sight, scene, list, (i, id, kind));
                all.primitive(&primitive, bits, cull);
                id += 1;
            }
        }
        all
    }

    /// Enters a candidate, if the pixel is one of the picture.
    fn enter(&mut self, x: i64, y: i64, candidate: Candidate<P>) {
        let [width, height] = self.sight.size.map(i64::from);
        if (0..width).contains(&x) && (0..height).contains(&y) {
            self.pixels[(y * width + x) as usize].push(candidate);
        }
    }

    fn surfel(&mut self, scene: &Scene, i: usize, cull: bool) {
        let (surfels, sight) = (&scene.surfels, &self.sight);
        let p = sight.point(surfels.position()[i]);
        let n = sight.direction(exact(wide(surfels.normal()[i])));
        let (t, placed) = (-p[2], sight.place(p));
        let g = sight.facing(&placed, n);
        let [x, y] = placed.at;
        let back = Num::ZERO.at_most_as(g);
        let [width, height] = sight.size.map(f64::from);
        let within = |v: Num<P>, size: f64| and(Num::ZERO.at_most_as(v), v.less(Num::exact(size)));
        // In the order of the fates: the first that holds.
        let finite = [x, y, t, g].iter().all(|v| v.v.is_finite());
        let questions = [
            (1, sight.near.less(t).map(|yes| !yes)),
            (2, Some(!finite)),
            (3, if cull { back } else { Some(false) }),
            (4, and(within(x, width), within(y, height)).map(|yes| !yes)),
        ];
        let mut certain = true;
        for (fate, answer) in questions {
            match answer {
                Some(true) if certain => return self.fates.counts[fate] += 1,
                Some(true) => return,
                Some(false) => {}
                None => {
                    self.fates.open += u64::from(certain);
                    certain = false;
                }
            }
        }
        self.fates.counts[0] += u64::from(certain);
        let color = match surfels.color() {
            Some(all) => wide(all[i]),
            None => colorless(scene),
        };
        let radius = Num::exact(surfels.radius()[i].into());
        let candidate = Candidate {
            id: i as u32,
            kind: 1,
            certain,
            group: i,
            t,
            normal: n,
            tangent: exact([0.0; 3]),
            extent: sight.extent(radius, placed.m),
            radius,
            center: [x, y],
            color: exact(color),
            place: Some(surfels.position()[i]),
        };
        let (columns, rows) = (floors(x), floors(y));
        let certain = certain && columns.len() * rows.len() == 1;
        for normal in turned(n, Num::ZERO.less(g)) {
            for (x, y) in columns.iter().flat_map(|x| rows.iter().map(move |y| (*x, *y))) {
                self.enter(x, y, Candidate { normal, certain, ..candidate });
            }
        }
    }

    fn primitive<const N: usize>(&mut self, primitive: &Primitive<P, N>, bits: u32, cull: bool) {
        let Ok(drawn) = pieces(&self.sight, &primitive.points, bits) else {
            return self.loose.push(primitive.id);
        };
        // Each piece has a list of outcomes of snapping: what all of them cover is certain.
        for outcomes in drawn {
            let all: Vec<_> = outcomes.iter().map(|piece| piece.covered(self.sight.size)).collect();
            let set = |pixels: &Vec<(i64, i64, _)>| -> BTreeSet<_> {
                pixels.iter().map(|(x, y, _)| (*x, *y)).collect()
            };
            let sets: Vec<_> = all.iter().map(set).collect();
            for (piece, pixels) in outcomes.iter().zip(&all) {
                if cull && primitive.kind == 4 && !piece.front() {
                    continue;
                }
                let sides = outcomes.iter().all(|other| other.front() == piece.front());
                let mut visited = BTreeSet::new();
                for (x, y, weights) in pixels {
                    // A line may visit a pixel twice.
                    let group = self.groups + usize::from(!visited.insert((*x, *y)));
                    let certain = sides && sets.iter().all(|set| set.contains(&(*x, *y)));
                    for candidate in primitive.candidates(&self.sight, piece, weights, (*x, *y)) {
                        self.enter(*x, *y, Candidate { certain, group, ..candidate });
                    }
                }
            }
            self.groups += 2;
        }
    }
}

/// Both or neither side of a vector, where its sign is open.
fn turned<const P: u32>(n: N3<P>, back: Option<bool>) -> Vec<N3<P>> {
    match back {
        Some(true) => vec![negated(n)],
        Some(false) => vec![n],
        None => vec![n, negated(n)],
    }
}

/// Both hold, as far as that is known.
pub(crate) fn and(a: Option<bool>, b: Option<bool>) -> Option<bool> {
    if a == Some(false) || b == Some(false) { Some(false) } else { a.zip(b).map(|_| true) }
}

/// What has no colour has the material's where others have one.
fn colorless(scene: &Scene) -> [f64; 3] {
    let there = scene.surfels.color().is_some() || scene.primitives.colored();
    if there { wide(scene.material.color) } else { [0.0; 3] }
}

/// A triangle or a segment before the camera.
struct Primitive<const P: u32, const N: usize> {
    id: u32,
    kind: u8,
    points: [N3<P>; N],
    /// In world space, where they are interpolated.
    directions: [N3<P>; N],
    radii: [Num<P>; N],
    colors: Option<[N3<P>; N]>,
    colorless: N3<P>,
}

impl<const P: u32, const N: usize> Primitive<P, N> {
    fn new(
        sight: &Sight<P>,
        scene: &Scene,
        list: &splatref::scene::indexed::Indexed<N>,
        (i, id, kind): (usize, u32, u8),
    ) -> Self {
        let (vertices, corners) = (list.vertices(), list.corners()[i].map(|v| v as usize));
        // The tangents of a tube's ends agree.
        let mut directions = corners.map(|v| wide(vertices.direction[v]));
        let dot: f64 = (0..3).map(|k| directions[0][k] * directions[1][k]).sum();
        if kind == TUBE && dot < 0.0 {
            directions[1] = directions[1].map(|v| -v);
        }
        Self {
            id,
            kind,
            points: corners.map(|v| sight.point(vertices.position[v])),
            directions: directions.map(exact),
            radii: corners.map(|v| Num::exact(vertices.radius[v].into())),
            colors: vertices.color.as_ref().map(|all| corners.map(|v| exact(wide(all[v])))),
            colorless: exact(colorless(scene)),
        }
    }

    /// What a pixel keeps of a piece; two if its side is open.
    fn candidates(
        &self,
        sight: &Sight<P>,
        piece: &Piece<P, N>,
        weights: &[Num<P>],
        (x, y): (i64, i64),
    ) -> Vec<Candidate<P>> {
        let c = piece.shares(weights);
        let sum = |of: &dyn Fn(usize) -> Num<P>| {
            let two = c[0] * of(0) + c[1] * of(1);
            if N == 3 { two + c[2] * of(2) } else { two }
        };
        let vector = |of: &[N3<P>; N]| [0, 1, 2].map(|i| sum(&|k| of[k][i]));
        let p = vector(&self.points);
        let (t, placed) = (-p[2], sight.place(p));
        let (radius, direction) =
            (sum(&|k| self.radii[k]), normalized(sight.direction(vector(&self.directions))));
        let null = exact([0.0; 3]);
        let (normals, tangent) = match self.kind {
            4 => (turned(direction, Some(!piece.front())), null),
            2 => (turned(direction, Num::ZERO.less(sight.facing(&placed, direction))), null),
            _ if sight.perspective => (vec![normalized(negated(p))], direction),
            _ => (vec![exact([0.0, 0.0, 1.0])], direction),
        };
        let candidate = |normal| Candidate {
            id: self.id,
            kind: self.kind,
            certain: true,
            group: 0,
            t,
            normal,
            tangent,
            extent: sight.extent(radius, placed.m),
            radius,
            center: [x, y].map(|v| Num::exact(v as f64 + 0.5)),
            color: self.colors.as_ref().map_or(self.colorless, vector),
            place: None,
        };
        normals.into_iter().map(candidate).collect()
    }
}
