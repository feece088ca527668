"""Checks of the felupe peer's own parts: stress and stiffness of the rubber, volume and its derivatives, the tangent with the cap."""

import dataclasses

import numpy as np

import felupe_free
import free

rng = np.random.default_rng(1)


def small(name, found, wanted, bound):
    error = np.linalg.norm(np.asarray(found) - wanted) / np.linalg.norm(wanted)
    print(f"{name:50s} {error:.1e}  (bound {bound:.0e})")
    assert error < bound, name


def rubber():
    """P = dW/dF and A = dP/dF by central differences, with equal stretches and without."""
    mu, alpha, bulk = 0.393, 1.2, 39.3
    material = felupe_free.Ogden(mu, alpha, bulk)

    def energy(F):
        stretch = np.linalg.svd(F, compute_uv=False)
        J = stretch.prod()
        return 2 * mu / alpha**2 * ((stretch * J ** (-1 / 3)) ** alpha).sum() + bulk / 2 * (J - 1) ** 2

    stress = lambda F: material.gradient([F[:, :, None, None], None])[0][:, :, 0, 0]
    unit = lambda i, j: np.eye(3)[:, [i]] * np.eye(3)[[j]]
    h = 1e-6
    for name, F in (("general", np.eye(3) + 0.2 * rng.standard_normal((3, 3))), ("equal stretches", 1.1 * np.eye(3))):
        P = [[(energy(F + h * unit(i, j)) - energy(F - h * unit(i, j))) / (2 * h) for j in range(3)] for i in range(3)]
        A = [[(stress(F + h * unit(k, l)) - stress(F - h * unit(k, l))) / (2 * h) for l in range(3)] for k in range(3)]
        small(f"rubber, stress, {name}", stress(F), P, 1e-8)
        small(f"rubber, stiffness, {name}", material.hessian([None])[0][..., 0, 0], np.moveaxis(np.array(A), (0, 1), (2, 3)), 1e-7)


def volume_and_tangent():
    """The volume of the undeformed tube, and the tangent along random directions, in equilibrium: only there is it symmetric in the cap's
    rotation and free of the second derivatives of the cylindrical coordinates."""
    case = dataclasses.replace(free.CASES["20deg-L40"], around=6, along=4, length=4.0, pressures_kpa=(10.0,))
    tube = felupe_free.Tube(case)
    gradient, _ = tube.volume.wall(tube.rest)
    cone = tube.volume.rim_area / 3 * case.length
    volume = (gradient * tube.rest[tube.volume.faces]).sum() / 3 + cone  # homogeneous of degree three
    small("volume, 6 quadratic edges for the circle", volume, np.pi * case.inner_radius**2 * case.length, 2e-2)

    pressure, h, m = 1e-3, 1e-5, tube.n_inner
    pardiso = felupe_free.Pardiso(tube.matrix)
    for _ in range(8):
        r, _ = tube.residual(pressure)
        tube.move(-pardiso.solve(tube.tangent(pressure), r))
    tube.residual(pressure)
    K = tube.tangent(pressure).toarray()
    K = np.triu(K) + np.triu(K, 1).T
    start = tube.state()

    def residual(step):
        tube.restore(start)
        tube.move(step)
        return tube.residual(pressure)[0]

    blocks = {"nodes": slice(0, m), "cap's translation": slice(m, m + 3), "cap's rotation": slice(m + 3, m + 6)}
    for name, block in blocks.items():
        d = np.zeros(tube.unknowns)
        d[block] = rng.standard_normal(len(d[block]))
        slope, along = (residual(h * d) - residual(-h * d)) / (2 * h), K @ d
        small(f"tangent, {name}", along, slope, 1e-7)


rubber()
volume_and_tangent()
