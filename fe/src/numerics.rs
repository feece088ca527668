/// Version of the numerics: two programs of the same number compute the same states from the same settings, but for rounding.
///
/// To be raised by one with every change after which a sweep gives other states or other numbers about them: points that were kept
/// from before are then computed anew.
pub const NUMERICS: u32 = 6;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FreeSweep, ModuleSweep, Run, SectionMesh, Shard, SolidSweep, section::tests::free};
    use actuator::{Base, FreePath, Limits, LoadedFree, MapAxis, Module, PlacedFree, Tip};
    use std::sync::atomic::AtomicBool;

    const PRESSURE: f64 = 3e4;

    /// The state at the pressure asked for in numbers, and how many other things are told about it and its path.
    fn numbers(path: &FreePath) -> (Vec<f64>, usize) {
        let state = path.states.iter().find(|state| (state.pressure - PRESSURE).abs() < 1e-6).unwrap();
        let middle = state.middle.iter().flat_map(|m| [m.axial_stretch, m.twist_per_length]);
        let more = [state.section.is_some(), state.mesh_error.is_some(), path.limit_error.is_some()];
        let more = more.into_iter().filter(|there| *there).count() + path.beyond.len();
        (state.deformation().into_iter().chain(middle).collect(), more)
    }

    #[test]
    fn the_version_stands_for_these_numbers() {
        let run = Run { jobs: 1, progress: &|_, _| (), stop: &AtomicBool::new(false) };
        let node: LoadedFree = free(30.0).into();
        let axes = MapAxis::of_angles_and_moduli(vec![40f64.to_radians()], vec![0.4e6]);
        let mesh = SectionMesh { radial: 2, under_fibre: 2, between_fibres: 2 };

        let section =
            FreeSweep { mesh, extra_states: 3, checks: 0, beyond_limit: Some(1.2), ..FreeSweep::default() };
        let mut map = section.empty_map(node, axes.clone(), vec![0.0, PRESSURE], Default::default()).unwrap();
        section.fill(&mut map, Shard::WHOLE, &run, &mut |_, _| ()).unwrap();
        let (section, section_more) = numbers(map.paths[0].as_ref().unwrap());

        let solid = SolidSweep { elements: Some([1, 12, 10]), checks: 0, seed: 1 };
        let mut map = solid.empty_map(node, axes, vec![0.0, PRESSURE], Default::default()).unwrap();
        solid.fill(&mut map, Shard::WHOLE, &run, &mut |_, _| ()).unwrap();
        let (solid, solid_more) = numbers(map.paths[0].as_ref().unwrap());

        let module = Module {
            frees: vec![PlacedFree { free: node.free, position: [5e-3, 0.0] }],
            tip: Tip { plate_mass: 5e-3, payload: 0.0, free_dof: [true; 6] },
            base: Base { gravity: [0.0, 0.0, 1.0], free_mass: 0.0 },
            spacers: 0,
        };
        let limits = Limits { pressure_max: vec![2e4], pressure_rate: 2e5, idle_pressure: 0.0 };
        let rods = ModuleSweep { mesh, checks: 0, ..ModuleSweep::default() };
        let mut map =
            rods.empty_map(module, limits, vec![vec![0.0, 1.3e4, 2e4]], Default::default()).unwrap();
        rods.fill(&mut map, Shard::WHOLE, &run, &mut |_, _| ()).unwrap();
        let state = map.states[1].as_ref().unwrap();
        let module = state.chart.to_array().to_vec();

        let known: [&[f64]; 3] = [
            &[0.9999138219787868, 1.1121636961824848, -20.4649684253835],
            &[
                0.9988242855567211,
                1.0908322543928235,
                -17.794254541898308,
                0.998385798763099,
                -18.440322699673594,
            ],
            &[
                -1.253600941091084,
                0.026923534827845697,
                0.0371756140739103,
                0.0021012932127766264,
                0.004321775374747632,
                0.13118191618448583,
            ],
        ];
        // Far below any change of the numerics, above what another processor rounds otherwise.
        let same = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-7 * b.abs().max(1e-2);
        for (numbers, known) in [&section, &solid, &module].into_iter().zip(known) {
            assert!(
                numbers.len() == known.len() && numbers.iter().zip(known).all(same),
                "other numbers than those of version {NUMERICS}: raise it, and write here {section:?}, {solid:?}, {module:?}"
            );
        }
        let more = (section_more, solid_more, state.slopes.len());
        assert_eq!(
            more,
            (7, 0, 3),
            "more or less is told about states: raise the version {NUMERICS}, and write here {more:?}"
        );
    }
}
