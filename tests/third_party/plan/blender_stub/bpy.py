"""In place of Blender's module: keeps what a script sets, and notes the camera of each picture."""

import json
import os
from pathlib import Path
from types import SimpleNamespace as Any


class Markers(list):
    pass


render = Any(image_settings=Any(), engine="CYCLES")
scene = Any(
    render=render, cycles=Any(), timeline_markers=Markers(["another camera"]), collection=Any(objects=Any(link=lambda _: None))
)
context = Any(scene=scene)
data = Any(
    cameras=Any(new=lambda _: Any(dof=Any())),
    objects=Any(new=lambda _, data: Any(data=data)),
)


def render_frame(write_still: bool) -> None:
    assert write_still and not scene.timeline_markers
    lens, settings = scene.camera.data, render.image_settings
    record = {
        "file": render.filepath,
        "matrix": scene.camera.matrix_world.rows,
        "edge_slope": lens.sensor_width / lens.lens / 2,
        "shift": [lens.shift_x, lens.shift_y],
        "lens": [lens.type, lens.sensor_fit],
        "near": lens.clip_start,
        "size": [render.resolution_x, render.resolution_y, render.resolution_percentage],
        "file_format": [settings.file_format, settings.color_mode, settings.color_depth],
    }
    Path(render.filepath).write_text("")
    with open(os.environ["BLENDER_STUB_LOG"], "a") as log:
        log.write(json.dumps(record) + "\n")


ops = Any(render=Any(render=render_frame))
