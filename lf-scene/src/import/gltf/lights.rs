//! Lights and cameras of a glTF file.

use std::f32::consts::{FRAC_PI_2, PI};

use glam::{Mat4, Vec3};
use gltf::Document;
use gltf::khr_lights_punctual::{self, Kind};
use lf_math::normalized;

use super::super::notes::Notes;
use super::super::{ImportOptions, SceneCamera};
use crate::ImportError;
use crate::environment::Environment;
use crate::light::{Light, Lighting};
use crate::material::Surface;
use crate::scene::SceneBuilder;

/// glTF gives candela and lux; at 683 lm/W they become radiometric units, as Blender's exporter assumes.
const LUMENS_PER_WATT: f32 = 683.0;
/// The largest intensity, candela or lux.
const MAX_INTENSITY: f32 = 1e12;
/// The zenith of the sky around a scene for which no environment is given, W/(m²·sr).
const SKY: Vec3 = Vec3::new(0.75, 0.85, 1.0);
/// Its ambient light, about half of the sky's: rooms hide much of it.
const AMBIENT: f32 = 0.45;
/// Radiance of a white surface under a sun of unknown strength, W/(m²·sr): brighter and warmer than the sky.
const SUNLIT: Vec3 = Vec3::new(1.6, 1.5, 1.3);

/// A light of KHR_lights_punctual at a node; `None` if the node's transform leaves it no direction.
pub(super) fn convert_light(
    light: &khr_lights_punctual::Light<'_>,
    world_from_node: Mat4,
    notes: &mut Notes,
) -> Result<Option<Light>, ImportError> {
    let place = format!("light {}", light.index());
    let [r, g, b] = light.color().map(|value| notes.within(&place, value, 0.0..=1.0));
    let intensity = notes.within(&place, light.intensity(), 0.0..=MAX_INTENSITY)?;
    let strength = Vec3::new(r?, g?, b?) * intensity / LUMENS_PER_WATT;
    notes.count("lights end at a range; here they do not", usize::from(light.range().is_some()));
    let position = world_from_node.w_axis.truncate();
    if !position.is_finite() {
        return Err(ImportError::malformed(place, "its position is not finite"));
    }
    let Some(direction) = normalized(-world_from_node.z_axis.truncate()) else {
        notes.add("lights have no direction and are left out");
        return Ok(None);
    };
    Ok(Some(match light.kind() {
        Kind::Directional => Light::Sun { towards: -direction, irradiance: strength },
        Kind::Point => Light::Point { position, intensity: strength },
        Kind::Spot { inner_cone_angle, outer_cone_angle } => {
            let outer = notes.within(&place, outer_cone_angle, 1e-3..=FRAC_PI_2)?;
            // The scene wants them apart.
            let inner = notes.within(&place, inner_cone_angle, 0.0..=outer)?.min(0.999 * outer);
            Light::Spot { position, direction, intensity: strength, inner, outer }
        }
    }))
}

/// The camera at a node; `None` for an orthographic one and one that looks nowhere.
pub(super) fn convert_camera(
    document: &Document,
    node: &gltf::Node<'_>,
    world_from_node: Mat4,
    notes: &mut Notes,
) -> Result<Option<SceneCamera>, ImportError> {
    let Some(camera) = node.camera() else { return Ok(None) };
    let json = document.as_json().cameras.get(camera.index());
    let Some(perspective) = json.and_then(|json| json.perspective.as_ref()) else {
        notes.add("orthographic cameras are left out");
        return Ok(None);
    };
    let fov_y = notes.within(&format!("camera {}", camera.index()), perspective.yfov, 1e-3..=PI - 1e-3)?;
    let position = world_from_node.w_axis.truncate();
    let axes = (normalized(-world_from_node.z_axis.truncate()), normalized(world_from_node.y_axis.truncate()));
    let (Some(forward), Some(up), true) = (axes.0, axes.1, position.is_finite()) else {
        notes.add("cameras look nowhere and are left out");
        return Ok(None);
    };
    let name = camera.name().or(node.name()).map(str::to_owned);
    Ok(Some(SceneCamera { name, position, forward, up, fov_y }))
}

/// The file's lights, and a sun if it names one. A file with nothing that shines gets a lamp at its camera. Where no
/// environment is given, ambient light fills in for it and for indirect light.
pub(super) fn lighting(
    mut lights: Vec<Light>,
    document: &Document,
    cameras: &[SceneCamera],
    builder: &SceneBuilder,
    options: &ImportOptions,
    notes: &mut Notes,
) -> Lighting {
    let sun = sun_direction(document, notes);
    lights.extend(sun.map(|towards| assumed_sun(towards, notes)));
    if lights.is_empty() && options.environment.is_none() && !glows(builder) {
        notes.inform("nothing shines: a lamp is put at the camera");
        let (min, max) = builder.bounds();
        let position = cameras.first().map_or(0.5 * (min + max), |camera| camera.position + Vec3::Y * 0.3);
        // Makes a white wall a quarter of the scene's diagonal away as bright as white can be shown.
        let reach = 0.25 * (max - min).length();
        lights.push(Light::Point { position, intensity: Vec3::splat(PI * reach * reach) });
    }
    match options.environment.clone() {
        Some(map) => Lighting { lights, ambient: Vec3::ZERO, environment: Environment::Map(map.into()) },
        None => {
            notes.inform(format!(
                "no environment is given: a blue-white sky of {SKY} W/(m²·sr) is put around the scene, with ambient light of \
                 {AMBIENT}; --environment sets another"
            ));
            Lighting { lights, ambient: Vec3::splat(AMBIENT), environment: Environment::Sky(SKY) }
        }
    }
}

/// A sun of which only the direction is known.
fn assumed_sun(towards: Vec3, notes: &mut Notes) -> Light {
    let irradiance = PI * SUNLIT;
    notes.inform(format!("the sun's strength is not given: its irradiance is taken for {irradiance:.1} W/m²"));
    Light::Sun { towards, irradiance }
}

/// Whether a triangle emits light.
fn glows(builder: &SceneBuilder) -> bool {
    let dark = Surface::Uniform(Vec3::ZERO);
    let glowing: Vec<bool> = builder.materials().iter().map(|material| material.emission != dark).collect();
    builder.triangles().iter().any(|(_, material)| glowing.get(*material as usize).is_some_and(|glows| *glows))
}

/// The sun that `asset.extras.emitters` names, a convention of converted scenes; other emitters there are noted.
fn sun_direction(document: &Document, notes: &mut Notes) -> Option<Vec3> {
    let extras = document.as_json().asset.extras.as_ref()?;
    let json: serde_json::Value = serde_json::from_str(extras.get()).ok()?;
    let emitters = json.get("emitters")?.as_array()?;
    let direction = |emitter: &serde_json::Value| {
        let sun = emitter.get("sun_direction_world")?.as_array()?;
        let number = |i: usize| Some(sun.get(i)?.as_f64()? as f32);
        normalized(Vec3::new(number(0)?, number(1)?, number(2)?))
    };
    let suns: Vec<Vec3> = emitters.iter().filter_map(direction).collect();
    notes.count(
        "emitters of asset.extras are not used; give an environment in their place",
        emitters.len() - suns.len(),
    );
    notes.count("suns of asset.extras beside the first are not used", suns.len().saturating_sub(1));
    suns.first().copied()
}
