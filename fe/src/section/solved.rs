use super::SectionSolver;
use crate::{SectionLaw, SectionResponse};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The finite elements of a section themselves as a law: every answer is solved for, with threads as wide as they are. Far dearer than a table: for
/// single FREEs.
#[derive(Debug)]
pub struct SolvedSection(Mutex<SectionSolver>);

impl From<SectionSolver> for SolvedSection {
    fn from(solver: SectionSolver) -> Self {
        SolvedSection(Mutex::new(solver.to_rounding()))
    }
}

impl SolvedSection {
    fn solver(&self) -> MutexGuard<'_, SectionSolver> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl SectionLaw for SolvedSection {
    /// Not numbers where the section has no answer.
    fn respond(&self, pressure: f64, axial_stretch: f64, twist_per_length: f64) -> SectionResponse {
        let nan = f64::NAN;
        let none = SectionResponse { energy: nan, force: nan, torque: nan, stiffness: [[nan; 2]; 2] };
        self.solver().respond(pressure, axial_stretch, twist_per_length).unwrap_or(none)
    }

    fn pressure_slopes(&self, pressure: f64, axial_stretch: f64, twist_per_length: f64) -> [f64; 2] {
        let answer = self.solver().answer(pressure, axial_stretch, twist_per_length);
        answer.map_or([f64::NAN; 2], |(_, slopes)| slopes)
    }
}
