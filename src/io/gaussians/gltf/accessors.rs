//! Read the numbers of accessors: of any component type, with strides, sparse or absent.

use super::buffers::{Buffers, missing, part};
use super::json::{Accessor, Document, Sparse};
use crate::io::Reason;
use crate::memory;
use crate::number::Real;

/// Component types by their codes.
const I8: u32 = 5120;
const U8: u32 = 5121;
const I16: u32 = 5122;
const U16: u32 = 5123;
const U32: u32 = 5125;
pub(super) const F32: u32 = 5126;

/// The component types that an attribute may have beside float.
#[derive(Clone, Copy)]
pub(super) enum Allowed {
    Float,
    /// Normalized signed integers.
    Signed,
    /// Normalized unsigned integers.
    Unsigned,
    /// Unsigned integers, normalized or not.
    AnyUnsigned,
    /// Integers of 8 and 16 bits, normalized or not.
    Any,
}

impl Allowed {
    fn has(self, component: u32, normalized: bool) -> bool {
        let (signed, unsigned) = (matches!(component, I8 | I16), matches!(component, U8 | U16));
        component == F32
            || match self {
                Self::Float => false,
                Self::Signed => signed && normalized,
                Self::Unsigned => unsigned && normalized,
                Self::AnyUnsigned => unsigned,
                Self::Any => signed || unsigned,
            }
    }
}

/// The numbers of a document.
pub(super) struct Accessors<'a> {
    pub(super) document: &'a Document,
    pub(super) buffers: &'a Buffers<'a>,
}

impl Accessors<'_> {
    /// The accessor with this index.
    pub(super) fn get(&self, index: usize) -> Reason<&Accessor> {
        self.document.accessors.get(index).ok_or_else(|| missing("accessor", index))
    }

    /// The elements of an accessor of `N` components: each decoded in f64, and rounded once.
    pub(super) fn read<const N: usize>(
        &self,
        index: usize,
        allowed: Allowed,
    ) -> Reason<Vec<[f32; N]>> {
        let accessor = self.get(index)?;
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][N - 1];
        if accessor.kind != kind {
            let found = &accessor.kind;
            return Err(format!("accessor {index} has the type {found:?}, but must be {kind}"));
        }
        let component = component(accessor, index)?;
        if !allowed.has(accessor.component_type, accessor.normalized) {
            let word = if accessor.normalized { "normalized " } else { "" };
            let name = component.name;
            return Err(format!(
                "accessor {index} has the component type {word}{name}, which its attribute may not \
                 have; export it as float"
            ));
        }
        // A Gaussian without a byte in any buffer has no rotation.
        if accessor.count > self.buffers.total() {
            return Err(format!(
                "accessor {index} has {} elements, more than the file has bytes: it is damaged",
                accessor.count
            ));
        }
        let bytes = accessor.count * 4 * N as u64;
        memory::try_ask(bytes, || format!("{} numbers of Gaussians", accessor.count))?;
        let mut all = match accessor.buffer_view {
            None => vec![[0.0; N]; accessor.count as usize],
            Some(view) => {
                let (bytes, stride) = self.buffers.view(self.document, view)?;
                let (offset, count) = (accessor.byte_offset, accessor.count);
                elements(bytes, offset, count, stride, component).ok_or_else(|| {
                    format!(
                        "accessor {index} reaches beyond buffer view {view}: the file is damaged"
                    )
                })?
            }
        };
        if let Some(sparse) = &accessor.sparse {
            self.replace(sparse, component, &mut all)
                .map_err(|what| format!("accessor {index}, sparse: {what}"))?;
        }
        Ok(all)
    }

    /// Puts the sparse elements in their places.
    fn replace<const N: usize>(
        &self,
        sparse: &Sparse,
        component: Component,
        all: &mut [[f32; N]],
    ) -> Reason<()> {
        let (indices, values) = (&sparse.indices, &sparse.values);
        let damaged = || String::from("it reaches beyond its buffer view: the file is damaged");
        let (bytes, _) = self.buffers.view(self.document, indices.buffer_view)?;
        let size = match indices.component_type {
            U8 => 1,
            U16 => 2,
            U32 => 4,
            other => {
                return Err(format!("indices of component type {other}; give 5121, 5123 or 5125"));
            }
        };
        let length = sparse.count.checked_mul(size).ok_or_else(damaged)?;
        let indices = part(bytes, indices.byte_offset, length).ok_or_else(damaged)?;
        let (bytes, stride) = self.buffers.view(self.document, values.buffer_view)?;
        let (offset, count) = (values.byte_offset, sparse.count);
        let values: Vec<[f32; N]> =
            elements(bytes, offset, count, stride, component).ok_or_else(damaged)?;
        for (index, value) in indices.chunks_exact(size as usize).zip(values) {
            let mut four = [0; 4];
            four[..index.len()].copy_from_slice(index);
            let index = u32::from_le_bytes(four);
            let count = all.len();
            let place = all
                .get_mut(index as usize)
                .ok_or_else(|| format!("index {index} of {count} elements: the file is damaged"))?;
            *place = value;
        }
        Ok(())
    }
}

/// How a component is stored.
#[derive(Clone, Copy)]
struct Component {
    name: &'static str,
    size: usize,
    decode: fn(&[u8]) -> f64,
    /// What normalized numbers are divided by.
    divisor: Option<f64>,
}

fn component(accessor: &Accessor, index: usize) -> Reason<Component> {
    fn bytes<const N: usize>(bytes: &[u8]) -> [u8; N] {
        bytes.first_chunk().copied().unwrap_or([0; N])
    }
    let (name, size, decode, most): (_, _, fn(&[u8]) -> f64, f64) = match accessor.component_type {
        I8 => ("byte", 1, |b| f64::from(i8::from_le_bytes(bytes(b))), 127.0),
        U8 => ("unsigned byte", 1, |b| f64::from(u8::from_le_bytes(bytes(b))), 255.0),
        I16 => ("short", 2, |b| f64::from(i16::from_le_bytes(bytes(b))), 32767.0),
        U16 => ("unsigned short", 2, |b| f64::from(u16::from_le_bytes(bytes(b))), 65535.0),
        U32 => ("unsigned int", 4, |b| f64::from(u32::from_le_bytes(bytes(b))), 4_294_967_295.0),
        F32 => ("float", 4, |b| f64::from(f32::from_le_bytes(bytes(b))), 1.0),
        other => {
            return Err(format!(
                "accessor {index} has the component type {other}, which glTF has not"
            ));
        }
    };
    let divisor = (accessor.normalized && accessor.component_type != F32).then_some(most);
    Ok(Component { name, size, decode, divisor })
}

/// `count` elements from `offset` on; `None` if there are fewer.
fn elements<const N: usize>(
    bytes: &[u8],
    offset: u64,
    count: u64,
    stride: Option<u64>,
    component: Component,
) -> Option<Vec<[f32; N]>> {
    let Component { size, decode, divisor, .. } = component;
    let own = (N * size) as u64;
    let stride = stride.filter(|&stride| stride > 0).unwrap_or(own);
    if stride < own {
        return None;
    }
    if count == 0 {
        return Some(Vec::new());
    }
    let length = (count - 1).checked_mul(stride)?.checked_add(own)?;
    let bytes = part(bytes, offset, length)?;
    let number = |bytes: &[u8]| {
        let value = decode(bytes);
        match divisor {
            None => value as f32,
            // The least signed code is beyond -1.
            Some(divisor) => (value / divisor).at_least(-1.0) as f32,
        }
    };
    let element = |row: &[u8]| std::array::from_fn(|i| number(&row[i * size..]));
    Some(bytes.chunks(stride as usize).map(element).collect())
}
