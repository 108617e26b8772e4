"""The examples run, and print what README shows."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[1]
EXAMPLES = sorted((PACKAGE / "examples").glob("*.py"))
README = (PACKAGE / "README.md").read_text(encoding="utf-8")

pytest.importorskip("matplotlib")


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_prints_what_the_readme_shows(example: Path, tmp_path: Path) -> None:
    if example.stem == "fit":
        pytest.importorskip("scipy")
    picture = tmp_path / "picture.svg"
    run = subprocess.run(
        [sys.executable, str(example), str(picture)],
        capture_output=True,
        text=True,
        env={**os.environ, "MPLBACKEND": "Agg"},
    )
    assert run.returncode == 0, run.stderr
    shown = re.search(rf"{re.escape(example.name)}\)\)\n(?:.*\n)*?```text\n((?:.*\n)*?)```", README)
    assert shown and run.stdout == shown.group(1)
    assert picture.stat().st_size > 1000
    assert (PACKAGE / "examples" / f"{example.stem}.svg").stat().st_size < 70_000
