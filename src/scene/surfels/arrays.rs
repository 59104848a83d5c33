//! Surfels under construction, which need no check.

use super::Surfels;
use crate::scene::{Mipmap, Sphere};
use glam::Vec3;

/// Surfels under construction, which need no check.
pub(in crate::scene) struct Arrays {
    pub(in crate::scene) position: Vec<Vec3>,
    pub(in crate::scene) normal: Vec<Vec3>,
    pub(in crate::scene) radius: Vec<f32>,
    pub(in crate::scene) color: Option<Vec<Vec3>>,
    pub(in crate::scene) opacity: Option<Vec<f32>>,
    pub(in crate::scene) tangents: Option<Vec<[Vec3; 2]>>,
    pub(in crate::scene) mipmap: Option<Mipmap>,
}

impl Arrays {
    /// Starts empty: with colours, opacities and half axes or not, and with this many levels of
    /// prefiltered colours, if not 0.
    pub(in crate::scene) fn new([color, opacity, tangents]: [bool; 3], levels: usize) -> Self {
        Self {
            position: Vec::new(),
            normal: Vec::new(),
            radius: Vec::new(),
            color: color.then(Vec::new),
            opacity: opacity.then(Vec::new),
            tangents: tangents.then(Vec::new),
            mipmap: (levels > 0).then(|| Mipmap::empty(levels)),
        }
    }

    /// Reserves room for this many more.
    pub(in crate::scene) fn reserve(&mut self, count: usize) {
        self.position.reserve(count);
        self.normal.reserve(count);
        self.radius.reserve(count);
        self.color.iter_mut().for_each(|color| color.reserve(count));
        self.opacity.iter_mut().for_each(|opacity| opacity.reserve(count));
        self.tangents.iter_mut().for_each(|tangents| tangents.reserve(count));
    }

    /// Appends arrays that have the same attributes.
    pub(in crate::scene) fn append(&mut self, others: Self) {
        self.position.extend(others.position);
        self.normal.extend(others.normal);
        self.radius.extend(others.radius);
        let (color, opacity) = (self.color.iter_mut(), self.opacity.iter_mut());
        color.zip(others.color).for_each(|(to, from)| to.extend(from));
        opacity.zip(others.opacity).for_each(|(to, from)| to.extend(from));
        self.tangents.iter_mut().zip(others.tangents).for_each(|(to, from)| to.extend(from));
        let mipmaps = self.mipmap.iter_mut().zip(others.mipmap);
        mipmaps.for_each(|(to, from)| to.colors_mut().extend(from.colors()));
    }

    /// Finishes the surfels; the median radius and the sphere may belong to a whole of which these
    /// are a part.
    pub(in crate::scene) fn into_surfels(self, median_radius: f32, sphere: Sphere) -> Surfels {
        let Self { position, normal, radius, color, opacity, tangents, mipmap } = self;
        let (groups, bounding_sphere) = (None, sphere);
        Surfels {
            position,
            normal,
            radius,
            color,
            opacity,
            tangents,
            mipmap,
            groups,
            median_radius,
            bounding_sphere,
        }
    }
}
