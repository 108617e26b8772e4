"""The examples of all docstrings, and of README."""

from __future__ import annotations

import doctest
import inspect
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

import stick_slip as ss
from stick_slip import _errors, _stick_slip

FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
README = Path(__file__).resolve().parents[1] / "README.md"


def documented() -> list[tuple[str, Any]]:
    """Classes, their methods and properties, and functions: doctest's own search misses some."""
    found: list[tuple[str, Any]] = [("stick_slip", ss), ("analysis", _stick_slip.analysis)]
    for module in (_stick_slip, _stick_slip.analysis, _errors):
        for name, item in vars(module).items():
            if isinstance(item, ModuleType) or (name.startswith("_") and module is not _errors):
                continue
            found.append((name, item))
            if inspect.isclass(item):
                found += [(f"{name}.{key}", it) for key, it in vars(item).items()]
    return found


ITEMS = {name: item for name, item in documented() if ">>>" in (getattr(item, "__doc__", "") or "")}


def run(text: str, name: str) -> None:
    test = doctest.DocTestParser().get_doctest(text, {}, name, None, 0)
    runner = doctest.DocTestRunner(optionflags=FLAGS)
    output: list[str] = []
    runner.run(test, out=output.append)
    assert runner.summarize(verbose=False).failed == 0, "".join(output)


@pytest.mark.parametrize("name", ITEMS)
def test_the_examples_of_a_docstring_run(name: str) -> None:
    run(ITEMS[name].__doc__, name)


def test_many_docstrings_have_examples() -> None:
    assert len(ITEMS) > 50


def test_everything_public_is_documented() -> None:
    bare = []
    for name in ss.__all__:
        item = getattr(ss, name)
        if not inspect.getdoc(item):
            bare.append(name)
        if inspect.isclass(item) and item.__module__ == "stick_slip":
            own = {key: it for key, it in vars(item).items() if not key.startswith("_")}
            bare += [f"{name}.{key}" for key, it in own.items() if not inspect.getdoc(it)]
    assert bare == []


def test_the_readme_runs() -> None:
    text = README.read_text(encoding="utf-8")
    blocks = text.split("```python\n")[1:]
    sessions = [block.split("```")[0] for block in blocks]
    prompts = [session for session in sessions if ">>>" in session]
    assert prompts
    for session in prompts:
        run(session, "README.md")
