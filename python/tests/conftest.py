"""What the tests share."""

from __future__ import annotations

import os
import pathlib
import signal

import pytest

# A shell's background job ignores Ctrl-C, and so does what it starts: the tests send it.
signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="session")
def rumbo_command() -> str:
    """The `rumbo` command of the same checkout, which RUMBO_COMMAND names as `cargo xtask test` does."""
    command = os.environ.get("RUMBO_COMMAND")
    if command is None:
        pytest.skip("RUMBO_COMMAND names no rumbo command to compare with")
    assert pathlib.Path(command).is_file()
    return command
