//! The crate's one error type.

use thiserror::Error;

use crate::image::Image;

/// Why a geometric value could not be made.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum GeometryError {
    /// A number is NaN or infinite.
    #[error("{what} must be finite, is {value}")]
    NotFinite {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f32,
    },
    /// A number that has to be positive is not.
    #[error("{what} must be greater than zero, is {value}")]
    NotPositive {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f32,
    },
    /// A number that may be zero, but not less, is less.
    #[error("{what} must not be negative, is {value}")]
    Negative {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f32,
    },
    /// A count of zero.
    #[error("{what} must be at least 1")]
    ZeroCount {
        /// Which count.
        what: &'static str,
    },
    /// Two slabs look in the same direction.
    #[error("two slabs share the face {face}; each face may have one")]
    DuplicateFace {
        /// The name of the face.
        face: &'static str,
    },
    /// No slab, or slabs not in the order of their faces.
    #[error("slabs must be one to six, in the order +X -X +Y -Y +Z -Z")]
    SlabOrder,
    /// A window of an image reaches beyond it, or ends before it begins.
    #[error("the window from texel {start} to {end} is not one of an image of {texels} texels")]
    Window {
        /// The first texel.
        start: u32,
        /// The texel after the last.
        end: u32,
        /// Texels of the image.
        texels: u32,
    },
    /// An index buffer or an image has a length that its shape does not allow.
    #[error("{what} has length {len}, expected {expected}")]
    Length {
        /// Which buffer.
        what: &'static str,
        /// Its length.
        len: usize,
        /// The length that was needed.
        expected: usize,
    },
    /// Two sizes that have to be equal are not.
    #[error("{what} has size {}×{}, expected {}×{}", have[0], have[1], want[0], want[1])]
    Size {
        /// What has the size.
        what: &'static str,
        /// Its size.
        have: [u32; 2],
        /// The size that was needed.
        want: [u32; 2],
    },
    /// A count above what indices in `f32` can tell apart.
    #[error("{what} is {count}, at most {max} can be told apart")]
    TooMany {
        /// Which count.
        what: &'static str,
        /// Its value.
        count: u32,
        /// The largest possible.
        max: u32,
    },
    /// A number too large to calculate with.
    #[error("{what} is {value}, beyond ±{max}")]
    TooLarge {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f32,
        /// The largest that works.
        max: f32,
    },
    /// A triangle names a vertex that does not exist.
    #[error("triangle index {index} is out of range for {vertices} vertices")]
    VertexIndex {
        /// The index.
        index: u32,
        /// How many vertices there are.
        vertices: usize,
    },
}

pub(crate) fn finite(what: &'static str, value: f32) -> Result<f32, GeometryError> {
    if value.is_finite() { Ok(value) } else { Err(GeometryError::NotFinite { what, value }) }
}

pub(crate) fn positive(what: &'static str, value: f32) -> Result<f32, GeometryError> {
    if finite(what, value)? > 0.0 { Ok(value) } else { Err(GeometryError::NotPositive { what, value }) }
}

pub(crate) fn same_size<T: Copy, U: Copy>(
    what: &'static str,
    image: &Image<T>,
    other: &Image<U>,
) -> Result<(), GeometryError> {
    let [have, want] = [[image.width(), image.height()], [other.width(), other.height()]];
    if have == want { Ok(()) } else { Err(GeometryError::Size { what, have, want }) }
}
