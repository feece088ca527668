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
        BendingSample { strain: [free[0] + off.x, free[1] + off.y], compliance }
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
