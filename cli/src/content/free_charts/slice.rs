use actuator::{FreeMap, FreeParameter, FreePath, FreeState, units::DEG};

/// Paths of a map where all axes but those shown stand at one value.
pub struct Slice<'a> {
    pub map: &'a FreeMap,
    /// Place on each axis of the value next to the description's own.
    fixed: Vec<usize>,
}

impl<'a> Slice<'a> {
    pub fn of(map: &'a FreeMap) -> Self {
        let next = |axis: &actuator::MapAxis| {
            let own = axis.parameter.of(&map.node).unwrap_or(axis.values[0]);
            let off = |i: &usize| (axis.values[*i] - own).abs();
            (0..axis.values.len()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0)
        };
        Slice { map, fixed: map.axes.iter().map(next).collect() }
    }

    /// The path where the axes given by their number stand at the places given, the others at their one value.
    pub fn path(&self, at: &[(usize, usize)]) -> Option<&'a FreePath> {
        let place = |axis: usize| at.iter().find(|at| at.0 == axis).map_or(self.fixed[axis], |at| at.1);
        let node = (0..self.map.axes.len())
            .fold(0, |node, axis| node * self.map.axes[axis].values.len() + place(axis));
        self.map.paths.get(node)?.as_ref()
    }

    /// Number of the axis of winding angles.
    pub fn angle_axis(&self) -> usize {
        self.map.axes.len() - 2
    }

    /// Winding angles, degrees from the hoop direction.
    pub fn angles_deg(&self) -> Vec<f64> {
        self.map.winding_angles().iter().map(|angle| angle / DEG).collect()
    }

    /// Numbers of the axes with several values, the winding angle first if it is among them.
    pub fn varied(&self) -> Vec<usize> {
        let mut axes: Vec<usize> =
            (0..self.map.axes.len()).filter(|axis| self.map.axes[*axis].values.len() > 1).collect();
        axes.sort_by_key(|axis| *axis != self.angle_axis());
        axes
    }

    /// Numbers of those beside the winding angle.
    pub fn parameters(&self) -> Vec<usize> {
        self.varied().into_iter().filter(|axis| *axis != self.angle_axis()).collect()
    }

    /// A value of an axis, as in a legend.
    pub fn value(&self, axis: usize, place: usize) -> String {
        let axis = &self.map.axes[axis];
        let value = plain(axis.values[place] / axis.parameter.unit());
        if axis.parameter == FreeParameter::WindingAngle { value + "°" } else { value }
    }

    /// Name of an axis over its unit, as a legend's head.
    pub fn head(&self, axis: usize) -> String {
        self.map.axes[axis].parameter.label().replace(" (", "\n(")
    }

    /// Name of an axis in the names of files.
    pub fn stem(&self, axis: usize) -> String {
        let name = self.map.axes[axis].parameter.name();
        let unit =
            ["_deg", "_mpa", "_mm", "_nmm", "_newton", "_n"].into_iter().find(|unit| name.ends_with(unit));
        unit.map_or(name, |unit| &name[..name.len() - unit.len()]).replace('_', "-")
    }

    /// Where the axes that are not shown stand, in words.
    pub fn told(&self, shown: &[usize]) -> String {
        let others = (0..self.map.axes.len()).rev().filter(|axis| !shown.contains(axis));
        let told = others.map(|axis| {
            let (name, unit) = match self.map.axes[axis].parameter.label().split_once(" (") {
                Some((name, unit)) => (name, format!(" {}", unit.trim_end_matches(')'))),
                None => (self.map.axes[axis].parameter.label(), String::new()),
            };
            let value = self.value(axis, self.fixed[axis]);
            let unit = unit.replace(" ° from hoop", " from hoop");
            format!("{name} {value}{unit}")
        });
        told.collect::<Vec<_>>().join(", ")
    }
}

/// A number with four significant figures and no zeros at its end.
pub fn plain(value: f64) -> String {
    let text = crate::table::short(value);
    match text.contains('.') && !text.contains('e') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// The state of a path at a pressure of the grid.
pub fn state_at(path: &FreePath, pressure: f64) -> Option<&FreeState> {
    path.states.iter().find(|state| (state.pressure - pressure).abs() <= 1e-9 * pressure.max(1.0))
}
