//! Scenes, environments and meshes from files, good and bad.

mod broken;
mod environments;
mod files;
mod materials;
mod meshes;
mod scenes;
