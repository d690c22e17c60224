"""Renders the cameras of plan.json with Blender, as linear OpenEXR pictures. Frames that are there are left as they are.

    blender -b SCENE.blend -P render_blender.py [-- --first 1 --last N]

Engine, samples, and all else but camera, size and file type are the scene's own.
"""

import argparse
import json
import os
import sys
from pathlib import Path

import bpy
from mathutils import Matrix

HERE = Path(__file__).resolve().parent
# Blender has +Z up: its (x, y, z) is (x, z, -y) in a world with +Y up.
BLENDER_FROM_LFSLAB = ((1, 0, 0), (0, 0, -1), (0, 1, 0))
SENSOR_MM = 36.0
# The near plane may not be 0: this much of the cell's edge.
SMALLEST_NEAR_CLIP = 1e-4


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="render_blender.py")
    parser.add_argument("--first", type=int, default=1, help="first frame")
    parser.add_argument("--last", type=int, help="last frame")
    own = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    return parser.parse_args(own)


def apply(matrix, vector) -> list[float]:
    return [sum(a * b for a, b in zip(row, vector)) for row in matrix]


def matrix_world(plan: dict, camera: dict) -> list[list[float]]:
    """Rows of a camera's matrix: it looks along -Z of its own space, with +X to the right and +Y up."""
    slab = plan["slabs"][camera["slab"]]

    def blender(vector) -> list[float]:
        return apply(BLENDER_FROM_LFSLAB, apply(plan["world"]["lfslab_from_world"], vector))

    back = [-x for x in slab["forward"]]
    columns = [blender(v) for v in (slab["right"], slab["up"], back, camera["position"])]
    return [[column[i] for column in columns] for i in range(3)] + [[0.0, 0.0, 0.0, 1.0]]


def prepare(scene, plan: dict):
    """Sets what all frames share, and returns the camera."""
    image = plan["image"]
    render = scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = image["width"], image["height"], 100
    render.pixel_aspect_x = render.pixel_aspect_y = 1.0
    render.use_border = render.use_multiview = render.use_sequencer = False
    if hasattr(render.image_settings, "media_type"):  # from Blender 5 on: a scene made for films takes no pictures otherwise
        render.image_settings.media_type = "IMAGE"
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_mode = "RGB"
    render.image_settings.color_depth = "32"
    render.use_file_extension = False
    if render.engine == "CYCLES":
        # A texel is the mean over its own pixel.
        scene.cycles.pixel_filter_type = "BOX"
    # Markers would put other cameras in the place of ours.
    scene.timeline_markers.clear()
    data = bpy.data.cameras.new("lfslab")
    data.type = "PERSP"
    data.sensor_fit = "HORIZONTAL"
    data.sensor_width = SENSOR_MM
    data.lens = SENSOR_MM / (2 * image["edge_slope"])
    data.shift_x = data.shift_y = 0.0
    data.dof.use_dof = False
    data.clip_end = 1e6 * 2 * max(plan["cell"]["half_extent"])
    camera = bpy.data.objects.new("lfslab", data)
    scene.collection.objects.link(camera)
    scene.camera = camera
    return camera


def main() -> None:
    options = arguments()
    plan = json.loads((HERE / "plan.json").read_text())
    names = plan["pictures"]
    folder = HERE / names["folder"]
    folder.mkdir(exist_ok=True)
    scene = bpy.context.scene
    eye = prepare(scene, plan)
    edge = 2 * max(plan["cell"]["half_extent"])
    for camera in plan["cameras"][options.first - 1 : options.last or len(plan["cameras"])]:
        path = folder / f"{names['prefix']}{camera['frame']:0{names['digits']}}.exr"
        if path.exists():
            continue
        eye.matrix_world = Matrix(matrix_world(plan, camera))
        eye.data.clip_start = max(plan["slabs"][camera["slab"]]["near_clip"], SMALLEST_NEAR_CLIP * edge)
        # Under another name until it is whole.
        part = path.with_suffix(".part")
        scene.render.filepath = str(part)
        bpy.ops.render.render(write_still=True)
        os.replace(part, path)


main()
