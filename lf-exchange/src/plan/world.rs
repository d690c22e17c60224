//! Whose coordinates a scene is in.

use glam::{DMat3, DVec3};

/// The coordinates that a renderer's users work in.
///
/// A slab is given in this project's world, which is glTF's: right-handed, +Y up. The others are taken there by exchanging or
/// mirroring axes. A mirrored world does not make mirrored pictures: what is to the right of a camera stays there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum World {
    /// Right-handed; +Y is up in glTF, and whatever the scene says in Mitsuba. This project's own.
    #[default]
    Gltf,
    /// POV-Ray's: left-handed, so that (x, y, z) is glTF's (x, y, −z).
    PovRay,
    /// Blender's: right-handed, +Z up, so that (x, y, z) is glTF's (x, z, −y), as Blender's own glTF importer has it.
    Blender,
}

impl World {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Gltf, Self::PovRay, Self::Blender];

    /// The name in a plan and on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Gltf => "gltf",
            Self::PovRay => "povray",
            Self::Blender => "blender",
        }
    }

    /// The world of a name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|world| world.name() == name)
    }

    /// Takes points and directions of this project's world to this one. Each row and column holds one ±1, so that nothing is
    /// rounded, and the transpose takes them back.
    #[must_use]
    pub fn world_from_lfslab(self) -> DMat3 {
        match self {
            Self::Gltf => DMat3::IDENTITY,
            Self::PovRay => DMat3::from_cols(DVec3::X, DVec3::Y, DVec3::NEG_Z),
            Self::Blender => DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn worlds_exchange_and_mirror_axes() {
        let p = DVec3::new(1.0, 2.0, 3.0);
        let found = World::ALL.map(|world| world.world_from_lfslab() * p);
        assert_eq!(found, [p, DVec3::new(1.0, 2.0, -3.0), DVec3::new(1.0, -3.0, 2.0)]);
        let handedness = World::ALL.map(|world| world.world_from_lfslab().determinant());
        assert_eq!(handedness, [1.0, -1.0, 1.0]);
        for world in World::ALL {
            assert_eq!(World::from_name(world.name()), Some(world));
            assert_eq!(world.world_from_lfslab().transpose() * (world.world_from_lfslab() * p), p);
        }
        assert_eq!(World::from_name("maya"), None);
    }
}
