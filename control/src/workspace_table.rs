use crate::{Bounds, pose_error::pose_error, target::Goal};
use actuator::{PoseChart, grid_places};
use rom::{OutOfDomain, PoseEvaluation, PoseModel};

/// Poses over a coarse grid of the pressures within bounds: where a solve finds its starts.
#[derive(Clone, Debug)]
pub struct WorkspaceTable {
    per_axis: Vec<usize>,
    bounds: Bounds,
    /// Of each node, where the module has a stable state.
    charts: Vec<Option<PoseChart>>,
}

/// Nodes of a table at most, as long as every axis has its three: 7 x 7 x 7 x 7 for four FREEs, 10 ms of evaluations.
const MOST_NODES: usize = 2500;

impl WorkspaceTable {
    /// Evaluates the grid; axes whose bounds coincide have one node.
    pub fn new<M: PoseModel + ?Sized>(model: &M, bounds: &Bounds) -> Result<Self, OutOfDomain> {
        let wide: Vec<bool> =
            bounds.lower.iter().zip(&bounds.upper).map(|(lower, upper)| upper > lower).collect();
        let axes = wide.iter().filter(|wide| **wide).count() as u32;
        let mut nodes = 3usize;
        while axes > 0 && nodes < 200 && (nodes + 1).checked_pow(axes).is_some_and(|all| all <= MOST_NODES) {
            nodes += 1;
        }
        // From nine FREEs on, three nodes an axis would be too many: corners only, and of these the first.
        let per_axis: Vec<usize> = wide
            .iter()
            .map(|wide| {
                if !wide {
                    1
                } else if axes > 8 {
                    2
                } else {
                    nodes
                }
            })
            .collect();
        let all = per_axis.iter().fold(1usize, |all, nodes| all.saturating_mul(*nodes)).min(1 << 14);
        let mut table = WorkspaceTable { per_axis, bounds: bounds.clone(), charts: Vec::with_capacity(all) };
        let mut evaluation = PoseEvaluation::new(bounds.lower.len(), 0);
        for node in 0..all {
            table.charts.push(match model.evaluate(&table.pressures(node), &mut evaluation) {
                Err(OutOfDomain::Unstable { .. }) => None,
                answer => answer.map(|()| Some(evaluation.chart))?,
            });
        }
        Ok(table)
    }

    /// Bounds it was made for.
    pub fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    /// Pressures (Pa) of a node, last FREE fastest.
    pub fn pressures(&self, node: usize) -> Vec<f64> {
        let places = self.indices(node).into_iter().enumerate();
        places.map(|(free, place)| self.bounds.step(free, place, self.per_axis[free] - 1)).collect()
    }

    fn indices(&self, node: usize) -> Vec<usize> {
        grid_places(self.per_axis.iter().copied(), node)
    }

    /// Up to `count` nodes near the goal in weighted pose error, nearest first, none beside another: neighbours lead to the
    /// same minimum.
    pub(crate) fn nearest(&self, goal: &Goal, count: usize) -> Vec<usize> {
        let mut order: Vec<(f64, usize)> = self
            .charts
            .iter()
            .enumerate()
            .filter_map(|(node, chart)| Some((pose_error(goal, chart.as_ref()?).0.norm_squared(), node)))
            .collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut chosen: Vec<(usize, Vec<usize>)> = Vec::with_capacity(count);
        for (_, node) in order {
            if chosen.len() >= count {
                break;
            }
            let indices = self.indices(node);
            // On three nodes an axis, or two, every node has a minimum of its own to offer.
            let beside = |free: usize| usize::from(self.per_axis[free] > 3);
            let apart = |other: &Vec<usize>| {
                (0..indices.len()).any(|free| indices[free].abs_diff(other[free]) > beside(free))
            };
            if chosen.iter().all(|(_, other)| apart(other)) {
                chosen.push((node, indices));
            }
        }
        chosen.into_iter().map(|(node, _)| node).collect()
    }
}
