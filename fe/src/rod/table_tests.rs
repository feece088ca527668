use super::*;
use crate::ThickTube;
use actuator::{Elastomer, Fibre, Handedness, OgdenForm, PathEnd, Tube, Winding};
use std::sync::atomic::AtomicBool;

fn free(angle_deg: f64, law: FibreLaw) -> Free {
    let fibre = Fibre { axial_stiffness: 644.0, diameter: 3e-4, law };
    Free {
        tube: Tube { length: 0.175, inner_radius: 4.76e-3, wall: 0.8e-3 },
        winding: Winding::from_hoop(angle_deg.to_radians(), Handedness::Right, 6, fibre),
        elastomer: Elastomer::Ogden { shear_modulus: 0.393e6, alpha: 1.2, form: OgdenForm::InitialModulus },
    }
}

fn free_path(tube: &ThickTube, pressure_max: f64) -> FreePath {
    let states = (0..=10).filter_map(|i| tube.free_state(pressure_max * i as f64 / 10.0).ok()).collect();
    FreePath::solved(states, PathEnd::Range)
}

fn table(free: &Free, pressure_max: f64) -> (ThickTube, SectionTable) {
    let tube = ThickTube::new(free);
    let grid = TableGrid::for_free(free, &free_path(&tube, pressure_max), pressure_max);
    let stop = AtomicBool::new(false);
    let run = Run { jobs: 2, progress: &|_, _| (), stop: &stop };
    let law = tube.clone();
    let table = SectionTable::tabulate(grid, &move |p, l, t| law.section(p, l, t), &run).unwrap();
    (tube, table)
}

/// Numbers in [0, 1) without a pattern.
fn random(seed: usize) -> f64 {
    ((seed as f64 * 78.233 + 1.7).sin() * 43758.5453).rem_euclid(1.0)
}

#[test]
fn force_torque_and_stiffness_are_derivatives_of_one_energy() {
    let (_, table) = table(&free(30.0, FibreLaw::TensionOnly), 5e4);
    for seed in 0..200 {
        let [a, b, c] = [0, 1, 2].map(|i| random(3 * seed + i));
        let (p, stretch, twist) = (5e4 * a, 0.97 + 0.1 * b, -45.0 + 75.0 * c);
        assert!(table.covers(p, stretch, twist), "{p} {stretch} {twist}");
        let here = table.respond(p, stretch, twist);
        // Inside a cell the law is a polynomial; a step that leaves the cell would meet a jump in the second derivative.
        let (h, k, q) = (1e-6, 1e-3, 1.0);
        let along = |i: usize, f: &dyn Fn(SectionResponse) -> f64| {
            let [ahead, behind] = [1.0, -1.0].map(|n| {
                let (dp, dl, dt) = [(n * q, 0.0, 0.0), (0.0, n * h, 0.0), (0.0, 0.0, n * k)][i];
                f(table.respond(p + dp, stretch + dl, twist + dt))
            });
            (ahead - behind) / (2.0 * [q, h, k][i])
        };
        let close = |difference: f64, exact: f64, size: f64, what: &str| {
            assert!(
                (difference - exact).abs() < 1e-5 * size,
                "{what} at {p} {stretch} {twist}: {difference} {exact}"
            );
        };
        close(along(1, &|r| r.energy), here.force, 10.0, "N");
        close(along(2, &|r| r.energy), here.torque, 0.05, "M");
        close(along(1, &|r| r.force), here.stiffness[0][0], 500.0, "N_lambda");
        close(along(2, &|r| r.force), here.stiffness[0][1], 2.0, "N_tau");
        close(along(1, &|r| r.torque), here.stiffness[1][0], 2.0, "M_lambda");
        close(along(2, &|r| r.torque), here.stiffness[1][1], 0.01, "M_tau");
        close(along(0, &|r| r.energy), -table.volume(p, stretch, twist), 1e-4, "V");
        let [force, torque] = table.pressure_slopes(p, stretch, twist);
        close(along(0, &|r| r.force), force, 1e-3, "N_p");
        close(along(0, &|r| r.torque), torque, 1e-5, "M_p");
    }
}

#[test]
fn first_derivatives_are_continuous_across_cells_and_edges() {
    let (_, table) = table(&free(30.0, FibreLaw::TensionOnly), 5e4);
    let grid = table.grid().clone();
    let size = |(low, high, count): (f64, f64, usize)| (high - low) / (count - 1) as f64;
    let jump = |a: SectionResponse, b: SectionResponse| {
        ((a.force - b.force) / 10.0).abs().max(((a.torque - b.torque) / 0.05).abs())
    };
    for seed in 0..100 {
        let [a, b, c] = [0, 1, 2].map(|i| random(7 * seed + i));
        let p = 5e4 * a;
        let sigma = grid.sigma.0 + size(grid.sigma) * (c * (grid.sigma.2 + 1) as f64).floor();
        let stretch = grid.stretch.0 + size(grid.stretch) * (b * (grid.stretch.2 + 1) as f64).floor();
        let twist = sigma + grid.shear * (stretch - 1.0) - grid.drift * p;
        let [below, above] = [-1e-9, 1e-9].map(|e| table.respond(p, stretch + e, twist + 1e3 * e));
        assert!(jump(below, above) < 1e-6, "{p} {stretch} {twist}: {below:?} {above:?}");
    }
}

#[test]
fn the_table_is_near_the_closed_form() {
    // What matters is the tip: a force off by dN moves it by dN/N_lambda of its length, a torque by dM/M_tau. States on the
    // way that FREEs of a module go: between rest and the free state, turned both ways.
    // At 60 degrees the fibres lie so steeply that a taut tube is ten times as stiff as a slack one, and the kink bends away
    // from the grid's line.
    let cases = [
        (20.0, 6e4, 1e-3, 5e-3),
        (30.0, 5e4, 5e-4, 3e-3),
        (40.0, 5e4, 2e-3, 0.015),
        (60.0, 4e4, 0.015, 0.03),
    ];
    for (angle, pressure_max, worst_stretch, worst_twist) in cases {
        let free = free(angle, FibreLaw::TensionOnly);
        let (tube, table) = table(&free, pressure_max);
        let b = free.tube.outer_radius();
        let mut sum = [0.0; 2];
        let mut most = [0.0f64; 2];
        let count = 300;
        for seed in 0..count {
            let [x, y, z] = [0, 1, 2].map(|i| random(5 * seed + i));
            // Every third at exactly no pressure: idle FREEs.
            let p = if seed % 3 == 0 { 0.0 } else { pressure_max * x };
            let end = tube.free_state(pressure_max).unwrap();
            let stretch = 0.99 + (end.axial_stretch.max(1.0) - 0.98) * y;
            let twist = end.twist_per_length * (1.5 * z - 0.5);
            if !table.covers(p, stretch, twist) {
                continue;
            }
            let (exact, found) = (tube.respond(p, stretch, twist), table.respond(p, stretch, twist));
            let off = [
                ((found.force - exact.force) / exact.stiffness[0][0]).abs(),
                ((found.torque - exact.torque) / exact.stiffness[1][1] * b).abs(),
            ];
            for i in 0..2 {
                sum[i] += off[i] * off[i] / count as f64;
                most[i] = most[i].max(off[i]);
            }
        }
        assert!(most[0] < worst_stretch && most[1] < worst_twist, "{angle} deg: {most:?}");
        assert!(
            sum[0].sqrt() < worst_stretch / 4.0 && sum[1].sqrt() < worst_twist / 4.0,
            "{angle} deg: {sum:?}"
        );
    }
}

#[test]
fn a_finer_table_is_nearer() {
    // Linear fibres: no kink, so the force converges with the third order of the spacing.
    let free = free(30.0, FibreLaw::Linear);
    let tube = ThickTube::new(&free);
    let stop = AtomicBool::new(false);
    let run = Run { jobs: 2, progress: &|_, _| (), stop: &stop };
    let error = |cells: usize| {
        let grid = TableGrid {
            pressures: vec![0.0, 1e4, 2e4],
            stretch: (0.95, 1.1, cells + 1),
            sigma: (-40.0, 40.0, 4 * cells + 1),
            shear: 0.0,
            drift: 0.0,
        };
        let law = tube.clone();
        let table = SectionTable::tabulate(grid, &move |p, l, t| law.section(p, l, t), &run).unwrap();
        // On a plane of the table: the pressure's own error is another matter.
        let off = |seed: usize| {
            let (stretch, twist) = (0.95 + 0.15 * random(2 * seed), -40.0 + 80.0 * random(2 * seed + 1));
            (table.respond(1e4, stretch, twist).force - tube.respond(1e4, stretch, twist).force).powi(2)
        };
        (0..400).map(off).sum::<f64>().sqrt()
    };
    let order = (error(4) / error(8)).log2();
    assert!((order - 3.0).abs() < 0.4, "{order}");
}

#[test]
fn nothing_is_claimed_beyond_the_table() {
    let (_, table) = table(&free(30.0, FibreLaw::TensionOnly), 5e4);
    assert!(table.covers(0.0, 1.0, 0.0) && table.covers(5e4, 1.04, -40.0));
    for (p, stretch, twist) in [
        (5.01e4, 1.0, 0.0),
        (-1.0, 1.0, 0.0),
        (2e4, 1.4, 0.0),
        (2e4, 0.8, 0.0),
        (2e4, 1.0, 300.0),
        (2e4, 1.0, -300.0),
    ] {
        assert!(!table.covers(p, stretch, twist), "{p} {stretch} {twist}");
        assert!(table.respond(p, stretch, twist).energy.is_finite());
    }
    assert!(!table.covers(f64::NAN, 1.0, 0.0));
}

#[test]
fn holes_of_the_provider_are_holes_of_the_table() {
    let free = free(30.0, FibreLaw::Linear);
    let tube = ThickTube::new(&free);
    let stop = AtomicBool::new(false);
    let run = Run { jobs: 1, progress: &|_, _| (), stop: &stop };
    let grid = TableGrid {
        pressures: vec![0.0, 1e4, 2e4],
        stretch: (0.9, 1.1, 5),
        sigma: (-40.0, 40.0, 9),
        shear: 0.0,
        drift: 0.0,
    };
    let holed = |top: f64| {
        let law = tube.clone();
        move |p: f64, l: f64, t: f64| {
            if p > top || (p > 1.5e4 && t > 25.0) { None } else { law.section(p, l, t) }
        }
    };
    let table = SectionTable::tabulate(grid.clone(), &holed(3e4), &run).unwrap();
    assert_eq!(table.unknown_nodes(), 10);
    assert!(table.covers(1e4, 1.0, 35.0) && !table.covers(1.1e4, 1.0, 35.0) && table.covers(2e4, 1.0, 15.0));
    assert_eq!(
        SectionTable::tabulate(grid.clone(), &holed(1.5e4), &run).unwrap_err(),
        TableError::NoAnswer { pressure: 2e4 }
    );
    stop.store(true, std::sync::atomic::Ordering::Relaxed);
    assert_eq!(SectionTable::tabulate(grid.clone(), &holed(3e4), &run).unwrap_err(), TableError::Stopped);
    let reversed = TableGrid { stretch: (1.1, 0.9, 5), ..grid };
    assert!(matches!(SectionTable::tabulate(reversed, &holed(3e4), &run), Err(TableError::Grid(_))));
}

#[test]
fn a_stumble_at_one_point_is_no_hole() {
    let free = free(30.0, FibreLaw::Linear);
    let tube = ThickTube::new(&free);
    let stop = AtomicBool::new(false);
    let run = Run { jobs: 1, progress: &|_, _| (), stop: &stop };
    let grid = TableGrid {
        pressures: vec![0.0, 1e4],
        stretch: (0.9, 1.1, 5),
        sigma: (-40.0, 40.0, 9),
        shear: 0.0,
        drift: 0.0,
    };
    let law = tube.clone();
    let stumbling =
        move |p: f64, l: f64, t: f64| if (t - 10.0).abs() < 0.1 { None } else { law.section(p, l, t) };
    let table = SectionTable::tabulate(grid, &stumbling, &run).unwrap();
    assert_eq!(table.unknown_nodes(), 0);
    let (exact, found) = (tube.respond(1e4, 1.05, 10.0), table.respond(1e4, 1.05, 10.0));
    // 0.2 rad/m beside: the next terms are third derivatives, some 1e-4 of the stiffness here.
    assert!((found.torque / exact.torque - 1.0).abs() < 1e-4, "{found:?} {exact:?}");
    assert!((found.force / exact.force - 1.0).abs() < 1e-4);
}
