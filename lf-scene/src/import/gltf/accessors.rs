//! Numbers from buffers: accessors (glTF 2.0, section 3.6.2), every access checked.

use glam::{Vec2, Vec3};
use gltf::accessor::{DataType, Dimensions};

use super::super::budget::Budget;
use super::container::Container;
use crate::ImportError;

/// Reads the accessors of a file.
pub(super) struct Accessors<'a> {
    pub(super) container: &'a Container<'a>,
    pub(super) budget: &'a mut Budget,
}

/// Whether an accessor holds its numbers itself: it has a view and no sparse part.
pub(super) fn is_plain(accessor: &gltf::Accessor<'_>) -> bool {
    accessor.view().is_some() && accessor.sparse().is_none()
}

impl Accessors<'_> {
    /// Vectors of three numbers.
    pub(super) fn vectors(&mut self, accessor: &gltf::Accessor<'_>) -> Result<Vec<Vec3>, ImportError> {
        let kind = (accessor.dimensions(), accessor.data_type());
        if kind != (Dimensions::Vec3, DataType::F32) {
            return Err(malformed(accessor, "a vector is not of three floats"));
        }
        self.read(accessor, 12, |bytes| Vec3::new(float(bytes, 0), float(bytes, 4), float(bytes, 8)))
    }

    /// Texture coordinates.
    pub(super) fn coordinates(&mut self, accessor: &gltf::Accessor<'_>) -> Result<Vec<Vec2>, ImportError> {
        match (accessor.dimensions(), accessor.data_type()) {
            (Dimensions::Vec2, DataType::F32) => {
                self.read(accessor, 8, |bytes| Vec2::new(float(bytes, 0), float(bytes, 4)))
            }
            (Dimensions::Vec2, DataType::U16) => {
                self.read(accessor, 4, |bytes| Vec2::new(short(bytes, 0), short(bytes, 2)) / 65535.0)
            }
            (Dimensions::Vec2, DataType::U8) => {
                self.read(accessor, 2, |bytes| Vec2::new(byte(bytes, 0), byte(bytes, 1)) / 255.0)
            }
            _ => Err(malformed(accessor, "texture coordinates are not of two floats, bytes or words")),
        }
    }

    /// Indices.
    pub(super) fn indices(&mut self, accessor: &gltf::Accessor<'_>) -> Result<Vec<u32>, ImportError> {
        let word = |bytes: &[u8]| {
            let mut word = [0; 4];
            word.iter_mut().zip(bytes).for_each(|(to, from)| *to = *from);
            u32::from_le_bytes(word)
        };
        match (accessor.dimensions(), accessor.data_type()) {
            (Dimensions::Scalar, DataType::U32) => self.read(accessor, 4, word),
            (Dimensions::Scalar, DataType::U16) => self.read(accessor, 2, word),
            (Dimensions::Scalar, DataType::U8) => self.read(accessor, 1, word),
            _ => Err(malformed(accessor, "indices are not whole numbers")),
        }
    }

    /// Calls `value` with the `size` bytes of each element.
    fn read<T>(
        &mut self,
        accessor: &gltf::Accessor<'_>,
        size: usize,
        value: impl Fn(&[u8]) -> T,
    ) -> Result<Vec<T>, ImportError> {
        let Some(view) = accessor.view() else { return Err(malformed(accessor, "it has no data")) };
        let stride = view.stride().unwrap_or(size);
        if stride < size {
            return Err(malformed(accessor, format!("elements of {size} bytes lie {stride} bytes apart")));
        }
        let count = accessor.count();
        let length = count.saturating_sub(1).checked_mul(stride).and_then(|last| last.checked_add(size));
        let end = length.and_then(|length| length.checked_add(accessor.offset()));
        let bytes = self.container.view(&view)?;
        let used = end.and_then(|end| bytes.get(accessor.offset()..end));
        let Some(used) = used.filter(|_| count > 0) else {
            let problem = format!("{count} elements of {size} bytes do not fit into a view of {} bytes", bytes.len());
            return Err(malformed(accessor, problem));
        };
        self.budget.take("the vertices and indices", count as u64, size_of::<T>() as u64)?;
        Ok(used.chunks(stride).map(value).collect())
    }
}

fn malformed(accessor: &gltf::Accessor<'_>, problem: impl ToString) -> ImportError {
    ImportError::malformed(format!("accessor {}", accessor.index()), problem)
}

// Elements have their full size; the fallbacks are never taken.

fn float(bytes: &[u8], at: usize) -> f32 {
    bytes.get(at..).and_then(<[u8]>::first_chunk).map_or(0.0, |four| f32::from_le_bytes(*four))
}

fn short(bytes: &[u8], at: usize) -> f32 {
    bytes.get(at..).and_then(<[u8]>::first_chunk).map_or(0.0, |two| f32::from(u16::from_le_bytes(*two)))
}

fn byte(bytes: &[u8], at: usize) -> f32 {
    bytes.get(at).map_or(0.0, |one| f32::from(*one))
}
