//! One FREE as a rod against the same FREE as a solid between rigid caps, at four pressures: how far its tip gives way to a force across, a
//! bending moment, a torque and a force along, how long it is and how far it is turned, and what a torque of finite size does.
//!
//! `cargo run --release -p fe --example rod_between_caps -- [spread] [fine] [ANGLE_DEG...]` (default: 30 and 60 degrees)
//!
//! Rods with the section's law from cap to cap, and with what the caps do to it ([`CapSweep`]); solids on two or, `fine`, three meshes (through
//! the wall x around + under half a fibre x along), the last of which the rods are compared with. Threads are 0.15 mm wide, or
//! spread over all of the surface as in maps of modules.

use actuator::{
    Base, Elastomer, EndLoad, Fibre, FibreLaw, Free, Handedness, Module, OgdenForm, PlacedFree, Tip, Tube,
    Winding,
};
use fe::{
    BendingLaw, BendingSweep, CapSweep, CappedSection, RodLaw, RodModule, RodSettings, Run, SectionLaw,
    SectionMesh, SectionSolver, SectionTable, SolidLoad, SolidMesh, SolidSolver, SolvedSection, Specimen,
    TableGrid, TipLoad,
};
use std::{
    error::Error,
    f64::consts::TAU,
    sync::{Arc, atomic::AtomicBool},
    time::Instant,
};

const PRESSURES: [f64; 4] = [0.0, 15e3, 30e3, 45e3];
const LENGTH: f64 = 0.12;
/// Of the finite torque, N m.
const TORQUE: f64 = 2e-3;

/// Shift and turn by a force across, turn by a moment about the same axis, turn by a torque, shift by a force along; mean stretch and
/// twist (rad/m), turn by the finite torque (rad).
type Answers = [f64; 8];
const NAMES: [&str; 8] = [
    "x/F m/N",
    "ry/F 1/N",
    "rx/M 1/(N m)",
    "rz/T 1/(N m)",
    "z/F m/N",
    "stretch",
    "twist rad/m",
    "turn by 2 N mm",
];

fn free(angle: f64, spread: bool) -> Free {
    let tube = Tube { length: LENGTH, inner_radius: 4.76e-3, wall: 0.8e-3 };
    let diameter = if spread { TAU * tube.outer_radius() } else { 0.15e-3 };
    let fibre = Fibre { axial_stiffness: 644.0, diameter, law: FibreLaw::Linear };
    Free {
        tube,
        winding: Winding::from_hoop(angle.to_radians(), Handedness::Right, 6, fibre),
        elastomer: Elastomer::Ogden { shear_modulus: 0.393e6, alpha: 1.2, form: OgdenForm::InitialModulus },
    }
}

fn of_solid(
    free: &Free,
    [radial, around, under_fibre, along]: [usize; 4],
) -> Result<Vec<Answers>, Box<dyn Error>> {
    let mesh = SolidMesh { radial, under_fibre, ..SolidMesh::new(around, along) };
    let specimen = Specimen::from(free);
    let mut sector = SolidSolver::sector(&specimen, mesh)?;
    let mut whole = SolidSolver::new(&specimen, mesh)?;
    let mut states = vec![];
    let rest = sector.rest();
    sector.follow(&rest, 0.0, &PRESSURES, &SolidLoad::pressure, &mut |_, state| {
        states.push(state.clone());
        true
    })?;
    let mut answers = vec![];
    for (pressure, state) in PRESSURES.into_iter().zip(&states) {
        let straight = whole.whole_of(&sector, state)?;
        let c = whole.tip_compliance(&straight)?.matrix;
        let seen = sector.deformation(state);
        let ends = EndLoad { force: 0.0, torque: TORQUE };
        let to = |part: f64| SolidLoad::axial(pressure, ends.times(part));
        let turned = sector.follow(state, 0.0, &[1.0], &to, &mut |_, _| true)?;
        let turn = (sector.deformation(&turned).twist_total - seen.twist_total) * LENGTH;
        let slopes = [c[(0, 0)], c[(4, 0)], c[(3, 3)], c[(5, 5)], c[(2, 2)]];
        let [x, ry, rx, rz, z] = slopes;
        answers.push([x, ry, rx, rz, z, seen.stretch_total, seen.twist_total, turn]);
    }
    Ok(answers)
}

fn of_rod(free: &Free, law: &RodLaw) -> Result<Vec<Answers>, Box<dyn Error>> {
    let module = Module {
        frees: vec![PlacedFree { free: *free, position: [0.0, 0.0] }],
        tip: Tip { plate_mass: 0.0, payload: 0.0, free_dof: [true; 6] },
        base: Base { gravity: [0.0; 3], free_mass: 0.0 },
        spacers: 0,
    };
    let solve = |pressure: f64, force: [f64; 3], moment: [f64; 3]| {
        let settings = RodSettings { tip_load: TipLoad { force, moment }, ..RodSettings::default() };
        RodModule::new(&module, vec![law.clone()], settings)?.solve(&[pressure])
    };
    let mut answers = vec![];
    for pressure in PRESSURES {
        // Differences of the tip's place and of its turn.
        let by = |force: [f64; 3], moment: [f64; 3], size: f64| -> Result<_, fe::RodError> {
            let at = |side: f64| {
                let found = solve(pressure, force.map(|f| f * side * size), moment.map(|m| m * side * size))?;
                Ok::<_, fe::RodError>(found.state.chart.to_pose())
            };
            let (above, below) = (at(1.0)?, at(-1.0)?);
            let turn = (above.rotation * below.rotation.inverse()).scaled_axis();
            Ok(((above.position - below.position) / (2.0 * size), turn / (2.0 * size)))
        };
        let across = by([1.0, 0.0, 0.0], [0.0; 3], 1e-4)?;
        let bent = by([0.0; 3], [1.0, 0.0, 0.0], 1e-6)?;
        let turned = by([0.0; 3], [0.0, 0.0, 1.0], 1e-6)?;
        let pulled = by([0.0, 0.0, 1.0], [0.0; 3], 1e-3)?;
        let still = solve(pressure, [0.0; 3], [0.0; 3])?.state.chart;
        let wound = solve(pressure, [0.0; 3], [0.0, 0.0, TORQUE])?.state.chart;
        // A moment on the chart's bend at a tip that is turned acts about an axis turned by half.
        answers.push([
            across.0.x,
            across.1.y,
            bent.1.xy().norm(),
            turned.1.z,
            pulled.0.z,
            still.to_pose().position.z / LENGTH,
            still.twist / LENGTH,
            wound.twist - still.twist,
        ]);
    }
    Ok(answers)
}

fn main() -> Result<(), Box<dyn Error>> {
    let (numbers, words): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|argument| argument.parse::<f64>().is_ok());
    let angles = numbers.iter().map(|number| number.parse()).collect::<Result<Vec<f64>, _>>()?;
    let angles = if angles.is_empty() { vec![30.0, 60.0] } else { angles };
    let told = |word: &str| words.iter().any(|own| own == word);
    let (spread, fine) = (told("spread"), told("fine"));
    let under = usize::from(!spread);
    let mut meshes = vec![[1, 12, 0, 84], [2, 24, under, 84]];
    if fine {
        meshes.push([2, 24, under, 168]);
    }
    let stop = AtomicBool::new(false);
    let run = Run { jobs: 2, progress: &|_, _| (), stop: &stop };
    let mut worst = [0.0f64; 2];
    for angle in angles {
        let free = free(angle, spread);
        let start = Instant::now();
        let mesh = SectionMesh { radial: 2, under_fibre: 2, between_fibres: 4 };
        let mut solver = SectionSolver::new(&free, mesh)?;
        // With threads spread the table of maps of modules, else the section's finite elements themselves.
        let far: Arc<dyn SectionLaw> = if spread {
            let grid = TableGrid::for_free(&free, &solver.path(&PRESSURES, 0)?, PRESSURES[3]);
            Arc::new(SectionTable::new(&free, grid, mesh, &run)?)
        } else {
            Arc::new(SolvedSection::from(solver))
        };
        let section_time = start.elapsed().as_secs_f64();
        let start = Instant::now();
        // Narrow threads cut into a wall that is turned far.
        let range = if spread { CapSweep::default().range } else { [0.02, 0.25] };
        let sweep = CapSweep { range, ..CapSweep::default() };
        let caps = sweep.tabulate(&free, far.as_ref(), PRESSURES[3], &run)?.ok_or("stopped")?;
        let cap_time = start.elapsed().as_secs_f64();
        let start = Instant::now();
        let bending = BendingSweep::default().tabulate(&free, PRESSURES[3], &run)?.ok_or("stopped")?;
        let bending_time = start.elapsed().as_secs_f64();
        println!(
            "{angle} deg{}: section law {section_time:.1} s, caps {cap_time:.1} s, bending law {bending_time:.1} s",
            if spread { ", threads spread" } else { "" }
        );
        let tube = free.tube;
        let capped = CappedSection::new(far.clone(), Arc::new(caps), [tube.length, tube.outer_radius()]);
        let between: Arc<dyn BendingLaw> = Arc::new(bending.between_caps(tube.length));
        let laws: [RodLaw; 2] = [
            RodLaw { section: far.clone(), bending: Arc::new(bending) },
            RodLaw { section: Arc::new(capped), bending: between },
        ];
        let rods = [of_rod(&free, &laws[0])?, of_rod(&free, &laws[1])?];
        let mut solids = vec![];
        for mesh in &meshes {
            let start = Instant::now();
            solids.push(of_solid(&free, *mesh)?);
            let [radial, around, under, along] = mesh;
            println!("solid {radial} x {around} + {under} x {along}: {:.1} s", start.elapsed().as_secs_f64());
        }
        for (name, quantity) in NAMES.into_iter().zip(0..) {
            for (plane, pressure) in PRESSURES.into_iter().enumerate() {
                let solid: Vec<f64> = solids.iter().map(|solid| solid[plane][quantity]).collect();
                let exact = solid[solid.len() - 1];
                // Of the stretch its change.
                let base = if quantity == 5 { 1.0 } else { 0.0 };
                let off = |value: f64| 100.0 * (value - exact) / (exact - base);
                let [without, with] = [&rods[0], &rods[1]].map(|rod| rod[plane][quantity]);
                let coarser: Vec<String> =
                    solid[..solid.len() - 1].iter().map(|value| format!("{:6.2} %", off(*value))).collect();
                println!(
                    "{name:14} {:4.0} kPa  solid {exact:10.5}  coarser {}  rod without caps {without:10.5} {:6.2} %  with {with:10.5} {:6.2} %",
                    1e-3 * pressure,
                    coarser.join(" "),
                    off(without),
                    off(with)
                );
                if quantity < 5 || quantity == 7 {
                    worst = [worst[0].max(off(without).abs()), worst[1].max(off(with).abs())];
                }
            }
        }
    }
    println!("worst of the tip's answers: without caps {:.2} %, with {:.2} %", worst[0], worst[1]);
    Ok(())
}
