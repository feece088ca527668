use super::{
    chain::{Assembly, Chain, Condensed, Member},
    element::ElementLaw,
    equilibrium::{Configuration, Equilibrium, RodError},
    motion::Frame,
    pivots::InvertedBlock,
    plate::{Plate, PlateVariation},
};
use crate::{BendingLaw, SectionLaw};
use actuator::{Module, ModuleState, units::STANDARD_GRAVITY};
use nalgebra::{Matrix6, UnitQuaternion, Vector3, Vector6};
use std::sync::Arc;

/// How finely and how stiff a module is modelled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RodSettings {
    /// Elements along each FREE of a module without spacers. A FREE may turn several times, but each element by less than 2.5 rad; one that
    /// turns by an angle within an element bends too little by a twelfth of its square: 1 % at 0.35 rad.
    pub elements: usize,
    /// Factor on the bending law of every FREE (bending, shear and their coupling), for calibration.
    pub bending_stiffness_scale: f64,
    /// Loads on the tip plate besides weights.
    pub tip_load: TipLoad,
}

impl Default for RodSettings {
    fn default() -> Self {
        RodSettings { elements: 20, bending_stiffness_scale: 1.0, tip_load: TipLoad::default() }
    }
}

impl RodSettings {
    /// In words, for a map.
    pub fn describe(&self) -> String {
        let factor = self.bending_stiffness_scale;
        let scaled =
            if factor == 1.0 { String::new() } else { format!(", bending and shear stiffness x {factor}") };
        format!(
            "geometrically exact rods, {} elements a FREE; with spacers, one element between two of them{scaled}",
            self.elements
        )
    }
}

/// A constant load on the tip plate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TipLoad {
    /// Force on the plate's centre in the base frame, N.
    pub force: [f64; 3],
    /// Moments that do work on bend x, bend y and twist of the pose chart, N m: in a plane motion the moment about that axis.
    /// (A moment of constant direction in space would have no energy.)
    pub moment: [f64; 3],
}

/// What a FREE is as a rod: a law may be shared; left-handed FREEs mirror it.
#[derive(Clone)]
pub struct RodLaw {
    /// Stretch and twist under pressure.
    pub section: Arc<dyn SectionLaw>,
    /// Bending and shear.
    pub bending: Arc<dyn BendingLaw>,
}

/// A module of FREEs as geometrically exact rods with their laws, clamped to two rigid plates.
///
/// With spacers, all FREEs share the spacers' motion, one element of each between two spacers ([`Module::spacers`]).
///
/// Energy: of the elements, minus the work of the weights (plate, payload and FREEs along the module's gravity) and of the tip
/// load. Degrees of freedom of the plate that are not in `tip.free_dof` stay at rest: position in the base frame, `rx` and `ry`
/// the bend and `rz` the twist of the pose chart.
pub struct RodModule {
    module: Module,
    laws: Vec<RodLaw>,
    settings: RodSettings,
    /// Shear stiffness of the stiffest FREE, N, and its outer radius, m: what residuals are relative to.
    reference: (f64, f64),
}

/// Relative residual of a converged state; rounding leaves about 1e-12.
const TOLERANCE: f64 = 1e-10;
/// Newton's steps allowed before the pressure step is halved.
const NEWTON_STEPS: usize = 20;
/// Longest pressure step, Pa: short enough to stay on the branch that comes from rest.
const PRESSURE_STEP: f64 = 15e3;
/// Shortest step as a part of the way before it is given up.
const SHORTEST_STEP: f64 = 1e-4;
/// Greatest change of an element's rotation (rad) and stretch in one Newton step.
const STEP_LIMITS: (f64, f64) = (0.4, 0.3);

/// Pressures and the part of weights and tip load that acts.
#[derive(Clone)]
struct Loads {
    pressures: Vec<f64>,
    part: f64,
}

/// Energy, gradient and tangent of a module in a configuration.
struct System {
    energy: f64,
    chains: Vec<Assembly>,
    /// Plate's coordinates: gradient of energy of the plate's own loads.
    load_gradient: Vector6<f64>,
    /// Greatest relative residual.
    residual: f64,
}

/// A factorised system.
struct Factored {
    condensed: Vec<Condensed>,
    plate: PlateVariation,
    inverse: Matrix6<f64>,
    /// Condensed gradient in the plate's coordinates.
    gradient: Vector6<f64>,
    negative: u32,
}

impl RodModule {
    /// A module with the laws of each FREE.
    ///
    /// # Errors
    /// [`RodError`] where a number of laws or a setting makes no sense.
    pub fn new(module: &Module, laws: Vec<RodLaw>, settings: RodSettings) -> Result<Self, RodError> {
        if laws.len() != module.frees.len() || laws.is_empty() {
            return Err(RodError::Count { what: "laws", given: laws.len(), needed: module.frees.len() });
        }
        if settings.elements == 0 {
            return Err(RodError::Setup { what: "elements", value: 0.0, remedy: "use at least one" });
        }
        let scale = settings.bending_stiffness_scale;
        if !(scale > 0.0 && scale.is_finite()) {
            let what = "factor on the bending stiffness";
            return Err(RodError::Setup { what, value: scale, remedy: "it must be positive" });
        }
        let reference = module.frees.iter().fold((0.0, 0.0), |(force, radius), placed| {
            let tube = placed.free.tube;
            let shear = placed.free.elastomer.initial_shear_modulus() * tube.wall_area();
            if shear > force { (shear, tube.outer_radius()) } else { (force, radius) }
        });
        Ok(RodModule { module: module.clone(), laws, settings, reference })
    }

    /// The laws of each FREE.
    pub fn laws(&self) -> Vec<RodLaw> {
        self.laws.clone()
    }

    fn chains(&self, part: f64) -> Vec<Chain<'_>> {
        let base = &self.module.base;
        let weight = Vector3::from(base.gravity) * (part * STANDARD_GRAVITY * base.free_mass);
        let elements = self.elements() as f64;
        let member = |free: usize, arm: Vector3<f64>| {
            let placed = &self.module.frees[free];
            let law = ElementLaw {
                section: self.laws[free].section.as_ref(),
                hand: placed.free.winding.handedness.sign(),
                bending: self.laws[free].bending.as_ref(),
                bending_scale: self.settings.bending_stiffness_scale,
                held_at: (self.module.spacers > 0).then_some(placed.position),
                length: placed.free.tube.length / elements,
                ends: 0.0,
            };
            Member { free, law, weight, arm, end_zone: 2.0 * placed.free.tube.outer_radius() }
        };
        let axis = |free: usize| {
            let [x, y] = self.module.frees[free].position;
            Vector3::new(x, y, 0.0)
        };
        let frees = 0..self.laws.len();
        if self.module.spacers > 0 {
            let members = frees.map(|free| member(free, axis(free))).collect();
            vec![Chain { members, offset: Vector3::zeros() }]
        } else {
            let alone = |free| Chain { members: vec![member(free, Vector3::zeros())], offset: axis(free) };
            frees.map(alone).collect()
        }
    }

    /// Elements along each FREE: one between two spacers, or as set.
    fn elements(&self) -> usize {
        match self.module.spacers {
            0 => self.settings.elements,
            spacers => spacers as usize + 1,
        }
    }

    /// The undeformed shape: straight FREEs under a plate at their mean length.
    pub fn straight(&self) -> Configuration {
        let (height, count) = (self.module.length(), self.elements());
        let inner = |chain: &Chain| {
            let node = |k: usize| chain.offset + Vector3::z() * (height * k as f64 / count as f64);
            (1..count).map(|k| Frame { rotation: UnitQuaternion::identity(), position: node(k) }).collect()
        };
        Configuration { plate: Plate::at_height(height), inner: self.chains(0.0).iter().map(inner).collect() }
    }

    /// Equilibrium at the pressures (Pa), followed from rest: first the weights and the tip load are put on without
    /// pressure, then all pressures are raised together.
    pub fn solve(&self, pressures: &[f64]) -> Result<Equilibrium, RodError> {
        let rest = self.rest()?;
        self.solve_from(&rest, pressures)
    }

    /// Equilibrium without pressure under the weights and the tip load.
    pub fn rest(&self) -> Result<Equilibrium, RodError> {
        let zero = vec![0.0; self.laws.len()];
        let from = Loads { pressures: zero.clone(), part: 0.0 };
        self.follow(&self.straight(), &from, &Loads { pressures: zero, part: 1.0 })
    }

    /// Equilibrium at the pressures (Pa), followed from another one in a straight line of pressures.
    pub fn solve_from(&self, start: &Equilibrium, pressures: &[f64]) -> Result<Equilibrium, RodError> {
        let finite = pressures.iter().filter(|pressure| pressure.is_finite()).count();
        if finite != self.laws.len() || pressures.len() != finite {
            return Err(RodError::Count { what: "finite pressures", given: finite, needed: self.laws.len() });
        }
        let from = Loads { pressures: start.pressures.clone(), part: 1.0 };
        self.follow(&start.configuration, &from, &Loads { pressures: pressures.to_vec(), part: 1.0 })
    }

    fn follow(&self, start: &Configuration, from: &Loads, to: &Loads) -> Result<Equilibrium, RodError> {
        let between = |t: f64| Loads {
            pressures: from
                .pressures
                .iter()
                .zip(&to.pressures)
                .map(|(a, b)| if t < 1.0 { a + t * (b - a) } else { *b })
                .collect(),
            part: from.part + t * (to.part - from.part),
        };
        let longest =
            from.pressures.iter().zip(&to.pressures).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let mut step = (PRESSURE_STEP / longest).min(1.0);
        // Equal steps, so that the last is not a splinter.
        step = 1.0 / (1.0 / step).ceil();
        let (mut done, mut shape) = (0.0, start.clone());
        loop {
            let goal = if done + step > 1.0 - 1e-9 { 1.0 } else { done + step };
            match self.newton(&shape, &between(goal)) {
                Ok(found) => {
                    shape = found;
                    done = goal;
                    if done == 1.0 {
                        return self.finish(shape, to);
                    }
                }
                Err(residual) if step < SHORTEST_STEP => {
                    return Err(RodError::NoEquilibrium {
                        goal: to.pressures.clone(),
                        reached: between(done).pressures,
                        residual,
                        last: Box::new(shape),
                    });
                }
                Err(_) => step *= 0.5,
            }
        }
    }

    /// Newton's method with a step limit and backtracking; the least residual met where it does not converge.
    fn newton(&self, start: &Configuration, loads: &Loads) -> Result<Configuration, f64> {
        let chains = self.chains(loads.part);
        let assemble = |shape: &Configuration| self.assemble(&chains, shape, loads, false);
        let mut shape = start.clone();
        let mut system = assemble(&shape).ok_or(f64::INFINITY)?;
        let mut least = system.residual;
        for _ in 0..NEWTON_STEPS {
            let factored = self.factorise(&chains, &shape, &system).ok_or(least)?;
            let (plate, inner) = factored.newton_step();
            let mut length = step_length(&plate, &inner, &factored, &chains);
            // The residual may grow a little on the way along a bent path, but not run off.
            let (next, found) = loop {
                let trial = moved(&shape, &plate, &inner, length);
                match assemble(&trial) {
                    Some(found) if found.residual < 3.0 * system.residual || found.residual < 1e-6 => {
                        break (trial, found);
                    }
                    _ if length < 1e-3 => return Err(least),
                    _ => length *= 0.5,
                }
            };
            shape = next;
            // Once below the tolerance one more step was as good as free: accept what it gives.
            let before = system.residual;
            system = found;
            least = least.min(system.residual);
            if system.residual < TOLERANCE && (before < 1e-5 || system.residual < 1e-13) {
                return Ok(shape);
            }
        }
        Err(least)
    }

    /// `None` where a section law has no answer.
    fn assemble(
        &self,
        chains: &[Chain],
        shape: &Configuration,
        loads: &Loads,
        sensitivities: bool,
    ) -> Option<System> {
        let frame = shape.plate.frame();
        let mut assemblies = Vec::with_capacity(chains.len());
        for (chain, inner) in chains.iter().zip(&shape.inner) {
            assemblies.push(chain.assemble(inner, &frame, &loads.pressures, sensitivities)?);
        }
        let load_gradient = -self.plate_load() * loads.part;
        let energy = assemblies.iter().map(|chain| chain.energy).sum::<f64>()
            + load_gradient.dot(&(shape.plate.0 - self.straight_plate()));
        let mut system = System { energy, chains: assemblies, load_gradient, residual: 0.0 };
        let (force, arm) = self.reference;
        let size = |g: Vector6<f64>| {
            let relative = |i: usize| if i < 3 { g[i] / force } else { g[i] / (force * arm) };
            (0..6).map(|i| relative(i).abs()).fold(0.0, f64::max)
        };
        let inner = system.chains.iter().flat_map(|chain| &chain.columns[..chain.columns.len() - 1]);
        let inner = inner.map(|columns| size(columns.column(0).into())).fold(0.0, f64::max);
        system.residual = size(self.free_part(self.gradient(chains, shape, &system))).max(inner);
        system.residual.is_finite().then_some(system)
    }

    fn straight_plate(&self) -> Vector6<f64> {
        Plate::at_height(self.module.length()).0
    }

    /// Generalised forces on the plate's coordinates of weight and tip load.
    fn plate_load(&self) -> Vector6<f64> {
        let (tip, base, load) = (&self.module.tip, &self.module.base, &self.settings.tip_load);
        let weight = Vector3::from(base.gravity) * (STANDARD_GRAVITY * (tip.plate_mass + tip.payload));
        let ([fx, fy, fz], [mx, my, mz]) = (load.force, load.moment);
        Vector6::new(weight.x + fx, weight.y + fy, weight.z + fz, mx, my, mz)
    }

    /// Gradient of the energy in the plate's coordinates.
    fn gradient(&self, chains: &[Chain], shape: &Configuration, system: &System) -> Vector6<f64> {
        let pulls = chains.iter().zip(&system.chains).map(|(chain, assembly)| {
            let at_tip = assembly.columns[assembly.columns.len() - 1].column(0);
            chain.to_tip().transpose() * at_tip
        });
        shape.plate.vary().first.transpose() * pulls.sum::<Vector6<f64>>() + system.load_gradient
    }

    fn free_part(&self, mut vector: Vector6<f64>) -> Vector6<f64> {
        for (value, free) in vector.iter_mut().zip(self.module.tip.free_dof) {
            if !free {
                *value = 0.0;
            }
        }
        vector
    }

    fn factorise(&self, chains: &[Chain], shape: &Configuration, system: &System) -> Option<Factored> {
        let plate = shape.plate.vary();
        let mut condensed = Vec::with_capacity(chains.len());
        for (chain, assembly) in chains.iter().zip(&system.chains) {
            condensed.push(chain.condense(assembly)?);
        }
        let stiffness: Matrix6<f64> = condensed.iter().map(|chain| chain.stiffness).sum();
        let plain: Vector6<f64> = condensed.iter().map(|chain| chain.plain_gradient).sum();
        let pulled: Vector6<f64> = condensed.iter().map(|chain| chain.columns.column(0).into_owned()).sum();
        let mut hessian = plate.hessian(&plain, &stiffness);
        for (i, free) in self.module.tip.free_dof.into_iter().enumerate() {
            if !free {
                hessian.row_mut(i).fill(0.0);
                hessian.column_mut(i).fill(0.0);
                hessian[(i, i)] = 1.0;
            }
        }
        let InvertedBlock { inverse, negative } = InvertedBlock::new(&hessian)?;
        let negative = negative + condensed.iter().map(|chain| chain.negative).sum::<u32>();
        let gradient = self.free_part(plate.first.transpose() * pulled + system.load_gradient);
        Some(Factored { condensed, plate, inverse, gradient, negative })
    }

    /// Checks a converged shape and takes its derivatives.
    fn finish(&self, shape: Configuration, loads: &Loads) -> Result<Equilibrium, RodError> {
        let chains = self.chains(loads.part);
        let frame = shape.plate.frame();
        for (chain, inner) in chains.iter().zip(&shape.inner) {
            let frames: Vec<Frame> = chain.frames(inner, &frame).collect();
            for (member, pair) in
                chain.members.iter().flat_map(|m| frames.windows(2).map(move |pair| (m, pair)))
            {
                let between = member.frame(&pair[0]).log_to(&member.frame(&pair[1]));
                let [axial_stretch, twist_per_length] = member.law.strain(&between);
                let (free, pressure) = (member.free, loads.pressures[member.free]);
                if !self.laws[free].section.covers(pressure, axial_stretch, twist_per_length) {
                    let last = Box::new(shape);
                    return Err(RodError::OutsideSectionLaw {
                        free,
                        pressure,
                        axial_stretch,
                        twist_per_length,
                        last,
                    });
                }
            }
        }
        let singular = || RodError::NoEquilibrium {
            goal: loads.pressures.clone(),
            reached: loads.pressures.clone(),
            residual: f64::INFINITY,
            last: Box::new(shape.clone()),
        };
        let system = self.assemble(&chains, &shape, loads, true).ok_or_else(singular)?;
        let factored = self.factorise(&chains, &shape, &system).ok_or_else(singular)?;
        let slope = |load: Vector6<f64>| shape.plate.chart_slope(&-(factored.inverse * self.free_part(load)));
        let column = |index: usize, chain: &Condensed| -> Vector6<f64> {
            factored.plate.first.transpose() * chain.columns.column(index)
        };
        let gravity = Vector3::from(self.module.base.gravity) * -STANDARD_GRAVITY;
        let slopes = [
            slope(Vector6::new(gravity.x, gravity.y, gravity.z, 0.0, 0.0, 0.0)),
            slope(factored.condensed.iter().map(|chain| column(Chain::BENDING_COLUMN, chain)).sum()),
        ];
        let mut pressure_jacobian = vec![[0.0; 6]; self.laws.len()];
        for (chain, condensed) in chains.iter().zip(&factored.condensed) {
            for (place, member) in chain.members.iter().enumerate() {
                pressure_jacobian[member.free] = slope(column(Chain::pressure_column(place), condensed));
            }
        }
        let state = ModuleState {
            chart: shape.chart(),
            slopes: slopes.to_vec(),
            negative_pivots: factored.negative,
            residual: system.residual,
        };
        Ok(Equilibrium {
            pressures: loads.pressures.clone(),
            configuration: shape,
            state,
            energy: system.energy,
            pressure_jacobian,
        })
    }
}

impl Factored {
    /// Newton's motion of the plate's coordinates and of each FREE's inner nodes.
    fn newton_step(&self) -> (Vector6<f64>, Vec<Vec<Vector6<f64>>>) {
        let plate = -(self.inverse * self.gradient);
        let motion = self.plate.first * plate;
        (plate, self.condensed.iter().map(|chain| chain.inner_motion(&motion)).collect())
    }
}

/// Part of Newton's step that keeps every element's change within limits.
fn step_length(
    plate: &Vector6<f64>,
    inner: &[Vec<Vector6<f64>>],
    factored: &Factored,
    chains: &[Chain],
) -> f64 {
    let mut worst: f64 = 1.0;
    for (chain, motions) in chains.iter().zip(inner) {
        let tip = chain.to_tip() * (factored.plate.first * plate);
        let mut below = Vector6::zeros();
        let length = chain.members[0].law.length;
        for motion in motions.iter().chain(std::iter::once(&tip)) {
            let turned: Vector3<f64> = motion.fixed_rows::<3>(3) - below.fixed_rows::<3>(3);
            let carried = below.fixed_rows::<3>(3).cross(&Vector3::z()) * length;
            let shifted: Vector3<f64> = motion.fixed_rows::<3>(0) - below.fixed_rows::<3>(0) - carried;
            let turn = turned.norm() / STEP_LIMITS.0;
            let shift = shifted.norm() / (length * STEP_LIMITS.1);
            worst = worst.max(turn).max(shift);
            below = *motion;
        }
    }
    1.0 / worst
}

fn moved(
    shape: &Configuration,
    plate: &Vector6<f64>,
    inner: &[Vec<Vector6<f64>>],
    length: f64,
) -> Configuration {
    Configuration {
        plate: Plate(shape.plate.0 + plate * length),
        inner: shape
            .inner
            .iter()
            .zip(inner)
            .map(|(nodes, motions)| {
                nodes.iter().zip(motions).map(|(node, xi)| node.moved(&(xi * length))).collect()
            })
            .collect(),
    }
}
