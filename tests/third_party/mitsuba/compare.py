"""Holds our tracer against Mitsuba 3 on the same rays.

    cargo run --release -p lf-tests --example ground_truth -- OUT --scene museum
    python compare.py OUT [--samples N] [--variant scalar_rgb] [--json FILE]

Prints, for each folder, how far the two are apart: relative mean squared error (the mean over rays and channels of
(a − b)² / (b² + 0.01·mean(b)²)), z-scores (the difference over both standard errors), the means of all rays, and rates.
`llvm_ad_rgb` is much faster; it needs LLVM's library, named by DRJIT_LIBLLVM_PATH where it is not found.
"""

from __future__ import annotations

import argparse
import json
import time
from dataclasses import dataclass
from pathlib import Path

import drjit as dr
import mitsuba as mi
import numpy as np

# Rays times paths that one call of the vectorised variant holds.
WAVEFRONT = 1 << 20


@dataclass
class Agreement:
    """How far two tracers are apart on the same rays."""

    scene: str
    bounces: int
    rays: int
    # Hits at another distance than ours by more than a thousandth.
    other_hits: float
    relative_mse: float
    # The same without noise: what both standard errors explain is taken off.
    unexplained_mse: float
    # Share of values further apart than three standard errors; 0.0027 for normal errors.
    beyond_three: float
    # Difference of the means over all rays in standard errors, the worst channel.
    mean_difference: float
    # Mean over all rays and channels, ours over theirs, less 1; and of the rays that meet a surface whose interpolated normal is within a
    # degree of the triangle's.
    mean_ratio: float
    mean_ratio_flat: float
    # Million rays a second, ours and theirs: nearest hits, then paths.
    hits_per_second: list
    paths_per_second: list


def summary_of(folder: Path) -> dict:
    """What our side says of itself."""
    return json.loads((folder / "ours.json").read_text())


def compare(folder: Path, samples: int) -> Agreement:
    """Traces the rays of a folder with Mitsuba and compares."""
    import scene as loader

    summary = summary_of(folder)
    rays = np.fromfile(folder / "rays.f32", "<f4").reshape(-1, 6)
    ours = np.fromfile(folder / "ours.f32", "<f4").reshape(-1, 7).astype(np.float64)
    loaded = loader.load(folder)
    distance, hit_seconds = nearest(loaded, rays)
    start = time.monotonic()
    theirs, error = radiance(loaded, rays, summary["bounces"], samples)
    seconds = time.monotonic() - start
    reply = (distance, theirs, error, is_flat(loaded, rays))
    return agreement(summary, ours, reply, (hit_seconds, seconds / samples * summary["samples"]))


def agreement(summary: dict, ours: np.ndarray, reply: tuple, seconds: tuple) -> Agreement:
    (distance, theirs, error, flat), (hit_seconds, path_seconds) = reply, seconds
    mean, own_error = ours[:, 0:3], ours[:, 3:6]
    same = np.isclose(ours[:, 6], distance, rtol=1e-3) | (np.isinf(ours[:, 6]) & np.isinf(distance))
    difference, variance = mean - theirs, own_error**2 + error**2
    weight = 1 / (theirs**2 + 0.01 * np.mean(theirs) ** 2)
    certain = variance > 1e-12 * np.mean(theirs) ** 2
    z = np.abs(difference[certain]) / np.sqrt(variance[certain])
    total = np.sqrt(np.sum(variance, axis=0))
    count, paths = len(mean), len(mean) * summary["samples"]
    return Agreement(
        scene=summary["scene"],
        bounces=summary["bounces"],
        rays=count,
        other_hits=float(np.mean(~same)),
        relative_mse=float(np.mean(difference**2 * weight)),
        unexplained_mse=float(np.mean((difference**2 - variance) * weight)),
        beyond_three=float(np.mean(z > 3)) if z.size else 0.0,
        mean_difference=float(np.max(np.abs(np.sum(difference, axis=0)) / np.maximum(total, 1e-30))) if z.size else 0.0,
        mean_ratio=float(np.mean(mean) / np.mean(theirs) - 1),
        mean_ratio_flat=float(np.mean(mean[flat]) / np.mean(theirs[flat]) - 1),
        hits_per_second=[count / summary["nearest_hit_seconds"] / 1e6, count / hit_seconds / 1e6],
        paths_per_second=[paths / summary["seconds"] / 1e6, paths / path_seconds / 1e6],
    )


def nearest(scene: mi.Scene, rays: np.ndarray) -> tuple[np.ndarray, float]:
    """Distances of the nearest hits, and the seconds it took."""
    if mi.variant().startswith("scalar"):
        made = [ray(values) for values in rays]
        start = time.monotonic()
        hits = [float(scene.ray_intersect_preliminary(one).t) for one in made]
        return np.array(hits), time.monotonic() - start
    # Compiles.
    distance = np.array(scene.ray_intersect_preliminary(beams(rays)).t)
    repeats = max(1, WAVEFRONT // len(rays))
    beam = beams(np.tile(rays, (repeats, 1)))
    dr.eval(beam)
    dr.sync_thread()
    start = time.monotonic()
    dr.eval(scene.ray_intersect_preliminary(beam).t)
    dr.sync_thread()
    return distance.astype(np.float64), (time.monotonic() - start) / repeats


def is_flat(scene: mi.Scene, rays: np.ndarray) -> np.ndarray:
    """Whether the interpolated normal where a ray hits is within a degree of the triangle's, on either side."""

    def cosine(hit: mi.SurfaceInteraction3f):
        return dr.abs(dr.dot(hit.n, hit.sh_frame.n))

    if mi.variant().startswith("scalar"):
        cosines = np.array([cosine(scene.ray_intersect(ray(values))) for values in rays])
    else:
        cosines = np.array(cosine(scene.ray_intersect(beams(rays))))
    return cosines > np.cos(np.radians(1))


def radiance(scene: mi.Scene, rays: np.ndarray, bounces: int, samples: int) -> tuple[np.ndarray, np.ndarray]:
    """Mean radiance and its standard error, a row for each ray."""
    integrator = mi.load_dict({"type": "path", "max_depth": bounces + 1})
    sampler = mi.load_dict({"type": "independent"})
    if mi.variant().startswith("scalar"):
        sampler.seed(1)
        one = lambda beam: np.array(list(integrator.sample(scene, sampler, beam)[0]))
        return moments(np.array([[one(ray(values)) for _ in range(samples)] for values in rays]))
    at_once = max(1, WAVEFRONT // samples)
    parts = []
    for number, first in enumerate(range(0, len(rays), at_once)):
        part = np.repeat(rays[first : first + at_once], samples, axis=0)
        sampler.seed(number, len(part))
        values = np.array(integrator.sample(scene, sampler, beams(part))[0]).T
        parts.append(moments(values.astype(np.float64).reshape(-1, samples, 3)))
    return np.concatenate([mean for mean, _ in parts]), np.concatenate([error for _, error in parts])


def moments(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    count = values.shape[1]
    return values.mean(axis=1), values.std(axis=1, ddof=1) / np.sqrt(count)


def ray(values: np.ndarray) -> mi.RayDifferential3f:
    values = values.tolist()
    return mi.RayDifferential3f(mi.Ray3f(values[:3], values[3:]))


def beams(rays: np.ndarray) -> mi.RayDifferential3f:
    column = [mi.Float(np.ascontiguousarray(rays[:, i])) for i in range(6)]
    return mi.RayDifferential3f(mi.Ray3f(mi.Point3f(*column[:3]), mi.Vector3f(*column[3:])))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--samples", type=int, default=256)
    parser.add_argument("--variant", default="llvm_ad_rgb")
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    mi.set_variant(arguments.variant)
    import plugins

    plugins.register()
    results = [compare(folder, arguments.samples) for folder in arguments.folders]
    for result in results:
        print(json.dumps(vars(result), indent=1))
    if arguments.json:
        arguments.json.write_text(json.dumps([vars(result) for result in results], indent=1))


if __name__ == "__main__":
    main()
