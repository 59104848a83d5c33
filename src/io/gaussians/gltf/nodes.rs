//! Find the meshes that a glTF scene draws, and their places.

use super::buffers::missing;
use super::json::{Document, Node};
use crate::io::Reason;
use crate::scene::Similarity;
use glam::{DMat3, DMat4, DQuat, DVec3};

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

/// The similarity that a matrix is.
pub(super) fn similarity(node: usize, matrix: &DMat4) -> Reason<Similarity> {
    if *matrix == DMat4::IDENTITY {
        return Ok(Similarity::IDENTITY);
    }
    let columns = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|column| column.truncate());
    let scale = columns[0].length();
    let [x, y, z] = columns.map(|column| column / scale);
    let translation = matrix.w_axis.truncate();
    let found = Similarity { rotation: DMat3::from_cols(x, y, z), scale, translation };
    found.check().map(|()| found).map_err(|_| {
        format!(
            "node {node}: its transform is no rotation with one positive scale for all axes, so it \
             does not turn Gaussians into Gaussians of known colours; apply it before the export"
        )
    })
}
