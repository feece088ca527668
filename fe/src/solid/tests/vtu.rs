use crate::solid::{
    Specimen,
    body::Body,
    mesh::SolidMesh,
    newton::SolidSolver,
    state::SolidState,
    vtu::{VTK_ORDER, fibres, rubber},
    wall,
};
use crate::vtk::{UnstructuredGrid, Values};
use actuator::{Elastomer, Fibre, FibreLaw, Free, Handedness, Tube, Winding};
use nalgebra::{Matrix3, Rotation3, Vector3};

const MODULUS: f64 = 0.4e6;

fn specimen(diameter: f64) -> Specimen {
    let fibre = Fibre { axial_stiffness: 644.0, diameter, law: FibreLaw::Linear };
    Specimen::from(&Free {
        tube: Tube { length: 0.02, inner_radius: 4.76e-3, wall: 0.8e-3 },
        winding: Winding::from_hoop(0.6, Handedness::Right, 3, fibre),
        elastomer: Elastomer::NeoHookean { shear_modulus: MODULUS },
    })
}

fn moved(body: &Body, to: impl Fn(Vector3<f64>) -> Vector3<f64>) -> SolidState {
    let mut state = body.rest();
    state.positions.iter_mut().for_each(|at| *at = to(Vector3::from(*at)).into());
    state
}

fn numbers(grid: &UnstructuredGrid, name: &str) -> Vec<f64> {
    let arrays = grid.point_data.iter().chain(&grid.cell_data).chain(&grid.field_data);
    let array = arrays.into_iter().find(|array| array.name == name).expect(name);
    match &array.values {
        Values::F64(values) => values.clone(),
        Values::F32(values) => values.iter().map(|&x| f64::from(x)).collect(),
        Values::I64(values) => values.iter().map(|&x| x as f64).collect(),
        Values::U8(values) => values.iter().map(|&x| f64::from(x)).collect(),
    }
}

#[test]
fn nodes_stand_in_the_order_of_vtk() {
    // vtkTriQuadraticHexahedron: corners of edges 8 to 19 and of faces 20 to 25.
    const EDGES: [[usize; 2]; 12] =
        [[0, 1], [1, 2], [3, 2], [0, 3], [4, 5], [5, 6], [7, 6], [4, 7], [0, 4], [1, 5], [2, 6], [3, 7]];
    const FACES: [[usize; 4]; 6] =
        [[0, 4, 7, 3], [1, 2, 6, 5], [0, 1, 5, 4], [3, 7, 6, 2], [0, 3, 2, 1], [4, 5, 6, 7]];
    let at = |vtk: usize| {
        let a = VTK_ORDER[vtk];
        Vector3::new(a % 3, a / 3 % 3, a / 9).map(|place| place as f64)
    };
    let mean = |of: &[usize]| of.iter().map(|&vtk| at(vtk)).sum::<Vector3<f64>>() / of.len() as f64;
    for (edge, ends) in EDGES.iter().enumerate() {
        assert_eq!(at(8 + edge), mean(ends), "edge {edge}");
    }
    for (face, corners) in FACES.iter().enumerate() {
        assert_eq!(at(20 + face), mean(corners), "face {face}");
    }
    assert_eq!(at(26), mean(&[0, 1, 2, 3, 4, 5, 6, 7]));
    let box_volume = (at(1) - at(0)).cross(&(at(3) - at(0))).dot(&(at(4) - at(0)));
    assert_eq!(box_volume, 8.0);
}

#[test]
fn a_homogeneous_deformation_has_its_strain_and_stress_everywhere() {
    let mesh = SolidMesh { radial: 2, ..SolidMesh::new(6, 2) };
    let body = Body::new(&specimen(0.0), mesh, 1).unwrap();
    let stretches = [1.3f64, 0.9, 1.0 / (1.3 * 0.9)];
    let (before, after) =
        (Rotation3::from_euler_angles(0.4, -0.8, 0.3), Rotation3::from_euler_angles(1.0, 0.2, -2.0));
    let f = after.matrix() * Matrix3::from_diagonal(&stretches.into()) * before.matrix();
    let mut state = moved(&body, |at| f * at);
    let pressure = 0.1e6;
    state.pressures.iter_mut().for_each(|q| q[0] = -pressure);
    let grid = rubber(&body, &state, &[]).unwrap();
    let mut sorted = stretches;
    sorted.sort_by(|a, b| b.total_cmp(a));
    let mean = sorted.iter().map(|l| l * l).sum::<f64>() / 3.0;
    // Incompressible: sigma = mu (b - tr b/3) + q.
    let stress = sorted.map(|l| 1e-6 * (MODULUS * (l * l - mean) - pressure));
    let check = |name: &str, expected: &[f64]| {
        for value in numbers(&grid, name).chunks_exact(expected.len()) {
            for (value, expected) in value.iter().zip(expected) {
                // Written in single precision.
                assert!((value - expected).abs() < 1e-6, "{name}: {value} for {expected}");
            }
        }
    };
    check("principal_stretch", &sorted);
    check("principal_log_strain", &sorted.map(f64::ln));
    check("principal_cauchy_stress_mpa", &stress);
    check("pressure_in_rubber_mpa", &[1e-6 * pressure]);
    let von_mises = (stress[0].powi(2) + stress[1].powi(2) + stress[2].powi(2)
        - stress[0] * stress[1]
        - stress[1] * stress[2]
        - stress[2] * stress[0])
        .sqrt();
    check("von_mises_stress_mpa", &[von_mises]);
    let volume: f64 = wall::points(&body, &state).iter().map(|point| 1e9 * point.weight).sum();
    assert!((numbers(&grid, "rubber_volume_mm3")[0] / volume - 1.0).abs() < 1e-12);
}

#[test]
fn a_sector_is_written_as_the_whole_tube() {
    for (follows_fibres, diameter) in [(true, 0.0), (true, 0.5e-3), (false, 0.0)] {
        let mesh = SolidMesh { follows_fibres, ..SolidMesh::new(12, 4) };
        let specimen = specimen(diameter);
        // Swells, turns and stretches, no two planes alike.
        let deform = |at: Vector3<f64>| {
            let swell = 1.0 + 4.0 * at.z;
            let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), 60.0 * at.z);
            turn * Vector3::new(swell * at.x, swell * at.y, 1.2 * at.z)
        };
        let mut grids = [1, 3].map(|sectors| {
            let body = Body::new(&specimen, mesh, sectors).unwrap();
            let state = moved(&body, deform);
            let field: Vec<[f64; 3]> = state.positions.iter().map(|at| [-at[1], at[0], 7.0]).collect();
            [rubber(&body, &state, &[("mode", &field)]).unwrap(), fibres(&body, &state).unwrap()]
        });
        let [whole, sector] = &mut grids;
        for (whole, sector) in whole.iter().zip(sector) {
            assert_eq!(whole.connectivity, sector.connectivity);
            for (a, b) in whole.points.as_flattened().iter().zip(sector.points.as_flattened()) {
                assert!((a - b).abs() < 1e-9, "point {a} for {b}, {follows_fibres}, {diameter}");
            }
            let names = |grid: &UnstructuredGrid| {
                grid.point_data
                    .iter()
                    .chain(&grid.cell_data)
                    .map(|array| array.name.clone())
                    .collect::<Vec<_>>()
            };
            assert_eq!(names(whole), names(sector));
            for name in names(whole) {
                let (a, b) = (numbers(whole, &name), numbers(sector, &name));
                assert_eq!(a.len(), b.len());
                for (a, b) in a.iter().zip(b) {
                    assert!((a - b).abs() <= 1e-6 * (1.0 + a.abs()), "{name}: {b} for {a}, {follows_fibres}");
                }
            }
        }
    }
}

#[test]
fn fibres_lie_on_the_surface_and_carry_its_stretch() {
    let stretch = 1.1;
    for (follows_fibres, diameter) in [(true, 0.0), (true, 0.5e-3), (false, 0.0)] {
        let mesh = SolidMesh { follows_fibres, ..SolidMesh::new(24, 8) };
        let body = Body::new(&specimen(diameter), mesh, 1).unwrap();
        let grid = fibres(&body, &moved(&body, |at| stretch * at)).unwrap();
        assert_eq!(grid.connectivity.len(), 2 * 3 * (2 * 8 - 1));
        for at in &grid.points {
            let radius = at[0].hypot(at[1]);
            // A chord's sagitta at most where a point is an average.
            assert!((radius / (1e3 * stretch * 5.56e-3) - 1.0).abs() < 0.02, "{radius}");
        }
        for (stretched, tension) in numbers(&grid, "stretch").iter().zip(numbers(&grid, "tension_n")) {
            assert!((stretched - stretch).abs() < 1e-9, "{stretched}");
            assert!((tension - 644.0 * (stretch - 1.0)).abs() < 1e-6, "{tension}");
        }
        let fibre = numbers(&grid, "fibre");
        assert!(fibre.first() == Some(&0.0) && fibre.last() == Some(&2.0), "{fibre:?}");
    }
}

#[test]
fn strains_are_found_where_they_are() {
    // Along straight lines of the mesh every cross-section has the same area.
    let mesh = SolidMesh { follows_fibres: false, ..SolidMesh::new(6, 5) };
    let solver = SolidSolver::new(&specimen(0.0), mesh).unwrap();
    // Stretches along by 1 + 10 z/m: most at the tip.
    let state = moved(&solver.body, |at| Vector3::new(at.x, at.y, at.z + 5.0 * at.z * at.z));
    let strains = solver.strains(&state);
    for found in [strains.greatest, strains.greatest_mid] {
        assert!((found.log_strain - (10.0 * found.reference[2]).ln_1p()).abs() < 1e-12, "{found:?}");
        let z = found.reference[2];
        assert!((found.position[2] - z - 5.0 * z * z).abs() < 1e-15, "{found:?}");
    }
    // The last Gauss points lie 11.3 % of an element before its end.
    assert!((strains.greatest.reference[2] - 0.02 * (1.0 - 0.1127 / 5.0)).abs() < 1e-6, "{strains:?}");
    assert!((strains.greatest_mid.reference[2] - 0.02 * (0.6 - 0.1127 / 5.0)).abs() < 1e-6, "{strains:?}");
    assert!(strains.least.log_strain.abs() < 1e-12 && strains.least_mid.log_strain.abs() < 1e-12);
    // Average of ln(1 + 10 z) over 0.008 to 0.012, by its second derivative at the middle: right to 6e-9.
    let expected = 0.1f64.ln_1p() - 0.5 * (10.0 / 1.1f64).powi(2) * 0.004f64.powi(2) / 12.0;
    assert!((strains.mean_mid[0] - expected).abs() < 1e-8, "{strains:?} {expected}");
}

#[test]
fn a_field_of_another_length_is_refused() {
    let solver = SolidSolver::new(&specimen(0.0), SolidMesh::new(6, 2)).unwrap();
    let error = solver.write_vtu(&solver.rest(), &[("mode", &[[0.0; 3]])], &mut vec![]).unwrap_err();
    assert!(error.to_string().contains("mode has 1 values for"), "{error}");
}
