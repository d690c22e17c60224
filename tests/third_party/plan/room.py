"""A room whose light is known: six walls of six colours and a ball, none of it symmetric, so that pictures that are mirrored, turned,
exchanged or shifted show it. Its coordinates are those of the program that renders it, whatever they are."""

import json
import os
import subprocess
from pathlib import Path

import numpy as np

import lfslab

ROOT = Path(__file__).resolve().parents[3]
LEAST, MOST = np.array([-3.0, -1.5, -2.0]), np.array([2.5, 2.0, 4.0])
# Linear colours of the walls at LEAST and at MOST of x, y, z, and of the ball.
WALLS = np.array(
    [[[1, 0, 0], [0, 0.5, 1]], [[0.25, 0.25, 0], [1, 1, 0.5]], [[0, 0.25, 0], [0.5, 0, 1]]], float
)
BALL, BALL_CENTER, BALL_RADIUS = np.array([1, 1, 1.0]), np.array([1.3, 0.7, 2.1]), 0.6
CELL_CENTER, CELL_EDGE = np.array([-0.25, 0.125, 0.5]), 0.5
CAMERAS, RESOLUTION = 2, 16


def program(*arguments: str) -> None:
    """Runs `lfslab` as it is in the source tree, or the one that LFSLAB names."""
    own = os.environ.get("LFSLAB")
    command = [own] if own else ["cargo", "run", "-q", "-p", "lf-cli", "--locked", "--"]
    subprocess.run([*command, *arguments], check=True, cwd=ROOT)


def plan(folder: Path, world: str, planes: str) -> dict:
    """The plan for the room, written to a folder."""
    cell = ",".join(str(x) for x in (*CELL_CENTER, CELL_EDGE))
    counts = ["--cameras", str(CAMERAS), "--resolution", str(RESOLUTION), "--planes", planes]
    program("plan", "--world", world, "--cell", cell, *counts, "--out", str(folder))
    return json.loads((folder / "plan.json").read_text())


def colors(origins: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """What rays [n, 3] from inside the room see."""
    with np.errstate(divide="ignore"):
        distances = np.where(directions > 0, MOST - origins, LEAST - origins) / directions
    axis = np.argmin(distances, axis=1)
    side = (np.take_along_axis(directions, axis[:, None], 1)[:, 0] > 0).astype(int)
    seen = WALLS[axis, side]
    to_ball = BALL_CENTER - origins
    length = np.linalg.norm(directions, axis=1)
    along = np.sum(to_ball * directions, axis=1) / length
    apart = np.sum(to_ball**2, axis=1) - along**2
    return np.where(((along > 0) & (apart < BALL_RADIUS**2))[:, None], BALL, seen)


def texel_rays(slab, offset: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Origins on the camera plane and directions of all texels [t, s, v, u], that many texels away from their centres; cell
    space (spec/conventions.md)."""
    at = [axis.first + axis.step * np.arange(axis.count) for axis in (slab.t, slab.s, slab.v, slab.u)]
    at[2], at[3] = at[2] + offset[1] * slab.v.step, at[3] + offset[0] * slab.u.step
    t, s, v, u = np.meshgrid(*at, indexing="ij")
    k = slab.face // 2
    i, j = (k + 1) % 3, (k + 2) % 3
    origins, directions = np.empty((*s.shape, 3)), np.empty((*s.shape, 3))
    origins[..., i], origins[..., j], origins[..., k] = s, t, slab.plane
    directions[..., i], directions[..., j], directions[..., k] = u, v, 1 - 2 * (slab.face % 2)
    return origins.reshape(-1, 3), directions.reshape(-1, 3)


def check(file: Path, room_from_lfslab, blur: float, expected, tolerance: float) -> None:
    """Holds every stored texel that sees one colour only, within `blur` texels of its centre, to that colour. `expected` makes of
    linear colours what the file stores."""
    field = lfslab.LightField(file.read_bytes())
    matrix = np.array(room_from_lfslab, float)
    assert [slab.face for slab in field.slabs] == list(range(6))
    compared = stored = 0
    for number, slab in enumerate(field.slabs):
        seen = []
        for offset in ((0, 0), (-blur, -blur), (blur, -blur), (-blur, blur), (blur, blur)):
            origins, directions = texel_rays(slab, offset)
            seen.append(colors(origins @ matrix.T + CELL_CENTER, directions @ matrix.T))
        texels = field.texels(number)
        there = np.zeros(texels.shape[:4], bool)
        for t, s in np.ndindex(there.shape[:2]):
            there[t, s][slab.window(s, t)] = True
        plain = np.all(np.array(seen) == seen[0], axis=(0, 2)) & there.ravel()
        found = texels.reshape(-1, 3)[plain].astype(float)
        error = np.abs(found - expected(seen[0][plain]))
        assert error.max() <= tolerance, f"slab {number}: off by up to {error.max()}, {np.mean(error > tolerance):.1%} of values"
        compared, stored = compared + plain.sum(), stored + there.sum()
    # With fewer the check would prove little.
    assert compared > (0.9 if blur < 0.1 else 0.6) * stored, (compared, stored)
    print(f"{file.name}: {compared} of {stored} texels compared")


def srgb8(linear: np.ndarray) -> np.ndarray:
    """IEC 61966-2-1."""
    return np.round(255 * np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055))
