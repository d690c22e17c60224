//! Scenes, a ray tracer and the capture of environment light fields: the independent oracle of the other crates.
//!
//! A [`Scene`] is triangles with textured materials, lights and an environment, made in code ([`EMBEDDED`]) or read from glTF
//! ([`import_gltf`]). A [`Tracer`] answers one ray at a time. From it come the texels of slabs ([`TexelSampler`], [`capture_slabs`]), cube
//! maps ([`trace_cube`], [`capture_cube`]) and the reference pictures ([`mod@reference`]).
//! [`rasterised()`] makes triangles with light at their corners of it, [`reflectors`] holds the objects to look at.
//!
//! # The tracer
//!
//! [`Quality`] says which light is traced: direct light over an ambient term, or all light by path tracing with next-event
//! estimation, multiple importance sampling and Russian roulette. Light comes from points, spots and suns, glowing triangles and
//! the [`Environment`]; surfaces are diffuse, glTF 2.0's metallic-roughness (GGX), mirrors and clear glass ([`Scattering`]), with holes
//! where a picture's alpha says so. Every answer comes with an upper bound of its standard error ([`Estimate`]).
//!
//! An answer is a function of scene, [`Quality`] and ray: the random numbers of a sample are a function of seed, sample and ray. Hits are
//! watertight, and rays leave surfaces from where rounding cannot bring them back, so that neither the unit of length nor the distance
//! from the origin matters (a power of two changes no bit of the radiance). Origins of rays should be within about the largest coordinate of
//! the scene; from farther away a ray may miss an edge.
//!
//! Not traced: rough glass, light through glass on its way to a point or a sun (glass casts a shadow; what passes it is found from the
//! other side, for lights with extent), dispersion, polarisation, media.
//!
//! World space is glTF's: right-handed, +Y up, metres; colour is linear Rec. 709. Radiance is in W/(m²·sr).

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
mod rasterised;
pub mod reference;
pub mod reflectors;
mod rounded;
mod scene;
mod surface_point;
mod tracer;
mod view;

pub use capture::{Capture, TexelSampler, capture_inverse_depths, capture_slabs};
pub use cube::{capture_cube, capture_distance_cube, capture_mirror_cube, trace_cube};
pub use embedded::{EMBEDDED, EmbeddedScene, beside, corridor, forest, mirror_box, museum};
pub use environment::{Environment, EnvironmentMap};
pub use error::{ImportError, SceneError};
pub use focus::{FocusRule, focus, focus_by};
pub use free_space::{FreeSpace, find_free_space, is_free};
pub use import::{
    ImportOptions, Imported, ImportedEnvironment, ImportedMesh, SceneCamera, import_environment, import_gltf,
    import_gltf_slice, import_obj,
};
pub use light::{Illuminant, Light, Lighting};
pub use material::{ColorEncoding, Material, Pattern, Scattering, Surface, Texture};
pub use quality::{Estimate, Illumination, Quality};
pub use rasterised::rasterised;
pub use scene::{Scene, SceneBuilder, Vertex};
pub use tracer::{Traced, Tracer};
pub use view::view;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
