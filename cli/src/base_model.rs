//! The model of a rig from its description alone, computed by finite elements and kept for the next time.

use crate::{
    command::fit,
    exit::Exit,
    failure::Failure,
    interrupt, lasting,
    map_file::MapFile,
    points::Points,
    sweep::{self, Sweeping},
};
use actuator::{Description, Free, MapAxis, Module, ModuleMap, Rig, units::DEG};
use fe::{FreeSweep, ModuleSweep};
use rom::Model;
use std::{
    path::Path,
    sync::{Mutex, PoisonError},
};

/// Pressures beyond the rig's greatest that a rubber softer than described answers as if it stood under them.
const BEYOND: f64 = 1.3;
/// The same for modules, the first that converges everywhere: FREEs that hold each other come to their limits early.
const MODULE_BEYOND: [f64; 5] = [1.3, 1.2, 1.12, 1.06, 1.0];
/// Winding angles about the description's own, degrees: hand winding errs by 1 to 3.
const ANGLES: [f64; 7] = [-6.0, -4.0, -2.0, 0.0, 2.0, 4.0, 6.0];
/// Shear moduli as factors of the description's own: rubber, wall and coating act alike.
const MODULI: [f64; 7] = [0.5, 0.65, 0.82, 1.0, 1.2, 1.4, 1.6];
/// Pressures of a FREE's map.
const PRESSURES: usize = 40;

/// The model of a rig, from `directory` where an earlier run left it there, made and left there otherwise.
pub fn of(rig: &Rig, directory: &Path) -> Result<Model, Failure> {
    let (map_path, model_path) = (directory.join("base.map"), directory.join("base.model"));
    if let Ok(model) = Model::read(&model_path) {
        let provenance = &model.provenance;
        if provenance.description_text == rig.text && provenance.program_version == env!("CARGO_PKG_VERSION")
        {
            return Ok(model);
        }
    }
    let points = Mutex::new(Points::open(&lasting::beside(&map_path))?);
    let map = map(rig, &Sweeping { points: Some(&points), ..Sweeping::whole() })?;
    map.write(&map_path)?;
    points.into_inner().unwrap_or_else(PoisonError::into_inner).remove()?;
    let model = fit::fit(&map).map_err(|failure| failure.about(&rig.path))?;
    model.write(&model_path)?;
    Ok(model)
}

/// The map that identification needs. What an earlier run had finished of it is not computed again.
fn map(rig: &Rig, sweeping: &Sweeping) -> Result<MapFile, Failure> {
    match &rig.description {
        Description::Free(free) => {
            let sweep = FreeSweep::default();
            let (axes, pressures) = free_axes(free, rig.limits.pressure_max[0]);
            let mut map = sweep::plan_free(&sweep, rig, axes, pressures)?;
            let swept = sweeping.paths(&sweep, &mut map)?;
            converged(rig, &swept.failed)?;
            Ok(MapFile::Free(map))
        }
        Description::Module(module) => module_map(rig, module, sweeping).map(MapFile::Module),
    }
}

/// A module's map as far beyond its greatest pressures as all states converge.
fn module_map(rig: &Rig, module: &Module, sweeping: &Sweeping) -> Result<ModuleMap, Failure> {
    let sweep = ModuleSweep::default();
    let mut refused = Ok(());
    for beyond in MODULE_BEYOND {
        let greatest: Vec<f64> = rig.limits.pressure_max.iter().map(|pressure| pressure * beyond).collect();
        // The corners and the checks tell soon whether the whole is worth its time.
        const CORNERS: usize = 2;
        for nodes in [CORNERS, sweep::usual_nodes(module.frees.len())] {
            let mut map = sweep::plan_module(rig, module, &greatest, &vec![nodes; greatest.len()], &sweep)?;
            let swept = sweeping.rows(&sweep, &mut map)?;
            refused = converged(rig, &swept.failed);
            match &refused {
                Err(_) => break,
                Ok(()) if nodes == CORNERS => {}
                Ok(()) => return Ok(map),
            }
        }
        if interrupt::is_asked() {
            return Err(Failure::interrupted());
        }
    }
    Err(refused.err().unwrap_or_else(Failure::interrupted))
}

fn converged<E: std::fmt::Display>(rig: &Rig, failed: &[E]) -> Result<(), Failure> {
    if interrupt::is_asked() {
        return Err(Failure::interrupted());
    }
    match failed.first() {
        None => Ok(()),
        Some(first) => Err(Failure::new(
            Exit::NotConverged,
            format!(
                "{}: {} states of the base map did not converge, first {first}; make a map over smaller pressures with \
                 `freeact map`, fit it and give it by --model",
                rig.path.display(),
                failed.len()
            ),
        )),
    }
}

fn free_axes(free: &Free, greatest: f64) -> (Vec<MapAxis>, Vec<f64>) {
    let angle = free.winding.angle_from_hoop();
    let angles = ANGLES.iter().map(|degrees| angle + degrees * DEG);
    let angles = angles.filter(|angle| (DEG..=89.5 * DEG).contains(angle)).collect();
    let modulus = free.elastomer.shear_modulus();
    let last = BEYOND * greatest;
    let pressures = (0..=PRESSURES).map(|i| last * i as f64 / PRESSURES as f64).collect();
    let moduli = MODULI.iter().map(|factor| factor * modulus).collect();
    (MapAxis::of_angles_and_moduli(angles, moduli), pressures)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map_file::samples;

    #[test]
    fn the_axes_hold_the_description_and_its_neighbourhood() {
        let free = samples::free_map().node.free;
        let (axes, pressures) = free_axes(&free, 50e3);
        let [angles, moduli] = [&axes[0].values, &axes[1].values];
        assert!(angles.iter().any(|angle| *angle == free.winding.angle_from_hoop()) && angles.len() == 7);
        assert!(moduli.contains(&free.elastomer.shear_modulus()));
        assert_eq!((pressures[0], pressures[PRESSURES]), (0.0, 65e3));
        let steep = free.at(88.0 * DEG, 0.4e6);
        assert!(free_axes(&steep, 50e3).0[0].values.iter().all(|angle| *angle <= 89.5 * DEG));
    }
}
