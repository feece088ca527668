use crate::{Run, SectionLaw, SectionResponse};
use actuator::{FibreLaw, Free, FreePath};
use rayon::prelude::*;

/// Nodes of a section table. The twist is tabulated as `sigma = tau - shear (lambda - 1) + drift p`: for small pressures and
/// stretches, sigma = 0 is where tension-only fibres go slack, and there the law has a kink that a table must not straddle.
#[derive(Clone, Debug, PartialEq)]
pub struct TableGrid {
    /// Pressures, Pa, rising from zero.
    pub pressures: Vec<f64>,
    /// Least and greatest axial stretch, and the number of nodes between and including them.
    pub stretch: (f64, f64, usize),
    /// Least and greatest sigma, rad/m, and the number of nodes.
    pub sigma: (f64, f64, usize),
    /// d tau/d lambda along a line of constant sigma, rad/m.
    pub shear: f64,
    /// -d tau/dp along a line of constant sigma, rad/m/Pa.
    pub drift: f64,
}

/// A section law interpolated from a table: tricubic Hermite of the enthalpy, so that force, torque and stiffness are the
/// derivatives of one function whose first derivatives are continuous.
///
/// At the nodes the energy, force, torque and coupling are the provider's own; slopes along the pressure are taken from the
/// neighbouring planes. Outside its stretches and twists the law goes on as a quadratic, for Newton's excursions only:
/// [`SectionLaw::covers`] says no there, nor where the provider had no answer at a corner of the cell.
#[derive(Clone, Debug)]
pub struct SectionTable {
    grid: TableGrid,
    /// (energy, d/dlambda, d/dsigma, d2/dlambda dsigma) of each node and the slopes of these along p; sigma fastest.
    nodes: Vec<[[f64; 4]; 2]>,
    known: Vec<bool>,
}

/// Why a table cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TableError {
    /// A table of too few nodes or of a reversed range.
    #[error(
        "a section table needs two pressures rising from zero and two nodes of stretch and twist with rising ends: {0:?}"
    )]
    Grid(TableGrid),
    /// The provider has no answer anywhere at this pressure.
    #[error("the section has no answer at {:.3} kPa for any tabulated stretch and twist; lower the greatest pressure", pressure / 1e3)]
    NoAnswer {
        /// The pressure, Pa.
        pressure: f64,
    },
    /// The computation was stopped from outside.
    #[error("tabulating the section was stopped")]
    Stopped,
}

/// Spacing of the table: stretch, and twist times the outer radius.
const SPACING: (f64, f64) = (0.025, 0.04);
/// Most nodes a direction.
const MOST_NODES: usize = 45;
/// Pressure planes, denser towards zero, where the fibres' slackness shows.
const PLANES: usize = 9;

impl TableGrid {
    /// The grid for a FREE used in modules up to a pressure (Pa), from its own free path: its stretch with margins on both
    /// sides (others pull and push it), its twist in both senses (others turn it). States of the path above the pressure and
    /// within 2 % of its limit do not count.
    pub fn for_free(free: &Free, path: &FreePath, pressure_max: f64) -> Self {
        let b = free.tube.outer_radius();
        let turn = free.winding.turn_per_length(b);
        let below = path.limit_pressure().map_or(pressure_max, |limit| pressure_max.min(0.98 * limit));
        let within = || path.states.iter().filter(|state| state.pressure <= below);
        let fold =
            |start: f64, f: fn(f64, f64) -> f64| within().map(|state| state.axial_stretch).fold(start, f);
        let (least, greatest) = (fold(1.0, f64::min), fold(1.0, f64::max));
        // Held in a bundle, a FREE is bent by the others: an arm of a diameter, a bend of a radian in ten diameters.
        let margin = 0.12 + 0.25 * (greatest - least);
        let twist = within().map(|state| state.twist_per_length.abs()).fold(0.0, f64::max);
        let twist = 1.1 * twist + 0.05 / b;
        let (mut shear, mut drift) = (0.0, 0.0);
        if free.winding.fibre.law == FibreLaw::TensionOnly && turn > 0.0 {
            // A slack tube has b^2 = B^2/lambda, so (b^2 (k + tau)^2 + lambda^2) = B^2 k^2 + 1 begins with
            // tau = (B^2 k^2 - 2)/(2 B^2 k) (lambda - 1). Pressure widens it by p/(2 mu (B^2/A^2 - 1)).
            shear = (b * b * turn * turn - 2.0) / (2.0 * b * b * turn);
            let ratio2 = (b / free.tube.inner_radius).powi(2);
            drift = turn / (2.0 * free.elastomer.initial_shear_modulus() * (ratio2 - 1.0));
        }
        let stretch = (least - margin, greatest + margin);
        let sheared = [stretch.0 - 1.0, stretch.1 - 1.0].map(|strain| -shear * strain);
        // Under pressure a FREE is turned against its sense by half of what it turns itself at most.
        let upper = twist.max(drift * pressure_max + 0.5 * twist);
        let sigma = (-twist + sheared[0].min(sheared[1]), upper + sheared[0].max(sheared[1]));
        let count = |(low, high): (f64, f64), spacing: f64| {
            (((high - low) / spacing).ceil() as usize + 1).clamp(2, MOST_NODES)
        };
        let pressures =
            (0..PLANES).map(|i| pressure_max * (i as f64 / (PLANES - 1) as f64).powf(1.3)).collect();
        let (stretches, sigmas) = (count(stretch, SPACING.0), count(sigma, SPACING.1 / b));
        TableGrid {
            pressures,
            stretch: (stretch.0, stretch.1, stretches),
            sigma: aligned(sigma, sigmas),
            shear,
            drift,
        }
    }

    fn is_sound(&self) -> bool {
        let rising = self.pressures.windows(2).all(|pair| pair[1] > pair[0]);
        let range =
            |(low, high, count): (f64, f64, usize)| count >= 2 && high > low && (high - low).is_finite();
        self.pressures.len() >= 2
            && self.pressures[0] == 0.0
            && rising
            && range(self.stretch)
            && range(self.sigma)
            && self.shear.is_finite()
            && self.drift.is_finite()
    }
}

/// Widens a range so that zero is a node: the kink lies on a line of the grid.
fn aligned((low, high): (f64, f64), count: usize) -> (f64, f64, usize) {
    let spacing = (high - low) / (count - 1) as f64;
    let (below, above) = ((-low / spacing).ceil(), (high / spacing).ceil());
    (-below * spacing, above * spacing, (below + above) as usize + 1)
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

/// Cell, place in it (0 to 1) and cell size on an evenly spaced axis.
fn locate((low, high, count): (f64, f64, usize), at: f64) -> (usize, f64, f64) {
    let size = (high - low) / (count - 1) as f64;
    let place = ((at - low) / size).clamp(0.0, (count - 1) as f64);
    let cell = (place as usize).min(count - 2);
    (cell, place - cell as f64, size)
}

/// Value, gradient (lambda, sigma) and second derivatives (ll, ls, ss) in table coordinates.
type Local = [f64; 6];

impl SectionTable {
    /// Tabulates a provider (`None` where it has no answer) over a grid; lines of constant pressure and stretch are shared
    /// among threads, and followed from sigma = 0 outwards by a clone of the provider each, as far as there are answers (two
    /// nodes without one end a line).
    pub fn tabulate<P>(grid: TableGrid, provider: &P, run: &Run) -> Result<Self, TableError>
    where
        P: FnMut(f64, f64, f64) -> Option<SectionResponse> + Clone + Send + Sync,
    {
        if !grid.is_sound() {
            return Err(TableError::Grid(grid));
        }
        let (stretches, sigmas) = (grid.stretch.2, grid.sigma.2);
        let node = |(low, high, count): (f64, f64, usize), i: usize| {
            low + (high - low) * i as f64 / (count - 1) as f64
        };
        let spacing = (grid.sigma.1 - grid.sigma.0) / (sigmas - 1) as f64;
        let lines = grid.pressures.len() * stretches;
        let line = |index: usize| -> Option<Vec<Option<[f64; 4]>>> {
            let (pressure, stretch) =
                (grid.pressures[index / stretches], node(grid.stretch, index % stretches));
            let mut values = vec![None; sigmas];
            let middle = locate(grid.sigma, 0.0).0;
            for order in [(middle..sigmas).collect::<Vec<_>>(), (0..middle).rev().collect()] {
                let mut provider = provider.clone();
                let mut missing = 0;
                for k in order {
                    if run.is_stopped() {
                        return None;
                    }
                    let twist = node(grid.sigma, k) + grid.shear * (stretch - 1.0) - grid.drift * pressure;
                    let found = ask(&mut provider, [pressure, stretch, twist], spacing);
                    missing = if found.is_some() { 0 } else { missing + 1 };
                    // Beyond a fold there is nothing, and a failure costs more than many answers.
                    if missing == 2 {
                        break;
                    }
                    values[k] = found.map(|found| {
                        // Along a line of constant sigma the twist grows with the stretch.
                        let mixed = found.stiffness[0][1] + grid.shear * found.stiffness[1][1];
                        [found.energy, found.force + grid.shear * found.torque, found.torque, mixed]
                    });
                }
            }
            Some(values)
        };
        let work = || (0..lines).into_par_iter().map(line).collect::<Option<Vec<_>>>();
        let found = match rayon::ThreadPoolBuilder::new().num_threads(run.jobs.max(1)).build() {
            Ok(pool) => pool.install(work),
            Err(_) => (0..lines).map(line).collect(),
        };
        let found: Vec<Option<[f64; 4]>> = found.ok_or(TableError::Stopped)?.into_iter().flatten().collect();
        let known: Vec<bool> = found.iter().map(Option::is_some).collect();
        let plane = stretches * sigmas;
        let mut values = Vec::with_capacity(found.len());
        for (index, value) in found.iter().enumerate() {
            let whole = &found[index / plane * plane..][..plane];
            let filled = value.or_else(|| nearest(whole, index % plane, &grid));
            values.push(filled.ok_or(TableError::NoAnswer { pressure: grid.pressures[index / plane] })?);
        }
        let nodes = (0..values.len())
            .map(|index| [values[index], slope_along_pressure(&grid, &values, index)])
            .collect();
        Ok(SectionTable { grid, nodes, known })
    }

    /// The nodes it was made on.
    pub fn grid(&self) -> &TableGrid {
        &self.grid
    }

    /// Number of nodes where the provider had no answer.
    pub fn unknown_nodes(&self) -> usize {
        self.known.iter().filter(|known| !**known).count()
    }

    fn sigma(&self, pressure: f64, stretch: f64, twist: f64) -> f64 {
        twist - self.grid.shear * (stretch - 1.0) + self.grid.drift * pressure
    }

    fn pressure_cell(&self, pressure: f64) -> (usize, f64, f64) {
        let axis = &self.grid.pressures;
        let cell = axis.partition_point(|node| *node <= pressure).clamp(1, axis.len() - 1) - 1;
        let size = axis[cell + 1] - axis[cell];
        (cell, ((pressure - axis[cell]) / size).clamp(0.0, 1.0), size)
    }

    fn index(&self, plane: usize, stretch: usize, sigma: usize) -> usize {
        (plane * self.grid.stretch.2 + stretch) * self.grid.sigma.2 + sigma
    }

    /// Interpolates in the table's coordinates, clamped to its box; `order` 0 for the values, 1 for the slopes along p.
    fn inside(&self, pressure: f64, stretch: f64, sigma: f64, order: usize) -> Local {
        let (plane, at_p, size_p) = self.pressure_cell(pressure);
        let along_p = hermite(at_p, size_p)[order];
        let (cell_l, at_l, size_l) = locate(self.grid.stretch, stretch);
        let (cell_s, at_s, size_s) = locate(self.grid.sigma, sigma);
        let (in_l, in_s) = (hermite(at_l, size_l), hermite(at_s, size_s));
        let mut local = [0.0; 6];
        for a in 0..2 {
            for b in 0..2 {
                let below = &self.nodes[self.index(plane, cell_l + a, cell_s + b)];
                let above = &self.nodes[self.index(plane + 1, cell_l + a, cell_s + b)];
                for k in 0..4 {
                    let value = along_p[0] * below[0][k]
                        + along_p[1] * below[1][k]
                        + along_p[2] * above[0][k]
                        + along_p[3] * above[1][k];
                    // k: energy, lambda-slope, sigma-slope, both.
                    let (l, s) = (2 * a + k % 2, 2 * b + k / 2);
                    for (target, [i, j]) in
                        local.iter_mut().zip([[0, 0], [1, 0], [0, 1], [2, 0], [1, 1], [0, 2]])
                    {
                        *target += in_l[i][l] * in_s[j][s] * value;
                    }
                }
            }
        }
        local
    }

    /// The same, continued beyond the box as a quadratic.
    fn local(&self, pressure: f64, stretch: f64, sigma: f64, order: usize) -> Local {
        let [e, l, s, ll, ls, ss] = self.inside(pressure, stretch, sigma, order);
        let (grid_l, grid_s) = (self.grid.stretch, self.grid.sigma);
        let x = stretch - stretch.clamp(grid_l.0, grid_l.1);
        let y = sigma - sigma.clamp(grid_s.0, grid_s.1);
        [
            e + l * x + s * y + 0.5 * ll * x * x + ls * x * y + 0.5 * ss * y * y,
            l + ll * x + ls * y,
            s + ls * x + ss * y,
            ll,
            ls,
            ss,
        ]
    }
}

/// The provider's answer at (pressure, stretch, twist). Newton's method of a section may stumble exactly where a fibre
/// tightens; then it is asked at a twist a few hundredths of a cell beside, and the answer is carried over as a quadratic.
fn ask<P>(provider: &mut P, [pressure, stretch, twist]: [f64; 3], spacing: f64) -> Option<SectionResponse>
where
    P: FnMut(f64, f64, f64) -> Option<SectionResponse>,
{
    [0.0, 0.03, -0.03].into_iter().find_map(|part| {
        let beside = part * spacing;
        let SectionResponse { energy, force, torque, stiffness } =
            provider(pressure, stretch, twist + beside)?;
        Some(SectionResponse {
            energy: energy - torque * beside + 0.5 * stiffness[1][1] * beside * beside,
            force: force - stiffness[0][1] * beside,
            torque: torque - stiffness[1][1] * beside,
            stiffness,
        })
    })
}

/// The known node of a plane that is nearest, continued to another one by its linear terms.
fn nearest(plane: &[Option<[f64; 4]>], index: usize, grid: &TableGrid) -> Option<[f64; 4]> {
    let count = grid.sigma.2;
    let size = |(low, high, count): (f64, f64, usize)| (high - low) / (count - 1) as f64;
    let place = |index: usize| ((index / count) as f64, (index % count) as f64);
    let (l, s) = place(index);
    let distance = |other: usize| {
        let (ol, os) = place(other);
        (ol - l).powi(2) + (os - s).powi(2)
    };
    let known = (0..plane.len()).filter(|other| plane[*other].is_some());
    let best = known.min_by(|a, b| distance(*a).total_cmp(&distance(*b)))?;
    let [energy, by_l, by_s, mixed] = plane[best]?;
    let (ol, os) = place(best);
    let (x, y) = ((l - ol) * size(grid.stretch), (s - os) * size(grid.sigma));
    Some([energy + by_l * x + by_s * y + mixed * x * y, by_l + mixed * y, by_s + mixed * x, mixed])
}

/// Derivative along p at a node: of the polynomial through the (up to) five nearest planes.
fn slope_along_pressure(grid: &TableGrid, values: &[[f64; 4]], index: usize) -> [f64; 4] {
    let size = grid.stretch.2 * grid.sigma.2;
    let (own, rest) = (index / size, index % size);
    let count = grid.pressures.len().min(5);
    let first = own.saturating_sub(2).min(grid.pressures.len() - count);
    let stencil = &grid.pressures[first..first + count];
    let at = stencil[own - first];
    let mut slope = [0.0; 4];
    for (i, p) in stencil.iter().enumerate() {
        // Derivative at x_o of Lagrange's polynomial i: prod_(m not i, o) (x_o - x_m)/(x_i - x_m) / (x_i - x_o), or, for
        // i = o, sum_m 1/(x_o - x_m).
        let weight: f64 = if i == own - first {
            stencil.iter().enumerate().filter(|(m, _)| *m != i).map(|(_, other)| 1.0 / (at - other)).sum()
        } else {
            let others = stencil.iter().enumerate().filter(|(m, _)| *m != i && *m != own - first);
            others.map(|(_, other)| (at - other) / (p - other)).product::<f64>() / (p - at)
        };
        for (target, value) in slope.iter_mut().zip(&values[(first + i) * size + rest]) {
            *target += weight * value;
        }
    }
    slope
}

impl SectionLaw for SectionTable {
    fn respond(&self, pressure: f64, axial_stretch: f64, twist_per_length: f64) -> SectionResponse {
        let shear = self.grid.shear;
        let sigma = self.sigma(pressure, axial_stretch, twist_per_length);
        let [energy, l, s, ll, ls, ss] = self.local(pressure, axial_stretch, sigma, 0);
        let coupling = ls - shear * ss;
        SectionResponse {
            energy,
            force: l - shear * s,
            torque: s,
            stiffness: [[ll - 2.0 * shear * ls + shear * shear * ss, coupling], [coupling, ss]],
        }
    }

    fn covers(&self, pressure: f64, axial_stretch: f64, twist_per_length: f64) -> bool {
        let grid = &self.grid;
        let sigma = self.sigma(pressure, axial_stretch, twist_per_length);
        let within = |value: f64, low: f64, high: f64| value >= low && value <= high;
        let top = grid.pressures[grid.pressures.len() - 1];
        if !(within(pressure, 0.0, top)
            && within(axial_stretch, grid.stretch.0, grid.stretch.1)
            && within(sigma, grid.sigma.0, grid.sigma.1))
        {
            return false;
        }
        let (plane, at_p, _) = self.pressure_cell(pressure);
        let (l, s) = (locate(grid.stretch, axial_stretch).0, locate(grid.sigma, sigma).0);
        // On a plane of the table only that plane counts.
        let planes = if at_p == 0.0 {
            plane..plane + 1
        } else if at_p == 1.0 {
            plane + 1..plane + 2
        } else {
            plane..plane + 2
        };
        planes
            .into_iter()
            .all(|k| (0..4).all(|corner| self.known[self.index(k, l + corner / 2, s + corner % 2)]))
    }

    fn volume(&self, pressure: f64, axial_stretch: f64, twist_per_length: f64) -> f64 {
        let sigma = self.sigma(pressure, axial_stretch, twist_per_length);
        let [by_pressure, ..] = self.local(pressure, axial_stretch, sigma, 1);
        let [_, _, by_sigma, ..] = self.local(pressure, axial_stretch, sigma, 0);
        // At constant twist sigma grows by the drift.
        -by_pressure - self.grid.drift * by_sigma
    }

    fn pressure_slopes(&self, pressure: f64, axial_stretch: f64, twist_per_length: f64) -> [f64; 2] {
        let (shear, drift) = (self.grid.shear, self.grid.drift);
        let sigma = self.sigma(pressure, axial_stretch, twist_per_length);
        let [_, lp, sp, ..] = self.local(pressure, axial_stretch, sigma, 1);
        let [.., ls, ss] = self.local(pressure, axial_stretch, sigma, 0);
        // At constant twist sigma grows by the drift.
        let torque = sp + drift * ss;
        [lp + drift * ls - shear * torque, torque]
    }
}

#[cfg(test)]
#[path = "table_tests.rs"]
mod tests;
