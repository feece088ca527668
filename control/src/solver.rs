use crate::{
    Answer, Bounds, Preference, Solution, Status, Target, Tolerance, WorkspaceTable,
    descent::{descend, step_program},
    polish::{MET, minimise, restore},
    preference::{Objective, Programs, prefer},
    problem::{Point, Problem},
    program::Program,
    solution::{ActiveBound, Side},
    target::Goal,
};
use rom::PoseModel;
use serde::{Deserialize, Serialize};

/// Everything a solve depends on besides the model: what a log keeps to compute the solve again, bit for bit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolveInput {
    /// Where the tip shall be.
    pub target: Target,
    /// Pressures that may be used.
    pub bounds: Bounds,
    /// Choice among equals.
    pub preference: Preference,
    /// Pressures of now, Pa: the first start, and what changes are counted from. Outside the bounds it is moved onto them.
    pub from: Option<Vec<f64>>,
    /// Greatest change of each pressure from `from`, Pa; needs `from`. With it the search starts from there only; where that does
    /// not reach the target but pressures farther away do, the answer is a step towards those.
    pub step_limit: Option<f64>,
    /// Starts taken from the table of the workspace; four times as many are tried before a target counts as unreachable.
    /// Default 4. With 0, only `from` (or, without it, the middle of the bounds) is tried, and nothing beyond one step.
    pub starts: usize,
    /// When the target counts as reached.
    pub tolerance: Tolerance,
}

/// How many times as far off as the nearest pose within a step the tip may be on the way to pressures that reach the target.
/// Targets a tenth of a millimetre outside the reachable set would else lead through twists of hundreds of degrees, millimetres
/// off, to another branch.
const DETOUR: f64 = 4.0;

/// Points of that way that are looked at.
const DETOUR_SAMPLES: usize = 16;

impl SolveInput {
    /// A target within bounds, with the defaults for everything else.
    pub fn new(target: Target, bounds: Bounds) -> Self {
        SolveInput {
            target,
            bounds,
            preference: Preference::default(),
            from: None,
            step_limit: None,
            starts: 4,
            tolerance: Tolerance::default(),
        }
    }
}

/// Solves for one model, keeping the table of the workspace and Clarabel's solvers between calls. Answers do not depend on
/// what was solved before.
pub struct Solver<'m, M: PoseModel + ?Sized> {
    model: &'m M,
    table: Option<WorkspaceTable>,
    steps: Program,
    preferences: Programs,
}

/// Solves once; [`Solver`] does the same faster when there is more to solve.
pub fn solve<M: PoseModel + ?Sized>(model: &M, input: &SolveInput) -> Solution {
    Solver::new(model).solve(input)
}

impl<'m, M: PoseModel + ?Sized> Solver<'m, M> {
    /// A solver for a model.
    pub fn new(model: &'m M) -> Self {
        let steps = step_program(model.domain().len());
        Solver { model, table: None, steps, preferences: Programs::default() }
    }

    /// The model it solves for.
    pub fn model(&self) -> &'m M {
        self.model
    }

    /// Pressures for a target. Never fails otherwise than by [`Status::Refused`] with the reason.
    pub fn solve(&mut self, input: &SolveInput) -> Solution {
        let mut iterations = 0;
        match self.try_solve(input, &mut iterations) {
            Ok(solution) => solution,
            Err(reason) => Solution::refused(reason, iterations),
        }
    }

    fn try_solve(&mut self, input: &SolveInput, iterations: &mut usize) -> Result<Solution, String> {
        let goal = Goal::new(&input.target)?;
        let domain = self.model.domain();
        if domain.is_empty() {
            return Err("the model has no FREE".into());
        }
        if let Some(complaint) = input.bounds.complaint(domain) {
            return Err(complaint);
        }
        for (name, value) in [("position", input.tolerance.position), ("rotation", input.tolerance.rotation)]
        {
            if !(value > 0.0 && value.is_finite()) {
                return Err(format!("the {name} tolerance is {value}; give a positive number"));
            }
        }
        let (lower, upper) = search_box(input)?;
        let objective = objective(input)?;
        let mut problem = Problem::new(self.model, goal, lower, upper);
        let mut best: Option<(Point, bool, f64)> = None;
        let mut tried = 0;
        for (number, start) in self.starts(input, &problem)?.enumerate() {
            // More starts than asked for are only for targets that no start has reached yet.
            let met = best.as_ref().is_some_and(|(_, met, _)| *met);
            if met && number >= input.starts.max(1) {
                break;
            }
            tried += 1;
            let found = self.search(&mut problem, &objective, start, iterations)?;
            if best.as_ref().is_none_or(|best| is_better(&found, best)) {
                best = Some(found);
            }
        }
        let Some((point, ..)) = best else {
            return Err("the module has no stable state at any of the pressures that a search could start from; no pressures are given".into());
        };
        let pressures = point.pressures.clone();
        let local = conclude(input, &problem, point, *iterations, tried)?;
        if local.status == Status::Reached || input.step_limit.is_none() || input.starts == 0 {
            return Ok(local);
        }
        let (Some(goal), Some(from)) = (self.beyond_one_step(input, iterations)?, &input.from) else {
            return Ok(local);
        };
        match towards(&goal, from, &pressures, &problem.lower, &problem.upper) {
            None => Ok(local),
            Some(pressures) => {
                if !self.is_worth(&local, &problem, from, &goal)? {
                    return Ok(local);
                }
                let point = problem.evaluate(pressures)?;
                let mut solution = conclude(input, &problem, point, *iterations, tried)?;
                solution.reason = format!("on the way to pressures that reach it: {}", solution.reason);
                Ok(solution)
            }
        }
    }

    /// The pressures nearest to those of now that reach the target, where any do, however many steps away.
    fn beyond_one_step(
        &mut self,
        input: &SolveInput,
        iterations: &mut usize,
    ) -> Result<Option<Vec<f64>>, String> {
        let anywhere = SolveInput { step_limit: None, preference: Preference::LeastChange, ..input.clone() };
        let solution = self.try_solve(&anywhere, iterations)?;
        let reached = solution.status == Status::Reached;
        Ok(solution.answer.filter(|_| reached).map(|answer| answer.pressures))
    }

    /// Whether the way from the pressures of now to `goal` is worth what it mends: nowhere on it the pose is farther off than
    /// [`DETOUR`] times as far as now.
    fn is_worth(
        &self,
        local: &Solution,
        problem: &Problem<M>,
        from: &[f64],
        goal: &[f64],
    ) -> Result<bool, String> {
        let Some(answer) = &local.answer else { return Ok(true) };
        let at = |part: f64| -> Vec<f64> {
            from.iter().zip(goal).map(|(from, goal)| from + part * (goal - from)).collect()
        };
        let bounds = self.model.domain();
        let mut probe = Problem::new(
            self.model,
            problem.goal.clone(),
            bounds.iter().map(|bound| bound.0).collect(),
            bounds.iter().map(|bound| bound.1).collect(),
        );
        let now = probe.evaluate(answer.pressures.clone())?.error.norm();
        for sample in 1..DETOUR_SAMPLES {
            let mut pressures = at(sample as f64 / DETOUR_SAMPLES as f64);
            probe.clamp(&mut pressures);
            if probe.evaluate(pressures)?.error.norm() > DETOUR * now {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Pressures to start from, in the order they are tried.
    fn starts(
        &mut self,
        input: &SolveInput,
        problem: &Problem<M>,
    ) -> Result<std::vec::IntoIter<Vec<f64>>, String> {
        let mut starts = Vec::new();
        if let Some(from) = &input.from {
            let mut from = from.clone();
            problem.clamp(&mut from);
            starts.push(from);
        } else if input.starts == 0 {
            starts.push(
                problem
                    .lower
                    .iter()
                    .zip(&problem.upper)
                    .map(|(lower, upper)| lower + 0.5 * (upper - lower))
                    .collect(),
            );
        }
        if input.starts > 0 && input.step_limit.is_none() {
            if self.table.as_ref().is_none_or(|table| table.bounds() != &input.bounds) {
                let table =
                    WorkspaceTable::new(self.model, &input.bounds).map_err(|outside| outside.to_string())?;
                self.table = Some(table);
            }
            if let Some(table) = &self.table {
                let nodes = table.nearest(&problem.goal, input.starts.saturating_mul(4));
                starts.extend(nodes.into_iter().map(|node| table.pressures(node)));
            }
        }
        Ok(starts.into_iter())
    }

    /// The minimum that a start leads to: the point, whether it meets the target, and the objective there.
    fn search(
        &mut self,
        problem: &mut Problem<M>,
        objective: &Objective,
        start: Vec<f64>,
        iterations: &mut usize,
    ) -> Result<(Point, bool, f64), String> {
        let mut point = problem.evaluate(start)?;
        *iterations += descend(problem, &mut self.steps, &mut point)?;
        let nothing_held = vec![false; problem.count()];
        let mut met = point.error.norm() <= MET || restore(problem, &mut point, &nothing_held, iterations)?;
        if !met {
            minimise(problem, &mut point, iterations)?;
            met = restore(problem, &mut point, &nothing_held, iterations)?;
        }
        if met {
            prefer(problem, &mut self.preferences, objective, &mut point, iterations)?;
        }
        let value = objective.value(&point.pressures, problem.scale);
        Ok((point, met, value))
    }
}

/// The step on the straight line from the pressures of now to `goal`, as far as the box allows; `None` where the step found by
/// the search, to `found`, goes there too: where it brings the pressure farthest from its goal nearer by half of that.
/// So a target is reached in twice the time its pressures need, and no local minimum on the way holds the search.
fn towards(goal: &[f64], from: &[f64], found: &[f64], lower: &[f64], upper: &[f64]) -> Option<Vec<f64>> {
    let left =
        |pressures: &[f64]| pressures.iter().zip(goal).map(|(p, goal)| (p - goal).abs()).fold(0.0, f64::max);
    let mut fraction = 1.0f64;
    for free in 0..goal.len() {
        let whole = goal[free] - from[free];
        let room = if whole > 0.0 { upper[free] - from[free] } else { lower[free] - from[free] };
        if whole != 0.0 {
            fraction = fraction.min((room / whole).max(0.0));
        }
    }
    let along =
        |free: usize| (from[free] + fraction * (goal[free] - from[free])).clamp(lower[free], upper[free]);
    let straight: Vec<f64> = (0..goal.len()).map(along).collect();
    let (now, ours, theirs) = (left(from), left(&straight), left(found));
    (now - theirs < 0.5 * (now - ours)).then_some(straight)
}

/// Meeting the target counts before everything, then the distance (unless both meet it), then the preference; differences in
/// the tenth digit do not, so that the earlier start wins a tie.
fn is_better(a: &(Point, bool, f64), b: &(Point, bool, f64)) -> bool {
    match (a.1, b.1) {
        (true, false) => true,
        (false, true) => false,
        (true, true) => a.2 < b.2 - 1e-9 * b.2.abs(),
        (false, false) => {
            let (cost_a, cost_b) = (a.0.cost(), b.0.cost());
            cost_a < cost_b * (1.0 - 1e-9)
                || (cost_a <= cost_b * (1.0 + 1e-9) && a.2 < b.2 - 1e-9 * b.2.abs())
        }
    }
}

/// The bounds, narrowed to what one step allows.
fn search_box(input: &SolveInput) -> Result<(Vec<f64>, Vec<f64>), String> {
    let Bounds { lower, upper, .. } = &input.bounds;
    if let Some(from) = &input.from {
        if from.len() != lower.len() {
            return Err(format!("{} start pressures for {} FREEs; give one each", from.len(), lower.len()));
        }
        if let Some(free) = from.iter().position(|pressure| !pressure.is_finite()) {
            return Err(format!(
                "the start pressure of p{} is {}; give a finite number",
                free + 1,
                from[free]
            ));
        }
    }
    let Some(step) = input.step_limit else { return Ok((lower.clone(), upper.clone())) };
    if !(step >= 0.0 && step.is_finite()) {
        return Err(format!("the step limit is {step} Pa; give a number of at least zero"));
    }
    let Some(from) = &input.from else { return Err("a step limit needs the pressures to step from".into()) };
    let mut narrowed = (lower.clone(), upper.clone());
    for (free, &now) in from.iter().enumerate() {
        narrowed.0[free] = lower[free].max(now - step);
        narrowed.1[free] = upper[free].min(now + step);
        if narrowed.0[free] > narrowed.1[free] {
            return Err(format!(
                "p{} stands at {:.3} kPa, more than one step of {:.3} kPa from its bounds {:.3} to {:.3} kPa; bring it there first",
                free + 1,
                now / 1e3,
                step / 1e3,
                lower[free] / 1e3,
                upper[free] / 1e3
            ));
        }
    }
    Ok(narrowed)
}

fn objective(input: &SolveInput) -> Result<Objective, String> {
    let Bounds { lower, upper, .. } = &input.bounds;
    Ok(match input.preference {
        Preference::LeastPressure => Objective::Distance { centre: vec![0.0; lower.len()] },
        Preference::LeastChange => match &input.from {
            Some(from) => Objective::Distance { centre: from.clone() },
            None => {
                return Err(
                    "least change needs the pressures to change from; give the pressures of now".into()
                );
            }
        },
        Preference::Margin => {
            let half_width: Vec<f64> =
                lower.iter().zip(upper).map(|(lower, upper)| 0.5 * (upper - lower)).collect();
            Objective::Excursion {
                middle: lower.iter().zip(&half_width).map(|(lower, half)| lower + half).collect(),
                half_width,
            }
        }
    })
}

/// Measures and judges the point in the target's own units, and checks what must hold of any answer.
fn conclude<M: PoseModel + ?Sized>(
    input: &SolveInput,
    problem: &Problem<M>,
    point: Point,
    iterations: usize,
    tried: usize,
) -> Result<Solution, String> {
    let n = problem.count();
    if point.is_unstable() {
        return Err(
            "the search found only pressures at which the module has no stable state; no pressures are given"
                .into(),
        );
    }
    let Bounds { lower, upper, limit } = &input.bounds;
    for (free, pressure) in point.pressures.iter().enumerate() {
        if !(lower[free] <= *pressure && *pressure <= upper[free]) {
            return Err(format!(
                "the search left the bounds of p{}: {pressure} Pa; no pressures are given",
                free + 1
            ));
        }
    }
    let mut active_bounds = Vec::new();
    for free in 0..n {
        let pressure = point.pressures[free];
        let sides = [
            (pressure == lower[free], Side::Min),
            (pressure == upper[free], Side::Max),
            (pressure == problem.lower[free] && pressure != lower[free], Side::RateDown),
            (pressure == problem.upper[free] && pressure != upper[free], Side::RateUp),
        ];
        active_bounds
            .extend(sides.into_iter().filter(|side| side.0).map(|(_, side)| ActiveBound { free, side }));
    }
    let pose = point.chart.to_pose();
    let position_error = (pose.position - problem.goal.position).norm();
    let rotation_error = problem.goal.has_rotation.then(|| pose.rotation.angle_to(&problem.goal.rotation));
    let stationarity = problem.stationarity(&point);
    let position_reached = problem.goal.position_weight == 0.0 || position_error <= input.tolerance.position;
    let rotation_reached = problem.goal.rotation_weight == 0.0
        || rotation_error.is_none_or(|error| error <= input.tolerance.rotation);
    let (status, reason) = if position_reached && rotation_reached {
        (Status::Reached, String::new())
    } else {
        let mut reason =
            format!("the nearest pose found from {tried} starts is {:.3} mm", position_error * 1e3);
        if let Some(error) = rotation_error {
            reason += &format!(" and {:.3} degrees", error.to_degrees());
        }
        reason += " away";
        if !active_bounds.is_empty() {
            let names: Vec<String> = active_bounds.iter().map(ActiveBound::to_string).collect();
            reason += &format!("; held by {}", names.join(", "));
        }
        // Newton's method ends far below this wherever the model is smooth.
        if stationarity > 1e-6 {
            reason += &format!(
                "; a nearer one may exist, the search ended with a relative slope of {stationarity:.1e}"
            );
        }
        (Status::Unreachable, reason)
    };
    let limit_margin = limit
        .iter()
        .zip(&point.pressures)
        .map(|(limit, pressure)| limit - pressure)
        .fold(f64::INFINITY, f64::min);
    let answer = Answer {
        pressures: point.pressures,
        chart: point.chart,
        position_error,
        rotation_error,
        active_bounds,
        limit_margin,
        stationarity,
    };
    Ok(Solution { status, answer: Some(answer), iterations, reason })
}
