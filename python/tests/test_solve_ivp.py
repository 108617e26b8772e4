"""The programs of solve_ivp.md: their lines, times and errors are those of its table."""

from __future__ import annotations

import os
import re
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("scipy")

PAGE = (Path(__file__).resolve().parents[1] / "solve_ivp.md").read_text(encoding="utf-8")
PERIOD = 6.799421444472157604854212
OURS, THEIRS = re.findall(r"```python\n(.*?)```", PAGE, re.S)


def table(name: str) -> tuple[int, float, float]:
    row = re.search(rf"^\| {re.escape(name)} \| (\d+) \| (\S+) \| (\S+) \|$", PAGE, re.M)
    assert row, name
    return int(row[1]), float(row[2]), float(row[3])


def measure(program: str, **given: float) -> tuple[int, float, float]:
    lines = sum(1 for line in program.splitlines() if line.strip())
    code = compile(program, "solve_ivp.md", "exec")
    least = np.inf
    for _ in range(3):
        names: dict[str, Any] = dict(given)
        begin = time.perf_counter()
        exec(code, names)
        least = min(least, time.perf_counter() - begin)
    releases = np.asarray(names["releases"])
    assert len(releases) == 147
    exact = releases[0] + PERIOD * np.arange(len(releases))
    return lines, least, np.abs(releases - exact).max()


def test_the_table_is_right() -> None:
    lines, unit, error = measure(OURS)
    assert lines == table("stick_slip")[0] and error <= table("stick_slip")[2]
    for tolerance in (1e-6, 1e-12):
        name = f"solve_ivp, tolerance {tolerance:.0e}".replace("e-0", "e-")
        lines, taken, error = measure(THEIRS, tolerance=tolerance)
        shown = table(name)
        assert lines == shown[0] and error <= shown[2]
        # Other work on the machine does not fail a test.
        assert "TIMES" not in os.environ or taken >= shown[1] * unit
        # The table does not flatter: the error is near what it says.
        assert error >= 1e-2 * shown[2]
