use super::*;
use nalgebra::Matrix2;

/// Compliances that are quadratics of the table's own kind in two coordinates, at a pressure.
fn plane(pressure: f64) -> BendingPlane {
    let free = [1.0 + 1e-6 * pressure, -3e-4 * pressure];
    let coordinates = Matrix2::new(25.0, 0.02, -3.0, 0.08);
    let sample = |x: f64, y: f64| {
        let off = coordinates.try_inverse().unwrap() * Vector2::new(x, y);
        let (u, v) = (saturated(x), saturated(y));
        let p = pressure / 5e4;
        let bending = 2e3 * (-0.3 * p + 0.1 * u - 0.05 * v + 0.02 * u * v + 0.04 * u * u).exp();
        let shear = 0.1 * (0.2 * p - 0.2 * u + 0.03 * v * v).exp();
        let mean = (bending * shear).sqrt();
        let compliance = RodCompliance {
            bending,
            shear,
            coupling: mean * (0.5 + 0.3 * p + 0.2 * v).tanh(),
            end_bending: bending * 1e-3 * (-0.4 + p + 0.2 * u),
            end_shear: shear * 1e-3 * (1.0 - v),
            end_coupling: mean * 1e-3 * (0.3 + 0.1 * u * v),
            end_lever: 0.0,
        };
        BendingSample {
            strain: [free[0] + off.x, free[1] + off.y],
            compliance,
            ends: [1e-4 * p, 0.1 * p + 0.02 * v],
        }
    };
    let around = [
        (-1.0, 0.1),
        (1.0, 0.0),
        (0.0, -1.0),
        (0.1, 1.0),
        (-0.7, -0.7),
        (0.7, -0.6),
        (-0.8, 0.7),
        (0.7, 0.7),
    ];
    BendingPlane {
        pressure,
        free: sample(0.0, 0.0),
        coordinates,
        loaded: around.map(|(x, y)| sample(x, y)).to_vec(),
    }
}

fn table() -> BendingTable {
    BendingTable::new(&[1e3, 2e4, 5e4].map(plane)).unwrap()
}

#[test]
fn the_law_passes_through_its_samples() {
    let table = table();
    for pressure in [1e3, 2e4, 5e4] {
        let plane = plane(pressure);
        for sample in plane.loaded.iter().chain([&plane.free]) {
            let [stretch, twist] = sample.strain;
            let RodCompliance { bending, shear, coupling, end_bending, end_shear, end_coupling, .. } =
                sample.compliance;
            for ends in [0.0, 60.0] {
                let s = Matrix2::new(
                    bending + ends * end_bending,
                    coupling + ends * end_coupling,
                    coupling + ends * end_coupling,
                    shear + ends * end_shear,
                );
                let [b, c, g] = table.respond(pressure, stretch, twist, ends).stiffness;
                let unit = Matrix2::new(b, c, c, g) * s;
                let size = (bending / shear).sqrt();
                let off = unit - Matrix2::identity();
                assert!(off[(0, 0)].abs() + off[(1, 1)].abs() < 1e-9, "{unit}");
                assert!(off[(0, 1)].abs() * size + off[(1, 0)].abs() / size < 1e-9 * size.max(1.0 / size));
                let [tied, none, sheared] = table.respond_tied(pressure, stretch, twist, ends).stiffness;
                assert!((tied * s[(0, 0)] - 1.0).abs() + (sheared * s[(1, 1)] - 1.0).abs() < 1e-9);
                assert_eq!(none, 0.0);
            }
        }
    }
}

#[test]
fn slopes_are_derivatives_and_the_energy_is_positive_everywhere() {
    let table = table();
    for (pressure, stretch, twist) in
        [(3e4, 1.02, -8.0), (1e4, 0.97, 14.0), (4.9e4, 1.4, -90.0), (0.0, 0.6, 60.0)]
    {
        for tied in [false, true] {
            let at = |stretch: f64, twist: f64| {
                let respond = if tied { BendingTable::respond_tied } else { BendingTable::respond };
                respond(&table, pressure, stretch, twist, 40.0)
            };
            let found = at(stretch, twist);
            let [b, c, g] = found.stiffness;
            assert!(b > 0.0 && g > 0.0 && b * g > c * c, "{found:?}");
            // Fourth-order differences in steps of a thousandth of the samples' range.
            let steps = [4e-5, 1e-2];
            for i in 0..3 {
                for (k, h) in steps.into_iter().enumerate() {
                    let moved = |e: f64| {
                        let by = [0, 1].map(|j| if j == k { e * h } else { 0.0 });
                        at(stretch + by[0], twist + by[1])
                    };
                    let difference = |value: &dyn Fn(&BendingResponse) -> f64| {
                        let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|e| value(&moved(e)));
                        (a - 8.0 * b + 8.0 * c - d) / (12.0 * h)
                    };
                    let size = found.stiffness[i].abs().max(1e-30) / h;
                    let slope = difference(&|r| r.stiffness[i]);
                    assert!((slope - found.slopes[k][i]).abs() < 1e-9 * size, "{i} {k} {slope} {found:?}");
                    for (j, other) in steps.into_iter().enumerate() {
                        let second = difference(&|r| r.slopes[j][i]);
                        let exact = found.curvatures[j + k][i];
                        assert!(
                            (second - exact).abs() < 1e-9 * size / other,
                            "{i} {j} {k}: {second} {exact}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn samples_far_apart_and_ends_stiffer_than_their_zone_leave_the_energy_positive_and_bounded() {
    // Threads that go slack: fifty times more flexible on one side, and caps that hold more than the whole end zone.
    let planes = [1e3, 2e4, 5e4].map(|pressure| {
        let mut plane = plane(pressure);
        for sample in plane.loaded.iter_mut().take(3) {
            let slack = RodCompliance { bending: 1e5, coupling: 90.0, ..sample.compliance };
            sample.compliance = RodCompliance { end_bending: -4e3, end_coupling: 3.0, ..slack };
        }
        plane
    });
    let table = BendingTable::new(&planes).unwrap();
    let samples = || planes.iter().flat_map(|plane| plane.loaded.iter().chain([&plane.free]));
    let least = samples().map(|sample| sample.compliance.bending).fold(f64::INFINITY, f64::min);
    let most = samples().map(|sample| sample.compliance.bending).fold(0.0, f64::max);
    let mut kept = 0;
    for pressure in (0..=50).map(|kpa| 1e3 * f64::from(kpa)) {
        for (stretch, twist) in
            [(1.0, 0.0), (1.3, -90.0), (0.9, 60.0), (1.02, 14.0), (0.97, -14.0), (1.1, 3.0)]
        {
            for ends in [0.0, 40.0, 150.0] {
                let found = table.respond(pressure, stretch, twist, ends);
                let [b, c, g] = found.stiffness;
                assert!(
                    b > 0.0 && g > 0.0 && b * g > c * c,
                    "{pressure} {stretch} {twist} {ends}: {found:?}"
                );
                let compliance = g / (b * g - c * c);
                if ends == 0.0 {
                    // Half the range beyond twice the range of the samples, in logarithms.
                    let room = (most / least).powf(1.5);
                    assert!(compliance > least / room && compliance < most * room, "{compliance}");
                }
                kept += usize::from(ends > 100.0);
            }
        }
    }
    assert!(kept > 100);
}

#[test]
fn what_keeps_numbers_in_bounds_has_two_derivatives() {
    for x in [-9.0, -1.3, -0.51, -0.49, 0.2] {
        let of = |x: f64| kept_above(Jet::variable(x, 0), -0.5, 0.4);
        let (found, h) = (of(x), 1e-4);
        let [behind, ahead] = [-h, h].map(|h| of(x + h));
        assert!(((ahead.value - behind.value) / (2.0 * h) - found.gradient[0]).abs() < 1e-7);
        assert!(((ahead.gradient[0] - behind.gradient[0]) / (2.0 * h) - found.hessian[(0, 0)]).abs() < 1e-6);
        assert!(found.value > -0.9 && (x < -0.5 || found.value == x));
        let mirrored = kept_below(Jet::variable(-x, 0), 0.5, 0.4);
        assert_eq!(mirrored.value, -found.value);
    }
    // Continuous over the join in value, slope and curvature.
    let [below, above] = [-0.5 - 1e-9, -0.5 + 1e-9].map(|x| kept_above(Jet::variable(x, 0), -0.5, 0.4));
    assert!((below.gradient[0] - above.gradient[0]).abs() < 1e-7);
    assert!((below.hessian[(0, 0)] - above.hessian[(0, 0)]).abs() < 1e-6);
}
