"""The FREE in CalculiX: C3D20R, the fibres as SPRINGA between neighbouring nodes, SPOOLES; its own Newton loop and increments.

The tip cap is a ring of stiff elements beyond the rubber (modulus 25 000 mu), pulled by a pressure on its end face that gives the force of the
pressure on the closed cap. CalculiX's own rigid body (`--cap rigid`) agrees with it to 0.1 % in stretch and twist, but its constraint is
linearised so that the same path takes two to three times the iterations. A bare tube does not turn, so it gets the rigid body.
"""

import argparse
import dataclasses
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

import numpy as np

import free

CAP_MODULUS = 1e4  # MPa; at 1e3 the ring gives (0.5 % of stretch - 1), at 1e5 the iterations double
CAP_POISSON = 0.3

# Tried on 20deg-L40: increments grow by 5 %, shrink by a fifth after more than 4 iterations, and are halved when residuals grow after the 8th.
# With CalculiX's own values they never grow (that wants fewer than 4 iterations twice) or grow until they are halved.
CONTROLS = ["*CONTROLS, PARAMETERS=TIME INCREMENTATION", "8, 10, 9, 16, 4, 3, , 8", "0.5, 0.5, 0.8, 0.85, , , 1.05"]


def lines(numbers, per_line=12):
    """Comma-separated numbers, a few to the line."""
    numbers = [str(n) for n in numbers]
    return ",\n".join(", ".join(numbers[i : i + per_line]) for i in range(0, len(numbers), per_line))


def deck(case, mesh, first_kpa, longest_kpa, cap):
    """The input file. Numbers from 1; the nodes of the rubber first, as in `mesh`."""
    n = len(mesh.points)
    elements = len(mesh.cells)
    if cap == "stiff":
        # one layer of elements more: nodes are numbered ring by ring, so the rubber's keep their numbers
        whole = free.TubeMesh(dataclasses.replace(case, along=case.along + 1, length=case.length * (case.along + 1) / case.along))
    reference, rotation = n + 1, n + 2  # of the rigid body
    mu, alpha = case.shear_modulus, case.ogden_alpha
    out = ["*NODE, NSET=NALL"]
    out += [f"{i}, {x:.12e}, {y:.12e}, {z:.12e}" for i, (x, y, z) in enumerate(mesh.points, 1)]
    if cap == "stiff":
        out += ["*NODE, NSET=NCAP"]
        out += [f"{i}, {x:.12e}, {y:.12e}, {z:.12e}" for i, (x, y, z) in enumerate(whole.points[n:], n + 1)]
    else:
        out += ["*NODE, NSET=NCAP", f"{reference}, 0., 0., {case.length}", f"{rotation}, 0., 0., {case.length}"]
    out += ["*ELEMENT, TYPE=C3D20R, ELSET=RUBBER"]
    out += [lines([i, *(cell + 1)], 11) for i, cell in enumerate(mesh.cells, 1)]
    out += ["*NSET, NSET=BASE", lines(mesh.base + 1), "*NSET, NSET=TIP", lines(mesh.tip + 1)]
    # CalculiX: W = 2 mu/alpha^2 (...) + (J - 1)^2/D, so D = 2/K
    out += ["*MATERIAL, NAME=OGDEN", "*HYPERELASTIC, OGDEN, N=1", f"{mu}, {alpha}, {2 / (case.bulk_ratio * mu):.12e}"]
    out += ["*SOLID SECTION, ELSET=RUBBER, MATERIAL=OGDEN"]
    if cap == "stiff":
        new = whole.cells[(whole.cells >= n).any(axis=1)]
        out += ["*ELEMENT, TYPE=C3D20R, ELSET=CAP"]
        out += [lines([i, *(cell + 1)], 11) for i, cell in enumerate(new, elements + 1)]
        elements += len(new)
        out += ["*MATERIAL, NAME=STIFF", "*ELASTIC", f"{CAP_MODULUS}, {CAP_POISSON}", "*SOLID SECTION, ELSET=CAP, MATERIAL=STIFF"]
    if len(mesh.trusses):
        ends = mesh.points[mesh.trusses]
        length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        assert np.ptp(length) < 1e-9 * length.mean(), "one spring constant for all"
        out += ["*ELEMENT, TYPE=SPRINGA, ELSET=FIBRES"]
        out += [f"{i}, {a + 1}, {b + 1}" for i, (a, b) in enumerate(mesh.trusses, elements + 1)]
        out += ["*SPRING, ELSET=FIBRES", "", f"{case.fibre_stiffness / length.mean():.12e}"]
    if cap == "rigid":
        out += [f"*RIGID BODY, NSET=TIP, REF NODE={reference}, ROT NODE={rotation}"]
    out += ["*BOUNDARY", "BASE, 1, 3"]
    # one step, whose time is the pressure in kPa: a new step would forget the increment to extrapolate from
    last = case.pressures_kpa[-1]
    out += ["*TIME POINTS, NAME=ASKED", lines(case.pressures_kpa, 8)]
    out += ["*STEP, NLGEOM, INC=100000", "*STATIC", f"{first_kpa}, {last}, 1e-5, {longest_kpa}", *CONTROLS]
    out += ["*DLOAD", f"RUBBER, P6, {1e-3 * last:.12e}"]
    if cap == "stiff":
        a2, b2 = case.inner_radius**2, case.outer_radius**2
        out += [f"CAP, P2, {-1e-3 * last * a2 / (b2 - a2):.12e}"]
    else:
        out += ["*CLOAD", f"{reference}, 3, {1e-3 * last * np.pi * case.inner_radius**2:.12e}"]
    out += ["*NODE PRINT, NSET=NALL, TIME POINTS=ASKED", "U", "*END STEP"]
    return "\n".join(out) + "\n"


def displacements(text, count):
    """The blocks of nodal displacements in a .dat file, in order."""
    blocks = re.split(r"displacements \(vx,vy,vz\) for set NALL and time.*\n", text)[1:]
    for block in blocks:
        rows = np.array([line.split() for line in block.strip().splitlines()[:count]], dtype=float)
        assert rows.shape == (count, 4) and (rows[:, 0] == np.arange(1, count + 1)).all(), "an incomplete block of displacements"
        yield rows[:, 1:]


def inflate(case, first_kpa, longest_kpa, cap, ccx, folder):
    """Write the deck, run CalculiX in `folder`, read what it found; the fields of the report."""
    mesh = free.TubeMesh(case)
    (folder / "free.inp").write_text(deck(case, mesh, first_kpa, longest_kpa, cap))
    begin = time.perf_counter()
    with open(folder / "free.log", "w") as log:
        process = subprocess.Popen([ccx, "free"], cwd=folder, stdout=log, stderr=subprocess.STDOUT)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    wall = time.perf_counter() - begin
    log = (folder / "free.log").read_text()
    data = folder / "free.dat"
    moved = list(displacements(data.read_text(), len(mesh.points))) if data.exists() else []
    if len(moved) < len(case.pressures_kpa):
        print("\n".join(log.splitlines()[-15:]), file=sys.stderr)
        print(f"CalculiX reached {len(moved)} of {len(case.pressures_kpa)} pressures (exit code {process.returncode})", file=sys.stderr)
    equations = re.search(r"number of equations\s+(\d+)", log)
    return dict(
        unknowns=int(equations.group(1)) if equations else 0,
        iterations=len(re.findall(r"^\s*iteration\s+\d+\s*$", log, re.M)),
        increments=sum(line.split()[:1] != [] and line.split()[0].isdigit() for line in (folder / "free.sta").read_text().splitlines()),
        wall_s=wall,
        cpu_s=used.ru_utime + used.ru_stime,
        peak_mb=used.ru_maxrss / 1024.0,
        complete=len(moved) == len(case.pressures_kpa),
        states=[mesh.measure(mesh.points + u, kpa) for u, kpa in zip(moved, case.pressures_kpa)],
    )


def version(ccx):
    told = subprocess.run([ccx, "-v"], capture_output=True, text=True).stdout
    found = re.search(r"Version\s+(\S+)", told)
    return found.group(1) if found else "unknown"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--case", choices=free.CASES, default="20deg-L40")
    parser.add_argument("--first-kpa", type=float, default=1.0, help="first increment")
    parser.add_argument("--step-kpa", type=float, default=1.0, help="longest increment")
    parser.add_argument("--to-kpa", type=float, help="leave out the pressures above")
    parser.add_argument("--cap", choices=("stiff", "rigid"), help="a stiff ring (default with fibres), or CalculiX's rigid body (default without)")
    parser.add_argument("--ccx", default="ccx", help="the program")
    parser.add_argument("--keep", type=pathlib.Path, help="folder for CalculiX's files (default: removed)")
    args = parser.parse_args()
    case = free.up_to(free.CASES[args.case], args.to_kpa)
    with tempfile.TemporaryDirectory() as scratch:
        folder = args.keep or pathlib.Path(scratch)
        folder.mkdir(parents=True, exist_ok=True)
        found = inflate(case, args.first_kpa, args.step_kpa, args.cap or ("stiff" if case.fibres else "rigid"), args.ccx, folder)
    free.report(program="CalculiX", version=version(args.ccx), case=case.name, mesh=case.mesh_name, **found)
    sys.exit(0 if found["complete"] else 1)
