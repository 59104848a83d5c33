//! Perspective and orthographic cameras.
//!
//! ```text
//!   view space: right-handed, +x right, +y up, the camera looks down -z
//!   depth       t = -z_view > 0, linear, world units
//!   pixel       (0, 0) is top left, its centre at (0.5, 0.5); x right, y down
//!
//!   perspective   X = cx + fx x/t      the ray of (X, Y): ((X - cx)/fx, -(Y - cy)/fy, -1) t
//!                 Y = cy - fy y/t
//!   orthographic  X = cx + fx x        fx, fy in pixels per world unit
//!                 Y = cy - fy y
//! ```
//!
//! # Arithmetic
//!
//! A camera is computed in f64, each operation rounded, in the order of the formulas of
//! [`Camera::new`], [`Camera::framing`] and [`Camera::eye`]. No operation is fused. For vectors in
//! f64
//!
//! ```text
//!   |a|    = sqrt((a.x a.x + a.y a.y) + a.z a.z)
//!   a x b  = (a.y b.z - b.y a.z, a.z b.x - b.z a.x, a.x b.y - b.x a.y)
//!   unit a = a (1 / |a|)                            each component times one quotient
//! ```
//!
//! and the quotient or product of a vector and a number is computed component by component. The
//! fields of [`Camera`] are rounded to `f32` at the end, once.
//!
//! # Cameras of other programs
//!
//! - [`convention`]: poses as matrices, in the conventions of `OpenCV`, OpenGL and Blender.
//! - [`intrinsics`]: focal lengths and principal points in pixels.
//! - [`clip`]: projection matrices of OpenGL, Vulkan and Direct3D.
//! - [`motion`], [`turntable`]: cameras that move over the frames of a sequence.
//! - [`stereo`]: the cameras of two eyes.

pub mod clip;
pub mod convention;
pub mod intrinsics;
pub mod motion;
pub mod stereo;
pub mod turntable;

use crate::error::{Error, Result};
use crate::frame::Rect;
use crate::scene::Sphere;
pub use convention::{Convention, PoseMatrix};
use glam::{DMat3, DMat4, DVec3, Mat4};
pub use intrinsics::Intrinsics;
pub use motion::CameraMotion;
pub use stereo::Stereo;
pub use turntable::Turntable;

/// How depth affects the size of what is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Projection {
    /// Through a centre: `fx` and `fy` are focal lengths in pixels.
    Perspective,
    /// Parallel: `fx` and `fy` are pixels per world unit.
    Orthographic,
}

/// The opening of a camera, in the terms in which people give it.
///
/// The lens gives the scale, [`Camera::fx`] and [`Camera::fy`] alike, for a picture of `height`
/// pixels; computed in f64 and rounded to `f32` once:
///
/// ```text
///   FieldOfView(d)    (height / 2) / tan((d (PI / 180)) / 2)
///   Focal(p)          p
///   Orthographic(u)   height / u
/// ```
///
/// PI / 180 is the quotient in f64. The tangent is [`crate::number::elementary::tan`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lens {
    /// Vertical field of view in degrees, in (0, 180).
    FieldOfView(f64),
    /// Focal length in pixels, > 0.
    Focal(f64),
    /// Orthographic: the height of the picture in world units, > 0.
    Orthographic(f64),
}

/// Where a camera stands, and where it looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The centre of projection, in world units.
    pub eye: DVec3,
    /// The point seen in the middle of the picture.
    pub target: DVec3,
    /// The direction that is up in the picture.
    pub up: DVec3,
}

impl Pose {
    /// The same pose in coordinates that begin at `origin`.
    #[must_use]
    pub fn relative_to(self, origin: DVec3) -> Self {
        Self { eye: self.eye - origin, target: self.target - origin, ..self }
    }
}

/// A camera. Its numbers are `f32`, so that every number type gets the same problem.
///
/// ```
/// use glam::DVec3;
/// use splatref::scene::{Camera, Lens, Pose};
///
/// let pose = Pose { eye: DVec3::new(0.0, 0.0, 4.0), target: DVec3::ZERO, up: DVec3::Y };
/// let camera = Camera::new(640, 480, pose, Lens::FieldOfView(40.0))?;
/// assert_eq!((camera.cx, camera.cy), (320.0, 240.0), "the target is in the middle");
/// assert_eq!(camera.eye(), pose.eye);
/// # Ok::<(), splatref::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Width of the picture in pixels.
    pub width: u32,
    /// Height of the picture in pixels.
    pub height: u32,
    /// Rigid transform from world to view space, computed in f64 and rounded once.
    pub view_from_world: Mat4,
    /// Perspective or orthographic.
    pub projection: Projection,
    /// Horizontal scale, see [`Projection`].
    pub fx: f32,
    /// Vertical scale, see [`Projection`].
    pub fy: f32,
    /// Column of the principal point in pixels.
    pub cx: f32,
    /// Row of the principal point in pixels.
    pub cy: f32,
    /// Depth of the near plane: anything not farther than this is not seen. > 0 for perspective
    /// cameras.
    pub near: f32,
    /// The other eye of a [stereo pair](stereo), if the camera is an eye of one: the last element of the
    /// first row of its view matrix. Its other numbers are the same.
    pub other_eye: Option<f32>,
}

/// The largest width or height of a picture.
pub const MAX_EXTENT: u32 = 65_536;
/// The largest number of pixels of a picture: 2^28, a square of 16,384.
pub const MAX_PIXELS: u64 = 1 << 28;
/// How far a coordinate of the eye may be from 0, and the eye from the target; there is a limit
/// because matrices are `f32`.
pub const MAX_DISTANCE: f64 = 1e38;

impl Camera {
    /// Places a camera at `pose`, with the principal point in the middle of the picture.
    ///
    /// The near plane is at 1/1024 of the distance from eye to target. In f64, in the terms of the
    /// [module](self#arithmetic):
    ///
    /// ```text
    ///   distance = |target - eye|
    ///   b = (eye - target) / distance                      towards the viewer: +z of view space
    ///   u = up, or up / m unless 1e-100 <= m <= 1e100       m = the largest |component| of up
    ///   r = unit (u x b)                                   right: +x
    ///   v = b x r                                          up: +y
    ///   near = distance / 1024      cx = width / 2      cy = height / 2      fx, fy: see Lens
    /// ```
    ///
    /// The view matrix has one row for each of r, v and b, and the row (0, 0, 0, 1). The row of a
    /// is
    ///
    /// ```text
    ///   a.x + 0    a.y + 0    a.z + 0    ((a.x (-eye.x) + a.y (-eye.y)) + a.z (-eye.z)) + 0
    /// ```
    ///
    /// (+ 0 turns a -0 into +0, and changes nothing else).
    ///
    /// # Errors
    /// [`Error::Invalid`] in any of these cases:
    ///
    /// - The picture has no pixels, more than [`MAX_EXTENT`] a side or more than [`MAX_PIXELS`] in
    ///   all.
    /// - The lens is out of range.
    /// - Eye and target coincide, or are farther away than [`MAX_DISTANCE`].
    /// - up is 0 or almost parallel to the view, not |u x b| > 1e-6 |u|.
    /// - Anything is not finite.
    pub fn new(width: u32, height: u32, pose: Pose, lens: Lens) -> Result<Self> {
        Self::check_size(width, height)?;
        let (projection, scale) = scale(height, lens)?;
        let (axes, distance) = axes(pose)?;
        let view = DMat4::from_mat3(axes.transpose()) * DMat4::from_translation(-pose.eye);
        let camera = Self {
            width,
            height,
            view_from_world: view.as_mat4(),
            projection,
            fx: scale,
            fy: scale,
            cx: (f64::from(width) / 2.0) as f32,
            cy: (f64::from(height) / 2.0) as f32,
            near: (distance / 1024.0) as f32,
            other_eye: None,
        };
        camera.check()?;
        Ok(camera)
    }

    /// Places a camera so that it sees a sphere around the scene, from the direction `from`, +y up.
    ///
    /// The sphere touches the nearer pair of picture edges, with a margin of 5 %. For a perspective
    /// camera `lens` must be [`Lens::FieldOfView`] or [`Lens::Focal`]; the height of
    /// [`Lens::Orthographic`] is kept. In f64, in the terms of the [module](self#arithmetic), with
    /// the scale of the lens as rounded to `f32`:
    ///
    /// ```text
    ///   R = radius 1.05 if radius > 0, else 1
    ///   g = (the lesser of width and height / 2) / scale        tangent of half the opening
    ///   distance = (R sqrt(1 + g g)) / g                        orthographic: 2 R
    ///   eye = center + (unit from) distance
    ///   up = -z if from.x and from.z are 0, else +y             -z is (-0, -0, -1)
    /// ```
    ///
    /// Then [`Camera::new`] with this eye and the target `center`.
    ///
    /// # Errors
    /// As [`Camera::new`].
    pub fn framing(
        width: u32,
        height: u32,
        Sphere { center, radius }: Sphere,
        from: DVec3,
        lens: Lens,
    ) -> Result<Self> {
        Self::check_size(width, height)?;
        let (projection, scale) = scale(height, lens)?;
        let half_extent = f64::from(if width < height { width } else { height }) / 2.0;
        // A single point has no extent, so any distance frames it.
        let radius = if radius > 0.0 { radius * 1.05 } else { 1.0 };
        let distance = match projection {
            // The sine of half the opening angle of the cone that fits between the nearer edges.
            Projection::Perspective => {
                let tangent = half_extent / f64::from(scale);
                radius * (1.0 + tangent * tangent).sqrt() / tangent
            }
            Projection::Orthographic => 2.0 * radius,
        };
        let up = if from.x == 0.0 && from.z == 0.0 { -DVec3::Z } else { DVec3::Y };
        let eye = center + from.normalize() * distance;
        Self::new(width, height, Pose { eye, target: center, up }, lens)
    }

    /// Checks that a picture may have this size.
    ///
    /// # Errors
    /// [`Error::Invalid`] as [`Camera::new`].
    pub fn check_size(width: u32, height: u32) -> Result<()> {
        let pixels = u64::from(width) * u64::from(height);
        if pixels == 0 || width > MAX_EXTENT || height > MAX_EXTENT || pixels > MAX_PIXELS {
            return Err(Error::Invalid(format!(
                "camera: a picture of {width} x {height} pixels; give 1 to {MAX_EXTENT} a side and at \
                 most {MAX_PIXELS} in all"
            )));
        }
        Ok(())
    }

    /// Checks that a pixel is in the picture.
    ///
    /// # Errors
    /// [`Error::Usage`] if it is not.
    pub fn check_pixel(&self, x: u32, y: u32) -> Result<()> {
        let (w, h) = (self.width, self.height);
        if x < w && y < h {
            Ok(())
        } else {
            Err(Error::Usage(format!("pixel {x} {y} is outside the picture of {w} x {h}")))
        }
    }

    /// Checks that a region has pixels, all of them in the picture.
    ///
    /// # Errors
    /// As [`Rect::check_inside`].
    pub fn check_region(&self, region: &Rect) -> Result<()> {
        region.check_inside(self.size())
    }

    /// Checks that these numbers can make a picture; for cameras whose fields were filled in by
    /// hand.
    ///
    /// # Errors
    /// [`Error::Invalid`] as [`Camera::new`].
    pub fn check(&self) -> Result<()> {
        Self::check_size(self.width, self.height)?;
        let numbers = [self.fx, self.fy, self.cx, self.cy, self.near];
        let numbers = numbers.into_iter().chain(self.other_eye);
        let finite = self.view_from_world.is_finite() && numbers.into_iter().all(f32::is_finite);
        let near_ok = match self.projection {
            Projection::Perspective => self.near > 0.0,
            Projection::Orthographic => true,
        };
        if !(finite && self.fx > 0.0 && self.fy > 0.0 && near_ok) {
            return Err(Error::Invalid(
                "camera: focal length, height and near plane must be finite and > 0".into(),
            ));
        }
        Ok(())
    }

    /// Width and height of the picture in pixels.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// The position of the camera in world space, in f64: the last column of the inverse of the
    /// view matrix. The last row of the view matrix is (0, 0, 0, 1).
    ///
    /// V(i,j) is the element of row i and column j, counted from 0, converted from `f32`:
    ///
    /// ```text
    ///   a = V12 V23 - V13 V22      b = V02 V23 - V03 V22      c = V02 V13 - V03 V12
    ///   d = V11 V23 - V13 V21      e = V01 V23 - V03 V21      f = V01 V13 - V03 V11
    ///   x = -((V01 a - V11 b) + V21 c)
    ///   y =   (V00 a - V10 b) + V20 c
    ///   z = -((V00 d - V10 e) + V20 f)
    ///   D = (V00 (V11 V22 - V12 V21) + V10 (-(V01 V22 - V21 V02))) + V20 (V01 V12 - V11 V02)
    ///   eye = (x, y, z) (1 / D)                                   each component times the quotient
    /// ```
    #[must_use]
    pub fn eye(&self) -> DVec3 {
        self.view_from_world.as_dmat4().inverse().w_axis.truncate()
    }
}

/// The axes right, up and back of a pose, as columns, and the distance from eye to target: r, v, b
/// and distance of [`Camera::new`]. This function also reports the errors of [`Camera::new`].
fn axes(pose: Pose) -> Result<(DMat3, f64)> {
    let invalid = |what: &str| Err(Error::Invalid(format!("camera: {what}")));
    let Pose { eye, target, up } = pose;
    if !(eye.is_finite() && target.is_finite() && up.is_finite()) {
        return invalid("eye, target and up must be finite numbers");
    }
    let distance = (target - eye).length();
    if distance == 0.0 {
        return invalid("eye and target are the same point: move one of them");
    }
    // The square of a longer distance is beyond f64, and such a position is beyond f32.
    if distance > MAX_DISTANCE || eye.abs().max_element() > MAX_DISTANCE {
        let what = format!("eye or target is farther away than {MAX_DISTANCE:e}");
        return invalid(&format!("{what}, about the limit of f32; move it closer"));
    }
    let back = (eye - target) / distance;
    // Only the direction of up counts, and the square of its length must fit in f64.
    let largest = up.abs().max_element();
    let up = if (1e-100..=1e100).contains(&largest) { up } else { up / largest };
    let right = up.cross(back);
    // An up of 0 is NaN by now. An angle below 1e-6 between up and the view leaves no digits for
    // `right`.
    if !(right.length() > 1e-6 * up.length()) {
        return invalid("up is zero or parallel to the line of sight: choose another --up");
    }
    let right = right.normalize();
    let up = back.cross(right);
    Ok((DMat3::from_cols(right, up, back), distance))
}

/// The projection of a lens, and its pixels per unit.
fn scale(height: u32, lens: Lens) -> Result<(Projection, f32)> {
    let height = f64::from(height);
    let (projection, scale) = match lens {
        Lens::FieldOfView(degrees) => {
            if !(degrees > 0.0 && degrees < 180.0) {
                let what = format!("camera: field of view {degrees}; give degrees in (0, 180)");
                return Err(Error::Invalid(what));
            }
            let half = degrees.to_radians() / 2.0;
            (Projection::Perspective, height / 2.0 / crate::number::elementary::tan(half))
        }
        Lens::Focal(pixels) => (Projection::Perspective, pixels),
        Lens::Orthographic(units) => (Projection::Orthographic, height / units),
    };
    // The rounding to f32 may turn a tiny scale into 0, or a huge one into infinity.
    if !(scale > 0.0 && (scale as f32).is_finite() && scale as f32 > 0.0) {
        let what = "camera: the focal length or orthographic height must be finite and > 0";
        return Err(Error::Invalid(what.into()));
    }
    Ok((projection, scale as f32))
}

#[cfg(test)]
mod tests;
