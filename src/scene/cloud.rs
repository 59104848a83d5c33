//! Points as a file holds them: nothing derived, nothing checked except the lengths of the arrays.

use super::degenerate::unit;
use super::{Coordinates, Groups, Mipmap, Paint};
use crate::number::MapInline;
use glam::{DVec3, Vec3};

/// A named number for each point, such as `roughness`, for your own shading.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Property {
    /// The name in the file.
    pub name: String,
    /// The values in the order of the points.
    pub values: Vec<f32>,
}

/// Points, with whatever else their file gave.
///
/// Every array that is present has the length of `position`. Values are unchecked: NaN, zero
/// normals and negative radii are dropped and counted when [`super::Surfels`] are made from the
/// points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cloud {
    /// Positions in world units.
    pub position: Vec<Vec3>,
    /// What a reader subtracted from the positions of the file, because `f32` would merge places
    /// that are far from 0; see [`crate::io::ply`].
    pub offset: DVec3,
    /// Normals of any length.
    pub normal: Option<Vec<Vec3>>,
    /// Radii in world units.
    pub radius: Option<Vec<f32>>,
    /// Linear RGB; 8- and 16-bit colours of files are sRGB and have been decoded.
    pub color: Option<Vec<Vec3>>,
    /// Opacity in [0, 1].
    pub opacity: Option<Vec<f32>>,
    /// Half axes of elliptical surfels, in world units.
    pub tangents: Option<Vec<[Vec3; 2]>>,
    /// Prefiltered linear RGB; used only where there are colours.
    pub mipmap: Option<Mipmap>,
    /// Tangents of tubes, of any length.
    pub tangent: Option<Vec<Vec3>>,
    /// Groups of the points.
    pub groups: Option<Groups>,
    /// Further numbers of the points; splatting knows only their names.
    pub properties: Vec<Property>,
    /// Where points or corners are in a texture.
    pub coordinates: Option<Coordinates>,
    /// The names of the textures that the file gives, in the order of their first use; an empty
    /// name stands for polygons without a texture.
    pub textures: Vec<String>,
    /// The texture, once it is read; without it, points get no colours from textures.
    pub paint: Option<Paint>,
    /// Triangles as indices into `position`; polygons of files have been cut into fans.
    pub triangles: Vec<[u32; 3]>,
    /// Linear RGB of the triangles, one for each; used only where points have no colours.
    pub triangle_color: Option<Vec<Vec3>>,
    /// Segments of ribbons and tubes as indices into `position`.
    pub edges: Vec<[u32; 2]>,
    /// What the reader doubts about the file, and what mends it: one line each, without the name
    /// of the file.
    pub warnings: Vec<String>,
}

impl Cloud {
    /// The points with these indices, in this order, without triangles and edges, and without the
    /// names of textures.
    ///
    /// # Panics
    /// If an index has no point, or an array is shorter than `position`.
    #[must_use]
    pub fn some(&self, indices: &[u32]) -> Self {
        Self {
            position: at(&self.position, indices),
            offset: self.offset,
            normal: self.normal.as_ref().map(|all| at(all, indices)),
            radius: self.radius.as_ref().map(|all| at(all, indices)),
            color: self.color.as_ref().map(|all| at(all, indices)),
            opacity: self.opacity.as_ref().map(|all| at(all, indices)),
            tangents: self.tangents.as_ref().map(|all| at(all, indices)),
            mipmap: self.mipmap.as_ref().map(|mipmap| {
                mipmap.some(&indices.iter().map(|&i| i as usize).collect::<Vec<_>>())
            }),
            tangent: self.tangent.as_ref().map(|all| at(all, indices)),
            groups: self.groups.as_ref().map(|groups| groups.some(indices)),
            properties: self.properties.iter().map(|one| one.some(indices)).collect(),
            coordinates: match &self.coordinates {
                Some(Coordinates::Points(all)) => Some(Coordinates::Points(at(all, indices))),
                Some(Coordinates::Corners(_)) | None => None,
            },
            textures: Vec::new(),
            paint: self.paint.clone(),
            triangles: Vec::new(),
            triangle_color: None,
            edges: Vec::new(),
            warnings: Vec::new(),
        }
    }

    /// Takes the normals out; `None` if no point has one, because all are zero or not finite.
    ///
    /// `Decided:` such normals count as missing. Programs write zeros where they have no normals. A
    /// file in which only some points have none keeps its normals: those points are dropped and
    /// counted, because the program that made the file looked for a normal there and found none.
    pub fn take_normals(&mut self) -> Option<Vec<Vec3>> {
        let normal = self.normal.take()?;
        normal.iter().any(|normal| unit(&mut normal.clone())).then_some(normal)
    }

    /// Keeps the points marked in `keep`, which has one mark per point, in their order. Keeps the
    /// triangles and edges whose corners are all kept.
    pub(crate) fn retain(&mut self, keep: &[bool]) {
        // The new index of each point that stays.
        let mut kept = 0;
        let index: Vec<Option<u32>> = keep
            .iter()
            .map(|&keep| {
                kept += u32::from(keep);
                keep.then(|| kept - 1)
            })
            .collect();
        marked([&mut self.position], keep);
        marked(&mut self.normal, keep);
        marked(&mut self.radius, keep);
        marked(&mut self.color, keep);
        marked(&mut self.opacity, keep);
        marked(&mut self.tangents, keep);
        marked(&mut self.tangent, keep);
        marked(self.properties.iter_mut().map(|one| &mut one.values), keep);
        self.mipmap = self.mipmap.take().map(|mipmap| mipmap.retain(keep));
        self.groups = self.groups.take().map(|groups| groups.retain(keep));
        let stays = |corners: &[u32; 3]| corners.iter().all(|&i| keep[i as usize]);
        let stays = || self.triangles.iter().map(stays).collect::<Vec<_>>();
        match &mut self.coordinates {
            Some(Coordinates::Points(all)) => marked([all], keep),
            Some(Coordinates::Corners(all)) => marked([all], &stays()),
            None => {}
        }
        if let Some(colors) = &mut self.triangle_color {
            marked([colors], &stays());
        }
        corners(&mut self.triangles, &index);
        corners(&mut self.edges, &index);
    }
}

impl Property {
    fn some(&self, indices: &[u32]) -> Self {
        Self { name: self.name.clone(), values: at(&self.values, indices) }
    }
}

/// The values at some indices.
fn at<T: Copy>(values: &[T], indices: &[u32]) -> Vec<T> {
    indices.iter().map(|&i| values[i as usize]).collect()
}

/// Keeps the values marked in `keep`, if there are values.
fn marked<'a, T: 'a>(values: impl IntoIterator<Item = &'a mut Vec<T>>, keep: &[bool]) {
    for values in values {
        let mut keep = keep.iter();
        values.retain(|_| keep.next().is_some_and(|&keep| keep));
    }
}

/// Gives corners their new index, and drops primitives that lost a corner.
fn corners<const N: usize>(all: &mut Vec<[u32; N]>, index: &[Option<u32>]) {
    all.retain_mut(|corners| {
        let mut found = true;
        for corner in corners {
            match index[*corner as usize] {
                Some(new) => *corner = new,
                None => found = false,
            }
        }
        found
    });
}

/// Two perpendicular half axes of a disc with normal n and radius r, in f64; n and r are used as
/// they are, in `f32`:
///
/// ```text
///   a    = the coordinate axis, of components 0 and 1, along which n is shortest:
///          x if |n.x| <= |n.y| and |n.x| <= |n.z|, else y if |n.y| <= |n.z|, else z
///   c    = a x n                      (a.y n.z - n.y a.z, a.z n.x - n.z a.x, a.x n.y - n.x a.y)
///   u    = c (1 / |c|)                |c| = sqrt((c.x c.x + c.y c.y) + c.z c.z)
///   v    = n x u                      not divided by its length
///   half axes u r, then v r           each component times r, rounded to f32 once
/// ```
///
/// u x v points along n.
#[must_use]
pub fn half_axes(normal: Vec3, radius: f32) -> [Vec3; 2] {
    let n = normal.as_dvec3();
    let [x, y, z] = normal.abs().to_array();
    let axis = if x <= y && x <= z {
        DVec3::X
    } else if y <= z {
        DVec3::Y
    } else {
        DVec3::Z
    };
    let u = axis.cross(n).normalize();
    let v = n.cross(u);
    [u, v].map_inline(|half| (half * f64::from(radius)).as_vec3())
}
