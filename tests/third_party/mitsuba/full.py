"""All figures of docs/ground-truth.md: our tracer against Mitsuba 3 on the same rays of several scenes.

    python full.py SCENES ENVIRONMENT OUT

SCENES is the folder with `wooden-staircase.glb`, `japanese-classroom.glb` and `grey-white-room-small.glb`, ENVIRONMENT a panorama (.hdr)
that lights the last, OUT a folder for the scenes as Mitsuba reads them. Takes some minutes on two cores. Prints a table
in Markdown.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import mitsuba as mi

ROOT = Path(__file__).resolve().parents[3]
VARIANT = "llvm_ad_rgb"
# Scatterings, rays, paths a ray.
DIRECT = ["--bounces", "1", "--rays", "4096", "--samples", "4096"]
GLOBAL = ["--bounces", "8", "--rays", "4096", "--samples", "1024"]


def ours(out: Path, arguments: list[str]) -> None:
    """Writes a scene, rays and our answers."""
    command = ["cargo", "run", "-q", "--release", "-p", "lf-tests", "--example", "ground_truth", "--", str(out), *arguments]
    subprocess.run(command, check=True, cwd=ROOT)


def scenes(folder: Path, environment: Path) -> dict[str, list[str]]:
    """How each scene is named to our example."""
    return {
        "museum": ["--scene", "museum"],
        "mirror-box": ["--scene", "mirror-box"],
        "wooden-staircase": ["--scene", str(folder / "wooden-staircase.glb")],
        "japanese-classroom": ["--scene", str(folder / "japanese-classroom.glb")],
        "grey-white-room": ["--scene", str(folder / "grey-white-room-small.glb"), "--environment", str(environment)],
    }


def row(result) -> str:
    light = "direct" if result.bounces == 1 else f"global, {result.bounces} bounces"
    rates = [f"{ours:.2f} / {theirs:.2f}" for ours, theirs in (result.hits_per_second, result.paths_per_second)]
    figures = [
        f"{100 * result.relative_mse:.2f} %",
        f"{100 * result.unexplained_mse:.2f} %",
        f"{100 * result.beyond_three:.2f} %",
        f"{result.mean_difference:.2f} σ",
        f"{100 * result.mean_ratio:+.3f} %",
        f"{100 * result.mean_ratio_flat:+.3f} %",
        f"{100 * result.other_hits:.3f} %",
    ]
    return f"| {' | '.join([result.scene, light, *figures, *rates])} |"


def main() -> None:
    folder, environment, out = (Path(argument).resolve() for argument in sys.argv[1:4])
    mi.set_variant(VARIANT)
    import compare
    import plugins

    plugins.register()
    print("| scene | light | relMSE | beyond noise | further than 3 σ | difference of means | ratio of means − 1 | where flat | other hit | nearest hits, M/s | paths, M/s |")
    print("|---|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|")
    for name, scene in scenes(folder, environment).items():
        for light, options in (("direct", DIRECT), ("global", GLOBAL)):
            place = out / f"{name}-{light}"
            ours(place, [*scene, *options])
            print(row(compare.compare(place, int(options[-1]))), flush=True)


if __name__ == "__main__":
    main()
