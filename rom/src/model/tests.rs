use super::*;
use crate::{
    PoseModel,
    effect::{Effect, EffectKind},
    synthetic::{PRESSURE_MAX, free_map, module_map},
};
use serde::ser::SerializeTuple;

const HEADER: usize = 44;

fn even(count: usize) -> Vec<f64> {
    (0..count).map(|i| PRESSURE_MAX * i as f64 / (count - 1) as f64).collect()
}

fn module() -> Model {
    let map = module_map(vec![even(5), even(4)], 10);
    let provenance = Provenance::new(&map, &map.source, &map.settings).unwrap();
    let mut model = Model::new(ModelContent::Module(ModuleModel::fit(&map).unwrap()), provenance);
    model.effects.effects.push(Effect::at_start(EffectKind::Creep, vec![0, 1]));
    model
}

fn free() -> Model {
    let map = free_map(vec![0.4, 0.8, 1.2], vec![0.2e6, 0.4e6], 12, None);
    let provenance = Provenance::new(&map, &map.source, &map.settings).unwrap();
    Model::new(ModelContent::Free(FreeModel::fit(&map).unwrap()), provenance)
}

fn read(bytes: &[u8]) -> Result<Model, ModelError> {
    Model::from_bytes(Path::new("x.model"), bytes)
}

/// A body that becomes a file as it stands, with a right checksum.
struct Raw<'a>(&'a [u8]);

impl Serialize for Raw<'_> {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut tuple = serializer.serialize_tuple(self.0.len())?;
        self.0.iter().try_for_each(|byte| tuple.serialize_element(byte))?;
        tuple.end()
    }
}

fn sealed(body: &[u8]) -> Vec<u8> {
    artefact::to_bytes(artefact::MODEL, &Raw(body)).unwrap()
}

#[test]
fn a_model_comes_back_bit_for_bit() {
    for model in [module(), free()] {
        let bytes = model.to_bytes().unwrap();
        let back = read(&bytes).unwrap();
        assert_eq!(back, model);
        assert_eq!(back.to_bytes().unwrap(), bytes);
        assert_eq!(back.hash().unwrap(), model.hash().unwrap());
        assert_eq!(sealed(&bytes[HEADER..]), bytes);
    }
    let (model, back) = (module(), read(&module().to_bytes().unwrap()).unwrap());
    let (a, b) = (model.as_module().unwrap(), back.as_module().unwrap());
    let (mut into, mut other) = (a.workspace(), b.workspace());
    a.evaluate(&[12_345.6, 54_321.0], &mut into).unwrap();
    b.evaluate(&[12_345.6, 54_321.0], &mut other).unwrap();
    assert_eq!(into, other);
    assert_eq!((a.domain(), model.frees(), free().frees()), (b.domain(), 2, 1));
    assert!(model.as_free().is_none() && free().as_module().is_none() && free().as_free().is_some());
}

#[test]
fn the_map_is_named_by_its_files_checksum() {
    let map = free_map(vec![0.4], vec![0.2e6], 12, None);
    let provenance = Provenance::new(&map, &map.source, &map.settings).unwrap();
    let bytes = artefact::to_bytes(artefact::MAP, &map).unwrap();
    assert_eq!(provenance.map_hash.len(), 64);
    assert!(provenance.map_hash.starts_with(&format!("{:02x}{:02x}", bytes[12], bytes[13])));
    assert!(provenance.map_hash.ends_with(&format!("{:02x}", bytes[43])));
    assert_eq!(provenance.description_name, "synthetic");
}

#[test]
fn files_that_are_no_models_are_told_in_words() {
    let bytes = module().to_bytes().unwrap();
    let message = |bytes: &[u8]| read(bytes).unwrap_err().to_string();
    let map = artefact::to_bytes(artefact::MAP, &1u8).unwrap();
    assert!(message(&map).contains("not a freeact model file"), "{}", message(&map));
    assert!(message(b"").contains("not a freeact model file"));
    assert!(message(&bytes[..30]).contains("ends inside its header"));
    assert!(message(&bytes[..bytes.len() - 7]).contains("checksum"));
    let mut flipped = bytes.clone();
    flipped[bytes.len() / 2] ^= 0x10;
    assert!(message(&flipped).contains("checksum"));
    let mut future = bytes.clone();
    future[8] = 77;
    assert!(message(&future).contains("version 77 is not known here"));
    // Cut short by someone who made the checksum again.
    for kept in [0, 1, 100, bytes.len() - HEADER - 1] {
        assert!(message(&sealed(&bytes[HEADER..HEADER + kept])).contains("damaged"));
    }
    let missing = Model::read(Path::new("no/such.model")).unwrap_err().to_string();
    assert!(missing.starts_with("no/such.model: "), "{missing}");
}

/// What `freeact predict` of the version that wrote the module's file printed for 40, 10, 0 and 20 kPa: position, m.
const MODULE_POSITION: [f64; 3] = [-17.0496883475e-3, -7.52964454601e-3, 176.54013763e-3];
/// The same of the FREE's for 30 kPa: stretch, expansion, twist per length in deg/mm.
const FREE_STATE: [f64; 3] = [1.01800133355, 1.08246491191, -1.34610988227];

#[test]
fn models_of_earlier_formats_are_read() {
    let old = |name: String| Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data").join(name);
    for version in [1, 2] {
        let [module, free] = ["module", "free"].map(|kind| {
            let path = old(format!("version-{version}-{kind}.model"));
            assert_eq!(artefact::version(&std::fs::read(&path).unwrap()), Some(version));
            let model = Model::read(&path).unwrap();
            let bytes = model.to_bytes().unwrap();
            assert_eq!(artefact::version(&bytes), Some(artefact::MODEL.version));
            assert_eq!(read(&bytes).unwrap(), model);
            model
        });
        // Both were fitted to the same maps.
        let module = module.as_module().unwrap();
        let mut into = module.workspace();
        module.evaluate(&[40e3, 10e3, 0.0, 20e3], &mut into).unwrap();
        let position = into.chart.to_pose().position;
        for (value, expected) in position.iter().zip(MODULE_POSITION) {
            assert!((value - expected).abs() < 1e-12, "{position:?}");
        }
        assert_eq!(module.splines().error_bars(&[0.0; 4]).is_some(), version == 2);
        assert_eq!(module.errors().position.count, 6);
        let angle = 30f64.to_radians();
        let free = free.as_free().unwrap();
        let state = free.evaluate(30e3, angle, 0.393e6).unwrap();
        let twist = state.twist_per_length.to_degrees() / 1e3;
        for (value, expected) in [state.axial_stretch, state.expansion, twist].iter().zip(FREE_STATE) {
            assert!((value - expected).abs() < 1e-10, "{state:?}");
        }
        assert!(free.splines().error_bars(30e3, angle, 0.393e6).unwrap().is_none());
    }
}

#[test]
fn a_model_is_written_whole_and_read_again() {
    let path = std::env::temp_dir().join(format!("freeact-model-{}.model", std::process::id()));
    let model = free();
    model.write(&path).unwrap();
    let back = Model::read(&path);
    std::fs::remove_file(&path).unwrap();
    assert_eq!(back.unwrap(), model);
}

#[test]
fn contents_that_cannot_be_are_told_in_words() {
    use crate::stored_model::StoredContent;
    let message = |model: &Model, change: fn(&mut StoredModel)| {
        let mut stored = StoredModel::from(model);
        change(&mut stored);
        read(&artefact::to_bytes(artefact::MODEL, &stored).unwrap()).unwrap_err().to_string()
    };
    let of_module = |change: fn(&mut StoredModel)| message(&module(), change);
    let of_free = |change: fn(&mut StoredModel)| message(&free(), change);
    let unknown = of_module(|stored| stored.effects[0].name = "tides".into());
    assert!(
        unknown.contains("effect `tides` that this program does not know; use a newer freeact"),
        "{unknown}"
    );
    assert!(
        of_module(|stored| stored.effects[0].parameters[0].0 = "x".into()).contains("the parameters [x, ")
    );
    assert!(of_module(|stored| stored.effects[0].frees[0] = 9).contains("FREE 10, but the actuator has 2"));
    assert!(of_module(|stored| stored.effects[0].parameters[0].1 = f64::NAN).contains("is NaN"));
    macro_rules! part {
        ($content:ident, $part:ident, $change:expr) => {
            |stored: &mut StoredModel| match &mut stored.content {
                StoredContent::$content { $part, .. } => $change($part),
                _ => unreachable!("the test changes a model of the other kind"),
            }
        };
    }
    use crate::{
        free_model::FreeFacts,
        module_model::{ModuleFacts, Tables},
        stored_model::StoredSpline,
    };
    type Table = StoredSpline;
    let cases = [
        (of_module(part!(Module, tables, |t: &mut Tables| t.chart.truncate(119))), "as parameters"),
        (of_module(part!(Module, tables, |t: &mut Tables| t.chart[7] = f64::NAN)), "not finite"),
        (of_module(part!(Module, nodes, |n: &mut Vec<Vec<f64>>| n[0].swap(1, 2))), "must rise"),
        (
            of_module(part!(Module, nodes, |n: &mut Vec<Vec<f64>>| n.push(vec![0.0]))),
            "as many pressures as FREEs",
        ),
        (of_module(part!(Module, nodes, |n: &mut Vec<Vec<f64>>| n[1].truncate(3))), "one pose per node"),
        (of_module(part!(Module, tables, |t: &mut Tables| t.slopes.truncate(120))), "as parameters"),
        (of_module(part!(Module, tables, |t: &mut Tables| t.slopes[9] = f64::INFINITY)), "not finite"),
        (of_module(part!(Module, tables, |t: &mut Tables| t.clearance.push(1.0))), "to its boundary"),
        (of_module(part!(Module, tables, |t: &mut Tables| t.bars.truncate(7))), "error bars"),
        (
            of_module(part!(Module, facts, |f: &mut ModuleFacts| f.limit_pressures[0] = Some(-1.0))),
            "limit pressure",
        ),
        (
            of_module(part!(Module, facts, |f: &mut ModuleFacts| f.limits.pressure_max[0] = f64::NAN)),
            "not finite",
        ),
        (
            of_module(part!(Module, facts, |f: &mut ModuleFacts| f.module.frees[0].free.tube.length = 0.0)),
            "dimension",
        ),
        (
            of_module(part!(Module, facts, |f: &mut ModuleFacts| f.errors.position.p95 = f64::NAN)),
            "statistic",
        ),
        (of_free(part!(Free, scaled_reference, |s: &mut Table| s.nodes[0][0] = 0.3)), "same winding angles"),
        (of_free(part!(Free, states, |s: &mut Table| s.nodes[2][0] = 0.01)), "path coordinate"),
        (
            of_free(part!(Free, states, |s: &mut Table| *s.nodes[2].last_mut().unwrap() = 1.0)),
            "path coordinate",
        ),
        (of_free(part!(Free, facts, |f: &mut FreeFacts| f.limited.clear())), "how it ends"),
        (of_free(part!(Free, facts, |f: &mut FreeFacts| f.free.tube.wall = f64::NAN)), "dimension"),
        (of_free(part!(Free, facts, |f: &mut FreeFacts| f.errors.fitted.expansion.rms = -1.0)), "statistic"),
    ];
    for (message, expected) in cases {
        assert!(message.starts_with("x.model: the model "), "{message}");
        assert!(message.contains(expected), "{message} should speak of {expected}");
    }
}

#[test]
fn damage_under_a_right_checksum_never_panics() {
    // A linear congruential generator: the same damage in every run.
    let mut seed = 0x2545_f491_4f6c_dd1du64;
    let mut next = move |below: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize % below
    };
    let mut read_anyway = 0;
    for model in [module(), free()] {
        let body = model.to_bytes().unwrap()[HEADER..].to_vec();
        for round in 0..4000 {
            let mut damaged = body.clone();
            for _ in 0..=next(4) {
                let place = next(damaged.len());
                damaged[place] = match round % 3 {
                    0 => damaged[place] ^ (1 << next(8)),
                    // The bytes of long lengths and of infinities.
                    1 => 0xff,
                    _ => next(256) as u8,
                };
            }
            if round % 7 == 0 {
                damaged.truncate(next(body.len()));
            }
            let Ok(model) = read(&sealed(&damaged)) else { continue };
            read_anyway += 1;
            match &model.content {
                ModelContent::Module(module) => {
                    let mut into = module.workspace();
                    let domain = module.domain().to_vec();
                    for place in [-0.1, 0.0, 0.3, 1.0, 1.2] {
                        let at: Vec<f64> = domain.iter().map(|(a, b)| a + place * (b - a)).collect();
                        let _ = module.evaluate(&at, &mut into);
                        let _ = module.evaluate_near(&at, 1e3, &mut into);
                        module.clearance(&at);
                        module.splines().error_bars(&at);
                    }
                }
                ModelContent::Free(free) => {
                    for angle in [0.4, 0.5, 1.2] {
                        let _ = free.evaluate(2e4, angle, 0.3e6);
                        let _ = free.evaluate_near(-1.0, angle, 0.2e6, 10.0);
                        let _ = free.limit_pressure(angle, 0.4e6);
                    }
                }
            }
            model.to_bytes().unwrap();
        }
    }
    // Most damage falls on digits of coefficients and leaves a model; without such the evaluations above would not be tried.
    assert!(read_anyway > 1000, "only {read_anyway} damaged models were read");
}
