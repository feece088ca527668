//! Principal logarithmic strains of the paper's FREE as a solid, and its states as files for ParaView or pyvista.
//!
//! `cargo run --release -p fe --example solid_strains -- ANGLE_DEG LENGTH_MM AROUND ALONG FOLDER P_KPA...`; open `FOLDER/path.pvd`.

use actuator::{Elastomer, Fibre, FibreLaw, Free, Handedness, OgdenForm, Tube, Winding};
use fe::{SolidLoad, SolidMesh, SolidSolver, Specimen};
use std::{fs::File, io::BufWriter, path::Path};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [angle, length, around, along, folder, pressures @ ..] = &arguments[..] else {
        return Err("usage: ANGLE_DEG LENGTH_MM AROUND ALONG FOLDER P_KPA...".into());
    };
    let fibre = Fibre { axial_stiffness: 644.0, diameter: 0.15e-3, law: FibreLaw::Linear };
    let free = Free {
        tube: Tube { length: 1e-3 * length.parse::<f64>()?, inner_radius: 4.76e-3, wall: 0.8e-3 },
        winding: Winding::from_hoop(angle.parse::<f64>()?.to_radians(), Handedness::Right, 6, fibre),
        elastomer: Elastomer::Ogden { shear_modulus: 0.393e6, alpha: 1.2, form: OgdenForm::InitialModulus },
    };
    let specimen = Specimen { bulk_ratio: 1e3, ..Specimen::from(&free) };
    let mut solver = SolidSolver::sector(&specimen, SolidMesh::new(around.parse()?, along.parse()?))?;
    let stops: Vec<f64> =
        pressures.iter().map(|p| p.parse().map(|p: f64| 1e3 * p)).collect::<Result<_, _>>()?;
    let rest = solver.rest();
    let mut states = vec![];
    let end = solver.follow(&rest, 0.0, &stops, &SolidLoad::pressure, &mut |pressure, state| {
        states.push((1e-3 * pressure, state.clone()));
        true
    });
    std::fs::create_dir_all(folder)?;
    let create = |name: &str| File::create(Path::new(folder).join(name)).map(BufWriter::new);
    let mut frames = vec![];
    for (pressure, state) in &states {
        let found = solver.strains(state);
        println!(
            "{pressure:6.1} kPa: {:.4} to {:.4}, away from the caps {:.4} to {:.4}, there on average {:.4} {:.4} {:.4}",
            found.least.log_strain,
            found.greatest.log_strain,
            found.least_mid.log_strain,
            found.greatest_mid.log_strain,
            found.mean_mid[0],
            found.mean_mid[1],
            found.mean_mid[2],
        );
        let files = [format!("{pressure:.1}-kpa.vtu"), format!("{pressure:.1}-kpa-fibres.vtu")];
        solver.write_vtu(state, &[], &mut create(&files[0])?)?;
        solver.write_fibres_vtu(state, &mut create(&files[1])?)?;
        frames.push((*pressure, files.to_vec()));
    }
    fe::vtk::write_pvd(&frames, &mut create("path.pvd")?)?;
    end?;
    Ok(())
}
