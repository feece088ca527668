//! Rods against closed forms and against solutions found another way, with plain laws: one phenomenon a file.

mod cantilever;
mod column;
mod objectivity;
mod tangent;
mod twisted;
