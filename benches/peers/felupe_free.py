"""The FREE in felupe: displacement hexahedra with 8 quadrature points, MKL PARDISO, the tip cap as six unknowns.

felupe assembles the rubber and the fibres; the enclosed volume, the cap and Newton's loop are written here, as a user has to.
What a plain loop lacks and this one has: node updates in cylindrical coordinates, a predictor of degree five, steps that double, one symbolic
factorisation, the upper triangle alone, no sparse matrix built twice.
"""

import argparse
import resource
import sys
import time

import felupe as fem
import numpy as np
from pypardiso import PyPardisoSolver
from scipy.sparse import csr_matrix
from scipy.spatial.transform import Rotation

import free


class Ogden(fem.ConstitutiveMaterial):
    """W = 2 mu/alpha^2 (sum of isochoric stretches^alpha - 3) + K/2 (J - 1)^2, in principal axes."""

    def __init__(self, mu, alpha, bulk):
        self.mu, self.alpha, self.bulk = mu, alpha, bulk
        self.x = [np.eye(3), np.zeros(0)]

    def gradient(self, x):
        F = np.ascontiguousarray(np.moveaxis(x[0], (0, 1), (-2, -1)))  # (q, c, 3, 3)
        square, N = np.linalg.eigh(np.swapaxes(F, -1, -2) @ F)
        stretch = np.sqrt(square)
        J = stretch.prod(axis=-1)[..., None]
        s = (stretch * J ** (-1 / 3)) ** self.alpha
        m = s.mean(axis=-1, keepdims=True)
        tau = 2 * self.mu / self.alpha * (s - m) + self.bulk * J * (J - 1)  # Kirchhoff stress
        n = (F @ N) / stretch[..., None, :]
        self.state = square, stretch, J, s, m, tau, n, N
        P = (n * (tau / stretch)[..., None, :]) @ np.swapaxes(N, -1, -2)
        return [np.moveaxis(P, (-2, -1), (0, 1)), x[-1]]

    def hessian(self, x):
        """dP/dF at the state of the last call of `gradient`."""
        square, stretch, J, s, m, tau, n, N = self.state
        a, b = np.array([0, 0, 1, 1, 2, 2]), np.array([1, 2, 0, 2, 0, 1])
        # d tau_a / d ln stretch_b
        slope = 2 * self.mu * (m[..., None] - s[..., None, :] - s[..., :, None]) / 3
        slope[..., range(3), range(3)] += 2 * self.mu * s
        slope += (self.bulk * J * (2 * J - 1))[..., None]
        normal = slope / (stretch[..., :, None] * stretch[..., None, :])
        normal[..., range(3), range(3)] -= tau / square
        # (tau_a - tau_b)/(stretch_a^2 - stretch_b^2), with its limit for equal stretches
        apart = square[..., a] - square[..., b]
        equal = np.abs(apart) < 1e-6
        limit = (slope[..., a, a] + slope[..., b, b] - 2 * slope[..., a, b]) / (2 * (square[..., a] + square[..., b]))
        shear = np.where(equal, limit, (tau[..., a] - tau[..., b]) / np.where(equal, 1.0, apart))
        cross = (shear * square[..., b] - tau[..., b]) / (stretch[..., a] * stretch[..., b])

        D = np.zeros((*square.shape[:-1], 9, 9))
        D[..., ::4, ::4] = normal
        D[..., 3 * a + b, 3 * a + b] = shear
        D[..., 3 * a + b, 3 * b + a] = cross
        basis = np.einsum("...ia,...Jb->...iJab", n, N).reshape(D.shape)
        A = basis @ D @ np.swapaxes(basis, -1, -2)
        return [np.moveaxis(A, (-2, -1), (0, 1)).reshape(3, 3, 3, 3, *square.shape[:-1])]


class EnclosedVolume:
    """Volume within the inner surface and the two flat caps, about the centre of the base; its gradient and Hessian are those of
    the pressure. With x trilinear in the nodes of each 8-node face the Hessian is one constant tensor times the nodes."""

    _EPS = np.zeros((3, 3, 3))
    for _i, _j, _k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        _EPS[_i, _j, _k], _EPS[_j, _i, _k] = 1.0, -1.0

    def __init__(self, faces, rim_area):
        self.faces, self.rim_area = faces, rim_area
        quad = fem.QuadraticQuad()
        rule = fem.GaussLegendre(order=2, dim=2)
        G = np.zeros((8, 8, 8))
        for point, weight in zip(rule.points, rule.weights):
            h, (r, s) = quad.function(point), quad.gradient(point).T
            turn = lambda u, v: np.multiply.outer(u, v) - np.multiply.outer(v, u)
            G += weight / 3 * (np.multiply.outer(turn(h, r), s) - np.multiply.outer(turn(h, s), r) + np.multiply.outer(turn(r, s), h))
        self.G = G

    def wall(self, points):
        """Gradient at the faces' nodes (face, 8, 3) and Hessian (face, 8, 3, 8, 3) of the wall's share."""
        x = points[self.faces]
        w = np.tensordot(x, self.G, axes=(1, 2))  # (face, l, a, b)
        hessian = np.einsum("ikl,flab->faibk", self._EPS, w)
        gradient = 0.5 * np.einsum("faibk,fbk->fai", hessian, x)  # homogeneous of degree two
        return gradient, hessian


class Cap:
    """The rigid tip: centre and rotation, and its nodes as arms from the centre."""

    def __init__(self, points, length):
        self.origin = np.array([0.0, 0.0, length])
        self.arms = points - self.origin
        self.centre, self.rotation = self.origin.copy(), Rotation.identity()

    def moved(self, step):
        """Centre and rotation after the increment (translation, rotation vector in space)."""
        return self.centre + step[:3], Rotation.from_rotvec(step[3:]) * self.rotation

    def points(self):
        return self.centre + self.rotation.apply(self.arms)

    def tangent(self):
        """(nodes, 3, 6): how the nodes follow translation and rotation."""
        arms = self.rotation.apply(self.arms)
        T = np.zeros((len(arms), 3, 6))
        T[:, range(3), range(3)] = 1.0
        T[:, 0, 4], T[:, 0, 5] = arms[:, 2], -arms[:, 1]
        T[:, 1, 3], T[:, 1, 5] = -arms[:, 2], arms[:, 0]
        T[:, 2, 3], T[:, 2, 4] = arms[:, 1], -arms[:, 0]
        return T


class Tube:
    """The assembled tube: residual and the upper triangle of the tangent over the free nodes and the cap's six unknowns."""

    def __init__(self, case):
        self.case, self.shape = case, free.TubeMesh(case)
        shape = self.shape
        self.rest = shape.points
        mesh = fem.Mesh(self.rest, shape.cells, "hexahedron20")
        region = fem.RegionQuadraticHexahedron(mesh, quadrature=fem.GaussLegendre(order=1, dim=3))
        self.field = fem.Field(region, dim=3).as_container()
        self.solid = fem.SolidBody(Ogden(case.shear_modulus, case.ogden_alpha, case.bulk_ratio * case.shear_modulus), self.field)
        self.truss = None
        if len(shape.trusses):
            line = fem.RegionTruss(fem.Mesh(self.rest, shape.trusses, "line"))
            self.truss_field = fem.Field(line, dim=3).as_container()
            stiffness = np.full(len(shape.trusses), case.fibre_stiffness)
            self.truss = fem.TrussBody(fem.LinearElastic1D(E=stiffness), self.truss_field, area=np.ones(len(stiffness)))

        faces = shape.cells[:, shape.INNER_FACE]
        rim = self.rest[shape.tip[shape.steps[shape.tip, 0] == 0]]
        self.volume = EnclosedVolume(faces, self._area_within(rim))
        self.cap = Cap(self.rest[shape.tip], case.length)
        held = np.concatenate([shape.base, shape.tip])
        self.inner_nodes = np.setdiff1d(np.arange(len(self.rest)), held)
        self.radius, self.angle = np.hypot(self.rest[:, 0], self.rest[:, 1]), shape.angle.copy()
        self.height = self.rest[:, 2].copy()
        self._lay_out()

    @staticmethod
    def _area_within(rim):
        """Area within the rim, drawn by the quadratic edges of the elements (corners at even places)."""
        a, m, b = rim[0::2, :2], rim[1::2, :2], np.roll(rim[0::2, :2], -1, axis=0)
        cross = lambda u, v: u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
        return (4 * cross(a, m) + 4 * cross(m, b) - cross(a, b)).sum() / 6

    def _lay_out(self):
        """Where each entry of the matrices over all nodes goes in the reduced upper triangle: found once."""
        shape, n = self.shape, 3 * len(self.rest)
        reduced = np.full(n, -1)
        inner = (3 * self.inner_nodes[:, None] + np.arange(3)).ravel()
        reduced[inner] = np.arange(len(inner))
        self.inner, self.n_inner = inner, len(inner)
        tip = (3 * shape.tip[:, None] + np.arange(3)).ravel()
        self.tip = tip
        in_tip = np.full(n, -1)
        in_tip[tip] = np.arange(len(tip))

        self.solid.assemble.vector(self.field)
        pattern = self.solid.assemble.matrix().tocsr()
        rows = np.repeat(np.arange(n), np.diff(pattern.indptr))
        cols = pattern.indices
        key = rows.astype(np.int64) * n + cols

        position = lambda r, c: np.searchsorted(key, r.astype(np.int64) * n + c)
        faces = 3 * self.volume.faces[:, :, None] + np.arange(3)  # (face, 8, 3)
        r, c = np.broadcast_arrays(faces[:, :, :, None, None], faces[:, None, None])
        self.volume_position = position(r.ravel(), c.ravel())
        if self.truss is not None:
            self.truss.assemble.vector(self.truss_field)
            k = self.truss.assemble.matrix().tocsr()
            self.truss_position = position(np.repeat(np.arange(n), np.diff(k.indptr)), k.indices)

        # the free upper triangle, then the six columns of the cap beside the rows that meet it
        upper = (reduced[rows] >= 0) & (reduced[cols] >= reduced[rows])
        self.upper_from = np.flatnonzero(upper)
        beside = (reduced[rows] >= 0) & (in_tip[cols] >= 0)
        self.beside_from = np.flatnonzero(beside)
        self.meets = np.unique(reduced[rows[beside]])
        self.beside_at = np.searchsorted(self.meets, reduced[rows[beside]]) * len(tip) + in_tip[cols[beside]]
        both = (in_tip[rows] >= 0) & (in_tip[cols] >= 0)
        self.both_from = np.flatnonzero(both)
        self.both_at = in_tip[rows[both]] * len(tip) + in_tip[cols[both]]

        m = self.n_inner
        six = np.arange(6)
        corner = np.stack(np.triu_indices(6))
        row = np.concatenate([reduced[rows[upper]], np.repeat(self.meets, 6), m + corner[0]])
        col = np.concatenate([reduced[cols[upper]], np.tile(m + six, len(self.meets)), m + corner[1]])
        order = np.lexsort((col, row))
        self.order, self.corner = order, corner
        indptr = np.concatenate([[0], np.cumsum(np.bincount(row, minlength=m + 6))])
        self.matrix = csr_matrix((np.ones(len(order)), col[order].astype(np.int32), indptr.astype(np.int32)), shape=(m + 6, m + 6))
        self.unknowns = m + 6

    def points(self):
        """Deformed nodes."""
        x = np.stack([self.radius * np.cos(self.angle), self.radius * np.sin(self.angle), self.height], axis=-1)
        x[self.shape.tip] = self.cap.points()
        return x

    def residual(self, pressure):
        """Residual over the unknowns and the size of the forces in it; keeps what `tangent` needs."""
        x = self.x = self.points()
        u = self.field[0].values
        u[:] = x - self.rest
        force = self.solid.assemble.vector(self.field).toarray().ravel()
        if self.truss is not None:
            self.truss_field[0].values[:] = u
            force += self.truss.assemble.vector(self.truss_field).toarray().ravel()
        gradient, self.volume_hessian = self.volume.wall(x)
        push = np.bincount((3 * self.volume.faces[..., None] + np.arange(3)).ravel(), gradient.ravel(), minlength=force.size)
        force -= pressure * push

        # the cap: its nodes' forces by their tangent, and the volume of the cone from the origin to its disc
        self.T = self.cap.tangent().reshape(-1, 6)
        self.tip_force = force[self.tip]
        c, n = self.cap.centre, self.cap.rotation.apply([0.0, 0.0, 1.0])
        area = self.volume.rim_area / 3
        cone = area * np.concatenate([n, np.cross(n, c)])
        self.cone = area, c, n
        cap = self.T.T @ self.tip_force - pressure * cone
        r = np.concatenate([force[self.inner], cap])
        return r, pressure * np.linalg.norm(push[self.inner])

    def tangent(self, pressure):
        """Upper triangle of the tangent at the last residual."""
        data = self.solid.assemble.matrix().data
        if self.truss is not None:
            data[self.truss_position] += self.truss.assemble.matrix().data
        data -= pressure * np.bincount(self.volume_position, self.volume_hessian.ravel(), minlength=data.size)

        t = len(self.tip)
        beside = np.bincount(self.beside_at, data[self.beside_from], minlength=len(self.meets) * t).reshape(-1, t) @ self.T
        both = np.bincount(self.both_at, data[self.both_from], minlength=t * t).reshape(t, t)
        corner = self.T.T @ both @ self.T
        # finite rotation: second derivative of the nodes' arms, and of the cone's volume
        arms = self.cap.rotation.apply(self.cap.arms)
        f = self.tip_force.reshape(-1, 3)
        bend = arms.T @ f
        corner[3:, 3:] += 0.5 * (bend + bend.T) - np.trace(bend) * np.eye(3)
        area, c, n = self.cone
        corner[:3, 3:] -= pressure * area * self._d_normal(n)
        outer = np.outer(n, c)
        corner[3:, 3:] -= pressure * area * (0.5 * (outer + outer.T) - (n @ c) * np.eye(3))
        values = np.concatenate([data[self.upper_from], beside.ravel(), corner[tuple(self.corner)]])
        self.matrix.data[:] = values[self.order]
        return self.matrix

    @staticmethod
    def _d_normal(n):
        """d n / d rotation vector: omega x n."""
        return np.array([[0, n[2], -n[1]], [-n[2], 0, n[0]], [n[1], -n[0], 0]])

    def move(self, step):
        """Add a Newton step: radius, angle and height of the free nodes, the cap by its rotation."""
        du = step[: self.n_inner].reshape(-1, 3)
        i = self.inner_nodes
        c, s = np.cos(self.angle[i]), np.sin(self.angle[i])
        turn = (c * du[:, 1] - s * du[:, 0]) / self.radius[i]
        self.radius[i] += c * du[:, 0] + s * du[:, 1]
        self.angle[i] += turn
        self.height[i] += du[:, 2]
        self.cap.centre, self.cap.rotation = self.cap.moved(step[self.n_inner :])

    def state(self):
        return np.stack([self.radius, self.angle, self.height]), self.cap.centre.copy(), self.cap.rotation

    def restore(self, state):
        self.radius, self.angle, self.height = state[0].copy()
        self.cap.centre, self.cap.rotation = state[1].copy(), state[2]


def predict(history, pressure):
    """The polynomial through the states kept, at `pressure`; the cap's rotation from the last one on."""
    last = history[-1][1]
    p = np.array([h[0] for h in history])
    weight = np.array([np.prod([(pressure - q) / (a - q) for q in p if q != a]) for a in p])
    nodes = sum(w * h[1][0] for w, h in zip(weight, history))
    centre = sum(w * h[1][1] for w, h in zip(weight, history))
    turn = [np.zeros(3)]
    for earlier, later in zip(history[-2::-1], history[:0:-1]):
        turn.append(turn[-1] + (earlier[1][2] * later[1][2].inv()).as_rotvec())
    step = sum(w * t for w, t in zip(weight[::-1], turn))
    return nodes, centre, Rotation.from_rotvec(step) * last[2]


class Pardiso:
    """MKL PARDISO, LDL^T with Bunch-Kaufman pivots: Cholesky is 15 % faster, but tangents on the way need not be positive definite.
    Analysed once; minimum degree, a fifth faster here than METIS."""

    SYMMETRIC_INDEFINITE = -2
    PARAMETERS = {1: 1, 2: 0, 10: 8, 21: 1}  # own values; minimum degree; pivots perturbed below 1e-8; Bunch-Kaufman

    def __init__(self, matrix):
        self.solver = PyPardisoSolver(mtype=self.SYMMETRIC_INDEFINITE)
        for number, value in self.PARAMETERS.items():
            self.solver.set_iparm(number, value)
        self.seconds = {"factor": 0.0, "solve": 0.0}
        self._call(11, matrix, np.zeros(matrix.shape[0]), "factor")

    def _call(self, phase, matrix, rhs, what):
        start = time.process_time()
        self.solver.set_phase(phase)
        x = self.solver._call_pardiso(matrix, rhs)
        self.seconds[what] += time.process_time() - start
        return x

    def solve(self, matrix, rhs):
        self._call(22, matrix, rhs, "factor")
        return self._call(33, matrix, rhs, "solve")


FIRST_STEP_KPA = 0.25  # from rest, with stiff fibres and no predictor, 130 mm of tube diverge at 0.5
MOST_ITERATIONS = 8
DIVERGED = 1e4  # residual over the pressure's nodal forces


def inflate(case, longest_kpa, order, tolerance, log):
    """Sweep to the case's pressures; the fields of the report."""
    wall, cpu = time.perf_counter(), time.process_time()
    tube = Tube(case)
    pardiso = Pardiso(tube.matrix)
    assembly, iterations = 0.0, 0
    history, states = [(0.0, tube.state())], []
    kpa, step = 0.0, FIRST_STEP_KPA
    for target in case.pressures_kpa:
        while kpa < target:
            # equal steps to the next pressure asked for
            trial = kpa + (target - kpa) / np.ceil((target - kpa) / min(step, longest_kpa) - 1e-9)
            pressure = 1e-3 * trial
            tube.restore(predict(history, pressure))
            for count in range(MOST_ITERATIONS + 1):
                start = time.process_time()
                r, scale = tube.residual(pressure)
                relative = np.linalg.norm(r) / scale
                if log:
                    print(f"{trial:7.3f} kPa  {count}  {relative:.2e}", file=sys.stderr)
                converged = relative < tolerance
                if converged or not relative < DIVERGED or count == MOST_ITERATIONS:
                    assembly += time.process_time() - start
                    break
                matrix = tube.tangent(pressure)
                assembly += time.process_time() - start
                tube.move(-pardiso.solve(matrix, r))
                iterations += 1
            if converged:
                step = (trial - kpa) * (2.0 if count <= 3 else 1.0)
                kpa = trial
                history = (history + [(pressure, tube.state())])[-1 - order :]
            else:
                step = (trial - kpa) / 2
                if step < 1e-3 * FIRST_STEP_KPA:
                    raise SystemExit(f"no equilibrium found beyond {kpa:.3f} kPa, even by steps of {step:.1e} kPa")
        states.append(tube.shape.measure(tube.points(), target))
    return dict(
        unknowns=tube.unknowns,
        iterations=iterations,
        wall_s=time.perf_counter() - wall,
        cpu_s=time.process_time() - cpu,
        peak_mb=free.peak_mb(resource.RUSAGE_SELF),
        assembly_s=assembly,
        factor_s=pardiso.seconds["factor"],
        solve_s=pardiso.seconds["solve"],
        states=states,
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--case", choices=free.CASES, default="20deg-L40")
    parser.add_argument("--step-kpa", type=float, default=10.0, help="longest pressure step")
    parser.add_argument("--order", type=int, default=5, help="degree of the predictor")
    parser.add_argument("--tolerance", type=float, default=1e-6, help="residual over the pressure's nodal forces")
    parser.add_argument("--to-kpa", type=float, help="leave out the pressures above")
    parser.add_argument("--log", action="store_true", help="every iteration to standard error")
    args = parser.parse_args()
    case = free.up_to(free.CASES[args.case], args.to_kpa)
    free.report(program="felupe", version=fem.__version__, case=case.name, mesh=case.mesh_name, **inflate(case, args.step_kpa, args.order, args.tolerance, args.log))
