//! Decode the number formats of files, and say how much each may have lost.

use crate::number::Real;
use crate::setting::Words;
use crate::verdict::client::Storage;
use exr::prelude::f16;

/// How a number is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    F32,
    F16,
    Unorm8,
    Unorm16,
    Unorm24,
    Snorm8,
    Snorm16,
    U8,
    U16,
    U32,
    I32,
    /// Three numbers in 32 bits, the first in the low bits, and two bits for an opacity.
    Rgb10a2,
    /// Three floats in 32 bits, without a sign, the first in the low bits.
    Rg11b10,
}

impl Words for Format {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("f32", Self::F32),
        ("f16", Self::F16),
        ("unorm8", Self::Unorm8),
        ("unorm16", Self::Unorm16),
        ("unorm24", Self::Unorm24),
        ("snorm8", Self::Snorm8),
        ("snorm16", Self::Snorm16),
        ("u8", Self::U8),
        ("u16", Self::U16),
        ("u32", Self::U32),
        ("i32", Self::I32),
        ("rgb10a2", Self::Rgb10a2),
        ("rg11b10", Self::Rg11b10),
    ];
}

/// A unit in the last place of 1 in `f32`.
pub(super) const F32_STEP: f64 = 1.0 / 8_388_608.0;
/// How much `f16` may lose of a number: a fraction, and at least this much.
pub(super) const F16_LOSS: Loss = Loss { relative: 1.0 / 1024.0, least: 1.0 / 16_777_216.0 };

/// How much the float of 10 bits may lose, the coarsest of the three.
const F10_LOSS: Loss = Loss { relative: 1.0 / 32.0, least: 1.0 / 524_288.0 };

/// How far off a stored number may be: the fraction `relative` of it, and at least `least`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Loss {
    pub(super) relative: f64,
    pub(super) least: f64,
}

impl Format {
    /// How many bytes one number takes in a raw file, or three packed ones together.
    pub(super) fn bytes(self) -> u64 {
        match self {
            Self::Unorm8 | Self::Snorm8 | Self::U8 => 1,
            Self::F16 | Self::Unorm16 | Self::Snorm16 | Self::U16 => 2,
            Self::F32 | Self::Unorm24 | Self::U32 | Self::I32 | Self::Rgb10a2 | Self::Rg11b10 => 4,
        }
    }

    /// Whether the three numbers of a pixel share their bytes.
    pub(super) fn is_packed(self) -> bool {
        matches!(self, Self::Rgb10a2 | Self::Rg11b10)
    }

    /// Decodes the low bits to a number; of packed numbers, the given component.
    pub(super) fn number(self, bits: u32, component: usize) -> f64 {
        match self {
            Self::Rgb10a2 => f64::from(bits >> (10 * component) & 0x3FF) / 1023.0,
            // The exponent has the bits of `f16`; the mantissa lacks 4 bits, in the last number 5.
            Self::Rg11b10 => {
                let [bits, missing] = match component {
                    0 | 1 => [bits >> (11 * component) & 0x7FF, 4],
                    _ => [bits >> 22, 5],
                };
                f16::from_bits((bits << missing) as u16).to_f64()
            }
            Self::F32 => f32::from_bits(bits).into(),
            Self::F16 => f16::from_bits(bits as u16).to_f64(),
            Self::Unorm8 => f64::from(bits as u8) / 255.0,
            Self::Unorm16 => f64::from(bits as u16) / 65_535.0,
            Self::Unorm24 => f64::from(bits & 0xFF_FFFF) / 16_777_215.0,
            // Two codes mean -1.
            Self::Snorm8 => (f64::from(bits as u8 as i8) / 127.0).at_least(-1.0),
            Self::Snorm16 => (f64::from(bits as u16 as i16) / 32_767.0).at_least(-1.0),
            Self::U8 => f64::from(bits as u8),
            Self::U16 => f64::from(bits as u16),
            Self::U32 => bits.into(),
            Self::I32 => f64::from(bits as i32),
        }
    }

    /// The stored number that is nearest to `value`.
    pub(super) fn nearest(self, value: f64) -> f64 {
        match (self, self.codes()) {
            (Self::F32, _) => f64::from(value as f32),
            (Self::F16, _) => f16::from_f64(value).to_f64(),
            // The file holds -1 as all bits set.
            (Self::U32, _) if (-2_147_483_648.0..0.0).contains(&value) => value + 4_294_967_296.0,
            (_, Some(codes)) => (value * codes).round() / codes,
            (_, None) => value,
        }
    }

    /// The code of 1, if the codes are equal steps of a number.
    pub(super) fn codes(self) -> Option<f64> {
        match self {
            Self::Unorm8 => Some(255.0),
            Self::Unorm16 => Some(65_535.0),
            Self::Unorm24 => Some(16_777_215.0),
            Self::Snorm8 => Some(127.0),
            Self::Snorm16 => Some(32_767.0),
            Self::Rgb10a2 => Some(1023.0),
            _ => None,
        }
    }

    /// Whether the format holds whole numbers: indices and counts.
    pub(super) fn is_whole(self) -> bool {
        matches!(self, Self::U8 | Self::U16 | Self::U32 | Self::I32)
    }

    pub(super) fn is_unorm(self) -> bool {
        matches!(self, Self::Unorm8 | Self::Unorm16 | Self::Unorm24 | Self::Rgb10a2)
    }

    /// Below this number all whole numbers are told apart.
    pub(super) fn most_whole(self) -> f64 {
        match self {
            Self::F16 => 2048.0,
            Self::F32 => 16_777_216.0,
            _ => f64::INFINITY,
        }
    }

    /// Whether a file of format `file` can hold numbers that passed through this format.
    pub(super) fn fits(self, file: Self) -> bool {
        match file {
            _ if self == file => true,
            Self::F32 => true,
            Self::F16 => matches!(self, Self::Unorm8 | Self::Snorm8) || self.is_whole(),
            Self::U8 | Self::U16 | Self::U32 | Self::I32 => self.is_unorm() || self.is_whole(),
            Self::Unorm16 => self == Self::Unorm8,
            _ => false,
        }
    }

    /// How exactly numbers are stored, after a multiplication by `scale`.
    pub(super) fn storage(self, scale: f64) -> Storage {
        match (self, self.codes()) {
            (_, Some(codes)) => Storage::Steps(scale.abs() / codes),
            (Self::F16, _) => Storage::Half,
            (Self::Rg11b10, _) => {
                let Loss { relative, least } = F10_LOSS;
                Storage::Float { relative, least }
            }
            _ => Storage::Single,
        }
    }

    /// How much storing may lose of a number that is computed from another. `f32` loses nothing
    /// that counts beside the computation, so its loss is `single`.
    pub(super) fn loss(self, single: Loss) -> Loss {
        match (self, self.codes()) {
            (_, Some(codes)) => Loss { relative: 0.0, least: 1.0 / codes },
            (Self::F16, _) => Loss { least: F16_LOSS.least.at_least(single.least), ..F16_LOSS },
            (Self::Rg11b10, _) => F10_LOSS,
            _ => single,
        }
    }

    pub(super) fn word(self) -> &'static str {
        Self::WORDS.iter().find(|(_, format)| *format == self).map_or("", |(word, _)| word)
    }
}
