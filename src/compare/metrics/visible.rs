//! Count pixels that are visibly off: a number for the word "visible" in papers.

use super::{Region, regions};
use crate::error::{Error, Result};
use crate::frame::{Frame, Samples};
use crate::number::srgb::from_linear;

/// A pixel is visibly off if R, G or B differs by more than this in sRGB.
pub const STEP: f64 = 8.0 / 255.0;

/// The per cent of [interior](Region::Interior) pixels that are visibly off: R, G or B differs by
/// more than [`STEP`] in sRGB. The truth's `A` says which pixels are interior. 0 if there are none.
///
/// `Decided:` a difference of 8/255 can be seen on a surface that is smooth around it. A silhouette
/// is left out, because it may be off by a pixel in both pictures. A NaN is off.
///
/// # Errors
/// [`Error::Invalid`] if the frames differ in size, or the colour or `A` is missing.
pub fn visible(picture: &Frame<f32>, truth: &Frame<f32>) -> Result<f64> {
    if (picture.width, picture.height) != (truth.width, truth.height) {
        return Err(Error::Invalid("visible differences: give pictures of one size".into()));
    }
    let Some(Samples::Scalar(covered)) = truth.plane("A") else {
        return Err(Error::Invalid("visible differences: the truth has no plane A".into()));
    };
    let (found, expected) = (picture.color("")?, truth.color("")?);
    let differs = |found: &[f32; 3], expected: &[f32; 3]| {
        let pairs = found.iter().zip(expected);
        let mut steps = pairs.map(|(a, b)| from_linear(f64::from(*a)) - from_linear(f64::from(*b)));
        steps.any(|step| !(step.abs() <= STEP))
    };
    let pixels = found.values().iter().zip(expected.values());
    let all = regions(covered.values(), truth.width as usize).into_iter().zip(pixels);
    let (mut off, mut count) = (0_u64, 0_u64);
    for (_, (found, expected)) in all.filter(|(region, _)| *region == Region::Interior) {
        off += u64::from(differs(found, expected));
        count += 1;
    }
    Ok(if count == 0 { 0.0 } else { 1e2 * off as f64 / count as f64 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{NamedPlane, Plane};

    /// A gray picture of 5 x 4 pixels, all covered except the last column.
    fn gray(value: f32) -> Frame<f32> {
        let covered = (0..20).map(|i| f32::from(u8::from(i % 5 < 4))).collect();
        let planes = vec![
            NamedPlane {
                name: String::new(),
                samples: Samples::Color(Plane::filled(5, 4, [value; 3])),
            },
            NamedPlane {
                name: "A".into(),
                samples: Samples::Scalar(Plane::from_values(5, 4, covered)),
            },
        ];
        Frame { width: 5, height: 4, planes }
    }

    fn with(index: usize, value: [f32; 3]) -> Frame<f32> {
        let mut frame = gray(0.5);
        let Samples::Color(plane) = &mut frame.planes[0].samples else { panic!("a color") };
        let mut values = plane.values().to_vec();
        values[index] = value;
        *plane = Plane::from_values(5, 4, values);
        frame
    }

    #[test]
    fn pixels_inside_count_beyond_eight_steps() {
        let truth = gray(0.5);
        let share = |frame: &Frame<f32>| visible(frame, &truth).unwrap();
        assert_eq!(share(&truth), 0.0);
        // Linear 0.5 is 187.52 of 255 in sRGB; these are 7.9 and 8.1 steps above. One of twelve
        // pixels inside.
        assert_eq!(share(&with(1, [0.5, 0.5, 0.54833])), 0.0);
        assert_eq!(share(&with(1, [0.5, 0.5, 0.54959])), 100.0 / 12.0);
        assert_eq!(share(&with(1, [0.5, f32::NAN, 0.5])), 100.0 / 12.0, "a NaN is off");
        // The fourth column is on the silhouette, the fifth beyond it.
        assert_eq!(share(&with(3, [1.0; 3])), 0.0);
        assert_eq!(share(&with(4, [1.0; 3])), 0.0);
        assert_eq!(share(&gray(0.9)), 100.0);
    }

    #[test]
    fn what_cannot_be_compared_is_refused() {
        let small = Frame::<f32> { width: 1, height: 1, planes: Vec::new() };
        assert!(visible(&small, &gray(0.5)).is_err());
        let bare = Frame { planes: gray(0.5).planes[..1].to_vec(), ..gray(0.5) };
        assert!(visible(&gray(0.5), &bare).unwrap_err().to_string().contains("no plane A"));
    }
}
