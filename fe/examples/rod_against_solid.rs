//! One FREE as a rod against the same FREE as a solid: clamped in caps, one of them free, at four pressures.
//!
//! `cargo run --release -p fe --example rod_against_solid -- [ANGLE_DEG [LENGTH_MM [FORCE_N [TORQUE_N_MM [GREATEST_KPA [linear|tension [RADIAL,AROUND,UNDER,PER_MM]]]]]]]`
//!
//! First the slopes of the tip's motions by a force across (x), by a moment about x and by a torque, then the tip under the
//! whole force, and under the whole torque. Rods with 3 mu I and mu A, and with the bending law from solids.

use actuator::{
    Base, Elastomer, Fibre, FibreLaw, Free, Handedness, Module, OgdenForm, PlacedFree, Tip, Tube, Winding,
};
use fe::{
    BendingLaw, BendingSweep, ConstantBending, RodLaw, RodModule, RodSettings, Run, SectionLaw, SectionMesh,
    SectionSolver, SolidLoad, SolidMesh, SolidSolver, SolvedSection, Specimen, TipLoad,
};
use nalgebra::{UnitQuaternion, Vector3};
use std::{
    error::Error,
    sync::{Arc, atomic::AtomicBool},
    time::Instant,
};

type Pose = (Vector3<f64>, UnitQuaternion<f64>);

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |i: usize, default: f64| arguments.get(i).map_or(Ok(default), |text| text.parse::<f64>());
    let (angle, length) = (number(0, 30.0)?, 1e-3 * number(1, 120.0)?);
    let (force, torque) = (number(2, 0.03)?, 1e-3 * number(3, 1.0)?);
    let top = 1e3 * number(4, 45.0)?;
    let tension_only = arguments.get(5).is_some_and(|law| law == "tension");
    let fibre = Fibre {
        axial_stiffness: 644.0,
        diameter: 0.15e-3,
        law: if tension_only { FibreLaw::TensionOnly } else { FibreLaw::Linear },
    };
    let free = Free {
        tube: Tube { length, inner_radius: 4.76e-3, wall: 0.8e-3 },
        winding: Winding::from_hoop(angle.to_radians(), Handedness::Right, 6, fibre),
        elastomer: Elastomer::Ogden { shear_modulus: 0.393e6, alpha: 1.2, form: OgdenForm::InitialModulus },
    };
    let pressures = [0.0, 1.0, 2.0, 3.0].map(|third| top * third / 3.0);
    let stop = AtomicBool::new(false);
    let run = Run { jobs: 2, progress: &|_, _| (), stop: &stop };
    let start = Instant::now();
    let mesh = SectionMesh { radial: 2, under_fibre: 1, between_fibres: 2 };
    let section: Arc<dyn SectionLaw> = Arc::new(SolvedSection::from(SectionSolver::new(&free, mesh)?));
    let tabulated = BendingSweep::default().tabulate(&free, top, &run)?.ok_or("stopped")?;
    println!("bending law {:.1} s", start.elapsed().as_secs_f64());
    let laws: [(&str, Arc<dyn BendingLaw>); 2] =
        [("3 mu I", Arc::new(ConstantBending::of_bare_tube(&free))), ("law", Arc::new(tabulated))];
    let module = Module {
        frees: vec![PlacedFree { free, position: [0.0, 0.0] }],
        tip: Tip { plate_mass: 0.0, payload: 0.0, free_dof: [true; 6] },
        base: Base { gravity: [0.0; 3], free_mass: 0.0 },
        spacers: 0,
    };
    let given = arguments.get(6).map_or("1,12,0,0.7", String::as_str).split(',');
    let numbers = given.map(str::parse).collect::<Result<Vec<f64>, _>>()?;
    let [radial, around, under, per_mm] = numbers[..] else { return Err("four numbers of a mesh".into()) };
    let solid_mesh = SolidMesh {
        radial: radial as usize,
        under_fibre: under as usize,
        ..SolidMesh::new(around as usize, (1e3 * per_mm * length).round() as usize)
    };
    let specimen = Specimen::from(&free);
    let mut sector = SolidSolver::sector(&specimen, solid_mesh)?;
    let mut whole = SolidSolver::new(&specimen, solid_mesh)?;
    let rest = sector.rest();
    let mut states = vec![];
    sector.follow(&rest, 0.0, &pressures, &SolidLoad::pressure, &mut |_, state| {
        states.push(state.clone());
        true
    })?;
    println!(
        "kPa    model    x/F m/N   ry/F 1/N  rx/F 1/N  rx/M 1/Nm  rz/T 1/Nm | under F: x, y, z mm, normal x, y | under T: z mm, turn deg"
    );
    for (&pressure, state) in pressures.iter().zip(&states) {
        let still = whole.whole_of(&sector, state)?;
        let c = whole.tip_compliance(&still)?.matrix;
        let mut follow = |force: f64, torque: f64| -> Result<Pose, _> {
            let to = |part: f64| SolidLoad {
                force: Vector3::x() * (part * force),
                moment: Vector3::z() * (part * torque),
                ..SolidLoad::pressure(pressure)
            };
            whole.follow(&still, 0.0, &[1.0], &to, &mut |_, _| true).map(|state| state.cap())
        };
        let print = |name: &str, slopes: [f64; 5], still: Pose, (x, turned): Pose, (z, twisted): Pose| {
            let normal = turned * Vector3::z();
            let [a, b, c, d, e] = slopes;
            let turn = (still.1.inverse() * twisted).scaled_axis().z.to_degrees();
            let x = 1e3 * x;
            println!(
                "{:5.1}  {name:7}  {a:.5}  {b:8.4}  {c:8.4}  {d:9.3}  {e:9.3} | {:7.3} {:7.3} {:8.3}  {:.5} {:8.5} | {:8.3} {turn:8.3}",
                1e-3 * pressure,
                x.x,
                x.y,
                x.z,
                normal.x,
                normal.y,
                1e3 * z.z
            );
        };
        let slopes = [c[(0, 0)], c[(4, 0)], c[(3, 0)], c[(3, 3)], c[(5, 5)]];
        match (follow(force, 0.0), follow(0.0, torque)) {
            (Ok(pushed), Ok(twisted)) => print("solid", slopes, state.cap(), pushed, twisted),
            (Err(error), _) | (_, Err(error)) => println!("solid: {error}"),
        }
        for (name, bending) in &laws {
            let solve = |force: f64, moment: [f64; 3]| {
                let law = RodLaw { section: section.clone(), bending: bending.clone() };
                let tip_load = TipLoad { force: [force, 0.0, 0.0], moment };
                let settings = RodSettings { tip_load, ..RodSettings::default() };
                RodModule::new(&module, vec![law], settings)?.solve(&[pressure])
            };
            let pose = |force, moment| {
                solve(force, moment).map(|found| {
                    let pose = found.state.chart.to_pose();
                    (pose.position, pose.rotation)
                })
            };
            let difference =
                |force: f64, moment: [f64; 3], size: f64| -> Result<[Vector3<f64>; 2], fe::RodError> {
                    let ((x, turn), (y, back)) = (
                        pose(force * size, moment.map(|m| m * size))?,
                        pose(-force * size, moment.map(|m| -m * size))?,
                    );
                    Ok([(x - y) / (2.0 * size), (turn * back.inverse()).scaled_axis() / (2.0 * size)])
                };
            let by_force = difference(1.0, [0.0; 3], 1e-4)?;
            let by_moment = difference(0.0, [1.0, 0.0, 0.0], 1e-6)?;
            let by_torque = difference(0.0, [0.0, 0.0, 1.0], 1e-6)?;
            // A moment on the chart's bend at a tip that is turned acts about an axis turned by half.
            let slopes =
                [by_force[0].x, by_force[1].y, by_force[1].x, by_moment[1].xy().norm(), by_torque[1].z];
            print(name, slopes, pose(0.0, [0.0; 3])?, pose(force, [0.0; 3])?, pose(0.0, [0.0, 0.0, torque])?);
        }
    }
    Ok(())
}
