//! Geometry of environment light fields: the pure mathematics behind reflections looked up in images.
//!
//! A reflective object moves inside a box, the [`Cell`]. The light that reaches the cell from outside is stored in up
//! to six [`Slab`]s, one per [`Face`] direction; each is a grid of cameras on a plane, each camera a small image indexed
//! by ray direction. [`LightFieldGeometry::index_ray`] turns a ray into a slab and real-valued sample indices
//! (s′, t′, u′, v′); [`Slab::taps`] turns those into four cameras, four image positions and four weights.
//!
//! The method is that of Yu, Yang & McMillan, *Real-Time Reflection Mapping with Parallax* (I3D 2005), cited below as
//! "the paper". Its letters are kept: **(s, t) is the camera plane, (u, v) the image**. (Levoy and Hanrahan's
//! LightPack uses them the other way round.)
//!
//! Everything here works in **cell space**: world axes and metres, origin at the cell's centre, so that a cell far from
//! the world's origin loses no precision. There is no input or output and no thread. Without the default feature `std` the crate needs only `alloc`.

#![cfg_attr(not(feature = "std"), no_std)]
#![forbid(unsafe_code)]

extern crate alloc;

mod axis;
mod cell;
mod color;
mod coverage;
mod cube;
mod distance_cube;
mod error;
mod face;
mod filter;
mod flip;
mod geometry;
mod image;
mod lit_mesh;
mod mesh;
mod metrics;
mod needed;
mod normal_map;
mod pinhole;
mod placement;
mod ray;
mod reflectance;
mod scale;
mod shadow;
mod slab;
mod sphere;
mod ssim;
mod texels;
mod view;
mod windows;

pub use axis::SampledAxis;
pub use cell::Cell;
pub use color::{linear_from_srgb, srgb_from_linear, srgb8_from_linear};
pub use coverage::Coverage;
pub use cube::{CubeCoord, CubeMap, cube_coord, cube_direction};
pub use distance_cube::{DistanceCube, Search};
pub use error::GeometryError;
pub use face::Face;
pub use flip::flip;
pub use geometry::{IndexedRay, LightFieldGeometry, PlanePlacement};
pub use image::Image;
pub use lit_mesh::LitMesh;
pub use mesh::TriangleMesh;
pub use metrics::{ImageError, VisibleError, image_error, visible_error};
pub use needed::{NeededImage, NeededTexels};
pub use normal_map::NormalMap;
pub use pinhole::{Pinhole, near_plane};
pub use placement::Placement;
pub use ray::{Ray, normalized, reflect};
pub use reflectance::Reflectance;
pub use scale::{length, triangle_normal};
pub use slab::{CameraTap, Slab, SlabCoord};
pub use sphere::sphere_exit;
pub use ssim::ssim;
pub use texels::{ImageWindow, SlabTexels};
pub use view::View;
pub use windows::Windows;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
