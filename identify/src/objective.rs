use crate::discrepancy::{Coefficients, Discrepancy};
use crate::mechanics::Mechanics;
use crate::rows::{Arena, Rows, Samples, linearise};
use crate::setup::Setup;
use nalgebra::{DMatrix, DVector};
use rom::OutOfDomain;

/// Residuals beyond this many standard deviations count linearly (Huber): lost markers and spikes do not steer a fit.
const HUBER: f64 = 3.0;

/// Huber's loss of a whitened residual: r^2/2 inside, linear outside.
pub fn huber(residual: f64) -> f64 {
    let size = residual.abs();
    if size <= HUBER { 0.5 * size * size } else { HUBER * (size - 0.5 * HUBER) }
}

/// Weight that makes a squared residual count as Huber's loss does, for one step of reweighted least squares.
fn huber_weight(residual: f64) -> f64 {
    let size = residual.abs();
    if size <= HUBER { 1.0 } else { HUBER / size }
}

/// One kind of residual in an objective.
pub struct Part<'a> {
    /// Which residual.
    pub arena: Arena,
    /// Standard deviation of each row: noise and the base model's own error.
    pub sigma: Rows,
    /// What the base model's error may look like, where it is taken out.
    pub discrepancy: Option<&'a Discrepancy>,
}

/// Robust, weighted sum of squares over chosen samples, with what is believed of the numbers beforehand.
pub struct Objective<'a> {
    /// The base model.
    pub mechanics: &'a dyn Mechanics,
    /// The samples.
    pub samples: &'a Samples<'a>,
    /// The residuals.
    pub parts: Vec<Part<'a>>,
}

/// Whitened residuals of an objective, part by part, and the discrepancies taken out.
pub struct Whitened {
    /// Rows of each part.
    pub rows: Vec<Rows>,
    /// Discrepancy of each part that has one.
    pub discrepancies: Vec<Option<Coefficients>>,
}

fn whiten(rows: &mut Rows, sigma: &Rows) {
    for (channel, sigma) in rows.channels.iter_mut().zip(&sigma.channels) {
        for (value, sigma) in channel.iter_mut().zip(sigma) {
            *value /= sigma;
        }
    }
}

impl Objective<'_> {
    fn linearised(&self, setup: &Setup) -> Result<(Whitened, Vec<Vec<Rows>>), OutOfDomain> {
        let mut whitened = Whitened { rows: Vec::new(), discrepancies: Vec::new() };
        let mut all_columns = Vec::new();
        for part in &self.parts {
            let linearisation = linearise(self.mechanics, self.samples, part.arena, setup)?;
            let (mut rows, mut columns) = (linearisation.rows, linearisation.columns);
            whiten(&mut rows, &part.sigma);
            columns.iter_mut().for_each(|column| whiten(column, &part.sigma));
            let taken = part.discrepancy.map(|discrepancy| discrepancy.project(&mut rows, &mut columns));
            whitened.rows.push(rows);
            whitened.discrepancies.push(taken);
            all_columns.push(columns);
        }
        Ok((whitened, all_columns))
    }

    /// Whitened residuals under a setup.
    pub fn whitened(&self, setup: &Setup) -> Result<Whitened, OutOfDomain> {
        let still = Setup { chain: setup.chain.clone(), numbers: Vec::new() };
        Ok(self.linearised(&still)?.0)
    }

    /// Whitened derivatives under a setup, part by part, number by number, per scale of the number.
    pub fn whitened_columns(&self, setup: &Setup) -> Result<Vec<Vec<Rows>>, OutOfDomain> {
        let (_, mut all) = self.linearised(setup)?;
        for columns in &mut all {
            for (column, number) in columns.iter_mut().zip(&setup.numbers) {
                column.channels.iter_mut().flatten().for_each(|value| *value *= number.parameter.scale);
            }
        }
        Ok(all)
    }

    fn cost(&self, whitened: &Whitened, setup: &Setup) -> f64 {
        let data: f64 = whitened
            .rows
            .iter()
            .flat_map(|rows| rows.channels.iter().flatten())
            .filter(|value| value.is_finite())
            .map(|value| huber(*value))
            .sum();
        let believed: f64 = (0..setup.numbers.len())
            .filter_map(|number| {
                let prior = setup.numbers[number].prior?;
                let away = setup.value(number) - setup.numbers[number].parameter.neutral;
                Some(0.5 * (away / prior).powi(2))
            })
            .sum();
        data + believed
    }
}

/// An estimate.
pub struct Estimate {
    /// The setup with the estimated values.
    pub setup: Setup,
    /// Cost at the estimate.
    pub cost: f64,
    /// Covariance of the numbers, SI, from Gauss-Newton's Hessian and the scatter of the gradient over blocks, so that residuals that stay alike
    /// for seconds count once and not at every sample. Numbers at a bound have zero variance.
    pub covariance: DMatrix<f64>,
}

/// Normal equations of a linearisation: gradient and Hessian in units of the numbers' scales, and the gradient of each block.
struct Normal {
    hessian: DMatrix<f64>,
    gradient: DVector<f64>,
    by_block: DMatrix<f64>,
}

impl Objective<'_> {
    fn normal(&self, whitened: &Whitened, columns: &[Vec<Rows>], setup: &Setup) -> Normal {
        let count = setup.numbers.len();
        let blocks = self.samples.blocks.last().map_or(0, |last| last + 1);
        let mut hessian = DMatrix::zeros(count, count);
        let mut by_block = DMatrix::zeros(count, blocks);
        let mut row = vec![0.0; count];
        let scales: Vec<f64> = setup.numbers.iter().map(|number| number.parameter.scale).collect();
        for (rows, columns) in whitened.rows.iter().zip(columns) {
            for (channel, residuals) in rows.channels.iter().enumerate() {
                for (sample, residual) in residuals.iter().enumerate() {
                    if !residual.is_finite() {
                        continue;
                    }
                    for ((entry, column), scale) in row.iter_mut().zip(columns).zip(&scales) {
                        *entry = column.channels[channel][sample] * scale;
                    }
                    let weight = huber_weight(*residual);
                    let block = self.samples.blocks[sample];
                    for a in 0..count {
                        let weighted = weight * row[a];
                        by_block[(a, block)] += weighted * residual;
                        for b in 0..=a {
                            hessian[(a, b)] += weighted * row[b];
                        }
                    }
                }
            }
        }
        hessian.fill_upper_triangle_with_lower_triangle();
        let mut gradient = by_block.column_sum();
        for number in 0..count {
            if let Some(prior) = setup.numbers[number].prior {
                let scale = scales[number] / prior;
                hessian[(number, number)] += scale * scale;
                let away = setup.value(number) - setup.numbers[number].parameter.neutral;
                gradient[number] += away / prior * scale;
            }
        }
        Normal { hessian, gradient, by_block }
    }

    /// Minimises over the setup's numbers by Gauss-Newton steps, damped after Levenberg and Marquardt, within the bounds.
    pub fn minimise(&self, start: &Setup) -> Result<Estimate, OutOfDomain> {
        const ITERATIONS: usize = 25;
        // A relative fall of the cost, and a step in units of a change that matters, below which nothing changes any more.
        const COST_AT_REST: f64 = 1e-6;
        const STEP_AT_REST: f64 = 1e-4;
        let mut setup = start.clone();
        let count = setup.numbers.len();
        let (mut whitened, mut columns) = self.linearised(&setup)?;
        let mut cost = self.cost(&whitened, &setup);
        let mut damping = 1e-4;
        let mut converged = count == 0;
        let mut normal = self.normal(&whitened, &columns, &setup);
        for _ in 0..ITERATIONS {
            if converged {
                break;
            }
            let held = at_bounds(&setup, &normal.gradient);
            let mut accepted = false;
            for _ in 0..8 {
                let Some(step) = damped_step(&normal, &held, damping) else { break };
                let mut trial = setup.clone();
                for number in 0..count {
                    let value = setup.value(number) + step[number] * setup.numbers[number].parameter.scale;
                    trial.set(number, value);
                }
                let (trial_whitened, trial_columns) = self.linearised(&trial)?;
                let trial_cost = self.cost(&trial_whitened, &trial);
                if trial_cost <= cost {
                    let fall = (cost - trial_cost) / cost.max(f64::MIN_POSITIVE);
                    converged = fall < COST_AT_REST || step.amax() < STEP_AT_REST;
                    (setup, whitened, columns, cost) = (trial, trial_whitened, trial_columns, trial_cost);
                    damping = (damping * 0.2).max(1e-10);
                    accepted = true;
                    break;
                }
                if step.amax() < STEP_AT_REST {
                    break;
                }
                damping = (damping * 8.0).max(1e-6);
            }
            if !accepted {
                break;
            }
            normal = self.normal(&whitened, &columns, &setup);
        }
        let covariance = covariance(&setup, &normal);
        Ok(Estimate { setup, cost, covariance })
    }
}

/// Which numbers stand at a bound and are pushed against it.
fn at_bounds(setup: &Setup, gradient: &DVector<f64>) -> Vec<bool> {
    (0..setup.numbers.len())
        .map(|number| {
            let near = 1e-9 * setup.numbers[number].parameter.scale;
            let value = setup.value(number);
            (value <= setup.numbers[number].lower + near && gradient[number] > 0.0)
                || (value >= setup.numbers[number].upper - near && gradient[number] < 0.0)
        })
        .collect()
}

/// (H + damping diag H) step = -gradient over the numbers that are not held.
fn damped_step(normal: &Normal, held: &[bool], damping: f64) -> Option<DVector<f64>> {
    let mut hessian = normal.hessian.clone();
    let mut right = -normal.gradient.clone();
    // A number without any influence must not make the matrix singular.
    let floor = 1e-12 * hessian.diagonal().amax().max(f64::MIN_POSITIVE);
    for number in 0..held.len() {
        hessian[(number, number)] += damping * hessian[(number, number)] + floor;
        if held[number] {
            hessian.row_mut(number).fill(0.0);
            hessian.column_mut(number).fill(0.0);
            hessian[(number, number)] = 1.0;
            right[number] = 0.0;
        }
    }
    hessian.cholesky().map(|factor| factor.solve(&right))
}

/// H^-1 (sum over blocks of g g^T) H^-1 with the usual correction for few blocks, plus what the prior leaves.
fn covariance(setup: &Setup, normal: &Normal) -> DMatrix<f64> {
    let count = setup.numbers.len();
    let held = at_bounds(setup, &normal.gradient);
    let mut hessian = normal.hessian.clone();
    let mut scores = normal.by_block.clone();
    let floor = 1e-12 * hessian.diagonal().amax().max(f64::MIN_POSITIVE);
    for number in 0..count {
        hessian[(number, number)] += floor;
        if held[number] {
            hessian.row_mut(number).fill(0.0);
            hessian.column_mut(number).fill(0.0);
            hessian[(number, number)] = 1.0;
            scores.row_mut(number).fill(0.0);
        }
    }
    let blocks = scores.ncols() as f64;
    let correction = blocks / (blocks - count as f64).max(1.0);
    let mut scatter = &scores * scores.transpose() * correction;
    for number in 0..count {
        if let (Some(prior), false) = (setup.numbers[number].prior, held[number]) {
            scatter[(number, number)] += (setup.numbers[number].parameter.scale / prior).powi(2);
        }
    }
    let Some(factor) = hessian.cholesky() else { return DMatrix::zeros(count, count) };
    let inverse = factor.inverse();
    let mut covariance = &inverse * scatter * &inverse;
    for a in 0..count {
        for b in 0..count {
            let scale = setup.numbers[a].parameter.scale * setup.numbers[b].parameter.scale;
            covariance[(a, b)] *= scale;
        }
    }
    covariance
}
