"""Models of FREE actuators (fibre-reinforced elastomeric enclosures), evaluated on numpy arrays.

SI units throughout, pressures are gauge. The base frame has +z from the base plate to the tip plate; at rest the tip plate's centre
is at (0, 0, length) and its frame has the directions of the base frame. Winding angles are from the hoop.

Where a model has no answer, arrays hold NaN, and `status` tells why; nothing is raised, so that one row outside does not lose the
others. What is wrong with the call itself is raised: TypeError for the other kind of model, ValueError for shapes and values.
"""

from os import PathLike
from typing import Final

from numpy import float64, uint8
from numpy.typing import ArrayLike, NDArray

OK: Final[int]
"""There is an answer."""
OUTSIDE_PRESSURE: Final[int]
"""A pressure is outside the domain."""
UNSTABLE: Final[int]
"""The pressures are beyond the stable states that the finite elements found."""
OUTSIDE_ANGLE: Final[int]
"""The winding angle is outside the domain."""
OUTSIDE_MODULUS: Final[int]
"""The shear modulus is outside the domain."""

class ModelError(ValueError):
    """A file is no model, or none for this version of freeact."""

class Tip:
    """Poses of a module's tip; NaN where `status` is not `OK`."""

    @property
    def position_m(self) -> NDArray[float64]:
        """Centre of the tip plate, m, base frame: (..., 3)."""
    @property
    def rotation_wxyz(self) -> NDArray[float64]:
        """Unit quaternion (w, x, y, z) from the plate's frame to the base frame: (..., 4)."""
    @property
    def jacobian(self) -> NDArray[float64] | None:
        """Rates per Pa of the pressure in each FREE: position (m, base frame), then angular rate (rad, plate's frame):
        (..., frees, 6). None unless it was asked for."""
    @property
    def status(self) -> NDArray[uint8]:
        """OK, OUTSIDE_PRESSURE or UNSTABLE: (...)."""

class Deformation:
    """Deformation of a single FREE; NaN where `status` is not `OK`."""

    @property
    def axial_stretch(self) -> NDArray[float64]:
        """Length over that at rest."""
    @property
    def expansion(self) -> NDArray[float64]:
        """Outer radius (of equal area) over that at rest."""
    @property
    def twist_per_length_rad_m(self) -> NDArray[float64]:
        """Twist over the length at rest, rad/m, with the sign of the FREE's hand."""
    @property
    def jacobian(self) -> NDArray[float64] | None:
        """[..., input, output]: inputs pressure (Pa), winding angle (rad), shear modulus (Pa); outputs stretch, expansion,
        twist. None unless it was asked for."""
    @property
    def status(self) -> NDArray[uint8]:
        """OK, OUTSIDE_PRESSURE, OUTSIDE_ANGLE or OUTSIDE_MODULUS."""

class Model:
    """A model of a single FREE or of a module, from a file that `freeact fit` or `freeact identify` wrote.

    Effects act as they do at rest; those with a memory (hysteresis, lag, creep, ...) act in a State. A model is never changed:
    threads may share it.
    """

    @staticmethod
    def load(path: str | PathLike[str]) -> Model:
        """Reads a .model file. Raises OSError where it cannot be read, ModelError where it is none."""
    @property
    def frees(self) -> int:
        """Number of FREEs; 1 of a single FREE."""
    @property
    def kind(self) -> str:
        """"module" or "free"."""
    @property
    def effects(self) -> list[str]:
        """Names of the effects beyond the finite elements, in the order in which they act."""
    @property
    def domain_kpa(self) -> NDArray[float64]:
        """Least and greatest pressure (kPa) of each FREE that the splines answer, after the effects: (frees, 2). Of a single FREE
        at its own winding angle and shear modulus (NaN where the model does not reach these)."""
    @property
    def winding_angle_rad(self) -> tuple[float, float, float]:
        """Of a single FREE: its own winding angle from the hoop, the model's least and its greatest, rad."""
    @property
    def shear_modulus_pa(self) -> tuple[float, float, float]:
        """Of a single FREE: its own shear modulus, the model's least and its greatest, Pa."""
    def tip(self, pressures_pa: ArrayLike, *, jacobian: bool = False) -> Tip:
        """Poses of a module's tip at commanded pressures (Pa), (..., frees), that are held."""
    def deform(
        self,
        pressure_pa: ArrayLike,
        winding_angle_rad: ArrayLike | None = None,
        shear_modulus_pa: ArrayLike | None = None,
        *,
        jacobian: bool = False,
    ) -> Deformation:
        """Deformation of a single FREE at commanded pressures (Pa) that are held, winding angles (rad) and shear moduli (Pa), by default its
        own; broadcast against each other."""
    def clearance(self, pressures_pa: ArrayLike) -> NDArray[float64]:
        """How much (Pa) every pressure that a module's splines answer may change at once without leaving the domain, negative
        outside, at commanded pressures (Pa), (..., frees): (...)."""
    def error_bars(self, pressures_pa: ArrayLike) -> NDArray[float64] | None:
        """What 95 of 100 errors against the finite elements stay below around commanded pressures (Pa), (..., frees): of the
        position (m) and the rotation (rad), (..., 2). None where the model was made without states to judge it by."""
    def state(self) -> State:
        """An actuator of this model that has rested, to be stepped through time."""

class State:
    """An actuator in time: a model with what its effects remember. Begins rested."""

    def __init__(self, model: Model) -> None: ...
    def step(
        self, step_s: float, pressures_pa: ArrayLike, *, measured: bool = False, jacobian: bool = False
    ) -> Tip | Deformation:
        """Goes `step_s` seconds on with these pressures (Pa), (frees,), held over the step; what is read at its end: a Tip of a
        module, a Deformation of a single FREE.

        The pressures are commands, which the supply follows. With `measured=True` they are what the sensors read, and the supply
        takes no part. Raises ValueError for a step or pressure that is none; the memory has then not gone on.
        """
    def reset(self) -> None:
        """Back to rest: everything is forgotten."""
