//! Predicted and measured motion of a real module: three FREEs on a guide that leaves z and the rotation about z free.
//!
//! `cargo run --release -p freeact-tests --example um_module -- DIR [drawing] [fit] [reasons] [bends] [guide]`
//!
//! DIR holds `rig.toml` and `grid.csv` of D. Bruder's module of the University of Michigan (github.com/bruderd/UM-Matlab at 80fc221, which states no
//! licence: the data are not part of this project). Everything is printed: what was recorded, the prediction from the drawing alone, with one
//! shear modulus fitted to all FREEs, errors on combinations held out of the fit, and by how much each likely reason would change
//! the prediction. Naming parts prints those only. Minutes, most for the fit.

use actuator::{
    Description, Module, PoseChart, Rig, Wrench,
    units::{DEG, KPA, MM},
};
use fe::{ConstantBending, ModuleSweep, ThickTube};
use freeact_tests::{
    plateau::{Plateau, plateaus},
    um_module::{Errors, ModulusScan, Motion, Predictor, Variation, ranges},
};
use std::{error::Error, path::PathBuf};

/// Factors on the modulus at which the fit's predictions are made.
const FACTORS: [f64; 7] = [2.5, 3.2, 4.0, 5.0, 6.3, 8.5, 12.0];
/// Student's t of 95 % for nine blocks.
const STUDENT: f64 = 2.306;

fn command(plateaus: &[Plateau]) -> Vec<[f64; 3]> {
    plateaus.iter().map(|plateau| plateau.command_kpa).collect()
}

fn monitor(plateaus: &[Plateau]) -> Vec<[f64; 3]> {
    plateaus.iter().map(|plateau| plateau.monitor_kpa).collect()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

fn head() {
    println!(
        "{:46} predicted  none     rms mm  median   worst    mean   of range    rms rad  median   worst    mean   of range",
        ""
    );
}

fn tell(what: &str, errors: &Errors, range: [f64; 2]) {
    print!("{what:46} {:9}  {:4}  ", errors.count, errors.missing);
    for (k, whole) in range.into_iter().enumerate() {
        print!(
            "  {:7.3} {:7.3} {:7.3} {:7.3}  {:6.1} %  ",
            errors.rms[k],
            errors.median[k],
            errors.worst[k],
            errors.mean[k],
            100.0 * errors.rms[k] / whole
        );
    }
    println!();
}

fn errors_where(motions: &[Option<Motion>], found: &[Plateau], chosen: &dyn Fn(&Plateau) -> bool) -> Errors {
    Errors::of(motions.iter().zip(found).filter(|(_, plateau)| chosen(plateau)))
}

/// What was recorded, as it is.
fn recorded(found: &[Plateau], lost: usize) {
    let range = ranges(found);
    println!(
        "{} settled plateaus of five seconds, {lost} more lost to missing samples and spikes",
        found.len()
    );
    println!("range of z {:.3} mm, of the rotation {:.4} rad", range[0], range[1]);
    let unsettled = |k: usize| median(found.iter().map(|plateau| plateau.spread[k]).collect());
    println!(
        "half range within the last two seconds of a plateau, median: {:.3} mm, {:.4} rad",
        unsettled(0),
        unsettled(1)
    );
    let aside = |k: usize| found.iter().map(|plateau| plateau.aside_mm[k].abs()).fold(0.0, f64::max);
    println!("the guide lets the marker go aside by up to {:.2} mm in x, {:.2} mm in y", aside(0), aside(1));
    let zero: Vec<&Plateau> = found.iter().filter(|plateau| plateau.command_kpa == [0.0; 3]).collect();
    for plateau in &zero {
        println!("without pressure: z {:.3} mm, rotation {:.4} rad", plateau.z_mm, plateau.rz_rad);
    }
    for free in 0..3 {
        let line = found.iter().filter(|plateau| plateau.command_kpa[free] > 0.0);
        let points: Vec<[f64; 2]> =
            line.map(|plateau| [plateau.command_kpa[free], plateau.monitor_kpa[free]]).collect();
        let mean = [0, 1].map(|k| points.iter().map(|point| point[k]).sum::<f64>() / points.len() as f64);
        let moment = |k: usize| points.iter().map(|p| (p[0] - mean[0]) * (p[k] - mean[k])).sum::<f64>();
        let gain = moment(1) / moment(0);
        let idle = found.iter().filter(|plateau| plateau.command_kpa[free] == 0.0);
        println!(
            "monitor of FREE {}: {gain:.3} command + {:.2} kPa, at rest {:.2} kPa (median)",
            free + 1,
            mean[1] - gain * mean[0],
            median(idle.map(|plateau| plateau.monitor_kpa[free]).collect())
        );
    }
    println!(
        "\nHands: rotation (rad) and z (mm) from the least to the greatest pressure of one FREE, the others at rest"
    );
    for free in 0..3 {
        let alone =
            |plateau: &&Plateau| (0..3).all(|other| (other == free) == (plateau.command_kpa[other] > 0.0));
        let line: Vec<&Plateau> = found.iter().filter(alone).collect();
        if let [first, .., last] = &line[..] {
            let word = if last.rz_rad < first.rz_rad { "right" } else { "left" };
            println!(
                "FREE {}: {:+.4} rad, {:+.3} mm: {word}-handed, if the recording's rotation is right-handed about +z from base to tip",
                free + 1,
                last.rz_rad - first.rz_rad,
                last.z_mm - first.z_mm
            );
        }
    }
}

/// Factor of least misfit, with its interval from leaving out each level of FREE 1, which are blocks in time.
fn fitted(scan: &ModulusScan, found: &[Plateau]) -> (f64, [f64; 2]) {
    let (best, _) = scan.fit(found, &|_| true);
    let mut levels: Vec<f64> = found.iter().map(|plateau| plateau.command_kpa[0]).collect();
    levels.sort_by(f64::total_cmp);
    levels.dedup();
    let without: Vec<f64> =
        levels.iter().map(|level| scan.fit(found, &|i| found[i].command_kpa[0] != *level).0.ln()).collect();
    let count = without.len() as f64;
    let mean = without.iter().sum::<f64>() / count;
    let spread = without.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
    let half = STUDENT * ((count - 1.0) / count * spread).sqrt();
    (best, [best * (-half).exp(), best * half.exp()])
}

/// Errors in parts of the combinations.
fn in_parts(motions: &[Option<Motion>], found: &[Plateau], range: [f64; 2]) {
    for free in 0..3 {
        let alone = move |plateau: &Plateau| {
            (0..3).all(|other| (other == free) == (plateau.command_kpa[other] > 0.0))
        };
        tell(&format!("  only FREE {}", free + 1), &errors_where(motions, found, &alone), range);
    }
    for (name, from, to) in [("0", -1.0, 1.0), ("17 to 69", 1.0, 70.0), ("86 to 138", 70.0, 140.0)] {
        let part = move |plateau: &Plateau| (from..to).contains(&plateau.command_kpa[2]);
        tell(&format!("  FREE 3 at {name} kPa"), &errors_where(motions, found, &part), range);
    }
}

fn fit_and_judge(
    module: &Module,
    predictor: &Predictor,
    base: &Variation,
    found: &[Plateau],
) -> Result<(), Box<dyn Error>> {
    let range = ranges(found);
    let scan = ModulusScan::new(predictor, base, &FACTORS, &command(found))?;
    let (factor, [low, high]) = fitted(&scan, found);
    let own = module.frees[0].free.elastomer.shear_modulus() / 1e6;
    println!(
        "\n{} spacers, bending {}, one modulus fitted to all: {factor:.3} x {own} MPa = {:.3} MPa (95 % {:.3} to {:.3}, leaving out levels of FREE 1)",
        base.spacers,
        if base.bare { "of the bare tubes" } else { "from solids" },
        factor * own,
        low * own,
        high * own
    );
    head();
    println!(
        "fitted on {} that have an equilibrium at every factor",
        (0..found.len()).filter(|i| scan.is_told(*i)).count()
    );
    let motions = predictor.predict(&Variation { modulus: factor, ..base.clone() }, &command(found))?;
    tell("all, as fitted", &errors_where(&motions, found, &|_| true), range);
    in_parts(&motions, found, range);
    let mut levels: Vec<f64> = found.iter().map(|plateau| plateau.command_kpa[2]).collect();
    levels.sort_by(f64::total_cmp);
    levels.dedup();
    let level = |i: usize| levels.iter().position(|level| *level == found[i].command_kpa[2]).unwrap_or(0);
    let splits: [(&str, &dyn Fn(usize) -> bool); 3] = [
        ("every other combination", &|i| i % 2 == 0),
        ("every other level of FREE 3", &|i| level(i) % 2 == 0),
        ("FREE 1 up to 34 kPa", &|i| found[i].command_kpa[0] < 35.0),
    ];
    for (name, split) in splits {
        let (own, _) = scan.fit(found, split);
        let motions = scan.at(own);
        let others = motions.iter().zip(found).enumerate().filter(|(i, _)| !split(*i)).map(|(_, pair)| pair);
        tell(&format!("held out; fit on {name}: {own:.3}"), &Errors::of(others), range);
    }
    Ok(())
}

/// Of nine plateaus that FREE 3 rises through, every fourth.
fn every_fourth_row(found: &[Plateau]) -> Vec<Plateau> {
    found.chunks(9).step_by(4).flatten().cloned().collect()
}

fn drawn(predictor: &Predictor, base: &Variation, part: &[Plateau]) -> Result<ModulusScan, Box<dyn Error>> {
    Ok(ModulusScan::new(predictor, base, &FACTORS, &command(part))?)
}

/// What each reason would change, on every fourth row of the recording.
fn reasons(predictor: &Predictor, found: &[Plateau]) -> Result<(), Box<dyn Error>> {
    let part = every_fourth_row(found);
    let range = ranges(found);
    // Bending of the bare tubes, with which every combination has an equilibrium and laws are quickly made.
    let bare = Variation { bare: true, ..Variation::default() };
    let (factor, _) = drawn(predictor, &bare, &part)?.fit(&part, &|_| true);
    let base = Variation { modulus: factor, ..bare };
    let before = predictor.predict(&base, &command(&part))?;
    let offset: [f64; 3] = std::array::from_fn(|free| {
        let idle = part.iter().filter(|plateau| plateau.command_kpa[free] == 0.0);
        median(idle.map(|plateau| plateau.monitor_kpa[free]).collect())
    });
    let above = |plateau: &Plateau| std::array::from_fn(|i| (plateau.monitor_kpa[i] - offset[i]).max(0.0));
    let changes: Vec<(&str, Variation, Vec<[f64; 3]>)> = vec![
        ("nothing", base.clone(), command(&part)),
        ("pressure: monitor instead of command", base.clone(), monitor(&part)),
        ("pressure: monitor less its value at rest", base.clone(), part.iter().map(above).collect()),
        ("wall 1.0 mm, threads at 5.76 mm", Variation { thinner: 0.4 * MM, ..base.clone() }, command(&part)),
        ("ends: FREEs 150 mm long", Variation { length: 150.0 / 160.0, ..base.clone() }, command(&part)),
        ("FREE 3 at 40.23 degrees", Variation { angle: 3.0 * DEG, ..base.clone() }, command(&part)),
        ("FREE 3 at 34.23 degrees", Variation { angle: -3.0 * DEG, ..base.clone() }, command(&part)),
        (
            "FREE 3 at 52.77 degrees from the hoop",
            Variation { angle: 15.54 * DEG, ..base.clone() },
            command(&part),
        ),
        ("threads 0.5 % loose", Variation { slack: 0.005, ..base.clone() }, command(&part)),
        ("threads 1 % loose", Variation { slack: 0.01, ..base.clone() }, command(&part)),
        ("EA a tenth", Variation { threads: 0.1, ..base.clone() }, command(&part)),
        ("bending stiffness x 3", Variation { bending: 3.0, ..base.clone() }, command(&part)),
        ("bending from solids", Variation { bare: false, ..base.clone() }, command(&part)),
        ("nine spacers", Variation { spacers: 9, ..base.clone() }, command(&part)),
    ];
    println!(
        "\nReasons, on {} combinations: change of the prediction at that modulus, and errors with the modulus fitted again",
        part.len()
    );
    println!("{:44} change: rms mm      rad   fitted again: x      rms mm      rad   misfit", "");
    for (name, variation, pressures) in &changes {
        let changed = predictor.predict(variation, pressures)?;
        let both = || changed.iter().zip(&before).filter_map(|(a, b)| Some(((*a)?, (*b)?)));
        let rms = |k: usize| {
            (both().map(|(a, b)| (a[k] - b[k]).powi(2)).sum::<f64>() / both().count().max(1) as f64).sqrt()
        };
        let scan = ModulusScan::new(predictor, variation, &FACTORS, pressures)?;
        let (again, misfit) = scan.fit(&part, &|_| true);
        let errors = Errors::of(scan.at(again).iter().zip(&part));
        println!(
            "{name:44} {:14.3} {:8.4} {again:17.2} {:11.3} {:8.4} {misfit:8.4}",
            rms(0) / MM,
            rms(1),
            errors.rms[0],
            errors.rms[1]
        );
    }
    println!(
        "misfit: 1 is the whole range of the recording ({:.2} mm, {:.2} rad) in both",
        range[0], range[1]
    );
    Ok(())
}

/// What the guide has to do with it: the wrench that it would have to give, and how far little of it moves the plate.
fn guide(module: &Module, predictor: &Predictor, found: &[Plateau]) -> Result<(), Box<dyn Error>> {
    let part = every_fourth_row(found);
    let (factor, _) =
        drawn(predictor, &Variation { bare: true, ..Variation::default() }, &part)?.fit(&part, &|_| true);
    let blocked = predictor.rods(&Variation { bare: true, ..Variation::default() })?;
    let rest = PoseChart { twist: 0.0, bend: [0.0; 2], position: [0.0, 0.0, module.length()] };
    println!(
        "\nForce along z and moment about z of one FREE at its greatest pressure, plate held at rest, from the drawing"
    );
    for (free, top) in [68.9476, 68.9476, 137.8951].into_iter().enumerate() {
        let mut pressures = [0.0; 3];
        pressures[free] = top * KPA;
        let given: Wrench = blocked.held(&rest)?.solve(&pressures)?.wrenches.into_iter().sum();
        println!("FREE {}: {:8.1} N {:8.4} N m at {top:.1} kPa", free + 1, given.force[2], given.moment[2]);
    }
    println!(
        "\nWhat the guide would have to give for the module to stand where it was measured (plate held there), medians"
    );
    for modulus in [1.0, factor] {
        let wanted =
            predictor.wanted_of_guide(&Variation { modulus, bare: true, ..Variation::default() }, &part)?;
        let pairs: Vec<([f64; 2], &Plateau)> =
            wanted.iter().zip(&part).filter_map(|(wanted, plateau)| Some(((*wanted)?, plateau))).collect();
        for (name, low, high) in [("0", -1.0, 1.0), ("17 to 69", 1.0, 70.0), ("86 to 138", 70.0, 140.0)] {
            let own = || pairs.iter().filter(|(_, plateau)| (low..high).contains(&plateau.command_kpa[2]));
            let of = |k: usize| median(own().map(|(wanted, _)| wanted[k]).collect());
            let size = |k: usize| median(own().map(|(wanted, _)| wanted[k].abs()).collect());
            println!(
                "modulus x {modulus:5.2}, FREE 3 at {name:9} kPa: {:7.2} N {:8.4} N m; sizes {:7.2} N {:8.4} N m ({} held)",
                of(0),
                of(1),
                size(0),
                size(1),
                own().count()
            );
        }
    }
    println!("\nWhere FREE 3 has up to 52 kPa, medians:");
    let low: Vec<Plateau> = part.iter().filter(|plateau| plateau.command_kpa[2] < 60.0).cloned().collect();
    for modulus in [1.0, factor] {
        let base = Variation { modulus, bare: true, ..Variation::default() };
        let before = predictor.predict(&base, &command(&low))?;
        for (name, load) in [("10 N along z", [10.0, 0.0]), ("0.01 N m about z", [0.0, 0.01])] {
            let changed = predictor.predict(&Variation { load, ..base.clone() }, &command(&low))?;
            let both = || changed.iter().zip(&before).filter_map(|(a, b)| Some(((*a)?, (*b)?)));
            let moved = |k: usize| median(both().map(|(a, b)| (a[k] - b[k]).abs()).collect());
            println!(
                "modulus x {modulus:5.2}: {name:16} moves the plate by {:.3} mm and {:.4} rad",
                moved(0) / MM,
                moved(1)
            );
        }
    }
    Ok(())
}

/// How stiff FREE 1 is in bending by the law from solids, and how far its threads are stretched, against how far the guide bends it.
fn bends(module: &Module, predictor: &Predictor, found: &[Plateau]) -> Result<(), Box<dyn Error>> {
    let (arm, length) = (module.frees[0].position[1].abs(), module.length());
    let turned = found.iter().map(|plateau| plateau.rz_rad.abs()).fold(0.0, f64::max);
    // Clamped ends that are shifted by d: 6 d/L^2.
    let curvature = 6.0 * arm * turned / (length * length);
    for modulus in [1.0, 5.0] {
        let mut free = module.frees[0].free;
        free.elastomer = free.elastomer.with_shear_modulus(modulus * free.elastomer.shear_modulus());
        let law = predictor.rods(&Variation { modulus, ..Variation::default() })?.laws().swap_remove(0);
        let (tube, radius) = (ThickTube::new(&free), free.tube.outer_radius());
        let turn = free.winding.turn_per_length(radius);
        let bare = ConstantBending::of_bare_tube(&free).bending;
        println!(
            "\nFREE 1 at {modulus} x the modulus; the guide bends its surface by up to {:.2} % ({curvature:.1} rad/m)",
            100.0 * curvature * radius
        );
        for kpa in [0.0, 17.2, 34.5, 51.7, 68.9] {
            let state = tube.free_state(kpa * KPA)?;
            let answer = law.bending.respond(kpa * KPA, state.axial_stretch, state.twist_per_length, 0.0);
            let around = state.expansion * radius * (turn + state.twist_per_length);
            let thread = around.hypot(state.axial_stretch) / (radius * turn).hypot(1.0) - 1.0;
            println!(
                "free at {kpa:4.1} kPa: EI {:5.1} x 3 mu I, threads stretched by {:.3} %",
                answer.stiffness[0] / bare,
                100.0 * thread
            );
        }
    }
    Ok(())
}

fn from_the_drawing(
    rig: &Rig,
    module: &Module,
    predictor: &Predictor,
    found: &[Plateau],
) -> Result<(), Box<dyn Error>> {
    let range = ranges(found);
    let map = ModuleSweep::default().empty_map(
        module.clone(),
        rig.limits.clone(),
        rig.limits.pressure_max.iter().map(|top| vec![0.0, *top]).collect(),
        Default::default(),
    )?;
    println!("\nFrom the drawing alone. Limit pressures of the FREEs: {:?} Pa", map.limit_pressures);
    head();
    for (spacers, bare) in [(0, false), (0, true), (9, false)] {
        let base = Variation { spacers, bare, ..Variation::default() };
        for (name, pressures) in [("command", command(found)), ("monitor", monitor(found))] {
            // Tied FREEs are for comparison only, and which pressures hardly matters here.
            if (spacers > 0 || bare) && name == "monitor" {
                continue;
            }
            let motions = predictor.predict(&base, &pressures)?;
            tell(
                &format!("{spacers} spacers, by {name}{}", if bare { ", 3 mu I" } else { "" }),
                &errors_where(&motions, found, &|_| true),
                range,
            );
            if spacers == 0 && !bare && name == "command" {
                in_parts(&motions, found, range);
            }
        }
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = PathBuf::from(arguments.next().ok_or("give the folder of rig.toml and grid.csv")?);
    let parts: Vec<String> = arguments.collect();
    let wanted = |part: &str| parts.is_empty() || parts.iter().any(|own| own == part);
    let rig = Rig::read(&folder.join("rig.toml"))?;
    let Description::Module(module) = &rig.description else {
        return Err("rig.toml is not of a module".into());
    };
    let (found, lost) = plateaus(&folder.join("grid.csv"));
    recorded(&found, lost);
    let predictor = Predictor::new(module);
    if wanted("drawing") {
        from_the_drawing(&rig, module, &predictor, &found)?;
    }
    if wanted("fit") {
        for (spacers, bare) in [(0, false), (0, true), (9, false)] {
            fit_and_judge(module, &predictor, &Variation { spacers, bare, ..Variation::default() }, &found)?;
        }
    }
    if wanted("reasons") {
        reasons(&predictor, &found)?;
    }
    if wanted("bends") {
        bends(module, &predictor, &found)?;
    }
    if wanted("guide") {
        guide(module, &predictor, &found)?;
    }
    Ok(())
}
