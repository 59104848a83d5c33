//! Pixels side by side: every lane does the operations of the definition, in its order.
//!
//! Pixels are gathered into arrays, shaded in straight loops, and scattered. A branch of the
//! definition becomes a choice between two results; only the powers differ, see [`Exact::powers`].

use super::{Answer, Form, Shader, mirrored};
use crate::number::ball::{BallLanes, Common, Profile};
use crate::number::lanes::{
    LANES, Lanes, any, components, load, mask, put_vector, transposed, vector, vectorized,
};
use crate::number::{Ball, Exact, MapInline, Real, Vector3};

/// One row of the picture.
pub(super) struct ShadedRow<'a, R> {
    /// Column and row of the first pixel.
    pub(super) at: (usize, usize),
    /// t, +inf where a pixel is empty.
    pub(super) depth: &'a [R],
    /// World space.
    pub(super) normal: Option<&'a [[R; 3]]>,
    /// World space; the null vector where there is no tube.
    pub(super) tangent: Option<&'a [[R; 3]]>,
    /// s of all pixels; if absent, each pixel holds its own.
    pub(super) own: Option<[R; 3]>,
}

vectorized!(
    /// Shades a row, as [`Shader::pixel`] does pixel by pixel.
    pub(super) fn shade<R: Exact>(
        shader: &Shader<R>,
        row: &ShadedRow<'_, R>,
        pixels: &mut [[R; 3]],
    ) {
        let (groups, rest) = pixels.as_chunks_mut();
        let whole = groups.len() * LANES;
        for (first, pixels) in (0..whole).step_by(LANES).zip(groups) {
            group(shader, row, first, pixels);
        }
        let one = |plane: Option<&[[R; 3]]>, x: usize| {
            plane.map_or(Vector3::ZERO, |p| Vector3::new(p[x][0], p[x][1], p[x][2]))
        };
        for (x, pixel) in (whole..).zip(rest) {
            let (normal, tangent) = (one(row.normal, x), one(row.tangent, x));
            let surface = row.own.unwrap_or(*pixel);
            let at = (row.at.0 + x, row.at.1);
            *pixel = shader.pixel(at, row.depth[x], normal, tangent, surface);
        }
    }
);

/// Shades the pixels from column `first` on.
#[inline(always)]
fn group<R: Exact>(
    shader: &Shader<R>,
    row: &ShadedRow<'_, R>,
    first: usize,
    pixels: &mut [[R; 3]; LANES],
) {
    let depth = load(row.depth, first);
    // Empty stretches of a picture are common and need no shading.
    if !any(&mask(|i| depth[i].is_finite())) {
        *pixels = [[R::ZERO; 3]; LANES];
        return;
    }
    let surface = match row.own {
        Some(own) => own.map_inline(|s| [s; LANES]),
        None => transposed(pixels),
    };
    let mut color = surface;
    if !shader.lights.is_empty() {
        let mut points = [[R::ZERO; LANES]; 3];
        for (i, &t) in depth.iter().enumerate() {
            put_vector(&mut points, i, shader.position(row.at.0 + first + i, row.at.1, t));
        }
        let normal = gather(row.normal, first).unwrap_or([[R::ZERO; LANES]; 3]);
        color = match gather(row.tangent, first) {
            None => {
                let turned = |i| shader.view.direction(vector(&normal, i));
                let form = |i| Form { normal: turned(i), tangent: Vector3::ZERO };
                lit(shader, &points, form, &surface)
            }
            Some(tangent) => {
                let form = |i| shader.form(vector(&normal, i), vector(&tangent, i));
                lit(shader, &points, form, &surface)
            }
        }
    }
    for i in 0..LANES {
        for c in 0..3 {
            pixels[i][c] = if depth[i].is_finite() { color[c][i] } else { R::ZERO };
        }
    }
}

impl<R: Exact> Shader<R> {
    /// [`Shader::pixel`] for surfaces at a block of pixels, in rows of `COLUMNS` pixels; the first
    /// pixel is (x, y).
    #[inline(always)]
    pub(crate) fn block<const COLUMNS: usize>(
        &self,
        (x, y): (u32, u32),
        depth: &Lanes<R>,
        normal: &[Lanes<R>; 3],
        surface: &[Lanes<R>; 3],
    ) -> [Lanes<R>; 3] {
        let mut color = *surface;
        if !self.lights.is_empty() {
            let (x, y, mut points) = (x as usize, y as usize, [[R::ZERO; LANES]; 3]);
            for (i, &t) in depth.iter().enumerate() {
                let point = self.position(x + i % COLUMNS, y + i / COLUMNS, t);
                put_vector(&mut points, i, point);
            }
            let turned = |i| self.view.direction(vector(normal, i));
            let form = |i| Form { normal: turned(i), tangent: Vector3::ZERO };
            color = lit(self, &points, form, surface);
        }
        for channel in &mut color {
            for (value, &t) in channel.iter_mut().zip(depth) {
                *value = if t.is_finite() { *value } else { R::ZERO };
            }
        }
        color
    }

    /// [`Shader::surfel`] for several surfels, with positions and normals in world space.
    #[inline(always)]
    pub(crate) fn surfels(
        &self,
        positions: &[Lanes<R>; 3],
        normals: &[Lanes<R>; 3],
        surface: &[Lanes<R>; 3],
    ) -> [Lanes<R>; 3] {
        if self.lights.is_empty() {
            return *surface;
        }
        let mut points = [[R::ZERO; LANES]; 3];
        for i in 0..LANES {
            put_vector(&mut points, i, self.view.point(vector(positions, i)));
        }
        self.points(&points, normals, surface)
    }

    /// The colours of surfaces at points in view space; the normals are in world space.
    #[inline(always)]
    pub(crate) fn points(
        &self,
        points: &[Lanes<R>; 3],
        normals: &[Lanes<R>; 3],
        surface: &[Lanes<R>; 3],
    ) -> [Lanes<R>; 3] {
        if self.lights.is_empty() {
            return *surface;
        }
        let turned = |i| self.view.direction(vector(normals, i));
        let form = |i| Form { normal: turned(i), tangent: Vector3::ZERO };
        lit(self, points, form, surface)
    }
}

impl<P: Profile> Shader<Ball<Common<P>>> {
    /// [`Shader::surface`] for several pixels, as far as common balls know each colour.
    #[inline(always)]
    pub(crate) fn surfaces(
        &self,
        at: &[(u32, u32); LANES],
        depth: &BallLanes<Common<P>>,
        normal: &[BallLanes<Common<P>>; 3],
        surface: &[BallLanes<Common<P>>; 3],
    ) -> [BallLanes<Common<P>>; 3] {
        if self.lights.is_empty() {
            return *surface;
        }
        let answer = Answer::<Ball<Common<P>>>::new(&self.material);
        let zero = [BallLanes::ZERO; 3];
        let (mut points, mut eyes, mut normals, mut color) = (zero, zero, zero, zero);
        for (i, &(x, y)) in at.iter().enumerate() {
            let p = self.position(x as usize, y as usize, depth.get(i));
            put_balls(&mut points, i, p);
            put_balls(&mut eyes, i, self.towards_eye(p));
            put_balls(&mut normals, i, self.view.direction(balls(normal, i)));
            let own = balls(surface, i);
            put_balls(&mut color, i, own * answer.ambient);
        }
        for (place, light) in &self.lights {
            let (mut cosines, mut gloss) = (BallLanes::ZERO, BallLanes::ZERO);
            for i in 0..LANES {
                let (l, n) = (place.from(balls(&points, i)), balls(&normals, i));
                let cosine = n.dot(l);
                gloss.put(i, mirrored(n, cosine, l, balls(&eyes, i)));
                cosines.put(i, cosine);
            }
            let mut highlights = BallLanes::ZERO;
            for i in 0..LANES {
                highlights.put(i, answer.highlight(cosines.get(i), gloss.get(i)));
            }
            for i in 0..LANES {
                let (before, own) = (balls(&color, i), balls(surface, i));
                let (cosine, faces) = (cosines.get(i), cosines.get(i).gt(Ball::ZERO));
                let before = [before.x, before.y, before.z];
                let own = [own.x, own.y, own.z];
                let after = answer.add(before, *light, cosine, own, highlights.get(i));
                let chosen = |c: usize| Ball::select(faces, after[c], before[c]);
                put_balls(&mut color, i, Vector3::new(chosen(0), chosen(1), chosen(2)));
            }
        }
        color
    }
}

/// The vector of a lane.
#[inline(always)]
fn balls<P: Profile>(lanes: &[BallLanes<P>; 3], i: usize) -> Vector3<Ball<P>> {
    Vector3::new(lanes[0].get(i), lanes[1].get(i), lanes[2].get(i))
}

/// Replaces the vector of a lane.
#[inline(always)]
fn put_balls<P: Profile>(lanes: &mut [BallLanes<P>; 3], i: usize, v: Vector3<Ball<P>>) {
    lanes[0].put(i, v.x);
    lanes[1].put(i, v.y);
    lanes[2].put(i, v.z);
}

/// The colours of these points in view space, under the lights of a scene.
#[inline(always)]
fn lit<R: Exact>(
    shader: &Shader<R>,
    points: &[Lanes<R>; 3],
    form: impl Fn(usize) -> Form<R>,
    surface: &[Lanes<R>; 3],
) -> [Lanes<R>; 3] {
    let answer = Answer::new(&shader.material);
    let (mut eyes, mut color) = ([[R::ZERO; LANES]; 3], [[R::ZERO; LANES]; 3]);
    for i in 0..LANES {
        put_vector(&mut eyes, i, shader.towards_eye(vector(points, i)));
        for c in 0..3 {
            color[c][i] = answer.ambient * surface[c][i];
        }
    }
    for (place, light) in &shader.lights {
        let (mut cosine, mut gloss) = ([R::ZERO; LANES], [R::ZERO; LANES]);
        for i in 0..LANES {
            let l = place.from(vector(points, i));
            let (n, n_l) = form(i).towards(l);
            let r_v = mirrored(n, n_l, l, vector(&eyes, i));
            cosine[i] = n_l;
            gloss[i] = if n_l > R::ZERO && r_v > R::ZERO { r_v } else { R::ZERO };
        }
        let highlight = highlights(&answer, &gloss);
        for i in 0..LANES {
            let (before, own) = (components(&color, i), components(surface, i));
            let after = answer.add(before, *light, cosine[i], own, highlight[i]);
            for c in 0..3 {
                color[c][i] = if cosine[i] > R::ZERO { after[c] } else { before[c] };
            }
        }
    }
    color
}

/// specular (r . v)^shininess where r . v, here `gloss`, is above 0, else 0.
#[inline(always)]
fn highlights<R: Exact>(answer: &Answer<R>, gloss: &Lanes<R>) -> Lanes<R> {
    let mut highlight = [R::ZERO; LANES];
    if !(answer.specular > R::ZERO) || !any(&mask(|i| gloss[i] > R::ZERO)) {
        return highlight;
    }
    // A power of 1 costs nothing.
    let mut base = [R::ONE; LANES];
    for i in 0..LANES {
        base[i] = if gloss[i] > R::ZERO { gloss[i] } else { R::ONE };
    }
    let power = R::powers(&base, answer.shininess);
    for i in 0..LANES {
        highlight[i] = if gloss[i] > R::ZERO { answer.specular * power[i] } else { R::ZERO };
    }
    highlight
}

/// The vectors of the pixels from column `first` on, a multiple of [`LANES`].
#[inline(always)]
fn gather<R: Exact>(plane: Option<&[[R; 3]]>, first: usize) -> Option<[Lanes<R>; 3]> {
    let (groups, _) = plane?.as_chunks();
    Some(transposed(&groups[first / LANES]))
}
