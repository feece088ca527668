use crate::{
    BendingSweep, Equilibrium, HeldModule, ModuleSweepError, RodError, RodLaw, RodModule, RodSettings, Run,
    SectionMesh, SectionSolver, ThickTube, module_laws::bending_laws, pressure_axes::check_axes,
};
use actuator::{ConvexPolygon, Free, Module, PlacedFree, PoseChart, Wrench, Zonotope, grid_places};
use std::sync::Arc;

/// How the wrenches of a module whose plate is held are computed.
///
/// Without spacers the FREEs do not know of each other: each is solved alone over its own pressures, and the wrenches of the module
/// are all sums of one of each, exactly. Spacers tie the FREEs together, and the whole module is solved at every combination of
/// pressures.
///
/// The section law is the closed form of a tube with its threads smeared over the surface ([`ThickTube`]), which is what the tables of a
/// module's map interpolate ([`crate::ModuleSweep`]); unlike them it has no greatest pressure: a FREE that is held bears more than
/// its limit pressure.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct BlockedSweep {
    /// Fineness of the rods, factor on their bending stiffness.
    pub rods: RodSettings,
    /// How bending and shear stiffness are computed; `None` takes those of the bare tube.
    pub bending: Option<BendingSweep>,
}

/// What is given to the held plate at one combination of pressures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldState {
    /// Wrench of the FREEs on the plate, about its centre, in the base frame.
    pub wrench: Wrench,
    /// Number of negative pivots: 0 = stable, more = a FREE would buckle sideways. `None` for a section, which knows no sideways.
    pub negative_pivots: Option<u32>,
}

impl HeldState {
    /// Whether a FREE would buckle sideways.
    pub fn is_unstable(&self) -> bool {
        self.negative_pivots.is_some_and(|pivots| pivots > 0)
    }
}

/// Wrenches that a held module, or FREE, gives over its pressures.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockedForces {
    /// Pressures of each FREE, Pa, rising from zero.
    pub pressures: Vec<Vec<f64>>,
    /// States of each FREE alone, over its pressures, where FREEs do not know of each other; `None` = no equilibrium found.
    pub frees: Option<Vec<Vec<Option<HeldState>>>>,
    /// States over the grid of pressures, last FREE fastest.
    pub states: Vec<Option<HeldState>>,
    /// The set made linear at the pose: slopes at a hundredth of the greatest pressures, where threads are just taut.
    pub linear: Zonotope,
}

/// Pressure at which the wrenches are made linear, as a share of the greatest: at zero, threads are neither taut nor slack.
const LINEAR_AT: f64 = 0.01;

fn state(found: &Equilibrium) -> HeldState {
    HeldState {
        wrench: found.wrenches.iter().copied().sum(),
        negative_pivots: Some(found.state.negative_pivots),
    }
}

/// States over a list of pressures, each followed from the one before; after a failure nothing further is tried.
fn follow(
    held: &HeldModule,
    pressures: impl Iterator<Item = Vec<f64>>,
    told: &mut dyn FnMut() -> bool,
) -> Option<Vec<Option<HeldState>>> {
    let mut last = Some(held.unpressurised().clone());
    let mut states = Vec::new();
    for pressures in pressures {
        last = last.and_then(|last| held.solve_from(&last, &pressures).ok());
        states.push(last.as_ref().map(state));
        if told() {
            return None;
        }
    }
    Some(states)
}

/// Slope of the wrench with one FREE's pressure, times its greatest pressure.
fn generator(held: &HeldModule, free: usize, top: f64, count: usize) -> Result<Wrench, RodError> {
    let mut pressures = vec![0.0; count];
    pressures[free] = LINEAR_AT * top;
    Ok(held.solve(&pressures)?.wrench_slopes[free] * top)
}

fn top(axis: &[f64]) -> f64 {
    axis.last().copied().unwrap_or_default()
}

impl BlockedSweep {
    /// Wrenches of a module whose plate is held at a pose, over pressures (Pa, rising from zero) of each FREE. `None` where the run was
    /// stopped.
    ///
    /// # Errors
    /// [`ModuleSweepError`] where an axis makes no sense, a FREE's bending law cannot be computed, or the plate cannot be brought to the pose.
    /// Pressures without equilibrium are no error: their states are missing.
    pub fn module(
        &self,
        module: &Module,
        pose: &PoseChart,
        pressures: Vec<Vec<f64>>,
        run: &Run<'_>,
    ) -> Result<Option<BlockedForces>, ModuleSweepError> {
        check_axes(module.frees.len(), &pressures)?;
        let Some(laws) = self.laws(module, &pressures, run)? else { return Ok(None) };
        let grid: usize = pressures.iter().map(Vec::len).product();
        let alone = module.spacers == 0;
        let all = if alone { pressures.iter().map(Vec::len).sum() } else { grid };
        let mut done = 0;
        let mut told = || {
            done += 1;
            (run.progress)(done, all);
            run.is_stopped()
        };
        (run.progress)(0, all);
        let mut forces = BlockedForces {
            linear: Zonotope { base: Wrench::default(), generators: Vec::new() },
            frees: None,
            states: Vec::with_capacity(grid),
            pressures,
        };
        if alone {
            let mut frees = Vec::with_capacity(module.frees.len());
            for (free, law) in laws.iter().enumerate() {
                let own = Module { frees: vec![module.frees[free]], ..module.clone() };
                let held = RodModule::new(&own, vec![law.clone()], self.rods)?.held(pose)?;
                let axis = &forces.pressures[free];
                let Some(states) = follow(&held, axis.iter().map(|p| vec![*p]), &mut told) else {
                    return Ok(None);
                };
                forces.linear.base = forces.linear.base + state(held.unpressurised()).wrench;
                forces.linear.generators.push(generator(&held, 0, top(axis), 1)?);
                frees.push(states);
            }
            forces.add_up(frees);
        } else {
            let held = RodModule::new(module, laws, self.rods)?.held(pose)?;
            forces.linear.base = state(held.unpressurised()).wrench;
            let count = module.frees.len();
            for (free, axis) in forces.pressures.iter().enumerate() {
                forces.linear.generators.push(generator(&held, free, top(axis), count)?);
            }
            let row = forces.pressures[count - 1].len();
            for first in (0..grid).step_by(row) {
                let nodes: Vec<Vec<f64>> =
                    (first..first + row).map(|node| forces.node_pressures(node)).collect();
                let Some(states) = follow(&held, nodes.into_iter(), &mut told) else { return Ok(None) };
                forces.states.extend(states);
            }
        }
        Ok(Some(forces))
    }

    /// The laws of each FREE.
    fn laws(
        &self,
        module: &Module,
        pressures: &[Vec<f64>],
        run: &Run<'_>,
    ) -> Result<Option<Vec<RodLaw>>, ModuleSweepError> {
        let greatest: Vec<f64> = pressures.iter().map(|axis| top(axis)).collect();
        let Some(bending) = bending_laws(module, &greatest, self.bending, false, run)? else {
            return Ok(None);
        };
        let law = |(placed, bending): (&PlacedFree, _)| RodLaw {
            section: Arc::new(ThickTube::new(&placed.free)),
            bending,
        };
        Ok(Some(module.frees.iter().zip(bending).map(law).collect()))
    }

    /// Force and torque along the axis of a FREE held at a stretch and a twist per length (rad/m), over pressures (Pa, rising from
    /// zero), by the finite elements of its section with its own threads.
    ///
    /// # Errors
    /// [`ModuleSweepError`] where the pressures make no sense or the section has no answer at the least of them.
    pub fn free(
        free: &Free,
        [axial_stretch, twist_per_length]: [f64; 2],
        pressures: Vec<f64>,
    ) -> Result<BlockedForces, ModuleSweepError> {
        let pressures = vec![pressures];
        check_axes(1, &pressures)?;
        let of = |source| ModuleSweepError::Section { free: 0, source };
        let mut solver = SectionSolver::new(free, SectionMesh::default()).map_err(of)?;
        let mut at = |pressure: f64| solver.blocked(pressure, axial_stretch, twist_per_length);
        let base = at(0.0).map_err(of)?.wrench;
        let greatest = top(&pressures[0]);
        let generators = vec![at(LINEAR_AT * greatest).map_err(of)?.slope * greatest];
        let states = pressures[0].iter().map(|pressure| {
            let wrench = at(*pressure).ok()?.wrench;
            Some(HeldState { wrench, negative_pivots: None })
        });
        let frees = vec![states.collect()];
        let linear = Zonotope { base, generators };
        let mut forces = BlockedForces { pressures, frees: None, states: Vec::new(), linear };
        forces.add_up(frees);
        Ok(forces)
    }
}

impl BlockedForces {
    /// The grid from the states of each FREE.
    fn add_up(&mut self, frees: Vec<Vec<Option<HeldState>>>) {
        let grid: usize = self.pressures.iter().map(Vec::len).product();
        let sum = |node: usize| {
            let states = self.places(node).into_iter().zip(&frees).map(|(place, states)| states[place]);
            states.collect::<Option<Vec<_>>>().map(|states| HeldState {
                wrench: states.iter().map(|state| state.wrench).sum(),
                negative_pivots: states.iter().map(|state| state.negative_pivots).sum(),
            })
        };
        self.states = (0..grid).map(sum).collect();
        self.frees = Some(frees);
    }

    /// Place of a node on each FREE's pressures.
    fn places(&self, node: usize) -> Vec<usize> {
        grid_places(self.pressures.iter().map(Vec::len), node)
    }

    /// Pressures (Pa) of a node of the grid.
    pub fn node_pressures(&self, node: usize) -> Vec<f64> {
        self.places(node).into_iter().zip(&self.pressures).map(|(place, axis)| axis[place]).collect()
    }

    /// The wrench that the linear set has at a node.
    pub fn linear_at(&self, node: usize) -> Wrench {
        let shares = self.node_pressures(node).into_iter().zip(&self.pressures);
        self.linear.at(&shares.map(|(pressure, axis)| pressure / top(axis)).collect::<Vec<_>>())
    }

    /// Greatest distance, component by component, between the wrench and the linear one at the same pressures.
    pub fn departure(&self) -> Wrench {
        let mut most = [0.0f64; 6];
        for (node, state) in self.states.iter().enumerate() {
            let Some(state) = state else { continue };
            let off = (state.wrench - self.linear_at(node)).to_array();
            most.iter_mut().zip(off).for_each(|(most, off)| *most = most.max(off.abs()));
        }
        Wrench::from_array(most)
    }

    /// Greatest distance, component by component, between the wrench and the sum of those of each FREE alone: zero without spacers.
    pub fn coupling(&self) -> Wrench {
        let mut most = [0.0f64; 6];
        let Some(base) = self.states.first().copied().flatten() else { return Wrench::default() };
        let mut stride = self.states.len();
        let strides: Vec<usize> = self
            .pressures
            .iter()
            .map(|axis| {
                stride /= axis.len();
                stride
            })
            .collect();
        for (node, state) in self.states.iter().enumerate() {
            let alone =
                self.places(node).into_iter().zip(&strides).map(|(place, stride)| {
                    self.states[place * stride].map(|state| state.wrench - base.wrench)
                });
            let (Some(state), Some(alone)) = (state, alone.sum::<Option<Wrench>>()) else { continue };
            let off = (state.wrench - base.wrench - alone).to_array();
            most.iter_mut().zip(off).for_each(|(most, off)| *most = most.max(off.abs()));
        }
        Wrench::from_array(most)
    }

    /// Convex hull of the shadow on the plane of two components (in the order of [`Wrench::to_array`]) of all wrenches found: of FREEs
    /// that do not know of each other, the Minkowski sum of the hulls of their curves.
    pub fn shadow(&self, components: [usize; 2]) -> ConvexPolygon {
        let hull = |states: &[Option<HeldState>]| {
            let points = states.iter().flatten().map(|state| state.wrench.to_array());
            ConvexPolygon::hull(points.map(|wrench| components.map(|k| wrench[k])))
        };
        match &self.frees {
            None => hull(&self.states),
            Some(frees) => {
                let point = ConvexPolygon { vertices: vec![[0.0; 2]] };
                frees.iter().fold(point, |sum, states| sum.minkowski_sum(&hull(states)))
            }
        }
    }
}

#[cfg(test)]
#[path = "blocked_tests.rs"]
mod tests;
