//! What is captured, and into which tiles it is cut.

use std::cmp::Reverse;
use std::io::Cursor;

use lf_compress::PackOptions;
use lf_compress::volume::cameras_per_tile;
use lf_format::{Contents, FormatError, Metadata, SlabTiling, TexelEncoding, Writer};
use lf_math::{Coverage, LightFieldGeometry, NeededTexels};
use lf_scene::{FocusRule, Tracer, focus_by};

use crate::error::CaptureError;
use crate::identity;

/// The metadata entry of a depth file that says what its texels are.
const DEPTH_KEY: &str = "lfslab.texels";
const DEPTH_TEXT: &str = "inverse depth of what the middle ray of each texel meets: 1/m along the axis of the face from the \
    camera plane, negative behind it, at most 65504 either way, 0 if nothing is met; red, green and blue alike";

/// How a light field is captured and stored.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Rays per texel and axis.
    pub grid: u32,
    /// How texels are stored: BC1 or RGBA8.
    pub encoding: TexelEncoding,
    /// How texels become blocks.
    pub pack: PackOptions,
    /// Trace and store everything, also what no ray through the cell asks for.
    pub whole: bool,
    /// Capture inverse depths beside the radiance.
    pub depth: bool,
}

/// A tile of the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TileId {
    /// Position of the slab in the geometry.
    pub slab: usize,
    /// The tile's number in the slab.
    pub tile: u32,
}

/// Everything that decides the bytes of the captured file.
#[derive(Debug, Clone)]
pub struct Plan {
    pub(crate) geometry: LightFieldGeometry,
    pub(crate) options: Options,
    pub(crate) metadata: Metadata,
    /// What the scene looks like, as a number.
    pub(crate) scene: u64,
    tilings: Vec<SlabTiling>,
    depth_tilings: Option<Vec<SlabTiling>>,
}

impl Plan {
    /// Surveys a scene: finds the focal planes ([`focus`](lf_scene::focus)), and with them what is needed of each image.
    ///
    /// # Errors
    /// If the encoding is not for 8-bit texels, or a slab or its tiles are too large.
    pub fn survey(
        tracer: &Tracer,
        geometry: &LightFieldGeometry,
        options: Options,
        metadata: Metadata,
    ) -> Result<Self, CaptureError> {
        Self::survey_by(tracer, geometry, FocusRule::default(), options, metadata)
    }

    /// As [`Self::survey`], with focal planes by a rule of the caller's choice.
    ///
    /// # Errors
    /// As there; also if a focal plane is not in front of the camera planes.
    pub fn survey_by(
        tracer: &Tracer,
        geometry: &LightFieldGeometry,
        rule: FocusRule,
        options: Options,
        metadata: Metadata,
    ) -> Result<Self, CaptureError> {
        let geometry = focus_by(tracer, geometry, rule)?;
        let scene = identity::of_scene(tracer, &geometry);
        Self::new(geometry, options, metadata, scene)
    }

    pub(crate) fn new(
        geometry: LightFieldGeometry,
        options: Options,
        metadata: Metadata,
        scene: u64,
    ) -> Result<Self, CaptureError> {
        if !matches!(options.encoding, TexelEncoding::Bc1 | TexelEncoding::Rgba8) {
            return Err(CaptureError::Encoding(options.encoding));
        }
        let tilings = cut(&geometry, options.encoding, options.whole)?;
        let depth = || cut(&geometry, TexelEncoding::Rgb16F, options.whole);
        let depth_tilings = options.depth.then(depth).transpose()?;
        let plan = Self { geometry, options, metadata, scene, tilings, depth_tilings };
        plan.check()?;
        Ok(plan)
    }

    /// Begins the files in memory: what cannot be written is known before the work.
    fn check(&self) -> Result<(), CaptureError> {
        let begin = |tilings: &[SlabTiling], metadata| {
            let contents = Contents::new(self.geometry.clone(), tilings.to_vec(), metadata);
            Writer::new(Cursor::new(Vec::new()), contents).map(|_| ())
        };
        begin(&self.tilings, self.metadata.clone())?;
        self.depth_tilings.as_ref().map_or(Ok(()), |tilings| Ok(begin(tilings, self.depth_metadata()?)?))
    }

    /// Cell and slabs, with their focal planes.
    #[must_use]
    pub fn geometry(&self) -> &LightFieldGeometry {
        &self.geometry
    }

    /// How it is captured and stored.
    #[must_use]
    pub fn options(&self) -> &Options {
        &self.options
    }

    /// How each slab is cut into tiles.
    #[must_use]
    pub fn tilings(&self) -> &[SlabTiling] {
        &self.tilings
    }

    /// How each slab of inverse depths is cut, if they are captured: into the same tiles.
    #[must_use]
    pub fn depth_tilings(&self) -> Option<&[SlabTiling]> {
        self.depth_tilings.as_deref()
    }

    /// All tiles, the largest first. In this order they are worked on, so that the last ones are short, and dealt out to shards, so that
    /// all have about as much to do.
    #[must_use]
    pub fn tiles(&self) -> Vec<TileId> {
        let slabs = self.tilings.iter().enumerate();
        let stored = slabs.flat_map(|(slab, tiling)| tiling.stored_tiles().map(move |tile| TileId { slab, tile }));
        let mut tiles: Vec<TileId> = stored.collect();
        tiles.sort_by_key(|id| (Reverse(self.tilings[id.slab].raw_len(id.tile)), *id));
        tiles
    }

    /// Texels of all images, stored or not.
    #[must_use]
    pub fn all_texels(&self) -> u64 {
        let of_slab = |slab: &lf_math::Slab| {
            slab.cameras().into_iter().chain(slab.resolution()).map(u64::from).fold(1, u64::saturating_mul)
        };
        self.geometry.slabs().iter().map(of_slab).fold(0, u64::saturating_add)
    }

    /// Rays that a texel's radiance takes.
    #[must_use]
    pub fn rays_per_texel(&self) -> u64 {
        u64::from(self.options.grid.max(1)).pow(2)
    }

    /// What is needed of each slab; `None` if everything is traced.
    pub(crate) fn needed(&self) -> Option<Vec<NeededTexels>> {
        let of_slab = |slab| NeededTexels::of_cell(slab, self.geometry.cell());
        (!self.options.whole).then(|| self.geometry.slabs().iter().map(of_slab).collect())
    }

    /// What the file of inverse depths says of itself.
    pub(crate) fn depth_metadata(&self) -> Result<Metadata, FormatError> {
        let mut metadata = self.metadata.clone();
        metadata.insert(DEPTH_KEY, DEPTH_TEXT)?;
        Ok(metadata)
    }
}

fn cut(geometry: &LightFieldGeometry, encoding: TexelEncoding, whole: bool) -> Result<Vec<SlabTiling>, FormatError> {
    let tiling = |slab| {
        let coverage = if whole { Coverage::whole(slab) } else { Coverage::of_cell(slab, geometry.cell()) };
        SlabTiling::covering(slab, encoding, cameras_per_tile(&coverage), coverage)
    };
    geometry.slabs().iter().map(tiling).collect()
}
