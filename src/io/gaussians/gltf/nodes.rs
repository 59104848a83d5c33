//! Find the meshes that a glTF scene draws, and their places.

use super::buffers::missing;
use super::json::{Document, Node};
use super::stretch::stretch;
use crate::io::Reason;
use crate::scene::{GaussianArrays, Similarity};
use crate::shade::harmonics::rotation::place;
use glam::{DMat3, DMat4, DQuat, DVec3, Vec3};

/// The meshes of the scene with their matrices: parents before children, in the order of the file.
pub(super) fn meshes(document: &Document) -> Reason<Vec<(usize, usize, DMat4)>> {
    let mut found = Vec::new();
    let mut seen = vec![false; document.nodes.len()];
    let mut stack: Vec<(usize, DMat4)> =
        roots(document)?.into_iter().rev().map(|root| (root, DMat4::IDENTITY)).collect();
    while let Some((index, parent)) = stack.pop() {
        let node = document.nodes.get(index).ok_or_else(|| missing("node", index))?;
        if std::mem::replace(&mut seen[index], true) {
            return Err(format!("node {index} has two parents, but the nodes of glTF are trees"));
        }
        let matrix = parent * matrix(node, index)?;
        found.extend(node.mesh.map(|mesh| (index, mesh, matrix)));
        stack.extend(node.children.iter().rev().map(|&child| (child, matrix)));
    }
    Ok(found)
}

/// The nodes without parents: of the scene to show, of the first scene, or of a file without scenes.
fn roots(document: &Document) -> Reason<Vec<usize>> {
    let chosen = document.scene.unwrap_or(0);
    match document.scenes.get(chosen) {
        Some(scene) => Ok(scene.nodes.clone()),
        None if document.scene.is_some() => Err(missing("scene", chosen)),
        None => {
            let is_child =
                |node: &usize| document.nodes.iter().any(|other| other.children.contains(node));
            Ok((0..document.nodes.len()).filter(|node| !is_child(node)).collect())
        }
    }
}

/// The matrix of a node.
fn matrix(node: &Node, index: usize) -> Reason<DMat4> {
    let parts = node.translation.is_some() || node.rotation.is_some() || node.scale.is_some();
    let matrix = match &node.matrix {
        Some(_) if parts => {
            return Err(format!(
                "node {index} has a matrix beside translation, rotation or scale; keep one"
            ));
        }
        Some(matrix) => DMat4::from_cols_array(matrix),
        None => {
            let quaternion = DQuat::from_array(node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]));
            DMat4::from_scale_rotation_translation(
                DVec3::from_array(node.scale.unwrap_or([1.0; 3])),
                quaternion.normalize(),
                DVec3::from_array(node.translation.unwrap_or_default()),
            )
        }
    };
    match matrix.is_finite() {
        true => Ok(matrix),
        false => Err(format!("node {index}: its transform is not finite")),
    }
}

/// Where a node puts its Gaussians.
pub(super) struct Place {
    /// Turns, moves and scales them. It does not scale if `stretch` does.
    pub(super) similarity: Similarity,
    /// The 3 x 3 matrix of a node that scales by different factors along its axes.
    pub(super) stretch: Option<DMat3>,
}

impl Place {
    /// The place that a matrix is.
    pub(super) fn new(node: usize, matrix: &DMat4) -> Reason<Self> {
        if *matrix == DMat4::IDENTITY {
            return Ok(Self { similarity: Similarity::IDENTITY, stretch: None });
        }
        let columns = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|column| column.truncate());
        let lengths = columns.map(DVec3::length);
        let [x, y, z] = [0, 1, 2].map(|i| columns[i] / lengths[i]);
        let rotation = DMat3::from_cols(x, y, z);
        let equal = lengths.iter().all(|length| (length / lengths[0] - 1.0).abs() <= 1e-6);
        let scale = if equal { lengths[0] } else { 1.0 };
        let similarity = Similarity { rotation, scale, translation: matrix.w_axis.truncate() };
        let stretch = (!equal).then(|| DMat3::from_mat4(*matrix));
        similarity.check().map(|()| Self { similarity, stretch }).map_err(|_| {
            format!(
                "node {node}: its transform is no rotation and positive scales, so the colours of \
                 Gaussians are not defined; apply it before the export"
            )
        })
    }

    /// Where a point goes.
    pub(super) fn point(&self, p: Vec3) -> DVec3 {
        let Similarity { rotation, scale, translation } = self.similarity;
        match &self.stretch {
            _ if self.is_nowhere() => p.as_dvec3(),
            Some(matrix) => *matrix * p.as_dvec3() + translation,
            None => rotation * (p.as_dvec3() * scale) + translation,
        }
    }

    /// Whether everything stays where it is.
    pub(super) fn is_nowhere(&self) -> bool {
        self.similarity == Similarity::IDENTITY && self.stretch.is_none()
    }

    /// Puts Gaussians there, except for their positions.
    pub(super) fn apply(&self, arrays: &mut GaussianArrays) {
        let Some(matrix) = self.stretch else { return place(arrays, &self.similarity) };
        let before = (arrays.scale.clone(), arrays.rotation.clone());
        // The coefficients are turned by the rotation of the node.
        place(arrays, &self.similarity);
        for (i, (scale, rotation)) in before.0.into_iter().zip(before.1).enumerate() {
            (arrays.scale[i], arrays.rotation[i]) = stretch(matrix, scale, rotation);
        }
    }
}
