//! Checksums that end the files and blocks of this crate, so that a reader notices damage.
//!
//! A checksum is the CRC-32 of PNG and gzip (polynomial `0xEDB88320`, as `zlib.crc32` gives it), a
//! little-endian u32. It finds every change of up to three bits, and every change within 32
//! neighbouring bits. It is not made against forgers.

/// How many bytes a checksum has.
pub(super) const BYTES: usize = 4;

/// The checksum of some bytes.
pub(super) fn of(bytes: &[u8]) -> [u8; BYTES] {
    crc32fast::hash(bytes).to_le_bytes()
}

/// The bytes, followed by their checksum.
pub(super) fn seal(mut bytes: Vec<u8>) -> Vec<u8> {
    let sum = of(&bytes);
    bytes.extend(sum);
    bytes
}

/// The bytes before the checksum at the end; `None` if the checksum is not theirs.
pub(super) fn open(bytes: &[u8]) -> Option<&[u8]> {
    let (bytes, sum) = bytes.split_last_chunk::<BYTES>()?;
    (*sum == of(bytes)).then_some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_crc_of_zlib() {
        assert_eq!(of(b"123456789"), 0xCBF4_3926_u32.to_le_bytes());
        assert_eq!(of(b""), [0; 4]);
    }

    #[test]
    fn one_bit_is_noticed_anywhere() {
        let sealed = seal((0..99).collect());
        assert_eq!(open(&sealed), Some(&sealed[..99]));
        for bit in 0..8 * sealed.len() {
            let mut flipped = sealed.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(open(&flipped), None, "bit {bit}");
        }
        (0..sealed.len()).for_each(|end| assert_eq!(open(&sealed[..end]), None, "{end}"));
    }
}
