"""The examples of docs/python.md run, and print what they say."""

from __future__ import annotations

import pathlib
import re
import subprocess
import types
from unittest.mock import MagicMock

import numpy as np
import pytest

import rumbo

PAGE = pathlib.Path(__file__).parents[2] / "docs/python.md"


def test_the_examples_of_the_page_run(
    rumbo_command: str, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    # Files of a checkout are named from its folder.
    (tmp_path / "examples").symlink_to(PAGE.parents[1] / "examples")
    subprocess.run([rumbo_command, "run", "mode1", "--seed", "7", "--out", "out"], check=True, capture_output=True)
    examples = re.findall(r"^```python\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
    assert len(examples) >= 6
    # What readers have besides.
    names = {"pandas": MagicMock(), "plt": MagicMock(), "np": np, "rumbo": rumbo}
    page = types.ModuleType("page")
    page.__dict__.update(names)
    for example in examples:
        exec(compile(example, str(PAGE), "exec"), page.__dict__)
    assert "<100 runs of mode1: 100 passed>" in capsys.readouterr().out


def test_the_errors_of_the_page_are_those_of_the_package() -> None:
    with pytest.raises(ValueError) as error:
        rumbo.run("mode1", parameters={"front_kpp": 5})
    assert str(error.value) in " ".join(PAGE.read_text(encoding="utf-8").split())
