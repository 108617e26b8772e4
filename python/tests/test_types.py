"""The stubs: strict, complete, and what a type checker is for."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("mypy")
pytest.importorskip("matplotlib")
TESTS = Path(__file__).resolve().parent
WRONG = [
    "ss.MassOnBelt(0.3, 0.2)",
    "ss.MassOnBelt(ss.Coulomb(0.4, 0.3), 0.2, 0.05)",
    "ss.MassOnBelt(ss.Coulomb(0.4, 0.3), 0.2).simulate(0.0, 1.0)",
    "ss.limit_cycles(ss.Structure([1.0]))",
    "ss.follow(3, 1.0, None, 0.0, 1.0)",
    "ss.Contact('0', ss.Coulomb(0.4, 0.3), 1.0)",
    "ss.Coulomb(0.4, 0.3).missing",
    "ss.Dahl(0.4, 1.0).kinetic(1.0)",
    "ss.MassOnBelt(ss.Freewheel(), 0.2)",
    "ss.RateState(0.4, 0.1, 0.2, 0.1, 0.1)",
    "ss.Stop.above(0, 1.0)",
    "ss.Structure([1.0]).with_stop(ss.FirstOrder())",
]


def mypy(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", *arguments], cwd=cwd, capture_output=True, text=True
    )


@pytest.fixture(scope="module")
def checked(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[str]]:
    """What mypy says of each program, in one run."""
    folder = tmp_path_factory.mktemp("programs")
    shutil.copy(TESTS / "user.py", folder)
    for i, wrong in enumerate(WRONG):
        (folder / f"wrong_{i}.py").write_text(f"import stick_slip as ss\n\n{wrong}\n")
    names = sorted(path.name for path in folder.glob("*.py"))
    run = mypy("mypy", "--strict", *names, cwd=folder)
    assert run.returncode == 1, run.stdout + run.stderr
    found: dict[str, list[str]] = {name: [] for name in names}
    for line in run.stdout.splitlines():
        name = line.split(":")[0]
        if ": error: " in line:
            found[name].append(line)
    return found


def test_a_users_program_passes_strictly(checked: dict[str, list[str]]) -> None:
    assert checked["user.py"] == []


@pytest.mark.parametrize("wrong", WRONG)
def test_what_is_wrong_is_found(wrong: str, checked: dict[str, list[str]]) -> None:
    errors = checked[f"wrong_{WRONG.index(wrong)}.py"]
    assert errors and all(":3: " in error for error in errors)


def test_the_stubs_are_those_of_the_extension(tmp_path: Path) -> None:
    # From NumPy 2.5 on the alias NDArray is no type at run time.
    allowed = tmp_path / "allowed"
    allowed.write_text("stick_slip.typing.Array\nstick_slip.typing.ComplexArray\n")
    arguments = ["--allowlist", str(allowed), "--ignore-unused-allowlist"]
    run = mypy("mypy.stubtest", "stick_slip", *arguments, cwd=tmp_path)
    assert run.returncode == 0, run.stdout
