//! The paper's modules as solids, beside the rods.

use super::{
    bench::Bench,
    module_rods::{GREATEST_KPA, Kind, SPACING_MM, follow},
};
use crate::{exit::Exit, failure::Failure, interrupt, study::module_rods::CasePath};
use actuator::{
    Case, Module, ModuleState,
    units::{KPA, MM},
};
use fe::{
    Bulge, IdlePressure, SolidBuckling, SolidModule, SolidModuleError, SolidModuleSettings, SolidShape,
};

/// Elements of a FREE through the wall, around and along, where meshes are coarse.
const COARSE: [u32; 3] = [1, 12, 60];
/// Least idle pressures are found to this, Pa.
const IDLE_TOLERANCE: f64 = 100.0;

/// An error of a module of solids on its way to the user.
pub fn lost(error: SolidModuleError) -> Failure {
    match error {
        SolidModuleError::Stopped => Failure::interrupted(),
        other => Failure::new(Exit::NotConverged, other),
    }
}

impl Bench {
    /// A module's solids on `threads` threads.
    pub fn solids(&self, module: &Module, threads: usize) -> Result<SolidModule, Failure> {
        let elements = self.coarse.then_some(COARSE);
        let settings = SolidModuleSettings { elements, threads, ..SolidModuleSettings::default() };
        SolidModule::new(module, settings).map_err(lost)
    }

    /// Threads left for each of some modules that are computed at the same time.
    fn threads_each(&self, modules: usize) -> usize {
        (self.jobs / modules.max(1)).max(1)
    }

    /// All cases of modules without ties through rising pressures (Pa), each to its first unstable state.
    pub fn solid_cases(
        &self,
        kinds: &'static [Kind],
        pressures: &[f64],
    ) -> Result<Vec<(&'static Kind, usize, CasePath)>, Failure> {
        let items: Vec<(&'static Kind, usize)> =
            kinds.iter().flat_map(|kind| (0..5).map(move |case| (kind, case))).collect();
        let threads = self.threads_each(items.len());
        self.each("modules as solids: a minute or two a case", &items, |(kind, case)| {
            let module = kind.module(SPACING_MM, 0);
            let mut solids = self.solids(&module, threads)?;
            let path = follow(&mut solids, &Case::all(&module)[*case], pressures, false)?;
            Ok((*kind, *case, path))
        })
    }
}

/// How a module of solids stands.
pub struct Standing {
    /// Pressure of the case, kPa.
    pub pressure_kpa: f64,
    /// Middle of each FREE from base to tip, m.
    pub centrelines: Vec<Vec<[f64; 3]>>,
    /// Pose and stability.
    pub state: ModuleState,
}

/// A module in case 2 without idle pressure, on its way to the greatest pressure.
pub struct SolidRise {
    /// Stable states.
    pub states: Vec<Standing>,
    /// Height of the plate at rest, m.
    pub rest_height: f64,
    /// Where it buckles.
    pub buckling: Option<SolidBuckling>,
    /// How far outwards the mode moves each FREE's surface, by lines along it.
    pub bulges: Vec<Vec<Vec<Bulge>>>,
    /// The last stable state with the mode (`.vtu`).
    pub grid: Vec<u8>,
}

/// Follows modules in case 2 without ties until they buckle, to `tolerance` (Pa).
pub fn rise(bench: &Bench, kinds: &'static [Kind], tolerance: f64) -> Result<Vec<SolidRise>, Failure> {
    let items: Vec<&'static Kind> = kinds.iter().collect();
    let threads = bench.threads_each(items.len());
    bench.each("Fig. 13 as solids, rising: some minutes", &items, |kind| {
        let module = kind.module(SPACING_MM, 0);
        let mut solids = bench.solids(&module, threads)?;
        let rest = solids.rest().map_err(lost)?;
        let mut on_path = vec![];
        let goal = with_idle(&Case::all(&module)[1], GREATEST_KPA * KPA, 0.0);
        let buckling = solids
            .first_buckling(&rest, &goal, tolerance, &mut |found, taken| {
                if taken && !found.state.is_buckled() {
                    on_path.push((found.shape.clone(), found.state.clone()));
                }
                !interrupt::is_asked()
            })
            .map_err(lost)?;
        let kilopascals = |pressures: &[f64]| pressures.iter().copied().fold(0.0, f64::max) / KPA;
        let standing = |(shape, state): (SolidShape, ModuleState)| Standing {
            pressure_kpa: kilopascals(shape.pressures()),
            centrelines: solids.centrelines(&shape),
            state,
        };
        let mut states: Vec<Standing> = on_path.into_iter().map(standing).collect();
        states.sort_by(|a, b| a.pressure_kpa.total_cmp(&b.pressure_kpa));
        let (mut bulges, mut grid) = (vec![], vec![]);
        if let Some(SolidBuckling { below, mode, .. }) = &buckling {
            if let Some(mode) = mode {
                let frees = 0..module.frees.len();
                bulges = frees.map(|free| solids.bulges(&below.shape, mode, free)).collect();
            }
            solids.write_vtu(&below.shape, mode.as_ref(), &mut grid).map_err(Failure::file)?;
        }
        Ok(SolidRise { states, rest_height: rest.state.chart.position[2], buckling, bulges, grid })
    })
}

/// The least idle pressure of modules at pressures (Pa) of case 2, sought from `share` of the case's downwards.
pub fn least_idle(
    bench: &Bench,
    wanted: &[(&'static Kind, f64)],
    share: f64,
) -> Result<Vec<IdlePressure>, Failure> {
    let threads = bench.threads_each(wanted.len());
    bench.each("least idle pressures of solids: minutes each", wanted, |(kind, pressure)| {
        let module = kind.module(SPACING_MM, 0);
        let mut solids = bench.solids(&module, threads)?;
        let case = &Case::all(&module)[1];
        let start = match solids.solve(&with_idle(case, *pressure, share * pressure)) {
            Ok(start) if !start.state.is_buckled() => start,
            Ok(_) | Err(SolidModuleError::NoEquilibrium(_)) => return Ok(IdlePressure::NeverEnough),
            Err(other) => return Err(lost(other)),
        };
        let goal = with_idle(case, *pressure, 0.0);
        let found = solids
            .first_buckling(&start, &goal, IDLE_TOLERANCE, &mut |_, _| !interrupt::is_asked())
            .map_err(lost)?;
        Ok(found.map_or(IdlePressure::NotNeeded, |found| {
            let pressures = found.below.shape.pressures();
            let idle = pressures.iter().zip(&case.inflated).filter(|(_, inflated)| !**inflated);
            IdlePressure::Least(idle.map(|(pressure, _)| *pressure).fold(0.0, f64::max))
        }))
    })
}

/// Pressures of a case with some in its idle FREEs, Pa.
pub fn with_idle(case: &Case, pressure: f64, idle: f64) -> Vec<f64> {
    let count = case.inflated.len();
    case.pressures(&vec![idle; count], &vec![pressure; count], 1.0)
}

/// Waves around the tube and height (mm) where a surface's motion outwards is greatest.
pub fn waves(lines: &[Vec<Bulge>]) -> (usize, f64) {
    let rings = lines.first().map_or(0, Vec::len);
    let ring = |k: usize| lines.iter().map(move |line| line[k]);
    let size = |k: &usize| ring(*k).map(|bulge| bulge.outwards.powi(2)).sum::<f64>();
    let Some(most) = (0..rings).max_by(|a, b| size(a).total_cmp(&size(b))) else { return (0, 0.0) };
    let harmonic = |n: &usize| {
        let sums = ring(most).fold([0.0; 2], |[cosines, sines], bulge| {
            let (sine, cosine) = (*n as f64 * bulge.around).sin_cos();
            [cosines + bulge.outwards * cosine, sines + bulge.outwards * sine]
        });
        // The mean counts once, waves share their square between sine and cosine.
        sums[0].hypot(sums[1]) * if *n == 0 { 0.5f64.sqrt() } else { 1.0 }
    };
    let waves = (0..=lines.len() / 4).max_by(|a, b| harmonic(a).total_cmp(&harmonic(b)));
    (waves.unwrap_or(0), lines[0][most].along / MM)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn waves_are_counted_where_they_are_highest() {
        for (count, mean) in [(0, 1.0), (1, 0.3), (2, 0.3), (5, -0.5)] {
            let line = |j: usize| -> Vec<Bulge> {
                let at = |k: usize| {
                    let (around, along) = (TAU * (j as f64 / 24.0 + 0.1 * k as f64), 5.0 * MM * k as f64);
                    let high = (-((k as f64 - 7.0) / 2.0).powi(2)).exp();
                    let outwards = high * (mean + (count as f64 * around).sin());
                    Bulge { around, along, outwards }
                };
                (0..20).map(at).collect()
            };
            let lines: Vec<_> = (0..24).map(line).collect();
            let (waves, height) = waves(&lines);
            assert_eq!(waves, count);
            assert!((height - 35.0).abs() < 1e-9, "{height}");
        }
        assert_eq!(waves(&[]), (0, 0.0));
    }
}
