//! Hash many pictures into one line, so that you can compare machines by that line.

use crate::frame::image::{Image, Values};
use sha2::{Digest, Sha256};

/// SHA-256 of named pictures, in lower-case hexadecimal, in the order given.
///
/// Each picture contributes these bytes, numbers in little-endian order:
///
/// ```text
///   name, a byte 0
///   u32 width, u32 height, u32 count of channels
///   each channel: name, a byte 0; a byte 0 for floats or 1 for indices; the values' 32 bits
/// ```
///
/// The text of a picture is not hashed.
#[must_use]
pub fn sha256<'a>(pictures: impl IntoIterator<Item = (&'a str, &'a Image)>) -> String {
    let mut hash = Sha256::new();
    for (name, image) in pictures {
        hash.update(name.as_bytes());
        hash.update([0]);
        for number in [image.width, image.height, image.channels.len() as u32] {
            hash.update(number.to_le_bytes());
        }
        for (name, values) in &image.channels {
            hash.update(name.as_bytes());
            hash.update([0]);
            match values {
                Values::Float(values) => {
                    hash.update([0]);
                    values.iter().for_each(|value| hash.update(value.to_le_bytes()));
                }
                Values::Index(values) => {
                    hash.update([1]);
                    values.iter().for_each(|value| hash.update(value.to_le_bytes()));
                }
            }
        }
    }
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(name: &str, values: Values) -> Image {
        Image { width: 1, height: 2, channels: vec![(name.into(), values)], text: None }
    }

    #[test]
    fn the_bytes_are_those_documented() {
        let bytes = b"a\0\x01\0\0\0\x02\0\0\0\x01\0\0\0Z\0\0\0\0\x80\x3f\0\0\0\x80";
        let expected: String = Sha256::digest(bytes).iter().map(|b| format!("{b:02x}")).collect();
        let picture = image("Z", Values::Float(vec![1.0, -0.0]));
        assert_eq!(sha256([("a", &picture)]), expected);
        // With no picture: the hash of no bytes, which is easy to recognize.
        assert!(sha256([]).starts_with("e3b0c44298fc1c149afbf4c8996fb924"));
    }

    #[test]
    fn every_bit_and_the_order_count() {
        let float = image("Z", Values::Float(vec![0.0, 0.0]));
        let negative = image("Z", Values::Float(vec![0.0, -0.0]));
        let index = image("Z", Values::Index(vec![0, 0]));
        let named = image("id", Values::Index(vec![0, 0]));
        let mut all: Vec<String> =
            [&float, &negative, &index, &named].map(|p| sha256([("a", p)])).to_vec();
        all.push(sha256([("b", &float)]));
        all.push(sha256([("a", &float), ("b", &index)]));
        all.push(sha256([("b", &index), ("a", &float)]));
        let count = all.len();
        all.sort();
        all.dedup();
        assert_eq!(all.len(), count);
    }
}
