"""The source archive holds what the wheel is built of."""

from __future__ import annotations

import os
import pathlib
import tarfile

import pytest

ROOT = pathlib.Path(__file__).parents[2]


def test_the_source_archive_has_every_file_that_is_embedded() -> None:
    archive = os.environ.get("RUMBO_SDIST")
    if archive is None:
        pytest.skip("RUMBO_SDIST names no source archive")
    with tarfile.open(archive) as sources:
        names = {name.split("/", 1)[1] for name in sources.getnames()}
    embedded = {
        path.relative_to(ROOT).as_posix()
        for folder in ("robots", "worlds", "scenarios", "crates/experiment", "python/rumbo")
        for path in (ROOT / folder).rglob("*")
        if path.suffix in {".toml", ".rs", ".py", ".pyi", ".typed"}
    }
    assert len(embedded) > 100 and embedded <= names
    assert {"Cargo.lock", "pyproject.toml", "LICENSE-MIT", "LICENSE-APACHE"} <= names
    assert not any(name.endswith(".so") for name in names)
