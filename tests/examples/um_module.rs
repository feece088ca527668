//! draft
use actuator::{Description, Rig};
use freeact_tests::{plateau::plateaus, um_module::*};
use std::{error::Error, path::PathBuf, time::Instant};
fn main() -> Result<(), Box<dyn Error>> {
    let dir = PathBuf::from(std::env::args().nth(1).unwrap());
    let rig = Rig::read(&dir.join("rig.toml"))?;
    let Description::Module(module) = rig.description else { return Err("module".into()) };
    let (found, lost) = plateaus(&dir.join("grid.csv"));
    println!("{} {lost}", found.len());
    let found: Vec<_> =
        found.into_iter().enumerate().filter(|(i, _)| (i / 9) % 4 == 0).map(|(_, p)| p).collect();
    let cmd: Vec<[f64; 3]> = found.iter().map(|p| p.command_kpa).collect();
    let moduli = [1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0];
    let variants: Vec<(&str, Variation)> = vec![
        ("base", Variation::default()),
        ("spacers", Variation { spacers: 9, ..Variation::default() }),
        ("slack 1%", Variation { slack: 0.01, ..Variation::default() }),
        ("slack 3%", Variation { slack: 0.03, ..Variation::default() }),
        ("thinner .6", Variation { thinner: 0.6e-3, ..Variation::default() }),
        ("angle +3", Variation { angle: 0.052, ..Variation::default() }),
        ("angle -3", Variation { angle: -0.052, ..Variation::default() }),
        ("bending x10", Variation { bending: 10.0, ..Variation::default() }),
    ];
    for (name, v) in variants {
        let t = Instant::now();
        let scan = ModulusScan::new(&module, &v, &moduli, &cmd)?;
        for (m, motion) in scan.moduli.iter().zip(&scan.motions) {
            let e = Errors::of(motion.iter().zip(&found));
            println!(
                "{name} x{m}: {} missing {} rms {:.3} mm {:.4} rad mean {:.3} {:.4}",
                e.count, e.missing, e.rms[0], e.rms[1], e.mean[0], e.mean[1]
            );
        }
        println!("{name}: fit {:?} in {:?}", scan.fit(&found, &|_| true), t.elapsed());
    }
    Ok(())
}
