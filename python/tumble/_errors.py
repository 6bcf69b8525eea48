"""Exceptions of both precisions."""

from __future__ import annotations


class TumbleError(Exception):
    """Any error of tumble. Its text is a sentence that names what is wrong."""


class SceneError(TumbleError, ValueError):
    """A scene that cannot be used.

    `file`, `body` and `field` name the culprit, as far as they are known; else they are `None`.
    """

    def __init__(self, text: str, file: str | None = None, body: str | None = None, field: str | None = None):
        super().__init__(text, file, body, field)
        self.file = file
        self.body = body
        self.field = field

    def __str__(self) -> str:
        return str(self.args[0])


class _Argument(TumbleError):
    def __init__(self, text: str, field: str | None = None):
        super().__init__(text, field)
        self.field = field

    def __str__(self) -> str:
        return str(self.args[0])


class ArgumentError(_Argument, ValueError):
    """An argument with an impossible value; `field` is its name."""


class ArgumentTypeError(_Argument, TypeError):
    """An argument of a wrong type; `field` is its name."""


class SnapshotError(TumbleError, ValueError):
    """A snapshot that cannot be taken, read or restored."""


class SweepFileError(TumbleError, ValueError):
    """A file that cannot be that of the sweep: of another, damaged, or in use."""
