"""A Mitsuba scene from the files that `lf_tests::mitsuba::write_scene` writes."""

from __future__ import annotations

import json
from pathlib import Path

import mitsuba as mi
import numpy as np


def load(folder: Path) -> mi.Scene:
    """The scene in a folder, for the current variant."""
    scene = json.loads((folder / "scene.json").read_text())
    parts = {"type": "scene"}
    for number, material in enumerate(scene["materials"]):
        file = folder / f"mesh-{number}.f32"
        if file.exists():
            parts[f"mesh-{number}"] = mesh(file, properties(folder, material))
    for number, light in enumerate(scene["lights"]):
        parts[f"light-{number}"] = emitter(light)
    if scene["environment"]:
        parts["environment"] = environment(folder, scene["environment"])
    return mi.load_dict(parts)


def properties(folder: Path, material: dict) -> mi.Properties:
    props = mi.Properties()
    props["bsdf"] = mi.load_dict(bsdf(folder, material))
    if material["emission"]:
        props["emitter"] = mi.load_dict({"type": "area", "radiance": color(folder, material["emission"])})
    return props


def mesh(file: Path, props: mi.Properties) -> mi.Mesh:
    """Three corners a triangle, none of them shared."""
    corners = np.fromfile(file, "<f4").reshape(-1, 8)
    made = mi.Mesh(file.stem, len(corners), len(corners) // 3, props, has_vertex_normals=True, has_vertex_texcoords=True)
    parameters = mi.traverse(made)
    parameters["vertex_positions"] = array(corners[:, 0:3])
    parameters["vertex_normals"] = array(unit(corners[:, 3:6]))
    parameters["vertex_texcoords"] = array(corners[:, 6:8])
    numbers = np.arange(len(corners), dtype=np.uint32)
    parameters["faces"] = numbers if scalar() else mi.UInt32(numbers)
    parameters.update()
    return made


def unit(vectors: np.ndarray) -> np.ndarray:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors / np.where(length > 0, length, 1)


def scalar() -> bool:
    return mi.variant().startswith("scalar")


def array(values: np.ndarray):
    flat = np.ascontiguousarray(values, dtype=np.float32).ravel()
    return flat if scalar() else mi.Float(flat)


def bsdf(folder: Path, material: dict) -> dict:
    kind, base = material["scattering"]["kind"], color(folder, material["base"])
    if kind == "glass":
        glass = material["scattering"]
        plugin = "thindielectric" if glass["thin"] else "dielectric"
        return {"type": plugin, "int_ior": glass["ior"], "ext_ior": 1.0, "specular_transmittance": base}
    inner = {
        "diffuse": lambda: {"type": "diffuse", "reflectance": base},
        "mirror": lambda: {"type": "conductor", "material": "none", "specular_reflectance": base},
        "metallic-roughness": lambda: metallic_roughness(folder, material["scattering"], base),
    }[kind]()
    return {"type": "twosided", "inner": inner}


def metallic_roughness(folder: Path, model: dict, base: dict) -> dict:
    metal, rough, texture = model["metallic"], model["roughness"], model["texture"]
    if texture is None and metal == 1.0 and rough < 0.03:
        return {"type": "smoothmetal", "base": base}
    if texture is None and metal == 1.0:
        # Mitsuba's own model of metals is glTF's.
        return {"type": "principled", "base_color": base, "metallic": 1.0, "roughness": rough, "specular": 0.5}
    made = {"type": "gltf", "base": base, "metallic": metal, "roughness": rough}
    return made | ({"factors": color(folder, texture)} if texture else {})


def color(folder: Path, surface: dict) -> dict:
    kind = surface["kind"]
    if kind == "uniform":
        return {"type": "rgb", "value": surface["color"]}
    if kind == "texture":
        texels = linear(folder, surface) * np.array(surface["factor"], np.float32)
        return bitmap(texels)
    colors = {f"color{i}": {"type": "rgb", "value": value} for i, value in enumerate(surface["colors"])}
    return {"type": "pattern", "kind": kind, "count": surface["count"], "colors": len(colors)} | colors


def linear(folder: Path, surface: dict) -> np.ndarray:
    """Texels as linear RGB; the first row is v = 0."""
    shape = (surface["height"], surface["width"], 4)
    texels = np.fromfile(folder / surface["file"], np.uint8).reshape(shape)[:, :, :3].astype(np.float32) / 255
    if not surface["srgb"]:
        return texels
    return np.where(texels <= 0.04045, texels / 12.92, ((texels + 0.055) / 1.055) ** 2.4)


def bitmap(texels: np.ndarray) -> dict:
    """A texture whose first row is v = 0."""
    made = mi.Bitmap(np.ascontiguousarray(texels, dtype=np.float32))
    return {"type": "bitmap", "bitmap": made, "raw": True, "filter_type": "bilinear", "wrap_mode": "repeat"}


def emitter(light: dict) -> dict:
    if light["kind"] == "point":
        return {"type": "point", "position": light["position"], "intensity": {"type": "rgb", "value": light["intensity"]}}
    if light["kind"] == "sun":
        away = [-x for x in light["towards"]]
        return {"type": "directional", "direction": away, "irradiance": {"type": "rgb", "value": light["irradiance"]}}
    raise SystemExit(f"Mitsuba has no {light['kind']} light of glTF's kind")


def environment(folder: Path, map: dict) -> dict:
    texels = np.fromfile(folder / "environment.f32", "<f4").reshape(map["height"], map["width"], 3)
    return {"type": "envmap", "bitmap": mi.Bitmap(texels)}
