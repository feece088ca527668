//! What finished points are stored under: the hash of everything that determines them.
//!
//! A setting that is added to a sweep must be dealt with here before it compiles: it is in the key, or it changes no point.

use actuator::{LoadedFree, ModuleMap, PointKey, StoreError, artefact};
use fe::{
    BendingSweep, CapSweep, CappedSweep, FreeSweep, ModuleSweep, NUMERICS, RodSettings, SectionMesh,
    SolidMesh, SolidModuleSettings, SolidSweep, TipLoad,
};
use serde::Serialize;

/// What all points hang on: the program, its numerics, and the form in which states are written.
const PROGRAM: (&str, u32, u32) = (env!("CARGO_PKG_VERSION"), NUMERICS, artefact::MAP.version);

/// The path of a FREE's section through pressures (Pa).
pub fn section(sweep: &FreeSweep, node: &LoadedFree, pressures: &[f64]) -> Result<PointKey, StoreError> {
    PointKey::of(&("path of a section", PROGRAM, section_settings(sweep), node, pressures))
}

/// The path of a FREE's section between caps, through pressures (Pa). But for checks, end effects are interpolated between the first and
/// the last of the map's shear moduli (Pa).
pub fn capped(
    sweep: &CappedSweep,
    node: (&LoadedFree, bool),
    shear_moduli: &[f64],
    pressures: &[f64],
) -> Result<PointKey, StoreError> {
    let CappedSweep { section, solid: SolidSweep { elements, checks: _, seed: _ } } = sweep;
    let ends = (shear_moduli.first(), shear_moduli.last());
    let computed_by = (section_settings(section), elements, ends);
    PointKey::of(&("path between caps", PROGRAM, computed_by, node, pressures))
}

/// The path of a FREE's solid through pressures (Pa), by the mesh that the sweep gives this FREE.
pub fn solid(sweep: &SolidSweep, node: &LoadedFree, pressures: &[f64]) -> Result<PointKey, StoreError> {
    let SolidSweep { elements: _, checks: _, seed: _ } = *sweep;
    let mesh = solid_mesh(sweep.mesh(&node.free));
    PointKey::of(&("path of a solid", PROGRAM, mesh, node, pressures))
}

/// A row of a module's states, by its pressures (Pa). The section tables are made for the map's whole axes.
pub fn row(sweep: &ModuleSweep, map: &ModuleMap, row: &[Vec<f64>]) -> Result<PointKey, StoreError> {
    let ModuleSweep { mesh, rods, solids, bending, caps, use_symmetry: _, checks: _, seed: _ } = *sweep;
    if let Some(solids) = solids {
        return row_of_solids(solids, map, row);
    }
    let RodSettings { elements, bending_stiffness_scale, tip_load: TipLoad { force, moment } } = rods;
    let rods = (elements, bending_stiffness_scale, force, moment);
    let bending = bending.map(|BendingSweep { planes, lengths, range }| (planes, lengths, range));
    let caps = caps.map(|CapSweep { planes, length, range }| (planes, length, range));
    let computed_by = (section_mesh(mesh), rods, bending, caps, &map.parameters);
    PointKey::of(&("row of a module", PROGRAM, computed_by, &map.module, &map.pressures, row))
}

/// A row of a module's states as solids, by the meshes that the settings give its FREEs. Neither threads nor the map's other rows matter,
/// but by rows they are followed.
fn row_of_solids(
    SolidModuleSettings { elements, tip_load, threads: _ }: SolidModuleSettings,
    map: &ModuleMap,
    row: &[Vec<f64>],
) -> Result<PointKey, StoreError> {
    let settings = SolidModuleSettings { elements, ..SolidModuleSettings::default() };
    let meshes = map.module.frees.iter().map(|placed| solid_mesh(settings.mesh(&placed.free)));
    let TipLoad { force, moment } = tip_load;
    let computed_by = (meshes.collect::<Vec<_>>(), force, moment, &map.parameters);
    PointKey::of(&("row of a module of solids", PROGRAM, computed_by, &map.module, row))
}

fn solid_mesh(mesh: SolidMesh) -> impl Serialize + use<> {
    let SolidMesh { radial, around, under_fibre, along, follows_fibres } = mesh;
    (radial, around, under_fibre, along, follows_fibres)
}

/// The settings of a section that determine its path. Checks are paths like others.
fn section_settings(sweep: &FreeSweep) -> impl Serialize + use<> {
    let FreeSweep {
        mesh,
        extra_states,
        interpolation_tolerance,
        beyond_limit,
        estimate_errors,
        checks: _,
        seed: _,
    } = *sweep;
    (section_mesh(mesh), extra_states, interpolation_tolerance, beyond_limit, estimate_errors)
}

fn section_mesh(SectionMesh { radial, under_fibre, between_fibres }: SectionMesh) -> [usize; 3] {
    [radial, under_fibre, between_fibres]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map_file::samples;
    use actuator::FreeParameter;

    /// Asserts that a change of anything gives another key.
    fn all_differ(keys: &[Result<PointKey, StoreError>]) {
        let keys: Vec<&PointKey> = keys.iter().map(|key| key.as_ref().unwrap()).collect();
        for (place, key) in keys.iter().enumerate() {
            assert!(!keys[..place].contains(key), "key {place} is that of another point");
        }
    }

    /// A FREE, and FREEs that differ from it in one number each.
    fn nodes() -> Vec<LoadedFree> {
        let node = samples::free_map().node;
        let mut nodes = vec![node];
        for parameter in FreeParameter::ALL {
            let value = parameter.of(&node).unwrap();
            let more =
                if parameter == FreeParameter::Fibres { value + 1.0 } else { value * (1.0 + 1e-15) + 1e-12 };
            nodes.push(parameter.set(node, more).unwrap());
        }
        let mut change = |change: &dyn Fn(&mut LoadedFree)| {
            let mut other = node;
            change(&mut other);
            nodes.push(other);
        };
        change(&|node| node.free.tube.length += 1e-6);
        change(&|node| node.free.winding.handedness = actuator::Handedness::Left);
        change(&|node| {
            node.free.winding.fibre.law = match node.free.winding.fibre.law {
                actuator::FibreLaw::Linear => actuator::FibreLaw::TensionOnly,
                actuator::FibreLaw::TensionOnly => actuator::FibreLaw::Linear,
            }
        });
        change(&|node| node.free.elastomer = actuator::Elastomer::NeoHookean { shear_modulus: 0.393e6 });
        nodes
    }

    const PRESSURES: [&[f64]; 4] = [&[0.0, 2e4], &[0.0, 2e4 + 1e-9], &[0.0], &[0.0, 2e4, 4e4]];

    #[test]
    fn paths_of_sections_hang_on_free_pressures_mesh_and_extra_states() {
        let sweep = FreeSweep::default();
        let [node, ..] = nodes()[..] else { panic!() };
        let mut keys: Vec<_> = nodes().iter().map(|node| section(&sweep, node, PRESSURES[0])).collect();
        keys.extend(PRESSURES[1..].iter().map(|pressures| section(&sweep, &node, pressures)));
        for (radial, under_fibre, between_fibres, extra_states) in
            [(3, 2, 4, 24), (2, 1, 4, 24), (2, 2, 5, 24), (4, 2, 2, 24), (2, 2, 4, 25)]
        {
            let mesh = SectionMesh { radial, under_fibre, between_fibres };
            keys.push(section(&FreeSweep { mesh, extra_states, ..sweep }, &node, PRESSURES[0]));
        }
        for other in [
            FreeSweep { interpolation_tolerance: Some(2e-5), ..sweep },
            FreeSweep { interpolation_tolerance: None, ..sweep },
            FreeSweep { beyond_limit: Some(1.5), ..sweep },
            FreeSweep { beyond_limit: Some(1.2), ..sweep },
            FreeSweep { estimate_errors: false, ..sweep },
        ] {
            keys.push(section(&other, &node, PRESSURES[0]));
        }
        keys.push(solid(&SolidSweep::default(), &node, PRESSURES[0]));
        all_differ(&keys);
        // Neither the number of checks nor their places change a path.
        let other = FreeSweep { checks: 9, seed: 9, ..sweep };
        assert_eq!(section(&other, &node, PRESSURES[0]).unwrap(), *keys[0].as_ref().unwrap());
    }

    #[test]
    fn paths_between_caps_hang_on_solids_and_the_ends_of_the_moduli_as_well() {
        let sweep = CappedSweep::default();
        let [node, ..] = nodes()[..] else { panic!() };
        let moduli = [0.2e6, 0.4e6, 0.6e6];
        let usual = |sweep: &CappedSweep| capped(sweep, (&node, false), &moduli, PRESSURES[0]);
        let mut keys: Vec<_> =
            nodes().iter().map(|node| capped(&sweep, (node, false), &moduli, PRESSURES[0])).collect();
        keys.extend(
            PRESSURES[1..].iter().map(|pressures| capped(&sweep, (&node, false), &moduli, pressures)),
        );
        keys.push(capped(&sweep, (&node, true), &moduli, PRESSURES[0]));
        keys.push(capped(&sweep, (&node, false), &moduli[1..], PRESSURES[0]));
        keys.push(capped(&sweep, (&node, false), &moduli[..2], PRESSURES[0]));
        let mut other = sweep;
        other.solid.elements = Some([2, 24, 60]);
        keys.push(usual(&other));
        let mut other = sweep;
        other.section.extra_states += 1;
        keys.push(usual(&other));
        keys.push(section(&sweep.section, &node, PRESSURES[0]));
        all_differ(&keys);
        // Moduli between the ends, and what only the checks hang on, change nothing.
        let mut other = sweep;
        (other.section.checks, other.section.seed, other.solid.checks) = (9, 9, 9);
        let fewer = capped(&other, (&node, false), &[0.2e6, 0.6e6], PRESSURES[0]);
        assert_eq!(fewer.unwrap(), *keys[0].as_ref().unwrap());
    }

    #[test]
    fn paths_of_solids_hang_on_free_pressures_and_the_mesh_in_the_end() {
        let sweep = SolidSweep::default();
        let [node, ..] = nodes()[..] else { panic!() };
        let mut keys: Vec<_> = nodes().iter().map(|node| solid(&sweep, node, PRESSURES[0])).collect();
        keys.extend(PRESSURES[1..].iter().map(|pressures| solid(&sweep, &node, pressures)));
        let usual = SolidSweep::usual_mesh(&node.free);
        let usual = [usual.radial, usual.around, usual.along].map(|count| count as u32);
        let given = |elements| solid(&SolidSweep { elements: Some(elements), ..sweep }, &node, PRESSURES[0]);
        for place in 0..3 {
            let mut elements = usual;
            elements[place] += 1;
            keys.push(given(elements));
        }
        all_differ(&keys);
        // The same mesh gives the same path, whether it was asked for or chosen.
        assert_eq!(given(usual).unwrap(), *keys[0].as_ref().unwrap());
    }

    #[test]
    fn rows_of_modules_hang_on_module_axes_row_mesh_and_rods() {
        let sweep = ModuleSweep::default();
        let map = samples::smooth_module_map(1.0);
        let pressures: Vec<Vec<f64>> = (0..4).map(|node| map.node_pressures(node)).collect();
        let mut keys = vec![row(&sweep, &map, &pressures), row(&sweep, &map, &pressures[..1])];
        keys.push(row(&sweep, &map, &(4..8).map(|node| map.node_pressures(node)).collect::<Vec<_>>()));
        let mut with_map = |change: &dyn Fn(&mut ModuleMap)| {
            let mut other = map.clone();
            change(&mut other);
            keys.push(row(&sweep, &other, &pressures));
        };
        with_map(&|map| map.pressures[0][1] += 1e-6);
        with_map(&|map| map.pressures[3].truncate(2));
        with_map(&|map| map.module.spacers += 1);
        with_map(&|map| map.module.tip.payload += 1e-3);
        with_map(&|map| map.module.tip.plate_mass += 1e-3);
        with_map(&|map| map.module.tip.free_dof[5] = !map.module.tip.free_dof[5]);
        with_map(&|map| map.module.base.gravity[2] += 0.1);
        with_map(&|map| map.module.base.free_mass += 1e-3);
        with_map(&|map| map.module.frees[1].position[0] += 1e-4);
        with_map(&|map| map.module.frees[1].free.tube.wall += 1e-5);
        with_map(&|map| map.parameters.clear());
        let mut with_sweep = |change: &dyn Fn(&mut ModuleSweep)| {
            let mut other = sweep;
            change(&mut other);
            keys.push(row(&other, &map, &pressures));
        };
        with_sweep(&|sweep| sweep.mesh.radial += 1);
        with_sweep(&|sweep| sweep.rods.elements += 1);
        with_sweep(&|sweep| sweep.rods.bending_stiffness_scale *= 1.5);
        with_sweep(&|sweep| sweep.rods.tip_load.force[2] += 1.0);
        with_sweep(&|sweep| sweep.rods.tip_load.moment[2] += 1.0);
        for (planes, length, range) in [(6, 3.6, 0.04), (5, 3.0, 0.04), (5, 3.6, 0.03)] {
            let own = BendingSweep { planes, lengths: [length, 7.2], range: [range, 0.75] };
            with_sweep(&|sweep| sweep.bending = Some(own));
        }
        with_sweep(&|sweep| sweep.bending = None);
        for (planes, length, range) in [(6, 10.8, 0.04), (7, 10.0, 0.04), (7, 10.8, 0.03)] {
            with_sweep(&|sweep| sweep.caps = Some(CapSweep { planes, length, range: [range, 1.0] }));
        }
        with_sweep(&|sweep| sweep.caps = None);
        let solids = |elements, force| {
            let tip_load = TipLoad { force: [force, 0.0, 0.0], ..TipLoad::default() };
            Some(SolidModuleSettings { elements, tip_load, threads: 1 })
        };
        with_sweep(&|sweep| sweep.solids = solids(None, 0.0));
        with_sweep(&|sweep| sweep.solids = solids(Some([1, 12, 60]), 0.0));
        with_sweep(&|sweep| sweep.solids = solids(None, 0.1));
        all_differ(&keys);
        // Limits bound what a controller may ask for, checks what a fit is judged by: no state hangs on them.
        let mut other = map.clone();
        other.limits.pressure_max[0] *= 2.0;
        let checks = ModuleSweep { checks: 9, seed: 9, ..sweep };
        assert_eq!(row(&checks, &other, &pressures).unwrap(), *keys[0].as_ref().unwrap());
    }
}
