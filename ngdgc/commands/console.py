"""The streams of a command: output that nobody takes stops no work, and silence does not last long."""

from __future__ import annotations

import os
import sys
from contextlib import ExitStack, redirect_stderr, redirect_stdout, suppress
from threading import Event, Thread
from time import monotonic
from types import TracebackType
from typing import Any

EVERY = 4.0         # [s] of silence after which a line says that work goes on

CLOSED = OSError("it is closed")


class Stream:
    """Standard output or error; what cannot be written is dropped.

    trouble : the first error of writing, None if there was none;  time : of the last line [s], 0 before the first
    """

    def __init__(self, stream: Any) -> None:
        self.trouble: Exception | None = None
        self.time = 0.0
        self.stream = stream
        if stream is None:      # closed before the command began
            self._Drop(CLOSED)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.stream, name)

    def write(self, text: str) -> int:
        try:
            self.stream.write(text)
        except UnicodeEncodeError:
            return self.write(text.encode(self.stream.encoding, "backslashreplace").decode(self.stream.encoding))
        except (OSError, ValueError) as error:      # a ValueError is what a closed file raises
            self._Drop(error)
        self.time = monotonic()
        return len(text)

    def flush(self) -> None:
        try:
            self.stream.flush()
        except (OSError, ValueError) as error:
            self._Drop(error)

    def _Drop(self, error: Exception) -> None:
        self.trouble = self.trouble or error
        nowhere = open(os.devnull, "w", encoding="utf-8")
        if self.stream is not None and self.stream in (sys.__stdout__, sys.__stderr__):
            # What is left in its buffer would be tried again when Python ends.
            with suppress(OSError, ValueError):
                os.dup2(nowhere.fileno(), self.stream.fileno())
        self.stream = nowhere


class Console:
    """Standard output and error of a command while it is entered, as `Stream`s.

    While nothing is written for some seconds a thread says on the stream that spoke last how long that has been so.
    """

    def __init__(self, *, every: float = EVERY) -> None:
        self.every = every

    def __enter__(self) -> Console:
        _OpenStandard()
        self.out, self.errors = Stream(sys.stdout), Stream(sys.stderr)
        self._stack, self._end = ExitStack(), Event()
        self._stack.enter_context(redirect_stdout(self.out))
        self._stack.enter_context(redirect_stderr(self.errors))
        self._thread = Thread(target=self._Beat, daemon=True)
        self._thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._end.set()
        self._thread.join()
        self.out.flush()
        self.errors.flush()
        self._stack.close()

    def _Beat(self) -> None:
        """NGSolve gives up Python's lock while it factorises: a thread can speak meanwhile."""
        spoke, seen = 0.0, 0.0      # when this thread wrote, and when anybody else did before
        while not self._end.wait(self.every / 4):
            stream = max(self.out, self.errors, key=lambda one: one.time)
            if stream.time != spoke:
                seen = stream.time
            if seen and monotonic() - stream.time > 0.75 * self.every:
                stream.write(f"... still at work, {monotonic() - seen:.0f} s\n")
                stream.flush()
                spoke = stream.time

    def Code(self, code: int) -> int:
        """The exit code of a command: 2 in place of 0 if its output could not be written, which the standard error says.

        That the reader has gone, as `| head` does, is no error, nor is an output that was closed on purpose.
        """
        self.out.flush()
        trouble = self.out.trouble
        if trouble is None or isinstance(trouble, BrokenPipeError):
            return code
        why = getattr(trouble, "strerror", None) or trouble
        print(f"ngdgc: the standard output cannot be written: {why}; files are written all the same", file=self.errors)
        return code or (0 if trouble is CLOSED else 2)


def _OpenStandard() -> None:
    """A closed standard stream leaves its number to the next file that is opened, into which C++ would print."""
    for number in (0, 1, 2):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)
