//! Surfels: the checked structure of arrays that every method takes.

mod arrays;

pub(super) use arrays::Arrays;

use super::Cloud;
use super::Groups;
use super::Mipmap;
use super::degenerate::{CHUNK, Dropped, Points};
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::number::MapInline;
use crate::scene::Sphere;
use crate::scene::light::is_color;
use glam::{DVec3, Vec3};
use std::ops::Range;

/// Surfels as a structure of arrays of one length.
///
/// The constructor guarantees:
///
/// - at least one surfel, except in [`Surfels::none`];
/// - finite positions;
/// - normals of length 1 within 2^-20;
/// - finite radii > 0;
/// - colours in [0, [`crate::scene::light::MAX_RADIANCE`]], prefiltered ones too, and opacities in
///   [0, 1], none of them -0;
/// - prefiltered colours only where there are colours;
/// - finite tangents that are not parallel. (Whether they are perpendicular to each other and to
///   the normal is up to the source of the scene.)
///
/// An array that the scene does not need is not allocated.
#[derive(Clone, Debug, PartialEq)]
pub struct Surfels {
    position: Vec<Vec3>,
    normal: Vec<Vec3>,
    radius: Vec<f32>,
    color: Option<Vec<Vec3>>,
    opacity: Option<Vec<f32>>,
    tangents: Option<Vec<[Vec3; 2]>>,
    mipmap: Option<Mipmap>,
    groups: Option<Groups>,
    median_radius: f32,
    bounding_sphere: Sphere,
}

impl Surfels {
    /// Checks a complete cloud, drops degenerate points, and counts them.
    ///
    /// A normal whose length is within 2^-20 of 1 is kept as it is. Any other normal is divided by
    /// its length, sqrt((x x + y y) + z z), in f64, component by component, and rounded once.
    /// Triangles, edges and the tangents of tubes are ignored.
    ///
    /// # Errors
    /// [`Error::Invalid`] if normals or radii are missing, if an array has the wrong length, or if
    /// there are prefiltered colours without colours. Also if nothing is left, or if there are more
    /// than 2^32 - 2 surfels.
    pub fn new(cloud: Cloud) -> Result<(Self, Dropped)> {
        Self::new_with(cloud, &Exec::sequential())
    }

    /// [`Surfels::new`] on several threads; the result is the same.
    ///
    /// # Errors
    /// As [`Surfels::new`].
    pub fn new_with(cloud: Cloud, exec: &Exec) -> Result<(Self, Dropped)> {
        let n = cloud.position.len();
        let (surfels, dropped) = Self::new_or_none(cloud, exec)?;
        if surfels.is_empty() {
            return Err(Error::Invalid(format!(
                "the scene is empty: none of its {n} points can be a surfel: {}; {}",
                dropped.reasons(),
                dropped.cure()
            )));
        }
        Ok((surfels, dropped))
    }

    /// [`Surfels::new_with`] for a part of a scene that has other primitives too: [`Surfels::none`]
    /// if nothing is left.
    ///
    /// # Errors
    /// [`Error::Invalid`] as [`Surfels::new`], except if nothing is left.
    pub fn new_or_none(cloud: Cloud, exec: &Exec) -> Result<(Self, Dropped)> {
        let (mut surfels, dropped) = Self::checked(cloud, exec)?;
        if !surfels.is_empty() {
            (surfels.median_radius, surfels.bounding_sphere) =
                exec.join(|| lower_median(surfels.radius.clone()), || surfels.sphere(exec));
        }
        Ok((surfels, dropped))
    }

    /// [`Surfels::new_or_none`] without the median radius and the bounding sphere.
    fn checked(cloud: Cloud, exec: &Exec) -> Result<(Self, Dropped)> {
        let n = cloud.position.len();
        let Cloud { position, normal, radius, color, opacity, tangents, mipmap, groups, .. } =
            cloud;
        let mut normal =
            normal.ok_or_else(|| Error::Invalid("the points have no normals".into()))?;
        let radius = radius.ok_or_else(|| Error::Invalid("the points have no radii".into()))?;
        check_lengths(n, normal.len(), radius.len(), &color, &opacity, &tangents, &groups)?;
        check_mipmap(n, color.is_some(), &mipmap)?;
        if n as u64 >= u64::from(u32::MAX) {
            return Err(Error::Invalid(format!(
                "{n} surfels, but ids have 32 bits: split the scene"
            )));
        }

        let points = Points {
            position: &position,
            radius: &radius,
            color: color.as_deref(),
            opacity: opacity.as_deref(),
            tangents: tangents.as_deref(),
            mipmap: mipmap.as_ref(),
        };
        let (keep, dropped) = points.keep(&mut normal, exec);
        if dropped.total() == n as u64 {
            return Ok((Self::none(), dropped));
        }
        let radius = retain(radius, &keep);
        let surfels = Self {
            median_radius: 0.0,
            bounding_sphere: Sphere::default(),
            position: retain(position, &keep),
            normal: retain(normal, &keep),
            radius,
            // Adding 0 turns -0 into 0.
            color: color.map(|c| retain(c, &keep).into_iter().map(|c| c + Vec3::ZERO).collect()),
            opacity: opacity.map(|o| retain(o, &keep).into_iter().map(|o| o + 0.0).collect()),
            tangents: tangents.map(|t| retain(t, &keep)),
            mipmap: mipmap.map(|mipmap| {
                let mut kept = mipmap.retain(&keep);
                kept.colors_mut().iter_mut().for_each(|color| *color += Vec3::ZERO);
                kept
            }),
            groups: groups.map(|g| g.retain(&keep)),
        };
        Ok((surfels, dropped))
    }

    /// No surfels at all, for a scene that consists of other primitives. The median radius is 0,
    /// and the bounds are the origin.
    #[must_use]
    pub fn none() -> Self {
        Self {
            position: Vec::new(),
            normal: Vec::new(),
            radius: Vec::new(),
            color: None,
            opacity: None,
            tangents: None,
            mipmap: None,
            groups: None,
            median_radius: 0.0,
            bounding_sphere: Sphere::default(),
        }
    }

    /// Surfels of a whole that has this median radius and this bounding sphere. `None` if a point of
    /// the cloud cannot be a surfel. Of no points, the result has the empty arrays of the cloud.
    ///
    /// # Errors
    /// As [`Surfels::new`], except if nothing is left.
    pub(crate) fn part_of(
        cloud: Cloud,
        median_radius: f32,
        bounding_sphere: Sphere,
        exec: &Exec,
    ) -> Result<Option<Self>> {
        if cloud.position.is_empty() {
            let there = [cloud.color.is_some(), cloud.opacity.is_some(), cloud.tangents.is_some()];
            let arrays = Arrays::new(there, 0);
            return Ok(Some(arrays.into_surfels(median_radius, bounding_sphere)));
        }
        let (surfels, dropped) = Self::checked(cloud, exec)?;
        Ok((dropped.total() == 0).then_some(Self { median_radius, bounding_sphere, ..surfels }))
    }

    /// Picks the surfels with these ascending indices; an index without a surfel is left out.
    /// Median radius and bounding sphere stay the ones of all surfels.
    #[must_use]
    pub fn some(&self, indices: &[u64], exec: &Exec) -> Self {
        let indices = indices.iter().map(|&i| i as usize).filter(|&i| i < self.len());
        let indices: Vec<usize> = indices.collect();
        let mipmap = self.mipmap.as_ref().map(|mipmap| mipmap.some(&indices));
        self.picked(&indices, mipmap, exec)
    }

    /// All surfels in another order, without their mipmaps and groups. Median radius and bounding
    /// sphere stay as they are.
    pub(crate) fn reordered(&self, order: impl Iterator<Item = u32>, exec: &Exec) -> Self {
        let order: Vec<usize> = order.map(|surfel| surfel as usize).collect();
        self.picked(&order, None, exec)
    }

    /// How many bytes [`Self::reordered`] takes, temporary memory included.
    pub(crate) fn bytes_reordered(&self) -> u64 {
        let of = |there: bool, bytes| if there { bytes } else { 0 };
        let more = of(self.color.is_some(), 12) + of(self.opacity.is_some(), 4);
        self.len() as u64 * (8 + 28 + more + of(self.tangents.is_some(), 24))
    }

    /// Picks the surfels with these indices, which must exist.
    fn picked(&self, indices: &[usize], mipmap: Option<Mipmap>, exec: &Exec) -> Self {
        fn of<T: Copy + Send + Sync>(values: &[T], indices: &[usize], exec: &Exec) -> Vec<T> {
            let mut some = Vec::with_capacity(indices.len());
            exec.extend(&mut some, indices.len(), |i| values[indices[i]]);
            some
        }
        let arrays = Arrays {
            position: of(&self.position, indices, exec),
            normal: of(&self.normal, indices, exec),
            radius: of(&self.radius, indices, exec),
            color: self.color.as_ref().map(|color| of(color, indices, exec)),
            opacity: self.opacity.as_ref().map(|opacity| of(opacity, indices, exec)),
            tangents: self.tangents.as_ref().map(|tangents| of(tangents, indices, exec)),
            mipmap,
        };
        arrays.into_surfels(self.median_radius, self.bounding_sphere)
    }

    /// Gives all surfels this colour, if they have none.
    pub(crate) fn colored(mut self, color: Vec3) -> Self {
        let count = self.len();
        self.color.get_or_insert_with(|| vec![color + Vec3::ZERO; count]);
        self
    }

    /// Whether two surfels have the same place and shape, by all bits: everything drawn for one is
    /// then drawn for the other.
    pub(crate) fn are_equal(&self, a: u32, b: u32) -> bool {
        let [a, b] = [a, b].map_inline(|i| i as usize);
        a < self.len()
            && b < self.len()
            && self.position[a] == self.position[b]
            && self.normal[a] == self.normal[b]
            && self.radius[a] == self.radius[b]
            && self.tangents.as_ref().is_none_or(|tangents| tangents[a] == tangents[b])
    }

    /// How many surfels there are: less than 2^32 - 1.
    #[must_use]
    pub fn len(&self) -> usize {
        self.position.len()
    }

    /// Whether this is [`Surfels::none`].
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.position.is_empty()
    }

    /// Positions in world units.
    #[must_use]
    pub fn position(&self) -> &[Vec3] {
        &self.position
    }

    /// Unit normals in world space.
    #[must_use]
    pub fn normal(&self) -> &[Vec3] {
        &self.normal
    }

    /// Radii in world units. An ellipse is drawn by its tangents; its radius is used for the median
    /// only.
    #[must_use]
    pub fn radius(&self) -> &[f32] {
        &self.radius
    }

    /// Linear RGB, not premultiplied.
    #[must_use]
    pub fn color(&self) -> Option<&[Vec3]> {
        self.color.as_deref()
    }

    /// Opacity in [0, 1].
    #[must_use]
    pub fn opacity(&self) -> Option<&[f32]> {
        self.opacity.as_deref()
    }

    /// The opacity of surfel `i`: 1 if there are no opacities.
    #[inline(always)]
    pub(crate) fn opacity_of(&self, i: usize) -> f32 {
        self.opacity().map_or(1.0, |opacity| opacity[i])
    }

    /// Half axes of elliptical surfels in world units.
    #[must_use]
    pub fn tangents(&self) -> Option<&[[Vec3; 2]]> {
        self.tangents.as_deref()
    }

    /// Prefiltered colours.
    #[must_use]
    pub fn mipmap(&self) -> Option<&Mipmap> {
        self.mipmap.as_ref()
    }

    /// Replaces the prefiltered colours, or removes them.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there are more or fewer than surfels, if surfels have no colours, or if a
    /// colour is not in [0, [`crate::scene::light::MAX_RADIANCE`]].
    pub fn with_mipmap(self, mipmap: Option<Mipmap>) -> Result<Self> {
        check_mipmap(self.len(), self.color.is_some(), &mipmap)?;
        let mut mipmap = mipmap;
        let colors = mipmap.iter_mut().flat_map(|mipmap| mipmap.colors_mut());
        for color in colors {
            if !is_color(*color) {
                return Err(Error::Invalid(format!(
                    "a prefiltered colour is {color}; give numbers in [0, {}]",
                    crate::scene::light::MAX_RADIANCE
                )));
            }
            *color += Vec3::ZERO;
        }
        Ok(Self { mipmap, ..self })
    }

    /// Replaces the colours, one for each surfel, and removes the prefiltered ones.
    pub(crate) fn recolored(self, colors: Vec<Vec3>) -> Self {
        Self { color: Some(colors), mipmap: None, ..self }
    }

    /// Groups, if the scene came with groups.
    #[must_use]
    pub fn groups(&self) -> Option<&Groups> {
        self.groups.as_ref()
    }

    /// The lower median of the radii: the element of rank (n - 1) / 2 in ascending order.
    #[must_use]
    pub fn median_radius(&self) -> f32 {
        self.median_radius
    }

    /// The corners of the smallest axis-parallel box around all positions.
    #[must_use]
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let first = self.position.first().copied().unwrap_or_default();
        self.position.iter().fold((first, first), |(low, high), p| (low.min(*p), high.max(*p)))
    }

    /// A sphere around all discs, in f64. Its middle is the middle of [`Surfels::bounds`], (low +
    /// high) / 2. Its radius is the largest distance from there to a surfel, sqrt((x x + y y) + z
    /// z), plus the surfel's reach: the radius or, for an ellipse, sqrt(U . U + V . V).
    #[must_use]
    pub fn bounding_sphere(&self) -> Sphere {
        self.bounding_sphere
    }

    fn sphere(&self, exec: &Exec) -> Sphere {
        let (low, high) = self.bounds();
        let center = (low.as_dvec3() + high.as_dvec3()) / 2.0;
        let firsts = (0..self.len()).step_by(CHUNK).collect();
        let far = exec.ordered(firsts, |first| {
            self.reach_of_some(first..self.len().min(first + CHUNK), center)
        });
        let radius = far.into_iter().fold(0.0, |most, far| if far > most { far } else { most });
        Sphere { center, radius }
    }

    /// The largest distance from a point to a surfel plus its reach; 0 if there is none.
    pub(crate) fn reach(&self, center: DVec3) -> f64 {
        self.reach_of_some(0..self.len(), center)
    }

    /// How far a surfel reaches from its centre at most.
    #[inline]
    pub(crate) fn reach_of(&self, i: usize) -> f64 {
        match &self.tangents {
            None => f64::from(self.radius[i]),
            Some(tangents) => {
                let [u, v] = tangents[i].map_inline(Vec3::as_dvec3);
                (u.length_squared() + v.length_squared()).sqrt()
            }
        }
    }

    /// [`Surfels::reach`] for a range of surfels.
    fn reach_of_some(&self, surfels: Range<usize>, center: DVec3) -> f64 {
        let mut most = 0.0;
        for i in surfels {
            let far = (self.position[i].as_dvec3() - center).length() + self.reach_of(i);
            most = if far > most { far } else { most };
        }
        most
    }

    /// Turns the surfels back into a cloud, to be written to a file.
    #[must_use]
    pub fn into_cloud(self) -> Cloud {
        Cloud {
            position: self.position,
            normal: Some(self.normal),
            radius: Some(self.radius),
            color: self.color,
            opacity: self.opacity,
            tangents: self.tangents,
            mipmap: self.mipmap,
            groups: self.groups,
            ..Cloud::default()
        }
    }
}

/// The element of rank (n - 1) / 2; there must be at least one element.
fn lower_median(mut values: Vec<f32>) -> f32 {
    let middle = (values.len() - 1) / 2;
    *values.select_nth_unstable_by(middle, f32::total_cmp).1
}

/// Checks that every array is as long as the positions.
fn check_lengths(
    n: usize,
    normals: usize,
    radii: usize,
    color: &Option<Vec<Vec3>>,
    opacity: &Option<Vec<f32>>,
    tangents: &Option<Vec<[Vec3; 2]>>,
    groups: &Option<Groups>,
) -> Result<()> {
    let others = [
        ("normals", normals),
        ("radii", radii),
        ("colours", color.as_ref().map_or(n, Vec::len)),
        ("opacities", opacity.as_ref().map_or(n, Vec::len)),
        ("half axes", tangents.as_ref().map_or(n, Vec::len)),
        ("groups", groups.as_ref().map_or(n, |g| g.own().len())),
    ];
    for (what, length) in others {
        if length != n {
            return Err(Error::Invalid(format!("{n} positions, but {length} {what}")));
        }
    }
    Ok(())
}

/// Checks that prefiltered colours, if there are any, exist for every surfel, and that there are
/// colours too.
pub(crate) fn check_mipmap(n: usize, colored: bool, mipmap: &Option<Mipmap>) -> Result<()> {
    let Some(mipmap) = mipmap else { return Ok(()) };
    if mipmap.len() != n {
        let of = mipmap.len();
        return Err(Error::Invalid(format!("{n} positions, but prefiltered colours for {of}")));
    }
    if colored {
        return Ok(());
    }
    Err(Error::Invalid("the points have prefiltered colours, but no colours of their own".into()))
}

/// Keeps the elements marked in `keep`, in order; without a copy if all are marked.
fn retain<T>(values: Vec<T>, keep: &[bool]) -> Vec<T> {
    if keep.iter().all(|&k| k) {
        return values;
    }
    values.into_iter().zip(keep).filter_map(|(value, &k)| k.then_some(value)).collect()
}

impl Groups {
    /// Checks that the groups can belong to these surfels: there must be as many of both.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there are not.
    pub fn check(&self, surfels: &Surfels) -> Result<()> {
        let (grouped, there) = (self.own().len(), surfels.len());
        if grouped == there {
            Ok(())
        } else {
            Err(Error::Invalid(format!(
                "the groups have {grouped} surfels, but the scene has {there}"
            )))
        }
    }
}

#[cfg(test)]
mod tests;
