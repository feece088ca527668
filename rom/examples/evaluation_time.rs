//! How long an evaluation takes: one FREE with its 3x3 Jacobian, and the pose of four FREEs with its 6x4 Jacobian.
//!
//! `cargo run --release -p rom --example evaluation_time` on a quiet machine. The tables are made of formulas, of the size that
//! real ones have (8 angles, 3 moduli; 9 pressures for each of four FREEs), since only their size bears on the time.

use actuator::{
    Base, Elastomer, Fibre, FibreLaw, Fidelity, Free, FreeMap, FreePath, FreeState, Handedness, Limits,
    MapAxis, MapParameter, Module, ModuleMap, ModuleState, PathEnd, PlacedFree, PoseChart, Tip, Tube,
    Winding,
};
use rom::{FreeModel, ModuleModel, PoseModel, recommended_pressure_nodes};
use std::{hint::black_box, time::Instant};

const PRESSURE_MAX: f64 = 60e3;
const SHEAR_MODULUS: f64 = 0.393e6;

fn free() -> Free {
    let fibre = Fibre { axial_stiffness: 644.0, diameter: 3e-4, law: FibreLaw::Linear };
    Free {
        tube: Tube { length: 0.17, inner_radius: 4.76e-3, wall: 0.8e-3 },
        winding: Winding::from_hoop(0.5, Handedness::Right, 6, fibre),
        elastomer: Elastomer::NeoHookean { shear_modulus: SHEAR_MODULUS },
    }
}

fn free_model() -> Result<FreeModel, Box<dyn std::error::Error>> {
    let winding_angles: Vec<f64> = (1..=8).map(|i| f64::from(10 * i).to_radians()).collect();
    let shear_moduli = [0.5, 1.0, 2.0].map(|factor| factor * SHEAR_MODULUS).to_vec();
    let path = |angle: f64, modulus: f64| {
        let limit = modulus * (0.11 + 0.25 * (-2.0 * angle).exp());
        let state = |i: i32| {
            let s = f64::from(i) / 30.0;
            FreeState {
                pressure: limit * (1.0 - (1.0 - s) * (1.0 - s)),
                axial_stretch: 1.0 + 0.3 * s * (2.2 * angle).cos(),
                expansion: 1.0 + 0.4 * s * s,
                twist_per_length: -90.0 * s * (2.0 * angle).sin(),
                residual: 0.0,
                middle: None,
                section: None,
                mesh_error: None,
            }
        };
        Some(FreePath::solved((0..=30).map(state).collect(), PathEnd::LimitPoint))
    };
    let paths = winding_angles
        .iter()
        .flat_map(|angle| shear_moduli.iter().map(move |modulus| path(*angle, *modulus)));
    Ok(FreeModel::fit(&FreeMap {
        node: free().into(),
        paths: paths.collect(),
        axes: MapAxis::of_angles_and_moduli(winding_angles, shear_moduli.clone()),
        pressures: vec![0.0],
        checks: Vec::new(),
        fidelity: Fidelity::Section,
        settings: "formulas".into(),
        source: Default::default(),
    })?)
}

fn module_model() -> Result<ModuleModel, Box<dyn std::error::Error>> {
    let mut map = ModuleMap {
        module: Module {
            frees: vec![PlacedFree { free: free(), position: [0.0; 2] }; 4],
            tip: Tip { plate_mass: 0.03, payload: 0.0, free_dof: [true; 6] },
            base: Base { gravity: [0.0, 0.0, 1.0], free_mass: 0.01 },
            spacers: 0,
        },
        limits: Limits { pressure_max: vec![PRESSURE_MAX; 4], pressure_rate: 2e5, idle_pressure: 0.0 },
        parameters: vec![MapParameter::Payload, MapParameter::BendingStiffness],
        pressures: vec![recommended_pressure_nodes(PRESSURE_MAX, Some(75e3), 9); 4],
        states: Vec::new(),
        checks: Vec::new(),
        limit_pressures: vec![Some(75e3); 4],
        settings: "formulas".into(),
        source: Default::default(),
    };
    let state = |node: usize| {
        let p = map.node_pressures(node);
        let sum: f64 = p.iter().sum::<f64>() / PRESSURE_MAX;
        let chart = PoseChart {
            twist: -sum,
            bend: [(p[0] - p[2]) / PRESSURE_MAX, (p[1] - p[3]) / PRESSURE_MAX],
            position: [0.01 * sum.sin(), 0.01 * sum.cos(), 0.17 + 0.01 * sum],
        };
        Some(ModuleState { chart, slopes: vec![[sum; 6]; 2], negative_pivots: 0, residual: 0.0, gap: None })
    };
    map.states = (0..map.node_count()).map(state).collect();
    Ok(ModuleModel::fit(&map)?)
}

/// Mean time of a call, in microseconds: median and least over many short rounds, which other programs disturb less than long ones.
fn microseconds(mut call: impl FnMut(usize)) -> String {
    let calls = 500;
    let mut rounds: Vec<f64> = (0..401)
        .map(|round| {
            let start = Instant::now();
            (0..calls).for_each(|index| call(round * calls + index));
            start.elapsed().as_secs_f64() * 1e6 / calls as f64
        })
        .collect();
    rounds.sort_by(f64::total_cmp);
    format!("{:.3} us (least {:.3})", rounds[rounds.len() / 2], rounds[0])
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Points that wander through the domain, so that no call finds its table's rows where the last one left them.
    let place = |call: usize, axis: usize| {
        ((call + 1) as f64 * [0.754_878, 0.569_840, 0.430_160, 0.324_718][axis]).fract()
    };
    let free = free_model()?;
    let time = microseconds(|call| {
        let point =
            [20e3 * place(call, 0), 0.2 + 1.1 * place(call, 1), SHEAR_MODULUS * (0.6 + place(call, 2))];
        let _ = black_box(free.evaluate(black_box(point[0]), point[1], point[2]));
    });
    println!("one FREE, value and 3x3 Jacobian: {time}");
    let module = module_model()?;
    let mut into = module.workspace();
    let time = microseconds(|call| {
        let pressures = [0, 1, 2, 3].map(|axis| PRESSURE_MAX * place(call, axis));
        let _ = black_box(module.evaluate(black_box(&pressures), &mut into));
    });
    println!("four FREEs, pose, 6x4 Jacobian and slopes to two parameters: {time}");
    Ok(())
}
