//! The paper's modules as rods, and what they do in its cases.

use super::{bench::Bench, specimen};
use crate::{exit::Exit, failure::Failure, interrupt};
use actuator::{
    Base, Case, Free, Handedness, Module, ModuleState, PlacedFree, Tip, Winding,
    units::{DEG, GRAM, KPA, MM},
};
use fe::{ModuleSolver, ModuleSweep, RodLaw, RodModule, RodSettings, Run};
use std::sync::{Mutex, PoisonError};

/// Greatest pressure of the paper's cases, 7.25 psi, kPa.
pub const GREATEST_KPA: f64 = 50.0;
/// Distance of neighbouring axes that is assumed where nothing else is said, mm: the paper gives none.
pub const SPACING_MM: f64 = 15.0;
/// Spacers that are assumed where FREEs are tied: the paper says nothing of ties.
pub const TIED: u32 = 9;
/// Length of its modules' FREEs, mm.
pub const LENGTH_MM: f64 = 175.0;

/// A module of the paper: its name, the angle from the hoop and whether hands alternate.
pub struct Kind {
    /// As the paper calls it.
    pub name: &'static str,
    /// Winding angle from the hoop, degrees.
    pub angle_deg: f64,
    /// Right and left in turn around the axis, or all right.
    pub alternate: bool,
}

/// The four of them.
pub const KINDS: [Kind; 4] = [
    Kind { name: "30 LR", angle_deg: 30.0, alternate: true },
    Kind { name: "60 LR", angle_deg: 60.0, alternate: true },
    Kind { name: "40 LR", angle_deg: 40.0, alternate: true },
    Kind { name: "40 R", angle_deg: 40.0, alternate: false },
];

/// The 60 LR by what its angle may be measured from.
pub const READINGS: [Kind; 2] = [
    Kind { name: "60 LR, angle from the hoop", angle_deg: 60.0, alternate: true },
    Kind { name: "60 LR, angle from the axis", angle_deg: 30.0, alternate: true },
];

impl Kind {
    /// The module at a distance of neighbouring axes.
    pub fn module(&self, spacing_mm: f64, spacers: u32) -> Module {
        let half = 0.5 * spacing_mm * MM;
        let frees = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]].into_iter().enumerate();
        let frees = frees.map(|(place, corner): (usize, [f64; 2])| {
            let mut free: Free = specimen::free(self.angle_deg, 0.15 * MM);
            free.tube.length = LENGTH_MM * MM;
            if self.alternate && place % 2 == 1 {
                let Winding { fibres, fibre, .. } = free.winding;
                free.winding = Winding::from_hoop(self.angle_deg * DEG, Handedness::Left, fibres, fibre);
            }
            PlacedFree { free, position: corner.map(|side| side * half) }
        });
        Module {
            frees: frees.collect(),
            tip: Tip { plate_mass: 5.0 * GRAM, payload: 0.0, free_dof: [true; 6] },
            base: Base { gravity: [0.0, 0.0, 1.0], free_mass: 4.3 * GRAM },
            spacers,
        }
    }
}

/// Laws of FREEs by their winding angle: neither spacing nor spacers nor hand change them, and they take longer than all cases.
#[derive(Default)]
pub struct Laws(Mutex<Vec<(f64, RodLaw)>>);

/// How modules are swept here: coarse ones bend as bare tubes.
pub fn sweep(bench: &Bench) -> ModuleSweep {
    let sweep = ModuleSweep::default();
    if bench.coarse {
        ModuleSweep { bending: None, checks: 6, ..sweep }
    } else {
        ModuleSweep { checks: 20, ..sweep }
    }
}

impl Bench {
    /// The law of a FREE of the paper's modules up to the greatest pressure, computed once.
    pub fn rod_law(&self, angle_deg: f64) -> Result<RodLaw, Failure> {
        // Held while it is computed: nobody else shall compute the same.
        let mut known = self.laws.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, law)) = known.iter().find(|(angle, _)| *angle == angle_deg) {
            return Ok(law.clone());
        }
        self.progress.say(&format!("law of a {angle_deg}° FREE"));
        let run = Run { jobs: self.jobs, progress: &|_, _| (), stop: interrupt::flag() };
        let kind = Kind { name: "", angle_deg, alternate: false };
        let mut module = kind.module(SPACING_MM, 0);
        module.frees.truncate(1);
        let (sweep, axes) = (sweep(self), vec![vec![0.0, GREATEST_KPA * KPA]]);
        let laws =
            sweep.rod_laws(&module, &axes, &run).map_err(|error| Failure::new(Exit::NotConverged, error))?;
        let law = laws.and_then(|laws| laws.into_iter().next()).ok_or_else(Failure::interrupted)?;
        known.push((angle_deg, law.clone()));
        Ok(law)
    }

    /// A module's rods.
    pub fn rods(&self, module: &Module, settings: RodSettings) -> Result<RodModule, Failure> {
        let angle = module.frees.first().map_or(0.0, |placed| placed.free.winding.angle_from_hoop() / DEG);
        let law = self.rod_law((1e6 * angle).round() / 1e6)?;
        RodModule::new(module, vec![law; module.frees.len()], settings)
            .map_err(|error| Failure::new(Exit::NotConverged, error))
    }
}

/// Equilibria of a module along a case, from rest.
pub struct CasePath {
    /// The case.
    pub case: Case,
    /// Each at its pressure (Pa) of the inflated FREEs.
    pub states: Vec<(f64, ModuleState)>,
    /// Why the path ends early.
    pub ended: Option<String>,
}

/// Follows a case through rising pressures (Pa), one state from the other, as far as there are equilibria; where not `beyond` it, to the first that is
/// unstable.
pub fn follow<S: ModuleSolver>(
    module: &mut S,
    case: &Case,
    pressures: &[f64],
    beyond: bool,
) -> Result<CasePath, Failure> {
    let mut last = module.rest().map_err(|error| Failure::new(Exit::NotConverged, error))?;
    let idle = vec![0.0; case.inflated.len()];
    let rest = module.state(&last).clone();
    let mut path = CasePath { case: case.clone(), states: vec![(0.0, rest)], ended: None };
    for pressure in pressures {
        if interrupt::is_asked() {
            return Err(Failure::interrupted());
        }
        let goal = case.pressures(&idle, &vec![*pressure; idle.len()], 1.0);
        match module.solve_from(&last, &goal) {
            Ok(found) => {
                path.states.push((*pressure, module.state(&found).clone()));
                if module.state(&found).is_buckled() && !beyond {
                    break;
                }
                last = found;
            }
            Err(error) => {
                path.ended = Some(error.to_string());
                break;
            }
        }
    }
    Ok(path)
}

/// What the tip does at an equilibrium, against rest.
#[derive(Clone, Copy, Debug)]
pub struct TipMotion {
    /// Pressure, kPa.
    pub pressure_kpa: f64,
    /// Sideways, mm.
    pub sideways: [f64; 2],
    /// Along the axis, mm.
    pub rise: f64,
    /// Turn about the axis, degrees, whole turns counted.
    pub twist: f64,
    /// Tilt of the plate, degrees.
    pub bend: f64,
    /// Least distance between FREEs, mm; negative where they overlap.
    pub gap: f64,
    /// Whether the equilibrium is unstable: a real module leaves it.
    pub unstable: bool,
}

impl TipMotion {
    /// How far sideways, mm.
    pub fn distance(&self) -> f64 {
        self.sideways[0].hypot(self.sideways[1])
    }

    /// In words.
    pub fn told(&self) -> String {
        format!(
            "{:+.1} mm along, {:.1} mm sideways, {:+.1}° twist, {:.1}° tilt at {:.0} kPa{}",
            self.rise,
            self.distance(),
            self.twist + 0.0,
            self.bend,
            self.pressure_kpa,
            if self.unstable { " (unstable)" } else { "" }
        )
    }
}

impl CasePath {
    /// The tip along the path.
    pub fn motions(&self) -> Vec<TipMotion> {
        let rest = self.states[0].1.chart.to_pose().position;
        let motion = |(pressure, state): &(f64, ModuleState)| {
            let (chart, position) = (state.chart, state.chart.to_pose().position);
            let off = (position - rest) / MM;
            TipMotion {
                pressure_kpa: pressure / KPA,
                sideways: [off.x, off.y],
                rise: off.z,
                twist: chart.twist / DEG,
                bend: chart.bend[0].hypot(chart.bend[1]) / DEG,
                gap: state.gap.map_or(f64::NAN, |gap| gap / MM),
                unstable: state.is_buckled(),
            }
        };
        self.states.iter().map(motion).collect()
    }

    /// The tip at the last equilibrium.
    pub fn last(&self) -> TipMotion {
        let motions = self.motions();
        motions[motions.len() - 1]
    }

    /// Least distance between FREEs along the way, mm.
    pub fn least_gap(&self) -> f64 {
        self.motions().iter().map(|motion| motion.gap).fold(f64::INFINITY, f64::min)
    }

    /// Lowest pressure (kPa) among the states at which the equilibrium is unstable.
    pub fn unstable_from(&self) -> Option<f64> {
        self.motions().iter().find(|motion| motion.unstable).map(|motion| motion.pressure_kpa)
    }
}

/// Whether two pressures (Pa) are the same step, however it was counted.
pub fn same_pressure(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-6 * KPA
}

/// Greatest distance of a way's points from the line between its ends, as a share of that line's length.
pub fn crookedness(motions: &[TipMotion]) -> f64 {
    let Some(last) = motions.last() else { return 0.0 };
    let ([x, y], length) = (last.sideways, last.distance());
    let off = |motion: &TipMotion| ((motion.sideways[0] * y - motion.sideways[1] * x) / length).abs();
    motions.iter().map(off).fold(0.0, f64::max) / length
}

#[cfg(test)]
mod tests {
    use super::*;
    use actuator::{Description, Rig};

    #[test]
    fn modules_are_those_of_the_descriptions() {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/modules");
        for (kind, file) in KINDS.iter().zip(["30lr", "60lr", "40lr", "40r"]) {
            let rig = Rig::read(&folder.join(format!("buffinton-2020-{file}.toml"))).unwrap();
            let Description::Module(described) = rig.description else { panic!("{file} is a module") };
            assert_eq!(format!("{:?}", kind.module(SPACING_MM, TIED)), format!("{described:?}"), "{file}");
        }
    }

    #[test]
    fn a_straight_way_is_not_crooked_and_a_right_angle_is() {
        let at = |x: f64, y: f64| TipMotion {
            pressure_kpa: 0.0,
            sideways: [x, y],
            rise: 0.0,
            twist: 0.0,
            bend: 0.0,
            gap: 1.0,
            unstable: false,
        };
        assert!(crookedness(&[at(0.0, 0.0), at(1.0, 2.0), at(2.0, 4.0)]) < 1e-12);
        // The corner lies sqrt(1/2) off the diagonal of length sqrt(2).
        assert!((crookedness(&[at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0)]) - 0.5).abs() < 1e-12);
    }
}
