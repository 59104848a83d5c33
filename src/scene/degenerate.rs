//! Find the points of a cloud that cannot be surfels.

use crate::frame::Exec;
use crate::scene::Mipmap;
use crate::scene::light::is_color;
use glam::Vec3;

/// How many points one job looks at.
pub(super) const CHUNK: usize = 1 << 14;

/// How many surfels of a cloud were dropped; each is counted once, under the first reason that
/// applies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dropped {
    /// A position that is NaN or infinite.
    pub position: u64,
    /// A normal that is not finite or shorter than 2^-80.
    pub normal: u64,
    /// A radius that is not finite or not > 0.
    pub radius: u64,
    /// Colour, prefiltered or not, outside [0, [`crate::scene::light::MAX_RADIANCE`]], opacity
    /// outside [0, 1], tangents not finite or parallel.
    pub attribute: u64,
}

impl Dropped {
    /// The sum of all counts.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.position + self.normal + self.radius + self.attribute
    }

    /// The reasons in words, each with its count: `4 without normal, 2 without radius`.
    #[must_use]
    pub fn reasons(&self) -> String {
        let reasons = [
            (self.position, "not finite"),
            (self.normal, "without normal"),
            (self.radius, "without radius"),
            (self.attribute, "with a bad colour, opacity or tangent"),
        ];
        let reasons = reasons.iter().filter(|(count, _)| *count > 0);
        let reasons: Vec<String> = reasons.map(|(count, why)| format!("{count} {why}")).collect();
        reasons.join(", ")
    }

    /// What mends the reason that is most frequent, the first of equal ones.
    pub(super) fn cure(&self) -> &'static str {
        let cures = [
            (self.position, "give finite positions"),
            (self.normal, "give normals that are not zero, or none, so that they are derived"),
            (self.radius, "give finite radii above 0, or none, so that they are derived"),
            (
                self.attribute,
                "give colours of at least 0, opacities in [0, 1], and half axes that span a plane",
            ),
        ];
        cures.iter().rev().max_by_key(|(count, _)| count).map_or("", |(_, cure)| cure)
    }
}

impl std::ops::AddAssign for Dropped {
    fn add_assign(&mut self, more: Self) {
        self.position += more.position;
        self.normal += more.normal;
        self.radius += more.radius;
        self.attribute += more.attribute;
    }
}

/// The attributes of points except their normals, in arrays of one length.
pub(super) struct Points<'a> {
    pub(super) position: &'a [Vec3],
    pub(super) radius: &'a [f32],
    pub(super) color: Option<&'a [Vec3]>,
    pub(super) opacity: Option<&'a [f32]>,
    pub(super) tangents: Option<&'a [[Vec3; 2]]>,
    pub(super) mipmap: Option<&'a Mipmap>,
}

impl Points<'_> {
    /// Marks the points that are kept and counts the others; makes the normals unit vectors.
    pub(super) fn keep(&self, normal: &mut [Vec3], exec: &Exec) -> (Vec<bool>, Dropped) {
        let mut keep = vec![true; normal.len()];
        let chunks = keep.chunks_mut(CHUNK).zip(normal.chunks_mut(CHUNK)).enumerate();
        let counts = exec.ordered(chunks.collect(), |(chunk, (keep, normal))| {
            let mut dropped = Dropped::default();
            for (i, (keep, normal)) in keep.iter_mut().zip(normal).enumerate() {
                if let Some(reason) = self.reason(chunk * CHUNK + i, normal, &mut dropped) {
                    *reason += 1;
                    *keep = false;
                }
            }
            dropped
        });
        let mut dropped = Dropped::default();
        counts.into_iter().for_each(|count| dropped += count);
        (keep, dropped)
    }

    /// The first reason to drop point `i`, as the counter to increase.
    fn reason<'d>(
        &self,
        i: usize,
        normal: &mut Vec3,
        dropped: &'d mut Dropped,
    ) -> Option<&'d mut u64> {
        let radius = self.radius[i];
        if !self.position[i].is_finite() {
            Some(&mut dropped.position)
        } else if !unit(normal) {
            Some(&mut dropped.normal)
        } else if !(radius > 0.0 && radius.is_finite()) {
            Some(&mut dropped.radius)
        } else if !self.color.is_none_or(|c| is_color(c[i]))
            || !self.opacity.is_none_or(|o| (0.0..=1.0).contains(&o[i]))
            || !self.tangents.is_none_or(|t| spans_a_plane(t[i]))
            || !self.mipmap.is_none_or(|m| m.of_surfel(i).iter().all(|c| is_color(*c)))
        {
            Some(&mut dropped.attribute)
        } else {
            None
        }
    }
}

/// Makes a normal a unit vector; false if the normal has no direction.
pub(crate) fn unit(normal: &mut Vec3) -> bool {
    let n = normal.as_dvec3();
    let length = n.length();
    // A normal shorter than 2^-80 is the rounding error of a sum that cancelled.
    if !(length >= 1.0 / 1_208_925_819_614_629_174_706_176.0 && length.is_finite()) {
        return false;
    }
    if (length - 1.0).abs() > 1.0 / 1_048_576.0 {
        *normal = (n / length).as_vec3();
    }
    true
}

/// Whether two half axes are finite and span a plane, judged by the f64 area of their
/// parallelogram.
fn spans_a_plane([u, v]: [Vec3; 2]) -> bool {
    u.is_finite() && v.is_finite() && u.as_dvec3().cross(v.as_dvec3()).length_squared() > 0.0
}
