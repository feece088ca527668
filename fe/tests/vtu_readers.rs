//! States of a solid are read by other people's libraries: runs tests/python/read_vtu.py on a short path.
//!
//! Needs FREEACT_PYTHON, the Python of an environment with tests/python/requirements.txt installed; says so and skips without it.

use actuator::{Elastomer, Fibre, FibreLaw, Free, Handedness, Tube, Winding};
use fe::{Coat, SolidLoad, SolidMesh, SolidSolver, Specimen};
use std::{fs, fs::File, io::BufWriter, path::Path, process::Command};

#[test]
fn states_of_a_path_are_read_by_meshio() {
    let Some(python) = std::env::var_os("FREEACT_PYTHON") else {
        eprintln!("SKIPPED: set FREEACT_PYTHON to a Python with tests/python/requirements.txt installed");
        return;
    };
    let fibre = Fibre { axial_stiffness: 644.0, diameter: 0.3e-3, law: FibreLaw::Linear };
    let elastomer = Elastomer::NeoHookean { shear_modulus: 0.393e6 };
    let free = Free {
        tube: Tube { length: 0.02, inner_radius: 4.76e-3, wall: 0.8e-3 },
        winding: Winding::from_hoop(20f64.to_radians(), Handedness::Right, 6, fibre),
        elastomer,
    };
    let coat = Some(Coat { thickness: 0.2e-3, elastomer });
    let specimen = Specimen { coat, bulk_ratio: 1e3, ..Specimen::from(&free) };
    let mut solver = SolidSolver::new(&specimen, SolidMesh::new(12, 6)).unwrap();
    let rest = solver.rest();
    let mut states = vec![];
    let load = |pressure| SolidLoad::pressure(pressure);
    let follow = solver.follow(&rest, 0.0, &[0.0, 20e3, 40e3], &load, &mut |pressure, state| {
        states.push((pressure, state.clone()));
        true
    });
    follow.unwrap();

    let folder = std::env::temp_dir().join(format!("freeact-vtu-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let mut frames = vec![];
    for (pressure, state) in &states {
        let kilopascals = 1e-3 * pressure;
        let files = [format!("{kilopascals:.0}.vtu"), format!("{kilopascals:.0}-fibres.vtu")];
        let create = |name: &str| BufWriter::new(File::create(folder.join(name)).unwrap());
        solver.write_vtu(state, &[], &mut create(&files[0])).unwrap();
        assert!(solver.write_fibres_vtu(state, &mut create(&files[1])).unwrap());
        frames.push((kilopascals, files.to_vec()));
    }
    let collection = folder.join("path.pvd");
    fe::vtk::write_pvd(&frames, &mut File::create(&collection).unwrap()).unwrap();

    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/python/read_vtu.py");
    let run = Command::new(&python).arg(&script).arg(&collection).output().unwrap();
    let (out, err) = (String::from_utf8_lossy(&run.stdout), String::from_utf8_lossy(&run.stderr));
    assert!(run.status.success(), "{}\n{out}\n{err}", folder.display());
    // 12 around, 6 along, tube and coat; 6 fibres with two points an element.
    assert!(out.contains("40 kPa: 144 hexahedra"), "{out}");
    assert!(out.contains("66 lines of 6 fibres"), "{out}");
    assert!(out.contains("3 states read by meshio"), "{out}");
    fs::remove_dir_all(&folder).unwrap();
}
