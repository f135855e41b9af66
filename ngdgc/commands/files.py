"""The files of a command: each is there when it is complete, and at the end, whatever it is, a line says which there are."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext, suppress
from pathlib import Path
from tempfile import TemporaryFile
from typing import TextIO

from ..exceptions import ProblemError
from .signals import SIGNALS


class Files:
    """Files in a folder, which is made if need be, and removed again if nothing was written; to be entered.

    option : of the command line, that gave the folder;  names : of files that will be written
    written : names of the files that are complete, in their order

    Raises ProblemError where nothing can be written, before anything is computed, and when something could not be written.
    """

    def __init__(self, folder: str | Path, *names: str, option: str = "--out") -> None:
        self.folder, self.option, self.names = Path(folder), option, names
        self.written: list[str] = []
        self._made: list[Path] = []

    def __enter__(self) -> Files:
        try:
            with self._Trying():
                # The deepest first, as they are removed.
                self._made = [path for path in (self.folder, *self.folder.parents) if not path.exists()]
                self.folder.mkdir(parents=True, exist_ok=True)
                with TemporaryFile(dir=self.folder):
                    pass        # what permissions say is not the whole truth: this is
            for name in self.names:
                with self._Trying(name), suppress(FileNotFoundError):
                    _InTheWay(self.folder / name, folder=name.endswith("/"))
        except ProblemError:
            self._Remove()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        self._Remove()
        if self.written:
            print(f"\nwritten to {self.folder}/: {', '.join(self.written)}")

    def _Remove(self) -> None:
        for path in self._made:
            with suppress(OSError):     # not empty, or not made after all
                path.rmdir()

    def Write(self, name: str, Writer: Callable[[Path], object], *, precious: bool = False) -> None:
        """Write a file, or a folder if the name ends in a slash, by Writer(path); one that is `precious` is not interrupted."""
        path = self.folder / name
        with SIGNALS.Held() if precious else nullcontext(), self._Trying(name):
            if name.endswith("/"):
                Writer(path)
            else:
                path.parent.mkdir(exist_ok=True)
                with Whole(path) as temporary:
                    Writer(temporary)
            self.written.append(name)

    def Text(self, name: str, text: str) -> None:
        """Write a text, which is quick and therefore not interrupted."""
        self.Write(name, lambda path: path.write_text(text, encoding="utf-8"), precious=True)

    @contextmanager
    def Growing(self, name: str) -> Iterator[TextIO]:
        """A file that is complete at every time, to write lines to; it goes again if none came."""
        path = self.folder / name
        with self._Trying(name), open(path, "w", newline="", encoding="utf-8") as file:
            try:
                yield file
            finally:
                file.close()
                if path.stat().st_size:
                    self.written.append(name)
                else:
                    path.unlink()

    @contextmanager
    def _Trying(self, name: str = "") -> Iterator[None]:
        try:
            yield
        except OSError as error:
            what = f"{name}: " if name else ""
            raise ProblemError(f"cannot write into {self.folder}: {what}{error.strerror or error}; choose another "
                               f"{self.option}") from error


def _InTheWay(path: Path, *, folder: bool) -> None:
    """OSError for a folder in the place of a file, or the other way round."""
    if folder:
        os.scandir(path).close()
    else:
        os.close(os.open(path, os.O_WRONLY))


@contextmanager
def Whole(path: Path) -> Iterator[Path]:
    """Another path, of the same suffix, to write to: what is written takes the place of `path` once it is complete."""
    temporary = path.with_name(f".{os.getpid()}-{path.name}")
    try:
        yield temporary
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)
