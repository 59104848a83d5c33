//! Deferred shading by other means: the picture from what reconstruction left of every pixel.

use crate::oracle::kit::eye::wide;
use crate::oracle::kit::number::{N3, Num, dot, exact, negated, normalized, ways};
use crate::oracle::kit::projection::Sight;
use splatref::scene::{Light, Scene};

/// What light falls on, as the crate left it but for the colour: vectors in world space.
pub(crate) struct Surface<const P: u32> {
    pub(crate) depth: f64,
    pub(crate) normal: [f64; 3],
    pub(crate) tangent: [f64; 3],
    pub(crate) color: N3<P>,
}

/// The colours that a pixel may have: whether a light is above the surface may be open.
pub(crate) fn shaded<const P: u32>(
    scene: &Scene,
    sight: &Sight<P>,
    (x, y): (u32, u32),
    surface: &Surface<P>,
) -> Vec<N3<P>> {
    let color = surface.color;
    if scene.lights.is_empty() {
        return vec![color];
    }
    let number = |v: f32| Num::exact(f64::from(v));
    let t = Num::exact(surface.depth);
    let across = (Num::exact(f64::from(x) + 0.5) - sight.cx) / sight.fx;
    let down = (Num::exact(f64::from(y) + 0.5) - sight.cy) / sight.fy;
    let p = if sight.perspective { [across * t, -down * t, -t] } else { [across, -down, -t] };
    let v = if sight.perspective { normalized(negated(p)) } else { exact([0.0, 0.0, 1.0]) };
    let phong = &scene.material;
    let mut all = vec![color.map(|s| number(phong.ambient) * s)];
    for light in &scene.lights {
        let (l, light_color) = match *light {
            Light::Directional { towards, color } => (sight.direction(exact(wide(towards))), color),
            Light::Headlight { towards, color } => (exact(wide(towards)), color),
            Light::Point { position, color } => {
                let at = sight.point(position);
                ([0, 1, 2].map(|i| at[i] - p[i]), color)
            }
        };
        let l = normalized(l);
        let tangent = normalized(sight.direction(exact(surface.tangent)));
        let is_tube = tangent.iter().any(|t| t.v != 0.0);
        let (n, incident) = if is_tube {
            // The length of what is left of l is the sine of its angle to the tangent.
            let along = dot(l, tangent);
            let across: N3<P> = [0, 1, 2].map(|i| l[i] - tangent[i] * along);
            (normalized(across), dot(across, across).sqrt())
        } else {
            let n = sight.direction(exact(surface.normal));
            (n, dot(n, l))
        };
        let r: N3<P> = [0, 1, 2].map(|i| n[i] * (Num::exact(2.0) * incident) - l[i]);
        let gloss = dot(r, v);
        let mut more = Vec::new();
        for [lit, glossy] in ways([Num::ZERO.less(incident), Num::ZERO.less(gloss)]) {
            let highlight =
                if glossy { gloss.at_least(0.0).pow(phong.shininess.into()) } else { Num::ZERO };
            let own: N3<P> = [0, 1, 2].map(|i| {
                let body = number(phong.diffuse) * incident * color[i];
                number(light_color[i]) * (body + number(phong.specular) * highlight)
            });
            let sum = |c: &N3<P>| [0, 1, 2].map(|i| if lit { c[i] + own[i] } else { c[i] });
            more.extend(all.iter().map(sum));
        }
        all = more;
    }
    all
}
