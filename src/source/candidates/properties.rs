//! Interpolate opacity and further properties of the vertices of a mesh.

use crate::number::MapInline;
use crate::scene::{Cloud, Property, Scene};

/// The numbers that vertices of a mesh have beside normals and colours.
pub(super) struct Properties<'a> {
    opacity: Option<&'a [f32]>,
    further: &'a [Property],
}

impl<'a> Properties<'a> {
    /// The numbers of the triangles of a scene.
    pub(super) fn from_scene(scene: &'a Scene) -> Self {
        let vertices = scene.primitives.triangles.vertices();
        Self { opacity: vertices.opacity.as_deref(), further: &vertices.properties }
    }

    /// How many of these numbers a candidate has.
    pub(super) fn count(&self) -> u64 {
        u64::from(self.opacity.is_some()) + self.further.len() as u64
    }

    /// A cloud without points that has the same arrays.
    pub(super) fn of_none(&self) -> Cloud {
        let empty = |one: &Property| Property { name: one.name.clone(), values: Vec::new() };
        Cloud {
            opacity: self.opacity.map(|_| Vec::new()),
            properties: self.further.iter().map(empty).collect(),
            ..Cloud::default()
        }
    }

    /// Interpolates the numbers with these weights of the corners, and replaces the contents of
    /// `to`: opacity first, if there is one.
    pub(super) fn at(&self, corners: [u32; 3], weights: [f32; 3], to: &mut Vec<f32>) {
        let [a, b, c] = corners.map_inline(|corner| corner as usize);
        let mixed =
            |of: &[f32]| ((weights[0] * of[a] + weights[1] * of[b]) + weights[2] * of[c]) + 0.0;
        to.clear();
        to.extend(self.opacity.map(|all| {
            let opacity = mixed(all);
            if opacity > 1.0 { 1.0 } else { opacity }
        }));
        to.extend(self.further.iter().map(|one| mixed(&one.values)));
    }
}

/// Appends the results of [`Properties::at`] to the arrays of [`Properties::of_none`].
pub(super) fn push(cloud: &mut Cloud, numbers: &[f32]) {
    let opacity = cloud.opacity.iter_mut();
    let all = opacity.chain(cloud.properties.iter_mut().map(|one| &mut one.values));
    all.zip(numbers).for_each(|(to, number)| to.push(*number));
}

#[cfg(test)]
mod tests;
