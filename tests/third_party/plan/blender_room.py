"""Within Blender: builds the room, then runs the script of a plan in a folder.

    blender -b --factory-startup -P blender_room.py -- FOLDER
"""

import json
import math
import runpy
import sys
from pathlib import Path

import bpy

folder = Path(sys.argv[sys.argv.index("--") + 1])
room = json.loads((folder / "room.json").read_text())


def add(name: str, vertices, faces, color) -> None:
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    emission, output = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeOutputMaterial")
    emission.inputs["Color"].default_value = (*color, 1)
    material.node_tree.links.new(emission.outputs["Emission"], output.inputs["Surface"])
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    mesh.materials.append(material)
    bpy.context.scene.collection.objects.link(bpy.data.objects.new(name, mesh))


def add_wall(axis: int, side: int) -> None:
    i, j = (axis + 1) % 3, (axis + 2) % 3
    corners = []
    for a, b in ((0, 0), (1, 0), (1, 1), (0, 1)):
        corner = [0.0] * 3
        corner[axis], corner[i], corner[j] = room["ends"][side][axis], room["ends"][a][i], room["ends"][b][j]
        corners.append(corner)
    add(f"wall {axis} {side}", corners, [[0, 1, 2, 3]], room["walls"][axis][side])


def add_ball(rings: int = 64, sectors: int = 128) -> None:
    center, radius = room["ball_center"], room["ball_radius"]
    vertices, faces = [], []
    for ring in range(rings + 1):
        for sector in range(sectors):
            theta, phi = math.pi * ring / rings, math.tau * sector / sectors
            unit = math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta)
            vertices.append([c + radius * x for c, x in zip(center, unit)])
    for ring in range(rings):
        for sector in range(sectors):
            here, there = ring * sectors + sector, ring * sectors + (sector + 1) % sectors
            faces.append([here, there, there + sectors, here + sectors])
    add("ball", vertices, faces, room["ball"])


for thing in list(bpy.data.objects):
    bpy.data.objects.remove(thing)
for axis in range(3):
    for side in range(2):
        add_wall(axis, side)
add_ball()
scene = bpy.context.scene
scene.render.engine = "CYCLES"
scene.cycles.samples = 4
scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
sys.argv = [sys.argv[0]]
runpy.run_path(str(folder / "render_blender.py"), run_name="__main__")
