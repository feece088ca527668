use crate::{
    failure::Failure,
    map_file::MapFile,
    sweep::{Sweeping, Swept},
};
use actuator::{FreeMap, ModuleMap};
use fe::{CappedSweep, FreeSweep, ModuleSweep, SolidSweep};
use std::io::{IsTerminal, stderr};

/// A map, empty or not, and what computes it.
pub enum Plan {
    /// Of a FREE as a section.
    Section(FreeSweep, FreeMap),
    /// Of a FREE as a section between caps.
    Capped(CappedSweep, FreeMap),
    /// Of a FREE as a solid.
    Solid(SolidSweep, FreeMap),
    /// Of a module.
    Module(ModuleSweep, ModuleMap),
}

impl Plan {
    /// The map as it is now.
    pub fn map(&self) -> MapFile {
        match self {
            Plan::Section(_, map) | Plan::Capped(_, map) | Plan::Solid(_, map) => MapFile::Free(map.clone()),
            Plan::Module(_, map) => MapFile::Module(map.clone()),
        }
    }

    /// The same with what another map of the sweep holds. `Err` where the two disagree.
    pub fn absorb(&mut self, other: MapFile) -> Result<(), Failure> {
        let mut joined = self.map();
        joined.absorb(other).map_err(Failure::refused)?;
        match self {
            Plan::Section(_, map) | Plan::Capped(_, map) | Plan::Solid(_, map) => {
                *map = joined.into_free()?
            }
            Plan::Module(_, map) => *map = joined.into_module()?,
        }
        Ok(())
    }

    /// Puts stored points into the map.
    pub fn recall(&mut self, sweeping: &Sweeping) -> Result<(), Failure> {
        match self {
            Plan::Section(sweep, map) => sweeping.recall_paths(sweep, map)?,
            Plan::Capped(sweep, map) => sweeping.recall_paths(sweep, map)?,
            Plan::Solid(sweep, map) => sweeping.recall_paths(sweep, map)?,
            Plan::Module(sweep, map) => sweeping.recall_rows(sweep, map)?,
        };
        Ok(())
    }

    /// Computes what is missing. Gives the map with its checks in order.
    pub fn complete(self, sweeping: &Sweeping) -> Result<(MapFile, Swept), Failure> {
        let (mut map, swept) = match self {
            Plan::Section(sweep, mut map) => {
                let swept = sweeping.paths(&sweep, &mut map)?;
                (MapFile::Free(map), swept)
            }
            Plan::Capped(sweep, mut map) => {
                let swept = sweeping.paths(&sweep, &mut map)?;
                (MapFile::Free(map), swept)
            }
            Plan::Solid(sweep, mut map) => {
                announce(&sweep, &map);
                let swept = sweeping.paths(&sweep, &mut map)?;
                (MapFile::Free(map), swept)
            }
            Plan::Module(sweep, mut map) => {
                let swept = sweeping.rows(&sweep, &mut map)?;
                (MapFile::Module(map), swept)
            }
        };
        map.sort_checks();
        Ok((map, swept))
    }
}

/// Tells what a long run is about to compute, where someone is watching.
fn announce(sweep: &SolidSweep, map: &FreeMap) {
    if !stderr().is_terminal() {
        return;
    }
    let unknowns = map.winding_angles().iter().filter_map(|angle| {
        let node = map.node.free.at(*angle, map.shear_moduli()[0]);
        Some(sweep.solver(&node).ok()?.unknowns())
    });
    eprintln!(
        "solids of up to {} unknowns, {} pressures on each of {} paths; {}",
        unknowns.max().unwrap_or(0),
        map.pressures.len(),
        map.paths.iter().filter(|path| path.is_none()).count() + sweep.check_points(map).len()
            - map.checks.len(),
        map.settings
    );
}
