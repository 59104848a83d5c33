//! Surfels as pixels \[MOC08, section 3.1\] by brute force, and the shading of what is
//! reconstructed.
//!
//! Which pixel a surfel falls into and which is the nearest there can hang on rounding. So every
//! pixel has a list of all that it may show; whoever compares asks which it does.

use crate::kit::eye::{Eye, V3, wide};
use crate::template::rounded::{Rounded, dot, scaled, unit};
use splatref::scene::{Camera, Light, Scene};
use std::cmp::Ordering;

/// What became of a surfel: the index of its number in a tally, in the order of the questions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fate {
    Behind,
    BackFacing,
    Outside,
    Visible,
}

/// A surfel as it may be drawn.
#[derive(Clone, Debug)]
pub(crate) struct Shot {
    pub(crate) id: u32,
    /// None if rounding decides.
    pub(crate) fate: Option<Fate>,
    /// The pixels that it may be drawn into: several if it is near the edge of one.
    pub(crate) pixels: Vec<[u32; 2]>,
    /// Whether the back is seen, so that the normal is reversed.
    pub(crate) back: Option<bool>,
    pub(crate) depth: Rounded,
    pub(crate) extent: Rounded,
    pub(crate) center: [Rounded; 2],
    /// As seen from the front.
    pub(crate) normal: [Rounded; 3],
    pub(crate) radius: f64,
    pub(crate) color: V3,
    position: V3,
}

impl Shot {
    /// Whether it is certainly drawn into that one pixel.
    pub(crate) fn is_sure(&self) -> bool {
        self.fate == Some(Fate::Visible) && self.pixels.len() == 1
    }

    /// Whether it certainly hides the other where both are drawn; ties go to the lower id.
    pub(crate) fn hides(&self, other: &Self, unit: f64) -> bool {
        let order = if self.position == other.position {
            Some(Ordering::Equal)
        } else {
            other.depth.compare(self.depth, unit)
        };
        let tie = order == Some(Ordering::Equal) && self.id < other.id;
        self.is_sure() && (tie || order == Some(Ordering::Greater))
    }
}

/// A camera, and the rounding times the guard of decisions.
pub(crate) struct Projection {
    eye: Eye,
    rows: [V3; 3],
    moves: V3,
    size: [u32; 2],
    cull: bool,
    unit: f64,
}

impl Projection {
    pub(crate) fn new(camera: &Camera, cull: bool, unit: f64) -> Self {
        let rows = [0, 1, 2].map(|i| camera.view_from_world.row(i).to_array().map(f64::from));
        Self {
            eye: Eye::new(camera),
            rows: rows.map(|m| [m[0], m[1], m[2]]),
            moves: rows.map(|m| m[3]),
            size: [camera.width, camera.height],
            cull,
            unit,
        }
    }

    /// The rotation of the view, row by row.
    pub(crate) fn view(&self) -> &[V3; 3] {
        &self.rows
    }

    fn direction(&self, world: V3) -> [Rounded; 3] {
        self.rows.map(|row| dot(Rounded::vector(row), Rounded::vector(world)))
    }

    fn point(&self, world: V3) -> [Rounded; 3] {
        let turned = self.direction(world);
        [0, 1, 2].map(|i| turned[i] + Rounded::exact(self.moves[i]))
    }

    /// Every surfel of a scene.
    pub(crate) fn shots(&self, scene: &Scene) -> Vec<Shot> {
        (0..scene.surfels.len()).map(|i| self.shot(scene, i)).collect()
    }

    fn shot(&self, scene: &Scene, i: usize) -> Shot {
        let surfels = &scene.surfels;
        let (position, radius) = (wide(surfels.position()[i]), f64::from(surfels.radius()[i]));
        let (p, n) = (self.point(position), self.direction(wide(surfels.normal()[i])));
        let eye = &self.eye;
        let [fx, fy, cx, cy] = [eye.fx, eye.fy, eye.cx, eye.cy].map(Rounded::exact);
        let depth = -p[2];
        let near = if eye.perspective { Rounded::ONE / depth } else { Rounded::ONE };
        let (a, b) = (p[0] * near, p[1] * near);
        let center = [cx + fx * a, cy - fy * b];
        let facing = if eye.perspective { n[0] * a + n[1] * b - n[2] } else { -n[2] };
        let scale = (fx * fy).sqrt() * near;
        let extent = (Rounded::exact(radius) * scale).at_most(48.0_f64.exp2());
        let pixels = self.pixels(center);
        let certain = pixels.len() == 1 || pixels.is_empty();
        let fate = match (depth.above(Rounded::exact(eye.near), self.unit), self.culled(facing)) {
            (None, _) | (Some(true), None) => None,
            (Some(false), _) => Some(Fate::Behind),
            (_, Some(true)) => Some(Fate::BackFacing),
            _ if !certain => None,
            _ if pixels.is_empty() => Some(Fate::Outside),
            _ => Some(Fate::Visible),
        };
        let seen = !matches!(fate, Some(Fate::Behind | Fate::BackFacing));
        Shot {
            id: i as u32,
            fate,
            pixels: if seen { pixels.into_iter().flatten().collect() } else { Vec::new() },
            back: facing.above(Rounded::ZERO, self.unit),
            depth,
            extent,
            center,
            normal: n,
            radius,
            color: surfels.color().map_or([0.0; 3], |colors| wide(colors[i])),
            position,
        }
    }

    /// With culling a surfel is dropped unless its front is seen.
    fn culled(&self, facing: Rounded) -> Option<bool> {
        if !self.cull {
            return Some(false);
        }
        Rounded::ZERO.above(facing, self.unit).map(|front| !front)
    }

    /// The pixels that a centre may lie in, none standing for any outside; empty if all are.
    fn pixels(&self, center: [Rounded; 2]) -> Vec<Option<[u32; 2]>> {
        let span = |i: usize| {
            let reach = center[i].units * self.unit;
            let ends = [center[i].value - reach, center[i].value + reach].map(f64::floor);
            if ends[0] == ends[1] { vec![ends[0]] } else { ends.to_vec() }
        };
        let inside = |v: f64, size: u32| (v >= 0.0 && v < f64::from(size)).then_some(v as u32);
        let mut all = Vec::new();
        for y in span(1) {
            for x in span(0) {
                let pixel = inside(x, self.size[0]).zip(inside(y, self.size[1]));
                all.push(pixel.map(|(x, y)| [x, y]));
            }
        }
        if all.iter().all(Option::is_none) { Vec::new() } else { all }
    }

    /// The colour of a pixel; none if rounding decides whether a light or a highlight is seen.
    pub(crate) fn shaded(
        &self,
        scene: &Scene,
        pixel: [u32; 2],
        (depth, normal, surface): (f64, V3, [Rounded; 3]),
    ) -> Option<[Rounded; 3]> {
        if scene.lights.is_empty() {
            return Some(surface);
        }
        let phong = &scene.material;
        let number = |v: f32| Rounded::exact(v.into());
        let p = self.seen_at(pixel, Rounded::exact(depth));
        let towards = unit(p.map(|v| -v));
        let v = if self.eye.perspective { towards } else { Rounded::vector([0.0, 0.0, 1.0]) };
        let n = self.direction(normal);
        let mut color = scaled(surface, number(phong.ambient));
        for light in &scene.lights {
            let (l, light_color) = match *light {
                Light::Directional { towards, color } => {
                    (unit(self.direction(wide(towards))), color)
                }
                Light::Headlight { towards, color } => {
                    (unit(Rounded::vector(wide(towards))), color)
                }
                Light::Point { position, color } => {
                    let at = self.point(wide(position));
                    (unit([0, 1, 2].map(|i| at[i] - p[i])), color)
                }
            };
            let incident = dot(n, l);
            if !incident.above(Rounded::ZERO, self.unit)? {
                continue;
            }
            let twice = incident + incident;
            let gloss = dot([0, 1, 2].map(|i| n[i] * twice - l[i]), v);
            let highlight = if gloss.above(Rounded::ZERO, self.unit)? {
                gloss.power(phong.shininess.into()) * number(phong.specular)
            } else {
                Rounded::ZERO
            };
            for i in 0..3 {
                let body = number(phong.diffuse) * incident * surface[i];
                color[i] = color[i] + number(light_color[i]) * (body + highlight);
            }
        }
        Some(color)
    }

    /// The point that a pixel shows at a depth.
    fn seen_at(&self, pixel: [u32; 2], depth: Rounded) -> [Rounded; 3] {
        let eye = &self.eye;
        let [x, y] = pixel.map(|v| Rounded::exact(f64::from(v) + 0.5));
        let u = (x - Rounded::exact(eye.cx)) / Rounded::exact(eye.fx);
        let v = (Rounded::exact(eye.cy) - y) / Rounded::exact(eye.fy);
        let far = if eye.perspective { depth } else { Rounded::ONE };
        [u * far, v * far, -depth]
    }
}
