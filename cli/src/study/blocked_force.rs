//! Wrenches that the paper's modules give to a plate that is held.

use super::{
    bench::{Bench, steps},
    findings::{Finding, Findings, Titled, Verdict},
    module_rods::{GREATEST_KPA, KINDS, SPACING_MM},
};
use crate::{
    exit::Exit,
    failure::Failure,
    interrupt,
    plot::{Chart, Mark, Series},
};
use actuator::{ConvexPolygon, PoseChart, units::MM};
use fe::{BendingSweep, BlockedForces, BlockedSweep, Run};

/// Force along the axis and moment about it.
const PLANE: [usize; 2] = [2, 5];

/// The outline of a set, N and N mm.
fn outline(set: &ConvexPolygon) -> Vec<(f64, f64)> {
    set.closed().map(|[force, moment]| (force, moment / MM)).collect()
}

/// Adds the sets of the modules, held at rest, and what they say.
pub fn judge(bench: &Bench, findings: &mut Findings) -> Result<(), Failure> {
    let count = if bench.coarse { 2 } else { 5 };
    let found = bench.each("blocked forces", &KINDS, |kind| -> Result<BlockedForces, Failure> {
        let module = kind.module(SPACING_MM, 0);
        let axis: Vec<f64> = std::iter::once(0.0).chain(steps(GREATEST_KPA, count)).collect();
        let rest = PoseChart { position: [0.0, 0.0, module.length()], ..PoseChart::default() };
        let run = Run { jobs: 1, progress: &|_, _| (), stop: interrupt::flag() };
        // A shear-soft rod under tension buckles where the pull passes its shear stiffness, that of a bare tube first: stability needs the
        // laws from solids.
        let bending = (!bench.coarse).then(BendingSweep::default);
        let sweep = BlockedSweep { bending, ..BlockedSweep::default() };
        let forces = sweep.module(&module, &rest, vec![axis; module.frees.len()], &run);
        forces.map_err(|error| Failure::new(Exit::NotConverged, error))?.ok_or_else(Failure::interrupted)
    })?;
    let bending = if bench.coarse { "bending as bare tubes" } else { "bending by laws from solids" };
    let mut table = Titled::new(
        format!(
            "Modules held at rest without ties, 0 to 50 kPa: force along the axis and moment about it; {bending}"
        ),
        ["<module", "force (N)", "moment (N mm)", "area (N · N mm)", "of the zonotope", "<states"],
    );
    let mut chart = Chart {
        subtitle: "lines: all pressures; dashed: zonotope, linear at rest".into(),
        ..Chart::new(
            "Blocked forces of the paper's modules, simulated",
            "force along the axis (N)",
            "moment about it (N mm)",
        )
    };
    let mut told = vec![];
    for (colour, (kind, forces)) in KINDS.iter().zip(&found).enumerate() {
        let (set, linear) = (forces.shadow(PLANE), forces.linear.shadow(PLANE));
        let (force, moment) = (set.extent(0), set.extent(1));
        let missing = forces.states.iter().filter(|state| state.is_none()).count();
        let unstable = forces.states.iter().flatten().filter(|state| state.is_unstable()).count();
        table.rows.push(vec![
            kind.name.into(),
            format!("{:.2} to {:.2}", force.0, force.1),
            format!("{:.1} to {:.1}", moment.0 / MM, moment.1 / MM),
            format!("{:.1}", set.area() / MM),
            // FREEs of one hand and angle give a line.
            match linear.area() > 1e-6 * (force.1 - force.0) * (moment.1 - moment.0) {
                true => format!("{:.2}", set.area() / linear.area()),
                false => "a line".into(),
            },
            format!(
                "{} of {}, {unstable} of them unstable",
                forces.states.len() - missing,
                forces.states.len()
            ),
        ]);
        told.push(format!(
            "{} {:.2} to {:.2} N, {:.0} to {:.0} N mm",
            kind.name,
            force.0,
            force.1,
            moment.0 / MM,
            moment.1 / MM
        ));
        chart = chart
            .with(Series::new(kind.name, Mark::Line, outline(&set)).coloured(colour))
            .with(Series::new("", Mark::Dashed, outline(&linear)).coloured(colour));
    }
    findings.tables.push(table);
    let caption = "Convex hulls of the wrenches at all pressures, and the zonotope of Bruder et al. (2018). A positive force pushes the plate away.";
    findings.figures.push(("p13-blocked", chart.into(), caption.into()));
    findings.findings.push(Finding {
        row: "P13",
        claim: "force zonotope of a module",
        ours: format!("held at rest, without ties, to {GREATEST_KPA} kPa: {}", told.join("; ")),
        verdict: Verdict::CannotBeJudged,
        reason: "the paper has no numbers; freeact blocked computes any module at any pose".into(),
    });
    Ok(())
}
