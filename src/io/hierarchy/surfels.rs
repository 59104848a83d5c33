//! The file of a node's surfels, see the [module](super).

use super::bytes::{Hash, Reader, Writer, check_magic, checked};
use crate::error::{Error, Result};
use crate::io::replace::write_atomically;
use crate::io::{Reason, checksum, input};
use crate::memory;
use crate::number::srgb;
use crate::scene::Cloud;
use crate::scene::objects::detail::prefix::Estimate;
use crate::source::hierarchy::Numbers;
use crate::source::sampler::estimate;
use glam::{DVec3, Vec3};
use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

const MAGIC: &[u8; 16] = b"splatref blue 2\n";
/// Bytes before the surfels, the checksum included.
const HEADER: u64 = 68;
/// How many surfels have one checksum.
const BLOCK: u32 = 1024;
/// Bytes of a surfel without further properties, of one property; and of both in memory, with the
/// file's bytes.
const BYTES: u64 = 20;
const PROPERTY: u64 = 4;
const IN_MEMORY: [u64; 2] = [BYTES + 40, 2 * PROPERTY];

/// The bytes of a surfel with `further` properties.
pub(super) fn size(further: usize) -> u64 {
    BYTES + PROPERTY * further as u64
}

/// The bytes of `count` surfels of `size` bytes, with the checksums of their blocks.
fn body_size(count: u32, size: u64) -> u64 {
    let sums = u64::from(count.div_ceil(BLOCK)) * checksum::BYTES as u64;
    u64::from(count).saturating_mul(size).saturating_add(sums)
}

/// The contents of a file's header.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Header {
    pub(super) node: u32,
    pub(super) count: u32,
    pub(super) estimate: Estimate,
}

/// The path of a node's surfels.
pub(super) fn path(folder: &Path, node: u32) -> PathBuf {
    folder.join(format!("surfels-{node}"))
}

/// Writes the surfels of a node: positions, normals, colours, and opacities and properties if there
/// are any.
pub(super) fn write(folder: &Path, hash: &Hash, node: u32, cloud: &Cloud) -> Result<()> {
    let count = cloud.position.len();
    let mut body = Writer(Vec::with_capacity(count * size(cloud.properties.len()) as usize));
    let (normal, color) = (cloud.normal.as_deref(), cloud.color.as_deref());
    let (normal, color) = (normal.unwrap_or_default(), color.unwrap_or_default());
    for (i, ((p, n), c)) in cloud.position.iter().zip(normal).zip(color).enumerate() {
        body.vector(*p);
        encode_normal(*n).iter().for_each(|code| body.bytes(&code.to_le_bytes()));
        body.bytes(&encode_color(*c));
        body.bytes(&[encode_opacity(cloud.opacity.as_ref().map_or(1.0, |all| all[i]))]);
        cloud.properties.iter().for_each(|one| body.float(one.values[i]));
    }
    // Use the normals that a reader will decode.
    let normals: Vec<Vec3> = normal.iter().map(|n| decode_normal(encode_normal(*n))).collect();
    let Estimate { count: p_m, distance } = estimate(&cloud.position, &normals);
    let mut header = Writer::default();
    header.bytes(MAGIC);
    header.bytes(hash);
    header.words(&[node, count as u32, p_m]);
    header.float(distance);
    write_atomically(&path(folder, node), |to| {
        to.write_all(&checksum::seal(header.0))?;
        for block in body.0.chunks(BLOCK as usize * size(cloud.properties.len()) as usize) {
            to.write_all(block)?;
            to.write_all(&checksum::of(block))?;
        }
        Ok(())
    })
}

/// Reads the header, if there is a complete and undamaged file for this hierarchy, this node and
/// this number of further properties.
pub(super) fn header(
    folder: &Path,
    hash: &Hash,
    node: u32,
    further: usize,
) -> Result<Option<Header>> {
    let path = path(folder, node);
    if !path.exists() {
        return Ok(None);
    }
    let bytes = input::bytes(&path).map_err(|source| Error::io(&path, source))?;
    let Some((first, body)) = bytes.split_first_chunk() else { return Ok(None) };
    let size = size(further);
    let header = parse(first, bytes.len() as u64, size, hash).ok();
    let whole = |_: &Header| blocks(body, size).all(|block| block.is_ok());
    Ok(header.filter(|header| header.node == node).filter(whole))
}

/// The blocks of surfels in the bytes after the header, without their checksums.
fn blocks(body: &[u8], size: u64) -> impl Iterator<Item = Reason<&[u8]>> {
    body.chunks(body_size(BLOCK, size) as usize).map(checked)
}

fn parse(bytes: &[u8; HEADER as usize], length: u64, size: u64, hash: &Hash) -> Reason<Header> {
    check_magic(bytes, MAGIC, "a surfel file")?;
    let mut rest = Reader(checked(bytes)?);
    rest.take::<16>()?;
    if &rest.take::<32>()? != hash {
        return Err("the surfels belong to another hierarchy than the index".into());
    }
    let [node, count, p_m] = rest.words()?;
    let estimate = Estimate { count: p_m, distance: rest.float()? };
    let expected = HEADER.saturating_add(body_size(count, size));
    if length != expected {
        return Err(format!("{count} surfels need {expected} bytes, but the file has {length}"));
    }
    check(estimate, count)?;
    Ok(Header { node, count, estimate })
}

/// Checks that an estimate is possible for this number of surfels.
pub(super) fn check(estimate: Estimate, count: u32) -> Reason<()> {
    let Estimate { count: p_m, distance } = estimate;
    if p_m > count || (p_m == 0) != (count == 0) || !(0.0..f32::INFINITY).contains(&distance) {
        return Err(format!("p_m = {p_m} and r_m = {distance} of {count} surfels"));
    }
    Ok(())
}

/// Reads a range of the surfels of a node, as far as there are some; the header must agree with the index.
pub(super) fn read(
    folder: &Path,
    hash: &Hash,
    expected: &Header,
    numbers: &Numbers,
    range: Range<u32>,
) -> Result<Cloud> {
    let path = path(folder, expected.node);
    let io = |source| Error::io(&path, source);
    let (mut file, length) = input::open(&path).map_err(io)?;
    let mut bytes = [0; HEADER as usize];
    if length < HEADER {
        return Err(Error::format(&path, format!("the file is truncated after {length} bytes")));
    }
    file.read_exact(&mut bytes).map_err(io)?;
    let size = size(numbers.properties.len());
    let found = parse(&bytes, length, size, hash).map_err(|what| Error::format(&path, what))?;
    if found != *expected {
        return Err(Error::format(&path, "the surfels belong to another index"));
    }
    body(file, found.count, range, numbers).map_err(|error| match error {
        Error::Io { source, .. } => io(source),
        Error::Invalid(what) => Error::format(&path, what),
        other => other,
    })
}

/// Reads a range of `total` surfels, in whole blocks.
fn body(mut file: File, total: u32, range: Range<u32>, numbers: &Numbers) -> Result<Cloud> {
    let further = numbers.properties.len();
    let end = total.min(range.end);
    let start = range.start.min(end);
    let first = start / BLOCK * BLOCK;
    let count = end - start;
    let read = total.min(end.div_ceil(BLOCK).saturating_mul(BLOCK)) - first;
    let in_memory = IN_MEMORY[0] + IN_MEMORY[1] * further as u64;
    memory::ask(u64::from(read) * in_memory, || format!("{count} surfels"))?;
    let size = size(further);
    let before = SeekFrom::Start(HEADER + body_size(first, size));
    file.seek(before).map_err(|source| Error::io(Path::new(""), source))?;
    let mut bytes = vec![0; body_size(read, size) as usize];
    file.read_exact(&mut bytes).map_err(|source| Error::io(Path::new(""), source))?;
    let blocks = blocks(&bytes, size).collect::<Reason<Vec<_>>>().map_err(Error::Invalid)?;
    let table = srgb::table(255);
    let count = count as usize;
    let [mut position, mut normal, mut color] = [(); 3].map(|()| Vec::with_capacity(count));
    let (mut opacity, mut properties) = (numbers.opacity.then(Vec::new), numbers.of_none());
    let surfels = blocks.iter().flat_map(|block| block.chunks_exact(size as usize));
    for surfel in surfels.skip((start - first) as usize).take(count) {
        let mut rest = Reader(surfel);
        position.push(rest.vector().map_err(Error::Invalid)?);
        let [u, v] = [rest.take(), rest.take()].map(|code| code.map(i16::from_le_bytes));
        normal.push(decode_normal([u.map_err(Error::Invalid)?, v.map_err(Error::Invalid)?]));
        let [r, g, b] = rest.take().map_err(Error::Invalid)?.map(|code| table[usize::from(code)]);
        color.push(Vec3::new(r, g, b));
        let [code] = rest.take().map_err(Error::Invalid)?;
        opacity.iter_mut().for_each(|all| all.push(decode_opacity(code)));
        for one in &mut properties {
            one.values.push(rest.float().map_err(Error::Invalid)?);
        }
    }
    if let Some(at) = position.iter().position(|p: &Vec3| !p.is_finite()) {
        let at = start as usize + at;
        return Err(Error::Invalid(format!("surfel {at} has no finite position")));
    }
    let (normal, color) = (Some(normal), Some(color));
    Ok(Cloud { position, normal, color, opacity, properties, ..Cloud::default() })
}

fn sign(v: f64) -> f64 {
    if v < 0.0 { -1.0 } else { 1.0 }
}

fn encode_normal(normal: Vec3) -> [i16; 2] {
    let n = normal.as_dvec3();
    let s = (n.x.abs() + n.y.abs()) + n.z.abs();
    let (mut a, mut b) = (n.x / s, n.y / s);
    if n.z < 0.0 {
        (a, b) = ((1.0 - b.abs()) * sign(a), (1.0 - a.abs()) * sign(b));
    }
    [a, b].map(|v| (32767.0 * v + 0.5).floor() as i16)
}

fn decode_normal(codes: [i16; 2]) -> Vec3 {
    let [a, b] = codes.map(|code| f64::from(code) / 32767.0);
    let z = (1.0 - a.abs()) - b.abs();
    let t = if z < 0.0 { -z } else { 0.0 };
    let (x, y) = (a - t * sign(a), b - t * sign(b));
    let length = ((x * x + y * y) + z * z).sqrt();
    (DVec3::new(x, y, z) / length).as_vec3() + Vec3::ZERO
}

fn encode_color(color: Vec3) -> [u8; 3] {
    let code = |v: f32| {
        let v = f64::from(v);
        let v = if v > 1.0 { 1.0 } else { v };
        // The cast turns numbers below 0 into 0.
        (255.0 * srgb::from_linear(v) + 0.5).floor() as u8
    };
    [code(color.x), code(color.y), code(color.z)]
}

fn encode_opacity(opacity: f32) -> u8 {
    (255.0 * f64::from(opacity) + 0.5).floor() as u8
}

fn decode_opacity(code: u8) -> f32 {
    (f64::from(code) / 255.0) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn normals_come_back(v in prop::array::uniform3(-1.0_f32..1.0), flat in 0_usize..4) {
            let mut v = Vec3::from_array(v);
            if flat < 3 {
                v[flat] = 0.0;
            }
            prop_assume!(v.length() > 1e-3);
            let n = v.normalize();
            let back = decode_normal(encode_normal(n));
            prop_assert!((back.length() - 1.0).abs() < 1e-6);
            prop_assert!((back - n).length() < 1e-4, "{} {}", n, back);
            let again = decode_normal(encode_normal(back));
            prop_assert!((again - back).length() < 1e-6, "once is for all but rounding");
        }
    }

    #[test]
    fn axes_are_exact_and_no_code_is_without_a_direction() {
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            for n in [axis, -axis] {
                assert_eq!(decode_normal(encode_normal(n)), n);
            }
        }
        for codes in [[i16::MIN, i16::MIN], [i16::MIN, 0], [i16::MAX, i16::MAX], [0, 0]] {
            assert!((decode_normal(codes).length() - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn colours_are_those_of_eight_bits() {
        let table = srgb::table(255);
        for code in 0..=255_u8 {
            let value = table[usize::from(code)];
            assert_eq!(encode_color(Vec3::splat(value)), [code, code, code]);
            assert_eq!(encode_opacity(decode_opacity(code)), code);
        }
        assert_eq!(encode_color(Vec3::new(7.0, 0.0, 1.0)), [255, 0, 255]);
        assert_eq!([0.0, 0.5, 1.0].map(encode_opacity), [0, 128, 255]);
    }
}
