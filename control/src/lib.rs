//! The inverse problem of FREE modules on Clarabel, and trajectories.
