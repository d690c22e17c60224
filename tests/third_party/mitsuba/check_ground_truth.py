"""Our tracer agrees with Mitsuba 3 on the same rays: direct light in the museum, all light in the museum and among mirror spheres under
area lights. Few rays, so that it is quick; `full.py` has the figures. Seeds are fixed: the outcome does not change by chance."""

from __future__ import annotations

import sys
from pathlib import Path

import mitsuba as mi

# Needs no library beside it; the vectorised variants want LLVM.
mi.set_variant("scalar_rgb")

import compare
import plugins

# Squared relative error, noise included; of normal errors 0.27 % are beyond three standard errors.
MAX_RELATIVE_MSE = 0.01
MAX_BEYOND_THREE = 0.01
MAX_MEAN_DIFFERENCE = 3.0


def check(folder: Path) -> None:
    result = compare.compare(folder, compare.summary_of(folder)["samples"])
    print(vars(result))
    if result.bounces == 1:
        assert result.relative_mse < MAX_RELATIVE_MSE, result
    assert result.other_hits == 0, result
    assert result.beyond_three < MAX_BEYOND_THREE, result
    assert result.mean_difference < MAX_MEAN_DIFFERENCE, result


def main() -> None:
    plugins.register()
    folders = sorted((Path(sys.argv[1]) / "ground-truth").iterdir())
    assert len(folders) == 3, folders
    for folder in folders:
        check(folder)


if __name__ == "__main__":
    main()
