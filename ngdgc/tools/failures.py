"""Errors that say what is wrong; users have them from `ngdgc.exceptions`."""


class Failure(Exception):
    """An error whose message names the cause: whoever meets it on the way hands it on."""


class ProblemError(Failure, ValueError):
    """Data that define no problem; the message names the argument at fault and the remedy.

    >>> from ngdgc import NormalCompliance
    >>> NormalCompliance(stiffness=-1)
    Traceback (most recent call last):
    ...
    ngdgc.exceptions.ProblemError: stiffness is -1; it must be at least 0
    """

    __module__ = "ngdgc.exceptions"     # where users find it, and what a copy in another process is made of
