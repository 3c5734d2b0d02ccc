"""Anatomy atlases in Python: pictures, label maps, grey values and surfaces as NumPy arrays.

>>> import splatlas
>>> atlas = splatlas.open("brain.atlas")
>>> atlas.render("Brain(ghost) + Thalamus*:surface", view="left").save("thalamus.png")

Points are in RAS mm and arrays have the order of axes of the source, as in nibabel. Errors of atlases and
selections are `splatlas.Error`, with a kind and a subject; odd things are `splatlas.Warning`.
"""
from __future__ import annotations

import json
import os
import threading
import warnings
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from splatlas import _engine
from splatlas._arguments import Error, Names, Structure, checked
from splatlas._programs import Page, Warning, build, page_of

__all__ = ["Atlas", "Error", "Page", "Picture", "Renderer", "Structure", "Warning", "build", "open"]


class Picture:
    """A rendered picture of (height, width) pixels, row 0 on top. It shows itself in notebooks.

    Attributes
    ----------
    array : (height, width, 3) uint8
        sRGB; with background=None (height, width, 4), the last is straight alpha.
    linear : (height, width, 4) float32
        Linear RGB, premultiplied by alpha, without background. Read only.
    ids : (height, width) uint16, or None without ids=True
        1 + `Structure.index` of what weighs most in each pixel, 0 for none. Read only.
    depth : (height, width) float32, or None without depth=True
        mm behind the plane of the centre; inf where a ray keeps over half its light. Read only.
    camera, ms : dict and float
        azimuth, elevation (degrees), zoom, center (RAS mm), projection, fieldOfView (degrees); time of the engine.
    """

    def __init__(self, renderer: Renderer, request: dict, background: str | None):
        self._background = None if background is None else _engine.Rgb(background)
        self._renderer, self._engine, self._structures = renderer, renderer._engine, renderer.atlas.structures
        renderer.atlas._opened()
        with renderer._turn:
            if renderer._selection[0] != request["select"]:
                renderer._selection = [request["select"]]
            self._selection = renderer._selection
            text, self._frame = self._engine.draw(json.dumps(request))  # type: ignore
            answer = json.loads(text)
            if "drawn" in answer:  # another selection, whose warnings are told once
                renderer._warnings = answer["warnings"]
            lines: list[str] = [*renderer._warnings, self._frame.emptiness(), *answer["missing"]]
        for line in filter(None, lines):
            warnings.warn(line, Warning, stacklevel=4)
        self.linear, self.ids, self.depth = self._frame.linear, self._frame.ids, self._frame.depth
        self.camera: dict[str, Any] = _flipped_center(answer["camera"])
        self.ms: float = answer["ms"]

    @property
    def array(self) -> np.ndarray:
        return self._frame.srgb(self._background).reshape(*self.linear.shape[:2], -1)

    def _repr_png_(self) -> bytes:
        return self._frame.png(self._background)

    @checked
    def pick(self, x: float, y: float) -> tuple[Structure, np.ndarray] | None:
        """The structure at column x and row y, in pixels from the top left corner; pixel [0, 0] is 0 to 1.

        None for the background. The point is (3,) float64 in RAS mm. One ray decides; of `ids` the whole pixel, which
        differs at some outlines. Raises Error once the renderer shows another selection.
        """
        with self._renderer._turn:
            if self._selection is not self._renderer._selection:
                raise Error("the renderer shows another selection by now; render the picture again", "usage")
            found = self._frame.pick(x, y)
        return found and (self._structures[found[0]], np.array(_flipped(found[1])))

    @checked
    def save(self, path: str | bytes | os.PathLike) -> None:
        """Writes a `path` in .png, .jpg, .tif, .exr (float), .svg or .pdf: whole, or not at all. Raises Error."""
        self._frame.save(path, self._background)  # type: ignore


class Renderer:
    """Draws pictures of one atlas, and keeps what it has decoded. Threads may share it; it draws in turn."""

    def __init__(self, atlas: Atlas | None, engine: _engine.Engine):
        self._atlas, self._engine = atlas, engine
        self._turn, self._selection, self._warnings = threading.Lock(), [""], list[str]()  # a list for each selection

    @property
    def atlas(self) -> Atlas:
        return self._atlas or self  # type: ignore  # an atlas is its own renderer

    @checked
    def render(self, select: str | None = None, *, scene: str | None = None, size: Sequence[int] = (800, 600),
               view: str | None = None, azimuth: float | None = None, elevation: float | None = None,
               zoom: float = 1, center: Sequence[float] | None = None, focus: str | Structure | None = None,
               camera: Mapping[str, Any] | None = None, projection: str | None = None,
               cuts: Mapping[str, float] | Iterable[str] | None = None, caps: str = "both",
               quality: str = "normal", shading: bool = True, depth_cue: bool = False,
               draft_budget_ms: float = 0, background: str | None = "#000000", ids: bool = False,
               depth: bool = False) -> Picture:
        """Draws a selection.

        Parameters
        ----------
        select : str
            As of `splatlas-player render --select`; None: that of the scene, or everything.
        scene : str
            Name of a scene, whose values the others replace.
        size : (int, int)
            Width and height in pixels.
        view : str
            anterior, posterior, left, right, superior or inferior; or `azimuth` and `elevation` in degrees.
        zoom : float
            Relative to the fit of the selection, or of the structure `focus`; multiplies that of a scene.
        center : (3,) floats
            Middle of the picture in RAS mm.
        camera : dict
            `Picture.camera`, in place of zoom, center and focus; view, azimuth and elevation turn it.
        projection, caps, quality : str
            perspective or parallel; values, labels, both or none; draft, normal or high.
        shading, depth_cue, draft_budget_ms : bool, bool, float
            Light volumes by their borders; darken what is far; time from which drafts are coarser, 0: never.
        cuts : dict or list of str
            {"left": 0} removes what lies further left than 0 mm; or texts as of `--cut`, in LPS mm.
        background : str
            "#rrggbb"; None: transparent.
        ids, depth : bool
            Fill `Picture.ids` and `Picture.depth`.
        """
        shown = self.atlas._named("scene", scene) if scene is not None else {}
        placed = {key: shown[key] for key in ("azimuth", "elevation", "projection") if key in shown}
        if camera is not None:
            if zoom != 1 or center is not None or focus is not None:
                raise ValueError("camera: takes the place of zoom, center and focus; change its values instead")
            placed |= _flipped_center(camera)
        seen = self.atlas._named("view", view) if view is not None else {}
        if not 1e-6 <= zoom <= 1e6:
            raise ValueError(f"zoom: {zoom!r}: must be from 1e-6 to 1e6")
        given = {"azimuth": azimuth, "elevation": elevation, "projection": projection}
        placed |= seen | {key: value for key, value in given.items() if value is not None}
        if camera is None:
            placed["fit"] = {"zoom": zoom * shown.get("zoom", 1),
                             "center": shown.get("center") if center is None else _flipped(center),
                             "structure": -1 if focus is None else self.atlas._one(focus)}
        planes = shown.get("cuts", []) if cuts is None else [
            {"normal": normal, "offset": offset} for normal, offset in _engine.parse_cuts(cuts)]  # type: ignore
        return Picture(self, {
            "call": "draw", "select": shown.get("select", "*") if select is None else select,
            "size": size, "camera": placed, "cuts": planes, "caps": caps,
            "quality": quality, "shading": shading, "depthCue": depth_cue, "draftBudget": draft_budget_ms,
            "ids": ids, "depths": depth}, background)


class Atlas(Renderer):
    """An atlas file. Parts are read when they are needed. `close()` or `with` ends it; threads may share it.

    Parameters
    ----------
    path : str or os.PathLike
    threads : int
        Of each renderer; 0: one per core.
    memory : int
        Bytes that decoded parts and pictures may take; 0: half of the machine's.
    max_work : float
        Limit of work in multiples of the usual one; below 1 for untrusted files.

    Attributes
    ----------
    structures : tuple of Structure
        Methods take `names`: a name as of `find()`, a Structure, or several of these.
    affine, shape : (4, 4) float64, (int, int, int)
        Voxel indices of the arrays to RAS mm, as nibabel's; shape of the arrays.
    scenes, path, info : tuple of str, str, dict
        Their names; absolute; the document of `splatlas-player info --json`.
    """

    @checked
    def __init__(self, path: str | bytes | os.PathLike, *, threads: int = 0, memory: int = 0, max_work: float = 1):
        if max_work <= 0:
            raise ValueError(f"max_work: {max_work!r}: must be above 0")
        self.path = os.path.abspath(os.fsdecode(path))
        self._file: _engine.File | None = _engine.File(os.fsencode(self.path), min(threads, 64), memory, max_work)
        super().__init__(None, _engine.Engine(self._file))
        self.info: dict[str, Any] = json.loads(self._file.info())
        grid = self.info["grid"]
        axes = np.reshape(grid["direction_lps"], (3, 3)) * grid["spacing_mm"]
        to_ras = np.c_[axes, grid["origin_lps_mm"]] * ((-1,), (-1,), (1,)) + 0.0  # no -0
        self.affine = np.vstack((to_ras, np.eye(4)[3]))
        self.shape: tuple[int, ...] = tuple(grid["size"])
        mm3 = abs(np.linalg.det(axes))
        self.structures: tuple[Structure, ...] = tuple(
            Structure(index, one["id"], one["name"], tuple(one["parents"]), one["color"], one.get("label"),
                      tuple((term["vocabulary"], term["value"]) for term in one.get("terms", [])),
                      sum(one["voxels"].values()), float(sum(one["voxels"].values()) * mm3 / 1000), one["triangles"])
            for index, one in enumerate(self.info["structures"]))
        self.scenes: tuple[str, ...] = tuple(scene["name"] for scene in self.info["scenes"])

    def __enter__(self) -> Atlas:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<splatlas.Atlas {self.path!r}: {len(self.structures)} structures, {self.shape} voxels>"

    def close(self) -> None:
        """Frees what is decoded, once no picture needs it."""
        self._file = self._engine = None  # type: ignore

    def renderer(self) -> Renderer:
        """Another renderer, with a cache of its own."""
        return Renderer(self, _engine.Engine(self._opened()))

    @checked
    def find(self, name: str) -> list[Structure]:
        """The structures of a name: an id, path, synonym, pattern ("Vermis*") or label ("#17"), too. Error for none."""
        return [self.structures[index] for index in self._indices([name])]

    @checked
    def labels(self, names: Names = "*") -> np.ndarray:
        """The source label map: (i, j, k), of its type. Other structures than `names` and their parts are 0."""
        return self._opened().voxels("labels", self._indices(names))

    @checked
    def mask(self, names: Names) -> np.ndarray:
        """(i, j, k) bool: where the structures `names` or their parts are; they may overlap."""
        return self._opened().voxels("mask", self._indices(names))

    def volume(self) -> np.ndarray:
        """The grey values: (i, j, k), of the type of the source. Raises Error in an atlas without them."""
        return self._opened().voxels("volume", [])

    @checked
    def surface(self, names: Names) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Vertices (n, 3) float64 in RAS mm, triangles (m, 3) uint32 of rows of these, and unit normals (n, 3) float32.

        Of the structures `names` and their parts. Triangles are counter-clockwise from outside.
        """
        vertices, triangles, normals = (flat.reshape(-1, 3) for flat in self._opened().surface(self._indices(names)))
        return vertices * (-1, -1, 1), triangles, normals * np.array((-1, -1, 1), np.float32)

    def volumes(self) -> list[dict[str, Any]]:
        """A row for each structure: id, name, label, voxels, ml; for pandas.DataFrame()."""
        return [{key: getattr(one, key) for key in ("id", "name", "label", "voxels", "ml")} for one in self.structures]

    @checked
    def show(self, select: str | None = None, scene: str | None = None, height: int = 600) -> Page:
        """The page of `select` or `scene`, for a cell of `height` pixels: the exported file, which needs no server."""
        self._opened()
        return page_of(self.path, select, scene, height)

    def _opened(self) -> _engine.File:
        if self._file is None:
            raise ValueError(f"{self.path}: the atlas is closed")
        return self._file

    def _indices(self, names: Any, argument: str = "names") -> list[int]:
        file, found = self._opened(), list[int]()
        for name in names:
            if isinstance(name, str):
                found += file.find(name)
            elif self.structures[name.index:name.index + 1] != (name,):  # type: ignore
                raise ValueError(f"{argument}: {name!r:.80}: is a structure of another atlas")
            else:
                found.append(name.index)
        return list(dict.fromkeys(found))

    def _one(self, name: str | Structure) -> int:
        found = self._indices([name], "focus")
        if len(found) != 1:
            raise ValueError(f"focus: {name!r}: names {len(found)} structures; it takes one")
        return found[0]

    def _named(self, kind: str, name: str) -> dict[str, Any]:
        """A scene or a view."""
        choice = {one["name"].casefold(): one for one in self.info[f"{kind}s"]}
        if name.casefold() not in choice:
            names = ", ".join(repr(one["name"]) for one in choice.values())
            raise ValueError(f"{self.path}: has no {kind} {name!r}; it has {names or 'none'}")
        return choice[name.casefold()]


open = Atlas


def _flipped(point: Sequence[float]) -> list[float]:
    """RAS to LPS mm, and back."""
    return [-point[0], -point[1], point[2]]


def _flipped_center(camera: Any) -> dict[str, Any]:
    return camera if camera.get("center") is None else camera | {"center": _flipped(camera["center"])}
