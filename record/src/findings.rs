use std::fmt;

/// What kind of irregularity was found in a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FindingKind {
    /// A quantity of the rig was not recorded at all.
    NotRecorded,
    /// Single samples were not measured.
    Missing,
    /// The clock jumps: samples are missing whole.
    Gap,
    /// The same time stands twice; only the first was kept.
    DuplicateTime,
    /// The sampling rate is not the nominal one.
    Rate,
    /// Samples far from their neighbours.
    Outlier,
    /// Numbers of a size that suggests another unit.
    UnitSlip,
    /// Pressures above the rig's limit.
    AboveLimit,
    /// A reading that took something for granted.
    Assumption,
    /// A file that ends early; what was there was read.
    CutOff,
}

/// One irregularity of a recording. Nothing is mended: who uses the recording decides.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Its kind.
    pub kind: FindingKind,
    /// What it is about: a usual column (`p2_kpa`), `position` or `rotation` as a whole, or empty for the whole recording.
    pub channel: String,
    /// How many samples.
    pub count: usize,
    /// In words, with numbers.
    pub message: String,
    /// Indices of the samples, where samples can be named (outliers, gaps: the sample after the gap).
    pub samples: Vec<usize>,
}

/// Everything irregular about a recording.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Findings {
    /// The findings in the order they were made.
    pub list: Vec<Finding>,
}

impl Findings {
    /// Adds a finding that names no samples.
    pub fn add(
        &mut self,
        kind: FindingKind,
        channel: impl Into<String>,
        count: usize,
        message: impl Into<String>,
    ) {
        self.list.push(Finding {
            kind,
            channel: channel.into(),
            count,
            message: message.into(),
            samples: Vec::new(),
        });
    }

    /// Findings of one kind.
    pub fn of_kind(&self, kind: FindingKind) -> impl Iterator<Item = &Finding> {
        self.list.iter().filter(move |finding| finding.kind == kind)
    }

    /// Whether nothing was found.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Appends the findings of another.
    pub fn append(&mut self, mut other: Findings) {
        self.list.append(&mut other.list);
    }
}

impl fmt::Display for Findings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, finding) in self.list.iter().enumerate() {
            if index > 0 {
                writeln!(f)?;
            }
            if finding.channel.is_empty() {
                write!(f, "{}", finding.message)?;
            } else {
                write!(f, "{}: {}", finding.channel, finding.message)?;
            }
        }
        Ok(())
    }
}
