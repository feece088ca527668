use crate::{FindingKind, Findings, RecordError};
use mcap::records::Record;
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// A record longer than this, or a chunk that claims to become longer, is taken for damage: 1 GiB.
const RECORD_LIMIT: usize = 1 << 30;

/// A message as it stands in the file.
pub(crate) struct RawMessage {
    pub log_time: u64,
    pub data: Vec<u8>,
}

/// A topic and its messages in the order of the file.
pub(crate) struct RawTopic {
    pub schema: String,
    pub encoding: String,
    pub messages: Vec<RawMessage>,
}

/// The contents of an MCAP file, undecoded.
#[derive(Default)]
pub(crate) struct RawLog {
    pub topics: BTreeMap<String, RawTopic>,
    pub metadata: BTreeMap<String, BTreeMap<String, String>>,
    pub attachments: Vec<(String, Vec<u8>)>,
    pub findings: Findings,
}

impl RawLog {
    pub fn attachment(&self, name: &str) -> Option<&[u8]> {
        self.attachments.iter().find(|(known, _)| known == name).map(|(_, data)| data.as_slice())
    }

    fn message_count(&self) -> usize {
        self.topics.values().map(|topic| topic.messages.len()).sum()
    }

    fn last_time(&self) -> u64 {
        let times =
            self.topics.values().flat_map(|topic| topic.messages.iter().map(|message| message.log_time));
        times.max().unwrap_or(0)
    }
}

/// Reads an MCAP file from its beginning, without need of its summary. Of a file that is cut off or damaged, keeps what comes
/// before and reports it.
pub(crate) fn read_raw(path: &Path) -> Result<RawLog, RecordError> {
    let bytes = fs::read(path).map_err(|source| RecordError::Io { path: path.to_owned(), source })?;
    let fault = |message: String, source: Option<mcap::McapError>| RecordError::Mcap {
        path: path.to_owned(),
        message,
        source: source.map(Box::new),
    };
    if bytes.is_empty() {
        return Err(fault("the file is empty".into(), None));
    }
    if !bytes.starts_with(mcap::MAGIC) {
        let beginning = String::from_utf8_lossy(&bytes[..bytes.len().min(8)]).into_owned();
        let message =
            format!("not an MCAP file (it begins with {beginning:?}); give an .mcap or a .csv recording");
        return Err(fault(message, None));
    }
    let mut log = RawLog::default();
    let mut ended = read_records(&bytes, &mut log, Check::BeforeUse);
    let whole = bytes.len() > mcap::MAGIC.len() && bytes.ends_with(mcap::MAGIC);
    if !whole && matches!(ended, Err(mcap::McapError::UnexpectedEof)) {
        // The file ends inside a chunk. What is there of it is good, though its checksum cannot be formed.
        log = RawLog::default();
        ended = read_records(&bytes, &mut log, Check::AtEnd);
    }
    let count = log.message_count();
    match (ended, whole) {
        (Ok(()), true) => {}
        (Err(error), _) if count == 0 => {
            return Err(fault(format!("nothing can be recovered: {error}; fetch a whole copy"), Some(error)));
        }
        (ended, whole) => {
            let what = if whole { "is damaged" } else { "was cut off" };
            let reason = ended.err().map_or_else(String::new, |error| format!(" ({error})"));
            let message = format!(
                "the file {what}{reason}: {count} messages recovered, up to {:.3} s of its clock",
                log.last_time() as f64 / 1e9
            );
            log.findings.add(FindingKind::CutOff, "", count, message);
        }
    }
    Ok(log)
}

/// When the checksum of a chunk is compared.
#[derive(Clone, Copy, PartialEq)]
enum Check {
    /// Before a message of the chunk is used, so that a damaged one gives none.
    BeforeUse,
    /// When the chunk has been read.
    AtEnd,
}

fn read_records(bytes: &[u8], log: &mut RawLog, check: Check) -> Result<(), mcap::McapError> {
    let mut rest = bytes;
    let mut schemas: BTreeMap<u16, String> = BTreeMap::new();
    let mut channels: BTreeMap<u16, String> = BTreeMap::new();
    let options = LinearReaderOptions::default()
        .with_skip_end_magic(true)
        .with_validate_chunk_crcs(true)
        .with_prevalidate_chunk_crcs(check == Check::BeforeUse)
        .with_record_length_limit(RECORD_LIMIT);
    let mut reader = LinearReader::new_with_options(options);
    while let Some(event) = reader.next_event() {
        match event? {
            LinearReadEvent::ReadRequest(need) => {
                let length = need.min(rest.len());
                reader.insert(length).copy_from_slice(&rest[..length]);
                reader.notify_read(length);
                rest = &rest[length..];
            }
            LinearReadEvent::Record { data, opcode } => match mcap::parse_record(opcode, data)? {
                Record::Schema { header, .. } => {
                    schemas.insert(header.id, header.name);
                }
                Record::Channel(channel) => {
                    let schema = schemas.get(&channel.schema_id).cloned().unwrap_or_default();
                    let encoding = channel.message_encoding;
                    log.topics.entry(channel.topic.clone()).or_insert_with(|| RawTopic {
                        schema,
                        encoding,
                        messages: Vec::new(),
                    });
                    channels.insert(channel.id, channel.topic);
                }
                Record::Message { header, data } => {
                    let topic = channels.get(&header.channel_id).and_then(|name| log.topics.get_mut(name));
                    let Some(topic) = topic else {
                        return Err(mcap::McapError::UnknownChannel(header.sequence, header.channel_id));
                    };
                    topic.messages.push(RawMessage { log_time: header.log_time, data: data.into_owned() });
                }
                Record::Metadata(metadata) => {
                    log.metadata.insert(metadata.name, metadata.metadata);
                }
                Record::Attachment { header, data, .. } => {
                    log.attachments.push((header.name, data.into_owned()));
                }
                _ => {}
            },
        }
    }
    Ok(())
}
