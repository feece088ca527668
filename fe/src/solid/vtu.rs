//! A state as files that ParaView, pyvista and meshio open: the rubber as 27-node hexahedra, the fibres as lines.

use super::{body::Body, fibre::FibreState, newton::SolidSolver, state::SolidState, wall};
use crate::vtk::{Array, LINE, TRIQUADRATIC_HEXAHEDRON, UnstructuredGrid, Values};
use nalgebra::{Matrix3, Rotation3, Vector3};
use std::{
    collections::BTreeMap,
    f64::consts::TAU,
    io::{self, Write},
};

const MM: f64 = 1e3;
const MPA: f64 = 1e-6;
const KPA: f64 = 1e-3;

/// Our number of a node (radially fastest, around, along) at each place in VTK's order: corners of the face at the base and of that
/// at the tip, counter-clockwise seen from the tip with the first coordinate radial; middles of the base's, the tip's and the upright
/// edges; of the faces inside, outside, before, behind, below, above; of the element.
pub(super) const VTK_ORDER: [usize; 27] =
    [0, 2, 8, 6, 18, 20, 26, 24, 1, 5, 7, 3, 19, 23, 25, 21, 9, 11, 17, 15, 12, 14, 10, 16, 4, 22, 13];

fn turn(angle: f64) -> Matrix3<f64> {
    *Rotation3::from_axis_angle(&Vector3::z_axis(), angle).matrix()
}

fn single(values: impl Iterator<Item = f64>) -> Values {
    Values::F32(values.map(|value| value as f32).collect())
}

/// What concerns the state as a whole.
fn of_state(state: &SolidState) -> Vec<Array> {
    vec![Array::new("pressure_kpa", 1, Values::F64(vec![KPA * state.load().pressure]))]
}

/// The points of the whole tube from those of the mesh: of each its number there and the number of sectors by which it is turned.
fn of_whole_tube(body: &Body) -> (Vec<(usize, usize)>, [usize; 2]) {
    let [ni, nj, nk] = body.grid.lines;
    let sectors = body.grid.sectors;
    let own = if sectors > 1 { nj - 1 } else { nj };
    let around = own * sectors;
    let places = (0..nk).flat_map(|k| (0..around).flat_map(move |j| (0..ni).map(move |i| (i, j, k))));
    (places.map(|(i, j, k)| ((k * nj + j % own) * ni + i, j / own)).collect(), [ni, around])
}

/// The rubber of the whole tube.
pub(super) fn rubber(
    body: &Body,
    state: &SolidState,
    fields: &[(&str, &[[f64; 3]])],
) -> io::Result<UnstructuredGrid> {
    let grid = &body.grid;
    for (name, values) in fields {
        if values.len() != grid.points.len() {
            let message =
                format!("the field {name} has {} values for {} points", values.len(), grid.points.len());
            return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
        }
    }
    let sector = TAU / grid.sectors as f64;
    let (of_mesh, [ni, around]) = of_whole_tube(body);
    let turned = |of: &dyn Fn(usize) -> Vector3<f64>| -> Vec<[f64; 3]> {
        of_mesh.iter().map(|&(point, times)| (turn(sector * times as f64) * of(point)).into()).collect()
    };
    let place = |of: &[[f64; 3]], point: usize| Vector3::from(of[point]);
    let moved = |point| place(&state.positions, point) - place(&grid.points, point);
    let displacement = turned(&|point| MM * moved(point));

    let inside = wall::points(body, state);
    let strain = wall::at_nodes(body, &inside.iter().map(|point| point.log_strain).collect::<Vec<_>>());
    let stress = wall::at_nodes(body, &inside.iter().map(|point| point.cauchy_stress).collect::<Vec<_>>());
    let principal_strain: Vec<[f64; 3]> = strain.iter().map(wall::principal).collect();
    let principal_stress: Vec<[f64; 3]> = stress.iter().map(wall::principal).collect();
    let three = |name, of: &[[f64; 3]], each: fn(f64) -> f64| {
        Array::new(name, 3, single(of_mesh.iter().flat_map(|&(point, _)| of[point].map(each))))
    };
    let one = |name, each: fn([f64; 3]) -> f64| {
        let values = of_mesh.iter().map(|&(point, _)| MPA * each(principal_stress[point]));
        Array::new(name, 1, single(values))
    };
    let mut point_data = vec![
        Array::new("displacement_mm", 3, Values::F64(displacement.as_flattened().to_vec())),
        three("principal_stretch", &principal_strain, f64::exp),
        three("principal_log_strain", &principal_strain, |strain| strain),
        three("principal_cauchy_stress_mpa", &principal_stress, |stress| MPA * stress),
        one("von_mises_stress_mpa", |[a, b, c]| {
            (0.5 * ((a - b).powi(2) + (b - c).powi(2) + (c - a).powi(2))).sqrt()
        }),
        one("pressure_in_rubber_mpa", |[a, b, c]| -(a + b + c) / 3.0),
    ];
    for (name, values) in fields {
        let values = turned(&|point| place(values, point));
        point_data.push(Array::new(name, 3, Values::F64(values.as_flattened().to_vec())));
    }

    let [ei, ej, ek] = grid.elements;
    let mut volumes = vec![[0.0; 2]; ei * ej * ek];
    for point in &inside {
        let volume = point.weight * point.volume_ratio;
        volumes[point.element][0] += volume;
        volumes[point.element][1] -= volume * point.cauchy_stress.trace() / 3.0;
    }
    let total = grid.sectors as f64 * volumes.iter().map(|[volume, _]| volume).sum::<f64>();
    let (mut connectivity, mut layers, mut pressures) = (vec![], vec![], vec![]);
    for k in 0..ek {
        for j in 0..ej * grid.sectors {
            for i in 0..ei {
                connectivity.extend(VTK_ORDER.map(|a| {
                    let (i, j, k) = (2 * i + a % 3, (2 * j + a / 3 % 3) % around, 2 * k + a / 9);
                    ((k * around + j) * ni + i) as i64
                }));
                layers.push(u8::from(grid.is_coat(i)));
                let [volume, integral] = volumes[(k * ej + j % ej) * ei + i];
                pressures.push(MPA * integral / volume);
            }
        }
    }
    let mut field_data = of_state(state);
    field_data.push(Array::new("rubber_volume_mm3", 1, Values::F64(vec![total * MM.powi(3)])));
    Ok(UnstructuredGrid {
        points: turned(&|point| MM * place(&state.positions, point)),
        cell_type: TRIQUADRATIC_HEXAHEDRON,
        nodes_per_cell: VTK_ORDER.len(),
        connectivity,
        point_data,
        cell_data: vec![
            Array::new("layer", 1, Values::U8(layers)),
            Array::new("pressure_in_rubber_mpa", 1, single(pressures.into_iter())),
        ],
        field_data,
    })
}

/// A fibre family in the specimen: number of its first fibre, of its fibres in all and in a sector, turn by reference arc length.
struct Family {
    first: usize,
    fibres: usize,
    in_sector: usize,
    /// Turn about the axis, rad/m, along the undeformed fibre.
    turn: f64,
    /// Reference length of half an element's part of a fibre, m.
    half_element: f64,
}

fn families(body: &Body) -> Vec<Family> {
    let tube = body.specimen.tube;
    let mut first = 0;
    let each = body.specimen.windings.iter().map(|winding| {
        let sine = winding.angle_from_hoop().sin();
        let fibres = winding.fibres as usize;
        first += fibres;
        Family {
            first: first - fibres,
            fibres,
            in_sector: fibres / body.grid.sectors,
            turn: winding.handedness.sign() * winding.turn_per_length(tube.outer_radius()) * sine,
            half_element: 0.5 * tube.length / (body.grid.elements[2] as f64 * sine),
        }
    });
    each.collect()
}

/// Average over integration points of a fibre that lie near each other along it.
#[derive(Clone, Copy, Debug, Default)]
struct Mean {
    weight: f64,
    reference: Vector3<f64>,
    position: Vector3<f64>,
    stretch: f64,
    tension: f64,
}

impl Mean {
    fn add(&mut self, state: &FibreState, [reference, position]: [Vector3<f64>; 2]) {
        self.weight += state.weight;
        self.reference += state.weight * reference;
        self.position += state.weight * position;
        self.stretch += state.weight * state.stretch;
        self.tension += state.weight * state.tension;
    }
}

/// All fibres of the tube; `None` for a bare one.
///
/// A fibre is the line through the means over half an element's length: one integration point of a single line along the mesh,
/// the average over its width of a fibre that has one.
pub(super) fn fibres(body: &Body, state: &SolidState) -> Option<UnstructuredGrid> {
    let families = families(body);
    let sector = TAU / body.grid.sectors as f64;
    let mut found: Vec<[FibreState; 2]> = vec![];
    for element in &body.fibres.elements {
        let undeformed = element.states(&body.grid.points, &body.fibres.rotations);
        let deformed = element.states(&state.positions, &state.rotations);
        found.extend(undeformed.into_iter().zip(deformed).map(|(before, now)| [before, now]));
    }
    found.sort_by(|[a, _], [b, _]| a.fibre.cmp(&b.fibre).then(a.arc_length.total_cmp(&b.arc_length)));
    // By fibre and by place along it.
    let mut means: BTreeMap<(usize, usize), Mean> = BTreeMap::new();
    for [before, now] in &found {
        let fibre = before.fibre as usize;
        let family = families.iter().rev().find(|family| family.first <= fibre)?;
        // A sector's mesh has the place's image: it is turned back to where the fibre is, which is known undeformed.
        let [x, y, _] = before.position;
        let start = TAU * (fibre - family.first) as f64 / family.fibres as f64;
        let ahead = start + family.turn * before.arc_length - y.atan2(x);
        let times = (ahead / sector).round().rem_euclid(body.grid.sectors as f64);
        let there = [before.position, now.position].map(|at| turn(sector * times) * Vector3::from(at));
        let bin = (before.arc_length / family.half_element) as usize;
        means.entry((fibre, bin)).or_default().add(now, there);
    }
    let mut grid = UnstructuredGrid {
        points: vec![],
        cell_type: LINE,
        nodes_per_cell: 2,
        connectivity: vec![],
        point_data: vec![],
        cell_data: vec![],
        field_data: of_state(state),
    };
    let (mut displacement, mut stretch, mut tension, mut numbers) = (vec![], vec![], vec![], vec![]);
    for times in 0..body.grid.sectors {
        let turn = turn(sector * times as f64);
        let mut before = None;
        for (&(fibre, _), mean) in &means {
            let family = families.iter().rev().find(|family| family.first <= fibre)?;
            if before == Some(fibre) {
                let point = grid.points.len() as i64;
                grid.connectivity.extend([point - 1, point]);
                numbers.push((fibre + times * family.in_sector) as i64);
            }
            before = Some(fibre);
            let scale = MM / mean.weight;
            grid.points.push((turn * mean.position * scale).into());
            displacement.extend::<[f64; 3]>((turn * (mean.position - mean.reference) * scale).into());
            stretch.push(mean.stretch / mean.weight);
            tension.push(mean.tension / mean.weight);
        }
    }
    grid.point_data = vec![
        Array::new("displacement_mm", 3, Values::F64(displacement)),
        Array::new("stretch", 1, Values::F64(stretch)),
        Array::new("tension_n", 1, Values::F64(tension)),
    ];
    grid.cell_data = vec![Array::new("fibre", 1, Values::I64(numbers))];
    (!grid.points.is_empty()).then_some(grid)
}

impl SolidSolver {
    /// Writes the rubber of a state as an unstructured grid of VTK (`.vtu`), for ParaView, pyvista or meshio.
    ///
    /// Points are where the nodes are now, mm; less `displacement_mm` they are where they were. At the nodes: the three
    /// `principal_stretch` and `principal_log_strain` (of V, the greatest first), `principal_cauchy_stress_mpa`,
    /// `von_mises_stress_mpa` and `pressure_in_rubber_mpa` (minus the mean stress), all from strain and stress tensors
    /// extrapolated from the integration points and averaged over the elements around a node. For each element its mean
    /// `pressure_in_rubber_mpa` and its `layer`, 0 for the tube and 1 for the coat. For the file `pressure_kpa` inside
    /// and `rubber_volume_mm3`. A mesh of one sector is written as the whole tube.
    ///
    /// `fields` are more vectors at the nodes of the mesh, under their names: the shape of a buckling mode, say.
    ///
    /// # Errors
    /// [`io::ErrorKind::InvalidInput`] if a field has not one vector for each point of the mesh; what `out` answers.
    pub fn write_vtu(
        &self,
        state: &SolidState,
        fields: &[(&str, &[[f64; 3]])],
        out: &mut dyn Write,
    ) -> io::Result<()> {
        rubber(&self.body, state, fields)?.write(out)
    }

    /// The rubber of a state as [`SolidSolver::write_vtu`] writes it.
    pub(crate) fn rubber_grid(
        &self,
        state: &SolidState,
        fields: &[(&str, &[[f64; 3]])],
    ) -> io::Result<UnstructuredGrid> {
        rubber(&self.body, state, fields)
    }

    /// Whether there are fibres, which [`SolidSolver::write_fibres_vtu`] would write.
    pub fn has_fibres(&self) -> bool {
        !self.body.fibres.elements.is_empty()
    }

    /// Writes the fibres of a state as lines in an unstructured grid of VTK; a bare tube has none and nothing is written:
    /// false.
    ///
    /// Points are two for each element along a fibre, at its integration points, so that the lines end a little before the caps; the
    /// mean over its width of a fibre that has one. At the points `displacement_mm`, `stretch` and `tension_n` (of the whole
    /// fibre); for each line the number of its `fibre`, families after one another.
    ///
    /// # Errors
    /// What `out` answers.
    pub fn write_fibres_vtu(&self, state: &SolidState, out: &mut dyn Write) -> io::Result<bool> {
        let fibres = fibres(&self.body, state);
        if let Some(fibres) = &fibres {
            fibres.write(out)?;
        }
        Ok(fibres.is_some())
    }
}
