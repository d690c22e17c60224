"""Renders the cameras of plan.json with Mitsuba 3, as linear OpenEXR pictures. Frames that are there are left as they are.

    python render_mitsuba.py SCENE.xml [--spp 64] [--variant scalar_rgb] [--first 1] [--last N]

The scene's own sensors are not used.
"""

import argparse
import json
import os
from pathlib import Path

import mitsuba as mi
import numpy as np

HERE = Path(__file__).resolve().parent
# Rays start at the near plane, which may not be 0: this much of the cell's edge.
SMALLEST_NEAR_CLIP = 1e-4


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", help="scene file (.xml)")
    parser.add_argument("--spp", type=int, default=64, help="samples per pixel")
    parser.add_argument("--variant", default="scalar_rgb", help="scalar_rgb, or llvm_ad_rgb or cuda_ad_rgb, which are faster")
    parser.add_argument("--first", type=int, default=1, help="first frame")
    parser.add_argument("--last", type=int, help="last frame")
    return parser.parse_args()


def sensor(plan: dict, camera: dict) -> dict:
    """A camera of Mitsuba looks along +Z of its own space, with +X to the left and +Y up."""
    mitsuba_from_world = np.array(plan["world"]["lfslab_from_world"])
    slab, image = plan["slabs"][camera["slab"]], plan["image"]
    to_world = np.eye(4)
    to_world[:3, 0] = -mitsuba_from_world @ slab["right"]
    to_world[:3, 1] = mitsuba_from_world @ slab["up"]
    to_world[:3, 2] = mitsuba_from_world @ slab["forward"]
    to_world[:3, 3] = mitsuba_from_world @ camera["position"]
    edge = 2 * max(plan["cell"]["half_extent"])
    return {
        "type": "perspective",
        "to_world": mi.ScalarTransform4f(to_world),
        "fov": image["field_of_view_degrees"],
        "fov_axis": "x",
        "near_clip": max(slab["near_clip"], SMALLEST_NEAR_CLIP * edge),
        "far_clip": 1e6 * edge,
        "film": {
            "type": "hdrfilm",
            "width": image["width"],
            "height": image["height"],
            "pixel_format": "rgb",
            "component_format": "float32",
            # A texel is the mean over its own pixel.
            "rfilter": {"type": "box"},
        },
    }


def main() -> None:
    options = arguments()
    mi.set_variant(options.variant)
    plan = json.loads((HERE / "plan.json").read_text())
    names = plan["pictures"]
    folder = HERE / names["folder"]
    folder.mkdir(exist_ok=True)
    scene = mi.load_file(options.scene)
    last = options.last or len(plan["cameras"])
    for camera in plan["cameras"][options.first - 1 : last]:
        path = folder / f"{names['prefix']}{camera['frame']:0{names['digits']}}.exr"
        if path.exists():
            continue
        picture = mi.render(scene, sensor=mi.load_dict(sensor(plan, camera)), spp=options.spp, seed=camera["frame"])
        # Under another name until it is whole.
        part = path.with_suffix(".part")
        mi.Bitmap(picture).write(str(part), mi.Bitmap.FileFormat.OpenEXR)
        os.replace(part, path)
        print(f"frame {camera['frame']} of {len(plan['cameras'])}", flush=True)


main()
