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
//! From the images of a slab alone, [`focus_from_images`] finds its focal plane, and [`view`] makes pictures between its cameras, to be
//! held against some that were left out: [`hold_out`].
//!
//! [`draw_frame`] draws any number of placed and tinted [`Reflector`]s and what is [`Behind`] them; [`SlabField::viewed`] shows which
//! slab answered, and which rays none holds.
//!
//! Colours are interpolated as they are stored, sRGB-encoded, as the paper's hardware did and as the GPU passes do.

#![forbid(unsafe_code)]

mod bilinear;
mod blocks;
mod cube;
mod distance;
mod focus;
mod frame;
mod gbuffer;
mod guide;
mod guided;
mod holdout;
mod lanes;
mod march;
mod mirrors;
mod palette;
mod proxy;
mod samples;
mod scene;
mod slabs;
mod surface;
mod texel;
mod views;

pub use blocks::BlockField;
pub use cube::CubeField;
pub use distance::{DistanceField, ProbeField};
pub use focus::{ImageFocus, PlaneError, focus_from_images};
pub use frame::{Environment, reflect_frame};
pub use gbuffer::{Fragment, GBuffer};
pub use guide::guide_ends;
pub use guided::GuidedField;
pub use holdout::{HoldOut, LeftOut, hold_out};
pub use proxy::{BoxCube, SphereCube};
pub use scene::{Behind, Reflector, draw_frame};
pub use slabs::{SlabField, ViewedSlabs};
pub use texel::Texel;
pub use views::{Blend, depth_planes, view};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
