//! Opacity and further properties of the vertices of a mesh.

use crate::error::{Error, Result};
use crate::scene::{Cloud, Property};

/// What the vertices of a mesh have beside normals and colours.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Properties {
    opacity: Option<Vec<f32>>,
    further: Vec<Property>,
}

impl Properties {
    /// Takes them from a cloud, of which points and triangles that can have no candidates are dropped; its points are
    /// finite then, if there are any properties.
    pub(super) fn take(cloud: &mut Cloud) -> Result<Self> {
        if cloud.opacity.is_none() && cloud.properties.is_empty() {
            return Ok(Self::default());
        }
        let before = cloud.triangles.len();
        let sound = |i: usize| {
            let opacity = cloud.opacity.as_ref().is_none_or(|all| (0.0..=1.0).contains(&all[i]));
            opacity && cloud.properties.iter().all(|one| one.values[i].is_finite())
        };
        let keep: Vec<bool> = (0..cloud.position.len()).map(sound).collect();
        cloud.retain(&keep);
        if cloud.triangles.is_empty() && before > 0 {
            let what = format!(
                "none of its {before} triangles has corners with an opacity in [0, 1] and finite properties"
            );
            return Err(Error::Invalid(format!("the scene is empty: {what}")));
        }
        let finite: Vec<bool> = cloud.position.iter().map(|place| place.is_finite()).collect();
        if finite.contains(&true) {
            cloud.retain(&finite);
        }
        Ok(Self { opacity: cloud.opacity.take(), further: std::mem::take(&mut cloud.properties) })
    }

    /// How many numbers a candidate has of them.
    pub(super) fn count(&self) -> u64 {
        u64::from(self.opacity.is_some()) + self.further.len() as u64
    }

    /// A cloud without points that has the same arrays.
    pub(super) fn of_none(&self) -> Cloud {
        let empty = |one: &Property| Property { name: one.name.clone(), values: Vec::new() };
        Cloud {
            opacity: self.opacity.as_ref().map(|_| Vec::new()),
            properties: self.further.iter().map(empty).collect(),
            ..Cloud::default()
        }
    }

    /// The numbers where corners have these weights, in place of what is in `to`: opacity first, if there is one.
    pub(super) fn at(&self, corners: [u32; 3], weights: [f32; 3], to: &mut Vec<f32>) {
        let [a, b, c] = corners.map(|corner| corner as usize);
        let mixed =
            |of: &[f32]| ((weights[0] * of[a] + weights[1] * of[b]) + weights[2] * of[c]) + 0.0;
        to.clear();
        to.extend(self.opacity.iter().map(|all| {
            let opacity = mixed(all);
            if opacity > 1.0 { 1.0 } else { opacity }
        }));
        to.extend(self.further.iter().map(|one| mixed(&one.values)));
    }
}

/// Appends what [`Properties::at`] found to the arrays of [`Properties::of_none`].
pub(super) fn push(cloud: &mut Cloud, numbers: &[f32]) {
    let opacity = cloud.opacity.iter_mut();
    let all = opacity.chain(cloud.properties.iter_mut().map(|one| &mut one.values));
    all.zip(numbers).for_each(|(to, number)| to.push(*number));
}

#[cfg(test)]
mod tests;
