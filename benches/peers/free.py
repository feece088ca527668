"""A FREE as both peers get it: cases, the mesh along the helix, and what is measured on a deformed mesh.

Units: mm, MPa (N/mm^2), radians; kPa and degrees where a name says so. z runs from the fixed base to the tip; right-handed helix.
"""

import dataclasses
import json
import resource

import numpy as np


@dataclasses.dataclass(frozen=True)
class Case:
    """One tube with six fibres (or bare), its mesh and the pressures at which it is measured."""

    name: str
    winding_angle_deg: float  # from the hoop direction
    length: float
    around: int  # elements around; the mesh lines follow the fibres
    along: int
    pressures_kpa: tuple
    fibres: int = 6
    fibre_stiffness: float = 644.0  # EA, N; linear in the stretch, compression too
    inner_radius: float = 4.76
    wall: float = 0.8
    shear_modulus: float = 0.393
    ogden_alpha: float = 1.2
    bulk_ratio: float = 1000.0  # K/mu

    @property
    def outer_radius(self):
        return self.inner_radius + self.wall

    @property
    def helix_slope(self):
        """k = cot(angle)/R_outer, rad/mm: the lines eta = Theta - k Z of mesh and fibres."""
        return 1.0 / (np.tan(np.radians(self.winding_angle_deg)) * self.outer_radius)

    @property
    def mesh_name(self):
        return f"hex20 {self.around}x{self.along}x1"


_TO_68_9 = (10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 68.9)
CASES = {
    case.name: case
    for case in (
        Case("20deg-L40", 20.0, 40.0, 12, 28, _TO_68_9),
        Case("20deg-L130", 20.0, 130.0, 12, 90, _TO_68_9),
        Case("20deg-L40-finer", 20.0, 40.0, 24, 56, _TO_68_9),
        Case("60deg-L40", 60.0, 40.0, 12, 18, (10.0, 20.0, 30.0, 40.0, 50.0)),
        Case("bare-L40", 90.0, 40.0, 12, 28, (4.0, 12.0, 20.0, 24.0), fibres=0),
    )
}


class TubeMesh:
    """20-node hexahedra, one through the wall, sheared along eta = Theta - k Z. Corner order as VTK and CalculiX C3D20."""

    # (radial, circumferential, axial) half steps of the 20 nodes within an element
    _LOCAL = np.array(
        [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [0, 0, 2], [2, 0, 2], [2, 2, 2], [0, 2, 2]]
        + [[1, 0, 0], [2, 1, 0], [1, 2, 0], [0, 1, 0], [1, 0, 2], [2, 1, 2], [1, 2, 2], [0, 1, 2]]
        + [[0, 0, 1], [2, 0, 1], [2, 2, 1], [0, 2, 1]]
    )
    # the inner face as an 8-node quadrilateral, s around and t along: corners, then edges
    INNER_FACE = [0, 3, 7, 4, 11, 19, 15, 16]

    def __init__(self, case):
        self.case = case
        turn, rows = 2 * case.around, 2 * case.along + 1
        grid = np.stack(np.meshgrid(np.arange(3), np.arange(turn), np.arange(rows), indexing="ij"), axis=-1)
        exists = (grid % 2).sum(axis=-1) <= 1
        # numbered ring by ring along the tube, which keeps the band narrow
        i, j, k = (a[exists] for a in np.moveaxis(grid, -1, 0))
        order = np.lexsort((i, j, k))
        self.steps = np.stack([i, j, k], axis=-1)[order]
        number = np.full(exists.shape, -1)
        number[tuple(self.steps.T)] = np.arange(len(order))

        radius = case.inner_radius + 0.5 * case.wall * self.steps[:, 0]
        self.height = case.length * self.steps[:, 2] / (2 * case.along)
        angle = 2 * np.pi * self.steps[:, 1] / turn + case.helix_slope * self.height
        self.angle = angle
        self.points = np.stack([radius * np.cos(angle), radius * np.sin(angle), self.height], axis=-1)

        first = 2 * np.stack(np.meshgrid(np.arange(case.around), np.arange(case.along), indexing="ij"), axis=-1).reshape(-1, 2)
        steps = self._LOCAL[None] + np.insert(first, 0, 0, axis=1)[:, None]
        self.cells = number[steps[..., 0], steps[..., 1] % turn, steps[..., 2]]
        self.base = np.flatnonzero(self.steps[:, 2] == 0)
        self.tip = np.flatnonzero(self.steps[:, 2] == rows - 1)

        if case.fibres:
            assert case.around % case.fibres == 0, "each fibre needs a line of element corners"
            every = turn // case.fibres
            lines = number[2, np.arange(case.fibres) * every]  # fibre x rows
            self.trusses = np.stack([lines[:, :-1], lines[:, 1:]], axis=-1).reshape(-1, 2)
        else:
            self.trusses = np.zeros((0, 2), dtype=int)

    def measure(self, points, pressure_kpa):
        """Stretch, inner radius, expansion and twist of the deformed nodes.

        Mid: the rings of corner nodes within the central 20 % of the length; stretch and twist are slopes over them. The expansion
        is the outer radius of equal area of an incompressible wall, b^2 = a^2 + (B^2 - A^2)/stretch, over B: with fibres that
        dimple the wall, the outer nodes alone would mislead.
        """
        case = self.case
        rows = np.arange(0, 2 * case.along + 1, 2)
        inside = rows[np.abs(rows / (2 * case.along) - 0.5) <= 0.1 + 1e-9]
        # mean turn of each ring, followed from ring to ring so that it never wraps
        turned = np.arctan2(points[:, 1], points[:, 0]) - self.angle
        mean = {k: np.angle(np.exp(1j * turned[self.steps[:, 2] == k]).mean()) for k in rows}
        ring_turn = np.unwrap([mean[k] for k in rows])
        ring_z = np.array([points[self.steps[:, 2] == k, 2].mean() for k in rows])
        ring_height = case.length * rows / (2 * case.along)
        middle = np.isin(rows, inside)
        fit = lambda y: np.polyfit(ring_height[middle], y[middle], 1)[0]
        inner = (self.steps[:, 0] == 0) & np.isin(self.steps[:, 2], inside)
        a = np.hypot(points[inner, 0], points[inner, 1]).mean()
        stretch = fit(ring_z)
        b = np.sqrt(a**2 + (case.outer_radius**2 - case.inner_radius**2) / stretch)
        return {
            "pressure_kpa": pressure_kpa,
            "stretch_total": (ring_z[-1] - ring_z[0]) / case.length,
            "stretch_mid": stretch,
            "inner_mid": a / case.inner_radius,
            "expansion_mid": b / case.outer_radius,
            "twist_total_deg_per_mm": np.degrees(ring_turn[-1] - ring_turn[0]) / case.length,
            "twist_mid_deg_per_mm": np.degrees(fit(ring_turn)),
        }


def report(**fields):
    """One JSON line, the format that `run` reads from every program."""
    print(json.dumps(fields, default=float))


def peak_mb(who=resource.RUSAGE_SELF):
    return resource.getrusage(who).ru_maxrss / 1024.0


def up_to(case, kpa):
    """The case without its pressures above `kpa` (none left out where that is None)."""
    return case if kpa is None else dataclasses.replace(case, pressures_kpa=tuple(p for p in case.pressures_kpa if p <= kpa))
