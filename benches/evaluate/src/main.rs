//! Time of one evaluation, with its derivatives, of a module's and a FREE's model, beside the crate `interpn` and scipy on the same table.
//!
//! `run MODULE.model FREE.model [PYTHON]`: rounds in turn, one thread each; the median of the rounds and their spread.

use evaluator::{Content, Image, Real};
use interpn::{MultiBsplineRegular, MulticubicRegular};
use rom::{Model, PoseModel};
use std::{env, fs, hint::black_box, path::Path, process::Command, time::Instant};

/// Points evaluated in a round, again and again.
const POINTS: usize = 1000;
/// Times over all points in a round.
const REPEATS: usize = 30;
const ROUNDS: usize = 9;
/// Nodes an axis of the even table that all libraries are given.
const NODES: usize = 9;
/// FREEs of the module: `interpn` has its number of axes at compile time.
const FREES: usize = 4;

/// Microseconds a point.
fn time(mut one: impl FnMut(usize)) -> f64 {
    let begin = Instant::now();
    for _ in 0..REPEATS {
        (0..POINTS).for_each(&mut one);
    }
    begin.elapsed().as_secs_f64() * 1e6 / (REPEATS * POINTS) as f64
}

struct Rounds {
    what: String,
    microseconds: Vec<f64>,
}

impl Rounds {
    fn median(&self) -> f64 {
        let mut sorted = self.microseconds.clone();
        sorted.sort_by(f64::total_cmp);
        sorted[sorted.len() / 2]
    }

    fn line(&self, base: f64) -> String {
        let least = self.microseconds.iter().fold(f64::INFINITY, |a, b| a.min(*b));
        let most = self.microseconds.iter().fold(0.0f64, |a, b| a.max(*b));
        let median = self.median();
        format!("{:<66} {median:>10.3} {least:>10.3} {most:>10.3} {:>9.1}", self.what, median / base)
    }
}

/// Uniform numbers below one, the same in every run.
fn scattered(count: usize) -> impl Iterator<Item = f64> {
    let mut seed = 0x2545_f491_4f6c_dd1du64;
    (0..count).map(move |_| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1u64 << 53) as f64
    })
}

fn aligned(bytes: &[u8]) -> Vec<u64> {
    let mut words = vec![0u64; bytes.len().div_ceil(8)];
    bytemuck::cast_slice_mut(&mut words)[..bytes.len()].copy_from_slice(bytes);
    words
}

fn write_numbers(path: &Path, numbers: &[f64]) {
    fs::write(path, bytemuck::cast_slice::<f64, u8>(numbers)).expect("a temporary file can be written");
}

fn tips<T: Real + bytemuck::Pod>(model: &Model, points: &[[f64; FREES]]) -> impl FnMut() -> f64 {
    let image: &'static [u64] = Vec::leak(aligned(&model.image::<T>().expect("the model has an image")));
    let length = model.image::<T>().expect("as above").len();
    let image = Image::<T>::read(&bytemuck::cast_slice(image)[..length]).expect("it was written so");
    let points: Vec<[T; FREES]> = points.iter().map(|point| point.map(T::constant)).collect();
    move || {
        let Content::Module(tip) = &image.content else { panic!("the first model is of a module") };
        let chain = image.effects.chain();
        let mut memory = vec![T::ZERO; chain.memory()];
        time(|k| {
            black_box(tip.evaluate(&chain, &mut memory, T::constant(0.01), black_box(&points[k])).ok());
        })
    }
}

fn main() {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [module_path, free_path, rest @ ..] = &arguments[..] else {
        eprintln!("usage: run MODULE.model FREE.model [PYTHON]");
        std::process::exit(2);
    };
    let load = |path: &String| Model::read(Path::new(path)).unwrap_or_else(|error| panic!("{error}"));
    let begin = Instant::now();
    let module = load(module_path);
    let load_time = begin.elapsed().as_secs_f64() * 1e3;
    let free_model = load(free_path);
    let size = |path: &String| fs::metadata(path).map_or(0, |data| data.len());
    let tip = module.as_module().expect("the first model is of a module");
    assert_eq!(module.frees(), FREES, "the first model is of a module of four FREEs");
    let free = free_model.as_free().expect("the second model is of a FREE");

    // The same even table for all: the module's chart at nine pressures a FREE.
    let domain = tip.domain().to_vec();
    let axes: Vec<Vec<f64>> = domain
        .iter()
        .map(|(low, high)| (0..NODES).map(|k| low + (high - low) * k as f64 / (NODES - 1) as f64).collect())
        .collect();
    let mut into = tip.workspace();
    into.slopes.clear();
    let table: Vec<[f64; 6]> = (0..NODES.pow(4))
        .map(|node| {
            let place = |free: usize| node / NODES.pow(3 - free as u32) % NODES;
            let pressures: [f64; FREES] = std::array::from_fn(|free| axes[free][place(free)]);
            tip.evaluate(&pressures, &mut into).expect("the box is the model's domain");
            into.chart.to_array()
        })
        .collect();
    let spline = rom::interpolate(axes.clone(), table.clone()).expect("even nodes interpolate");
    let numbers: Vec<f64> = scattered(POINTS * FREES).collect();
    let points: Vec<[f64; FREES]> = numbers
        .as_chunks::<FREES>()
        .0
        .iter()
        .map(|u| std::array::from_fn(|free| domain[free].0 + (domain[free].1 - domain[free].0) * u[free]))
        .collect();

    let outputs: Vec<Vec<f64>> =
        (0..6).map(|output| table.iter().map(|entry| entry[output]).collect()).collect();
    let starts: [f64; FREES] = std::array::from_fn(|free| axes[free][0]);
    let steps: [f64; FREES] = std::array::from_fn(|free| axes[free][1] - axes[free][0]);
    let cubics: Vec<_> = outputs
        .iter()
        .map(|values| MulticubicRegular::new([NODES; FREES], starts, steps, values, false).unwrap())
        .collect();
    let mut coefficients = vec![vec![0.0; table.len()]; 6];
    for (values, into) in outputs.iter().zip(&mut coefficients) {
        let mut scratch = vec![0.0; 16 * table.len()];
        interpn::multibspline::regular::coefficients([NODES; FREES], values, into, &mut scratch).unwrap();
    }
    let bsplines: Vec<_> = coefficients
        .iter()
        .map(|values| MultiBsplineRegular::new([NODES; FREES], starts, steps, values, false).unwrap())
        .collect();

    let folder = env::temp_dir().join(format!("freeact-evaluate-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a temporary folder can be made");
    write_numbers(&folder.join("axes"), &axes.concat());
    write_numbers(&folder.join("table"), table.as_flattened());
    write_numbers(&folder.join("points"), points.as_flattened());

    let (angles, moduli) = (free.winding_angles(), free.shear_moduli());
    let between = |axis: &[f64], u: f64| axis[0] + (axis[axis.len() - 1] - axis[0]) * u;
    let free_points: Vec<[f64; 3]> = numbers
        .as_chunks::<FREES>()
        .0
        .iter()
        .map(|u| {
            let (angle, modulus) = (between(angles, u[0]), between(moduli, u[1]));
            [0.98 * u[2] * free.greatest_pressure(angle, modulus).expect("it is inside"), angle, modulus]
        })
        .collect();

    let mut double = tips::<f64>(&module, &points);
    let mut single = tips::<f32>(&module, &points);
    let python = rest.first();
    let mut measures: Vec<(&str, Box<dyn FnMut() -> f64 + '_>)> = vec![
        (
            "freeact, single FREE, state and 3x3 Jacobian, f64",
            Box::new(|| {
                time(|k| {
                    let [pressure, angle, modulus] = black_box(free_points[k]);
                    black_box(free.evaluate(pressure, angle, modulus).ok());
                })
            }),
        ),
        (
            "freeact, model of the module, chart and 6x4 Jacobian, f64",
            Box::new(|| {
                time(|k| {
                    black_box(tip.evaluate(black_box(&points[k]), &mut into).ok());
                    black_box(&into);
                })
            }),
        ),
        ("freeact, image of the module, pose and 6x4 Jacobian, f64", Box::new(&mut double)),
        ("freeact, image of the module, pose and 6x4 Jacobian, f32", Box::new(&mut single)),
        (
            "freeact, the even table, 6 outputs and 6x4 Jacobian",
            Box::new(|| {
                time(|k| {
                    let (mut value, mut gradient) = ([0.0; 6], [[0.0; 6]; FREES]);
                    black_box(spline.evaluate(black_box(&points[k]), &mut value, &mut gradient).ok());
                    black_box((value, gradient));
                })
            }),
        ),
        (
            "interpn 0.11.2 multicubic, the same",
            Box::new(|| {
                time(|k| {
                    for cubic in &cubics {
                        black_box(cubic.interp_one(black_box(points[k])).ok());
                        black_box(cubic.interp_one_grad(black_box(points[k])).ok());
                    }
                })
            }),
        ),
        (
            "interpn 0.11.2 B-spline, the same",
            Box::new(|| {
                time(|k| {
                    for bspline in &bsplines {
                        black_box(bspline.interp_one(black_box(points[k])).ok());
                        black_box(bspline.interp_one_grad(black_box(points[k])).ok());
                    }
                })
            }),
        ),
    ];
    if let Some(python) = python {
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("scipy_grid.py");
        for (what, part) in [
            ("scipy RegularGridInterpolator cubic, 6 outputs, values alone, batch", "values"),
            ("scipy RegularGridInterpolator cubic, 6 outputs and 6x4 Jacobian, batch", "jacobian"),
        ] {
            let (script, folder) = (script.clone(), folder.clone());
            measures.push((
                what,
                Box::new(move || {
                    let told = Command::new(python).arg(&script).arg(&folder).arg(part).output();
                    let told = String::from_utf8(told.expect("Python starts").stdout).unwrap_or_default();
                    told.trim().parse().unwrap_or(f64::NAN)
                }),
            ));
        }
    }
    let mut rounds: Vec<Rounds> = measures
        .iter()
        .map(|(what, _)| Rounds { what: (*what).to_owned(), microseconds: Vec::new() })
        .collect();
    for round in 0..ROUNDS {
        for ((what, measure), into) in measures.iter_mut().zip(&mut rounds) {
            // Python takes seconds a round.
            if !what.starts_with("scipy") || round < 3 {
                into.microseconds.push(measure());
            }
        }
    }
    drop(measures);
    println!("{:<66} {:>10} {:>10} {:>10} {:>9}", "us an evaluation, one thread", "median", "least", "most", "x ours");
    let base = rounds[4].median();
    for rounds in &rounds {
        println!("{}", rounds.line(base));
    }
    // That all answer alike on the same table, where they mean the same: at the nodes.
    let off = |answer: &dyn Fn(usize, [f64; FREES]) -> f64| {
        let node: [f64; FREES] = std::array::from_fn(|free| axes[free][3 + free % 2]);
        let index = (0..FREES).fold(0, |index, free| index * NODES + 3 + free % 2);
        (0..6).map(|output| (answer(output, node) - table[index][output]).abs()).fold(0.0, f64::max)
    };
    println!(
        "\noff the table at a node: ours {:.1e}, interpn multicubic {:.1e}, interpn B-spline {:.1e}",
        off(&|output, at| spline.partial(&at, &[0; FREES]).unwrap()[output]),
        off(&|output, at| cubics[output].interp_one(at).unwrap()),
        off(&|output, at| bsplines[output].interp_one(at).unwrap())
    );
    println!(
        "module: file {} bytes read in {load_time:.2} ms, image {} bytes in f64 and {} in f32; FREE: file {} bytes, image {}",
        size(module_path),
        module.image::<f64>().expect("as above").len(),
        module.image::<f32>().expect("as above").len(),
        size(free_path),
        free_model.image::<f64>().expect("a FREE's model has an image").len()
    );
    let _ = fs::remove_dir_all(&folder);
}
