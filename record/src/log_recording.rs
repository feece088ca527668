use crate::{FreeSample, LogHeader, LogWriter, Motion, RecordError, Recording, Rounding, Storage, TipTopic};
use std::io::{Seek, Write};
use std::path::Path;

/// Writes a recording as a log. Samples that were not measured (NaN) give no message.
///
/// With `storage.hold_commands` a command is written where it changes, and where it is all that a sample has; a FREE
/// whose commands have holes is written whole.
pub fn write_mcap(
    path: &Path,
    recording: &Recording,
    header: &LogHeader,
    storage: &Storage,
) -> Result<(), RecordError> {
    let mut header = header.clone();
    header.origin_ns = origin(recording, header.origin_ns);
    let mut log = LogWriter::create(path, &header, storage)?;
    write_samples(&mut log, recording, storage)?;
    log.finish()?;
    Ok(())
}

/// Log time of t = 0: moved on by whole seconds where the recording begins before it.
fn origin(recording: &Recording, given: u64) -> u64 {
    let before = recording.time.first().map_or(0.0, |first| (-first).max(0.0).ceil());
    given.max(before as u64 * 1_000_000_000)
}

fn write_samples<W: Write + Seek>(
    log: &mut LogWriter<W>,
    recording: &Recording,
    storage: &Storage,
) -> Result<(), RecordError> {
    let hold: Vec<bool> =
        recording.command.iter().map(|channel| storage.hold_commands && has_no_hole(channel)).collect();
    // Without steps nothing is rounded.
    let steps = storage.rounding.unwrap_or(Rounding { pressure: 0.0, position: 0.0, rotation: 0.0 });
    for (index, &time) in recording.time.iter().enumerate() {
        let pressures = || recording.pressure.iter().map(|channel| channel[index]);
        let mut seen = pressures().any(|pressure| !pressure.is_nan());
        match &recording.motion {
            Motion::Pose { position, rotation } => {
                let position = position.each_ref().map(|channel| rounded(channel[index], steps.position));
                let rotation = rotation.each_ref().map(|channel| rounded(channel[index], steps.rotation));
                seen |= position.iter().chain(&rotation).any(|value| !value.is_nan());
                log.tip(time, TipTopic::Measured, position, rotation)?;
            }
            Motion::Free { twist, extension, outer_diameter, torque, force } => {
                let sample = FreeSample {
                    twist: rounded(twist[index], steps.rotation),
                    extension: rounded(extension[index], steps.position),
                    outer_diameter: rounded(outer_diameter[index], steps.position),
                    torque: torque[index],
                    force: force[index],
                };
                seen |= [twist, extension, outer_diameter, torque, force].iter().any(|c| !c[index].is_nan());
                log.free_state(time, sample)?;
            }
        }
        for (free, pressure) in pressures().enumerate() {
            log.pressure(time, free, rounded(pressure, steps.pressure))?;
        }
        for (free, channel) in recording.command.iter().enumerate() {
            let same = index > 0 && channel[index] == channel[index - 1];
            if !(hold[free] && same && seen) {
                log.command(time, free, rounded(channel[index], steps.pressure))?;
            }
        }
    }
    Ok(())
}

/// Whether, from the first command on, none is missing.
fn has_no_hole(channel: &[f64]) -> bool {
    !channel.iter().skip_while(|value| value.is_nan()).any(|value| value.is_nan())
}

/// The nearest multiple of `step`; the value itself where the step is zero.
fn rounded(value: f64, step: f64) -> f64 {
    if step == 0.0 { value } else { (value / step).round() * step }
}
