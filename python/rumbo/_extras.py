"""Packages that only some of this one needs."""

from __future__ import annotations

import importlib
import re


def need(what: str, package: str, extra: str, least: tuple[int, int]) -> None:
    """Refuses to go on without a package of this version or a newer one, and names the extra that brings it.

    Raises:
        ModuleNotFoundError: The package is not there.
        ImportError: It is too old.
    """
    wanted = f"{package} {least[0]}.{least[1]} or newer"
    remedy = f"pip install 'rumbo[{extra}]'"
    try:
        found = importlib.import_module(package)
    except ModuleNotFoundError as error:
        # What a package that is there lacks is another matter.
        if error.name != package:
            raise
        raise ModuleNotFoundError(f"{what} needs {wanted}: {remedy}", name=package) from None
    version = str(getattr(found, "__version__", ""))
    numbers = re.match(r"(\d+)\.(\d+)", version)
    if numbers is not None and (int(numbers[1]), int(numbers[2])) < least:
        raise ImportError(f"{what} needs {wanted}, and {version} is installed: {remedy}", name=package)
