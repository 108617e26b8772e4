"""The stubs: strict, complete, and what a type checker is for."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("mypy")
pytest.importorskip("matplotlib")
TESTS = Path(__file__).resolve().parent


def mypy(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", *arguments], cwd=cwd, capture_output=True, text=True
    )


def test_a_users_program_passes_strictly(tmp_path: Path) -> None:
    run = mypy("mypy", "--strict", str(TESTS / "user.py"), cwd=tmp_path)
    assert run.returncode == 0, run.stdout


@pytest.mark.parametrize(
    "wrong",
    [
        "ss.MassOnBelt(0.3, 0.2)",
        "ss.MassOnBelt(ss.Coulomb(0.4, 0.3), 0.2, 0.05)",
        "ss.MassOnBelt(ss.Coulomb(0.4, 0.3), 0.2).simulate(0.0, 1.0)",
        "ss.limit_cycles(ss.Structure([1.0]))",
        "ss.follow(3, 1.0, None, 0.0, 1.0)",
        "ss.Contact('0', ss.Coulomb(0.4, 0.3), 1.0)",
        "ss.Coulomb(0.4, 0.3).missing",
        "ss.Dahl(0.4, 1.0).kinetic(1.0)",
    ],
)
def test_what_is_wrong_is_found(wrong: str, tmp_path: Path) -> None:
    program = tmp_path / "wrong.py"
    program.write_text(f"import stick_slip as ss\n\n{wrong}\n")
    run = mypy("mypy", "--strict", str(program), cwd=tmp_path)
    assert run.returncode == 1, run.stdout


def test_the_stubs_are_those_of_the_extension(tmp_path: Path) -> None:
    allowed = tmp_path / "allowed"
    allowed.write_text("")
    run = mypy("mypy.stubtest", "stick_slip", "--allowlist", str(allowed), cwd=tmp_path)
    assert run.returncode == 0, run.stdout
