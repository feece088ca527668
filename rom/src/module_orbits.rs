use crate::{SplineGrid, module_model::Tables};
use actuator::{Module, ModuleSymmetry, grid_places};

/// Nodes of a module's grid that its symmetry makes of each other: one of each orbit is enough to know all.
///
/// The coefficients of splines go with the nodes: where the axes change places with the FREEs, so do the B-splines, and a chart
/// is moved along linearly.
pub(crate) struct Orbits {
    symmetries: Vec<ModuleSymmetry>,
    /// Of each node the first of its orbit, by its number among those, and which symmetry carries that one here.
    from: Vec<(usize, usize)>,
    /// The first node of each orbit.
    first: Vec<usize>,
}

/// Greatest relative difference of tables that count as symmetric: what solvers leave.
const SAME: f64 = 1e-7;

impl Orbits {
    /// The orbits of a grid over a module's pressures; each node is its own where axes of FREEs that are alike differ.
    pub fn new(module: &Module, grid: &SplineGrid) -> Self {
        let axes: Vec<&[f64]> = grid.axes().iter().map(|axis| axis.nodes()).collect();
        let symmetries: Vec<ModuleSymmetry> =
            module.symmetries().into_iter().filter(|symmetry| symmetry.carry(&axes) == axes).collect();
        let node_of = |places: &[usize]| -> usize {
            places.iter().zip(grid.strides()).map(|(place, stride)| place * stride).sum()
        };
        let mut from = vec![None; grid.node_count()];
        let mut first = Vec::new();
        for node in 0..grid.node_count() {
            if from[node].is_some() {
                continue;
            }
            let places = grid_places(axes.iter().map(|axis| axis.len()), node);
            for (index, symmetry) in symmetries.iter().enumerate() {
                from[node_of(&symmetry.carry(&places))].get_or_insert((first.len(), index));
            }
            first.push(node);
        }
        // The identity is among the symmetries, so that every node was met.
        let from = from.into_iter().flatten().collect();
        Orbits { symmetries, from, first }
    }

    /// Number of orbits.
    pub fn count(&self) -> usize {
        self.first.len()
    }

    fn kept<const OUT: usize>(&self, table: &[f64], nodes: usize) -> Vec<f64> {
        let rows = table.as_chunks::<OUT>().0;
        // One table after the other: of several parameters, say.
        let tables = rows.chunks(nodes);
        tables.flat_map(|rows| self.first.iter().flat_map(|node| rows[*node])).collect()
    }

    fn spread_rows<const OUT: usize>(
        &self,
        table: &[f64],
        carry: impl Fn(&ModuleSymmetry, [f64; OUT]) -> [f64; OUT],
    ) -> Vec<f64> {
        let tables = table.as_chunks::<OUT>().0.chunks(self.count());
        let row = |rows: &[[f64; OUT]], (orbit, symmetry): &(usize, usize)| {
            carry(&self.symmetries[*symmetry], rows[*orbit])
        };
        tables
            .flat_map(|rows| self.from.iter().flat_map(|from| row(rows, from)).collect::<Vec<_>>())
            .collect()
    }

    /// The rows of the first node of each orbit.
    pub fn reduced(&self, tables: &Tables) -> Tables {
        let nodes = self.from.len();
        Tables {
            chart: self.kept::<6>(&tables.chart, nodes),
            slopes: self.kept::<6>(&tables.slopes, nodes),
            clearance: self.kept::<1>(&tables.clearance, nodes),
            bars: self.kept::<2>(&tables.bars, nodes),
        }
    }

    /// The inverse of [`Orbits::reduced`]; `None` where the tables are not as long as that makes them.
    pub fn spread(&self, tables: &Tables) -> Option<Tables> {
        let whole = |table: &[f64], out: usize| table.len().is_multiple_of(self.count() * out);
        let Tables { chart, slopes, clearance, bars } = tables;
        let sound = whole(chart, 6) && whole(slopes, 6) && whole(clearance, 1) && whole(bars, 2);
        sound.then(|| Tables {
            chart: self.spread_rows::<6>(chart, ModuleSymmetry::chart),
            slopes: self.spread_rows::<6>(slopes, ModuleSymmetry::chart),
            clearance: self.spread_rows::<1>(clearance, |_, row| row),
            bars: self.spread_rows::<2>(bars, |_, row| row),
        })
    }

    /// Error bars, exactly symmetric where the tables are.
    pub fn symmetrised_bars(&self, bars: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
        let none = Vec::new;
        let bars = bars.into_flattened();
        let tables = Tables { chart: none(), slopes: none(), clearance: none(), bars };
        self.symmetrised(tables).bars.as_chunks().0.to_vec()
    }

    /// The same tables, exactly symmetric, where they are that up to what solvers leave; as they are elsewhere (a map that follows one
    /// of several branches, say).
    pub fn symmetrised(&self, tables: Tables) -> Tables {
        let Some(spread) = self.spread(&self.reduced(&tables)) else { return tables };
        let near = |a: &[f64], b: &[f64]| {
            let size = a.iter().fold(0.0f64, |most, value| most.max(value.abs()));
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= SAME * size)
        };
        let same = near(&tables.chart, &spread.chart)
            && near(&tables.slopes, &spread.slopes)
            && near(&tables.clearance, &spread.clearance)
            && near(&tables.bars, &spread.bars);
        if same { spread } else { tables }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        ModuleModel,
        synthetic::{PRESSURE_MAX, module_map},
    };

    fn even(count: usize) -> Vec<f64> {
        (0..count).map(|i| PRESSURE_MAX * i as f64 / (count - 1) as f64).collect()
    }

    fn tables(model: &ModuleModel) -> Tables {
        Tables::of(model.splines())
    }

    #[test]
    fn a_symmetric_module_is_kept_once_and_comes_back_bit_for_bit() {
        // Three like FREEs around the axis: three turns.
        let map = module_map(vec![even(5); 3], 30);
        let model = ModuleModel::fit(&map).unwrap();
        let orbits = Orbits::new(model.module(), model.splines().grid());
        // (5^3 + 2 * 5)/3 orbits under the turns, by Burnside's count.
        assert_eq!(orbits.count(), 45);
        let whole = tables(&model);
        let reduced = orbits.reduced(&whole);
        assert_eq!((reduced.chart.len(), reduced.bars.len()), (45 * 6, 45 * 2));
        assert!(orbits.spread(&reduced).unwrap() == whole);
        // Against a fit that knows of no symmetry: what it interpolates from is symmetric to rounding.
        let mut other = map.clone();
        other.module.frees[0].free.tube.length *= 1.0 + 1e-9;
        let plain = ModuleModel::fit(&other).unwrap();
        assert_eq!(Orbits::new(plain.module(), plain.splines().grid()).count(), 125);
        for (a, b) in tables(&plain).chart.iter().zip(&whole.chart) {
            assert!((a - b).abs() < 1e-12);
        }
    }

    #[test]
    fn what_is_not_symmetric_is_left_as_it_is() {
        let mut map = module_map(vec![even(5); 3], 0);
        map.states[7].as_mut().unwrap().chart.position[0] += 1e-4;
        let model = ModuleModel::fit(&map).unwrap();
        let at = map.node_pressures(7);
        let found = model.splines().partial(&at, &[0; 3]).unwrap();
        assert!((found[3] - map.states[7].as_ref().unwrap().chart.position[0]).abs() < 1e-12);
        // Axes that differ leave every node its own.
        let uneven = ModuleModel::fit(&module_map(vec![even(5), even(5), even(4)], 0)).unwrap();
        assert_eq!(Orbits::new(uneven.module(), uneven.splines().grid()).count(), 100);
    }
}
