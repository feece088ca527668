//! Analytic maps of the kind the finite elements make, for the tests of fits and files.

use actuator::{
    Base, Elastomer, Fibre, FibreLaw, Fidelity, Free, FreeMap, FreePath, FreeState, Handedness, Limits,
    MapAxis, MapParameter, Module, ModuleCheck, ModuleMap, ModuleState, OgdenForm, PathEnd, PlacedFree,
    PoseChart, Tip, Tube, Winding,
};

/// A FREE of 170 mm.
pub fn free() -> Free {
    let fibre = Fibre { axial_stiffness: 644.0, diameter: 3e-4, law: FibreLaw::Linear };
    Free {
        tube: Tube { length: 0.17, inner_radius: 4.76e-3, wall: 0.8e-3 },
        winding: Winding::from_hoop(30f64.to_radians(), Handedness::Right, 6, fibre),
        elastomer: Elastomer::Ogden { shear_modulus: 0.393e6, alpha: 1.2, form: OgdenForm::InitialModulus },
    }
}

/// Greatest pressure of the synthetic module, Pa.
pub const PRESSURE_MAX: f64 = 68.9e3;
/// Limit pressure of each FREE of the synthetic module, Pa.
pub const LIMIT: f64 = 80e3;

/// Pose of a module of `frees` FREEs: each bends towards its side, stretches and turns by a folding function of its pressure,
/// and the FREEs stiffen each other.
pub fn module_state(pressures: &[f64]) -> ModuleState {
    let fold = |pressure: &f64| 1.0 - (1.0 - pressure / LIMIT).sqrt();
    let (mut twist, mut bend, mut mean) = (0.0, [0.0; 2], 0.0);
    for (index, pressure) in pressures.iter().enumerate() {
        let around = std::f64::consts::TAU * index as f64 / pressures.len() as f64;
        let s = fold(pressure);
        twist += -1.5 * s - 0.5 * s * s;
        bend[0] += 0.9 * s * around.cos();
        bend[1] += 0.9 * s * around.sin();
        mean += s / pressures.len() as f64;
    }
    let soft = 1.0 / (1.0 + 0.4 * mean);
    let bend = bend.map(|b| b * soft);
    let position = [
        0.085 * bend[1],
        -0.085 * bend[0],
        0.17 * (1.0 + 0.1 * mean) - 0.02 * (bend[0].powi(2) + bend[1].powi(2)),
    ];
    let payload = [0.1 * mean, bend[0], bend[1], 0.01 * bend[1], -0.01 * bend[0], 0.03 * soft];
    let stiffness = [0.0, -bend[0], -bend[1], 0.0, 0.0, -0.01 * mean];
    ModuleState {
        chart: PoseChart { twist, bend, position },
        slopes: vec![payload, stiffness],
        negative_pivots: 0,
        residual: 1e-10,
        gap: None,
    }
}

/// A complete map on these pressure nodes, with `checks` states between the nodes.
pub fn module_map(pressures: Vec<Vec<f64>>, checks: usize) -> ModuleMap {
    let frees = pressures.len();
    let placed = |index: usize| {
        let around = std::f64::consts::TAU * index as f64 / frees as f64;
        PlacedFree { free: free(), position: [0.012 * around.cos(), 0.012 * around.sin()] }
    };
    let mut map = ModuleMap {
        module: Module {
            frees: (0..frees).map(placed).collect(),
            tip: Tip { plate_mass: 0.03, payload: 0.0, free_dof: [true; 6] },
            base: Base { gravity: [0.0, 0.0, 1.0], free_mass: 0.01 },
            spacers: 0,
        },
        limits: Limits { pressure_max: vec![PRESSURE_MAX; frees], pressure_rate: 2e5, idle_pressure: 0.0 },
        parameters: vec![MapParameter::Payload, MapParameter::BendingStiffness],
        pressures,
        states: Vec::new(),
        checks: Vec::new(),
        limit_pressures: vec![Some(LIMIT); frees],
        settings: "analytic".into(),
        source: ("synthetic".into(), "kind = \"module\"\n".into()),
    };
    map.states = (0..map.node_count()).map(|node| Some(module_state(&map.node_pressures(node)))).collect();
    map.checks = (0..checks)
        .map(|k| {
            let spread = |d: usize| ((k + 1) as f64 * 0.754_877_666f64.powi(d as i32 + 1)).fract();
            let pressures: Vec<f64> = map
                .pressures
                .iter()
                .enumerate()
                .map(|(d, axis)| axis[0] + spread(d) * (axis[axis.len() - 1] - axis[0]))
                .collect();
            ModuleCheck { state: module_state(&pressures), pressures }
        })
        .collect();
    map
}
/// Limit pressure (Pa) of the synthetic FREE: falls with the angle, nearly in proportion to the modulus.
pub fn limit_pressure(angle: f64, modulus: f64) -> f64 {
    modulus * (0.11 + 0.25 * (-2.0 * angle).exp()) * (1.0 - 0.02 * modulus / 0.393e6)
}

/// The synthetic FREE's state: smooth in s, with pressure = limit (1 - (1 - s)^2), and smooth in angle and modulus.
pub fn free_state(angle: f64, modulus: f64, s: f64) -> FreeState {
    let soft = 1.0 - 0.03 * modulus / 0.393e6;
    FreeState {
        pressure: limit_pressure(angle, modulus) * (1.0 - (1.0 - s) * (1.0 - s)),
        axial_stretch: 1.0 + soft * (0.3 * s * (2.2 * angle).cos() + 0.2 * s * s),
        expansion: 1.0 + soft * (0.35 * s * angle.sin() + 0.4 * s * s * s),
        twist_per_length: -soft * (90.0 * s * (2.0 * angle).sin() + 30.0 * s * s * angle.cos()),
        residual: 1e-10,
        middle: None,
        section: None,
        mesh_error: None,
    }
}

/// A path of `steps` states up to its limit point, or below `upper` (Pa).
pub fn free_path(angle: f64, modulus: f64, steps: usize, upper: Option<f64>) -> FreePath {
    let limit = limit_pressure(angle, modulus);
    let end = match upper {
        Some(upper) if upper < limit => 1.0 - (1.0 - upper / limit).sqrt(),
        _ => 1.0,
    };
    // Uneven steps, as a continuation takes them.
    let place = |i: usize| {
        let u = i as f64 / (steps - 1) as f64;
        end * (u + 0.1 * (1.0 - u) * u)
    };
    let states = (0..steps).map(|i| free_state(angle, modulus, place(i))).collect();
    FreePath::solved(states, if end < 1.0 { PathEnd::Range } else { PathEnd::LimitPoint })
}

/// A complete map with a check path in the middle of every cell.
pub fn free_map(
    winding_angles: Vec<f64>,
    shear_moduli: Vec<f64>,
    steps: usize,
    upper: Option<f64>,
) -> FreeMap {
    let between = |axis: &[f64]| match axis {
        [single] => vec![*single],
        _ => axis.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect(),
    };
    let grid = |angles: &[f64], moduli: &[f64]| -> Vec<(f64, f64)> {
        angles.iter().flat_map(|angle| moduli.iter().map(|modulus| (*angle, *modulus))).collect()
    };
    let path = |angle, modulus| free_path(angle, modulus, steps, upper);
    FreeMap {
        node: free().into(),
        pressures: (0..8).map(|i| f64::from(i) * 1e4).collect(),
        paths: grid(&winding_angles, &shear_moduli).into_iter().map(|(a, m)| Some(path(a, m))).collect(),
        checks: grid(&between(&winding_angles), &between(&shear_moduli))
            .into_iter()
            .map(|(angle, modulus)| (free().at(angle, modulus).into(), path(angle, modulus)))
            .collect(),
        axes: MapAxis::of_angles_and_moduli(winding_angles, shear_moduli),
        fidelity: Fidelity::Section,
        settings: "analytic".into(),
        source: ("synthetic".into(), "kind = \"free\"\n".into()),
    }
}
