//! Images: any bytes, under a right checksum too, give a model that evaluates without a panic, or an error.
#![no_main]

use evaluator::{Content, HEADER, Image, Real};

fn check<T: Real + bytemuck::Pod>(bytes: &[u8]) {
    let mut words = vec![0u64; bytes.len().div_ceil(8)];
    let copy = &mut bytemuck::cast_slice_mut(&mut words)[..bytes.len()];
    copy.copy_from_slice(bytes);
    let Ok(image) = Image::<T>::read(copy) else { return };
    let chain = image.effects.chain();
    let mut memory = vec![T::ZERO; chain.memory()];
    match &image.content {
        Content::Module(tip) => {
            for place in [-0.1, 0.0, 0.37, 1.0, f64::NAN] {
                let share = T::constant(place);
                let sides = tip.splines.domain().iter();
                let at: Vec<T> = sides.map(|(low, high)| *low + share * (*high - *low)).collect();
                let _ = tip.evaluate(&chain, &mut memory, T::constant(0.01), &at);
                let _ = (tip.splines.clearance(&at), tip.splines.error_bars(&at));
            }
        }
        Content::Free { splines, winding_angle, shear_modulus } => {
            for pressure in [-1.0, 0.0, 2e4, f64::INFINITY] {
                let _ = splines.evaluate(T::constant(pressure), *winding_angle, *shear_modulus, T::ZERO);
            }
        }
    }
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let mut sealed = bytes.to_vec();
    if let Some(body) = bytes.get(HEADER..) {
        sealed[16..20].copy_from_slice(&crc32fast::hash(body).to_le_bytes());
    }
    check::<f64>(bytes);
    check::<f64>(&sealed);
    check::<f32>(&sealed);
});
