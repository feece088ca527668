use super::super::{Factorisation, lowest_modes};
use super::tube::Tube;

/// A thin rubber tube, ten diameters long, nearly incompressible.
fn rubber(bulk_modulus: f64) -> Tube {
    Tube {
        elements_around: 6,
        elements_along: 12,
        elements_through: 1,
        inner_radius: 5.0,
        outer_radius: 6.0,
        length: 110.0,
        shear_modulus: 1.0,
        bulk_modulus,
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |max, x| max.max(x.abs()))
}

#[test]
fn stiff_in_bulk_the_residual_stays_at_rounding() {
    for bulk_modulus in [10.0, 1e5] {
        let tube = rubber(bulk_modulus);
        let pattern = tube.pattern();
        let values = tube.stiffness(&pattern);
        let n = pattern.dimension();
        let mut factorisation = Factorisation::new(&pattern, &[]);
        assert_eq!(factorisation.factorise(&values).unwrap().positive, n);
        // A force and a torque on the cap.
        let mut right = vec![0.0; n];
        right[n - 4] = 1.0;
        right[n - 1] = 1.0;
        let mut solution = right.clone();
        factorisation.solve(&mut solution);
        let mut residual = vec![0.0; n];
        let scale = largest(&values) * largest(&solution);
        pattern.multiply_into(&values, &solution, &mut residual);
        let left = residual.iter().zip(&right).fold(0.0_f64, |most, (kx, b)| most.max((b - kx).abs()));
        assert!(left < 1e-14 * scale, "K/mu {bulk_modulus:.0e}: {left:.1e} of {scale:.1e}");
    }
}

#[test]
fn stretching_and_twisting_a_capped_tube_is_that_of_a_rod() {
    // Incompressible E = 3 mu; the held and the capped end stiffen it over about a radius each.
    // Twist is uniform, all that is wrong with it is the biquadratic circle, of the fourth order: 5e-3 with 6 elements.
    let tube = Tube { elements_around: 12, ..rubber(1e5) };
    let pattern = tube.pattern();
    let mut factorisation = Factorisation::new(&pattern, &[]);
    factorisation.factorise(&tube.stiffness(&pattern)).unwrap();
    let n = pattern.dimension();
    let mut solution = vec![0.0; 2 * n];
    solution[n - 4] = 1.0;
    solution[2 * n - 1] = 1.0;
    factorisation.solve(&mut solution);
    let area = std::f64::consts::PI * (6.0_f64.powi(2) - 5.0_f64.powi(2));
    let polar = std::f64::consts::FRAC_PI_2 * (6.0_f64.powi(4) - 5.0_f64.powi(4));
    let (stretch, twist) = (solution[n - 4] * 3.0 * area / 110.0, solution[2 * n - 1] * polar / 110.0);
    println!("stretch {stretch}, twist {twist} of the rod's");
    assert!((0.98..1.0).contains(&stretch));
    assert!((twist - 1.0).abs() < 5e-4);
}

#[test]
fn bending_modes_come_in_pairs_and_inertia_steps_over_them() {
    let tube = rubber(1e4);
    let pattern = tube.pattern();
    let mut values = tube.stiffness(&pattern);
    let mut factorisation = Factorisation::new(&pattern, &[]);
    factorisation.factorise(&values).unwrap();
    let modes = lowest_modes(&mut factorisation, 4, None);
    assert!(modes.iter().all(|mode| mode.error < 1e-9));
    assert!((modes[0].value / modes[1].value - 1.0).abs() < 1e-6);
    assert!((modes[2].value / modes[3].value - 1.0).abs() < 1e-6);
    assert!(modes[2].value > 5.0 * modes[1].value);
    for mode in &modes {
        let mut product = vec![0.0; pattern.dimension()];
        pattern.multiply_into(&values, &mode.vector, &mut product);
        let left =
            product.iter().zip(&mode.vector).map(|(kv, v)| (kv - mode.value * v).powi(2)).sum::<f64>().sqrt();
        // Of the size of rounding in K v.
        println!("mode {:.6e}, residual {left:.1e}", mode.value);
        assert!(left < f64::EPSILON * largest(&values));
    }
    let mut lower = |by: f64| {
        for block in 0..pattern.blocks() as u32 {
            for i in 0..pattern.size(block) {
                values[pattern.place(block, block).index(i, i)] -= by;
            }
        }
        factorisation.factorise(&values).unwrap().negative
    };
    assert_eq!(lower(0.99 * modes[0].value), 0);
    assert_eq!(lower(0.02 * modes[0].value), 2);
    assert_eq!(lower(modes[3].value - modes[0].value), 4);
}
