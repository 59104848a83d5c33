//! Recognize files of 3D Gaussians, so that the reader can refuse them by name.

use super::header::PlyHeader;
use super::vertex;

/// Refuses vertices that are 3D Gaussians, whether they are stored plainly or packed.
///
/// Their opacities are logits, their scales are logarithms and their colours are coefficients of
/// spherical harmonics, so that a picture of them as points would be silently wrong.
pub(super) fn check(header: &PlyHeader) -> Result<(), String> {
    let properties = &vertex(header)?.properties;
    let has = |names: &[&str]| properties.iter().any(|p| names.contains(&p.name.as_str()));
    let shaped = has(&["scale_0", "scaling_0"]) && has(&["rot_0", "rotation_0"]);
    let what = if has(&["packed_position", "packed_rotation", "packed_scale"]) {
        "compressed 3D Gaussians, as SuperSplat and PlayCanvas write them"
    } else if shaped || has(&["f_dc_0", "f_rest_0"]) {
        "3D Gaussians: opacities are logits, scales are logarithms"
    } else {
        return Ok(());
    };
    Err(format!(
        "this PLY holds {what}; splatref does not draw Gaussian splats yet; give a point cloud or \
         a mesh"
    ))
}
