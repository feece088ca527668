//! Images of models: the bytes that a controller evaluates in place, see [`evaluator::Image`].

use crate::{
    FreeModel, Model, ModelContent, ModuleModel, SplineAxis, SplineGrid,
    effect::{EffectError, hanging_mass},
};
use actuator::PAYLOAD_STEP;
use evaluator::{FREE, HEADER, MAGIC, MODULE, Real, VERSION, effect::MAX_EFFECTS};

/// Why a model has no image.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoImage {
    /// More effects than an image holds.
    #[error("the model has {0} effects, an image holds up to {MAX_EFFECTS}")]
    Effects(usize),
    /// An effect with numbers that it cannot have.
    #[error("the model has an effect that cannot be: {0}")]
    Effect(#[from] EffectError),
    /// More content than an image can count.
    #[error("the model is too large for an image")]
    Size,
    /// A number that the image's precision cannot hold apart from its neighbour, or at all.
    #[error("the model cannot be told in numbers of {0} bytes: {1}; take double precision")]
    Precision(usize, evaluator::ImageError),
}

/// Integers and numbers of an image, in order.
#[derive(Default)]
struct Writer {
    integers: Vec<u32>,
    numbers: Vec<f64>,
}

impl Writer {
    fn count(&mut self, count: usize) -> Result<(), NoImage> {
        self.integers.push(u32::try_from(count).map_err(|_| NoImage::Size)?);
        Ok(())
    }

    fn axis(&mut self, axis: &SplineAxis) -> Result<(), NoImage> {
        self.count(axis.nodes().len())?;
        self.count(axis.pieces().len())?;
        self.numbers.extend_from_slice(axis.nodes());
        self.numbers.extend_from_slice(axis.pieces());
        Ok(())
    }

    fn grid(&mut self, grid: &SplineGrid) -> Result<(), NoImage> {
        grid.axes().iter().try_for_each(|axis| self.axis(axis))
    }

    fn free(&mut self, free: &FreeModel) -> Result<(), NoImage> {
        self.integers.push(FREE);
        let splines = free.splines();
        self.grid(splines.scaled_reference().grid())?;
        self.numbers.extend_from_slice(splines.scaled_reference().coefficients().as_flattened());
        self.grid(splines.states().grid())?;
        self.numbers.extend_from_slice(splines.states().coefficients().as_flattened());
        let free = free.free();
        self.numbers.extend([free.winding.angle_from_hoop(), free.elastomer.shear_modulus()]);
        self.integers.push(u32::from(!splines.bars().is_empty()));
        self.numbers.extend_from_slice(splines.bars().as_flattened());
        Ok(())
    }

    fn module(&mut self, model: &ModuleModel) -> Result<(), NoImage> {
        self.integers.push(MODULE);
        let splines = model.splines();
        self.count(splines.domain().len())?;
        self.grid(splines.grid())?;
        self.count(model.parameters().len())?;
        self.integers.push(u32::from(!splines.clearances().is_empty()));
        self.integers.push(u32::from(!splines.bars().is_empty()));
        self.integers.extend(model.load_parameters().map(|parameter| parameter as u32));
        self.numbers.extend([hanging_mass(model.module()), PAYLOAD_STEP]);
        self.numbers.extend(splines.domain().iter().flat_map(|(lower, upper)| [lower, upper]));
        self.numbers.extend_from_slice(splines.chart().as_flattened());
        for parameter in 0..splines.parameters() {
            self.numbers.extend_from_slice(splines.slopes(parameter).as_flattened());
        }
        self.numbers.extend_from_slice(splines.clearances());
        self.numbers.extend_from_slice(splines.bars().as_flattened());
        Ok(())
    }
}

impl Model {
    /// The model as an image in numbers `T`, `f32` or `f64`: content and effects, without provenance.
    ///
    /// # Errors
    /// [`NoImage`] for a model that an image cannot hold.
    pub fn image<T: Real + bytemuck::Pod>(&self) -> Result<Vec<u8>, NoImage> {
        let mut writer = Writer::default();
        match &self.content {
            ModelContent::Free(free) => writer.free(free)?,
            ModelContent::Module(module) => writer.module(module)?,
        }
        self.effects.check(self.frees())?;
        let effects = &self.effects.effects;
        if effects.len() > MAX_EFFECTS {
            return Err(NoImage::Effects(effects.len()));
        }
        writer.count(effects.len())?;
        for effect in effects {
            writer.integers.push(effect.kind.number());
            writer.integers.push(effect.frees.iter().fold(0, |bits, free| bits | 1 << free));
            writer.count(effect.values.len())?;
            writer.numbers.extend_from_slice(&effect.values);
        }
        if writer.integers.len() % 2 == 1 {
            writer.integers.push(0);
        }
        let Writer { integers, numbers } = writer;
        let mut body: Vec<u8> = integers.iter().flat_map(|integer| integer.to_le_bytes()).collect();
        let numbers: Vec<T> = numbers.into_iter().map(T::constant).collect();
        body.extend_from_slice(bytemuck::cast_slice(&numbers));
        let words = [
            VERSION as usize,
            size_of::<T>(),
            crc32fast::hash(&body) as usize,
            integers.len(),
            numbers.len(),
            0,
        ];
        let mut bytes = Vec::with_capacity(HEADER + body.len());
        bytes.extend_from_slice(&MAGIC);
        for word in words {
            bytes.extend_from_slice(&u32::try_from(word).map_err(|_| NoImage::Size)?.to_le_bytes());
        }
        bytes.extend_from_slice(&body);
        // What a controller would refuse is better refused here. A copy lies where numbers may lie.
        let mut aligned = vec![0u64; bytes.len().div_ceil(8)];
        let copy = &mut bytemuck::cast_slice_mut(&mut aligned)[..bytes.len()];
        copy.copy_from_slice(&bytes);
        evaluator::Image::<T>::read(copy).map_err(|error| NoImage::Precision(size_of::<T>(), error))?;
        Ok(bytes)
    }
}

#[cfg(test)]
mod tests;
