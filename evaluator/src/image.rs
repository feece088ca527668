use crate::{
    Axis, FreeSplines, LoadParameter, MAX_AXES, MAX_PARAMETERS, ModuleSplines, Real, SplineGrid,
    TensorSpline, TipModel,
    effect::{Effect, EffectKind, Effects},
};
use core::fmt;

/// First eight bytes of an image.
pub const MAGIC: [u8; 8] = *b"FREEimg\0";
/// Format version that is written; those before are read.
pub const VERSION: u32 = 2;
/// Bytes before the content: magic, version, bytes per number, CRC-32 of what follows the header, counts of integers and numbers, zero.
pub const HEADER: usize = 32;

/// A model in the bytes of an image, evaluated where it lies: nothing is copied.
///
/// Layout, little-endian: the header ([`HEADER`]), then 32-bit integers (an even count), then numbers of the image's precision.
/// The image has to lie at an address that its numbers may have (a multiple of eight for double precision).
#[derive(Clone, Debug, PartialEq)]
pub struct Image<'a, T: 'static> {
    /// What it answers for.
    pub content: Content<'a, T>,
    /// What acts beyond the finite elements, in order.
    pub effects: Effects<'a, T>,
}

/// What an image answers for.
#[derive(Clone, Debug, PartialEq)]
pub enum Content<'a, T: 'static> {
    /// A single FREE.
    Free {
        /// The splines.
        splines: FreeSplines<T, &'a [T]>,
        /// The FREE's own winding angle, from the hoop, rad.
        winding_angle: T,
        /// The FREE's own shear modulus, Pa.
        shear_modulus: T,
    },
    /// Several between two plates.
    Module(TipModel<T, &'a [T]>),
}

/// Kinds of content, the first integer of an image.
pub const FREE: u32 = 1;
/// See [`FREE`].
pub const MODULE: u32 = 2;

/// Why bytes are no image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageError {
    /// They do not begin as an image does.
    NoImage,
    /// Written by a version that this one does not know.
    Version(u32),
    /// Numbers of as many bytes as these, not of the precision asked for.
    Precision(u32),
    /// They begin at an address that is no multiple of the size of their numbers.
    Address,
    /// This processor stores numbers the other way round.
    Endian,
    /// They end early, or go on too long.
    Length,
    /// Their checksum does not match.
    Checksum,
    /// An effect that this version does not know.
    UnknownEffect(u32),
    /// They are whole but say something that cannot be.
    Content(&'static str),
}

impl fmt::Display for ImageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ImageError::NoImage => f.write_str("not a freeact image; make one with `freeact export`"),
            ImageError::Version(found) => {
                write!(f, "image format version {found} is not known here (this evaluator reads up to {VERSION}); use a newer one")
            }
            ImageError::Precision(bytes) => {
                write!(f, "the image holds numbers of {bytes} bytes, not of the precision asked for; export it again")
            }
            ImageError::Address => f.write_str(
                "the image does not lie at an address that is a multiple of the size of its numbers; align it to 8 bytes",
            ),
            ImageError::Endian => f.write_str("this processor is big-endian, images are little-endian"),
            ImageError::Length => f.write_str("the image ends early or goes on too long; fetch a whole copy"),
            ImageError::Checksum => f.write_str("the image is damaged: its checksum does not match"),
            ImageError::UnknownEffect(number) => {
                write!(f, "the image has effect number {number}, which this evaluator does not know; use a newer one")
            }
            ImageError::Content(problem) => write!(f, "the image does not hold together: {problem}"),
        }
    }
}

impl core::error::Error for ImageError {}

/// What is left to be read of an image.
struct Reader<'a, T> {
    integers: &'a [u32],
    numbers: &'a [T],
}

impl<'a, T: Real + bytemuck::Pod> Reader<'a, T> {
    fn integer(&mut self) -> Result<u32, ImageError> {
        let (first, rest) = self.integers.split_first().ok_or(ImageError::Length)?;
        self.integers = rest;
        Ok(*first)
    }

    fn count(&mut self) -> Result<usize, ImageError> {
        usize::try_from(self.integer()?).map_err(|_| ImageError::Length)
    }

    fn numbers(&mut self, count: Option<usize>) -> Result<&'a [T], ImageError> {
        let split = count.and_then(|count| self.numbers.split_at_checked(count));
        let (taken, rest) = split.ok_or(ImageError::Length)?;
        self.numbers = rest;
        Ok(taken)
    }

    fn axis(&mut self) -> Result<Axis<T, &'a [T]>, ImageError> {
        let nodes = self.count()?;
        let pieces = self.count()?;
        Axis::new(self.numbers(Some(nodes))?, self.numbers(Some(pieces))?)
            .ok_or(ImageError::Content("an axis of its splines is none"))
    }

    fn grid(&mut self, axes: usize) -> Result<SplineGrid<T, &'a [T]>, ImageError> {
        let wrong = ImageError::Content("a grid of its splines is none");
        if axes > MAX_AXES {
            return Err(wrong);
        }
        let mut read: [Axis<T, &'a [T]>; MAX_AXES] = Default::default();
        for axis in &mut read[..axes] {
            *axis = self.axis()?;
        }
        SplineGrid::new(read.into_iter().take(axes)).ok_or(wrong)
    }

    fn spline<const OUT: usize>(&mut self, axes: usize) -> Result<TensorSpline<T, &'a [T], OUT>, ImageError> {
        let grid = self.grid(axes)?;
        let coefficients = self.numbers(grid.node_count().checked_mul(OUT))?;
        TensorSpline::new(grid, coefficients).ok_or(ImageError::Content("a spline's coefficients are none"))
    }

    fn module(&mut self) -> Result<TipModel<T, &'a [T]>, ImageError> {
        let frees = self.count()?;
        let grid = self.grid(frees)?;
        let nodes = grid.node_count();
        let (count, has_clearance, has_bars) = (self.count()?, self.count()?, self.count()?);
        let mut parameters = [None; MAX_PARAMETERS];
        let known = parameters.get_mut(..count).ok_or(ImageError::Content("it has too many parameters"))?;
        for parameter in known {
            *parameter = LoadParameter::from_number(self.integer()?);
        }
        let &[hanging_mass, payload_step] = self.numbers(Some(2))? else { return Err(ImageError::Length) };
        if !(hanging_mass.is_finite() && payload_step.is_finite() && payload_step > T::ZERO) {
            return Err(ImageError::Content("a mass of it is none"));
        }
        let domain = self.numbers(frees.checked_mul(2))?;
        let entry = nodes.checked_mul(6);
        let chart = self.numbers(entry)?;
        let slopes = self.numbers(entry.and_then(|entry| entry.checked_mul(count)))?;
        let clearance = self.numbers(nodes.checked_mul(has_clearance))?;
        let bars = self.numbers(nodes.checked_mul(2).and_then(|bars| bars.checked_mul(has_bars)))?;
        let domain = domain.as_chunks().0.iter().map(|[lower, upper]| (*lower, *upper));
        let splines = ModuleSplines::new(grid, (chart, slopes), domain, (clearance, bars))
            .map_err(ImageError::Content)?;
        Ok(TipModel { splines, parameters, hanging_mass, payload_step })
    }

    fn effects(&mut self, frees: usize) -> Result<Effects<'a, T>, ImageError> {
        let count = self.count()?;
        let mut effects = Effects::none(frees);
        for _ in 0..count {
            let number = self.integer()?;
            let kind = EffectKind::from_number(number).ok_or(ImageError::UnknownEffect(number))?;
            let frees = self.integer()?;
            let values = self.count()?;
            let effect = Effect { kind, frees, values: self.numbers(Some(values))? };
            effects.push(effect).map_err(ImageError::Content)?;
        }
        Ok(effects)
    }
}

impl<'a, T: Real + bytemuck::Pod> Image<'a, T> {
    /// Reads an image in place.
    ///
    /// # Errors
    /// What is wrong with the bytes, see [`ImageError`].
    pub fn read(bytes: &'a [u8]) -> Result<Self, ImageError> {
        if cfg!(target_endian = "big") {
            return Err(ImageError::Endian);
        }
        let (header, body) = bytes.split_at_checked(HEADER).ok_or(ImageError::NoImage)?;
        if header[..8] != MAGIC {
            return Err(ImageError::NoImage);
        }
        let word = |index: usize| {
            let mut four = [0; 4];
            four.copy_from_slice(&header[8 + 4 * index..12 + 4 * index]);
            u32::from_le_bytes(four)
        };
        let [version, precision, checksum, integers, numbers] = [word(0), word(1), word(2), word(3), word(4)];
        if !(1..=VERSION).contains(&version) {
            return Err(ImageError::Version(version));
        }
        if precision as usize != size_of::<T>() {
            return Err(ImageError::Precision(precision));
        }
        let end = |count: u32, size: usize| (count as usize).checked_mul(size).ok_or(ImageError::Length);
        let (of_integers, of_numbers) = (end(integers, 4)?, end(numbers, size_of::<T>())?);
        if of_integers.checked_add(of_numbers) != Some(body.len()) {
            return Err(ImageError::Length);
        }
        if crc32fast::hash(body) != checksum {
            return Err(ImageError::Checksum);
        }
        let (integers, numbers) = body.split_at(of_integers);
        let mut reader = Reader {
            integers: bytemuck::try_cast_slice(integers).map_err(|_| ImageError::Address)?,
            numbers: bytemuck::try_cast_slice(numbers).map_err(|_| ImageError::Address)?,
        };
        let (content, frees) = match reader.integer()? {
            FREE => {
                let (reference, states) = (reader.spline(2)?, reader.spline(3)?);
                let &[winding_angle, shear_modulus] = reader.numbers(Some(2))? else {
                    return Err(ImageError::Length);
                };
                // The first version had none.
                let has_bars = if version > 1 { reader.count()? } else { 0 };
                let bars = reader.numbers((3 * has_bars).checked_mul(states.grid().node_count()))?;
                let splines = FreeSplines::new(reference, states, bars).map_err(ImageError::Content)?;
                (Content::Free { splines, winding_angle, shear_modulus }, 1)
            }
            MODULE => {
                let module = reader.module()?;
                let frees = module.splines.domain().len();
                (Content::Module(module), frees)
            }
            _ => return Err(ImageError::Content("it is neither of a FREE nor of a module")),
        };
        let effects = reader.effects(frees)?;
        // One integer may be left, which makes their count even.
        if !reader.numbers.is_empty()
            || reader.integers.iter().any(|left| *left != 0)
            || reader.integers.len() > 1
        {
            return Err(ImageError::Length);
        }
        Ok(Image { content, effects })
    }
}
