use super::*;
use crate::ThickTube;
use actuator::{
    Elastomer, Fibre, FibreLaw, FreePath, FreeState, Handedness, OgdenForm, PathEnd, Tube, Winding,
};
use std::sync::atomic::{AtomicBool, Ordering};

const MESH: SectionMesh = SectionMesh { radial: 2, under_fibre: 1, between_fibres: 1 };

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

fn table_of(free: &Free, grid: TableGrid) -> Result<SectionTable, TableError> {
    let stop = AtomicBool::new(false);
    SectionTable::new(free, grid, MESH, &Run { jobs: 2, progress: &|_, _| (), stop: &stop })
}

fn table(free: &Free, pressure_max: f64) -> (ThickTube, SectionTable) {
    let tube = ThickTube::new(free);
    let grid = TableGrid::for_free(free, &free_path(&tube, pressure_max), pressure_max);
    (tube, table_of(free, grid).unwrap())
}

fn without_threads(table: &SectionTable, mut free: Free) -> SectionTable {
    free.winding.fibre.axial_stiffness = 0.0;
    SectionTable { threads: SmearedThreads::of(&free), ..table.clone() }
}

/// Numbers in [0, 1) without a pattern.
fn random(seed: usize) -> f64 {
    ((seed as f64 * 78.233 + 1.7).sin() * 43758.5453).rem_euclid(1.0)
}

#[test]
fn force_torque_and_stiffness_are_derivatives_of_one_energy() {
    for (angle, law) in
        [(30.0, FibreLaw::TensionOnly), (75.0, FibreLaw::TensionOnly), (50.0, FibreLaw::Linear)]
    {
        let (_, table) = table(&free(angle, law), 4e4);
        let bare = without_threads(&table, free(angle, law));
        let (mut taut, mut inside) = (0, 0);
        for seed in 0..200 {
            let [a, b, c] = [0, 1, 2].map(|i| random(3 * seed + i));
            // Also on both sides of zero twist, where the wall is mirrored.
            let (p, stretch, twist) = (4e4 * a, 0.97 + 0.05 * b, -25.0 + 40.0 * c);
            assert!(table.covers(p, stretch, twist), "{p} {stretch} {twist}");
            let here = table.respond(p, stretch, twist);
            let (h, k, q) = (1e-6, 1e-3, 1.0);
            let aside = |i: usize, n: f64| {
                let (dp, dl, dt) = [(n * q, 0.0, 0.0), (0.0, n * h, 0.0), (0.0, 0.0, n * k)][i];
                [p + dp, stretch + dl, twist + dt]
            };
            let along = |i: usize, f: &dyn Fn(SectionResponse) -> f64| {
                let [ahead, behind] = [1.0, -1.0].map(|n| {
                    let [p, stretch, twist] = aside(i, n);
                    f(table.respond(p, stretch, twist))
                });
                (ahead - behind) / (2.0 * [q, h, k][i])
            };
            // Inside a cell the law is smooth; a step that leaves it, or meets the threads' kink, meets a jump in the second derivative.
            let cell = |[p, stretch, twist]: [f64; 3]| {
                let grid = table.grid();
                let volume = table.volume(p, stretch, twist) / (PI * table.radius * table.radius);
                let place = |(low, high, count): (f64, f64, usize), at: f64| {
                    ((at - low) / (high - low) * (count - 1) as f64) as usize
                };
                let outer = (volume + 1.0 - grid.own_volume) / stretch;
                let tight = table.threads.tight_at(stretch, twist * table.radius);
                let at = (twist * table.radius).abs();
                let places =
                    [place(grid.volume, volume), place(grid.stretch, stretch), place(grid.twists(), at)];
                (places, tight.is_some_and(|tight| outer > tight), twist > 0.0)
            };
            let here_cell = cell([p, stretch, twist]);
            if (0..3).any(|i| [1.0, -1.0].iter().any(|n| cell(aside(i, *n)) != here_cell)) {
                continue;
            }
            inside += 1;
            let close = |difference: f64, exact: f64, size: f64, what: &str| {
                let scale = size.max(exact.abs());
                assert!(
                    (difference - exact).abs() < 1e-5 * scale,
                    "{what} at {angle} deg {p} {stretch} {twist}: {difference} {exact}"
                );
            };
            taut += usize::from((here.force - bare.respond(p, stretch, twist).force).abs() > 1e-3);
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
        assert!(taut > 20 && inside > 180, "{angle} deg: {taut} {inside}");
    }
}

#[test]
fn first_derivatives_are_continuous_across_cells_and_edges() {
    let (_, table) = table(&free(30.0, FibreLaw::TensionOnly), 5e4);
    let grid = table.grid().clone();
    let b = table.radius;
    let size = |(low, high, count): (f64, f64, usize)| (high - low) / (count - 1) as f64;
    let jump = |a: SectionResponse, b: SectionResponse| {
        ((a.force - b.force) / 10.0).abs().max(((a.torque - b.torque) / 0.05).abs())
    };
    let mut crossed = 0;
    for seed in 0..200 {
        let [a, x, y] = [0, 1, 2].map(|i| random(7 * seed + i));
        let p = 3e4 * a;
        // Lines of the grid, one past its ends, and the mirror plane.
        let stretch = grid.stretch.0 + size(grid.stretch) * (x * (grid.stretch.2 + 1) as f64).floor();
        let twist = size(grid.twists()) * ((2.0 * y - 1.0) * grid.twist.1 as f64).round() / b;
        let [below, above] = [-1e-9, 1e-9].map(|e| table.respond(p, stretch + e, twist + 1e3 * e));
        if below.energy.is_finite() {
            assert!(jump(below, above) < 1e-6, "{p} {stretch} {twist}: {below:?} {above:?}");
            crossed += 1;
        }
    }
    assert!(crossed > 100, "{crossed}");
}

/// A state that loads on the ends of a FREE bring about, from its free state at the pressure.
fn loaded(tube: &ThickTube, pressure: f64, [force, torque]: [f64; 2]) -> Option<[f64; 2]> {
    let FreeState { axial_stretch, twist_per_length, .. } = tube.free_state(pressure).ok()?;
    let mut at = [axial_stretch, twist_per_length];
    const STEPS: usize = 20;
    for step in 1..=STEPS {
        let part = step as f64 / STEPS as f64;
        let mut left = f64::INFINITY;
        for _ in 0..40 {
            let r = tube.section(pressure, at[0], at[1])?;
            let off = [r.force - part * force, r.torque - part * torque];
            left = (off[0] / 10.0).hypot(off[1] / 0.05);
            if left < 1e-8 {
                break;
            }
            let [[a, b], [_, d]] = r.stiffness;
            let determinant = a * d - b * b;
            let change = [(d * off[0] - b * off[1]) / determinant, (a * off[1] - b * off[0]) / determinant];
            let size = (change[0].abs() / 0.01).max(change[1].abs() / 10.0).max(1.0);
            at = [at[0] - change[0] / size, at[1] - change[1] / size];
        }
        if left >= 1e-8 {
            return None;
        }
    }
    Some(at)
}

/// What matters is the tip: where the law's forces would move a FREE to that bears given loads. States that a FREE comes to in a module: idle or
/// under pressure, pulled, pushed and turned by a third of what pressure does to ends that are held.
#[test]
fn laws_of_all_windings_are_those_of_the_thick_tube() {
    for angle in [10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 75.0, 80.0] {
        let free = free(angle, FibreLaw::TensionOnly);
        let tube = ThickTube::new(&free);
        let b = free.tube.outer_radius();
        let top = 0.9 * tube.limit_state().unwrap().pressure;
        let (_, table) = table(&free, top);
        let held = tube.section(0.5 * top, 1.0, 0.0).unwrap();
        let (mut count, mut most) = (0, [0.0f64; 2]);
        for seed in 0..150 {
            let [x, y, z] = [0, 1, 2].map(|i| random(5 * seed + i));
            // Every third at exactly no pressure: idle FREEs.
            let pressure = if seed % 3 == 0 { 0.0 } else { top * x };
            let loads = [held.force * (2.0 * y - 1.0) / 3.0, held.torque * (2.0 * z - 1.0) / 3.0];
            let Some([stretch, twist]) = loaded(&tube, pressure, loads) else { continue };
            if !table.covers(pressure, stretch, twist) {
                continue;
            }
            let (exact, found) =
                (tube.respond(pressure, stretch, twist), table.respond(pressure, stretch, twist));
            let [[kl, c], [_, kt]] = exact.stiffness;
            let (force, torque) = (found.force - exact.force, found.torque - exact.torque);
            let determinant = kl * kt - c * c;
            let off = [(kt * force - c * torque) / determinant, (kl * torque - c * force) / determinant * b];
            count += 1;
            (0..2).for_each(|i| most[i] = most[i].max(off[i].abs()));
        }
        println!("{angle} deg: {count} of 150, {most:?}");
        assert!(count >= 120, "{angle} deg: {count} of 150 states are found");
        assert!(most[0] < 2e-4 && most[1] < 5e-4, "{angle} deg: {most:?}");
    }
}

#[test]
fn loose_threads_are_those_of_the_thick_tube() {
    let free = free(60.0, FibreLaw::TensionOnly);
    let (tube, table) = table(&free, 3e4);
    let (tube, table) = (tube.with_slack(0.01), table.with_slack(0.01));
    for (pressure, stretch, twist) in [(1e4, 1.0, 0.0), (3e4, 0.99, -5.0), (2e4, 1.03, 10.0)] {
        let (exact, found) =
            (tube.respond(pressure, stretch, twist), table.respond(pressure, stretch, twist));
        assert!((exact.force - found.force).abs() < 1e-5 * exact.stiffness[0][0], "{exact:?} {found:?}");
        assert!(
            (exact.torque - found.torque).abs() < 1e-8 + 2e-5 * exact.stiffness[0][1].abs(),
            "{exact:?} {found:?}"
        );
    }
    let tight = SectionTable { threads: SmearedThreads::of(&free), ..table.clone() };
    assert!((tight.respond(3e4, 1.0, 0.0).force - table.respond(3e4, 1.0, 0.0).force).abs() > 1.0);
}

#[test]
fn a_finer_table_is_nearer() {
    // The force converges with the third order of the spacing, down to the error of the finite elements.
    let free = free(30.0, FibreLaw::TensionOnly);
    let tube = ThickTube::new(&free);
    let error = |cells: usize| {
        let grid = TableGrid {
            volume: (0.4, 1.4, 2 * cells + 1),
            own_volume: (free.tube.inner_radius / free.tube.outer_radius()).powi(2),
            stretch: (0.9, 1.3, cells + 1),
            twist: (0.4, cells + 1),
        };
        let table = table_of(&free, grid).unwrap();
        let off = |seed: usize| {
            let (stretch, twist) = (0.95 + 0.2 * random(2 * seed), -40.0 + 60.0 * random(2 * seed + 1));
            (table.respond(2e4, stretch, twist).force - tube.respond(2e4, stretch, twist).force).powi(2)
        };
        (0..400).map(off).sum::<f64>().sqrt()
    };
    let order = (error(4) / error(8)).log2();
    println!("order {order}");
    assert!((order - 3.0).abs() < 0.6, "{order}");
}

#[test]
fn nothing_is_claimed_beyond_the_table() {
    let (_, table) = table(&free(30.0, FibreLaw::TensionOnly), 5e4);
    let top = table.grid().twist.0 / table.radius;
    for (p, stretch, twist) in
        [(0.0, 1.0, 0.0), (5e4, 1.04, -40.0), (-1e3, 1.0, 0.0), (0.0, 1.0, 0.999 * top)]
    {
        assert!(table.covers(p, stretch, twist), "{p} {stretch} {twist}");
    }
    for (p, stretch, twist) in
        [(2e4, 1.6, 0.0), (2e4, 0.7, 0.0), (2e4, 1.0, 1.001 * top), (2e4, 1.0, -1.001 * top)]
    {
        assert!(!table.covers(p, stretch, twist), "{p} {stretch} {twist}");
        assert!(table.respond(p, stretch, twist).energy.is_finite(), "{p} {stretch} {twist}");
    }
    for (p, stretch, twist) in
        [(f64::NAN, 1.0, 0.0), (0.0, f64::NAN, 0.0), (0.0, 1.0, f64::NAN), (0.0, -1.0, 0.0)]
    {
        assert!(!table.covers(p, stretch, twist) && table.respond(p, stretch, twist).energy.is_nan());
    }
    // Where nothing holds the wall it balloons, as the tube does.
    let bare = without_threads(&table, free(30.0, FibreLaw::TensionOnly));
    let tube = ThickTube::bare(&free(30.0, FibreLaw::TensionOnly));
    let limit = (1..100).map(|kpa| 1e3 * f64::from(kpa)).find(|p| tube.section(*p, 1.0, 0.0).is_none());
    let limit = limit.unwrap();
    assert!(bare.covers(0.8 * limit, 1.0, 0.0));
    assert!(!bare.covers(limit + 2e3, 1.0, 0.0) && table.covers(limit + 2e3, 1.0, 0.0));
}

#[test]
fn what_cannot_be_tabulated_is_told() {
    let free = free(30.0, FibreLaw::Linear);
    let stop = AtomicBool::new(false);
    let run = Run { jobs: 1, progress: &|_, _| (), stop: &stop };
    let grid = TableGrid { volume: (0.5, 1.0, 5), own_volume: 0.73, stretch: (0.9, 1.1, 5), twist: (0.4, 5) };
    let wall = |top: f64| {
        let mut bare = free;
        bare.winding.fibre.axial_stiffness = 0.0;
        let mut solver = SectionSolver::new(&bare, MESH).unwrap();
        move |v: f64, l: f64, t: f64| if l > top { None } else { solver.respond_at_volume(v, l, t).ok() }
    };
    let TableError::NoAnswer { axial_stretch, .. } =
        SectionTable::tabulate(&free, grid.clone(), &wall(1.06), &run).unwrap_err()
    else {
        panic!("an answer")
    };
    assert!(axial_stretch > 1.06);
    stop.store(true, Ordering::Relaxed);
    assert_eq!(
        SectionTable::tabulate(&free, grid.clone(), &wall(2.0), &run).unwrap_err(),
        TableError::Stopped
    );
    stop.store(false, Ordering::Relaxed);
    for wrong in [
        TableGrid { stretch: (1.1, 0.9, 5), ..grid.clone() },
        TableGrid { volume: (0.0, 1.0, 5), ..grid.clone() },
        TableGrid { twist: (0.4, 1), ..grid.clone() },
    ] {
        assert!(matches!(SectionTable::tabulate(&free, wrong, &wall(2.0), &run), Err(TableError::Grid(_))));
    }
    let mut none = free;
    none.tube.wall = -1.0;
    assert!(matches!(SectionTable::new(&none, grid, MESH, &run), Err(TableError::Section(_))));
}
