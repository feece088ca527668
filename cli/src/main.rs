//! From the drawing of a FREE actuator to its controller: the binary `freeact`.

fn main() {}
