//! Write 3D Gaussians as the PLY of the original program.

use crate::io::activation::{logarithm, logit};
use crate::scene::Gaussians;
use crate::scene::gaussians::coefficients;
use glam::DVec3;
use std::io::{self, Write};

/// Writes the bytes of a file: binary, little-endian, with the properties in the order of the
/// original program, normals of 0 included, because its viewer expects them.
pub(super) fn write(gaussians: &Gaussians, offset: DVec3, out: &mut dyn Write) -> io::Result<()> {
    let rest = coefficients(gaussians.degree()) - 1;
    write!(out, "ply\nformat binary_little_endian 1.0\n")?;
    if offset != DVec3::ZERO {
        let DVec3 { x, y, z } = offset;
        writeln!(out, "comment splatref offset {x:?} {y:?} {z:?}")?;
    }
    writeln!(out, "element vertex {}", gaussians.len())?;
    let own = "x y z nx ny nz f_dc_0 f_dc_1 f_dc_2".split(' ').map(String::from);
    let more = (0..3 * rest).map(|i| format!("f_rest_{i}"));
    let end = "opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3".split(' ');
    for name in own.chain(more).chain(end.map(String::from)) {
        writeln!(out, "property float {name}")?;
    }
    writeln!(out, "end_header")?;
    for i in 0..gaussians.len() {
        let mut put = |value: f32| out.write_all(&value.to_le_bytes());
        gaussians.position()[i].to_array().into_iter().try_for_each(&mut put)?;
        [0.0; 3].into_iter().try_for_each(&mut put)?;
        let harmonics = gaussians.harmonics(i);
        harmonics[0].to_array().into_iter().try_for_each(&mut put)?;
        let channels = (0..3).flat_map(|channel| harmonics[1..].iter().map(move |c| c[channel]));
        channels.into_iter().try_for_each(&mut put)?;
        put(logit(gaussians.opacity()[i]))?;
        gaussians.scale()[i].to_array().into_iter().map(logarithm).try_for_each(&mut put)?;
        let [x, y, z, w] = gaussians.rotation()[i];
        [w, x, y, z].into_iter().try_for_each(&mut put)?;
    }
    Ok(())
}
