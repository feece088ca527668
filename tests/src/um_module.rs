//! The University of Michigan module: its predictions by rods, and how far they are from the recording.

use crate::plateau::Plateau;
use actuator::{
    Module, PoseChart, Winding, Wrench,
    units::{KPA, MM},
};
use fe::{
    BendingLaw, ConstantBending, Equilibrium, ModuleSweep, ModuleSweepError, RodError, RodLaw, RodModule,
    RodSettings, Run, SectionLaw, SectionTable, TipLoad,
};
use std::{
    error::Error,
    sync::{Arc, Mutex, PoisonError, atomic::AtomicBool},
};

/// What is changed of the description for a prediction.
#[derive(Clone, Debug)]
pub struct Variation {
    /// Factor on the shear modulus.
    pub modulus: f64,
    /// Thickness of the wall taken off its outside, m: the radius of the threads goes with it.
    pub thinner: f64,
    /// Factor on the length of the FREEs.
    pub length: f64,
    /// Added to the winding angle of FREE 3, rad.
    pub angle: f64,
    /// Length of the threads over that of their helix, minus one.
    pub slack: f64,
    /// Factor on EA.
    pub threads: f64,
    /// Factor on the bending law.
    pub bending: f64,
    /// Bending of the bare tubes, 3 mu I and mu A, in the place of that from solids.
    pub bare: bool,
    /// Spacers.
    pub spacers: u32,
    /// Elements a FREE.
    pub elements: usize,
    /// Force (N) and moment (N m) on the plate along and about z.
    pub load: [f64; 2],
}

impl Default for Variation {
    /// As it is described; without spacers, because the drawing has none.
    fn default() -> Self {
        Variation {
            modulus: 1.0,
            thinner: 0.0,
            length: 1.0,
            angle: 0.0,
            slack: 0.0,
            threads: 1.0,
            bending: 1.0,
            bare: false,
            spacers: 0,
            elements: 8,
            load: [0.0; 2],
        }
    }
}

/// Shift along z (m) and rotation about z (rad) of the plate since rest.
pub type Motion = [f64; 2];

/// Greatest pressures that laws are made for, kPa: the monitors read a little more than the commands.
const TOP_KPA: [f64; 3] = [75.0, 75.0, 147.0];

/// Section and bending laws of a module of one modulus, wall, thread and angle.
struct Laws {
    /// Factor on the modulus, wall taken off, factor on EA, angle added, bare bending.
    of: ([f64; 4], bool),
    sections: Vec<Arc<SectionTable>>,
    bending: Vec<Arc<dyn BendingLaw>>,
}

/// The module, and the laws of its FREEs as they have been wanted so far.
pub struct Predictor {
    module: Module,
    laws: Mutex<Vec<Arc<Laws>>>,
}

/// Why there is no prediction.
#[derive(Debug)]
pub enum PredictionError {
    /// The laws of the FREEs cannot be made.
    Laws(Box<ModuleSweepError>),
    /// The rods cannot be set up or have no state of rest.
    Rods(RodError),
    /// A prediction panicked.
    Panicked,
}

impl std::fmt::Display for PredictionError {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            PredictionError::Laws(error) => error.fmt(out),
            PredictionError::Rods(error) => error.fmt(out),
            PredictionError::Panicked => "a prediction panicked".fmt(out),
        }
    }
}

impl Error for PredictionError {}

impl From<RodError> for PredictionError {
    fn from(error: RodError) -> Self {
        PredictionError::Rods(error)
    }
}

impl From<ModuleSweepError> for PredictionError {
    fn from(error: ModuleSweepError) -> Self {
        PredictionError::Laws(Box::new(error))
    }
}

impl Predictor {
    /// Of a module as it is described.
    pub fn new(module: &Module) -> Self {
        Predictor { module: module.clone(), laws: Mutex::default() }
    }

    fn changed(&self, variation: &Variation) -> Module {
        let mut module = self.module.clone();
        module.spacers = variation.spacers;
        for (index, placed) in module.frees.iter_mut().enumerate() {
            let free = &mut placed.free;
            free.elastomer =
                free.elastomer.with_shear_modulus(variation.modulus * free.elastomer.shear_modulus());
            free.tube.wall -= variation.thinner;
            free.tube.length *= variation.length;
            free.winding.fibre.axial_stiffness *= variation.threads;
            if index == 2 {
                let Winding { handedness, fibres, fibre, .. } = free.winding;
                let angle = free.winding.angle_from_hoop() + variation.angle;
                free.winding = Winding::from_hoop(angle, handedness, fibres, fibre);
            }
        }
        module
    }

    /// Laws of the FREEs as changed: made anew for every modulus, wall, thread and angle, as `freeact map` makes them.
    fn laws(&self, module: &Module, variation: &Variation) -> Result<Vec<RodLaw>, ModuleSweepError> {
        let Variation { modulus, thinner, threads, angle, bare, .. } = *variation;
        let of = ([modulus, thinner, threads, angle], bare);
        let known = || self.laws.lock().unwrap_or_else(PoisonError::into_inner);
        let found = known().iter().find(|laws| laws.of == of).cloned();
        let laws = match found {
            Some(laws) => laws,
            None => {
                // Without the law of caps: their bending and their sections go together.
                let sweep = ModuleSweep { caps: None, ..ModuleSweep::default() };
                let stop = AtomicBool::new(false);
                let run = Run { jobs: 2, progress: &|_, _| (), stop: &stop };
                let axes: Vec<Vec<f64>> = TOP_KPA.iter().map(|top| vec![0.0, top * KPA]).collect();
                let sections = sweep.section_laws(module, &axes, &run)?.unwrap_or_default();
                let law = |free| Arc::new(ConstantBending::of_bare_tube(free)) as Arc<dyn BendingLaw>;
                let bending = match bare {
                    true => module.frees.iter().map(|placed| law(&placed.free)).collect(),
                    false => sweep.bending_laws(module, &axes, &run)?.unwrap_or_default(),
                };
                let made = Arc::new(Laws { of, sections, bending });
                known().push(made.clone());
                made
            }
        };
        let pairs = laws.sections.iter().zip(&laws.bending);
        let law = |(section, bending): (&Arc<SectionTable>, &Arc<dyn BendingLaw>)| RodLaw {
            section: Arc::new(section.as_ref().clone().with_slack(variation.slack)) as Arc<dyn SectionLaw>,
            bending: bending.clone(),
        };
        Ok(pairs.map(law).collect())
    }

    /// Rods of the module as changed. The sections are tabulated from finite elements, with smeared threads; bending is from solids, or that of
    /// the bare tubes. Loose threads are not loose in the solids.
    ///
    /// # Errors
    /// [`PredictionError`] where the laws cannot be made or the rods not be set up.
    pub fn rods(&self, variation: &Variation) -> Result<RodModule, PredictionError> {
        let module = self.changed(variation);
        let laws = self.laws(&module, variation)?;
        let [force, moment] = variation.load;
        let settings = RodSettings {
            elements: variation.elements,
            bending_stiffness_scale: variation.bending,
            tip_load: TipLoad { force: [0.0, 0.0, force], moment: [0.0, 0.0, moment] },
        };
        Ok(RodModule::new(&module, laws, settings)?)
    }

    /// Motions at pressures (kPa) in the order of the recording, in which FREE 3 rises in rows: each is followed from the one before, or from
    /// the same one of the row before, or from rest; `None` where all these paths end.
    ///
    /// # Errors
    /// [`PredictionError`] where the rods cannot be set up or have no state of rest.
    pub fn predict(
        &self,
        variation: &Variation,
        pressures_kpa: &[[f64; 3]],
    ) -> Result<Vec<Option<Motion>>, PredictionError> {
        let rods = self.rods(variation)?;
        let rest = rods.rest()?;
        let height = rest.state.chart.position[2];
        let mut row: Vec<Option<Equilibrium>> = vec![];
        let mut above: Vec<Option<Equilibrium>> = vec![];
        let mut before = [f64::INFINITY; 3];
        let mut motions = Vec::with_capacity(pressures_kpa.len());
        for kpa in pressures_kpa {
            let pressures = kpa.map(|kpa| kpa * KPA);
            if kpa[2] < before[2] {
                above = std::mem::take(&mut row);
            }
            before = *kpa;
            let near = [row.last(), above.get(row.len())].into_iter().flatten().filter_map(Option::as_ref);
            let found = near.chain([&rest]).find_map(|start| rods.solve_from(start, &pressures).ok());
            motions.push(found.as_ref().map(|found| {
                let chart = found.state.chart;
                [chart.position[2] - height, chart.twist]
            }));
            row.push(found);
        }
        Ok(motions)
    }

    /// What the guide would have to give to the plate, N along and N m about z, for the module as changed to stand where it was measured; by the
    /// module held there.
    ///
    /// # Errors
    /// [`PredictionError`] where the rods cannot be set up.
    pub fn wanted_of_guide(
        &self,
        variation: &Variation,
        plateaus: &[Plateau],
    ) -> Result<Vec<Option<[f64; 2]>>, PredictionError> {
        let rods = self.rods(variation)?;
        let height = rods.rest()?.state.chart.position[2];
        let wanted = plateaus.iter().map(|plateau| {
            let position = [0.0, 0.0, height + plateau.z_mm * MM];
            let pose = PoseChart { twist: plateau.rz_rad, bend: [0.0; 2], position };
            let found =
                rods.held(&pose).and_then(|held| held.solve(&plateau.command_kpa.map(|kpa| kpa * KPA)));
            let given: Wrench = found.ok()?.wrenches.into_iter().sum();
            Some([-given.force[2], -given.moment[2]])
        });
        Ok(wanted.collect())
    }
}

/// Errors of predictions: shift (mm) and rotation (rad).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Combinations that are predicted.
    pub count: usize,
    /// Combinations without equilibrium.
    pub missing: usize,
    /// Root mean square.
    pub rms: [f64; 2],
    /// Median of the absolute values.
    pub median: [f64; 2],
    /// Greatest absolute value.
    pub worst: [f64; 2],
    /// Mean, predicted minus measured.
    pub mean: [f64; 2],
}

impl Errors {
    /// Of pairs of a prediction and what was measured.
    pub fn of<'a>(pairs: impl Iterator<Item = (&'a Option<Motion>, &'a Plateau)>) -> Self {
        let mut errors = Errors::default();
        let mut off: [Vec<f64>; 2] = Default::default();
        for (motion, plateau) in pairs {
            let Some([z, turn]) = motion else {
                errors.missing += 1;
                continue;
            };
            off[0].push(z / MM - plateau.z_mm);
            off[1].push(turn - plateau.rz_rad);
        }
        errors.count = off[0].len();
        for (k, off) in off.iter_mut().enumerate().filter(|(_, off)| !off.is_empty()) {
            let count = off.len() as f64;
            errors.rms[k] = (off.iter().map(|off| off * off).sum::<f64>() / count).sqrt();
            errors.mean[k] = off.iter().sum::<f64>() / count;
            off.iter_mut().for_each(|off| *off = off.abs());
            off.sort_by(f64::total_cmp);
            errors.median[k] = off[off.len() / 2];
            errors.worst[k] = off[off.len() - 1];
        }
        errors
    }
}

/// Ranges of the measured shift (mm) and rotation (rad).
pub fn ranges(plateaus: &[Plateau]) -> [f64; 2] {
    let range = |value: fn(&Plateau) -> f64| {
        let values = || plateaus.iter().map(value);
        values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
    };
    [range(|plateau| plateau.z_mm), range(|plateau| plateau.rz_rad)]
}

/// Predictions at several factors on the modulus, for a fit.
pub struct ModulusScan {
    /// Rising factors.
    pub moduli: Vec<f64>,
    /// Motions at each of them.
    pub motions: Vec<Vec<Option<Motion>>>,
}

impl ModulusScan {
    /// Predicts at each factor.
    ///
    /// # Errors
    /// As of [`Predictor::predict`].
    pub fn new(
        predictor: &Predictor,
        base: &Variation,
        moduli: &[f64],
        pressures_kpa: &[[f64; 3]],
    ) -> Result<Self, PredictionError> {
        let at = |modulus: &f64| {
            predictor.predict(&Variation { modulus: *modulus, ..base.clone() }, pressures_kpa)
        };
        let motions = std::thread::scope(|scope| {
            let each: Vec<_> = moduli.iter().map(|modulus| scope.spawn(move || at(modulus))).collect();
            let found =
                each.into_iter().map(|thread| thread.join().map_err(|_| PredictionError::Panicked)?);
            found.collect::<Result<_, _>>()
        })?;
        Ok(ModulusScan { moduli: moduli.to_vec(), motions })
    }

    /// Motions at a factor between the first and the last: linear in its logarithm between neighbours.
    pub fn at(&self, modulus: f64) -> Vec<Option<Motion>> {
        let cell = self.moduli.partition_point(|own| *own <= modulus).clamp(1, self.moduli.len() - 1) - 1;
        let [low, high] = [self.moduli[cell], self.moduli[cell + 1]];
        let share = (modulus / low).ln() / (high / low).ln();
        let between = |(a, b): (&Option<Motion>, &Option<Motion>)| {
            let (a, b) = ((*a)?, (*b)?);
            Some([0, 1].map(|k| a[k] + share * (b[k] - a[k])))
        };
        self.motions[cell].iter().zip(&self.motions[cell + 1]).map(between).collect()
    }

    /// Whether a plateau has a prediction at every factor.
    pub fn is_told(&self, index: usize) -> bool {
        self.motions.iter().all(|motions| motions[index].is_some())
    }

    /// The factor of least misfit on those of the plateaus chosen that have a prediction at every factor, each motion measured against its range;
    /// and that misfit.
    pub fn fit(&self, plateaus: &[Plateau], chosen: &dyn Fn(usize) -> bool) -> (f64, f64) {
        let range = ranges(plateaus);
        let misfit = |modulus: f64| {
            let motions = self.at(modulus);
            let pairs = motions
                .iter()
                .zip(plateaus)
                .enumerate()
                .filter(|(index, _)| chosen(*index) && self.is_told(*index));
            let errors = Errors::of(pairs.map(|(_, pair)| pair));
            (errors.rms[0] / range[0]).hypot(errors.rms[1] / range[1])
        };
        let (first, last) = (self.moduli[0].ln(), self.moduli[self.moduli.len() - 1].ln());
        const STEPS: usize = 200;
        let factors = (0..=STEPS).map(|i| (first + (last - first) * i as f64 / STEPS as f64).exp());
        factors
            .map(|factor| (factor, misfit(factor)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap_or((1.0, f64::NAN))
    }
}
