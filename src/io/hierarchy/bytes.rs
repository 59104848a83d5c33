//! Convert numbers to bytes and back.

use crate::io::{Reason, checksum};
use glam::{DMat3, DVec3, Vec3};

/// A SHA-256 hash.
pub(super) type Hash = [u8; 32];

/// A growing buffer of bytes.
#[derive(Default)]
pub(in crate::io) struct Writer(pub(in crate::io) Vec<u8>);

impl Writer {
    pub(in crate::io) fn bytes(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(bytes);
    }

    pub(in crate::io) fn words(&mut self, words: &[u32]) {
        words.iter().for_each(|word| self.bytes(&word.to_le_bytes()));
    }

    pub(in crate::io) fn long(&mut self, long: u64) {
        self.bytes(&long.to_le_bytes());
    }

    pub(in crate::io) fn float(&mut self, float: f32) {
        self.bytes(&float.to_le_bytes());
    }

    pub(in crate::io) fn vector(&mut self, v: Vec3) {
        v.to_array().into_iter().for_each(|float| self.float(float));
    }

    /// Writes the length, then the bytes.
    pub(super) fn text(&mut self, text: &str) {
        self.words(&[text.len() as u32]);
        self.bytes(text.as_bytes());
    }

    pub(in crate::io) fn double(&mut self, double: f64) {
        self.bytes(&double.to_le_bytes());
    }
}

/// Why a file with a wrong checksum is refused.
pub(super) const DAMAGED: &str =
    "damaged: its checksum is wrong; rerun `splatref surfels` to make the file again";

/// The bytes before the checksum at the end of a file or a block.
pub(super) fn checked(bytes: &[u8]) -> Reason<&[u8]> {
    checksum::open(bytes).ok_or_else(|| DAMAGED.into())
}

/// Checks that a file begins with its `magic`; `what` is what it should be.
pub(super) fn check_magic(bytes: &[u8], magic: &[u8; 16], what: &str) -> Reason<()> {
    let mut older = *magic;
    older[14] = b'1';
    match bytes.first_chunk::<16>() {
        Some(found) if found == magic => Ok(()),
        Some(found) if *found == older => Err("an older version wrote this file, without a \
             checksum; remove the folder and rerun `splatref surfels`"
            .into()),
        _ => Err(format!("not {what} of a splatref hierarchy")),
    }
}

/// Bytes, read from the front.
pub(in crate::io) struct Reader<'a>(pub(in crate::io) &'a [u8]);

impl Reader<'_> {
    pub(in crate::io) fn take<const N: usize>(&mut self) -> Reason<[u8; N]> {
        let (first, rest) = self.0.split_first_chunk::<N>().ok_or("the file is truncated")?;
        self.0 = rest;
        Ok(*first)
    }

    pub(super) fn text(&mut self, length: u32) -> Reason<String> {
        let split = self.0.split_at_checked(length as usize).ok_or("the file is truncated")?;
        self.0 = split.1;
        String::from_utf8(split.0.to_vec()).map_err(|_| "a name is not UTF-8".into())
    }

    pub(in crate::io) fn word(&mut self) -> Reason<u32> {
        self.take().map(u32::from_le_bytes)
    }

    pub(in crate::io) fn words<const N: usize>(&mut self) -> Reason<[u32; N]> {
        let mut words = [0; N];
        for word in &mut words {
            *word = self.word()?;
        }
        Ok(words)
    }

    pub(in crate::io) fn long(&mut self) -> Reason<u64> {
        self.take().map(u64::from_le_bytes)
    }

    pub(in crate::io) fn float(&mut self) -> Reason<f32> {
        self.take().map(f32::from_le_bytes)
    }

    pub(in crate::io) fn vector(&mut self) -> Reason<Vec3> {
        Ok(Vec3::new(self.float()?, self.float()?, self.float()?))
    }

    pub(in crate::io) fn double(&mut self) -> Reason<f64> {
        self.take().map(f64::from_le_bytes)
    }

    pub(in crate::io) fn position(&mut self) -> Reason<DVec3> {
        Ok(DVec3::new(self.double()?, self.double()?, self.double()?))
    }

    pub(super) fn matrix(&mut self) -> Reason<DMat3> {
        Ok(DMat3::from_cols(self.position()?, self.position()?, self.position()?))
    }

    pub(super) fn scale(&mut self) -> Reason<f64> {
        self.double()
    }
}
