"""What knobcam raises: a bad call or input is kept apart from a failure of the program."""

from __future__ import annotations


class KnobcamError(Exception):
    """Anything knobcam raises on purpose; the command line ends with `exit_code`."""

    exit_code = 1


class InputError(KnobcamError, ValueError):
    """The call or its input is wrong: one line that says where, what, and the way out.

    The message is squeezed onto one line, because the command line promises one line on standard error
    whatever a file's cells, headers or name contain.
    """

    exit_code = 2

    def __init__(self, message: str) -> None:
        super().__init__(" ".join(message.split()))


class KnobcamWarning(UserWarning):
    """Something is left out, and the rest goes on."""
