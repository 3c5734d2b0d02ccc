"""Runs of splatlas-preprocess and splatlas-player: atlases from arrays, and pages."""
from __future__ import annotations

import csv
import dataclasses
import html
import os
import pathlib
import shutil
import subprocess
import tempfile
import warnings
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from splatlas._arguments import Error, checked


class Warning(UserWarning):
    """What is odd in the sources of an atlas, a selection or a picture."""


@dataclasses.dataclass(frozen=True)
class Page:
    """A page that plays an atlas: `html` is the text of its file, `height` in pixels that of its cell."""

    html: str = dataclasses.field(repr=False)
    height: int

    def _repr_html_(self) -> str:
        return (f'<iframe srcdoc="{html.escape(self.html)}" width="100%" height="{self.height}" '
                'sandbox="allow-scripts allow-downloads" style="border: 0"></iframe>')


@checked
def build(output: str | bytes | os.PathLike, *, labels: Any = None, volume: Any = None,
          affine: ArrayLike | None = None, names: Any = None, tree: str | os.PathLike | Iterable[str] | None = None,
          meshes: Mapping[str, Sequence[ArrayLike]] | None = None, options: Sequence[str] = ()) -> None:
    """Builds the atlas `output` with splatlas-preprocess. Its notes become warnings.

    Parameters
    ----------
    labels, volume : path, image of nibabel, or (i, j, k) array with `affine`
        labels also {group: one of these}.
    affine : (4, 4) floats
        Voxel indices of arrays to RAS mm.
    names : path, {label: name}, pandas.DataFrame, or rows
        Rows are mappings with label, name, color ("#rrggbb") and other columns of CSV tables.
    tree : path, or lines such as "Brain/Left/Precentral_L"
    meshes : {name: (vertices (n, 3) in RAS mm, triangles (m, 3))}
    options : more options of `splatlas-preprocess build`
    """
    groups = dict(labels) if isinstance(labels, Mapping) else {"": labels}
    have_affines = [image is None or isinstance(image, (str, os.PathLike)) or hasattr(image, "dataobj")
                    for image in (*groups.values(), volume)]
    if affine is not None and all(have_affines):
        raise ValueError("affine: files and images have their own; it is for arrays")
    for name in (*groups, *(meshes or {})):
        if "=" in str(name) or (name in groups and "/" in str(name)):
            raise ValueError(f"{name!r}: names of meshes and groups hold no '=', and of groups no '/'")
    with tempfile.TemporaryDirectory(prefix="splatlas-") as folder:
        files = pathlib.Path(folder)
        words = ["build", f"--output={os.fsdecode(output)}", "--progress=none"]
        for number, (group, image) in enumerate(groups.items()):
            if image is not None:
                path = _image_file(image, affine, files / f"labels{number or ''}.nrrd", "labels")
                words.append(f"--labels={group}={path}" if group else f"--labels={path}")
        if volume is not None:
            words.append(f"--volume={_image_file(volume, affine, files / 'volume.nrrd', 'volume')}")
        if names is not None:
            words.append(f"--names={_names_file(names, files / 'names.csv')}")
        if tree is not None:
            if "\n" in tree:  # type: ignore
                tree, lines = files / "names.tree", tree
                tree.write_text(lines, encoding="utf-8")  # type: ignore
            words.append(f"--tree={tree}")
        for number, (name, mesh) in enumerate((meshes or {}).items()):
            words.append(f"--mesh={name}={_mesh_file(*mesh, files / f'{number}.obj')},frame=ras")  # type: ignore
        _run("splatlas-preprocess", [*words, *options], folder, stacklevel=4)


def page_of(path: str, select: str | None, scene: str | None, height: int) -> Page:
    with tempfile.TemporaryDirectory(prefix="splatlas-") as folder:
        page = pathlib.Path(folder, "page.html")
        named = {"html": page, "select": select, "scene": scene}
        words = [f"--{option}={value}" for option, value in named.items() if value is not None]
        _run("splatlas-player", ["export", path, *words], folder, stacklevel=5)
        return Page(page.read_text(encoding="utf-8"), height)


def _run(program: str, words: list[str], folder: str, stacklevel: int) -> None:
    beside = pathlib.Path(__file__).parents[2] / "bin" / program  # in a build
    found = os.fspath(beside) if beside.exists() else shutil.which(program)
    if found is None:
        raise Error(f"{program} is not installed, or not in PATH")
    done = subprocess.run([found, *words], capture_output=True, text=True, errors="replace")
    lines = done.stderr.replace(f"{folder}/", "").splitlines()
    last = lines.pop() if lines and done.returncode != 0 else ""
    for line in lines:
        kind, _, text = line.partition(": ")
        if kind in ("note", "warning"):
            warnings.warn(text, Warning, stacklevel=stacklevel)
    if done.returncode != 0:
        message = last.removeprefix(f"{program}: ") or f"{program}: ended with {done.returncode}"
        subject = message.partition(": ")[0].partition(' "')[0]
        kind = {2: "usage", 3: "invalid atlas", 4: "not found"}.get(done.returncode, "failed")
        raise Error(message, kind, subject if any(subject in word for word in words) else "")


def _image_file(image: Any, affine: Any, path: pathlib.Path, what: str) -> str:
    if isinstance(image, (str, os.PathLike)):
        return os.fspath(image)
    if hasattr(image, "dataobj"):  # nibabel
        mm = {"meter": 1000, "micron": 0.001}.get(image.header.get_xyzt_units()[0], 1) if hasattr(
            image.header, "get_xyzt_units") else 1
        image, affine = np.asanyarray(image.dataobj), np.diag((mm, mm, mm, 1)) @ image.affine
    array = np.asarray(np.ma.filled(image, 0))
    while array.ndim > 3 and array.shape[-1] == 1:
        array = array[..., 0]
    if array.ndim != 3 or 0 in array.shape:
        raise ValueError(f"{what}: an array of shape {array.shape}; it must have three axes, none of them empty")
    if affine is None:
        raise ValueError(f"{what}: an array needs affine=, the map from voxel indices to RAS mm")
    if not np.isfinite(affine).all() or not np.array_equal(affine[3], (0, 0, 0, 1)):
        raise ValueError("affine: must be 4 x 4 finite numbers, with 0, 0, 0, 1 in the last row")
    array = _storable(array, what)
    vector = "({!r},{!r},{!r})".format
    columns = [vector(*map(float, affine[:3, axis])) for axis in range(4)]
    header = ("NRRD0005", f"type: {array.dtype.name.replace('float32', 'float').replace('float64', 'double')}",
              "dimension: 3", "space: right-anterior-superior", "sizes: {} {} {}".format(*array.shape),
              f"space directions: {' '.join(columns[:3])}", f"space origin: {columns[3]}", "endian: little",
              "encoding: raw", "", "")
    with open(path, "wb") as file:
        file.write("\n".join(header).encode())
        file.write(array.astype(array.dtype.newbyteorder("<"), copy=False).tobytes(order="F"))
    return os.fspath(path)


def _storable(array: np.ndarray, what: str) -> np.ndarray:
    """The array with a type that atlases have, and the same values."""
    if array.dtype.kind not in "buif":
        raise ValueError(f"{what}: an array of {array.dtype}; it must hold integers, floats or booleans")
    integer = "int32" if array.min() < 0 else "uint32"
    types = {"bool": "uint8", "float16": "float32", "float128": "float64", "int64": integer, "uint64": integer}
    stored = array.astype(types.get(array.dtype.name, array.dtype))
    if array.dtype.kind in "iu" and not np.array_equal(stored, array):
        raise ValueError(f"{what}: holds {array.min()} to {array.max()}; an atlas has integers of 32 bits")
    return stored


def _names_file(names: Any, path: pathlib.Path) -> str:
    if isinstance(names, (str, os.PathLike)):
        return os.fspath(names)
    if hasattr(names, "to_dict"):  # pandas
        names = names.to_dict("records") if names.ndim == 2 else names.to_dict()
    if isinstance(names, Mapping):
        names = [{"label": label, "name": name} for label, name in names.items()]
    rows = list(names) if isinstance(names, Iterable) else []
    if not rows or not all(isinstance(row, Mapping) for row in rows):
        raise ValueError("names: must be a path, {label: name}, a DataFrame or mappings with label and name")
    columns = list(dict.fromkeys(key for row in rows for key in row))
    with open(path, "w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, columns)
        writer.writeheader()
        writer.writerows(rows)
    return os.fspath(path)


def _mesh_file(vertices: np.ndarray, triangles: np.ndarray, path: pathlib.Path) -> str:
    for what, array in (("vertices", vertices), ("triangles", triangles)):
        if array.ndim != 2 or array.shape[1] != 3:
            raise ValueError(f"{what}: of shape {array.shape}; must be (n, 3)")
    if triangles.dtype.kind not in "iu" or not ((0 <= triangles) & (triangles < len(vertices))).all():
        raise ValueError(f"triangles: must be integers from 0 to {len(vertices) - 1}")
    with open(path, "w", encoding="ascii") as file:
        np.savetxt(file, vertices, fmt="v %.17g %.17g %.17g")
        np.savetxt(file, triangles.astype(np.int64) + 1, fmt="f %d %d %d")
    return os.fspath(path)
