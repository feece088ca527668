"""Reads the states of a solid, as a collection (.pvd) of grids (.vtu), and checks what they say.

    python -m venv .venv && .venv/bin/pip install -r tests/python/requirements.txt
    .venv/bin/python tests/python/read_vtu.py PATH.pvd

meshio reads them; where pyvista is installed, too (it brings all of VTK, over 500 MB), VTK must read the same.
The volume of the rubber is integrated here from the points alone, in the node order that VTK documents: a wrong order or an element
turned inside out does not get past.
"""

import sys
import xml.etree.ElementTree
from collections import defaultdict
from pathlib import Path

import meshio
import numpy as np

try:
    import pyvista
except ImportError:
    pyvista = None

# vtkTriQuadraticHexahedron: twice the coordinates of its nodes.
NODES = np.array([
    (0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2),
    (1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2),
    (0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1),
    (0, 1, 1), (2, 1, 1), (1, 0, 1), (1, 2, 1), (1, 1, 0), (1, 1, 2), (1, 1, 1),
])
SCALARS = ("von_mises_stress_mpa", "pressure_in_rubber_mpa")
TRIPLES = ("displacement_mm", "principal_stretch", "principal_log_strain", "principal_cauchy_stress_mpa")


def check(condition, message):
    if not condition:
        sys.exit(f"FAILED: {message}")


def jacobians(points):
    """Determinants (cells, 27) of the cells' maps from (0, 1)^3 at 27 Gauss points, and the points' weights."""
    place, weight = np.polynomial.legendre.leggauss(3)
    x = 0.5 * (1 + place)
    values = np.stack([(1 - x) * (1 - 2 * x), 4 * x * (1 - x), x * (2 * x - 1)])
    slopes = np.stack([4 * x - 3, 4 - 8 * x, 4 * x - 1])
    a, b, c = NODES.T
    gradient = np.stack([
        np.einsum("ai,aj,ak->aijk", slopes[a], values[b], values[c]),
        np.einsum("ai,aj,ak->aijk", values[a], slopes[b], values[c]),
        np.einsum("ai,aj,ak->aijk", values[a], values[b], slopes[c]),
    ]).reshape(3, 27, 27)
    determinants = np.linalg.det(np.einsum("cax,rag->cgxr", points, gradient))
    return determinants, np.einsum("i,j,k->ijk", *3 * [weight / 2]).ravel()


def finite(mesh, name, components):
    values = mesh.point_data.get(name)
    check(values is not None, f"there is no {name}, only {sorted(mesh.point_data)}")
    shape = (len(mesh.points),) if components == 1 else (len(mesh.points), components)
    check(values.shape == shape, f"{name} has the shape {values.shape}")
    check(np.isfinite(values).all(), f"{name} is not finite everywhere")
    return values


def read_rubber(path, pressure):
    mesh = meshio.read(path)
    check([block.type for block in mesh.cells] == ["hexahedron27"], f"{path}: {mesh.cells}")
    cells = mesh.cells[0].data
    determinants, weights = jacobians(mesh.points[cells])
    check((determinants > 0).all(), f"{path}: least Jacobian {determinants.min()}")
    volume = (determinants @ weights).sum()
    stated = mesh.field_data["rubber_volume_mm3"].item()
    check(abs(volume / stated - 1) < 1e-9, f"{path}: volume {volume}, stated {stated}")
    check(abs(mesh.field_data["pressure_kpa"].item() - pressure) < 1e-9, f"{path}: {mesh.field_data}")
    arrays = {name: finite(mesh, name, 3) for name in TRIPLES} | {name: finite(mesh, name, 1) for name in SCALARS}
    stretch, stress = arrays["principal_stretch"], arrays["principal_cauchy_stress_mpa"]
    check((np.diff(stretch, axis=1) <= 0).all(), "principal stretches are not sorted")
    check(np.allclose(np.log(stretch), arrays["principal_log_strain"], atol=1e-5), "stretch and log strain differ")
    check(np.allclose(-stress.mean(axis=1), arrays["pressure_in_rubber_mpa"], atol=1e-5), "pressure and stress differ")
    check(set(np.unique(mesh.cell_data["layer"][0])) <= {0, 1}, "layers other than 0 and 1")
    check(np.isfinite(mesh.cell_data["pressure_in_rubber_mpa"][0]).all(), "pressure is not finite")
    return mesh, cells, volume


def read_fibres(path):
    mesh = meshio.read(path)
    check([block.type for block in mesh.cells] == ["line"], f"{path}: {mesh.cells}")
    stretch, tension = finite(mesh, "stretch", 1), finite(mesh, "tension_n", 1)
    finite(mesh, "displacement_mm", 3)
    # At rest both are rounding errors.
    agrees = (np.sign(tension) == np.sign(stretch - 1)) | (np.abs(stretch - 1) < 1e-12)
    check(agrees.all(), "a fibre's tension has not the sign of its stretch")
    return mesh, tension


def same_by_vtk(path, mesh):
    grid = pyvista.read(path)
    check(grid.n_cells == len(mesh.cells[0].data), f"VTK sees {grid.n_cells} cells")
    check(np.array_equal(grid.points, mesh.points), "VTK reads other points")
    for name, values in mesh.point_data.items():
        check(np.array_equal(grid.point_data[name], values), f"VTK reads another {name}")
    if mesh.cells[0].type == "hexahedron27":
        check(set(grid.celltypes) == {pyvista.CellType.TRIQUADRATIC_HEXAHEDRON}, "cells of another type in VTK")
        coordinates = np.reshape(grid.GetCell(0).GetParametricCoords(), (27, 3))
        check(np.array_equal(2 * coordinates, NODES), "VTK has another order of nodes")


def main(path):
    path = Path(path)
    frames = defaultdict(list)
    for entry in xml.etree.ElementTree.parse(path).iter("DataSet"):
        frames[float(entry.attrib["timestep"])].append(path.parent / entry.attrib["file"])
    check(frames, "the collection is empty")
    rest = None
    for pressure, (rubber, *fibres) in sorted(frames.items()):
        mesh, cells, volume = read_rubber(rubber, pressure)
        undeformed = mesh.points - mesh.point_data["displacement_mm"]
        if rest is None:
            rest = undeformed
            reference_volume = (jacobians(undeformed[cells])[0] @ jacobians(undeformed[cells])[1]).sum()
        check(np.allclose(undeformed, rest, atol=1e-9), "points less displacements are not the undeformed points")
        base = rest[:, 2] < 1e-9
        check(base.any() and np.abs(mesh.point_data["displacement_mm"][base]).max() < 1e-9, "the base has moved")
        # Rubber of a bulk modulus of a thousand times that of shear.
        check(abs(volume / reference_volume - 1) < 1e-3, f"the rubber's volume changes by {volume / reference_volume - 1}")
        strain = mesh.point_data["principal_log_strain"].max()
        check((strain < 1e-6) == (pressure == 0), f"log strain {strain} at {pressure} kPa")
        print(f"{pressure:g} kPa: {len(cells)} hexahedra of {volume:.3f} mm3, greatest log strain {strain:.4f}")
        if pyvista:
            same_by_vtk(rubber, mesh)
        for file in fibres:
            lines, tension = read_fibres(file)
            count = len(np.unique(lines.cell_data["fibre"][0]))
            mean = tension.mean()
            check((mean > 1e-3) == (pressure > 0), f"mean tension {mean} N at {pressure} kPa")
            print(f"  {len(lines.cells[0].data)} lines of {count} fibres, tension {tension.min():.3f} to {tension.max():.3f} N")
            if pyvista:
                same_by_vtk(file, lines)
    if pyvista:
        reader = pyvista.get_reader(path)
        check(list(reader.time_values) == sorted(frames), f"VTK sees times {reader.time_values}")
        reader.set_active_time_value(max(frames))
        check(len(reader.read()) == len(frames[max(frames)]), "VTK sees another number of parts")
    print(f"{len(frames)} states read by meshio{' and VTK' if pyvista else ''}")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
