//! The University of Michigan module: its predictions by rods, and how far they are from the recording.

use crate::plateau::Plateau;
use actuator::{
    Module, PoseChart, Winding, Wrench,
    units::{KPA, MM},
};
use fe::{ConstantBending, Equilibrium, RodError, RodLaw, RodModule, RodSettings, ThickTube, TipLoad};
use std::sync::Arc;

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
    /// Factor on the bending stiffness.
    pub bending: f64,
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
            spacers: 0,
            elements: 8,
            load: [0.0; 2],
        }
    }
}

/// Shift along z (m) and rotation about z (rad) of the plate since rest.
pub type Motion = [f64; 2];

/// Rods of the module as changed. The sections are tubes with smeared threads, in closed form; bending is that of the bare tubes.
///
/// # Errors
/// As of [`RodModule::new`].
pub fn rods(module: &Module, variation: &Variation) -> Result<RodModule, RodError> {
    let mut module = module.clone();
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
    let law = |free| RodLaw {
        section: Arc::new(ThickTube::new(free).with_slack(variation.slack)),
        bending: Arc::new(ConstantBending::of_bare_tube(free)),
    };
    let laws = module.frees.iter().map(|placed| law(&placed.free)).collect();
    let [force, moment] = variation.load;
    let settings = RodSettings {
        elements: variation.elements,
        bending_stiffness_scale: variation.bending,
        tip_load: TipLoad { force: [0.0, 0.0, force], moment: [0.0, 0.0, moment] },
    };
    RodModule::new(&module, laws, settings)
}

/// Motions at pressures (kPa) in the order of the recording, in which FREE 3 rises in rows: each is followed from the one before, the
/// first of a row from the first of the row before. `None` where no equilibrium is found, and for the rest of that row.
///
/// # Errors
/// [`RodError`] where the rods cannot be set up or have no state of rest.
pub fn predict(
    module: &Module,
    variation: &Variation,
    pressures_kpa: &[[f64; 3]],
) -> Result<Vec<Option<Motion>>, RodError> {
    let rods = rods(module, variation)?;
    let rest = rods.rest()?;
    let height = rest.state.chart.position[2];
    let (mut row, mut last): (Equilibrium, Option<Equilibrium>) = (rest.clone(), None);
    let mut motions = Vec::with_capacity(pressures_kpa.len());
    let mut before = [f64::INFINITY; 3];
    for kpa in pressures_kpa {
        let pressures = kpa.map(|kpa| kpa * KPA);
        if kpa[2] < before[2] {
            let found = rods.solve_from(&row, &pressures).or_else(|_| rods.solve_from(&rest, &pressures));
            last = found.ok();
            if let Some(found) = &last {
                row = found.clone();
            }
        } else {
            last = last.and_then(|last| rods.solve_from(&last, &pressures).ok());
        }
        before = *kpa;
        motions.push(last.as_ref().map(|found| {
            let chart = found.state.chart;
            [chart.position[2] - height, chart.twist]
        }));
    }
    Ok(motions)
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
    /// As of [`predict`].
    pub fn new(
        module: &Module,
        base: &Variation,
        moduli: &[f64],
        pressures_kpa: &[[f64; 3]],
    ) -> Result<Self, RodError> {
        let at =
            |modulus: &f64| predict(module, &Variation { modulus: *modulus, ..base.clone() }, pressures_kpa);
        let motions = moduli.iter().map(at).collect::<Result<_, _>>()?;
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

    /// The factor of least misfit on the plateaus chosen, each motion measured against its range; and that misfit. Only where every plateau chosen
    /// has a prediction.
    pub fn fit(&self, plateaus: &[Plateau], chosen: &dyn Fn(usize) -> bool) -> (f64, f64) {
        let range = ranges(plateaus);
        let misfit = |modulus: f64| {
            let motions = self.at(modulus);
            let pairs = motions.iter().zip(plateaus).enumerate().filter(|(index, _)| chosen(*index));
            let errors = Errors::of(pairs.map(|(_, pair)| pair));
            match errors.missing {
                0 => (errors.rms[0] / range[0]).hypot(errors.rms[1] / range[1]),
                _ => f64::INFINITY,
            }
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

/// What the guide would have to give to the plate, N along and N m about z, for the module as changed to stand where it was measured; by the
/// module held there.
///
/// # Errors
/// [`RodError`] where the rods cannot be set up.
pub fn wanted_of_guide(
    module: &Module,
    variation: &Variation,
    plateaus: &[Plateau],
) -> Result<Vec<Option<[f64; 2]>>, RodError> {
    let rods = rods(module, variation)?;
    let height = rods.rest()?.state.chart.position[2];
    let wanted = plateaus.iter().map(|plateau| {
        let position = [0.0, 0.0, height + plateau.z_mm * MM];
        let pose = PoseChart { twist: plateau.rz_rad, bend: [0.0; 2], position };
        let found = rods.held(&pose).and_then(|held| held.solve(&plateau.command_kpa.map(|kpa| kpa * KPA)));
        let given: Wrench = found.ok()?.wrenches.into_iter().sum();
        Some([-given.force[2], -given.moment[2]])
    });
    Ok(wanted.collect())
}
