//! What the paper leaves to later: loads at the tip, several families of fibres, another rubber, blocked forces.

use super::{
    bench::{Bench, failure, steps},
    blocked_force,
    findings::{Curves, Finding, Findings, Titled, Verdict},
    module_rods::{KINDS, SPACING_MM, TIED},
    specimen::{SHEAR_MODULUS, free},
};
use crate::{
    exit::Exit,
    failure::Failure,
    interrupt,
    plot::{Field, Patch},
};
use actuator::{
    Elastomer, Handedness, Winding,
    units::{DEG, KPA, MM},
};
use fe::{
    Equilibrium, RodModule, RodSettings, SectionMesh, SectionSolver, SolidLoad, SolidMesh, SolidSolver,
    Specimen, TipLoad,
};

/// Force (N) and moment (N m) of the differences that give stiffness: small against what bends the module, large against rounding.
const LOADS: (f64, f64) = (0.01, 1e-4);

/// Computes it.
pub fn compute(bench: &Bench) -> Result<Findings, Failure> {
    let mut findings = Findings {
        setup: vec![
            "Simulated. Shown is that these things can be computed, on small cases; the paper reports nothing to compare with.".into(),
        ],
        ..Findings::default()
    };
    loads(bench, &mut findings)?;
    families(bench, &mut findings)?;
    rubber(&mut findings)?;
    blocked_force::judge(bench, &mut findings)?;
    findings.findings.push(Finding {
        row: "P13",
        claim: "dynamics",
        ours: "not there: states are in equilibrium at each instant".into(),
        verdict: Verdict::CannotBeJudged,
        reason: "the paper leaves it to later work, and so does this version".into(),
    });
    Ok(findings)
}

/// Compliance of the tip (mm/N sideways, mm/N along, degrees per N mm about the axis) and how it stands, at one set of pressures.
struct Soft {
    pressures_kpa: [f64; 2],
    compliance: [f64; 3],
    is_stable: bool,
}

/// How a module's tip gives way to forces and a moment, over the pressures of two pairs of neighbours.
fn loads(bench: &Bench, findings: &mut Findings) -> Result<(), Failure> {
    let kind = &KINDS[0];
    let module = kind.module(SPACING_MM, TIED);
    let with = |force: [f64; 3], moment: [f64; 3]| {
        let settings = RodSettings { tip_load: TipLoad { force, moment }, ..RodSettings::default() };
        bench.rods(&module, settings)
    };
    let (force, moment) = LOADS;
    let bare = bench.rods(&module, RodSettings::default())?;
    let pairs = [1.0, -1.0].map(|sign| -> Result<[RodModule; 3], Failure> {
        Ok([
            with([sign * force, 0.0, 0.0], [0.0; 3])?,
            with([0.0, 0.0, sign * force], [0.0; 3])?,
            with([0.0; 3], [0.0, 0.0, sign * moment])?,
        ])
    });
    let [ahead, behind] = pairs;
    let (ahead, behind) = (ahead?, behind?);
    let count = if bench.coarse { 3 } else { 6 };
    let at = |index: usize| 45.0 * index as f64 / (count - 1) as f64;
    let places: Vec<[f64; 2]> = (0..count * count).map(|node| [at(node / count), at(node % count)]).collect();
    let lost = |error| Failure::new(Exit::NotConverged, error);
    let found = bench.each("loads at the tip", &places, |[first, second]| {
        let pressures = [*first, *first, *second, *second].map(|kpa| kpa * KPA);
        let there = bare.solve(&pressures).map_err(lost)?;
        let moved = |rods: &RodModule| rods.solve_from(&there, &pressures).map_err(lost);
        let mut compliance = [0.0; 3];
        for (place, (ahead, behind)) in ahead.iter().zip(&behind).enumerate() {
            let (a, b) = (moved(ahead)?, moved(behind)?);
            let off = |of: &Equilibrium| {
                let (pose, chart) = (of.state.chart.to_pose(), of.state.chart);
                [pose.position.x / MM, pose.position.z / MM, chart.twist / DEG][place]
            };
            let load = [force, force, moment / MM][place];
            compliance[place] = (off(&a) - off(&b)) / (2.0 * load);
        }
        Ok(Soft { pressures_kpa: [*first, *second], compliance, is_stable: there.state.negative_pivots == 0 })
    })?;
    let head =
        vec!["p1_p2_kpa", "p3_p4_kpa", "sideways_mm_per_n", "along_mm_per_n", "twist_deg_per_nmm", "stable"];
    let rows = found.iter().map(|soft| {
        let numbers = soft.pressures_kpa.iter().chain(&soft.compliance);
        let mut row: Vec<String> = numbers.map(|number| format!("{number:.6}")).collect();
        row.push(u8::from(soft.is_stable).to_string());
        row
    });
    findings.curves.push(Curves { stem: "p13-stiffness".into(), head, rows: rows.collect() });
    let half = 0.5 * at(1);
    let patches = found.iter().map(|soft| {
        let [x, y] = soft.pressures_kpa;
        Patch {
            corners: [(x - half, y - half), (x + half, y - half), (x + half, y + half), (x - half, y + half)],
            value: 1.0 / soft.compliance[0],
        }
    });
    let field = Field {
        patches: patches.collect(),
        ..Field::new(
            format!("Sideways stiffness of the {} at its tip, tied, simulated", kind.name),
            "pressure of FREEs 1 and 2 (kPa)",
            "pressure of FREEs 3 and 4 (kPa)",
            "N/mm",
        )
    };
    findings.figures.push((
        "p13-stiffness",
        field.into(),
        "Force along x over the shift along x, by differences of ±0.01 N; each block is one computed state."
            .into(),
    ));
    let range = |place: usize| {
        let values = found.iter().map(|soft| 1.0 / soft.compliance[place]);
        values
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
    };
    let (sideways, along, twist) = (range(0), range(1), range(2));
    findings.findings.push(Finding {
        row: "P13",
        claim: "external loads",
        ours: format!(
            "{} tied, {} pairs of pressures to 45 kPa: stiffness of the tip sideways {:.3} to {:.3} N/mm, along {:.2} to {:.2} N/mm, about the axis \
             {:.3} to {:.3} N mm/°",
            kind.name,
            found.len(),
            sideways.0,
            sideways.1,
            along.0,
            along.1,
            twist.0,
            twist.1
        ),
        verdict: Verdict::CannotBeJudged,
        reason: "the paper has no numbers; loads on the tip are part of the rods' equilibrium, and the map of stiffness is a figure here".into(),
    });
    Ok(())
}

/// Two families of fibres in one tube.
fn families(bench: &Bench, findings: &mut Findings) -> Result<(), Failure> {
    let base = free(30.0, 0.3 * MM);
    let Winding { fibre, .. } = base.winding;
    let wound = |angle: f64, hand| Winding::from_hoop(angle * DEG, hand, 6, fibre);
    let (right, left) = (Handedness::Right, Handedness::Left);
    let sets = [
        ("30° right", vec![wound(30.0, right)]),
        ("30° right and 30° left", vec![wound(30.0, right), wound(30.0, left)]),
        ("30° right and 70° left", vec![wound(30.0, right), wound(70.0, left)]),
    ];
    let found = bench.each("families of fibres", &sets, |(_, windings)| {
        let mut short = base;
        short.tube.length = 40.0 * MM;
        let specimen = Specimen { windings: windings.clone(), ..Specimen::from(&short) };
        let mesh = SolidMesh::new(12, if bench.coarse { 10 } else { 24 });
        let mut solver = SolidSolver::new(&specimen, mesh).map_err(failure)?;
        let rest = solver.rest();
        let state = solver
            .follow(&rest, 0.0, &[10.0 * KPA, 20.0 * KPA], &SolidLoad::pressure, &mut |_, _| {
                !interrupt::is_asked()
            })
            .map_err(failure)?;
        Ok(solver.deformation(&state))
    })?;
    let mut table = Titled::new(
        "Families of fibres in one solid tube of 40 mm at 20 kPa, its middle",
        ["<fibres, from the hoop", "stretch", "expansion", "twist (°/mm)"],
    );
    for ((name, _), state) in sets.iter().zip(&found) {
        table.rows.push(vec![
            (*name).into(),
            format!("{:.4}", state.stretch_mid),
            format!("{:.4}", state.expansion_mid),
            format!("{:+.4}", state.twist_mid / DEG * MM),
        ]);
    }
    findings.tables.push(table);
    let twist = |place: usize| found[place].twist_mid / DEG * MM;
    findings.findings.push(Finding {
        row: "P13",
        claim: "several fibre families",
        ours: format!(
            "30° right alone turns {:+.3} °/mm at 20 kPa, with 30° left over it {:+.4} ({:.1} % of it), with 70° left {:+.3}",
            twist(0),
            twist(1),
            100.0 * (twist(1) / twist(0)).abs(),
            twist(2)
        ),
        verdict: Verdict::CannotBeJudged,
        reason: "the paper has no numbers; the solid takes any number of families. Opposite ones of one angle should cancel the twist: what is left is the error of the mesh".into(),
    });
    Ok(())
}

/// The paper's FREE of Arruda and Boyce's rubber.
fn rubber(findings: &mut Findings) -> Result<(), Failure> {
    let pressures = steps(40.0, 8);
    let rubbers = [
        ("Ogden, alpha 1.2", None),
        ("Arruda-Boyce, locks at 5", Some(5.0)),
        ("Arruda-Boyce, locks at 1.5", Some(1.5)),
    ];
    let mut rows = vec![];
    let mut table = Titled::new(
        "Rubbers of one initial shear modulus, 0.393 MPa: a 30° FREE at 40 kPa, section",
        ["<rubber", "stretch", "expansion", "twist (°/mm)"],
    );
    let mut twists = vec![];
    for (name, locking) in rubbers {
        let mut own = free(30.0, 0.3 * MM);
        if let Some(locking_stretch) = locking {
            own.elastomer = Elastomer::ArrudaBoyce { shear_modulus: SHEAR_MODULUS, locking_stretch };
        }
        let path = SectionSolver::new(&own, SectionMesh::default())
            .and_then(|mut solver| solver.path(&pressures, 0))
            .map_err(|error| Failure::new(Exit::NotConverged, error))?;
        // A path goes on to its own end.
        let within = || path.states.iter().filter(|state| state.pressure <= pressures[7] * (1.0 + 1e-9));
        for state in within() {
            let numbers = [
                state.pressure / KPA,
                state.axial_stretch,
                state.expansion,
                state.twist_per_length / DEG * MM,
            ];
            rows.push(
                std::iter::once(name.replace(',', "")).chain(numbers.map(|n| format!("{n:.6}"))).collect(),
            );
        }
        let Some(last) = within().next_back() else { continue };
        let twist = last.twist_per_length / DEG * MM;
        twists.push(format!("{name} {twist:+.3} °/mm"));
        let numbers =
            [format!("{:.4}", last.axial_stretch), format!("{:.4}", last.expansion), format!("{twist:+.4}")];
        table.rows.push(std::iter::once(name.to_owned()).chain(numbers).collect());
    }
    findings.tables.push(table);
    let head = vec!["rubber", "pressure_kpa", "axial_stretch", "expansion", "twist_per_length_deg_per_mm"];
    findings.curves.push(Curves { stem: "p13-rubber".into(), head, rows });
    findings.findings.push(Finding {
        row: "P13",
        claim: "Arruda and Boyce's rubber",
        ours: format!("at 40 kPa, 30°: {}", twists.join("; ")),
        verdict: Verdict::CannotBeJudged,
        reason: "the paper has no numbers; the model is there for sections, solids and fits to tests".into(),
    });
    Ok(())
}
