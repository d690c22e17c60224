"""A light field of POV-Ray's patio, and a mirror sphere in it beside POV-Ray's own.

    python patio.py patio-radio_37.pov OUT [--threads N] [--focus DEPTH]

needs POV-Ray 3.7, numpy and OpenImageIO, and `lfslab` on the path or its file in the variable LFSLAB. Writes to the folder OUT and goes
on where it was stopped. The scene (CC BY 3.0) is in Debian's package povray-examples.
"""

import argparse
import os
import re
import resource
import subprocess
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

LFSLAB = os.environ.get("LFSLAB", "lfslab")
# Beside a column, in POV-Ray's left-handed coordinates, centimetres; nothing stands within an edge length of the centre.
CENTER, EDGE = np.array([370.0, 150.0, 60.0]), 60.0
# As `lfslab render` has them: the radius of its sphere and its eye in edge lengths, its field of view in radians.
RADIUS, EYE, FIELD_OF_VIEW = 0.48, np.array([1.4, 0.5, 0.6]), 0.67
SIZE = 512
PANORAMA = "+W1024", "+H512"
SPHERE = """
sphere {{ <{}, {}, {}>, {}
  pigment {{ rgb 0 }} finish {{ ambient 0 emission 0 diffuse 0 reflection {{ 1 }} }}
  no_shadow no_radiosity
}}
"""


def run(*command: str, cwd: Path | None = None) -> None:
    outcome = subprocess.run(command, cwd=cwd, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace")
    if outcome.returncode != 0:
        raise SystemExit(f"{' '.join(command)}\n{outcome.stdout}")
    if "lfslab" in command[0]:
        print(outcome.stdout, end="")


def write_scenes(original: Path, folder: Path) -> None:
    """The scene with cameras of ours. Radiosity is gathered once, in a panorama from the cell, and only looked up in all others."""
    gathering = original.read_text(errors="replace")
    looking_up = re.sub(r"pretrace_start \S+", "pretrace_start 1 always_sample off", gathering)
    looking_up = re.sub(r"pretrace_end +\S+", "pretrace_end 1", looking_up)
    looking_up = re.sub(r"error_bound \S+", "error_bound 0.5", looking_up)
    assert looking_up != gathering, f"{original} is another scene"
    eye = CENTER + EDGE * EYE * [1, 1, -1]  # POV-Ray's z is the negative of ours
    height = 2 * np.tan(FIELD_OF_VIEW / 2)
    camera = (
        "camera {{ location <{},{},{}> right {height}*x up {height}*y direction z look_at <{},{},{}> }}\n".format(
            *eye, *CENTER, height=height
        )
    )
    panorama = "camera {{ spherical angle 360 180 location <{},{},{}> }}\n".format(*CENTER)
    sphere = SPHERE.format(*CENTER, RADIUS * EDGE)
    scenes = {
        "gather": panorama,
        "panorama": panorama,
        "frames": '#include "lfslab_camera.inc"\n',
        "mirror": sphere + camera,
    }
    for name, addition in scenes.items():
        text = gathering if name == "gather" else looking_up
        (folder / f"{name}.pov").write_text(text + "\n" + addition)


def render(folder: Path, threads: int) -> None:
    common = ["-D", "-P", f"+WT{threads}", "Radiosity_File_Name=patio.rad", "-GA"]
    if not (folder / "patio.rad").exists():
        run("povray", "+Igather.pov", "+Ogather.png", *PANORAMA, "-A", "Radiosity_To_File=on", *common, cwd=folder)
    common.append("Radiosity_From_File=on")
    run("povray", "lfslab.ini", "+Iframes.pov", "+C", "Antialias_Depth=2", *common, cwd=folder)
    print(f"pictures of this run: {resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime:.0f} s of one core")
    run("povray", "+Ipanorama.pov", "+Opanorama.png", *PANORAMA, "+A0.1", "+R3", *common, cwd=folder)
    run("povray", "+Imirror.pov", "+Omirror.png", f"+W{SIZE}", f"+H{SIZE}", "+A0.1", "+R3", *common, cwd=folder)


def png(path: Path) -> np.ndarray:
    picture = oiio.ImageInput.open(str(path))
    assert picture, oiio.geterror()
    return np.asarray(picture.read_image("uint8"))[..., :3]


def view_slopes() -> np.ndarray:
    """To the right of the columns, and downwards of the rows."""
    return np.tan(FIELD_OF_VIEW / 2) * (2 * (np.arange(SIZE) + 0.5) / SIZE - 1)


def sphere_mask() -> np.ndarray:
    """Pixels whose ray meets the sphere, less a rim of two pixels, where both programs blend it with what is behind."""
    slope = view_slopes()
    silhouette = RADIUS / np.sqrt(np.sum(EYE**2) - RADIUS**2)
    rim = 2 * (slope[1] - slope[0])
    return np.hypot(slope[:, None], slope[None, :]) < silhouette - rim


def by_panorama(panorama: np.ndarray, mask: np.ndarray) -> np.ndarray:
    """What a mirror shows of a picture of all directions from the cell's centre: no parallax. Nearest pixels of [row, column, channel]."""
    eye = EYE * [1, 1, -1]
    forward = -eye / np.linalg.norm(eye)
    right = np.cross([0, 1, 0], forward)  # of a left-handed world
    right /= np.linalg.norm(right)
    up = np.cross(forward, right)
    y, x = np.meshgrid(-view_slopes(), view_slopes(), indexing="ij")
    ray = (forward + x[..., None] * right + y[..., None] * up)[mask]
    ray /= np.linalg.norm(ray, axis=1, keepdims=True)
    along = -ray @ eye
    normal = (eye + (along - np.sqrt(along**2 - eye @ eye + RADIUS**2))[:, None] * ray) / RADIUS
    mirrored = ray - 2 * np.sum(ray * normal, axis=1, keepdims=True) * normal
    height, width = panorama.shape[:2]
    column = (np.arctan2(mirrored[:, 0], mirrored[:, 2]) / (2 * np.pi) + 0.5) * width
    row = (0.5 - np.arcsin(np.clip(mirrored[:, 1], -1, 1)) / np.pi) * height
    return panorama[np.clip(row.astype(int), 0, height - 1), column.astype(int) % width]


def psnr(a: np.ndarray, b: np.ndarray) -> float:
    return 10 * np.log10(255**2 / np.mean((a.astype(float) - b.astype(float)) ** 2))


def write_small(pictures: list[np.ndarray], path: Path) -> None:
    """Side by side, at five eighths of their size."""
    row = np.ascontiguousarray(np.concatenate(pictures, axis=1))
    height, width = row.shape[:2]
    small = oiio.ImageBufAlgo.resize(oiio.ImageBuf(row), roi=oiio.ROI(0, width * 5 // 8, 0, height * 5 // 8, 0, 1, 0, 3))
    small.write(str(path), "uint8")


def compare(folder: Path) -> None:
    """PSNR over the sphere's pixels; also of what is wrong in ways that a conversion of coordinates could be, and of a panorama."""
    theirs, ours, mask = png(folder / "mirror.png"), png(folder / "ours.png"), sphere_mask()
    flat = theirs.copy()
    flat[mask] = by_panorama(png(folder / "panorama.png"), mask)
    pictures = {
        "slabs": ours,
        "slabs, mirrored": ours[:, ::-1],
        "slabs, upside down": ours[::-1],
        "panorama from the cell's centre": flat,
    }
    print(f"PSNR over the {mask.sum()} pixels of the sphere")
    for name, picture in pictures.items():
        print(f"  {name:32} {psnr(theirs[mask], picture[mask]):5.2f} dB")
    write_small([theirs, np.where(mask[..., None], ours, theirs), flat], folder / "patio.png")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--focus", type=float, default=300.0, help="distance of the focal planes from the camera planes")
    options = parser.parse_args()
    folder = options.out
    cell = ",".join(str(x) for x in (*CENTER, EDGE))
    run(LFSLAB, "plan", "--world", "povray", "--cell", cell, "--cameras", "16", "--resolution", "64", "--planes", "center", "--out", str(folder))
    write_scenes(options.scene, folder)
    render(folder, options.threads)
    file = str(folder / "patio.lfslab")
    run(LFSLAB, "import", str(folder), "--out", file, "--focal-plane", str(options.focus), "--license", "CC-BY-3.0")
    eye = ",".join(str(x) for x in EYE)
    run(LFSLAB, "render", file, "--cpu", "--reflector", "sphere", "--eye", eye, "--size", str(SIZE), "--out", str(folder / "ours.png"))
    compare(folder)


main()
