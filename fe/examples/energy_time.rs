//! How long one evaluation (energy, stress, tangent) of each rubber takes.
//!
//! `cargo run --release -p fe --example energy_time` on a quiet machine.

use actuator::{Elastomer, OgdenForm, OgdenTerm, OgdenTerms};
use fe::material::{Hyperelastic, Rubber};
use nalgebra::Matrix3;
use std::{hint::black_box, time::Instant};

const MU: f64 = 0.393e6;
const POINTS: usize = 1000;
const ROUNDS: usize = 200;

fn main() {
    let term = |share: f64, alpha| OgdenTerm { shear_modulus: share * MU, alpha };
    let ogden = |alpha| Elastomer::Ogden { shear_modulus: MU, alpha, form: OgdenForm::InitialModulus };
    let three = OgdenTerms::new(&[term(0.9, 1.3), term(0.02, 5.0), term(0.08, -2.0)]);
    let mut rubbers = vec![
        ("linear elastic", Elastomer::LinearElastic { shear_modulus: MU }),
        ("neo-Hookean", Elastomer::NeoHookean { shear_modulus: MU }),
        ("Yeoh", Elastomer::Yeoh { c10: 0.5 * MU, c20: -0.01 * MU, c30: 0.002 * MU }),
        ("Gent", Elastomer::Gent { shear_modulus: MU, locking_invariant: 80.0 }),
        ("Arruda-Boyce", Elastomer::ArrudaBoyce { shear_modulus: MU, locking_stretch: 4.0 }),
        ("Mooney-Rivlin", Elastomer::MooneyRivlin { c10: 0.45 * MU, c01: 0.05 * MU }),
        ("St Venant-Kirchhoff", Elastomer::StVenantKirchhoff { shear_modulus: MU }),
        ("Ogden, one term", ogden(1.2)),
    ];
    rubbers.extend(three.map(|terms| ("Ogden, three terms", Elastomer::OgdenSeries { terms })));
    // Near det F = 1, as in a solver; no two alike.
    let points: Vec<Matrix3<f64>> = (0..POINTS)
        .map(|point| {
            Matrix3::from_fn(|i, j| {
                let turn = (point * 9 + 3 * i + j) as f64;
                f64::from(u8::from(i == j)) + 0.15 * (1.7 * turn).sin()
            })
        })
        .collect();
    for (name, elastomer) in rubbers {
        let rubber = Rubber::from(elastomer);
        let mut best = f64::INFINITY;
        for _ in 0..ROUNDS {
            let start = Instant::now();
            for point in &points {
                black_box(rubber.answer(black_box(point)));
            }
            best = best.min(start.elapsed().as_secs_f64() / POINTS as f64);
        }
        println!("{name:20} {:6.0} ns", best * 1e9);
    }
}
