//! A point of a surface as a ray finds it.

use glam::{Vec2, Vec3};

use crate::bsdf::{Bsdf, Evaluated, Scattered, Smooth};
use crate::bvh::{Hit, interpolate, plane_normal};
use crate::ggx::{Glossy, MIN_ROUGHNESS};
use crate::material::{Material, Scattering};
use crate::random::Random;
use crate::rounded::RoundedPoint;
use crate::scene::{Scene, Vertex};

/// Where a ray met a surface, world space.
pub(crate) struct SurfacePoint<'a> {
    /// The point.
    pub(crate) place: RoundedPoint,
    /// The material's number.
    pub(crate) material_number: u32,
    /// The triangle's unit normal, on the viewer's side.
    facing: Vec3,
    /// Whether the viewer is on the side from which the corners run anticlockwise.
    front: bool,
    /// Unit vector towards the viewer.
    viewer: Vec3,
    /// The interpolated normal, on the viewer's side, and two directions at right angles.
    shading: Frame,
    uv: Vec2,
    material: &'a Material,
    bsdf: Bsdf,
}

/// Three unit vectors at right angles.
struct Frame {
    x: Vec3,
    y: Vec3,
    z: Vec3,
}

impl<'a> SurfacePoint<'a> {
    /// The point of a hit by a ray of a unit direction.
    pub(crate) fn new(scene: &'a Scene, hit: &Hit, direction: Vec3) -> Self {
        let (corners, material_number) = &scene.triangles()[hit.triangle];
        let positions = corners.map(|v| v.position);
        let normal = plane_normal(positions);
        let front = normal.dot(direction) < 0.0;
        let facing = if front { normal } else { -normal };
        let place = RoundedPoint::new(positions, hit.shares);
        let uv = uv_on(corners, hit.shares);
        let material = scene.material(hit.triangle);
        let shading = Frame::around(shading_normal(corners, hit.shares, facing, -direction));
        let bsdf = material.bsdf(uv, front);
        Self {
            place,
            material_number: *material_number,
            facing,
            front,
            viewer: -direction,
            shading,
            uv,
            material,
            bsdf,
        }
    }

    /// Radiance that the surface sends to the viewer by itself.
    pub(crate) fn emission(&self) -> Vec3 {
        if self.front || self.material.double_sided { self.material.emission.color(self.uv) } else { Vec3::ZERO }
    }

    /// Base colour.
    pub(crate) fn base(&self) -> Vec3 {
        self.material.base.color(self.uv)
    }

    /// The shading normal, on the viewer's side.
    pub(crate) fn normal(&self) -> Vec3 {
        self.shading.z
    }

    /// Cosine between the triangle's normal and the direction to the viewer.
    pub(crate) fn cosine_to_viewer(&self) -> f32 {
        self.facing.dot(self.viewer)
    }

    /// Whether light is scattered to single directions only.
    pub(crate) fn is_smooth(&self) -> bool {
        matches!(self.bsdf, Bsdf::Smooth(_))
    }

    /// BSDF times cosine for light from a unit direction; `None` where there is none, also if the direction is on different
    /// sides of the triangle and of the shading normal: light must not leak through.
    pub(crate) fn evaluate(&self, light: Vec3) -> Option<Evaluated> {
        let above = self.facing.dot(light) > 0.0;
        above.then(|| self.bsdf.evaluate(self.shading.to_local(self.viewer), self.shading.to_local(light))).flatten()
    }

    /// A unit direction to look for light.
    pub(crate) fn scatter(&self, random: &mut Random) -> Option<Scattered> {
        if let Bsdf::Smooth(smooth) = &self.bsdf {
            return self.scatter_smooth(smooth, random.uniform());
        }
        let local = self.bsdf.sample(self.shading.to_local(self.viewer), random)?;
        let scattered = Scattered { towards: self.shading.to_world(local.towards), ..local };
        (self.facing.dot(scattered.towards) > 0.0).then_some(scattered)
    }

    /// Where the shading normal would send reflected light into the surface or refracted light out of it, the triangle's
    /// normal decides.
    fn scatter_smooth(&self, smooth: &Smooth, uniform: f32) -> Option<Scattered> {
        let by = |frame: &Frame| {
            let local = smooth.scatter(frame.to_local(self.viewer), uniform);
            let towards = frame.to_world(local.towards);
            let right_side = self.facing.dot(towards) * local.towards.z > 0.0;
            right_side.then_some(Scattered { towards, ..local })
        };
        by(&self.shading).or_else(|| by(&Frame::around(self.facing)))
    }

    /// Where a ray in a direction may start without meeting this surface again through rounding.
    pub(crate) fn launch(&self, direction: Vec3) -> Vec3 {
        self.place.lifted(if self.facing.dot(direction) < 0.0 { -self.facing } else { self.facing })
    }
}

/// Texture coordinates of a point of a triangle.
pub(crate) fn uv_on(corners: &[Vertex; 3], shares: Vec3) -> Vec2 {
    interpolate(corners.map(|v| v.uv.extend(0.0)), shares).truncate()
}

/// The interpolated normal on the side of `facing`; `facing` itself where the viewer is behind the former.
fn shading_normal(corners: &[Vertex; 3], shares: Vec3, facing: Vec3, viewer: Vec3) -> Vec3 {
    let smooth = lf_math::normalized(interpolate(corners.map(|v| v.normal), shares)).unwrap_or(facing);
    let normal = if smooth.dot(facing) < 0.0 { -smooth } else { smooth };
    if normal.dot(viewer) > 0.0 { normal } else { facing }
}

impl Material {
    /// How a point scatters light towards a viewer in front of the surface or behind it.
    fn bsdf(&self, uv: Vec2, front: bool) -> Bsdf {
        let base = self.base.color(uv);
        match &self.scattering {
            Scattering::Diffuse => Bsdf::Lambert(base),
            Scattering::Mirror => Bsdf::Smooth(Smooth::Mirror(base)),
            Scattering::Glass { ior, thin: true } => Bsdf::Smooth(Smooth::Pane { tint: base, ior: *ior }),
            Scattering::Glass { ior, thin: false } => {
                Bsdf::Smooth(Smooth::Glass { tint: base, eta: if front { *ior } else { 1.0 / ior } })
            }
            Scattering::MetallicRoughness { metallic, roughness, texture } => {
                let factors = texture.as_ref().map_or(Vec3::ONE, |texture| texture.sample(uv).truncate());
                let (metallic, roughness) = (metallic * factors.z, roughness * factors.y);
                if metallic >= 1.0 && roughness < MIN_ROUGHNESS {
                    return Bsdf::Smooth(Smooth::Metal(base));
                }
                Bsdf::Glossy(Glossy::new(base, metallic, roughness))
            }
        }
    }
}

impl Frame {
    /// A frame around a unit vector (Duff et al.: Building an Orthonormal Basis, Revisited, JCGT 2017).
    fn around(z: Vec3) -> Self {
        let sign = 1f32.copysign(z.z);
        let a = -1.0 / (sign + z.z);
        let b = z.x * z.y * a;
        let x = Vec3::new(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x);
        Self { x, y: Vec3::new(b, sign + z.y * z.y * a, -z.y), z }
    }

    fn to_local(&self, v: Vec3) -> Vec3 {
        Vec3::new(v.dot(self.x), v.dot(self.y), v.dot(self.z))
    }

    fn to_world(&self, v: Vec3) -> Vec3 {
        self.x * v.x + self.y * v.y + self.z * v.z
    }
}
