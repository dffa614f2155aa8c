# SPDX-License-Identifier: GPL-3.0-or-later
"""Output files that appear whole or not at all, all those of a run together, at its end.

Until then each is written in a hidden folder beside its target, so that one `os.replace` publishes it, on
every system, and Blender sees the file name that it was asked for.
"""

from __future__ import annotations

import errno
import os
import secrets
import shutil
import weakref
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from .errors import OutputFailed

_FULL = (errno.ENOSPC, getattr(errno, "EDQUOT", errno.ENOSPC), errno.EFBIG)


class Outputs:
    """The outputs of one run. Leaving the `with` block publishes them; leaving it by an exception of any
    kind drops them all.

    >>> with Outputs() as outputs:
    ...     with outputs.file("m.npz") as file:
    ...         file.write(b"...")
    """

    def __init__(self):
        self._written: list[tuple[Path, Path]] = []  # (where it waits, its target)
        self._folders: list[Path] = []
        weakref.finalize(self, _remove, self._folders)  # a Ctrl-C may come while drop() runs

    def __enter__(self) -> Outputs:
        return self

    def __exit__(self, kind, error, trace) -> None:
        try:
            if kind is None:
                self._publish()
        finally:
            self.drop()

    @contextmanager
    def file(self, target: str | Path) -> Iterator[BinaryIO]:
        """A binary file to write, seekable. Raises OutputFailed in the place of OSError."""
        with self.path(target) as path, path.open("w+b") as file:
            yield file

    @contextmanager
    def path(self, target: str | Path) -> Iterator[Path]:
        """A path of the same name for software that writes files by name (Blender). Raises OutputFailed
        in the place of OSError, and where nothing was written."""
        target = writable_target(target)
        with _explained(target):
            folder = target.parent / f".realmodel-{secrets.token_hex(8)}"
            self._folders.append(folder)  # first, so that a Ctrl-C leaves no folder that is not known
            folder.mkdir()
            path = folder / target.name
            yield path
            if not path.is_file():
                raise OutputFailed(f"{target}: nothing was written")
            with path.open("r+b") as file:
                os.fsync(file.fileno())
        self._written.append((path, target))

    def _publish(self) -> None:
        new: list[Path] = []
        try:
            for path, target in self._written:
                with _explained(target):
                    if not target.exists():
                        new.append(target)
                    os.replace(path, target)
        except BaseException:
            for target in new:
                with suppress(OSError):
                    target.unlink()
            raise

    def drop(self) -> None:
        """Gives up all that is not published."""
        self._written.clear()
        _remove(self._folders)


def _remove(folders: list[Path]) -> None:
    while folders:
        shutil.rmtree(folders[-1], ignore_errors=True)
        folders.pop()


def writable_target(target: str | Path) -> Path:
    """The path, links followed, where an output will stand. Raises OutputFailed where it cannot."""
    with _explained(target):
        resolved = Path(os.path.realpath(target))
        if resolved.is_dir():
            raise OutputFailed(f"{target}: this is a folder; give a file name")
        if resolved.exists() and not resolved.is_file():
            raise OutputFailed(f"{target}: this is not an ordinary file")
        if not resolved.parent.is_dir():
            raise OutputFailed(f"{target}: there is no folder {resolved.parent}; make it first")
        if not os.access(resolved.parent, os.W_OK | os.X_OK):
            raise OutputFailed(f"{target}: you may not write in {resolved.parent}; choose another folder")
    return resolved


@contextmanager
def _explained(target: str | Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        reason = error.strerror or str(error)
        advice = "; make room or choose another folder" if error.errno in _FULL else ""
        raise OutputFailed(f"{target}: cannot be written: {reason}{advice}") from error
