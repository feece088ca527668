//! End-to-end checks of freeact: the paper's claims, closed forms, runs of the binary.
