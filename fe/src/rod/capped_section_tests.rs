use super::*;
use crate::{
    CapSample, CapSweep, SolidLoad, SolidMesh, SolidSolver, Specimen, ThickTube, rod::specimens::free,
};
use actuator::{EndLoad, Handedness};
use std::{f64::consts::TAU, sync::atomic::AtomicBool};

/// W = (s - s0).K.(s - s0)/2 - p (V.(s - s0)), s0 = (1, 0).
struct Quadratic {
    stiffness: Matrix2<f64>,
    volume: Vector2<f64>,
}

impl SectionLaw for Quadratic {
    fn respond(&self, pressure: f64, stretch: f64, twist: f64) -> SectionResponse {
        let off = Vector2::new(stretch - 1.0, twist);
        let force = self.stiffness * off - self.volume * pressure;
        let k = &self.stiffness;
        SectionResponse {
            energy: 0.5 * off.dot(&(k * off)) - pressure * self.volume.dot(&off),
            force: force.x,
            torque: force.y,
            stiffness: [[k[(0, 0)], k[(0, 1)]], [k[(1, 0)], k[(1, 1)]]],
        }
    }
}

fn quadratic() -> Quadratic {
    Quadratic { stiffness: Matrix2::new(32.0, 0.02, 0.02, 8e-4), volume: Vector2::new(-1e-5, -3e-7) }
}

const LENGTH: f64 = 0.12;
const SIZES: [f64; 2] = [1.5, 0.03];
const RADIUS: f64 = 5.56e-3;

/// Ends that answer linearly next to no load, `by` times as much at each pressure.
fn effect(by: f64) -> CapEffect {
    let ends = |load: EndLoad| {
        let (n, m) = (load.force, load.torque);
        [by * (1e-4 - 2e-5 * n - 4e-3 * m), by * (0.1 - 4e-3 * n - 2.5 * m)]
    };
    let places = [
        [1.0, 0.0],
        [-1.0, 0.0],
        [0.0, 1.0],
        [0.0, -1.0],
        [0.5, 0.5],
        [-0.5, 0.5],
        [0.5, -0.5],
        [-0.5, -0.5],
    ];
    let load = |[x, y]: [f64; 2]| EndLoad { force: x * SIZES[0], torque: y * SIZES[1] };
    let samples = places.map(|place| CapSample { load: load(place), ends: ends(load(place)) });
    CapEffect::new(ends(EndLoad::NONE), &samples, SIZES, RADIUS)
}

fn capped(by: f64) -> CappedSection {
    let caps = CapTable::new(&[(0.0, effect(0.0)), (4e4, effect(by))]).unwrap();
    CappedSection::new(Arc::new(quadratic()), Arc::new(caps), [LENGTH, RADIUS])
}

#[test]
fn tube_and_caps_are_in_series() {
    let (law, capped) = (quadratic(), capped(1.0));
    for pressure in [0.0, 2e4, 4e4] {
        for [force, torque] in [[0.0, 0.0], [0.6, -0.01], [-1.0, 0.02]] {
            // Where the section stands under the load and what the ends add.
            let load = Vector2::new(force, torque);
            let flexible = law.stiffness.try_inverse().unwrap();
            let far = Vector2::new(1.0, 0.0) + flexible * (load + law.volume * pressure);
            let ends = capped.caps.at(pressure).at(force, torque);
            let mean = far + Vector2::from(ends.ends) / LENGTH;
            let found = capped.respond(pressure, mean.x, mean.y);
            assert!((found.force - force).abs() < 1e-9 && (found.torque - torque).abs() < 1e-11, "{found:?}");
            let compliance = Matrix2::from_row_iterator(ends.compliance.into_iter().flatten()) / LENGTH;
            let off = stiffness(&found) * (flexible + compliance) - Matrix2::identity();
            assert!(off.amax() < 1e-6, "{pressure}: {off}");
            // Legendre: what tube and ends store without what the load has done.
            let stored = law.respond(pressure, far.x, far.y).energy
                + (load.dot(&Vector2::from(ends.ends)) - ends.energy) / LENGTH;
            assert!((found.energy - stored).abs() < 1e-12, "{} {stored}", found.energy);
            assert!(capped.covers(pressure, mean.x, mean.y));
        }
    }
}

#[test]
fn force_and_torque_are_slopes_of_the_energy() {
    let capped = capped(1.0);
    for (stretch, twist) in [(1.0, 0.0), (1.03, -25.0), (0.95, 18.0)] {
        let own = capped.respond(3e4, stretch, twist);
        let steps = [1e-4, 1e-2];
        for (by, step) in steps.into_iter().enumerate() {
            let [above, below] = [step, -step].map(|step| {
                let [x, y] = if by == 0 { [step, 0.0] } else { [0.0, step] };
                capped.respond(3e4, stretch + x, twist + y)
            });
            let slope = |value: fn(&SectionResponse) -> f64| (value(&above) - value(&below)) / (2.0 * step);
            let close = |found: f64, wanted: f64, size: f64| {
                assert!((found - wanted).abs() < 1e-6 * size, "{stretch} {twist}: {found} {wanted}");
            };
            close(slope(|r| r.energy), [own.force, own.torque][by], SIZES[by]);
            close(slope(|r| r.force), own.stiffness[0][by], SIZES[0] / [0.04, 20.0][by]);
            close(slope(|r| r.torque), own.stiffness[1][by], SIZES[1] / [0.04, 20.0][by]);
        }
    }
}

/// Mean stretch and twist per length of a FREE of another length than that of the sweep, and how far a torque and a force turn and lengthen it,
/// against a solid. Without caps the law is 3 % off in the turn at 60 degrees and in the twist.
#[test]
fn a_free_between_caps_is_its_solid() {
    let stop = AtomicBool::new(false);
    let run = crate::Run { jobs: 2, progress: &|_, _| (), stop: &stop };
    let mut free = free(60.0, Handedness::Right);
    free.tube.length = 0.1;
    free.winding.fibre.law = actuator::FibreLaw::Linear;
    free.winding.fibre.diameter = TAU * free.tube.outer_radius();
    let pressures = [2e4, 4e4];
    let tube = ThickTube::new(&free);
    let caps = CapSweep { planes: 4, ..CapSweep::default() }.tabulate(&free, &tube, 4e4, &run);
    let sizes = [free.tube.length, free.tube.outer_radius()];
    let capped = CappedSection::new(Arc::new(tube.clone()), Arc::new(caps.unwrap().unwrap()), sizes);

    let mut solid = SolidSolver::sector(&Specimen::from(&free), SolidMesh::lean(&free)).unwrap();
    let mut states = vec![];
    let rest = solid.rest();
    solid
        .follow(&rest, 0.0, &pressures, &SolidLoad::pressure, &mut |_, state| {
            states.push(state.clone());
            true
        })
        .unwrap();
    let mut far_off = 0.0f64;
    for (pressure, state) in pressures.into_iter().zip(&states) {
        let mut at = |load: EndLoad| {
            let to = |part: f64| SolidLoad::axial(pressure, load.times(part));
            let found = solid.follow(state, 0.0, &[1.0], &to, &mut |_, _| true).unwrap();
            let seen = solid.deformation(&found);
            Vector2::new(seen.stretch_total, seen.twist_total)
        };
        let solid = [
            at(EndLoad::NONE),
            at(EndLoad { force: 0.3, torque: 0.0 }),
            at(EndLoad { force: 0.0, torque: 3e-3 }),
        ];
        // Mean strains of a law under a load, by Newton's method.
        let strains = |law: &dyn SectionLaw, load: EndLoad| {
            let mut at = solid[0];
            for _ in 0..20 {
                let own = law.respond(pressure, at.x, at.y);
                let off = Vector2::new(own.force - load.force, own.torque - load.torque);
                at -= stiffness(&own).try_inverse().unwrap() * off;
            }
            at
        };
        let of = |law: &dyn SectionLaw| {
            [EndLoad::NONE, EndLoad { force: 0.3, torque: 0.0 }, EndLoad { force: 0.0, torque: 3e-3 }]
                .map(|load| strains(law, load))
        };
        let (rod, section) = (of(&capped), of(&tube));
        let errors = |found: [Vector2<f64>; 3]| {
            let by = |of: [Vector2<f64>; 3], load: usize, i: usize| of[load][i] - of[0][i];
            [
                (found[0].x - solid[0].x) / (solid[0].x - 1.0),
                found[0].y / solid[0].y - 1.0,
                by(found, 1, 0) / by(solid, 1, 0) - 1.0,
                by(found, 2, 1) / by(solid, 2, 1) - 1.0,
            ]
        };
        for error in errors(rod) {
            assert!(error.abs() < 5e-3, "{pressure}: {:?}, without caps {:?}", errors(rod), errors(section));
        }
        far_off = errors(section).into_iter().fold(far_off, |most, error| most.max(error.abs()));
    }
    assert!(far_off > 0.02, "caps do nothing: {far_off}");
}
