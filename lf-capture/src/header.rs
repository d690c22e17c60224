//! How a journal says what it belongs to: a plan and a shard as JSON.

use std::collections::BTreeMap;

use glam::{DVec3, Vec3};
use lf_compress::PackOptions;
use lf_format::{Metadata, TexelEncoding};
use lf_math::{Cell, Face, GeometryError, LightFieldGeometry, SampledAxis, Slab};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::error::CaptureError;
use crate::identity;
use crate::plan::{Options, Plan};
use crate::shard::Shard;

/// Whatever decides the bytes of the tiles, under the names that messages use.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Header {
    /// The version of this crate.
    program: String,
    /// The kind of machine; tiles of two kinds may differ in their last bits.
    machine: String,
    /// What the scene looks like.
    scene: String,
    shard: u32,
    shards: u32,
    rays_per_texel_and_axis: u32,
    encoding: String,
    /// How texels become blocks.
    quality: String,
    error_for_bits: String,
    whole: bool,
    depth: bool,
    metadata: BTreeMap<String, String>,
    cell: CellText,
    slabs: Vec<SlabText>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct CellText {
    center: [f64; 3],
    half_extent: [f32; 3],
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct SlabText {
    face: u8,
    plane: f32,
    /// Along s, t, u and v.
    axes: [AxisText; 4],
    focal_depth: Option<f32>,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct AxisText {
    first: f32,
    step: f32,
    count: u32,
}

/// Samples that an axis may have in a file.
const MAX_COUNT: u32 = 1 << 16;

const ENCODINGS: [(&str, TexelEncoding); 2] = [("bc1", TexelEncoding::Bc1), ("rgba8", TexelEncoding::Rgba8)];

impl Header {
    pub(crate) fn new(plan: &Plan, shard: Shard) -> Self {
        let (options, cell) = (plan.options, plan.geometry.cell());
        let encoding = ENCODINGS.into_iter().find(|(_, encoding)| *encoding == options.encoding);
        let PackOptions { quality, rdo } = options.pack;
        Self {
            program: concat!("lf-capture ", env!("CARGO_PKG_VERSION")).to_owned(),
            machine: identity::of_machine(),
            scene: format!("{:016x}", plan.scene),
            shard: shard.number(),
            shards: shard.count(),
            rays_per_texel_and_axis: options.grid,
            encoding: encoding.map_or(String::new(), |(name, _)| name.to_owned()),
            quality: quality.name().to_owned(),
            error_for_bits: format!("{} of at most {}", rdo.lambda, rdo.max_loss),
            whole: options.whole,
            depth: options.depth,
            metadata: plan.metadata.iter().map(|(key, value)| (key.to_owned(), value.to_owned())).collect(),
            cell: CellText { center: cell.center().to_array(), half_extent: cell.half_extent().to_array() },
            slabs: plan.geometry.slabs().iter().map(SlabText::new).collect(),
        }
    }

    /// The shard; `None` if there is no such shard.
    pub(crate) fn shard(&self) -> Option<Shard> {
        Shard::new(self.shard, self.shards)
    }

    /// The plan as far as putting files together needs it: how texels become blocks is left at its default.
    pub(crate) fn plan(&self) -> Result<Plan, CaptureError> {
        let encoding = ENCODINGS.into_iter().find(|(name, _)| *name == self.encoding);
        let options = Options {
            grid: self.rays_per_texel_and_axis,
            // What is not known is refused as an encoding that is not captured.
            encoding: encoding.map_or(TexelEncoding::Rgb16F, |(_, encoding)| encoding),
            pack: PackOptions::default(),
            whole: self.whole,
            depth: self.depth,
        };
        let mut metadata = Metadata::new();
        for (key, value) in &self.metadata {
            metadata.insert(key, value)?;
        }
        let cell = Cell::new(DVec3::from_array(self.cell.center), Vec3::from_array(self.cell.half_extent))?;
        let slabs = self.slabs.iter().map(SlabText::slab).collect::<Result<_, _>>()?;
        let scene = u64::from_str_radix(&self.scene, 16).unwrap_or(0);
        Plan::new(LightFieldGeometry::new(cell, slabs)?, options, metadata, scene)
    }

    /// What differs from another header, but for what `except` names: a line for each entry.
    pub(crate) fn differences(&self, other: &Self, except: &str) -> Vec<String> {
        let entries = |header: &Self| match serde_json::to_value(header) {
            Ok(Value::Object(entries)) => entries,
            _ => serde_json::Map::new(),
        };
        let (here, there) = (entries(self), entries(other));
        let differing = here.iter().filter(|(key, value)| *key != except && there.get(*key) != Some(value));
        differing.map(|(key, value)| difference(key, value, there.get(key).unwrap_or(&Value::Null))).collect()
    }
}

/// An entry that differs; long values are not shown.
fn difference(key: &str, here: &Value, there: &Value) -> String {
    let key = key.replace('_', " ");
    let (here, there) = (here.to_string(), there.to_string());
    if key == "scene" || here.len().max(there.len()) > 60 {
        return format!("the {key} differs");
    }
    format!("{key} is {there} there and {here} here")
}

impl SlabText {
    fn new(slab: &Slab) -> Self {
        let [[s, t], [u, v]] = [slab.st(), slab.uv()];
        let text = |axis: SampledAxis| AxisText { first: axis.first(), step: axis.step(), count: axis.count() };
        Self {
            face: slab.face().index(),
            plane: slab.plane(),
            axes: [s, t, u, v].map(text),
            focal_depth: slab.focal_depth(),
        }
    }

    fn slab(&self) -> Result<Slab, CaptureError> {
        let face = Face::from_index(self.face).ok_or(GeometryError::SlabOrder)?;
        // The file format has no more; this is asked before anything is as long as a count.
        if let Some(&AxisText { count, .. }) = self.axes.iter().find(|axis| axis.count > MAX_COUNT) {
            return Err(GeometryError::TooMany { what: "sample count", count, max: MAX_COUNT }.into());
        }
        let axis = |i: usize| SampledAxis::new(self.axes[i].first, self.axes[i].step, self.axes[i].count);
        Ok(Slab::new(face, self.plane, [axis(0)?, axis(1)?], [axis(2)?, axis(3)?], self.focal_depth)?)
    }
}
