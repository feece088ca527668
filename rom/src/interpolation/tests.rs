use super::*;
use evaluator::OutsideGrid;

/// Uneven nodes, finer towards the upper end.
fn uneven(lower: f64, upper: f64, count: usize) -> Vec<f64> {
    let step = |i: usize| i as f64 / (count.max(2) - 1) as f64;
    (0..count).map(|i| lower + (upper - lower) * (step(i) * (1.6 - 0.6 * step(i)))).collect()
}

fn table<const OUT: usize>(nodes: &[Vec<f64>], function: impl Fn(&[f64]) -> [f64; OUT]) -> Vec<[f64; OUT]> {
    let count: usize = nodes.iter().map(Vec::len).product();
    (0..count)
        .map(|entry| {
            let mut rest = entry;
            let mut point = vec![0.0; nodes.len()];
            for (x, axis) in point.iter_mut().zip(nodes).rev() {
                *x = axis[rest % axis.len()];
                rest /= axis.len();
            }
            function(&point)
        })
        .collect()
}

fn fit<const OUT: usize>(nodes: &[Vec<f64>], function: impl Fn(&[f64]) -> [f64; OUT]) -> TensorSpline<OUT> {
    interpolate(nodes.to_vec(), table(nodes, function)).unwrap()
}

/// Points spread over the box of the nodes (additive recurrence with the plastic number's powers), ends included.
fn points(nodes: &[Vec<f64>], count: usize) -> Vec<Vec<f64>> {
    let place = |axis: &Vec<f64>, u: f64| axis[0] + u * (axis[axis.len() - 1] - axis[0]);
    let mut all: Vec<Vec<f64>> = (0..count)
        .map(|k| {
            let spread = |d: usize| (0.5 + (k + 1) as f64 * 0.754_877_666f64.powi(d as i32 + 1)).fract();
            nodes.iter().enumerate().map(|(d, axis)| place(axis, spread(d))).collect()
        })
        .collect();
    for end in [0.0, 1.0] {
        all.push(nodes.iter().map(|axis| place(axis, end).min(axis[axis.len() - 1])).collect());
    }
    all
}

#[test]
fn polynomials_of_the_degree_are_reproduced_with_their_gradient() {
    // Degrees 3, 2, 1 and 0: seven, three, two and one node.
    let nodes = [uneven(-1.0, 2.0, 7), uneven(0.5, 1.5, 3), uneven(-2.0, -1.0, 2), vec![4.0]];
    let cubic = |x: f64| 1.0 - x + 0.5 * x * x + 0.3 * x * x * x;
    let quadratic = |y: f64| 2.0 + y * y;
    let spline =
        fit(&nodes, |p| [cubic(p[0]) * quadratic(p[1]) * (1.0 - 3.0 * p[2]) * p[3], cubic(p[0]) - p[2]]);
    for p in points(&nodes, 60) {
        let (mut value, mut gradient) = ([0.0; 2], [[0.0; 2]; 4]);
        spline.evaluate(&p, &mut value, &mut gradient).unwrap();
        let (c, q, l) = (cubic(p[0]), quadratic(p[1]), 1.0 - 3.0 * p[2]);
        let dc = -1.0 + p[0] + 0.9 * p[0] * p[0];
        let expected =
            [[dc * q * l * 4.0, dc], [c * 2.0 * p[1] * l * 4.0, 0.0], [c * q * -12.0, -1.0], [0.0; 2]];
        // Numbers of size 100 in double precision, times the small condition number of the interpolation.
        assert!((value[0] - c * q * l * 4.0).abs() < 1e-11 && (value[1] - c + p[2]).abs() < 1e-11);
        for (row, want) in gradient.iter().zip(expected) {
            for (a, b) in row.iter().zip(want) {
                assert!((a - b).abs() < 1e-10, "{p:?}: {gradient:?} for {expected:?}");
            }
        }
        let mixed = spline.partial(&p, &[2, 1, 1, 0]).unwrap()[0];
        assert!((mixed - (1.0 + 1.8 * p[0]) * 2.0 * p[1] * -12.0).abs() < 1e-9);
    }
}

#[test]
fn the_table_is_passed_through_on_a_scaled_axis() {
    // Axes in Pa and radians together: the scale of an axis must not matter.
    let nodes = [uneven(0.0, 7e4, 8), uneven(0.2, 1.4, 5)];
    let function = |p: &[f64]| [(p[0] / 3e4).sin() * p[1].exp()];
    let spline = fit(&nodes, function);
    let all = table(&nodes, |p| [p[0], p[1]]);
    for point in all {
        let (mut value, mut gradient) = ([0.0], [[0.0]; 2]);
        spline.evaluate(&point, &mut value, &mut gradient).unwrap();
        assert!((value[0] - function(&point)[0]).abs() < 1e-13);
    }
}

#[test]
fn the_gradient_is_the_derivative_in_four_and_eight_dimensions() {
    let four: Vec<Vec<f64>> = [6, 5, 7, 4].iter().map(|n| uneven(0.0, 1.0, *n)).collect();
    let eight: Vec<Vec<f64>> = [2, 3, 1, 4, 2, 5, 3, 2].iter().map(|n| uneven(0.0, 1.0, *n)).collect();
    for nodes in [four, eight] {
        let spline = fit(&nodes, |p| {
            let sum: f64 = p.iter().enumerate().map(|(d, x)| (d as f64 + 1.0) * x).sum();
            [(0.3 * sum).sin(), (0.1 * sum).exp(), sum * sum]
        });
        for mut point in points(&nodes, 20) {
            let (mut value, mut gradient) = ([0.0; 3], vec![[0.0; 3]; nodes.len()]);
            spline.evaluate(&point, &mut value, &mut gradient).unwrap();
            for axis in 0..nodes.len() {
                let here = point[axis];
                let mut orders = vec![0; nodes.len()];
                orders[axis] = 1;
                let partial = spline.partial(&point, &orders).unwrap();
                // One-sided at the ends of the box, so that no point lies outside: error of order h.
                let h = 1e-6;
                let towards = if here < 0.5 { h } else { -h };
                point[axis] = if nodes[axis].len() == 1 { here } else { here + towards };
                let (mut moved, mut unused) = ([0.0; 3], vec![[0.0; 3]; nodes.len()]);
                spline.evaluate(&point, &mut moved, &mut unused).unwrap();
                point[axis] = here;
                for output in 0..3 {
                    let difference = (moved[output] - value[output]) / towards;
                    // Truncation h/2 times second derivatives below 100.
                    assert!((difference - gradient[axis][output]).abs() < 1e-4);
                    assert!((partial[output] - gradient[axis][output]).abs() < 1e-12);
                }
            }
        }
    }
}

#[test]
fn the_error_falls_with_the_fourth_power_of_the_spacing() {
    let function = |p: &[f64]| [(2.0 * p[0]).sin() * (1.0 + p[1]).ln()];
    let error = |count: usize| {
        let nodes = [uneven(0.0, 2.0, count), uneven(0.0, 2.0, count)];
        let spline = fit(&nodes, function);
        let mut worst: (f64, f64) = (0.0, 0.0);
        for point in points(&nodes, 2000) {
            let (mut value, mut gradient) = ([0.0], [[0.0]; 2]);
            spline.evaluate(&point, &mut value, &mut gradient).unwrap();
            let slope = 2.0 * (2.0 * point[0]).cos() * (1.0 + point[1]).ln();
            worst.0 = worst.0.max((value[0] - function(&point)[0]).abs());
            worst.1 = worst.1.max((gradient[0][0] - slope).abs());
        }
        worst
    };
    let (coarse, fine) = (error(21), error(41));
    let order = (coarse.0 / fine.0).log2();
    let slope_order = (coarse.1 / fine.1).log2();
    // 4 for the value; at least 3 for the slope, whose worst error at these spacings still falls faster, at the ends.
    assert!((3.7..4.4).contains(&order), "order {order}");
    assert!(slope_order > 2.8, "order of the slope {slope_order}");
}

#[test]
fn second_derivatives_are_continuous_across_knots_and_third_ones_jump() {
    let nodes = [uneven(0.0, 3.0, 9)];
    let spline = fit(&nodes, |p| [(3.0 * p[0]).sin()]);
    let at = |x: f64, order: usize| spline.partial(&[x], &[order]).unwrap()[0];
    let jump = |knot: f64, order: usize| (at(knot + 1e-9, order) - at(knot - 1e-9, order)).abs();
    for knot in &nodes[0][2..7] {
        // The next derivative is below 1000, so 2e-9 apart nothing may change by more than 2e-6.
        for order in 0..3 {
            assert!(jump(*knot, order) < 2e-6, "derivative {order} jumps at {knot}");
        }
        assert!(jump(*knot, 3) > 1e-2, "{knot} is not a knot at all");
    }
    for not_a_knot in [nodes[0][1], nodes[0][7]] {
        assert!(jump(not_a_knot, 3) < 1e-6, "{not_a_knot} should not be a knot");
    }
}

#[test]
fn outside_is_an_error_and_never_an_extrapolation() {
    let spline = fit(&[uneven(0.0, 1.0, 5), vec![2.0]], |p| [p[0]]);
    let (mut value, mut gradient) = ([0.0], [[0.0]; 2]);
    let mut at = |x, y| spline.evaluate(&[x, y], &mut value, &mut gradient);
    assert!(at(0.5, 2.0).is_ok());
    assert_eq!(at(1.5, 2.0), Err(OutsideGrid { axis: 0, value: 1.5, lower: 0.0, upper: 1.0 }));
    assert!(at(-1e-9, 2.0).is_err());
    assert!(at(0.5, 2.1).is_err_and(|error| error.to_string().contains("coordinate 2 is 2.1")));
    assert!(at(f64::NAN, 2.0).is_err());
}

#[test]
fn tables_that_do_not_fit_are_refused() {
    let nodes = || vec![vec![0.0, 1.0], vec![0.0, 1.0, 2.0]];
    let wrong = interpolate::<1>(nodes(), vec![[0.0]; 5]);
    assert_eq!(wrong, Err(SplineError::Count { expected: 6, found: 5 }));
    let mut holed = vec![[0.0]; 6];
    holed[4] = [f64::NAN];
    assert!(interpolate(nodes(), holed).unwrap_err().to_string().contains("entry 4"));
    assert_eq!(interpolate::<1>(vec![], vec![]), Err(SplineError::Axes { count: 0 }));
    assert!(from_coefficients::<1>(nodes(), vec![f64::INFINITY; 6]).is_err());
    // Axes whose product would overflow.
    assert!(grid(vec![(0..300).map(f64::from).collect(); 8]).is_err());
}

#[test]
fn the_functions_are_a_partition_of_unity() {
    for count in 1..9 {
        let nodes: Vec<f64> = (0..count).map(|i| 3.0 + (i as f64).powf(1.4)).collect();
        let along = axis(nodes, 0).unwrap();
        let (lower, upper) = along.range();
        for step in 0..=50 {
            let x = lower + (upper - lower) * step as f64 / 50.0;
            let (first, values, slopes) = along.values_and_slopes(x);
            // Sums of four numbers of size one: a few units of rounding.
            assert!((values.iter().sum::<f64>() - 1.0).abs() < 1e-14);
            assert!(slopes.iter().sum::<f64>().abs() < 1e-12);
            assert!(first + along.degree() < count);
            assert_eq!(along.derivatives(x, 0), (first, values));
            for (a, b) in along.derivatives(x, 1).1.iter().zip(slopes) {
                assert!((a - b).abs() < 1e-13);
            }
        }
    }
}

#[test]
fn bad_nodes_are_named() {
    let message = |nodes: &[f64]| axis(nodes.to_vec(), 2).unwrap_err().to_string();
    assert!(message(&[]).contains("axis 3 has no nodes"));
    assert!(message(&[0.0, 1.0, 1.0]).contains("1 is followed by 1"));
    assert!(message(&[0.0, 2.0, 1.0]).contains("2 is followed by 1"));
    assert!(message(&[2.0, 1.0, 0.0]).contains("2 is followed by 1"));
    assert!(message(&[0.0, f64::NAN]).contains("node 1"));
    assert!(message(&[0.0, f64::INFINITY]).contains("node 1"));
    // A range that overflows leaves no room between the scaled nodes.
    assert!(message(&[-1e308, 0.0, 1e308]).contains("is followed by"));
}

#[test]
fn the_hessian_is_the_derivative_of_the_gradient() {
    let nodes: Vec<Vec<f64>> = [6, 5, 7].iter().map(|n| uneven(0.0, 1.0, *n)).collect();
    let spline = fit(&nodes, |p| [(p[0] + 2.0 * p[1]).sin() * p[2], (p[0] * p[1] * p[2]).exp()]);
    for point in points(&nodes, 20).into_iter().take(20) {
        let mut hessian = [[0.0; 2]; 9];
        spline.hessian(&point, &mut hessian).unwrap();
        for (i, axis) in nodes.iter().enumerate() {
            let h = 1e-6;
            let gradient = |by: f64| {
                let mut moved = point.clone();
                moved[i] = (moved[i] + by).clamp(axis[0], axis[axis.len() - 1]);
                let (mut value, mut gradient) = ([0.0; 2], [[0.0; 2]; 3]);
                spline.evaluate(&moved, &mut value, &mut gradient).unwrap();
                (moved[i], gradient)
            };
            let ((above, ahead), (below, behind)) = (gradient(h), gradient(-h));
            for j in 0..3 {
                for output in 0..2 {
                    let difference = (ahead[j][output] - behind[j][output]) / (above - below);
                    // Truncation h times third derivatives below 100.
                    assert!((difference - hessian[3 * i + j][output]).abs() < 1e-4);
                }
            }
        }
    }
}
