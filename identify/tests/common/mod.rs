//! A synthetic module of four FREEs and its recordings. What generates the recordings is not the model that is fitted: another shape of the pressure
//! law, another stiffening, another bending. All numbers are reproducible.
#![allow(dead_code)]

use actuator::{
    Base, Elastomer, Fibre, FibreLaw, Free, Handedness, MapParameter, Module, OgdenForm, PlacedFree,
    PoseChart, Tip, Tube, Winding,
};
use identify::{Mechanics, ModuleMechanics, Seen};
use record::{Motion, Recording};
use rom::effect::{Chain, Effect, EffectKind};
use rom::{OutOfDomain, PoseEvaluation, PoseModel};

pub const GREATEST: f64 = 50e3;
pub const PARAMETERS: [MapParameter; 2] = [MapParameter::Payload, MapParameter::BendingStiffness];

/// Analytic module: softening by `p (1 + soft p + other p^2)`, alternate hands, bending away from the inflated FREE.
pub struct Synthetic {
    pub soft: f64,
    pub other: f64,
    pub bend: f64,
    domain: Vec<(f64, f64)>,
}

impl Synthetic {
    /// The model that is fitted.
    pub fn fitted() -> Self {
        Synthetic { soft: 0.35, other: 0.0, bend: 0.25, domain: vec![(0.0, GREATEST); 4] }
    }

    /// The model that generates: differs by up to 2 % of the stroke in shape and size.
    pub fn maker() -> Self {
        Synthetic { soft: 0.30, other: 0.07, bend: 0.26, domain: vec![(-1e4, 2.0 * GREATEST); 4] }
    }

    fn chart(&self, pressures: &[f64], payload: f64, stiffer: f64) -> [f64; 6] {
        let x: Vec<f64> = pressures.iter().map(|p| p / GREATEST).collect();
        let f = |x: f64| x * (1.0 + self.soft * x + self.other * x * x);
        let mean = x.iter().map(|x| f(*x)).sum::<f64>() / 4.0;
        let hands = [-1.0, 1.0, -1.0, 1.0];
        let sides = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];
        let mut twist = 0.0;
        let mut bend = [0.0; 2];
        for free in 0..4 {
            twist += 1.2 * hands[free] * f(x[free]);
            bend[0] += self.bend * sides[free][1] * f(x[free]);
            bend[1] -= self.bend * sides[free][0] * f(x[free]);
        }
        // A hanging mass straightens and stretches; pressure stiffens.
        let soft = 1.0 / (1.0 + 0.4 * mean) / (1.0 + 10.0 * payload) / (1.0 + stiffer);
        let bend = bend.map(|bend| bend * soft);
        let z = 0.175 * (1.0 + 0.03 * mean) + 0.014 * payload - 0.03 * (bend[0].powi(2) + bend[1].powi(2));
        [twist, bend[0], bend[1], 0.0875 * bend[1], -0.0875 * bend[0], z]
    }
}

impl PoseModel for Synthetic {
    fn domain(&self) -> &[(f64, f64)] {
        &self.domain
    }

    fn evaluate(&self, pressures: &[f64], into: &mut PoseEvaluation) -> Result<(), OutOfDomain> {
        into.chart = PoseChart::from_array(self.chart(pressures, 0.0, 0.0));
        let slope = |up: [f64; 6], down: [f64; 6], step: f64| {
            std::array::from_fn(|k| (up[k] - down[k]) / (2.0 * step))
        };
        for free in 0..pressures.len() {
            let moved = |step: f64| {
                let mut moved = pressures.to_vec();
                moved[free] += step;
                self.chart(&moved, 0.0, 0.0)
            };
            into.jacobian[free] = slope(moved(5.0), moved(-5.0), 5.0);
        }
        if into.slopes.len() == 2 {
            into.slopes[0] = slope(self.chart(pressures, 1e-5, 0.0), self.chart(pressures, -1e-5, 0.0), 1e-5);
            into.slopes[1] = slope(self.chart(pressures, 0.0, 1e-5), self.chart(pressures, 0.0, -1e-5), 1e-5);
        }
        Ok(())
    }
}

pub fn module() -> Module {
    let fibre = Fibre { axial_stiffness: 644.0, diameter: 3e-4, law: FibreLaw::TensionOnly };
    let free = |handedness| Free {
        tube: Tube { length: 0.175, inner_radius: 4.76e-3, wall: 0.8e-3 },
        winding: Winding::from_hoop(30f64.to_radians(), handedness, 6, fibre),
        elastomer: Elastomer::Ogden { shear_modulus: 0.393e6, alpha: 1.2, form: OgdenForm::InitialModulus },
    };
    let places = [[7.5e-3, 7.5e-3], [-7.5e-3, 7.5e-3], [-7.5e-3, -7.5e-3], [7.5e-3, -7.5e-3]];
    let hands = [Handedness::Right, Handedness::Left, Handedness::Right, Handedness::Left];
    Module {
        frees: places
            .into_iter()
            .zip(hands)
            .map(|(position, hand)| PlacedFree { free: free(hand), position })
            .collect(),
        tip: Tip { plate_mass: 5e-3, payload: 0.0, free_dof: [true; 6] },
        base: Base { gravity: [0.0, 0.0, 1.0], free_mass: 4.3e-3 },
        spacers: 0,
    }
}

/// Numbers that look random (a 64-bit linear congruence, upper bits).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    pub fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Standard normal, by the sum of twelve.
    pub fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

/// Commands of five kinds, sample by sample at 20 Hz.
pub fn commands(kind: usize, seconds: f64) -> Vec<[f64; 4]> {
    let count = (seconds * 20.0) as usize;
    let mut random = Random::new(17 + kind as u64);
    let mut point = [0.0; 4];
    let phases: Vec<f64> = (0..8).map(|_| random.uniform()).collect();
    (0..count)
        .map(|k| {
            let t = k as f64 / 20.0;
            match kind {
                // Staircase of one FREE after the other.
                0 => {
                    let which = (t / 16.0) as usize % 6;
                    let step = 1.0 - ((t % 16.0) / 2.0 - 3.5).floor().abs() / 4.0;
                    let pattern = [
                        [1., 0., 0., 0.],
                        [0., 1., 0., 0.],
                        [0., 0., 1., 0.],
                        [0., 0., 0., 1.],
                        [1., 1., 0., 0.],
                        [1., 1., 1., 1.],
                    ];
                    pattern[which].map(|on| on * 45e3 * step.clamp(0.0, 1.0))
                }
                // Triangles at two rates.
                1 => {
                    let period = if t < 0.5 * seconds { 20.0 } else { 5.0 };
                    let phase = (t / period).fract();
                    let level = 45e3 * (1.0 - (2.0 * phase - 1.0).abs());
                    if ((t / period) as usize).is_multiple_of(2) {
                        [level, level, 0.0, 0.0]
                    } else {
                        [0.0, level, level, 0.3 * level]
                    }
                }
                // Random set-points.
                2 => {
                    if k % 40 == 0 {
                        point = std::array::from_fn(|_| 47e3 * random.uniform());
                    }
                    point
                }
                // Long holds.
                3 => match (t / 30.0) as usize % 4 {
                    0 => [35e3, 0.0, 0.0, 0.0],
                    1 => [0.0; 4],
                    2 => [35e3, 35e3, 20e3, 0.0],
                    _ => [0.0, 10e3, 0.0, 30e3],
                },
                // Smooth.
                _ => std::array::from_fn(|free| {
                    let wave = (t * (0.31 + 0.07 * free as f64) + 6.0 * phases[free]).sin()
                        + (t * 0.83 + 6.0 * phases[free + 4]).sin();
                    24e3 + 11e3 * wave
                }),
            }
        })
        .collect()
}

/// A recording of the maker's module with the effects of a chain, with noise, and with missing samples and outliers in shares of the samples.
pub fn record(
    name: &str,
    kind: usize,
    seconds: f64,
    chain: &Chain,
    missing: f64,
    outliers: f64,
) -> Recording {
    let maker = Synthetic::maker();
    let module = module();
    let mechanics = ModuleMechanics::new(&maker, &PARAMETERS, &module);
    let mut state = chain.at_rest(4);
    let mut random = Random::new(1000 + kind as u64);
    let commands = commands(kind, seconds);
    let mut recording = Recording {
        name: name.into(),
        time: (0..commands.len()).map(|k| k as f64 / 20.0).collect(),
        command: vec![Vec::new(); 4],
        pressure: vec![Vec::new(); 4],
        motion: Motion::Pose { position: Default::default(), rotation: Default::default() },
    };
    let Motion::Pose { position, rotation } = &mut recording.motion else { unreachable!() };
    let mut response = mechanics.room();
    for (k, command) in commands.iter().enumerate() {
        let step = if k == 0 { 0.0 } else { 0.05 };
        let mut pressures = *command;
        chain.supply(&mut state, step, &mut pressures);
        let mut read = pressures;
        chain.read_pressures(&mut read);
        for free in 0..4 {
            recording.command[free].push(command[free]);
            let reading = read[free] + 80.0 * random.normal();
            recording.pressure[free].push(if random.uniform() < missing { f64::NAN } else { reading });
        }
        chain.deform(&mut state, step, &mut pressures);
        mechanics.respond(chain, &pressures, &mut response).unwrap();
        let Seen::Pose(pose, _) = mechanics.observe(chain, &response) else { unreachable!() };
        let shaken = nalgebra::UnitQuaternion::from_scaled_axis(nalgebra::Vector3::from_fn(|_, _| {
            2e-3 * random.normal()
        }));
        let wxyz = (pose.rotation * shaken).coords;
        let gone = random.uniform() < missing;
        let jump = if random.uniform() < outliers { 0.05 } else { 0.0 };
        for (channel, exact) in position.iter_mut().zip(pose.position.iter()) {
            let seen = exact + 1.5e-4 * random.normal() + jump;
            channel.push(if gone { f64::NAN } else { seen });
        }
        for (channel, value) in rotation.iter_mut().zip([wxyz.w, wxyz.x, wxyz.y, wxyz.z]) {
            channel.push(if gone { f64::NAN } else { value });
        }
    }
    recording
}

pub fn effect(kind: EffectKind, values: &[f64]) -> Effect {
    let frees = vec![0, 1, 2, 3];
    Effect { kind, frees, values: values.to_vec() }
}

/// Four recordings to fit and one of another kind to hold out.
pub fn recordings(effects: Vec<Effect>, missing: f64, outliers: f64) -> (Vec<Recording>, Vec<Recording>) {
    // Every real supply has some lag.
    let mut chain = Chain { effects };
    if !chain.effects.iter().any(|effect| effect.kind == EffectKind::SupplyLag) {
        chain.effects.push(effect(EffectKind::SupplyLag, &[0.03, 0.03]));
    }
    let names = ["staircase", "triangles", "setpoints", "holds", "smooth"];
    let mut all: Vec<Recording> = names
        .iter()
        .enumerate()
        .map(|(kind, name)| record(name, kind, 100.0, &chain, missing, outliers))
        .collect();
    let held = all.split_off(4);
    (all, held)
}
