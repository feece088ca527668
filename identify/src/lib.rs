//! Closing the loop: residual, candidate effects, selection, verdict.
