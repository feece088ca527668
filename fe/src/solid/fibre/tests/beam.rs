use super::*;
use nalgebra::{DMatrix, DVector, Rotation3};
use std::f64::consts::PI;

const DIAMETER: f64 = 0.3e-3;
const BENDING: f64 = STIFFNESS * DIAMETER * DIAMETER / 16.0;
const TORSION: f64 = BENDING / 1.3;

fn beams(specimen: &Specimen, mesh: SolidMesh) -> (Grid, Fibres) {
    let grid = grid(specimen, mesh);
    let fibres = Fibres::beams(specimen, &grid).unwrap();
    (grid, fibres)
}

fn energy(fibres: &Fibres, positions: &[[f64; 3]], rotations: &[UnitQuaternion<f64>]) -> f64 {
    fibres.elements.iter().map(|element| element.energy(positions, rotations).unwrap()).sum()
}

fn increment(block: usize, amount: f64) -> [f64; 3] {
    let x = block as f64;
    [(1.3 * x).sin(), (2.1 * x + 1.0).sin(), (0.7 * x + 2.0).sin()].map(|part| amount * part)
}

/// A state far from rest.
fn shaken(grid: &Grid, fibres: &Fibres) -> (Vec<[f64; 3]>, Vec<UnitQuaternion<f64>>) {
    let mut positions = moved(grid, 1.05, 20.0, 1.05);
    for (point, place) in positions.iter_mut().enumerate() {
        let shift = increment(point, 1e-4);
        place.iter_mut().zip(shift).for_each(|(x, d)| *x += d);
    }
    let turned =
        fibres.rotations.iter().enumerate().map(|(node, r)| Fibres::moved(r, increment(node, 0.2))).collect();
    (positions, turned)
}

/// Along lines, across them, and with images of nodes in the next sector; trusses and threads.
fn cases() -> Vec<(Grid, Fibres)> {
    let mut cases = vec![];
    for law in [FibreLaw::Linear, FibreLaw::TensionOnly] {
        let mut right = winding(40.0, Handedness::Right, 6, DIAMETER);
        right.fibre.law = law;
        let left = winding(55.0, Handedness::Left, 4, DIAMETER);
        cases.push(beams(&specimen(&[right, left]), mesh(12, 6, true)));
        let alone = specimen(&[right]);
        let sector = Grid::new(&alone, mesh(12, 6, false), 6).unwrap();
        let fibres = Fibres::beams(&alone, &sector).unwrap();
        cases.push((sector, fibres));
    }
    cases
}

#[test]
fn gradient_and_tangent_are_derivatives_of_the_energy() {
    for (grid, fibres) in cases() {
        let (positions, rotations) = shaken(&grid, &fibres);
        for element in fibres.elements.iter().step_by(7) {
            let unknowns = 3 * element.blocks().len();
            // One length for both kinds of unknowns: 1 mm of shift and 1 rad of turn.
            let unit = |unknown: usize| match element.blocks()[unknown / 3] {
                Block::Point(_) => 1e-3,
                Block::Rotation(_) => 1.0,
            };
            let evaluated = |unknown: usize, step: f64| {
                let (mut positions, mut rotations) = (positions.clone(), rotations.clone());
                let mut along = [0.0; 3];
                along[unknown % 3] = step * unit(unknown);
                match element.blocks()[unknown / 3] {
                    Block::Point(point) => positions[point as usize][unknown % 3] += along[unknown % 3],
                    Block::Rotation(node) => {
                        rotations[node as usize] = Fibres::moved(&rotations[node as usize], along);
                    }
                }
                let (mut gradient, mut tangent) = ([f64::NAN; MAX_UNKNOWNS], [f64::NAN; MAX_UNKNOWNS.pow(2)]);
                let energy = element.evaluate(&positions, &rotations, &mut gradient, &mut tangent).unwrap();
                assert!((energy - element.energy(&positions, &rotations).unwrap()).abs() <= 1e-13 * energy);
                (energy, gradient, tangent)
            };
            let (_, gradient, tangent) = evaluated(0, 0.0);
            let entry =
                |row: usize, column: usize| unit(row) * unit(column) * tangent[column * unknowns + row];
            let pull = |unknown: usize| unit(unknown) * gradient[unknown];
            let largest = (0..unknowns).fold(0.0_f64, |max, i| max.max(entry(i, i).abs()));
            let h = 1e-4;
            // Second differences of the energy by all pairs of unknowns: exact for the Hessian in these increments.
            for i in 0..unknowns {
                let (plus, minus) = (evaluated(i, h), evaluated(i, -h));
                let slope = (plus.0 - minus.0) / (2.0 * h);
                assert!((slope - pull(i)).abs() < 1e-6 * largest, "{slope} {}", pull(i));
                let centre = element.energy(&positions, &rotations).unwrap();
                let curvature = (plus.0 - 2.0 * centre + minus.0) / (h * h);
                assert!((curvature - entry(i, i)).abs() < 1e-5 * largest, "{i}: {curvature} {}", entry(i, i));
                for j in 0..unknowns {
                    assert!((entry(i, j) - entry(j, i)).abs() < 1e-12 * largest);
                    // Increments of different blocks commute; so do those of a position.
                    let same_rotation = i / 3 == j / 3 && unit(i) == 1.0;
                    let slope = unit(j) * (plus.1[j] - minus.1[j]) / (2.0 * h);
                    if !same_rotation {
                        assert!((slope - entry(j, i)).abs() < 1e-6 * largest, "{i} {j} {slope}");
                    }
                }
            }
        }
    }
}

/// Three unknowns at once: the Hessian by a node's rotation is symmetric, that of E(R exp w), unlike the change of its gradient.
#[test]
fn rotations_of_one_node_have_the_hessian_of_the_exponential() {
    for (grid, fibres) in cases() {
        let (positions, rotations) = shaken(&grid, &fibres);
        for element in fibres.elements.iter().step_by(7) {
            let unknowns = 3 * element.blocks().len();
            let (mut gradient, mut tangent) = ([0.0; MAX_UNKNOWNS], [0.0; MAX_UNKNOWNS.pow(2)]);
            element.evaluate(&positions, &rotations, &mut gradient, &mut tangent).unwrap();
            for (place, block) in element.blocks().iter().enumerate() {
                let Block::Rotation(node) = block else { continue };
                let at = |w: [f64; 3]| {
                    let mut turned = rotations.clone();
                    turned[*node as usize] = Fibres::moved(&turned[*node as usize], w);
                    element.energy(&positions, &turned).unwrap()
                };
                let w = [0.6, -0.5, 0.62];
                let h = 1e-3;
                let second = (at(w.map(|x| h * x)) - 2.0 * at([0.0; 3]) + at(w.map(|x| -h * x))) / (h * h);
                let entry = |i: usize, j: usize| tangent[(3 * place + j) * unknowns + 3 * place + i];
                let hessian: f64 = (0..9).map(|ij| w[ij / 3] * w[ij % 3] * entry(ij / 3, ij % 3)).sum();
                let scale = (0..3).map(|i| entry(i, i).abs()).sum::<f64>();
                assert!((second - hessian).abs() < 1e-5 * scale, "{second} {hessian}");
            }
        }
    }
}

#[test]
fn a_rigid_motion_costs_nothing_and_changes_nothing() {
    let turn = UnitQuaternion::from_scaled_axis(Vector3::new(2.0, -1.0, 1.5));
    let carried = |positions: &[[f64; 3]]| -> Vec<[f64; 3]> {
        let shift = Vector3::new(0.02, 0.01, -0.03);
        positions.iter().map(|x| (turn * Vector3::from(*x) + shift).into()).collect()
    };
    for (grid, fibres) in cases() {
        if grid.sectors > 1 {
            // A sector turns about the tube's axis only: its neighbours are its images.
            continue;
        }
        let turned = |rotations: &[UnitQuaternion<f64>]| -> Vec<_> {
            rotations.iter().map(|rotation| turn * rotation).collect()
        };
        let rest = energy(&fibres, &grid.points, &fibres.rotations);
        assert!(rest.abs() < 1e-25, "{rest}");
        let moved = energy(&fibres, &carried(&grid.points), &turned(&fibres.rotations));
        // Strains of rounding, 1e-13: squared, times 644 N times a metre of fibre.
        assert!(moved.abs() < 1e-20, "{moved}");
        let (positions, rotations) = shaken(&grid, &fibres);
        let before = energy(&fibres, &positions, &rotations);
        let after = energy(&fibres, &carried(&positions), &turned(&rotations));
        assert!(before > 0.0 && (after / before - 1.0).abs() < 1e-10, "{before} {after}");
    }
}

/// A straight fibre at angle 0 of the tube, its elements, and its nodes' heights.
fn straight(along: usize, diameter: f64) -> (Grid, Vec<FibreElement>, Fibres) {
    let specimen = specimen(&[winding(90.0, Handedness::Right, 6, diameter)]);
    let (grid, fibres) = beams(&specimen, mesh(12, along, true));
    let elements = fibres.elements[..2 * along].to_vec();
    (grid, elements, fibres)
}

/// Energy of the straight fibre with its points and frames where `place` sends those at its height.
fn straight_energy(place: impl Fn(f64) -> ([f64; 3], UnitQuaternion<f64>)) -> f64 {
    let (grid, elements, fibres) = straight(5, DIAMETER);
    let outer = 2 * grid.through_tube;
    let mut positions = grid.points.clone();
    for plane in 0..grid.lines[2] {
        let point = grid.point(outer, 0, plane) as usize;
        positions[point] = place(grid.points[point][2]).0;
    }
    let turned =
        |(node, rotation): (usize, &UnitQuaternion<f64>)| place(LENGTH * node as f64 / 10.0).1 * rotation;
    let rotations: Vec<_> = fibres.rotations.iter().enumerate().map(turned).collect();
    elements.iter().map(|element| element.energy(&positions, &rotations).unwrap()).sum()
}

#[test]
fn a_straight_fibre_stretched_sheared_twisted_and_bent_has_the_energy_of_its_section() {
    let outer = 5.56e-3;
    let still = UnitQuaternion::identity();
    let close = |found: f64, exact: f64| assert!((found / exact - 1.0).abs() < 1e-9, "{found} {exact}");
    close(straight_energy(|z| ([outer, 0.0, 1.02 * z], still)), 0.5 * STIFFNESS * 0.02_f64.powi(2) * LENGTH);
    // Cowper's factor at a ratio of 0.3.
    let shear = 0.886_363_636_363_636_4 * STIFFNESS / 2.6;
    close(straight_energy(|z| ([outer, 0.1 * z, z], still)), 0.5 * shear * 0.01 * LENGTH);
    let rate = 50.0;
    let twisted = |z: f64| ([outer, 0.0, z], UnitQuaternion::from_axis_angle(&Vector3::z_axis(), rate * z));
    close(straight_energy(twisted), 0.5 * TORSION * rate * rate * LENGTH);
    // To an arc of more than half a circle, about the y axis and about the x axis.
    let curvature = 70.0;
    let (sine, cosine) = (|z: f64| (curvature * z).sin(), |z: f64| (curvature * z).cos());
    let bent = |z: f64| {
        let place = [outer + (1.0 - cosine(z)) / curvature, 0.0, sine(z) / curvature];
        (place, UnitQuaternion::from_axis_angle(&Vector3::y_axis(), curvature * z))
    };
    close(straight_energy(bent), 0.5 * BENDING * curvature * curvature * LENGTH);
    let bent = |z: f64| {
        let place = [outer, -(1.0 - cosine(z)) / curvature, sine(z) / curvature];
        (place, UnitQuaternion::from_axis_angle(&Vector3::x_axis(), curvature * z))
    };
    close(straight_energy(bent), 0.5 * BENDING * curvature * curvature * LENGTH);
}

/// A helix of given turn (rad/m) and radius, by its curvature and torsion.
fn curvature_and_torsion(turn: f64, radius: f64) -> [f64; 2] {
    let square = 1.0 + (turn * radius).powi(2);
    [turn * turn * radius / square, turn / square]
}

#[test]
fn a_helix_that_becomes_another_has_the_energy_of_the_change() {
    let (stretch, twist, widening) = (1.1, -40.0, 1.06);
    let family = winding(35.0, Handedness::Right, 6, DIAMETER);
    let specimen = specimen(&[family]);
    let radius = specimen.tube.outer_radius();
    let before = family.turn_per_length(radius);
    let after = (before + twist) / stretch;
    let lambda = ((radius * widening * (before + twist)).powi(2) + stretch * stretch).sqrt()
        / ((radius * before).powi(2) + 1.0).sqrt();
    let [curved, wound] = curvature_and_torsion(before, radius);
    let [curved_after, wound_after] = curvature_and_torsion(after, radius * widening);
    let exact = 3.0
        * (LENGTH / family.angle_from_hoop().sin())
        * (STIFFNESS * (lambda - 1.0).powi(2)
            + BENDING * (lambda * curved_after - curved).powi(2)
            + TORSION * (lambda * wound_after - wound).powi(2));
    for (follows, sectors) in [(true, 1), (true, 6), (false, 1), (false, 6)] {
        let errors = [12, 24, 48].map(|size| {
            let grid = Grid::new(&specimen, mesh(size, size, follows), sectors).unwrap();
            let fibres = Fibres::beams(&specimen, &grid).unwrap();
            let positions = moved(&grid, stretch, twist, widening);
            // Frames of the helix through each node, from where the surface has it.
            let mut rotations = fibres.rotations.clone();
            for element in &fibres.elements {
                let FibreElement::Beam(beam) = element else { continue };
                for (node, place) in beam.node_places(&positions) {
                    rotations[node] = super::super::beam::helix_frame(place.into(), after, 0.0);
                }
            }
            (energy(&fibres, &positions, &rotations) * sectors as f64 / exact - 1.0).abs()
        });
        if follows {
            // Constant strain: exact, whatever the mesh.
            assert!(errors.iter().all(|error| *error < 1e-9), "{errors:?}");
        } else {
            assert!(0.5 * (errors[0] / errors[2]).log2() > 1.8, "{errors:?}");
        }
    }
}

/// Straight fibre with its points moved sideways by a (1 - cos kz), its ends' rotations held: its rotations find the angle theta of
/// Timoshenko's beam, EI theta'' + GA (w' - theta) = 0.
#[test]
fn free_rotations_find_the_bending_of_a_wave_to_second_order() {
    let diameter = 4e-3;
    let (bending, shear) =
        (STIFFNESS * diameter * diameter / 16.0, 0.886_363_636_363_636_4 * STIFFNESS / 2.6);
    let wave = 2.0 * PI / LENGTH;
    let amplitude = 1e-6;
    let angle = shear * amplitude * wave / (bending * wave * wave + shear);
    let exact =
        0.25 * LENGTH * (bending * (wave * angle).powi(2) + shear * (amplitude * wave - angle).powi(2));
    let errors = [4, 8, 16].map(|along| {
        let (grid, elements, fibres) = straight(along, diameter);
        let mut positions = grid.points.clone();
        for plane in 0..grid.lines[2] {
            let point = grid.point(2 * grid.through_tube, 0, plane) as usize;
            positions[point][1] += amplitude * (1.0 - (wave * positions[point][2]).cos());
        }
        let nodes = 2 * along + 1;
        let mut rotations = fibres.rotations.clone();
        // Newton's method from rest; the problem is all but linear for so small a wave.
        for _ in 0..2 {
            let mut residual = DVector::zeros(3 * nodes);
            let mut stiffness = DMatrix::<f64>::zeros(3 * nodes, 3 * nodes);
            for element in &elements {
                let unknowns = 3 * element.blocks().len();
                let (mut gradient, mut tangent) = ([0.0; MAX_UNKNOWNS], [0.0; MAX_UNKNOWNS.pow(2)]);
                element.evaluate(&positions, &rotations, &mut gradient, &mut tangent).unwrap();
                let places: Vec<Option<usize>> = (0..unknowns)
                    .map(|i| match element.blocks()[i / 3] {
                        Block::Rotation(node) => Some(3 * node as usize + i % 3),
                        Block::Point(_) => None,
                    })
                    .collect();
                for (i, row) in places.iter().enumerate() {
                    let Some(row) = row else { continue };
                    residual[*row] += gradient[i];
                    for (j, column) in places.iter().enumerate() {
                        let Some(column) = column else { continue };
                        stiffness[(*row, *column)] += tangent[j * unknowns + i];
                    }
                }
            }
            let inner = 3 * (nodes - 2);
            let step = stiffness
                .view((3, 3), (inner, inner))
                .clone_owned()
                .cholesky()
                .unwrap()
                .solve(&residual.rows(3, inner).into_owned());
            for (rotation, w) in rotations[1..nodes - 1].iter_mut().zip(step.as_slice().chunks(3)) {
                *rotation = Fibres::moved(rotation, [-w[0], -w[1], -w[2]]);
            }
        }
        let found: f64 = elements.iter().map(|e| e.energy(&positions, &rotations).unwrap()).sum();
        (found / exact - 1.0).abs()
    });
    assert!(orders(&errors).iter().all(|order| (order - 2.0).abs() < 0.2), "{errors:?}");
}

#[test]
fn a_slack_thread_bends_all_the_same() {
    let mut thread = winding(90.0, Handedness::Right, 6, DIAMETER);
    let energies = [FibreLaw::Linear, FibreLaw::TensionOnly].map(|law| {
        thread.fibre.law = law;
        let (grid, fibres) = beams(&specimen(&[thread]), mesh(12, 4, true));
        let short = moved(&grid, 0.98, 0.0, 1.0);
        let turned: Vec<_> = fibres
            .rotations
            .iter()
            .enumerate()
            .map(|(node, r)| Fibres::moved(r, [0.0, 0.0, 0.01 * (node % 9) as f64]))
            .collect();
        let states: Vec<FibreState> =
            fibres.elements.iter().flat_map(|element| element.states(&short, &fibres.rotations)).collect();
        let tension = if law == FibreLaw::Linear { -0.02 * STIFFNESS } else { 0.0 };
        assert!(
            states.iter().all(|s| (s.tension - tension).abs() < 1e-9 && (s.stretch - 0.98).abs() < 1e-12)
        );
        energy(&fibres, &short, &turned)
    });
    let axial = 6.0 * 0.5 * STIFFNESS * 0.02_f64.powi(2) * LENGTH;
    assert!(energies[1] > 0.0 && ((energies[0] - energies[1]) / axial - 1.0).abs() < 1e-9, "{energies:?}");
}

#[test]
fn frames_run_along_the_fibre_on_a_tapered_tube() {
    let mut specimen = specimen(&[winding(60.0, Handedness::Left, 6, DIAMETER)]);
    specimen.wall_taper = 3.0;
    for follows in [true, false] {
        let (grid, fibres) = beams(&specimen, mesh(48, 60, follows));
        for element in &fibres.elements {
            let FibreElement::Beam(beam) = element else { continue };
            let [(a, from), (b, to)] = beam.node_places(&grid.points);
            let along = fibres.rotations[a] * Vector3::z() + fibres.rotations[b] * Vector3::z();
            // Second order in the turn over an element, 0.04 rad; without the taper the radius would not grow by 0.03 of the height.
            let chord = (to - from).normalize();
            assert!((along.normalize() - chord).norm() < 2e-3, "{along} {chord}");
        }
    }
}

#[test]
fn a_fibre_without_diameter_is_no_beam() {
    let specimen = specimen(&[winding(30.0, Handedness::Right, 6, 0.0)]);
    let grid = grid(&specimen, mesh(12, 6, true));
    assert!(Fibres::beams(&specimen, &grid).unwrap_err().to_string().contains("bending stiffness"));
    let frame = Rotation3::from(super::super::beam::helix_frame([0.0, 2.0, 0.0], 0.5, 0.0));
    // Outwards is y; the fibre runs towards -x and z alike.
    assert!((frame * Vector3::x() - Vector3::y()).norm() < 1e-15);
    assert!((frame * Vector3::z() - Vector3::new(-1.0, 0.0, 1.0).normalize()).norm() < 1e-15);
}
