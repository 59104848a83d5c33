//! Mix Gaussian splats with opaque geometry that another pass drew from the same camera: a depth and a
//! colour at each pixel.

use super::light::MAX_RADIANCE;
use crate::error::{Error, Result};
use crate::frame::Plane;

/// The opaque geometry of one view.
///
/// The surface belongs to one camera, because its planes have the pixels of that camera's picture.
///
/// ```
/// use splatref::frame::Plane;
/// use splatref::scene::Surface;
///
/// let depth = Plane::from_values(2, 1, vec![3.5, f32::INFINITY]);
/// let surface = Surface::new(depth, Plane::filled(2, 1, [0.5, 0.25, 0.0]))?;
/// assert_eq!(surface.at(0, 0), Some((3.5, [0.5, 0.25, 0.0])));
/// assert_eq!(surface.at(1, 0), None);
/// # Ok::<(), splatref::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    depth: Plane<f32>,
    color: Plane<[f32; 3]>,
}

impl Surface {
    /// Makes a surface from depths t in world units, and linear RGB. A depth of +inf says that a pixel
    /// shows nothing opaque; its colour is ignored.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the planes differ in size, if a depth is not in [0, +inf], or if the colour
    /// beside a finite depth is not in [0, [`MAX_RADIANCE`]]; the error names the pixel.
    pub fn new(mut depth: Plane<f32>, mut color: Plane<[f32; 3]>) -> Result<Self> {
        let size = |width, height| format!("{width} x {height}");
        if (depth.width(), depth.height()) != (color.width(), color.height()) {
            return Err(Error::Invalid(format!(
                "surface: {} depths and {} colours; give planes of one size",
                size(depth.width(), depth.height()),
                size(color.width(), color.height())
            )));
        }
        let width = depth.width() as usize;
        let pixels = depth.values_mut().iter_mut().zip(color.values_mut());
        for (i, (depth, color)) in pixels.enumerate() {
            let at = || format!("surface: pixel ({}, {})", i % width, i / width);
            // NaN fails this comparison.
            if !(*depth >= 0.0) {
                let what = format!(
                    "{} has the depth {depth}; give linear depths from 0, +inf where nothing is",
                    at()
                );
                return Err(Error::Invalid(what));
            }
            if *depth == f32::INFINITY {
                *color = [0.0; 3];
            } else if !color.iter().all(|part| (0.0..=MAX_RADIANCE).contains(part)) {
                let what =
                    format!("{} is {color:?}; clamp the colours to [0, {MAX_RADIANCE}]", at());
                return Err(Error::Invalid(what));
            }
            // Adding 0 turns -0 into 0.
            *depth += 0.0;
            color.iter_mut().for_each(|part| *part += 0.0);
        }
        Ok(Self { depth, color })
    }

    /// Width and height in pixels.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        [self.depth.width(), self.depth.height()]
    }

    /// The depths, +inf where nothing opaque is.
    #[must_use]
    pub fn depths(&self) -> &Plane<f32> {
        &self.depth
    }

    /// The colours, 0 where nothing opaque is.
    #[must_use]
    pub fn colors(&self) -> &Plane<[f32; 3]> {
        &self.color
    }

    /// Depth and colour at a column and row; none where nothing opaque is.
    ///
    /// # Panics
    /// If the pixel lies outside.
    #[inline]
    #[must_use]
    pub fn at(&self, x: u32, y: u32) -> Option<(f32, [f32; 3])> {
        let depth = *self.depth.at(x, y);
        (depth < f32::INFINITY).then(|| (depth, *self.color.at(x, y)))
    }

    /// Checks that the surface has this size of a picture.
    pub(crate) fn check_size(&self, [width, height]: [u32; 2]) -> Result<()> {
        let [own_width, own_height] = self.size();
        if self.size() == [width, height] {
            return Ok(());
        }
        Err(Error::Invalid(format!(
            "the surface has {own_width} x {own_height} pixels, but the camera's picture has {width} x \
             {height}; draw both with one camera"
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(depth: f32, color: [f32; 3]) -> String {
        let depths = Plane::from_values(1, 2, vec![1.0, depth]);
        let colors = Plane::from_values(1, 2, vec![[0.0; 3], color]);
        Surface::new(depths, colors).unwrap_err().to_string()
    }

    #[test]
    fn what_is_no_surface_is_refused_by_its_pixel() {
        for depth in [f32::NAN, -1.0, f32::NEG_INFINITY] {
            let line = refused(depth, [0.5; 3]);
            assert!(line.contains("pixel (0, 1) has the depth") && line.contains("+inf"), "{line}");
        }
        for part in [f32::NAN, -0.5, f32::INFINITY] {
            let line = refused(2.0, [0.5, part, 0.5]);
            assert!(line.contains("pixel (0, 1) is [0.5, ") && line.contains("clamp"), "{line}");
        }
        let line = Surface::new(Plane::filled(2, 1, 1.0), Plane::filled(1, 2, [0.0; 3]));
        assert!(line.unwrap_err().to_string().contains("2 x 1 depths and 1 x 2 colours"));
    }

    #[test]
    fn a_colour_beside_an_infinite_depth_is_ignored_and_no_zero_is_negative() {
        let depths = Plane::from_values(2, 1, vec![f32::INFINITY, -0.0]);
        let colors = Plane::from_values(2, 1, vec![[f32::NAN; 3], [-0.0, 1.0, 2.0]]);
        let surface = Surface::new(depths, colors).unwrap();
        assert_eq!((surface.at(0, 0), surface.colors().at(0, 0)), (None, &[0.0; 3]));
        let bits =
            surface.at(1, 0).map(|(depth, color)| (depth.to_bits(), color.map(f32::to_bits)));
        assert_eq!(bits, Some((0, [0.0_f32, 1.0, 2.0].map(f32::to_bits))));
    }
}
