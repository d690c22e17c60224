"""The script for Blender sets the cameras of plan.json: by a stand-in for Blender's module always, and by Blender itself, in the
way of the other programs, where it is installed (as a program, or `pip install bpy`).

    python check_blender.py SAMPLES
"""

import importlib.util
import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import room

HERE = Path(__file__).resolve().parent
# Blender's world has +Z up: its (x, y, z) is our (x, z, -y).
LFSLAB_FROM_BLENDER = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])


def check_numbers(folder: Path, world: str) -> None:
    plan, log = room.plan(folder, world, "center"), folder / "log"
    variables = {"PYTHONPATH": str(HERE / "blender_stub"), "BLENDER_STUB_LOG": str(log)}
    command = [sys.executable, str(folder / "render_blender.py")]
    for words in (["--", "--first", "2", "--last", "3"], []):
        subprocess.run([*command, *words], check=True, env=os.environ | variables)
    records = [json.loads(line) for line in log.read_text().splitlines()]
    # Frames 2 and 3 were there already in the second run.
    order = [2, 3, 1, *range(4, len(plan["cameras"]) + 1)]
    assert len(records) == len(order)
    blender_from_world = LFSLAB_FROM_BLENDER.T @ np.array(plan["world"]["lfslab_from_world"])
    if world == "blender":
        assert np.array_equal(blender_from_world, np.eye(3))
    image = plan["image"]
    for frame, record in zip(order, records):
        camera = plan["cameras"][frame - 1]
        slab = plan["slabs"][camera["slab"]]
        matrix = np.array(record["matrix"])
        # Blender's camera has +X to the right, +Y up, and looks along -Z.
        expected = np.array([slab["right"], slab["up"], np.negative(slab["forward"]), camera["position"]]).T
        assert np.array_equal(matrix[:3], blender_from_world @ expected) and np.array_equal(matrix[3], [0, 0, 0, 1])
        assert np.linalg.det(matrix) == 1
        assert abs(record["edge_slope"] - image["edge_slope"]) < 1e-12
        assert record["size"] == [image["width"], image["height"], 100] and record["shift"] == [0, 0]
        assert record["lens"] == ["PERSP", "HORIZONTAL"] and record["near"] == slab["near_clip"] == room.CELL_EDGE / 2
        assert record["file_format"] == ["OPEN_EXR", "RGB", "32"]
        assert (folder / "pictures" / f"lfslab{frame:02}.exr").exists()
    print(f"render_blender.py, {world}: {len(records)} cameras as in plan.json")


def blender() -> list[str] | None:
    if shutil.which("blender"):
        return ["blender", "-b", "--factory-startup", "-P"]
    return [sys.executable] if importlib.util.find_spec("bpy") else None


def check_pictures(command: list[str], folder: Path, planes: str) -> None:
    room.plan(folder, "blender", planes)
    contents = {
        "ends": [room.LEAST.tolist(), room.MOST.tolist()],
        "walls": room.WALLS.tolist(),
        "ball": room.BALL.tolist(),
        "ball_center": room.BALL_CENTER.tolist(),
        "ball_radius": room.BALL_RADIUS,
    }
    (folder / "room.json").write_text(json.dumps(contents))
    subprocess.run([*command, str(HERE / "blender_room.py"), "--", str(folder)], check=True, stdout=subprocess.DEVNULL)
    file = folder / f"blender-{planes}.lfslab"
    room.program("import", str(folder), "--out", str(file))
    # Samples lie anywhere in the pixel, and the ball has 128 corners around.
    room.check(file, LFSLAB_FROM_BLENDER.T, 0.55, lambda linear: linear, 1e-3)


for each in ("blender", "gltf", "povray"):
    with tempfile.TemporaryDirectory() as name:
        check_numbers(Path(name), each)
program = blender()
if program:
    for each in ("faces", "center"):
        with tempfile.TemporaryDirectory() as name:
            check_pictures(program, Path(name), each)
else:
    print("NOT TESTED: Blender itself is not installed")
