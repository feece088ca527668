"""Evaluates the models of a folder with the Python module `freeact` and compares with what the program and Rust wrote beside them:
module.model, pressures.csv, poses.csv; free.model, states.csv, deformations.csv; steps.csv, stepped.csv."""

import csv
import math
import sys
from pathlib import Path

import freeact
import numpy as np


def table(path):
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    return {name: [row[name] for row in rows] for name in rows[0]}


def numbers(columns, names):
    return np.array([[float(cell or "nan") for cell in columns[name]] for name in names]).T


def same(found, printed, what):
    """Twelve printed digits, the last of them rounded. What is far smaller than its neighbours has their rounding."""
    off = np.abs(found - printed) > 1e-11 * np.abs(printed) + 1e-12
    assert not off.any(), f"{what}: {found[off]} for {printed[off]}"


def outside(status):
    return np.array([text != "ok" for text in status])


def raises(kind, words, call):
    try:
        call()
    except kind as error:
        assert words in str(error), error
    else:
        raise AssertionError(f"{words}: not raised")


folder = Path(sys.argv[1])
module = freeact.Model.load(folder / "module.model")
assert module.kind == "module" and module.frees == 4
assert module.domain_kpa.shape == (4, 2) and (module.domain_kpa[:, 1] > module.domain_kpa[:, 0]).all()
assert "hysteresis" in module.effects

# Poses, as `freeact predict` prints them.
poses = table(folder / "poses.csv")
pressures = 1e3 * numbers(table(folder / "pressures.csv"), [f"p{free}_kpa" for free in range(1, 5)])
tip = module.tip(pressures, jacobian=True)
missing = outside(poses["status"])
inside = ~missing
assert missing.sum() > 20 and inside.sum() > 100, (missing.sum(), inside.sum())
assert ((tip.status == freeact.OK) == inside).all()
assert np.isnan(tip.position_m[missing]).all() and np.isnan(tip.rotation_wxyz[missing]).all()
same(1e3 * tip.position_m[inside], numbers(poses, ["x_mm", "y_mm", "z_mm"])[inside], "position")
same(tip.rotation_wxyz[inside], numbers(poses, ["qw", "qx", "qy", "qz"])[inside], "rotation")

# Shapes: any leading axes, lists, other orders in memory, none at all.
assert tip.jacobian.shape == (len(pressures), 4, 6) and module.tip(pressures).jacobian is None
one = module.tip(list(pressures[inside][0]))
assert one.position_m.shape == (3,) and one.status.shape == ()
assert (one.position_m == tip.position_m[inside][0]).all()
stacked = module.tip(np.asfortranarray(pressures[:12].reshape(3, 4, 4)))
assert stacked.rotation_wxyz.shape == (3, 4, 4)
assert np.array_equal(stacked.position_m.reshape(12, 3), tip.position_m[:12], equal_nan=True)
assert module.tip(np.empty((0, 4))).position_m.shape == (0, 3)
tip.position_m[0] = 0.0  # arrays are the caller's own

# Derivatives against differences.
middle = np.array([10e3, 20e3, 15e3, 5e3])
slopes = module.tip(middle, jacobian=True).jacobian
for free in range(4):
    by = np.zeros(4)
    by[free] = 1.0
    rate = (module.tip(middle + by).position_m - module.tip(middle - by).position_m) / 2.0
    assert np.allclose(rate, slopes[free, :3], rtol=1e-5, atol=1e-12), (rate, slopes[free, :3])
clearance = module.clearance(pressures)
assert clearance.shape == missing.shape and (clearance[inside] >= 0.0).all() and (clearance[missing] < 1e-6).all()
assert module.error_bars(pressures) is None
bars = freeact.Model.load(folder / "bars.model").error_bars(pressures[inside])
assert bars.shape == (inside.sum(), 2) and (bars > 0.0).all()

# Steps in time, as Rust takes them, to the last bit.
steps, stepped = table(folder / "steps.csv"), table(folder / "stepped.csv")
state = module.state()
for again in range(2):
    answers = [
        state.step(row[0], row[1:], jacobian=True)
        for row in numbers(steps, ["step_s", "p1_pa", "p2_pa", "p3_pa", "p4_pa"])
    ]
    found = np.array([[*a.position_m, *a.rotation_wxyz, *a.jacobian[3]] for a in answers])
    assert np.array_equal(found, numbers(stepped, list(stepped)), equal_nan=True), "steps"
    state.reset()
readings = freeact.State(module)
assert (readings.step(0.01, middle, measured=True).position_m != found[0, :3]).any()

# A single FREE, as `freeact predict` prints it.
free = freeact.Model.load(str(folder / "free.model"))
states, printed = table(folder / "states.csv"), table(folder / "deformations.csv")
kpa, degrees, mpa = numbers(states, ["p1_kpa", "winding_angle_deg", "shear_modulus_mpa"]).T
shape = free.deform(1e3 * kpa, degrees * (math.pi / 180), 1e6 * mpa, jacobian=True)
inside = ~outside(printed["status"])
assert 100 < inside.sum() < len(inside)
assert ((shape.status == freeact.OK) == inside).all()
assert {freeact.OUTSIDE_PRESSURE, freeact.OUTSIDE_ANGLE} <= set(shape.status.tolist())
for array, name, unit in [
    (shape.axial_stretch, "axial_stretch", 1.0),
    (shape.expansion, "expansion", 1.0),
    (shape.twist_per_length_rad_m, "twist_per_length_deg_per_mm", 180 / math.pi * 1e-3),
]:
    assert np.isnan(array[~inside]).all()
    same(unit * array[inside], numbers(printed, [name])[:, 0][inside], name)
assert shape.jacobian.shape == (len(kpa), 3, 3)
own = free.deform(np.linspace(0.0, 5e3, 6)[:, None], np.array([free.winding_angle_rad[0]]))
assert own.axial_stretch.shape == (6, 1) and own.status.max() == freeact.OK
assert (free.deform(5e3).axial_stretch == own.axial_stretch[5, 0]).all()
assert free.state().step(0.1, [4e3]).twist_per_length_rad_m.shape == ()

# What is wrong with a call.
raises(FileNotFoundError, "absent.model", lambda: freeact.Model.load(folder / "absent.model"))
raises(freeact.ModelError, "not a freeact", lambda: freeact.Model.load(folder / "poses.csv"))
raises(ValueError, "has 4 entries; it has 3", lambda: module.tip([1.0, 2.0, 3.0]))
raises(ValueError, "none", lambda: module.tip(1.0))
raises(TypeError, "single FREE", lambda: free.tip([1.0]))
raises(TypeError, "module", lambda: module.deform(1.0))
raises(ValueError, "zero or more", lambda: state.step(-0.1, middle))
raises(ValueError, "not a number", lambda: state.step(0.1, [math.nan] * 4))
raises(ValueError, "could not convert", lambda: module.tip(["a", "b", "c", "d"]))
assert module.tip.__doc__ and freeact.__doc__
print(f"{len(missing)} poses, {len(kpa)} deformations, {len(answers)} steps agree")
