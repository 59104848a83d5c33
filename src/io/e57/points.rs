//! Read the points of all scans.
//!
//! The crate's reader of ready points stops at files whose points begin in a later packet, so that
//! the raw values are read here.

use super::scan::Scan;
use crate::io::Reason;
use crate::io::far::{self, Settled};
use crate::io::ply::ReadOptions;
use crate::memory;
use crate::scene::light::Phong;
use crate::scene::{Cloud, Property};
use e57::{E57Reader, Error, PointCloud, RecordDataType};
use glam::Vec3;
use std::io::Cursor;

/// The most memory that a point takes: the crate's values of it, its position in f64 and in `f32`,
/// its colour and its intensity.
const BYTES_A_POINT: u64 = 192;

/// What is read of the scans.
#[derive(Default)]
struct Points {
    positions: Vec<[f64; 3]>,
    /// NaN where a point has none.
    colors: Vec<Vec3>,
    intensity: Vec<f32>,
    /// Points without coordinates.
    without: u64,
}

pub(super) fn read(bytes: &[u8], options: &ReadOptions) -> Reason<Cloud> {
    let mut file = E57Reader::new(Cursor::new(bytes)).map_err(reason)?;
    let scans = file.pointclouds();
    for (i, scan) in scans.iter().enumerate() {
        check(i, scan, bytes.len() as u64)?;
    }
    let count = scans.iter().map(|scan| scan.records).fold(0, u64::saturating_add);
    memory::try_ask(count.saturating_mul(BYTES_A_POINT), || format!("a cloud of {count} points"))?;
    let mut all = Points::default();
    for (i, cloud) in scans.iter().enumerate() {
        let of_scan = |error| format!("scan {i}: {}", reason(error));
        let scan = Scan::new(cloud);
        for values in file.pointcloud_raw(cloud).map_err(of_scan)? {
            let values = values.map_err(of_scan)?;
            match scan.position(&values).map_err(of_scan)? {
                Some(position) => {
                    all.positions.push(position.to_array());
                    all.colors.push(scan.color(&values).map_err(of_scan)?);
                    all.intensity.push(scan.intensity(&values).map_err(of_scan)?);
                }
                None => all.without += 1,
            }
        }
    }
    all.cloud(scans.iter().any(PointCloud::has_intensity), options)
}

/// One line, with the remedy.
fn reason(error: Error) -> String {
    format!("{error}; write the file again").replace('\n', " ")
}

/// Refuses a scan that claims more points than the file can hold, or that has no coordinates.
fn check(i: usize, scan: &PointCloud, length: u64) -> Reason<()> {
    if !(scan.has_cartesian() || scan.has_spherical()) {
        return Err(format!("scan {i} has no coordinates; remove it"));
    }
    let bits = scan.prototype.iter().map(|record| match record.data_type {
        RecordDataType::Single { .. } => 32,
        RecordDataType::Double { .. } => 64,
        RecordDataType::ScaledInteger { min, max, .. } | RecordDataType::Integer { min, max } => {
            u64::from(max > min)
        }
    });
    // A point takes at least these bits. Without any, the crate would make points for ever.
    let bits: u64 = bits.sum();
    if bits == 0 || u128::from(scan.records) * u128::from(bits) > 8 * u128::from(length) {
        return Err(format!(
            "scan {i} claims {} points of at least {bits} bits, more than a file of {length} bytes \
             can hold: it is damaged",
            scan.records
        ));
    }
    Ok(())
}

impl Points {
    fn cloud(mut self, has_intensity: bool, options: &ReadOptions) -> Reason<Cloud> {
        if self.positions.is_empty() {
            return Err(format!("no point has coordinates; {} have none", self.without));
        }
        let Settled { position, offset, warning } =
            far::settle(&self.positions, options.keep_place)?;
        let mut warnings: Vec<String> = warning.into_iter().collect();
        if self.without > 0 {
            let without = self.without;
            warnings.push(format!("{without} points have no valid coordinates, and are left out"));
        }
        let colored = self.colors.iter().any(|color| !color.is_nan());
        for color in self.colors.iter_mut().filter(|color| color.is_nan()) {
            *color = Phong::default().color;
        }
        let intensity = Property { name: "intensity".into(), values: self.intensity };
        Ok(Cloud {
            position,
            offset,
            color: colored.then_some(self.colors),
            properties: has_intensity.then_some(intensity).into_iter().collect(),
            warnings,
            ..Cloud::default()
        })
    }
}
