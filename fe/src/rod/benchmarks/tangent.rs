//! The whole's tangent against differences of the gradient of its energy.

use crate::rod::{chain::Columns, path::Loads, path::moved, specimens::*, *};
use actuator::Module;
use nalgebra::Vector6;

type Motion = (Vector6<f64>, Vec<Vec<Vector6<f64>>>);

/// Numbers in -1 to 1 without a pattern, m and rad at the size of a FREE.
fn random(rods: &RodModule, shape: &Configuration, seed: &mut f64) -> Motion {
    let mut next = || {
        *seed += 1.0;
        let unit = |i: usize| ((*seed * 78.233 + i as f64 * 12.9898).sin() * 43758.5453).fract();
        Vector6::from_fn(|i, _| unit(i) * if i < 3 { 5e-3 } else { 1.0 })
    };
    let inner = shape.inner.iter().map(|nodes| nodes.iter().map(|_| next()).collect()).collect();
    (rods.tip.free_part(next()), inner)
}

/// With x = -K^-1 b for any b, the gradient changes along x by -b: for plates free and guided, FREEs on their own and in spacers.
#[test]
fn it_is_what_the_gradient_changes_by() {
    let hanging = left_right([0.3, 0.0, 0.9]);
    let mut guided = hanging.clone();
    guided.tip.free_dof = [true, false, true, false, true, false];
    let tied = Module { spacers: 4, ..hanging.clone() };
    for (module, pressures) in
        [(&hanging, [3e4, 1e4, 5e3, 2e4]), (&guided, [2e4, 0.0, 0.0, 1e4]), (&tied, [3e4, 1e4, 5e3, 2e4])]
    {
        let settings = RodSettings { elements: 5, ..RodSettings::default() };
        let rods = analytic(module, settings);
        let found = rods.solve(&pressures).unwrap();
        let shape = &found.configuration;
        let loads = Loads::at(&pressures);
        let chains = rods.chains(1.0);
        let system = |shape: &Configuration| rods.assemble(&chains, shape, &loads, false).unwrap();
        let mut seed = 0.0;
        for _ in 0..4 {
            let (plate, inner) = random(&rods, shape, &mut seed);
            let mut here = system(shape);
            for (chain, on_nodes) in here.chains.iter_mut().zip(&inner) {
                for (k, columns) in chain.columns.iter_mut().enumerate() {
                    let load = on_nodes.get(k).copied().unwrap_or_default();
                    *columns = Columns::from_columns(&[columns.column(0).into_owned(), load]);
                }
            }
            let factored = rods.factorise(&chains, shape, &here).unwrap();
            let (mut x, mut nodes) = factored.answer(1, &plate, &rods.tip);
            let size = nodes.iter().flatten().map(Vector6::amax).fold(x.amax(), f64::max);
            x /= size;
            nodes.iter_mut().flatten().for_each(|xi| *xi /= size);
            let (along, on_nodes) = random(&rods, shape, &mut seed);
            let slope = |h: f64| {
                let there = moved(shape, &x, &nodes, h);
                rods.slope_along(&chains, &there, &system(&there), (&along, &on_nodes))
            };
            // Fourth order in a step of 1e-3 rad.
            let h = 1e-3;
            let change = (slope(-2.0 * h) - 8.0 * slope(-h) + 8.0 * slope(h) - slope(2.0 * h)) / (12.0 * h);
            let pairs = inner.iter().flatten().zip(on_nodes.iter().flatten());
            let expected = -(plate.dot(&along) + pairs.map(|(a, b)| a.dot(b)).sum::<f64>()) / size;
            let scale = (plate.norm_squared()
                + inner.iter().flatten().map(Vector6::norm_squared).sum::<f64>())
                / size;
            assert!((change - expected).abs() < 1e-5 * scale, "{change} {expected} {scale}");
        }
    }
}
