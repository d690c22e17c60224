"""Mitsuba 3 renders a plan of ours by the script that comes with it, and the imported light field has the colours that each ray sees.

    python check_mitsuba.py SAMPLES
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import room


def matrix(values) -> str:
    return " ".join(str(float(x)) for x in np.ravel(values))


def emitter(color) -> str:
    return f'<emitter type="area"><rgb name="radiance" value="{" ".join(map(str, color))}"/></emitter>'


def wall(axis: int, side: int) -> str:
    """A rectangle that shines into the room: along its own +z."""
    middle, half = (room.LEAST + room.MOST) / 2, (room.MOST - room.LEAST) / 2
    i, j = ((axis + 1) % 3, (axis + 2) % 3)[:: 1 - 2 * side]
    to_world = np.zeros((4, 4))
    to_world[i, 0], to_world[j, 1], to_world[axis, 2] = half[i], half[j], 1 - 2 * side
    to_world[:3, 3], to_world[3, 3] = middle, 1
    to_world[axis, 3] = (room.LEAST, room.MOST)[side][axis]
    assert np.linalg.det(to_world) > 0
    transform = f'<transform name="to_world"><matrix value="{matrix(to_world)}"/></transform>'
    return f'<shape type="rectangle">{transform}{emitter(room.WALLS[axis, side])}</shape>'


def scene() -> str:
    walls = [wall(axis, side) for axis in range(3) for side in range(2)]
    x, y, z = room.BALL_CENTER
    place = f'<point name="center" x="{x}" y="{y}" z="{z}"/><float name="radius" value="{room.BALL_RADIUS}"/>'
    ball = f'<shape type="sphere">{place}{emitter(room.BALL)}</shape>'
    integrator = '<integrator type="path"><integer name="max_depth" value="1"/></integrator>'
    return f'<scene version="3.0.0">{integrator}{"".join(walls)}{ball}</scene>'


def check(folder: Path, planes: str) -> None:
    plan = room.plan(folder, "gltf", planes)
    (folder / "room.xml").write_text(scene())
    script = [sys.executable, str(folder / "render_mitsuba.py"), str(folder / "room.xml"), "--spp", "4"]
    # In two goes: the second leaves alone what is there.
    subprocess.run([*script, "--first", "3", "--last", "5"], check=True, stdout=subprocess.DEVNULL)
    before = {path.name: path.stat().st_mtime_ns for path in (folder / "pictures").iterdir()}
    assert sorted(before) == ["lfslab03.exr", "lfslab04.exr", "lfslab05.exr"], before
    subprocess.run(script, check=True, stdout=subprocess.DEVNULL)
    assert all((folder / "pictures" / name).stat().st_mtime_ns == time for name, time in before.items())
    assert len(list((folder / "pictures").iterdir())) == len(plan["cameras"])
    file = folder / f"mitsuba-{planes}.lfslab"
    room.program("import", str(folder), "--out", str(file))
    # Samples lie anywhere in the pixel.
    room.check(file, np.eye(3), 0.5, lambda linear: linear, 1e-3)


for each in ("faces", "center"):
    with tempfile.TemporaryDirectory() as name:
        check(Path(name), each)
