"""Runs every check of other people's programs on our files: `*/check_*.py` beside this file, with the folder of samples.

    python run.py SAMPLES

`cargo xtask test` runs it in the virtual environment that it makes. A check finds our Python reader on its path, and the folder
of Node modules in NODE_PATH.
"""

import os
import subprocess
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
READER = HERE.parents[1] / "spec" / "python"
NODE_MODULES = Path(sys.prefix).parent / "node" / "node_modules"


def passes(check: Path, samples: str) -> bool:
    """Whether the check ends well; one line says so, and what it printed follows if not."""
    variables = {"PYTHONPATH": str(READER), "NODE_PATH": str(NODE_MODULES), "PYTHONDONTWRITEBYTECODE": "1"}
    start = time.monotonic()
    command = [sys.executable, str(check), samples]
    outcome = subprocess.run(
        command, check=False, env=os.environ | variables, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
    )
    passed = outcome.returncode == 0
    name, seconds = check.relative_to(HERE).as_posix(), time.monotonic() - start
    print(f"{name:40} {'passed' if passed else 'FAILED'} {seconds:6.1f} s", flush=True)
    if not passed:
        print(outcome.stdout.decode(errors="replace"), flush=True)
    return passed


def main() -> None:
    samples = str(Path(sys.argv[1]).resolve())
    checks = sorted(HERE.glob("*/check_*.py"))
    outcomes = [passes(check, samples) for check in checks]
    if not outcomes or not all(outcomes):
        sys.exit(f"{outcomes.count(False)} of {len(outcomes)} checks failed")


if __name__ == "__main__":
    main()
