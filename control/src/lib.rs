//! The inverse problem of FREE modules: pressures for a target tip pose, and trajectories.
//!
//! [`Solver::solve`] minimises the weighted pose error `1/2 (w_p^2 |x - x_t|^2 + w_r^2 |log(R_t^T R)|^2)` over the box of the
//! [`Bounds`], and among pressures that reach the target the [`Preference`]. It is a pure function of the model and the
//! [`SolveInput`]: the same input gives the same bits, whatever was solved before.
//!
//! 1. Starts: the pressures of now, and the nearest nodes of a [`WorkspaceTable`].
//! 2. Gauss-Newton steps in a trust region, each a quadratic program solved by Clarabel (`descent`).
//! 3. Newton steps that keep the bounds exactly finish what an interior-point method leaves (`polish`).
//! 4. Where the target is reached and pressures are left to choose, the preference is minimised on the set that reaches it.
//! 5. Bounds and stationarity of the result are verified.

mod bounds;
mod descent;
mod polish;
mod pose_error;
mod preference;
mod problem;
mod program;
mod reach;
mod solution;
mod solver;
mod target;
mod track;
mod trajectory;
mod waypoint;
mod workspace_table;

pub use bounds::{Bounds, BoundsError};
pub use pose_error::{chart_to_pose_jacobian, inverse_right_jacobian, right_jacobian};
pub use preference::Preference;
pub use reach::{
    Dexterity, Face, Facet, ReachError, ReachRun, ReachSettings, ReachableSet, Segments, Sideways, Surface,
    positions, scattered_pressures,
};
pub use solution::{ActiveBound, Answer, Side, Solution, Status};
pub use solver::{SolveInput, Solver, solve};
pub use target::{Target, Tolerance};
pub use track::{Tick, TrackError, Tracker, track};
pub use trajectory::{Blend, Trajectory, TrajectoryError};
pub use waypoint::{Waypoint, WaypointError, read_waypoints, waypoints_from};
pub use workspace_table::WorkspaceTable;
