"""Systems of the reference files of the Rust tests, built through Python."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

import stick_slip as ss

DATA = Path(__file__).resolve().parents[2] / "tests" / "data"


def cases(name: str) -> list[dict[str, Any]]:
    return list(json.loads((DATA / f"{name}.json").read_text())["cases"])


def floats(values: Any) -> Any:
    return np.array(values, dtype=float)


def law(case: dict[str, Any]) -> ss.Law:
    if "kt" in case:
        return ss.Coulomb(float(case["mu"]), float(case["mu"]))
    p = {name: float(value) for name, value in case["law_params"].items()}
    match case["law"]:
        case "poly":
            return ss.Polynomial(p["mus"], p["mum"], p["vm"])
        case "exp":
            return ss.Exponential(p["mus"], p["muk"], p["vs"])
        case "coulomb":
            return ss.Coulomb(p["mus"], p["muk"])
        case "rational":
            return ss.Rational(p["mus"], p["gamma"], p["delta"], p["eta"])
    raise ValueError(case["law"])


def belt(case: dict[str, Any]) -> ss.MassOnBelt:
    return ss.MassOnBelt(
        law(case),
        float(case["v_b"]),
        damping=float(case["beta"]),
        load=float(case["gamma2"]),
    )


def drive(given: Any) -> ss.Drive:
    if not isinstance(given, dict):
        return ss.Drive.constant(float(given))
    match given["type"]:
        case "const":
            return ss.Drive.constant(float(given["value"]))
        case "fourier":
            total = ss.Drive.constant(float(given["a0"]))
            for term in given["terms"]:
                omega = float(term["omega"])
                total += ss.Drive.harmonic(float(term["a"]), omega)
                total += ss.Drive.sine(float(term["b"]), omega)
            return total
        case "pwl":
            return ss.Drive.profile(np.column_stack([floats(given["t"]), floats(given["values"])]))
        case "steps":
            times, values = floats(given["t"]), floats(given["values"])
            points = [(times[0], values[0])]
            for k in range(1, len(times)):
                points += [(times[k], values[k - 1]), (times[k], values[k])]
            return ss.Drive.profile(points)
    raise ValueError(given["type"])


def contact_law(given: dict[str, Any]) -> ss.Law | ss.ContactLaw | None:
    """None if Python cannot express it: a dry law with another static coefficient."""
    p = given.get("law_params", {})
    match given.get("law"):
        case "directional":
            sides = [p[side] for side in ("forward", "backward")]
            return ss.Directional(*[ss.Coulomb(float(s["mus"]), float(s["muk"])) for s in sides])
        case "freewheel":
            return ss.Freewheel(ss.Coulomb(float(p["drag"]), float(p["drag"])))
        case "rate_state":
            f0, a, b, d_c, v0 = (float(p[name]) for name in ("f0", "a", "b", "dc", "v0"))
            return ss.RateState(f0=f0, a=a, b=b, d_c=d_c, v0=v0, evolution=p["evolution"])
    own = law(given)
    if "dwell" in given:
        dwell = given["dwell"]
        lowest = float(dwell["mu_0"])
        kinetic = float(given["law_params"].get("muk", "nan"))
        if given["law"] == "coulomb":
            own = ss.Coulomb(lowest, kinetic)
        elif own.static_coefficient != lowest:
            return None
        time = float(dwell["theta_c"])
        if dwell["form"] == "logarithmic":
            return ss.Dwell(own, rate=float(dwell["B"]), time=time)
        hyperbolic = dwell["form"] == "hyperbolic"
        return ss.Dwell(own, limit=float(dwell["mu_inf"]), time=time, hyperbolic=hyperbolic)
    if "bristle" in given:
        sigma = [float(given["bristle"][f"sigma{i}"]) for i in range(3)]
        return ss.LuGre(own, sigma[0], sigma[1], sigma[2])
    return own


def force_law(given: dict[str, Any]) -> ss.ForceLaw:
    if given["law"] == "polynomial":
        return ss.PolynomialSpring(floats(given["law_params"]["c"]))
    p = {name: float(value) for name, value in given["law_params"].items()}
    match given["law"]:
        case "sine":
            return ss.Pendulum(p["A"], p["l"])
        case "gap":
            return ss.Backlash(p["k"], p["g"])
        case "snap":
            return ss.SnapThrough(p["k"], p["L"], p["l"])
        case "van_der_pol":
            return ss.VanDerPol(p["a"], p["b"])
        case "cubic_damper":
            return ss.ForceLaw(lambda x, v: p["c"] * v**3)
        case "exponential":
            return ss.ForceLaw(lambda x, v: p["A"] * (np.exp(x / p["l"]) - 1.0))
        case "magnet":
            return ss.ForceLaw(lambda x, v: -p["A"] / (p["g"] - x) ** 2)
    raise ValueError(given["law"])


def force_element(given: dict[str, Any]) -> ss.ForceElement:
    factor = drive(given["factor"]) if "factor" in given else None
    rows = [dict(enumerate(floats(row))) for row in given["directions"]]
    if given["law"] != "quartic_pair":
        return ss.ForceElement(rows[0], force_law(given), factor=factor)
    stiffness = float(given["law_params"]["k4"])

    def forces(x: Any, v: Any) -> Any:
        common = (x[0] ** 2 + x[1] ** 2) * stiffness
        return common * x[0], common * x[1]

    return ss.ForceElement.field(rows, forces, factor=factor)


def stop(given: dict[str, Any]) -> ss.Stop:
    return ss.Stop(
        dict(enumerate(floats(given["direction"]))),
        float(given["gap"]),
        stiffness=float(given["k"]),
        damping=float(given["c"]),
        adhesive=given["kind"] == "adhesive",
    )


def structure(system: dict[str, Any]) -> ss.Structure | None:
    masses: dict[str, Any] = (
        {"mass_matrix": floats(system["mass"])}
        if "mass" in system
        else {"masses": floats(system["m"])}
    )
    built = ss.Structure(
        **masses, stiffness=floats(system["K"]), damping=floats(system["C"])
    )
    for i, force in enumerate(system["f"]):
        built = built.with_force(i, drive(force))
    for i, given in enumerate(system["contacts"]):
        if given is None:
            continue
        rule = contact_law(given)
        if rule is None:
            return None
        direction = (
            dict(enumerate(floats(given["direction"]))) if "direction" in given else {i: 1.0}
        )
        gradient = dict(enumerate(floats(given["n"]))) if "n" in given else {}
        options: dict[str, Any] = {"belt_velocity": drive(given["w"])}
        if "kt" in given:
            options["tangential_stiffness"] = float(given["kt"])
        if "reaction" in given:
            row = floats(given["reaction"])
            j = int(np.flatnonzero(row)[0])
            options["normal_spring"] = (dict(enumerate(row)), gradient[j] / row[j])
        elif gradient:
            options["load_gradient"] = gradient
        built = built.with_contact(ss.Contact(direction, rule, drive(given["N0"]), **options))
    for given in system.get("forces", []):
        built = built.with_element(force_element(given))
    return built.with_stops([stop(given) for given in system.get("kv_stops", [])])


def start(case: dict[str, Any]) -> Any:
    given = case["start"]
    parts = [floats(given["q"]), floats(given["v"])]
    for memory in ("T", "z", "phi"):
        if memory in given:
            parts.append(floats(given[memory]))
    return tuple(parts)
