//! Tests of fibres on interpolated surfaces.

mod beam;
mod foreseen;
mod tracing;
mod truss;

use super::*;
use crate::solid::{FibreModel, SolidMesh, Specimen};
use actuator::{Elastomer, Fibre, FibreLaw, Handedness, OgdenForm, Tube};

const LENGTH: f64 = 0.05;
const STIFFNESS: f64 = 644.0;

fn winding(angle_deg: f64, handedness: Handedness, fibres: u32, diameter: f64) -> Winding {
    let fibre = Fibre { axial_stiffness: STIFFNESS, diameter, law: FibreLaw::Linear };
    Winding::from_hoop(angle_deg.to_radians(), handedness, fibres, fibre)
}

/// Tube with bore 4.76 mm, wall 0.8 mm.
fn specimen(windings: &[Winding]) -> Specimen {
    let specimen = Specimen {
        tube: Tube { length: LENGTH, inner_radius: 4.76e-3, wall: 0.8e-3 },
        elastomer: Elastomer::Ogden { shear_modulus: 0.393e6, alpha: 1.2, form: OgdenForm::InitialModulus },
        windings: windings.to_vec(),
        fibre_model: FibreModel::Truss,
        coat: None,
        bore_offset: [[0.0; 2]; 2],
        wall_taper: 1.0,
        bulk_ratio: 1e4,
        density: 930.0,
        cap_mass: 0.0,
    };
    specimen.check().unwrap();
    specimen
}

fn mesh(around: usize, along: usize, follows_fibres: bool) -> SolidMesh {
    SolidMesh { follows_fibres, ..SolidMesh::new(around, along) }
}

fn grid(specimen: &Specimen, mesh: SolidMesh) -> Grid {
    Grid::new(specimen, mesh, 1).unwrap()
}

fn trusses(specimen: &Specimen, mesh: SolidMesh) -> (Grid, Fibres) {
    let grid = grid(specimen, mesh);
    let fibres = Fibres::trusses(specimen, &grid).unwrap();
    (grid, fibres)
}

/// Positions of the points of a tube that is stretched, twisted (rad/m) and widened evenly.
fn moved(grid: &Grid, stretch: f64, twist: f64, widening: f64) -> Vec<[f64; 3]> {
    let place = |&[x, y, z]: &[f64; 3]| {
        let (sine, cosine) = (twist * z).sin_cos();
        [widening * (x * cosine - y * sine), widening * (x * sine + y * cosine), stretch * z]
    };
    grid.points.iter().map(place).collect()
}

fn all_states(fibres: &Fibres, positions: &[[f64; 3]]) -> Vec<FibreState> {
    fibres.elements.iter().flat_map(|element| element.states(positions, &[])).collect()
}

/// Orders of convergence between errors at meshes twice as fine each.
fn orders(errors: &[f64]) -> Vec<f64> {
    errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect()
}
