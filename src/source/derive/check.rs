//! Check that the arrays of a cloud fit together.

use crate::error::{Error, Result};
use crate::scene::surfels::check_mipmap;
use crate::scene::{Cloud, Coordinates};

impl Cloud {
    /// Checks the promises of [`Cloud`]: one length for all arrays, prefiltered colours only beside
    /// colours, triangles and edges of existing points, and fewer than 2^32 - 1 points.
    ///
    /// # Errors
    /// [`Error::Invalid`] with the name of the array.
    pub fn check(&self) -> Result<()> {
        let n = self.position.len();
        if n as u64 >= u64::from(u32::MAX) {
            let what = format!("{n} points, but ids have 32 bits: split the scene");
            return Err(Error::Invalid(what));
        }
        let [of_points, of_triangles] =
            self.coordinates.as_ref().map_or([None; 2], Coordinates::lengths);
        let lengths = [
            ("normals", self.normal.as_ref().map(Vec::len)),
            ("radii", self.radius.as_ref().map(Vec::len)),
            ("colours", self.color.as_ref().map(Vec::len)),
            ("opacities", self.opacity.as_ref().map(Vec::len)),
            ("half axes", self.tangents.as_ref().map(Vec::len)),
            ("tangents", self.tangent.as_ref().map(Vec::len)),
            ("texture coordinates", of_points),
            ("groups", self.groups.as_ref().map(|g| g.own().len())),
        ];
        for (what, length) in lengths {
            if let Some(length) = length.filter(|&length| length != n) {
                return Err(Error::Invalid(format!("{n} positions, but {length} {what}")));
            }
        }
        if let Some(one) = self.properties.iter().find(|one| one.values.len() != n) {
            let what = format!("{n} positions, but {} of {}", one.values.len(), one.name);
            return Err(Error::Invalid(what));
        }
        let triangles = self.triangles.len();
        if let Some(length) = of_triangles.filter(|&length| length != triangles) {
            let what = format!("{triangles} triangles, but texture coordinates for {length}");
            return Err(Error::Invalid(what));
        }
        let colors = self.triangle_color.as_ref().map(Vec::len);
        if let Some(length) = colors.filter(|&length| length != triangles) {
            let what = format!("{triangles} triangles, but colours for {length}");
            return Err(Error::Invalid(what));
        }
        check_mipmap(n, self.color.is_some(), &self.mipmap)?;
        let outside = |triangle: &[u32; 3]| triangle.iter().any(|&i| i as usize >= n);
        if let Some(at) = self.triangles.iter().position(outside) {
            let what = format!("triangle {at} has a corner that is not one of the {n} points");
            return Err(Error::Invalid(what));
        }
        let outside = |edge: &[u32; 2]| edge.iter().any(|&i| i as usize >= n);
        if let Some(at) = self.edges.iter().position(outside) {
            let what = format!("edge {at} has an end that is not one of the {n} points");
            return Err(Error::Invalid(what));
        }
        Ok(())
    }
}
