use super::{
    table_grid::TableGrid,
    wall_table::{TableError, WallTable},
};
use crate::{
    Run, SectionLaw, SectionMesh, SectionResponse, SectionSolver, WallResponse, jet::Jet,
    smeared_threads::SmearedThreads,
};
use actuator::Free;
use std::f64::consts::{PI, TAU};

/// The section law of a FREE whose threads are spread over its surface, from a table of its bare wall.
///
/// `Phi(p, lambda, tau) = min over V of W(V, lambda, tau) + T(V, lambda, tau) - p V`, per reference length: W the strain energy of the wall at the
/// enclosed volume V, tabulated from the section's finite elements, T that of the threads, as it is. Rubber keeps its volume, so that V gives the
/// radius b on which the threads lie: `b^2 lambda = V/pi + B^2 - A^2`.
///
/// Only what is smooth is interpolated. Threads that carry tension only have a kink where they go slack, and where they run along the tube
/// they are a hundred times stiffer than the wall: a table of Phi itself, whose cells the kink crosses, answers there with forces that are
/// far greater than what the pressure does, and even with negative stiffness. W knows no limit pressure either: what balloons is the tube with its
/// threads, under a pressure. There [`SectionLaw::respond`] is not a number.
///
/// Beyond the table's volumes, stretches and twists the wall goes on as a quadratic, for Newton's excursions only:
/// [`SectionLaw::covers`] says no there.
#[derive(Clone, Debug)]
pub struct SectionTable {
    wall: WallTable,
    threads: SmearedThreads,
    /// B, m.
    radius: f64,
}

/// Relative size of the last step of the volume, which is put in to first order: Newton's next one would be its square.
const TOLERANCE: f64 = 1e-8;
/// Steps of the volume allowed. Three to five are usual.
const MOST_STEPS: usize = 60;
/// Greatest step of the volume relative to the tube's own.
const LONGEST_STEP: f64 = 0.2;

impl SectionTable {
    /// Tabulates the wall of a FREE by finite elements of `mesh`.
    ///
    /// # Errors
    /// [`TableError`] where there is no such section, the grid makes no sense, or the run was stopped.
    pub fn new(free: &Free, grid: TableGrid, mesh: SectionMesh, run: &Run<'_>) -> Result<Self, TableError> {
        let mut bare = *free;
        bare.winding.fibre.axial_stiffness = 0.0;
        // Nothing of a bare wall changes along its circumference: one piece of it.
        bare.winding.fibre.diameter = TAU * bare.tube.outer_radius();
        let mut solver = SectionSolver::new(&bare, mesh)?;
        let wall = move |volume: f64, stretch: f64, twist: f64| {
            solver.respond_at_volume(volume, stretch, twist).ok()
        };
        Self::tabulate(free, grid, &wall, run)
    }

    /// Tabulates the bare wall of a FREE that a provider knows (`None` where it has no answer).
    ///
    /// # Errors
    /// [`TableError`] where the grid makes no sense, the provider has no answer, or the run was stopped.
    pub fn tabulate<P>(free: &Free, grid: TableGrid, wall: &P, run: &Run<'_>) -> Result<Self, TableError>
    where
        P: FnMut(f64, f64, f64) -> Option<WallResponse> + Clone + Send + Sync,
    {
        let radius = free.tube.outer_radius();
        let wall = WallTable::tabulate(grid, radius, wall, run)?;
        Ok(SectionTable { wall, threads: SmearedThreads::of(free), radius })
    }

    /// The threads wound loosely: longer than their helix at rest by this share of it.
    pub fn with_slack(mut self, slack: f64) -> Self {
        self.threads = self.threads.with_slack(slack);
        self
    }

    /// The nodes it was made on.
    pub fn grid(&self) -> &TableGrid {
        self.wall.grid()
    }

    /// W + T.
    fn strain_energy(&self, at: [f64; 3]) -> Jet {
        let wall = self.wall.energy(at);
        let [volume, stretch, twist] = [0, 1, 2].map(|i| Jet::variable(at[i], i));
        let own = 1.0 - self.grid().own_volume;
        // (b/B)^2 = (V/(pi B^2) + 1 - (A/B)^2)/lambda.
        let outer = (volume + Jet::constant(own)) * stretch.powf(-1.0);
        self.threads.energy(outer, stretch, twist).map_or(wall, |threads| wall + threads)
    }

    /// The volume (in pi B^2) of least enthalpy at a pressure (in J/m, p pi B^2), and W + T there.
    fn at_rest(&self, pressure: f64, stretch: f64, twist: f64) -> Option<(f64, Jet)> {
        if !(pressure.is_finite() && stretch > 0.0 && stretch.is_finite() && twist.is_finite()) {
            return None;
        }
        let own = self.grid().own_volume;
        let (least, most, _) = self.grid().volume;
        let mut volume = own;
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        // A kink is no place for Newton's method: it is told first on which side of it the volume comes to rest.
        let tight = self.threads.tight_at(stretch, twist);
        if let Some(tight) = tight.filter(|tight| !tight.is_nan()) {
            let kink = (tight * stretch - 1.0 + own).clamp(least, most);
            let energy = self.strain_energy([kink, stretch, twist]);
            let slope = energy.gradient[0] - pressure;
            if slope < 0.0 && (energy.hessian[(0, 0)] > 0.0 || kink <= own) {
                // A hair beyond, where threads are taut.
                (volume, low) = (kink + TOLERANCE * own, kink);
            } else if slope >= 0.0 {
                high = kink;
                volume = volume.min(kink);
            }
        }
        for _ in 0..MOST_STEPS {
            let mut energy = self.strain_energy([volume, stretch, twist]);
            let (slope, curvature) = (energy.gradient[0] - pressure, energy.hessian[(0, 0)]);
            // Past the greatest pressure that the wall holds: what lies beyond is another branch, if anything.
            if !(slope.is_finite() && curvature.is_finite()) || (curvature <= 0.0 && slope < 0.0) {
                return None;
            }
            if slope < 0.0 {
                low = low.max(volume);
            } else {
                high = high.min(volume);
            }
            let step = if curvature > 0.0 { -slope / curvature } else { -slope.signum() };
            let mut step = step.clamp(-LONGEST_STEP * own, LONGEST_STEP * own);
            let next = volume + step;
            if !(next >= low && next <= high) && step.abs() > TOLERANCE * own {
                step = if low.is_finite() && high.is_finite() { 0.5 * (low + high) - volume } else { step };
            }
            if step.abs() < TOLERANCE * own {
                energy.value += energy.gradient[0] * step;
                energy.gradient += energy.hessian.column(0) * step;
                return (curvature > 0.0).then_some((volume + step, energy));
            }
            volume += step;
        }
        None
    }

    /// The volume and W + T at a pressure (Pa), stretch and twist per reference length (rad/m).
    fn found(&self, pressure: f64, axial_stretch: f64, twist_per_length: f64) -> Option<(f64, Jet)> {
        let area = PI * self.radius * self.radius;
        self.at_rest(pressure * area, axial_stretch, twist_per_length * self.radius)
    }
}

impl SectionLaw for SectionTable {
    fn respond(&self, pressure: f64, axial_stretch: f64, twist_per_length: f64) -> SectionResponse {
        let Some((volume, energy)) = self.found(pressure, axial_stretch, twist_per_length) else {
            let nan = f64::NAN;
            return SectionResponse { energy: nan, force: nan, torque: nan, stiffness: [[nan; 2]; 2] };
        };
        let (b, h) = (self.radius, &energy.hessian);
        // The volume eliminated: K - k k^T / k_VV.
        let condensed = |i: usize, j: usize| h[(i, j)] - h[(i, 0)] * h[(0, j)] / h[(0, 0)];
        let coupling = b * condensed(1, 2);
        SectionResponse {
            energy: energy.value - pressure * PI * b * b * volume,
            force: energy.gradient[1],
            torque: b * energy.gradient[2],
            stiffness: [[condensed(1, 1), coupling], [coupling, b * b * condensed(2, 2)]],
        }
    }

    fn covers(&self, pressure: f64, axial_stretch: f64, twist_per_length: f64) -> bool {
        let grid = self.grid();
        let within = |value: f64, (low, high): (f64, f64)| value >= low && value <= high;
        within(axial_stretch, (grid.stretch.0, grid.stretch.1))
            && within(twist_per_length * self.radius, (-grid.twist.0, grid.twist.0))
            && self
                .found(pressure, axial_stretch, twist_per_length)
                .is_some_and(|(volume, _)| within(volume, (grid.volume.0, grid.volume.1)))
    }

    fn volume(&self, pressure: f64, axial_stretch: f64, twist_per_length: f64) -> f64 {
        let found = self.found(pressure, axial_stretch, twist_per_length);
        found.map_or(f64::NAN, |(volume, _)| PI * self.radius * self.radius * volume)
    }

    fn pressure_slopes(&self, pressure: f64, axial_stretch: f64, twist_per_length: f64) -> [f64; 2] {
        let Some((_, energy)) = self.found(pressure, axial_stretch, twist_per_length) else {
            return [f64::NAN; 2];
        };
        // dV/dp = 1/(W + T)_VV.
        let h = &energy.hessian;
        let area = PI * self.radius * self.radius;
        [h[(0, 1)], h[(0, 2)] * self.radius].map(|slope| area * slope / h[(0, 0)])
    }
}

#[cfg(test)]
#[path = "section_table_tests.rs"]
mod tests;
