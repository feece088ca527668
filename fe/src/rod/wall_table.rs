use super::table_grid::TableGrid;
use crate::{Run, SectionError, WallResponse, jet::Jet};
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Why a table cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TableError {
    /// A table of too few nodes or of a reversed range.
    #[error("a section table needs two nodes of volume, stretch and twist with rising ends: {0:?}")]
    Grid(TableGrid),
    /// The wall has no answer at a node.
    #[error(
        "the wall has no answer at {volume:.3} of its outer radius's area, stretch {axial_stretch:.3} and {twist:.3} rad of twist an outer radius"
    )]
    NoAnswer {
        /// Enclosed volume per reference length over pi B^2.
        volume: f64,
        /// Axial stretch.
        axial_stretch: f64,
        /// Twist over the length of an outer radius, rad.
        twist: f64,
    },
    /// There is no such section.
    #[error(transparent)]
    Section(#[from] SectionError),
    /// The computation was stopped from outside.
    #[error("tabulating the section was stopped")]
    Stopped,
}

/// Strain energy of a tube's bare wall over enclosed volume (per reference length, in pi B^2), stretch and twist (over a length of B, rad),
/// J/m: tricubic Hermite, with energy, gradient and mixed second derivatives at the nodes the provider's own. Even in the twist.
#[derive(Clone, Debug)]
pub(super) struct WallTable {
    grid: TableGrid,
    /// Derivatives of each node: bits of the index are by volume, by stretch, by twist. Volume fastest, then stretch.
    nodes: Vec<[f64; 8]>,
}

/// Cubic Hermite weights of (value, slope) at both ends of a cell of size h, at t in 0..1: values, first, second derivatives.
fn hermite(t: f64, h: f64) -> [[f64; 4]; 3] {
    let (t2, t3) = (t * t, t * t * t);
    let h2 = h * h;
    [
        [1.0 - 3.0 * t2 + 2.0 * t3, h * (t - 2.0 * t2 + t3), 3.0 * t2 - 2.0 * t3, h * (t3 - t2)],
        [6.0 * (t2 - t) / h, 1.0 - 4.0 * t + 3.0 * t2, 6.0 * (t - t2) / h, 3.0 * t2 - 2.0 * t],
        [(12.0 * t - 6.0) / h2, (6.0 * t - 4.0) / h, (6.0 - 12.0 * t) / h2, (6.0 * t - 2.0) / h],
    ]
}

/// Cell of an evenly spaced axis, and weights at a place in it.
fn weights((low, high, count): (f64, f64, usize), at: f64) -> (usize, [[f64; 4]; 3]) {
    let size = (high - low) / (count - 1) as f64;
    let place = (at - low) / size;
    let cell = (place.max(0.0) as usize).min(count - 2);
    (cell, hermite(place - cell as f64, size))
}

/// Orders of the derivatives by stretch and twist that are wanted: six of one, one, none.
const ORDERS: [(usize, usize); 6] = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)];

impl WallTable {
    /// Tabulates a wall (`None` where it has no answer) over a grid for a tube of outer radius `radius` (m). Lines of constant stretch and twist
    /// are shared among threads and followed from the tube's own volume both ways, by a clone of the provider each.
    pub fn tabulate<P>(grid: TableGrid, radius: f64, provider: &P, run: &Run<'_>) -> Result<Self, TableError>
    where
        P: FnMut(f64, f64, f64) -> Option<WallResponse> + Clone + Send + Sync,
    {
        if !grid.is_sound() {
            return Err(TableError::Grid(grid));
        }
        let area = PI * radius * radius;
        let (volumes, stretches) = (grid.volume.2, grid.stretch.2);
        let size = (grid.volume.1 - grid.volume.0) / (volumes - 1) as f64;
        let line = |index: usize| -> Result<Vec<[f64; 8]>, TableError> {
            let axial_stretch = TableGrid::node(grid.stretch, index % stretches);
            let twist = TableGrid::node(grid.twists(), index / stretches);
            let mut nodes = vec![[0.0; 8]; volumes];
            let middle = (0..volumes).find(|i| TableGrid::node(grid.volume, *i) >= grid.own_volume);
            let middle = middle.unwrap_or(volumes - 1);
            for order in [(middle..volumes).collect::<Vec<_>>(), (0..middle).rev().collect()] {
                let mut provider = provider.clone();
                for k in order {
                    if run.is_stopped() {
                        return Err(TableError::Stopped);
                    }
                    let volume = TableGrid::node(grid.volume, k);
                    let found = provider(area * volume, axial_stretch, twist / radius)
                        .ok_or(TableError::NoAnswer { volume, axial_stretch, twist })?;
                    let units = [area, 1.0, 1.0 / radius];
                    let slope = |i: usize| found.gradient[i] * units[i];
                    let mixed = |i: usize, j: usize| found.hessian[i][j] * units[i] * units[j];
                    let [v, s, t] = [0, 1, 2];
                    nodes[k] = [
                        found.energy,
                        slope(v),
                        slope(s),
                        mixed(v, s),
                        slope(t),
                        mixed(v, t),
                        mixed(s, t),
                        0.0,
                    ];
                }
            }
            // The third mixed derivative from the second ones of the neighbours.
            let along: Vec<f64> = nodes.iter().map(|node| node[6]).collect();
            for (k, node) in nodes.iter_mut().enumerate() {
                node[7] = slope_of(&along, k) / size;
            }
            Ok(nodes)
        };
        let lines = stretches * grid.twist.1;
        let work = || (0..lines).into_par_iter().map(line).collect::<Result<Vec<_>, _>>();
        let found = match rayon::ThreadPoolBuilder::new().num_threads(run.jobs.max(1)).build() {
            Ok(pool) => pool.install(work),
            Err(_) => (0..lines).map(line).collect(),
        };
        Ok(WallTable { grid, nodes: found?.into_iter().flatten().collect() })
    }

    /// The nodes it was made on.
    pub fn grid(&self) -> &TableGrid {
        &self.grid
    }

    /// The energy with its first and second derivatives; beyond the table a quadratic.
    pub fn energy(&self, [volume, stretch, twist]: [f64; 3]) -> Jet {
        let clamped = |(low, high, _): (f64, f64, usize), at: f64| at.clamp(low, high);
        let size = twist.abs();
        let at = [
            clamped(self.grid.volume, volume),
            clamped(self.grid.stretch, stretch),
            clamped(self.grid.twists(), size),
        ];
        let mut energy = self.inside(at);
        let beyond = Vector3::new(volume - at[0], stretch - at[1], size - at[2]);
        if beyond != Vector3::zeros() {
            let bent = energy.hessian * beyond;
            energy.value += energy.gradient.dot(&beyond) + 0.5 * beyond.dot(&bent);
            energy.gradient += bent;
        }
        if twist < 0.0 {
            energy.gradient[2] = -energy.gradient[2];
            for i in 0..2 {
                energy.hessian[(i, 2)] = -energy.hessian[(i, 2)];
                energy.hessian[(2, i)] = -energy.hessian[(2, i)];
            }
        }
        energy
    }

    fn inside(&self, [volume, stretch, twist]: [f64; 3]) -> Jet {
        let (cell_v, in_v) = weights(self.grid.volume, volume);
        let (cell_s, in_s) = weights(self.grid.stretch, stretch);
        let (cell_t, in_t) = weights(self.grid.twists(), twist);
        // Along the twist, then the stretch, then the volume: by volume's end and derivative, six orders.
        let mut lines = [[[0.0; 6]; 2]; 2];
        for (a, ends) in lines.iter_mut().enumerate() {
            for b in 0..2 {
                let corner = |c: usize| {
                    let line = (cell_t + c) * self.grid.stretch.2 + cell_s + b;
                    &self.nodes[line * self.grid.volume.2 + cell_v + a]
                };
                let (near, far) = (corner(0), corner(1));
                for k in 0..4 {
                    let along =
                        in_t.map(|w| w[0] * near[k] + w[1] * near[k + 4] + w[2] * far[k] + w[3] * far[k + 4]);
                    let (by_volume, by_stretch) = (k % 2, k / 2);
                    for (target, (s, t)) in ends[by_volume].iter_mut().zip(ORDERS) {
                        *target += in_s[s][2 * b + by_stretch] * along[t];
                    }
                }
            }
        }
        let along = |order: usize, k: usize| {
            let w = &in_v[order];
            w[0] * lines[0][0][k] + w[1] * lines[0][1][k] + w[2] * lines[1][0][k] + w[3] * lines[1][1][k]
        };
        let [vs, vt, st] = [along(1, 1), along(1, 2), along(0, 4)];
        Jet {
            value: along(0, 0),
            gradient: Vector3::new(along(1, 0), along(0, 1), along(0, 2)),
            hessian: Matrix3::new(along(2, 0), vs, vt, vs, along(0, 3), st, vt, st, along(0, 5)),
        }
    }
}

/// Derivative, by the index, of the polynomial through the (up to) five values nearest to one of them.
fn slope_of(values: &[f64], own: usize) -> f64 {
    let count = values.len().min(5);
    let first = own.saturating_sub(2).min(values.len() - count);
    let at = (own - first) as f64;
    let places = || (0..count).map(|i| i as f64);
    // Derivative at x_o of Lagrange's polynomial i: prod_(m not i, o) (x_o - x_m)/(x_i - x_m) / (x_i - x_o), or, for
    // i = o, sum_m 1/(x_o - x_m).
    let weight = |x: f64| -> f64 {
        if x == at {
            return places().filter(|m| *m != x).map(|m| 1.0 / (at - m)).sum();
        }
        places().filter(|m| *m != x && *m != at).map(|m| (at - m) / (x - m)).product::<f64>() / (x - at)
    };
    places().zip(&values[first..]).map(|(x, value)| weight(x) * value).sum()
}
