//! Laws of the FREEs of a module as rods: sections and bending, shared by FREEs of one section.

use crate::{
    BendingLaw, BendingSweep, ConstantBending, ModuleSweep, ModuleSweepError, RodLaw, RodModule, Run,
    SectionSolver, SectionTable, TableError, TableGrid,
};
use actuator::{Free, FreePath, Handedness, Module};
use std::{f64::consts::TAU, sync::Arc};

/// What a FREE's section depends on: neither its length nor, but for the mirror, its hand. Its threads are spread over all of the
/// surface: in a FREE that others turn against its own sense under pressure they are pulled tight, and narrow ones cut into the
/// wall, which bulges between them in a snap (0.15 mm: from 10 rad/m at 40 kPa in a 40 degree FREE). A module's states there would
/// hang on a width that nobody measures. The price is 4 to 6 % more twist of a free FREE at 20 degrees, 1.5 % at 60.
fn section_of(free: &Free) -> Free {
    let mut section = *free;
    section.tube.length = 1.0;
    section.winding.handedness = Handedness::Right;
    section.winding.fibre.diameter = TAU * section.tube.outer_radius();
    section
}

/// The first FREE whose section is the same as that of each FREE.
fn first_alike(module: &Module) -> Vec<usize> {
    let sections: Vec<Free> = module.frees.iter().map(|placed| section_of(&placed.free)).collect();
    sections.iter().map(|own| sections.iter().position(|other| other == own).unwrap_or_default()).collect()
}

fn greatest(pressures: &[f64]) -> f64 {
    pressures.iter().fold(0.0f64, |greatest, pressure| greatest.max(*pressure))
}

/// Bending law of each FREE up to its greatest pressure (Pa), from solids or, with no sweep, of the bare tube; FREEs of one section
/// share it. `None` where the run was stopped.
pub(crate) fn bending_laws(
    module: &Module,
    pressures: &[f64],
    sweep: Option<BendingSweep>,
    run: &Run<'_>,
) -> Result<Option<Vec<Arc<dyn BendingLaw>>>, ModuleSweepError> {
    let alike = first_alike(module);
    let mut laws: Vec<Arc<dyn BendingLaw>> = Vec::with_capacity(alike.len());
    for (free, first) in alike.iter().copied().enumerate() {
        let own = &module.frees[free].free;
        let law = match sweep {
            _ if first < free => laws[first].clone(),
            None => Arc::new(ConstantBending::of_bare_tube(own)),
            Some(sweep) => {
                let users = alike.iter().zip(pressures).filter(|(other, _)| **other == free);
                let top = users.fold(0.0f64, |top, (_, pressure)| top.max(*pressure));
                let found = sweep.tabulate(own, top, run);
                match found.map_err(|source| ModuleSweepError::Bending { free, source })? {
                    None => return Ok(None),
                    Some(table) => Arc::new(table),
                }
            }
        };
        laws.push(law);
    }
    Ok(Some(laws))
}

impl ModuleSweep {
    /// Free path of each FREE as if right-handed; FREEs of one section share it.
    pub(crate) fn free_paths(
        &self,
        module: &Module,
        pressures: &[Vec<f64>],
    ) -> Result<Vec<FreePath>, ModuleSweepError> {
        let alike = first_alike(module);
        let mut paths: Vec<FreePath> = Vec::with_capacity(alike.len());
        for (free, first) in alike.into_iter().enumerate() {
            let path = if first < free {
                paths[first].clone()
            } else {
                SectionSolver::new(&section_of(&module.frees[free].free), self.mesh)
                    .and_then(|mut solver| solver.path(&pressures[free], 8))
                    .map_err(|source| ModuleSweepError::Section { free, source })?
            };
            paths.push(path);
        }
        Ok(paths)
    }

    /// Section law of each FREE, tabulated up to its greatest pressure or its limit pressure; FREEs of one section share it.
    ///
    /// # Errors
    /// [`ModuleSweepError`] where a section cannot be solved or the tabulation was stopped.
    pub fn section_laws(
        &self,
        module: &Module,
        pressures: &[Vec<f64>],
        run: &Run<'_>,
    ) -> Result<Vec<Arc<SectionTable>>, ModuleSweepError> {
        let alike = first_alike(module);
        let paths = self.free_paths(module, pressures)?;
        let mut laws: Vec<Arc<SectionTable>> = Vec::with_capacity(alike.len());
        for (free, first) in alike.iter().copied().enumerate() {
            if first < free {
                laws.push(laws[first].clone());
                continue;
            }
            let users = alike.iter().zip(pressures).filter(|(other, _)| **other == free);
            let top = users.flat_map(|(_, axis)| axis).fold(0.0f64, |top, pressure| top.max(*pressure));
            let top = paths[free].limit_pressure().map_or(top, |limit| top.min(limit));
            let section = section_of(&module.frees[free].free);
            let mut solver = SectionSolver::new(&section, self.mesh)
                .map_err(|source| ModuleSweepError::Section { free, source })?;
            let grid = TableGrid::for_free(&section, &paths[free], top);
            let provider = move |p: f64, stretch: f64, twist: f64| solver.respond(p, stretch, twist).ok();
            let table = SectionTable::tabulate(grid, &provider, run)
                .map_err(|source| ModuleSweepError::Table { free, source })?;
            laws.push(Arc::new(table));
        }
        Ok(laws)
    }

    /// Bending law of each FREE up to the greatest pressure of its section law; FREEs of one section share it. `None` where the run
    /// was stopped.
    ///
    /// # Errors
    /// [`ModuleSweepError::Bending`] where a FREE's solids cannot be solved.
    pub fn bending_laws(
        &self,
        module: &Module,
        sections: &[Arc<SectionTable>],
        run: &Run<'_>,
    ) -> Result<Option<Vec<Arc<dyn BendingLaw>>>, ModuleSweepError> {
        let greatest = sections.iter().map(|section| greatest(&section.grid().pressures));
        bending_laws(module, &greatest.collect::<Vec<_>>(), self.bending, run)
    }

    /// Section and bending law of each FREE; `None` where the run was stopped.
    ///
    /// # Errors
    /// As of [`ModuleSweep::section_laws`] and [`ModuleSweep::bending_laws`].
    pub fn rod_laws(
        &self,
        module: &Module,
        pressures: &[Vec<f64>],
        run: &Run<'_>,
    ) -> Result<Option<Vec<RodLaw>>, ModuleSweepError> {
        let sections = match self.section_laws(module, pressures, run) {
            Err(ModuleSweepError::Table { source: TableError::Stopped, .. }) => return Ok(None),
            sections => sections?,
        };
        let Some(bending) = self.bending_laws(module, &sections, run)? else { return Ok(None) };
        let laws = sections.into_iter().zip(bending).map(|(section, bending)| RodLaw { section, bending });
        Ok(Some(laws.collect()))
    }

    /// The module as rods with these laws; `None` where the run was stopped.
    pub(crate) fn rod_module(
        &self,
        module: &Module,
        pressures: &[Vec<f64>],
        run: &Run<'_>,
    ) -> Result<Option<RodModule>, ModuleSweepError> {
        let Some(laws) = self.rod_laws(module, pressures, run)? else { return Ok(None) };
        Ok(Some(RodModule::new(module, laws, self.rods)?))
    }
}
