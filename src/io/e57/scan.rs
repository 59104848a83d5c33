//! Turn the raw values of a point into its position, colour and intensity.

use crate::number::{Real, elementary, srgb};
use e57::Transform;
use e57::{ColorLimits, PointCloud, Record, RecordDataType, RecordName, RecordValue, Result};
use glam::{DVec3, Vec3};

/// Where the values of a scan are, and what they mean.
pub(super) struct Scan<'a> {
    cloud: &'a PointCloud,
    /// `None` if the scan has no such coordinates.
    cartesian: Option<[usize; 3]>,
    spherical: Option<[usize; 3]>,
    color: Option<[usize; 3]>,
    /// The values of black and white of each channel.
    limits: [[f64; 2]; 3],
}

impl<'a> Scan<'a> {
    pub(super) fn new(cloud: &'a PointCloud) -> Self {
        use RecordName::{CartesianX, CartesianY, CartesianZ};
        use RecordName::{ColorBlue, ColorGreen, ColorRed};
        use RecordName::{SphericalAzimuth, SphericalElevation, SphericalRange};
        let three = |names: [RecordName; 3]| {
            let [a, b, c] = names.map(|name| place(cloud, &name));
            Some([a?, b?, c?])
        };
        let color = three([ColorRed, ColorGreen, ColorBlue]);
        let kind = |channel: usize| color.map(|at| &cloud.prototype[at[channel]]);
        Self {
            cloud,
            cartesian: three([CartesianX, CartesianY, CartesianZ]),
            spherical: three([SphericalRange, SphericalAzimuth, SphericalElevation]),
            color,
            limits: [0, 1, 2]
                .map(|channel| limits(cloud.color_limits.as_ref(), channel, kind(channel))),
        }
    }

    /// The position in the coordinates of the file; `None` if it is invalid or only a direction.
    pub(super) fn position(&self, values: &[RecordValue]) -> Result<Option<DVec3>> {
        let number = |at: usize| self.number(values, at);
        let (cartesian, spherical) =
            (RecordName::CartesianInvalidState, RecordName::SphericalInvalidState);
        let own = if let Some([x, y, z]) = self.cartesian
            && self.is_valid(values, &cartesian)?
        {
            DVec3::new(number(x)?, number(y)?, number(z)?)
        } else if let Some([range, azimuth, elevation]) = self.spherical
            && self.is_valid(values, &spherical)?
        {
            let (r, a, e) = (number(range)?, number(azimuth)?, number(elevation)?);
            let flat = r * elementary::cos(e);
            DVec3::new(flat * elementary::cos(a), flat * elementary::sin(a), r * elementary::sin(e))
        } else {
            return Ok(None);
        };
        Ok(Some(self.cloud.transform.as_ref().map_or(own, |pose| placed(pose, own))))
    }

    /// The linear colour; NaN if the point has none.
    pub(super) fn color(&self, values: &[RecordValue]) -> Result<Vec3> {
        let Some(at) = self.color else { return Ok(Vec3::NAN) };
        if !self.is_valid(values, &RecordName::IsColorInvalid)? {
            return Ok(Vec3::NAN);
        }
        let mut color = Vec3::NAN;
        for (channel, at) in at.into_iter().enumerate() {
            let [black, white] = self.limits[channel];
            let value = (self.number(values, at)? - black) / (white - black);
            color[channel] = srgb::to_linear(value.at_least(0.0).at_most(1.0)) as f32;
        }
        Ok(color)
    }

    /// The intensity; NaN if the point has none.
    pub(super) fn intensity(&self, values: &[RecordValue]) -> Result<f32> {
        match place(self.cloud, &RecordName::Intensity) {
            Some(at) if self.is_valid(values, &RecordName::IsIntensityInvalid)? => {
                Ok(self.number(values, at)? as f32)
            }
            _ => Ok(f32::NAN),
        }
    }

    fn number(&self, values: &[RecordValue], at: usize) -> Result<f64> {
        values[at].to_f64(&self.cloud.prototype[at].data_type)
    }

    /// Whether the record of this name says nothing against the values; 0 is valid.
    fn is_valid(&self, values: &[RecordValue], name: &RecordName) -> Result<bool> {
        place(self.cloud, name).map_or(Ok(true), |at| Ok(self.number(values, at)? == 0.0))
    }
}

/// Where the values of this name are in a point.
fn place(cloud: &PointCloud, name: &RecordName) -> Option<usize> {
    cloud.prototype.iter().position(|record| record.name == *name)
}

/// The values of black and white: the limits of the scan, else the range of the type. Floats without
/// a range are in [0, 1].
fn limits(limits: Option<&ColorLimits>, channel: usize, record: Option<&Record>) -> [f64; 2] {
    let Some(Record { data_type, .. }) = record else { return [0.0, 1.0] };
    let own = limits.map(|of| match channel {
        0 => [&of.red_min, &of.red_max],
        1 => [&of.green_min, &of.green_max],
        _ => [&of.blue_min, &of.blue_max],
    });
    let own = own.map(|ends| ends.map(|end| end.as_ref()?.to_f64(data_type).ok()));
    if let Some([Some(black), Some(white)]) = own {
        return [black, white];
    }
    match *data_type {
        RecordDataType::Single { min, max } => {
            [min.unwrap_or(0.0), max.unwrap_or(1.0)].map(f64::from)
        }
        RecordDataType::Double { min, max } => [min.unwrap_or(0.0), max.unwrap_or(1.0)],
        RecordDataType::Integer { min, max } => [min as f64, max as f64],
        RecordDataType::ScaledInteger { min, max, scale, offset } => {
            [min, max].map(|end| end as f64 * scale + offset)
        }
    }
}

/// A point in the coordinates of the file, see [`super`].
fn placed(pose: &Transform, p: DVec3) -> DVec3 {
    let (q, t) = (&pose.rotation, &pose.translation);
    let v = DVec3::new(q.x, q.y, q.z);
    let c = v.cross(p) + q.w * p;
    (p + 2.0 * v.cross(c)) + DVec3::new(t.x, t.y, t.z)
}
