"""Time in microseconds a point of scipy's cubic RegularGridInterpolator on the table that the benchmark wrote: `scipy_grid.py DIR values|jacobian`.

All points in one call, which is how numpy is used at its fastest.
"""

import pathlib
import sys
import time

import numpy as np
from scipy.interpolate import RegularGridInterpolator

folder = pathlib.Path(sys.argv[1])
axes = np.fromfile(folder / "axes").reshape(4, -1)
nodes = axes.shape[1]
table = np.fromfile(folder / "table").reshape(nodes, nodes, nodes, nodes, 6)
points = np.fromfile(folder / "points").reshape(-1, 4)
spline = RegularGridInterpolator(tuple(axes), table, method="cubic")
begin = time.perf_counter()
spline(points)
if sys.argv[2] == "jacobian":
    for axis in range(4):
        spline(points, nu=np.eye(4, dtype=int)[axis])
print((time.perf_counter() - begin) * 1e6 / len(points))
