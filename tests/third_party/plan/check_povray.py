"""POV-Ray renders a plan of ours in one run, and the imported light field has the colours that each ray sees.

    python check_povray.py SAMPLES
"""

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import room

# POV-Ray's coordinates are left-handed: its (x, y, z) is our (x, y, -z).
POVRAY_FROM_LFSLAB = [[1, 0, 0], [0, 1, 0], [0, 0, -1]]


def vector(values) -> str:
    return "<" + ",".join(str(float(x)) for x in values) + ">"


def scene() -> str:
    shine = "finish {{ ambient 0 diffuse 0 emission 1 }} pigment {{ rgb {} }}"
    lines = ["#version 3.7;", "global_settings { assumed_gamma 1 }", '#include "lfslab_camera.inc"']
    for axis, name in enumerate("xyz"):
        for side, at in enumerate((room.LEAST[axis], room.MOST[axis])):
            lines.append(f"plane {{ {name}, {at} {shine.format(vector(room.WALLS[axis, side]))} }}")
    lines.append(f"sphere {{ {vector(room.BALL_CENTER)}, {room.BALL_RADIUS} {shine.format(vector(room.BALL))} }}")
    return "\n".join(lines)


def check(folder: Path, planes: str) -> None:
    room.plan(folder, "povray", planes)
    (folder / "room.pov").write_text(scene())
    command = ["povray", "lfslab.ini", "+Iroom.pov", "-A", "+WT1", "-GA"]
    subprocess.run(command, cwd=folder, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    file = folder / f"povray-{planes}.lfslab"
    room.program("import", str(folder), "--encoding", "rgba8", "--out", str(file))
    # POV-Ray asks for each pixel's centre: the edges of what it sees may lie anywhere else in it.
    room.check(file, POVRAY_FROM_LFSLAB, 0.02, room.srgb8, 1)


if not shutil.which("povray"):
    sys.exit("POV-Ray is missing: apt-get install povray povray-includes")
for each in ("faces", "center"):
    with tempfile.TemporaryDirectory() as name:
        check(Path(name), each)
