//! Scenes, a ray tracer and the capture of environment light fields: the independent oracle of the other crates.
//!
//! A [`Scene`] is triangles with textured diffuse or emissive materials and simple lights, made in code
//! ([`EMBEDDED`]) or read from glTF ([`import_gltf`]). A [`Tracer`] answers one ray at a time. From it come the texels of
//! slabs ([`TexelSampler`], [`capture_slabs`]), cube maps ([`trace_cube`], [`capture_cube`]) and the reference pictures ([`mod@reference`]).
//! [`reflectors`] holds the objects to look at.
//!
//! Shading is direct light only: point lights and a sun with hard shadows over an ambient term. World space is glTF's:
//! right-handed, +Y up, metres; colour is linear Rec. 709.

#![forbid(unsafe_code)]

mod bsdf;
mod bvh;
mod capture;
#[cfg(test)]
mod chi_square;
mod cube;
mod distribution;
mod embedded;
mod emitters;
mod environment;
mod error;
mod focus;
mod free_space;
mod ggx;
mod import;
mod light;
mod material;
mod path;
mod quality;
mod random;
pub mod reference;
pub mod reflectors;
mod rounded;
mod scene;
mod surface_point;
mod tracer;
mod view;

pub use capture::{Capture, TexelSampler, capture_slabs};
pub use cube::{capture_cube, trace_cube};
pub use embedded::{EMBEDDED, EmbeddedScene, beside, corridor, forest, mirror_box, museum};
pub use environment::{Environment, EnvironmentMap};
pub use error::{ImportError, SceneError};
pub use focus::focus;
pub use free_space::{FreeSpace, find_free_space, is_free};
pub use import::{
    ImportOptions, Imported, ImportedEnvironment, SceneCamera, import_environment, import_gltf, import_gltf_slice,
    import_obj,
};
pub use light::{Illuminant, Light, Lighting};
pub use material::{ColorEncoding, Material, Pattern, Scattering, Surface, Texture};
pub use quality::{Estimate, Illumination, Quality};
pub use scene::{Scene, SceneBuilder, Vertex};
pub use tracer::{Traced, Tracer};
pub use view::view;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
