"""Arguments of public functions: converted to the types of the signature, or refused by name."""
from __future__ import annotations

import dataclasses
import functools
import inspect
import math
import operator
import os
from collections.abc import Callable, Iterable, Mapping
from typing import Any, TypeVar, Union

import numpy as np

Function = TypeVar("Function", bound=Callable[..., Any])


class Error(Exception):
    """An error of an atlas, a selection, a file or a program.

    `kind` is "failed", "usage", "invalid atlas", "not found", "limit" or "cancelled"; `subject` the file or argument
    that the message begins with, or empty.
    """
    __module__ = "splatlas"

    def __init__(self, message: str, kind: str = "failed", subject: str = ""):
        super().__init__(message)
        self.kind, self.subject = kind, subject


@dataclasses.dataclass(frozen=True)
class Structure:
    """A structure of an atlas; its counts include its descendants.

    `index` is its position in `Atlas.structures` (`Picture.ids` holds index + 1), `parents` their ids, `color`
    "#rrggbb", `label` the value in the source label map, `terms` (vocabulary, value): synonyms, languages, codes.
    """

    index: int
    id: str
    name: str
    parents: tuple[str, ...]
    color: str
    label: int | None
    terms: tuple[tuple[str, str], ...]
    voxels: int
    ml: float
    triangles: int


Names = Union[str, Structure, Iterable[Union[str, Structure]]]


def checked(function: Function) -> Function:
    signature = inspect.signature(function)

    @functools.wraps(function)
    def call(*args: Any, **options: Any) -> Any:
        try:
            bound = signature.bind(*args, **options)
        except TypeError:
            return function(*args, **options)  # its error names the function
        for name, value in bound.arguments.items():
            annotation = str(signature.parameters[name].annotation)
            convert, expected = _CONVERSIONS.get(kind := annotation.removesuffix(" | None"), (lambda value: value, ""))
            try:
                bound.arguments[name] = None if value is None and kind != annotation else convert(value)
            except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
                fault = f"{name}: {' '.join(repr(value).split()):.80}: must be {expected}"
                raise (ValueError if isinstance(error, ValueError) else TypeError)(fault) from None
        return function(*bound.args, **bound.kwargs)
    return call  # type: ignore


def _text(value: str) -> str:
    return str.encode(value).decode()  # TypeError for others, ValueError for halves of surrogate pairs


def _names(value: Any) -> list:
    several = [value] if isinstance(value, (str, Structure)) else value
    return [one if isinstance(one, Structure) else _text(one) for one in several]


def _number(value: float) -> float:
    if not math.isfinite(value):
        raise ValueError
    return float(value)


def _path(value: str | bytes | os.PathLike) -> bytes:
    if b"\0" in os.fsencode(value):
        raise ValueError
    return os.fsencode(value)


def _cuts(value: Any) -> str:
    mm = {side: _number(mm) for side, mm in value.items()} if isinstance(value, Mapping) else {}
    return " ".join([f"{side}={mm[side]!r}" for side in mm] or map(_text, _names(value)))


_CONVERSIONS: dict[str, tuple[Callable, str]] = {
    "str": (_text, "a text"),
    "bool": (lambda value: bool([False, True].index(value)), "True or False"),
    "int": (lambda value: range(2**63).index(operator.index(value)), "an integer from 0"),
    "float": (_number, "a finite number"),
    "str | bytes | os.PathLike": (_path, "a path"),
    "Sequence[int]": (lambda value: [operator.index(side) for side in np.reshape(value, 2)], "(width, height)"),
    "Sequence[float]": (lambda value: [_number(mm) for mm in np.reshape(value, 3)], "three finite numbers"),
    "Sequence[str]": (lambda value: [*map(_text, _names(value))], "a list of texts"),
    "str | Structure": (lambda value: _names([value])[0], "a name or a Structure"),
    "Names": (_names, "a name, a Structure, or several"),
    "Mapping[str, Any]": (lambda value: {key: _CONVERSIONS[_CAMERA[key]][0](one) for key, one in value.items()
                                         if one is not None}, "like Picture.camera"),
    "Mapping[str, float] | Iterable[str]": (_cuts, "{side: mm}, or texts such as 'left=0'"),
    "ArrayLike": (lambda value: np.asarray(value, float).reshape(4, 4), "4 x 4 numbers"),
    "str | os.PathLike | Iterable[str]": (
        lambda value: os.fspath(value) if isinstance(value, (str, os.PathLike)) else "".join(
            f"{_text(line)}\n" for line in value), "a path, or lines such as 'Brain/Left'"),
    "Mapping[str, Sequence[ArrayLike]]": (
        lambda value: {_text(name): (np.asarray(vertices, float), np.asarray(triangles))
                       for name, (vertices, triangles, *_) in value.items()}, "{name: (vertices, triangles)}"),
}
_CAMERA: dict[str, str] = dict.fromkeys(("azimuth", "elevation", "zoom", "fieldOfView"), "float") | {
    "center": "Sequence[float]", "projection": "str"}
