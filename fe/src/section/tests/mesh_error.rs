//! The estimate of the mesh's error against the error.

use super::*;
use actuator::FreePath;

fn path(free: &Free, mesh: SectionMesh, pressures: &[f64], estimate_errors: bool) -> FreePath {
    let request = PathRequest { pressures, estimate_errors, ..PathRequest::default() };
    solver(free, mesh).free_path(&request).unwrap()
}

fn variants() -> Vec<Free> {
    let with = |angle: f64, change: &dyn Fn(&mut Free)| {
        let mut free = free(angle);
        change(&mut free);
        free
    };
    let modulus =
        |value: f64| move |free: &mut Free| free.elastomer = free.elastomer.with_shear_modulus(value);
    vec![
        with(10.0, &modulus(0.8e6)),
        with(15.0, &modulus(0.3e6)),
        with(30.0, &|free| free.winding.fibre.diameter = 0.15e-3),
        with(40.0, &|free| free.winding.fibres = 12),
        with(55.0, &modulus(0.2e6)),
        with(70.0, &|free| free.tube.wall = 1.6e-3),
        tension_only(free(80.0)),
    ]
}

#[test]
fn the_estimate_bounds_the_error_against_a_mesh_four_times_as_fine() {
    let mesh = SectionMesh::default();
    let mut compared = 0;
    for free in variants() {
        let what = format!("{:.0} deg", free.winding.angle_from_hoop().to_degrees());
        let limit = path(&free, mesh, &[], false).limit_pressure().unwrap();
        let pressures = [0.15, 0.45, 0.75, 0.93].map(|share| share * limit);
        let (found, exact) =
            (path(&free, mesh, &pressures, true), path(&free, mesh.refined(4), &pressures, false));
        assert_eq!(found.states.len(), exact.states.len());
        let change = |q: usize| {
            let of = |state: &FreeState| (state.deformation()[q] - found.states[0].deformation()[q]).abs();
            found.states.iter().map(of).fold(0.0, f64::max)
        };
        for (state, exact) in found.states.iter().zip(&exact.states).skip(1) {
            let error = state.mesh_error.unwrap();
            let estimate = [error.axial_stretch, error.expansion, error.twist_per_length];
            for (q, estimate) in estimate.into_iter().enumerate() {
                let error = (state.deformation()[q] - exact.deformation()[q]).abs();
                // Less is the rounding of the fine mesh.
                if error > 1e-6 * change(q) {
                    compared += 1;
                    assert!(
                        estimate >= error,
                        "{what}, quantity {q}: {estimate:e} for {error:e} at {state:?}"
                    );
                }
                assert!(estimate < 2e-2 * change(q), "{what}, quantity {q}: {estimate:e} says nothing");
            }
        }
        let error = (limit - exact.limit_pressure().unwrap()).abs();
        let estimate = found.limit_error.unwrap();
        assert!(estimate >= error && estimate < 1e-2 * limit, "{what}: limit {estimate} Pa for {error} Pa");
    }
    assert!(compared > 60, "{compared}");
}

#[test]
fn there_is_no_estimate_where_none_was_asked_or_the_mesh_cannot_be_halved() {
    for (mesh, asked) in [(SectionMesh::default(), false), (COARSE, true)] {
        let path = path(&free(30.0), mesh, &[20e3], asked);
        assert!(path.limit_error.is_none() && path.states.iter().all(|state| state.mesh_error.is_none()));
    }
}

#[test]
fn a_path_without_limit_has_errors_of_its_states_only() {
    let mut free = free(70.0);
    free.elastomer = Elastomer::NeoHookean { shear_modulus: 0.393e6 };
    let path = path(&free, SectionMesh::default(), &[20e3, 500e3], true);
    assert_eq!((path.end, path.limit_error), (PathEnd::Range, None));
    // The end is where the tube has grown threefold, on each mesh at its own pressure.
    assert!(path.states[1].mesh_error.unwrap().expansion > 0.0);
}
