"""What goes wrong, one class for each kind. All of them are :class:`Error`.

An error says in ``message`` what is wrong, in ``hint`` what to try (or ``None``), and in ``report`` what was found until then (or ``None``). What
else belongs to its kind it has as attributes, which are ``None`` where they are not known. Lengths are in model units.
"""

from __future__ import annotations

import json
import re
from typing import Any

__all__ = [
    "BadArray",
    "Deadline",
    "DeviceError",
    "Empty",
    "Error",
    "InputError",
    "InternalError",
    "LimitError",
    "LimitWarning",
    "MemoryLimit",
    "MeshwrightWarning",
    "NotClosed",
    "NotExact",
    "NotSolid",
    "NothingEnclosed",
    "NothingLeft",
    "TooMany",
    "TooThin",
    "UsageError",
    "VoxelError",
    "Withheld",
    "WriteFailed",
]


class MeshwrightWarning(UserWarning):
    """Something that a user should read: what a reader left out, what was guessed."""


class LimitWarning(MeshwrightWarning):
    """There is a result, and it does not keep a promise or a stated limit: the program would end with exit status 3."""


class Error(Exception):
    """Why there is no result."""

    message: str
    hint: str | None
    report: dict[str, Any] | None

    def __init__(
        self,
        message: str,
        hint: str | None = None,
        report: dict[str, Any] | None = None,
        fields: dict[str, Any] | None = None,
    ) -> None:
        super().__init__(message if hint is None else f"{message}\n  try: {hint}")
        self.message = message
        self.hint = hint
        self.report = report
        for name, value in (fields or {}).items():
            setattr(self, name, value)

    def __reduce__(self) -> tuple[Any, ...]:
        # What is raised in another process arrives whole.
        return _again, (type(self), self.message, self.hint, self.report, _fields_of(self))


class InternalError(Error):
    """The program has a bug. Please report it."""


class UsageError(Error, ValueError):
    """Options that contradict each other, or ask for what cannot be."""


class BadArray(Error, ValueError):
    """Arrays that are no mesh: a face refers to a vertex that is not there."""


class LimitError(Error):
    """A limit does not hold that was set by ``fail_on``, ``fail_on_max`` or ``max_memory``."""


class InputError(Error):
    """An input that cannot be read, or that the function cannot take."""


class Empty(InputError):
    """No triangle of an input has an area."""

    operand: int | None = None


class NothingEnclosed(InputError):
    """The result would enclose nothing. ``reason``: ``scattered``, ``open-sheet``, ``thinner-than-voxel``, ``nothing``, ``no-common-part`` or ``all-smaller``."""

    reason: str | None = None
    share: float | None = None
    voxel: float | None = None
    thin: dict[str, Any] | None = None
    surfaces: int | None = None
    least: float | None = None
    largest: float | None = None


class NothingLeft(InputError):
    """An operation on a solid leaves nothing: it is nowhere thicker than ``thinner_than``."""

    thinner_than: float | None = None


class TooThin(InputError):
    """What is left is thinner everywhere than ``voxel``, the smallest voxel that was tried."""

    voxel: float | None = None


class TooMany(InputError):
    """More triangles or crossings than can be numbered."""


class VoxelError(InputError):
    """The voxel does not go with the coordinates."""


class NotClosed(UsageError):
    """A closed surface is needed; ``problem`` says what is wrong with this one."""

    problem: str | None = None


class NotExact(Error):
    """``method="exact"`` was asked for, and there is no exact result: ``operand`` is open around ``edges`` edges, one of them between the two ``ends``."""

    edges: int | None = None
    operand: int | None = None
    ends: list[list[float]] | None = None


class NotSolid(Error):
    """What was made is no valid solid; ``problems`` says why."""

    problems: list[str] | None = None


class Withheld(Error):
    """Most of the shape would be lost. ``keep_partial=True`` gives the result all the same."""


class MemoryLimit(Error, MemoryError):
    """More memory would be needed (``needed``, bytes) than there is or is allowed (``allowed``)."""

    needed: int | None = None
    allowed: int | None = None
    voxel_that_fits: float | None = None


class Deadline(Error, TimeoutError):
    """The time given by ``timeout`` has passed."""


class WriteFailed(Error, OSError):
    """A file cannot be written."""


class DeviceError(Error):
    """The graphics processor cannot do what ``backend="gpu"`` asks for."""


_CLASSES: dict[str, type[Error]] = {
    "bad-array": BadArray,
    "deadline": Deadline,
    "device": DeviceError,
    "empty": Empty,
    "input": InputError,
    "internal": InternalError,
    "limit": LimitError,
    "memory": MemoryLimit,
    "not-closed": NotClosed,
    "not-exact": NotExact,
    "not-solid": NotSolid,
    "nothing-enclosed": NothingEnclosed,
    "nothing-left": NothingLeft,
    "too-many": TooMany,
    "too-thin": TooThin,
    "usage": UsageError,
    "voxel": VoxelError,
    "withheld": Withheld,
    "write": WriteFailed,
}


def _again(
    kind: type[Error], message: str, hint: str | None, report: dict[str, Any] | None, fields: dict[str, Any]
) -> Error:
    return kind(message, hint, report, fields)


def _fields_of(error: Error) -> dict[str, Any]:
    return {name: value for name, value in vars(error).items() if name not in ("message", "hint", "report")}


def in_python(text: str) -> str:
    """A sentence of the program, with its flags as keywords: ``--max-memory`` is ``max_memory``."""
    return re.sub(r"--([a-z][a-z-]*)", lambda flag: flag[1].replace("-", "_"), text)


def failure(text: str, report: str | None = None) -> BaseException:
    """The error of a failure in JSON."""
    told = json.loads(text)
    if told["class"] == "interrupted":
        return KeyboardInterrupt()
    message = in_python(told["message"])
    if told.get("place"):
        message = f"{message}\n{told['place']}"
    hint = told.get("hint")
    return _CLASSES[told["class"]](
        message,
        in_python(hint) if hint else None,
        json.loads(report) if report else None,
        told.get("fields"),
    )
