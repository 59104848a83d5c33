//! Export splats as bytes for a backend to upload: the same numbers that this crate draws.
//!
//! A backend that draws these records has the projection of the reference, bit for bit. So a
//! difference in its picture comes from its rasterization or its compositing.

use super::{Footprint, Kernel, Projector, Shared, Splat, Tally, View, batch};
use crate::number::MapInline;
use crate::number::Vector2;
use crate::scene::{Camera, Surfels};
use std::mem::{offset_of, size_of};

/// A visible splat and its attributes in 96 bytes of `f32` and `u32`.
///
/// | offset | size | field | meaning |
/// |---|---|---|---|
/// | 0 | 8 | `center` | column and row of the centre, px |
/// | 8 | 12 | `conic` | ux, uy, vy of [`super::Footprint`] |
/// | 20 | 12 | `plane` | w0, wx, wy: nearness at the centre, and its change per px right and down |
/// | 32 | 8 | `range` | `w_far`, `w_near`: the least and the greatest nearness |
/// | 40 | 4 | `amplitude` | the weight at q = 0 |
/// | 44 | 4 | `surfel` | its index in the scene: the order of every sum, and of ties |
/// | 48 | 16 | `bounds` | the pixels that may be inside: first column and row, and the ones after the last |
/// | 64 | 12 | `normal` | world space, of the side that is seen |
/// | 76 | 4 | `opacity` | in \[0, 1\]; 1 if the scene has no opacities |
/// | 80 | 12 | `color` | linear RGB; 0 if the scene has no colours: the material's colour then applies |
/// | 92 | 4 | `back` | 1 if the back of the surfel is seen, else 0 |
///
/// WGSL gives the same struct in a storage buffer these offsets, and so does std430:
///
/// ```wgsl
/// struct SplatRecord {
///     center: vec2<f32>, ux: f32, uy: f32, vy: f32, w0: f32, wx: f32, wy: f32,
///     w_far: f32, w_near: f32, amplitude: f32, surfel: u32, bounds: vec4<u32>,
///     normal: vec3<f32>, opacity: f32, color: vec3<f32>, back: u32,
/// }
/// ```
///
/// [`super::Footprint`] says how to draw the records; the numbers that all splats of a picture
/// share are in [`Shared`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct SplatRecord {
    /// Column and row of the centre, in px.
    pub center: [f32; 2],
    /// The factor of the conic: ux, uy, vy.
    pub conic: [f32; 3],
    /// Nearness of the disc's plane: w0 at the centre, wx per px to the right, wy per px down.
    pub plane: [f32; 3],
    /// The least and the greatest nearness of the disc: `w_far`, `w_near`.
    pub range: [f32; 2],
    /// The weight at q = 0.
    pub amplitude: f32,
    /// The index of the surfel in its scene.
    pub surfel: u32,
    /// The pixels that may be inside: x0, y0, x1, y1, the ends exclusive.
    pub bounds: [u32; 4],
    /// The unit normal in world space, reversed if the back is seen.
    pub normal: [f32; 3],
    /// Opacity in \[0, 1\]; 1 if the scene has none.
    pub opacity: f32,
    /// Linear RGB; 0 if the scene has none.
    pub color: [f32; 3],
    /// 1 if the back of the surfel is seen, else 0.
    pub back: u32,
}

impl SplatRecord {
    /// The number of bytes of a record, and the distance from one to the next.
    pub const SIZE: usize = size_of::<Self>();

    /// Name, offset in bytes and type of each field, in order.
    pub const FIELDS: [(&'static str, usize, &'static str); 11] = [
        ("center", offset_of!(Self, center), "f32 x 2"),
        ("conic", offset_of!(Self, conic), "f32 x 3"),
        ("plane", offset_of!(Self, plane), "f32 x 3"),
        ("range", offset_of!(Self, range), "f32 x 2"),
        ("amplitude", offset_of!(Self, amplitude), "f32"),
        ("surfel", offset_of!(Self, surfel), "u32"),
        ("bounds", offset_of!(Self, bounds), "u32 x 4"),
        ("normal", offset_of!(Self, normal), "f32 x 3"),
        ("opacity", offset_of!(Self, opacity), "f32"),
        ("color", offset_of!(Self, color), "f32 x 3"),
        ("back", offset_of!(Self, back), "u32"),
    ];

    /// Makes the record of a visible splat of `surfels`.
    ///
    /// # Panics
    /// If the splat belongs to another scene, with more surfels.
    #[must_use]
    pub fn new(splat: &Splat<f32>, surfels: &Surfels) -> Self {
        let (f, b, i) = (&splat.footprint, &splat.bounds, splat.surfel as usize);
        let normal = surfels.normal()[i].to_array();
        Self {
            center: [f.center.x, f.center.y],
            conic: [f.ux, f.uy, f.vy],
            plane: [f.w0, f.wx, f.wy],
            range: [f.w_far, f.w_near],
            amplitude: f.amplitude,
            surfel: splat.surfel,
            bounds: [b.x0, b.y0, b.x1, b.y1],
            normal: if splat.back { normal.map_inline(|component| -component) } else { normal },
            opacity: surfels.opacity_of(i),
            color: surfels.color().map_or([0.0; 3], |color| color[i].to_array()),
            back: splat.back.into(),
        }
    }

    /// Writes the fields in order, little-endian, without padding.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; Self::SIZE] {
        little_endian(&self.words())
    }

    /// Reads a record from bytes that [`SplatRecord::to_bytes`] wrote.
    #[must_use]
    pub fn from_bytes(bytes: &[u8; Self::SIZE]) -> Self {
        let words = bytes.as_chunks().0;
        let word = |at: usize| u32::from_le_bytes(words[at]);
        let number = |at: usize| f32::from_bits(word(at));
        let three = |at: usize| [number(at), number(at + 1), number(at + 2)];
        Self {
            center: [number(0), number(1)],
            conic: three(2),
            plane: three(5),
            range: [number(8), number(9)],
            amplitude: number(10),
            surfel: word(11),
            bounds: [word(12), word(13), word(14), word(15)],
            normal: three(16),
            opacity: number(19),
            color: three(20),
            back: word(23),
        }
    }

    /// The kernel on the screen.
    #[must_use]
    pub fn footprint(&self) -> Footprint<f32> {
        let ([x, y], [ux, uy, vy]) = (self.center, self.conic);
        let ([w0, wx, wy], [w_far, w_near]) = (self.plane, self.range);
        let center = Vector2::new(x, y);
        Footprint { center, ux, uy, vy, w0, wx, wy, w_far, w_near, amplitude: self.amplitude }
    }

    /// The bits of every number.
    fn words(&self) -> [u32; Self::SIZE / 4] {
        let ([cx, cy], [ux, uy, vy]) = (self.center, self.conic);
        let ([w0, wx, wy], [w_far, w_near]) = (self.plane, self.range);
        let ([nx, ny, nz], [r, g, b]) = (self.normal, self.color);
        let [x0, y0, x1, y1] = self.bounds;
        let footprint = [cx, cy, ux, uy, vy, w0, wx, wy, w_far, w_near, self.amplitude];
        let attributes = [nx, ny, nz, self.opacity, r, g, b].map_inline(f32::to_bits);
        let mut words = [0; Self::SIZE / 4];
        words[..11].copy_from_slice(&footprint.map_inline(f32::to_bits));
        words[11..16].copy_from_slice(&[self.surfel, x0, y0, x1, y1]);
        words[16..23].copy_from_slice(&attributes);
        words[23] = self.back;
        words
    }
}

/// Words as bytes; there are four times as many.
pub(crate) fn little_endian<const N: usize>(words: &[u32]) -> [u8; N] {
    let mut bytes = [0; N];
    for (to, word) in bytes.as_chunks_mut().0.iter_mut().zip(words) {
        *to = word.to_le_bytes();
    }
    bytes
}

/// Projects the visible splats of a scene, in ascending surfel index, and counts the fates of all
/// surfels.
///
/// Each surfel has the size that it has in the scene: the records of a method of groups are not
/// enlarged.
///
/// ```
/// use splatref::scene::Camera;
/// use splatref::source::Shape;
/// use splatref::splat::{Kernel, record};
///
/// let shape = Shape::Sphere;
/// let surfels = shape.surfels(500, 0)?;
/// let camera = Camera::new(64, 64, shape.default_pose(), shape.default_lens())?;
/// let (records, tally) = record::project_records(&surfels, &camera, &Kernel::default(), true);
/// assert_eq!(records.len() as u64, tally.visible);
/// let bytes: Vec<u8> = records.iter().flat_map(|record| record.to_bytes()).collect();
/// assert_eq!(bytes.len(), 96 * records.len());
/// # Ok::<(), splatref::Error>(())
/// ```
#[must_use]
pub fn project_records(
    surfels: &Surfels,
    camera: &Camera,
    kernel: &Kernel,
    cull: bool,
) -> (Vec<SplatRecord>, Tally) {
    let projector = Projector::new(View::new(camera), kernel, cull);
    let mut records = Vec::new();
    let tally = batch::splats_f32(&projector, surfels, 0..surfels.len(), |splat| {
        records.push(SplatRecord::new(&splat, surfels));
    });
    (records, tally)
}

/// The numbers that the records of a picture share, each with its name.
#[must_use]
pub fn shared_numbers(camera: &Camera, kernel: &Kernel) -> Vec<(&'static str, f32)> {
    let shared = Shared::new(&View::<f32>::new(camera), kernel);
    vec![("limit", shared.limit), ("low_pass", shared.low_pass), ("w_clip", shared.w_clip)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Rect;
    use crate::scene::{Lens, Pose};
    use crate::source::Shape;
    use crate::splat::Outline;
    use glam::Vec3;

    #[test]
    fn the_layout_is_the_documented_one() {
        let offsets = SplatRecord::FIELDS.map(|(_, offset, _)| offset);
        assert_eq!(offsets, [0, 8, 20, 32, 40, 44, 48, 64, 76, 80, 92]);
        assert_eq!((SplatRecord::SIZE, align_of::<SplatRecord>()), (96, 4));
        // Each field ends where the next begins: there is no padding.
        for (i, (name, offset, kind)) in SplatRecord::FIELDS.into_iter().enumerate() {
            let count: usize = kind[3..].trim_start_matches(" x ").parse().unwrap_or(1);
            let next = offsets.get(i + 1).copied().unwrap_or(SplatRecord::SIZE);
            assert_eq!(offset + 4 * count, next, "{name}");
        }
    }

    /// Every number has another value, and is found where the table says.
    #[test]
    fn bytes_read_back_are_the_fields() {
        let record = SplatRecord {
            center: [1.0, 2.0],
            conic: [3.0, 4.0, 5.0],
            plane: [6.0, 7.0, 8.0],
            range: [9.0, 10.0],
            amplitude: 11.0,
            surfel: 12,
            bounds: [13, 14, 15, 16],
            normal: [17.0, 18.0, -19.0],
            opacity: 20.0,
            color: [21.0, 22.0, 23.0],
            back: 24,
        };
        let bytes = record.to_bytes();
        let word = |at: usize| u32::from_le_bytes(bytes[4 * at..4 * at + 4].try_into().unwrap());
        for at in 0..24 {
            let is_float = ![11, 12, 13, 14, 15, 23].contains(&at);
            let value = at as f32 + 1.0;
            let value = if at == 18 { -value } else { value };
            assert_eq!(word(at), if is_float { value.to_bits() } else { at as u32 + 1 }, "{at}");
        }
        assert_eq!(SplatRecord::from_bytes(&bytes), record);
        assert_eq!(record.footprint().wy, 8.0);
    }

    #[test]
    fn a_record_holds_the_splat_and_the_attributes_of_its_surfel() {
        let shape = Shape::Sphere;
        let mut cloud = shape.surfels(300, 0).unwrap().into_cloud();
        cloud.opacity = Some((0..cloud.position.len()).map(|i| i as f32 / 1024.0).collect());
        let (surfels, _) = Surfels::new(cloud).unwrap();
        let camera = Camera::new(40, 30, shape.default_pose(), shape.default_lens()).unwrap();
        for outline in [Outline::Affine, Outline::Perspective, Outline::RayCast] {
            let kernel = Kernel { outline, ..Kernel::DEFAULT };
            let (records, tally) = project_records(&surfels, &camera, &kernel, false);
            assert_eq!(records.len() as u64, tally.visible);
            assert!(records.is_sorted_by(|a, b| a.surfel < b.surfel));
            assert!(records.iter().any(|r| r.back == 1) && records.iter().any(|r| r.back == 0));
            let projector = Projector::new(View::new(&camera), &kernel, false);
            let mut splats = Vec::new();
            batch::splats::<f32>(&projector, &surfels, 0..surfels.len(), |s| splats.push(s));
            assert_eq!(splats.len(), records.len());
            for (splat, record) in splats.iter().zip(&records) {
                let i = record.surfel as usize;
                let ([cx, cy], [ux, uy, vy]) = (record.center, record.conic);
                let ([w0, wx, wy], [w_far, w_near]) = (record.plane, record.range);
                let center = Vector2::new(cx, cy);
                let amplitude = record.amplitude;
                let footprint =
                    Footprint { center, ux, uy, vy, w0, wx, wy, w_far, w_near, amplitude };
                assert_eq!(splat.footprint, footprint);
                let [x0, y0, x1, y1] = record.bounds;
                assert_eq!(splat.bounds, Rect { x0, y0, x1, y1 });
                assert_eq!((splat.surfel, u32::from(splat.back)), (record.surfel, record.back));
                let side = if splat.back { -1.0 } else { 1.0 };
                assert_eq!(Vec3::from(record.normal), surfels.normal()[i] * side);
                assert_eq!(record.opacity, i as f32 / 1024.0);
                let color = surfels.color().map_or([0.0; 3], |color| color[i].to_array());
                assert_eq!(record.color, color);
            }
        }
    }

    #[test]
    fn shared_numbers_are_those_of_the_picture() {
        let pose = Pose { eye: glam::DVec3::Z, target: glam::DVec3::ZERO, up: glam::DVec3::Y };
        let camera = Camera::new(8, 8, pose, Lens::FieldOfView(60.0)).unwrap();
        let found = shared_numbers(&camera, &Kernel::DEFAULT);
        assert_eq!(found[..2], [("limit", 4.0), ("low_pass", 0.25)]);
        assert_eq!(found[2], ("w_clip", 1.0 / camera.near));
    }
}
