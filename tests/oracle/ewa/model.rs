//! One pixel of the oracle: both passes, normalization and shading over every surfel of the scene.

use crate::oracle::ewa::splat::{Fragment, Optics, Splat};
use crate::oracle::kit::eye::{Eye, V3, dot, scaled, sub, unit, wide};
use splatref::method::ewa::Settings;
use splatref::scene::{Camera, Light, Scene};

/// A plane's value at a pixel, and the change of it that rounding may cause.
#[derive(Clone, Copy)]
pub(crate) struct Entry {
    pub(crate) plane: &'static str,
    pub(crate) value: V3,
    pub(crate) condition: V3,
}

/// What the oracle knows of a pixel.
pub(crate) struct Pixel {
    /// Whether a decision lies within its rounding error.
    pub(crate) ambiguous: bool,
    /// The surfels that may be the nearest; empty: the pixel is.
    pub(crate) nearest: Vec<u32>,
    pub(crate) count: usize,
    pub(crate) entries: Vec<Entry>,
}

/// A fragment, and whose it is.
pub(crate) type Seen<'a> = (&'a Splat, Fragment);

/// A scene before a camera.
pub(crate) struct Oracle<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) optics: Optics,
    pub(crate) epsilon: f64,
    splats: Vec<Splat>,
    /// Step of the inputs, and how many conditions count as rounding.
    pub(crate) step: f64,
    pub(crate) guard: f64,
}

impl<'a> Oracle<'a> {
    /// `step`: the relative rounding error that conditions are measured for.
    pub(crate) fn new(
        scene: &'a Scene,
        camera: &Camera,
        settings: &Settings,
        [step, guard]: [f64; 2],
    ) -> Self {
        let optics = Optics::new(camera, settings);
        let splats = (0..scene.surfels.len())
            .filter_map(|i| {
                Splat::new(&optics, &scene.surfels, (i, 1.0), settings.cull, [step, guard])
            })
            .collect();
        let epsilon = settings.epsilon.resolve(&scene.surfels).into();
        Self { scene, optics, epsilon, splats, step, guard }
    }

    /// How many surfels are drawn or outside the picture; none if that is in doubt.
    pub(crate) fn drawn(&self) -> Option<u64> {
        let doubt = self.splats.iter().any(|s| s.doubtful);
        (!doubt).then_some(self.splats.len() as u64)
    }

    /// The fragments at a point of the picture, of splats in ascending surfel index.
    pub(crate) fn fragments(&self, [x, y]: [f64; 2]) -> Vec<Seen<'_>> {
        let drawn = self.splats.iter().filter(|s| !s.outside || s.doubtful);
        drawn.filter_map(|s| s.fragment(&self.optics, x, y).map(|f| (s, f))).collect()
    }

    /// k^2: a fragment is inside if q <= this.
    pub(crate) fn limit(&self) -> f64 {
        self.optics.k * self.optics.k
    }

    /// The rounding error of q.
    pub(crate) fn margin(&self, f: &Fragment) -> f64 {
        self.guard * (f.spread.q + self.step * self.limit())
    }

    /// Whether it is in doubt that the fragment is drawn and inside, or that it is not.
    pub(crate) fn unsure(&self, (s, f): &Seen<'_>) -> bool {
        s.doubtful || (f.value.q - self.limit()).abs() <= self.margin(f)
    }

    /// The rounding error of a depth.
    pub(crate) fn slack(&self, f: &Fragment) -> f64 {
        self.guard * (f.spread.t + self.step * f.value.t.abs())
    }

    /// The rounding error that epsilon adds to a comparison with one that is epsilon away.
    pub(crate) fn band(&self) -> f64 {
        if self.epsilon.is_finite() { 2.0 * self.guard * self.step * self.epsilon } else { 0.0 }
    }

    /// The pixel at a column and row.
    pub(crate) fn pixel(&self, x: u32, y: u32) -> Pixel {
        let at = [f64::from(x) + 0.5, f64::from(y) + 0.5];
        let all = self.fragments(at);
        let limit = self.limit();
        let inside: Vec<_> = all.iter().filter(|(_, f)| f.value.q <= limit).copied().collect();
        let (first, first_slack) = self.first(&inside);
        let reach = first + self.epsilon + first_slack + self.band();
        let mut ambiguous = all.iter().any(|seen| {
            let near_limit = seen.1.value.q - limit <= self.margin(&seen.1);
            near_limit && self.unsure(seen) && seen.1.value.t - self.slack(&seen.1) <= reach
        });
        ambiguous |= self.grazes(&inside);
        let nearest = self.nearest(&inside);
        let seen = self.seen(&inside);
        let entries = self.entries(at, &inside, &seen);
        Pixel { ambiguous, nearest, count: seen.len(), entries }
    }

    /// The least depth, and its rounding error.
    pub(crate) fn first(&self, inside: &[Seen<'_>]) -> (f64, f64) {
        let first = inside.iter().map(|(_, f)| f.value.t).fold(f64::INFINITY, f64::min);
        let those = inside.iter().filter(|(_, f)| f.value.t == first);
        (first, those.map(|(_, f)| self.slack(f)).fold(0.0, f64::max))
    }

    /// Those that pass the epsilon-z test.
    pub(crate) fn seen<'b>(&self, inside: &[Seen<'b>]) -> Vec<Seen<'b>> {
        let (first, _) = self.first(inside);
        inside.iter().filter(|(_, f)| f.value.t <= first + self.epsilon).copied().collect()
    }

    /// The surfels that may be the nearest.
    pub(crate) fn nearest(&self, inside: &[Seen<'_>]) -> Vec<u32> {
        let (first, first_slack) = self.first(inside);
        let close = |f: &Fragment| f.value.t - first <= self.slack(f) + first_slack;
        inside.iter().filter(|(_, f)| close(f)).map(|(s, _)| s.index as u32).collect()
    }

    /// Whether the epsilon-z test of any fragment is within its rounding error.
    pub(crate) fn grazes(&self, inside: &[Seen<'_>]) -> bool {
        let (first, first_slack) = self.first(inside);
        inside.iter().any(|(_, f)| {
            let beyond = f.value.t - (first + self.epsilon);
            f.value.t != first && beyond.abs() <= self.slack(f) + first_slack + self.band()
        })
    }

    /// The values of all planes from the `seen` of the fragments `inside`.
    pub(crate) fn entries(
        &self,
        at: [f64; 2],
        inside: &[Seen<'_>],
        seen: &[Seen<'_>],
    ) -> Vec<Entry> {
        let mut entries = Vec::new();
        if seen.is_empty() {
            return entries;
        }
        let (first, first_slack) = self.first(inside);
        let close = |f: &Fragment| f.value.t - first <= self.slack(f) + first_slack;
        let spreads = inside.iter().filter(|(_, f)| close(f)).map(|(_, f)| f.spread.t);
        let condition = [spreads.fold(0.0, f64::max); 3];
        self.sum(seen, &mut entries);
        let depth = Entry { plane: "Z", value: [first; 3], condition };
        entries.push(Entry { plane: "visibility.Z", ..depth });
        entries.push(depth);
        self.shade(at, &mut entries);
        for entry in &mut entries {
            for i in 0..3 {
                entry.condition[i] += self.step * entry.value[i].abs();
            }
        }
        entries
    }

    /// The sums and what normalization makes of them.
    fn sum(&self, seen: &[Seen<'_>], entries: &mut Vec<Entry>) {
        let surfels = &self.scene.surfels;
        let mut weight = Entry { plane: "weight", value: [0.0; 3], condition: [0.0; 3] };
        let mut normal = Entry { plane: "attributes.normal", ..weight };
        let mut color = Entry { plane: "attributes", ..weight };
        let add = |sum: &mut Entry, value: V3, f: &Fragment| {
            for (i, v) in value.into_iter().enumerate() {
                sum.value[i] += f.value.weight * v;
                sum.condition[i] += (f.spread.weight + self.step * f.value.weight) * v.abs();
            }
        };
        for (splat, f) in seen {
            let n = wide(surfels.normal()[splat.index]);
            add(&mut weight, [1.0; 3], f);
            add(&mut normal, scaled(n, if splat.back { -1.0 } else { 1.0 }), f);
            if let Some(colors) = surfels.color() {
                add(&mut color, wide(colors[splat.index]), f);
            }
        }
        let (w, dw) = (weight.value[0], weight.condition[0]);
        let average = |sum: &Entry, plane| {
            let value = scaled(sum.value, 1.0 / w);
            let condition = std::array::from_fn(|i| (sum.condition[i] + value[i].abs() * dw) / w);
            Entry { plane, value, condition }
        };
        let resolved = average(&color, "resolved");
        let mean = average(&normal, "normal");
        let length = dot(mean.value, mean.value).sqrt();
        let error = dot(mean.condition, mean.condition).sqrt() / length;
        let direction = Entry {
            value: scaled(mean.value, 1.0 / length),
            condition: [error; 3],
            plane: "normal",
        };
        entries.extend([weight, Entry { plane: "attributes.weight", ..weight }, normal, direction]);
        if surfels.color().is_some() {
            entries.extend([color, resolved]);
        }
    }

    /// Phong shading, and its change with each of its inputs.
    fn shade(&self, [x, y]: [f64; 2], entries: &mut Vec<Entry>) {
        let find = |plane| entries.iter().find(|e| e.plane == plane).copied();
        let (Some(normal), Some(depth)) = (find("normal"), find("Z")) else { return };
        let material = wide(self.scene.material.color);
        let own = Entry { plane: "", value: material, condition: [0.0; 3] };
        let surface = find("resolved").unwrap_or(own);
        let value = self.phong([x, y], depth.value[0], normal.value, surface.value);
        let mut condition = scaled(value, 0.0);
        let mut vary = |t: f64, n: V3, s: V3| {
            let change = sub(self.phong([x, y], t, n, s), value);
            for i in 0..3 {
                condition[i] += change[i].abs();
            }
        };
        vary(depth.value[0] + depth.condition[0], normal.value, surface.value);
        for i in 0..3 {
            let mut n = normal.value;
            n[i] += normal.condition[i] + self.step;
            vary(depth.value[0], n, surface.value);
        }
        let brighter = std::array::from_fn(|i| surface.value[i] + surface.condition[i]);
        vary(depth.value[0], normal.value, brighter);
        entries.push(Entry { plane: "", value, condition });
    }

    /// The colour of a surface with a world-space normal at depth t.
    pub(crate) fn phong(&self, [x, y]: [f64; 2], t: f64, normal: V3, surface: V3) -> V3 {
        let eye: &Eye = &self.optics.eye;
        if self.scene.lights.is_empty() {
            return surface;
        }
        let phong = &self.scene.material;
        let (origin, ray) = eye.ray(x, y);
        let p: V3 = std::array::from_fn(|i| origin[i] + t * ray[i]);
        let v = if eye.perspective { unit(scaled(p, -1.0)) } else { [0.0, 0.0, 1.0] };
        let n = eye.direction(normal);
        let mut color = scaled(surface, phong.ambient.into());
        for light in &self.scene.lights {
            let (l, light_color) = match *light {
                Light::Directional { towards, color } => {
                    (unit(eye.direction(wide(towards))), color)
                }
                Light::Headlight { towards, color } => (unit(wide(towards)), color),
                Light::Point { position, color } => {
                    (unit(sub(eye.point(wide(position)), p)), color)
                }
            };
            let incident = dot(n, l);
            if incident <= 0.0 {
                continue;
            }
            let r = sub(scaled(n, 2.0 * incident), l);
            let gloss = dot(r, v);
            let highlight = if gloss > 0.0 { gloss.powf(phong.shininess.into()) } else { 0.0 };
            for i in 0..3 {
                let body = f64::from(phong.diffuse) * incident * surface[i];
                let shine = f64::from(phong.specular) * highlight;
                color[i] += wide(light_color)[i] * (body + shine);
            }
        }
        color
    }
}
