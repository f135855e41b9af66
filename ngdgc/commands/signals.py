"""Signals that ask a command to stop: what they interrupt, and what they must wait for."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

ASKING = signal.SIGINT, signal.SIGTERM, signal.SIGHUP       # Ctrl-C, a polite kill or a batch system, a closed terminal


class Signals:
    """While it is entered, each of these signals raises KeyboardInterrupt: all of them end a solve as Ctrl-C does.

    received : number of the last one, None before

    A signal that whoever started the process ignores (`nohup`, `command &`) stays ignored.  Code in C++ runs to its end first.
    """

    def __init__(self) -> None:
        self.received: int | None = None
        self._before: dict[int, Any] = {}
        self._holds, self._waits = 0, False

    def __enter__(self) -> Signals:
        self.received, self._waits = None, False
        if threading.current_thread() is threading.main_thread():
            self._before = {number: signal.signal(number, self._Receive) for number in ASKING
                            if signal.getsignal(number) != signal.SIG_IGN}
        return self

    def __exit__(self, *_: object) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)
        self._before = {}

    def _Receive(self, number: int, frame: FrameType | None) -> None:
        self.received = number
        if self._holds:
            self._waits = True
        else:
            signal.default_int_handler(number, frame)

    @contextmanager
    def Held(self) -> Iterator[None]:
        """For what must not be cut short, such as writing a file: a signal takes effect at its end."""
        self._holds += 1
        try:
            yield
        finally:
            self._holds -= 1
        if self._waits and not self._holds:
            self._waits = False
            signal.default_int_handler(self.received or signal.SIGINT, None)

    @contextmanager
    def Ending(self) -> Iterator[None]:
        """For the last thing that a process does: once asked to stop it is deaf, and its exit code is that of the command."""
        try:
            yield
        finally:
            if self.received is not None:
                for number in ASKING:
                    signal.signal(number, signal.SIG_IGN)

    @property
    def code(self) -> int:
        """The exit code of a command that was stopped: 130 for Ctrl-C, 143 for a polite kill."""
        return 128 + (self.received or signal.SIGINT)

    @property
    def words(self) -> str:
        """What stopped the command."""
        return "interrupted" if self.received in (None, signal.SIGINT) else f"stopped by {signal.Signals(self.received).name}"


SIGNALS = Signals()     # of the process, which has one handler for each
