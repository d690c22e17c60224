"""Grids, benchmark scenes, quilts and `transforms.json`: every pixel, and every number about the cameras.

The oracle is `transforms.json` itself: each pixel of each of its pictures is turned into a ray in world space, as OpenGL cameras
do, and has to have the texel that the slab stores for that ray. The other exports are held to those pictures and cameras.

    python check_pictures.py SAMPLES
"""

import configparser
import json
import re

import numpy as np
import OpenEXR
import OpenImageIO as oiio

from samples import FOLDER, samples

AXES = {"X": 0, "Y": 1, "Z": 2}


def png(path) -> np.ndarray:
    picture = oiio.ImageInput.open(str(path))
    assert picture, oiio.geterror()
    assert picture.spec().nchannels == 3
    return np.asarray(picture.read_image("uint8"))


class Face:
    """The pictures and cameras of one slab, by row and column."""

    def __init__(self, facts: dict, expected: str, frames: dict):
        self.facts, self.frames = facts, frames
        counts = [facts[a]["count"] for a in "tsvu"]
        self.texels = np.frombuffer((FOLDER / expected).read_bytes(), np.uint8).reshape(*counts, 3)
        self.pictures = {at: png(FOLDER / "nerf" / frame["file_path"]) for at, frame in frames.items()}
        self.grid = tuple(max(at[i] for at in frames) + 1 for i in (0, 1))

    def index(self, axis: str, coordinate: np.ndarray) -> np.ndarray:
        index = (coordinate - self.facts[axis]["first"]) / self.facts[axis]["step"]
        assert np.abs(index - np.round(index)).max() < 1e-3, (axis, index)
        return np.round(index).astype(int)

    def check_rays(self) -> None:
        k, sign = AXES[self.facts["face"][1]], 1.0 if self.facts["face"][0] == "+" else -1.0
        i, j = (k + 1) % 3, (k + 2) % 3
        for at, frame in self.frames.items():
            matrix, picture = np.array(frame["transform_matrix"]), self.pictures[at]
            assert np.allclose(matrix[:3, :3].T @ matrix[:3, :3], np.eye(3)) and np.linalg.det(matrix[:3, :3]) > 0.999
            assert picture.shape[:2] == (frame["h"], frame["w"])
            assert abs(2 * np.arctan(frame["w"] / 2 / frame["fl_x"]) - frame["camera_angle_x"]) < 1e-9
            x, y = np.meshgrid(np.arange(frame["w"]) + 0.5, np.arange(frame["h"]) + 0.5)
            camera = np.stack(
                [(x - frame["cx"]) / frame["fl_x"], -(y - frame["cy"]) / frame["fl_y"], -np.ones_like(x)], -1
            )
            rays = camera @ matrix[:3, :3].T
            assert np.allclose(rays[..., k], sign)
            eye = matrix[:3, 3] - self.facts["center"]
            assert abs(eye[k] - self.facts["plane"]) < 1e-6
            s, t = self.index("s", eye[i]), self.index("t", eye[j])
            stored = self.texels[t, s, self.index("v", rays[..., j]), self.index("u", rays[..., i])]
            assert np.array_equal(picture, stored), (self.facts["face"], at)

    def right_down(self, at) -> np.ndarray:
        matrix = np.array(self.frames[at]["transform_matrix"])
        return np.array([matrix[:3, 0] @ matrix[:3, 3], -matrix[:3, 1] @ matrix[:3, 3]])

    def check_order(self) -> None:
        """Columns run to the right, rows downwards."""
        for row, column in self.frames:
            here = self.right_down((row, column))
            if column > 0:
                assert (here - self.right_down((row, column - 1)))[0] > 1e-3
            if row > 0:
                assert (here - self.right_down((row - 1, column)))[1] > 1e-3


def check_stanford(face: Face, folder) -> None:
    files = sorted(folder.iterdir())
    assert len(files) == len(face.frames)
    for file in files:
        name = re.fullmatch(r"out_(\d\d)_(\d\d)_(-?[\d.]+)_(-?[\d.]+)\.png", file.name)
        at = (int(name[1]), int(name[2]))
        assert np.array_equal(png(file), face.pictures[at]), file
        assert np.allclose(face.right_down(at), [1e-3 * float(name[4]), 1e-3 * float(name[3])], atol=1e-7), file


def check_exr(face: Face, folder) -> None:
    files = sorted(folder.iterdir())
    assert len(files) == len(face.frames)
    for file in files:
        with OpenEXR.File(str(file)) as exr:
            pixels = exr.channels()["RGB"].pixels
            primaries = exr.header()["chromaticities"]
        at = tuple(int(part) for part in file.stem.split("_"))
        assert pixels.dtype == np.float16
        assert np.array_equal(pixels, (face.pictures[at] / 16).astype(np.float16)), file
        assert np.allclose(np.ravel(primaries), [0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329]), primaries


def blender_rotation(rx: float, ry: float, rz: float) -> np.ndarray:
    """Blender's Euler angles in the order XYZ: first about X, then Y, then Z, all fixed."""
    def about(axis: int, angle: float) -> np.ndarray:
        c, s = np.cos(angle), np.sin(angle)
        i, j = (axis + 1) % 3, (axis + 2) % 3
        out = np.eye(3)
        out[i, i], out[i, j], out[j, i], out[j, j] = c, -s, s, c
        return out

    return about(2, rz) @ about(1, ry) @ about(0, rx)


def check_hci(face: Face, folder) -> None:
    parser = configparser.ConfigParser()
    with open(folder / "parameters.cfg") as file:
        parser.read_file(file)
    inside, outside, meta = parser["intrinsics"], parser["extrinsics"], parser["meta"]
    rows, columns = face.grid
    frame = face.frames[(0, 0)]
    width, height = inside.getint("image_resolution_x_px"), inside.getint("image_resolution_y_px")
    assert (width, height) == (frame["w"], frame["h"])
    focal = inside.getfloat("focal_length_mm") / inside.getfloat("sensor_size_mm") * max(width, height)
    assert abs(focal - frame["fl_x"]) < 1e-6 * focal
    assert (outside.getint("num_cams_x"), outside.getint("num_cams_y")) == (columns, rows)
    baseline = 1e-3 * outside.getfloat("baseline_mm")
    assert np.allclose(face.right_down((1, 1)) - face.right_down((0, 0)), baseline, atol=1e-7)
    assert outside.getfloat("offset") < 1e-3
    assert abs(meta.getfloat("disp_max") - baseline * focal / 1.0) < 1e-3
    assert abs(meta.getfloat("disp_min") - baseline * focal / 8.0) < 1e-3
    for name in ("scene", "category", "date", "version", "authors", "contact", "depth_map_scale", "frustum_disp_min"):
        assert name in meta, name
    assert meta["scene"] == f"100 % {folder.name}", meta["scene"]
    # Blender's world has +Z up: its (x, y, z) is our (x, z, −y).
    ours = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])
    angles = [outside.getfloat(f"center_cam_r{axis}_rad") for axis in "xyz"]
    matrices = [np.array(each["transform_matrix"]) for each in face.frames.values()]
    assert np.allclose(ours @ blender_rotation(*angles), matrices[0][:3, :3], atol=1e-6)
    center = ours @ np.array([outside.getfloat(f"center_cam_{axis}_m") for axis in "xyz"])
    assert np.allclose(center, np.mean([matrix[:3, 3] for matrix in matrices], axis=0), atol=1e-6)
    for index in range(rows * columns):
        picture = png(folder / f"input_Cam{index:03d}.png")
        assert np.array_equal(picture, face.pictures[divmod(index, columns)]), (folder, index)
    assert len(list(folder.glob("input_Cam*.png"))) == rows * columns


def check_quilt(face: Face, sample: dict) -> None:
    quilt = png(FOLDER / sample["file"])
    columns, rows, aspect = re.search(r"_qs(\d+)x(\d+)a([\d.]+)\.png$", sample["file"]).groups()
    columns, rows = int(columns), int(rows)
    assert columns * rows == face.grid[1]
    for view in range(columns * rows):
        picture = face.pictures[(sample["row"], view)]
        height, width = picture.shape[:2]
        # From the bottom left to the right, then up.
        x, y = view % columns * width, quilt.shape[0] - (view // columns + 1) * height
        assert np.array_equal(quilt[y : y + height, x : x + width], picture), view
    frame = face.frames[(0, 0)]
    assert abs(float(aspect) - (frame["w"] / frame["fl_x"]) / (frame["h"] / frame["fl_y"])) < 1e-5


def faces() -> dict[str, Face]:
    """Each face of `transforms.json`, with the numbers of the camera in each frame."""
    root = json.loads((FOLDER / "nerf/transforms.json").read_text())
    shared = {key: value for key, value in root.items() if key != "frames"}
    found = {}
    for sample in samples("png"):
        name = sample["file"].split("/")[1]
        frames = {}
        for frame in root["frames"]:
            folder, file = frame["file_path"].split("/")
            if folder == name:
                row, column = file.removesuffix(".png").split("_")
                frames[(int(row), int(column))] = shared | frame
        found[name] = Face(sample["of"]["slab"], sample["of"]["expected"], frames)
    assert len(root["frames"]) == sum(len(face.frames) for face in found.values())
    return found


FACES = faces()
for face in FACES.values():
    face.check_rays()
    face.check_order()
print("transforms.json", "ok")
for each in samples("png", "exr", "hci", "quilt"):
    face = FACES[re.split(r"[/_]", each["file"])[1]]
    checks = {"png": check_stanford, "exr": check_exr, "hci": check_hci}
    if each["kind"] == "quilt":
        check_quilt(face, each)
    else:
        checks[each["kind"]](face, FOLDER / each["file"])
    print(each["file"], "ok")
