# SPDX-License-Identifier: GPL-3.0-or-later
"""What a model comes from: a project that is built, or the file of a built one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from ..core import Model, Project, build, load_project
from .options import MODEL_ENDING

ENDINGS = (".toml", MODEL_ENDING)


@dataclass(frozen=True)
class OpenedFile:
    """The file of a project, read already, or of a model: then project is None."""

    file: Path
    project: Project | None

    @classmethod
    def of(cls, file: Path) -> OpenedFile:
        """Reads a project. Raises InputRefused."""
        return cls(file, None if file.suffix.lower() == MODEL_ENDING else load_project(file))

    @property
    def inputs(self) -> list[Path]:
        """All files that are read."""
        return [self.file] if self.project is None else [self.file, *self.project.input_files()]

    def model(
        self,
        cells: str,
        threads: int = 0,
        device: str = "cpu",
        progress: Callable[[float, str], None] | None = None,
        stage: int | None = None,
        memory: int | None = None,
    ) -> Model:
        """The model: built, with the arguments of `build`, or loaded as it is. Raises RealModelError."""
        if self.project is not None:
            return build(
                self.project,
                cells,
                threads=threads,
                device=device,
                progress=progress,
                stage=stage,
                memory=memory,
            )
        model = Model.load(self.file, threads=threads, progress=progress)
        return model if stage is None else model.stage(stage, progress=progress)
