//! Rods whose sections couple bending and shear, against the linearisation by hand and against the solid.

use super::*;
use crate::{
    BendingLaw, BendingSweep, ConstantBending, RodCompliance, Run, SectionLaw, SectionMesh, SectionResponse,
    SectionSolver, SolidLoad, SolidMesh, SolidSolver, SolvedSection, Specimen, StraightRod,
};
use actuator::{
    Base, Elastomer, Fibre, FibreLaw, Free, Handedness, Module, OgdenForm, PlacedFree, Tip, Tube, Winding,
};
use nalgebra::{Complex, Matrix2, Vector3};
use std::sync::{Arc, atomic::AtomicBool};

fn free(angle_deg: f64, length: f64) -> Free {
    let fibre = Fibre { axial_stiffness: 644.0, diameter: 0.15e-3, law: FibreLaw::Linear };
    Free {
        tube: Tube { length, inner_radius: 4.76e-3, wall: 0.8e-3 },
        winding: Winding::from_hoop(angle_deg.to_radians(), Handedness::Right, 6, fibre),
        elastomer: Elastomer::Ogden { shear_modulus: 0.393e6, alpha: 1.2, form: OgdenForm::InitialModulus },
    }
}

fn alone(free: Free, law: &RodLaw, elements: usize, tip_load: TipLoad) -> RodModule {
    let module = Module {
        frees: vec![PlacedFree { free, position: [0.0, 0.0] }],
        tip: Tip { plate_mass: 0.0, payload: 0.0, free_dof: [true; 6] },
        base: Base { gravity: [0.0; 3], free_mass: 0.0 },
        spacers: 0,
    };
    RodModule::new(&module, vec![law.clone()], RodSettings { elements, tip_load, ..RodSettings::default() })
        .unwrap()
}

/// Compliance of the tip across the axis, (shift, turn) per (force, moment) as x + i y, by differences over loads of either sign.
fn transverse(
    solve: &dyn Fn(TipLoad) -> Equilibrium,
    axial: TipLoad,
    sizes: [f64; 2],
) -> Matrix2<Complex<f64>> {
    let column = |half: usize| {
        let tip = |sign: f64| {
            let mut load = axial;
            let on = if half == 0 { &mut load.force } else { &mut load.moment };
            on[0] += sign * sizes[half];
            solve(load).state.chart.to_pose()
        };
        let (plus, minus) = (tip(1.0), tip(-1.0));
        let shift = (plus.position - minus.position) / (2.0 * sizes[half]);
        let turn = (plus.rotation * minus.rotation.inverse()).scaled_axis() / (2.0 * sizes[half]);
        [Complex::new(shift.x, shift.y), Complex::new(turn.x, turn.y)]
    };
    // Moments do work on the chart's bend, whose axes are turned by half of the twist.
    let back = Complex::from_polar(1.0, -0.5 * solve(axial).state.chart.twist);
    let [by_force, by_moment] = [column(0), column(1).map(|motion| motion * back)];
    Matrix2::new(by_force[0], by_moment[0], by_force[1], by_moment[1])
}

fn relative(a: &Matrix2<Complex<f64>>, b: &Matrix2<Complex<f64>>) -> f64 {
    let size = |i: usize, j: usize| (b[(i, i)] * b[(j, j)]).norm().sqrt();
    let entries = (0..4).map(|n| (n % 2, n / 2));
    entries.map(|(i, j)| (a[(i, j)] - b[(i, j)]).norm() / size(i, j)).fold(0.0, f64::max)
}

struct Linear;

impl SectionLaw for Linear {
    fn respond(&self, _: f64, stretch: f64, twist: f64) -> SectionResponse {
        let (axial, torsion, mixed) = (30.0, 3e-4, 0.02);
        let strain = stretch - 1.0;
        SectionResponse {
            energy: 0.5 * axial * strain * strain + mixed * strain * twist + 0.5 * torsion * twist * twist,
            force: axial * strain + mixed * twist,
            torque: mixed * strain + torsion * twist,
            stiffness: [[axial, mixed], [mixed, torsion]],
        }
    }
}

#[test]
fn rods_give_way_as_the_linearisation_by_hand_says() {
    let free = free(60.0, 0.06);
    let compliance = RodCompliance {
        bending: 1800.0,
        shear: 0.12,
        coupling: 9.0,
        end_bending: 0.0,
        end_shear: 0.0,
        end_coupling: 0.0,
        end_lever: 0.0,
    };
    let inverse = Matrix2::new(1800.0, 9.0, 9.0, 0.12).try_inverse().unwrap();
    let bending =
        ConstantBending { bending: inverse[(0, 0)], coupling: inverse[(0, 1)], shear: inverse[(1, 1)] };
    let law = RodLaw { section: Arc::new(Linear), bending: Arc::new(bending) };
    for [force, torque] in [[0.0, 0.0], [0.9, 2e-3], [-0.15, -3e-3]] {
        // Strains under force and torque.
        let flexible = Matrix2::new(30.0, 0.02, 0.02, 3e-4).try_inverse().unwrap();
        let strain = flexible * nalgebra::Vector2::new(force, torque);
        let rod = StraightRod {
            length: 0.06,
            force,
            torque,
            stretch: 1.0 + strain.x,
            height: 0.06 * (1.0 + strain.x),
        };
        let exact = compliance.tip_stiffness(&rod).try_inverse().unwrap();
        let axial = TipLoad { force: [0.0, 0.0, force], moment: [0.0, 0.0, torque] };
        let error = |elements: usize| {
            let solve = |load: TipLoad| alone(free, &law, elements, load).rest().unwrap();
            relative(&transverse(&solve, axial, [1e-4, 1e-6]), &exact)
        };
        // The elements err with 1/n^2.
        let [coarse, fine] = [10, 20].map(error);
        assert!(fine < 2e-3 && fine < 0.3 * coarse + 1e-7, "{force} {torque}: {coarse:.1e} {fine:.1e}");
    }
}

#[test]
fn a_rod_is_the_solid_of_its_free() {
    let free = free(40.0, 0.1);
    let stop = AtomicBool::new(false);
    let run = Run { jobs: 2, progress: &|_, _| (), stop: &stop };
    let pressures = [0.0, 1.2e4, 2.4e4, 3.6e4];
    let bending = BendingSweep { planes: 4, ..BendingSweep::default() }.tabulate(&free, 3.6e4, &run);
    let bending: Arc<dyn BendingLaw> = Arc::new(bending.unwrap().unwrap());
    let mesh = SectionMesh { radial: 2, under_fibre: 1, between_fibres: 2 };
    let section = Arc::new(SolvedSection::from(SectionSolver::new(&free, mesh).unwrap()));
    let law = RodLaw { section, bending };
    let mesh = SolidMesh::new(12, 70);
    let specimen = Specimen::from(&free);
    let mut sector = SolidSolver::sector(&specimen, mesh).unwrap();
    let mut whole = SolidSolver::new(&specimen, mesh).unwrap();
    let rest = sector.rest();
    let mut states = vec![];
    sector
        .follow(&rest, 0.0, &pressures, &SolidLoad::pressure, &mut |_, state| {
            states.push(state.clone());
            true
        })
        .unwrap();
    for (pressure, state) in pressures.iter().zip(&states) {
        let state = whole.whole_of(&sector, state).unwrap();
        let c = whole.tip_compliance(&state).unwrap().matrix;
        let part = |i: usize, j: usize| Complex::new(c[(i, j)], c[(i + 1, j)]);
        let solid = Matrix2::new(part(0, 0), part(0, 3), part(3, 0), part(3, 3));
        let solve = |load: TipLoad| alone(free, &law, 10, load).solve(&[*pressure]).unwrap();
        let rods = transverse(&solve, TipLoad::default(), [1e-4, 1e-6]);
        let off = relative(&rods, &solid);
        assert!(off < 0.02, "{pressure}: {rods} {solid}");
        // A finite force across.
        if *pressure == pressures[2] {
            let force = 0.05;
            let load = |part: f64| SolidLoad {
                force: Vector3::x() * (part * force),
                ..SolidLoad::pressure(*pressure)
            };
            let (cap, turn) = whole.follow(&state, 0.0, &[1.0], &load, &mut |_, _| true).unwrap().cap();
            let pose = solve(TipLoad { force: [force, 0.0, 0.0], moment: [0.0; 3] }).state.chart.to_pose();
            let still = Vector3::z() * state.cap().0.z;
            let (ours, theirs) = (pose.position - still, cap - still);
            assert!(theirs.x > 15e-3, "{theirs}");
            assert!((ours - theirs).norm() < 0.02 * theirs.norm(), "{ours} {theirs}");
            let normals = [pose.rotation, turn].map(|turn| turn * Vector3::z());
            assert!((normals[0] - normals[1]).norm() < 0.02 * normals[1].xy().norm(), "{normals:?}");
        }
    }
}
