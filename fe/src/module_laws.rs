//! Laws of the FREEs of a module as rods: sections and bending, shared by FREEs of one section.

use crate::{
    BendingLaw, BendingSweep, CapTable, CappedSection, ConstantBending, ModuleSweep, ModuleSweepError,
    RodLaw, RodModule, Run, SectionLaw, SectionSolver, SectionTable, TableError, TableGrid,
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

/// What is found of each FREE's section once, `find` being told the first FREE that has it, its section and the greatest pressure (Pa) of all
/// that have it. `None` where that finds none.
fn each_section<T: Clone>(
    module: &Module,
    pressures: &[f64],
    mut find: impl FnMut(usize, &Free, f64) -> Result<Option<T>, ModuleSweepError>,
) -> Result<Option<Vec<T>>, ModuleSweepError> {
    let sections: Vec<Free> = module.frees.iter().map(|placed| section_of(&placed.free)).collect();
    let mut found: Vec<T> = Vec::with_capacity(sections.len());
    for (free, section) in sections.iter().enumerate() {
        let first = sections.iter().position(|other| other == section).unwrap_or(free);
        let own = if first < free {
            Some(found[first].clone())
        } else {
            let users = sections.iter().zip(pressures).filter(|(other, _)| *other == section);
            find(free, section, users.map(|(_, pressure)| *pressure).fold(0.0, f64::max))?
        };
        let Some(own) = own else { return Ok(None) };
        found.push(own);
    }
    Ok(Some(found))
}

fn greatest(pressures: &[f64]) -> f64 {
    pressures.iter().copied().fold(0.0, f64::max)
}

/// Bending law of each FREE up to its greatest pressure (Pa), from solids or, with no sweep, of the bare tube: a law of the strains far
/// from caps or, `between_caps`, of the FREE's mean ones. `None` where the run was stopped.
pub(crate) fn bending_laws(
    module: &Module,
    pressures: &[f64],
    sweep: Option<BendingSweep>,
    between_caps: bool,
    run: &Run<'_>,
) -> Result<Option<Vec<Arc<dyn BendingLaw>>>, ModuleSweepError> {
    let Some(sweep) = sweep else {
        let bare = module.frees.iter().map(|placed| ConstantBending::of_bare_tube(&placed.free));
        return Ok(Some(bare.map(|law| Arc::new(law) as Arc<dyn BendingLaw>).collect()));
    };
    let tables = each_section(module, pressures, |free, _, top| {
        let found = sweep.tabulate(&module.frees[free].free, top, run);
        let table = found.map_err(|source| ModuleSweepError::Bending { free, source })?;
        Ok(table.map(Arc::new))
    })?;
    let Some(tables) = tables else { return Ok(None) };
    let laws = tables.into_iter().zip(&module.frees).map(|(table, placed)| -> Arc<dyn BendingLaw> {
        if between_caps { Arc::new(table.between_caps(placed.free.tube.length)) } else { table }
    });
    Ok(Some(laws.collect()))
}

impl ModuleSweep {
    /// Free path of each FREE as if right-handed; FREEs of one section share it.
    pub(crate) fn free_paths(
        &self,
        module: &Module,
        pressures: &[Vec<f64>],
    ) -> Result<Vec<FreePath>, ModuleSweepError> {
        let paths = each_section(module, &[], |free, section, _| {
            let path = SectionSolver::new(section, self.mesh)
                .and_then(|mut solver| solver.path(&pressures[free], 8))
                .map_err(|source| ModuleSweepError::Section { free, source })?;
            Ok(Some(path))
        })?;
        Ok(paths.unwrap_or_default())
    }

    /// Section law of each FREE, for where it comes up to its greatest pressure; FREEs of one section share it. `None` where the run was
    /// stopped.
    ///
    /// # Errors
    /// [`ModuleSweepError`] where a section cannot be solved.
    pub fn section_laws(
        &self,
        module: &Module,
        pressures: &[Vec<f64>],
        run: &Run<'_>,
    ) -> Result<Option<Vec<Arc<SectionTable>>>, ModuleSweepError> {
        let paths = self.free_paths(module, pressures)?;
        let tops: Vec<f64> = pressures.iter().map(|axis| greatest(axis)).collect();
        each_section(module, &tops, |free, section, top| {
            let grid = TableGrid::for_free(section, &paths[free], top);
            match SectionTable::new(section, grid, self.mesh, run) {
                Err(TableError::Stopped) => Ok(None),
                Err(source) => Err(ModuleSweepError::Table { free, source }),
                Ok(table) => Ok(Some(Arc::new(table))),
            }
        })
    }

    /// Bending law of each FREE up to its greatest pressure or its limit pressure; FREEs of one section share it. `None` where the run was
    /// stopped.
    ///
    /// # Errors
    /// [`ModuleSweepError::Bending`] where a FREE's solids cannot be solved.
    pub fn bending_laws(
        &self,
        module: &Module,
        pressures: &[Vec<f64>],
        run: &Run<'_>,
    ) -> Result<Option<Vec<Arc<dyn BendingLaw>>>, ModuleSweepError> {
        bending_laws(module, &self.tops(module, pressures)?, self.bending, self.caps.is_some(), run)
    }

    /// Greatest pressure of each FREE (Pa) that it bears without load.
    fn tops(&self, module: &Module, pressures: &[Vec<f64>]) -> Result<Vec<f64>, ModuleSweepError> {
        let top = |(axis, path): (&Vec<f64>, &FreePath)| {
            path.limit_pressure().map_or(greatest(axis), |limit| limit.min(greatest(axis)))
        };
        Ok(pressures.iter().zip(&self.free_paths(module, pressures)?).map(top).collect())
    }

    /// Law of each FREE's stretch and twist as a rod: that of its section with, where they count, its caps. `None` where the run was
    /// stopped.
    ///
    /// # Errors
    /// [`ModuleSweepError::Caps`] where the solid between the caps cannot be solved.
    pub fn capped_laws(
        &self,
        module: &Module,
        sections: Vec<Arc<SectionTable>>,
        pressures: &[Vec<f64>],
        run: &Run<'_>,
    ) -> Result<Option<Vec<Arc<dyn SectionLaw>>>, ModuleSweepError> {
        let Some(sweep) = self.caps else {
            return Ok(Some(sections.into_iter().map(|section| section as Arc<dyn SectionLaw>).collect()));
        };
        let caps = each_section(module, &self.tops(module, pressures)?, |free, section, top| {
            let found = sweep.tabulate(section, sections[free].as_ref(), top, run);
            let found: Option<CapTable> = found.map_err(|source| ModuleSweepError::Caps { free, source })?;
            Ok(found.map(Arc::new))
        })?;
        let Some(caps) = caps else { return Ok(None) };
        let laws = sections.into_iter().zip(caps).zip(&module.frees);
        let laws = laws.map(|((section, caps), placed)| -> Arc<dyn SectionLaw> {
            let tube = placed.free.tube;
            Arc::new(CappedSection::new(section, caps, [tube.length, tube.outer_radius()]))
        });
        Ok(Some(laws.collect()))
    }

    /// Law of each FREE as a rod; `None` where the run was stopped.
    ///
    /// # Errors
    /// As of [`ModuleSweep::section_laws`], [`ModuleSweep::capped_laws`] and [`ModuleSweep::bending_laws`].
    pub fn rod_laws(
        &self,
        module: &Module,
        pressures: &[Vec<f64>],
        run: &Run<'_>,
    ) -> Result<Option<Vec<RodLaw>>, ModuleSweepError> {
        let Some(tables) = self.section_laws(module, pressures, run)? else { return Ok(None) };
        let Some(sections) = self.capped_laws(module, tables, pressures, run)? else { return Ok(None) };
        let Some(bending) = self.bending_laws(module, pressures, run)? else { return Ok(None) };
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

#[cfg(test)]
#[path = "module_laws_tests.rs"]
mod tests;
