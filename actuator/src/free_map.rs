use crate::{FreeParameter, FreePath, LoadedFree, MapAxis, ParameterError, grid_places};
use serde::{Deserialize, Serialize};

/// What computed the states of a FREE's map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Fidelity {
    /// The cross-section far from the caps.
    Section,
    /// The whole tube with its rigid caps.
    Solid {
        /// Elements through the wall, around and along, where they were given; `None` = by the rule that the map's settings tell.
        elements: Option<[u32; 3]>,
    },
    /// The cross-section, and what caps at the FREE's length change of it, from solids.
    CappedSection,
}

/// Pressure-to-deformation map of a FREE over winding angle, shear modulus and whatever else was asked for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FreeMap {
    /// The FREE and its loads; its own values of the axes' parameters are one point of the axes' space.
    pub node: LoadedFree,
    /// Axes beside pressure, each with at least one value. The last two are the winding angle and the shear modulus; before them
    /// stand those asked for by name, which have at least two values.
    pub axes: Vec<MapAxis>,
    /// Pressures asked for, Pa, rising from zero. Paths hold these (as far as they exist) and further states up to their end.
    pub pressures: Vec<f64>,
    /// Paths over the axes, the last axis fastest; `None` = not computed yet or not converged.
    pub paths: Vec<Option<FreePath>>,
    /// Paths between the nodes, for the fit to be judged by and never to be fitted.
    pub checks: Vec<(LoadedFree, FreePath)>,
    /// What computed it.
    pub fidelity: Fidelity,
    /// Settings of the finite elements, in words.
    pub settings: String,
    /// Name and text of the description it was made from.
    pub source: (String, String),
}

impl FreeMap {
    /// Winding angles from the hoop, rad, rising.
    pub fn winding_angles(&self) -> &[f64] {
        self.values(FreeParameter::WindingAngle)
    }

    /// Shear moduli, Pa, rising.
    pub fn shear_moduli(&self) -> &[f64] {
        self.values(FreeParameter::ShearModulus)
    }

    /// Values of an axis; none where the map has no such axis.
    pub fn values(&self, parameter: FreeParameter) -> &[f64] {
        self.axes.iter().find(|axis| axis.parameter == parameter).map_or(&[], |axis| &axis.values)
    }

    /// The axes asked for by name, slowest first: all but winding angle and shear modulus.
    pub fn named_axes(&self) -> &[MapAxis] {
        &self.axes[..self.axes.len().saturating_sub(2)]
    }

    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.axes.iter().map(|axis| axis.values.len()).product()
    }

    /// The values (SI) of the axes at node `index`, in their order.
    pub fn coordinates(&self, index: usize) -> Vec<f64> {
        let places = grid_places(self.axes.iter().map(|axis| axis.values.len()), index);
        places.into_iter().zip(&self.axes).map(|(place, axis)| axis.values[place]).collect()
    }

    /// The FREE at values (SI) of the axes, in their order.
    ///
    /// # Errors
    /// [`ParameterError`] where an axis cannot have its value.
    pub fn at(&self, coordinates: &[f64]) -> Result<LoadedFree, ParameterError> {
        self.axes
            .iter()
            .zip(coordinates)
            .try_fold(self.node, |node, (axis, value)| axis.parameter.set(node, *value))
    }

    /// The path at winding angle `i` and shear modulus `j` (of the first values of the other axes).
    pub fn path(&self, i: usize, j: usize) -> Option<&FreePath> {
        self.paths[i * self.shear_moduli().len() + j].as_ref()
    }

    /// Whether every node was computed.
    pub fn is_complete(&self) -> bool {
        self.paths.iter().all(Option::is_some)
    }
}
