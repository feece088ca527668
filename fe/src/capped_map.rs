use crate::{
    EndChange, EndEffect, FreeSweep, FreeSweepError, FreeSweepReport, PathError, PressureUnit, Run,
    SectionSolver, Shard, SolidError, SolidSweep, free_sweep,
};
use actuator::{EndLoad, Fidelity, Free, FreeMap, FreePath, LoadedFree, MapAxis, PathEnd, units::MPA};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// Length of the solid whose middle is far from its caps, over the outer radius: 100 mm for the paper's tube. At 20 to 80 deg its middle
/// is then that of a longer one within 0.1 % up to 0.9 of the section's limit pressure, within 0.5 % up to 0.98.
const LONG: f64 = 18.0;
/// States of a solid beside that at rest, evenly spaced in s.
const STEPS: usize = 12;
/// Greatest difference between the end effects at the first and the last shear modulus with which those between are interpolated.
/// They change by what fibres stretch, nearly in proportion to mu B^2/EA, so that what is left is far smaller.
const ALIKE: f64 = 0.1;

/// How the map of a FREE between its caps is computed: section states, and what rigid caps change of them, from solids.
///
/// Stretch and twist are from cap to cap; the section's own stand beside them as those of the middle. Solids are computed at the first and the
/// last shear modulus of a map, and the end effects of those between are interpolated in mu B^2/EA at equal p/p_limit: they are the same
/// but for what the fibres stretch. Where the two differ by more than a tenth, where loads pull the FREE, and for checks, each FREE has
/// solids of its own. A FREE shorter than 18 outer radii has one of its own length as well, the middle of the long one being
/// what its ends are measured by.
///
/// A path goes on to the section's limit pressure, which is lower than that of a FREE between caps, or ends before as far as there are
/// solids.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CappedSweep {
    /// How the sections are computed, and the checks.
    pub section: FreeSweep,
    /// How the solids are meshed; its checks are not used. Elements along, where given, are those of a solid of 18 outer radii.
    pub solid: SolidSweep,
}

/// What a sweep did about caps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CapsReport {
    /// End effects taken from solids now.
    pub end_effects: usize,
    /// Greatest difference between the end effects at the first and the last shear modulus, over the greatest; see
    /// [`EndEffect::difference`].
    pub difference: f64,
}

/// Why there is no end effect; `None` where it was stopped.
type NoEffect = Option<PathError>;
type Slot = Arc<OnceLock<Result<EndEffect, NoEffect>>>;

/// The end effects found so far.
struct Effects<'a> {
    sweep: &'a CappedSweep,
    /// First and last shear modulus of the map, Pa.
    moduli: [f64; 2],
    slots: Mutex<Vec<(LoadedFree, Slot)>>,
    report: Mutex<CapsReport>,
}

impl Effects<'_> {
    /// The end effect of a FREE up to its limit pressure, or up to `reach` shear moduli where it has none. Of threads that ask for the same, one
    /// computes it.
    fn of(
        &self,
        node: &LoadedFree,
        reach: f64,
        told: &mut dyn FnMut() -> bool,
    ) -> Result<EndEffect, NoEffect> {
        let slot = {
            let mut slots = self.slots.lock().unwrap_or_else(PoisonError::into_inner);
            match slots.iter().find(|(other, _)| other == node) {
                Some((_, slot)) => Arc::clone(slot),
                None => {
                    let slot = Slot::default();
                    slots.push((*node, Arc::clone(&slot)));
                    slot
                }
            }
        };
        let found = slot.get_or_init(|| {
            self.report.lock().unwrap_or_else(PoisonError::into_inner).end_effects += 1;
            self.sweep.end_effect(node, reach, told).map_err(|error| match error {
                PathError::Solid(SolidError::Stopped) => None,
                error => Some(error),
            })
        });
        found.clone()
    }

    /// The changes by caps along the section's path of a node.
    fn along(
        &self,
        (node, is_check): (&LoadedFree, bool),
        path: &FreePath,
        pressures: &[f64],
        told: &mut dyn FnMut() -> bool,
    ) -> Result<Vec<EndChange>, NoEffect> {
        let modulus = node.free.elastomer.shear_modulus();
        let unit = PressureUnit::of(path, modulus);
        let greatest = pressures.last().copied().unwrap_or(0.0);
        let changes = |at: &dyn Fn(f64) -> Option<EndChange>| {
            path.states.iter().map_while(|state| at(unit.coordinate(state.pressure))).collect()
        };
        let [first, last] = self.moduli;
        let share = (modulus - first) / (last - first);
        if !is_check && node.load == EndLoad::NONE && share > 0.0 && share < 1.0 {
            let at = |modulus: f64| LoadedFree {
                free: Free { elastomer: node.free.elastomer.with_shear_modulus(modulus), ..node.free },
                ..*node
            };
            let reach = greatest / first;
            let [soft, stiff] = [self.of(&at(first), reach, told)?, self.of(&at(last), reach, told)?];
            let difference = soft.difference(&stiff);
            if difference.is_finite() {
                let mut report = self.report.lock().unwrap_or_else(PoisonError::into_inner);
                report.difference = report.difference.max(difference);
            }
            if difference <= ALIKE && unit.is_like(soft.unit()) {
                return Ok(changes(&|s| soft.between(&stiff, share, s)));
            }
        }
        let reach = if is_check { greatest / modulus } else { greatest / first };
        let own = self.of(node, reach, told)?;
        Ok(changes(&|s| own.at(s)))
    }
}

impl CappedSweep {
    /// An empty map; see [`FreeSweep::empty_map`].
    ///
    /// # Errors
    /// [`FreeSweepError`] where an axis, the mesh or the FREE at one of the corners makes no sense.
    pub fn empty_map(
        &self,
        node: LoadedFree,
        axes: Vec<MapAxis>,
        pressures: Vec<f64>,
        source: (String, String),
    ) -> Result<FreeMap, FreeSweepError> {
        let made_by = (Fidelity::CappedSection, String::new());
        let mut map = free_sweep::empty_map(node, axes, pressures, made_by, source, &|node| {
            SectionSolver::new(&node.free, self.section.mesh)?;
            for free in self.solids(&node.free) {
                self.solid_for(&free).solver(&free)?;
            }
            Ok(())
        })?;
        map.settings = self.settings(&map);
        Ok(map)
    }

    /// The settings in words, as they stand in the map.
    fn settings(&self, map: &FreeMap) -> String {
        let solids = self.solids(&map.node.free);
        let words = solids.iter().map(|free| {
            let (length, sweep) = (free.tube.length, self.solid_for(free));
            format!("{:.4} mm long, {}", 1e3 * length, sweep.solid_in_words(free, map.winding_angles()))
        });
        let words: Vec<String> = words.collect();
        let moduli = map.shear_moduli();
        let of_moduli = match moduli {
            [first, .., last] => {
                format!("{:.4} and {:.4} MPa, interpolated between", first / MPA, last / MPA)
            }
            _ => format!("{:.4} MPa", moduli.first().copied().unwrap_or(f64::NAN) / MPA),
        };
        format!(
            "{}; between caps {:.4} mm apart: end extension and end twist at {STEPS} pressures up to the section's limit pressure and at \
             shear moduli of {of_moduli}, from solids: {}; the limit pressure is the section's",
            self.section.settings(),
            1e3 * map.node.free.tube.length,
            words.join("; ")
        )
    }

    /// The FREEs of the checks, between the nodes; none where the map has a single node.
    pub fn check_points(&self, map: &FreeMap) -> Vec<LoadedFree> {
        self.section.check_points(map)
    }

    /// The FREEs whose solids tell the end effect of a FREE: a long one, and one of its own length where that is shorter.
    fn solids(&self, free: &Free) -> Vec<Free> {
        let mut long = *free;
        long.tube.length = LONG * free.tube.outer_radius();
        if free.tube.length < long.tube.length { vec![long, *free] } else { vec![long] }
    }

    /// The sweep for a solid, its elements along being in proportion to its length.
    fn solid_for(&self, free: &Free) -> SolidSweep {
        let share = free.tube.length / (LONG * free.tube.outer_radius());
        let elements = self.solid.elements.map(|[radial, around, along]| {
            [radial, around, (f64::from(along) * share).round().max(10.0) as u32]
        });
        SolidSweep { elements, ..self.solid }
    }

    /// The end effect of a FREE up to its section's limit pressure, or up to `reach` shear moduli where that has none. `told` is called
    /// after each state of a solid and says whether to go on.
    ///
    /// # Errors
    /// [`PathError`] where a path is not found or stopped.
    pub fn end_effect(
        &self,
        node: &LoadedFree,
        reach: f64,
        told: &mut dyn FnMut() -> bool,
    ) -> Result<EndEffect, PathError> {
        let modulus = node.free.elastomer.shear_modulus();
        let mut solver = SectionSolver::new(&node.free, self.section.mesh)?;
        let section = solver.path_under(node.load, &[0.0, reach * modulus], 0)?;
        let unit = PressureUnit::of(&section, modulus);
        let end = unit.coordinate(section.states.last().map_or(0.0, |state| state.pressure));
        let pressures: Vec<f64> =
            (0..=STEPS).map(|step| unit.pressure(end * step as f64 / STEPS as f64)).collect();
        let solids = self.solids(&node.free);
        let paths: Vec<FreePath> = solids
            .iter()
            .map(|free| self.solid_for(free).path(&LoadedFree { free: *free, ..*node }, &pressures, told))
            .collect::<Result<_, SolidError>>()?;
        let (far, own) = (&paths[0], &paths[paths.len() - 1]);
        let length = solids[solids.len() - 1].tube.length;
        EndEffect::of_solids(own, length, far, &pressures, unit).ok_or_else(|| {
            PathError::Solid(SolidError::NotConverged {
                target: format!("{:.4} kPa between caps", 1e-3 * pressures[1]),
                residual: f64::NAN,
                last_good: 0.0,
                advice: "Use a finer mesh",
            })
        })
    }

    /// Computes the paths of the map that are missing and belong to `shard`; see [`FreeSweep::fill`]. Progress is told in states of
    /// solids. A stop takes effect after the state being sought; solids whose paths are not finished are computed again.
    ///
    /// # Errors
    /// [`FreeSweepError::Shape`] where the map does not fit its own axes.
    pub fn fill(
        &self,
        map: &mut FreeMap,
        shard: Shard,
        run: &Run<'_>,
        finished: &mut (dyn FnMut(&LoadedFree, &FreePath) + Send),
    ) -> Result<(FreeSweepReport, CapsReport), FreeSweepError> {
        let check_points = self.check_points(map);
        let moduli = map.shear_moduli();
        let ends = [moduli[0], moduli[moduli.len() - 1]];
        let effects = Effects {
            sweep: self,
            moduli: ends,
            slots: Mutex::new(Vec::new()),
            report: Mutex::new(CapsReport::default()),
        };
        let steps = STEPS * self.solids(&map.node.free).len();
        let report =
            free_sweep::fill(map, &check_points, shard, (run, steps), finished, &|node, pressures, told| {
                let section =
                    self.section.path(node, pressures).map_err(|error| Some(PathError::Section(error)))?;
                let whole = (node, check_points.contains(node));
                let changes = effects.along(whole, &section, pressures, &mut || told.step())?;
                Ok(capped(section, node.free.tube.length, &changes))
            })?;
        let caps = *effects.report.lock().unwrap_or_else(PoisonError::into_inner);
        Ok((report, caps))
    }
}

/// The path between caps `length` (m) apart, as far as what they change is known. States past the limit point, of which it is not, are
/// left out.
fn capped(section: FreePath, length: f64, changes: &[EndChange]) -> FreePath {
    let end = if changes.len() < section.states.len() { PathEnd::Range } else { section.end };
    let states =
        section.states.iter().zip(changes).map(|(state, change)| change.cap_to_cap(length, state)).collect();
    FreePath { states, end, beyond: Vec::new(), ..section }
}

#[cfg(test)]
#[path = "capped_map_tests.rs"]
mod tests;
