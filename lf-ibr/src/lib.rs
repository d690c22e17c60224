//! CPU renderers of reflections from images: the readable twins of the GPU passes.
//!
//! A frame is made in two steps, as on the GPU. [`GBuffer::rasterize`] finds the reflector's position and normal at
//! each pixel (Fig. 5a and b of Yu, Yang & McMillan). [`reflect_frame`] mirrors the view ray there and asks an
//! [`Environment`] for the light along it:
//!
//! * [`SlabField`]: light field slabs, four bilinear fetches blended (Figs. 6 and 8 of the paper);
//! * [`BlockField`]: the same straight from BC1 blocks, many rays at a time;
//! * [`CubeField`]: an environment map, looked up by direction alone;
//! * [`SphereCube`], [`BoxCube`]: the same on a sphere or a box that stands for the scene;
//! * [`DistanceField`]: a cube that knows how far everything is; [`ProbeField`]: several of them;
//! * [`GuidedField`]: a few sharp distance cubes and a small light field of depths that says where to look in them.
//!
//! Colours are interpolated as they are stored, sRGB-encoded, as the paper's hardware did and as the GPU passes do.

#![forbid(unsafe_code)]

mod bilinear;
mod blocks;
mod cube;
mod distance;
mod frame;
mod gbuffer;
mod guide;
mod guided;
mod march;
mod proxy;
mod slabs;
mod texel;

pub use blocks::BlockField;
pub use cube::CubeField;
pub use distance::{DistanceField, ProbeField};
pub use frame::{Environment, reflect_frame};
pub use gbuffer::{Fragment, GBuffer};
pub use guide::DepthGuide;
pub use guided::GuidedField;
pub use proxy::{BoxCube, SphereCube};
pub use slabs::SlabField;
pub use texel::Texel;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
